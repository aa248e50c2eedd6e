"""What training minimises, the step that it takes, and the error by which it is watched."""

import functools
from collections.abc import Callable
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
import optax.contrib

from edmlift.joints import BONES, HINGES
from model import fconn, fconv, jax_stages, lifter
from training.recipe import Recipe
from training.views import Views, imputation_of

NETWORKS: dict[str, ModuleType] = {"fconn": fconn, "fconv": fconv}  # from distances to distances
BLOCK = 500  # views that a network takes at once
STRAIGHT = 0.35  # radians: a limb that is bent by less counts as straight, more or less

Params = dict[str, Any]  # of a network; "fusion", "share": what the fuse stage takes
# (params, batch, key) -> a number, and the parameters that are observed instead of trained.
Loss = Callable[[Params, Views, jax.Array], tuple[jax.Array, Params]]


def losses(recipe: Recipe) -> tuple[Loss, Loss]:
    """The loss of each phase: L2 on the distances (section 3.2), the error of the poses."""
    return distance_losses(recipe) if recipe.network in NETWORKS else lifter_losses(recipe)


def start(recipe: Recipe, joints: np.ndarray, views: Views, seed: int) -> Params:
    """The parameters before the first epoch, for training people [F,14,3] and views of them."""
    if recipe.network not in NETWORKS:
        image = jax_stages.body_frame(views.keypoints, imputation_of(recipe))
        inputs = np.concatenate(lifter.inputs(recipe.network, image, views.up), 1)
        return lifter.init(recipe.network, recipe.hidden, joints, inputs, seed)
    mean = np.asarray(jax_stages.edm_3d(joints)).mean(0)
    params = NETWORKS[recipe.network].init(mean, seed)
    if not recipe.fuse:
        return params
    share = jnp.array(0.4, jnp.float32)  # with its type: an epoch is compiled once
    return params | {"fusion": jax_stages.FUSION, "share": share}


# ---- The paper's networks ----------------------------------------------------------------------


def distance_losses(recipe: Recipe) -> tuple[Loss, Loss]:
    """Of networks from distances to distances."""
    net = NETWORKS[recipe.network]
    imputation = imputation_of(recipe)
    if recipe.pose_epochs > 0 and recipe.rigid < 1 and not recipe.fuse:
        raise ValueError("rigid must be 1 without the fuse stage: points of an MDS have no camera")

    def forward(
        params: Params, batch: Views, key: jax.Array
    ) -> tuple[jax_stages.Image, jax.Array, Params]:
        image = jax_stages.body_frame(batch.keypoints, imputation)
        edm = jax_stages.edm_2d(image, recipe.impute)
        return image, *net.forward(params, edm, key, recipe.dropout)

    def l2_loss(params: Params, batch: Views, key: jax.Array) -> tuple[jax.Array, Params]:
        _, predicted, observed = forward(params, batch, key)
        return jnp.mean((predicted - jax_stages.edm_3d(batch.truth)) ** 2), observed

    def mds_loss(params: Params, batch: Views, key: jax.Array) -> tuple[jax.Array, Params]:
        image, predicted, observed = forward(params, batch, key)
        pose = mds_poses(params, image, predicted, batch.truth)
        error = jax_stages.joint_errors(pose, batch.truth).mean()
        if recipe.rigid < 1:
            in_camera = jax_stages.camera_errors(pose, batch.truth).mean()
            error = recipe.rigid * error + (1 - recipe.rigid) * in_camera
        square = jnp.mean((predicted - jax_stages.edm_3d(batch.truth)) ** 2)
        return error + recipe.distance_weight * square, observed

    return l2_loss, mds_loss


