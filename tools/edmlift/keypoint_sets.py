"""Keypoint sets as detectors write them, to arrays; and the names of keypoints."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edmlift._binding import JOINT_COUNT
from edmlift.formats import find_format, formats_with
from edmlift.joints import JOINTS
from edmlift.people import is_number, is_set_of_lists

CONFIDENCES = ("score", "confidence", "visibility", "visible", "c")  # names of a confidence
_NOWHERE = (0.0, 0.0, 0.0)
_Point = tuple[float, float, float]
_SIDES = ("left", "right")
_LIMBS = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")


def _sides(*parts: str) -> tuple[str, ...]:
    return tuple(f"{side}_{part}" for part in parts for side in _SIDES)


_COCO = ("nose", *_sides("eye", "ear", *_LIMBS))
_EYES = tuple(f"{side}_eye{part}" for side in _SIDES for part in ("_inner", "", "_outer"))
_BLAZEPOSE = (
    "nose", *_EYES, *_sides("ear"), "mouth_left", "mouth_right", *_sides(*_LIMBS[:3]),
    *_sides("pinky", "index", "thumb"), *_sides(*_LIMBS[3:]), *_sides("heel", "foot_index"),
)  # fmt: skip
# The names of a format's keypoints in its order, as TensorFlow.js has them.
KEYPOINT_NAMES = {"coco17": _COCO, "movenet17": _COCO, "blazepose33": _BLAZEPOSE}


def names_of(format: str | None) -> tuple[str, ...] | None:
    """The names of the keypoints of a format, or of the 14 joints; None: not known."""
    return JOINTS if format is None else KEYPOINT_NAMES.get(format)


def count_of(format: str | None) -> int:
    """How many keypoints a person has."""
    return JOINT_COUNT if format is None else int(find_format(format).keypoints)


def wrong_count(found: str, wanted: str, count: float, format: str | None) -> str:
    """What is said of a wrong number of keypoints, of which there are perhaps `count`."""
    others = formats_with(int(count)) if count == int(count) else []
    hint = f"; formats with {int(count)} keypoints: {', '.join(others)}: name one" if others else ""
    if not hint and format is None:
        hint = "; a detector's keypoints need its format"
    return f"{found}, but {format or 'a pose'} has {wanted}{hint}"


def read_set(points: Any, scores: Any, format: str | None) -> NDArray[np.float32]:
    """A keypoint set as [K,3]: x, y and confidence, 0 for what is null.  ValueError: what is
    wrong with it."""
    if is_set_of_lists(points):
        points = _from_lists(points)
    if not isinstance(points, list):
        raise ValueError("keypoints is not an array")
    count = count_of(format)
    if all(is_number(value) or value is None for value in points) and any(map(is_number, points)):
        points = _from_flat(points, count, format)
    if len(points) != count:
        raise ValueError(wrong_count(f"{len(points)} keypoints", f"{count}", len(points), format))
    found = [_keypoint(number, point) for number, point in enumerate(points)]
    if scores is not None:
        found = _with_scores(found, scores)
    with np.errstate(over="ignore"):
        array = np.array(found).astype(np.float32)
    order = _order(points, names_of(format), format)
    return array if order is None else array[order]


def _from_lists(points: dict[str, Any]) -> list[Any]:
    """Keypoints from {"x": [...], "y": [...], "visible": [...]}."""
    name = next((name for name in CONFIDENCES if name in points), None)
    columns = [points["x"], points["y"], *([] if name is None else [points[name]])]
    if not all(isinstance(column, list) and len(column) == len(columns[0]) for column in columns):
        raise ValueError("the lists of x, y and confidences differ in length")
    return [list(point) for point in zip(*columns, strict=True)]


def _from_flat(numbers: list[Any], count: int, format: str | None) -> list[Any]:
    """Keypoints from x, y, c, x, y, c ... or x, y, x, y ..."""
    each, rest = divmod(len(numbers), count)
    if each not in (2, 3) or rest:
        found = f"{len(numbers)} numbers"
        raise ValueError(
            wrong_count(found, f"{2 * count} or {3 * count}", len(numbers) / 3, format)
        )
    return [numbers[n : n + each] for n in range(0, len(numbers), each)]


def _keypoint(number: int, given: Any) -> _Point:
    """x, y and c from null, [null, null], [x, y], [x, y, c] or an object."""
    if given is None:
        return _NOWHERE
    values = given
    if isinstance(given, dict):
        name = next((name for name in CONFIDENCES if name in given), None)
        values = [given.get("x", ""), given.get("y", ""), *([given[name]] if name else [])]
    if isinstance(values, list) and len(values) in (2, 3):
        if values[0] is None and values[1] is None:
            return _NOWHERE
        if all(map(is_number, values)):
            x, y, c = map(_float, (*values, 1.0)[:3])
            return x, y, c
    raise ValueError(f"keypoint {number} is not null, [x, y], [x, y, c] or an object with x and y")


def _float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:  # an integer of over 300 digits: as strtof() has it
        return math.inf if value > 0 else -math.inf


def _with_scores(points: list[_Point], scores: Any) -> list[_Point]:
    """With the confidences that stand beside them; a third number is z then."""
    if not isinstance(scores, list) or not all(map(is_number, scores)):
        raise ValueError("keypoint_scores is not an array of numbers")
    if len(scores) != len(points):
        raise ValueError(f"{len(scores)} keypoint_scores of {len(points)} keypoints")
    pairs = zip(points, scores, strict=True)
    return [p if p is _NOWHERE else (p[0], p[1], _float(score)) for p, score in pairs]


def _order(
    points: list[Any], names: tuple[str, ...] | None, format: str | None
) -> list[int] | None:
    """Which of the points each keypoint of the format is, by their names; None: they have none."""
    given = [point.get("name") if isinstance(point, dict) else None for point in points]
    if names is None or all(name is None for name in given):
        return None
    what = format or "a pose"
    for number, name in enumerate(given):
        if name is None:
            raise ValueError(f"keypoint {number} has no name, but others have")
        if name not in names:
            raise ValueError(f"{what} has no keypoint named {name!r}; it has {', '.join(names)}")
        if given.index(name) != number:
            raise ValueError(f"two keypoints are named {name!r}")
    return [given.index(name) for name in names]
