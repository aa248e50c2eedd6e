"""The C stages against the NumPy reference: 500 poses of the sample clips, each network."""

import re

import numpy as np
import pytest
from builds import long_but
from scipy.spatial.transform import Rotation
from support import ROOT

from data import cameras
from edmlift import joints as skeleton
from edmlift.library import Library as edmlift_library
from model import reference

POSITIONS = 5e-5  # metres: the promise of the header and of tests/support/tolerance.h
TEXT = (ROOT / "tests" / "support" / "tolerance.h").read_text()
TOLERANCE = {
    name: float(value)
    for name, value in re.findall(r"#define (\w+_TOLERANCE)[ \\\n]+([\d.e-]+)F", TEXT)
}
COUNT = 500
NETWORK = 3e-5  # metres: float32 of hidden units up to 26


MODELS = ("distances", "direct", "fconn")


@pytest.fixture(scope="module", params=MODELS)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def model(kind):
    return reference.read_model(ROOT / "gen" / f"{kind}.npz")


@pytest.fixture(scope="module")
def library(kind):
    return edmlift_library(f"{kind}_f32")


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
def images(model, keypoints):
    return [image_of(model, k) for k in keypoints]


@pytest.fixture(scope="module")
def predicted(model, images):
    """Distances [500,91] of the reference."""
    said = [reference.predict(model, image) for image in images]
    if said[0].distance is None:
        pytest.skip("this network gives no distances")
    return np.array([one.distance for one in said])


def image_of(model, keypoints):
    return reference.body_frame(keypoints.astype(float), model.fewest_joints, model.imputation)


def apart(a, b):
    """Largest distance of a joint after the best rotation or reflection, metres."""
    u, _, vt = np.linalg.svd(a.T @ b)
    return np.linalg.norm(a @ (u @ vt) - b, axis=1).max()


def test_body_frame_and_edm(library, model, keypoints, images):
    for k, expected in zip(keypoints, images, strict=True):
        status, image = library.body_frame(k, model.fewest_joints, impute=True)
        assert status == "ok" and (image.seen == expected.seen).all()
        assert np.abs(image.down - expected.down).max() < TOLERANCE["FRAME_TOLERANCE"]
        error = np.abs(library.edm(image) - reference.edm(expected))
        both = expected.seen[skeleton.PAIRS[0]] & expected.seen[skeleton.PAIRS[1]]
        assert error[both].max() < 2 * TOLERANCE["FRAME_TOLERANCE"]
        assert error.max() < 2 * TOLERANCE["FRAME_GUESSED_TOLERANCE"]


UP = np.array([0.05, -0.98, 0.1])


@pytest.mark.parametrize("up", [None, UP])
def test_network(library, model, keypoints, images, up):
    for k, image in zip(keypoints, images, strict=True):
        expected = reference.predict(model, image, up)
        found = library.predict(library.body_frame(k, model.fewest_joints, impute=True)[1], up)
        assert np.abs(found.share - expected.share).max() < 1e-4
        if expected.distance is not None:
            assert np.abs(found.distance - expected.distance).max() < NETWORK
        if expected.points is not None:
            assert np.abs(found.points - expected.points).max() < NETWORK


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


@pytest.mark.slow
@pytest.mark.parametrize("objective", long_but(["eq2"], ["square", "raw", "eq2"]))
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


@pytest.mark.parametrize("up", [None, UP])
def test_pose(library, model, keypoints, up):
    """What the last bits of the float network alone do to a pose comes on top: 0.001 mm, but 0.03
    in one whose third and fourth eigenvalue are within 1 %."""
    poses = library.lift(keypoints, up)
    assert (poses.status == "ok").all()
    off = []
    for i, k in enumerate(keypoints):
        joints, misfit = reference.lift(model, k.astype(float), up)
        off.append(np.linalg.norm(poses.joints[i] - joints, axis=1).max())
        assert poses.misfit[i] == pytest.approx(misfit, abs=1e-4)
    # The mirror image of distances alone, where rounding decides it, is a metre away.
    off = np.array(off)[np.array(off) < 0.1]
    assert len(off) >= COUNT - 2
    assert np.quantile(off, 0.98) < POSITIONS and off.max() < 10 * POSITIONS


BAD = {
    "not_finite": lambda k: k.__setitem__((3, 0), np.nan),
    "too_few_joints": lambda k: k.__setitem__((slice(0, 6), 2), 0),
    "degenerate": lambda k: k.__setitem__((slice(None), 1), 300),
}


@pytest.mark.parametrize("status", BAD)
def test_refusals_agree(library, model, keypoints, status):
    bad = keypoints[0].copy()
    BAD[status](bad)
    assert library.lift(bad[None]).status[0] == status
    with pytest.raises(reference.Refused, match=status):
        reference.lift(model, bad.astype(float))
