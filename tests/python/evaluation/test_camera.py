"""Poses placed before a camera: the binding, OpenCV's solvePnP beside it, and the evaluation."""

from pathlib import Path

import cv2
import numpy as np
import pytest
import scipy.io
from support import OTHERS_TEST, ROOT, TEST, need_motion

from data import cameras
from data.mocap import load_motion
from edmlift.joints import mid_hip
from edmlift.library import Library
from evaluation import camera, cli, off_axis, reproject
from evaluation.command import by_set
from reports import markdown

WALK = np.loadtxt(ROOT / "examples" / "data" / "walk.csv", delimiter=",").reshape(-1, 14, 3)
CAMERA = (1145.0, 1145.0, 500.0, 500.0)
SIZE = (1000.0, 1000.0)
MATRIX = np.array([[1145.0, 0, 500], [0, 1145, 500], [0, 0, 1]])


def rotations(count: int, rng: np.random.Generator) -> np.ndarray:
    """Random rotations [F,3,3]."""
    q, r = np.linalg.qr(rng.normal(size=(count, 3, 3)))
    q *= np.sign(np.diagonal(r, axis1=1, axis2=2))[:, None]
    return q * np.sign(np.linalg.det(q))[:, None, None]


@pytest.fixture
def scenes(library: Library) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """People 3 to 6 m away [F,14,3], their poses in any axes, and the rotations back [F,3,3]."""
    rng = np.random.default_rng(5)
    people = np.repeat(library.lift(WALK).joints.astype(float), 8, axis=0)
    people = np.einsum("fij,fnj->fni", rotations(len(people), rng), people)
    root = rng.uniform([-1, -0.5, 3], [1, 0.5, 6], (len(people), 3))
    back = rotations(len(people), rng)
    poses = np.einsum("fji,fnj->fni", back, people - mid_hip(people)[:, None])
    truth = people - mid_hip(people)[:, None] + root[:, None]
    return truth, poses.astype(np.float32), back


def project(truth: np.ndarray) -> np.ndarray:
    return 1145 * truth[..., :2] / truth[..., 2:] + 500


# ---- The binding -----------------------------------------------------------------------------


def test_exact_poses_are_found_again(library, scenes):
    truth, poses, back = scenes
    placed = library.place(poses, cameras.keypoints(project(truth)), CAMERA)
    assert (placed.status == "ok").all()
    assert placed.joints.shape == truth.shape and placed.rotation.shape == back.shape
    np.testing.assert_allclose(placed.joints, truth, atol=1e-4)
    np.testing.assert_allclose(placed.rotation, back, atol=1e-4)
    np.testing.assert_allclose(placed.translation, mid_hip(truth), atol=1e-4)
    assert placed.reprojection.max() < 1e-3
    assert (placed.focal == 1145).all() and placed.steps.max() <= 53


def test_a_focal_length_of_the_sweep_is_found(library, scenes):
    truth, poses, _ = scenes
    focal = 500 * 8 ** (3 / 11)
    points = focal * truth[..., :2] / truth[..., 2:] + 500
    placed = library.place_sweep(poses, cameras.keypoints(points), SIZE)
    np.testing.assert_allclose(placed.focal, focal, rtol=1e-4)
    np.testing.assert_allclose(placed.joints, truth, rtol=1e-3, atol=1e-3)


def test_each_image_may_have_a_size_of_its_own(library, scenes):
    truth, poses, _ = scenes
    focal = 500 * 8 ** (3 / 11)
    sizes = np.array([[1000.0, 1000.0], [600.0, 1000.0]])
    points = focal * truth[:2, :, :2] / truth[:2, :, 2:] + sizes[:, None] / 2
    placed = library.place_sweep(poses[:2], cameras.keypoints(points), sizes)
    np.testing.assert_allclose(placed.joints, truth[:2], rtol=1e-3, atol=1e-3)


def test_statuses_and_nan_where_there_is_no_place(library, scenes):
    truth, poses, _ = scenes
    keypoints = cameras.keypoints(project(truth))[:4]
    keypoints[1, 7:, 2] = 0
    keypoints[2, :8, 2] = 0
    keypoints[3, 2, 0] = np.nan
    placed = library.place(poses[:4], keypoints, CAMERA)
    assert list(placed.status) == ["ok", "ok", "too_few_joints", "not_finite"]
    for field in (placed.joints, placed.rotation, placed.translation, placed.reprojection):
        assert np.isfinite(field[:2]).all() and np.isnan(field[2:]).all()
    assert np.isnan(placed.focal[2:]).all()


