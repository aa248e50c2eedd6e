"""Real detections, lifted and compared with what else is known of them, and the tools for that."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from support import ROOT

from data.detections import CAMERAS, DATA, SIZES
from data.triangulate import Camera, read_cameras, triangulate
from edmlift import read_poses
from edmlift.keypoints import DETECTOR_THRESHOLD
from edmlift.library import Library
from edmlift.metrics import rigid_errors
from evaluation import detections
from reports import markdown

PROGRAM = Path(
    os.environ.get("EDMLIFT_LIFT_STDIN", ROOT / "build" / "dev" / "examples" / "lift_stdin")
)
DOCUMENT = ROOT / "docs" / "detections.md"
SHOULDERS, HIPS = [2, 5], [8, 11]


@pytest.fixture(scope="module")
def beam(library: Library) -> dict[str, detections.Clip]:
    return detections.read_beam(library)[0]


@pytest.fixture(scope="module")
def street(library: Library) -> detections.Clip:
    return detections.read_street(library)


# ---- The detections, lifted ------------------------------------------------------------------

# Measured at most 75.1 and 147.7 mm, and 91.7 against BlazePose's 3D; a tenth is left for other
# weights.  Where the detector swaps left and right there is nothing to hold the lift to.
MEAN, WORST, APART = 0.102, 0.151, 0.105  # metres


def put_right(clip: detections.Clip) -> np.ndarray:
    return detections.put_right(clip.keypoints, clip.swapped)


@pytest.mark.parametrize("name", detections.BEAM)
@pytest.mark.parametrize("fixed", [False, True])
def test_the_beam_is_near_its_reference(beam, name: str, fixed: bool):
    library = Library("distances_w16" if fixed else "distances_f32", fixed=fixed)
    clip = beam[name]
    poses = library.lift(put_right(clip))
    assert (poses.status == "ok").all()
    error = rigid_errors(poses.joints.astype(float), clip.truth).mean(1)
    assert error.mean() < MEAN and error.max() < WORST


@pytest.mark.parametrize("name", [*detections.BEAM, "street"])
def test_the_lift_is_near_the_detectors_own_3d(library, beam, street, name: str):
    clip = (beam | {"street": street})[name]
    poses = library.lift(clip.keypoints)
    fine = poses.status == "ok"
    apart = rigid_errors(poses.joints[fine].astype(float), clip.world[fine])
    assert apart.mean() < APART


def test_left_is_left(library, beam):
    for clip in beam.values():
        joints = library.lift(put_right(clip)).joints
        for right, left in (SHOULDERS, HIPS):
            lifted, true = (np.sign(p[:, left, 0] - p[:, right, 0]) for p in (joints, clip.truth))
            np.testing.assert_array_equal(lifted, true)


def test_the_mirror_image_is_the_right_one(library, beam):
    keypoints = np.concatenate([put_right(clip) for clip in beam.values()])
    truth = np.concatenate([clip.truth for clip in beam.values()])
    joints = library.lift(keypoints).joints.astype(float)
    chosen, other = (rigid_errors(p, truth).mean(1) for p in (joints, joints * [1, 1, -1]))
    wrong = chosen > other
    assert wrong.mean() <= 0.05
    assert (chosen - other)[wrong].max(initial=0) < 0.015  # there either is as bad


def test_a_known_camera_puts_the_man_where_he_is(library, beam):
    for clip in beam.values():
        keypoints = put_right(clip)
        joints = library.lift(keypoints).joints
        placed = library.place(joints, keypoints, clip.camera)
        assert (placed.status == "ok").all()
        off = np.abs(placed.translation[:, 2] / detections.mid_hip(clip.truth)[:, 2] - 1)
        assert off.mean() < 0.09  # measured 4 to 7 %


def test_the_frame_without_a_person_is_refused(library, street):
    status = library.lift(street.keypoints).status
    assert status[0] == "too_few_joints"
    assert (status[1:] == "ok").all()


def test_the_detector_swaps_left_and_right(beam):
    assert {name: np.flatnonzero(clip.swapped).tolist() for name, clip in beam.items()} == {
        "beam1": [],
        "beam2": [9, 10, 11, 12, 13, 14],
        "beam3": [],
        "beam4": [],
    }


@pytest.mark.skipif(
    "EDMLIFT_LIFT_STDIN" not in os.environ and not PROGRAM.exists(), reason="no lift_stdin"
)
@pytest.mark.parametrize("name", [*detections.BEAM, "street"])
def test_lift_stdin_takes_them_as_the_detector_gives_them(
    library, beam, street, tmp_path: Path, name: str
):
    clip = (beam | {"street": street})[name]
    views = dict(zip(detections.BEAM, read_cameras(CAMERAS), strict=True))
    width, height = views[name].size if name in views else SIZES[name]
    out = tmp_path / "lifted.csv"
    with (DATA / f"{name}.csv").open() as source, out.open("w") as target:
        image = f"{width},{height}"
        command = [PROGRAM, "--format", "blazepose33", "--image", image, "--threshold", "0"]
        subprocess.run(command, stdin=source, stdout=target, check=True)
    found = read_poses(out)
    poses = library.lift(clip.keypoints)
    np.testing.assert_array_equal(found.status, poses.status)
    raw = np.loadtxt(DATA / f"{name}.csv", delimiter=",").reshape(len(found.joints), -1, 3)
    at = raw[..., :2]  # of the image; what is outside does not count for lift_stdin
    inside = ((at >= 0) & (at <= 1)).all((1, 2)) | (found.status != "ok")
    assert inside.sum() >= 0.5 * len(inside)
    joints = (found.joints[inside], poses.joints[inside])
    np.testing.assert_allclose(*joints, atol=1e-3)  # pixels rounded twice


@pytest.mark.claims("docs/detections.md", "detections")
def test_the_table_is_the_documents(library, beam, street):
    figures = {n: detections.measure(library, c) for n, c in (beam | {"street": street}).items()}
    assert markdown.read(DOCUMENT, "detections") == detections.report(figures)


@pytest.mark.claims("docs/detections.md", "thresholds")
def test_the_table_of_thresholds_is_the_documents_and_the_default_costs_nothing(library):
    columns = detections.compare_thresholds(library)
    assert markdown.read(DOCUMENT, "thresholds") == detections.report_detectors(columns)
    default = columns[f"{DETECTOR_THRESHOLD:g}"]
    for row, figure in columns["0"].items():
        assert default[row] < figure + 1, row


def test_the_summarys_figures(library, beam):
    clips = beam.values()
    keypoints = np.concatenate([put_right(clip) for clip in clips])
    world = np.concatenate([detections.put_right(c.world, c.swapped) for c in clips])
    truth = np.concatenate([clip.truth for clip in clips])
    lifted = library.lift(keypoints).joints.astype(float)
    own, other = (detections.millimetres(rigid_errors(p, truth)) for p in (lifted, world))
    text = (
        f"the lift is {own:.0f} mm from what four cameras triangulate; "
        f"BlazePose's own 3D is {other:.0f} mm"
    )
    assert text in " ".join((ROOT / "docs" / "accuracy.md").read_text().split())


# ---- The reference ---------------------------------------------------------------------------


def test_the_reference_is_near_the_detections(library):
    errors = detections.read_beam(library)[1]
    assert errors.shape == (4, 20, 12)
    assert np.median(errors) < 13  # pixels, 25 mm; measured 12.5


def test_the_mans_bones_keep_their_length(beam):
    truth = beam["beam1"].truth
    for start, end in [(2, 3), (5, 6), (8, 9), (9, 10), (11, 12), (12, 13)]:
        length = np.linalg.norm(truth[:, start] - truth[:, end], axis=-1)
        assert length.std() < 0.02  # metres; measured up to 0.017


def test_the_views_show_one_man(beam):
    for name in detections.BEAM[1:]:
        # The cameras' rotations have six decimals.
        assert rigid_errors(beam[name].truth, beam["beam1"].truth).max() < 2e-6


def look_at_centre(angle: float) -> Camera:
    """A camera with a bad lens, 4 m from the origin."""
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.array([[c, s, 0], [0, 0, -1], [-s, c, 0]])
    lens = np.array([-0.05, 0.1, 0.001, -0.0005])
    return Camera((1000, 1000), np.array([900, 910]), np.array([480, 510]), lens, rotation,
                  -4 * rotation[2])  # fmt: skip


def image(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Pixels of world points, through the lens (Brown's model)."""
    k1, k2, p1, p2 = camera.distortion
    seen = camera.look(points)
    x, y = np.moveaxis(seen[..., :2] / seen[..., 2:], -1, 0)
    r = x * x + y * y
    radial = 1 + k1 * r + k2 * r * r
    bent = [
        x * radial + 2 * p1 * x * y + p2 * (r + 2 * x * x),
        y * radial + p1 * (r + 2 * y * y) + 2 * p2 * x * y,
    ]
    return np.stack(bent, -1) * camera.focal + camera.centre


