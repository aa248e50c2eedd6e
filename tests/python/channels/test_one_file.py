"""tools/amalgamate: the library as one file gives the library's bits, in C and in C++."""

from pathlib import Path

import pytest
from builds import need, run_firmware

from channels.amalgamation import amalgamate
from reports.targets import INCLUDES, ROOT, TARGETS, library_flags, run

PROGRAM = ROOT / "tests" / "targets" / "bits.c"
BITS = (ROOT / "tests" / "bits.txt").read_text().splitlines(keepends=True)
DIRECT = ["direct_f32", "direct_w16", "direct_w8"]
DIRECT_BITS = "".join(line for line in BITS if "direct" in line)  # -DPARTS=2


@pytest.fixture(scope="module")
def direct(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("direct")
    amalgamate(DIRECT, ["all"], folder)
    return folder / "edmlift.c"


def bits(source: Path, part: int, folder: Path, command: str, *objects: Path) -> str:
    """What a part of bits.c prints with the one file, compiled without a warning by a command."""
    compiler, *options = command.split()
    need(compiler)
    item, program = folder / "one.o", folder / "bits"
    run(compiler, *options, "-Wall", "-Wextra", "-Werror", "-c", source, "-o", item)
    flags = [*library_flags(), "-O1", *INCLUDES, f"-DPARTS={part}"]
    run("gcc", *flags, PROGRAM, item, *objects, "-lm", "-o", program)
    return run(program)


@pytest.mark.parametrize(
    "command", ["g++ -x c++ -std=c++11 -O1", "clang -std=gnu11 -O1 -march=native"]
)
def test_cpp_and_clang_give_the_same_bits(command: str, direct: Path, tmp_path: Path) -> None:
    assert bits(direct, 2, tmp_path, command) == DIRECT_BITS


@pytest.mark.parametrize("core", ["cortex-m4f", "rv32imc"])
def test_a_core_gives_the_same_bits(core: str, direct: Path, tmp_path: Path) -> None:
    assert run_firmware(PROGRAM, TARGETS[core], tmp_path, [direct], "-DPARTS=2") == DIRECT_BITS
