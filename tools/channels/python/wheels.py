"""The Python package: its source distribution, and a wheel a platform with the compiled library.

    python tools/run.py channels.python.wheels FOLDER [PLATFORM...]      all platforms without one

zig compiles the one file of all models for each platform.  On Linux and Windows the library needs
no other, not even a C library, so that one wheel serves glibc and musl.  scikit-build-core writes
the wheels, as it does where pip builds from source: the library and the tags alone differ.
"""

import argparse
import filecmp
import os
import shutil
import sys
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tqdm import tqdm

from channels.amalgamation.amalgamate import amalgamate, known_models
from channels.python import wheel_checks
from channels.python.platforms import CACHE, PLATFORMS, Platform, compile_library, need_modules
from data.paths import ROOT
from reports.targets import ToolError, run

SOURCE = ROOT / "build" / "wheels"


def build(folder: Path) -> list[Path]:
    """The source distribution and all wheels; all of it compiled, whatever was before."""
    with tempfile.TemporaryDirectory() as temporary:
        source, cache = Path(temporary, "source"), Path(temporary, "zig")
        return [build_sdist(folder), *build_wheels(folder, PLATFORMS, source, cache)]


def build_sdist(folder: Path) -> Path:
    """edmlift-VERSION.tar.gz: what pip compiles where there is no wheel."""
    return package(folder, "--sdist")


def build_wheels(
    folder: Path, names: Iterable[str], source: Path = SOURCE, cache: Path = CACHE
) -> list[Path]:
    """Wheels of some of the PLATFORMS.  `source` is where zig finds what it compiles, `cache` has
    what it compiled before."""
    need_modules("ziglang", "build", "scikit_build_core")
    platforms = [PLATFORMS[name] for name in names]
    write_source(source)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        compiled = pool.map(lambda p: compile_library(p, source, cache), platforms)
        libraries = list(tqdm(compiled, "libraries", len(platforms), disable=None))
    return [
        build_wheel(folder, platform, library)
        for platform, library in zip(platforms, libraries, strict=True)
    ]


def write_source(folder: Path) -> None:
    """The one file of all models in a folder; left as it is if it is that, because zig does not
    compile again what nobody touched."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        amalgamate(list(known_models()), ["all"], Path(temporary))
        names = {"edmlift.c", "edmlift.h"}
        same, *_ = filecmp.cmpfiles(temporary, folder, names, shallow=False)
        for name in names - set(same):
            shutil.copy(Path(temporary) / name, folder)


def build_wheel(folder: Path, platform: Platform, library: Path) -> Path:
    """The wheel of a platform with its library, of which nothing is compiled any more."""
    settings = {
        "wheel.cmake": "false",
        "wheel.platlib": "true",
        "wheel.tags": ";".join(f"py3-none-{tag}" for tag in platform.tags),
        f"wheel.force-include.{library}": f"edmlift/{library.name}",
    }
    return package(folder, "--wheel", *(f"-C{name}={value}" for name, value in settings.items()))


def package(folder: Path, *options: str) -> Path:
    """What the backend of pyproject.toml writes into a folder."""
    need_modules("build", "scikit_build_core")
    with tempfile.TemporaryDirectory() as temporary:
        backend = [sys.executable, "-m", "build", "--no-isolation", *options]
        run(*backend, "--outdir", temporary, ROOT, cwd=temporary)
        (made,) = Path(temporary).iterdir()
        return Path(shutil.copy(made, folder))


def check(files: list[Path]) -> None:
    """Checks the source distribution and the wheels, and runs those that this machine can run, most
    of them in emulators; raises ToolError.  It takes a Debian on x86-64."""
    wheel_checks.check_metadata(files)
    sdist, *wheels = files
    wanted = wheel_checks.lifted_by(sdist)
    for wheel in wheels:
        name = wheel_checks.platform_of(wheel)
        wheel_checks.check_wheel(wheel, name)
        if name == wheel_checks.host() and wheel_checks.lifted_by(wheel) != wanted:
            raise ToolError(f"{wheel.name} lifts other poses than {sdist.name}")
        if name in wheel_checks.PYTHONS and wheel_checks.lifted_in_qemu(wheel, name) != wanted:
            raise ToolError(f"{wheel.name} lifts other poses, in QEMU, than {sdist.name}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where they are written")
    parser.add_argument("platforms", nargs="*", metavar="PLATFORM", help=", ".join(PLATFORMS))
    options = parser.parse_args()
    unknown = set(options.platforms) - set(PLATFORMS)
    if unknown:
        parser.error(f"no platform {min(unknown)}; there are {', '.join(PLATFORMS)}")
    options.folder.mkdir(parents=True, exist_ok=True)
    try:
        made = build_wheels(options.folder, options.platforms or PLATFORMS)
    except ToolError as error:
        print(f"channels.python.wheels: {error}", file=sys.stderr)
        return 1
    for wheel in made:
        print(wheel)
    return 0


if __name__ == "__main__":
    sys.exit(main())
