"""Keypoints and poses in files, a line each: the CSV and the JSON lines of lift_stdin.

Keypoints are x,y or x,y,c of each, separated by commas or blanks; or objects with a member
"keypoints": [[x,y,c],...].  Poses are status,x0,y0,z0,...,x13,y13,z13,misfit; or objects with
"status", "joints" and "misfit".  Blank lines and those that start with # are skipped.  A name that
ends in .jsonl, .ndjson or .json holds JSON lines.
"""

import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from edmlift._binding import JOINT_COUNT
from edmlift.formats import find_format
from edmlift.lifting import Poses, batched

_NO_FORMAT = "a pose"  # what messages call a line of the 14 joints
JSON_SUFFIXES = (".jsonl", ".ndjson", ".json")
BAD_LINE = "bad_line"  # the status of a line that is not a pose
_NUMBERS = 3 * JOINT_COUNT
_COLUMNS = ("status", *(f"{axis}{j}" for j in range(JOINT_COUNT) for axis in "xyz"))
HEADER = ",".join((*_COLUMNS, "misfit"))
_ANSWERS = ("status", "joints", "misfit")


class FileError(ValueError):
    """A file that does not hold what it should: its name, the line, and what is wrong with it."""


@dataclass(frozen=True)
class Lines:
    """What the lines of a file hold, in their order."""

    keypoints: NDArray[np.float32]  # [F,K,3] x, y and confidence; all NaN for a bad line
    numbers: Sequence[int]  # [F] of the lines, from 1
    problems: dict[int, str]  # what is wrong with the bad ones, by their index
    objects: Sequence[dict[str, Any] | None]  # [F] JSON alone: what was read


def is_json(path: str | Path) -> bool:
    """Does a file of this name hold JSON lines?"""
    return Path(path).suffix.lower() in JSON_SUFFIXES


# ---- Reading -----------------------------------------------------------------------------------


def read_keypoints(
    path: str | Path, format: str | None = None, *, bad_lines: Literal["raise", "nan"] = "raise"
) -> NDArray[np.float32]:
    """Keypoints [F,K,3] of a file: x, y and confidence, 1 where the file has none.

    format     what one line holds: a detector's keypoints, or by default the 14 joints
    bad_lines  "raise" FileError, or make the pose "nan", which a lift takes for one without joints

    A keypoint that is null in JSON has confidence 0.
    """
    if bad_lines not in ("raise", "nan"):
        raise ValueError(f"bad_lines must be 'raise' or 'nan', not {bad_lines!r}")
    lines = read_lines(Path(path).read_bytes(), format, is_json(path))
    for index, problem in lines.problems.items():
        if bad_lines == "raise":
            raise FileError(f"{path}:{lines.numbers[index]}: {problem}")
    return lines.keypoints


def read_poses(path: str | Path) -> Poses:
    """Lifted poses of a file, with or without a header; further columns are left out.

    Where they were seen is not in the file: their keypoints are NaN.
    """
    statuses: list[str] = []
    numbers: list[list[float]] = []
    for line, text in _text_lines(Path(path).read_bytes()):
        if not numbers and text.startswith("status,"):
            continue
        try:
            status, pose = (_pose_object if is_json(path) else _pose_fields)(text)
        except ValueError as error:
            raise FileError(f"{path}:{line}: {error}") from None
        statuses.append(status)
        numbers.append(pose)
    values = np.array(numbers, np.float32).reshape(-1, _NUMBERS + 1)
    joints = values[:, :_NUMBERS].reshape(-1, JOINT_COUNT, 3)
    poses = Poses.of(joints, status=np.array(statuses, np.str_))
    return replace(poses, misfit=values[:, -1])


