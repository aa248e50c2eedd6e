"""What all evaluations have in common as commands: options, how motion is loaded, and errors.

An evaluation is a function from its options to Markdown tables by the names of their marks.
"""

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from data.mocap import Motion, load_motion
from edmlift.library import Library
from export.layers import ExportError
from reports import markdown

QUICK = 20  # every so many poses

SETS = {"cmu14_test": "CMU's people", "labs14_test": "Other laboratories' people"}

Tables = dict[str, str]  # Markdown by the name of its marks
T = TypeVar("T")


def motion_options(parser: argparse.ArgumentParser) -> None:
    """The options of an evaluation on motion capture."""
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--model", default="distances_f32", help="(%(default)s)")
    parser.add_argument("--quick", action="store_true", help=f"every {QUICK}th pose")


def set_options(parser: argparse.ArgumentParser, models: tuple[str, ...]) -> None:
    """The options of an evaluation of models on several sets of people."""
    parser.add_argument("motion", type=Path, nargs="+", help=".npz or folder, a set of people each")
    parser.add_argument("--models", nargs="+", default=models, help="(%(default)s)")
    parser.add_argument("--quick", action="store_true", help=f"every {QUICK}th pose")


@dataclass(frozen=True)
class Evaluation:
    """An evaluation; `about` is its module's docstring, whose first line is its summary."""

    about: str
    tables: Callable[[argparse.Namespace], Tables]
    options: Callable[[argparse.ArgumentParser], None] = motion_options


def load(args: argparse.Namespace) -> tuple[Library, Motion]:
    """The library with the model of the options, and their motion."""
    return Library(args.model), every(load_motion(args.motion), args.quick)


def every(motion: Motion, quick: bool) -> Motion:
    """The motion, or, if it is to be quick, every QUICKth pose of it."""
    return motion.take(np.arange(0, len(motion.joints), QUICK)) if quick else motion


def load_sets(args: argparse.Namespace) -> dict[str, Motion]:
    """The sets of people of the options, by the names of their files: "cmu14_test"."""
    motions = [every(load_motion(path), args.quick) for path in args.motion]
    return {Path(motion.source).stem: motion for motion in motions}


def by_set(text: Callable[[T], str], figures: Mapping[str, T]) -> str:
    """A text for each set of people under its title."""
    return "\n".join(f"**{SETS.get(s, s)}**\n\n{text(found)}" for s, found in figures.items())


def base_model(args: argparse.Namespace) -> str:
    """The model's name without its number format: "distances"."""
    return args.model.removesuffix("_f32")


def parser(evaluations: Mapping[str, Evaluation]) -> argparse.ArgumentParser:
    """One command with a sub-command for each evaluation."""
    whole = argparse.ArgumentParser(
        prog="evaluate", description="Measures the library, and prints tables in Markdown."
    )
    choose = whole.add_subparsers(dest="evaluation", required=True, metavar="EVALUATION")
    for name, evaluation in evaluations.items():
        one = choose.add_parser(
            name,
            help=evaluation.about.partition("\n")[0].rstrip("."),
            description=evaluation.about,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        evaluation.options(one)
        one.add_argument(
            "--update", type=Path, nargs="+", default=[], metavar="PAGE",
            help="Markdown files with marks, in which the tables are replaced",
        )  # fmt: skip
    return whole


def run(evaluations: Mapping[str, Evaluation], arguments: list[str] | None = None) -> int:
    """Exit status 0, or 1 with one line on stderr."""
    args = parser(evaluations).parse_args(arguments)
    try:
        tables = evaluations[args.evaluation].tables(args)
        print("\n\n".join(text.strip("\n") for text in tables.values()))
        for page in args.update:
            markdown.write_those(page, tables)
    except (ExportError, OSError, ValueError) as error:  # a MocapError is a ValueError
        print(f"evaluate {args.evaluation}: {error}", file=sys.stderr)
        return 1
    return 0
