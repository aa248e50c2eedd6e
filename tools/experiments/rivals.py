"""Trains the rivals that go from 2D joints straight to 3D joints, and measures them.

    run.py experiments.rivals --train MOTION ... --test MOTION ... [--rivals NAMES] [--epochs N]
                       [--out build/rivals] [--json docs/accuracy/rivals.json]
    run.py experiments.rivals --train MOTION ... --trials --update docs/accuracy-log.md

They get what the library's networks get: the same people, cameras, noise, missing joints, bodies,
losses, and averaging of weights.  Motion is an .npz file or a folder of motion capture, CMU's
first.  The figures go into the JSON from which `evaluate.py accuracy` takes their rows.

With --trials, small changes are tried on people of the training motion who are held out.
A run goes on where its checkpoint (NAME.state in OUT) left off; a finished one is measured.
"""

import argparse
import dataclasses
import functools
import json
import sys
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from data import cameras
from data.mocap import MocapError, Motion, load_motion
from edmlift.library import Poses
from evaluation.baselines import TRAINED
from evaluation.measures import chosen, evaluate, rounded
from experiments.runs import HELD_OUT, finish, in_blocks
from model import coordinates, equivariant, jax_stages, lifter
from model.manifest import write_manifest
from reports import markdown
from training.loss import Loss, Params, mean_errors, pose_errors, validate
from training.recipe import EVEN_NOISE, RECIPES, Recipe
from training.run import Run, by_column, origin, split
from training.views import Views, draw_2d, imputation_of, pick_poses

# What a rival is: fully connected, the same in residual blocks (Martinez et al.), or left and right
# alike, as the library's network `direct` is.
NETWORKS = ("plain", "residual", "equivariant")

# The recipe of `direct`, but for what is in the lift around it, at the best rate of TRIALS.
rival = functools.partial(dataclasses.replace, RECIPES["direct"], up=0.0, fuse=False)
plain = functools.partial(rival, network="plain", hidden=(121,) * 3)
alike = functools.partial(rival, network="equivariant", hidden=(90,) * 3)

RIVALS = {
    "mlp40k": plain(pose_epochs=300, rate=3e-3),
    "equivariant40k": alike(pose_epochs=600),
    "martinez": rival(
        network="residual",
        hidden=(1024,) * 5,
        adam=True,  # of such matrices a step of Muon takes seconds
        straightened=0.0,
        pose_epochs=24,
        batch=1024,
        rate=1e-3,
        average=0.99,
        **EVEN_NOISE,
    ),
}

# What rate is best on HELD_OUT people, and whether the noise of RECIPES is, at that rate.
TRIALS = {
    f"{name}, rate {rate}": make(pose_epochs=60, rate=rate, **EVEN_NOISE)
    for name, make in (("40 K", plain), ("left and right alike", alike))
    for rate in (0.75e-3, 1.5e-3, 3e-3)
} | {
    f"{name}, weak noise more often, fewer mixed limbs": dataclasses.replace(
        RIVALS[rival_of], pose_epochs=60
    )
    for name, rival_of in (("40 K", "mlp40k"), ("left and right alike", "equivariant40k"))
}
TRIED = ("gt", "gt_camera", "n10", "cpm", "left_leg")  # columns of their table
UP_INPUTS = 4  # of `direct`, for up
SETTLE = 8192  # training views by which inputs are standardised, and batches normalised


def upright(recipe: Recipe, keypoints: jax.Array) -> jax_stages.Image:
    """What rivals see: the image upright as it is, missing joints imputed."""
    return jax_stages.body_frame(keypoints, imputation_of(recipe), upright=True)


def nowhere(keypoints: jax.Array) -> jax.Array:
    """For lifter.run(): up is not known."""
    return jnp.zeros((len(keypoints), 3))