def test_no_poses_and_wrong_shapes(library, scenes):
    none = np.zeros((0, 14, 3))
    assert library.place(none, none, CAMERA).joints.shape == (0, 14, 3)
    assert library.place_sweep(none, none, SIZE).status.shape == (0,)
    with pytest.raises(ValueError, match="keypoints must be"):
        library.place(np.zeros((2, 14, 3)), np.zeros((3, 14, 3)), CAMERA)


# ---- OpenCV ----------------------------------------------------------------------------------


def solve_pnp(pose: np.ndarray, points: np.ndarray, guess: tuple | None) -> float:
    """RMS reprojection error of solvePnP's own start, or of one; infinity where it fails."""
    pose, points = pose.astype(float), points.astype(float)
    start = () if guess is None else (cv2.Rodrigues(guess[0])[0], guess[1].reshape(3, 1), True)
    try:
        found, rotation, shift = cv2.solvePnP(pose, points, MATRIX, None, *start)
    except cv2.error:
        return np.inf
    at = pose @ cv2.Rodrigues(rotation)[0].T + shift.T
    if not found or (at[:, 2] <= 0).any():
        return np.inf
    return np.sqrt((np.linalg.norm(project(at) - points, axis=1) ** 2).mean())


@pytest.mark.parametrize("noise", [0.0, 2.0, 10.0, 20.0])
@pytest.mark.parametrize("hidden", [0, 4])
def test_no_worse_than_opencv(library, scenes, noise: float, hidden: int):
    truth, poses, _ = scenes
    rng = np.random.default_rng(6)
    points = cameras.gaussian_noise(project(truth), noise, rng).astype(np.float32)
    seen = cameras.hide_random(len(points), hidden, rng)
    placed = library.place(poses, cameras.keypoints(points, seen), CAMERA)
    assert (placed.status == "ok").all()
    better = []
    for i, mask in enumerate(seen):
        guess = placed.rotation[i].astype(float), placed.translation[i].astype(float)
        theirs = [solve_pnp(poses[i][mask], points[i][mask], g) for g in (None, guess)]
        better.append(placed.reprojection[i] - 1.01 * min(theirs) < 1e-3)
    # With 20 pixels and few joints, an image may fit two places in front of the camera.
    assert np.mean(better) == 1 if noise < 20 else np.mean(better) > 0.99


def test_lifted_poses_are_placed_no_worse_than_by_opencv(library):
    lifted = library.lift(WALK)
    placed = library.place(lifted.joints, WALK, CAMERA)
    assert (placed.status == "ok").all()
    for i, pose in enumerate(lifted.joints):
        guess = placed.rotation[i].astype(float), placed.translation[i].astype(float)
        theirs = [solve_pnp(pose, WALK[i, :, :2], g) for g in (None, guess)]
        assert placed.reprojection[i] < 1.01 * min(theirs)


# ---- The evaluation --------------------------------------------------------------------------


