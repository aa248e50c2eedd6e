"""Arduino and PlatformIO: the example, built from what a maker installs, lifts on emulated boards
to the bits of the library."""

import json
import re
import shutil
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from builds import need, need_core
from numpy.typing import NDArray
from support import ROOT, need_library

import edmlift
from channels.firmware import arduino, arduino_costs, boards
from reports import markdown
from reports.targets import TARGETS, ToolError, emulate, run

pytestmark = pytest.mark.slow

SKETCH = ROOT / arduino.EXAMPLE
PAGE = ROOT / "docs" / "arduino.md"
TURNS = 3  # of loop(), on an emulated board
MICROSECONDS = 1250  # between two looks at its clock


def snippet(language: str, begins: str) -> str:
    """A block of the page."""
    blocks = re.findall(rf"^```{language}\n(.*?)^```$", PAGE.read_text("utf-8"), re.M | re.S)
    (found,) = [block for block in blocks if block.startswith(begins)]
    return found


# ---- What there is to install ------------------------------------------------------------------


def test_src_holds_includes_of_all_that_is_compiled_and_no_more() -> None:
    """`tools/run.py channels.firmware.arduino` writes it."""
    assert arduino.files_below(arduino.SRC) == arduino.sources()


def test_src_is_written_anew(tmp_path: Path) -> None:
    (tmp_path / "gone.c").write_text("of a source that is no more")
    arduino.write_sources(tmp_path)
    assert arduino.files_below(tmp_path) == arduino.sources()


def test_nothing_in_src_is_a_second_copy() -> None:
    """Each file is one line, or, of a model on request, has a refusal of C++ around it."""
    for name, text in arduino.sources().items():
        code = re.sub(r"^#(ifdef|error|else|endif).*\n", "", text, flags=re.M)
        code = re.sub(r"/\*.*?\*/\n", "", code, flags=re.S)
        assert re.fullmatch(r'#include "(\.\./)+(lib|include)/[\w/]+\.[ch]"\n', code), name


def test_arduinos_manifest() -> None:
    lines = (ROOT / "library.properties").read_text("utf-8").splitlines()
    manifest = dict(line.split("=", 1) for line in lines)
    wanted = "name version author maintainer sentence paragraph category url architectures".split()
    assert set(wanted) <= set(manifest) and all(manifest.values())
    assert (arduino.SRC / manifest["includes"]).exists()
    assert not manifest["paragraph"].startswith(manifest["sentence"])  # they stand side by side


def test_platformios_manifest() -> None:
    manifest = json.loads((ROOT / "library.json").read_text("utf-8"))
    assert (ROOT / manifest["build"]["srcDir"]) == arduino.SRC
    for header in manifest["headers"]:
        assert (ROOT / manifest["build"]["includeDir"] / header).exists()
    assert "license" not in manifest  # `pio pkg pack` would ask the internet for a list of them


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The zip file for Arduino, and the package for PlatformIO."""
    return arduino.build(tmp_path_factory.mktemp("packages"))


def test_both_packages_hold_what_is_needed_and_no_more(packages: list[Path]) -> None:
    with zipfile.ZipFile(packages[0]) as archive, tarfile.open(packages[1]) as package:
        files = {item.name: package.extractfile(item).read() for item in package if item.isfile()}
        assert {f"edmlift/{name}" for name in files} == set(archive.namelist())
    assert {name.partition("/")[0] for name in files} == {
        *("LICENSE", "README.md", "library.json", "library.properties"),
        *("examples", "gen", "include", "lib", "src"),
    }
    kinds = {Path(name).suffix for name in files}
    assert kinds == {"", ".md", ".json", ".properties", ".c", ".h", ".ino"}
    assert {name for name in files if name.startswith("gen/")} == {
        f"gen/{header.name}" for header in (ROOT / "gen").glob("*.h")
    }


def test_an_export_that_is_not_there_is_told(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "library.json").write_text('{"export": {"include": ["lib"]}}')
    monkeypatch.setattr(arduino, "ROOT", tmp_path)
    with pytest.raises(FileNotFoundError, match="library.json exports lib, which is not there"):
        arduino.package_files()


# ---- On emulated boards ------------------------------------------------------------------------


def lifted(model: str) -> NDArray[np.float32]:
    """What the library makes of the example's tensor: joints and misfit [43]."""
    need_library()
    text = (SKETCH / "movenet.ino").read_text("utf-8")
    rows = re.findall(r"^    \{([\d.]+)F, ([\d.]+)F, ([\d.]+)F\}", text, re.M)
    y, x, score = np.array(rows, np.float32).T
    keypoints = np.stack([x * np.float32(192), y * np.float32(192), score], 1)
    pose = edmlift.lift(keypoints, model, format="coco17")
    assert keypoints.shape == (17, 3) and pose.status == "ok"
    return np.array([*pose.joints.ravel(), pose.misfit], np.float32)


