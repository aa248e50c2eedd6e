"""Builds programs with the library for the cores of CMakePresets.json and runs them in QEMU.

Needs arm-none-eabi-gcc or riscv64-unknown-elf-gcc with picolibc, which brings the startup code and
prints through semihosting, and qemu-system-arm or qemu-system-riscv32.
"""

import json
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from data.paths import LIB, ROOT

SOURCES = sorted(LIB.rglob("*.c"))
# Without FConv's megabytes, which take a third of the time to compile.
SMALL_SOURCES = [source for source in SOURCES if not source.match("models/fconv_*.c")]
WITHOUT_MODELS = [source for source in SOURCES if source.parent.name != "models"]
INCLUDES = [f"-I{ROOT / 'include'}", f"-I{LIB}"]


class ToolError(Exception):
    """A program that is missing or failed, and what it said."""


@dataclass(frozen=True)
class System:
    """What the cores of an instruction set share."""

    cross: str  # prefix of compiler and binary utilities
    flags: tuple[str, ...]  # those of its toolchain file
    qemu: tuple[str, ...]
    icount: int  # with `-icount shift=N` an instruction takes 2^N ns


SYSTEMS = {
    "arm": System(
        "arm-none-eabi-", ("--specs=picolibc.specs", "-mthumb"), ("qemu-system-arm",), icount=5
    ),
    "riscv": System(
        "riscv64-unknown-elf-",
        ("--specs=picolibc.specs", "-mcmodel=medany"),
        ("qemu-system-riscv32", "-bios", "none"),
        icount=0,
    ),
}
SYSTICK_MHZ = {"microbit": 16, "mps2-an505": 20, "mps3-an547": 32}  # the others: 25


@dataclass(frozen=True)
class Target:
    """A core, and the board of QEMU's that has it (or one that runs its code)."""

    name: str
    system: System
    flags: tuple[str, ...]
    board: str
    flash: str  # address,size
    ram: str

    @property
    def counts(self) -> int:
        """What its counter counts in 1000 instructions: SysTick, or RISC-V's minstret itself."""
        if self.system is SYSTEMS["riscv"]:
            return 1000
        return SYSTICK_MHZ.get(self.board, 25) << self.system.icount


def targets() -> dict[str, Target]:
    """The presets that name a core."""
    presets = json.loads((ROOT / "CMakePresets.json").read_text("utf-8"))["configurePresets"]
    variables = {preset["name"]: preset["cacheVariables"] for preset in presets}
    found = {}
    for preset in presets:
        base = preset.get("inherits")
        if base in SYSTEMS:
            has = variables[base] | preset["cacheVariables"]
            found[preset["name"]] = Target(
                preset["displayName"], SYSTEMS[base], tuple(has["EDMLIFT_CPU"].split()),
                has["EDMLIFT_BOARD"], has["EDMLIFT_FLASH"], has["EDMLIFT_RAM"],
            )  # fmt: skip
    return found


TARGETS = targets()


def run(*command: object, **options: Any) -> str:
    """Standard output of a command."""
    texts = [str(part) for part in command]
    try:
        done = subprocess.run(texts, capture_output=True, text=True, timeout=1500, **options)
    except FileNotFoundError:
        raise ToolError(f"{texts[0]} is not installed; tools/check installs it") from None
    if done.returncode != 0:
        raise ToolError(f"{' '.join(texts)}\n{done.stdout}{done.stderr}")
    return done.stdout


def library_flags() -> list[str]:
    """The flags that cmake/EdmliftFlags.cmake gives the library, without warnings."""
    text = (ROOT / "cmake" / "EdmliftFlags.cmake").read_text("utf-8")
    options = re.search(r"target_compile_options\(\$\{target\} PRIVATE(.*?)\)", text, re.S)[1]
    return ["-std=c99", *re.findall(r"-f\S+", options)]


def compiler(target: Target, level: str) -> list[str]:
    """The compiler's name and flags; level is -Os, -O2 ..."""
    system = target.system
    return [
        f"{system.cross}gcc", *system.flags, *target.flags, *library_flags(), level, *INCLUDES
    ]  # fmt: skip


def object_name(source: Path) -> str:
    """A name for a source's object file, unlike that of any other: lift_lift_f32.o."""
    return "_".join(source.relative_to(LIB).with_suffix(".o").parts)


def compile_each(command: list[str], folder: Path, sources: list[Path] = SOURCES) -> list[Path]:
    """The library's sources, each to an object file in a folder, by a compiler and its flags."""
    objects = [folder / object_name(source) for source in sources]
    for source, item in zip(sources, objects, strict=True):
        run(*command, "-c", source, "-o", item)
    return objects


def compile_library(
    target: Target, level: str, folder: Path, sources: list[Path] = SOURCES, *options: str
) -> list[Path]:
    """The library in a folder, as a file for the linker: an archive, of which a program links what
    it calls."""
    objects = compile_each([*compiler(target, level), *options], folder, sources)
    archive = folder / "libedmlift.a"
    run(f"{target.system.cross}ar", "rcs", archive, *objects)
    return [archive]


def link_flags(target: Target) -> list[str]:
    """Those of a program: startup code, semihosting, and where flash and RAM are."""
    (flash, flash_size), (ram, ram_size) = target.flash.split(","), target.ram.split(",")
    places = {"flash": flash, "flash_size": flash_size, "ram": ram, "ram_size": ram_size}
    sizes = places | {"stack_size": "6144"}
    symbols = [f"-Wl,--defsym=__{name}={value}" for name, value in sizes.items()]
    return ["--oslib=semihost", "--crt0=semihost", "-Wl,--gc-sections", *symbols]


def build(
    program: Path, target: Target, level: str, image: Path, *options: str, library: list[Path]
) -> Path:
    """An image of a program and the library's sources or objects."""
    run(
        *compiler(target, level), *link_flags(target), "-DPICOLIBC_INTEGER_PRINTF_SCANF", *options,
        program, *library, "-lm", "-o", image,
    )  # fmt: skip
    return image


def emulate(image: Path, target: Target, *options: str) -> str:
    """What an image prints."""
    return run(
        *target.system.qemu, "-M", target.board, *options, "-display", "none", "-monitor", "none",
        "-serial", "none", "-chardev", "stdio,id=out",
        "-semihosting-config", "enable=on,target=native,chardev=out",
        "-kernel", image, stdin=subprocess.DEVNULL,
    )  # fmt: skip


def count(image: Path, target: Target) -> str:
    """What an image prints whose counter counts instructions, `target.counts` in 1000."""
    return emulate(image, target, "-icount", f"shift={target.system.icount}")
