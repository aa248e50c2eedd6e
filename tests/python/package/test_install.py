"""pip install: the sdist, the wheel built from it, and four lines in a fresh environment."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from package_support import DATA, LIFT_STDIN, ROOT, need_lift_stdin

if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = pytest.importorskip("tomli")

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("install")]  # one environment

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
MODULES = {
    path.relative_to(ROOT / "tools").as_posix()
    for path in (ROOT / "tools" / "edmlift").rglob("*")
    if path.is_file() and path.suffix in (".py", ".typed", ".html", ".css", ".js")
}
FOUR_LINES = """
import edmlift
keypoints = edmlift.read_keypoints("walk.csv")
poses = edmlift.lift(keypoints)
edmlift.write_poses("lifted.csv", poses)
"""


def environment() -> dict[str, str]:
    """Without what would lead to this working copy."""
    mine = ("PYTHONPATH", "EDMLIFT_LIBRARY", "CMAKE_GENERATOR")
    return {name: value for name, value in os.environ.items() if name not in mine}


def run(*command: str | Path, folder: Path) -> subprocess.CompletedProcess:
    return subprocess.run(
        [str(part) for part in command], cwd=folder, env=environment(), capture_output=True,
        text=True, timeout=900,
    )  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("install")


@pytest.fixture(scope="module")
def python(folder: Path) -> Path:
    """A fresh environment with what builds the package."""
    for program in ("cmake", "cc"):
        if shutil.which(program) is None:
            pytest.skip(f"no {program}")
    made = run(sys.executable, "-m", "venv", folder / "venv", folder=folder)
    if made.returncode != 0:
        pytest.skip("this Python makes no environments: no ensurepip")
    python = folder / "venv" / "bin" / "python"
    wanted = [*PROJECT["build-system"]["requires"], *PROJECT["project"]["dependencies"]]
    got = run(python, "-m", "pip", "install", "-q", *wanted, folder=folder)
    if got.returncode != 0:
        pytest.skip(f"pip cannot get {', '.join(wanted)}: no network?")
    return python


@pytest.fixture(scope="module")
def sdist(python: Path, folder: Path) -> Path:
    code = f"import scikit_build_core.build as b; b.build_sdist({str(folder)!r})"
    result = run(python, "-c", code, folder=ROOT)
    assert result.returncode == 0, result.stderr
    (path,) = folder.glob("*.tar.gz")
    return path


@pytest.fixture(scope="module")
def wheel(python: Path, sdist: Path, folder: Path) -> Path:
    options = ["-q", "--no-deps", "--no-build-isolation", "-w", folder]
    result = run(python, "-m", "pip", "wheel", *options, sdist, folder=folder)
    assert result.returncode == 0, result.stderr
    (path,) = folder.glob("*.whl")
    return path


def in_the_header() -> str:
    line = next(
        line for line in (ROOT / "include" / "edmlift.h").read_text("utf-8").splitlines()
        if "define EDML_VERSION_STRING" in line
    )  # fmt: skip
    return line.split('"')[1]


def test_the_sdist_holds_what_builds_the_package_and_no_more(sdist: Path):
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    wanted = {f"tools/{name}" for name in MODULES}
    wanted |= {"CMakeLists.txt", "LICENSE", "README.md", "pyproject.toml", "PKG-INFO"}
    wanted |= {"cmake/EdmliftFlags.cmake"}
    wanted |= {f"gen/{path.name}" for path in ROOT.glob("gen/*.h")}
    for part in ("lib", "include"):
        files = (path for path in (ROOT / part).rglob("*") if path.is_file())
        wanted |= {path.relative_to(ROOT).as_posix() for path in files}
    assert names == wanted
    assert sdist.name == f"edmlift-{in_the_header()}.tar.gz"
    assert sdist.stat().st_size < 3_200_000


def test_the_wheel_holds_the_package_and_the_library(wheel: Path):
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        info = {name.partition("/")[2] for name in names if ".dist-info/" in name}
        metadata = archive.read(next(name for name in names if name.endswith("/METADATA")))
    package = {name for name in names if ".dist-info/" not in name}
    libraries = package - MODULES
    assert package - libraries == MODULES
    assert len(libraries) == 1 and libraries.pop().startswith("edmlift/libedmlift.")
    assert info == {"METADATA", "WHEEL", "RECORD", "entry_points.txt", "licenses/LICENSE"}
    assert "-py3-none-" in wheel.name and wheel.name.startswith(f"edmlift-{in_the_header()}-")
    requires = [line for line in metadata.decode().splitlines() if line.startswith("Requires-Dist")]
    assert [line for line in requires if "extra" not in line] == ["Requires-Dist: numpy>=1.24"]
    assert wheel.stat().st_size < 3_000_000


def test_nothing_internal_is_exported(wheel: Path, folder: Path):
    if shutil.which("nm") is None or sys.platform == "darwin":
        pytest.skip("no nm, or another kind of library")
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if "libedmlift" in name)
        library = Path(archive.extract(name, folder / "unpacked"))
    listed = subprocess.run(
        ["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True
    )
    symbols = [line.split()[-1] for line in listed.stdout.splitlines()]
    assert "edml_lift" in symbols and "edml_distances_f32" in symbols
    assert [s for s in symbols if not s.startswith("edml_") or s.startswith("edml__")] == []


def test_four_lines_lift_the_sample_walk(python: Path, wheel: Path, folder: Path):
    installed = run(python, "-m", "pip", "install", "-q", "--no-deps", wheel, folder=folder)
    assert installed.returncode == 0, installed.stderr
    empty = folder / "empty"
    empty.mkdir()
    shutil.copy(DATA / "walk.csv", empty)
    result = run(python, "-c", FOUR_LINES, folder=empty)
    assert result.returncode == 0, result.stderr
    lifted = (empty / "lifted.csv").read_text()
    assert lifted.count("ok,") == 39
    program = run(python.parent / "edmlift", "lift", "walk.csv", folder=empty)
    assert program.returncode == 0 and program.stdout == lifted
    need_lift_stdin()
    with open(DATA / "walk.csv", "rb") as keypoints:
        theirs = subprocess.run([LIFT_STDIN], stdin=keypoints, capture_output=True, check=True)
    assert lifted == theirs.stdout.decode()


def test_the_demos_requirements_are_some_of_all():
    tools = ROOT / "tools"
    demo, everything = (
        {line for line in (tools / name).read_text().splitlines() if "==" in line}
        for name in ("requirements-demo.txt", "requirements.txt")
    )
    assert demo and demo <= everything
    wanted = [
        *PROJECT["project"]["dependencies"],
        *PROJECT["project"]["optional-dependencies"]["draw"],
    ]
    assert {line.split("==")[0] for line in demo} == {line.split(">=")[0] for line in wanted}


def test_types(python: Path, folder: Path):
    """mypy --strict, where it is installed or can be."""
    got = run(python, "-m", "pip", "install", "-q", "mypy", "pillow", folder=ROOT)
    if got.returncode != 0:
        pytest.skip("pip cannot get mypy: no network?")
    cache = f"--cache-dir={folder / 'mypy'}"
    result = run(python, "-m", "mypy", "--strict", cache, "tools/edmlift", folder=ROOT)
    assert result.returncode == 0, result.stdout
