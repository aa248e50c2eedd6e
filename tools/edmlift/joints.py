"""The 14 joints of CPM-14: names, tree and mirror pairs, in the order of `enum edml_joint`.

Left and right are the subject's. Every other tool imports the skeleton from here.
"""

import numpy as np

JOINTS = (
    "head_top",
    "neck",
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

# The tree is rooted at the neck; PARENT[NECK] is the neck itself.
PARENT = np.array([1, 1, 1, 2, 3, 1, 5, 6, 1, 8, 9, 1, 11, 12])
BONES = [(int(p), j) for j, p in enumerate(PARENT) if p != j]

# Index of each joint's mirror image.
MIRROR = np.array([0, 1, 5, 6, 7, 2, 3, 4, 11, 12, 13, 8, 9, 10])

# Bone types, left and right alike: the units in which bodies are varied.
BONE_TYPE = {
    "head": ("head_top",),
    "clavicle": ("right_shoulder", "left_shoulder"),
    "upper_arm": ("right_elbow", "left_elbow"),
    "forearm": ("right_wrist", "left_wrist"),
    "trunk": ("right_hip", "left_hip"),
    "thigh": ("right_knee", "left_knee"),
    "shin": ("right_ankle", "left_ankle"),
}

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


def pair_twins() -> np.ndarray:
    """Each pair of joints with its twin, the same with left for right: indices into PAIRS [49,2].

    In the order of PAIRS; last come those that are their own, such as that of the knees.
    """
    number = np.zeros((len(JOINTS), len(JOINTS)), int)
    number[PAIRS] = np.arange(len(PAIRS[0]))
    number += number.T
    twin = number[MIRROR[PAIRS[0]], MIRROR[PAIRS[1]]]
    first = np.arange(len(twin))
    return np.concatenate(
        [np.stack([first, twin], 1)[keep] for keep in (first < twin, first == twin)]
    )


PAIR_TWINS = pair_twins()
SELF_TWINS = 7  # of these, their own


def indices(names: tuple[str, ...]) -> list[int]:
    """Joint indices of a tuple of joint names."""
    return [INDEX[name] for name in names]


def mid_hip(joints: np.ndarray) -> np.ndarray:
    """Root of a pose: the point between the hips; [..., 14, D] -> [..., D]."""
    return (joints[..., INDEX["right_hip"], :] + joints[..., INDEX["left_hip"], :]) / 2


def mid_shoulder(joints: np.ndarray) -> np.ndarray:
    """Midpoint of the shoulders: [..., 14, D] -> [..., D]."""
    return (joints[..., INDEX["right_shoulder"], :] + joints[..., INDEX["left_shoulder"], :]) / 2


def mirrored(joints: np.ndarray) -> np.ndarray:
    """What the pose is in a mirror, left for right: [..., 14, 3] -> [..., 14, 3]."""
    return joints[..., MIRROR, :] * [-1, 1, 1]
