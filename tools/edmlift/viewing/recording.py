"""What a page shows: the numbers of all frames, small enough for an hour of video.

Lengths are in millimetres, 16 bits; 2D joints and the values of curves have a step of their own.
Arrays are the base64 of little-endian integers.
"""

import base64
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.drawing.palette import SIDE_NAMES
from edmlift.drawing.scene import DRAWN, JOINT_SIDE
from edmlift.joint_angles import flexion, heading, lean
from edmlift.joints import JOINTS
from edmlift.keypoints import read_up
from edmlift.lifting import Poses
from edmlift.metrics import joint_errors

Array = NDArray[np.float64]

MISSING = -32768  # an integer of 16 bits that stands for NaN
_LARGEST = 32767
_MARGIN = 0.1  # of the 2D joints' box, on each side
_OUTLIERS = 1.0  # per cent of frames at each end that the box leaves out
_ROOM = 4.0  # of the box's size: what is farther outside is drawn at this distance


def recording_of(
    poses: Poses,
    truth: Array | None,
    quality: Array | None,
    fps: float,
    up: ArrayLike,
    image: tuple[float, float] | None,
) -> dict[str, Any]:
    """The page's data: F poses, truth [F,14,3] in metres, quality [F], frames a second, up, and the
    image's size in pixels."""
    upwards = read_up(up, len(poses.joints))
    assert upwards is not None  # up was given
    upright = np.asarray(upwards, float)
    axes = _level_axes(upright)
    names, codes = np.unique(poses.status, return_inverse=True)
    joints = np.where(poses.ok[:, None, None], poses.joints, np.nan).astype(float)
    return {
        "frames": len(joints),
        "fps": float(fps),
        "joints": JOINTS,
        "bones": DRAWN,
        "jointSides": JOINT_SIDE,
        "sideNames": SIDE_NAMES,
        "statuses": [str(name) for name in names],
        "status": _packed(codes.reshape(-1), "<u2"),
        "seen": _packed(poses.seen @ (1 << np.arange(len(JOINTS))), "<u2"),
        "poses": _packed_lengths(joints @ axes),
        "truth": None if truth is None else _packed_lengths(truth @ axes),
        "image": _image(poses, image),
        "curves": _curves(joints, truth, quality, upright),
    }


def _level_axes(up: Array) -> Array:
    """Matrices [F,3,3] whose columns are a level camera's axes in those of a camera with up [F,3]:
    points as rows @ matrix are in x right, y down, z away."""
    down = -up / np.linalg.norm(up, axis=-1, keepdims=True)
    straight = np.abs(down[:, 2:]) > 0.999  # down or up: its own y says where ahead is
    ahead = np.where(straight, [0.0, -1.0, 0.0] * np.sign(down[:, 2:]), [0.0, 0.0, 1.0])
    right = np.cross(down, ahead)
    right /= np.linalg.norm(right, axis=-1, keepdims=True)
    return np.stack([right, down, np.cross(right, down)], -1)


# ---- The image ---------------------------------------------------------------------------------


def _image(poses: Poses, size: tuple[float, float] | None) -> dict[str, Any] | None:
    """The 2D joints, and the box of the image that is shown, all of it if its size is known; None
    where there are no joints."""
    points = poses.keypoints[..., :2].astype(float)
    shown = poses.seen & np.isfinite(points).all(-1)
    if not shown.any():
        return None
    points = np.where(shown[..., None], points, np.nan)
    low, high = _box(points[shown.any(1)]) if size is None else (np.zeros(2), np.array(size))
    middle, extent = (low + high) / 2, max(float((high - low).max()), 1e-6)
    step = _ROOM * extent / _LARGEST
    confidence = np.nan_to_num(np.clip(poses.keypoints[..., 2].astype(float), 0, 1))
    return {
        "box": [*_rounded(low), *_rounded(high)],
        "origin": _rounded(middle),
        "step": float(f"{step:.8g}"),
        "points": _packed_values(points - middle, step),
        "confidence": _packed(np.rint(255 * confidence), "u1"),
    }


