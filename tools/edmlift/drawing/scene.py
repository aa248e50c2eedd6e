"""What is drawn, in metres and pixels: poses, the views of them, and the windows that hold them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.joints import BONES, INDEX, JOINTS, indices
from edmlift.lifting import Poses

Array = NDArray[np.float64]

# Drawn bones, each with its side: the skeleton's, but a spine and a pelvis for the two long bones
# from the neck to the hips.  The 15th point is midway between the hips.
HIPS = indices(("right_hip", "left_hip"))
SHOULDERS = indices(("right_shoulder", "left_shoulder"))
MIDDLE = len(JOINTS)
JOINT_SIDE = [
    next((side for side in ("right", "left") if name.startswith(side)), "trunk") for name in JOINTS
]
DRAWN: list[tuple[int, int, str]] = [
    (a, b, "trunk" if b in SHOULDERS else JOINT_SIDE[b]) for a, b in BONES if b not in HIPS
]
DRAWN += [(INDEX["neck_base"], MIDDLE, "trunk"), *((MIDDLE, hip, "trunk") for hip in HIPS)]
TORSO = SHOULDERS + HIPS[::-1]

VIEWER = 5.0  # metres from which a pose is looked at
RAISED = 12.0  # degrees by which the viewer looks down
GRID = 0.25  # metres: side of a floor square
_ANGLES = np.arange(0.0, 360.0, 15.0)


@dataclass(frozen=True)
class View:
    """From where a pose is looked at."""

    name: str
    azimuth: float  # degrees walked round the person, from the camera to its right
    elevation: float = RAISED  # degrees looked down


CAMERA = View("from the camera", 0.0)
SIDE = View("from the side", 90.0)
ABOVE = View("from above", 0.0, 90.0)
VIEWS = (CAMERA, SIDE, ABOVE)


def look(points: ArrayLike, view: View) -> Array:
    """Camera axes [...,3] -> right, up and towards the viewer, in metres, in mild perspective."""
    at = np.asarray(points, float)
    a, e = np.radians(view.azimuth), np.radians(view.elevation)
    x, up, near = at[..., 0], -at[..., 1], -at[..., 2]
    right, near = np.cos(a) * x - np.sin(a) * near, np.sin(a) * x + np.cos(a) * near
    up, near = np.cos(e) * up - np.sin(e) * near, np.sin(e) * up + np.cos(e) * near
    scale = VIEWER / (VIEWER - near)
    return np.stack([right * scale, up * scale, near], -1)


def level(points: ArrayLike, pitch: float) -> Array:
    """Axes of a camera that looks down by so many degrees -> those of a level one, [...,3]."""
    c, s = np.cos(np.radians(pitch)), np.sin(np.radians(pitch))
    x, y, z = np.moveaxis(np.asarray(points, float), -1, 0)
    return np.stack([x, c * y + s * z, c * z - s * y], -1)


def with_middle(points: Array) -> Array:
    """[14,D] -> [15,D]: adds the point midway between the hips, or the one hip that is not NaN."""
    hips = points[HIPS]
    hips = hips[np.isfinite(hips).all(1)]
    middle = hips.mean(0) if len(hips) else np.full(points.shape[1], np.nan)
    return np.vstack([points, middle])


@dataclass(frozen=True)
class Scene:
    """F poses, and windows that hold all of them at one scale."""

    keypoints: Array  # [F,14,3] pixels and confidence
    poses: Array  # [F,14,3] metres; y = 0 is the floor
    status: NDArray[np.str_]  # [F]
    seen: NDArray[np.bool_]  # [F,14]
    truth: Array | None  # [F,14,3], moved with the poses
    image_centre: Array  # [F,2] pixels
    image_size: Array  # [2] pixels; 0 where there are no keypoints
    window: Array  # metres, raised views: left, right, bottom, top
    half: float  # metres: half the side of the view from above

    @property
    def aspect(self) -> float:
        """Width by height of the raised views."""
        left, right, bottom, top = self.window
        return float((right - left) / (top - bottom))

    def panel_size(self, view: View, scale: float) -> tuple[float, float]:
        """Width and height of a view's panel at so many pixels a metre."""
        left, right, bottom, top = self.view_window(view)
        return scale * float(right - left), scale * float(top - bottom)

    @property
    def has_image(self) -> bool:
        return bool(self.image_size.any())

    def view_window(self, view: View) -> Array:
        """Left, right, bottom and top of a view, in metres."""
        if view.elevation < 45:
            return self.window
        return np.array([-self.half, self.half, -self.half, self.half])


