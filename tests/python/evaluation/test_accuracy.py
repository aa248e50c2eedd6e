"""The metric measures what it says, on lifters whose errors are known."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data.views import NOISE, Column, views
from edmlift.joints import INDEX, mid_hip
from edmlift.library import Poses
from evaluation import accuracy, forms, measures
from reports import markdown


@dataclass
class Pretend:
    """A lifter that returns prepared joints."""

    joints: np.ndarray
    status: str = "ok"

    def lift(self, keypoints):
        assert len(keypoints) == len(self.joints)
        return Poses.of(self.joints, status=self.status)


@pytest.fixture
def truth():
    return np.random.default_rng(0).normal(0, 0.4, (60, 14, 3)) + [0, 0, 4]


SUBJECT = np.repeat([1, 2, 3], [40, 15, 5])


def figures(joints, truth, seen=None):
    seen = np.ones(truth.shape[:2], bool) if seen is None else seen
    column = Column(np.zeros((*truth.shape[:2], 3)), seen, truth)
    return measures.measure(Pretend(joints), column, SUBJECT)


def test_a_rotated_and_moved_truth_has_no_error(truth):
    moved = truth @ Rotation.random(rng=np.random.default_rng(1)).as_matrix() + [1, 2, 3]
    result = figures(moved, truth)
    assert result["error"] == pytest.approx(0, abs=1e-3)
    assert result["mirror_right_percent"] == 100 and result["pck150_percent"] == 100
    assert result["camera_axes"] > 100  # no alignment there


def test_the_mirror_image_is_wrong_but_for_the_oracle(truth):
    result = figures(truth * [1, 1, -1], truth)
    assert result["error"] > 50 and result["mirror_right_percent"] == 0
    assert result["oracle_mirror"] == pytest.approx(0, abs=1e-3)


def test_size_counts_unless_scaled(truth):
    result = figures(truth * 1.1, truth)
    assert result["with_scale"] == pytest.approx(0, abs=1e-3)
    centred = truth - truth.mean(1, keepdims=True)
    expected = [(100 * np.linalg.norm(centred[s == SUBJECT], axis=-1)).mean() for s in (1, 2, 3)]
    assert result["error"] == pytest.approx(np.mean(expected))


def test_subjects_count_alike(truth):
    joints = truth.copy()
    joints[SUBJECT == 3] *= [1, 1, -1]  # 5 of 60 frames, 1 of 3 subjects
    result = figures(joints, truth)
    assert result["mirror_right_percent"] == pytest.approx(200 / 3)
    assert result["mirror_right_percent_of_frames"] == pytest.approx(100 * 55 / 60)
    low, high = result["interval"]
    assert low == pytest.approx(0, abs=1e-3) and high > result["error"]


def test_hidden_joints_are_told_apart(truth):
    seen = np.ones((60, 14), bool)
    seen[:, INDEX["left_wrist"]] = False
    joints = truth.copy()
    joints[:, INDEX["left_wrist"]] += [0.2, 0, 0]
    result = figures(joints, truth, seen)
    assert result["hidden_joints"] == pytest.approx(result["by_joint"]["left_wrist"])
    assert result["hidden_joints"] > 5 * result["by_joint"]["right_knee"]
    assert "hidden_joints" not in figures(joints, truth)


def test_camera_axes_compares_without_rotating(truth):
    rooted = truth - mid_hip(truth)[:, None]
    assert figures(rooted, truth)["camera_axes"] == pytest.approx(0, abs=1e-3)


class Half(Pretend):
    """Refuses every other pose."""

    def lift(self, keypoints):
        poses = super().lift(keypoints)
        status = np.where(np.arange(len(keypoints)) % 2, poses.status, "aspect")
        joints = np.where(np.arange(len(keypoints))[:, None, None] % 2, poses.joints, np.nan)
        return Poses.of(joints, status=status)


def test_refused_poses_are_counted_and_left_out(truth):
    column = Column(np.zeros((60, 14, 3)), np.ones((60, 14), bool), truth)
    result = measures.measure(Half(truth), column, SUBJECT)
    assert result["refused"] == 30 and result["error"] == pytest.approx(0, abs=1e-3)


def test_views_are_the_protocols_columns():
    joints = np.random.default_rng(2).normal(0, 0.3, (200, 14, 3)) + [0, 1, 0]
    columns = views(joints)
    limbs = ["right_arm", "left_arm", "right_leg", "left_leg"]
    noisy = ["n5", "n10", "n15", "n20", "cpm"]
    assert list(columns) == ["gt", *noisy, "rand2", *limbs, "rolled", "close"]
    exact = columns["gt"].keypoints[..., :2]
    for name, sigma in NOISE.items():
        off = columns[name].keypoints[..., :2] - exact
        assert off.std() == pytest.approx(sigma, rel=0.05)
    assert (columns["rand2"].seen.sum(1) == 12).all()
    again = views(joints)
    assert all(np.array_equal(columns[n].keypoints, again[n].keypoints) for n in columns)
    assert columns["gt"].truth is columns["left_leg"].truth
    near, far = (np.linalg.norm(mid_hip(columns[n].truth), axis=1) for n in ("close", "gt"))
    assert near.min() > 1.4 and near.max() < 3.01 < far.max()


def test_tables_have_a_row_a_figure(truth):
    found = {"gt": figures(truth, truth)}
    assert "| error | 0.0 |" in accuracy.means_table(found)
    assert "| left_wrist | 0.0 |" in accuracy.joints_table(found)


def test_what_a_form_loses_is_told_from_the_float_lift(truth):
    column = Column(np.zeros((60, 14, 3)), np.ones((60, 14), bool), truth)
    near = truth + [0, 0.003, 0]
    near[:6] *= [1, 1, -1]
    result = forms.lose({"f32": Pretend(truth), "near": Pretend(near)}, column, SUBJECT)
    assert list(result) == ["near"]
    assert result["near"]["moved"] == pytest.approx(3, rel=1e-4)
    assert result["near"]["moved_999"] == pytest.approx(3, rel=1e-4)
    assert result["near"]["mirrored"] == 6 and result["near"]["refused"] == 0
    assert result["near"]["error"] > 5  # of the six; moving costs nothing
    half = forms.lose({"f32": Pretend(truth), "half": Half(near)}, column, SUBJECT)["half"]
    assert half["refused"] == 30 and half["moved"] == pytest.approx(3, rel=1e-4)


def test_small_differences_have_no_sign():
    assert markdown.signed(-0.004) == "0.00" and markdown.signed(-0.006) == "-0.01"


def test_rivals_stand_beside_the_paper(truth):
    mine = {"gt": figures(truth, truth), "close": figures(truth, truth)}
    rival = {name: figures(truth * 1.1, truth) for name in mine}
    text = accuracy.rivals_table(mine, {"nearest": rival})
    assert "| edmlift | 0.0 | 0.0 |" in text
    assert f"| nearest | {rival['gt']['error']:.1f} |" in text
    assert text.splitlines()[-1] == "| the paper's FConv, on other data | 62.2 |  |"
