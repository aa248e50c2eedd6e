"""The instructions that no lift exceeds, and the most that were seen, beside the mean, as Markdown.

    run.py reports.worst             prints the table: ten minutes
    run.py reports.worst --update    writes it to docs/costs.md
    run.py reports.worst --check     compares it, within 3 %

The bound is a static one, of implicit path enumeration (Y.-T. S. Li, S. Malik, "Performance
analysis of embedded software using implicit path enumeration", 1995).  The machine code of a
program that does nothing but lift is a graph of blocks.  How often each is run is unknown, but
flows in and out of a block are equal, a function is entered as often as it is called, and a loop
goes on as often as its source says at most (reports/loops.py).  A linear program finds the most
instructions that these allow, whether or not an input takes that way.
"""

import dataclasses
import itertools
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_array

from reports import markdown
from reports.command import Disagreement, Table, run_report
from reports.flow import CALL, JUMP, MAYBE, Block, Function, Instruction, Loop, Program, reachable
from reports.loops import COPIES, LEAVES, Facts, facts_of, usual_facts
from reports.size import BENCH, COSTS, LEVEL, SLACK, options_of, parse
from reports.stack import THROUGH_POINTERS
from reports.targets import SMALL_SOURCES, TARGETS, ToolError, build, compile_library, count

CORES = ("cortex-m4f", "cortex-m3", "cortex-m0plus", "rv32imc", "cortex-m55")
MODELS, VARIANTS = ("distances", "direct"), ("f32", "fixed")
SOURCES = [
    source for source in SMALL_SOURCES
    if source.parent.name in ("lift", "network", "number", "joints")
    or re.fullmatch(r"(distances|direct)_(f32|w16)", source.stem)
]  # fmt: skip
LINES = "-gdwarf-4"  # of which binutils read more than of version 5
FLASH = "0x8000000,0x400000"  # not at 0, where the lines are of what the linker leaves out
WORDS = re.compile(r"\b(for|while) \(|^\} while")
LENGTH = re.compile(r"(?:li|movs?(?:\.w)?) (?:a2|r2), ?#?(\d+)$")  # of a copy
MOST_COPIED = 4 * 91  # bytes: the largest object that a lift copies or clears, a model's distances
Row = dict[int, float]
KnownLoop = tuple[Loop, list[str], Row, Row]  # its lines, its edges back and those into it


@cache
def source_lines(path: str) -> list[str]:
    file = Path(path)
    return file.read_text("utf-8").splitlines() if file.is_file() else []


def texts_of(instructions: list[Instruction]) -> list[str]:
    """The lines that instructions come from, if they begin or end a loop: "file: text"."""
    found = []
    for instruction in instructions:
        path, number = instruction.line or ("", 0)
        lines = source_lines(path)
        text = lines[number - 1].strip() if 0 < number <= len(lines) else ""
        if WORDS.search(text):
            found.append(f"{Path(path).name}: {text}")
    return list(dict.fromkeys(found))


def loop_texts(function: Function, loop: Loop, inner: set[int]) -> list[str]:
    """The lines that may be a loop's: of where it is left, or goes on, or else of all of it.

    inner  blocks of the loops in it
    """
    blocks = function.blocks
    places = [
        [i for at in places for i in blocks[at].instructions[-4:]]
        for places in (loop.exits, loop.back, [loop.head])
    ]
    places.append([i for at in sorted(loop.body - inner) for i in blocks[at].instructions])
    return next(filter(None, map(texts_of, places)), [])


def through_pointers(program: Program) -> dict[int, int]:
    """What functions call through a pointer, in a program with one model."""
    found = {}
    for caller, pattern in THROUGH_POINTERS.items():
        called = [at for name, at in program.symbols.items() if re.fullmatch(pattern, name)]
        if len(called) > 1:
            raise ToolError(f"{caller} calls one of {len(called)} functions")
        if called and caller in program.symbols:
            found[program.symbols[caller]] = called[0]
    return found


def bytes_copied(program: Program, block: Block) -> int:
    """How much the calls of memcpy() and memset() in a block copy: what is loaded before them."""
    total, length = 0, MOST_COPIED
    for instruction in block.instructions:
        if match := LENGTH.match(instruction.text):
            length = int(match[1])
        if instruction.kind not in (CALL, JUMP):
            continue
        if COPIES.fullmatch(f"{program.name(instruction.target)}: 0"):
            total, length = total + length, MOST_COPIED
    return total


def ends_at_its_end(function: Function, loop: Loop, names: list[str]) -> bool:
    """Is the condition behind the body?  Then it goes back once less than the body is run."""
    conditions = [
        at for at in loop.exits
        if any(text in names for text in texts_of(function.blocks[at].instructions[-1:]))
    ]  # fmt: skip
    return (conditions or loop.exits) == loop.back


