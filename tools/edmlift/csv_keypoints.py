"""Lines of numbers, with or without a heading that says which number is what."""

import re
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from edmlift.keypoint_sets import CONFIDENCES, count_of, names_of, wrong_count

_NOT_SEEN = ("", "null")
_SEPARATOR = re.compile(r"[ \t\r]*,[ \t\r]*|[ \t\r]+")


class HeadingError(ValueError):
    """A heading that does not say where the keypoints are."""


def text_lines(data: bytes) -> Iterator[tuple[int, str]]:
    """Number and text of the lines that are neither blank nor a comment, which begins with #."""
    text = data.decode("utf-8-sig", errors="replace")
    for number, line in enumerate(text.split("\n"), 1):
        line = line.strip(" \t\r")
        if line and not line.startswith("#"):
            yield number, line


def read_numbers(text: str, *, missing: bool = False) -> list[float]:
    """Numbers separated by commas or blanks; blank and null fields, if they may be, are NaN."""
    return [_number(n, field, missing) for n, field in enumerate(re.split(_SEPARATOR, text), 1)]


def _number(n: int, field: str, missing: bool) -> float:
    if missing and field.lower() in _NOT_SEEN:
        return np.nan
    try:
        if "_" in field or not field.isascii():  # float() takes them
            raise ValueError
        return float(field)
    except ValueError:
        message = f"field {n} is not a number (commas or blanks separate them)"
        raise ValueError(message) from None


class Columns:
    """Where the numbers of a keypoint are in a line: one behind another, or as a heading says."""

    def __init__(self, format: str | None):
        self._format, self._count = format, count_of(format)
        self._fields = 0  # of a line, when there was a heading
        self._where: list[list[int]] = []  # the fields of each keypoint

    def take_heading(self, text: str) -> bool:
        """Is this, the first line, a heading?  HeadingError if its names are not known."""
        names = [name.strip().strip('"').lower() for name in text.split(",")]
        first = next((field for field in re.split(_SEPARATOR, text) if field), "")
        try:  # pandas names no column of its index
            _number(1, first, True)
            return False
        except ValueError:
            pass
        if len(names) == 1:
            names = names[0].split()
        if len(names) < 2 * self._count:  # words, but no heading of lines that could be read
            return False
        if names[0] == "status":
            raise HeadingError("poses, not keypoints: they are lifted already")
        where = find_columns(names, self._format)
        if where is None:
            raise HeadingError(f"a heading that does not name all {known_columns(self._format)}")
        self._fields, self._where = len(names), where
        return True

    def read(self, text: str) -> NDArray[np.float32]:
        """Keypoints [K,3] of a line; NaN for what was not seen."""
        numbers = self._by_heading(text) if self._where else self._by_place(text)
        with np.errstate(over="ignore"):
            points = np.array(numbers).astype(np.float32).reshape(self._count, -1)
        return np.insert(points, 2, 1, axis=1) if points.shape[1] == 2 else points

    def _by_place(self, text: str) -> list[float]:
        numbers, count = read_numbers(text, missing=True), self._count
        if len(numbers) in (2 * count, 3 * count):
            return numbers
        raise ValueError(
            wrong_count(
                f"{len(numbers)} numbers", f"{2 * count} or {3 * count}", len(numbers) / 3,
                self._format,
            )
        )  # fmt: skip

    def _by_heading(self, text: str) -> list[float]:
        fields = [field.strip() for field in text.split(",")]
        if len(fields) == 1:
            fields = text.split()
        if len(fields) != self._fields:
            raise ValueError(f"{len(fields)} fields, but the heading has {self._fields}")
        return [_number(n + 1, fields[n], True) for point in self._where for n in point]


def find_columns(names: Sequence[str], format: str | None) -> list[list[int]] | None:
    """Which of these names, in lower case, are x, y and, where there is one, c of each keypoint;
    None: not all are there."""
    numbers = [str(number) for number in range(count_of(format))]
    every = (_find(names, known) for known in (numbers, names_of(format)) if known is not None)
    return next((where for where in every if where is not None), None)


def known_columns(format: str | None) -> str:
    """What columns of keypoints are called, for a message."""
    names, last = names_of(format), count_of(format) - 1
    named = "" if names is None else f"; or {names[0]}_x,{names[0]}_y,{names[0]}_score ..., of "
    return (
        f"keypoints of {format or 'a pose'}: known are "
        f"x0,y0,c0 ... x{last},y{last},c{last}{named}{', '.join(names or ())}"
    )


def _find(names: Sequence[str], known: Sequence[str]) -> list[list[int]] | None:
    """The same; keypoints are known by a number, written without an underscore, or a name."""
    where = []
    for name in known:
        x, y, *confidences = (
            _places(names, name, endings) for endings in (("x",), ("y",), CONFIDENCES)
        )
        if len(x) != 1 or len(y) != 1 or len(confidences[0]) > 1:
            return None
        where.append([*x, *y, *confidences[0]])
    return where if len({len(fields) for fields in where}) == 1 else None


def _places(names: Sequence[str], name: str, endings: tuple[str, ...]) -> list[int]:
    wanted = {f"{ending}{name}" if name.isdigit() else f"{name}_{ending}" for ending in endings}
    return [place for place, found in enumerate(names) if found in wanted]
