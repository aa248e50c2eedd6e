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
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import marks

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted((ROOT / "lib").glob("*.c"))
INCLUDE = [f"-I{ROOT / 'include'}", f"-I{ROOT / 'lib'}"]
FLAGS = "-std=gnu99 -Os -mthumb -ffunction-sections -fdata-sections -ffp-contract=off".split()
FLAGS += "-fno-math-errno --specs=picolibc.specs".split()
LINK = "--oslib=semihost --crt0=semihost -DPICOLIBC_INTEGER_PRINTF_SCANF -Wl,--gc-sections".split()
SLACK = 0.03  # of instructions


@dataclass(frozen=True)
class Core:
    """A core, its compiler flags, and the QEMU board that has one."""

    name: str
    flags: str
    board: str
    flash: int
    ram: int
    mhz: int  # of the board's SysTick


CORES = [
    Core("Cortex-M4F", "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16", "mps2-an386", 0, 0x20000000, 25),
    Core("Cortex-M7", "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16", "mps2-an500", 0, 0x20000000, 25),
    Core(
        "Cortex-M33", "-mcpu=cortex-m33 -mfpu=fpv5-sp-d16", "mps2-an505", 0x10000000, 0x38000000, 20
    ),
]


class ReportError(Exception):
    """What could not be measured or does not agree."""


def run(command: list[str], **options) -> str:
    """Output of a command; ReportError if it cannot be run or fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, **options)
    except FileNotFoundError:
        raise ReportError(f"{command[0]} is not installed; tools/check installs it") from None
    if done.returncode != 0:
        raise ReportError(f"{' '.join(command)}\n{done.stderr.strip()}")
    return done.stdout


def compiler(core: Core) -> list[str]:
    return ["arm-none-eabi-gcc", *FLAGS, *core.flags.split(), "-mfloat-abi=hard", *INCLUDE]


def flash_sizes(core: Core, folder: Path) -> tuple[int, int]:
    """Bytes of code, and of the model, constants included."""
    code = model = 0
    for source in SOURCES:
        target = folder / f"{source.stem}.o"
        run([*compiler(core), "-c", str(source), "-o", str(target)])
        text, data, bss = map(
            int, run(["arm-none-eabi-size", str(target)]).splitlines()[1].split()[:3]
        )
        if data or bss:
            raise ReportError(f"{source.name} has {data} bytes of .data and {bss} of .bss")
        if source.stem.startswith("model_"):
            model += text
        else:
            code += text
    return code, model


def stage_costs(core: Core, folder: Path) -> dict[str, tuple[int, int]]:
    """Instructions and bytes of stack of each stage: mean, and deepest."""
    program = folder / "target.elf"
    memory = {
        "__flash": core.flash,
        "__flash_size": 0x400000,
        "__ram": core.ram,
        "__ram_size": 0x400000,
        "__stack_size": 8192,
    }
    run(
        [
            *compiler(core),
            *LINK,
            f"-DTICK_MHZ={core.mhz}",
            *(f"-Wl,--defsym={name}={value:#x}" for name, value in memory.items()),
            str(ROOT / "tests" / "bench" / "target.c"),
            *map(str, SOURCES),
            "-lm",
            "-o",
            str(program),
        ]
    )
    output = run(
        ["qemu-system-arm", "-M", core.board, "-icount", "shift=7", "-kernel", str(program)]
        + "-display none -monitor none -serial none -chardev stdio,id=s0".split()
        + ["-semihosting-config", "enable=on,target=native,chardev=s0"],
        stdin=subprocess.DEVNULL,
    )
    lines = [line.split() for line in output.splitlines()]
    return {name: (int(count), int(stack)) for name, count, stack in lines}


def work_bytes(core: Core, folder: Path) -> int:
    """sizeof(edml_work), read off an object file."""
    source = folder / "work.c"
    source.write_text('#include "edmlift.h"\nconst char work[sizeof(edml_work)] = {1};\n')
    target = folder / "work.o"
    run([*compiler(core), "-c", str(source), "-o", str(target)])
    listing = run(["arm-none-eabi-nm", "--print-size", "--radix=d", str(target)])
    return int(re.search(r"\d+ (\d+) R work", listing)[1])


def measure(core: Core) -> list[str | int]:
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
    lines += [
        "| " + " | ".join(f"{c:,}" if isinstance(c, int) else c for c in r) + " |" for r in rows
    ]
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


def compare(written: list[list[str | int]], measured: list[list[str | int]]) -> None:
    """Raises ReportError where a figure is not what was measured."""
    wrong = [] if len(written) == len(measured) else ["number of cores"]
    for old, new in zip(written, measured, strict=False):
        for n, (a, b) in enumerate(zip(old, new, strict=True)):
            exact = n < 5
            if a != b and (exact or abs(a - b) > SLACK * b):
                wrong.append(f"{new[0]}, {HEADER[n]}: written {a}, measured {b}")
    if wrong:
        raise ReportError("\n".join(wrong))


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
    except (ReportError, OSError, ValueError) as error:
        print(f"size_report: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
