"""Several people in a video: a track for each."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.body import unmeasured
from edmlift.detections import Detections
from edmlift.keypoints import read_joints, read_keypoints, read_up
from edmlift.lifting import picked, run_warnings
from edmlift.mistakes import wrong_unit_of_time
from edmlift.networks import Model, find_model
from edmlift.tracking import (
    MEASURED_POSES,
    Tracked,
    TrackedFrames,
    checked_count,
    frame_times,
    with_bones,
)

_LONGEST_GAP = 1000  # ms, that a track waits for its person
_ALONE = ("alone",)  # the id of who is the only person of each line
_FURTHEST = 1.0  # body sizes, that a person may be from where the track expects them


@dataclass(frozen=True, repr=False)
class TrackedPeople(Tracked):
    """Poses of several people in a video, in the order in which the detector wrote them."""

    frame: NDArray[np.int_]  # [F] index of the frame
    # [F] number of the track, from 0, in the order of first appearance; -1: refused before it
    # ever was lifted
    person: NDArray[np.int_]

    def of_person(self, number: int) -> "TrackedPeople":
        """The poses of one person, one a frame in which they were seen."""
        return picked(self, np.flatnonzero(self.person == number))


def track_people(
    found: Detections,
    *,
    fps: float | None = None,
    model: str | None = None,
    up: ArrayLike | None = None,
    threshold: float | None = None,
    image: tuple[float, float] | None = None,
    mirrored: bool = False,
    hold_bones: int = MEASURED_POSES,
) -> TrackedPeople:
    """Lifts a video of several people, each made steady by the frames before.

    found  of `read_detections` or `Detections.of`
    fps    frames a second; default: each person has a time `t`, in seconds
    up     as in `lift`: [3], or one a person that was found, [N,3]

    model, threshold, image and mirrored are as in `lift`, hold_bones as in `Track`.  People whom
    the detector has given an id have a track each; others go to the nearest track that nobody of
    the frame has, within a body size of where it expects them, or to a new one.  A track without
    its person for over a second ends.  Lines or values that are one person each, without an id, are
    one person's.
    """
    joints, _ = read_joints(found.keypoints, found.format, threshold, image, mirrored)
    times = _times(found, fps)
    directions = read_up(up, len(joints))
    tracks, poses = _Tracks(find_model(model)), checked_count(hold_bones)
    rows: list[Tracked] = []
    numbers: list[int] = []
    taken: set[_PersonTrack] = set()
    for n, frame in enumerate(found.frame):
        if n > 0 and frame != found.frame[n - 1]:
            taken = set()
        above = None if directions is None else directions[n : n + 1]
        person = found.person[n] if found.listed[n] or found.person[n] is not None else _ALONE
        track = tracks.find(joints[n], person, times[n], taken)
        taken.add(track)
        row = track.frames.lift(joints[n : n + 1], times[n : n + 1], above)
        rows.append(with_bones(row, poses, track.measured))
        numbers.append(tracks.fed(track, times[n], bool(rows[-1].ok[0])))
    tracked = _joined(rows) if rows else TrackedFrames(find_model(model)).lift(joints, times)
    given, _ = read_keypoints(found.keypoints, found.format, threshold, image)
    warnings = run_warnings(tracked, given, found.format)
    if fps is None:
        warnings += wrong_unit_of_time(times[np.unique(found.frame, return_index=True)[1]])
    parts = {f.name: getattr(tracked, f.name) for f in fields(tracked)} | {"warnings": warnings}
    return TrackedPeople(**parts, frame=found.frame, person=np.array(numbers, int))


def _times(found: Detections, fps: float | None) -> NDArray[np.float64]:
    """Milliseconds [N]."""
    if fps is not None:
        return frame_times(fps, found.frames)[found.frame]
    if not np.isfinite(found.t).all():
        raise ValueError("track_people() needs fps=, or a finite `t` in seconds for each person")
    times: NDArray[np.float64] = np.floor(1000 * found.t + 0.5)
    return times


@dataclass(eq=False)
class _PersonTrack:
    frames: TrackedFrames
    person: Any  # the detector's id
    number: int = -1
    fed: float = -np.inf  # when, ms
    measured: NDArray[np.void] = field(default_factory=unmeasured)  # bones


class _Tracks:
    """The tracks of all people who are there."""

    def __init__(self, model: Model):
        self._model = model
        self._tracks: list[_PersonTrack] = []
        self._count = 0  # also of those that are over

    def find(
        self, joints: NDArray[np.float32], person: Any, time: float, taken: set[_PersonTrack]
    ) -> _PersonTrack:
        """This person's track; nobody else of the frame, who is `taken`, has it."""
        self._tracks = [
            track for track in self._tracks
            if track.person is _ALONE or time - track.fed <= _LONGEST_GAP
        ]  # fmt: skip
        if person is not None:
            same = [track for track in self._tracks if _is_same(track.person, person)]
            if not any(track in taken for track in same):  # else the id says nothing
                return same[0] if same else self._start(person)
        free = [track for track in self._tracks if track not in taken]
        distances = [track.frames.distance(joints, time) for track in free]
        if not distances or not min(distances) <= _FURTHEST:
            return self._start(None)
        return free[int(np.argmin(distances))]

    def fed(self, track: _PersonTrack, time: float, lifted: bool) -> int:
        """The number of a track that was given a frame.  One that has none is not kept."""
        if track.number < 0 and lifted:
            track.number, self._count = self._count, self._count + 1
            self._tracks.append(track)
        track.fed = time
        return track.number

    def _start(self, person: Any) -> _PersonTrack:
        return _PersonTrack(TrackedFrames(self._model), person)


def _is_same(a: Any, b: Any) -> bool:
    """Are these ids the same?  1 is neither "1" nor true."""
    return type(a) is type(b) and bool(a == b)


def _joined(rows: Sequence[Tracked]) -> Tracked:
    """Frames of one each, one behind another."""
    arrays: dict[str, Any] = {
        f.name: np.concatenate([getattr(row, f.name) for row in rows])
        for f in fields(Tracked)
        if f.name != "warnings"
    }
    return replace(rows[0], **arrays)
