"""How far a pose can be trusted: quality, uncertainty, joint limits."""

import ctypes
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from edmlift._binding import OK, POSE_Q, load, pointers
from edmlift.keypoints import seen_bits
from edmlift.lifting import Poses, batched, c_poses, first, quality_of


def quality(poses: Poses) -> NDArray[np.float32]:
    """The chance [F], 0 to 1, that a pose of `lift` has a mean joint error under 100 mm (rigid
    alignment, no scale); NaN where there is none.  For poses as lifted: not after `fit_body`
    (docs/body.md)."""
    given, single = batched(poses)
    found = quality_of(load(), given)
    return found[0] if single else found


def uncertainty(poses: Poses) -> NDArray[np.float32]:
    """Mean error [F,14] in metres of each joint after rigid alignment, given which joints were
    seen: for training people, with a detector's noise.  NaN where there is no pose."""
    given, single = batched(poses)
    found = uncertainty_of(load(), given.seen)
    found[~given.ok] = np.nan
    return found[0] if single else found


def joint_limits(poses: Poses) -> NDArray[np.float32]:
    """How many of nine bones [F] point where no training person's did (section 3.3); NaN where
    there is no pose.  Nearly always 0 for true poses, 3 or more for their mirror images."""
    given, single = batched(poses)
    found = violations_of(load(), given)
    return found[0] if single else found


def reflect_by_joint_limits(poses: Poses) -> tuple[Poses, NDArray[np.float32]]:
    """Reflects in depth each pose whose mirror image breaks fewer joint limits (section 3.3).

    Returns the poses, and how many fewer violations each [F] now has than its mirror image: 0 is
    no opinion.
    """
    given, single = batched(poses)
    reflected, fewer = reflect(load(), given)
    return (first(reflected), fewer[0]) if single else (reflected, fewer)


# ---- For the library, unchecked ----------------------------------------------------------------


def uncertainty_of(c: ctypes.CDLL, seen: NDArray[np.bool_]) -> NDArray[np.float32]:
    """edml_uncertainty() in metres [F,14] given which joints were seen; NaN: too few."""
    found = np.zeros(seen.shape, np.uint8)
    bits = seen_bits(seen)
    status = [
        c.edml_uncertainty(row, int(bit)) for (row,), bit in zip(pointers(found), bits, strict=True)
    ]
    metres = found.astype(np.float32) / np.float32(1000)
    metres[np.array(status, np.int32) != OK] = np.nan
    return metres


def violations_of(c: ctypes.CDLL, poses: Poses, fixed: bool = False) -> NDArray[np.float32]:
    """edml_joint_limits(), or _q, [F]; NaN where there is no pose."""
    count = c.edml_joint_limits_q if fixed else c.edml_joint_limits
    found = np.zeros(len(poses.joints), np.intc)
    given = _c_poses(poses, fixed)
    status = np.array([count(*row) for row in pointers(found, given)], int)
    return np.where(status == OK, np.float32(found), np.float32(np.nan))


def reflect(c: ctypes.CDLL, poses: Poses, fixed: bool = False) -> tuple[Poses, NDArray[np.float32]]:
    """edml_reflect_by_joint_limits(), or _q: poses, and how many fewer [F]; NaN without a pose."""
    apply = c.edml_reflect_by_joint_limits_q if fixed else c.edml_reflect_by_joint_limits
    given, found = _c_poses(poses, fixed), np.zeros(len(poses.joints), np.intc)
    status = np.array([apply(*row) for row in pointers(found, given)], int)
    fewer = np.where(status == OK, found, np.nan).astype(np.float32)
    unit = np.float32(1 / 65536 if fixed else 1)
    joints = np.where((status == OK)[:, None, None], given["joint"] * unit, poses.joints)
    return replace(poses, joints=joints), fewer


def _c_poses(poses: Poses, fixed: bool) -> NDArray[np.void]:
    """Poses [F] as edml_pose or edml_pose_q; NaN becomes a number that the library refuses."""
    if not fixed:
        return c_poses(poses)
    given = np.zeros(len(poses.joints), POSE_Q)
    given["joint"] = np.nan_to_num(np.round(poses.joints * 65536.0), nan=-(2.0**31))
    given["misfit"] = np.nan_to_num(np.round(poses.misfit * 65536.0))
    return given
