"""Cases that users complain of: each must come out well enough to be used (cases/README.md)."""

from pathlib import Path

import numpy as np
import pytest
from support import EXAMPLES, need_library

import edmlift
from data import cameras
from edmlift import joint_angles as angles
from edmlift.joints import INDEX, mid_hip
from edmlift.metrics import rigid_errors

CASES = Path(__file__).parent / "cases"
MODELS = ("distances_f32", "direct_f32")
KNEES = [angles.BENDING.index(name) for name in ("right_knee", "left_knee")]
ANKLES = [INDEX["right_ankle"], INDEX["left_ankle"]]
DISTANCE = 4.0  # metres, at which the cases are seen


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def read(name: str, numbers: int = 3) -> np.ndarray:
    """Rows of joints or keypoints [F,n,3] of a case, or of so many other numbers."""
    rows = np.loadtxt(CASES / f"{name}.csv", delimiter=",", ndmin=2)
    return rows if numbers != 3 else rows.reshape(len(rows), -1, 3)


def raised(truth: np.ndarray, degrees: float) -> np.ndarray:
    """The same people [F,14,3], seen from so many degrees further above."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return truth @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T


def seen(truth: np.ndarray) -> np.ndarray:
    """Their keypoints [F,14,3], exact."""
    return cameras.keypoints(cameras.project(truth + [0, 0, DISTANCE]))


def leans(joints: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Angles [F] between up and the line from between the ankles to the neck."""
    return angles.between(joints[:, INDEX["neck_base"]] - joints[:, ANKLES].mean(1), up)


# ---- What the files hold ----------------------------------------------------------------------


@pytest.mark.parametrize("name", ["camera_looks_down", "straight_legs", "sitting"])
def test_keypoints_are_where_the_truth_is_seen(name: str):
    truth, keypoints = read(f"{name}_truth"), read(name)
    np.testing.assert_allclose(seen(truth)[..., :2], keypoints[..., :2], atol=0.05)
    np.testing.assert_allclose(mid_hip(truth), 0, atol=1e-4)


def test_who_is_seen_from_above_is_upright():
    elevation, *up = read("camera_looks_down_up", 4).T
    up = np.stack(up, 1)
    truth = read("camera_looks_down_truth")
    assert leans(truth, up).max() < 1
    neck = truth[:, INDEX["neck_base"]]
    assert (neck[:, 2] < 0).all()  # it is nearer to the camera than the hips
    np.testing.assert_allclose(np.degrees(np.arcsin(-up[:, 2])), elevation, atol=0.01)


@pytest.mark.parametrize(("name", "below"), [("straight_legs", 8), ("sitting", 10)])
def test_the_others_are_seen_from_below(name: str, below: float):
    """And raised() sees them from as much above."""
    truth = read(f"{name}_truth")
    for people, sign in ((truth, 1), (raised(truth, 2 * below), -1)):
        tilt = np.degrees(np.arctan2(people[:, 1, 2], -people[:, 1, 1])).mean()
        assert sign * tilt == pytest.approx(below, abs=2)


# ---- What must come out ----------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_someone_upright_before_a_camera_that_looks_down_does_not_lean(model: str):
    elevation, *up = read("camera_looks_down_up", 4).T
    up, keypoints = np.stack(up, 1), read("camera_looks_down")
    told, alone = edmlift.lift(keypoints, model, up), edmlift.lift(keypoints, model)
    assert told.ok.all() and alone.ok.all()
    for degrees in (10, 20, 30):
        those = elevation == degrees
        assert leans(told.joints[those], up[those]).mean() < 5
        assert leans(alone.joints[those], up[those]).mean() < 10, degrees


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("above", [0, 16])
def test_straight_legs_are_straight(model: str, above: float):
    truth = read("straight_legs_truth")
    keypoints = seen(raised(truth, above)) if above else read("straight_legs")
    flexion = angles.flexion(edmlift.lift(keypoints, model).joints)[:, KNEES]
    assert angles.flexion(truth)[:, KNEES].max() < 9
    assert flexion.mean() < 15
    if above == 0 and model == MODELS[0]:  # the case itself, by the default network: each leg
        assert flexion.max() < 15


@pytest.mark.parametrize("model", MODELS)
def test_a_detectors_legs_outside_the_image_are_not_believed(model: str):
    keypoints = read("legs_out_of_frame")
    pose = edmlift.lift(keypoints, model, format="blazepose33", image=(1280, 720))
    assert pose.ok.all() and pose.seen.sum() == 10
    assert list(np.flatnonzero(~pose.seen[0])) == [9, 10, 12, 13]  # knees and ankles
    assert edmlift.quality(pose)[0] < 0.8


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("above", [0, 20])
def test_someone_who_sits_comes_out_sitting(model: str, above: float):
    truth = raised(read("sitting_truth"), above)
    keypoints = seen(truth) if above else read("sitting")
    poses = edmlift.lift(keypoints, model)
    assert poses.ok.all()
    assert 1000 * rigid_errors(poses.joints.astype(float), truth).mean() < 65
    off = angles.flexion(poses.joints)[:, KNEES] - angles.flexion(truth)[:, KNEES]
    assert np.abs(off).mean() < 10


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("pixels", "mean", "worst"), [(2, 10, 50), (8, 20, 250)])
def test_someone_who_stands_still_does_not_tremble(
    model: str, pixels: float, mean: float, worst: float
):
    keypoints = read("standing_still")
    if pixels != 2:  # the file's own noise, enlarged
        middle = keypoints[..., :2].mean(0)
        keypoints[..., :2] = middle + pixels / 2 * (keypoints[..., :2] - middle)
    alone, tracked = (
        1000 * np.linalg.norm(np.diff(poses.joints[30:], axis=0), axis=-1)
        for poses in (edmlift.lift(keypoints, model), edmlift.track(keypoints, fps=30, model=model))
    )
    assert tracked.mean() < mean and tracked.max() < worst
    assert tracked.mean() < alone.mean() / 4


@pytest.mark.parametrize("model", MODELS)
def test_one_frame_of_another_person_leaves_no_trace(model: str):
    """Whom the detector lists first for a frame, 420 pixels to the right."""
    keypoints = read("other_person_once")
    alone = edmlift.lift(keypoints, model)
    tracked = edmlift.track(keypoints, fps=30, model=model)
    assert tracked.ok.all() and tracked.elapsed[15] == 0 and tracked.elapsed[16] > 60
    off = 1000 * np.linalg.norm(tracked.joints - alone.joints, axis=-1).mean(1)
    assert off[15] == 0 and off.max() < 15
    without = np.delete(keypoints, 15, 0)
    times = np.delete(np.arange(len(keypoints)) * 1000 / 30, 15)
    clean = edmlift.track(without, time_ms=times, model=model)
    np.testing.assert_array_equal(np.delete(tracked.joints, 15, 0), clean.joints)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("turn", [90, 180, 270, 37])
def test_a_turned_image_is_a_turned_pose(model: str, turn: float):
    """Handstands, people who lie, and cameras on their side are as good as upright."""
    walk = np.loadtxt(EXAMPLES / "walk.csv", delimiter=",", ndmin=2).reshape(-1, 14, 3)
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    turned = walk.copy()
    turned[..., :2] = (walk[..., :2] - 500) @ rotation[:2, :2].T + 500
    upright, poses = edmlift.lift(walk, model), edmlift.lift(turned, model)
    assert (poses.status == upright.status).all()
    np.testing.assert_allclose(poses.joints, upright.joints @ rotation.T, atol=1e-3)
