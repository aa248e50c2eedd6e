"""The views of the protocol: the draws of the columns there were, and what is told of up."""

import numpy as np
import pytest

from data import cameras
from data.views import SEED, STRESS, conditions, views


@pytest.fixture(scope="module")
def joints() -> np.ndarray:
    return np.random.default_rng(3).normal(0, 0.3, (60, 14, 3)) + [0, 1, 0]


def test_a_new_column_leaves_the_others_as_they_were(joints):
    """Figures stay comparable: the draws are those of the columns before there was `sideways`."""
    rng = np.random.default_rng(SEED)
    truth = cameras.look(joints, rng)
    expected = conditions(truth, cameras.project(truth), rng)
    found = views(joints)
    for name, column in expected.items():
        np.testing.assert_array_equal(found[name].keypoints, column.keypoints)
    for name, rig in STRESS.items():
        np.testing.assert_array_equal(found[name].truth, cameras.look(joints, rng, rig))
    assert [*found] == [*expected, *STRESS, "sideways"]


def test_up_is_that_of_each_camera(joints):
    """The world's vertical, in which the head of someone upright is above the hips."""
    for name, column in views(joints).items():
        assert np.linalg.norm(column.up, axis=1) == pytest.approx(1)
        height = (column.truth * column.up[:, None]).sum(-1)
        rise = height - height[:, :1]
        np.testing.assert_allclose(rise, joints[..., 1] - joints[:, :1, 1], atol=1e-9, err_msg=name)


def test_sideways_cameras_are_those_of_gt_turned_to_either_side(joints):
    columns = views(joints)
    upright, column = columns["gt"], columns["sideways"]
    assert (np.abs(column.up[:, 0]) > 0.6).all() and len(np.unique(np.sign(column.up[:, 0]))) == 2
    np.testing.assert_allclose(column.truth[..., 2], upright.truth[..., 2])
    np.testing.assert_array_equal(column.keypoints[..., :2], cameras.project(column.truth))
    offset = column.keypoints[..., :2] - cameras.CENTRE
    before = upright.keypoints[..., :2] - cameras.CENTRE
    turned = np.sign(column.up[:, :1] * upright.up[:, 1:2])  # x is the former y, or its negative
    np.testing.assert_allclose(offset[..., 0], turned * before[..., 1], atol=1e-9)
    np.testing.assert_allclose(offset[..., 1], -turned * before[..., 0], atol=1e-9)


def test_some_of_the_views(joints):
    column = views(joints)["rand2"]
    few = column.take(np.arange(3))
    for name in ("keypoints", "seen", "truth", "up"):
        np.testing.assert_array_equal(getattr(few, name), getattr(column, name)[:3])
    truth = column.truth
    plain = conditions(truth, cameras.project(truth), np.random.default_rng(0))["gt"]
    assert plain.up is None and plain.take(np.arange(3)).up is None
