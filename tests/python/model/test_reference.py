"""The C stages against the NumPy reference: 500 poses of the sample clips, the shipped model."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support import ROOT

from data import cameras
from edmlift import joints as skeleton
from model import reference

POSITIONS = 5e-5  # metres: the promise of the header and of tests/support/tolerance.h
TEXT = (ROOT / "tests" / "support" / "tolerance.h").read_text()
TOLERANCE = {
    name: float(value)
    for name, value in re.findall(r"#define (\w+_TOLERANCE)[ \\\n]+([\d.e-]+)F", TEXT)
}
COUNT = 500


@pytest.fixture(scope="module")
def model():
    return reference.read_model(ROOT / "gen" / "fconn.npz")


@pytest.fixture(scope="module")
def keypoints():
    """Walk, cartwheel and kick from all around, noisy, with up to four joints missing."""
    rng = np.random.default_rng(0)
    files = [ROOT / "examples" / "data" / f"{c}_truth.csv" for c in ("walk", "cartwheel", "kick")]
    joints = np.concatenate([np.loadtxt(f, delimiter=",").reshape(-1, 14, 3) for f in files])
    joints = joints[rng.integers(0, len(joints), COUNT)]
    yaw = Rotation.from_rotvec(rng.uniform(0, 2 * np.pi, (COUNT, 1)) * [0, 1, 0]).as_matrix()
    seen_from = np.einsum("fij,fkj->fki", yaw, joints) + [0, 0, 4]
    points = cameras.gaussian_noise(cameras.project(seen_from), rng.uniform(0, 15, COUNT), rng)
    hidden = cameras.hide_random(COUNT, rng.integers(0, 5, COUNT), rng)
    return cameras.keypoints(points, hidden).astype(np.float32)


@pytest.fixture(scope="module")
def predicted(model, keypoints):
    """Distances [500,91] of the reference."""
    edms = [reference_edm(model, k) for k in keypoints]
    return np.array([reference.net(model.layers, edm) for edm in edms])


def reference_edm(model, keypoints):
    settings = (model.fewest_joints, model.max_aspect, model.imputation)
    return reference.edm(keypoints.astype(float), *settings)


def apart(a, b):
    """Largest distance of a joint after the best rotation or reflection, metres."""
    u, _, vt = np.linalg.svd(a.T @ b)
    return np.linalg.norm(a @ (u @ vt) - b, axis=1).max()


def test_edm(library, model, keypoints):
    for k in keypoints:
        status, edm = library.edm(k, model.fewest_joints, model.max_aspect, impute=True)
        expected = reference_edm(model, k)
        assert status == "ok"
        error, seen = np.abs(edm - expected), k[:, 2] > 0
        both = seen[skeleton.PAIRS[0]] & seen[skeleton.PAIRS[1]]
        assert error[both].max() < TOLERANCE["EDM_TOLERANCE"]
        assert error.max() < TOLERANCE["EDM_GUESSED_TOLERANCE"]


def test_network(library, model, keypoints, predicted):
    for k, expected in zip(keypoints, predicted, strict=True):
        edm = reference_edm(model, k)
        assert np.abs(library.predict(edm) - expected).max() < 1e-5


def test_eigenpairs(library, predicted):
    for distance in predicted:
        gram = reference.gram(distance)
        values, vectors = library.jacobi(gram)
        size = np.linalg.norm(gram)
        expected = np.linalg.eigvalsh(gram)[::-1]
        assert np.abs(values - expected).max() < TOLERANCE["EIGENPAIR_TOLERANCE"] * size
        rest = gram @ vectors.T - vectors.T * values
        assert np.abs(rest).max() < TOLERANCE["EIGENPAIR_TOLERANCE"] * size
        assert np.abs(vectors @ vectors.T - np.eye(14)).max() < TOLERANCE["ORTHONORMAL_TOLERANCE"]


def test_mds(library, predicted):
    worst = max(apart(library.mds(d), reference.mds(d)) for d in predicted)
    assert worst < POSITIONS


def oracle_moves(distance, objective) -> float:
    """How far apart ten steps of the oracle end, metres, where float32 rounds the distances."""
    rng = np.random.default_rng(1)
    ends = []
    for _ in range(16):
        d = distance + rng.normal(0, 2e-7, len(distance))
        ends.append(reference.refine(reference.mds(d), d, objective, 10))
    return max(apart(end, ends[0]) for end in ends)


@pytest.mark.parametrize("objective", ["square", "raw", "eq2"])
def test_refinement(library, predicted, objective):
    """Five steps agree in every pose.  In a flat valley ten amplify rounding a thousandfold: there
    the points may differ a little in a pose in hundreds, the objective not; but where the oracle
    itself goes elsewhere for it, it says nothing of C."""
    far = 0
    for distance in predicted:
        start = reference.mds(distance)
        five, expected = (reference.refine(start, distance, objective, n) for n in (5, 10))
        assert apart(library.refine(start, distance, objective, 5)[0], five) < POSITIONS
        refined, _ = library.refine(start, distance, objective, 10)
        off = apart(refined, expected)
        far += off >= POSITIONS
        reached = reference.stress(refined, distance, objective)
        assert reached <= reference.stress(start, distance, objective) * (1 + 1e-6)
        if off >= 10 * POSITIONS and oracle_moves(distance, objective) >= off / 2:
            continue
        assert off < 10 * POSITIONS
        wanted = reference.stress(expected, distance, objective)
        assert reached == pytest.approx(wanted, rel=1e-3)
    assert far <= 0.01 * COUNT


def test_pose(library, model, keypoints, predicted):
    """What the last bits of the float network alone do to a pose comes on top: 0.001 mm, but 0.03
    in one whose third and fourth eigenvalue are within 1 %."""
    poses = library.lift(keypoints)
    assert (poses.status == "ok").all()
    for i, (k, distance) in enumerate(zip(keypoints, predicted, strict=True)):
        joints, margin, residual = reference.lift(model, k.astype(float))
        _, edm = library.edm(k, model.fewest_joints, model.max_aspect, impute=True)
        given = library.predict(edm)
        rounding = apart(reference.mds(given.astype(float)), reference.mds(distance))
        if margin > 1e-3:  # else rounding decides the mirror image
            off = np.linalg.norm(poses.joints[i] - joints, axis=1).max()
            assert off < POSITIONS + rounding
        assert poses.mirror_margin[i] == pytest.approx(margin, abs=20 * (POSITIONS + rounding))
        assert poses.residual[i] == pytest.approx(residual, abs=1e-5)


BAD = {
    "not_finite": lambda k: k.__setitem__((3, 0), np.nan),
    "too_few_joints": lambda k: k.__setitem__((slice(0, 6), 2), 0),
    "degenerate": lambda k: k.__setitem__((slice(None), 1), 300),
    "aspect": lambda k: k.__setitem__((slice(None), 0), k[:, 0] * 30),
}


@pytest.mark.parametrize("status", BAD)
def test_refusals_agree(library, model, keypoints, status):
    bad = keypoints[0].copy()
    BAD[status](bad)
    assert library.lift(bad[None]).status[0] == status
    with pytest.raises(reference.Refused, match=status):
        reference.lift(model, bad.astype(float))
