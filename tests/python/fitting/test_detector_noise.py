"""How detectors err: measured on errors of known size, and the tables of the page."""

from pathlib import Path

import numpy as np
import pytest
from motions import STANDING
from support import ROOT, run_tool

from data.detections import CAMERAS
from data.triangulate import Camera, read_cameras, triangulate
from edmlift.joints import INDEX, MIRROR
from edmlift.library import Library
from fitting import detector_noise as noise
from fitting.body import JOINT_TYPE
from reports import markdown

PAGE = ROOT / "docs" / "detections.md"
VIEWS, FRAMES, WINDOW = 4, 60, 6


# ---- Noise -----------------------------------------------------------------------------------


def made_up(rng: np.random.Generator, offset: float, slow: float, fast: float) -> np.ndarray:
    """Errors [4,60,14,2] whose parts have these sigmas."""
    of_joints = rng.normal(size=(VIEWS, 1, 14, 2))
    of_windows = rng.normal(size=(VIEWS, FRAMES // WINDOW, 14, 2)).repeat(WINDOW, 1)
    of_frames = rng.normal(size=(VIEWS, FRAMES, 14, 2))
    return offset * of_joints + slow * of_windows + fast * of_frames


@pytest.mark.parametrize("sigmas", [(3.0, 0, 0), (0, 3.0, 0), (0, 0, 3.0), (1.0, 2.0, 3.0)])
def test_the_parts_are_found(sigmas):
    parts = noise.split(made_up(np.random.default_rng(0), *sigmas), WINDOW)
    for part, sigma in zip(noise.PARTS, sigmas, strict=False):
        found = np.sqrt((parts[part] ** 2).mean())
        # Means of a few are not free of what is drawn anew.
        assert abs(found - sigma) < 0.15 * max(sigmas) + 0.5 * (sigma == 0) * max(sigmas)
    assert parts["shift"] < 0.5 * max(sigmas)


def test_the_squares_add_up():
    parts = noise.split(made_up(np.random.default_rng(1), 1, 2, 3), 7)
    total = sum(parts[part] ** 2 for part in ("offset", "slow", "fast"))
    np.testing.assert_allclose(total, parts["all"] ** 2)


def test_a_shift_of_a_view_is_no_noise():
    error = made_up(np.random.default_rng(2), 1, 2, 3)
    parts = noise.split(error, WINDOW)
    error[2] += [50, 20]
    shifted = noise.split(error, WINDOW)
    for part in noise.PARTS:
        np.testing.assert_allclose(shifted[part], parts[part])
    assert shifted["shift"][0] == pytest.approx(np.sqrt((50**2 + 20**2) / 8), abs=0.5)


def test_mistakes_do_not_move_what_is_usual():
    error = made_up(np.random.default_rng(3), 0, 0, 1)
    parts = noise.noise(error)
    np.testing.assert_allclose(parts["usual"], 1, atol=0.15)
    np.testing.assert_allclose(parts["all"], 1, atol=0.15)
    error[:, ::20, INDEX["left_wrist"]] += 30
    wrist = JOINT_TYPE.index("wrist")
    worse = noise.noise(error)
    assert worse["usual"][wrist] < 1.2 and worse["all"][wrist] > 4


def around(angle: float) -> Camera:
    """A camera 4 m from the origin, without distortion."""
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, s, 0], [0, 0, -1], [-s, c, 0]])
    return Camera((1000, 1000), np.array([1000.0, 1000]), np.array([500.0, 500]), np.zeros(4),
                  rotation, -4 * rotation[2])  # fmt: skip


def test_errors_are_as_large_as_before_they_were_triangulated():
    rng = np.random.default_rng(4)
    views = [around(angle) for angle in (0.2, 1.5, 3.4, 4.9)]
    points = rng.uniform(-0.5, 0.5, (200, 14, 3))
    seen = np.stack([view.look(points) for view in views])
    drawn = rng.normal(0, 3, (4, 200, 14, 2))
    pixels = 1000 * seen[..., :2] / seen[..., 2:] + 500 + drawn
    found, _, _ = triangulate(views, pixels, np.ones(pixels.shape[:3]), np.arange(14))
    back = np.stack([view.look(found) for view in views])
    left = pixels - (1000 * back[..., :2] / back[..., 2:] + 500)
    assert left.std() < 2.5
    assert left.std() * noise.unfitted(4) == pytest.approx(3, rel=0.05)


