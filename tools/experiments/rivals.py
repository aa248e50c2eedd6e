"""Trains the rivals that go from 2D joints straight to 3D joints, and measures them.

    run.py experiments.rivals TRAIN TEST [--rivals NAMES] [--epochs N] [--out build/rivals]
    run.py experiments.rivals TRAIN TEST --trials --update docs/accuracy.md

Bodies, cameras, noise, missing joints and the balance of subjects are those of tools/train.py; one
drawn epoch feeds all networks.  TRAIN and TEST are .npz files or folders that tools/mocap.py reads.
Figures of the columns of tools/evaluate.py go into the JSON from which that takes their rows.

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

import jax
import jax.numpy as jnp
import numpy as np
from tqdm import tqdm

from data import cameras
from data.mocap import MocapError, Motion, load_motion
from edmlift.joints import JOINTS, mid_hip
from edmlift.library import Poses
from edmlift.metrics import rigid_errors
from evaluation import accuracy, baselines
from export.weights import manifest_text
from model import coordinates, jax_stages
from reports import markdown
from training import train


@dataclasses.dataclass(frozen=True)
class Recipe(train.Recipe):
    """Of a rival; `mds_epochs` are all of its epochs."""

    hidden: tuple[int, ...] = (128, 128)
    residual: bool = False  # batch normalisation, and a skip around each two layers
    mask: bool = False  # which joints are seen is input, too

    def noted(self, seed: int) -> dict:
        """What decides the weights, for the JSON."""
        fields = dataclasses.asdict(self)
        fields["epochs"] = fields.pop("mds_epochs")
        unused = ("network", "l2_epochs", "distance_share")
        return {"seed": seed} | {k: v for k, v in fields.items() if k not in unused}


def recipe(**changes) -> Recipe:
    """FConn's recipe, but for the changes; the phase of L2 on distances has no counterpart."""
    base = train.RECIPES["mds"]
    fields = dataclasses.asdict(base) | {"l2_epochs": 0, "distance_share": 0.0, "blend": False}
    fields |= {"rigid": 0.8, "complete": False}
    fields["mds_epochs"] = base.l2_epochs + base.mds_epochs
    return Recipe(**fields | changes)


martinez = functools.partial(
    recipe, hidden=(1024,) * 5, residual=True, mds_epochs=150, batch=1024, average=0.99
)

RIVALS = {  # what was best of TRIALS
    "mlp40k": recipe(hidden=(121,) * 3, mask=True, rate=3e-3, batch=128),
    "mlp40k_guess": recipe(hidden=(121,) * 3, mask=True, rate=3e-3, batch=128, complete=True),
    "mlp40k_blend": recipe(hidden=(121,) * 3, mask=True, rate=3e-3, blend=True),
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
    "the same, missing joints guessed": small(
        hidden=(120,) * 3, mask=True, rate=3e-3, rigid=0.8, complete=True
    ),
    "4.3 M, no dropout": large(),
    "4.3 M, dropout 0.1": large(dropout=0.1),
    "4.3 M, dropout 0.5": large(dropout=0.5),
}
CURVE = 20  # points of the validation curve
SETTLE = 8192  # training views by which batch normalisation is fixed


def blended(points, keypoints, params):
    """Poses [B,14,3] moved to the image, if the parameters say how; about their mean."""
    if "blend" not in params:
        return points
    points = jax_stages.blend(points, keypoints, params["blend"])
    return points - points.mean(1, keepdims=True)


def rival_loss(recipe: Recipe):
    """(params, keypoints [B,14,3], truth [B,14,3], key) -> mean joint error, metres; and {}, for
    nothing of the parameters is observed."""

    completion = train.completion_of(recipe)

    def loss(params, keypoints, truth, key):
        x = coordinates.inputs(keypoints, recipe.mask, completion)
        layers = params["layers"]
        points, _ = coordinates.forward(layers, x, recipe.residual, None, key, recipe.dropout)
        points = blended(points, keypoints, params)
        value = 0.0
        if recipe.rigid > 0:
            value += recipe.rigid * jax_stages.joint_errors(points, truth, mirror=False).mean()
        if recipe.rigid < 1:
            value += (1 - recipe.rigid) * coordinates.camera_errors(points, truth).mean()
        return value, {}

    return loss


