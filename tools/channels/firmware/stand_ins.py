"""Projects of ESP-IDF and Zephyr, built with what stands for these systems in tests/channels, and
run on boards of QEMU's.

A stand-in has the system's CMake functions and the few C functions that the project calls. The
project's own files are built as they are.
"""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import kconfiglib

from data.paths import LIB, ROOT
from reports.targets import TARGETS, Target, ToolError, count, emulate, run

STAND_INS = ROOT / "tests" / "channels"
MODELS = {source.stem for source in (LIB / "models").glob("*.c")}


@dataclass(frozen=True)
class Chip:
    """A chip whose core is a preset of CMakePresets.json."""

    name: str
    core: str
    mhz: int

    @property
    def target(self) -> Target:
        return TARGETS[self.core]


@dataclass(frozen=True)
class Project:
    """A project that was built for a chip: `app` is its program, and `bits` prints checksums."""

    folder: Path
    chip: Chip
    library: str  # the archive that the library became
    stack: int  # bytes that the program has

    @cached_property
    def prints(self) -> str:
        """What the program prints, if each instruction takes a cycle."""
        return count(self.folder / "app.elf", self.chip.target)

    def bits(self) -> str:
        """Those lines of tests/bits.txt that belong to the model direct."""
        return emulate(self.folder / "bits.elf", self.chip.target)

    def last_line(self) -> tuple[float, int]:
        """Milliseconds of the lift, and bytes of the stack that the program took."""
        found = re.fullmatch(
            r"(\d+\.\d{3}) ms, (\d+) bytes of stack never used", self.prints.splitlines()[-1]
        )
        if found is None:
            raise ToolError(f"the program in {self.folder} prints\n{self.prints}")
        return float(found[1]), self.stack - int(found[2])

    def flash(self) -> tuple[int, int]:
        """Bytes of the library in the program: code, with the compiler's functions; weights."""
        placed = (self.folder / "app.map").read_text("utf-8")
        placed = placed.partition("\nLinker script and memory map\n")[2]
        section = r"^ \.(?:text|s?rodata)\S*\s+0x[0-9a-f]+\s+0x([0-9a-f]+) \S+/(\w+)\.a\((\w+)"
        code = weights = 0
        for size, archive, name in re.findall(section, placed, re.M):
            if archive == self.library and name in MODELS:
                weights += int(size, 16)
            elif archive in (self.library, "libgcc", "libm"):
                code += int(size, 16)
        return code, weights


def write_configuration(kconfigs: Sequence[Path], settings: str, out: Path) -> None:
    """What a project's settings make of these Kconfig files.  ToolError for a setting that is of
    no effect, such as one of a symbol that no file has."""
    top, given = out.with_suffix(".kconfig"), out.with_suffix(".conf")
    top.write_text("".join(f'source "{path}"\n' for path in kconfigs), "utf-8")
    given.write_text(settings, "utf-8")
    configuration = kconfiglib.Kconfig(str(top), warn_to_stderr=False)
    configuration.warn_assign_undef = True
    configuration.load_config(str(given))
    if configuration.warnings:
        raise ToolError("\n".join(configuration.warnings))
    configuration.write_config(str(out))


def build_project(
    source: Path, folder: Path, chip: Chip, environment: Mapping[str, Path], *settings: str
) -> None:
    """CMake's build of a project in a folder."""
    target = chip.target
    values = {
        "CMAKE_TOOLCHAIN_FILE": ROOT / "cmake" / f"{target.system.cross.rstrip('-')}.cmake",
        "EDMLIFT_CPU": " ".join(target.flags),
        "EDMLIFT_FLASH": target.flash,
        "EDMLIFT_RAM": target.ram,
        "MHZ": chip.mhz,
        "COUNTS_PER_1000": target.counts,
    }
    run(
        "cmake", "-S", source, "-B", folder, *(f"-D{name}={v}" for name, v in values.items()),
        *settings, env=os.environ | {name: str(path) for name, path in environment.items()},
    )  # fmt: skip
    run("cmake", "--build", folder, "--parallel", "2")
