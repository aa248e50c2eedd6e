"""The most stack that each public function can use, by the call graph, as Markdown.

    run.py reports.stack             prints the table
    run.py reports.stack --update    writes it to docs/stack.md
    run.py reports.stack --check     compares it

The compiler says each function's frame and whom it calls (-fcallgraph-info=su).  The frames of the
compiler's and the C library's functions are read off their machine code.  A bound is the frames of
the deepest chain of calls, whether or not an input takes it; painting (reports.size) finds what
some took.
"""

import os
import re
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path

from data.paths import DOCS, ROOT
from reports import markdown
from reports.command import Disagreement, Table, run_report
from reports.size import LEVEL, Row, to_table
from reports.targets import (
    SMALL_SOURCES,
    TARGETS,
    Target,
    ToolError,
    compiler,
    run,
)

PAGE = DOCS / "stack.md"
LEAST = 100  # bytes: functions below are not in the table
# Whom a function calls through a pointer.  A model's network is one that the lift can run.
KERNELS = "edml__(equivariant|fconn)_"
THROUGH_POINTERS = {
    "edml__run_network": f"{KERNELS}(f32|w16|w8)",
    "edml__run_network_q": f"{KERNELS}(w16|w8)",
    "edml_lift": "edml__scale_and_(align|orient)",
    "edml_lift_q": "edml__scale_and_(align|orient)_q",
    "edml_model_check": f"{KERNELS.removesuffix('_')}_checksum_(f32|w16|w8)",
    "sum_errors": "(line|image)_residual",
    "gauss_newton_step": "(line|image)_residual",
}
POINTER = "__indirect_call"
ROOMY = ("flash=0", "flash_size=64M", "ram=512M", "ram_size=64M")  # of a memory for all of it
BRANCH = re.compile(r"(?:b|jal|j |jr|c\.j|c\.b).*<([\w.$]+)>")


@dataclass
class Function:
    """A function of the library, or of the compiler's or C library."""

    frame: int  # bytes
    calls: set[str] = field(default_factory=set)
    through_pointer: bool = False


Graph = dict[str, Function]  # by name; a static function's is file:name


# ---- The library: what the compiler says -------------------------------------------------------


def read_compiled(text: str) -> Graph:
    """The functions of a .ci file.  ToolError where a frame has no bound."""
    graph: Graph = {}
    for name, label in re.findall(r'^node: \{ title: "([^"]+)" label: "([^"]+)" \}', text, re.M):
        size, kind = re.search(r"(\d+) bytes \(([a-z,]+)\)", label).groups()
        if kind not in ("static", "dynamic,bounded"):
            raise ToolError(f"{name} has a frame without a bound")
        graph[name] = Function(int(size))
    edge = r'^edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"'
    for caller, callee in re.findall(edge, text, re.M):
        if callee == POINTER:
            graph[caller].through_pointer = True
        else:
            graph[caller].calls.add(callee)
    return graph


def simple_name(name: str) -> str:
    """Without the file, and without the suffix of a copy that the compiler made."""
    return name.rpartition(":")[2].partition(".")[0]


def follow_pointers(graph: Graph) -> None:
    """Adds the calls through pointers.  ToolError for one that this file does not know."""
    for name, function in graph.items():
        if not function.through_pointer:
            continue
        pattern = THROUGH_POINTERS.get(simple_name(name))
        if pattern is None:
            raise ToolError(f"{name} calls through a pointer: say whom in reports/stack.py")
        file = name.rpartition(":")[0]
        function.calls |= {
            other for other in graph
            if re.fullmatch(pattern, simple_name(other)) and other.rpartition(":")[0] in ("", file)
        }  # fmt: skip


# ---- The runtime library: its machine code -----------------------------------------------------


MOVED = re.compile(
    r"(?:sub(?:\.w|w)?\s+sp, (?:sp, )?#(\d+)|addi\s+sp,sp,-(\d+)|str\S*\s+\w+, \[sp, #-(\d+)\]!)"
)


def bytes_pushed(instruction: str) -> int:
    """How far an instruction moves the stack pointer down, bytes."""
    words = instruction.split(maxsplit=1)
    name, operands = words[0], words[1] if len(words) > 1 else ""
    if name in ("push", "stmdb", "push.w") and (name != "stmdb" or operands.startswith("sp!")):
        return 4 * count_registers(operands)
    if name == "vpush":
        return count_registers(operands) * (8 if "d" in operands else 4)
    moved = MOVED.match(instruction)
    return int(next(filter(None, moved.groups()))) if moved else 0


def count_registers(operands: str) -> int:
    """Of a list such as {r0, r4-r7, lr}."""
    total = 0
    for item in re.search(r"\{([^}]*)\}", operands)[1].split(","):
        first, _, last = item.strip().partition("-")
        number = [int(re.sub(r"\D", "", end)) for end in (first, last) if last]
        total += number[1] - number[0] + 1 if number else 1
    return total


def read_machine_code(text: str) -> Graph:
    """The functions of a disassembly: all that a function pushes anywhere counts, and each branch
    that leaves it is a call.  Of several with one name the largest frame counts."""
    named: dict[str, list[Function]] = {}
    function = Function(0)
    for line in text.splitlines():
        if start := re.fullmatch(r"[0-9a-f]+ <([^>]+)>:", line):
            function = Function(0)
            named.setdefault(start[1], []).append(function)
            continue
        cells = line.split("\t")
        if len(cells) < 3 or cells[2].startswith("."):
            continue
        instruction = " ".join(cells[2:])
        function.frame += bytes_pushed(instruction)
        if to := BRANCH.fullmatch(instruction.partition("@")[0].strip()):
            function.calls.add(to[1])
    return {
        name: Function(max(f.frame for f in them), set().union(*(f.calls for f in them)) - {name})
        for name, them in named.items()
    }


