"""What a lift costs on a microcontroller: flash, RAM, stack and instructions, as Markdown.

    size_report.py                      prints the table
    size_report.py --update README.md   writes it between the marks in a file
    size_report.py --check README.md    compares: sizes exactly, instructions within 3 %

Everything is compiled by arm-none-eabi-gcc -Os with picolibc and run by qemu-system-arm, which
counts instructions (not cycles) exactly.  Code is that of all of lib/, before a linker drops what
a program does not use.
"""

import argparse
import json
import re
import sys
import tempfile
from pathlib import Path

import marks
from firmware import CROSS, ROOT, SOURCES, TARGETS, Target, ToolError, build, compiler, emulate, run

CORES = [TARGETS["cortex-m4f"], TARGETS["cortex-m7"], TARGETS["cortex-m33"]]
LEVEL = "-Os"
SLACK = 0.03  # of instructions


def flash_sizes(core: Target, folder: Path) -> tuple[int, int]:
    """Bytes of code, and of the model, constants included."""
    code = model = 0
    for source in SOURCES:
        item = folder / f"{source.stem}.o"
        run(*compiler(core, LEVEL), "-c", source, "-o", item)
        size = int(run(f"{CROSS}size", item).splitlines()[1].split()[0])
        if source.stem.startswith("model_"):
            model += size
        else:
            code += size
    return code, model


def stage_costs(core: Target, folder: Path) -> dict[str, tuple[int, int]]:
    """Instructions (mean) and bytes of stack (deepest) of each stage."""
    image = build(ROOT / "tests" / "bench" / "target.c", core, LEVEL, folder, stack=8192)
    lines = [line.split() for line in emulate(image, core, "-icount", "shift=7").splitlines()]
    return {name: (int(count), int(stack)) for name, count, stack in lines}


def work_bytes(core: Target, folder: Path) -> int:
    """sizeof(edml_work), read off an object file."""
    source = folder / "work.c"
    source.write_text('#include "edmlift.h"\nconst char work[sizeof(edml_work)] = {1};\n')
    item = folder / "work.o"
    run(*compiler(core, LEVEL), "-c", source, "-o", item)
    listing = run(f"{CROSS}nm", "--print-size", "--radix=d", item)
    return int(re.search(r"\d+ (\d+) R work", listing)[1])


def measure(core: Target) -> list[str | int]:
    """A row of the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        code, model = flash_sizes(core, folder)
        costs = stage_costs(core, folder)
        work = work_bytes(core, folder)
    stages = [costs[s][0] for s in ("edm", "net", "mds", "mirror", "orient", "lift")]
    stack = max(stack for _, stack in costs.values())
    return [core.name, code, model, work, stack, *stages]


HEADER = "core|code|weights|work|stack|edm|network|MDS|mirror|orient|**a lift**".split("|")
UNITS = "|bytes|bytes|bytes|bytes".split("|") + ["instr."] * 6


def table(rows: list[list[str | int]]) -> str:
    lines = ["| " + " | ".join(HEADER) + " |", "|---" + "|--:" * (len(HEADER) - 1) + "|"]
    lines.append("| " + " | ".join(UNITS) + " |")
    for row in rows:
        cells = [f"{cell:,}" if isinstance(cell, int) else cell for cell in row]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def summary(rows: list[list[str | int]]) -> str:
    """The README's first table: one core, and the errors noted in the model's manifest."""
    core, code, model, work, stack, *_, lift = rows[0]
    error = json.loads((ROOT / "gen" / "fconn.json").read_text())["metrics"]
    lines = [
        f"| {core} | flash | RAM | a lift | error, exact 2D | detector's 2D | two joints missing |",
        "|---|--:|--:|--:|--:|--:|--:|",
        f"| `edml_fconn_f32` | {code:,} bytes + {model:,} of weights "
        f"| {work:,} bytes + {stack} of stack | {lift:,} instructions "
        f"| {error['gt']} mm | {error['cpm']} mm | {error['rand2']} mm |",
    ]
    return "\n".join(lines)


def parse(text: str) -> list[list[str | int]]:
    """The rows of a table between the marks."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in text.splitlines()
        if line.startswith("| Cortex")
    ]
    return [[row[0], *(int(cell.replace(",", "")) for cell in row[1:])] for row in rows]


class Disagreement(Exception):
    """Figures that are not what was measured."""


def compare(written: list[list[str | int]], measured: list[list[str | int]]) -> None:
    """Raises Disagreement where a figure is not what was measured."""
    wrong = [] if len(written) == len(measured) else ["number of cores"]
    for old, new in zip(written, measured, strict=False):
        for n, (a, b) in enumerate(zip(old, new, strict=True)):
            exact = n < 5
            if a != b and (exact or abs(a - b) > SLACK * b):
                wrong.append(f"{new[0]}, {HEADER[n]}: written {a}, measured {b}")
    if wrong:
        raise Disagreement("\n".join(wrong))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--update", type=Path, metavar="FILE")
    parser.add_argument("--check", type=Path, metavar="FILE")
    args = parser.parse_args()
    try:
        rows = [measure(core) for core in CORES]
        print(table(rows))
        if args.check:
            compare(parse(marks.read(args.check, "size_report")), rows)
        if args.update:
            marks.write(args.update, "size_report", table(rows))
            marks.write(args.update, "summary", summary(rows))
    except (Disagreement, ToolError, OSError, ValueError) as error:
        print(f"size_report: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
