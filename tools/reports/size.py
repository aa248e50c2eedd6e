"""What a lift costs on a microcontroller: flash, RAM, stack and instructions, as Markdown.

    run.py reports.size                 prints a row a core, model and variant
    run.py reports.size --core NAME     only this core's (a preset of CMakePresets.json);
                                        --model NAME: and this model's
    run.py reports.size --update        writes the tables of README.md and docs/costs.md
    run.py reports.size --check         compares them: sizes exactly, instructions within 3 %

Everything is compiled by gcc -Os with picolibc and run by QEMU, which counts instructions (not
cycles) exactly.  Flash is what a program links that does nothing but lift.
"""

import argparse
import dataclasses
import itertools
import re
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from data.paths import DOCS, GEN, ROOT
from model.manifest import read_manifest
from reports import markdown
from reports.command import Disagreement
from reports.targets import (
    SMALL_SOURCES,
    SOURCES,
    TARGETS,
    Target,
    ToolError,
    build,
    compile_library,
    count,
    object_name,
    run,
)

BENCH = ROOT / "tests" / "targets" / "bench"
README, COSTS = ROOT / "README.md", DOCS / "costs.md"
LEVEL = "-Os"
SLACK = 0.03  # of instructions
MODELS = ("distances", "direct", "fconn")
VARIANTS = {"f32": "f32", "w16": "w16", "w8": "w8", "fixed": "w16"}  # the weights of each
FCONV = {  # a table of its own: a lift is 20 million instructions and more
    ("cortex-m4f", "f32"): ["-DMODEL=edml_fconv_f32", "-DFCONV"],
    ("cortex-m4f", "w8"): ["-DMODEL=edml_fconv_w8", "-DFCONV"],
    ("cortex-m3", "fixed w8"): ["-DMODEL=edml_fconv_w8", "-DFCONV", "-DFIXED"],
}
FCONV_COLUMNS = ("core", "variant", "code", "weights", "work", "stack", "network", "lift")
SUMMARY = [  # the chip; core, model and variant of the figures
    ("FPU, such as Cortex-M4F, M7, M33, M55", "Cortex-M4F", "direct", "w16"),
    ("FPU, little flash", "Cortex-M4F", "direct", "w8"),
    ("FPU, float weights wanted", "Cortex-M4F", "direct", "f32"),
    ("FPU, distances wanted as well", "Cortex-M4F", "distances", "w16"),
    ("no FPU, such as Cortex-M3", "Cortex-M3", "direct", "fixed"),
    ("no FPU, small: Cortex-M0+", "Cortex-M0+", "direct", "fixed"),
]
# Instructions that a multiplication takes at least where several go at a time: its share of the
# product's, and of a load of weights (four words at a time, or a vector); where two of 8 bits have
# to be widened, also of that.
FLOORS = {
    ("Cortex-M4F", "w16"): 1 / 2 + 1 / 8,
    ("Cortex-M4F", "w8"): 1 / 2 + 1 / 2 + 1 / 16,
    ("Cortex-M55", "w16"): 1 / 8 + 1 / 8,
    ("Cortex-M55", "w8"): 1 / 8 + 1 / 8,
}
METRICS = {"f32": "metrics", "w16": "metrics_w16", "w8": "metrics_w8"}  # errors in the manifest


@dataclass(frozen=True)
class Cost:
    """A row of docs/costs.md: bytes of flash, RAM and stack, then instructions of the stages."""

    core: str
    model: str
    variant: str
    code: int  # with the helpers
    helpers: int  # of the compiler and its libraries: what the processor has no instruction for
    weights: int
    work: int
    stack: int  # of the lift, the deepest
    place_stack: int  # of edml_place, which is no part of the lift
    impute: int  # `frame` of a pose without knees and ankles
    frame: int
    inputs: int  # of the network, and what is made of its outputs
    network: int
    mds: int
    align: int
    orient: int
    mirror: int
    fuse: int
    lift: int
    place: int


COLUMNS = [field.name for field in dataclasses.fields(Cost)]
EXACT = COLUMNS[: COLUMNS.index("impute")]
TITLES = ["core", "model", "variant"]


def flash_sizes(link_map: str) -> dict[str, int]:
    """Bytes of code, helpers and weights by the linker's map of tests/targets/bench/smallest.c."""
    library = {object_name(source) for source in SOURCES}
    sizes = {"code": 0, "helpers": 0, "weights": 0}
    placed = link_map.partition("\nLinker script and memory map\n")[2]
    section = r"^ \.(?:text|s?rodata)\S*\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S+)$"
    for size, file in re.findall(section, placed, re.M):
        if re.search(r"/lib(gcc|m|c)\.a\(", file):
            sizes["helpers"] += int(size, 16)
            sizes["code"] += int(size, 16)
        elif (name := file.rpartition("(")[2].rstrip(")")) in library:
            model = name.startswith("models_")
            sizes["weights" if model else "code"] += int(size, 16)
    return sizes


