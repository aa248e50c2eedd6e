"""The stages of a lift in float, one pose at a time: what research looks into.

Poses are [14,3] in metres, keypoints [14,3] in pixels with a confidence, distances [91].
"""

import ctypes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import JOINT_COUNT, OBJECTIVES, OK, PAIR_COUNT, pointer
from edmlift.keypoints import seen_bits
from edmlift.networks import Model

_F32 = NDArray[np.float32]


class Stages:
    """The stages with a model; a status other than "ok" is a ValueError, but for edm()."""

    def __init__(self, model: Model):
        self._model, self._c = model, model.c
        self._work = model.work()

    def status_name(self, status: int) -> str:
        name: bytes = self._c.edml_status_name(status)
        return name.decode()

    def edm(
        self, keypoints: ArrayLike, fewest_joints: int, max_aspect: float, impute: bool
    ) -> tuple[str, _F32]:
        """Status name and normalised 2D distances (section 3.1).

        Joints that are not seen are imputed, or their distances are zero.
        """
        out, given = np.zeros(PAIR_COUNT, np.float32), _f32(keypoints)
        imputation = ctypes.addressof(ctypes.c_int16.in_dll(self._c, "edml_default_imputation"))
        status = self._c.edml_edm(
            pointer(out), pointer(given), fewest_joints, max_aspect, imputation if impute else None
        )
        return self.status_name(status), out

    def predict(self, edm: ArrayLike) -> _F32:
        """Distances in metres that the network predicts (section 3.2)."""
        out, given = np.zeros(PAIR_COUNT, np.float32), _f32(edm)
        self._check(
            self._c.edml_predict(
                pointer(out), pointer(given), self._model.address, self._work, len(self._work)
            )
        )
        return out

    def jacobi(self, matrix: ArrayLike) -> tuple[_F32, _F32]:
        """Eigenvalues [14], descending, and eigenvectors as rows [14,14]."""
        given, vectors = _f32(matrix), JOINT_COUNT * JOINT_COUNT
        eigen = np.zeros(JOINT_COUNT + vectors + 2 * 640, np.float32)
        self._c.edml_jacobi(pointer(eigen), pointer(given))
        rows = eigen[JOINT_COUNT : JOINT_COUNT + vectors].reshape(JOINT_COUNT, JOINT_COUNT)
        return eigen[:JOINT_COUNT].copy(), rows.copy()

    def mds(self, distance: ArrayLike) -> _F32:
        """Classical multidimensional scaling (section 3.3)."""
        out, given = np.zeros((JOINT_COUNT, 3), np.float32), _f32(distance)
        self._c.edml_mds(pointer(out), pointer(given), self._work)
        return out

    def refine(
        self, points: ArrayLike, distance: ArrayLike, objective: str, steps: int
    ) -> tuple[_F32, int]:
        """Refined points and the number of steps taken; the objective is one of OBJECTIVES."""
        out, given = _f32(points).copy(), _f32(distance)
        taken: int = self._c.edml_refine(
            pointer(out), pointer(given), OBJECTIVES.index(objective), steps, self._work
        )
        return out, taken

    def stress(self, points: ArrayLike, distance: ArrayLike, objective: str) -> float:
        """The value of an objective."""
        at, given = _f32(points), _f32(distance)
        value: float = self._c.edml_stress(pointer(at), pointer(given), OBJECTIVES.index(objective))
        return value

    def mirror(self, points: ArrayLike) -> tuple[_F32, float]:
        """The chosen mirror image and the margin."""
        out = _f32(points).copy()
        margin: float = self._c.edml_mirror(pointer(out), self._model.address)
        return out, margin

    def orient(self, points: ArrayLike, keypoints: ArrayLike) -> _F32:
        """Points rotated to the axes of the camera."""
        out, given = _f32(points).copy(), _f32(keypoints)
        self._check(self._c.edml_orient(pointer(out), pointer(given), _seen(given)))
        return out

    def fuse(self, points: ArrayLike, keypoints: ArrayLike) -> _F32:
        """Points of orient(), moved towards where the image has them, as the model says."""
        out, given = _f32(points).copy(), _f32(keypoints)
        self._c.edml_fuse(pointer(out), pointer(given), _seen(given), self._model.address)
        return out

    def _check(self, status: int) -> None:
        if status != OK:
            raise ValueError(self.status_name(status))


def _f32(array: ArrayLike) -> NDArray[Any]:
    return np.ascontiguousarray(array, np.float32)


def _seen(keypoints: _F32) -> int:
    return int(seen_bits(keypoints[:, 2] > 0))
