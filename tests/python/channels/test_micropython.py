"""The module for MicroPython, compiled with what stands for its C API (tests/channels/micropython).

By hand, before a release: build it with MicroPython itself, as docs/packages.md says, and run what
that page shows.
"""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from builds import need
from support import EXAMPLES, ROOT, need_library

import edmlift
from edmlift import _binding
from edmlift.library import Library
from reports.targets import INCLUDES, LIB, run

MODULE = ROOT / "examples" / "micropython" / "edmlift"
STAND_IN = ROOT / "tests" / "channels" / "micropython"
WARNINGS = "-Wall -Wextra -Wdouble-promotion -Wfloat-conversion -Werror".split()  # MicroPython's
WALK = np.loadtxt(EXAMPLES / "walk.csv", delimiter=",").reshape(-1, 14, 3).astype(np.float32)


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Calls the module's functions; linked to the tools' library."""
    need("gcc")
    need_library()
    library = _binding.default_path().resolve()
    program = tmp_path_factory.mktemp("micropython") / "program"
    sources = [STAND_IN / "main.c", MODULE / "modedmlift.c"]
    run("gcc", "-std=gnu99", "-O1", *WARNINGS, f"-I{STAND_IN}", INCLUDES[0], *sources, library,
        f"-Wl,-rpath,{library.parent}", "-o", program)  # fmt: skip
    return program


def call(program: Path, keypoints: str, *format_name: str) -> str:
    """What a call prints, of lift() or, with the name of a format, of adapt()."""
    command = [str(program), *format_name]
    return subprocess.run(command, input=keypoints, capture_output=True, text=True).stdout


def text(keypoints: np.ndarray) -> str:
    """Keypoints as the program reads them; None where nothing was seen."""
    return " ".join(
        " ".join(float(number).hex() for number in point) if point[2] > 0 else "None"
        for point in keypoints
    )


def triples(said: str) -> np.ndarray:
    return np.array(
        [[float.fromhex(word) for word in line.split()] for line in said.splitlines()], np.float32
    )


def test_it_lifts_to_the_same_bits(program: Path) -> None:
    keypoints = WALK[::10].copy()
    keypoints[1, 7] = 0
    poses = edmlift.lift(keypoints, "direct_w16").joints
    for image, joints in zip(keypoints, poses, strict=True):
        assert np.array_equal(triples(call(program, text(image))), joints)


def test_it_adapts_to_the_same_bits(program: Path, library: Library) -> None:
    detected = np.tile(WALK[0, :1], (17, 1)) + np.arange(17, dtype=np.float32)[:, None]
    detected[:, 2] = 0.75
    wanted = library.adapt(detected[None], "coco17")[0]
    assert np.array_equal(triples(call(program, text(detected), "coco17")), wanted)


@pytest.mark.parametrize(
    "keypoints, said",
    [
        ("None " * 5 + text(WALK[0, 5:]), "ValueError: too_few_joints\n"),
        (text(WALK[0]).replace("0x", "nan 0x", 1).rsplit(" ", 1)[0], "ValueError: not_finite\n"),
        ("3 3 1 " * 14, "ValueError: degenerate\n"),
        (text(WALK[0, :13]), "ValueError: 13 items, not 14\n"),
    ],
)
def test_what_cannot_be_lifted_raises(program: Path, keypoints: str, said: str) -> None:
    assert call(program, keypoints) == said


def test_an_unknown_format_raises(program: Path) -> None:
    assert call(program, text(WALK[0]), "coco99") == "ValueError: unknown format\n"


def test_both_build_files_list_what_the_module_needs() -> None:
    """The sources without the optional parts, and one model."""
    make = (MODULE / "micropython.mk").read_text("utf-8")
    cmake = (MODULE / "micropython.cmake").read_text("utf-8")
    folders = {folder.name for folder in LIB.iterdir() if list(folder.glob("*.c"))}
    wanted = folders - {"models", "optional"}
    assert set(re.search(r"foreach folder,([\w ]+),", make)[1].split()) == wanted
    assert set(re.findall(r"\{edmlift\}/lib/(\w+)/\*\.c", cmake)) == wanted
    assert "lib/models/direct_w16.c" in make and "lib/models/direct_w16.c" in cmake