# ---- What a joint is ---------------------------------------------------------------------------


@pytest.fixture
def standing() -> np.ndarray:
    return np.repeat(np.asarray(STANDING, float)[None], 3, 0)


def test_the_trunks_axes_are_a_persons(standing):
    axes = noise.trunk_axes(standing)
    np.testing.assert_allclose(axes @ axes.swapaxes(1, 2), np.tile(np.eye(3), (3, 1, 1)), atol=1e-9)
    np.testing.assert_allclose(axes[0, 2], [0, 0, 1], atol=1e-9)  # forward, as the person is drawn
    across = standing[:, INDEX["right_hip"]] - standing[:, INDEX["left_hip"]]
    assert (np.einsum("fi,fi->f", axes[:, 0], across) > 0).all()


def test_other_definitions_of_joints_are_found(standing):
    right, up, forward = noise.trunk_axes(standing)[0]
    others = standing.copy()
    for side, sign in (("right", 1), ("left", -1)):
        others[:, INDEX[f"{side}_hip"]] += 0.02 * sign * right + 0.03 * up
        others[:, INDEX[f"{side}_knee"]] += 0.04 * forward
    others[:, INDEX["head"]] += 0.05 * up
    apart = noise.redefined(others, standing)
    expected = np.zeros((8, 3))
    expected[JOINT_TYPE.index("hip"), :2] = 0.02, 0.03
    expected[JOINT_TYPE.index("knee"), 2] = 0.04
    expected[JOINT_TYPE.index("head"), 1] = 0.05
    np.testing.assert_allclose(apart, expected, atol=1e-9)
    mirrored = [p[:, MIRROR] * [-1, 1, 1] for p in (others, standing)]
    np.testing.assert_allclose(noise.redefined(*mirrored), expected, atol=1e-9)


# ---- Tables ----------------------------------------------------------------------------------


def test_tables_are_of_what_was_found():
    rng = np.random.default_rng(5)
    found = {"MoveNet thunder": noise.noise(made_up(rng, 0.01, 0.01, 0.01))}
    head, rule, *rows = noise.report_noise(found).splitlines()
    assert head == "| mm | thunder: offset | slow | fast | all |"
    assert [row.split(" | ")[0].strip("| ") for row in rows[:8]] == list(JOINT_TYPE)
    assert float(rows[8].split("|")[5]) == pytest.approx(17.3, abs=1.5)  # all 14 joints
    training = noise.report_training(found).splitlines()
    assert len(training) == 2 + len(JOINT_TYPE)
    shares = np.array([float(row.split("|")[5]) for row in training[2:]])
    np.testing.assert_allclose(shares, 1, atol=0.25)
    lines = noise.report_definitions({"MoveNet thunder": np.full((8, 3), 0.01)}).splitlines()
    assert lines[2] == "| head |  | 10.0 | 10.0 |" and lines[-1] == "| ankle | 10.0 | 10.0 | 10.0 |"


@pytest.mark.claims("docs/detections.md", "noise", "definitions", "noise_for_training")
def test_tables_are_those_of_the_page(library: Library):
    for name, text in noise.measure(library).items():
        assert markdown.read(PAGE, name).strip() == text.strip()


def test_the_cameras_are_to_blame_for_what_all_detectors_have_alike(library: Library):
    """Of all joints of a view, by every detector, the same shift but for a few millimetres."""
    assert len(read_cameras(CAMERAS)) == VIEWS
    shifts = [
        noise.errors(noise.later(library, detector)).mean((1, 2)) for detector in noise.DETECTORS
    ]
    assert np.linalg.norm(np.mean(shifts, 0), axis=-1).mean() > 0.02
    assert np.linalg.norm(np.std(shifts, 0), axis=-1).max() < 0.01


def test_an_error_names_the_file(tmp_path: Path):
    page = tmp_path / "page.md"
    page.write_text("nothing\n")
    done = run_tool("fitting.detector_noise", "--update", page)
    assert done.returncode == 1 and f"detector_noise: {page}: no <!-- begin NAME" in done.stderr
