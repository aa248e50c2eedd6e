"""The virtual cameras keep what the protocol says."""

import numpy as np
import pytest
from motions import STANDING

from data import cameras
from edmlift import joint_angles as angles
from edmlift import joints as skeleton
from edmlift.joints import HINGES, INDEX, MIRROR, PARENT, mid_hip


@pytest.fixture
def people():
    return np.repeat(STANDING[None], 4000, 0)


def test_a_view_is_a_rigid_motion(people):
    seen = cameras.look(people, np.random.default_rng(0))
    there = np.linalg.norm(people[:, :, None] - people[:, None], axis=-1)
    here = np.linalg.norm(seen[:, :, None] - seen[:, None], axis=-1)
    assert np.abs(there - here).max() < 1e-9
    # Not mirrored: the handedness of three bones is kept.
    assert np.allclose(handedness(seen), handedness(people), atol=1e-9)


def handedness(joints):
    a, b, c = (joints[:, INDEX[n]] - joints[:, 1] for n in ("head", "left_wrist", "right_knee"))
    return np.einsum("fi,fi->f", a, np.cross(b, c))


def test_distances_and_heights_are_the_rigs(people):
    seen = cameras.look(people, np.random.default_rng(1))
    distance = np.linalg.norm(mid_hip(seen), axis=1)
    assert distance.min() > 2.99 and distance.max() < 6.01
    assert distance.mean() == pytest.approx(4.5, abs=0.05)


def test_people_stand_upright_in_the_middle_of_the_image(people):
    points = cameras.project(cameras.look(people, np.random.default_rng(2)))
    assert np.abs(mid_hip(points) - 500).mean() < 25
    assert (points[:, INDEX["head"], 1] < points[:, INDEX["left_ankle"], 1]).all()
    height = np.ptp(points[:, :, 1], axis=1)
    assert 300 < height.mean() < 460


def test_a_person_facing_the_camera_has_the_left_on_the_right():
    rng = np.random.default_rng(3)
    seen = cameras.look(np.repeat(STANDING[None], 500, 0), rng)
    left = seen[:, INDEX["left_shoulder"]] - seen[:, INDEX["right_shoulder"]]
    up = seen[:, INDEX["neck_base"]] - mid_hip(seen)
    forward = np.cross(left, up)
    frontal = np.abs(forward[:, 2]) > 0.7 * np.linalg.norm(forward, axis=1)
    facing = forward[:, 2] < 0  # toward the camera
    assert 0.4 < facing.mean() < 0.6
    assert (left[facing & frontal, 0] > 0).all() and (left[~facing & frontal, 0] < 0).all()


def test_one_seed_gives_one_view(people):
    a, b = (cameras.look(people[:50], np.random.default_rng(4)) for _ in range(2))
    assert np.array_equal(a, b)


def test_a_camera_above_the_pelvis_is_still_a_camera():
    low = STANDING[None] - [0, 0.9, 0]  # pelvis on the floor, camera at 2.5 m, 1.5 m away
    rig = cameras.Rig(distance=(1.5, 1.5), height=(2.5, 2.5))
    seen = cameras.look(low, np.random.default_rng(5), rig)
    assert np.isfinite(seen).all() and np.linalg.norm(mid_hip(seen)[0]) == pytest.approx(1.5)


def test_noise_has_its_sigma(people):
    rng = np.random.default_rng(6)
    points = np.zeros((4000, 14, 2))
    assert cameras.gaussian_noise(points, 10.0, rng).std() == pytest.approx(10, rel=0.02)
    noisy = cameras.detector_noise(points, rng)
    sigma = noisy.std(axis=(0, 2))
    spread = np.sqrt(0.9 * 0.7**2 + 0.1 * 2.1**2)
    assert sigma == pytest.approx(
        cameras.DETECTOR_SIGMA * cameras.DETECTOR_SHARE * spread, rel=0.08
    )


