"""The C library as ctypes sees it: its structures, its functions, and where its file is."""

import ctypes
import functools
import os
import platform
import sys
from collections.abc import Iterator
from ctypes import c_char_p, c_float, c_int, c_int32, c_size_t, c_uint8, c_uint16, c_uint32
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

JOINT_COUNT = 14
BONE_COUNT = 13
PAIR_COUNT = 91
OK = 0
NO_KEYPOINT = 255  # in an edml_format: the detector has no such keypoint
OBJECTIVES = ("none", "square", "raw", "eq2")  # edml_objective

# ---- Structures --------------------------------------------------------------------------------


def _pose(number: DTypeLike) -> np.dtype[np.void]:
    return np.dtype(
        [
            ("joint", number, (JOINT_COUNT, 3)),
            ("misfit", number),
            ("seen", np.uint16),
        ],
        align=True,
    )


POSE = _pose(np.float32)  # edml_pose
POSE_Q = _pose(np.int32)  # edml_pose_q: Q16
IMAGE = np.dtype(  # edml_image: the image in the body's frame
    [
        ("at", np.float32, (JOINT_COUNT, 2)),
        ("down", np.float32, 2),
        ("seen", np.uint16),
    ],
    align=True,
)
PREDICTION = np.dtype(  # edml_prediction
    [
        ("distance", np.float32, PAIR_COUNT),
        ("share", np.float32, JOINT_COUNT),
        ("x", np.float32, (JOINT_COUNT, 3)),
    ]
)
KEYPOINT_Q = np.dtype([("at", np.int32, 2), ("c", np.int16)], align=True)  # Q16, Q15
PLACEMENT = np.dtype(
    [
        ("joint", np.float32, (JOINT_COUNT, 3)),
        ("rotation", np.float32, (3, 3)),
        ("translation", np.float32, 3),
        ("reprojection", np.float32),
        ("steps", np.uint16),
    ],
    align=True,
)
BODY = np.dtype([("height", np.float32), ("bone", np.float32, BONE_COUNT)])
MEASURED_BODY = np.dtype(  # edml_measured_body
    [("body", BODY), ("seen", np.uint8, BONE_COUNT), ("poses", np.uint8)], align=True
)
PATH = np.dtype(  # edml_path
    [
        ("at", np.float32, 3),
        ("rate", np.float32, 3),
        ("time", np.uint32),
        ("placements", np.uint16),
    ],
    align=True,
)
FOCAL = np.dtype(  # edml_focal
    [
        ("width", np.float32),
        ("height", np.float32),
        ("misfit", np.float32, 12),
        ("poses", np.uint16),
    ],
    align=True,
)
_SMOOTHING = np.dtype([("cutoff", np.float32), ("slope", np.float32)])
_MOVING = np.dtype([("at", np.float32, 3), ("rate", np.float32, 3)])
_TRACKED_JOINT = np.dtype(
    [
        ("image", _MOVING),
        ("space", _MOVING),
        ("innovation", np.float32, 2),
        ("age", np.uint16),
    ],
    align=True,
)
TRACK = np.dtype(
    [
        ("smooth_image", _SMOOTHING),
        ("smooth_space", _SMOOTHING),
        ("noise_full", np.float32),
        ("jitter", np.float32),
        ("image_step", np.float32),
        ("space_step", np.float32),
        ("elapsed", np.uint32),
        ("held", np.uint16),
        ("swapped", np.uint8),
        ("mirrored", np.uint8),
        ("leapt", np.uint8),
        ("started", np.uint8),
        ("aside", np.uint16),
        ("time", np.uint32),
        ("arms_log_odds", np.float32),
        ("legs_log_odds", np.float32),
        ("mirror_log_odds", np.float32),
        ("joint", _TRACKED_JOINT, JOINT_COUNT),
    ],
    align=True,
)


class Format(ctypes.Structure):
    """edml_format: indices of a detector's keypoints; NO_KEYPOINT where it has none."""

    _fields_ = [
        ("name", c_char_p),
        ("keypoints", c_uint8),
        ("normalised", c_uint8),
        ("limb", c_uint8 * (JOINT_COUNT - 2)),
        ("ears", c_uint8 * 2),
        ("face", c_uint8 * 3),
        ("crown", c_uint8),
        ("centre", c_uint8),
    ]


class Point(ctypes.Structure):
    """edml_point, passed by value."""

    _fields_ = [(axis, c_float) for axis in "xyz"]


class PointQ(ctypes.Structure):
    """edml_point_q, passed by value."""

    _fields_ = [(axis, c_int32) for axis in "xyz"]


# ---- Functions ---------------------------------------------------------------------------------

_POINTER = ctypes.c_void_p
_STATUS = c_int
_WORK = (_POINTER, c_size_t)
_VOID = None

