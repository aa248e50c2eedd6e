"""Trains the rivals that go from 2D joints straight to 3D joints, and measures them.

    run.py experiments.rivals TRAIN TEST [--rivals NAMES] [--epochs N] [--out build/rivals]
    run.py experiments.rivals TRAIN TEST --trials --update docs/accuracy-log.md

Bodies, cameras, noise, missing joints and the balance of subjects are those of tools/training/; one
drawn epoch feeds all networks.  TRAIN and TEST are .npz files or folders of motion capture.  The
figures go into the JSON from which `evaluate.py accuracy` takes their rows.

With --trials, small changes are tried on people of TRAIN who are held out; TEST is not looked at.
A run goes on where its checkpoint (NAME.state in OUT) left off; a finished one is measured.
"""

import argparse
import dataclasses
import functools
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from tqdm import tqdm

from data import cameras
from data.mocap import MocapError, Motion, load_motion
from edmlift.joints import JOINTS, mid_hip
from edmlift.library import Poses
from edmlift.metrics import rigid_errors
from evaluation.baselines import TRAINED
from evaluation.measures import by_subject, chosen, evaluate, rounded
from model import coordinates, jax_stages
from model.manifest import write_manifest
from reports import markdown
from training.loss import Loss, Params
from training.recipe import RECIPES, Recipe
from training.run import Run, every_nth, origin, split
from training.views import Views, draw_2d, imputation_of, pick_poses, validation_set


@dataclasses.dataclass(frozen=True)
class RivalRecipe(Recipe):
    """How a rival is trained; `mds_epochs` are all of its epochs."""

    hidden: tuple[int, ...] = (128, 128)
    residual: bool = False  # batch normalisation, and a skip around each two layers
    mask: bool = False  # which joints are seen is input as well

    def recorded(self, seed: int) -> dict:
        """What decides the weights, for the JSON."""
        fields = dataclasses.asdict(self)
        fields["epochs"] = fields.pop("mds_epochs")
        unused = ("network", "l2_epochs", "distance_weight")
        return {"seed": seed} | {k: v for k, v in fields.items() if k not in unused}


def recipe(**changes: Any) -> RivalRecipe:
    """FConn's recipe, but for the changes; the phase of L2 on distances has no counterpart."""
    base = RECIPES["mds"]
    fields = dataclasses.asdict(base) | {"l2_epochs": 0, "distance_weight": 0.0, "fuse": False}
    fields |= {"rigid": 0.8, "impute": False}
    fields["mds_epochs"] = base.l2_epochs + base.mds_epochs
    return RivalRecipe(**fields | changes)


martinez = functools.partial(
    recipe, hidden=(1024,) * 5, residual=True, mds_epochs=150, batch=1024, average=0.99
)

RIVALS = {  # what was best of TRIALS
    "mlp40k": recipe(hidden=(121,) * 3, mask=True, rate=3e-3, batch=128),
    "mlp40k_guess": recipe(hidden=(121,) * 3, mask=True, rate=3e-3, batch=128, impute=True),
    "mlp40k_blend": recipe(hidden=(121,) * 3, mask=True, rate=3e-3, fuse=True),
    "mlp25k": recipe(hidden=(128, 128), rate=3e-3, batch=128),
    "martinez": martinez(mask=True),
}

# On HELD_OUT people: what the loss is measured on, what tells missing joints, depth, rate, dropout.
HELD_OUT = [3, 13, 91, 127]
small = functools.partial(recipe, hidden=(167, 167), rigid=1.0, mds_epochs=100, batch=128)
large = functools.partial(martinez, rigid=1.0, mask=True, mds_epochs=8)
TRIALS = {
    "40 K, camera axes": small(rigid=0.0),
    "40 K, half aligned": small(rigid=0.5),
    "40 K, 0.8 aligned": small(rigid=0.8),
    "40 K, aligned": small(),
    "40 K, aligned, mask": small(hidden=(162,) * 2, mask=True),
    "40 K, aligned, three layers": small(hidden=(124,) * 3),
    "40 K, aligned, rate 0.003": small(rate=3e-3),
    "40 K, aligned, mask, three layers": small(hidden=(120,) * 3, mask=True),
    "40 K, aligned, mask, rate 0.003": small(hidden=(162,) * 2, mask=True, rate=3e-3),
    "40 K, aligned, all three": small(hidden=(120,) * 3, mask=True, rate=3e-3),
    "40 K, 0.8 aligned, all three": small(hidden=(120,) * 3, mask=True, rate=3e-3, rigid=0.8),
    "the same, missing joints imputed": small(
        hidden=(120,) * 3, mask=True, rate=3e-3, rigid=0.8, impute=True
    ),
    "4.3 M, no dropout": large(),
    "4.3 M, dropout 0.1": large(dropout=0.1),
    "4.3 M, dropout 0.5": large(dropout=0.5),
}
CURVE = 20  # points of the validation curve
SAMPLE = 6000  # poses to validate on, about
SETTLE = 8192  # training views by which batch normalisation is fixed


