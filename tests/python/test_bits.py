"""The same bits everywhere: compilers, levels of optimisation, processors."""

import json
import re
import subprocess
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest
from builds import long_but, need, need_cross_compiler

from reports import bits, markdown
from reports.command import Disagreement
from reports.targets import (
    INCLUDES,
    ROOT,
    SMALL_SOURCES,
    SOURCES,
    TARGETS,
    ToolError,
    compile_each,
    library_flags,
    run,
)

PROGRAM, EXPECTED = bits.PROGRAM, bits.EXPECTED.read_text("utf-8")

# The kernels of processors without vectors: weights input by input, and in blocks by row.
PORTABLE = ["-O2 -U__SSE2__", "-O2 -U__SSE2__ -DEDML_BLOCKS_BY_ROW"]


def test_most_poses_are_lifted_and_some_are_not() -> None:
    for line in EXPECTED.splitlines():
        *_, lifted, _, of, done = line.split()
        if done == "computed":
            continue
        assert int(of) >= 200 and 0.8 * int(of) < int(lifted) < int(of)


def printed(command: list[str], folder: Path) -> str:
    """What the program prints here, by a compiler and its flags."""
    objects = compile_each(command, folder, SMALL_SOURCES)
    run(*command, PROGRAM, *objects, "-lm", "-o", folder / "bits")
    return run(folder / "bits")


COMPILERS = ["gcc", "clang"]
LEVELS = ["-O0", "-O1", "-O2", "-O3", "-Os", "-O2 -march=native", *PORTABLE]
SOME_LEVELS = [("clang", "-O3"), ("gcc", PORTABLE[1])]


@pytest.mark.slow
@pytest.mark.parametrize(("compiler", "options"), long_but(SOME_LEVELS, product(COMPILERS, LEVELS)))
def test_every_compiler_and_level_gives_the_same_bits(
    compiler: str, options: str, tmp_path: Path
) -> None:
    need(compiler)
    command = [compiler, *library_flags(), *options.split(), *INCLUDES]
    assert printed(command, tmp_path) == EXPECTED


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", long_but(["gcc -ffp-contract=fast"], ["gcc", "gcc -ffp-contract=fast", "clang"])
)
def test_no_flag_is_needed_for_these_bits(command: str, tmp_path: Path) -> None:
    """As GNU C, which fuses products and sums where the processor can: the sources forbid it."""
    compiler, *options = command.split()
    need(compiler)
    flags = ["-std=gnu11", "-O2", "-march=native", *options, *INCLUDES]
    assert printed([compiler, *flags], tmp_path) == EXPECTED


UNSAFE = "-ffast-math -fno-finite-math-only"  # refused by gcc, and undone by clang
ANOTHER_ARITHMETIC = [  # of floats than IEEE 754's
    "-ffast-math",
    UNSAFE,
    "-funsafe-math-optimizations",
    "-freciprocal-math",
    "-fassociative-math -fno-signed-zeros -fno-trapping-math",
    "-fsingle-precision-constant",  # changes nothing
    "-mfpmath=387",
]
REFUSED = [options for options in ANOTHER_ARITHMETIC if "constant" not in options]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("compiler", "options"),
    long_but(
        [("clang", UNSAFE), *product(["gcc"], REFUSED)],
        product(COMPILERS, ANOTHER_ARITHMETIC),
    ),
)
def test_options_that_change_floats_are_refused_or_change_nothing(
    compiler: str, options: str, tmp_path: Path
) -> None:
    need(compiler)
    command = [compiler, "-std=gnu99", "-O2", "-w", *options.split(), *INCLUDES]
    try:
        assert printed(command, tmp_path) == EXPECTED
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


@pytest.mark.slow
def test_no_instruction_is_fused_on_a_cortex_m4f(tmp_path: Path) -> None:
    floats = [source for source in SOURCES if "float" in source.read_text() or "f32" in source.stem]
    assert len(floats) > 8
    for source in floats:
        assert fused_instructions(source, "cortex-m4f", tmp_path / "x.o") == [], source