class Flow:
    """The linear program of all that an entry runs: a column an edge from block to block."""

    def __init__(self, program: Program, entry: str, facts: Facts) -> None:
        self.program, self.facts = program, facts
        self.entry = program.symbols[entry]
        self.functions = reachable(program, self.entry, through_pointers(program))
        self.columns: dict[tuple[int, int, int], int] = {}
        self.cost: Row = {}
        self.equal: list[tuple[Row, float]] = []
        self.most: list[tuple[Row, float]] = []
        self.limits: list[tuple[Function, Loop, int]] = []  # how often a loop goes back at most
        self.turns: dict[str, Row] = {}  # of the loops of a name: their edges back
        self.copied: Row = {}  # bytes, by what calls memcpy() and memset()
        for function in self.functions.values():
            if turns := LEAVES.get(program.name(function.entry)):
                size = sum(len(block.instructions) for block in function.blocks.values())
                self.cost[self.edge(function, -1, function.entry)] = float(turns * size)
            else:
                self.add_flow(function)
                self.add_loops(function)
        self.add_calls()
        self.add_facts()

    def edge(self, function: Function, start: int, to: int) -> int:
        return self.columns.setdefault((function.entry, start, to), len(self.columns))

    def into(self, function: Function, block: int) -> Row:
        """The edges into a block, each once."""
        befores = [*function.before[block], *([-1] if block == function.entry else [])]
        return {self.edge(function, before, block): 1.0 for before in befores}

    def add_flow(self, function: Function) -> None:
        """What comes into a block leaves it, but at a return."""
        for address, block in function.blocks.items():
            into = self.into(function, address)
            self.cost |= dict.fromkeys(into, float(len(block.instructions)))
            if not block.after:
                continue
            out = {self.edge(function, address, to): 1.0 for to in block.after}
            row = add(out, into, -1.0)
            if block.instructions[-1].kind == MAYBE:
                self.most.append((row, 0.0))
            else:
                self.equal.append((row, 0.0))

    def add_calls(self) -> None:
        """A function is entered as often as it is called; the entry once."""
        calls: dict[int, Row] = {at: {} for at in self.functions}
        pointers = through_pointers(self.program)
        for function in self.functions.values():
            if self.program.name(function.entry) in LEAVES:
                continue
            for address, block in function.blocks.items():
                into = self.into(function, address)
                self.copied = add(self.copied, into, float(bytes_copied(self.program, block)))
                there = pointers.get(self.program.entry_of(address))
                for call in block.calls:
                    if (at := there if call is None else call) is None:
                        self.equal.append((into, 0.0))  # what it would call is not linked
                    else:
                        calls[at] = add(calls[at], into, -1.0)
        for at, row in calls.items():
            entry = {self.edge(self.functions[at], -1, at): 1.0}
            self.equal.append((add(entry, row, 1.0), 1.0 if at == self.entry else 0.0))

    def add_loops(self, function: Function) -> None:
        """A loop goes on at most so often each time that it is entered."""
        known: list[KnownLoop] = []
        nameless: Counter[str] = Counter()
        loops = function.loops()
        for loop in loops:
            inner = set().union(*(other.body for other in loops if other.body < loop.body))
            names = loop_texts(function, loop, inner)
            if not names:  # the runtime's or an assembler's: by their order in the function
                symbol = self.program.symbol(loop.head)
                names = [f"{symbol}: {nameless[symbol]}"]
                nameless[symbol] += 1
            back = {self.edge(function, at, loop.head): 1.0 for at in loop.back}
            entries = {k: 1.0 for k in self.into(function, loop.head) if k not in back}
            self.turns.setdefault(names[0], {}).update(back)
            known.append((loop, names, back, entries))
            limits = [self.facts.limit(name) for name in names]
            if None in limits and len(names) > 1:
                raise ToolError(f"which loop is this: {', '.join(names)}?")
            if None not in limits:
                turns = max(limits) - ends_at_its_end(function, loop, names)
                self.most.append((add(back, entries, -float(turns)), 0.0))
                self.limits.append((function, loop, turns))
        self.add_nested(function, known)

    def add_nested(self, function: Function, known: list[KnownLoop]) -> None:
        """How often a loop goes on each time that the loop around it is entered."""
        for inner, names, back, entries in known:
            around = [o for o in known if inner.body < o[0].body]
            if not around or len(names) > 1:
                continue
            _, others, _, outer_entries = min(around, key=lambda o: len(o[0].body))
            sums = [self.facts.together(other, names[0]) for other in others]
            if len(sums) == 1 and sums[0] is not None:
                at_end = ends_at_its_end(function, inner, names)
                bodies = add(back, entries, 1.0) if at_end else back
                self.most.append((add(bodies, outer_entries, -float(sums[0])), 0.0))

    def add_facts(self) -> None:
        for weights, limit in self.facts.totals:
            row: Row = {}
            for begins, weight in weights.items():
                for name, turns in self.turns.items():
                    if name.startswith(begins):
                        row = add(row, turns, float(weight))
            self.most.append((row, float(limit)))
        for name, turns in self.turns.items():
            if COPIES.fullmatch(name):
                self.most.append((add(turns, self.copied, -1.0), 0.0))
        for name in self.facts.never:
            if (at := self.program.symbols.get(name)) in self.functions:
                self.most.append(({self.edge(self.functions[at], -1, at): 1.0}, 0.0))

    def bound(self) -> int:
        """The most instructions, by linear programming."""
        size = len(self.columns)
        cost = np.zeros(size)
        for edge, instructions in self.cost.items():
            cost[edge] = -instructions
        (equal, equals), (most, at_most) = (matrix(r, size) for r in (self.equal, self.most))
        found = linprog(cost, A_ub=most, b_ub=at_most, A_eq=equal, b_eq=equals, method="highs")
        if found.status != 0:
            raise ToolError(f"no bound: {found.message}")
        self.counts = found.x
        return round(-found.fun)