def fused(points: jax.Array, keypoints: jax.Array, params: Params) -> jax.Array:
    """Poses [B,14,3] moved to the image, if the parameters say how; about their mean."""
    if "fusion" not in params:
        return points
    points = jax_stages.fuse(points, keypoints, params["fusion"])
    return points - points.mean(1, keepdims=True)


def rival_loss(recipe: RivalRecipe) -> Loss:
    """Mean joint error, metres; no parameter is observed instead of trained."""
    imputation = imputation_of(recipe)

    def loss(
        params: Params, keypoints: jax.Array, truth: jax.Array, key: jax.Array
    ) -> tuple[jax.Array, Params]:
        x = coordinates.inputs(keypoints, recipe.mask, imputation)
        layers = params["layers"]
        points, _ = coordinates.forward(layers, x, recipe.residual, None, key, recipe.dropout)
        points = fused(points, keypoints, params)
        value = 0.0
        if recipe.rigid > 0:
            value += recipe.rigid * jax_stages.joint_errors(points, truth, mirror=False).mean()
        if recipe.rigid < 1:
            value += (1 - recipe.rigid) * coordinates.camera_errors(points, truth).mean()
        return value, {}

    return loss


@functools.partial(jax.jit, static_argnames="recipe")
def predict(
    params: Params,
    statistics: coordinates.Statistics | None,
    keypoints: jax.Array,
    recipe: RivalRecipe,
) -> tuple[jax.Array, coordinates.Statistics]:
    """Centred poses [B,14,3] of keypoints [B,14,3]; and the statistics of normalisation.

    These are measured on the keypoints where they are not given.
    """
    x = coordinates.inputs(keypoints, recipe.mask, imputation_of(recipe))
    points, used = coordinates.forward(params["layers"], x, recipe.residual, statistics)
    return fused(points, keypoints, params), used


class RivalRun(Run):
    """A rival's training."""

    recipe: RivalRecipe

    def losses(self) -> tuple[Loss, Loss]:
        return (rival_loss(self.recipe),) * 2

    def start(self) -> Params:
        truth = cameras.look(self.motion.joints, np.random.default_rng(self.seed))
        mean = (truth - truth.mean(1, keepdims=True)).mean(0)
        widths = ((3 if self.recipe.mask else 2) * len(JOINTS), *self.recipe.hidden)
        widths = (*widths, coordinates.OUTPUTS)
        return {"layers": coordinates.init(widths, mean, self.recipe.residual, self.seed)}

    @property
    def layers(self) -> coordinates.Params:
        """The averaged weights."""
        return self.params["layers"]

    def draw(self, epoch: int) -> Views:
        """The views of an epoch, keypoints and truth [F,14,3]: the same for all rivals."""
        rng = np.random.default_rng([self.seed, epoch])
        chosen = pick_poses(self.motion.subject, self.recipe, rng)
        return draw_2d(self.motion.joints[chosen], self.recipe, rng)

    def advance(self, views: Views) -> float:
        """One epoch on views [F,14,3]; those that do not fill a batch are left out."""
        shape = (self.steps, self.recipe.batch, len(JOINTS), 3)
        return super().advance(tuple(a[: shape[0] * shape[1]].reshape(shape) for a in views))

    def settle(self) -> "Rival":
        """The averaged weights, normalised by what they make of training views: exact, because
        running averages would belong to other weights."""
        rng = np.random.default_rng([self.seed, 1 << 31])
        chosen = pick_poses(self.motion.subject, self.recipe, rng)[:SETTLE]
        keypoints, _ = draw_2d(self.motion.joints[chosen], self.recipe, rng)
        _, statistics = predict(self.params, None, jnp.asarray(keypoints), self.recipe)
        return Rival(self.recipe, self.params, statistics)

    def describe(self) -> str:
        """What a checkpoint must be of: also the motion."""
        return json.dumps({"recipe": super().describe(), "motion": self.motion.sha256})


@dataclasses.dataclass(frozen=True)
class Rival:
    """A trained rival, ready to lift as the library does.  It answers every pose."""

    recipe: RivalRecipe
    params: Params
    statistics: coordinates.Statistics

    def lift(self, keypoints: np.ndarray) -> Poses:
        """keypoints [F,14,3] -> poses in camera axes, metres, about mid-hip."""
        given = jnp.asarray(keypoints, jnp.float32)
        points, _ = predict(self.params, self.statistics, given, self.recipe)
        points = np.asarray(points, float)
        return Poses.of(points - mid_hip(points)[:, None])


def validate(run: RivalRun, columns: dict, subject: np.ndarray) -> dict[str, float]:
    """Error of each column in mm, rigidly aligned: the mean over subjects of their means."""
    lifter, result = run.settle(), {}
    for name, (keypoints, truth) in columns.items():
        error = rigid_errors(lifter.lift(keypoints).joints, truth.astype(float)).mean(1)
        result[name] = round(1000 * float(by_subject(error, subject).mean()), 2)
    return result


