"""How tall people of motion capture are and how long their bones, and what of it is one's own."""

from dataclasses import dataclass

import numpy as np

from data.head_model import TRAGION_TO_CROWN
from data.mocap import Motion
from edmlift.joints import BONE_TYPE, BONES, INDEX, JOINTS

GOOD = 0.100  # metres: a pose with a mean joint error below this is a good one
ANKLES = [INDEX["right_ankle"], INDEX["left_ankle"]]


@dataclass(frozen=True)
class Bodies:
    """S subjects: number [S], standing height [S] and bones [S,13], metres."""

    subject: np.ndarray
    height: np.ndarray
    bone: np.ndarray


def bone_lengths(joints: np.ndarray) -> np.ndarray:
    """[F,14,3] -> [F,13], metres."""
    start, end = np.array(BONES).T
    return np.linalg.norm(joints[:, end] - joints[:, start], axis=-1)


def by_type(values: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of values [F,13] by the kind of bone, left and right alike."""
    ends = [JOINTS[end] for _, end in BONES]
    return {kind: values[:, [ends.index(j) for j in names]] for kind, names in BONE_TYPE.items()}


def ankle_height(motion: Motion) -> float:
    """Height of a standing foot's ankle above the floor: the median over subjects of low (5th
    percentile) heights of the lower ankle, metres, to the centimetre."""
    low = motion.joints[:, ANKLES, 1].min(1)
    each = [np.percentile(low[motion.subject == s], 5) for s in np.unique(motion.subject)]
    return round(float(np.median(each)), 2)


def bodies(motion: Motion, ankle: float) -> Bodies:
    """Estimates what the data do not say: how tall their people stand.

    The height is the 99th percentile of the head joint's height, which is the ears', above the
    lower ankle, plus the length from ears to crown, plus that of a foot: `ankle`, metres.
    """
    subjects = np.unique(motion.subject)
    ears = motion.joints[:, INDEX["head"], 1] - motion.joints[:, ANKLES, 1].min(1)
    stand = [np.percentile(ears[motion.subject == s], 99) for s in subjects]
    bone = [bone_lengths(motion.joints[motion.subject == s]).mean(0) for s in subjects]
    return Bodies(subjects, np.array(stand) + ankle + TRAGION_TO_CROWN / 1000, np.array(bone))
