"""The stages of a lift in float, one pose at a time: what research looks into.

Poses are [14,3] in metres, keypoints [14,3] in pixels with a confidence, distances [91].
"""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import (
    IMAGE,
    JOINT_COUNT,
    OBJECTIVES,
    OK,
    PAIR_COUNT,
    PREDICTION,
    pointer,
)
from edmlift.keypoints import from_bits, read_up
from edmlift.networks import Model

_F32 = NDArray[np.float32]
_ONE_Q24 = 1 << 24


@dataclass(frozen=True)
class Image:
    """edml_image: keypoints in the body's frame."""

    record: NDArray[np.void]  # IMAGE [1], as C has it

    @property
    def at(self) -> _F32:
        """Where the joints are [14,2]: u across the body, v along it, of all, also if imputed."""
        at: _F32 = self.record["at"][0]
        return at

    @property
    def down(self) -> _F32:
        """The body's axis in the image [2], from neck to hips: a unit vector."""
        down: _F32 = self.record["down"][0]
        return down

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Which joints were seen [14]."""
        seen: NDArray[np.bool_] = from_bits(self.record["seen"])[0]
        return seen


@dataclass(frozen=True)
class Prediction:
    """edml_prediction: what a network gives, in the body's frame; zeros are not this network's."""

    distance: _F32  # [91] metres
    share: _F32  # [14] how far the image of a joint is believed
    points: _F32  # [14,3] metres


class Stages:
    """The stages with a model; a status other than "ok" is a ValueError, but for body_frame()."""

    def __init__(self, model: Model):
        self._model, self._c = model, model.c
        self._work = model.work()

    def status_name(self, status: int) -> str:
        name: bytes = self._c.edml_status_name(status)
        return name.decode()

    def body_frame(
        self, keypoints: ArrayLike, fewest_joints: int, impute: bool
    ) -> tuple[str, Image]:
        """Status name, and the image in the body's frame, with joints that are not seen imputed.

        Without imputation they have no place, and the image keeps its own axes, as in section 3.1.
        """
        out, given = np.zeros(1, IMAGE), _f32(keypoints)
        imputation = ctypes.addressof(ctypes.c_int16.in_dll(self._c, "edml_default_imputation"))
        status = self._c.edml_body_frame(
            pointer(out), pointer(given), fewest_joints, imputation if impute else None
        )
        return self.status_name(status), Image(out)

    def edm(self, image: Image) -> _F32:
        """Normalised 2D distances (section 3.1); those of joints without a place are zero."""
        out = np.zeros(PAIR_COUNT, np.float32)
        self._c.edml_edm(pointer(out), pointer(image.record))
        return out

    def predict(self, image: Image, up: ArrayLike | None = None) -> Prediction:
        """What the network makes of an image (section 3.2), up in the camera's axes if known."""
        out, direction = np.zeros(1, PREDICTION), read_up(up, 1)
        if direction is not None:
            direction = direction / np.abs(direction).max()  # as the lift does: the same bits
            direction = direction / np.linalg.norm(direction)
        self._check(
            self._c.edml_predict(
                pointer(out), pointer(image.record),
                None if direction is None else pointer(direction),
                self._model.address, self._work, len(self._work),
            )
        )  # fmt: skip
        return Prediction(*(out[name][0] for name in ("distance", "share", "x")))

    def jacobi(self, matrix: ArrayLike) -> tuple[_F32, _F32]:
        """Eigenvalues [14], descending, and eigenvectors as rows [14,14]."""
        given, vectors = _f32(matrix), JOINT_COUNT * JOINT_COUNT
        eigen = np.zeros(JOINT_COUNT + vectors + vectors, np.float32)
        self._c.edml_jacobi(pointer(eigen), pointer(given))
        rows = eigen[JOINT_COUNT : JOINT_COUNT + vectors].reshape(JOINT_COUNT, JOINT_COUNT)
        return eigen[:JOINT_COUNT].copy(), rows.copy()

    def mds(self, distance: ArrayLike) -> _F32:
        """Classical multidimensional scaling (section 3.3)."""
        out, given = np.zeros((JOINT_COUNT, 3), np.float32), _f32(distance)
        self._c.edml_mds(pointer(out), pointer(given), self._work)
        return out

    def mds_q(self, distance: ArrayLike) -> NDArray[np.float64]:
        """The same in fixed point: distances to the nearest Q24."""
        given = np.rint(np.asarray(distance, np.float64) * _ONE_Q24).astype(np.int32)
        out = np.zeros((JOINT_COUNT, 3), np.int32)
        self._c.edml_mds_q(pointer(out), pointer(given), self._work)
        return out / _ONE_Q24

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

    def mirror(self, points: ArrayLike) -> _F32:
        """The mirror image that the model's five weights choose."""
        out = _f32(points).copy()
        self._c.edml_mirror(pointer(out), self._model.address)
        return out

    def align(self, points: ArrayLike, onto: ArrayLike) -> _F32:
        """Points of mds(), rotated and if need be reflected onto the network's points [14,3], and
        the mean of the two that the model says."""
        out, given = _f32(points).copy(), _f32(onto)
        self._c.edml_align(pointer(out), pointer(given), self._model.address)
        return out

    def orient(self, points: ArrayLike, image: Image) -> _F32:
        """Points rotated to the axes of the image."""
        out = _f32(points).copy()
        self._check(self._c.edml_orient(pointer(out), pointer(image.record)))
        return out

    def fuse(self, points: ArrayLike, image: Image, share: ArrayLike) -> tuple[_F32, float]:
        """Points of orient(), moved towards where the image has them, as the shares [14] and the
        model say; and the misfit before."""
        out, given = _f32(points).copy(), _f32(share)
        misfit: float = self._c.edml_fuse(
            pointer(out), pointer(image.record), pointer(given), self._model.address
        )
        return out, misfit

    def _check(self, status: int) -> None:
        if status != OK:
            raise ValueError(self.status_name(status))


def _f32(array: ArrayLike) -> NDArray[Any]:
    return np.ascontiguousarray(array, np.float32)