def _box(points: Array) -> tuple[Array, Array]:
    """Corners [2] of the box that holds the seen joints [F,14,2] of nearly all frames."""
    low = np.percentile(np.nanmin(points, 1), _OUTLIERS, axis=0)
    high = np.percentile(np.nanmax(points, 1), 100 - _OUTLIERS, axis=0)
    margin = _MARGIN * float((high - low).max())
    return low - margin, high + margin


def _rounded(values: Array) -> list[float]:
    return [float(f"{value:.8g}") for value in values]


# ---- Curves ------------------------------------------------------------------------------------


def _curves(
    joints: Array, truth: Array | None, quality: Array | None, up: Array
) -> list[dict[str, Any]]:
    """What is drawn over time: a row of lines each, with its scale."""
    both = [joints] if truth is None else [joints, truth]
    bends = [flexion(points).astype(float) for points in both]
    elbows, knees = ([bend[:, part] for bend in bends] for part in (slice(0, 2), slice(2, 4)))
    leans = [lean(points, up)[:, None].astype(float) for points in both]
    headings = [heading(points, up)[:, None].astype(float) for points in both]
    sides = ("right", "left")
    rows = [
        _row("Elbows", "°", sides, elbows, step=0.1, about="0 is straight"),
        _row("Knees", "°", sides, knees, step=0.1, about="0 is straight"),
        _row("Trunk lean", "°", ("trunk",), leans, step=0.1, about="0 is upright"),
        _row("Heading", "°", ("trunk",), headings, step=0.1, about="0 is towards the camera, "
             "90 to the right of the image", wraps=True),
    ]  # fmt: skip
    if quality is not None:
        about = "the chance that the mean joint error is under 100 mm"
        values = [quality[:, None]]
        rows.append(_row("Quality", "", ("trunk",), values, step=0.001, about=about, digits=2))
    if truth is not None:
        error = 1000 * joint_errors(joints, truth).mean(-1)
        about = "mean distance of the joints from the truth, hips laid together"
        rows.append(_row("Error", "mm", ("trunk",), [error[:, None]], step=0.1, about=about))
    return rows


def _row(
    name: str, unit: str, sides: Sequence[str], values: Sequence[Array], *, step: float,
    about: str, digits: int = 0, wraps: bool = False,
) -> dict[str, Any]:  # fmt: skip
    """A row: lines of values[0] [F,lines], dashed ones of values[1] if there is truth."""
    low, high = _scale(values, unit, wraps)
    return {
        "name": name, "unit": unit, "about": about, "digits": digits, "wraps": wraps,
        "low": low, "high": high, "step": step,
        "lines": [
            {"side": side, "dashed": n > 0, "values": _packed_values(lines[:, i], step)}
            for n, lines in enumerate(values)
            for i, side in enumerate(sides)
        ],
    }  # fmt: skip


def _scale(values: Sequence[Array], unit: str, wraps: bool) -> tuple[float, float]:
    """Ends of a row's scale, round numbers around all values."""
    if unit == "":
        return 0.0, 1.0
    known = np.concatenate([part[np.isfinite(part)] for part in values])
    lowest, highest = (known.min(), known.max()) if len(known) else (0.0, 0.0)
    if wraps:
        low, high = 30 * np.floor(lowest / 30), 30 * np.ceil(highest / 30)
        middle = 30 * np.round((low + high) / 60)
        low, high = min(low, middle - 30), max(high, middle + 30)
        return (-180.0, 180.0) if high - low > 180 else (float(low), float(high))
    if unit == "°":
        return 0.0, next((top for top in (30.0, 60.0, 90.0, 120.0) if highest <= top), 180.0)
    size = 10 ** np.floor(np.log10(max(highest, 10.0)))
    return 0.0, float(next(n * size for n in (1, 2, 3, 5, 10) if highest <= n * size))


# ---- Packing -----------------------------------------------------------------------------------


def _packed(values: NDArray[Any], type_: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, np.dtype(type_)).tobytes()).decode()


def _packed_values(values: Array, step: float) -> str:
    """Multiples of a step; NaN is MISSING, and what is too large the largest there is."""
    counts = np.clip(np.rint(np.asarray(values, float) / step), -_LARGEST, _LARGEST)
    return _packed(np.where(np.isnan(counts), MISSING, counts), "<i2")


def _packed_lengths(metres: Array) -> str:
    return _packed_values(metres, 0.001)
