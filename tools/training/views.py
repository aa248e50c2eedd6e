"""What training sees: fresh cameras, noise, missing joints and bodies for every pose."""

import numpy as np

from data import cameras
from edmlift import joints as skeleton
from edmlift.joints import LIMBS
from model import constants
from training.recipe import MAX_MISSING, Recipe

Views = tuple[np.ndarray, np.ndarray]  # keypoints [F,14,3], truth in camera axes [F,14,3], float32


def draw_2d(joints: np.ndarray, recipe: Recipe, rng: np.random.Generator) -> Views:
    """One fresh view of every pose [F,14,3], metres, y up."""
    if recipe.flip:
        joints = np.where(rng.random((len(joints), 1, 1)) < 0.5, skeleton.mirrored(joints), joints)
    for limbs in (skeleton.ARMS, skeleton.LEGS):
        joints = cameras.mix_limbs(joints, limbs, recipe.mix, rng)
    if recipe.bodies:
        joints = cameras.vary_bodies(joints, rng)
    truth = cameras.look(joints, rng)
    points = cameras.project(truth)
    count = len(points)
    strength = recipe.least + (1 - recipe.least) * rng.random(count)
    iid = rng.random(count) < recipe.iid
    points = cameras.gaussian_noise(points, np.where(iid, strength * recipe.noise, 0.0), rng)
    points = cameras.detector_noise(points, rng, np.where(iid, 0.0, strength * recipe.detector))
    adapted = rng.random(count) < recipe.adapted
    points[adapted] = cameras.adapter_error(
        points[adapted], truth[adapted], constants.NECK_ON_TRUNK, rng
    )
    seen = draw_masks(count, rng) if recipe.masks else None
    keypoints = cameras.keypoints(points, seen)
    return keypoints.astype(np.float32), truth.astype(np.float32)


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


def pick_poses(subject: np.ndarray, recipe: Recipe, rng: np.random.Generator) -> np.ndarray:
    """Indices of an epoch: as many poses as there are, subjects balanced as the recipe says."""
    if recipe.balance == 0.0:
        return rng.permutation(len(subject))
    _, inverse, counts = np.unique(subject, return_inverse=True, return_counts=True)
    weight = counts[inverse] ** -recipe.balance
    return rng.choice(len(subject), len(subject), p=weight / weight.sum())


def validation_set(joints: np.ndarray, seed: int) -> dict[str, Views]:
    """Fixed views of poses [F,14,3]: exact, noisy, detector-like, two joints missing."""
    rng = np.random.default_rng([seed, 1 << 30])
    truth = cameras.look(joints, rng)
    points = cameras.project(truth)
    hidden = cameras.hide_random(len(points), 2, rng)
    columns = {
        "gt": cameras.keypoints(points),
        "n10": cameras.keypoints(cameras.gaussian_noise(points, 10.0, rng)),
        "cpm": cameras.keypoints(cameras.detector_noise(points, rng)),
        "rand2": cameras.keypoints(points, hidden),
    }
    return {name: (k.astype(np.float32), truth.astype(np.float32)) for name, k in columns.items()}


def imputation_of(recipe: Recipe) -> np.ndarray | None:
    """For jax_stages.edm_2d(): [14,14], or None."""
    return constants.imputation().astype(np.float32) if recipe.impute else None
