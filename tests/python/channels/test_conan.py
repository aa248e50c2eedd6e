"""The recipe of Conan: made, installed and used, without a network."""

import os
import shutil
import sys
from pathlib import Path

import pytest
from builds import need
from support import ROOT

from channels.version import version
from reports.targets import run

CONAN = Path(sys.executable).with_name("conan")
READ = ("conanfile.py", "CMakeLists.txt", "LICENSE", "cmake", "gen", "include", "lib",
        "tests/channels/conan", "tests/install")  # fmt: skip


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the recipe reads of a checkout, because Conan builds its test in there."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in READ:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        copy(ROOT / name, folder / name)
    return folder


def conan(checkout: Path, *arguments: str) -> str:
    home = {"CONAN_HOME": str(checkout / "home")}
    return run(CONAN, *arguments, cwd=checkout, env=os.environ | home)


@pytest.mark.slow
def test_a_package_is_made_and_its_consumers_run(checkout: Path) -> None:
    """The project of tests/install, in C and C++; a debug build, which compiles fastest."""
    need("cmake", "make", "g++")
    conan(checkout, "profile", "detect")
    conan(checkout, "remote", "disable", "*")
    options = ["-s", "build_type=Debug", "-o", "&:models=distances_f32"]
    said = conan(checkout, "create", ".", *options)
    listed = conan(checkout, "list", f"edmlift/{version()}:*")
    assert "models: distances_f32" in listed and "shared: False" in listed
    packages = list((checkout / "home").glob("p/b/*/p"))
    assert len(packages) == 1
    files = {path.relative_to(packages[0]).as_posix() for path in packages[0].rglob("*.*")}
    headers = {path.relative_to(ROOT).as_posix() for path in (ROOT / "include").rglob("*.h")}
    assert files >= headers | {"lib/libedmlift.a"} and not any("cmake" in name for name in files)
    assert (packages[0] / "licenses" / "LICENSE").is_file(), said
