"""What training sees: fresh cameras, noise, missing joints and bodies for every pose."""

from typing import NamedTuple

import numpy as np

from data import cameras
from data.mocap import Motion
from edmlift import joints as skeleton
from edmlift.joints import LIMBS
from model import constants
from training.recipe import MAX_MISSING, Recipe

UP_SIGMA = np.radians(2)  # of what is told of up
TILT_SIGMA = 0.45  # of an axis, where that is wrong: some 25 degrees


class Views(NamedTuple):
    """F views, or batches of them, float32."""

    keypoints: np.ndarray  # [F,14,3]
    truth: np.ndarray  # [F,14,3] metres, camera axes
    up: np.ndarray  # [F,3] unit vectors, camera axes; 0: not told


def draw_2d(joints: np.ndarray, recipe: Recipe, rng: np.random.Generator) -> Views:
    """One fresh view of every pose [F,14,3], metres, y up."""
    if recipe.flip:
        joints = np.where(rng.random((len(joints), 1, 1)) < 0.5, skeleton.mirrored(joints), joints)
    for limbs in (skeleton.ARMS, skeleton.LEGS):
        joints = cameras.mix_limbs(joints, limbs, recipe.mix, rng)
    joints = cameras.straighten_limbs(joints, recipe.straightened, rng)
    if recipe.bodies:
        joints = cameras.vary_bodies(joints, rng)
    truth, up = draw_cameras(joints, recipe, rng)
    count = len(truth)
    elsewhere = np.where(rng.random(count) < recipe.redefined, rng.random(count), 0.0)
    points = cameras.project(cameras.redefine(truth, rng, elsewhere))
    strength = recipe.least + (1 - recipe.least) * rng.random(count) ** recipe.weak
    iid = rng.random(count) < recipe.iid
    points = cameras.gaussian_noise(points, np.where(iid, strength * recipe.noise, 0.0), rng)
    points = cameras.detector_noise(points, rng, np.where(iid, 0.0, strength * recipe.detector))
    adapted = rng.random(count) < recipe.adapted
    points[adapted] = cameras.adapter_error(
        points[adapted], truth[adapted], constants.NECK_ON_TRUNK, rng
    )
    seen = draw_masks(count, rng) if recipe.masks else None
    told = draw_up(up, recipe, rng)
    arrays = (cameras.keypoints(points, seen), truth, told)
    return Views(*(array.astype(np.float32) for array in arrays))


def draw_cameras(
    joints: np.ndarray, recipe: Recipe, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Poses [F,14,3] before cameras, some of them near, and where up is, [F,3]."""
    truth, up = cameras.look_and_up(joints, rng)
    near = rng.random(len(joints)) < recipe.near
    truth[near], up[near] = cameras.look_and_up(joints[near], rng, cameras.CLOSE)
    return truth, up


def draw_up(up: np.ndarray, recipe: Recipe, rng: np.random.Generator) -> np.ndarray:
    """What the network is told of up [F,3]: about right, wrong, or 0."""
    count = len(up)
    tilted = rng.random((count, 1)) < recipe.tilted
    told = up + np.where(tilted, TILT_SIGMA, UP_SIGMA) * rng.normal(size=up.shape)
    told /= np.linalg.norm(told, axis=1, keepdims=True)
    return np.where(rng.random((count, 1)) < recipe.up, told, 0.0)


def draw_masks(count: int, rng: np.random.Generator) -> np.ndarray:
    """Masks [F,14] of the joints seen: half of the poses whole, a quarter without 1 to 4 random
    joints, a quarter without a limb."""
    kind = rng.integers(0, 4, count)
    missing = np.where(kind == 2, rng.integers(1, MAX_MISSING + 1, count), 0)
    seen = cameras.hide_random(count, missing, rng)
    limb = rng.integers(0, len(LIMBS), count)
    for i, name in enumerate(LIMBS):
        chosen = (kind == 3) & (limb == i)
        seen[chosen] = cameras.hide_limb(int(chosen.sum()), name)
    return seen


def pick_poses(motions: list[Motion], recipe: Recipe, rng: np.random.Generator) -> np.ndarray:
    """Joints [F,14,3] of an epoch: as many poses as there are, subjects balanced as the recipe
    says.  Where there are several motions, the first has its share and the others have the rest."""
    if recipe.balance == 0.0 and len(motions) == 1:
        return motions[0].joints[rng.permutation(len(motions[0].joints))]
    joints = np.concatenate([motion.joints for motion in motions])
    weights = [balanced(motion.subject, recipe.balance) for motion in motions]
    if len(motions) > 1:
        rest = np.concatenate(weights[1:])
        weights = [weights[0] * (1 - recipe.others), rest / rest.sum() * recipe.others]
    return joints[rng.choice(len(joints), len(joints), p=np.concatenate(weights))]


def balanced(subject: np.ndarray, balance: float) -> np.ndarray:
    """How probable each pose [F] is; the sum is 1."""
    _, inverse, counts = np.unique(subject, return_inverse=True, return_counts=True)
    weight = counts[inverse] ** -balance
    return weight / weight.sum()


def validation_set(joints: np.ndarray, seed: int) -> dict[str, Views]:
    """Fixed views of poses [F,14,3]: exact, with up, noisy, detector-like, joints missing."""
    rng = np.random.default_rng([seed, 1 << 30])
    truth, up = cameras.look_and_up(joints, rng)
    points = cameras.project(truth)
    count = len(points)
    hidden = cameras.hide_random(count, 2, rng)
    columns = {
        "gt": cameras.keypoints(points),
        "n10": cameras.keypoints(cameras.gaussian_noise(points, 10.0, rng)),
        "cpm": cameras.keypoints(cameras.detector_noise(points, rng)),
        "rand2": cameras.keypoints(points, hidden),
        "left_leg": cameras.keypoints(points, cameras.hide_limb(count, "left_leg")),
    }
    views = {name: (keypoints, truth, np.zeros((count, 3))) for name, keypoints in columns.items()}
    views["gt_up"] = (columns["gt"], truth, up)
    return {name: Views(*(a.astype(np.float32) for a in view)) for name, view in views.items()}


def imputation_of(recipe: Recipe) -> np.ndarray | None:
    """For jax_stages.body_frame(): [14,14], or None."""
    return constants.imputation().astype(np.float32) if recipe.impute else None
