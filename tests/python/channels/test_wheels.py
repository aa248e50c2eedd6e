"""pip install: the source distribution and wheels as a release has them, in a fresh environment."""

import functools
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tomllib
from builds import long_but, need
from support import EXAMPLES, ROOT, need_library, read_joints

import edmlift
from channels.python import wheel_checks, wheels
from channels.python.platforms import PLATFORMS
from channels.version import version
from edmlift.library import Library
from reports.targets import ToolError, run

pytestmark = pytest.mark.slow

WALK = read_joints("walk", 3)
HOST, CROSS = wheel_checks.host(), "linux_aarch64"
MODULES = {
    path.relative_to(ROOT / "tools").as_posix()
    for path in (ROOT / "tools" / "edmlift").rglob("*")
    if path.is_file() and "__pycache__" not in path.parts
}
PAGE = (ROOT / "docs" / "python.md").read_text("utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("dist")


@pytest.fixture(scope="module")
def build(folder: Path) -> Callable[[str | None], Path]:
    """Returns a platform's wheel, which is built when it is asked for first."""

    @functools.cache
    def built(name: str | None) -> Path:
        if name not in PLATFORMS:
            pytest.skip(f"no wheel for {name}")
        return wheels.build_wheels(folder, [name])[0]

    return built


@pytest.fixture(scope="module")
def wheel(build: Callable[[str | None], Path]) -> Path:
    """Of this machine."""
    return build(HOST)


@pytest.fixture(params=long_but([HOST], [HOST, CROSS]))
def built(request: pytest.FixtureRequest, build: Callable[[str | None], Path]) -> tuple[str, Path]:
    """A platform's name and its wheel: of this machine, and of another processor."""
    return request.param, build(request.param)


@pytest.fixture(scope="module")
def sdist(folder: Path) -> Path:
    return wheels.build_sdist(folder)


def contents(wheel: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


# ---- What they hold ------------------------------------------------------------------------------


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
    assert sdist.name == f"edmlift-{version()}.tar.gz"
    assert sdist.stat().st_size < 3_200_000


def test_a_wheel_holds_the_package_and_the_library(built: tuple[str, Path]):
    name, path = built
    platform = PLATFORMS[name]
    files = contents(path)
    info = {file.partition("/")[2] for file in files if ".dist-info/" in file}
    assert {file for file in files if ".dist-info/" not in file} == {
        *MODULES, f"edmlift/{platform.library}"
    }  # fmt: skip
    assert info == {"METADATA", "WHEEL", "RECORD", "entry_points.txt", "licenses/LICENSE"}
    tags = ".".join(sorted(platform.tags))
    assert path.name == f"edmlift-{version()}-py3-none-{tags}.whl"
    assert path.stat().st_size < 3_000_000
    assert f"It is {path.stat().st_size / 1e6:.1f} MB" in PAGE
    assert wheel_checks.platform_of(path) == name
    wheel_checks.check_record(path)


def test_a_wheel_asks_for_numpy_alone(wheel: Path):
    (metadata,) = (text for name, text in contents(wheel).items() if name.endswith("/METADATA"))
    requires = [line for line in metadata.decode().splitlines() if line.startswith("Requires-Dist")]
    assert [line for line in requires if "extra" not in line] == ["Requires-Dist: numpy>=1.24"]


def test_a_wheel_has_the_same_bytes_each_time(wheel: Path, tmp_path: Path):
    platform = PLATFORMS[HOST]
    library = wheel_checks.unpack_library(wheel, platform, tmp_path)
    library.chmod(0o755)
    again = wheels.build_wheel(tmp_path, platform, library)
    assert again.name == wheel.name and again.read_bytes() == wheel.read_bytes()


def test_an_index_of_packages_would_take_it(sdist: Path, built: tuple[str, Path]):
    name, path = built
    wheel_checks.check_metadata([sdist, path])
    if name.startswith("linux"):
        wheel_checks.check_oldest_glibc(path)


def test_a_record_of_other_files_is_found(wheel: Path, tmp_path: Path):
    other = tmp_path / wheel.name
    shutil.copy(wheel, other)
    with zipfile.ZipFile(other, "a") as archive:
        archive.writestr("edmlift/more.py", "")
    with pytest.raises(ToolError, match="RECORD"):
        wheel_checks.check_record(other)


# ---- What they compute ---------------------------------------------------------------------------


def test_the_library_exports_the_public_names_and_needs_no_other(
    built: tuple[str, Path], tmp_path: Path
):
    name, path = built
    library = wheel_checks.unpack_library(path, PLATFORMS[name], tmp_path)
    wheel_checks.check_exports(library)
    wheel_checks.check_needs(library)


@pytest.mark.long
def test_another_processor_gives_the_same_bits(build: Callable[[str | None], Path], tmp_path: Path):
    """All that tests/targets/bits.c computes, in QEMU."""
    need("qemu-aarch64")
    if not Path(wheel_checks.ARM64.loader).exists():
        pytest.skip("no libc6-arm64-cross")
    library = wheel_checks.unpack_library(build(CROSS), PLATFORMS[CROSS], tmp_path)
    wheel_checks.check_bits(library, wheel_checks.ARM64)


def test_the_page_of_python_lifts_the_sample_walk(wheel: Path, folder: Path):
    need_library()
    (program,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.M | re.S)
    python = wheel_checks.install(wheel, folder / "venv")
    empty = folder / "empty"
    empty.mkdir()
    shutil.copy(EXAMPLES / "walk.csv", empty)
    said = run(python, "-c", program, cwd=empty, env={})
    assert said == re.search(r"print\(poses\)  # (.*\n)", program)[1]
    lifted = (empty / "lifted.csv").read_text()
    assert lifted.count("ok,") == len(WALK)
    assert run(python.parent / "edmlift", "lift", "walk.csv", cwd=empty, env={}) == lifted
    edmlift.write_poses(empty / "expected.csv", edmlift.lift(WALK))
    assert lifted == (empty / "expected.csv").read_text()


@pytest.mark.long
def test_pip_compiles_the_sdist_to_the_same_package(wheel: Path, sdist: Path, tmp_path: Path):
    """Where there is no wheel; of one model, which takes less time."""
    need("cmake", "cc")
    need_library()
    options = ["-q", "--no-deps", "--no-build-isolation", "-w", tmp_path]
    setting = "-Ccmake.define.EDMLIFT_MODELS=direct_f32"
    run(sys.executable, "-m", "pip", "wheel", *options, setting, sdist, cwd=tmp_path)
    (compiled,) = tmp_path.glob("*.whl")
    ours, theirs = contents(wheel), contents(compiled)
    assert ours.keys() == theirs.keys()
    differ = {name.rpartition("/")[2] for name in ours if ours[name] != theirs[name]}
    assert differ == {PLATFORMS[HOST].library, "WHEEL", "RECORD"}
    library = wheel_checks.unpack_library(compiled, PLATFORMS[HOST], tmp_path)
    wheel_checks.check_exports(library)
    poses = Library("direct_f32", library).lift(WALK)
    np.testing.assert_array_equal(poses.joints, Library("direct_f32").lift(WALK).joints)


# ---- The command ---------------------------------------------------------------------------------


def test_a_platform_that_is_not_known(tmp_path: Path):
    program = [sys.executable, ROOT / "tools" / "run.py", "channels.python.wheels"]
    done = subprocess.run([*program, tmp_path, "amiga"], capture_output=True, text=True)
    assert done.returncode != 0
    assert "no platform amiga; there are linux_x86_64, " in done.stderr


def test_a_module_that_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ToolError, match=r"has no ziglang: pip install -r tools/requirements"):
        wheels.build_wheels(tmp_path, [CROSS])


def test_a_system_that_cannot_be_emulated_here(tmp_path: Path):
    system = wheel_checks.System("no-such", str(tmp_path / "ld.so"), "qemu-user libc6-no-cross")
    with pytest.raises(ToolError, match="apt-get install qemu-user libc6-no-cross"):
        wheel_checks.bits_of(tmp_path / "libedmlift.so", system)


def test_the_demos_requirements_are_some_of_all():
    tools = ROOT / "tools"
    demo, everything = (
        {line for line in (tools / name).read_text().splitlines() if "==" in line}
        for name in ("requirements-demo.txt", "requirements.txt")
    )
    assert demo and demo <= everything
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    wanted = [*project["dependencies"], *project["optional-dependencies"]["draw"]]
    assert {line.split("==")[0] for line in demo} == {line.split(">=")[0] for line in wanted}
