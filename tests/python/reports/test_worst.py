"""The bound on a lift's instructions: how flow and loops are read, and the table on the page."""

import itertools
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from builds import need, need_core
from support import ROOT

from reports import loops, markdown, size, worst
from reports.flow import Program
from reports.targets import INCLUDES, TARGETS, ToolError, build, compile_library, emulate, run

CORE = TARGETS["cortex-m4f"]
ROWS = worst.read_table(markdown.read(size.COSTS, "worst"))

# Five turns of two instructions; either two or four; a call in a loop of three.
TURNS = "movs r0, #5\n1: subs r0, #1\nbne 1b\nbx lr"
EITHER = "cbz r0, 1f\nnop\nnop\nnop\nbx lr\n1: nop\nbx lr"
CALLS = "push {r4, lr}\nmovs r4, #3\n1: bl either\nsubs r4, #1\nbne 1b\npop {r4, pc}"
MIDDLE = "cbz r0, 2f\n1: nop\n2: subs r0, #1\nbne 1b\nnop\nbne 2b\nbx lr"


def program(folder: Path, **functions: str) -> Program:
    """Of functions in assembly."""
    need_core(CORE)
    source, image = folder / "code.s", folder / "code.elf"
    text = "".join(
        f".globl {name}\n.thumb_func\n{name}:\n{code}\n" for name, code in functions.items()
    )
    source.write_text(f".syntax unified\n.thumb\n.text\n{text}.section .rodata\n.word 0\n")
    flags = ["-mthumb", "-mcpu=cortex-m4", "-nostdlib", "-Wl,--entry=0"]
    run(f"{CORE.system.cross}gcc", *flags, source, "-o", image)
    return Program(image, CORE.system.cross)


class Known:
    """What is known of loops without a text."""

    never, totals = (), []

    def __init__(self, **limits: int) -> None:
        self.limits = {f"{name}: 0": limit for name, limit in limits.items()}

    def limit(self, name: str) -> int:
        return self.limits[name]

    def together(self, outer: str, inner: str) -> None:
        return None


def test_a_loop_is_run_as_often_as_is_known(tmp_path: Path):
    code = program(tmp_path, turns=TURNS)
    assert worst.Flow(code, "turns", Known(turns=5)).bound() == 1 + 5 * 2 + 1
    assert worst.Flow(code, "turns", Known(turns=9)).bound() == 1 + 9 * 2 + 1


def test_the_longer_way_counts(tmp_path: Path):
    code = program(tmp_path, either=EITHER)
    assert worst.Flow(code, "either", Known()).bound() == 5


def test_a_call_counts_each_time(tmp_path: Path):
    code = program(tmp_path, calls=CALLS, either=EITHER)
    assert worst.Flow(code, "calls", Known(calls=3)).bound() == 2 + 3 * (3 + 5) + 1


def test_what_a_pointer_calls_is_that_of_the_function_that_calls(tmp_path: Path):
    """Also where another function jumps into that one at its end."""
    lift = "push {r4, lr}\nblx r3\npop {r4, pc}"
    functions = {"edml_lift": lift, "edml__scale_and_align": "nop\nbx lr"}
    code = program(tmp_path, stage="nop\nb edml_lift", **functions)
    assert worst.Flow(code, "edml_lift", Known()).bound() == 3 + 2
    assert worst.Flow(code, "stage", Known()).bound() == 2 + 3 + 2


def test_what_is_known_of_a_whole_lift_counts(tmp_path: Path):
    code = program(tmp_path, calls=CALLS, either=EITHER, turns=TURNS)
    known = Known(calls=10)
    known.totals = [({"calls: 0": 1}, 4)]  # it goes back four times
    assert worst.Flow(code, "calls", known).bound() == 2 + 5 * (3 + 5) + 1
    known.never = ("either",)
    with pytest.raises(ToolError, match="no bound"):
        worst.Flow(code, "calls", known).bound()


def test_a_loop_that_is_entered_in_the_middle_is_refused(tmp_path: Path):
    code = program(tmp_path, middle=MIDDLE)
    with pytest.raises(ToolError, match="entered in the middle"):
        worst.Flow(code, "middle", Known())


# ---- What is known of loops ---------------------------------------------------------------------


FACTS = {name: loops.facts_of(name, "fixed", "cortex-m3") for name in worst.MODELS}
TEXTS = [
    *loops.LIMITS,
    *(text for facts in FACTS.values() for weights, _ in facts.totals for text in weights),
]  # fmt: skip


@pytest.mark.parametrize("text", [text for text in dict.fromkeys(TEXTS) if ".h: " in text])
def test_a_loop_that_something_is_known_of_is_there(text: str):
    file, _, begins = text.partition(": ")
    (path,) = (ROOT / "lib").rglob(file)
    assert any(line.strip().startswith(begins) for line in path.read_text("utf-8").splitlines())


