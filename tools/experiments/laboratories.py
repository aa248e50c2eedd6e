"""What a stranger's laboratory gets: networks trained without one, and measured on its people.

    run.py experiments.laboratories --train MOTION ... --test MOTION ... [--networks direct]
                       [--epochs 200] [--out build/laboratories]
                       [--json docs/accuracy/laboratories.json] [--update docs/accuracy-log.md]

People are a laboratory's by their numbers.  They are measured on those of the test motion; where
it has none of the laboratory, on its training people, whom only the network without them does not
know.  Beside it stands a network that is trained on all, in the same way and as long.

Poses come out of C.  A run goes on where its checkpoint (in OUT) left off.
"""

import argparse
import dataclasses
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from data.mocap import MocapError, Motion, load_motion
from data.paths import DOCS
from data.views import views
from edmlift.library import Library
from evaluation.measures import Figures, chosen, measure, rounded
from experiments.runs import finish, library_of
from export.layers import ExportError
from model.layout import KINDS
from model.manifest import write_manifest
from reports import markdown
from training.recipe import EVEN_NOISE, RECIPES, scale_epochs
from training.run import Run, origin

RESULTS = DOCS / "accuracy" / "laboratories.json"
# Numbers of the people; CMU's own captures are those below a thousand.
LABORATORIES = {"CMU": range(1000), "UI-PRMD": range(5001, 5101), "ACCAD": range(5101, 5201)}
COLUMNS = ("gt", "n10", "cpm", "left_leg")
FIGURES = ("error", "camera_axes", "mirror_right_percent")


def without(motions: list[Motion], people: range) -> list[Motion]:
    """Motion of all others."""
    rest = [motion.take(~np.isin(motion.subject, people)) for motion in motions]
    return [motion for motion in rest if len(motion.joints)]


def whom(people: range, train: list[Motion], test: list[Motion]) -> Motion:
    """Motion of a laboratory: that of the test, or where it has none of the training."""
    for motion in (*test, *reversed(train)):
        chosen = np.isin(motion.subject, people)
        if chosen.any():
            return motion.take(chosen)
    raise MocapError(f"no subject of {people.start} to {people.stop - 1}")


def figures(library: Library, motion: Motion) -> dict[str, Figures]:
    """Some figures in some of the columns."""
    columns = views(motion.joints)
    found = {name: measure(library, columns[name], motion.subject) for name in COLUMNS}
    return chosen(rounded(found), FIGURES)


def report(results: dict[str, dict]) -> str:
    """A table: for each network and laboratory, without it and with it."""
    heads = [f"{name}{more}" for name in COLUMNS for more in ("", ", camera axes")]
    rows = {}
    for network, laboratories in results.items():
        for laboratory, entry in laboratories.items():
            for how, columns in entry["figures"].items():
                row = [columns[c][key] for c in COLUMNS for key in FIGURES[:2]]
                row.append(columns["gt"]["mirror_right_percent"])
                rows[f"{network}: {laboratory}, {how}"] = row
    return markdown.table("mm", [*heads, "mirror right, %"], rows)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    motion = {"type": Path, "nargs": "+", "metavar": "MOTION", "required": True}
    parser.add_argument("--train", help="motion to train on, CMU's first", **motion)
    parser.add_argument("--test", help="motion of other people", **motion)
    parser.add_argument("--networks", nargs="+", choices=KINDS, default=["direct"])
    parser.add_argument("--epochs", type=int, default=200, help="of each run (%(default)s)")
    parser.add_argument("--out", type=Path, default=Path("build/laboratories"), help="checkpoints")
    parser.add_argument("--json", type=Path, default=RESULTS, help="for results (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown with marks for the table")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def compare(kind: str, args: argparse.Namespace) -> dict[str, Any]:
    """Of a kind of network, {laboratory: what it was measured on, and the figures}."""
    train, test = ([load_motion(path) for path in paths] for paths in (args.train, args.test))
    recipe = dataclasses.replace(scale_epochs(RECIPES[kind], args.epochs), **EVEN_NOISE)
    args.out.mkdir(parents=True, exist_ok=True)

    def network(motions: list[Motion], name: str) -> Library:
        print(f"{kind}, {name}", file=sys.stderr)
        weights = args.out / f"{kind}_{name}.npz"
        run = finish(Run(motions, recipe, args.seed), motions, weights.with_suffix(".state"))
        return library_of(run, weights)

    everyone, results = network(train, "everyone"), {}
    for laboratory, people in LABORATORIES.items():
        rest, measured = without(train, people), whom(people, train, test)
        known = np.isin(measured.subject, np.concatenate([m.subject for m in train])).any()
        both = {"left out": network(rest, f"without_{laboratory}")}
        both["these people in training" if known else "others of it in training"] = everyone
        results[laboratory] = {
            "epochs": args.epochs,
            "seed": args.seed,
            "data": origin(rest, []),
            "test": {"source": measured.source, "poses": len(measured.joints)},
            "figures": {how: figures(library, measured) for how, library in both.items()},
        }
    return results


def main() -> int:
    args = arguments()
    try:
        for kind in args.networks:
            found = json.loads(args.json.read_text()) if args.json.exists() else {}
            found[kind] = compare(kind, args)
            write_manifest(args.json, found)
    except (MocapError, ExportError, ValueError, FloatingPointError, OSError) as error:
        print(f"laboratories: {error}", file=sys.stderr)
        return 1
    text = report(found)
    print(text, end="")
    if args.update:
        markdown.write(args.update, "laboratories", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