def test_the_search_for_fused_instructions_finds_them(tmp_path: Path) -> None:
    program = tmp_path / "fused.c"
    program.write_text("float f(float a, float b, float c) { return a * b + c; }\n", "utf-8")
    assert fused_instructions(program, "cortex-m4f", tmp_path / "x.o") != []


def need_row(row: bits.Row) -> None:
    """Skips the test where a target's compiler or emulator is missing."""
    if not bits.is_there(row):
        pytest.skip(f"no {row.packages}")


@pytest.mark.slow
@pytest.mark.parametrize("name", long_but(["cortex-m4f"], TARGETS))
def test_every_microcontroller_gives_the_same_bits(name: str) -> None:
    row = bits.core(name)
    need_row(row)
    bits.compare(row)


BIG_ENDIAN = next(row for row in bits.ROWS if row.target == "s390x")


@pytest.mark.slow
def test_a_big_endian_processor_gives_the_same_bits() -> None:
    """The others are for tools/run.py reports.bits."""
    need_row(BIG_ENDIAN)
    bits.compare(replace(BIG_ENDIAN, flags=f"{BIG_ENDIAN.flags} -O1"))  # half the time


def test_cmake_compiles_for_s390x_as_the_table_does(tmp_path: Path) -> None:
    """As GNU C, because C99 there is refused: in gcc's C99, floats are computed in double."""
    need("cmake")
    need_row(BIG_ENDIAN)
    system = ["-DCMAKE_SYSTEM_NAME=Linux", "-DCMAKE_SYSTEM_PROCESSOR=s390x"]
    compiler = [f"-DCMAKE_C_COMPILER={BIG_ENDIAN.compiler}", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"]
    run("cmake", "-S", ROOT, "-B", tmp_path, *system, *compiler)
    commands = json.loads((tmp_path / "compile_commands.json").read_text("utf-8"))
    command = next(c["command"] for c in commands if c["file"].endswith("/lift/lift_f32.c"))
    run(*command.split(), "-fsyntax-only", cwd=tmp_path)
    with pytest.raises(ToolError, match=bits.REFUSAL):
        run(*command.split(), "-fsyntax-only", "-std=c99", cwd=tmp_path)


# ---- The table of targets ----------------------------------------------------------------------


def test_the_page_has_each_target() -> None:
    table = markdown.read(bits.PAGE, "bits").splitlines()[2:]
    written = [[cell.strip() for cell in line.strip("|").split("|")] for line in table]
    assert len(written) >= 12
    for row, (target, arithmetic, _, flags, _, same, size) in zip(bits.ROWS, written, strict=True):
        assert (row.target, row.arithmetic) == (target, arithmetic)
        assert flags.strip("`").split()[1:] == row.flags.split()
        wanted = ("yes", written[0][-1]) if row.same else ("refused when compiled", "")
        assert (same, size) == wanted


def printing(text: str) -> bits.Row:
    """A target that prints this."""
    return replace(BIG_ENDIAN, output=lambda row, folder: text)


def test_other_bits_are_an_error_that_shows_them() -> None:
    bits.compare(printing(EXPECTED))
    first = EXPECTED.splitlines()[0]
    with pytest.raises(Disagreement, match=r"s390x, .*: other bits\nfloat distances_f32 0000"):
        bits.compare(printing(EXPECTED.replace(first.split()[2], "0" * 16)))
    with pytest.raises(Disagreement, match="not refused"):
        bits.compare(replace(printing(EXPECTED), same=False))


def test_what_is_missing_is_named_by_its_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bits.shutil, "which", lambda program: None)
    packages = "gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user clang lld nodejs"
    with pytest.raises(ToolError, match=rf"for s390x, WebAssembly please install .*: {packages}$"):
        bits.require([BIG_ENDIAN, *bits.WASM])
