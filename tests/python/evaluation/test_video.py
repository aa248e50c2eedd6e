"""Tracks through the binding, and tools/evaluation/video.py on motion whose figures are known."""

import numpy as np
import pytest
from support import ROOT, TEST, need_motion

from data import cameras
from data.mocap import Motion, save_motion
from edmlift import Track, track
from edmlift.joints import INDEX, MIRROR, mid_hip
from edmlift.library import TRACK, Poses, Tracked
from evaluation import cli, video
from reports import markdown

DOCS = ROOT / "docs" / "video.md"
WALK = np.loadtxt(ROOT / "examples" / "data" / "walk.csv", delimiter=",").reshape(-1, 14, 3)
TIMES = np.arange(len(WALK)) * 33


def test_the_noise_at_which_filters_act_in_full_can_be_set(library):
    """Exact keypoints are filtered less, unless the filters always act in full."""
    view = video.View(WALK, np.zeros((len(WALK), 2), bool))
    clip = video.Clip(WALK, TIMES, 1)
    alone = library.lift(WALK).joints
    own, full = (
        np.abs(video.track(library, view, clip, noise).joints - alone).mean() for noise in (None, 0)
    )
    assert own < full / 2


# The binding


def test_a_still_person_is_as_lifted(library):
    still = np.repeat(WALK[:1], 20, 0)
    tracked = library.track().lift(still, TIMES[:20])
    np.testing.assert_array_equal(tracked.joints, library.lift(still).joints)
    assert (tracked.status == "ok").all() and tracked.seen.all()
    assert not (tracked.held.any() or tracked.swapped.any() or tracked.mirrored.any())
    assert list(tracked.elapsed[:3]) == [0, 33, 33]


def test_reports_and_statuses(library):
    keypoints, times = WALK[:30].copy(), TIMES[:30].copy()
    keypoints[12, 3] = 0
    keypoints[15] = keypoints[15, MIRROR]
    keypoints[18, 0, 0] = np.nan
    times[21] = times[20]
    tracked = library.track().lift(keypoints, times)
    assert np.argwhere(tracked.held).tolist() == [[12, 3]]
    assert np.flatnonzero(~tracked.seen[12]).tolist() == [3]
    assert np.argwhere(tracked.swapped).tolist() == [[15, 0], [15, 1]]
    assert {i: s for i, s in enumerate(tracked.status) if s != "ok"} == {
        18: "not_finite",
        21: "time",
    }
    assert np.isnan(tracked.joints[[18, 21]]).all()
    assert tracked.elapsed[19] == 66


def test_settings_are_the_tracks(library):
    open_track = library.track()
    for name in ("smooth_image", "smooth_space"):
        open_track.state[name]["cutoff"] = np.inf
    lifted = library.lift(WALK).joints
    steady = library.track().lift(WALK, TIMES).joints
    np.testing.assert_allclose(open_track.lift(WALK, TIMES).joints, lifted, atol=1e-4)
    assert np.abs(steady - lifted).max() > 1e-3


@pytest.mark.parametrize(
    "setting",
    [{"smooth_image": (0, 1)}, {"smooth_space": (1, np.inf)}, {"smooth_space": (np.nan, 1)},
     {"noise_full": -1}, {"noise_full": np.nan}, {"noise_full": 1e39}],
)  # fmt: skip
def test_bad_settings(setting):
    (name,) = setting
    for make in (Track, lambda **given: track(WALK, fps=30, **given)):
        with pytest.raises(ValueError, match=name):
            make(**setting)


def test_calls_continue_the_track(library):
    track = library.track()
    halves = [track.lift(WALK[part], TIMES[part]).joints for part in (slice(20), slice(20, None))]
    np.testing.assert_array_equal(np.concatenate(halves), library.track().lift(WALK, TIMES).joints)


@pytest.mark.parametrize("limbs", [[True, False], [False, True], [True, True]])
@pytest.mark.parametrize("pixels", [0, 2])
def test_sides_that_are_swapped_for_half_a_second_stay_right(library, limbs, pixels):
    """As without the swap, whenever it comes; at the start the track must learn the sides."""
    keypoints = WALK.copy()
    keypoints[..., :2] += pixels * np.random.default_rng(8).normal(size=(*WALK.shape[:2], 2))
    clean = library.track().lift(keypoints, TIMES)
    for first in range(11, 19):
        swapped = np.zeros((len(WALK), 2), bool)
        swapped[first : first + 15] = limbs
        tracked = library.track().lift(video.swap(keypoints, swapped), TIMES)
        np.testing.assert_array_equal(tracked.swapped, swapped)
        np.testing.assert_array_equal(tracked.joints, clean.joints)


