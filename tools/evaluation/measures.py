"""How accuracy is measured: the error of poses, and means over people.

The error of a pose is the mean distance of its 14 joints from the truth after rigid alignment
without scale; a figure is the mean over subjects of their means.  Poses that a lifter refuses are
counted, and left out of the means.
"""

from collections.abc import Sequence
from typing import Any, Protocol, TypeVar

import numpy as np
from tqdm import tqdm

from data.mocap import Motion
from data.views import SEED, Column, views
from edmlift.joints import JOINTS, mid_hip
from edmlift.library import Poses
from edmlift.metrics import joint_errors, rigid_errors

PCK = 0.150  # metres: a joint within this counts as found
RESAMPLES = 1000  # of the subjects, for the confidence interval
MIRROR_IMAGE = [1, 1, -1]  # times a pose: its reflection in depth

Figures = dict[str, Any]  # of a column, mm unless said otherwise
T = TypeVar("T")


class Lifter(Protocol):
    """The library, or a rival."""

    def lift(self, keypoints: np.ndarray) -> Poses:
        """Poses of keypoints [F,14,3]; the library takes up=, too."""


def lift(lifter: Lifter, column: Column, up: np.ndarray | None = None) -> Poses:
    """The poses of a column; up [F,3], if it is told, is for lifters that take it."""
    return lifter.lift(column.keypoints) if up is None else lifter.lift(column.keypoints, up=up)


def by_subject(values: np.ndarray, subject: np.ndarray) -> np.ndarray:
    """Mean of the values [F] of each subject; NaN values are left out."""
    return np.array([np.nanmean(values[subject == s]) for s in np.unique(subject)])


def bootstrap(means: np.ndarray) -> list[float]:
    """95 % interval of the mean over subjects, by resampling the subjects."""
    rng = np.random.default_rng(SEED)
    draws = rng.choice(means, (RESAMPLES, len(means))).mean(1)
    return np.percentile(draws, [2.5, 97.5]).tolist()


def mean_errors(joints: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Error of each pose, [F] in mm, of joints and truth [F,14,3]."""
    return 1000 * rigid_errors(joints, truth).mean(1)


def mean_error(joints: np.ndarray, truth: np.ndarray, subject: np.ndarray) -> float:
    """The mean over subjects of the mean of their poses' errors, mm."""
    return float(by_subject(mean_errors(joints, truth), subject).mean())


def camera_errors(joints: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Error of each pose in the camera's axes, mid-hips together, [F] in mm."""
    rooted = joints - (truth - mid_hip(truth)[:, None])
    return 1000 * np.linalg.norm(rooted, axis=-1).mean(1)


def measure(lifter: Lifter, column: Column, subject: np.ndarray) -> Figures:
    """All figures of a column."""
    poses = lift(lifter, column)
    fine = poses.status == "ok"
    joints, truth, seen = poses.joints[fine].astype(float), column.truth[fine], column.seen[fine]
    subject = subject[fine]
    error = 1000 * rigid_errors(joints, truth)
    mirrored = mean_errors(joints * MIRROR_IMAGE, truth)
    right = error.mean(1) <= mirrored
    oracle = np.minimum(error.mean(1), mirrored)
    scaled = 1000 * joint_errors(joints, truth, "similarity").mean(1)
    means = by_subject(error.mean(1), subject)
    result = {
        "error": means.mean(),
        "interval": bootstrap(means),
        "oracle_mirror": by_subject(oracle, subject).mean(),
        "mirror_right_percent": 100 * by_subject(right.astype(float), subject).mean(),
        "mirror_right_percent_of_frames": 100 * right.mean(),
        "with_scale": by_subject(scaled, subject).mean(),
        "camera_axes": by_subject(camera_errors(joints, truth), subject).mean(),
        "pck150_percent": 100 * by_subject((error < 1000 * PCK).mean(1), subject).mean(),
        "refused": int((~fine).sum()),
        "by_joint": {
            name: by_subject(error[:, j], subject).mean() for j, name in enumerate(JOINTS)
        },
    }
    if not seen.all():
        hidden = np.nanmean(np.where(seen, np.nan, error), 1)
        result["hidden_joints"] = by_subject(hidden, subject).mean()
    return result


def evaluate(lifter: Lifter, motion: Motion) -> dict[str, Figures]:
    """Figures of every column: {column: {figure: value}}."""
    bar = tqdm(views(motion.joints).items(), desc="evaluate", disable=None)
    return {name: measure(lifter, column, motion.subject) for name, column in bar}


def tilted(up: np.ndarray, degrees: float) -> np.ndarray:
    """Directions [F,3] that are off by so many degrees, to any side."""
    side = np.cross(up, np.random.default_rng(SEED).normal(size=up.shape))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    angle = np.radians(degrees)
    return np.cos(angle) * up + np.sin(angle) * side


def both_errors(
    lifter: Lifter, column: Column, subject: np.ndarray, up: np.ndarray | None = None
) -> dict[str, float]:
    """The aligned error and that in the camera's axes, alone; up [F,3], if it is told."""
    poses = lift(lifter, column, up)
    fine = poses.status == "ok"
    joints, truth = poses.joints[fine].astype(float), column.truth[fine]
    errors = {"error": mean_errors(joints, truth), "camera_axes": camera_errors(joints, truth)}
    return {name: by_subject(values, subject[fine]).mean() for name, values in errors.items()}


def person_errors(lifter: Lifter, column: Column, subject: np.ndarray) -> dict[str, float]:
    """Mean error of each person's poses, mm; those that are refused are left out."""
    poses = lifter.lift(column.keypoints)
    fine = poses.status == "ok"
    errors = mean_errors(poses.joints[fine].astype(float), column.truth[fine])
    means = by_subject(errors, subject[fine])
    names = map(str, np.unique(subject[fine]).tolist())
    return dict(zip(names, rounded(means.tolist()), strict=True))


def rounded(value: Any) -> Any:
    """Figures to 3 decimals, so that files do not change with the last bits."""
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return value if isinstance(value, int) else round(float(value), 3)


def chosen(figures: dict[str, Figures], names: Sequence[str]) -> dict[str, Figures]:
    """Some of the figures of every column, where it has them."""
    return {c: {k: row[k] for k in names if k in row} for c, row in figures.items()}