def read_truth(path: str | Path) -> NDArray[np.float32]:
    """Poses [F,14,3] in metres, 42 numbers a line."""
    rows = []
    for line, text in _text_lines(Path(path).read_bytes()):
        try:
            row = _numbers(text)
        except ValueError as error:
            raise FileError(f"{path}:{line}: {error}") from None
        if len(row) != _NUMBERS:
            raise FileError(f"{path}:{line}: {len(row)} numbers, but a 3D pose has {_NUMBERS}")
        rows.append(row)
    return np.array(rows, np.float32).reshape(-1, JOINT_COUNT, 3)


def read_lines(data: bytes, format: str | None, as_json: bool) -> Lines:
    """Keypoints of a file's bytes; a bad line does not end it."""
    count = JOINT_COUNT if format is None else int(find_format(format).keypoints)
    read: Callable[[str, int, str], tuple[NDArray[np.float32], dict[str, Any] | None]]
    read = _keypoint_object if as_json else _keypoint_fields
    poses: list[NDArray[np.float32]] = []
    numbers: list[int] = []
    objects: list[dict[str, Any] | None] = []
    problems: dict[int, str] = {}
    for number, text in _text_lines(data):
        found: dict[str, Any] | None = None
        try:
            pose, found = read(text, count, format or _NO_FORMAT)
        except ValueError as error:
            problems[len(poses)] = str(error)
            pose = np.full((count, 3), np.nan, np.float32)
            found = _object_or_none(text) if as_json else None
        poses.append(pose)
        numbers.append(number)
        objects.append(found)
    keypoints = np.array(poses, np.float32).reshape(-1, count, 3)
    return Lines(keypoints, numbers, problems, objects)


def _text_lines(data: bytes) -> Iterator[tuple[int, str]]:
    """Number and text of the lines that are not skipped."""
    text = data.decode("utf-8-sig", errors="replace")
    for number, line in enumerate(text.split("\n"), 1):
        line = line.strip(" \t\r")
        if line and not line.startswith("#"):
            yield number, line


def _numbers(text: str) -> list[float]:
    """Numbers separated by commas or blanks."""
    numbers = []
    for n, field in enumerate(re.split(r"[ \t\r]*,[ \t\r]*|[ \t\r]+", text), 1):
        try:
            if "_" in field or not field.isascii():  # float() takes them
                raise ValueError
            numbers.append(float(field))
        except ValueError:
            message = f"field {n} is not a number (commas or blanks separate them)"
            raise ValueError(message) from None
    return numbers


def _keypoint_fields(text: str, count: int, name: str) -> tuple[NDArray[np.float32], None]:
    numbers = _numbers(text)
    if len(numbers) not in (2 * count, 3 * count):
        raise ValueError(
            f"{len(numbers)} numbers, but {name} has {2 * count} or {3 * count}{_hint(name)}"
        )
    with np.errstate(over="ignore"):
        pose = np.array(numbers).astype(np.float32).reshape(count, -1)
    return (np.insert(pose, 2, 1, axis=1) if pose.shape[1] == 2 else pose), None


def _hint(name: str) -> str:
    """What to try when the number of keypoints is wrong."""
    return "; a detector's keypoints need its format" if name == _NO_FORMAT else ""


def _object_or_none(text: str) -> dict[str, Any] | None:
    """The JSON object of a line, if it is one and its members leave room for the answer's."""
    try:
        found = _object(text)
    except ValueError:
        return None
    return None if found.keys() & set(_ANSWERS) else found


