"""Platforms that wheels are for, and the library compiled for them by zig, from here."""

import importlib.util
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from channels.archives import EPOCH
from data.paths import ROOT
from reports.targets import ToolError, library_flags, run

CACHE = ROOT / "build" / "zig"  # of what zig compiled before, its own runtimes as well
COMPILE = (*library_flags(), "-O2", "-fPIC")
# memcpy() and what the processor lacks, such as divisions, come from the compiler's runtime.
ALONE = ("-nostdlib", "-rtlib=compiler-rt", "-Wl,--gc-sections")


@dataclass(frozen=True)
class Platform:
    """Where a wheel can be installed, and what its library is compiled for."""

    tags: tuple[str, ...]
    target: str  # by zig's name: the least processor and system
    library: str  # as tools/edmlift/_binding.py looks for it
    link: tuple[str, ...] = ALONE
    processor: tuple[str, ...] = ()


def linux(machine: str, target: str, *processor: str) -> Platform:
    """glibc 2.17 and musl 1.1, and later ones."""
    kinds = ("manylinux_2_17", "manylinux2014", "musllinux_1_1")
    tags = tuple(f"{kind}_{machine}" for kind in kinds)
    return Platform(tags, target, "libedmlift.so", processor=processor)


def macos(machine: str, version: str, target: str) -> Platform:
    name = "libedmlift.dylib"
    link = (f"-Wl,-install_name,@rpath/{name}", "-Wl,-dead_strip")
    tag = f"macosx_{version.replace('.', '_')}_{machine}"
    return Platform((tag,), f"{target}.{version}", name, link)


def windows(machine: str, target: str) -> Platform:
    return Platform((f"win_{machine}",), target, "edmlift.dll", (*ALONE, "-Wl,--no-entry"))


PLATFORMS = {
    "linux_x86_64": linux("x86_64", "x86_64-linux-gnu"),
    "linux_aarch64": linux("aarch64", "aarch64-linux-gnu"),
    # Without NEON, whose floats are not IEEE 754's.
    "linux_armv7l": linux("armv7l", "arm-linux-gnueabihf", "-mcpu=generic+v7a+vfp3d16-neon"),
    "macos_x86_64": macos("x86_64", "10.13", "x86_64-macos"),
    "macos_arm64": macos("arm64", "11.0", "aarch64-macos"),
    "windows_amd64": windows("amd64", "x86_64-windows-gnu"),
    "windows_arm64": windows("arm64", "aarch64-windows-gnu"),
}


def need_modules(*names: str) -> None:
    """ToolError if this Python lacks one."""
    for name in names:
        if importlib.util.find_spec(name) is None:
            todo = "pip install -r tools/requirements.txt"
            raise ToolError(f"{sys.executable} has no {name}: {todo}")


def zig(target: str, *arguments: object, folder: Path, cache: Path = CACHE) -> None:
    """The compiler, in a folder."""
    settings = {
        "ZIG_GLOBAL_CACHE_DIR": str(cache),
        "ZIG_LOCAL_CACHE_DIR": str(cache),
        "SOURCE_DATE_EPOCH": str(EPOCH),  # libraries of Windows have a time
    }
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target]
    run(*command, *arguments, cwd=folder, env=os.environ | settings)


def compile_library(platform: Platform, source: Path, cache: Path = CACHE) -> Path:
    """The library of edmlift.c in a folder, in one below it."""
    folder = source / platform.target
    folder.mkdir(exist_ok=True)
    item = f"{folder.name}/edmlift.o"
    options = (*COMPILE, *platform.processor)
    zig(platform.target, *options, "-c", "edmlift.c", "-o", item, folder=source, cache=cache)
    link = ("-shared", "-s", *platform.link, *platform.processor)
    made = ("-o", platform.library)
    zig(platform.target, *link, "edmlift.o", *made, folder=folder, cache=cache)
    return folder / platform.library
