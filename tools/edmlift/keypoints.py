"""What callers give, checked and brought to the 14 joints that a lift takes."""

import ctypes
import math
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import JOINT_COUNT, KEYPOINT_Q, Format, load, pointer
from edmlift.formats import BY_SQUARE, FORMATS, find_format
from edmlift.joints import MIRROR

MAX_PROPORTION = 10.0  # of the image's size, that a keypoint outside the image may have
DETECTOR_THRESHOLD = 0.1  # the default for a detector's scores: docs/detectors.md says why
_IN_CACHE = 1024  # poses: what a processor keeps at hand between two sums


def adapt(
    keypoints: ArrayLike,
    format: str,
    *,
    threshold: float | None = None,
    image: ArrayLike | None = None,
    mirrored: bool = False,
) -> NDArray[np.float32]:
    """A detector's keypoints to the 14 joints: [F,K,2 or 3] -> [F,14,3], [K,2 or 3] -> [14,3].

    keypoints, threshold, image and mirrored are as in `lift`.  Limbs are copied; head and neck are
    put where the models have them, with half the least confidence of what they are made of.
    """
    joints, single = read_joints(keypoints, format, threshold, image, mirrored)
    return joints[0] if single else joints


def read_joints(
    keypoints: ArrayLike,
    format: str | None = None,
    threshold: float | None = None,
    image: ArrayLike | None = None,
    mirrored: bool = False,
) -> tuple[NDArray[np.float32], bool]:
    """The joints [F,14,3] that `lift` is to take, and whether one pose was given without F."""
    given, single = read_keypoints(keypoints, format, threshold, image)
    if mirrored:
        given = unmirrored(given, image)
    if format is not None:
        given = adapt_joints(load(), given, find_format(format))
    return (np.ascontiguousarray(given[:, MIRROR]) if mirrored else given), single


def read_keypoints(
    keypoints: ArrayLike,
    format: str | None,
    threshold: float | None,
    image: ArrayLike | None,
) -> tuple[NDArray[np.float32], bool]:
    """Keypoints [F,K,3] in pixels, c 0 where not seen, and whether one pose was given without F."""
    layout = None if format is None else find_format(format)
    count = JOINT_COUNT if layout is None else int(layout.keypoints)
    array = _numbers(keypoints)
    if array.ndim not in (2, 3) or array.shape[-2] != count or array.shape[-1] not in (2, 3):
        raise ValueError(_wrong_shape(array.shape, format, count))
    single = array.ndim == 2
    seen = _with_confidence(array[None] if single else array, _threshold(threshold, format))
    return _in_pixels(seen, layout, image), single


def unmirrored(keypoints: NDArray[np.float32], image: ArrayLike | None) -> NDArray[np.float32]:
    """Keypoints [F,K,3] in pixels with x as it was before the mirror; the names of sides stay."""
    widths = 0.0 if image is None else image_sizes(image, len(keypoints))[..., 0]
    given = keypoints.copy()
    given[..., 0] = np.float32(widths) - given[..., 0]
    return given


def _threshold(threshold: float | None, format: str | None) -> float:
    """What was given, checked, or the default."""
    if threshold is None:
        return 0.0 if format is None else DETECTOR_THRESHOLD
    if not (isinstance(threshold, Real) and math.isfinite(threshold) and threshold >= 0):
        raise ValueError(f"threshold must be a finite number >= 0, not {threshold}")
    return float(threshold)


def _numbers(keypoints: ArrayLike) -> NDArray[np.float32]:
    if isinstance(keypoints, np.ma.MaskedArray):  # what is masked is missing
        keypoints = np.ma.filled(np.ma.asarray(keypoints, float), np.nan)
    array = np.asarray(keypoints)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"keypoints must be real numbers in one array, not of dtype {array.dtype}")
    with np.errstate(over="ignore"):  # what is too large becomes infinite, which the lift refuses
        return array.astype(np.float32, copy=False)


def _wrong_shape(shape: tuple[int, ...], format: str | None, count: int) -> str:
    what = "the 14 joints" if format is None else f"format {format!r}"
    text = (
        f"keypoints of {what} must be [F,{count},2] or [F,{count},3], or one pose without F, "
        f"not {list(shape)}"
    )
    fits = [name for name, n in FORMATS.items() if len(shape) >= 2 and n == shape[-2]]
    if format is None:
        text += "; a detector's keypoints need format=, one of " + ", ".join(fits or FORMATS)
    return text


