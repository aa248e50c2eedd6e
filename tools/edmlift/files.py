"""Keypoints and poses in files, a line each: what lift_stdin reads and writes.

Keypoints are x,y or x,y,c of each, separated by commas or blanks; or JSON as detectors write it
(docs/detectors.md).  Poses are status,x0,y0,z0,...,x13,y13,z13,misfit; or objects with "status",
"joints" and "misfit".  Blank lines and those that start with # are skipped.  A name that ends in
.jsonl, .ndjson or .json holds JSON.
"""

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from edmlift._binding import JOINT_COUNT
from edmlift.csv_keypoints import read_numbers, text_lines
from edmlift.keypoint_files import ANSWERS, FileError, is_json, read_source
from edmlift.lifting import Poses, batched

_NUMBERS = 3 * JOINT_COUNT
_COLUMNS = ("status", *(f"{axis}{j}" for j in range(JOINT_COUNT) for axis in "xyz"))
HEADER = ",".join((*_COLUMNS, "misfit"))


# ---- Reading -----------------------------------------------------------------------------------


def read_keypoints(
    path: str | Path, format: str | None = None, *, bad_lines: Literal["raise", "nan"] = "raise"
) -> NDArray[np.float32]:
    """Keypoints [F,K,3] of a file, or of a folder of JSON files: x, y and confidence, 1 where the
    file has none.  `read_detections` says whose they are, too.

    format     what one line holds: a detector's keypoints, or by default the 14 joints
    bad_lines  "raise" FileError, or make the pose "nan", which a lift takes for one without joints

    A keypoint that is null in JSON has confidence 0; a frame without people has only such.
    """
    if bad_lines not in ("raise", "nan"):
        raise ValueError(f"bad_lines must be 'raise' or 'nan', not {bad_lines!r}")
    lines = read_source(path, format)
    if bad_lines == "raise":
        lines.raise_problem()
    return lines.keypoints


def read_poses(path: str | Path) -> Poses:
    """Lifted poses of a file, with or without a header; further columns are left out.

    Where they were seen is not in the file: their keypoints are NaN.
    """
    statuses: list[str] = []
    numbers: list[list[float]] = []
    for line, text in text_lines(Path(path).read_bytes()):
        if not numbers and text.startswith("status,"):
            continue
        try:
            status, pose = (_pose_object if is_json(path) else _pose_fields)(text)
        except ValueError as error:
            raise FileError(f"{path}:{line}: {error}") from None
        statuses.append(status)
        numbers.append(pose)
    values = _float32(numbers).reshape(-1, _NUMBERS + 1)
    joints = values[:, :_NUMBERS].reshape(-1, JOINT_COUNT, 3)
    poses = Poses.of(joints, status=np.array(statuses, np.str_))
    return replace(poses, misfit=values[:, -1])


def read_truth(path: str | Path) -> NDArray[np.float32]:
    """Poses [F,14,3] in metres, 42 numbers a line."""
    rows = []
    for line, text in text_lines(Path(path).read_bytes()):
        try:
            row = read_numbers(text)
        except ValueError as error:
            raise FileError(f"{path}:{line}: {error}") from None
        if len(row) != _NUMBERS:
            raise FileError(f"{path}:{line}: {len(row)} numbers, but a 3D pose has {_NUMBERS}")
        rows.append(row)
    return _float32(rows).reshape(-1, JOINT_COUNT, 3)


def _float32(numbers: list[list[float]]) -> NDArray[np.float32]:
    """Numbers of a file; what is too large for float32 is infinite."""
    with np.errstate(over="ignore"):
        return np.array(numbers, np.float32)


def _object(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise ValueError("not a JSON object in one line")
    return found


def _pose_fields(text: str) -> tuple[str, list[float]]:
    status, *fields = text.split(",")
    wanted = _NUMBERS + 1
    if len(fields) < wanted or not re.fullmatch(r"[a-z_]+", status):
        raise ValueError("not a pose as lift_stdin writes it: status and 43 numbers")
    if status != "ok":
        return status, [np.nan] * wanted
    return status, read_numbers(",".join(fields[:wanted]))


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
        members |= dict.fromkeys(ANSWERS) | {"status": str(status)}
        if status == "ok":
            members["joints"] = [[_six(v) for v in joint] for joint in poses.joints[i]]
            members["misfit"] = _six(poses.misfit[i])
        text = json.dumps(members, separators=(",", ":"), ensure_ascii=False)
        # Half of a surrogate pair is JSON when escaped, but has no UTF-8.
        yield re.sub("[\ud800-\udfff]", lambda half: f"\\u{ord(half[0]):04x}", text)


def _six(value: np.float32) -> float:
    return float(f"{value:.6g}")