@functools.partial(jax.jit, static_argnames="recipe")
def predict(params, statistics, keypoints, recipe: Recipe):
    """Centred poses [B,14,3] of keypoints [B,14,3]; and the statistics of normalisation.

    These are measured on the keypoints where they are not given.
    """
    x = coordinates.inputs(keypoints, recipe.mask, train.completion_of(recipe))
    points, used = coordinates.forward(params["layers"], x, recipe.residual, statistics)
    return blended(points, keypoints, params), used


class Run(train.Run):
    """A rival's training."""

    def losses(self):
        return (rival_loss(self.recipe),) * 2

    def start(self) -> dict[str, coordinates.Params]:
        truth = cameras.look(self.motion.joints, np.random.default_rng(self.seed))
        mean = (truth - truth.mean(1, keepdims=True)).mean(0)
        widths = ((3 if self.recipe.mask else 2) * len(JOINTS), *self.recipe.hidden)
        widths = (*widths, coordinates.OUTPUTS)
        return {"layers": coordinates.init(widths, mean, self.recipe.residual, self.seed)}

    @property
    def layers(self) -> coordinates.Params:
        """The averaged weights."""
        return self.params["layers"]

    def draw(self, epoch: int) -> tuple[np.ndarray, np.ndarray]:
        """The views of an epoch, keypoints and truth [F,14,3]: the same for all rivals."""
        rng = np.random.default_rng([self.seed, epoch])
        chosen = train.pick_poses(self.motion.subject, self.recipe, rng)
        return train.draw_2d(self.motion.joints[chosen], self.recipe, rng)

    def advance(self, views: tuple[np.ndarray, np.ndarray]) -> float:
        """One epoch on views [F,14,3]; those that do not fill a batch are left."""
        shape = (self.steps, self.recipe.batch, len(JOINTS), 3)
        return super().advance(tuple(a[: shape[0] * shape[1]].reshape(shape) for a in views))

    def settle(self) -> "Lifter":
        """The averaged weights, normalised by what they do to training views: exact, where
        running averages would be those of other weights."""
        rng = np.random.default_rng([self.seed, 1 << 31])
        chosen = train.pick_poses(self.motion.subject, self.recipe, rng)[:SETTLE]
        keypoints, _ = train.draw_2d(self.motion.joints[chosen], self.recipe, rng)
        _, statistics = predict(self.params, None, jnp.asarray(keypoints), self.recipe)
        return Lifter(self.recipe, self.params, statistics)

    def describe(self) -> str:
        return json.dumps({"recipe": super().describe(), "motion": self.motion.sha256})


@dataclasses.dataclass(frozen=True)
class Lifter:
    """A trained rival, ready to lift: `lift` is edmlift.Library's.  It answers every pose."""

    recipe: Recipe
    params: dict
    statistics: coordinates.Statistics

    def lift(self, keypoints: np.ndarray) -> Poses:
        """keypoints [F,14,3] -> poses in camera axes, metres, about mid-hip."""
        given = jnp.asarray(keypoints, jnp.float32)
        points, _ = predict(self.params, self.statistics, given, self.recipe)
        points = np.asarray(points, float)
        return baselines.all_fine(points - mid_hip(points)[:, None])


def validate(run: Run, columns: dict, subject: np.ndarray) -> dict[str, float]:
    """Error of each column in mm, rigidly aligned: the mean over subjects of their means."""
    lifter, result = run.settle(), {}
    for name, (keypoints, truth) in columns.items():
        error = rigid_errors(lifter.lift(keypoints).joints, truth.astype(float)).mean(1)
        result[name] = round(1000 * float(accuracy.by_subject(error, subject).mean()), 2)
    return result


