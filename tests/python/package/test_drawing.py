"""The pictures of tools/draw.py, and what it says about files that it cannot use."""

from pathlib import Path

import draw
import numpy as np
import pytest
from PIL import Image

DATA = Path(__file__).resolve().parents[2] / "examples" / "data"
WALK, TRUTH = DATA / "walk.csv", DATA / "walk_truth.csv"
TURN = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])

pytestmark = pytest.mark.filterwarnings("error")


def write_lifted(path: Path, poses: np.ndarray, refused: tuple[int, ...] = ()) -> Path:
    """A file as lift_stdin writes it."""
    lines = ["ok," + ",".join(f"{v:.6g}" for v in pose.ravel()) + ",5.5,0.02" for pose in poses]
    for i in refused:
        lines[i] = "too_few_joints" + "," * 44
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def lifted(tmp_path: Path) -> Path:
    """The walk's truth, as if it had been lifted."""
    return write_lifted(tmp_path / "lifted.csv", draw.read_truth(TRUTH))


@pytest.fixture
def short(tmp_path: Path) -> tuple[Path, Path]:
    """Four poses as keypoints and lifted: a missing arm, a refused one, a line that is none."""
    lines = [line for line in WALK.read_text().splitlines() if not line.startswith("#")][:4]
    arm = lines[1].split(",")
    arm[9:15] = "000000"
    lines[1], lines[2] = ",".join(arm), "text"
    keypoints = tmp_path / "short.csv"
    keypoints.write_text("\n".join(lines))
    return keypoints, write_lifted(tmp_path / "out.csv", draw.read_truth(TRUTH)[:4], refused=(2, 3))


def run(*arguments: str | Path) -> int:
    return draw.main([str(argument) for argument in arguments])


# ---- Pictures --------------------------------------------------------------------------------


def test_sheet(tmp_path: Path, lifted: Path, capsys: pytest.CaptureFixture):
    out = tmp_path / "walk.png"
    assert run(WALK, lifted, "--out", out, "--truth", TRUTH, "--title", "A walk") == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    assert printed.out.startswith("39 of 39 poses lifted; mean error 0.0 mm root-relative, 0.0 mm")
    with Image.open(out) as image:
        wide, high = image.size
        colours = image.convert("RGB").getcolors(1 << 24)
    assert 1700 <= wide <= 1900 and 0.5 < high / wide < 1.2
    drawn = {colour for _, colour in colours}
    for name in draw.COLOURS.values():
        assert tuple(bytes.fromhex(name[1:])) in drawn


@pytest.mark.parametrize(("kind", "start"), [("svg", b"<?xml"), ("pdf", b"%PDF"), ("PNG", b"\x89")])
def test_other_kinds_of_sheet(tmp_path: Path, lifted: Path, kind: str, start: bytes):
    out = tmp_path / f"walk.{kind}"
    assert run(WALK, lifted, "--out", out, "--frames", "2") == 0
    assert out.read_bytes().startswith(start)


def test_one_frame_is_a_strip(tmp_path: Path, lifted: Path):
    out = tmp_path / "walk.png"
    assert run(WALK, lifted, "--out", out, "--frame", "38") == 0
    with Image.open(out) as image:
        assert 800 <= image.width <= 1800
        assert image.height < image.width


def test_animation(tmp_path: Path, short: tuple[Path, Path]):
    out = tmp_path / "short.gif"
    assert run(*short, "--out", out, "--title", "Four poses") == 0
    with Image.open(out) as image:
        assert image.n_frames == 4
        assert 600 <= image.width <= 1400 and 300 <= image.height <= 700
        assert 15 <= 1000 / image.info["duration"] <= 30
        assert image.info["loop"] == 0


def test_refused_poses_and_missing_joints(tmp_path: Path, short: tuple[Path, Path]):
    out = tmp_path / "short.svg"
    assert run(*short, "--out", out, "--frames", "4") == 0
    assert out.read_text().count("<!-- too_few_joints -->") == 4  # two poses from two sides
    assert "<!-- not seen in 2D -->" in out.read_text()


def test_nothing_lifted_at_all(tmp_path: Path, capsys: pytest.CaptureFixture):
    nothing = write_lifted(tmp_path / "nothing.csv", np.zeros((39, 14, 3)), tuple(range(39)))
    assert run(WALK, nothing, "--out", tmp_path / "x.png", "--truth", TRUTH) == 0
    assert capsys.readouterr().out == "0 of 39 poses lifted\n"


def test_from_python(tmp_path: Path):
    truth = draw.read_truth(TRUTH)
    keypoints = draw.read_keypoints(WALK)
    status = ["ok"] * len(truth)
    draw.draw_sheet(keypoints, truth, status, tmp_path / "sheet.png", title="A walk", frames=[1, 5])
    draw.draw_animation(keypoints[:2], truth[:2], status[:2], tmp_path / "walk.gif", truth[:2])
    assert (tmp_path / "sheet.png").stat().st_size > 10_000
    assert (tmp_path / "walk.gif").stat().st_size > 10_000


# ---- Numbers ---------------------------------------------------------------------------------


def test_mean_errors_by_hand():
    truth = draw.read_truth(TRUTH)
    moved = truth + [0.3, -0.2, 0.1]
    np.testing.assert_allclose(draw.mean_errors(moved, truth), 0, atol=1e-6)
    relative, aligned = draw.mean_errors(truth @ TURN, truth)
    assert relative > 50 and aligned < 1e-6
    lower = truth.copy()
    lower[:, 0, 1] += 0.14  # the head's top alone, 140 mm
    assert draw.mean_errors(lower, truth)[0] == pytest.approx(10)
    lower[3:] = np.nan
    assert draw.mean_errors(lower, truth)[0] == pytest.approx(10)


