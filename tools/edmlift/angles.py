"""Angles of poses, in degrees: how limbs bend, how the trunk leans, which way a person faces.

Poses are [...,14,3] in metres, as `lift` returns them: x right, y down, z away from the camera.
`up` is where upwards is in these axes, [3] or one a pose, of any length; the default is a level
camera.  NaN comes out where a pose is NaN, or where what is asked has no direction.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.joints import HINGES, INDEX, mid_hip

LEVEL = (0.0, -1.0, 0.0)  # up before a level camera
BENDING = ("right_elbow", "left_elbow", "right_knee", "left_knee")  # in the order of flexion()

_BEFORE, _AT, _BEHIND = np.array(HINGES).T
_TOWARDS_CAMERA = np.array([0.0, 0.0, -1.0])


def flexion(joints: ArrayLike) -> NDArray[np.float64]:
    """How far elbows and knees are bent [...,4], in the order of BENDING: 0 is straight, 90 a right
    angle between the bones, 180 folded.  A straight standing leg of motion capture has 3 to 10."""
    points = np.asarray(joints, float)
    before = points[..., _AT, :] - points[..., _BEFORE, :]
    behind = points[..., _BEHIND, :] - points[..., _AT, :]
    return between(before, behind)


def lean(joints: ArrayLike, up: ArrayLike = LEVEL) -> NDArray[np.float64]:
    """Angle [...] of the trunk, from between the hips to the neck, with the vertical: 0 is upright,
    90 lies, 180 stands on the head."""
    points = np.asarray(joints, float)
    return between(points[..., INDEX["neck_base"], :] - mid_hip(points), np.asarray(up, float))


def heading(joints: ArrayLike, up: ArrayLike = LEVEL) -> NDArray[np.float64]:
    """Which way the torso faces [...], about the vertical, -180 to 180: 0 is towards the camera, 90
    to the right of the image, 180 away from the camera.

    The torso faces at a right angle to the line from its right to its left side, the mean of
    shoulders and hips.  It says little where that line is upright, as of people who lie on a side;
    side_slope() tells.
    """
    vertical = unit(np.asarray(up, float))
    forward = np.cross(_across(joints), vertical)
    level = _TOWARDS_CAMERA - (vertical @ _TOWARDS_CAMERA)[..., None] * vertical
    right = np.cross(vertical, level)
    east, north = (forward * right).sum(-1), (forward * level).sum(-1)
    angle = np.degrees(np.arctan2(east, north))
    return np.where(np.hypot(east, north) > 0, angle, np.nan)


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


def _across(joints: ArrayLike) -> NDArray[np.float64]:
    """From the right to the left side of the torso [...,3], both of shoulders and hips."""
    points = np.asarray(joints, float)
    parts = ("shoulder", "hip")
    left, right = (
        sum(points[..., INDEX[f"{side}_{part}"], :] for part in parts) for side in ("left", "right")
    )
    across: NDArray[np.float64] = np.asarray(left - right)
    return across
