"""Builds programs with the library for Cortex-M cores and runs them on emulated boards.

Needs arm-none-eabi-gcc with picolibc, which brings the startup code and prints through
semihosting, and qemu-system-arm.
"""

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted((ROOT / "lib").glob("*.c"))
INCLUDES = [f"-I{ROOT / 'include'}", f"-I{ROOT / 'lib'}"]
CROSS = "arm-none-eabi-"
PICOLIBC = "--specs=picolibc.specs"


class ToolError(Exception):
    """A program that is missing or failed, and what it said."""


@dataclass(frozen=True)
class Target:
    """A core, and the board of QEMU's that has it."""

    name: str
    board: str
    flags: tuple[str, ...]
    flash: tuple[int, int] = (0, 0x400000)  # address and size
    ram: tuple[int, int] = (0x20000000, 0x400000)
    tick_mhz: int = 25  # of SysTick


HARD = "-mfloat-abi=hard"
TARGETS = {
    "cortex-m0": Target(
        "Cortex-M0",
        "microbit",
        ("-mcpu=cortex-m0",),
        flash=(0, 0x40000),
        ram=(0x20000000, 0x4000),
        tick_mhz=16,
    ),
    "cortex-m3": Target("Cortex-M3", "mps2-an385", ("-mcpu=cortex-m3",)),
    "cortex-m4f": Target(
        "Cortex-M4F", "mps2-an386", ("-mcpu=cortex-m4", HARD, "-mfpu=fpv4-sp-d16")
    ),
    "cortex-m7": Target("Cortex-M7", "mps2-an500", ("-mcpu=cortex-m7", HARD, "-mfpu=fpv5-sp-d16")),
    "cortex-m33": Target(
        "Cortex-M33",
        "mps2-an505",
        ("-mcpu=cortex-m33", HARD, "-mfpu=fpv5-sp-d16"),
        flash=(0x10000000, 0x400000),
        ram=(0x38000000, 0x400000),
        tick_mhz=20,
    ),
}


def run(*command: object, **options) -> str:
    """Standard output of a command."""
    texts = [str(part) for part in command]
    try:
        done = subprocess.run(texts, capture_output=True, text=True, timeout=300, **options)
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
    return [
        f"{CROSS}gcc", PICOLIBC, *library_flags(), level, "-mthumb", *target.flags, *INCLUDES
    ]  # fmt: skip


def build(program: Path, target: Target, level: str, folder: Path, stack: int = 2048) -> Path:
    """An image of a program and the library, in a folder."""
    places = {
        "flash": target.flash[0],
        "flash_size": target.flash[1],
        "ram": target.ram[0],
        "ram_size": target.ram[1],
        "stack_size": stack,
    }
    image = folder / f"{program.stem}.elf"
    run(
        *compiler(target, level), "--oslib=semihost", "--crt0=semihost",
        "-DPICOLIBC_INTEGER_PRINTF_SCANF", f"-DTICK_MHZ={target.tick_mhz}", "-Wl,--gc-sections",
        "-Wl," + ",".join(f"--defsym=__{name}={value:#x}" for name, value in places.items()),
        program, *SOURCES, "-lm", "-o", image,
    )  # fmt: skip
    return image


def emulate(image: Path, target: Target, *options: str) -> str:
    """What an image prints; `-icount shift=7` makes SysTick count instructions."""
    return run(
        "qemu-system-arm", "-M", target.board, *options, "-display", "none", "-monitor", "none",
        "-serial", "none", "-chardev", "stdio,id=out",
        "-semihosting-config", "enable=on,target=native,chardev=out",
        "-kernel", image, stdin=subprocess.DEVNULL,
    )  # fmt: skip
