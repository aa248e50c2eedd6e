"""Fits the five weights of the mirror score (lib/lift/mirror.h) to network output."""

import numpy as np
from scipy.optimize import minimize

from edmlift.metrics import rigid_errors
from model.reference import mirror_features


def fit_mirror(points: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Logistic regression: weights [5] whose score is the log-odds that a pose is not mirrored.

    points [F,14,3] are the network's, of either handedness; truth [F,14,3].
    """
    upright = rigid_errors(points, truth).mean(1) < rigid_errors(points * [1, 1, -1], truth).mean(1)
    features = mirror_features(points) * np.where(upright, 1, -1)[:, None]

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        score = features @ weights
        probability = 1 / (1 + np.exp(np.clip(score, -50, 50)))
        gradient = -(features * probability[:, None]).mean(0)
        return np.logaddexp(0, -score).mean(), gradient

    return minimize(loss, np.zeros(5), jac=True).x
