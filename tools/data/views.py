"""The views on which accuracy is measured: poses before virtual cameras, whose 2D is spoiled.

A column of a table is one kind of 2D: exact (`gt`), with noise of 5 to 20 pixels (`n5` ... `n20`),
as an imitated detector sees (`cpm`), with two joints or a limb missing (`rand2`, `left_arm` ...),
by rolled cameras and by close ones.  One seed gives the same views each time.
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

    def take(self, which: np.ndarray) -> "Column":
        """Some of the views: a mask or indices."""
        return Column(self.keypoints[which], self.seen[which], self.truth[which])


def views(joints: np.ndarray, seed: int = SEED) -> dict[str, Column]:
    """Every column, of poses [F,14,3] in metres, y up."""
    rng = np.random.default_rng(seed)
    truth = cameras.look(joints, rng)
    columns = conditions(truth, cameras.project(truth), rng)
    for name, rig in STRESS.items():
        other = cameras.look(joints, rng, rig)
        whole = np.ones(other.shape[:2], bool)
        columns[name] = Column(cameras.keypoints(cameras.project(other)), whole, other)
    return columns


def conditions(truth: np.ndarray, exact: np.ndarray, rng: np.random.Generator) -> dict[str, Column]:
    """Views of poses, exact, noisy, as by a detector and with joints missing.

    truth [F,14,3] camera axes, metres; exact [F,14,2], where a camera sees it, pixels.
    """
    whole = np.ones(exact.shape[:2], bool)
    points = {"gt": (exact, whole)}
    for name, sigma in NOISE.items():
        points[name] = (cameras.gaussian_noise(exact, sigma, rng), whole)
    points["cpm"] = (cameras.detector_noise(exact, rng), whole)
    points["rand2"] = (exact, cameras.hide_random(len(exact), 2, rng))
    for limb in LIMBS:
        points[limb] = (exact, cameras.hide_limb(len(exact), limb))
    return {n: Column(cameras.keypoints(p, seen), seen, truth) for n, (p, seen) in points.items()}
