"""The views on which accuracy is measured: poses before virtual cameras, whose 2D is spoiled.

A column of a table is one kind of 2D: exact (`gt`), with noise of 5 to 20 pixels (`n5` ... `n20`),
as an imitated detector sees (`cpm`), with two joints or a limb missing (`rand2`, `left_arm` ...),
by rolled cameras and by close ones, and by those of `gt` turned onto a side (`sideways`).  One seed
gives the same views each time; what is new is drawn last, so that the others stay as they were.
"""

from dataclasses import dataclass

import numpy as np

from data import cameras
from edmlift.joints import LIMBS

SEED = 20170714
NOISE = {"n5": 5.0, "n10": 10.0, "n15": 15.0, "n20": 20.0}  # pixels
STRESS = {"rolled": cameras.ROLLED, "close": cameras.CLOSE}


@dataclass(frozen=True)
class Column:
    """F views of one kind."""

    keypoints: np.ndarray  # [F,14,3] x, y in pixels, confidence
    seen: np.ndarray  # [F,14] bool
    truth: np.ndarray  # [F,14,3] metres, camera axes
    up: np.ndarray | None = None  # [F,3] unit vectors, camera axes; None: not known

    def take(self, which: np.ndarray) -> "Column":
        """Some of the views: a mask or indices."""
        up = None if self.up is None else self.up[which]
        return Column(self.keypoints[which], self.seen[which], self.truth[which], up)


def views(joints: np.ndarray, seed: int = SEED) -> dict[str, Column]:
    """Every column, of poses [F,14,3] in metres, y up."""
    rng = np.random.default_rng(seed)
    truth, up = cameras.look_and_up(joints, rng)
    columns = conditions(truth, cameras.project(truth), rng, up)
    for name, rig in STRESS.items():
        columns[name] = exact(*cameras.look_and_up(joints, rng, rig))
    columns["sideways"] = sideways(columns["gt"], rng)
    return columns


def exact(truth: np.ndarray, up: np.ndarray) -> Column:
    """Whole poses [F,14,3] in camera axes, exactly seen."""
    keypoints = cameras.keypoints(cameras.project(truth))
    return Column(keypoints, np.ones(truth.shape[:2], bool), truth, up)


def sideways(column: Column, rng: np.random.Generator) -> Column:
    """The same poses, exactly seen by cameras that are rolled by 90 degrees, to either side."""
    side = np.where(rng.random(len(column.truth)) < 0.5, 1.0, -1.0)

    def rolled(points: np.ndarray) -> np.ndarray:
        """Camera axes [F,n,3] after the roll."""
        x, y, z = np.moveaxis(points, -1, 0)
        return np.stack([side[:, None] * y, -side[:, None] * x, z], -1)

    return exact(rolled(column.truth), rolled(column.up[:, None])[:, 0])


def conditions(
    truth: np.ndarray, exact: np.ndarray, rng: np.random.Generator, up: np.ndarray | None = None
) -> dict[str, Column]:
    """Views of poses, exact, noisy, as by a detector and with joints missing.

    truth [F,14,3] camera axes, metres; exact [F,14,2], where a camera sees it, pixels; up [F,3].
    """
    whole = np.ones(exact.shape[:2], bool)
    points = {"gt": (exact, whole)}
    for name, sigma in NOISE.items():
        points[name] = (cameras.gaussian_noise(exact, sigma, rng), whole)
    points["cpm"] = (cameras.detector_noise(exact, rng), whole)
    points["rand2"] = (exact, cameras.hide_random(len(exact), 2, rng))
    for limb in LIMBS:
        points[limb] = (exact, cameras.hide_limb(len(exact), limb))
    return {
        n: Column(cameras.keypoints(p, seen), seen, truth, up) for n, (p, seen) in points.items()
    }