def test_points_are_triangulated_and_swapped_views_found():
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.8, 0.8, (5, 6, 3))
    swapped = np.array([1, 0, 3, 2, 5, 4])
    views = [look_at_centre(angle) for angle in (0, 1.4, 2.9, 4.5)]
    pixels = np.stack([image(view, points) for view in views])
    pixels[2, 1] = pixels[2, 1, swapped]
    pixels[0, 4] = pixels[0, 4, swapped]
    found, exchanged, errors = triangulate(views, pixels, np.ones(pixels.shape[:3]), swapped)
    np.testing.assert_allclose(found, points, atol=1e-6)
    assert sorted(map(tuple, np.argwhere(exchanged))) == [(0, 4), (2, 1)]
    assert errors.shape == (4, 5, 6) and errors.max() < 1e-3


# ---- The files -------------------------------------------------------------------------------


def test_files_say_what_they_are():
    for name in (*detections.BEAM, "street"):
        for file in (name, f"{name}_world"):
            lines = (DATA / f"{file}.csv").read_text().splitlines()
            comments = [line for line in lines if line.startswith("#")]
            assert lines[: len(comments)] == comments
            assert "BSD-3-Clause" in comments[-1] and "Apache-2.0" in comments[-2]
            assert {line.count(",") for line in lines[len(comments) :]} == {98}


def test_the_picture_is_drawn(library, beam, tmp_path: Path):
    detections.picture(library, beam, tmp_path / "sheet.png")
    drawn = (tmp_path / "sheet.png").read_bytes()
    assert drawn.startswith(b"\x89PNG") and 50_000 < len(drawn) < 250_000
