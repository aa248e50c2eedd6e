"""Angles of poses that are made at known ones."""

import numpy as np
import pytest
from package_support import DATA
from scipy.spatial.transform import Rotation

import edmlift
from edmlift import joint_angles as angles
from edmlift._binding import load
from edmlift.joints import INDEX, mid_hip, mirrored

LEVEL = np.array(angles.LEVEL)


def bent(degrees: float) -> np.ndarray:
    """Someone [14,3] who stands upright and faces a level camera, elbows and knees so bent."""
    pose = np.zeros((14, 3))

    def put(name: str, *at: float) -> None:
        pose[INDEX[f"right_{name}"]] = np.array(at) * [-1, 1, 1]  # the camera's left
        pose[INDEX[f"left_{name}"]] = at

    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    pose[INDEX["head"]], pose[INDEX["neck_base"]] = (0, -0.8, 0), (0, -0.5, 0)
    put("shoulder", 0.2, -0.45, 0)
    put("elbow", 0.2, -0.2, 0)
    put("wrist", 0.2, -0.2 + 0.25 * c, -0.25 * s)
    put("hip", 0.1, 0, 0)
    put("knee", 0.1, 0.4, 0)
    put("ankle", 0.1, 0.4 + 0.4 * c, 0.4 * s)
    return pose


@pytest.mark.parametrize("degrees", [0, 8, 90, 179])
def test_flexion_is_the_angle_by_which_a_limb_is_bent(degrees: float):
    np.testing.assert_allclose(angles.flexion(bent(degrees)), degrees, atol=1e-5)
    turned = bent(degrees) @ Rotation.random(rng=np.random.default_rng(0)).as_matrix() + [1, 2, 3]
    np.testing.assert_allclose(angles.flexion(turned), degrees, atol=1e-5)


def test_each_limb_has_its_own_flexion():
    pose = bent(0)
    pose[INDEX["left_ankle"]] = bent(30)[INDEX["left_ankle"]]
    np.testing.assert_allclose(angles.flexion(pose), [0, 0, 0, 30], atol=1e-5)
    assert angles.BENDING[3] == "left_knee"
    np.testing.assert_allclose(angles.flexion(mirrored(pose)), [0, 0, 30, 0], atol=1e-5)


@pytest.mark.parametrize("degrees", [0, 10, 30, 90, 180])
def test_lean_is_told_from_the_vertical_and_not_from_the_camera(degrees: float):
    for axis in ("x", "z"):
        tilt = Rotation.from_euler(axis, degrees, degrees=True).as_matrix()
        assert angles.lean(bent(0) @ tilt) == pytest.approx(degrees, abs=1e-5)
        assert angles.lean(bent(0) @ tilt, 7 * LEVEL @ tilt) == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("degrees", [0, 30, 90, -90, -150])
def test_heading_is_towards_the_camera_and_turns_to_the_right_of_the_image(degrees: float):
    turn = Rotation.from_rotvec(np.radians(degrees) * LEVEL).as_matrix()
    pose = bent(20) @ turn.T
    facing = np.array([0, 0, -1]) @ turn.T
    assert angles.heading(pose) == pytest.approx(degrees, abs=1e-5)
    assert np.degrees(np.arctan2(facing[0], -facing[2])) == pytest.approx(degrees)
    assert angles.heading(pose + 5) == pytest.approx(degrees, abs=1e-5)
    down = Rotation.from_euler("x", 25, degrees=True).as_matrix()  # the camera looks down
    assert angles.heading(pose @ down, LEVEL @ down) == pytest.approx(degrees, abs=1e-5)


def test_a_mirrored_person_faces_the_other_way_round():
    pose = np.array([bent(d) for d in (0, 20)]) @ Rotation.from_euler("y", 40, True).as_matrix()
    np.testing.assert_allclose(angles.heading(mirrored(pose)), -angles.heading(pose), atol=1e-5)


def test_who_lies_on_a_side_has_an_upright_line_of_shoulders():
    for roll, slope in ((0, 0), (60, 60), (90, 90), (120, 60)):
        side = Rotation.from_euler("z", roll, degrees=True).as_matrix()
        assert angles.side_slope(bent(0) @ side) == pytest.approx(slope, abs=1e-5)


def test_turns_go_the_short_way_round():
    found = angles.turn([170, -170, 10, 0], [-170, 170, 40, 0])
    np.testing.assert_allclose(found, [20, -20, 30, 0])


def test_what_has_no_direction_is_nan():
    nobody = np.zeros((2, 14, 3))
    nobody[1] = np.nan
    with np.errstate(all="raise"):
        for found in (angles.flexion(nobody), angles.lean(nobody), angles.heading(nobody)):
            assert np.isnan(found).all()


