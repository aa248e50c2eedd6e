"""The committed clips of examples/data, and the tool that makes them."""

from pathlib import Path

import numpy as np
import pytest
from support import ROOT

from data import cameras, make_samples
from edmlift.joints import BONES, INDEX, JOINTS, mid_hip

DATA = ROOT / "examples" / "data"
CLIPS = {"walk": 39, "cartwheel": 82, "kick": 47, "tpose": 1}


def read(name: str) -> np.ndarray:
    rows = np.loadtxt(DATA / f"{name}.csv", delimiter=",", ndmin=2)
    return rows.reshape(len(rows), len(JOINTS), 3)


@pytest.mark.parametrize(("clip", "count"), CLIPS.items())
def test_shapes_and_ranges(clip: str, count: int):
    points, truth = read(clip), read(f"{clip}_truth")
    assert points.shape == truth.shape == (count, 14, 3)
    assert np.isfinite(points).all() and np.isfinite(truth).all()
    assert (points[..., :2] >= 0).all() and (points[..., :2] <= 1000).all()
    assert (points[..., 2] == 1).all()


@pytest.mark.parametrize("clip", CLIPS)
def test_files_are_small_and_say_what_they_are(clip: str):
    for name in (clip, f"{clip}_truth"):
        lines = (DATA / f"{name}.csv").read_text().splitlines()
        comments = [line for line in lines if line.startswith("#")]
        assert len(lines) <= 90
        assert lines[: len(comments)] == comments
        assert f"# {', '.join(JOINTS)}" in comments
        assert "licence" in comments[-1]


@pytest.mark.parametrize("clip", CLIPS)
def test_truth_is_a_rigid_body_rooted_at_mid_hip(clip: str):
    truth = read(f"{clip}_truth")
    np.testing.assert_allclose(mid_hip(truth), 0, atol=1e-4)
    # Neck to hip changes as the spine bends; the pelvis itself is rigid.
    hips = INDEX["right_hip"], INDEX["left_hip"]
    for start, end in [hips] + [bone for bone in BONES if bone[1] not in hips]:
        length = np.linalg.norm(truth[:, end] - truth[:, start], axis=1)
        assert np.ptp(length) < 0.001, JOINTS[end]


@pytest.mark.parametrize("clip", CLIPS)
def test_truth_projects_to_the_keypoints(clip: str):
    # (x - 500) / f * (Z + tz) = X + tx, and likewise in y: linear in the unknown translation t.
    for points, truth in zip(read(clip), read(f"{clip}_truth"), strict=True):
        slope = (points[:, :2] - cameras.CENTRE) / cameras.FOCAL
        unknowns = np.zeros((14, 2, 3))
        unknowns[:, 0, 0] = unknowns[:, 1, 1] = -1
        unknowns[:, :, 2] = slope
        known = truth[:, :2] - slope * truth[:, 2:]
        move = np.linalg.lstsq(unknowns.reshape(28, 3), known.reshape(28), rcond=None)[0]
        residual = cameras.project((truth + move)[None])[0] - points[:, :2]
        assert np.abs(residual).max() < 0.1  # pixels
        assert 2.5 < move[2] < 6  # metres to the camera


@pytest.mark.parametrize("clip", ("tpose", "walk"))
def test_a_subject_who_faces_the_camera_has_its_right_on_the_left(clip: str):
    points = read(clip)
    for joint in ("shoulder", "hip"):
        right, left = (points[:, INDEX[f"{side}_{joint}"], 0] for side in ("right", "left"))
        assert (right < left).all()


def test_look_from_keeps_lengths_and_centres_the_aim():
    joints = np.random.default_rng(1).normal(size=(5, 14, 3))
    position, aim = np.array([3.0, 1.5, 2.0]), joints[0, 0]
    seen = cameras.look_from(joints, position, aim)
    np.testing.assert_allclose(seen[0, 0], [0, 0, np.linalg.norm(aim - position)], atol=1e-12)
    distance = np.linalg.norm(joints - position, axis=-1)
    np.testing.assert_allclose(np.linalg.norm(seen, axis=-1), distance)


def test_look_from_has_x_right_and_y_down():
    world = np.array([[[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]])
    seen = cameras.look_from(world, np.array([0.0, 0, 5]), np.zeros(3))
    np.testing.assert_allclose(seen, [[[1, 0, 5], [0, -1, 5], [0, 0, 4]]], atol=1e-12)


# A body whose every link is as long as it is easy to check by hand.
BODY = (
    ("root", "base", (0, 0, 0)),
    ("chest", "root", (0, 1, 0)),
    ("neck", "chest", (0, 1, 0)),
    *(
        (f"{side}_{joint}", parent.format(side), (0, up, z if joint in ("hip", "shoulder") else 0))
        for side, z in (("right", 0.5), ("left", -0.5))
        for joint, parent, up in (
            ("hip", "root", 0),
            ("knee", "{}_hip", -2),
            ("ankle", "{}_knee", -2),
            ("shoulder", "chest", 0.9),
            ("elbow", "{}_shoulder", -1),
            ("wrist", "{}_elbow", -1),
        )
    ),
)


def frame(**channels: tuple[float, ...]) -> np.ndarray:
    """One motion frame [1,44] at rest at height 4 but for the given channels."""
    values = [0.03, 0.0, 4.0, 0.0]
    for name, width in make_samples.CHANNELS.items():
        values += channels.get(name, (1.0, 0.0, 0.0, 0.0) if width == 4 else (0.0,))
    return np.array([values])


def test_forward_kinematics_by_hand():
    links = [make_samples.Link(name, parent, np.array(offset)) for name, parent, offset in BODY]
    half = np.sqrt(0.5)
    moved = frame(
        right_knee=(-np.pi / 2,),
        left_elbow=(np.pi / 2,),
        chest=(half, half, 0.0, 0.0),  # 90 degrees about x: y goes to z
    )
    joints = make_samples.pose_model(moved, links, np.array([0.0, 0.25, 0.0]))[0]
    expected = {
        "neck_base": (0, 5, 1),
        "head": (0, 5, 1.25),
        "right_hip": (0, 4, 0.5),
        "right_knee": (0, 2, 0.5),
        "right_ankle": (-2, 2, 0.5),
        "left_ankle": (0, 0, -0.5),
        "right_shoulder": (0, 4.5, 0.9),
        "right_wrist": (0, 4.5, -1.1),
        "left_shoulder": (0, 5.5, 0.9),
        "left_elbow": (0, 5.5, -0.1),
        "left_wrist": (1, 5.5, -0.1),
    }
    for name, place in expected.items():
        np.testing.assert_allclose(joints[INDEX[name]], place, atol=1e-12, err_msg=name)


def test_the_tpose_file_is_what_the_tool_writes(tmp_path: Path):
    joints = np.array([[make_samples.T_POSE[joint] for joint in JOINTS]])
    make_samples.write_clip(tmp_path, "tpose", joints)
    for name in ("tpose.csv", "tpose_truth.csv"):
        assert (tmp_path / name).read_bytes() == (DATA / name).read_bytes()
