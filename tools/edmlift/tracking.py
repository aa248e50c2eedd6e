"""One person in a video: lifts its frames, each made steady by those before."""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import OK, POSE, TRACK, load, pointer, pointers
from edmlift.body import give_measured, unmeasured
from edmlift.keypoints import from_bits, read_joints, read_keypoints, read_up
from edmlift.lifting import Poses, first, run_warnings, to_poses
from edmlift.mistakes import wrong_unit_of_time
from edmlift.networks import Model, find_model

MEASURED_POSES = 60  # EDML_MEASURED_POSES
_MAX_FLOAT = float(np.finfo(np.float32).max)
_ARMS, _LEGS = 1, 2  # EDML_SWAPPED_ARMS, EDML_SWAPPED_LEGS


@dataclass(frozen=True, repr=False)
class Tracked(Poses):
    """Poses of a video.  keypoints are with left and right as the track took them; `seen` says
    what was seen in this frame."""

    held: NDArray[np.bool_]  # [F,14] not seen in this frame, but lately
    swapped: NDArray[np.bool_]  # [F,2] the detector had swapped right and left arm; leg
    mirrored: NDArray[np.bool_]  # [F] not the mirror image that this frame alone would give
    elapsed: NDArray[np.uint32]  # [F] ms since the frame before; 0 at a start, and aside
    aside: NDArray[np.bool_]  # [F] somebody else, for a moment: lifted by itself


class Track:
    """The state of one person's video; one for each person.

        track = edmlift.Track(format="coco17")
        for keypoints, time_ms in frames:
            pose = track.lift(keypoints, time_ms)

    model, format, threshold, image and mirrored are as in `lift`.  smooth_image and smooth_space
    are (cutoff in Hz, slope) of the one-euro filters of keypoints (Hz per body size a second) and
    of poses (Hz per m/s), by default as measured; an infinite cutoff filters nothing.  noise_full
    is the share of noise at and above which the filters act in full; 0: always, and as the paper
    has them.  docs/video.md has what they give.  ValueError: a cutoff that is not over 0, a slope
    that is negative or not finite, or noise_full out of 0 to 64.

    hold_bones  so many poses, 60 at most, measure the person's bones, whose lengths all poses then
                have (docs/body.md); 0: bones are as long as each pose has them
    """

    def __init__(
        self,
        model: str | None = None,
        *,
        format: str | None = None,
        threshold: float | None = None,
        image: tuple[float, float] | None = None,
        mirrored: bool = False,
        smooth_image: tuple[float, float] | None = None,
        smooth_space: tuple[float, float] | None = None,
        noise_full: float | None = None,
        hold_bones: int = MEASURED_POSES,
    ):
        self._frames = TrackedFrames(find_model(model))
        self._given = (format, threshold, image, mirrored)
        _set(self._frames, smooth_image, smooth_space, noise_full)
        self._hold_bones, self._measured = checked_count(hold_bones), unmeasured()

    def lift(
        self, keypoints: ArrayLike, time_ms: ArrayLike, up: ArrayLike | None = None
    ) -> Tracked:
        """Lifts the next frame, or the next F frames with F times.

        time_ms  milliseconds by any clock, ascending
        up       as in `lift`

        Status besides those of `edmlift.lift`: "time" (not later than the frame before, or by
        more than 24 days); the track is then as before.
        """
        joints, single = read_joints(keypoints, *self._given)
        times = np.atleast_1d(np.asarray(time_ms))
        tracked = self._frames.lift(joints, times, read_up(up, len(joints)))
        tracked = with_bones(tracked, self._hold_bones, self._measured)
        return first(tracked) if single else tracked

    def distance(self, keypoints: ArrayLike, time_ms: float) -> float:
        """How far one frame's keypoints are from where the track expects them at that time.

        In body sizes; the same person's are within about 0.3, and beyond 1 it is another person.
        Infinity if the track cannot say, as at its start and a second after its last frame
        (edml_track_distance in edmlift/video.h).
        """
        joints, single = read_joints(keypoints, *self._given)
        if not single:
            raise ValueError("distance() takes one frame [K,2] or [K,3]")
        return self._frames.distance(joints[0], time_ms)


def track(
    keypoints: ArrayLike,
    *,
    fps: float | None = None,
    time_ms: ArrayLike | None = None,
    model: str | None = None,
    up: ArrayLike | None = None,
    format: str | None = None,
    threshold: float | None = None,
    image: tuple[float, float] | None = None,
    mirrored: bool = False,
    smooth_image: tuple[float, float] | None = None,
    smooth_space: tuple[float, float] | None = None,
    noise_full: float | None = None,
    hold_bones: int = MEASURED_POSES,
) -> Tracked:
    """Lifts a whole video of one person: keypoints [F,K,2 or 3], as in `lift`, at so many frames a
    second or at times [F] in milliseconds.  `Track` takes the frames as they come; the settings
    are its own."""
    if (fps is None) == (time_ms is None):
        raise ValueError("track() takes either fps= or time_ms=")
    if fps is not None:
        frame_times(fps, 0)  # before the keypoints are looked at
    joints, single = read_joints(keypoints, format, threshold, image, mirrored)
    if single:
        raise ValueError("track() takes frames [F,K,2] or [F,K,3], not one; Track takes one")
    times = np.asarray(time_ms) if fps is None else frame_times(fps, len(joints))
    directions = read_up(up, len(joints))
    frames = TrackedFrames(find_model(model))
    _set(frames, smooth_image, smooth_space, noise_full)
    tracked = frames.lift(joints, times, directions)
    seen, _ = read_keypoints(keypoints, format, threshold, image)
    warnings = run_warnings(tracked, seen, format)
    held = with_bones(tracked, checked_count(hold_bones), unmeasured())
    return replace(held, warnings=warnings + wrong_unit_of_time(times))