def add(row: Row, other: Row, factor: float) -> Row:
    """row + factor other."""
    return row | {k: row.get(k, 0.0) + factor * value for k, value in other.items()}


def matrix(rows: list[tuple[Row, float]], columns: int) -> tuple[coo_array, np.ndarray]:
    """The rows as a sparse matrix, and the right side."""
    entries = [(n, at, value) for n, (row, _) in enumerate(rows) for at, value in row.items()]
    row, at, value = np.array(entries).reshape(-1, 3).T
    sides = np.array([side for _, side in rows])
    return coo_array((value, (row.astype(int), at.astype(int))), shape=(len(rows), columns)), sides


# ---- The table ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Worst:
    """A row: instructions of a lift."""

    core: str
    model: str
    variant: str
    seen: int  # the most of INPUTS inputs of tests/targets/bench/worst.c
    usual: int  # the bound where the usual way to scale does
    bound: int


def measure_variant(preset: str, model: str, variant: str, library: list[Path]) -> Worst:
    """Builds a lift into the library's folder, reads its flow and runs it."""
    target, image = TARGETS[preset], library[0].with_name("lift.elf")
    far = target if preset == "rv32imc" else dataclasses.replace(target, flash=FLASH)
    options = options_of(model, variant)
    build(
        BENCH / "smallest.c", far, LEVEL, image, *options, LINES, "-nostartfiles",
        "-Wl,--entry=main", library=library,
    )  # fmt: skip
    program, facts = Program(image, target.system.cross), facts_of(model, variant, preset)
    bound, usual = (
        Flow(program, "stage_lift", known).bound() for known in (facts, usual_facts(facts))
    )
    options.append(f"-DCOUNTS_PER_1000={target.counts}")
    build(BENCH / "worst.c", target, LEVEL, image, *options, library=library)
    seen = int(count(image, target).split()[0])
    if seen > bound:
        raise ToolError(f"{target.name}, {model}, {variant}: {seen} seen, above {bound}")
    return Worst(target.name, model, variant, seen, usual, bound)


def measure_core(preset: str) -> list[Worst]:
    """The rows of a core."""
    with tempfile.TemporaryDirectory() as folder:
        library = compile_library(TARGETS[preset], LEVEL, Path(folder), SOURCES, LINES)
        return [
            measure_variant(preset, model, variant, library)
            for model, variant in itertools.product(MODELS, VARIANTS)
        ]


def worst_table(rows: Sequence[Worst]) -> str:
    """With the means of the page's table of costs."""
    means = {(c.core, c.model, c.variant): c.lift for c in parse(markdown.read(COSTS, "costs"))}
    cells = []
    for row in rows:
        mean = means[row.core, row.model, row.variant]
        figures = [mean, row.seen, row.usual, row.bound]
        times = [f"{row.usual / mean:.1f}", f"{row.bound / mean:.1f}"]
        cells.append((row.core, [row.model, row.variant, *figures, *times]))
    heads = ["model", "variant", "mean", "most seen", "usual bound", "bound", "usual / mean",
             "bound / mean"]  # fmt: skip
    return markdown.table("core", heads, cells, markdown.counted, left=3)


def read_table(text: str) -> list[Worst]:
    """The rows of such a table."""
    rows = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines()[2:]]
    return [Worst(*r[:3], *(int(cell.replace(",", "")) for cell in r[4:7])) for r in rows]


def check(rows: Sequence[Worst]) -> None:
    """Raises Disagreement where the page's figures of these are off by more than SLACK."""
    written = {(w.core, w.model, w.variant): w for w in read_table(markdown.read(COSTS, "worst"))}
    for row in rows:
        old = written[row.core, row.model, row.variant]
        pairs = zip(dataclasses.astuple(old)[3:], dataclasses.astuple(row)[3:], strict=True)
        if any(abs(a - b) > SLACK * b for a, b in pairs):
            raise Disagreement(f"written {old}, found {row}")


def tables() -> Iterator[Table]:
    """The page's table."""
    rows = [row for preset in CORES for row in measure_core(preset)]
    yield Table(COSTS, "worst", worst_table(rows), partial(check, rows))


def main() -> int:
    return run_report("worst", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