def _with_confidence(array: NDArray[np.float32], threshold: float) -> NDArray[np.float32]:
    """[F,K,3]: c is 1 where none was given, and 0 for what was not seen: up to the threshold or
    NaN, or at a place that detectors write for nothing: NaN, 0,0 or -1,-1."""
    given = np.empty((*array.shape[:-1], 3), np.float32)
    given[..., 2] = 1
    given[..., : array.shape[-1]] = array
    scored = array.shape[-1] == 3
    for first in range(0, len(given), _IN_CACHE):
        some = given[first : first + _IN_CACHE]
        x, y, c = np.moveaxis(some, -1, 0).copy()  # each in a row, which is twice as fast
        nowhere = np.isnan(x) | np.isnan(y)
        unseen = nowhere | ((x == y) & ((x == 0) | (x == -1)))
        if scored:
            unseen |= ~(c > np.float32(threshold))
        if unseen.any():
            some[unseen, 2] = 0
            some[nowhere, :2] = 0
    return given


def _in_pixels(
    keypoints: NDArray[np.float32], layout: Format | None, image: ArrayLike | None
) -> NDArray[np.float32]:
    """Keypoints in pixels, x first; those outside the image, where it is known, are not seen."""
    sizes = None if image is None else image_sizes(image, len(keypoints))
    if layout is None or not layout.normalised:
        return keypoints if sizes is None else _inside(keypoints, sizes)
    name = layout.name.decode()
    if sizes is None:
        raise ValueError(
            f"keypoints of format {name!r} are normalised: give the image's size in pixels, "
            "image=(width, height)"
        )
    if look_like_pixels(keypoints).any():
        raise ValueError(
            f"keypoints of format {name!r} are normalised, 0 to 1 within the image, not in pixels"
        )
    if layout.normalised == BY_SQUARE:
        return _inside(_from_square(keypoints, sizes), sizes)
    given = _inside(keypoints, np.ones_like(sizes))
    given[..., :2] *= np.float32(sizes)
    return given


def look_like_pixels(keypoints: NDArray[np.float32]) -> NDArray[np.bool_]:
    """[F]: has a seen keypoint of [F,K,3], in shares of an image, a place far outside of it?"""
    far = (np.abs(keypoints[..., :2]) > MAX_PROPORTION).any(-1)
    return np.asarray((far & (keypoints[..., 2] > 0)).any(-1))


def _from_square(keypoints: NDArray[np.float32], sizes: NDArray[np.float64]) -> NDArray[np.float32]:
    """y, x, c in shares of the square that an image of this size was padded to -> x, y, c."""
    sides = sizes.max(-1, keepdims=True)
    padding = (sides - sizes) / 2
    given = keypoints.copy()
    given[..., :2] = keypoints[..., 1::-1] * np.float32(sides) - np.float32(padding)
    return given


def _inside(keypoints: NDArray[np.float32], sizes: NDArray[np.float64]) -> NDArray[np.float32]:
    """The same with confidence 0 for what is outside an image of this size: detectors invent limbs
    there, and are sure of them."""
    at = keypoints[..., :2]
    outside = ((at < 0) | (at > np.float32(sizes))).any(-1)
    inside = keypoints.copy()
    inside[outside & np.isfinite(keypoints).all(-1), 2] = 0  # else the lift refuses it
    return inside


def read_up(up: ArrayLike | None, count: int) -> NDArray[np.float32] | None:
    """Directions [F,3] of `count` poses from one, or one each; None: not known."""
    if up is None:
        return None
    with np.errstate(over="ignore"):
        given = np.asarray(up, float).astype(np.float32)  # as C takes it
    fits = given.shape in ((3,), (count, 3))
    if not fits or not (np.isfinite(given).all() and given.any(-1).all()):
        raise ValueError(
            f"up must be three finite numbers, not all 0, or so many a pose, not {up!r}"
        )
    return np.ascontiguousarray(np.broadcast_to(given, (count, 3)))


def image_size(image: Any) -> tuple[float, float]:
    """Width and height, checked."""
    width, height = _over_0(image, ((2,),)).tolist()
    return width, height


def image_sizes(image: Any, count: int) -> NDArray[np.float64]:
    """Width and height of the images of `count` poses, checked: [F,1,2], or [1,1,2] of all."""
    return _over_0(image, ((2,), (count, 2))).reshape(-1, 1, 2)


def _over_0(image: Any, shapes: tuple[tuple[int, ...], ...]) -> NDArray[np.float64]:
    sizes = np.asarray(image, float)
    if sizes.shape not in shapes or not (np.isfinite(sizes).all() and (sizes > 0).all()):
        each = ", or so many a pose" if len(shapes) > 1 else ""
        raise ValueError(
            f"image must be (width, height) in pixels, both over 0{each}, not {image!r}"
        )
    return sizes


def read_cameras(camera: Any, count: int) -> NDArray[np.float32]:
    """fx, fy, cx, cy of `count` poses [F,4], or [1,4] of all, from these or from a matrix."""
    numbers = np.asarray(camera, np.float32)
    if numbers.shape != (count, 4):
        return read_camera(camera)[None]
    if not (np.isfinite(numbers).all() and (numbers[:, :2] > 0).all()):
        raise ValueError("each camera must be fx, fy, cx, cy in pixels, fx, fy > 0")
    return numbers


