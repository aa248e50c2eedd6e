"""Rivals answer with what they were made of."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import cameras
import rivals
from mirror import rigid_errors
from mocap import Motion


@pytest.fixture
def train() -> Motion:
    joints = np.random.default_rng(3).normal(0, 0.3, (50, 14, 3)) + [0, 1, 0]
    number = np.zeros(50, int)
    return Motion(joints, number, number, number, number, (), "made up")


def test_mean_of_one_pose_turned_is_that_pose(train):
    turned = Rotation.random(50, rng=np.random.default_rng(4)).as_matrix()
    same = replace(train, joints=train.joints[:1] @ turned)
    poses = rivals.MeanPose(same).lift(np.zeros((2, 14, 3)))
    assert poses.joints.shape == (2, 14, 3) and (poses.status == "ok").all()
    assert rigid_errors(poses.joints, same.joints[:2]).max() < 1e-6


def test_nearest_neighbour_knows_its_own_views_of_any_size_and_with_joints_hidden(train):
    truth = cameras.look(train.joints, np.random.default_rng(rivals.SEED))
    seen = np.ones((50, 14), bool)
    seen[10:20, [3, 4]] = False
    seen[20:30, [0, 13]] = False  # the vertical extent is another
    keypoints = cameras.keypoints(0.5 * cameras.project(truth) + 40, seen)
    poses = rivals.NearestNeighbour(train).lift(keypoints)
    assert rigid_errors(poses.joints, truth).max() < 1e-6
    assert not np.array_equal(poses.joints[0], poses.joints[1])
