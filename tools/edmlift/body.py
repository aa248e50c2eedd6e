"""What is known of the person: height and bones."""

import ctypes
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import BODY, BONE_COUNT, MEASURED_BODY, OK, load, pointer, pointers
from edmlift.joints import BONES, JOINTS
from edmlift.lifting import Poses, batched, c_poses, first, status_names

BONE_NAMES = tuple(JOINTS[end] for _, end in BONES)  # each by the joint that it leads to


def fit_body(
    poses: Poses,
    height: ArrayLike | None = None,
    bones: ArrayLike | Mapping[str, float] | None = None,
) -> Poses:
    """Gives lifted poses their owner's size (docs/body.md).

    height  metres, standing, barefoot, 0.5 to 2.5; one number or [F]
    bones   metres, [13] or [F,13] in the order of BONES, 0 where unknown; or by the joint that a
            bone leads to, such as {"left_elbow": 0.29} for the left upper arm

    Known bones get their length; the others are scaled by one factor, so that head to ankle takes
    its proportion of the height.  Quality comes before this, placement after.  Poses get the status
    "body" where the measurements are nobody's, "degenerate" where the size would be more than
    twice, or an eighth, of what was lifted.
    """
    if height is None and bones is None:
        raise ValueError("fit_body() needs height= or bones=")
    given, single = batched(poses)
    count = len(given.joints)
    people = np.zeros(count, BODY)
    people["height"] = _measures("height", 0.0 if height is None else height, (count,))
    lengths = _by_name(bones) if isinstance(bones, Mapping) else bones
    people["bone"] = _measures("bones", 0.0 if lengths is None else lengths, (count, BONE_COUNT))
    joints, names = fit_joints(load(), given, people)
    status = np.where(given.ok, names, given.status)
    fitted = replace(given, joints=joints, status=status)
    return first(fitted) if single else fitted


def _by_name(bones: Mapping[str, float]) -> NDArray[np.float32]:
    unknown = [name for name in bones if name not in BONE_NAMES]
    if unknown:
        raise ValueError(f"bone {unknown[0]!r} is not known; there are {', '.join(BONE_NAMES)}")
    return np.array([bones.get(name, 0.0) for name in BONE_NAMES], np.float32)


def _measures(name: str, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float32]:
    array = np.asarray(values, np.float32)
    try:
        return np.broadcast_to(array, shape)
    except ValueError:
        raise ValueError(f"{name} must be {list(shape)}, not {list(array.shape)}") from None


# ---- For the library, unchecked ----------------------------------------------------------------


def fit_joints(
    c: ctypes.CDLL, poses: Poses, people: NDArray[np.void]
) -> tuple[NDArray[np.float32], NDArray[np.str_]]:
    """edml_fit_body() of poses and BODY [F]: joints [F,14,3] and the names of the status [F]."""
    fitted = c_poses(poses)
    codes = [c.edml_fit_body(pose, body) for pose, body in pointers(fitted, people)]
    status = np.array(codes, np.int32)
    joints = np.where((status == OK)[:, None, None], fitted["joint"], np.float32(np.nan))
    return joints, status_names(c, status)


def give_measured(
    c: ctypes.CDLL,
    poses: Poses,
    starts: NDArray[np.bool_],
    own: NDArray[np.bool_],
    frames: int,
    measured: NDArray[np.void],
) -> Poses:
    """The poses of a video [F] with the bones of the first `frames` of them, or of as many as there
    were, by edml_measure_body() and edml_fit_body(); measured anew where one starts [F].  Frames
    that are not the person's own [F] are as they were.

    measured  the state, MEASURED_BODY [1], which goes on from call to call
    """
    fitted, ok = c_poses(poses), poses.ok
    state = pointer(measured)
    for i, (pose,) in enumerate(pointers(fitted)):
        if not (ok[i] and own[i]):
            continue
        if starts[i]:
            c.edml_measure_start(state)
        if measured["poses"][0] < frames:
            c.edml_measure_body(state, pose)
        if measured["poses"][0] > 0:
            c.edml_fit_body(pose, state)  # the body is the first member
    joints = np.where(ok[:, None, None], fitted["joint"], np.float32(np.nan))
    return replace(poses, joints=joints)


def unmeasured() -> NDArray[np.void]:
    """The state of `give_measured` before the first pose."""
    return np.zeros(1, MEASURED_BODY)
