"""The bounds of the stack: of the call graph, on the page, and in the words of the headers."""

import math
import re
from pathlib import Path

import pytest
from builds import long_but, need_cross_compiler
from support import ROOT

from reports import markdown, size, stack
from reports.stack import Function
from reports.targets import TARGETS, ToolError

PAGE = stack.read_table(markdown.read(stack.PAGE, "stack"))
HEADERS = {path: path.read_text("utf-8") for path in sorted((ROOT / "include").rglob("*.h"))}
WORDS = r"[Aa]t\s+most\s+([0-9.]+) KB of stack"
BENCH = 32  # bytes: the frame of a function of tests/targets/bench around the call


@pytest.mark.claims("docs/stack.md", "stack")
@pytest.mark.slow
@pytest.mark.parametrize("core", long_but(["cortex-m0plus"], ["cortex-m0plus", "rv32imafc"]))
def test_the_page_has_the_bounds_of_the_call_graph(core: str):
    target = TARGETS[core]
    need_cross_compiler(target)
    stack.check({target.name: stack.measure_core(target)})


def test_what_ccache_has_kept_is_compiled_for_its_calls(tmp_path: Path):
    target = TARGETS["cortex-m0plus"]
    need_cross_compiler(target)
    for name in ("first", "again"):
        (tmp_path / name).mkdir()
        graph = stack.compile_graph(
            target, ROOT / "lib" / "joints" / "joints.c", tmp_path / name / "x.o"
        )
        assert graph


def test_the_page_has_each_core():
    assert list(PAGE) == [target.name for target in TARGETS.values()]


def said() -> dict[str, float]:
    """What headers say in a comment before a function, KB."""
    found = {}
    for text in HEADERS.values():
        for comment, name in re.findall(
            r"/\*((?:(?!\*/).)*)\*/\n[\w ]*?\b(edml_\w+)\(", text, re.S
        ):
            if words := re.search(WORDS, comment.replace("\n *", "")):
                found[name] = float(words[1])
    return found


def test_the_headers_say_what_the_page_does():
    words = said()
    assert len(words) == sum(
        len(re.findall(r"KB\s+(?:\* )?of\s+stack", t)) for t in HEADERS.values()
    )
    for name, kilobytes in words.items():
        both = [core[f] for core in PAGE.values() for f in (name, f"{name}_q")]
        assert kilobytes == math.ceil(max(both) / 100) / 10, name


def test_each_function_that_takes_over_a_kilobyte_says_so():
    words = said()
    large = {name for core in PAGE.values() for name, figure in core.items() if figure > 1000}
    assert {name.removesuffix("_q") for name in large} <= set(words)


def test_no_painted_stack_is_deeper_than_its_bound():
    table = markdown.read(size.COSTS, "costs").strip().splitlines()
    head, rows = table[0], table[3:]
    columns = [cell.strip() for cell in head.strip("|").split("|")]
    assert len(rows) > 50
    for row in rows:
        cost = dict(zip(columns, (cell.strip() for cell in row.strip("|").split("|")), strict=True))
        suffix = "_q" if cost["variant"] == "fixed" else ""
        bound = PAGE[cost["core"]]
        for column, name in (("stack", "edml_lift"), ("place_stack", "edml_place")):
            assert int(cost[column].replace(",", "")) <= bound[name + suffix] + BENCH, row


# ---- How it is read ----------------------------------------------------------------------------


COMPILED = """graph: { title: "a.c"
node: { title: "edml_lift" label: "edml_lift\\na.c:1:1\\n24 bytes (static)\\n0 dynamic objects" }
node: { title: "a.c:step.part.0" label: "step\\na.c:9:1\\n100 bytes (static)" }
node: { title: "sqrtf" label: "sqrtf\\n<built-in>" shape : ellipse }
edge: { sourcename: "edml_lift" targetname: "a.c:step.part.0" label: "a.c:2:3" }
edge: { sourcename: "a.c:step.part.0" targetname: "sqrtf" label: "a.c:2:3" }
edge: { sourcename: "edml_lift" targetname: "__indirect_call" label: "a.c:2:3" }
}
"""


def test_what_the_compiler_says():
    graph = stack.read_compiled(COMPILED)
    assert graph["edml_lift"] == Function(24, {"a.c:step.part.0"}, through_pointer=True)
    assert graph["a.c:step.part.0"] == Function(100, {"sqrtf"})
    graph |= {"sqrtf": Function(8), "edml__scale_and_orient": Function(200)}
    stack.follow_pointers(graph)
    assert stack.bounds(graph, ["edml_lift", "sqrtf"]) == {"edml_lift": 224, "sqrtf": 8}


def test_a_frame_without_a_bound_is_refused():
    with pytest.raises(ToolError, match="frame without a bound"):
        stack.read_compiled(COMPILED.replace("100 bytes (static)", "100 bytes (dynamic)"))


def test_an_unknown_call_through_a_pointer_is_refused():
    with pytest.raises(ToolError, match="calls through a pointer"):
        stack.follow_pointers({"edml_new": Function(8, through_pointer=True)})


def test_a_circle_of_calls_is_refused():
    graph = {"a": Function(8, {"b"}), "b": Function(8, {"a"})}
    with pytest.raises(ToolError, match="a -> b -> a"):
        stack.bounds(graph, ["a"])


@pytest.mark.parametrize(
    ("instruction", "moved"),
    [
        ("push {r4, r5, r6, lr}", 16),
        ("stmdb sp!, {r4-r7, lr}", 20),
        ("stmdb r0!, {r4, r5}", 0),
        ("vpush {d8-d9}", 16),
        ("sub sp, #8", 8),
        ("sub.w sp, sp, #136 @ 0x88", 136),
        ("str.w lr, [sp, #-4]!", 4),
        ("addi sp,sp,-32", 32),
        ("addi sp,sp,32", 0),
        ("add sp, #8", 0),
    ],
)
def test_how_far_an_instruction_moves_the_stack_pointer(instruction: str, moved: int):
    assert stack.bytes_pushed(instruction) == moved


def test_machine_code_with_two_names():
    text = "00000010 <one>:\n  10:\tb510\tpush\t{r4, lr}\n  12:\tf000\tbl\t40 <other>\n" \
           "  16:\td0fb\tbeq.n\t10 <one+0x2>\n00000040 <other>:\n  40:\t4770\tbx\tlr\n"  # fmt: skip
    graph = stack.read_machine_code(text)
    assert graph == {"one": Function(8, {"other"}), "other": Function(0)}
    stack.add_aliases(graph, "00000010 T one\n00000010 T first\n         U no\n")
    assert graph["first"] is graph["one"]


def test_of_static_functions_with_one_name_the_largest_frame_counts():
    text = "00000010 <one>:\n  10:\tb510\tpush\t{r4, lr}\n  12:\tf000\tbl\t40 <other>\n" \
           "00000040 <one>:\n  40:\tb5f0\tpush\t{r4, r5, r6, r7, lr}\n"  # fmt: skip
    assert stack.read_machine_code(text) == {"one": Function(20, {"other"})}
