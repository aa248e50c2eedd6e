"""What training minimises, the step that it takes, and the error by which it is watched."""

import functools
from collections.abc import Callable
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax

from model import equivariant, fconn, fconv, jax_stages
from training.recipe import Recipe
from training.views import Views, imputation_of

NETWORKS: dict[str, ModuleType] = {"fconn": fconn, "equivariant": equivariant, "fconv": fconv}
BLOCK = 500  # views that a network takes at once

Params = dict[str, Any]  # of a network; "fusion": what the fuse stage takes
# (params, keypoints [B,14,3], truth [B,14,3], key) -> a number, and the parameters that are
# observed instead of trained.
Loss = Callable[[Params, jax.Array, jax.Array, jax.Array], tuple[jax.Array, Params]]


def distance_losses(recipe: Recipe) -> tuple[Loss, Loss]:
    """The loss of each phase: L2 on the distances (section 3.2), the error of the lifted joints."""
    net = NETWORKS[recipe.network]
    imputation = imputation_of(recipe)
    if recipe.mds_epochs > 0 and recipe.rigid < 1 and not recipe.fuse:
        raise ValueError("rigid must be 1 without the fuse stage: points of an MDS have no camera")

    def forward(
        params: Params, keypoints: jax.Array, key: jax.Array
    ) -> tuple[jax.Array, Params]:
        return net.forward(params, jax_stages.edm_2d(keypoints, imputation), key, recipe.dropout)

    def l2_loss(
        params: Params, keypoints: jax.Array, truth: jax.Array, key: jax.Array
    ) -> tuple[jax.Array, Params]:
        predicted, observed = forward(params, keypoints, key)
        return jnp.mean((predicted - jax_stages.edm_3d(truth)) ** 2), observed

    def mds_loss(
        params: Params, keypoints: jax.Array, truth: jax.Array, key: jax.Array
    ) -> tuple[jax.Array, Params]:
        predicted, observed = forward(params, keypoints, key)
        pose = poses(predicted, keypoints, truth, params.get("fusion"))
        error = jax_stages.joint_errors(pose, truth).mean()
        if recipe.rigid < 1:
            in_camera = jax_stages.camera_errors(pose, truth).mean()
            error = recipe.rigid * error + (1 - recipe.rigid) * in_camera
        square = jnp.mean((predicted - jax_stages.edm_3d(truth)) ** 2)
        return error + recipe.distance_weight * square, observed

    return l2_loss, mds_loss


def poses(
    distances: jax.Array, keypoints: jax.Array, truth: jax.Array, fusion: jax.Array | None
) -> jax.Array:
    """Poses [B,14,3] whose error counts; fusion None: the points of the MDS, in their own axes."""
    if fusion is None:
        return jax_stages.classical_mds(distances)
    return jax_stages.poses(distances, keypoints, truth, fusion)


# ---- A step ----------------------------------------------------------------------------------

Carry = tuple[Params, Params, optax.OptState]  # parameters, their average, the optimizer's state


def make_epoch(
    loss: Loss, recipe: Recipe, optimizer: optax.GradientTransformation
) -> Callable[[Carry, np.ndarray, np.ndarray, jax.Array], tuple[Carry, jax.Array]]:
    """The jitted epoch of a loss: (carry, keypoints, truth, key) -> (carry, mean loss).

    keypoints and truth are the epoch's batches [steps,B,14,3].
    """

    def step(carry: Carry, batch: tuple[jax.Array, ...]) -> tuple[Carry, jax.Array]:
        params, average, state = carry
        (value, observed), gradient = jax.value_and_grad(loss, has_aux=True)(params, *batch)
        updates, state = optimizer.update(gradient, state, params)
        params = optax.apply_updates(params, updates) | observed
        average = optax.incremental_update(params, average, 1 - recipe.average)
        return (params, average, state), value

    def run(
        carry: Carry, keypoints: jax.Array, truth: jax.Array, key: jax.Array
    ) -> tuple[Carry, jax.Array]:
        keys = jax.random.split(key, len(keypoints))
        carry, values = jax.lax.scan(step, carry, (keypoints, truth, keys))
        return carry, values.mean()

    return jax.jit(run)


def make_optimizer(recipe: Recipe, steps_per_epoch: int) -> optax.GradientTransformation:
    """Adam with a clipped gradient and the recipe's schedule of the rate."""
    total = recipe.epochs * steps_per_epoch
    if recipe.drop_rate_at > 0:
        schedule = optax.piecewise_constant_schedule(
            recipe.rate, {int(total * recipe.drop_rate_at): 0.1}
        )
    else:
        schedule = optax.warmup_cosine_decay_schedule(
            0.0, recipe.rate, min(2 * steps_per_epoch, total // 2), total, recipe.rate * 1e-3
        )
    clip = optax.clip_by_global_norm(recipe.clip) if recipe.clip > 0 else optax.identity()
    return optax.chain(clip, optax.adam(schedule))


# ---- Validation ------------------------------------------------------------------------------


@functools.partial(jax.jit, static_argnums=0)
def predict_block(
    net: ModuleType, params: Params, keypoints: jax.Array, imputation: jax.Array | None
) -> jax.Array:
    """Distances [B,91] of keypoints [B,14,3]."""
    return net.predict(params, jax_stages.edm_2d(keypoints, imputation))


def predict(recipe: Recipe, params: Params, keypoints: np.ndarray) -> np.ndarray:
    """Distances [F,91] of keypoints [F,14,3], a block at a time."""
    net, imputation = NETWORKS[recipe.network], imputation_of(recipe)
    blocks = [keypoints[i : i + BLOCK] for i in range(0, len(keypoints), BLOCK)]
    return np.concatenate([predict_block(net, params, block, imputation) for block in blocks])


@jax.jit
def mean_errors(
    distances: jax.Array, keypoints: jax.Array, truth: jax.Array, fusion: jax.Array | None
) -> jax.Array:
    """Mean joint error of each pose, the better of it and its reflection, [B], metres."""
    return jax_stages.joint_errors(poses(distances, keypoints, truth, fusion), truth).mean(1)


def validate(
    recipe: Recipe, params: Params, columns: dict[str, Views], subject: np.ndarray
) -> dict[str, float]:
    """Error of each column in mm, the better of pose and reflection: the mean over subjects of
    their means."""
    result = {}
    for name, (keypoints, truth) in columns.items():
        distances = predict(recipe, params, keypoints)
        error = np.asarray(mean_errors(distances, keypoints, truth, params.get("fusion")))
        means = [error[subject == s].mean() for s in np.unique(subject)]
        result[name] = round(float(1000 * np.mean(means)), 2)
    return result
