"""What detectors saw, as files and as the library takes it; and the tool that asks MoveNet."""

import dataclasses
import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from data import crops, detect_movenet, videos
from data import detections as data
from data.triangulate import Camera
from edmlift.joints import MIRROR
from edmlift.library import Library

CLIPS = (*data.BEAM, "street")
MOVENET = (data.THUNDER, data.LIGHTNING)


# ---- Detectors -------------------------------------------------------------------------------


@pytest.mark.parametrize("detector", data.DETECTORS, ids=lambda d: d.name)
def test_counterparts_are_those_of_the_joints(library: Library, detector):
    count = len(detector.counterpart)
    keypoints = np.random.default_rng(0).uniform(0, 500, (3, count, 3))
    keypoints[..., 2] = 0.9
    seen, sure = data.adapt(library, keypoints, detector)
    np.testing.assert_array_equal(seen, sure)
    mirrored, _ = data.adapt(library, keypoints[:, detector.counterpart], detector)
    np.testing.assert_allclose(mirrored, seen[:, MIRROR], rtol=1e-5)
    np.testing.assert_array_equal(detector.counterpart[detector.counterpart], np.arange(count))


def test_limbs_are_the_joints_but_head_and_neck(library: Library):
    for detector in data.DETECTORS:
        keypoints = np.zeros((1, len(detector.counterpart), 3))
        keypoints[:, list(detector.limbs), 2] = 0.9
        joints, _ = data.adapt(library, keypoints, detector)
        assert (joints[0, 2:, 2] > 0).all() and joints[0, 0, 2] == 0
        assert len(detector.limbs) == 12


def test_unsure_keypoints_are_missing(library: Library):
    keypoints = np.full((1, 17, 3), 0.9)
    keypoints[:, 7, 2] = 0.29
    seen, sure = data.adapt(library, keypoints, data.THUNDER)
    assert (seen[..., 2] > 0).all()
    np.testing.assert_array_equal(np.argwhere(sure[..., 2] == 0), [[0, 6]])  # the left elbow


@pytest.mark.parametrize("detector", data.DETECTORS, ids=lambda d: d.name)
def test_points_in_space_are_adapted_as_in_an_image(library: Library, detector):
    points = np.random.default_rng(1).normal(size=(2, len(detector.counterpart), 3))
    joints = data.joints_3d(library, points, detector)
    flat = np.concatenate([points[..., :2], np.ones_like(points[..., :1])], -1)
    np.testing.assert_allclose(joints[..., :2], data.adapt(library, flat, detector)[0][..., :2])


# ---- Clips -----------------------------------------------------------------------------------


def clip(frames: int) -> data.Clip:
    numbers = np.arange(frames * 14 * 3.0).reshape(frames, 14, 3)
    return data.Clip(numbers, numbers, numbers, numbers, np.arange(frames) % 2 == 1, (1.0,))


def test_some_frames_of_a_clip():
    whole = clip(4)
    later = whole.frames(slice(1, None))
    assert later.camera == whole.camera
    for field in dataclasses.fields(data.Clip)[:-1]:
        one, other = (getattr(c, field.name) for c in (later, whole))
        np.testing.assert_array_equal(one, other[1:])


def test_sides_are_put_right_where_they_were_swapped():
    whole = clip(2)
    np.testing.assert_array_equal(whole.right()[0], whole.keypoints[0])
    np.testing.assert_array_equal(whole.right()[1], whole.keypoints[1, MIRROR])


def test_how_far_pixels_are_beside_a_point():
    view = Camera((100, 100), np.array([500.0, 500]), np.array([50.0, 50]), np.zeros(4),
                  np.eye(3), np.zeros(3))  # fmt: skip
    truth = np.array([[0.0, 0, 5], [0.1, 0, 2]])
    pixels = np.array([[51.0, 48], [75, 50]])
    np.testing.assert_allclose(data.beside(view, pixels, truth), [[0.01, -0.02], [0, 0]], atol=1e-9)