def read_camera(camera: Any) -> NDArray[np.float32]:
    """fx, fy, cx, cy [4] of those, or of a camera matrix."""
    numbers = np.asarray(camera, np.float32)
    if numbers.shape == (3, 3):
        others = numbers[[0, 1, 2, 2, 2], [1, 0, 0, 1, 2]]
        if not np.array_equal(others, [0, 0, 0, 0, 1]):
            raise ValueError("a camera matrix must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]")
        numbers = numbers[[0, 1, 0, 1], [0, 1, 2, 2]]
    if numbers.shape != (4,) or not (np.isfinite(numbers).all() and (numbers[:2] > 0).all()):
        raise ValueError(f"camera must be fx, fy, cx, cy in pixels, fx, fy > 0, not {camera!r}")
    return numbers


# ---- For the library, unchecked ----------------------------------------------------------------


def adapt_joints(
    c: ctypes.CDLL, keypoints: NDArray[np.float32], layout: Format
) -> NDArray[np.float32]:
    """edml_adapt_many() of keypoints [F,K,3] in pixels -> [F,14,3]."""
    keypoints = np.ascontiguousarray(keypoints, np.float32)
    joints = np.zeros((len(keypoints), JOINT_COUNT, 3), np.float32)
    c.edml_adapt_many(pointer(joints), pointer(keypoints), len(joints), ctypes.addressof(layout))
    return joints


def refusable(keypoints: NDArray[np.float32]) -> NDArray[np.float32]:
    """Keypoints [F,K,3] for to_q16(): a confidence that is not finite has no number in fixed
    point, but a coordinate that is not finite has one that is refused."""
    given = keypoints.copy()
    given[~np.isfinite(keypoints[..., 2])] = -np.inf, 0, 1
    return given


def adapt_joints_q(c: ctypes.CDLL, keypoints: NDArray[np.void], layout: Format) -> NDArray[np.void]:
    """edml_adapt_many_q() of keypoints KEYPOINT_Q [F,K] -> [F,14]."""
    keypoints = np.ascontiguousarray(keypoints)
    joints = np.zeros((len(keypoints), JOINT_COUNT), KEYPOINT_Q)
    c.edml_adapt_many_q(pointer(joints), pointer(keypoints), len(joints), ctypes.addressof(layout))
    return joints


def to_q16(keypoints: ArrayLike) -> NDArray[np.void]:
    """Keypoints [F,K,3] as KEYPOINT_Q [F,K]; what is out of range, or NaN, its nearest end."""
    x, y, c = np.moveaxis(np.asarray(keypoints, np.float64), -1, 0)
    out = np.zeros(x.shape, KEYPOINT_Q)
    out["at"][..., 0] = np.rint(_within(x * 65536, 2.0**31))
    out["at"][..., 1] = np.rint(_within(y * 65536, 2.0**31))
    out["c"] = np.ceil(_within(c * 32768, 2.0**15))
    return out


def _within(numbers: NDArray[np.float64], limit: float) -> NDArray[np.float64]:
    """The nearest from -limit to below limit; NaN becomes -limit."""
    return np.fmin(np.fmax(numbers, -limit), limit - 1)


def from_q16(keypoints: NDArray[np.void]) -> NDArray[np.float32]:
    """The inverse: KEYPOINT_Q [F,K] -> [F,K,3]."""
    out = np.empty((*keypoints.shape, 3), np.float32)
    out[..., 0] = keypoints["at"][..., 0] / 65536
    out[..., 1] = keypoints["at"][..., 1] / 65536
    out[..., 2] = keypoints["c"] / 32768
    return out


def up_q(up: NDArray[np.float32]) -> NDArray[np.int32]:
    """Directions [F,3] as edml_point_q, whose unit does not matter: the largest component is 1."""
    largest = np.abs(up).max(-1, keepdims=True).astype(float)
    scaled: NDArray[np.int32] = np.round(up / largest * 65536).astype(np.int32)
    return scaled


def camera_q(camera: NDArray[np.float32]) -> NDArray[np.int32]:
    """fx, fy, cx, cy [4] as edml_camera_q; what is out of range, the nearest that is."""
    inside = np.clip(camera.astype(float) * 65536, -(2.0**31), 2.0**31 - 1)
    rounded: NDArray[np.int32] = np.round(inside).astype(np.int32)
    return rounded


def seen_bits(seen: NDArray[np.bool_]) -> NDArray[np.uint16]:
    """Bit j: joint j was seen; [...,14] -> [...]."""
    bits: NDArray[np.uint16] = (seen @ (1 << np.arange(JOINT_COUNT))).astype(np.uint16)
    return bits


def from_bits(bits: NDArray[np.uint16]) -> NDArray[np.bool_]:
    """The inverse: [...] -> [...,14]."""
    flags: NDArray[np.bool_] = bits[..., None] & (1 << np.arange(JOINT_COUNT, dtype=np.uint16)) != 0
    return flags
