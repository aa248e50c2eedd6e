"""Angles are measured as they are off, of those of whom they can be told."""

from pathlib import Path

import numpy as np
import pytest
from motions import STANDING, people
from scipy.spatial.transform import Rotation
from support import OTHERS_TEST, ROOT, TEST, need_library, need_motion

from data.mocap import load_motion
from data.views import Column, views
from edmlift.joints import INDEX, mid_hip
from edmlift.library import Poses
from evaluation import angles
from evaluation.command import by_set
from reports import markdown

UP = np.array([0.0, -1.0, 0.0])
SUBJECT = np.repeat([1, 2], [30, 10])


@pytest.fixture
def truth() -> np.ndarray:
    """People who stand before a level camera, their left knees bent by 40 degrees."""
    need_library()
    pose = STANDING * [1, -1, 1]
    shin = Rotation.from_euler("x", 40, degrees=True).as_matrix()
    knee, ankle = INDEX["left_knee"], INDEX["left_ankle"]
    thigh = pose[knee] - pose[INDEX["left_hip"]]
    pose[ankle] = pose[knee] + shin @ thigh
    for side in ("right", "left"):  # the arms and the right leg are straight
        shoulder, elbow, wrist = (INDEX[f"{side}_{n}"] for n in ("shoulder", "elbow", "wrist"))
        pose[wrist] = 2 * pose[elbow] - pose[shoulder]
    hip, knee, ankle = (INDEX[f"right_{n}"] for n in ("hip", "knee", "ankle"))
    pose[ankle] = 2 * pose[knee] - pose[hip]
    return np.tile(pose - mid_hip(pose) + [0, 0, 4], (40, 1, 1))


class Pretend:
    def __init__(self, joints, status="ok"):
        self.joints, self.status, self.told = joints, status, None

    def lift(self, keypoints, up=None):
        self.told = up
        return Poses.of(self.joints, status=self.status)


def measure(joints, truth, know_up=False, status="ok"):
    up = np.tile(UP, (len(truth), 1))
    column = Column(np.zeros_like(truth), np.ones(truth.shape[:2], bool), truth, up)
    lifter = Pretend(joints, status)
    found = angles.measure(lifter, column, SUBJECT, know_up)
    assert (lifter.told is not None) == know_up
    return found


def test_the_truth_is_right(truth):
    found = measure(truth, truth)
    names = ["elbows", "straight elbows", "knees", "straight knees", "lean of the trunk", "heading"]
    assert list(found) == names
    np.testing.assert_allclose([*found.values()], 0, atol=1e-4)


def test_a_straight_leg_that_comes_out_bent_is_told_by_itself(truth):
    joints = truth.copy()
    knee, ankle = INDEX["right_knee"], INDEX["right_ankle"]
    bent = Rotation.from_euler("x", 20, degrees=True).as_matrix()
    joints[:, ankle] = joints[:, knee] + (truth[:, ankle] - truth[:, knee]) @ bent.T
    found = measure(joints, truth)
    assert found["straight knees"] == pytest.approx([20, 20], abs=1e-3)
    assert found["knees"] == pytest.approx([10, 10], abs=1e-3)  # of two
    assert found["straight elbows"] == pytest.approx([0, 0], abs=1e-3)
    found = measure(truth, joints)  # the other way round: bias has a sign
    assert found["knees"] == pytest.approx([10, -10], abs=1e-3)
    assert np.isnan(found["straight knees"]).all()  # there is none


def test_people_count_alike_and_refused_poses_do_not(truth):
    tilt = Rotation.from_euler("x", -8, degrees=True).as_matrix()
    joints = truth.copy()
    joints[SUBJECT == 2] = (truth[SUBJECT == 2] - [0, 0, 4]) @ tilt.T
    found = measure(joints, truth)
    assert np.abs(found["lean of the trunk"]) == pytest.approx([4, 4], abs=0.1)
    status = np.where(SUBJECT == 2, "degenerate", "ok")
    found = measure(np.where((SUBJECT == 2)[:, None, None], np.nan, joints), truth, status=status)
    assert found["lean of the trunk"] == pytest.approx([0, 0], abs=1e-3)


def test_heading_is_of_those_who_do_not_lie_on_a_side(truth):
    turned = (truth - [0, 0, 4]) @ Rotation.from_euler("y", 170, degrees=True).as_matrix()
    assert measure(turned, truth)["heading"][0] == pytest.approx(170, abs=1e-3)
    lying = (truth - [0, 0, 4]) @ Rotation.from_euler("z", 90, degrees=True).as_matrix()
    assert np.isnan(measure(turned, lying)["heading"]).all()


def test_the_table_has_a_column_a_lifter_and_view(truth):
    need_library()
    motion = people(24)

    class Exact:
        def lift(self, keypoints, up=None):
            at = next(c for c in views(motion.joints).values()
                      if np.array_equal(c.keypoints, keypoints))  # fmt: skip
            return Poses.of(at.truth - mid_hip(at.truth)[:, None])

    found = angles.evaluate(Exact(), motion, ("gt", "cpm", "gt, up given"))
    text = angles.report({"one": found, "two": found})
    head, _, *rows = text.splitlines()
    assert head.startswith("| degrees | one, gt | one, cpm | one, gt, up given | two, gt |")
    assert len(rows) == 12 and rows[1].startswith("| elbows, bias | +0.0 |")


def test_all_angles_are_told_right_and_left_together(truth):
    joints = truth.copy()
    knee, ankle = INDEX["right_knee"], INDEX["right_ankle"]
    bent = Rotation.from_euler("x", 20, degrees=True).as_matrix()
    joints[:, ankle] = joints[:, knee] + (truth[:, ankle] - truth[:, knee]) @ bent.T
    off = angles.every_off(joints, truth, np.tile(UP, (len(truth), 1)))
    assert len(off) == 12 and all(len(d) == len(truth) for d in off.values())
    assert off["knee flexion"].shape[1] == 2 and off["heading"].shape[1] == 1
    np.testing.assert_allclose(off["knee flexion"][:, 0], 20, atol=1e-3)
    others = np.concatenate([off[name] for name in off if name != "knee flexion"], 1)
    np.testing.assert_allclose(others[np.isfinite(others)], 0, atol=1e-3)
    assert np.isfinite(off["shoulder elevation"]).all() and np.isfinite(off["heading"]).all()


@pytest.mark.slow
@pytest.mark.claims("docs/angles.md", "angle_errors")
def test_the_angles_of_the_page_are_measured():
    motions = {Path(name).stem: load_motion(need_motion(name)) for name in (TEST, OTHERS_TEST)}
    need_library()
    figures = angles.every_by_set(angles.MODELS, motions)
    page = ROOT / "docs" / "angles.md"
    assert markdown.read(page, "angle_errors") == by_set(angles.report, figures)
