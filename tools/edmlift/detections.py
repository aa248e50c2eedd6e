"""People that a detector found, and whose they are."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from edmlift.keypoint_files import Lines, read_objects, read_source
from edmlift.people import is_number

_FRAME_NAMES = ("image_id", "frame_id", "frame")
_PERSON_NAMES = ("idx", "track_id", "person_id")


@dataclass(frozen=True, repr=False)
class Detections:
    """N people in a number of frames, in the order in which the detector wrote them.

    `lift(found.keypoints, format=found.format)` lifts them, `track_people(found, fps=30)` follows
    them through a video.
    """

    keypoints: NDArray[
        np.float32
    ]  # [N,K,3] x, y and confidence as the detector has them; c 0: null
    frame: NDArray[np.int_]  # [N] index of the frame, from 0; frames without people count
    frames: int  # how many there are
    empty: NDArray[np.int_]  # indices of the frames without people
    image: tuple[Any, ...]  # [N] image_id, frame_id or frame as the detector has it, or None
    t: NDArray[np.float64]  # [N] the time, seconds; NaN where there is none
    person: tuple[Any, ...]  # [N] idx, track_id, person_id or id; None: the detector has none
    listed: NDArray[np.bool_]  # [N] among the people of a frame; else a line or value of its own
    objects: tuple[dict[str, Any], ...]  # [N] the members of the person and of its frame, from JSON
    format: str | None  # of the keypoints; None: the 14 joints

    def __repr__(self) -> str:
        count, names = len(self.keypoints), self.format or "the 14 joints"
        return (
            f"Detections({count} people in {self.frames} frames, {len(self.empty)} of them without "
            f"people: {names})"
        )

    def __len__(self) -> int:
        return len(self.keypoints)

    @classmethod
    def of(cls, objects: Any, format: str | None = None) -> "Detections":
        """People of a detector's objects in memory, as `read_detections` finds them in a file:
        dictionaries and lists of them, keypoints as lists or arrays; a list of lists is a list of
        frames.

            Detections.of([result.summary() for result in results], "coco17")   # Ultralytics

        ValueError: what is wrong with the first that cannot be read.
        """
        lines = read_objects(objects, format)
        for _, problem in sorted(lines.problems.items()):
            raise ValueError(problem)
        return _detections(lines, format)


def read_detections(
    path: str | Path, format: str | None = None, *, bad_lines: Literal["raise", "skip"] = "raise"
) -> Detections:
    """People in a file of a detector, or in the JSON files of a folder in the order of their names.

    format     the detector's, one of FORMATS, such as "body25"; default: the 14 joints
    bad_lines  "raise" FileError, or "skip" what cannot be read; it counts as a frame

    JSON (.json, .jsonl, .ndjson) may be OpenPose's, COCO's, AlphaPose's, mmpose's, Ultralytics',
    TensorFlow.js' or MediaPipe's, one value a frame or all in one; other files are lines of
    numbers, with or without a heading.  docs/detectors.md has the table.
    """
    if bad_lines not in ("raise", "skip"):
        raise ValueError(f"bad_lines must be 'raise' or 'skip', not {bad_lines!r}")
    lines = read_source(path, format)
    if bad_lines == "raise":
        lines.raise_problem()
    return _detections(lines, format)


def _detections(lines: Lines, format: str | None) -> Detections:
    count = len(lines.numbers)
    rows = [n for n in range(count) if n not in lines.problems and n not in lines.nobody]
    objects = [lines.objects[n] if lines.objects else {} for n in rows]
    frames = np.array(lines.frames, int)
    listed = np.array([bool(lines.listed) and lines.listed[n] for n in rows], bool)
    return Detections(
        lines.keypoints[rows],
        frames[rows],
        int(frames[-1]) + 1 if count else 0,
        np.setdiff1d(frames[sorted(lines.nobody)], frames[rows]),
        tuple(next((o[name] for name in _FRAME_NAMES if name in o), None) for o in objects),
        np.array([_time(o) for o in objects], float),
        tuple(_person(o, one) for o, one in zip(objects, listed, strict=True)),
        listed,
        tuple(objects),
        format,
    )


def _time(members: dict[str, Any]) -> float:
    time: Any = members.get("t")
    return float(time) if is_number(time) else np.nan


def _person(members: dict[str, Any], listed: bool) -> Any:
    """The id of a person: the first that is not null or -1, alone or in a list of one.  A member
    "id" is one only among people: it may be the line's, or COCO's, one an annotation."""
    more = ("id",) if listed and "image_id" not in members else ()
    found: Sequence[Any] = [members[name] for name in _PERSON_NAMES + more if name in members]
    ids = [one[0] if isinstance(one, list) and len(one) == 1 else one for one in found]
    return next((one for one in ids if isinstance(one, str | int) and one != -1), None)
