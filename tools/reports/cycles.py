"""Milliseconds of a lift: on an RP2040 by a published model of the chip, on others about.

    run.py reports.cycles             prints both tables
    run.py reports.cycles --check     compares those of docs/costs.md
    run.py reports.cycles --update    writes them

Not part of tools/check: it wants node 18 or later with npm, which installs rp2040js, the emulator
of the Wokwi project, under build/rp2040.  The model knows the cycles of the Cortex-M0+'s
instructions and of the bus.  It takes flash to be as fast as memory, which it is while the chip's
cache has it.  Means over four poses.

No such model is known of the other chips.  Theirs is what the instructions of docs/costs.md take at
1 to 1.6 cycles each: most of a Cortex-M3's or M4's take one cycle, loads and branches one to three
(Arm's technical reference manuals), and the modelled Cortex-M0+ takes 1.4.
"""

import dataclasses
import itertools
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from data.paths import ROOT
from reports import markdown
from reports.command import Table, run_report
from reports.size import BENCH, COSTS, LEVEL, Cost, options_of, parse
from reports.targets import SMALL_SOURCES, TARGETS, ToolError, build, compile_library, run

FILES = Path(__file__).parent / "rp2040"
INSTALLED = ROOT / "build" / "rp2040"
MHZ = 133  # the RP2040's clock, at most
MODELS = ("distances", "direct")
LIFTS = list(itertools.product(MODELS, ("fixed", "w16")))
CYCLES = (1.0, 1.6)  # an instruction
CHIPS = {  # core, variant, MHz
    "STM32F405": ("Cortex-M4F", "w16", 168),
    "nRF52840": ("Cortex-M4F", "w16", 64),
    "STM32F103": ("Cortex-M3", "fixed", 72),
    "ESP32-C3": ("RV32IMC", "fixed", 160),
}
CHIP = dataclasses.replace(
    TARGETS["cortex-m0plus"], name="RP2040", flash="0x10000000,0x200000", ram="0x20000000,0x40000"
)


def install(folder: Path) -> None:
    """Puts rp2040.mjs and the emulator into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in FILES.iterdir():
        shutil.copy(file, folder)
    options = ["--no-audit", "--no-fund", "--no-package-lock", "--silent"]
    try:
        subprocess.run(["npm", "install", *options], cwd=folder, check=True)
    except FileNotFoundError:
        raise ToolError("npm is not installed; tools/check installs it") from None
    except (OSError, subprocess.CalledProcessError) as error:
        raise ToolError(f"npm install: {error}") from None


def measure() -> dict[str, dict[str, int]]:
    """Cycles of each stage that a lift has, and of the lift, by model and variant."""
    found = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        library = compile_library(CHIP, LEVEL, folder, SMALL_SOURCES)
        for model, variant in LIFTS:
            options = [*options_of(model, variant), "-DRP2040", "-DCOUNTS_PER_1000=1000"]
            image = folder / "bench.elf"
            build(BENCH / "target.c", CHIP, LEVEL, image, *options, library=library)
            flash = image.with_suffix(".bin")
            run(f"{CHIP.system.cross}objcopy", "-O", "binary", image, flash)
            lines = run("node", INSTALLED / "rp2040.mjs", flash).splitlines()
            counts = {stage: int(cycles) for stage, cycles, _ in map(str.split, lines)}
            found[f"`{model}`, `{variant}`"] = counts
    return found


def report(found: dict[str, dict[str, int]]) -> str:
    """A row a model and variant."""
    heads = ["frame", "predict", "mds", "align", "fuse", "lift, cycles", f"ms at {MHZ} MHz"]
    rows = {}
    for title, counts in found.items():
        stages = [counts[name] for name in ("frame", "predict", "mds", "align", "fuse", "lift")]
        rows[title] = [*(f"{cycles:,}" for cycles in stages), f"{counts['lift'] / MHZ / 1000:.1f}"]
    return markdown.table("RP2040, modelled", heads, rows)


def about(instructions: int, mhz: int) -> str:
    """Milliseconds, from ... to ..."""
    fewest, most = (instructions / mhz / 1000 * cycles for cycles in CYCLES)
    return f"{fewest:.2f} to {most:.2f}"


def chips_table(costs: list[Cost]) -> str:
    """A row a chip: milliseconds of a lift by either model."""
    lifts = {(cost.core, cost.variant, cost.model): cost.lift for cost in costs}
    rows = {}
    for chip, (core, variant, mhz) in CHIPS.items():
        spans = [about(lifts[core, variant, model], mhz) for model in MODELS]
        rows[f"{chip}, {core}, {mhz} MHz, `{variant}`"] = spans
    return markdown.table("ms, about", [f"`{model}`" for model in MODELS], rows)


def tables() -> Iterator[Table]:
    """Both, in one place of the page."""
    install(INSTALLED)
    modelled = report(measure())
    costs = parse(markdown.read(COSTS, "costs"))
    yield Table(COSTS, "cycles", f"{modelled}\n{chips_table(costs)}")


def main() -> int:
    return run_report("cycles", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
