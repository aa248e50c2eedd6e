"""2D joints in, 3D poses out."""

import ctypes
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from ctypes import c_int
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import JOINT_COUNT, OK, POSE, POSE_Q, load, pointer, pointers
from edmlift.formats import find_format
from edmlift.joints import MIRROR
from edmlift.keypoints import (
    adapt_joints,
    adapt_joints_q,
    camera_q,
    from_q16,
    read_cameras,
    read_keypoints,
    read_up,
    refusable,
    seen_bits,
    to_q16,
    unmirrored,
    up_q,
)
from edmlift.mistakes import likely_mistakes
from edmlift.networks import Model, find_model

_WORTH_A_THREAD = {"fconv": 2}  # poses, by the model's name without its weights; of others ...
_WORTH_ONE = 200
_WORTH_A_LOOK = 1000  # poses, spread over a run, that tell a mistake
_Record = TypeVar("_Record")


@dataclass(frozen=True, repr=False)
class Poses:
    """F poses, or one without the leading axis; numbers are NaN where status is not "ok"."""

    joints: NDArray[np.float32]  # [F,14,3] metres; x right, y down, z away; origin at mid-hip
    misfit: NDArray[np.float32]  # [F] metres, RMS: how far the network's points are from the image
    status: NDArray[np.str_]  # [F] "ok", or why there is no pose
    seen: NDArray[np.bool_]  # [F,14] in the image
    keypoints: NDArray[np.float32]  # [F,14,3] pixels and confidence that the poses come from
    # Likely mistakes in what was given, each with what to do; none is certain.
    warnings: tuple[str, ...] = field(default=(), kw_only=True)

    def __repr__(self) -> str:
        return summary(self)

    @property
    def ok(self) -> NDArray[np.bool_]:
        """[F] whether there is a pose."""
        return np.asarray(np.asarray(self.status) == "ok")

    @classmethod
    def of(
        cls, joints: ArrayLike, keypoints: ArrayLike | None = None, status: ArrayLike = "ok"
    ) -> "Poses":
        """Poses from elsewhere, joints [F,14,3] or [14,3], for the functions that take poses.

        keypoints, of the shape of joints, are where they were seen; without them every joint counts
        as seen, and what needs the image (`place`, `quality`) refuses.
        """
        points = np.asarray(joints, np.float32)
        if points.ndim not in (2, 3) or points.shape[-2:] != (JOINT_COUNT, 3):
            raise ValueError(f"joints must be [F,14,3] or [14,3], not {list(points.shape)}")
        image = np.asarray(np.nan if keypoints is None else keypoints, np.float32)
        if keypoints is not None and image.shape != points.shape:
            raise ValueError(f"keypoints must be {list(points.shape)}, not {list(image.shape)}")
        image = np.broadcast_to(image, points.shape)
        nothing = np.full(points.shape[:-2], np.nan, np.float32)
        statuses = np.broadcast_to(np.asarray(status, np.str_), points.shape[:-2])
        seen = np.ones(points.shape[:-1], bool) if keypoints is None else image[..., 2] > 0
        return cls(points, nothing, statuses, seen, image)


