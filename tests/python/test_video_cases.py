"""Videos that users complain of: each must come out well enough to be used (cases/README.md).

By the package, which calls the C library, and by lift_stdin, which answers a frame before it reads
the next.
"""

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support import EXAMPLES, ROOT, need_library

import edmlift
from data.bodies import bone_lengths
from edmlift.joints import BONES, JOINTS, mid_hip
from edmlift.metrics import joint_errors

CASES = Path(__file__).parent / "cases"
CAMERA, IMAGE = (1145.0, 1145.0, 500.0, 500.0), (1000.0, 1000.0)
LIMBS = [b for b, (_, end) in enumerate(BONES) if JOINTS[end].split("_")[-1] in
         ("elbow", "wrist", "knee", "ankle")]  # fmt: skip


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def read(path: Path) -> np.ndarray:
    """Joints or keypoints [F,14,3]."""
    return np.loadtxt(path, delimiter=",").reshape(-1, 14, 3)


WALKS_AWAY = read(CASES / "walks_away.csv")
ROOTS = np.loadtxt(CASES / "walks_away_root.csv", delimiter=",")
KICK, KICK_TRUTH = read(EXAMPLES / "kick.csv"), read(EXAMPLES / "kick_truth.csv")


def by_program(keypoints: np.ndarray, *options: str) -> dict[str, np.ndarray]:
    """Columns of what lift_stdin makes of a video of 30 frames a second."""
    from test_lift_stdin import PROGRAM

    lines = "\n".join(",".join(f"{n:.6g}" for n in pose.ravel()) for pose in keypoints)
    command = [PROGRAM, "--track", "30", "--header", *options]
    done = subprocess.run(command, input=lines.encode(), capture_output=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, b"")
    names, *rows = (line.split(",") for line in done.stdout.decode().splitlines())
    assert {row[0] for row in rows} == {"ok"}
    table = {name: [row[n] for row in rows] for n, name in enumerate(names)}
    table.pop("status")
    assert set(table.pop("placement", ["ok"])) == {"ok"}
    return {name: np.array(column, float) for name, column in table.items()}


