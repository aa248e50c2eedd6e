"""Skips for tests that build programs; how to build them is in tools/firmware.py."""

import shutil
import subprocess
from pathlib import Path

import pytest

import firmware


def need(*programs: str) -> None:
    """Skips the test where a program is missing."""
    for program in programs:
        if shutil.which(program) is None:
            pytest.skip(f"no {program}")


def need_cross_compiler() -> None:
    """Skips the test where the compiler or its C library is missing."""
    need(f"{firmware.CROSS}gcc")
    probe = [f"{firmware.CROSS}gcc", firmware.PICOLIBC, "-E", "-x", "c", "-"]
    if subprocess.run(probe, input=b"", capture_output=True).returncode != 0:
        pytest.skip("no picolibc")


def run_firmware(program: Path, target: firmware.Target, folder: Path) -> str:
    """What a program prints on an emulated board."""
    need_cross_compiler()
    need("qemu-system-arm")
    return firmware.emulate(firmware.build(program, target, "-O2", folder), target)
