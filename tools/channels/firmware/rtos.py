"""What the examples of ESP-IDF and Zephyr print and take of a chip, as Markdown.

    run.py channels.firmware.rtos             prints it
    run.py channels.firmware.rtos --update    writes it to docs/esp-idf.md and docs/zephyr.md

They are built with what stands for these systems (tests/channels) and run in QEMU.
"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from channels.firmware import esp_idf, zephyr
from channels.firmware.stand_ins import Project
from data.paths import DOCS
from reports import markdown
from reports.command import Table, run_report
from reports.cycles import CYCLES

PAGES = {"esp_idf": DOCS / "esp-idf.md", "zephyr": DOCS / "zephyr.md"}
COLUMNS = ["code, bytes", "weights, bytes", "stack taken, bytes", "instructions a lift", "ms"]


def row(project: Project) -> tuple[str, list[markdown.Figure]]:
    """A chip's title and figures; its milliseconds at 1 to 1.6 cycles an instruction."""
    chip = project.chip
    ms, stack = project.last_line()
    span = "{:.2f} to {:.2f}".format(*(ms * cycles for cycles in CYCLES))
    title = f"{chip.name}, {chip.target.name}, {chip.mhz} MHz"
    return title, [*project.flash(), stack, round(ms * chip.mhz) * 1000, span]


def texts(name: str, projects: list[Project]) -> dict[str, str]:
    """What a system's page has between its marks: the first and last lines that the program prints
    on the first chip, and a table with a row a chip."""
    lines = projects[0].prints.splitlines()
    shown = "\n".join(["```", *lines[:3], "...", *lines[-2:], "```", ""])
    costs = markdown.table("chip", COLUMNS, map(row, projects), markdown.counted)
    return {f"{name}_prints": shown, f"{name}_costs": costs}


def build_projects(folder: Path) -> dict[str, list[Project]]:
    """Both systems' projects, for all chips, built in a folder."""
    component = esp_idf.unpack(esp_idf.build(folder)[0], folder)
    return {
        "esp_idf": [
            esp_idf.build_example(component, folder / chip.core, chip) for chip in esp_idf.CHIPS
        ],
        "zephyr": [zephyr.build_sample(folder / chip.core, chip) for chip in zephyr.CHIPS],
    }


def tables() -> Iterator[Table]:
    """Those of both pages."""
    with tempfile.TemporaryDirectory() as folder:
        for name, projects in build_projects(Path(folder)).items():
            for mark, text in texts(name, projects).items():
                yield Table(PAGES[name], mark, text)


def main() -> int:
    return run_report("rtos", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