def root_of(table: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([table[f"root_{axis}"] for axis in "xyz"], 1)


def joints_of(table: dict[str, np.ndarray]) -> np.ndarray:
    columns = [table[f"{axis}{j}"] for j in range(14) for axis in "xyz"]
    return np.stack(columns, 1).reshape(-1, 14, 3)


def frame_by_frame(poses: edmlift.Tracked, **camera: tuple[float, ...]) -> edmlift.Placements:
    """As a program places that answers frames as they come."""
    return edmlift.PlacedTrack(**camera).place(poses)


# ---- The path of someone who walks away ------------------------------------------------------


def path_by_package() -> np.ndarray:
    return edmlift.place(edmlift.track(WALKS_AWAY, fps=30), CAMERA).translation


def path_frame_by_frame() -> np.ndarray:
    return frame_by_frame(edmlift.track(WALKS_AWAY, fps=30), camera=CAMERA).translation


def path_by_program() -> np.ndarray:
    return root_of(by_program(WALKS_AWAY, "--camera", ",".join(map(str, CAMERA))))


@pytest.mark.parametrize("path", [path_by_package, path_frame_by_frame, path_by_program])
def test_the_path_through_the_room_is_smooth(path: Callable[[], np.ndarray]):
    roots = 1000 * path().astype(float)
    assert np.linalg.norm(np.diff(roots, 2, axis=0), axis=1).mean() < 20  # mm; 92 alone
    assert np.linalg.norm(roots - 1000 * ROOTS, axis=1).mean() < 47


def test_the_path_is_filtered_in_depth_and_hardly_across():
    tracked = edmlift.track(WALKS_AWAY, fps=30)
    found = edmlift.place(tracked, CAMERA)
    alone = edmlift.place(edmlift.Poses.of(tracked.joints, tracked.keypoints), CAMERA)
    sight = ROOTS / np.linalg.norm(ROOTS, axis=1, keepdims=True)
    moved = (found.translation - alone.translation).astype(float)
    along = (moved * sight).sum(1)
    across = np.linalg.norm(moved - along[:, None] * sight, axis=1)
    assert np.abs(along).mean() > 0.02  # metres
    assert across.mean() < 0.003
    shift = found.joints - alone.joints
    np.testing.assert_allclose(shift, np.broadcast_to(moved[:, None], shift.shape), atol=1e-5)


# ---- A focal length that is not known --------------------------------------------------------


def placed_by_package() -> tuple[np.ndarray, np.ndarray]:
    placed = edmlift.place(edmlift.track(WALKS_AWAY, fps=30), image=IMAGE)
    return placed.focal, placed.translation


def placed_frame_by_frame() -> tuple[np.ndarray, np.ndarray]:
    track, place = edmlift.Track(), edmlift.PlacedTrack(image=IMAGE)
    placed = [place.place(track.lift(k, i * 1000 // 30)) for i, k in enumerate(WALKS_AWAY)]
    return np.array([p.focal for p in placed]), np.array([p.translation for p in placed])


def placed_by_program() -> tuple[np.ndarray, np.ndarray]:
    table = by_program(WALKS_AWAY, "--focal", "sweep", "--image", "1000,1000")
    return table["focal"], root_of(table)


@pytest.mark.parametrize("placed", [placed_by_package, placed_frame_by_frame, placed_by_program])
def test_a_video_has_one_focal_length(placed: Callable[[], tuple[np.ndarray, np.ndarray]]):
    focal, roots = placed()
    assert len(set(focal.tolist())) == 1
    assert abs(np.log(focal[0] / CAMERA[0])) < 0.2
    assert 1000 * np.linalg.norm(np.diff(roots, axis=0), axis=1).max() < 300  # mm; true 41


# ---- Limbs that keep their lengths -----------------------------------------------------------


def kick_by_package() -> np.ndarray:
    return edmlift.track(KICK, fps=30).joints


def kick_by_program() -> np.ndarray:
    return joints_of(by_program(KICK))


@pytest.mark.parametrize("kick", [kick_by_package, kick_by_program])
def test_limbs_keep_their_lengths(kick: Callable[[], np.ndarray]):
    joints = kick().astype(float)
    limbs = 1000 * bone_lengths(joints)[:, LIMBS]
    assert limbs.std(0).mean() < 5  # mm; 28 as lifted
    assert 1000 * joint_errors(joints, KICK_TRUTH, "rigid").mean() < 70
    np.testing.assert_allclose(limbs[:, [0, 1, 4, 5]], limbs[:, [2, 3, 6, 7]], atol=0.1)
    np.testing.assert_allclose(mid_hip(joints), 0, atol=1e-5)


def test_bones_may_be_as_lifted():
    lifted, free = (edmlift.track(KICK, fps=30, hold_bones=n).joints for n in (60, 0))
    assert (1000 * bone_lengths(free.astype(float))[:, LIMBS]).std(0).mean() > 15
    np.testing.assert_allclose(
        joints_of(by_program(KICK, "--hold-bones", "0")), free, rtol=1e-5, atol=1e-5
    )
    assert np.abs(lifted - free).max() > 0.01


@pytest.mark.parametrize("hold", [60, 5, 1])
def test_the_program_is_the_package(hold: int):
    tracked = edmlift.track(WALKS_AWAY, fps=30, hold_bones=hold)
    placed = edmlift.place(tracked, CAMERA)
    table = by_program(WALKS_AWAY, "--hold-bones", str(hold), "--camera", "1145,1145,500,500")
    np.testing.assert_allclose(root_of(table), placed.translation, rtol=1e-4, atol=1e-4)
    joints = placed.joints - placed.translation[:, None]
    np.testing.assert_allclose(joints_of(table), joints, atol=1e-4)
    lengths = bone_lengths(tracked.joints[hold:].astype(float))
    np.testing.assert_allclose(lengths, np.broadcast_to(lengths[0], lengths.shape), atol=1e-5)


def test_a_known_height_is_kept():
    tall, usual = (
        joints_of(by_program(KICK, "--height", height)).astype(float) for height in ("1.9", "1.6")
    )
    np.testing.assert_allclose(
        bone_lengths(tall).sum(1) / bone_lengths(usual).sum(1), 1.9 / 1.6, rtol=0.01
    )


# ---- What is wrong with the arguments --------------------------------------------------------


@pytest.mark.parametrize(
    "options",
    [
        ("--track", "30", "--hold-bones", "61"),
        ("--track", "30", "--hold-bones", "-1"),
        ("--track", "30", "--hold-bones", "2.5"),
        ("--track", "30", "--hold-bones", "x"),
        ("--hold-bones", "30"),
    ],
)
def test_bad_options(options: tuple[str, ...]):
    from test_lift_stdin import PROGRAM

    done = subprocess.run([PROGRAM, *options], input=b"", capture_output=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, b"") and b"--hold-bones" in done.stderr


def test_bad_arguments():
    with pytest.raises(ValueError, match="hold_bones must be 0 to 60"):
        edmlift.track(KICK, fps=30, hold_bones=61)
    with pytest.raises(ValueError, match="either camera="):
        edmlift.PlacedTrack()
    with pytest.raises(ValueError, match="either camera="):
        edmlift.place(edmlift.track(KICK, fps=30), CAMERA, image=IMAGE)
    with pytest.raises(TypeError, match="frames must be Tracked, not Poses"):
        edmlift.PlacedTrack(CAMERA).place(edmlift.lift(KICK))


def test_frames_that_cannot_be_placed_leave_the_path():
    """Nobody, in one frame and for two seconds: the same path, or a new one."""
    keypoints = np.insert(WALKS_AWAY, 40, np.nan, axis=0)
    times = np.insert(np.arange(78) * 1000 // 30, 40, 1320)
    tracked = edmlift.track(keypoints, time_ms=times)
    placed = edmlift.place(tracked, CAMERA)
    assert list(np.flatnonzero(placed.status != "ok")) == [40]
    assert np.isnan(placed.translation[40]).all()
    others = np.delete(placed.translation, 40, 0)
    whole = edmlift.place(edmlift.track(WALKS_AWAY, fps=30), CAMERA).translation
    np.testing.assert_allclose(others, whole, atol=1e-5)
    late = times + np.where(np.arange(79) > 40, 2000, 0)
    anew = edmlift.place(edmlift.track(keypoints, time_ms=late), CAMERA)
    first = edmlift.place(edmlift.track(WALKS_AWAY[40:], fps=30), CAMERA)
    np.testing.assert_allclose(anew.translation[41], first.translation[0], atol=1e-5)


def test_the_constant_is_the_headers():
    header = (ROOT / "include" / "edmlift" / "body.h").read_text("utf-8")
    assert f"EDML_MEASURED_POSES = {edmlift.tracking.MEASURED_POSES} " in header