def lift(
    keypoints: ArrayLike,
    model: str | None = None,
    up: ArrayLike | None = None,
    *,
    format: str | None = None,
    threshold: float | None = None,
    image: ArrayLike | None = None,
    camera: ArrayLike | None = None,
    mirrored: bool = False,
    fixed: bool = False,
    threads: int | None = None,
) -> Poses:
    """Lifts 2D poses to 3D (the paper's section 3).

    keypoints  [F,K,2] x and y, or [F,K,3] with a confidence; or one pose without F.  Pixels, y
               down, of any size and offset.  [.., 2] means that all were seen, but for NaN in x or
               y, and for 0,0 and -1,-1 exactly, which detectors write for what they have not found
    model      one of `models()`; default "distances_f32", with `fixed` "distances_w16"
    up         where upwards is in the camera's axes, of any length, [3] or one a pose [F,3], as an
               accelerometer at rest measures it; (0, -1, 0) is a level camera.  Default: not known
    format     the detector's keypoint order, one of FORMATS, such as "coco17".  Default: K is 14
               and the keypoints are JOINTS, as `adapt` returns them.
    threshold  a confidence up to this counts as not seen, as do NaN and what is negative.  Default:
               0.1 with a format, whose model has not found it then; 0 without
    image      (width, height) in pixels, or one a pose [F,2]: keypoints outside are not seen,
               whatever the detector invents there.  "blazepose33" and "movenet17", which are
               normalised by it, need it
    camera     fx, fy, cx, cy in pixels, or the 3x3 matrix, of a camera without distortion, if it is
               known, or one a pose [F,4]: people off its axis are then lifted as if it looked at
               them, and do not come out turned
    mirrored   the picture is a mirror image, as selfie cameras show it: x becomes width - x (-x
               without `image`), and right and left are exchanged
    fixed      lift in fixed point, to the bits of a core without an FPU; coordinates within 8192
    threads    how many processors to use at most.  Default: all of them

    Returns Poses; one pose for one.  A pose that cannot be lifted has a status and NaN:
    "too_few_joints" (fewer than 10 seen), "not_finite" (infinity), "degenerate" (on a point or a
    line, or like no person), "camera" (that camera cannot have seen it).  What looks like a mistake
    in five poses or more is in `Poses.warnings`.  ValueError: the arguments are wrong.
    """
    if threads is not None and threads < 1:
        raise ValueError(f"threads must be 1 or more, not {threads}")
    chosen = find_model(model, fixed)
    given, single = read_keypoints(keypoints, format, threshold, image)
    layout = None if format is None else find_format(format)
    directions = read_up(up, len(given))
    cameras = None if camera is None else read_cameras(camera, len(given))
    if mirrored and camera is not None and image is None:
        raise ValueError("mirrored= with camera= needs image=(width, height)")
    seen = unmirrored(given, image) if mirrored else given
    sides = MIRROR if mirrored else slice(None)
    if fixed:
        given_q = to_q16(refusable(seen))
        joints_q = given_q if layout is None else adapt_joints_q(load(), given_q, layout)
        poses = lift_joints_q(chosen, joints_q[:, sides], directions, cameras, threads)
    else:
        joints = seen if layout is None else adapt_joints(load(), seen, layout)
        poses = lift_joints(chosen, joints[:, sides], directions, cameras, threads)
    if single:
        return first(poses)
    return replace(poses, warnings=run_warnings(poses, given, format))