def test_angles_and_rotations():
    rng = np.random.default_rng(7)
    rotation, points = rotations(5, rng), rng.normal(size=(5, 14, 3))
    moved = np.einsum("fij,fnj->fni", rotation, points) + 3
    np.testing.assert_allclose(camera.rotation_between(points, moved), rotation, atol=1e-12)
    quarter = np.array([[[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]])
    np.testing.assert_allclose(camera.angle_between(quarter, np.eye(3)[None]), 90)


@pytest.mark.slow
@pytest.mark.claims("docs/where-in-the-room.md", "camera")
def test_the_tables_are_those_of_the_page(library):
    figures = camera.evaluate(library, load_motion(need_motion(TEST)))
    table = camera.report(figures)
    assert markdown.read(ROOT / "docs" / "where-in-the-room.md", "camera").strip() == table.strip()
    assert figures["true pose, gt"]["root"] < 0.1  # cm
    assert figures["true pose, gt"]["rotation"] < 0.01


def test_people_are_turned_about_the_camera(scenes):
    truth = scenes[0]
    ahead = np.full((1, 14, 3), (0.0, 0.0, 4.0))
    right, down = (off_axis.turned(ahead, 30, np.array([a]))[0, 0] for a in (0, np.pi / 2))
    np.testing.assert_allclose(right, (2, 0, 2 * np.sqrt(3)), atol=1e-12)
    np.testing.assert_allclose(
        down, (0, 4 * np.sin(np.pi / 10), 4 * np.cos(np.pi / 10)), atol=1e-12
    )
    moved = off_axis.turned(truth, 20, np.linspace(0, 6, len(truth)))
    np.testing.assert_allclose(np.linalg.norm(moved, axis=-1), np.linalg.norm(truth, axis=-1))


@pytest.mark.claims("docs/where-in-the-room.md", "off_axis")
def test_the_camera_helps_off_the_axis():
    people = {
        Path(name).stem: off_axis.evaluate(["direct_f32"], load_motion(need_motion(name)))
        for name in (TEST, OTHERS_TEST)
    }
    table = by_set(off_axis.report, people)
    page = markdown.read(ROOT / "docs" / "where-in-the-room.md", "off_axis")
    assert page.strip() == table.strip()
    for errors in people.values():
        known, unknown = errors["direct_f32, camera known"], errors["direct_f32"]
        np.testing.assert_allclose(known, known[0], atol=0.1)  # mm
        assert known[0] < unknown[0] + 2 and (np.array(known[1:]) < unknown[1:]).all()


# ---- Annotated images ------------------------------------------------------------------------


@pytest.fixture
def lsp(tmp_path: Path) -> Path:
    """The walk as LSP would annotate it: 3 x 14 x F, joints in its order, occluded in row 3."""
    order = "r ankle,r knee,r hip,l hip,l knee,l ankle,r wrist,r elbow,r shoulder"
    order += ",l shoulder,l elbow,l wrist,neck,head top"
    ours = "head top,neck,r shoulder,r elbow,r wrist,l shoulder,l elbow,l wrist"
    ours = (ours + ",r hip,r knee,r ankle,l hip,l knee,l ankle").split(",")
    joints = np.zeros((3, 14, len(WALK)))
    for row, name in enumerate(order.split(",")):
        joints[:2, row] = WALK[:, ours.index(name), :2].T
    joints[2, 3] = 1
    scipy.io.savemat(tmp_path / "joints.mat", {"joints": joints})
    return tmp_path / "joints.mat"


def test_lsp_joints_are_ours_in_another_order(lsp):
    keypoints = reproject.read_keypoints(lsp)
    np.testing.assert_allclose(keypoints[..., :2], WALK[..., :2])
    assert (keypoints[..., 2] == 1).all()


def test_lsp_extended_is_the_other_way_round(tmp_path, lsp):
    joints = scipy.io.loadmat(lsp)["joints"].transpose(1, 0, 2).copy()
    joints[6, :, 0] = 0  # not visible, not annotated: the right wrist of the first
    scipy.io.savemat(tmp_path / "extended.mat", {"joints": joints})
    keypoints = reproject.read_keypoints(tmp_path / "extended.mat")
    assert (keypoints[0, 4] == 0).all() and (keypoints[1:, :, 2] == 1).all()
    np.testing.assert_allclose(keypoints[1:, :, :2], WALK[1:, :, :2])


def test_errors_are_told_by_part():
    annotated = np.concatenate([np.zeros((2, 14, 2)), np.ones((2, 14, 1))], -1)
    points = np.zeros((2, 14, 2))
    points[:, [10, 13]] = (3, 4)  # feet
    points[0, 1] = (0, 2)  # neck
    annotated[1, 1, 2] = 0
    errors = reproject.errors(points, annotated)
    assert errors["feet"] == 5 and errors["neck"] == 2 and errors["hands"] == 0
    assert errors["mean"] == pytest.approx((4 * 5 + 2) / 27)


def test_the_table_of_annotations_and_detections(library, lsp, tmp_path, capsys):
    detected = WALK.copy()
    detected[..., 0] += 3
    np.savetxt(tmp_path / "detected.csv", detected.reshape(-1, 42), delimiter=",")
    arguments = ["reproject", str(lsp), "--detections", str(tmp_path / "detected.csv")]
    assert cli.main(arguments) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = [line.strip("|").split("|") for line in lines[2:]]
    assert [row[0].strip() for row in rows] == [
        "lifted from annotated", "detections", "lifted from detected",
    ]  # fmt: skip
    annotated, detections, moved = (np.array(row[1:], float) for row in rows)
    np.testing.assert_allclose(detections, 3, atol=0.01)
    assert 0 < annotated[-1] < 20  # pixels; the person is about 360 tall
    assert annotated[-1] < moved[-1] < annotated[-1] + 3


@pytest.mark.parametrize(
    ("contents", "message"),
    [({"points": 1}, "no variable"), ({"joints": np.zeros((3, 16, 2))}, r"not \(3, 14, N\)")],
)
def test_other_files_are_refused(tmp_path, contents, message):
    scipy.io.savemat(tmp_path / "other.mat", contents)
    with pytest.raises(ValueError, match=message):
        reproject.read_keypoints(tmp_path / "other.mat")


def test_lines_of_another_length_are_refused(tmp_path):
    (tmp_path / "other.csv").write_text("1,2,3\n")
    with pytest.raises(ValueError, match="3 numbers"):
        reproject.read_keypoints(tmp_path / "other.csv")
    assert cli.main(["reproject", str(tmp_path / "other.csv")]) == 1
