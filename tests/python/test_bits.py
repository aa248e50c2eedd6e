"""The same bits everywhere: compilers, levels of optimisation, processors."""

from pathlib import Path

import pytest
from builds import need, run_firmware

from firmware import INCLUDES, ROOT, SOURCES, TARGETS, library_flags, run

PROGRAM = ROOT / "tests" / "bits.c"


def checksum(compiler: str, options: list[str], out: Path) -> str:
    need(compiler)
    program = out / "bits"
    run(compiler, *library_flags(), *options, *INCLUDES, PROGRAM, *SOURCES, "-lm", "-o", program)
    return run(program)


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Of the plainest build there is."""
    return checksum("gcc", ["-O0"], tmp_path_factory.mktemp("bits"))


def test_most_poses_are_lifted_and_some_are_not(expected: str) -> None:
    lifted, of = int(expected.split()[1]), int(expected.split()[3])
    assert of >= 200 and 0.8 * of < lifted < of


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("options", ["-O0", "-O1", "-O2", "-O3", "-Os", "-O2 -march=native"])
def test_every_compiler_and_level_gives_the_same_bits(
    compiler: str, options: str, expected: str, tmp_path: Path
) -> None:
    assert checksum(compiler, options.split(), tmp_path) == expected


@pytest.mark.parametrize("name", TARGETS)
def test_every_processor_gives_the_same_bits(name: str, expected: str, tmp_path: Path) -> None:
    assert run_firmware(PROGRAM, TARGETS[name], tmp_path) == expected