# What each function returns, and what it takes.  Each name that ends in * stands for two functions:
# the float one, without a suffix, and the fixed-point one, with _q.
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "edml_status_name": (c_char_p, _STATUS),
    "edml_model_name": (c_char_p, _POINTER),
    "edml_model_check": (_STATUS, _POINTER),
    "edml_model_work_bytes*": (c_size_t, _POINTER),
    "edml_adapt*": (_VOID, _POINTER, _POINTER, _POINTER),
    "edml_lift*": (_STATUS, *[_POINTER] * 4, *_WORK),
    "edml_lift_with_camera*": (_STATUS, *[_POINTER] * 5, *_WORK),
    "edml_lift_many*": (c_int, *[_POINTER] * 5, c_int, _POINTER, *_WORK),
    "edml_adapt_many*": (_VOID, _POINTER, _POINTER, c_int, _POINTER),
    "edml_place": (_STATUS, _POINTER, _POINTER, _POINTER, _POINTER, *_WORK),
    "edml_place_sweep": (_STATUS, *[_POINTER] * 4, c_float, c_float, *_WORK),
    "edml_path_start": (_VOID, _POINTER),
    "edml_path_follow": (_STATUS, _POINTER, _POINTER, c_uint32),
    "edml_focal_start": (_STATUS, _POINTER, c_float, c_float),
    "edml_focal_add": (_STATUS, *[_POINTER] * 3, *_WORK),
    "edml_focal_camera": (_STATUS, _POINTER, _POINTER),
    "edml_track_start*": (_VOID, _POINTER),
    "edml_track_lift*": (_STATUS, *[_POINTER] * 3, c_uint32, *[_POINTER] * 2, *_WORK),
    "edml_track_distance": (c_float, _POINTER, _POINTER, c_uint32),
    "edml_track_distance_q": (c_int32, _POINTER, _POINTER, c_uint32),
    "edml_track_swap_sides*": (_VOID, _POINTER, _POINTER),
    "edml_fit_body*": (_STATUS, _POINTER, _POINTER),
    "edml_measure_start*": (_VOID, _POINTER),
    "edml_measure_body*": (_STATUS, _POINTER, _POINTER),
    "edml_quality*": (_STATUS, _POINTER, _POINTER),
    "edml_uncertainty": (_STATUS, _POINTER, c_uint16),
    "edml_joint_limits*": (_STATUS, _POINTER, _POINTER),
    "edml_reflect_by_joint_limits*": (_STATUS, _POINTER, _POINTER),
    "edml_stand": (_STATUS, _POINTER, _POINTER, Point),
    "edml_stand_q": (_STATUS, _POINTER, _POINTER, PointQ),
    "edml_angles*": (_STATUS, *[_POINTER] * 3),
    "edml_angle_name": (c_char_p, c_int),
    "edml_body_frame*": (_STATUS, _POINTER, _POINTER, c_int, _POINTER),
    "edml_edm*": (_VOID, _POINTER, _POINTER),
    "edml_predict*": (_STATUS, *[_POINTER] * 4, *_WORK),
    "edml_jacobi*": (_VOID, _POINTER, _POINTER),
    "edml_mds*": (_VOID, _POINTER, _POINTER, _POINTER),
    "edml_refine*": (c_int, _POINTER, _POINTER, c_int, c_int, _POINTER),
    "edml_stress": (c_float, _POINTER, _POINTER, c_int),
    "edml_stress_q": (c_int32, _POINTER, _POINTER, c_int),
    "edml_mirror*": (_VOID, _POINTER, _POINTER),
    "edml_align*": (_VOID, _POINTER, _POINTER, _POINTER),
    "edml_orient*": (_STATUS, _POINTER, _POINTER),
    "edml_fuse": (c_float, *[_POINTER] * 4),
    "edml_fuse_q": (c_int32, *[_POINTER] * 4),
}


def _declare(library: ctypes.CDLL, path: Path) -> None:
    for pattern, (result, *arguments) in _SIGNATURES.items():
        for name in [pattern] if pattern[-1] != "*" else [pattern[:-1], pattern[:-1] + "_q"]:
            try:
                function = getattr(library, name)
            except AttributeError:
                raise ImportError(f"{path} has no {name}(): build it again") from None
            function.restype, function.argtypes = result, arguments


def pointer(array: NDArray[Any]) -> int:
    """The address of an array's first element; the caller keeps the array."""
    return array.ctypes.data


def pointers(*arrays: NDArray[Any]) -> Iterator[tuple[int, ...]]:
    """The addresses of each row of arrays of F rows, F times."""
    rows = zip(*(count(pointer(array), array.strides[0]) for array in arrays), strict=True)
    return islice(rows, len(arrays[0]))


# ---- The file ----------------------------------------------------------------------------------

_HERE = Path(__file__).resolve().parent
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_PREFIX = "" if sys.platform == "win32" else "lib"
INSTALLED = _HERE / f"{_PREFIX}edmlift{_SUFFIX}"
BUILT = _HERE.parents[1] / "build" / "dev" / f"{_PREFIX}edmlift_tools{_SUFFIX}"


def default_path() -> Path:
    """What EDMLIFT_LIBRARY names, or the library in the package, or that of build/dev."""
    if named := os.environ.get("EDMLIFT_LIBRARY"):
        return Path(named)
    is_working_copy = (_HERE.parents[1] / "include" / "edmlift.h").exists()
    return BUILT if is_working_copy and not INSTALLED.exists() else INSTALLED


def load(path: Path | None = None) -> ctypes.CDLL:
    """The C library, every function declared; loaded once a file."""
    return _load_named(path or default_path())


@functools.cache
def _load_named(path: Path) -> ctypes.CDLL:
    return _load(path.resolve())


@functools.cache
def _load(path: Path) -> ctypes.CDLL:
    if not path.exists():
        raise FileNotFoundError(
            f"{path}: the C library is not there. `pip install --force-reinstall edmlift` brings "
            "it; in a clone `pip install .` builds it into the package, "
            "`cmake -S . -B build/dev -DEDMLIFT_TOOLS=ON && cmake --build build/dev` for a working "
            "copy; or let EDMLIFT_LIBRARY name its file"
        )
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        machine = f"{platform.system()} on {platform.machine()}"
        raise ImportError(
            f"{path} is no library for this Python ({machine}): `pip install --force-reinstall "
            f"--no-cache-dir edmlift` gets the right one, or compiles it ({error})"
        ) from None
    _declare(library, path)
    return library
