"""The command line of reports that write tables into pages: they print them, and with --check or
--update compare them with the pages or write them there."""

import argparse
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from reports import markdown
from reports.targets import ToolError


class Disagreement(Exception):
    """Figures that are not what was measured."""


@dataclass(frozen=True)
class Table:
    """What stands between two marks of a page."""

    page: Path
    name: str  # of the marks
    text: str
    compare: Callable[[], None] | None = None  # raises Disagreement; by default the texts are equal

    def check(self) -> None:
        """Raises Disagreement if the page has other figures."""
        if self.compare is not None:
            self.compare()
        elif markdown.read(self.page, self.name) != self.text:
            raise Disagreement(f"{self.page.name}, {self.name}: not what was found")


def run_report(
    report: str,
    description: str | None,
    tables: Callable[[], Iterable[Table]],
    arguments: Sequence[str] | None = None,
    *,
    comparable: bool = True,
) -> int:
    """The exit status of a report of that name: 1 if the tables cannot be made, or disagree.
    Times of one machine are not comparable, and have no --check."""
    parser = argparse.ArgumentParser(
        prog=report, description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--update", action="store_true", help="write the tables into their pages")
    if comparable:
        what.add_argument(
            "--check", action="store_true", help="compare the tables with their pages"
        )
    options = parser.parse_args(arguments)
    try:
        for table in tables():
            print(table.text)
            if comparable and options.check:
                table.check()
            if options.update:
                markdown.write(table.page, table.name, table.text)
    except (Disagreement, ToolError, OSError, ValueError) as error:
        print(f"{report}: {error}", file=sys.stderr)
        return 1
    return 0