def add_aliases(graph: Graph, symbols: str) -> None:
    """Adds the other names of a function, of which a disassembly shows one."""
    at: dict[str, list[str]] = {}
    for address, _, name in (line.split() for line in symbols.splitlines() if line[0] != " "):
        at.setdefault(address, []).append(name)
    for names in at.values():
        shown = next((name for name in names if name in graph), None)
        if shown is not None:
            graph.update(dict.fromkeys(names, graph[shown]))


# ---- Bounds ------------------------------------------------------------------------------------


def compile_graph(target: Target, source: Path, to: Path) -> Graph:
    """The functions of a source, which is compiled for a core."""
    environment = os.environ | {"CCACHE_DISABLE": "1"}  # ccache keeps no .ci
    run(*compiler(target, LEVEL), "-fcallgraph-info=su", "-c", source, "-o", to, env=environment)
    return read_compiled(next(to.parent.glob(f"{to.stem}*.ci")).read_text("utf-8"))


def read_graph(target: Target, folder: Path) -> Graph:
    """All functions of the library, compiled for a core, and those of the runtime that it calls."""
    objects = folder / "objects"
    objects.mkdir()
    graph: Graph = {}
    for source in (source for source in SMALL_SOURCES if not source.match("models/*")):
        to = objects / f"{source.parent.name}_{source.stem}.o"
        graph |= compile_graph(target, source, to)
    image = folder / "all.elf"
    run(
        *compiler(target, LEVEL), "-nostartfiles", "-Wl,--entry=edml_lift,--no-gc-sections",
        *(f"-Wl,--defsym=__{place}" for place in ROOMY),
        *objects.glob("*.o"), "-lm", "-o", image,
    )  # fmt: skip
    machine = read_machine_code(run(f"{target.system.cross}objdump", "-d", image))
    add_aliases(machine, run(f"{target.system.cross}nm", image))
    for name, function in graph.items():
        if function.frame == 0 and (code := machine.get(simple_name(name))):
            function.frame = code.frame  # a naked function's, which the compiler does not know
    graph = machine | graph
    for name in {call for function in graph.values() for call in function.calls} - graph.keys():
        if simple_name(name) in machine:  # the compiler folded it into an equal function
            graph[name] = machine[simple_name(name)]
    follow_pointers(graph)
    return graph


def bounds(graph: Graph, names: list[str]) -> dict[str, int]:
    """The most stack of each function, bytes.  ToolError for a circle of calls."""
    on_the_way: list[str] = []

    @cache
    def depth(name: str) -> int:
        if name in on_the_way:
            raise ToolError(f"{name} calls itself: {' -> '.join([*on_the_way, name])}")
        if name not in graph:
            raise ToolError(f"{on_the_way[-1] if on_the_way else 'nobody'} calls {name}, unknown")
        on_the_way.append(name)
        deepest = max(map(depth, graph[name].calls), default=0)
        on_the_way.pop()
        return graph[name].frame + deepest

    return {name: depth(name) for name in names}


def public_functions() -> list[str]:
    """The names that include/ declares, in its order."""
    headers = [ROOT / "include" / "edmlift.h", *sorted((ROOT / "include" / "edmlift").glob("*.h"))]
    declared = r"^[a-z][\w ]*?[ *](edml_\w+)\("
    found = (
        name for path in headers for name in re.findall(declared, path.read_text("utf-8"), re.M)
    )
    return list(dict.fromkeys(found))


def measure_core(target: Target) -> dict[str, int]:
    """Bounds of the public functions on a core, bytes."""
    with tempfile.TemporaryDirectory() as folder:
        graph = read_graph(target, Path(folder))
    return bounds(graph, [name for name in public_functions() if name in graph])


def measure() -> dict[str, dict[str, int]]:
    """The same of every core, by its name."""
    return {target.name: measure_core(target) for target in TARGETS.values()}


# ---- The page ----------------------------------------------------------------------------------


def stack_table(costs: dict[str, dict[str, int]]) -> str:
    """A row a function, a column a core; then the largest of the others."""
    functions = list(next(iter(costs.values())))
    large = [name for name in functions if max(core[name] for core in costs.values()) >= LEAST]
    rows: list[Row] = [[f"`{name}`", *(core[name] for core in costs.values())] for name in large]
    others = set(functions) - set(large)
    rows.append(["all others", *(max(core[n] for n in others) for core in costs.values())])
    return to_table(["stack at most, bytes", *costs], rows)


def read_table(text: str) -> dict[str, dict[str, int]]:
    """The figures of such a table, by core and function."""
    head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")]
                      for line in text.strip().splitlines())  # fmt: skip
    return {
        core: {row[0].strip("`"): int(row[column].replace(",", "")) for row in rows}
        for column, core in enumerate(head[1:], 1)
    }


def check(costs: dict[str, dict[str, int]]) -> None:
    """Raises Disagreement where the page's figures of these cores are others."""
    written = read_table(markdown.read(PAGE, "stack"))
    for core, figures in costs.items():
        for name, figure in figures.items():
            if name in written[core] and written[core][name] != figure:
                raise Disagreement(f"{core}, {name}: written {written[core][name]}, is {figure}")
            if name not in written[core] and figure > written[core]["all others"]:
                raise Disagreement(f"{core}, {name}: not written, is {figure}")


def tables() -> Iterator[Table]:
    """The page's table."""
    costs = measure()
    yield Table(PAGE, "stack", stack_table(costs), partial(check, costs))


def main() -> int:
    return run_report("stack", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