def mds_poses(
    params: Params, image: jax_stages.Image, distances: jax.Array, truth: jax.Array
) -> jax.Array:
    """Poses [B,14,3] of distances [B,91], the true mirror image; without the fuse stage in the axes
    of the MDS."""
    points = jax_stages.classical_mds(distances)
    if "fusion" not in params:
        return points
    points = jax_stages.true_mirror(jax_stages.orient(points, image), truth)
    shares = jax_stages.gate_shares(params["share"] * jnp.ones_like(image.seen))
    points = jax_stages.fuse(points, image, shares, params["fusion"])
    return jax_stages.turned_back(points, image.down)


# ---- The equivariant networks ------------------------------------------------------------------


def lift(recipe: Recipe, params: Params, views: Views) -> tuple[jax.Array, lifter.Output]:
    """Poses as lifter.poses() has them, and what the network gave."""
    image = jax_stages.body_frame(views.keypoints, imputation_of(recipe))
    output = lifter.run(recipe.network, params, image, views.up)
    return lifter.poses(params, image, output), output


def lifter_losses(recipe: Recipe, lift: Callable = lift) -> tuple[Loss, Loss]:
    """Of the networks of model/lifter.py: the same in both phases."""

    def pose_loss(params: Params, batch: Views, key: jax.Array) -> tuple[jax.Array, Params]:
        pose, output = lift(recipe, params, batch)
        value = pose_errors(recipe, pose, batch.truth)
        if output.distances is not None:
            square = jnp.mean((output.distances - jax_stages.edm_3d(batch.truth)) ** 2)
            value += recipe.distance_weight * square
        return value, {}

    return pose_loss, pose_loss


def pose_errors(recipe: Recipe, pose: jax.Array, truth: jax.Array) -> jax.Array:
    """What poses [B,14,3] in camera axes are off by, metres: a weighted sum of means."""
    value = recipe.rigid * jax_stages.joint_errors(pose, truth, mirror=False).mean()
    value += (1 - recipe.rigid) * jax_stages.camera_errors(pose, truth).mean()
    value += recipe.direction_weight * direction_errors(pose, truth).mean()
    bent, off = flexions(truth), jnp.abs(flexions(pose) - flexions(truth))
    straight = jnp.exp(-((bent / STRAIGHT) ** 2))
    return value + jnp.mean((recipe.flexion_weight + recipe.straight_weight * straight) * off)


STARTS, ENDS = np.array(BONES).T


def direction_errors(pose: jax.Array, truth: jax.Array) -> jax.Array:
    """How far apart unit vectors along the bones are, [B,13]."""

    def directions(points: jax.Array) -> jax.Array:
        bones = points[:, ENDS] - points[:, STARTS]
        return bones / jnp.sqrt(jnp.sum(bones**2, -1, keepdims=True) + 1e-8)

    difference = directions(pose) - directions(truth)
    return jnp.sqrt(jnp.sum(difference**2, -1) + jax_stages.TINY)


def flexions(points: jax.Array) -> jax.Array:
    """Flexion of elbows and knees, radians: [B,14,3] -> [B,4], 0 is straight."""
    before, at, after = (points[:, side] for side in np.array(HINGES).T)
    upper, lower = at - before, after - at
    sine = jnp.sqrt(jnp.sum(jnp.cross(upper, lower) ** 2, -1) + 1e-10)
    return jnp.arctan2(sine, jnp.sum(upper * lower, -1))


# ---- A step ----------------------------------------------------------------------------------

Carry = tuple[Params, Params, optax.OptState]  # parameters, their average, the optimizer's state


def make_epoch(
    loss: Loss, recipe: Recipe, optimizer: optax.GradientTransformation
) -> Callable[[Carry, Views, jax.Array], tuple[Carry, jax.Array]]:
    """The jitted epoch of a loss: (carry, the epoch's batches, key) -> (carry, mean loss)."""

    def step(carry: Carry, batch: tuple[Views, jax.Array]) -> tuple[Carry, jax.Array]:
        params, average, state = carry
        (value, observed), gradient = jax.value_and_grad(loss, has_aux=True)(params, *batch)
        updates, state = optimizer.update(gradient, state, params)
        params = optax.apply_updates(params, updates) | observed
        average = optax.incremental_update(params, average, 1 - recipe.average)
        return (params, average, state), value

    def run(carry: Carry, batches: Views, key: jax.Array) -> tuple[Carry, jax.Array]:
        keys = jax.random.split(key, len(batches.truth))
        carry, values = jax.lax.scan(step, carry, (batches, keys))
        return carry, values.mean()

    return jax.jit(run)