@pytest.mark.parametrize(
    ("count", "columns", "frames"),
    [(39, 6, [3, 9, 16, 22, 29, 35]), (3, 6, [0, 1, 2]), (10, 1, [5]), (1, 6, [0])],
)
def test_spread(count: int, columns: int, frames: list[int]):
    assert draw.spread(count, columns) == frames


def test_views():
    x, y, z = np.eye(3)
    for degrees, right, near in ((0, x, -z), (90, z, x)):
        assert draw.turn(right, degrees)[0] == pytest.approx(1)
        assert draw.turn(-y, degrees)[1] > 0.9
        assert draw.turn(near, degrees)[2] > 0.9


def test_a_pitched_cameras_poses_are_turned_upright():
    pitch = np.radians(30)
    up = np.array([0, -np.cos(pitch), -np.sin(pitch)])  # in axes of a camera that looks down
    poses = np.stack([2 * up, [1.0, 0, 0]])
    assert draw.upright(poses, 30) == pytest.approx(np.array([[0, -2, 0], [1, 0, 0]]))
    assert (draw.upright(poses, 0) == poses).all()


def test_read_keypoints_reads_what_lift_stdin_does(tmp_path: Path):
    path = tmp_path / "in.csv"
    numbers = np.arange(1, 29)
    path.write_bytes(
        b"\xef\xbb\xbf# names\r\n\r\n"
        + " \t".join(map(str, numbers)).encode()
        + b"\r\n"
        + b"1,,2\n"
        + ",".join(f"{n}, {n},0.3" for n in range(14)).encode()
    )
    poses = draw.read_keypoints(path, threshold=0.3)
    np.testing.assert_array_equal(poses[0, :, :2].ravel(), numbers)
    assert (poses[0, :, 2] == 1).all()
    assert np.isnan(poses[1]).all()
    assert (poses[2, :, 2] == 0).all()


def test_read_lifted_with_and_without_header(lifted: Path):
    poses, status = draw.read_lifted(lifted)
    lifted.write_text("status," + ",".join("abc") + "\n" + lifted.read_text())
    again, _ = draw.read_lifted(lifted)
    np.testing.assert_array_equal(poses, again)
    assert set(status) == {"ok"}
    np.testing.assert_allclose(poses, draw.read_truth(TRUTH), atol=1e-6)


# ---- Errors ----------------------------------------------------------------------------------


def fails(capsys: pytest.CaptureFixture, *arguments: str | Path) -> str:
    """The one line that it says when it gives up."""
    assert run(*arguments) == 1
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1
    assert printed.err.startswith("draw: ")
    return printed.err


def test_files_of_unequal_length(tmp_path: Path, lifted: Path, capsys: pytest.CaptureFixture):
    out = tmp_path / "x.png"
    message = fails(capsys, DATA / "kick.csv", lifted, "--out", out)
    assert "kick.csv has 47, " in message and "lifted.csv has 39" in message
    message = fails(capsys, WALK, lifted, "--out", out, "--truth", DATA / "kick_truth.csv")
    assert "kick_truth.csv has 47" in message
    assert not out.exists()


def test_no_camera_looks_down_by_more_than_a_right_angle(lifted: Path, tmp_path: Path, capsys):
    assert run(WALK, lifted, "--out", tmp_path / "a.png", "--pitch", "91") == 1
    assert capsys.readouterr().err == "draw: --pitch 91: must be within 90 degrees\n"


def test_unreadable_files(tmp_path: Path, lifted: Path, capsys: pytest.CaptureFixture):
    out, none = tmp_path / "x.png", tmp_path / "none.csv"
    for files in ((none, lifted), (WALK, none), (WALK, lifted, "--truth", none)):
        assert "none.csv: No such file" in fails(capsys, *files, "--out", out)
    assert "Is a directory" in fails(capsys, tmp_path, lifted, "--out", out)


def test_files_of_another_kind(tmp_path: Path, lifted: Path, capsys: pytest.CaptureFixture):
    out, empty = tmp_path / "x.png", tmp_path / "empty.csv"
    empty.write_text("# nothing\n")
    assert "pose 1 is not a line of lift_stdin" in fails(capsys, WALK, WALK, "--out", out)
    assert "holds no pose of 28 or 42" in fails(capsys, lifted, lifted, "--out", out)
    assert "holds no pose" in fails(capsys, empty, lifted, "--out", out)
    assert "pose 1 is not 42" in fails(capsys, WALK, lifted, "--out", out, "--truth", lifted)


@pytest.mark.parametrize("name", ["x.jpg", "x", "x.gif.txt"])
def test_unknown_extension(name: str, lifted: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    assert "must end in .png, .svg, .pdf or .gif" in fails(
        capsys, WALK, lifted, "--out", tmp_path / name
    )


@pytest.mark.parametrize("kind", ["png", "svg", "gif"])
def test_unwritable(kind: str, short: tuple[Path, Path], tmp_path: Path, capsys):
    message = fails(capsys, *short, "--out", tmp_path / "nowhere" / f"x.{kind}")
    assert "No such file or directory" in message


@pytest.mark.parametrize(
    "options", [("--frame", "39"), ("--frame", "-1"), ("--frames", "0"), ("--frames", "25")]
)
def test_frames_that_are_not_there(options, lifted: Path, tmp_path: Path, capsys):
    assert options[0] in fails(capsys, WALK, lifted, "--out", tmp_path / "x.png", *options)


def test_frames_of_an_animation(lifted: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    message = fails(capsys, WALK, lifted, "--out", tmp_path / "x.gif", "--frames", "3")
    assert "a .gif shows the whole sequence" in message