def test_the_distance_tells_a_persons_next_frame_from_another_person():
    track = Track()
    assert track.distance(WALK[0], 0) == np.inf
    track.lift(WALK[:20], TIMES[:20])
    size = np.abs(WALK[20, :, :2] - WALK[20, :, :2].mean(0)).sum(1).mean()
    assert track.distance(WALK[20], TIMES[20]) < 0.1
    other = WALK[20] + [1.5 * size, 0, 0]
    assert track.distance(other, TIMES[20]) == pytest.approx(1.5, abs=0.1)
    assert track.distance(other[:, :2], float(TIMES[20])) > 1
    assert track.distance(WALK[20], 5000) == np.inf


def test_wrong_shapes(library):
    with pytest.raises(ValueError, match="takes one frame"):
        Track().distance(WALK[:2], 0)
    with pytest.raises(ValueError, match="keypoints of the 14 joints must be"):
        Track().lift(WALK[:, :13], TIMES)
    with pytest.raises(ValueError, match="times must be"):
        library.track().lift(WALK, TIMES[:-1])


def test_its_size_is_what_is_written():
    assert f"{TRACK.itemsize} bytes" in DOCS.read_text("utf-8")


# The measurement


def swing(count: int) -> np.ndarray:
    """Somebody with a wrist that swings, [F,14,3] camera axes."""
    rng = np.random.default_rng(3)
    joints = np.repeat(rng.normal(0, 0.4, (1, 14, 3)), count, 0) + [0, 0, 4]
    joints[:, INDEX["left_wrist"], 0] += 0.3 * np.sin(np.arange(count) / 4)
    return joints


@pytest.fixture
def clip() -> video.Clip:
    return video.Clip(swing(200), np.arange(200) * 1000 // 30, 1)


STANDING = np.array(  # metres, y up
    [[0, 1.65, 0], [0, 1.45, 0], [-0.2, 1.4, 0], [-0.3, 1.15, 0], [-0.3, 0.9, 0.1], [0.2, 1.4, 0],
     [0.3, 1.15, 0], [0.3, 0.9, 0.1], [-0.1, 0.9, 0], [-0.1, 0.5, 0.05], [-0.1, 0.1, 0],
     [0.1, 0.9, 0], [0.1, 0.5, 0.05], [0.1, 0.1, 0]],
    np.float32,
)  # fmt: skip


@pytest.mark.parametrize("late", [0, 1, 2])
def test_lag_and_error_of_a_late_lifter(clip, late):
    rooted = clip.truth - mid_hip(clip.truth)[:, None]
    figures, squares = video.measure(Poses.of(np.roll(rooted, late, 0)), clip)
    assert video.LAGS[np.argmin(squares)] == pytest.approx(late, abs=0.05)
    assert (np.nanmean(figures["error"]) < 1e-3) == (late == 0)


def test_jitter_is_the_second_difference(clip):
    joints = np.zeros((200, 14, 3))
    joints[:, 0, 1] = 0.5 * 0.010 * np.arange(200) ** 2  # 10 mm a frame and frame
    jitter = video.jitter(joints, clip)
    assert np.nanmax(jitter) == pytest.approx(10 / 14)
    assert np.nanmin(jitter) == pytest.approx(10 / 14)
    uneven = video.Clip(clip.truth, clip.time + 60 * (np.arange(200) > 100), 1)
    assert np.isnan(video.jitter(joints, uneven)[[100, 101]]).all()
    assert np.isfinite(video.jitter(joints, uneven)[[99, 102]]).all()


def test_noise_is_as_large_as_the_detectors_and_half_of_it_slow():
    clip = video.Clip(swing(20000), np.arange(20000) * 33, 1)
    noise = video.detector_noise(clip, np.random.default_rng(1))
    plain = cameras.detector_noise(np.zeros(noise.shape), np.random.default_rng(2))
    np.testing.assert_allclose(noise.std((0, 2)), plain.std((0, 2)), rtol=0.1)
    later = (noise[1:] * noise[:-1]).mean() / noise.var()
    assert later == pytest.approx(0.5 * np.exp(-0.033 / video.SLOW), abs=0.03)


def test_spells_are_as_frequent_and_as_long_as_said():
    clip = video.Clip(swing(30000), np.arange(30000) * 33, 1)
    on = video.spells(clip, 4, 0.05, 0.2, np.random.default_rng(4))
    assert on.mean() == pytest.approx(0.05, rel=0.15)
    begins = (on[1:] & ~on[:-1]).sum()
    assert on.sum() / begins * 0.033 == pytest.approx(0.2, rel=0.15)


def test_swaps_are_counted(clip):
    views = video.views(clip, np.random.default_rng(5))
    wrong = views["swapped"].swapped
    assert wrong.any() and not views["noisy"].swapped.any()
    back = video.swap(views["swapped"].keypoints, wrong)
    np.testing.assert_array_equal(back, views["noisy"].keypoints)
    said = wrong.copy()
    said[0, 0] ^= True
    no = np.zeros(200)
    tracked = Tracked(
        **vars(Poses.of(swing(200))), held=no, swapped=said, mirrored=no, elapsed=no, aside=no
    )
    counts = video.swaps(tracked, views["swapped"])
    assert counts["missed"] + counts["false"] == 1
    assert counts["found"] + counts["missed"] == wrong.sum()


def test_joints_that_are_hidden_leave_a_lift_possible(clip):
    keypoints = video.views(clip, np.random.default_rng(6))["both"].keypoints
    hidden = (keypoints[..., 2] == 0).sum(1)
    assert 0 < hidden.max() <= video.MOST_HIDDEN


def test_clips_end_where_frames_do():
    frame = np.concatenate([np.arange(20) * 8, 1000 + np.arange(18) * 8, 2000 + np.arange(9) * 8])
    count = len(frame)
    motion = Motion(
        swing(count).astype(np.float32), np.ones(count, int), np.ones(count, int), frame,
        np.zeros(count, int), (), "made up",
    )  # fmt: skip
    clips = video.cut(motion, np.random.default_rng(7))
    assert [len(clip.time) for clip in clips] == [20] * video.CAMERAS + [18] * video.CAMERAS
    assert clips[0].time[3] == 200
    for clip in clips:  # before a camera
        assert (clip.truth[..., 2] > 1).all()


# What docs/video.md says

claims = pytest.mark.claims


def columns(text: str) -> dict[str, list[str]]:
    """Rows of a table by their titles."""
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("|")]
    return {row[0]: row[1:] for row in rows}


