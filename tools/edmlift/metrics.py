"""How far off poses are."""

import numpy as np


def rigid_errors(points: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Joint errors after the best rotation and translation, no scale, no reflection.

    points, truth [F,14,3] metres -> [F,14] metres.
    """
    points = points - points.mean(1, keepdims=True)
    truth = truth - truth.mean(1, keepdims=True)
    u, _, vt = np.linalg.svd(np.einsum("fni,fnj->fij", points, truth))
    u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
    return np.linalg.norm(np.einsum("fni,fij->fnj", points, u @ vt) - truth, axis=-1)
