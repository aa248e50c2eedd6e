"""edmlift lift, of tables: as much in memory as a batch."""

import argparse
import importlib
import sys
import warnings
from pathlib import Path
from typing import Any

from edmlift.commands.errors import CommandError, OptionError, about_options
from edmlift.commands.inputs import lift_options
from edmlift.tables import TABLE_SUFFIXES

COLUMNS = ("keypoints", "scores", "up", "image", "camera")
TABLES = f"""\
tables: {", ".join(TABLE_SUFFIXES)}, or a folder of these, a person a row.  FILE is such a table,
too: the same rows and columns, and pose, misfit, quality and status (docs/corpora.md)
"""


def add_table_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--column", action="append", default=[], type=_column, metavar="NAME=COLUMN",
        help=f"of a table: which column holds NAME, one of {', '.join(COLUMNS)}; or which columns, "
        "and numbers, as camera=1145,1145,cx,cy",
    )  # fmt: skip
    parser.add_argument(
        "--prefix", metavar="TEXT", help="of a table: before the names of the columns it adds"
    )


def _column(text: str) -> tuple[str, Any]:
    name, _, value = text.partition("=")
    parts = value.split(",")
    if name not in COLUMNS or "" in parts:
        raise argparse.ArgumentTypeError(
            f"must be NAME=COLUMN with NAME of {', '.join(COLUMNS)}, not {text!r}"
        )
    if len(parts) == 1 or name in ("keypoints", "scores"):
        return name, value
    return name, tuple(map(_number_or_name, parts))


def _number_or_name(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def lift_table(options: argparse.Namespace) -> int:
    """Lifts a table into another."""
    columns = dict(options.column)
    _check(options, columns)
    files = importlib.import_module("edmlift.arrow_files")  # others do without what it needs
    with about_options():
        lifter = files.Lifter(**lift_options(options) | columns, prefix=options.prefix or "")
    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.showwarning = lambda text, *_: files.say(f"edmlift: warning: {text}")
        try:
            counts = files.lift_files(Path(options.keypoints), Path(options.out), lifter)
        except files.ArrowException as error:
            raise CommandError(f"{options.keypoints}: {' '.join(str(error).split())}") from None
    statuses = ", ".join(f"{count:,} {status}" for status, count in counts.most_common())
    total = f"{sum(counts.values()):,} rows: {statuses}" if counts else "no rows"
    print(f"edmlift: {options.out}: {total}", file=sys.stderr)
    return 0


def _check(options: argparse.Namespace, columns: dict[str, Any]) -> None:
    """Before the table is opened."""
    if options.out is None or Path(options.out).suffix.lower() not in TABLE_SUFFIXES:
        raise OptionError(
            f"the poses of a table go into a table: -o must end in {', '.join(TABLE_SUFFIXES)}"
        )
    for name in ("fps", "motion", "header", "json"):
        if getattr(options, name):
            raise OptionError(f"--{name} is not for tables")
    for name in columns:
        if name in ("up", "image", "camera") and getattr(options, name) is not None:
            raise OptionError(f"--{name} and --column {name}= both say what {name} is: give one")


def check_no_table_options(options: argparse.Namespace) -> None:
    for name in ("column", "prefix"):
        if getattr(options, name):
            raise OptionError(f"--{name} is for tables, which end in {', '.join(TABLE_SUFFIXES)}")
