"""From distances to points as the paper does it: a semidefinite relaxation, then gradient descent.

The library does not; it is what tools/evaluation/scaling.py measures the library against.  Needs
tools/requirements-sdp.txt.
"""

import numpy as np

from edmlift.joints import JOINTS, PAIRS

try:
    import cvxpy
except ImportError:  # it is not in tools/requirements.txt
    cvxpy = None

COUNT = len(JOINTS)
STEPS = 500  # of the descent, at most
SETTLED = 1e-9  # share of the objective: a step that gains less is the last one


class Relaxation:
    """Eq. 2 with the rank of the Gram matrix left free (section 3.3).

    Over Y [14,14], positive semidefinite, Y 1 = 0: least sum |d_ij^2(Y) - D_ij^2| - trace(Y),
    where d_ij^2 = Y_ii + Y_jj - 2 Y_ij.  The trace keeps points apart: there are no anchors.
    Y = V Z V', V [14,13] an orthonormal basis of what adds up to 0: no Y 1 = 0 has an interior,
    which the solver needs, but Z has.
    """

    def __init__(self) -> None:
        if cvxpy is None:
            raise ValueError("no cvxpy: pip install -r tools/requirements-sdp.txt")
        self._basis = np.linalg.svd(np.ones((1, COUNT)))[2][1:].T
        self._inner = cvxpy.Variable((COUNT - 1, COUNT - 1), PSD=True)
        self._target = cvxpy.Parameter(len(PAIRS[0]), nonneg=True)
        between = self._basis[PAIRS[0]] - self._basis[PAIRS[1]]  # d_ij^2 = b' Z b
        squares = np.einsum("pi,pj->pij", between, between).reshape(len(between), -1)
        excess = squares @ cvxpy.vec(self._inner, order="C") - self._target
        objective = cvxpy.norm1(excess) - cvxpy.trace(self._inner)
        self._problem = cvxpy.Problem(cvxpy.Minimize(objective))

    @property
    def value(self) -> float:
        """What the last solution has as the objective: no points have less."""
        return self._problem.value

    def solve(self, distance: np.ndarray) -> np.ndarray:
        """Points [14,3] of distances [91], metres: the three largest eigenpairs of Y.

        Raises cvxpy.SolverError where the solver falls short of its accuracy, as it does on exact
        distances, where all terms of the sum are at their kink.
        """
        self._target.value = np.asarray(distance, float) ** 2
        self._problem.solve(solver=cvxpy.CLARABEL)
        if self._problem.status != cvxpy.OPTIMAL:
            raise cvxpy.SolverError(self._problem.status)
        values, vectors = np.linalg.eigh(self._inner.value)
        return self._basis @ vectors[:, :-4:-1] * np.sqrt(np.maximum(values[:-4:-1], 0))


def descend(points: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Gradient descent on sum (d - D)^2, what the solver that the paper cites descends on.

    points [14,3], distance [91] metres.  A step that gains less than half of what the slope
    promises is halved, the one after a good step is twice as long.
    """
    value, slope = raw_stress(points, distance)
    step = 1 / (2 * COUNT)
    for _ in range(STEPS):
        trial = points - step * slope
        lower, next_slope = raw_stress(trial, distance)
        if lower > value - step / 2 * (slope**2).sum():
            step /= 2
            continue
        settled = value - lower <= SETTLED * value
        points, value, slope, step = trial, lower, next_slope, 2 * step
        if settled:
            break
    return points


def raw_stress(points: np.ndarray, distance: np.ndarray) -> tuple[float, np.ndarray]:
    """Sum (d - D)^2 over the pairs, and its gradient [14,3]."""
    between = points[PAIRS[0]] - points[PAIRS[1]]
    length = np.linalg.norm(between, axis=1)
    off = length - distance
    pull = (2 * off / np.maximum(length, 1e-9))[:, None] * between
    slope = np.zeros_like(points)
    np.add.at(slope, PAIRS[0], pull)
    np.subtract.at(slope, PAIRS[1], pull)
    return float((off**2).sum()), slope
