"""The paper's recipes and the steps from them to ours: trains each, and measures it through C.

    run.py experiments.ablations TRAIN TEST [--recipes NAMES] [--epochs N] [--out build/recipes]
                     [--json docs/accuracy/recipes.json] [--update docs/accuracy-log.md]

The paper trains by L2 with dropout, on exact 2D, on a detector's or on both (its table 1), with
joints hidden or not (its tables of occlusion).  Both of its networks are as large as they ship; the
weights become C and a library is built of them, so that poses are those a device would compute.
TRAIN and TEST are .npz files or folders of motion capture.  A run goes on where its
checkpoint (NAME.state in OUT) left off.
"""

import argparse
import dataclasses
import functools
import json
import sys
from pathlib import Path
from typing import Any

from data.mocap import MocapError, Motion, load_motion
from data.paths import DOCS
from edmlift.joints import JOINTS
from evaluation.measures import chosen, evaluate, rounded
from export.build import build_library
from export.layers import ExportError
from model.manifest import write_manifest
from reports import markdown
from training.manifest import MAX_ASPECT, write
from training.recipe import MAX_MISSING, RECIPES, Recipe, scale_epochs
from training.run import Run, by_column, origin, train

RESULTS = DOCS / "accuracy" / "recipes.json"

paper = functools.partial(dataclasses.replace, RECIPES["paper"])
l2 = functools.partial(
    dataclasses.replace, RECIPES["l2"], network="fconn", impute=False, l2_epochs=500
)
through = functools.partial(l2, l2_epochs=20, mds_epochs=480)
ours = functools.partial(through, fuse=True, impute=True, network="equivariant")
fconv = functools.partial(paper, network="fconv", l2_epochs=30)
detector = {"detector": 1.0, "least": 1.0}  # as noisy as the column cpm, always

# Each row changes the one above it, or the first; those of FConv, the first of them.
ABLATIONS = {
    "the paper's, exact 2D": paper(),
    "the paper's, detector's noise": paper(iid=0.0, **detector),
    "the paper's, both": paper(**detector),
    "the paper's, both, joints hidden": paper(masks=True, **detector),
    "without dropout": paper(masks=True, dropout=0.0, **detector),
    "our noise, bodies and motion, L2": l2(batch=128),
    "through the MDS": through(batch=128),
    "fused with the image, batches of 64": through(fuse=True),
    "missing joints imputed": through(fuse=True, impute=True),
    "left and right alike": ours(),
    "in the camera's axes as well": ours(rigid=0.7),
    "missing joints imputed, as long as FConv": through(
        fuse=True, impute=True, l2_epochs=5, mds_epochs=25
    ),
    "left and right alike, as long as FConv": ours(l2_epochs=5, mds_epochs=25),
    "FConv: the paper's, exact 2D": fconv(),
    "FConv: the paper's, detector's noise": fconv(iid=0.0, **detector),
    "FConv: the paper's, both": fconv(**detector),
    "FConv: the paper's, both, joints hidden": fconv(masks=True, **detector),
}


def run_recipe(motion: Motion, recipe: Recipe, seed: int, weights: Path) -> Run:
    """Trains to the last epoch and writes weights and manifest."""
    run = Run(motion, recipe, seed)
    state = weights.with_suffix(".state")
    if state.exists():
        run.load_state(state)
    train(run, motion, state)
    write(run, weights.stem, [], weights)
    # The paper's networks get poses with joints missing, whatever they were trained on.
    manifest = json.loads(weights.with_suffix(".json").read_text())
    manifest["fewest_joints"] = len(JOINTS) - MAX_MISSING
    manifest["max_aspect"] = MAX_ASPECT
    write_manifest(weights.with_suffix(".json"), manifest)
    return run


def entry(run: Run, weights: Path, test: Motion) -> dict[str, Any]:
    """A recipe's entry in the JSON: what it is, and its figures through the library."""
    library = build_library(weights, weights.with_suffix(""))
    figures = rounded(evaluate(library, test))
    return {
        "recipe": {"seed": run.seed} | dataclasses.asdict(run.recipe),
        "data": origin(run.motion, []),
        "training_people": by_column(run.curve),
        "test": {"source": test.source, "poses": len(test.joints), "sha256": test.sha256},
        "figures": chosen(figures, ("error", "interval", "hidden_joints")),
    }


def report(results: dict[str, dict]) -> str:
    """Two tables, a row a recipe: errors of all joints; and, where some are hidden, of these."""
    figures = {title: entry["figures"] for title, entry in results.items()}
    columns = list(next(iter(figures.values())))
    errors = {title: [row[c]["error"] for c in columns] for title, row in figures.items()}
    some = [c for c in columns if "hidden_joints" in next(iter(figures.values()))[c]]
    hidden = {title: [row[c]["hidden_joints"] for c in some] for title, row in figures.items()}
    first = markdown.table("all joints, mm", columns, errors)
    return first + "\n" + markdown.table("hidden joints, mm", some, hidden)


def record(path: Path, entries: dict[str, dict]) -> dict[str, dict]:
    """Puts entries into the JSON; returns all that it then has, in the order of ABLATIONS."""
    both = (json.loads(path.read_text()) if path.exists() else {}) | entries
    results = {name: both[name] for name in ABLATIONS if name in both}
    write_manifest(path, results)
    return results


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("train", type=Path, help="motion to train on")
    parser.add_argument("test", type=Path, help="motion of other people, to measure on")
    parser.add_argument(
        "--recipes", nargs="+", choices=ABLATIONS, metavar="NAME", default=list(ABLATIONS)
    )
    parser.add_argument("--epochs", type=int, help="instead of the recipes'")
    parser.add_argument("--out", type=Path, default=Path("build/recipes"), help="for weights")
    parser.add_argument("--json", type=Path, default=RESULTS, help="for results (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown with marks for the table")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def main() -> int:
    args = arguments()
    try:
        motion, test = load_motion(args.train), load_motion(args.test)
        args.out.mkdir(parents=True, exist_ok=True)
        for name in args.recipes:
            print(name, file=sys.stderr)
            weights = args.out / f"{list(ABLATIONS).index(name)}.npz"
            recipe = scale_epochs(ABLATIONS[name], args.epochs)
            run = run_recipe(motion, recipe, args.seed, weights)
            results = record(args.json, {name: entry(run, weights, test)})
    except (MocapError, ExportError, ValueError, FloatingPointError, OSError) as error:
        print(f"ablations: {error}", file=sys.stderr)
        return 1
    text = report(results)
    print(text, end="")
    if args.update:
        markdown.write(args.update, "recipes", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
