"""What a page loads, and how fast it lifts: bytes and poses a second of each model, as Markdown.

    run.py channels.browser.npm_figures            prints a row a model
    run.py channels.browser.npm_figures --update   writes the table of docs/browser.md

Poses a second are those of Node.js on one core of this machine, by the processor's time; medians.
"""

import gzip
import json
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from channels.browser.npm import MODELS, NPM, PAGE, VARIANTS, write_package
from data.paths import EXAMPLES
from reports import markdown
from reports.command import Table, run_report
from reports.targets import run

NAME = "browser_models"
HEAD = [
    "bytes", "after gzip", "poses a second, one by one", "by `liftMany`", "`liftMany` without SIMD"
]  # fmt: skip


def gzipped(file: Path) -> int:
    """The bytes that a server sends of a file."""
    return len(gzip.compress(file.read_bytes(), 9, mtime=0))


def speeds(folder: Path) -> dict[str, dict[str, int]]:
    """Poses a second by `lift` and by `liftMany` of each file, in hundreds."""
    names = [f"{model}{variant}" for model in MODELS for variant in VARIANTS]
    found = json.loads(run("node", NPM / "speed.mjs", folder, EXAMPLES / "walk.csv", *names))
    return {
        name: {call: round(rate, -2) for call, rate in of.items()} for name, of in found.items()
    }


def tables() -> Iterator[Table]:
    """The page's table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_package(folder)
        rates = speeds(folder)
        rows = {
            f"`{model}`": [
                (folder / f"{model}.wasm").stat().st_size, gzipped(folder / f"{model}.wasm"),
                *rates[model].values(), rates[f"{model}_scalar"]["liftMany"],
            ]
            for model in MODELS
        }  # fmt: skip
    yield Table(PAGE, NAME, markdown.table("model", HEAD, rows, markdown.counted))


def main() -> int:
    return run_report("npm_figures", __doc__, tables, comparable=False)


if __name__ == "__main__":
    sys.exit(main())