@pytest.mark.parametrize("name", ["video15", "video30"])
def test_what_must_hold_of_a_detectors_keypoints(name):
    """Half the jitter, under two frames of lag, no more error than 1 %, and about as many right
    mirror images."""
    rows = columns(markdown.read(DOCS, name))

    def pairs(title: str):
        both = zip(rows[f"{title}: alone"], rows[f"{title}: tracked"], strict=True)
        return [(float(alone), float(tracked)) for alone, tracked in both]

    assert all(tracked <= alone / 2 for alone, tracked in pairs("jitter, mm")[1:])
    assert all(tracked - alone < 2 for alone, tracked in pairs("lag, frames"))
    assert all(tracked <= 1.01 * alone for alone, tracked in pairs("error, mm"))
    assert all(tracked >= alone - 0.75 for alone, tracked in pairs("mirror right, %")[1:])


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, source",
    [
        pytest.param("video15", TEST, marks=[pytest.mark.long, claims("docs/video.md", "video15")]),
        pytest.param("video30", "cmu_raw/subjects/02", marks=claims("docs/video.md", "video30")),
    ],
)
def test_the_table_is_what_is_measured(name, source, library):
    motion = video.load_video(need_motion(source), 30)
    clips = video.cut(motion, np.random.default_rng(video.SEED))
    text = video.report(video.evaluate(library, clips), clips)
    assert markdown.read(DOCS, name).strip() == text.strip()


def test_command_line(tmp_path, library, capsys):
    page = tmp_path / "page.md"
    page.write_text("<!-- begin video -->\n<!-- end video -->\n")
    assert cli.main(["video", str(tmp_path / "none.npz")]) == 1
    assert "none.npz: no such file" in capsys.readouterr().err
    motion = Motion(
        np.repeat(STANDING[None], 20, 0), np.ones(20, int), np.ones(20, int), np.arange(20) * 8,
        np.zeros(20, int), (), "made up",
    )  # fmt: skip
    save_motion(motion, tmp_path / "still.npz", 15)
    assert cli.main(["video", str(tmp_path / "still.npz"), "--update", str(page)]) == 0
    printed = capsys.readouterr().out
    assert markdown.read(page, "video") == printed
    assert "true jitter is 0.0 mm" in printed
    save_motion(motion.take(np.arange(10)), tmp_path / "short.npz", 15)
    assert cli.main(["video", str(tmp_path / "short.npz")]) == 1
    assert "no 15 frames in a row" in capsys.readouterr().err
