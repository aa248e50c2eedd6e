"""Skips for tests that build programs; how to build them is in tools/reports/targets.py."""

import shutil
import subprocess
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

import pytest

from reports import targets


def long_but(few: Collection[Any], values: Iterable[Any]) -> list[Any]:
    """Parameters of a test, or tuples of them: with all but a few of them it is a long one."""
    return [value if value in few else _long(value) for value in values]


def _long(value: Any) -> Any:
    values = value if isinstance(value, tuple) else (value,)
    return pytest.param(*values, marks=pytest.mark.long)


def need(*programs: str) -> None:
    """Skips the test where a program is missing."""
    for program in programs:
        if shutil.which(program) is None:
            pytest.skip(f"no {program}")


def need_cross_compiler(target: targets.Target) -> None:
    """Skips the test where the core's compiler or its C library is missing."""
    compiler = f"{target.system.cross}gcc"
    need(compiler)
    probe = [compiler, *target.system.flags, *target.flags, "-E", "-x", "c", "-"]
    if subprocess.run(probe, input=b"", capture_output=True).returncode != 0:
        pytest.skip(f"no picolibc for {compiler}")


def need_core(target: targets.Target) -> None:
    """Skips the test where the core's compiler or emulator is missing."""
    need_cross_compiler(target)
    need(target.system.qemu[0])


def run_firmware(
    program: Path, target: targets.Target, folder: Path, library: list[Path], *options: str
) -> str:
    """What a program, with the library's sources or objects, prints on an emulated board."""
    need_core(target)
    image = folder / f"{program.stem}.elf"
    targets.build(program, target, "-O2", image, *options, library=library)
    return targets.emulate(image, target)