def poses(
    recipe: Recipe,
    params: Params,
    keypoints: jax.Array,
    statistics: coordinates.Statistics | None = None,
    key: jax.Array | None = None,
) -> tuple[jax.Array, coordinates.Statistics]:
    """Centred poses [B,14,3], camera axes, of keypoints [B,14,3]; and statistics of normalisation.

    These are measured on the keypoints where they are not given.
    """
    image = upright(recipe, keypoints)
    if recipe.network == "equivariant":  # neither its gates nor up are used
        return lifter.run("direct", params["layers"], image, nowhere(keypoints)).points, []
    residual = recipe.network == "residual"
    x = coordinates.inputs(image)
    return coordinates.forward(params["layers"], x, residual, statistics, key, recipe.dropout)


predict = jax.jit(poses, static_argnums=0)


def parameters(recipe: Recipe, layers: Any) -> int:
    """How many a rival has that matter."""
    if recipe.network != "equivariant":
        return coordinates.count(layers)
    layout = lifter.layout("direct")
    used = jnp.arange(len(layout.has_even)) < 3 * lifter.ROWS
    layout = layout._replace(has_even=layout.has_even & used, has_odd=layout.has_odd & used)
    ones = {name: jnp.ones_like(layers[name]) for name in layers if name[-1].isdigit()}
    count = sum(int(array.sum()) for array in equivariant.masked(ones, layout).values())
    return count - UP_INPUTS * recipe.hidden[0]


class RivalRun(Run):
    """A rival's training."""

    def losses(self) -> tuple[Loss, Loss]:
        def loss(params: Params, batch: Views, key: jax.Array) -> tuple[jax.Array, Params]:
            points, _ = poses(self.recipe, params, batch.keypoints, None, key)
            return pose_errors(self.recipe, points, batch.truth), {}

        return loss, loss

    def start(self) -> Params:
        recipe, joints = self.recipe, self.motions[0].joints
        if recipe.network == "equivariant":
            keypoints = self.some_views()
            image = upright(recipe, keypoints)
            inputs = np.concatenate(lifter.inputs("direct", image, nowhere(keypoints)), 1)
            return {"layers": lifter.init("direct", recipe.hidden, joints, inputs, self.seed)}
        truth = cameras.look(joints, np.random.default_rng(self.seed))
        mean = (truth - truth.mean(1, keepdims=True)).mean(0)
        widths = (coordinates.INPUTS, *recipe.hidden, coordinates.OUTPUTS)
        residual = recipe.network == "residual"
        return {"layers": coordinates.init(widths, mean, residual, self.seed)}

    def some_views(self) -> jax.Array:
        """Keypoints [F,14,3] of training views."""
        rng = np.random.default_rng([self.seed, 1 << 31])
        joints = pick_poses(self.motions, self.recipe, rng)[:SETTLE]
        return jnp.asarray(draw_2d(joints, self.recipe, rng).keypoints)

    def settle(self) -> "Rival":
        """The averaged weights, normalised by what they make of training views: exact, because
        running averages would belong to other weights."""
        _, statistics = predict(self.recipe, self.params, self.some_views())
        return Rival(self.recipe, self.params, statistics)

    def validate(self, columns: dict[str, Views], subject: np.ndarray) -> dict[str, float]:
        return validate(self.settle().errors, columns, subject)

    def describe(self) -> str:
        """What a checkpoint must be of: also the motion."""
        return json.dumps({"recipe": super().describe(), "motion": origin(self.motions, [])})


@dataclasses.dataclass(frozen=True)
class Rival:
    """A trained rival, ready to lift as the library does.  It answers every pose."""

    recipe: Recipe
    params: Params
    statistics: coordinates.Statistics

    def lift(self, keypoints: np.ndarray) -> Poses:
        """keypoints [F,14,3] -> poses in camera axes, metres, about mid-hip."""
        return in_blocks(self._points, keypoints)

    def _points(self, keypoints: jax.Array) -> jax.Array:
        return predict(self.recipe, self.params, keypoints, self.statistics)[0]

    def errors(self, views: Views) -> tuple[jax.Array, jax.Array]:
        """As loss.block_errors() has them."""
        points = self._points(jnp.asarray(views.keypoints))
        return mean_errors(points, jnp.asarray(views.truth), mirror=False)


