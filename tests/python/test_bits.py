"""The same bits everywhere: compilers, levels of optimisation, processors."""

from dataclasses import replace
from pathlib import Path

import pytest
from builds import need, run_firmware

from firmware import INCLUDES, ROOT, SOURCES, TARGETS, library_flags, run

PROGRAM = ROOT / "tests" / "targets" / "bits.c"
EXPECTED = (ROOT / "tests" / "bits.txt").read_text()  # of gcc -O0 on x86-64; by make_tables


def test_most_poses_are_lifted_and_some_are_not() -> None:
    for line in EXPECTED.splitlines():
        *_, lifted, _, of, done = line.split()
        if done == "convolved":
            continue
        assert int(of) >= 200 and 0.8 * int(of) < int(lifted) < int(of)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("options", ["-O0", "-O1", "-O2", "-O3", "-Os", "-O2 -march=native"])
def test_every_compiler_and_level_gives_the_same_bits(
    compiler: str, options: str, tmp_path: Path
) -> None:
    need(compiler)
    program = tmp_path / "bits"
    flags = [*library_flags(), *options.split(), *INCLUDES]
    run(compiler, *flags, PROGRAM, *SOURCES, "-lm", "-o", program)
    assert run(program) == EXPECTED


@pytest.mark.parametrize("name", TARGETS)
def test_every_processor_gives_the_same_bits(name: str, tmp_path: Path) -> None:
    target = TARGETS[name]
    if name == "cortex-m0plus":  # three networks do not fit its board: its code on a larger one
        large = TARGETS["cortex-m3"]
        target = replace(target, board=large.board, flash=large.flash, ram=large.ram)
    assert run_firmware(PROGRAM, target, tmp_path) == EXPECTED
