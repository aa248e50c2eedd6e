"""Angles of poses, in degrees: how limbs bend and lift, how the trunk leans, where a person faces.

`angles` is for poses of `lift` and `track`.  The others take joints [...,14,3] of any unit, with x
right, y down and z away from the camera.  `up` is where upwards is in these axes, [3] or one a
pose, of any length; the default is a level camera.  The C library computes, in float32: errors of
1e-5 degrees.  docs/angles.md defines each angle.
"""

import ctypes

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import OK, POSE, load, pointers
from edmlift.joints import INDEX, mid_hip
from edmlift.keypoints import read_up, seen_bits
from edmlift.lifting import Poses, batched

LEVEL = (0.0, -1.0, 0.0)  # up before a level camera
_PAIRS = (
    "elbow_flexion",
    "knee_flexion",
    "hip_flexion",
    "hip_abduction",
    "shoulder_elevation",
    "shoulder_plane",
    "shoulder_flexion",
    "shoulder_abduction",
)
ANGLES = (  # in the order of enum edml_angle
    *(f"{side}_{name}" for name in _PAIRS for side in ("right", "left")),
    "trunk_lean",
    "trunk_lean_forward",
    "trunk_lean_right",
    "heading",
)
BENDING = ("right_elbow", "left_elbow", "right_knee", "left_knee")  # in the order of flexion()
_REACH = 3.9  # metres from mid-hip: the C library takes 4


def angles(poses: Poses, up: ArrayLike | None = None) -> dict[str, NDArray[np.float32]]:
    """The angles of poses in degrees, each [F], by the names in ANGLES (docs/angles.md).

    up  where upwards is in the camera's axes, of any length, [3] or one a pose [F,3]; the default
        is a level camera.  Only the trunk's lean and the heading depend on it

    NaN where there is no pose, where a joint that the angle needs was not seen, and where there is
    no direction to measure, as the flexion of an arm that is held out sideways.  One pose gives
    numbers without the axis F.
    """
    given, single = batched(poses)
    directions = read_up(LEVEL if up is None else up, len(given.joints))
    assert directions is not None  # it is known
    found = measure(load(), given.joints, given.seen, directions)
    return {name: found[0, n] if single else found[:, n] for n, name in enumerate(ANGLES)}


def every(joints: ArrayLike, up: ArrayLike = LEVEL) -> NDArray[np.float32]:
    """All angles [...,20] of joints [...,14,3], in the order of ANGLES.  A joint that is NaN was
    not seen; joints may be anywhere and of any size."""
    points = np.asarray(joints, float)
    shape = points.shape[:-2]
    flat = points.reshape(-1, *points.shape[-2:])
    root = mid_hip(flat)[:, None]
    flat = flat - np.where(np.isfinite(root), root, 0)
    size = np.abs(np.where(np.isfinite(flat), flat, 0)).max((1, 2), initial=0)[:, None, None]
    flat = (flat * (_REACH / np.maximum(size, _REACH))).astype(np.float32)
    above = np.broadcast_to(np.asarray(up, float), (*shape, 3)).reshape(-1, 3)
    directions = read_up(above, len(flat))
    assert directions is not None
    seen = np.ones(flat.shape[:2], bool)
    return measure(load(), flat, seen, directions).reshape(*shape, len(ANGLES))


def flexion(joints: ArrayLike) -> NDArray[np.float32]:
    """How far elbows and knees are bent [...,4], in the order of BENDING: 0 is straight, 90 a right
    angle between the bones, 180 folded.  A straight standing leg of motion capture has 3 to 10.
    NaN where a joint is NaN, or a bone has no length."""
    return every(joints, LEVEL)[..., : len(BENDING)]


def lean(joints: ArrayLike, up: ArrayLike = LEVEL) -> NDArray[np.float32]:
    """Angle [...] of the trunk, from between the hips to the neck, with the vertical: 0 is upright,
    90 lies, 180 stands on the head."""
    return every(joints, up)[..., ANGLES.index("trunk_lean")]


def heading(joints: ArrayLike, up: ArrayLike = LEVEL) -> NDArray[np.float32]:
    """Which way the torso faces [...], about the vertical, -180 to 180: 0 is towards the camera, 90
    to the right of the image, 180 away from the camera.

    The torso faces at a right angle to the line from its right to its left side, the mean of
    shoulders and hips.  NaN where that line is nearly upright, as of people who lie on a side, and
    before a camera that looks straight down.
    """
    return every(joints, up)[..., ANGLES.index("heading")]


def side_slope(joints: ArrayLike, up: ArrayLike = LEVEL) -> NDArray[np.float64]:
    """Angle [...] of the line from the torso's right to its left side with the horizontal: 0 to
    90."""
    return np.abs(90.0 - between(_across(joints), np.asarray(up, float)))


def turn(from_angle: ArrayLike, to_angle: ArrayLike) -> NDArray[np.float64]:
    """By how much an angle is larger than another one, the short way round: -180 to 180."""
    difference = np.asarray(to_angle, float) - np.asarray(from_angle, float)
    angle: NDArray[np.float64] = (difference + 180.0) % 360.0 - 180.0
    return angle


def between(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angle [...] between vectors [...,3]; NaN where one of them is 0."""
    first, second = unit(a), unit(b)
    apart = np.linalg.norm(first - second, axis=-1)
    together = np.linalg.norm(first + second, axis=-1)
    angle: NDArray[np.float64] = np.degrees(2 * np.arctan2(apart, together))
    return angle


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors [...,3] of length 1; NaN where the length is 0."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        found: NDArray[np.float64] = vectors / length
    return found


# ---- For the library, unchecked ----------------------------------------------------------------


def measure(
    c: ctypes.CDLL,
    joints: NDArray[np.float32],
    seen: NDArray[np.bool_],
    up: NDArray[np.float32],
) -> NDArray[np.float32]:
    """edml_angles() [F,20] of joints [F,14,3] metres, those that were seen [F,14], up [F,3].  A
    joint that is NaN was not seen."""
    known = np.asarray(np.isfinite(joints).all(-1))
    given = np.zeros(len(joints), POSE)
    given["joint"] = np.where(known[..., None], joints, 0)
    given["seen"] = seen_bits(seen & known)
    found = np.full((len(joints), len(ANGLES)), np.nan, np.float32)
    directions = np.ascontiguousarray(up, np.float32)
    status = [c.edml_angles(*row) for row in pointers(found, given, directions)]
    found[np.array(status, int) != OK] = np.nan
    return found


def _across(joints: ArrayLike) -> NDArray[np.float64]:
    """From the right to the left side of the torso [...,3], both of shoulders and hips."""
    points = np.asarray(joints, float)
    parts = ("shoulder", "hip")
    left, right = (
        sum(points[..., INDEX[f"{side}_{part}"], :] for part in parts) for side in ("left", "right")
    )
    across: NDArray[np.float64] = np.asarray(left - right)
    return across
