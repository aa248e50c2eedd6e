"""The evaluation of a video's path, focal length and bones."""

from pathlib import Path

import numpy as np
import pytest
from support import OTHERS_TEST, ROOT, TEST, need_library, need_motion

from data import cameras
from data.mocap import load_motion
from edmlift.joints import mid_hip
from edmlift.lifting import Poses
from evaluation import room, video
from evaluation.command import by_set
from reports import markdown

WHERE, BODY = (ROOT / "docs" / page for page in ("where-in-the-room.md", "body.md"))


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


@pytest.fixture
def clip() -> video.Clip:
    """Somebody who goes 1 m/s to the right, 4 m away."""
    rng = np.random.default_rng(3)
    joints = np.repeat(rng.normal(0, 0.4, (1, 14, 3)), 60, 0) + [0, 0, 4]
    joints -= mid_hip(joints)[:, None] - [0, 0, 4]
    joints[..., 0] += np.arange(60)[:, None] / 30
    return video.Clip(joints, np.arange(60) * 1000 // 30, 1)


def test_figures_of_a_path(clip):
    truth = mid_hip(clip.truth)
    far = room.path_figures(truth * 1.05, clip, "far")
    assert far["root, mm: far"] == pytest.approx(50 * np.linalg.norm(truth, axis=1).mean())
    assert far["of that across the line of sight, mm: far"] == pytest.approx(0, abs=1e-9)
    assert far["second difference, mm: far"] == pytest.approx(0, abs=1e-6)
    jumps = truth + [[0, 0.01 * (-1) ** f, 0] for f in range(60)]
    up = room.path_figures(jumps, clip, "up")
    assert up["of that across the line of sight, mm: up"] == pytest.approx(10, rel=0.01)
    assert up["second difference, mm: up"] == pytest.approx(40)


def test_another_lens_zooms_about_the_middle(clip):
    keypoints = cameras.keypoints(cameras.project(clip.truth))
    same = room.through(keypoints, cameras.FOCAL / room.IMAGE[1])
    np.testing.assert_allclose(same, keypoints, rtol=1e-6)
    zoomed = room.through(keypoints, 2 * cameras.FOCAL / room.IMAGE[1])
    np.testing.assert_allclose(zoomed[..., :2] - 500, 2 * (keypoints[..., :2] - 500), rtol=1e-6)


def test_figures_of_bones(clip):
    poses = Poses.of(clip.truth * np.where(np.arange(60) % 2, 1.02, 0.98)[:, None, None])
    figures = room.bone_figures(poses, clip, "x")
    true = room.bone_lengths(clip.truth)[:, room.LIMBS].mean()
    assert figures["standard deviation of limbs, mm: x"] == pytest.approx(20 * true, rel=1e-3)
    assert figures["error of limbs' lengths, mm: x"] == pytest.approx(20 * true, rel=1e-3)
    assert len(room.LIMBS) == 8


def test_rows_that_begin_alike_stand_together():
    text = room.report({"gt": {"a: x": 1.0, "b: x": 2.0, "a: y": 3.0}})
    assert [line.split("|")[1].strip() for line in text.splitlines()[2:]] == [
        "a: x",
        "a: y",
        "b: x",
    ]


@pytest.mark.long
@pytest.mark.claims("docs/where-in-the-room.md", "path", "focal")
@pytest.mark.claims("docs/body.md", "held_bones")
def test_the_tables_are_those_of_the_pages():
    names = (TEST, OTHERS_TEST)
    clips = {Path(n).stem: room.watch(load_motion(need_motion(n))) for n in names}
    figures = {
        "path": {name: room.paths(c) for name, c in clips.items()},
        "focal": {name: room.focal_lengths(c) for name, c in clips.items()},
        "held_bones": {name: room.bones(c) for name, c in clips.items()},
    }
    for mark, found in figures.items():
        page = markdown.read(BODY if mark == "held_bones" else WHERE, mark)
        assert page.strip() == by_set(room.report, found).strip()
    for found in figures["held_bones"].values():
        for column in found.values():
            assert column["standard deviation of limbs, mm: held"] < 5
            assert column["error, mm: held"] < 1.02 * column["error, mm: as lifted"]
    for found in figures["path"].values():
        for column in found.values():
            shaken, filtered = (
                column[f"second difference, mm: {w}"] for w in ("alone", "filtered")
            )
            assert filtered < 0.7 * shaken
    for found in figures["focal"].values():
        for column in found.values():
            assert column["of 1 pose"] < column["the best of each"]
