"""What optional parts cost beside a lift: code that they add, stack and instructions, as Markdown.

    run.py reports.parts             prints the tables
    run.py reports.parts --update    writes them to the parts' pages
    run.py reports.parts --check     compares them: sizes exactly, instructions within 3 %

Measured as reports.size measures a lift, with `direct`.
"""

import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from data.paths import DOCS
from reports import markdown
from reports.command import Disagreement, Table, run_report
from reports.size import BENCH, LEVEL, SLACK, Row, flash_sizes, options_of, to_table
from reports.targets import (
    SMALL_SOURCES,
    TARGETS,
    Target,
    build,
    compile_library,
    count,
)

MODEL = "direct"
CORES = {"cortex-m4f": ("w16", "fixed"), "cortex-m0plus": ("w16", "fixed")}  # and variants
CALLS = {"w16": "", "fixed": "_q"}  # what the part's name ends in
PARTS = {  # pages, by the name of the part's stage in tests/targets/bench, which is its call's
    "angles": "angles.md",
    "measure_body": "body.md",
    "path_follow": "where-in-the-room.md",
}
HEAD = ["core", "call", "code, bytes", "stack, bytes", "instructions"]


@dataclass(frozen=True)
class PartCost:
    """A row of a part's table."""

    core: str
    call: str
    code: int  # bytes that a program which lifts grows by
    stack: int
    instructions: int


def measure(part: str) -> list[PartCost]:
    """The rows of a part."""
    costs = []
    for name, variants in CORES.items():
        with tempfile.TemporaryDirectory() as folder:
            library = compile_library(TARGETS[name], LEVEL, Path(folder), SMALL_SOURCES)
            costs += [
                _measure_variant(TARGETS[name], part, variant, Path(folder), library)
                for variant in variants
            ]
    return costs


def _measure_variant(
    target: Target, part: str, variant: str, folder: Path, library: list[Path]
) -> PartCost:
    options = options_of(MODEL, variant)
    lift, with_part = (
        linked_code("smallest.c", target, folder, [*options, *more], library)
        for more in ([], [f"-DPART=stage_{part}"])
    )
    bench = build(
        BENCH / "target.c", target, LEVEL, folder / "bench.elf", *options,
        f"-DCOUNTS_PER_1000={target.counts}", library=library,
    )  # fmt: skip
    lines = {line.split()[0]: line.split()[1:] for line in count(bench, target).splitlines()}
    instructions, stack = (int(number) for number in lines[part])
    call = f"`edml_{part}{CALLS[variant]}`"
    return PartCost(target.name, call, with_part - lift, stack, instructions)


def linked_code(
    program: str, target: Target, folder: Path, options: list[str], library: list[Path]
) -> int:
    """Bytes of code that a program of tests/targets/bench links."""
    link_map = folder / "map"
    build(
        BENCH / program, target, LEVEL, folder / "smallest.elf", *options, "-nostartfiles",
        f"-Wl,--entry=main,-Map={link_map}", library=library,
    )  # fmt: skip
    return flash_sizes(link_map.read_text())["code"]


def part_table(costs: list[PartCost]) -> str:
    """A row a core and call."""
    rows: list[Row] = [[c.core, c.call, c.code, c.stack, c.instructions] for c in costs]
    return to_table(HEAD, rows)


def check(part: str, costs: list[PartCost]) -> None:
    """Raises Disagreement where the page's figures are not these."""
    rows = markdown.read(DOCS / PARTS[part], f"{part}_costs").strip().splitlines()[2:]
    for row, cost in zip(rows, costs, strict=True):
        _, _, *cells = (cell.strip().replace(",", "") for cell in row.strip("|").split("|"))
        code, stack, instructions = map(int, cells)
        near = abs(instructions - cost.instructions) <= SLACK * cost.instructions
        if (code, stack) != (cost.code, cost.stack) or not near:
            raise Disagreement(f"{PARTS[part]}, {cost.core}: written {row}, measured {cost}")


def tables() -> Iterator[Table]:
    """A table of each part, on its page."""
    for part, page in PARTS.items():
        costs = measure(part)
        yield Table(DOCS / page, f"{part}_costs", part_table(costs), partial(check, part, costs))


def main() -> int:
    return run_report("parts", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