def test_hidden_joints_are_as_many_as_asked_and_lose_their_coordinates():
    seen = cameras.hide_random(1000, np.arange(1000) % 5, np.random.default_rng(7))
    assert ((~seen).sum(1) == np.arange(1000) % 5).all()
    assert (~seen).mean(0).min() > 0.1  # every joint has its turn
    keypoints = cameras.keypoints(np.full((1000, 14, 2), 7.0), seen)
    assert (keypoints[~seen] == 0).all() and (keypoints[seen] == [7, 7, 1]).all()


def test_a_hidden_limb_is_its_two_outer_joints():
    seen = cameras.hide_limb(2, "left_leg")
    assert (~seen[0]).nonzero()[0].tolist() == [INDEX["left_knee"], INDEX["left_ankle"]]


def test_bodies_vary_in_length_not_in_direction(people):
    varied = cameras.vary_bodies(people, np.random.default_rng(8))
    bones = (varied - varied[:, PARENT])[:, np.arange(14) != PARENT]
    before = (people - people[:, PARENT])[:, np.arange(14) != PARENT]
    ratio = np.linalg.norm(bones, axis=-1) / np.linalg.norm(before, axis=-1)
    assert ratio.min() > 0.94 * 0.9 - 1e-9 and ratio.max() < 1.06 * 1.1 + 1e-9
    assert ratio.std(0).min() > 0.05
    assert np.allclose(bones, before * ratio[..., None])
    assert np.allclose(mid_hip(varied), mid_hip(people))


def test_left_and_right_vary_alike(people):
    varied = cameras.vary_bodies(people, np.random.default_rng(9))
    lengths = np.linalg.norm(varied - varied[:, PARENT], axis=-1)
    assert np.allclose(lengths, lengths[:, MIRROR])


def test_straightened_limbs_are_straight_and_as_long_and_others_stay(people):
    people = people + np.random.default_rng(9).normal(0, 0.05, people.shape)
    straight = cameras.straighten_limbs(people, 0.3, np.random.default_rng(10))
    before, after = angles.flexion(people), angles.flexion(straight)
    moved = np.abs(after - before) > 1e-9
    assert 0.2 < moved.mean() < 0.31
    assert after[moved].max() < 15 and (after[moved] < before[moved]).all()
    bones = [np.linalg.norm(x - x[:, PARENT], axis=-1) for x in (people, straight)]
    assert np.allclose(*bones)
    ends = [end for _, _, end in HINGES]
    assert (np.delete(straight, ends, 1) == np.delete(people, ends, 1)).all()
    assert (straight[:, ends][~moved] == people[:, ends][~moved]).all()


def test_a_straightened_limb_stays_in_its_plane(people):
    people = people + np.random.default_rng(9).normal(0, 0.05, people.shape)
    straight = cameras.straighten_limbs(people, 1.0, np.random.default_rng(11))
    for start, middle, end in HINGES:
        upper = people[:, middle] - people[:, start]
        normal = np.cross(upper, people[:, end] - people[:, middle])
        lower = straight[:, end] - straight[:, middle]
        assert np.abs(np.sum(normal * lower, 1)).max() < 1e-9
        assert (np.sum(np.cross(upper, lower) * normal, 1) > -1e-12).all()  # to the same side


def test_a_limb_that_is_bent_right_back_stays_as_it_is():
    pose = np.zeros((1, 14, 3))
    for start, middle, _ in HINGES:
        pose[0, middle] = pose[0, start] + [0, -0.4, 0]
    assert (cameras.straighten_limbs(pose, 1.0, np.random.default_rng(12)) == pose).all()


def test_the_skeleton_is_a_tree_of_13_bones():
    assert len(skeleton.BONES) == 13 and len(skeleton.PAIRS[0]) == 91
    assert (MIRROR[MIRROR] == np.arange(14)).all()
    assert sorted(j for names in skeleton.BONE_TYPE.values() for j in skeleton.indices(names)) == [
        j for j in range(14) if j != INDEX["neck_base"]
    ]