def scene_of(
    poses: Poses, truth: NDArray[Any] | None, pitch: float, steady: bool, max_aspect: float
) -> Scene:
    """Levels the poses, stands them on the floor and finds the windows.

    steady      the image's window does not move with the person
    max_aspect  width by height of the image's window, at most
    """
    joints = level(poses.joints, pitch)
    floor = np.nan_to_num(joints[..., 1].max(1), nan=0)[:, None] * [0.0, 1.0, 0.0]
    joints = joints - floor[:, None]
    true = None
    if truth is not None:  # a pose that was refused stands nowhere
        true = np.where(poses.ok[:, None, None], level(truth, pitch) - floor[:, None], np.nan)
    keypoints = poses.keypoints.astype(float)
    shown = poses.seen & np.isfinite(keypoints).all(-1)
    window, half = _windows(joints if true is None else np.concatenate([joints, true]))
    low, high = _boxes(keypoints, shown)
    if steady and len(low):
        low, high = (np.broadcast_to(f(b, 0), b.shape) for f, b in ((np.min, low), (np.max, high)))
    size = 1.16 * (high - low).max(0, initial=0)
    if size.any():
        aspect = (window[1] - window[0]) / (window[3] - window[2])
        aspect = np.clip(size[0] / max(size[1], 1e-9), aspect, max(aspect, max_aspect))
        size = np.maximum(size, [size[1] * aspect, size[0] / aspect])
    return Scene(
        keypoints, joints, poses.status, poses.seen, true, (low + high) / 2, size, window, half
    )


def _windows(poses: Array) -> tuple[Array, float]:
    """The window that holds the poses from all round, and half that of the view from above."""
    points = poses.reshape(-1, 3)
    points = points[np.isfinite(points).all(1)]
    if len(points) == 0:
        points = np.array([[0.0, -1.7, 0.0], [0.0, 0.0, 0.0]])
    radius = max(0.5, float(np.hypot(points[:, 0], points[:, 2]).max()))
    rotated = np.concatenate([look(points, View("", angle)) for angle in _ANGLES])
    half = 1.06 * max(radius, float(np.abs(rotated[:, 0]).max()))
    front = look([0.0, 0.0, -floor_half(half)], CAMERA)[1]
    bottom, top = min(float(rotated[:, 1].min()), front), max(0.5, float(rotated[:, 1].max()))
    margin = 0.05 * (top - bottom)
    above = 1.06 * floor_half(half)
    return np.array([-half, half, bottom - margin, top + 1.6 * margin]), max(half, above)


def floor_half(half: float) -> float:
    """Half the side of the floor: whole squares, within a window's half."""
    return float(max(2, np.floor(half / GRID / 1.08)) * GRID)


def _boxes(keypoints: Array, shown: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Corners [F,2] of the seen joints; a pose that has none gets a mean place."""
    points = np.where(shown[..., None], keypoints[..., :2], np.nan)
    some = np.isfinite(points).any((1, 2))
    low, high = np.zeros((2, len(points), 2))
    if some.any():
        low[some], high[some] = np.nanmin(points[some], 1), np.nanmax(points[some], 1)
        low[~some] = high[~some] = (low[some] + high[some]).mean(0) / 2
    return low, high