def test_shapes_are_those_of_the_poses_and_up_may_be_one_a_pose():
    walk = edmlift.read_truth(DATA / "walk_truth.csv")
    assert angles.flexion(walk).shape == (len(walk), 4) and angles.flexion(walk[0]).shape == (4,)
    ups = np.tile(LEVEL, (len(walk), 1))
    for measure in (angles.lean, angles.heading, angles.side_slope):
        assert measure(walk[0]).shape == ()
        np.testing.assert_allclose(measure(walk, ups), measure(walk))
    # Someone walks: upright, and never with a leg as straight as a rod.
    assert angles.lean(walk).max() < 30 and 1 < angles.flexion(walk)[:, 2:].min() < 20
    assert np.ptp(np.unwrap(np.radians(angles.heading(walk)))) < np.radians(60)
    assert (mid_hip(walk) < 1e-3).all()


# ---- All angles of poses -----------------------------------------------------------------------


def test_names_are_those_of_the_c_library():
    c = load()
    assert [c.edml_angle_name(n).decode() for n in range(len(angles.ANGLES))] == [*angles.ANGLES]
    assert c.edml_angle_name(len(angles.ANGLES)) == b"?"
    assert tuple(n.removesuffix("_flexion") for n in angles.ANGLES[:4]) == angles.BENDING


def test_angles_of_poses_are_by_name_and_nan_where_a_joint_was_not_seen():
    keypoints = edmlift.read_keypoints(DATA / "walk.csv")[:8].copy()
    keypoints[2, INDEX["left_wrist"], 2] = 0
    keypoints[5, :6, 2] = 0  # too few
    poses = edmlift.lift(keypoints, up=LEVEL)
    found = edmlift.angles(poses, LEVEL)
    assert tuple(found) == edmlift.ANGLES and all(a.shape == (8,) for a in found.values())
    nan = {name: np.flatnonzero(np.isnan(a)).tolist() for name, a in found.items()}
    assert nan["left_elbow_flexion"] == [2, 5] and nan["right_elbow_flexion"] == [5]
    assert nan["heading"] == nan["trunk_lean"] == [5]
    np.testing.assert_array_equal(found["trunk_lean"], edmlift.lean(poses.joints, LEVEL))
    np.testing.assert_array_equal(found["heading"], edmlift.heading(poses.joints, LEVEL))
    few = np.stack([found[f"{name}_flexion"] for name in angles.BENDING], -1)
    few[2, 1] = angles.flexion(poses.joints)[2, 1]  # a guessed joint has coordinates all the same
    np.testing.assert_allclose(few, angles.flexion(poses.joints), rtol=2e-7)  # a last bit


def test_one_pose_gives_numbers_and_up_is_level_by_default():
    pose = edmlift.Poses.of(bent(30))
    found = edmlift.angles(pose)
    assert np.ndim(found["heading"]) == 0
    assert found["right_knee_flexion"] == pytest.approx(30, abs=1e-4)
    tilt = Rotation.from_euler("x", 25, degrees=True).as_matrix()
    tilted = edmlift.Poses.of(bent(30) @ tilt)
    assert edmlift.angles(tilted)["trunk_lean"] == pytest.approx(25, abs=1e-4)
    assert edmlift.angles(tilted, 3 * LEVEL @ tilt)["trunk_lean"] == pytest.approx(0, abs=1e-4)
    with pytest.raises(ValueError, match="up must be"):
        edmlift.angles(pose, (0, 0, 0))
    with pytest.raises(TypeError, match="Poses"):
        edmlift.angles(bent(30))


def test_a_mirror_exchanges_right_and_left_angles():
    walk = edmlift.read_truth(DATA / "walk_truth.csv")
    found, other = (edmlift.angles(edmlift.Poses.of(x)) for x in (walk, mirrored(walk)))
    for name, degrees in found.items():
        side, _, rest = name.partition("_")
        exchanged = {"right": f"left_{rest}", "left": f"right_{rest}"}.get(side, name)
        sign = -1 if name in ("heading", "trunk_lean_right") else 1
        np.testing.assert_allclose(other[exchanged], sign * degrees, atol=2e-3)


def test_joints_may_be_anywhere_and_of_any_size():
    pose = bent(40)
    for size, place in ((1000, (0, 0, 4000)), (1e-3, (0, 0, 0)), (1, (100, -50, 3))):
        np.testing.assert_allclose(angles.every(size * pose + place), angles.every(pose), atol=1e-3)


def test_a_joint_that_is_nan_takes_its_own_angles_only():
    pose = bent(40)
    pose[INDEX["left_wrist"]] = np.nan
    assert np.isnan(angles.every(pose)).sum() == np.isnan(angles.every(bent(40))).sum() + 1
