"""A training run: from the first epoch to the last, with checkpoints."""

import dataclasses
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from tqdm import tqdm

from data.mocap import MocapError, Motion
from edmlift.joints import PAIRS
from model import jax_stages
from training.loss import (
    NETWORKS,
    Loss,
    Params,
    distance_losses,
    make_epoch,
    make_optimizer,
    validate,
)
from training.recipe import Recipe
from training.views import Views, draw_2d, pick_poses, validation_set

STOPS = 30  # of a run, for validation and a checkpoint
SAMPLE = 3000  # poses to validate on, about


class Run:
    """Parameters, their average, and the optimizer, epoch by epoch."""

    def __init__(self, motion: Motion, recipe: Recipe, seed: int) -> None:
        self.motion, self.recipe, self.seed = motion, recipe, seed
        self.steps = len(motion.joints) // recipe.batch
        if self.steps == 0:
            raise MocapError(f"{len(motion.joints)} poses do not fill a batch of {recipe.batch}")
        optimizer = make_optimizer(recipe, self.steps)
        self.l2_epoch, self.mds_epoch = (
            make_epoch(loss, recipe, optimizer) for loss in self.losses()
        )
        params = self.start()
        if recipe.fuse:
            params = params | {"fusion": jax_stages.FUSION}
        self.carry = (params, params, optimizer.init(params))
        self.epoch = 0
        self.curve: dict[int, dict[str, float]] = {}  # epoch -> validation error by column, mm

    def losses(self) -> tuple[Loss, Loss]:
        """Of the first phase and of the second."""
        return distance_losses(self.recipe)

    def start(self) -> Params:
        """The network's parameters before the first epoch."""
        joints = self.motion.joints
        mean = np.linalg.norm(joints[:, PAIRS[0]] - joints[:, PAIRS[1]], axis=-1).mean(0)
        return self.network.init(mean, self.seed)

    @property
    def network(self) -> ModuleType:
        """The module of the network."""
        return NETWORKS[self.recipe.network]

    @property
    def epochs(self) -> int:
        """Of both phases."""
        return self.recipe.epochs

    @property
    def params(self) -> Params:
        """The averaged weights: what is validated and saved."""
        return self.carry[1]

    def draw(self, epoch: int) -> Views:
        """The batches of an epoch [steps,B,14,3], from the seed and its number alone."""
        rng = np.random.default_rng([self.seed, epoch])
        chosen = pick_poses(self.motion.subject, self.recipe, rng)[: self.steps * self.recipe.batch]
        keypoints, truth = draw_2d(self.motion.joints[chosen], self.recipe, rng)
        shape = (self.steps, self.recipe.batch, *truth.shape[1:])
        return keypoints.reshape(shape), truth.reshape(shape)

    def advance(self, batches: Views) -> float:
        """One epoch; returns the mean loss."""
        step = self.l2_epoch if self.epoch < self.recipe.l2_epochs else self.mds_epoch
        self.carry, loss = step(self.carry, *batches, jax.random.key(self.epoch))
        self.epoch += 1
        return float(loss)

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


def split(motion: Motion, held_out: list[int]) -> tuple[Motion, Motion]:
    """Training and validation people; without any held out, both are everyone."""
    chosen = np.isin(motion.subject, held_out)
    missing = set(held_out) - set(motion.subject.tolist())
    if missing:
        raise MocapError(f"no subject {sorted(missing)} in {motion.source}")
    return motion.take(~chosen), motion.take(chosen if held_out else ~chosen)


def every_nth(motion: Motion, count: int) -> Motion:
    """About `count` poses of a motion, evenly spread."""
    return motion.take(np.arange(0, len(motion.joints), max(1, len(motion.joints) // count)))


def train(run: Run, held: Motion, state: Path) -> None:
    """Runs to the last epoch with a progress bar."""
    sample = every_nth(held, SAMPLE)
    columns = validation_set(sample.joints, run.seed)
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
                error = validate(run.recipe, run.params, columns, sample.subject)
                run.curve[run.epoch] = {"loss": round(loss, 4), **error}
                run.save_state(state)
            bar.update()
            bar.set_postfix(next(reversed(run.curve.values()), {"loss": loss}))


def origin(motion: Motion, held_out: list[int]) -> dict[str, Any]:
    """What was trained on, for manifests."""
    return {
        "source": motion.source,
        "poses": len(motion.joints),
        "subjects": np.unique(motion.subject).tolist(),
        "held_out": held_out,
        "sha256": motion.sha256,
    }


def by_column(curve: dict[int, dict[str, float]]) -> dict[str, list[float]]:
    """A curve as a list a column, the epochs first."""
    columns = next(iter(curve.values()))
    return {"epoch": [*curve], **{name: [row[name] for row in curve.values()] for name in columns}}