def train_all(runs: dict[str, RivalRun], held: Motion, folder: Path) -> None:
    """Runs all to their last epochs, on the same views, with checkpoints and a progress bar."""
    sample = every_nth(held, SAMPLE)
    first = next(iter(runs.values()))
    columns = validation_set(sample.joints, first.seed)
    left = {name: run for name, run in runs.items() if run.epoch < run.epochs}
    start = min((run.epoch for run in left.values()), default=0)
    end = max((run.epochs for run in left.values()), default=0)
    with ThreadPoolExecutor(1) as pool, tqdm(total=end, initial=start, unit="epoch") as bar:
        following = pool.submit(first.draw, start)
        for epoch in range(start, end):
            views = following.result()
            following = pool.submit(first.draw, epoch + 1)
            for name, run in left.items():
                if epoch == run.epoch < run.epochs:
                    advance(run, views, columns, sample.subject, folder / f"{name}.state")
            bar.update()
            bar.set_postfix({n: [*r.curve.values()][-1]["gt"] for n, r in left.items() if r.curve})


def advance(
    run: RivalRun, views: Views, columns: dict[str, Views], subject: np.ndarray, state: Path
) -> None:
    """One epoch of a run; now and then a point of its curve, and a checkpoint."""
    loss = run.advance(views)
    if not np.isfinite(loss):
        raise FloatingPointError(f"{state.stem}: loss is {loss} in epoch {run.epoch}")
    if run.epoch % max(1, run.epochs // CURVE) == 0 or run.epoch == run.epochs:
        run.curve[run.epoch] = validate(run, columns, subject)
        run.save_state(state)


def entry(run: RivalRun, held_out: list[int], test: Motion) -> dict[str, Any]:
    """A rival's entry in the JSON: what it is, how it was trained, and its figures."""
    figures = rounded(evaluate(run.settle(), test))
    return {
        "parameters": coordinates.count(run.layers),
        "recipe": run.recipe.recorded(run.seed),
        "data": origin(run.motion, held_out),
        # Rigidly aligned, mm; of people who were trained on, if none were held out.
        "validation" if held_out else "training_people": run.curve,
        "test": {"source": test.source, "poses": len(test.joints), "sha256": test.sha256},
        "figures": chosen(figures, ("error", "interval")),
    }


def tried(run: RivalRun, held_out: list[int]) -> dict[str, Any]:
    """A trial's entry in the JSON."""
    return {
        "parameters": coordinates.count(run.layers),
        "recipe": run.recipe.recorded(run.seed),
        "data": origin(run.motion, held_out),
        "validation": run.curve[run.epochs],
    }


def trials_table(trials: dict[str, dict]) -> str:
    """The table of trials: errors on the people held out."""
    columns = list(next(iter(trials.values()))["validation"])
    rows = {
        title: [
            f"{row['parameters']:,}",
            row["recipe"]["epochs"],
            *(row["validation"][c] for c in columns),
        ]
        for title, row in trials.items()
    }
    return markdown.table("mm, held-out people", ["parameters", "epochs", *columns], rows)


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
    parser.add_argument("train", type=Path, help="motion to train on")
    parser.add_argument("test", type=Path, help="motion of other people, to measure on")
    parser.add_argument("--rivals", nargs="+", choices=RIVALS, metavar="NAME", default=list(RIVALS))
    parser.add_argument("--trials", action="store_true", help="the trials instead of the rivals")
    parser.add_argument("--epochs", type=int, help="at most so many, instead of the recipes'")
    parser.add_argument("--out", type=Path, default=Path("build/rivals"), help="for checkpoints")
    parser.add_argument(
        "--json", type=Path, default=TRAINED, help="for results (%(default)s)"
    )
    parser.add_argument("--update", type=Path, help="Markdown with marks for the trials' table")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def prepare(args: argparse.Namespace) -> tuple[dict[str, RivalRun], Motion]:
    """The runs, as far as they got before, and the people to validate on."""
    motion, held = split(load_motion(args.train), HELD_OUT if args.trials else [])
    recipes = TRIALS if args.trials else {name: RIVALS[name] for name in args.rivals}
    args.out.mkdir(parents=True, exist_ok=True)
    runs = {}
    for name, recipe in recipes.items():
        if args.epochs is not None:
            recipe = dataclasses.replace(recipe, mds_epochs=min(args.epochs, recipe.mds_epochs))
        runs[name] = RivalRun(motion, recipe, args.seed)
        state = args.out / f"{name}.state"
        if state.exists():
            runs[name].load_state(state)
    return runs, held


def main() -> int:
    args = arguments()
    try:
        test = load_motion(args.test)
        runs, held = prepare(args)
        train_all(runs, held, args.out)
        if args.trials:
            trials = record(args.json, "trials", {n: tried(r, HELD_OUT) for n, r in runs.items()})
            print(trials_table(trials))
        else:
            record(args.json, "rivals", {n: entry(run, [], test) for n, run in runs.items()})
    except (MocapError, ValueError, FloatingPointError, OSError) as error:
        print(f"rivals: {error}", file=sys.stderr)
        return 1
    if args.trials and args.update:
        markdown.write(args.update, "trials", trials_table(trials))
    return 0


if __name__ == "__main__":
    sys.exit(main())
