"""The 14 joints: names, bones and mirror pairs, in the order of `enum edml_joint`.

Left and right are the subject's.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

JOINTS = (
    "head",
    "neck_base",
    "right_shoulder",
    "right_elbow",
    "right_wrist",
    "left_shoulder",
    "left_elbow",
    "left_wrist",
    "right_hip",
    "right_knee",
    "right_ankle",
    "left_hip",
    "left_knee",
    "left_ankle",
)
INDEX = {name: i for i, name in enumerate(JOINTS)}

# The tree is rooted at the base of the neck, which is its own parent.
PARENT = np.array([1, 1, 1, 2, 3, 1, 5, 6, 1, 8, 9, 1, 11, 12])
# (parent, joint) of the 13 bones, in the order of edml_bones.
BONES = tuple((int(parent), joint) for joint, parent in enumerate(PARENT) if parent != joint)

# Elbows and knees in the order of joint_angles.BENDING, each behind its shoulder or hip, and before
# its wrist or ankle.
HINGES = ((2, 3, 4), (5, 6, 7), (8, 9, 10), (11, 12, 13))

# Index of each joint's mirror image.
MIRROR = np.array([0, 1, 5, 6, 7, 2, 3, 4, 11, 12, 13, 8, 9, 10])

# Bone types, left and right alike: the units in which bodies are varied.
BONE_TYPE = {
    "head": ("head",),
    "clavicle": ("right_shoulder", "left_shoulder"),
    "upper_arm": ("right_elbow", "left_elbow"),
    "forearm": ("right_wrist", "left_wrist"),
    "trunk": ("right_hip", "left_hip"),
    "thigh": ("right_knee", "left_knee"),
    "shin": ("right_ankle", "left_ankle"),
}

# The two free joints of each limb.
LIMBS = {
    "right_arm": ("right_elbow", "right_wrist"),
    "left_arm": ("left_elbow", "left_wrist"),
    "right_leg": ("right_knee", "right_ankle"),
    "left_leg": ("left_knee", "left_ankle"),
}
ARMS, LEGS = ("right_arm", "left_arm"), ("right_leg", "left_leg")

# (row, column) of the 91 pairs above the diagonal of a 14x14 matrix, row by row: the order of
# the network's input and output.
PAIRS = np.triu_indices(len(JOINTS), 1)


def _pair_mirror() -> NDArray[np.int_]:
    """Each pair of joints with its mirror pair, left for right: indices into PAIRS [49,2].

    In the order of PAIRS; those that are their own mirror pair, such as the knees, come last.
    """
    number = np.zeros((len(JOINTS), len(JOINTS)), int)
    number[PAIRS] = np.arange(len(PAIRS[0]))
    number += number.T
    mirror = number[MIRROR[PAIRS[0]], MIRROR[PAIRS[1]]]
    first = np.arange(len(mirror))
    return np.concatenate(
        [np.stack([first, mirror], 1)[keep] for keep in (first < mirror, first == mirror)]
    )


PAIR_MIRROR = _pair_mirror()
SELF_MIRRORED = 7  # pairs, the last of PAIR_MIRROR, that are their own mirror pair


def indices(names: Sequence[str]) -> list[int]:
    """Joint indices of joint names."""
    return [INDEX[name] for name in names]


def mid_hip(joints: NDArray[Any]) -> NDArray[Any]:
    """The point midway between the hips, a pose's origin: [..., 14, D] -> [..., D]."""
    return _middle(joints, "hip")


def mid_shoulder(joints: NDArray[Any]) -> NDArray[Any]:
    """The point midway between the shoulders: [..., 14, D] -> [..., D]."""
    return _middle(joints, "shoulder")


def _middle(joints: NDArray[Any], name: str) -> NDArray[Any]:
    right, left = INDEX[f"right_{name}"], INDEX[f"left_{name}"]
    middle: NDArray[Any] = (joints[..., right, :] + joints[..., left, :]) / 2
    return middle


def mirrored(joints: NDArray[Any]) -> NDArray[Any]:
    """What the pose is in a mirror, left for right: [..., 14, 3] -> [..., 14, 3]."""
    image: NDArray[Any] = joints[..., MIRROR, :] * [-1, 1, 1]
    return image