def train_all(runs: dict[str, Run], held: Motion, folder: Path) -> None:
    """Runs all to their last epochs, on the same views, with checkpoints and a progress bar."""
    sample = held.take(np.arange(0, len(held.joints), max(1, len(held.joints) // 6000)))
    first = next(iter(runs.values()))
    columns = train.validation_set(sample.joints, first.seed)
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


def advance(run: Run, views, columns: dict, subject: np.ndarray, state: Path) -> None:
    """One epoch of a run; now and then a point of its curve, and a checkpoint."""
    loss = run.advance(views)
    if not np.isfinite(loss):
        raise FloatingPointError(f"{state.stem}: loss is {loss} in epoch {run.epoch}")
    if run.epoch % max(1, run.epochs // CURVE) == 0 or run.epoch == run.epochs:
        run.curve[run.epoch] = validate(run, columns, subject)
        run.save_state(state)


def record(run: Run, held_out: list[int], test: Motion) -> dict:
    """A rival's entry in the JSON: what it is, how it was trained, and its figures."""
    figures = accuracy.rounded(accuracy.evaluate(run.settle(), test))
    return {
        "parameters": coordinates.count(run.layers),
        "recipe": run.recipe.noted(run.seed),
        "data": train.origin(run.motion, held_out),
        # Rigidly aligned, mm; of people who were trained on, if none were held out.
        "validation" if held_out else "training_people": run.curve,
        "test": {"source": test.source, "poses": len(test.joints), "sha256": test.sha256},
        "figures": {n: {k: c[k] for k in ("error", "interval")} for n, c in figures.items()},
    }


def tried(run: Run, held_out: list[int]) -> dict:
    """A trial's entry in the JSON."""
    return {
        "parameters": coordinates.count(run.layers),
        "recipe": run.recipe.noted(run.seed),
        "data": train.origin(run.motion, held_out),
        "validation": run.curve[run.epochs],
    }


def tried_markdown(trials: dict[str, dict]) -> str:
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
    return accuracy.table("mm, held-out people", ["parameters", "epochs", *columns], rows)


def note(path: Path, section: str, entries: dict[str, dict]) -> dict[str, dict]:
    """Puts entries into a section of the JSON; returns the section, in the order of this file."""
    results = json.loads(path.read_text()) if path.exists() else {}
    known = RIVALS if section == "rivals" else TRIALS
    both = results.get(section, {}) | entries
    results[section] = {name: both[name] for name in known if name in both}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(manifest_text(results))
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
        "--json", type=Path, default=baselines.TRAINED, help="for results (%(default)s)"
    )
    parser.add_argument("--update", type=Path, help="Markdown with marks for the trials' table")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def prepare(args: argparse.Namespace) -> tuple[dict[str, Run], Motion]:
    """The runs, as far as they got before, and the people to validate on."""
    motion, held = train.split(load_motion(args.train), HELD_OUT if args.trials else [])
    recipes = TRIALS if args.trials else {name: RIVALS[name] for name in args.rivals}
    args.out.mkdir(parents=True, exist_ok=True)
    runs = {}
    for name, recipe in recipes.items():
        if args.epochs is not None:
            recipe = dataclasses.replace(recipe, mds_epochs=min(args.epochs, recipe.mds_epochs))
        runs[name] = Run(motion, recipe, args.seed)
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
            trials = note(args.json, "trials", {n: tried(r, HELD_OUT) for n, r in runs.items()})
            print(tried_markdown(trials))
        else:
            note(args.json, "rivals", {n: record(run, [], test) for n, run in runs.items()})
    except (MocapError, ValueError, FloatingPointError, OSError) as error:
        print(f"rivals: {error}", file=sys.stderr)
        return 1
    if args.trials and args.update:
        markdown.write(args.update, "trials", tried_markdown(trials))
    return 0


if __name__ == "__main__":
    sys.exit(main())
