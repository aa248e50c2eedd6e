"""The library's networks and their rivals on every training person, none of whom they know.

    run.py experiments.folds --train MOTION ... [--folds 6] [--epochs 60] [--out build/people]
                       [--json docs/accuracy/people.json] [--update docs/accuracy-log.md]
                       [--plots docs/accuracy]

The people of the test sets are few, and which network is ahead may depend on who they are.  Here
the people of all motions, .npz files or folders of motion capture, CMU's first, are dealt into
folds; each network is trained on all folds but one, by its own recipe, but with EVEN_NOISE, shorter
and all equally long, and measured on that one.  The library's poses come out of C.

A run goes on where it was cut off: a finished fold is FOLD.json in OUT.
"""

import argparse
import dataclasses
import functools
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from data.mocap import MocapError, Motion, load_motion
from data.paths import DOCS
from data.views import views
from evaluation.baselines import TITLES
from evaluation.measures import Lifter, person_errors
from experiments import rivals
from experiments.runs import finish, library_of
from export.layers import ExportError
from model.manifest import write_manifest
from reports import markdown, plots
from training.recipe import EVEN_NOISE, RECIPES, scale_epochs
from training.run import Run, origin, split

RESULTS = DOCS / "accuracy" / "people.json"
LIBRARY = "edmlift"  # how titles of its networks begin
even = functools.partial(dataclasses.replace, **EVEN_NOISE)  # as all of them were measured
OURS = {f"{LIBRARY}, {kind}": even(RECIPES[kind]) for kind in ("distances", "direct")}
RIVALS = {TITLES[name]: even(rivals.RIVALS[name]) for name in ("mlp40k", "equivariant40k")}
PLOTTED = "gt"  # the column of the picture

Errors = dict[str, dict[str, dict[str, float]]]  # network -> column -> person -> mm


def deal(subject: np.ndarray, folds: int) -> list[list[int]]:
    """People in `folds` hands: dealt in the order of how many poses they have."""
    people, counts = np.unique(subject, return_counts=True)
    if not 2 <= folds <= len(people):
        raise ValueError(f"{folds} folds of {len(people)} people: must be 2 to {len(people)}")
    order = people[np.argsort(-counts, kind="stable")]
    return [sorted(order[k::folds].tolist()) for k in range(folds)]


def lifters(
    rest: list[Motion], held: list[Motion], epochs: int, folder: Path, seed: int
) -> Iterator[tuple[str, Lifter]]:
    """(title, what lifts) of each network, trained on `rest`; `held` is only watched."""
    for title, recipe in OURS.items():
        weights = folder / f"{recipe.network}.npz"
        run = Run(rest, scale_epochs(recipe, epochs), seed)
        yield title, library_of(finish(run, held, weights.with_suffix(".state")), weights)
    for title, recipe in RIVALS.items():
        run = rivals.RivalRun(rest, scale_epochs(recipe, epochs), seed)
        yield title, finish(run, held, folder / f"{recipe.network}.state").settle()


def measure_fold(motions: list[Motion], people: list[int], args: argparse.Namespace) -> Errors:
    """All networks, trained on the others, on these people; or what an earlier run found."""
    folder = args.out / "_".join(map(str, people))
    done = folder.with_suffix(".json")
    about = {"epochs": args.epochs, "seed": args.seed, "data": [m.sha256 for m in motions]}
    if done.exists():
        found = json.loads(done.read_text())
        if found["about"] != about:
            raise ValueError(f"{done}: of another run; remove it to start anew")
        return found["errors"]
    folder.mkdir(parents=True, exist_ok=True)
    rest, held = split(motions, people)
    columns = views(np.concatenate([motion.joints for motion in held]))
    subject = np.concatenate([motion.subject for motion in held])
    errors = {
        title: {name: person_errors(lifter, c, subject) for name, c in columns.items()}
        for title, lifter in lifters(rest, held, args.epochs, folder, args.seed)
    }
    done.write_text(json.dumps({"about": about, "errors": errors}))
    return errors


def merged(folds: list[Errors]) -> Errors:
    """The errors of all people."""
    return {
        title: {name: {p: e for f in folds for p, e in f[title][name].items()} for name in columns}
        for title, columns in folds[0].items()
    }


def report(errors: Errors) -> str:
    """Two tables: means over people; and for how many of them the library is ahead of a rival."""
    ours = [title for title in errors if title.startswith(LIBRARY)]
    columns, count = list(errors[ours[0]]), len(errors[ours[0]][PLOTTED])
    means = {t: [float(np.mean([*row[c].values()])) for c in columns] for t, row in errors.items()}
    ahead = {
        f"{mine} against {title}": [
            sum(e < row[c][p] for p, e in errors[mine][c].items()) for c in columns
        ]
        for mine in ours
        for title, row in errors.items()
        if title not in ours
    }
    first = markdown.table("people held out, mm", columns, means)
    return first + "\n" + markdown.table(f"ahead for, of {count} people", columns, ahead)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--train", type=Path, nargs="+", metavar="MOTION", required=True, help="CMU's first"
    )
    parser.add_argument("--folds", type=int, default=6, help="of the people (%(default)s)")
    parser.add_argument("--epochs", type=int, default=60, help="of each run (%(default)s)")
    parser.add_argument("--out", type=Path, default=Path("build/people"), help="for weights")
    parser.add_argument("--json", type=Path, default=RESULTS, help="for results (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown with marks for the tables")
    parser.add_argument("--plots", type=Path, help="folder for people.png")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def main() -> int:
    args = arguments()
    try:
        motions = [load_motion(path) for path in args.train]
        folds = deal(np.concatenate([motion.subject for motion in motions]), args.folds)
        done = []
        for number, people in enumerate(folds):
            print(f"fold {number + 1} of {len(folds)}: people {people}", file=sys.stderr)
            done.append(measure_fold(motions, people, args))
    except (MocapError, ExportError, ValueError, FloatingPointError, OSError) as error:
        print(f"folds: {error}", file=sys.stderr)
        return 1
    errors = merged(done)
    result = {
        "data": origin(motions, []),
        "folds": folds,
        "epochs": args.epochs,
        "seed": args.seed,
        "errors": errors,
    }
    write_manifest(args.json, result)
    text = report(errors)
    print(text, end="")
    if args.update:
        markdown.write(args.update, "people", text)
    if args.plots:
        plots.save(plots.people(errors, PLOTTED), args.plots / "people.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
