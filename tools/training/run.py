"""A training run: from the first epoch to the last, with checkpoints."""

import dataclasses
import functools
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from tqdm import tqdm

from data.mocap import MocapError, Motion
from training.loss import (
    Loss,
    Params,
    block_errors,
    losses,
    make_epoch,
    make_optimizer,
    start,
    validate,
)
from training.recipe import Recipe
from training.views import Views, draw_2d, pick_poses, validation_set

STOPS = 30  # of a run, for validation and a checkpoint
SAMPLE = 3000  # poses to validate on, about
SETTLE = 100  # batches whose inputs are measured before the first epoch


class Run:
    """Parameters, their average, and the optimizer, epoch by epoch."""

    def __init__(self, motions: list[Motion], recipe: Recipe, seed: int) -> None:
        self.motions, self.recipe, self.seed = motions, recipe, seed
        poses = sum(len(motion.joints) for motion in motions)
        self.steps = poses // recipe.batch
        if self.steps == 0:
            raise MocapError(f"{poses} poses do not fill a batch of {recipe.batch}")
        optimizer = make_optimizer(recipe, self.steps)
        first, second = self.losses()
        self.l2_epoch = make_epoch(first, recipe, optimizer)
        self.pose_epoch = self.l2_epoch  # compiled once where the losses are the same
        if second is not first:
            self.pose_epoch = make_epoch(second, recipe, optimizer)
        params = self.start()
        self.carry = (params, params, optimizer.init(params))
        self.epoch = 0
        self.curve: dict[int, dict[str, float]] = {}  # epoch -> validation error by column, mm

    def losses(self) -> tuple[Loss, Loss]:
        """Of the first phase and of the second."""
        return losses(self.recipe)

    def start(self) -> Params:
        """The parameters before the first epoch."""
        views = Views(*(array[:SETTLE].reshape(-1, *array.shape[2:]) for array in self.draw(0)))
        return start(self.recipe, self.motions[0].joints, views, self.seed)

    @property
    def epochs(self) -> int:
        """Of both phases."""
        return self.recipe.epochs

    @property
    def params(self) -> Params:
        """The averaged weights: what is validated and saved."""
        return self.carry[1]

    def draw(self, epoch: int) -> Views:
        """The batches of an epoch [steps,B,...], from the seed and its number alone."""
        rng = np.random.default_rng([self.seed, epoch])
        joints = pick_poses(self.motions, self.recipe, rng)[: self.steps * self.recipe.batch]
        shape = (self.steps, self.recipe.batch)
        return Views(*(a.reshape(*shape, *a.shape[1:]) for a in draw_2d(joints, self.recipe, rng)))

    def advance(self, batches: Views) -> float:
        """One epoch; returns the mean loss."""
        step = self.l2_epoch if self.epoch < self.recipe.l2_epochs else self.pose_epoch
        self.carry, loss = step(self.carry, batches, jax.random.key(self.epoch))
        self.epoch += 1
        return float(loss)

    def validate(self, columns: dict[str, Views], subject: np.ndarray) -> dict[str, float]:
        """Errors of each column, mm."""
        return validate(functools.partial(block_errors, self.recipe, self.params), columns, subject)

    def save_state(self, path: Path) -> None:
        """Writes a checkpoint, whole or not at all."""
        leaves = jax.tree.leaves(self.carry)
        temporary = path.with_suffix(".tmp")
        about = {"epoch": self.epoch, "curve": json.dumps(self.curve), "recipe": self.describe()}
        with temporary.open("wb") as file:
            np.savez(file, *map(np.asarray, leaves), **about)
        temporary.replace(path)

    def load_state(self, path: Path) -> None:
        """Goes on from a checkpoint; ValueError if it is of another recipe or seed."""
        with np.load(path) as state:
            if str(state["recipe"]) != self.describe():
                raise ValueError(f"{path}: of another recipe or seed; remove it to start anew")
            leaves = [jnp.asarray(state[f"arr_{i}"]) for i in range(len(state.files) - 3)]
            self.carry = jax.tree.unflatten(jax.tree.structure(self.carry), leaves)
            self.epoch = int(state["epoch"])
            self.curve = {int(epoch): row for epoch, row in json.loads(str(state["curve"])).items()}

    def describe(self) -> str:
        """What a checkpoint must be of."""
        return json.dumps({"seed": self.seed, **dataclasses.asdict(self.recipe)})


def split(motions: list[Motion], held_out: list[int]) -> tuple[list[Motion], list[Motion]]:
    """Training and validation people of each motion; without any held out, both are everyone."""
    missing = set(held_out) - {s for motion in motions for s in motion.subject.tolist()}
    if missing:
        raise MocapError(f"no subject {sorted(missing)} in {motions[0].source}")
    train, held = [], []
    for motion in motions:
        chosen = np.isin(motion.subject, held_out)
        train.append(motion.take(~chosen))
        held.append(motion.take(chosen if held_out else ~chosen))
    return [m for m in train if len(m.joints)], [m for m in held if len(m.joints)]


def every_nth(motion: Motion, count: int) -> Motion:
    """About `count` poses of a motion, evenly spread."""
    return motion.take(np.arange(0, len(motion.joints), max(1, len(motion.joints) // count)))


def train(run: Run, held: list[Motion], state: Path) -> None:
    """Runs to the last epoch with a progress bar."""
    samples = [every_nth(motion, SAMPLE) for motion in held]
    columns = [validation_set(sample.joints, run.seed) for sample in samples]

    def errors() -> dict[str, float]:
        """Of each motion, all columns."""
        found = {}
        for sample, views in zip(samples, columns, strict=True):
            stem = f"{Path(sample.source).stem} " if len(samples) > 1 else ""
            row = run.validate(views, sample.subject)
            found |= {stem + name: value for name, value in row.items()}
        return found

    with (
        ThreadPoolExecutor(1) as pool,  # draws the next epoch while this one trains
        tqdm(total=run.epochs, initial=run.epoch, unit="epoch") as bar,
    ):
        following = pool.submit(run.draw, run.epoch)
        while run.epoch < run.epochs:
            batches = following.result()
            following = pool.submit(run.draw, run.epoch + 1)
            loss = run.advance(batches)
            if not np.isfinite(loss):
                raise FloatingPointError(f"loss is {loss} in epoch {run.epoch}: lower the rate")
            if run.epoch % max(1, run.epochs // STOPS) == 0 or run.epoch == run.epochs:
                run.curve[run.epoch] = {"loss": round(loss, 4), **errors()}
                run.save_state(state)
            bar.update()
            bar.set_postfix(next(reversed(run.curve.values()), {"loss": loss}))


def origin(motions: list[Motion], held_out: list[int]) -> dict[str, Any]:
    """What was trained on, for manifests."""
    files = [
        {
            "source": motion.source,
            "poses": len(motion.joints),
            "subjects": np.unique(motion.subject).tolist(),
            "sha256": motion.sha256,
        }
        for motion in motions
    ]
    return {"files": files, "held_out": held_out}


def by_column(curve: dict[int, dict[str, float]]) -> dict[str, list[float]]:
    """A curve as a list a column, the epochs first."""
    columns = next(iter(curve.values()))
    return {"epoch": [*curve], **{name: [row[name] for row in curve.values()] for name in columns}}
