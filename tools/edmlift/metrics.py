"""How far off poses are.  Arrays are [F,N,3] or [N,3], in metres; so are errors."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.joints import JOINTS, mid_hip

Alignment = Literal["none", "root", "rigid", "similarity"]
ALIGNMENTS: tuple[Alignment, ...] = ("none", "root", "rigid", "similarity")


def procrustes(points: ArrayLike, truth: ArrayLike, scale: bool = False) -> NDArray[np.float64]:
    """The points [...,N,3], moved and rotated, without reflection, to lie nearest to the truth in
    the least-squares sense; with `scale`, also scaled."""
    given, target = np.asarray(points, float), np.asarray(truth, float)
    centre = target.mean(-2, keepdims=True)
    given = given - given.mean(-2, keepdims=True)
    rotation, singular = _rotation(given, target - centre)
    moved = np.einsum("...ni,...ij->...nj", given, rotation)
    if scale:
        size = (given**2).sum((-2, -1))
        ratio = np.divide(singular.sum(-1), size, out=np.zeros_like(size), where=size > 0)
        moved = moved * ratio[..., None, None]
    aligned: NDArray[np.float64] = moved + centre
    return aligned


def best_rotation(points: ArrayLike, truth: ArrayLike) -> NDArray[np.float64]:
    """The rotations [...,3,3] of procrustes(), for points as rows: points @ rotation."""
    centred = (p - p.mean(-2, keepdims=True) for p in map(np.asarray, (points, truth)))
    return _rotation(*centred)[0]


def _rotation(
    points: NDArray[np.float64], truth: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rotations [...,3,3] of rows, and the signed singular values [...,3]; NaN for NaN."""
    product = np.einsum("...ni,...nj->...ij", points, truth)
    known = np.isfinite(product).all((-2, -1))
    u, singular, vt = np.linalg.svd(np.where(known[..., None, None], product, 0))
    sign = np.sign(np.linalg.det(u @ vt))
    u[..., :, 2] *= sign[..., None]
    singular[..., 2] *= sign
    rotation = u @ vt
    rotation[~known], singular[~known] = np.nan, np.nan
    return rotation, singular


def joint_errors(
    points: ArrayLike, truth: ArrayLike, align: Alignment = "root"
) -> NDArray[np.float64]:
    """Distances [...,N] of points from the truth after an alignment.

    align  "none"; "root": mid-hips laid together, for the 14 joints; "rigid": best rotation and
           translation; "similarity": best scale, too.  NaN for a pose that is NaN.
    """
    given, target = np.asarray(points, float), np.asarray(truth, float)
    if given.shape != target.shape or given.ndim < 2 or given.shape[-1] != 3:
        raise ValueError(
            f"points and truth must both be [F,N,3] or [N,3], "
            f"not {list(given.shape)} and {list(target.shape)}"
        )
    if align == "root":
        if given.shape[-2] != len(JOINTS):
            raise ValueError(f"align='root' is for 14 joints, not {given.shape[-2]} points")
        given, target = (p - mid_hip(p)[..., None, :] for p in (given, target))
    elif align in ("rigid", "similarity"):
        given = procrustes(given, target, scale=align == "similarity")
    elif align != "none":
        raise ValueError(f"align must be one of {', '.join(ALIGNMENTS)}, not {align!r}")
    errors: NDArray[np.float64] = np.linalg.norm(given - target, axis=-1)
    return errors


def rigid_errors(points: ArrayLike, truth: ArrayLike) -> NDArray[np.float64]:
    """joint_errors() after the best rotation and translation: the measure of this project."""
    return joint_errors(points, truth, "rigid")


def mpjpe(points: ArrayLike, truth: ArrayLike, align: Alignment = "root") -> float:
    """Mean per-joint position error in metres, mid-hips laid together.

    Poses that are NaN, which the lift refused, do not count: say how many there were.  NaN where
    there is no other.
    """
    errors = joint_errors(points, truth, align)
    errors = errors[np.isfinite(errors)]
    return float(errors.mean()) if errors.size else float("nan")


def pa_mpjpe(points: ArrayLike, truth: ArrayLike) -> float:
    """mpjpe() after Procrustes alignment with scale, as the field has it."""
    return mpjpe(points, truth, "similarity")


def pck(
    points: ArrayLike, truth: ArrayLike, threshold: float = 0.15, align: Alignment = "root"
) -> float:
    """Proportion of joints, 0 to 1, within a threshold of the truth in metres.

    The joints of poses that are NaN count as missed; NaN where there are no poses.
    """
    within = joint_errors(points, truth, align) <= threshold
    return float(within.mean()) if within.size else float("nan")
