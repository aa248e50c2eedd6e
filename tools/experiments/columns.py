"""What a network of this size can reach: `direct`, trained for one column of the test alone.

    run.py experiments.columns --train MOTION ... --test MOTION ... [--columns n10 cpm]
                       [--epochs 1000] [--out build/columns]
                       [--json docs/accuracy/columns.json] [--update docs/accuracy-log.md]

Such a network sees the views of its column and no others: as noisy, no joint missing, no camera
near, and up never told.  It is trained on all training people and measured on the test's, beside
the network that ships, which is for all columns.

Poses come out of C.  A run goes on where its checkpoint (in OUT) left off.
"""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from data.mocap import MocapError, Motion, load_motion
from data.paths import DOCS
from data.views import views
from edmlift.library import Library
from evaluation.measures import Figures, chosen, measure, rounded
from experiments.ablations import ABLATIONS, PartRun
from experiments.runs import finish, library_of
from export.layers import ExportError
from model.manifest import write_manifest
from reports import markdown
from training.recipe import scale_epochs
from training.run import origin

RESULTS = DOCS / "accuracy" / "columns.json"
ALONE = "direct: for the column {} alone"  # the name of the recipe
COLUMNS = ("gt", "n10", "cpm")
FIGURES = ("error", "camera_axes")


def figures(library: Library, motions: list[Motion], column: str) -> dict[str, Figures]:
    """Of each motion, in a column."""
    found = {
        motion.source: measure(library, views(motion.joints)[column], motion.subject)
        for motion in motions
    }
    return chosen(rounded(found), FIGURES)


def reach(
    column: str, train: list[Motion], test: list[Motion], args: argparse.Namespace
) -> dict[str, Any]:
    """What the network for a column reaches there, and the one for all columns."""
    weights = args.out / f"direct_{column}.npz"
    recipe = scale_epochs(ABLATIONS[ALONE.format(column)], args.epochs)
    run = finish(PartRun(train, recipe, args.seed), train, weights.with_suffix(".state"))
    return {
        "epochs": args.epochs,
        "seed": args.seed,
        "data": origin(train, []),
        "for this column": figures(library_of(run, weights), test, column),
        "for all columns": figures(Library("direct_f32"), test, column),
    }


def report(results: dict[str, dict]) -> str:
    """A table: a row a column, each motion's errors by the two networks, one of so many epochs."""
    first = next(iter(results.values()))
    names = {"for this column": "alone", "for all columns": "for all"}
    heads, rows = ["epochs"], {column: [entry["epochs"]] for column, entry in results.items()}
    for source in first["for this column"]:
        for figure in FIGURES:
            for key, name in names.items():
                axes = ", camera axes" if figure == "camera_axes" else ""
                heads.append(f"{Path(source).stem}{axes}: {name}")
                for column, entry in results.items():
                    rows[column].append(entry[key][source][figure])
    return markdown.table("mm", heads, rows)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    motion = {"type": Path, "nargs": "+", "metavar": "MOTION", "required": True}
    parser.add_argument("--train", help="motion to train on, CMU's first", **motion)
    parser.add_argument("--test", help="motion of other people", **motion)
    parser.add_argument("--columns", nargs="+", choices=COLUMNS, default=["n10", "cpm"])
    parser.add_argument("--epochs", type=int, default=1000, help="of each run (%(default)s)")
    parser.add_argument("--out", type=Path, default=Path("build/columns"), help="checkpoints")
    parser.add_argument("--json", type=Path, default=RESULTS, help="for results (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown with marks for the table")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def main() -> int:
    args = arguments()
    try:
        train, test = ([load_motion(path) for path in paths] for paths in (args.train, args.test))
        args.out.mkdir(parents=True, exist_ok=True)
        found = json.loads(args.json.read_text()) if args.json.exists() else {}
        for column in args.columns:
            print(column, file=sys.stderr)
            found[column] = reach(column, train, test, args)
            write_manifest(args.json, found)
    except (MocapError, ExportError, ValueError, FloatingPointError, OSError) as error:
        print(f"columns: {error}", file=sys.stderr)
        return 1
    text = report({column: found[column] for column in COLUMNS if column in found})
    print(text, end="")
    if args.update:
        markdown.write(args.update, "columns", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
