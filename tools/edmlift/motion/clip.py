"""A clip: poses in the axes of the world, a frame each."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.joint_angles import unit
from edmlift.joints import INDEX, mid_hip
from edmlift.keypoints import read_up
from edmlift.lifting import Poses, batched
from edmlift.motion.bones import constant_lengths
from edmlift.placing import Placements, stand

_F64 = NDArray[np.float64]
_FLIP = np.array([1.0, -1.0, -1.0])  # from the axes of a level camera: y up, z towards it
_REACH = 4.0  # metres that a joint may be from mid-hip, as for the C library
_STILL = 5.0  # degrees by which the upward directions of a camera that stands still may differ


@dataclass(frozen=True)
class Clip:
    """F frames in metres: x right, y up, z towards the camera."""

    joints: _F64  # [F,14,3] NaN where status is not "ok"
    misfit: _F64  # [F] metres, as in Poses
    status: NDArray[np.str_]  # [F]
    fps: float | None  # frames a second, where they are known
    on_floor: bool  # y is 0 on the floor

    @property
    def ok(self) -> NDArray[np.bool_]:
        """[F] whether there is a pose."""
        return np.asarray(self.status == "ok")

    @property
    def rate(self) -> float:
        """Frames a second, of files that must have them."""
        assert self.fps is not None
        return self.fps

    @property
    def times(self) -> _F64:
        """Seconds [F] from the first frame."""
        return np.arange(len(self.joints)) / self.rate


def clip_of(
    poses: Poses,
    fps: float | None,
    up: ArrayLike | None,
    root: Placements | ArrayLike | None,
    *,
    rigid: bool,
) -> Clip:
    """A clip of poses; arguments as of write_motion(); rigid: bones keep their length."""
    given, _ = batched(poses)
    directions = read_up(up, len(given.joints))
    joints, path, status = _about_hips(given, root)
    ok = status == "ok"
    _check(joints, given.status, ok)
    if rigid:
        joints[ok] = constant_lengths(joints[ok])
    if directions is None:
        joints = (joints if path is None else joints + path[:, None]) * _FLIP
    elif path is None:
        joints = stand(Poses.of(joints, status=status), directions).astype(float)
    else:
        joints = _in_the_room(joints, path, directions)
    return Clip(joints, given.misfit.astype(float), status, fps, directions is not None)


def _about_hips(
    poses: Poses, root: Placements | ArrayLike | None
) -> tuple[_F64, _F64 | None, NDArray[np.str_]]:
    """Joints [F,14,3] in the camera's axes, NaN where there are none; the path [F,3] of their
    origin, if it is known; and the status."""
    joints, status = poses.joints.astype(float), poses.status
    path: _F64 | None = None
    if isinstance(root, Placements):
        placed = root.joints.reshape(-1, *joints.shape[1:])
        path = root.translation.reshape(-1, 3).astype(float)
        if len(path) != len(joints):
            raise ValueError(f"root has {len(path)} placements, but there are {len(joints)} poses")
        joints = placed - path[:, None]
        status = np.where(poses.ok, np.atleast_1d(root.status), status)
    elif root is not None:
        path = np.array(root, float, ndmin=2)
        if path.shape != (len(joints), 3):
            raise ValueError(f"root must be [{len(joints)},3], not {list(path.shape)}")
        lost = poses.ok & ~np.isfinite(path).all(1)
        status = np.where(lost, "not_placed", status)
    joints = np.where((status == "ok")[:, None, None], joints, np.nan)
    return joints, path, status.astype(np.str_)


def _check(joints: _F64, status: NDArray[np.str_], ok: NDArray[np.bool_]) -> None:
    """ValueError where there is no pose, or one that is nobody's."""
    if not ok.any():
        names = ", ".join(sorted({str(name) for name in status})) or "no frames"
        raise ValueError(f"there is no pose to write ({names})")
    far = ~(np.abs(joints[ok] - mid_hip(joints[ok])[:, None]) <= _REACH).all((1, 2))
    if far.any():
        frame = int(np.flatnonzero(ok)[far][0])
        raise ValueError(f"the pose of frame {frame} is not within 4 m: are these metres?")


def _in_the_room(joints: _F64, path: _F64, directions: NDArray[np.float32]) -> _F64:
    """Joints on one floor, at y = 0, below a camera that stands still."""
    towards = unit(directions.astype(float))
    upwards = unit(towards.mean(0))
    if not (towards @ upwards >= np.cos(np.radians(_STILL))).all():
        raise ValueError("root is of a camera that stands still, but up is not the same throughout")
    rotation = _rotation(upwards)
    world = (joints + path[:, None]) @ rotation.T
    standing = stand(Poses.of(joints), upwards)  # NaN where there is no pose
    hips = INDEX["right_hip"]
    floor = np.nanmedian(world[:, hips, 1] - standing[:, hips, 1])
    return np.asarray(world - [0.0, floor, 0.0])


def _rotation(up: _F64) -> _F64:
    """The rotation by which `stand` undoes the camera's roll and pitch."""
    axes = np.zeros((14, 3))
    axes[:3] = np.eye(3)
    stood = stand(Poses.of(axes), up).astype(float)
    return np.asarray((stood[:3] - stood[3]).T)