def assert_bits(text: str, wanted: NDArray[np.float32]) -> None:
    """Does a board print this pose in each turn?"""
    heading, *lines = text.splitlines()
    assert heading.startswith("status,x0,y0,z0,") and heading.endswith(",z13,misfit,ms")
    assert len(lines) == TURNS
    for line in lines:
        status, *numbers, ms = line.split(",")
        assert status == "ok" and float(ms) == MICROSECONDS / 1000
        assert np.array(numbers, np.float32).tobytes() == wanted.tobytes()


def need_arduino(core: str) -> None:
    need("arduino-builder", f"{TARGETS[core].system.cross}g++")
    need_core(TARGETS[core])


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder "libraries" that has this checkout."""
    libraries = tmp_path_factory.mktemp("libraries")
    (libraries / "edmlift").symlink_to(ROOT)
    return libraries


@pytest.fixture(scope="module")
def maker(checkout: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[[], Path]:
    """A sketch of the maker's own, which is the example at first; called, it is built for a
    Cortex-M4F."""
    need_arduino("cortex-m4f")
    folder = tmp_path_factory.mktemp("maker")
    shutil.copytree(SKETCH, folder / "movenet")
    return lambda: boards.build_by_arduino(
        folder / "movenet", checkout, "cortex-m4f", folder / "out"
    )


@pytest.fixture(scope="module")
def image(maker: Callable[[], Path]) -> Path:
    """The example's, with what the build has left beside it kept as it was."""
    built = maker().parent
    shutil.copytree(built, built.parent / "example")
    return built.parent / "example" / "movenet.ino.elf"


@pytest.fixture(scope="module")
def said(image: Path) -> str:
    return emulate(image, TARGETS["cortex-m4f"])


def test_the_example_gives_the_bits_of_the_library(said: str) -> None:
    assert_bits(said, lifted("direct_w16"))


def test_what_it_prints_is_a_file_of_poses(said: str, tmp_path: Path) -> None:
    log = tmp_path / "serial.csv"
    log.write_text(said)
    poses = edmlift.read_poses(log)
    assert list(poses.status) == ["ok"] * TURNS
    assert poses.joints[0].tobytes() == lifted("direct_w16")[:42].tobytes()


def test_the_page_shows_what_it_prints(said: str) -> None:
    """With the three decimals that a board prints, and but for the time."""
    shown = snippet("", "status,").splitlines()
    heading, pose, *_ = said.splitlines()
    assert shown[0] == "{},...,{}".format(",".join(heading.split(",")[:7]), "z13,misfit,ms")
    status, *numbers = pose.split(",")
    rounded = [f"{float(number):.3f}" for number in numbers]
    assert shown[1].startswith(",".join([status, *rounded[:6], "...", *rounded[41:43]]) + ",")


def objects_of_fconv(image: Path) -> list[str]:
    return [path.name for path in image.parent.rglob("*fconv*.o") if "network_" not in path.name]