@pytest.mark.parametrize(
    ("text", "turns"),
    [
        ("fuse.h: for (int j = 0; j < EDML_JOINTS; j++) {", 14),
        ("mds.h: for (int j = i + 1; j < EDML_JOINTS; j++, distance++) {", 13),
        ("mds.h: for (int i = ORDER - 1; i >= 0; i--)", 13),
        ("mds.h: for (int j = ORDER - 1; j >= i; j--) matrix[i][j] = *--entry;", 13),
        ("tridiagonal.h: for (int i = 0; i < 2 * n; i += 2)", 13),
        ("jacobi.h: for (int sweep = 0, rotated = 1; sweep < SWEEPS && rotated; sweep++) {", 12),
        ("impute.h: for (int q = p + 1; q < count; q++) x();", 3),
    ],
)
def test_how_often_a_for_goes_on(text: str, turns: int):
    assert FACTS["direct"].limit(text) == turns


def test_a_loop_of_which_nothing_is_known_is_refused():
    with pytest.raises(ToolError, match="how often does this loop go on: a.h: while"):
        FACTS["direct"].limit("a.h: while (wrong) {")
    with pytest.raises(ToolError, match="how often"):
        FACTS["direct"].limit("a.h: for (int i = 0; i < number; i++) {")


def test_how_often_nested_loops_go_on_together():
    outer, inner = (f"a.h: for (int {i} = {start}; {i} < EDML_JOINTS; {i}++)"
                    for i, start in (("i", "0"), ("j", "i + 1")))  # fmt: skip
    assert FACTS["direct"].together(outer, inner) == 91
    assert FACTS["direct"].together("a.h: while (1)", inner) is None


def test_the_constants_are_those_of_the_library(tmp_path: Path):
    need("gcc")
    source = tmp_path / "constants.c"
    names = [name for name in loops.CONSTANTS if name != "LAST"]  # of a function
    checks = "".join(f"char a{n}[{n} == {loops.CONSTANTS[n]} ? 1 : -1];\n" for n in names)
    source.write_text(f'#include "api/api_f32.h"\n#include "lift/lift.h"\n{checks}', "utf-8")
    subprocess.run(["gcc", "-fsyntax-only", "-w", *INCLUDES, source], check=True)


def test_the_sizes_of_a_network():
    model = loops.read_model("direct", "w16")
    assert model.layers == [(56, 88), (176, 88), (176, 88), (176, 32)] and model.fewest == 10
    assert model.groups == [11, 11, 11, 4]
    assert 8 * model.reads == 88 * 56 + 2 * 88 * 176 + 32 * 176


def addresses(log: Path, offset: int) -> list[int]:
    """Of the instructions that QEMU ran, where the program lies so much further up."""
    found = re.findall(r"^Trace \d+: \w+ \[\w+/(\w+)/", log.read_text("utf-8"), re.M)
    return [int(address, 16) + offset for address in found]


@pytest.mark.slow
def test_no_loop_that_was_seen_goes_on_more_often_than_is_known(tmp_path: Path):
    """Of four lifts, instruction by instruction."""
    need_core(CORE)
    library = compile_library(CORE, "-Os", tmp_path, worst.SOURCES, worst.LINES)
    options = [*size.options_of("distances", "fixed"), "-DINPUTS=4", worst.LINES]
    options.append(f"-DCOUNTS_PER_1000={CORE.counts}")
    program, far = size.BENCH / "worst.c", replace(CORE, flash=worst.FLASH)
    image, near, log = tmp_path / "far.elf", tmp_path / "near.elf", tmp_path / "log"
    build(program, far, "-Os", image, *options, library=library)
    build(program, CORE, "-Os", near, *options, library=library)
    emulate(near, CORE, "-icount", "shift=5", "-singlestep", "-d", "exec,nochain", "-D", str(log))
    facts = loops.facts_of("distances", "fixed", "cortex-m4f")
    flow = worst.Flow(Program(image, CORE.system.cross), "stage_lift", facts)
    trace = addresses(log, int(worst.FLASH.partition(",")[0], 16))
    before: dict[int, list[int]] = {}
    for last, address in itertools.pairwise(trace):
        before.setdefault(address, []).append(last)
    seen = 0
    for function, loop, limit in flow.limits:
        ends = {function.blocks[at].instructions[-1].address for at in loop.back}
        turns = most = 0
        for last in before.get(loop.head, []):
            turns = turns + 1 if last in ends else 0
            most = max(most, turns)
        assert most <= limit, worst.loop_texts(function, loop, set())
        seen += most > 0
    assert seen > 70


# ---- The page ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.claims("docs/costs.md", "worst")
def test_the_page_has_the_bounds():
    need_core(CORE)
    worst.check(worst.measure_core("cortex-m4f"))


def test_the_page_has_each_core_model_and_variant():
    wanted = [
        (TARGETS[core].name, model, variant)
        for core in worst.CORES for model in worst.MODELS for variant in worst.VARIANTS
    ]  # fmt: skip
    assert [(row.core, row.model, row.variant) for row in ROWS] == wanted


def test_no_lift_that_was_seen_exceeds_the_bound():
    means = {(c.core, c.model, c.variant): c.lift
             for c in size.parse(markdown.read(size.COSTS, "costs"))}  # fmt: skip
    for row in ROWS:
        assert means[row.core, row.model, row.variant] < row.seen < row.usual <= row.bound


def test_another_figure_is_found():
    row = ROWS[0]
    worst.check([row])
    with pytest.raises(size.Disagreement, match=re.escape(f"bound={row.bound}")):
        worst.check([replace(row, seen=row.seen * 11 // 10)])