def frame_times(fps: float, count: int) -> NDArray[np.float64]:
    """The times of so many frames, ms; ValueError: not a rate."""
    if not (np.isfinite(fps) and 0 < fps <= 1000):
        raise ValueError(f"fps must be over 0 and at most 1000, not {fps}")
    return np.arange(count) * 1000 / fps


def checked_count(hold_bones: int) -> int:
    """How many poses measure the bones: 0 to MEASURED_POSES."""
    if not 0 <= hold_bones <= MEASURED_POSES:
        raise ValueError(f"hold_bones must be 0 to {MEASURED_POSES} poses, not {hold_bones}")
    return hold_bones


def with_bones(tracked: Tracked, frames: int, measured: NDArray[np.void]) -> Tracked:
    """A video with the bones of its first frames; 0: as it is.  `measured` is the state."""
    if frames == 0:
        return tracked
    held = give_measured(load(), tracked, tracked.elapsed == 0, ~tracked.aside, frames, measured)
    return replace(tracked, joints=held.joints)


def _set(
    frames: "TrackedFrames",
    smooth_image: tuple[float, float] | None,
    smooth_space: tuple[float, float] | None,
    noise_full: float | None,
) -> None:
    """Settings that are given, checked as edml_track_lift() does."""
    for name, pair in (("smooth_image", smooth_image), ("smooth_space", smooth_space)):
        if pair is None:
            continue
        cutoff, slope = pair
        if not (cutoff > 0 and 0 <= slope <= _MAX_FLOAT):
            raise ValueError(
                f"{name} must be a cutoff over 0 and a finite slope of 0 or more, not {pair}"
            )
        frames.state[name] = (cutoff, slope)
    if noise_full is None:
        return
    if not 0 <= noise_full <= 64:
        raise ValueError(f"noise_full must be 0 to 64, not {noise_full}")
    frames.state["noise_full"] = noise_full


# ---- For the library, unchecked ----------------------------------------------------------------


class TrackedFrames:
    """edml_track_lift() of joints; `state`, a TRACK, holds the settings, too."""

    def __init__(self, model: Model):
        self._model = model
        self._work = model.work()
        self.state = np.zeros(1, TRACK)
        model.c.edml_track_start(pointer(self.state))

    def distance(self, joints: NDArray[np.float32], time_ms: float) -> float:
        """edml_track_distance() of joints [14,3]."""
        seen = np.array(joints, np.float32)
        ms = int(np.floor(time_ms)) & 0xFFFFFFFF
        return float(self._model.c.edml_track_distance(pointer(self.state), pointer(seen), ms))

    def lift(
        self,
        joints: NDArray[np.float32],
        time_ms: NDArray[np.generic],
        up: NDArray[np.float32] | None = None,
    ) -> Tracked:
        """Lifts joints [F,14,3] that were seen at times [F], ms; up [F,3] where it is known."""
        if time_ms.shape != joints.shape[:1]:
            raise ValueError(f"times must be [{len(joints)}], not {list(time_ms.shape)}")
        if time_ms.dtype.kind not in "iuf" or not np.isfinite(time_ms).all():
            raise ValueError("times must be finite numbers of milliseconds")
        times = np.floor(time_ms.astype(np.float64)) if time_ms.dtype.kind == "f" else time_ms
        model, joints = self._model, np.array(joints, np.float32, order="C")
        poses, reports = np.zeros(len(joints), POSE), np.zeros(len(joints), TRACK)
        status = np.zeros(len(joints), np.int32)
        for i, (pose, seen) in enumerate(pointers(poses, joints)):
            status[i] = model.c.edml_track_lift(
                pose, pointer(self.state), seen, int(times[i]) & 0xFFFFFFFF,
                None if up is None else pointer(up[i]), model.address, self._work,
                model.work_bytes,
            )  # fmt: skip
            if status[i] == OK:
                reports[i] = self.state[0]
                model.c.edml_track_swap_sides(seen, pointer(self.state))
        lifted = to_poses(model, poses, status, joints, 1)
        swapped = reports["swapped"][:, None] & np.array([_ARMS, _LEGS]) != 0
        parts = {f.name: getattr(lifted, f.name) for f in fields(lifted)}
        return Tracked(
            **parts, held=from_bits(reports["held"]), swapped=swapped,
            mirrored=reports["mirrored"] != 0, elapsed=reports["elapsed"],
            aside=reports["aside"] > 0,
        )  # fmt: skip