def run_warnings(poses: Poses, given: NDArray[np.float32], format: str | None) -> tuple[str, ...]:
    """Likely mistakes in the keypoints [F,K,3] that poses were lifted from."""
    found = np.flatnonzero(poses.ok)
    spread = found[:: 1 + len(found) // _WORTH_A_LOOK]
    lifted = picked(poses, spread)
    return likely_mistakes(lifted.keypoints, quality_of(load(), lifted), given[spread], format)


def first(record: _Record) -> _Record:
    """The first pose of a record of arrays, without the leading axis."""
    return picked(record, 0)


def picked(record: _Record, which: Any) -> _Record:
    """Some of the poses of a record of arrays; what is no array, such as warnings, stays."""
    parts = ((f.name, getattr(record, f.name)) for f in fields(record))  # type: ignore[arg-type]
    chosen = {name: part[which] for name, part in parts if isinstance(part, np.ndarray)}
    return replace(record, **chosen)  # type: ignore[type-var]


def summary(record: Any) -> str:
    """Poses or placements in a line: how many there are, and how many of each status."""
    names, counts = np.unique(record.status, return_counts=True)
    statuses = ", ".join(f"{n} {name}" for name, n in zip(names, counts, strict=True))
    shape = list(np.shape(record.joints))
    return f"{type(record).__name__}(joints {shape}: {statuses or 'none'})"


def batched(poses: Poses) -> tuple[Poses, bool]:
    """Poses with a leading axis, and whether it was missing."""
    if not isinstance(poses, Poses):
        raise TypeError(f"poses must be Poses of lift() or Poses.of(), not {type(poses).__name__}")
    single = poses.joints.ndim == 2
    if not single:
        return poses, False
    parts = {f.name: getattr(poses, f.name) for f in fields(poses) if f.name != "warnings"}
    arrays: dict[str, Any] = {name: np.asarray(part)[None] for name, part in parts.items()}
    return replace(poses, **arrays), True


# ---- For the library, unchecked ----------------------------------------------------------------


def lift_joints(
    model: Model,
    joints: NDArray[np.float32],
    up: NDArray[np.float32] | None = None,
    camera: NDArray[np.float32] | None = None,
    threads: int | None = None,
) -> Poses:
    """edml_lift() of joints [F,14,3], up [F,3] and the cameras [4] or [F,4] where known."""
    joints = np.ascontiguousarray(joints, np.float32)
    poses, status = _call(model, "", joints, up, camera, POSE, threads)
    return to_poses(model, poses, status, joints, 1)


def lift_joints_q(
    model: Model,
    joints: NDArray[np.void],
    up: NDArray[np.float32] | None = None,
    camera: NDArray[np.float32] | None = None,
    threads: int | None = None,
) -> Poses:
    """edml_lift_q() of joints KEYPOINT_Q [F,14], up [F,3], the cameras [4] or [F,4] where known."""
    directions = None if up is None else up_q(up)
    intrinsics = None if camera is None else camera_q(camera)
    poses, status = _call(model, "_q", joints, directions, intrinsics, POSE_Q, threads)
    return to_poses(model, poses, status, from_q16(joints), 1 / 65536)


def _call(
    model: Model,
    suffix: str,
    joints: NDArray[Any],
    up: NDArray[Any] | None,
    camera: NDArray[Any] | None,
    kind: np.dtype[np.void],
    threads: int | None,
) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """Poses [F] and status [F] of edml_lift_many() with this suffix, on so many processors."""
    joints = np.ascontiguousarray(joints)
    directions = None if up is None else np.ascontiguousarray(up)
    cameras = None if camera is None else np.atleast_2d(camera)
    function = getattr(model.c, f"edml_lift_many{suffix}")
    poses, status = np.zeros(len(joints), kind), np.zeros(len(joints), c_int)

    def run(start: int, end: int) -> None:
        """Frames from start to end: a call a camera."""
        work = model.work()
        for first, last in _with_one_camera(cameras, start, end):
            above = None if directions is None else pointer(directions[first:])
            known = None if cameras is None else pointer(cameras[first % len(cameras) :])
            function(
                pointer(poses[first:]), pointer(status[first:]), pointer(joints[first:]), above,
                known, last - first, model.address, work, model.work_bytes,
            )  # fmt: skip

    least = _WORTH_A_THREAD.get(model.name.partition("_")[0], _WORTH_ONE)
    side_by_side(run, len(joints), least, threads)
    return poses, status


def _with_one_camera(
    cameras: NDArray[Any] | None, start: int, end: int
) -> Iterator[tuple[int, int]]:
    """Parts of the frames from start to end: one behind another with the same camera."""
    if start == end:
        return
    changes = []
    if cameras is not None and len(cameras) > 1:
        differ = (cameras[start + 1 : end] != cameras[start : end - 1]).any(1)
        changes = (np.flatnonzero(differ) + start + 1).tolist()
    yield from pairwise([start, *changes, end])


def side_by_side(
    run: Callable[[int, int], None], count: int, least: int, threads: int | None = None
) -> None:
    """run(start, end) of a part of `count` for each processor, of `least` or more: while C runs,
    so may another.  On `threads` processors at most, or all."""
    parts = max(1, min(threads or processors(), count // least))
    ends = [count * n // parts for n in range(parts + 1)]
    if parts == 1:
        run(0, count)
        return
    with ThreadPoolExecutor(parts) as pool:
        list(pool.map(run, ends, ends[1:]))


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):  # Linux
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def to_poses(
    model: Model,
    poses: NDArray[np.void],
    status: NDArray[np.int32],
    keypoints: NDArray[np.float32],
    unit: float,
) -> Poses:
    """C's poses, in metres, NaN where one has a status."""
    joints, misfit = (poses[name].astype(np.float32) for name in ("joint", "misfit"))
    for array in (joints, misfit):
        array *= np.float32(unit)
        array[status != OK] = np.nan
    return Poses(joints, misfit, status_names(model.c, status), keypoints[..., 2] > 0, keypoints)


def status_names(c: Any, status: NDArray[np.int32]) -> NDArray[np.str_]:
    """The names of statuses [F]."""
    codes, which = np.unique(status, return_inverse=True)
    names = [c.edml_status_name(int(code)).decode() for code in codes]
    return np.array(names, np.str_)[which]


def c_poses(poses: Poses) -> NDArray[np.void]:
    """Poses [F] as edml_pose."""
    given = np.zeros(len(poses.joints), POSE)
    given["joint"], given["misfit"] = poses.joints, poses.misfit
    given["seen"] = seen_bits(poses.seen)
    return given


def quality_of(c: ctypes.CDLL, poses: Poses) -> NDArray[np.float32]:
    """edml_quality() [F]; NaN where there is no pose."""
    found = np.full(len(poses.joints), np.nan, np.float32)
    given = c_poses(poses)
    for row in pointers(found, given):
        c.edml_quality(*row)
    found[~poses.ok] = np.nan
    return found