def options_of(model: str, variant: str) -> list[str]:
    """What tests/targets/bench is compiled with."""
    fixed = ["-DFIXED"] if variant == "fixed" else []
    return [f"-DMODEL=edml_{model}_{VARIANTS[variant]}", *fixed]


def measure_variant(
    target: Target, title: tuple[str, str], options: list[str], library: list[Path], folder: Path
) -> Cost:
    """The costs of one lift on a core, by a model in a variant."""
    link_map = folder / "map"
    smallest = build(
        BENCH / "smallest.c", target, LEVEL, folder / "smallest.elf", *options, "-nostartfiles",
        f"-Wl,--entry=main,-Map={link_map}", library=library,
    )  # fmt: skip
    symbols = run(f"{target.system.cross}nm", "--print-size", "--radix=d", smallest)
    work = int(re.search(r"\d+ (\d+) b work\n", symbols)[1])
    bench = build(
        BENCH / "target.c", target, LEVEL, folder / "bench.elf", *options,
        f"-DCOUNTS_PER_1000={target.counts}", library=library,
    )  # fmt: skip
    lines = [line.split() for line in count(bench, target).splitlines()]
    counts = {name: int(instructions) for name, instructions, _ in lines}
    counts["inputs"] = counts["predict"] - counts["network"]
    stages = {name: number for name, number in counts.items() if name in COLUMNS}
    deepest = {name: int(stack) for name, _, stack in lines}
    stacks = {"stack": deepest["lift"], "place_stack": deepest["place"]}
    return Cost(
        target.name, *title, work=work, **stacks, **flash_sizes(link_map.read_text()), **stages
    )


def measure_core(target: Target, models: Sequence[str] = MODELS) -> list[Cost]:
    """The rows of a core."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        library = compile_library(target, LEVEL, folder, SMALL_SOURCES)
        return [
            measure_variant(target, title, options_of(*title), library, folder)
            for title in itertools.product(models, VARIANTS)
        ]


def measure() -> list[Cost]:
    """All rows, two cores at a time."""
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(measure_core, TARGETS.values()))
    return [cost for costs in results for cost in costs]


def measure_fconv() -> list[Cost]:
    """The rows of the other table.  An instruction takes less time than in the first, so that the
    counter of 24 bits lasts."""
    costs = []
    for (name, variant), options in FCONV.items():
        target = TARGETS[name]
        target = dataclasses.replace(target, system=dataclasses.replace(target.system, icount=1))
        with tempfile.TemporaryDirectory() as folder:
            library = compile_library(target, LEVEL, Path(folder))
            title = "fconv", variant
            costs.append(measure_variant(target, title, options, library, Path(folder)))
    return costs


# ---- Tables ----------------------------------------------------------------------------------


Row = list[str | int]


def to_table(head: list[str], rows: Iterable[Row]) -> str:
    """A table whose first column has the titles, and whose integers have commas."""
    titled = [(str(row[0]), row[1:]) for row in rows]
    return markdown.table(head[0], head[1:], titled, markdown.counted).rstrip("\n")


def full_table(costs: list[Cost]) -> str:
    """The table of docs/costs.md."""
    sizes, counts = len(EXACT) - len(TITLES), len(COLUMNS) - len(EXACT)
    units = [*[""] * len(TITLES), *["bytes"] * sizes, *["instr."] * counts]
    return to_table(COLUMNS, [units, *(list(dataclasses.astuple(cost)) for cost in costs)])


def fconv_table(costs: list[Cost]) -> str:
    """The table of FConv."""
    units = ["", "", *["bytes"] * 4, *["instr."] * 2]
    rows = [[getattr(cost, name) for name in FCONV_COLUMNS] for cost in costs]
    return to_table(list(FCONV_COLUMNS), [units, *rows])


def parse(text: str) -> list[Cost]:
    """The rows of a full table."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
    return [
        Cost(core, model, variant, *(int(cell.replace(",", "")) for cell in cells))
        for core, model, variant, *cells in rows
        if variant in VARIANTS
    ]


def short_tables(costs: list[Cost]) -> str:
    """Those of all models, each below its name."""
    by_model = {model: [cost for cost in costs if cost.model == model] for model in MODELS}
    return "\n\n".join(f"`{model}`:\n\n{short_table(of)}" for model, of in by_model.items() if of)


def short_table(costs: list[Cost]) -> str:
    """A row a core: code, and thousands of instructions a lift, of each variant of a model; then
    memory."""
    of = {(cost.core, cost.variant): cost for cost in costs}
    head, units = [""], [""]
    for variant in VARIANTS:
        head += [f"`{variant}`", ""]
        units += ["code, bytes", "a lift"]
    rows: list[Row] = [units]
    for core in dict.fromkeys(cost.core for cost in costs):
        row: Row = [core]
        for variant in VARIANTS:
            row += [of[core, variant].code, f"{of[core, variant].lift / 1000:,.0f} k"]
        rows.append(row)
    for label, name in (
        ("weights, bytes", "weights"), ("work memory, bytes", "work"), ("stack, at most", "stack")
    ):  # fmt: skip
        most = [max(getattr(c, name) for c in costs if c.variant == v) for v in VARIANTS]
        rows.append([label, *(x for size in most for x in (size, ""))])
    return to_table(head, rows)