def about(run: RivalRun, held_out: list[int]) -> dict[str, Any]:
    """What a rival is, for the JSON."""
    return {
        "parameters": parameters(run.recipe, run.params["layers"]),
        "recipe": {"seed": run.seed} | dataclasses.asdict(run.recipe),
        "data": origin(run.motions, held_out),
    }


def measured(run: RivalRun, tests: list[Motion]) -> list[dict[str, Any]]:
    """Its figures on each of the motions."""
    lifter = run.settle()
    figures = [rounded(evaluate(lifter, test)) for test in tests]
    kept = ("error", "interval", "camera_axes", "mirror_right_percent", "hidden_joints")
    return [
        {
            "source": test.source,
            "poses": len(test.joints),
            "sha256": test.sha256,
            "figures": chosen(found, kept),
        }
        for test, found in zip(tests, figures, strict=True)
    ]


def trials_table(trials: dict[str, dict]) -> str:
    """The table of trials: errors on the people held out."""
    columns = [
        name
        for name in next(iter(trials.values()))["validation"]
        if name.rpartition(" ")[2] in TRIED
    ]
    rows = {
        title: [
            f"{row['parameters']:,}",
            row["recipe"]["pose_epochs"],
            *(row["validation"][c] for c in columns),
        ]
        for title, row in trials.items()
    }
    heads = [name.replace("_camera", ", camera axes") for name in columns]
    return markdown.table("mm, held-out people", ["parameters", "epochs", *heads], rows)


def record(path: Path, section: str, entries: dict[str, dict]) -> dict[str, dict]:
    """Puts entries into a section of the JSON; returns the section, in the order of this file."""
    results = json.loads(path.read_text()) if path.exists() else {}
    known = RIVALS if section == "rivals" else TRIALS
    both = results.get(section, {}) | entries
    results[section] = {name: both[name] for name in known if name in both}
    write_manifest(path, results)
    return results[section]


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    motion = {"type": Path, "nargs": "+", "metavar": "MOTION"}
    parser.add_argument("--train", required=True, help="to train on, CMU's first", **motion)
    parser.add_argument("--test", default=[], help="other people, to measure on", **motion)
    parser.add_argument("--rivals", nargs="+", choices=RIVALS, metavar="NAME", default=list(RIVALS))
    parser.add_argument("--trials", action="store_true", help="the trials instead of the rivals")
    parser.add_argument("--epochs", type=int, help="at most so many, instead of the recipes'")
    parser.add_argument("--out", type=Path, default=Path("build/rivals"), help="for checkpoints")
    parser.add_argument("--json", type=Path, default=TRAINED, help="for results (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown with marks for the trials' table")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def run_all(args: argparse.Namespace) -> None:
    """Trains, and records each as it is finished."""
    tests = [load_motion(path) for path in args.test]
    section, held_out = ("trials", HELD_OUT) if args.trials else ("rivals", [])
    motions, held = split([load_motion(path) for path in args.train], held_out)
    recipes = TRIALS if args.trials else {name: RIVALS[name] for name in args.rivals}
    args.out.mkdir(parents=True, exist_ok=True)
    for name, recipe in recipes.items():
        print(name, file=sys.stderr)
        epochs = min(recipe.epochs, args.epochs or recipe.epochs)
        recipe = dataclasses.replace(recipe, pose_epochs=epochs)
        run = finish(RivalRun(motions, recipe, args.seed), held, args.out / f"{name}.state")
        entry = about(run, held_out)
        if args.trials:
            entry["validation"] = run.curve[run.epochs]
        else:  # mm; of people who were trained on
            entry |= {"training_people": by_column(run.curve), "tests": measured(run, tests)}
        entries = record(args.json, section, {name: entry})
    if args.trials:
        print(trials_table(entries), end="")
        if args.update:
            markdown.write(args.update, "trials", trials_table(entries))


def main() -> int:
    args = arguments()
    try:
        run_all(args)
    except (MocapError, ValueError, FloatingPointError, OSError) as error:
        print(f"rivals: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
