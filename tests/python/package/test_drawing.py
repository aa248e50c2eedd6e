"""The pictures: what is in them, and what they are not drawn from."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from package_support import DATA, WALK

import edmlift
from edmlift.drawing import draw_joint_diagram, spread
from edmlift.drawing.diagram import joint_positions
from edmlift.drawing.palette import SIDES, WHITE, flat_palette, mix, rgb
from edmlift.drawing.scene import ABOVE, CAMERA, SIDE, View, level, look, scene_of

Image = pytest.importorskip("PIL.Image", reason="no Pillow")
TRUTH = edmlift.read_truth(DATA / "walk_truth.csv")

pytestmark = pytest.mark.filterwarnings("error")


def poses(count: int = 39) -> edmlift.Poses:
    """The walk's truth, as if it had been lifted."""
    return edmlift.Poses.of(TRUTH[:count], WALK[:count])


def colours(path: Path) -> set[tuple[int, int, int]]:
    with Image.open(path) as image:
        return {colour for _, colour in image.convert("RGB").getcolors(1 << 24)}


# ---- Pictures ----------------------------------------------------------------------------------


def test_sheet(tmp_path: Path):
    out = tmp_path / "walk.png"
    edmlift.draw(poses(), out, truth=TRUTH, title="A walk")
    with Image.open(out) as image:
        wide, high = image.size
    assert 1400 <= wide <= 1600 and 0.8 < high / wide < 1.4
    assert {rgb(colour) for colour in SIDES.values()} < colours(out)
    assert out.stat().st_size < 200_000


def test_one_pose_is_a_strip(tmp_path: Path):
    out = tmp_path / "walk.png"
    edmlift.draw(edmlift.Poses.of(TRUTH[5], WALK[5]), out)
    with Image.open(out) as image:
        assert 800 <= image.width <= 1500 and image.height < 0.7 * image.width


@pytest.mark.slow
def test_animation(tmp_path: Path):
    out = tmp_path / "walk.gif"
    edmlift.draw(poses(), out, title="A walk")
    with Image.open(out) as image:
        assert image.n_frames == 2 * 39  # a whole turn
        assert 600 <= image.width <= 1000 and 300 <= image.height <= 600
        assert image.info["duration"] == 50 and image.info["loop"] == 0
        first = np.asarray(image.convert("RGB"), int)
        image.seek(39)  # the same pose, from behind
        later = np.asarray(image.convert("RGB"), int)
    changed = np.flatnonzero((first != later).any((0, 2)))
    assert len(changed) > 50  # the 3D panel
    assert changed.min() > 250 and changed.max() < 0.75 * first.shape[1]  # and nothing else
    assert out.stat().st_size < 1_500_000


@pytest.mark.slow
def test_one_pose_turns_for_a_while(tmp_path: Path):
    out = tmp_path / "one.gif"
    edmlift.draw(poses(1), out, fps=25)
    with Image.open(out) as image:
        assert image.n_frames == 80 and image.info["duration"] == 40


def test_poses_without_an_image(tmp_path: Path):
    edmlift.draw(edmlift.Poses.of(TRUTH), tmp_path / "sheet.png")
    edmlift.draw(poses(), tmp_path / "whole.png")
    with Image.open(tmp_path / "sheet.png") as image, Image.open(tmp_path / "whole.png") as whole:
        assert image.height < whole.height


@pytest.mark.slow
def test_refused_poses_and_missing_joints(tmp_path: Path):
    status = np.array(["ok", "ok", "too_few_joints", "ok"])
    keypoints, joints = WALK[:4].copy(), TRUTH[:4].copy()
    keypoints[1, 3:5] = 0
    keypoints[2], joints[2] = 0, np.nan
    given = edmlift.Poses.of(joints, keypoints, status)
    edmlift.draw(given, tmp_path / "refused.png", frames=range(4))
    edmlift.draw(given, tmp_path / "refused.gif")
    nothing = edmlift.Poses.of(joints * np.nan, keypoints * 0, ["degenerate"] * 4)
    edmlift.draw(nothing, tmp_path / "nothing.png")
    assert not {rgb(SIDES["left"]), rgb(SIDES["right"])} - colours(tmp_path / "refused.png")


@pytest.mark.slow
def test_a_photo_is_behind_the_keypoints(tmp_path: Path):
    photo = np.full((1000, 1000, 3), (40, 200, 90), np.uint8)
    Image.fromarray(photo).save(tmp_path / "photo.png")
    veiled = tuple(int(c + (255 - c) * 0.25) for c in (40, 200, 90))
    for pictures in ([photo], [tmp_path / "photo.png"] * 6):
        edmlift.draw(poses(6), tmp_path / "out.png", pictures=pictures)
        assert any(max(abs(a - b) for a, b in zip(c, veiled, strict=True)) < 3
                   for c in colours(tmp_path / "out.png"))  # fmt: skip
    edmlift.draw(poses(3), tmp_path / "out.gif", pictures=[photo])


def test_the_diagram_of_the_joints(tmp_path: Path):
    out = tmp_path / "joints.png"
    draw_joint_diagram(out)
    assert out.stat().st_size < 60_000
    at = joint_positions()
    right, left = at[[2, 3, 4, 8, 9, 10]], at[[5, 6, 7, 11, 12, 13]]
    assert (right[:, 0] < at[0, 0]).all() and (left[:, 0] > at[0, 0]).all()
    apart = np.diff(np.sort(left[:, 1]))
    assert apart.min() >= 22  # no name over another


# ---- Numbers -----------------------------------------------------------------------------------


