"""What the library as one file takes: bytes of text, and of flash beside the library, as Markdown.

    run.py channels.amalgamation.one_file_sizes             prints the table of docs/one-file.md
    run.py channels.amalgamation.one_file_sizes --update    writes it

Flash is what a program links that does nothing but lift, code and weights, by gcc -Os.
"""

import re
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from channels.amalgamation.amalgamate import amalgamate, choose
from data.paths import DOCS
from reports.command import Table, run_report
from reports.size import BENCH, LEVEL, Row, to_table
from reports.targets import TARGETS, Target, build, compile_library, run

CORE = "cortex-m4f"
CHOICES = [
    ("direct_w8", ["float"]),
    ("direct_w16", ["float"]),
    ("direct_w16", ["fixed"]),
    ("direct_w16", ["all"]),
]
HEAD = ["models and parts", "text, bytes", "flash, bytes", "as many files", "more"]


@dataclass(frozen=True)
class Size:
    """A row of the table."""

    choice: str
    text: int  # of edmlift.c
    flash: int
    many: int  # flash where the program is linked with the library as many files

    @property
    def more(self) -> float:
        """Per cent of flash beyond that."""
        return 100 * (self.flash - self.many) / self.many


def linked_bytes(image: Path, target: Target) -> int:
    """Code and constants of an image."""
    listed = run(f"{target.system.cross}size", "-A", image)
    return sum(int(size) for size in re.findall(r"^\.(?:text|rodata)\s+(\d+)", listed, re.M))


def measure(model: str, parts: Sequence[str]) -> Size:
    """A choice on the core, beside the same sources as files of their own."""
    target = TARGETS[CORE]
    options = [f"-DMODEL=edml_{model}", "-nostartfiles", "-Wl,--entry=main"]
    options += ["-DFIXED"] if "float" not in parts and "all" not in parts else []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        amalgamate([model], parts, folder)
        sources = [source.path for source in choose([model], parts).sources()]
        many = compile_library(target, LEVEL, folder, sources)
        one, as_many = (
            linked_bytes(
                build(
                    BENCH / "smallest.c", target, LEVEL, folder / "image", *options, library=files
                ),
                target,
            )
            for files in ([folder / "edmlift.c"], many)
        )
        text = (folder / "edmlift.c").stat().st_size
    return Size(f"`{model} --parts {' '.join(parts)}`", text, one, as_many)


def size_table(sizes: Sequence[Size]) -> str:
    rows: list[Row] = [[s.choice, s.text, s.flash, s.many, f"{s.more:.1f} %"] for s in sizes]
    return to_table(HEAD, rows)


def tables() -> Iterator[Table]:
    """The page's table."""
    yield Table(
        DOCS / "one-file.md", "one_file", size_table([measure(*choice) for choice in CHOICES])
    )


def main() -> int:
    return run_report("one_file_sizes", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