def summary_table(costs: list[Cost]) -> str:
    """The README's first table: a few rows, and the errors noted in the models' manifests."""
    of = {(cost.core, cost.model, cost.variant): cost for cost in costs}
    rows: list[Row] = []
    for chip, core, model, variant in SUMMARY:
        cost, form = of[core, model, variant], VARIANTS[variant]
        metrics = read_manifest(model).get(METRICS[form], {})
        rows.append([
            chip, f"`edml_lift{'_q' if variant == 'fixed' else ''}`", f"`edml_{model}_{form}`",
            f"{cost.code:,} + {cost.weights:,} of weights",
            f"{cost.work:,} + {cost.stack} of stack",
            cost.lift,
            *(f"{metrics[view]} mm" if metrics else "" for view in ("gt", "cpm", "rand2")),
        ])  # fmt: skip
    head = [
        "your chip", "call", "model", "flash, bytes", "RAM, bytes", "instructions a lift",
        "error, exact 2D", "a detector's 2D", "two joints missing",
    ]  # fmt: skip
    return to_table(head, rows)


def floor_table(costs: list[Cost]) -> str:
    """The networks of which no zero is left out, beside what their multiplications take."""
    of = {(cost.core, cost.variant, cost.model): cost.network for cost in costs}
    rows: list[Row] = []
    for (core, variant), least in FLOORS.items():
        for model in MODELS:
            with np.load(GEN / f"{model}.npz") as arrays:
                products = sum(arrays[n].size for n in arrays if n.startswith("weight"))
            network, floor = of[core, variant, model], round(products * least)
            rows.append([core, variant, model, products, floor, network, f"{network / floor:.2f}"])
    heads = ["core", "variant", "model", "multiplications", "floor", "network", "times the floor"]
    return to_table(heads, rows)


def compare(written: list[Cost], measured: list[Cost]) -> None:
    """Raises Disagreement where a figure is not what was measured."""
    wrong = [] if len(written) == len(measured) else ["number of rows"]
    for old, new in zip(written, measured, strict=False):
        for name in COLUMNS:
            a, b = getattr(old, name), getattr(new, name)
            if a != b and (name in EXACT or abs(a - b) > SLACK * b):
                title = f"{new.core}, {new.model}, {new.variant}, {name}"
                wrong.append(f"{title}: written {a}, measured {b}")
    if wrong:
        raise Disagreement("\n".join(wrong))


def check(measured: list[Cost]) -> None:
    """Compares the tables: the rows of these cores with what was measured, and the other tables
    with the full one."""
    written = parse(markdown.read(COSTS, "costs"))
    cores = {cost.core for cost in measured}
    compare([cost for cost in written if cost.core in cores], measured)
    for page, name, table in (
        (COSTS, "size_report", short_tables), (COSTS, "floor", floor_table),
        (README, "summary", summary_table),
    ):  # fmt: skip
        if markdown.read(page, name).strip() != table(written):
            raise Disagreement(f"{page.name}, {name}: not that of docs/costs.md, costs")


def check_fconv(measured: list[Cost]) -> None:
    """Compares the table of FConv: sizes exactly, instructions within SLACK."""
    rows = markdown.read(COSTS, "fconv_costs").strip().splitlines()[3:]
    for row, cost in zip(rows, measured, strict=True):
        for name, cell in zip(FCONV_COLUMNS, row.strip("|").split("|"), strict=True):
            old, new = cell.strip().replace(",", ""), getattr(cost, name)
            exact = name not in ("network", "lift")
            if old != str(new) and (exact or abs(int(old) - new) > SLACK * new):
                raise Disagreement(f"FConv, {cost.core}, {name}: written {old}, measured {new}")


def update(measured: list[Cost]) -> None:
    """Writes the tables of both pages."""
    markdown.write(COSTS, "costs", full_table(measured))
    markdown.write(COSTS, "size_report", short_tables(measured))
    markdown.write(COSTS, "floor", floor_table(measured))
    markdown.write(README, "summary", summary_table(measured))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--core", choices=TARGETS)
    what.add_argument("--update", action="store_true")
    what.add_argument("--check", action="store_true")
    parser.add_argument("--model", choices=MODELS, help="of a --core")
    args = parser.parse_args()
    try:
        if args.core:
            models = [args.model] if args.model else MODELS
            print(full_table(measure_core(TARGETS[args.core], models)))
            return 0
        costs = measure()
        print(full_table(costs))
        fconv = measure_fconv()
        print(fconv_table(fconv))
        if args.check:
            check(costs)
            check_fconv(fconv)
        if args.update:
            update(costs)
            markdown.write(COSTS, "fconv_costs", fconv_table(fconv))
    except (Disagreement, ToolError, OSError, ValueError) as error:
        print(f"size: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
