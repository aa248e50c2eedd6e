"""What a track costs on a microcontroller beside the lift: flash, stack, instructions, as Markdown.

    run.py reports.video            prints a row a core
    run.py reports.video --update   writes the table of docs/video.md
    run.py reports.video --check    compares it: sizes exactly, instructions within 3 %

Compiled and counted as by reports.size.
"""

import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass
from functools import partial
from pathlib import Path

from data.paths import DOCS
from reports import markdown
from reports.command import Disagreement, Table, run_report
from reports.parts import linked_code
from reports.size import BENCH, LEVEL, SLACK, options_of, to_table
from reports.targets import (
    SMALL_SOURCES,
    TARGETS,
    Target,
    build,
    compile_library,
    count,
)

PAGE, NAME = DOCS / "video.md", "video_costs"
MODEL = "direct"
CORES = {  # and the arithmetic that suits each
    "cortex-m0plus": "fixed",
    "cortex-m3": "fixed",
    "cortex-m4f": "w16",
}
HEAD = ["core", "call", "code", "stack", "a lift", "a frame"]
UNITS = ["", "", "bytes", "bytes", "instr.", "instr."]
COUNTED = 4  # the first column of instructions


@dataclass(frozen=True)
class Cost:
    """A row: what edml_track_lift() takes more than the lift; then instructions."""

    core: str
    call: str
    code: int
    stack: int
    lift: int
    frame: int  # the lift in it


def measure(target: Target, variant: str) -> Cost:
    """The costs of a frame on a core."""
    options = options_of(MODEL, variant)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        library = compile_library(target, LEVEL, folder, SMALL_SOURCES)
        lift_code, code = (
            linked_code(program, target, folder, options, library)
            for program in ("smallest.c", "smallest_video.c")
        )
        bench = build(
            BENCH / "video.c", target, LEVEL, folder / "bench.elf", *options,
            f"-DCOUNTS_PER_1000={target.counts}", library=library,
        )  # fmt: skip
        figures = [line.split() for line in count(bench, target).splitlines()]
    (_, lift, lift_stack), (_, frame, frame_stack) = figures
    call = f"`edml_track_lift{'_q' if variant == 'fixed' else ''}`"
    stack = int(frame_stack) - int(lift_stack)
    return Cost(target.name, call, code - lift_code, stack, int(lift), int(frame))


def table(costs: list[Cost]) -> str:
    """The table of docs/video.md."""
    return to_table(HEAD, [[*UNITS], *(list(astuple(cost)) for cost in costs)])


def check(costs: list[Cost]) -> None:
    """Raises Disagreement where a figure on the page is not what was measured."""
    rows = markdown.read(PAGE, NAME).strip().splitlines()[3:]
    if len(rows) != len(costs):
        raise Disagreement("number of rows")
    for row, cost in zip(rows, costs, strict=True):
        cells = [cell.strip().replace(",", "") for cell in row.strip("|").split("|")]
        for n, (old, new) in enumerate(zip(cells, astuple(cost), strict=True)):
            near = n >= COUNTED and abs(int(old) - new) <= SLACK * new
            if old != str(new) and not near:
                raise Disagreement(f"{cost.core}, {HEAD[n]}: written {old}, measured {new}")


def tables() -> Iterator[Table]:
    """The page's table."""
    costs = [measure(TARGETS[core], variant) for core, variant in CORES.items()]
    yield Table(PAGE, NAME, table(costs), partial(check, costs))


def main(arguments: Sequence[str] | None = None) -> int:
    return run_report("video", __doc__, tables, arguments)


if __name__ == "__main__":
    sys.exit(main())