def test_fconv_is_compiled_for_who_asks(
    image: Path, maker: Callable[[], Path], tmp_path: Path
) -> None:
    """By a tab fconv.c of one line, as the page says."""
    assert objects_of_fconv(image) == []
    sketch = image.parents[2] / "movenet"
    text = (sketch / "movenet.ino").read_text("utf-8")
    other = text.replace("direct_w16", "fconv_w8").replace("edml_work", "edml_fconv_work")
    (sketch / "movenet.ino").write_text(other, "utf-8")
    with pytest.raises(ToolError, match="undefined reference to `edml_fconv_w8'"):
        maker()
    (sketch / "fconv.c").write_text(snippet("cpp", "#include <edmlift_fconv_w8.h>"), "utf-8")
    asked = maker()
    assert objects_of_fconv(asked) == ["fconv.c.o"]
    assert_bits(emulate(asked, TARGETS["cortex-m4f"]), lifted("fconv_w8"))


def test_fconv_in_cpp_is_refused(tmp_path: Path) -> None:
    need("g++")
    (tmp_path / "x.cpp").write_text("#include <edmlift_fconv_w8.h>\n")
    with pytest.raises(ToolError, match="in a C file, such as a tab fconv.c"):
        run("g++", f"-I{arduino.SRC}", "-fsyntax-only", tmp_path / "x.cpp")


@pytest.fixture(scope="module")
def installed(packages: list[Path], tmp_path_factory: pytest.TempPathFactory):
    """What the packages' examples print, and the folder in which they were built."""
    need_arduino("cortex-m0plus")
    need_core(TARGETS["rv32imc"])
    if not boards.PLATFORMIO.exists():
        pytest.skip("no PlatformIO: tools/check installs it into build/venv-platformio")
    folder = tmp_path_factory.mktemp("installed")
    return arduino.printed(packages, folder), folder


def test_the_packages_give_the_bits_of_the_library(installed) -> None:
    texts, _ = installed
    assert len(texts) == 2
    for text in texts:
        assert_bits(text, lifted("direct_w16"))


@pytest.mark.parametrize("texts", [["h\nok,1\n", "h\nok,2\n"], ["h\nmodel,\n"] * 2, ["h\n"] * 2])
def test_the_check_of_a_release_sees_what_is_wrong(texts: list[str], monkeypatch) -> None:
    monkeypatch.setattr(arduino, "printed", lambda files, folder: ["h\nok,1\n"] * 2)
    arduino.check([])
    monkeypatch.setattr(arduino, "printed", lambda files, folder: texts)
    with pytest.raises(ToolError, match="the example prints"):
        arduino.check([])


@pytest.mark.claims("docs/arduino.md", "arduino_memory")
def test_the_page_has_the_bytes_of_these_images(image: Path, installed) -> None:
    version = run("arm-none-eabi-gcc", "-dumpversion").strip()
    if not version.startswith("12.2"):
        pytest.skip(f"the figures are of gcc 12.2, this is {version}")
    images = {"cortex-m4f": image, "cortex-m0plus": boards.arduino_image(installed[1] / "arduino")}
    assert markdown.read(PAGE, "arduino_memory") == arduino_costs.memory_table(images)


def test_loop_leaves_room_on_a_stack(image: Path) -> None:
    assert 0 < arduino_costs.frame(image) < 1024


@pytest.mark.claims("docs/arduino.md", "arduino_milliseconds")
def test_the_page_has_the_milliseconds_of_the_costs() -> None:
    assert markdown.read(PAGE, "arduino_milliseconds") == arduino_costs.milliseconds_table()


# ---- Boards that are too small -----------------------------------------------------------------


def test_an_avr_is_refused(checkout: Path, tmp_path: Path, monkeypatch) -> None:
    """Before anything of the library is compiled."""
    need_arduino("cortex-m0plus")
    flags = boards.settings(TARGETS["cortex-m0plus"])
    avr = flags | {"cpu_flags": f"{flags['cpu_flags']} -D__AVR__"}
    monkeypatch.setattr(boards, "settings", lambda target: avr)
    with pytest.raises(ToolError, match="needs a 32-bit board, such as .* would lie in RAM"):
        boards.build_by_arduino(SKETCH, checkout, "cortex-m0plus", tmp_path / "out")
    assert list((tmp_path / "out").rglob("*.o")) == []


def test_without_arduino_builder_it_says_so(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ToolError, match="arduino-builder is not installed; tools/check installs"):
        boards.build_by_arduino(SKETCH, tmp_path, "cortex-m4f", tmp_path / "out")