def make_optimizer(recipe: Recipe, steps_per_epoch: int) -> optax.GradientTransformation:
    """The recipe's optimizer with a clipped gradient, and its schedule of the rate."""
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
    return optax.chain(clip, optax.adam(schedule) if recipe.adam else muon(schedule))


def muon(schedule: optax.Schedule) -> optax.GradientTransformation:
    """Muon (K. Jordan et al., 2024): steps along orthogonalised momentum for matrices, which are
    weights, and Adam's with Nesterov's momentum for the rest.  All are about as large as Adam's."""
    return optax.contrib.muon(schedule, adam_learning_rate=schedule, consistent_rms=0.2)


# ---- Validation ------------------------------------------------------------------------------


@functools.partial(jax.jit, static_argnums=0)
def predict_block(recipe: Recipe, params: Params, keypoints: jax.Array) -> jax.Array:
    """Distances [B,91] of keypoints [B,14,3], by one of NETWORKS."""
    image = jax_stages.body_frame(keypoints, imputation_of(recipe))
    return NETWORKS[recipe.network].predict(params, jax_stages.edm_2d(image, recipe.impute))


def predict(recipe: Recipe, params: Params, keypoints: np.ndarray) -> np.ndarray:
    """Distances [F,91] of keypoints [F,14,3], a block at a time."""
    blocks = [keypoints[i : i + BLOCK] for i in range(0, len(keypoints), BLOCK)]
    return np.concatenate([predict_block(recipe, params, block) for block in blocks])


@functools.partial(jax.jit, static_argnums=0)
def block_errors(recipe: Recipe, params: Params, views: Views) -> tuple[jax.Array, jax.Array]:
    """Mean joint error of each pose [B], metres: rigidly aligned, and in the camera's axes.

    An equivariant network chooses the mirror image, for others it is the better one.
    """
    if better := recipe.network in NETWORKS:
        image = jax_stages.body_frame(views.keypoints, imputation_of(recipe))
        distances = predict_block(recipe, params, views.keypoints)
        pose = mds_poses(params, image, distances, views.truth)
    else:
        pose, _ = lift(recipe, params, views)
    return mean_errors(pose, views.truth, better)


def mean_errors(pose: jax.Array, truth: jax.Array, mirror: bool) -> tuple[jax.Array, jax.Array]:
    """Mean joint error of each pose [B], metres: aligned, with `mirror` the better of it and its
    reflection; and in the camera's axes."""
    aligned = jax_stages.joint_errors(pose, truth, mirror).mean(1)
    return aligned, jax_stages.camera_errors(pose, truth).mean(1)


def validate(
    errors_of: Callable[[Views], tuple[jax.Array, jax.Array]],
    columns: dict[str, Views],
    subject: np.ndarray,
) -> dict[str, float]:
    """Errors of each column in mm, aligned and in camera axes: means over subjects.

    errors_of  as block_errors() has them, of BLOCK views
    """
    result = {}
    for name, views in columns.items():
        blocks = [
            errors_of(Views(*(a[i : i + BLOCK] for a in views)))
            for i in range(0, len(views.truth), BLOCK)
        ]
        for kind, errors in zip((name, f"{name}_camera"), zip(*blocks, strict=True), strict=True):
            error = np.concatenate(errors)
            means = [error[subject == s].mean() for s in np.unique(subject)]
            result[kind] = round(float(1000 * np.mean(means)), 2)
    return result