def test_views():
    x, y, z = np.eye(3)
    for view, right, up, near in ((CAMERA, x, -y, -z), (SIDE, z, -y, x), (ABOVE, x, z, -y)):
        assert look(right, view)[0] == pytest.approx(1, abs=0.3)
        assert look(up, view)[1] > 0.9
        assert look(near, view)[2] > 0.9
    assert look(x, View("", 360.0)) == pytest.approx(look(x, CAMERA))


def test_a_pitched_cameras_poses_are_level():
    pitch = np.radians(30)
    up = np.array([0, -np.cos(pitch), -np.sin(pitch)])  # in axes of a camera that looks down
    points = np.stack([2 * up, [1.0, 0, 0]])
    assert level(points, 30) == pytest.approx(np.array([[0, -2, 0], [1, 0, 0]]))
    assert (level(points, 0) == points).all()


def test_windows_hold_the_poses_at_one_scale():
    scene = scene_of(poses(), TRUTH.astype(float), 8.5, True, 1.5)
    for view in (CAMERA, SIDE, ABOVE, View("", 45.0)):
        left, right, bottom, top = scene.view_window(view)
        at = look(scene.poses, view)
        assert (left < at[..., 0]).all() and (at[..., 0] < right).all()
        assert (bottom < at[..., 1]).all() and (at[..., 1] < top).all()
        assert scene.panel_size(view, 100) == pytest.approx(
            (100 * (right - left), 100 * (top - bottom))
        )
    assert scene.poses[..., 1].max(1) == pytest.approx(0)  # on the floor


def test_the_truth_of_a_refused_pose_does_not_count():
    status = np.where(np.arange(39) == 3, "degenerate", "ok")
    joints = np.where((status == "ok")[:, None, None], TRUTH, np.nan)
    refused = edmlift.Poses.of(joints, WALK, status)
    far = TRUTH.astype(float)
    far[3] += 9
    window = scene_of(refused, far, 0, True, 1.5).window
    np.testing.assert_allclose(window, scene_of(refused, None, 0, True, 1.5).window, atol=0.05)


def test_colours():
    assert mix("#000000", WHITE, 0.5) == "#808080" and mix("#123456", WHITE, 0) == "#123456"
    palette = np.reshape(flat_palette(), (-1, 3))
    assert len(palette) <= 128 and {rgb(c) for c in SIDES.values()} < set(map(tuple, palette))


@pytest.mark.parametrize(
    ("count", "columns", "frames"),
    [(39, 6, [3, 9, 16, 22, 29, 35]), (3, 6, [0, 1, 2]), (10, 1, [5]), (1, 6, [0])],
)
def test_spread(count: int, columns: int, frames: list[int]):
    assert spread(count, columns) == frames


# ---- Errors ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("x.jpg", {}, "must end in .png or .gif"),
        ("x", {}, "must end in .png or .gif"),
        ("x.gif", {"frames": [1]}, "a .gif shows the whole sequence"),
        ("x.png", {"frames": [39]}, "frames must be from 0 to 38"),
        ("x.png", {"frames": [-1]}, "frames must be from 0 to 38"),
        ("x.png", {"frames": []}, "frames must be from 0 to 38"),
        ("x.png", {"truth": TRUTH[:3]}, "as many in truth: 39 and 3"),
        ("x.png", {"pitch": 91}, "pitch must be -90 to 90"),
        ("x.gif", {"fps": 0}, "fps 1 to 50"),
        ("x.png", {"pictures": [1, 2]}, "pictures must be 1, or 39"),
    ],
)
def test_what_cannot_be_drawn(name: str, options: dict, message: str, tmp_path: Path):
    with pytest.raises(ValueError, match=re.escape(message)):
        edmlift.draw(poses(), tmp_path / name, **options)
    assert not list(tmp_path.iterdir())


def test_no_poses_at_all(tmp_path: Path):
    with pytest.raises(ValueError, match="needs poses"):
        edmlift.draw(edmlift.Poses.of(TRUTH[:0]), tmp_path / "x.png")


def test_without_pillow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("edmlift.drawing.canvas.Image", None)
    with pytest.raises(ImportError, match=re.escape("pip install 'edmlift[draw]'")):
        edmlift.draw(poses(), tmp_path / "x.png")


@pytest.mark.parametrize("far", [np.nan, np.inf, 1e300, 1e30, -1e8, 101.0])
@pytest.mark.parametrize("suffix", [".png", ".gif"])
def test_what_no_picture_can_show(tmp_path: Path, far: float, suffix: str):
    """Before: a traceback, an empty picture, or a floor without an end."""
    given = poses()
    joints, truth = given.joints.copy(), np.array(TRUTH, float)
    with np.errstate(over="ignore"):
        joints[3, 5, 1] = far
    truth[3, 5, 1] = far
    out = tmp_path / f"x{suffix}"
    with pytest.raises(ValueError, match="poses: joints at .* a picture shows 100 m"):
        edmlift.draw(replace(given, joints=joints), out)
    with pytest.raises(ValueError, match="truth: joints at .* a picture shows 100 m"):
        edmlift.draw(given, out, truth=truth)
    assert not out.exists()


def test_a_refused_pose_may_be_anything(tmp_path: Path):
    given = poses()
    joints, status = given.joints.copy(), given.status.astype("U32")
    joints[0], status[0] = np.nan, "degenerate"
    edmlift.draw(replace(given, joints=joints, status=status), tmp_path / "x.png", frames=[0, 1])
    assert (tmp_path / "x.png").exists()
