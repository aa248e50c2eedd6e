"""The C library with one model, for research: arrays of joints in, as C takes them, and the stages.

What a user wants is in the package's functions; these here check less, and take another file.
"""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import (
    BODY,
    BUILT,
    KEYPOINT_Q,
    NO_KEYPOINT,
    TRACK,
    Format,
    load,
)
from edmlift.body import fit_joints
from edmlift.formats import find_format
from edmlift.keypoints import adapt_joints, read_camera, read_up, to_q16
from edmlift.lifting import Poses, lift_joints, lift_joints_q, quality_of
from edmlift.networks import NAMES, find_model
from edmlift.placing import Placements, place_joints, place_joints_by_sweep, stand_joints
from edmlift.plausibility import reflect, uncertainty_of, violations_of
from edmlift.stages import Stages
from edmlift.tracking import Tracked, TrackedFrames

__all__ = [
    "BUILT",
    "KEYPOINT_Q",
    "NO_KEYPOINT",
    "ROOT",
    "TRACK",
    "Format",
    "Library",
    "Placements",
    "Poses",
    "Tracked",
    "checked_joints",
    "to_q16",
]

ROOT = Path(__file__).resolve().parents[2]  # of a working copy


class Library(Stages):
    """The C library; `model` names one of its models, such as "direct_w16".

    With `fixed`, `lift` is edml_lift_q(), which takes quantised models.
    """

    def __init__(self, model: str | None = None, path: Path | None = None, fixed: bool = False):
        super().__init__(find_model(model, fixed, load(path)))
        self.fixed = fixed

    def has(self, model: str) -> bool:
        """Is this one of the library's models?"""
        return model in NAMES and hasattr(self._c, f"edml_{model}")

    def lift(
        self, keypoints: ArrayLike, up: ArrayLike | None = None, camera: ArrayLike | None = None
    ) -> Poses:
        """Lifts joints [F,14,3]: x, y in pixels and confidence.

        up [3] or [F,3], and the camera (fx, fy, cx, cy), where they are known.
        """
        joints = checked_joints(keypoints)
        directions = read_up(up, len(joints))
        known = None if camera is None else read_camera(camera)
        if self.fixed:
            return lift_joints_q(self._model, to_q16(joints), directions, known)
        return lift_joints(self._model, joints, directions, known)

    def format(self, name: str) -> Format:
        """One of the formats of keypoints, such as "coco17"."""
        return find_format(name, self._c)

    def adapt(self, keypoints: ArrayLike, name: str) -> NDArray[np.float32]:
        """Keypoints [F,K,3] of a format, in pixels, to joints [F,14,3]."""
        layout, given = self.format(name), np.asarray(keypoints, np.float32)
        if given.ndim != 3 or given.shape[1:] != (layout.keypoints, 3):
            raise ValueError(f"keypoints must be [F,{layout.keypoints},3], not {given.shape}")
        return adapt_joints(self._c, given, layout)

    def track(self) -> TrackedFrames:
        """A new track of one person in a video."""
        return TrackedFrames(self._model)

    def fit_body(
        self, joints: ArrayLike, height: ArrayLike = 0, bones: ArrayLike = 0
    ) -> tuple[NDArray[np.float32], NDArray[np.str_]]:
        """Poses [F,14,3] with the size of people whose height, number or [F], and bones, [13] or
        [F,13], are known where they are not 0, in metres; and the names of the status [F]."""
        poses = Poses.of(joints)
        people = np.zeros(len(poses.joints), BODY)
        people["height"], people["bone"] = height, bones
        return fit_joints(self._c, poses, people)

    def quality(self, poses: Poses) -> NDArray[np.float32]:
        """Quality [F] of what `lift` returned; NaN where it refused."""
        return quality_of(self._c, poses)

    def uncertainty(self, seen: ArrayLike) -> NDArray[np.float32]:
        """Mean errors in metres [F,14] of joints given which were seen, [F,14]; NaN: too few."""
        return uncertainty_of(self._c, np.asarray(seen, bool))

    def joint_limits(self, joints: ArrayLike) -> NDArray[np.float32]:
        """How many bones [F] of poses [F,14,3] violate joint limits; NaN: not a pose."""
        return violations_of(self._c, Poses.of(joints), self.fixed)

    def reflect_by_joint_limits(
        self, joints: ArrayLike
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The mirror images [F,14,3] of poses with fewer violations, and how many fewer [F]."""
        poses, fewer = reflect(self._c, Poses.of(joints), self.fixed)
        return poses.joints, fewer

    def stand(self, joints: ArrayLike, up: tuple[float, ...]) -> tuple[str, NDArray[np.float32]]:
        """Status name, and the joints [14,3] of a pose, y up from the floor."""
        directions = np.array([up], np.float32)
        out, status = stand_joints(self._c, Poses.of(np.asarray(joints)[None]), directions)
        return str(status[0]), out[0]

    def place(
        self, joints: ArrayLike, keypoints: ArrayLike, camera: tuple[float, float, float, float]
    ) -> Placements:
        """Places poses [F,14,3] before a camera (fx, fy, cx, cy) that sees keypoints [F,14,3]."""
        poses = Poses.of(joints, keypoints)
        return place_joints(self._model, poses, np.array(camera, np.float32))

    def place_sweep(self, joints: ArrayLike, keypoints: ArrayLike, size: ArrayLike) -> Placements:
        """The same by cameras of unknown focal length, of whose images `size` is the width and
        height, [2] or [F,2]; the principal point is in the middle."""
        poses = Poses.of(joints, keypoints)
        sizes = np.broadcast_to(np.asarray(size, np.float32), (len(poses.joints), 2))
        return place_joints_by_sweep(self._model, poses, sizes)


def checked_joints(keypoints: ArrayLike) -> NDArray[np.float32]:
    """Keypoints [F,14,3] as the library takes them."""
    joints = np.ascontiguousarray(keypoints, np.float32)
    if joints.ndim != 3 or joints.shape[1:] != (14, 3):
        raise ValueError(f"keypoints must be [F,14,3], not {joints.shape}")
    return joints
