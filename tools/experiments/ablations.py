"""The paper's recipes and the steps from them to ours: trains each, and measures it through C.

    run.py experiments.ablations TRAIN TEST [--recipes NAMES] [--epochs N] [--out build/recipes]
                     [--json docs/accuracy/recipes.json] [--update docs/accuracy.md]

The paper trains by L2 with dropout, on exact 2D, on a detector's or on both (its table 1), with
joints hidden or not (its tables of occlusion).  Both of its networks, as large as they ship; the
weights become C and a library is built of them, so that poses are those a device would compute.
TRAIN and TEST are .npz files or folders that tools/mocap.py reads.  A run goes on where its
checkpoint (NAME.state in OUT) left off.
"""

import argparse
import dataclasses
import functools
import json
import subprocess
import sys
from pathlib import Path

from data.mocap import MocapError, Motion, load_motion
from data.paths import ROOT
from edmlift.library import Library
from evaluation import accuracy
from export import cli
from export.weights import ExportError, manifest_text
from reports import markdown
from training import train

RESULTS = ROOT / "docs" / "accuracy" / "recipes.json"

paper = functools.partial(dataclasses.replace, train.RECIPES["paper"])
l2 = functools.partial(
    dataclasses.replace, train.RECIPES["l2"], network="fconn", complete=False, l2_epochs=500
)
through = functools.partial(l2, l2_epochs=20, mds_epochs=480)
ours = functools.partial(through, blend=True, complete=True, network="twin")
fconv = functools.partial(paper, network="fconv", l2_epochs=30)
detector = {"detector": 1.0, "least": 1.0}  # as noisy as the column cpm, always

# Each row changes the one above it, or the first; those of FConv, the first of them.
RECIPES = {
    "the paper's, exact 2D": paper(),
    "the paper's, detector's noise": paper(iid=0.0, **detector),
    "the paper's, both": paper(**detector),
    "the paper's, both, joints hidden": paper(masks=True, **detector),
    "without dropout": paper(masks=True, dropout=0.0, **detector),
    "our noise, bodies and motion, L2": l2(batch=128),
    "through the MDS": through(batch=128),
    "blended with the image, batches of 64": through(blend=True),
    "missing joints guessed": through(blend=True, complete=True),
    "left and right alike": ours(),
    "in the camera's axes, too": ours(rigid=0.7),
    "missing joints guessed, as long as FConv": through(
        blend=True, complete=True, l2_epochs=5, mds_epochs=25
    ),
    "left and right alike, as long as FConv": ours(l2_epochs=5, mds_epochs=25),
    "FConv: the paper's, exact 2D": fconv(),
    "FConv: the paper's, detector's noise": fconv(iid=0.0, **detector),
    "FConv: the paper's, both": fconv(**detector),
    "FConv: the paper's, both, joints hidden": fconv(masks=True, **detector),
}


def run_recipe(motion: Motion, recipe: train.Recipe, seed: int, weights: Path) -> train.Run:
    """Trains to the last epoch and writes weights and manifest."""
    run = train.Run(motion, recipe, seed)
    state = weights.with_suffix(".state")
    if state.exists():
        run.load_state(state)
    train.train(run, motion, state)
    train.write(run, weights.stem, [], weights)
    # The paper's networks get poses with joints missing, whatever they were trained on.
    manifest = json.loads(weights.with_suffix(".json").read_text())
    manifest["fewest_joints"] = len(accuracy.JOINTS) - train.MAX_MISSING
    manifest["widest"] = train.WIDEST
    weights.with_suffix(".json").write_text(manifest_text(manifest))
    return run


def build(weights: Path, network: str) -> Library:
    """The library with this network as its only model, edml_fconn_trial_f32 or edml_fconv_..."""
    name, folder = f"{network}_trial", weights.with_suffix("")
    folder.mkdir(exist_ok=True)
    header = folder / f"{name}_f32.h"
    if cli.main([str(weights), "--name", name, "--out", str(header)]) != 0:
        raise ExportError(f"{weights}: not exported")
    model = folder / "model.c"
    model.write_text(f'#include "model.h"\n#include "{header.name}"\n')
    shared = folder / "libtrial.so"
    lib = [str(path) for path in sorted((ROOT / "lib").glob("*.c")) if "model_" not in path.name]
    options = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-w"]
    include = [f"-I{ROOT / 'include'}", f"-I{ROOT / 'lib'}"]
    command = ["cc", *options, *include, str(model), *lib, "-lm", "-o", str(shared)]
    subprocess.run(command, check=True, capture_output=True, text=True)
    return Library(f"{name}_f32", shared)


def record(run: train.Run, weights: Path, test: Motion) -> dict:
    """A recipe's entry in the JSON: what it is, and its figures through the library."""
    figures = accuracy.rounded(accuracy.evaluate(build(weights, run.recipe.network), test))
    kept = ("error", "interval", "hidden_joints")
    return {
        "recipe": {"seed": run.seed} | dataclasses.asdict(run.recipe),
        "data": train.origin(run.motion, []),
        "training_people": train.by_column(run.curve),
        "test": {"source": test.source, "poses": len(test.joints), "sha256": test.sha256},
        "figures": {n: {k: c[k] for k in kept if k in c} for n, c in figures.items()},
    }


def report(results: dict[str, dict]) -> str:
    """Two tables, a row a recipe: errors of all joints; and, where some are hidden, of these."""
    figures = {title: entry["figures"] for title, entry in results.items()}
    columns = list(next(iter(figures.values())))
    errors = {title: [row[c]["error"] for c in columns] for title, row in figures.items()}
    some = [c for c in columns if "hidden_joints" in next(iter(figures.values()))[c]]
    hidden = {title: [row[c]["hidden_joints"] for c in some] for title, row in figures.items()}
    first = accuracy.table("all joints, mm", columns, errors)
    return first + "\n" + accuracy.table("hidden joints, mm", some, hidden)


def note(path: Path, entries: dict[str, dict]) -> dict[str, dict]:
    """Puts entries into the JSON; returns all that it then has, in the order of RECIPES."""
    both = (json.loads(path.read_text()) if path.exists() else {}) | entries
    results = {name: both[name] for name in RECIPES if name in both}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(manifest_text(results))
    return results


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("train", type=Path, help="motion to train on")
    parser.add_argument("test", type=Path, help="motion of other people, to measure on")
    parser.add_argument("--recipes", nargs="+", choices=RECIPES, metavar="NAME", default=RECIPES)
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
            weights = args.out / f"{list(RECIPES).index(name)}.npz"
            recipe = train.shorten(RECIPES[name], args.epochs)
            run = run_recipe(motion, recipe, args.seed, weights)
            results = note(args.json, {name: record(run, weights, test)})
    except (MocapError, ExportError, ValueError, FloatingPointError, OSError) as error:
        print(f"ablations: {error}", file=sys.stderr)
        return 1
    except subprocess.CalledProcessError as error:
        print(f"ablations: the library does not build: {error.stderr}", file=sys.stderr)
        return 1
    text = report(results)
    print(text, end="")
    if args.update:
        markdown.write(args.update, "recipes", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
