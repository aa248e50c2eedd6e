"""Metrics by hand, and the properties that make them metrics."""

import numpy as np
import pytest
from package_support import DATA

import edmlift
from edmlift.metrics import ALIGNMENTS, best_rotation, rigid_errors

TRUTH = edmlift.read_truth(DATA / "walk_truth.csv").astype(float)
TURN = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
MOVE = np.array([0.3, -0.2, 4.0])


def test_each_alignment_undoes_what_it_says():
    moved, turned = TRUTH + MOVE, TRUTH @ TURN + MOVE
    scaled = 1.3 * turned
    zero = {  # what is nothing to the measure that needs no more than this
        "none": [TRUTH],
        "root": [TRUTH, moved],
        "rigid": [TRUTH, moved, turned],
        "similarity": [TRUTH, moved, turned, scaled],
    }
    for align in ALIGNMENTS:
        for points in (TRUTH, moved, turned, scaled):
            error = edmlift.mpjpe(points, TRUTH, align)
            assert (error < 1e-9) == any(points is p for p in zero[align]), align


def test_the_best_rotation():
    rotation = best_rotation(TRUTH + MOVE, TRUTH @ TURN)
    np.testing.assert_allclose(rotation, np.broadcast_to(TURN, rotation.shape), atol=1e-12)
    assert np.isnan(best_rotation(TRUTH[0] * np.nan, TRUTH[0])).all()


def test_no_alignment_reflects():
    image = TRUTH * [1, 1, -1]
    assert edmlift.pa_mpjpe(image, TRUTH) > 0.03


def test_errors_by_hand():
    points = TRUTH.copy()
    points[:, 0, 1] += 0.14  # the head alone, 140 mm
    np.testing.assert_allclose(edmlift.joint_errors(points, TRUTH)[:, 0], 0.14)
    assert edmlift.mpjpe(points, TRUTH) == pytest.approx(0.01)
    assert edmlift.pck(points, TRUTH, 0.13) == pytest.approx(13 / 14)
    assert edmlift.pck(points, TRUTH, 0.15) == 1


def test_scale_by_hand():
    points = np.array([[[-1.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0]]])
    target = 2 * points + [5, 6, 7]
    np.testing.assert_allclose(edmlift.procrustes(points, target, scale=True), target, atol=1e-12)
    np.testing.assert_allclose(edmlift.procrustes(points, target), points + [5, 6, 7], atol=1e-12)


@pytest.mark.filterwarnings("error")
def test_poses_that_were_refused():
    points = TRUTH + MOVE
    points[3:] = np.nan
    assert edmlift.mpjpe(points, TRUTH) == pytest.approx(0, abs=1e-12)
    assert edmlift.pa_mpjpe(points, TRUTH) == pytest.approx(0, abs=1e-12)
    assert edmlift.pck(points, TRUTH) == pytest.approx(3 / len(TRUTH))
    assert np.isnan(edmlift.mpjpe(points[3:], TRUTH[3:]))
    assert np.isnan(edmlift.pck(points[:0], TRUTH[:0]))


def test_one_pose_and_many_are_alike():
    points = TRUTH @ TURN + np.linspace(0, 0.1, 14)[:, None]
    for align in ALIGNMENTS:
        together = edmlift.joint_errors(points, TRUTH, align)
        np.testing.assert_allclose(edmlift.joint_errors(points[5], TRUTH[5], align), together[5])
    np.testing.assert_array_equal(
        rigid_errors(points, TRUTH), edmlift.joint_errors(points, TRUTH, "rigid")
    )


def test_a_pose_at_one_point_has_no_scale():
    assert np.isfinite(edmlift.pa_mpjpe(np.zeros((1, 14, 3)), TRUTH[:1]))


@pytest.mark.parametrize("shape", [(14, 2), (3,), (2, 14, 3)])
def test_shapes_that_do_not_fit(shape):
    with pytest.raises(ValueError, match=r"both be \[F,N,3\]"):
        edmlift.mpjpe(np.zeros(shape), TRUTH[0])


def test_an_alignment_that_is_none():
    with pytest.raises(ValueError, match="one of none, root, rigid, similarity, not 'procrustes'"):
        edmlift.mpjpe(TRUTH, TRUTH, "procrustes")
    with pytest.raises(ValueError, match="14 joints, not 17"):
        edmlift.mpjpe(np.zeros((17, 3)), np.zeros((17, 3)))
