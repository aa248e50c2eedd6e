"""Rivals answer with what they were made of."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data import cameras
from data.mocap import Motion
from edmlift.metrics import rigid_errors
from evaluation import accuracy, baselines, measures


@pytest.fixture
def train() -> Motion:
    joints = np.random.default_rng(3).normal(0, 0.3, (50, 14, 3)) + [0, 1, 0]
    number = np.zeros(50, int)
    return Motion(joints, number, number, number, number, (), "made up")


def test_mean_of_one_pose_rotated_is_that_pose(train):
    rotations = Rotation.random(50, rng=np.random.default_rng(4)).as_matrix()
    same = replace(train, joints=train.joints[:1] @ rotations)
    poses = baselines.MeanPose([same]).lift(np.zeros((2, 14, 3)))
    assert poses.joints.shape == (2, 14, 3) and (poses.status == "ok").all()
    assert rigid_errors(poses.joints, same.joints[:2]).max() < 1e-6


def test_nearest_neighbour_knows_its_own_views_of_any_size_and_with_joints_hidden(train):
    truth = cameras.look(train.joints, np.random.default_rng(baselines.SEED))
    seen = np.ones((50, 14), bool)
    seen[10:20, [3, 4]] = False
    seen[20:30, [0, 13]] = False  # the vertical extent is another
    keypoints = cameras.keypoints(0.5 * cameras.project(truth) + 40, seen)
    motions = [train.take(np.arange(20)), train.take(np.arange(20, 50))]
    poses = baselines.NearestNeighbour(motions).lift(keypoints)
    assert rigid_errors(poses.joints, truth).max() < 1e-6
    assert not np.array_equal(poses.joints[0], poses.joints[1])


@pytest.fixture
def trained(tmp_path, train, monkeypatch):
    """The JSON of a rival, and the people that it was measured on."""
    test = replace(train, joints=train.joints[:40] + 0.5, source="test.npz").take(np.arange(40))
    figures = {"gt": {"error": 61.0, "interval": [55.0, 66.0]}}
    other = {"sha256": train.sha256, "figures": {"gt": {"error": 1.0, "interval": [1.0, 1.0]}}}
    entry = {
        "data": {"files": [{"sha256": train.sha256}]},
        "tests": [other, {"sha256": test.sha256, "figures": figures}],
    }
    path = tmp_path / "rivals.json"
    path.write_text(json.dumps({"rivals": {"mlp40k": entry}, "trials": {}}))
    monkeypatch.setattr(baselines, "TRAINED", path)
    return path, test


def test_rows_of_trained_rivals_are_those_of_the_json(trained, train):
    path, test = trained
    rows = baselines.read_trained(path, test, [train], ["gt"])
    assert rows == {"Cartesian network, 40 K": {"gt": {"error": 61.0, "interval": [55.0, 66.0]}}}


def test_a_stale_json_is_refused(tmp_path, trained, train):
    path, test = trained
    other = replace(test, joints=test.joints + 0.001, source="other.npz")
    with pytest.raises(ValueError, match="mlp40k was measured on other poses .*other.npz"):
        baselines.read_trained(path, other, [train], ["gt"])
    for people in ([other], [train, other]):
        with pytest.raises(ValueError, match="mlp40k was trained on other poses .*other.npz"):
            baselines.read_trained(path, test, people, ["gt"])
    with pytest.raises(ValueError, match="mlp40k has no column n5, cpm"):
        baselines.read_trained(path, test, [train], ["gt", "n5", "cpm"])
    empty = tmp_path / "empty.json"
    empty.write_text("{}")
    with pytest.raises(ValueError, match="empty.json: has no rivals"):
        baselines.read_trained(empty, test, [train], ["gt"])
    with pytest.raises(ValueError, match="none.json: not there"):
        baselines.read_trained(tmp_path / "none.json", test, [train], ["gt"])


def test_trained_rivals_stand_first_or_are_left_out(trained, train, monkeypatch, capsys):
    _, test = trained
    views = measures.views
    monkeypatch.setattr(measures, "views", lambda joints: {"gt": views(joints)["gt"]})
    rows = accuracy.evaluate_rivals([train], test)
    assert list(rows) == ["Cartesian network, 40 K", "mean pose", "nearest neighbour"]
    assert rows["Cartesian network, 40 K"]["gt"]["error"] == 61.0
    assert "left out" not in capsys.readouterr().err
    other = replace(test, joints=test.joints + 0.001)
    assert list(accuracy.evaluate_rivals([train], other)) == ["mean pose", "nearest neighbour"]
    assert "left out: " in capsys.readouterr().err
