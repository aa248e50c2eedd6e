"""Where a pose stands: before a camera, or on the floor."""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import OK, PLACEMENT, Point, load
from edmlift.keypoints import image_size, read_camera, read_up
from edmlift.lifting import Poses, batched, c_poses, first, pointers, status_names, summary
from edmlift.networks import Model, find_model

_FIELDS = ("joint", "rotation", "translation", "reprojection")


@dataclass(frozen=True, repr=False)
class Placements:
    """F placements, or one without the leading axis; NaN where status is not "ok"."""

    joints: NDArray[np.float32]  # [F,14,3] metres, camera axes, origin at the camera's centre
    rotation: NDArray[np.float32]  # [F,3,3]: joints = rotation @ pose + translation
    translation: NDArray[np.float32]  # [F,3] metres: where mid-hip is
    reprojection: NDArray[np.float32]  # [F] pixels: RMS distance from the keypoints
    focal: NDArray[np.float32]  # [F] pixels, along x: given, or found by the sweep
    steps: NDArray[np.uint16]  # [F] iterations
    status: NDArray[np.str_]  # [F] "ok", or why there is no placement

    def __repr__(self) -> str:
        return summary(self)


def place(
    poses: Poses,
    camera: ArrayLike | None = None,
    *,
    image: tuple[float, float] | None = None,
) -> Placements:
    """Places lifted poses before the camera that saw them (docs/where-in-the-room.md).

    poses   as from `lift` or `track`; the keypoints that they come from are in them
    camera  fx, fy, cx, cy in pixels, or the 3x3 matrix, of a camera without distortion
    image   (width, height) in pixels, instead of camera: the focal length that fits best, of 12, is
            taken (section 4 of the paper), and distances are then a guess

    One pose gives one placement.  Statuses: "too_few_joints" (fewer than 7 seen), "degenerate",
    "camera" (that camera cannot have seen it), and that of a pose which was not lifted.
    """
    if (camera is None) == (image is None):
        raise ValueError("place() takes either camera=(fx, fy, cx, cy) or image=(width, height)")
    given, single = batched(poses)
    model = find_model()
    if image is None:
        placed = place_joints(model, given, read_camera(camera))
    else:
        sizes = np.tile(np.array(image_size(image), np.float32), (len(given.joints), 1))
        placed = place_joints_by_sweep(model, given, sizes)
    return first(placed) if single else placed


def stand(poses: Poses, up: ArrayLike = (0.0, -1.0, 0.0)) -> NDArray[np.float32]:
    """Stands poses on the floor: joints [F,14,3] in metres, y up from the floor under the lower
    ankle's foot, x right and z towards the camera, from mid-hip; NaN where there is no pose.

    up  where upwards is in the camera's axes, of any length, [3] or one a pose [F,3], as an
        accelerometer at rest measures it; the default is a level camera
    """
    given, single = batched(poses)
    directions = read_up(up, len(given.joints))
    assert directions is not None  # up was given
    out, _ = stand_joints(load(), given, directions)
    return out[0] if single else out


# ---- For the library, unchecked ----------------------------------------------------------------


def place_joints(model: Model, poses: Poses, camera: NDArray[np.float32]) -> Placements:
    """edml_place() before a camera [4]."""

    def run(_i: int, at: list[int]) -> int:
        placement, camera, pose, seen = at
        code: int = model.c.edml_place(placement, pose, seen, camera, work, model.work_bytes)
        return code

    work = model.work()
    return _placed(model, poses, camera, run)


def place_joints_by_sweep(model: Model, poses: Poses, sizes: NDArray[np.float32]) -> Placements:
    """edml_place_sweep() in images of these sizes [F,2]."""

    def run(i: int, at: list[int]) -> int:
        placement, camera, pose, seen = at
        size = [float(side) for side in sizes[i]]
        code: int = model.c.edml_place_sweep(
            placement, camera, pose, seen, *size, work, model.work_bytes
        )
        return code

    work = model.work()
    return _placed(model, poses, np.full(4, np.nan, np.float32), run)


def _placed(
    model: Model,
    poses: Poses,
    camera: NDArray[np.float32],
    run: Callable[[int, list[int]], int],
) -> Placements:
    """Calls `run`, for each pose, with its number and where placement, camera, pose and keypoints
    are."""
    given, keypoints = c_poses(poses), np.ascontiguousarray(poses.keypoints, np.float32)
    placed = np.zeros(len(given), PLACEMENT)
    for field in _FIELDS:
        placed[field] = np.nan
    cameras = np.tile(camera, (len(given), 1))
    rows = pointers(placed, cameras, given, keypoints)
    status = np.array([run(i, row) for i, row in enumerate(rows)], np.int32)
    focal = np.where(status == OK, cameras[:, 0], np.float32(np.nan))
    names = np.where(poses.ok, status_names(model.c, status), poses.status)
    joints, rotation, translation, reprojection = (placed[field] for field in _FIELDS)
    return Placements(joints, rotation, translation, reprojection, focal, placed["steps"], names)


def stand_joints(
    c: ctypes.CDLL, poses: Poses, up: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.str_]]:
    """edml_stand() of poses, up [F,3]: joints [F,14,3] and the names of the status [F]."""
    given, out = c_poses(poses), np.full(poses.joints.shape, np.nan, np.float32)
    status = [
        c.edml_stand(target, pose, Point(*direction))
        for (target, pose), direction in zip(pointers(out, given), up.tolist(), strict=True)
    ]
    return out, status_names(c, np.array(status, np.int32))
