"""The library for Arduino and PlatformIO: src/, and the packages of a release.

    run.py channels.firmware.arduino      writes src/

Arduino compiles all that is below src/, and searches no other folder for headers.  So a source of
lib/ has a file there that includes it, and so does a header of include/.  The names are unlike each
other, because both systems put the objects into one archive, which has no folders.  FConv's models
are megabytes: they have headers instead, edmlift_fconv_w8.h, which a sketch that wants one includes
in a C file of its own.
"""

import json
import shutil
import sys
import tempfile
from pathlib import Path

from channels.archives import write_tar, write_zip
from channels.firmware.boards import build_by_arduino, build_by_platformio
from channels.version import version
from data.paths import ROOT
from reports.targets import SMALL_SOURCES, SOURCES, TARGETS, ToolError, emulate, object_name

SRC = ROOT / "src"
INCLUDE = ROOT / "include"
EXAMPLE = "examples/movenet"
MODEL_ON_REQUEST = """\
/* The model edml_{name}.  Its weights are megabytes of text, so that no sketch compiles them
 * unasked: one that wants the model includes this, in one C file of its own. */
#ifdef __cplusplus
#error "include <edmlift_{name}.h> in a C file, such as a tab fconv.c that has this line alone"
#else
#include "../lib/models/{name}.c"
#endif
"""


def sources() -> dict[str, str]:
    """What src/ has to hold: the text of each file, by its path there."""
    found = {}
    for source in SMALL_SOURCES:
        name = Path(object_name(source)).with_suffix(".c").name
        found[name] = f'#include "../{source.relative_to(ROOT).as_posix()}"\n'
    for header in INCLUDE.rglob("*.h"):
        path = header.relative_to(INCLUDE)
        up = "../" * len(path.parts)
        found[path.as_posix()] = f'#include "{up}include/{path.as_posix()}"\n'
    for source in set(SOURCES) - set(SMALL_SOURCES):
        found[f"edmlift_{source.stem}.h"] = MODEL_ON_REQUEST.format(name=source.stem)
    return found


def files_below(folder: Path) -> dict[str, str]:
    """The text of all files of a folder, by their path there."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {path.relative_to(folder).as_posix(): path.read_text("utf-8") for path in files}


def write_sources(folder: Path = SRC) -> None:
    """Makes src/ what it has to be."""
    wanted = sources()
    for name in files_below(folder).keys() - wanted.keys():
        (folder / name).unlink()
    for name, text in wanted.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, "utf-8")


def package_files() -> dict[str, Path]:
    """What both packages hold, by its path there: what library.json exports."""
    manifest = json.loads((ROOT / "library.json").read_text("utf-8"))
    found = {}
    for pattern in manifest["export"]["include"]:
        paths = [path for match in ROOT.glob(pattern) for path in (match, *match.rglob("*"))]
        if not paths:
            raise FileNotFoundError(f"library.json exports {pattern}, which is not there")
        found |= {path.relative_to(ROOT).as_posix(): path for path in paths if path.is_file()}
    return found


def build(out: Path) -> list[Path]:
    """Writes the library's zip file for Arduino, and its package for PlatformIO."""
    files = package_files()
    inside = {f"edmlift/{name}": path for name, path in files.items()}
    return [
        write_zip(out / f"edmlift-{version()}-arduino.zip", inside),
        write_tar(out / f"edmlift-{version()}-platformio.tar.gz", files),
    ]


def printed(files: list[Path], folder: Path) -> list[str]:
    """What the example prints on emulated boards: built from the zip file by Arduino, and from the
    package by PlatformIO."""
    archive, package = files
    libraries = folder / "libraries"
    shutil.unpack_archive(archive, libraries)
    sketch = libraries / "edmlift" / EXAMPLE
    small = build_by_arduino(sketch, libraries, "cortex-m0plus", folder / "arduino")
    other = build_by_platformio(sketch, package, "rv32imc", folder / "platformio")
    return [emulate(small, TARGETS["cortex-m0plus"]), emulate(other, TARGETS["rv32imc"])]


def check(files: list[Path]) -> None:
    """Builds the example out of both packages and runs it; raises ToolError if it does not lift."""
    with tempfile.TemporaryDirectory() as folder:
        one, other = printed(files, Path(folder))
    heading, *poses = one.splitlines()
    if one != other or not poses or any(not pose.startswith("ok,") for pose in poses):
        raise ToolError(f"the example prints\n{one}by Arduino, and\n{other}by PlatformIO")


def main() -> int:
    write_sources()
    return 0


if __name__ == "__main__":
    sys.exit(main())