# ---- Files -----------------------------------------------------------------------------------


@pytest.mark.parametrize("detector", MOVENET, ids=lambda d: d.name)
@pytest.mark.parametrize("name", CLIPS)
def test_files_say_what_they_are(name: str, detector):
    lines = (data.DATA / f"{name}{detector.ending}.csv").read_text().splitlines()
    comments = [line for line in lines if line.startswith("#")]
    assert lines[: len(comments)] == comments
    assert f"MoveNet{detector.ending.replace('_', ' ')} " in comments[-2]
    assert "BSD-3-Clause" in comments[-1] and "Apache-2.0" in comments[-2]
    assert detect_movenet.models_package() in comments[-2]
    assert {line.count(",") for line in lines[len(comments) :]} == {17 * 3 - 1}


@pytest.mark.parametrize("name", CLIPS)
def test_all_detectors_saw_the_same_frames(name: str):
    size = data.SIZES.get(name, (1080, 1920))
    seen = [data.read(name, size, detector) for detector in data.DETECTORS]
    assert len({len(keypoints) for keypoints in seen}) == 1
    hips = [np.median(k[..., :2][:, list(d.limbs[6:8])], 0) for k, d in
            zip(seen, data.DETECTORS, strict=True)]  # fmt: skip
    if name != "street":  # where there are two people
        assert np.ptp(hips, 0).max() < 50


def test_rows_are_written_as_asked(tmp_path: Path):
    rows = np.array([[[1.26, -0.00000001], [2, 3]], [[4, 5], [6, 7]]])
    videos.write_rows(tmp_path / "rows.csv", ("# two",), rows, ("%.1f", "%.2f"))
    text = (tmp_path / "rows.csv").read_text()
    assert text == "# two\n1.3,0.00,2.0,3.00\n4.0,5.00,6.0,7.00\n"


# ---- The tool --------------------------------------------------------------------------------


class Watcher:
    """In MoveNet's place: always finds the same, and remembers what it was shown."""

    def __init__(self) -> None:
        self.shown: list[crops.Square] = []
        self.found = np.tile([30.0, 20, 0.9], (17, 1))
        self.found[[5, 6], 1] = 15  # shoulders

    def detect(self, image: np.ndarray, square: crops.Square) -> np.ndarray:
        assert image.shape == (48, 64, 3)
        self.shown.append(square)
        return self.found


@pytest.fixture
def video(tmp_path: Path) -> Path:
    """Five black frames."""
    path = tmp_path / "video.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 30, (64, 48))
    for _ in range(5):
        writer.write(np.zeros((48, 64, 3), np.uint8))
    writer.release()
    return path


def test_every_frame_is_cut_out_around_what_was_found_before(video: Path):
    network = Watcher()
    found, size, rate = detect_movenet.detect(network, video)
    assert found.shape == (5, 17, 3) and size == (64, 48) and rate == 30
    assert network.shown == [crops.whole(size)] + [crops.around(network.found, size)] * 4
    assert network.shown[1].side == pytest.approx(2 * 1.9 * 5)


def test_one_frame_in_so_many_is_written(video: Path, tmp_path: Path):
    path = tmp_path / "clip_thunder.csv"
    one = videos.Clip("pose2sim", "video.avi", 2)
    detect_movenet.write_clip(path, "thunder", one, video, Watcher())
    lines = path.read_text().splitlines()
    assert [line[0] for line in lines] == ["#"] * 4 + ["3"] * 3
    assert "pixels of 64 x 48, y down; 15 lines a second" in lines[1]


def test_what_is_installed_is_pinned():
    package = json.loads((detect_movenet.FILES / "package.json").read_text())
    versions = [*package["dependencies"].values(), package["config"]["models"].split("@")[-1]]
    assert all(re.fullmatch(r"\d+\.\d+\.\d+", version) for version in versions)
