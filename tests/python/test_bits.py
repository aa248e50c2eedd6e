"""The same bits everywhere: compilers, levels of optimisation, processors."""

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from builds import need, need_core, need_cross_compiler, run_firmware

from reports.targets import (
    INCLUDES,
    ROOT,
    SMALL_SOURCES,
    SOURCES,
    TARGETS,
    ToolError,
    compile_each,
    compile_library,
    library_flags,
    run,
)

PROGRAM = ROOT / "tests" / "targets" / "bits.c"
EXPECTED = (ROOT / "tests" / "bits.txt").read_text()  # of gcc -O0 on x86-64; by make_tables

# The kernels of processors without vectors: weights input by input, and in blocks by row.
PORTABLE = ["-O2 -U__SSE2__", "-O2 -U__SSE2__ -DEDML_BLOCKS_BY_ROW"]


def test_most_poses_are_lifted_and_some_are_not() -> None:
    for line in EXPECTED.splitlines():
        *_, lifted, _, of, done = line.split()
        if done == "computed":
            continue
        assert int(of) >= 200 and 0.8 * int(of) < int(lifted) < int(of)


def bits(command: list[str], folder: Path) -> str:
    """What the program prints here, by a compiler and its flags."""
    objects = compile_each(command, folder, SMALL_SOURCES)
    run(*command, PROGRAM, *objects, "-lm", "-o", folder / "bits")
    return run(folder / "bits")


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    "options", ["-O0", "-O1", "-O2", "-O3", "-Os", "-O2 -march=native", *PORTABLE]
)
def test_every_compiler_and_level_gives_the_same_bits(
    compiler: str, options: str, tmp_path: Path
) -> None:
    need(compiler)
    command = [compiler, *library_flags(), *options.split(), *INCLUDES]
    assert bits(command, tmp_path) == EXPECTED


@pytest.mark.parametrize("command", ["gcc", "gcc -ffp-contract=fast", "clang"])
def test_no_flag_is_needed_for_these_bits(command: str, tmp_path: Path) -> None:
    """As GNU C, which fuses products and sums where the processor can: the sources forbid it."""
    compiler, *options = command.split()
    need(compiler)
    flags = ["-std=gnu11", "-O2", "-march=native", *options, *INCLUDES]
    assert bits([compiler, *flags], tmp_path) == EXPECTED


ANOTHER_ARITHMETIC = [  # of floats than IEEE 754's
    "-ffast-math",
    "-ffast-math -fno-finite-math-only",
    "-funsafe-math-optimizations",
    "-freciprocal-math",
    "-fassociative-math -fno-signed-zeros -fno-trapping-math",
    "-fsingle-precision-constant",
    "-mfpmath=387",
]


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("options", ANOTHER_ARITHMETIC)
def test_options_that_change_floats_are_refused_or_change_nothing(
    compiler: str, options: str, tmp_path: Path
) -> None:
    need(compiler)
    command = [compiler, "-std=gnu99", "-O2", "-w", *options.split(), *INCLUDES]
    try:
        assert bits(command, tmp_path) == EXPECTED
    except ToolError as refused:
        assert re.search("edmlift computes|'387' unit is not supported", str(refused))


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(
    "method, allowed", [(0, True), (16, True), (1, False), (2, False), (-1, False)]
)
def test_floats_in_a_wider_format_are_refused(compiler: str, method: int, allowed: bool) -> None:
    """As on s390x with -std=c99 (1), and on x86 without SSE (2)."""
    need(compiler)
    says = ["-U__FLT_EVAL_METHOD__", f"-D__FLT_EVAL_METHOD__={method}"]
    source = ROOT / "lib" / "optional" / "camera_f32.c"
    command = [compiler, *library_flags(), "-w", *says, *INCLUDES, "-fsyntax-only", source]
    built = subprocess.run(command, capture_output=True, text=True)
    assert (built.returncode == 0) == allowed
    if not allowed:
        assert "edmlift computes in float, not in a wider format" in built.stderr
        assert "-mfpmath=sse" in built.stderr and "-std=gnu99" in built.stderr


FUSED = re.compile(r"\b(vfn?m[as]|fn?m(add|sub))[.\w]*\b")


def fused_instructions(source: Path, name: str, item: Path) -> list[str]:
    """Fused multiplications and additions in a source's object code for a core."""
    target = TARGETS[name]
    need_cross_compiler(target)
    system = target.system
    flags = [*system.flags, *target.flags, "-std=gnu11", "-O2", *INCLUDES]
    run(f"{system.cross}gcc", *flags, "-c", source, "-o", item)
    return FUSED.findall(run(f"{system.cross}objdump", "-d", item))


def test_no_instruction_is_fused_on_a_cortex_m4f(tmp_path: Path) -> None:
    floats = [source for source in SOURCES if "float" in source.read_text() or "f32" in source.stem]
    assert len(floats) > 8
    for source in floats:
        assert fused_instructions(source, "cortex-m4f", tmp_path / "x.o") == [], source


def test_the_search_for_fused_instructions_finds_them(tmp_path: Path) -> None:
    program = tmp_path / "fused.c"
    program.write_text("float f(float a, float b, float c) { return a * b + c; }\n", "utf-8")
    assert fused_instructions(program, "cortex-m4f", tmp_path / "x.o") != []


@pytest.mark.parametrize("name", TARGETS)
def test_every_processor_gives_the_same_bits(name: str, tmp_path: Path) -> None:
    target = TARGETS[name]
    if name == "cortex-m0plus":  # three networks do not fit its board: its code on a larger one
        large = TARGETS["cortex-m3"]
        target = replace(target, board=large.board, flash=large.flash, ram=large.ram)
    need_core(target)
    library = compile_library(target, "-O2", tmp_path, SMALL_SOURCES)
    wanted = [f"-DPARTS={1 << n}" for n in range(5)]
    parts = [run_firmware(PROGRAM, target, tmp_path, library, part) for part in wanted]
    assert "".join(parts) == EXPECTED
