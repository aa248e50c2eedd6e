"""A sketch for an emulated board, built as a maker builds it: by Arduino's builder, or PlatformIO.

The boards are the cores of reports.targets.  tests/channels/arduino has their Arduino platform and
what the example asks of Arduino; tests/channels/platformio has their PlatformIO platform.
"""

import json
import os
import shutil
from pathlib import Path

from data.paths import ROOT
from reports.targets import TARGETS, Target, link_flags, run

FILES = ROOT / "tests" / "channels"
CORE = FILES / "arduino" / "core"
# Debian's arduino-builder finds its own tools by these settings.
ARDUINO_BUILDER = Path("/usr/share/arduino-builder")
PLATFORMIO = ROOT / "build" / "venv-platformio" / "bin" / "pio"
TOOL_SCONS = "4.41101.0"  # what PlatformIO calls the version of SCons that it wants


def settings(target: Target) -> dict[str, str]:
    """What both platforms have to know of a board."""
    cpu = [*target.system.flags, *target.flags]
    flags = {"cpu_flags": cpu, "link_flags": link_flags(target)}
    return {"cross": target.system.cross} | {k: " ".join(words) for k, words in flags.items()}


# ---- Arduino ----------------------------------------------------------------------------------


def write_arduino_platform(folder: Path) -> None:
    """The platform edmlift:emulated in a folder for "hardware"."""
    platform = folder / "edmlift" / "emulated"
    shutil.copytree(CORE, platform / "cores" / "emulated")
    shutil.copy(FILES / "arduino" / "platform.txt", platform)
    lines = []
    for name, target in TARGETS.items():
        board = {"core": "emulated", "board": name.upper().replace("-", "_")} | settings(target)
        lines.append(f"{name}.name={target.name}")
        lines += [f"{name}.build.{key}={value}" for key, value in board.items()]
    (platform / "boards.txt").write_text("\n".join(lines) + "\n", "utf-8")


def arduino_image(folder: Path) -> Path:
    """The one that build_by_arduino() has made in a folder."""
    (image,) = folder.glob("build/*.elf")
    return image


def build_by_arduino(sketch: Path, libraries: Path, core: str, folder: Path) -> Path:
    """The image of the sketch in a folder, for a core, a key of TARGETS.

    libraries  what Arduino calls so: a folder that has the library's
    folder     is made; a second build there compiles what has changed
    """
    hardware, build = folder / "hardware", folder / "build"
    if not hardware.exists():
        build.mkdir(parents=True)
        write_arduino_platform(hardware)
    run(
        "arduino-builder", "-compile", "-hardware", ARDUINO_BUILDER, "-hardware", hardware,
        "-tools", hardware, "-libraries", libraries, "-fqbn", f"edmlift:emulated:{core}",
        "-build-path", build, sketch / f"{sketch.name}.ino",
    )  # fmt: skip
    return arduino_image(folder)


# ---- PlatformIO -------------------------------------------------------------------------------


def write_build_tool(home: Path) -> None:
    """SCons where PlatformIO keeps it, so that it needs no download."""
    tool = home / "packages" / "tool-scons"
    tool.mkdir(parents=True)
    manifest = {"name": "tool-scons", "version": TOOL_SCONS}
    origin = {"type": "tool", "spec": {"owner": "platformio", "name": "tool-scons"}}
    (tool / "package.json").write_text(json.dumps(manifest), "utf-8")
    (tool / ".piopm").write_text(json.dumps(manifest | origin), "utf-8")
    (tool / "scons.py").write_text("from SCons.Script import main\n\nmain()\n", "utf-8")


def build_by_platformio(sketch: Path, package: Path, core: str, folder: Path) -> Path:
    """The image of a project with the sketch as main.cpp and the library's package, for a core."""
    project = folder / "project"
    (project / "src").mkdir(parents=True)
    shutil.copy(sketch / f"{sketch.name}.ino", project / "src" / "main.cpp")
    options = {
        "platform": f"file://{FILES / 'platformio'}",
        "lib_deps": f"file://{package}",
        "custom_core": str(CORE),
    } | {f"custom_{key}": value for key, value in settings(TARGETS[core]).items()}
    lines = ["[env:emulated]", *(f"{key} = {value}" for key, value in options.items())]
    (project / "platformio.ini").write_text("\n".join(lines) + "\n", "utf-8")
    write_build_tool(folder / "home")
    own = {
        "PLATFORMIO_CORE_DIR": str(folder / "home"),
        "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "No",
    }
    run(PLATFORMIO, "run", "-d", project, env=os.environ | own)
    return project / ".pio" / "build" / "emulated" / "program.elf"
