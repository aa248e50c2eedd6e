"""What experiments have in common: runs that go on where they left off, and what lifts by them."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from data.mocap import Motion
from edmlift.joints import mid_hip
from edmlift.library import Library, Poses
from export.build import build_library
from training.loss import BLOCK
from training.manifest import write
from training.run import Run, train

HELD_OUT = [5, 13, 91, 127, 902, 5003, 5102]  # training people by whom recipes are chosen

AnyRun = TypeVar("AnyRun", bound=Run)


def finish(run: AnyRun, held: list[Motion], state: Path) -> AnyRun:
    """The run at its last epoch, from its checkpoint if there is one; people `held` are watched."""
    if state.exists():
        run.load_state(state)
    train(run, held, state)
    return run


def library_of(run: Run, weights: Path) -> Library:
    """The C library with the run's network as its only model; weights, .npz, are written."""
    write(run, weights.stem, [], weights)
    return build_library(weights, weights.with_suffix(""))


def in_blocks(points_of: Callable[[jax.Array], jax.Array], keypoints: np.ndarray) -> Poses:
    """Poses about mid-hip, by a function from keypoints [B,14,3] to points [B,14,3]."""
    blocks = [keypoints[i : i + BLOCK] for i in range(0, len(keypoints), BLOCK)]
    given = (jnp.asarray(block, jnp.float32) for block in blocks)
    points = np.concatenate([points_of(block) for block in given]).astype(float)
    return Poses.of(points - mid_hip(points)[:, None])