def _object(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise ValueError("not a JSON object in one line (NaN and Infinity are not JSON)")
    return found


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not JSON")


def _keypoint_object(
    text: str, count: int, name: str
) -> tuple[NDArray[np.float32], dict[str, Any]]:
    found = _object(text)
    for answer in _ANSWERS:
        if answer in found:
            raise ValueError(f'has a member "{answer}", which the answer adds: rename it')
    if "keypoints" not in found:
        raise ValueError('has no member "keypoints"')
    given = found["keypoints"]
    if given is None or given == []:
        return np.zeros((count, 3), np.float32), found  # nobody
    if not isinstance(given, list):
        raise ValueError("keypoints is not an array")
    if len(given) != count:
        raise ValueError(f"{len(given)} keypoints, but {name} has {count}{_hint(name)}")
    with np.errstate(over="ignore"):
        return np.array([_keypoint(n, k) for n, k in enumerate(given)]).astype(np.float32), found


def _keypoint(number: int, given: Any) -> list[float]:
    """x, y and c from null, [null, null], [x, y] or [x, y, c]."""
    if given is None:
        return [0.0, 0.0, 0.0]
    if isinstance(given, list) and len(given) in (2, 3):
        if given[:2] == [None, None]:
            return [0.0, 0.0, 0.0]
        if all(isinstance(v, int | float) and not isinstance(v, bool) for v in given):
            return [_float(v) for v in (*given, 1.0)[:3]]
    raise ValueError(f"keypoint {number} is not null, [x, y] or [x, y, c]")


def _float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:  # an integer of over 300 digits: as strtof() has it
        return math.inf if value > 0 else -math.inf


def _pose_fields(text: str) -> tuple[str, list[float]]:
    status, *fields = text.split(",")
    wanted = _NUMBERS + 1
    if len(fields) < wanted or not re.fullmatch(r"[a-z_]+", status):
        raise ValueError("not a pose as lift_stdin writes it: status and 43 numbers")
    if status != "ok":
        return status, [np.nan] * wanted
    return status, _numbers(",".join(fields[:wanted]))


def _pose_object(text: str) -> tuple[str, list[float]]:
    found = _object(text)
    status = found.get("status")
    if not isinstance(status, str):
        raise ValueError('has no member "status"')
    if status != "ok":
        return status, [np.nan] * (_NUMBERS + 1)
    try:
        joints = np.array(found["joints"], float).reshape(_NUMBERS)
        return status, [*joints, float(found["misfit"])]
    except (KeyError, TypeError, ValueError):
        raise ValueError("joints or misfit are missing or malformed") from None


# ---- Writing -----------------------------------------------------------------------------------


def write_poses(path: str | Path, poses: Poses, *, header: bool = False) -> None:
    """Writes poses, a line each, with six digits: what lift_stdin prints for them.

    header  names of the columns first; not for JSON lines
    """
    if is_json(path):
        if header:
            raise ValueError("header= is for CSV, not for JSON lines")
        lines: Iterable[str] = json_lines(poses)
    else:
        lines = csv_lines(poses, header)
    Path(path).write_text("".join(f"{line}\n" for line in lines), encoding="utf-8", newline="\n")


def csv_lines(poses: Poses, header: bool = False) -> Iterator[str]:
    """Lines of CSV, a pose each."""
    if header:
        yield HEADER
    poses, _ = batched(poses)
    for i, status in enumerate(poses.status):
        if status != "ok":
            yield status + "," * (_NUMBERS + 1)
            continue
        values = [*poses.joints[i].ravel(), poses.misfit[i]]
        yield ",".join([status, *(f"{value:.6g}" for value in values)])


def json_lines(
    poses: Poses, objects: Sequence[dict[str, Any] | None] | None = None
) -> Iterator[str]:
    """Lines of JSON, an object a pose, behind the members of the objects that were read."""
    poses, _ = batched(poses)
    for i, status in enumerate(poses.status):
        members = dict((objects[i] if objects else None) or {})
        members |= dict.fromkeys(_ANSWERS) | {"status": str(status)}
        if status == "ok":
            members["joints"] = [[_six(v) for v in joint] for joint in poses.joints[i]]
            members["misfit"] = _six(poses.misfit[i])
        text = json.dumps(members, separators=(",", ":"), ensure_ascii=False)
        # Half of a surrogate pair is JSON when escaped, but has no UTF-8.
        yield re.sub("[\ud800-\udfff]", lambda half: f"\\u{ord(half[0]):04x}", text)


def _six(value: np.float32) -> float:
    return float(f"{value:.6g}")
