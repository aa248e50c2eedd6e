"""The paper's way from distances to points, and that the library's is no worse."""

import numpy as np
import pytest

from edmlift.metrics import rigid_errors
from evaluation import scaling
from model.reference import distances, mds, stress
from model.sdp import Relaxation, descend, raw_stress

pytest.importorskip("cvxpy", reason="no cvxpy: pip install -r tools/requirements-sdp.txt")


def people(count: int) -> np.ndarray:
    return np.random.default_rng(7).normal(0, 0.35, (count, 14, 3))


def off(truth: np.ndarray, sigma: float = 0.05) -> np.ndarray:
    """Distances as of a network: of no points, off by 5 cm."""
    return np.maximum(distances(truth) + np.random.default_rng(8).normal(0, sigma, 91), 0)


def test_relaxation_finds_points_of_nearly_exact_distances():
    relaxation = Relaxation()
    for truth in people(3):
        points = relaxation.solve(off(truth, 0.0001))
        handed = [rigid_errors(points[None] * [1, 1, s], truth[None]).mean() for s in (1, -1)]
        assert min(handed) < 0.0003


def test_relaxation_is_the_least_of_its_objective():
    """No points in 3D, whose Gram matrices it may choose among, can have a lower one."""

    def objective(points):
        centred = points - points.mean(0)
        return 91 * stress(points, wanted, "eq2") - (centred**2).sum()

    (truth,) = people(1)
    wanted = off(truth)
    relaxation = Relaxation()
    relaxation.solve(wanted)
    rng = np.random.default_rng(9)
    for start in (truth, mds(wanted), descend(mds(wanted), wanted)):
        for size in (0, 0.003, 0.03):
            assert objective(start + rng.normal(0, size, (14, 3))) > relaxation.value - 1e-6


def test_descent_follows_its_gradient_to_a_stop():
    (truth,) = people(1)
    wanted = off(truth)
    value, slope = raw_stress(truth, wanted)
    for joint, axis in ((0, 0), (7, 2)):
        step = np.zeros((14, 3))
        step[joint, axis] = 1e-6
        ahead, behind = (raw_stress(truth + s * step, wanted)[0] for s in (1, -1))
        assert slope[joint, axis] == pytest.approx((ahead - behind) / 2e-6, rel=1e-5, abs=1e-7)
    lower, flat = raw_stress(descend(truth, wanted), wanted)
    assert lower < value and np.abs(flat).max() < 0.01 * np.abs(slope).max()


def test_sample_takes_people_alike():
    subject = np.repeat([3, 5, 9], [1000, 200, 4])
    which = scaling.sample(subject, 30)
    assert np.unique(which).size == len(which)
    assert np.unique(subject[which], return_counts=True)[1].tolist() == [10, 10, 4]


def test_the_library_reaches_an_eq2_no_worse_than_the_papers_way(library):
    ways = scaling.solvers(library)
    truth = people(20)
    wanted = np.array([off(pose) for pose in truth])
    mine, papers, classical = (
        scaling.measure(library, ways[title], wanted, truth)
        for title in ("+ eq. 2", scaling.PAPER, "classical MDS")
    )
    assert scaling.no_worse(mine, papers) >= 90
    assert scaling.no_worse(papers, papers) == 100
    assert scaling.no_worse(classical, mine) < 10
    expected = [stress(mds(w), w, "eq2") for w in wanted]
    assert classical["eq2"] == pytest.approx(expected, rel=1e-2)
