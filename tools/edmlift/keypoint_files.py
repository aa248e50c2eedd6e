"""Keypoints in files: lines of numbers, or JSON as detectors write it, in one file or a folder."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edmlift.csv_keypoints import Columns, HeadingError, text_lines
from edmlift.formats import BY_IMAGE, BY_SQUARE, find_format
from edmlift.json_values import Value, read_values
from edmlift.keypoint_sets import count_of, read_set
from edmlift.keypoints import look_like_pixels
from edmlift.messages import OneLineError
from edmlift.people import Frame, Person, find_frames, is_one_person

JSON_SUFFIXES = (".jsonl", ".ndjson", ".json")
BAD_LINE = "bad_line"  # the status of what cannot be read
NOBODY = "nobody"  # the status of a frame without people
PIXELS = "keypoints of this format are normalised, 0 to 1; these look like pixels"
ANSWERS = ("status", "joints", "misfit")


class FileError(OneLineError, ValueError):
    """A file that does not hold what it should: its name, the line, and what is wrong with it."""


@dataclass(frozen=True)
class Lines:
    """What is to be answered: people, frames without any, and what cannot be read."""

    keypoints: NDArray[np.float32]  # [A,K,3] x, y and confidence; NaN where it cannot be read
    frames: Sequence[int]  # [A] from 0
    numbers: Sequence[int]  # [A] of the lines where they, or a JSON value with them, begin, from 1
    problems: dict[int, str] = field(default_factory=dict)  # what is wrong, by index
    nobody: frozenset[int] = frozenset()  # indices of the frames without people
    objects: Sequence[dict[str, Any]] = ()  # [A] JSON alone: the members for the answer
    listed: Sequence[bool] = ()  # [A] JSON alone: in a list of people, and not a value of its own
    sources: Sequence[str] = ()  # [A] names of their files

    def where(self, index: int) -> str:
        """FILE:LINE of what is answered."""
        return f"{self.sources[index]}:{self.numbers[index]}"

    def raise_problem(self) -> None:
        """FileError that says the first thing that is wrong."""
        for index, problem in sorted(self.problems.items()):
            raise FileError(f"{self.where(index)}: {problem}")

    def statuses(self, lifted: NDArray[np.str_]) -> NDArray[np.str_]:
        """The statuses [A] of the lift, but for what holds no person."""
        every = np.arange(len(self.numbers))
        known = np.where(np.isin(every, list(self.nobody)), NOBODY, lifted)
        found: NDArray[np.str_] = np.where(np.isin(every, list(self.problems)), BAD_LINE, known)
        return found


def is_json(path: str | Path) -> bool:
    """Does a file of this name hold JSON, or is it a folder?"""
    return Path(path).suffix.lower() in JSON_SUFFIXES or Path(path).is_dir()


def read_source(path: str | Path, format: str | None, as_json: bool | None = None) -> Lines:
    """The lines of a file, or of the JSON files of a folder in the order of their names."""
    path = Path(path)
    if not path.is_dir():
        known = is_json(path) if as_json is None else as_json
        return read_lines(path.read_bytes(), format, known, str(path))
    found = sorted(p for p in path.iterdir() if p.suffix.lower() in JSON_SUFFIXES and p.is_file())
    if not found:
        raise FileError(f"{path}: a folder without files that end in {', '.join(JSON_SUFFIXES)}")
    parts = _Parts(format)
    for file in found:
        for value in read_values(file.read_bytes()):
            parts.add_value(value, str(file))
    return parts.lines()


def read_lines(data: bytes, format: str | None, as_json: bool, name: str = "") -> Lines:
    """What a file's bytes hold; what cannot be read does not end it."""
    parts = _Parts(format)
    if as_json:
        for value in read_values(data):
            parts.add_value(value, name)
        return parts.lines()
    columns = Columns(format)
    for index, (number, text) in enumerate(text_lines(data)):
        try:
            if index > 0 or not columns.take_heading(text):
                parts.add_line(number, name, columns, text)
        except HeadingError as error:
            raise FileError(f"{name}:{number}: {error}") from None
    return replace(parts.lines(), objects=(), listed=())


def read_objects(objects: Any, format: str | None) -> Lines:
    """What a detector's objects in memory hold: dictionaries and lists, arrays as well."""
    parts = _Parts(format)
    parts.add_value((1, _plain(objects), ""), "")
    return parts.lines()


def _plain(value: Any) -> Any:
    """As JSON would have it: tuples and arrays as lists, NumPy's numbers as Python's."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, dict):
        return {str(name): _plain(member) for name, member in value.items()}
    return [_plain(element) for element in value] if isinstance(value, list | tuple) else value


class _Parts:
    """Lines, as they come."""

    def __init__(self, format: str | None):
        self._format, self._count = format, count_of(format)
        layout = None if format is None else find_format(format)
        self._shares = layout is not None and layout.normalised in (BY_IMAGE, BY_SQUARE)
        self._points: list[NDArray[np.float32]] = []
        self._of_frame: list[int] = []
        self._numbers: list[int] = []
        self._objects: list[dict[str, Any]] = []
        self._sources: list[str] = []
        self._listed: list[bool] = []
        self._problems: dict[int, str] = {}
        self._nobody: set[int] = set()
        self._frames = 0

    def add_line(self, number: int, name: str, columns: Columns, text: str) -> None:
        """A person from a line of numbers."""
        points, problem = None, ""
        try:
            points = columns.read(text)
        except ValueError as error:
            problem = str(error)
        self._add(points, number, {}, name, problem)
        self._frames += 1

    def add_value(self, value: Value, name: str) -> None:
        """The frames of a JSON value."""
        number, given, problem = value
        try:
            frames = list(find_frames(given))
        except RecursionError:
            frames, problem = [], "nested too deep"
        if problem:
            frames = [Frame([Person({}, problem=problem)])]
        several = sum(len(frame.people) for frame in frames) > 1
        listed = not is_one_person(given)
        for n, frame in enumerate(frames):
            for i, person in enumerate(frame.people):
                where = f"frame {n}, person {i}: " if several else ""
                self._add_person(person, number, name, where)
                self._listed.append(listed)
            self._frames += 1

    def _add_person(self, person: Person, number: int, name: str, where: str) -> None:
        members, problem, points = person.members, person.problem, None
        answer = next((answer for answer in ANSWERS if answer in members), None)
        if answer is not None:
            problem = problem or f'has a member "{answer}", which the answer adds: rename it'
            members = {name: value for name, value in members.items() if name not in ANSWERS}
        if not problem and person.points is None:
            self._nobody.add(len(self._points))
            points = np.zeros((self._count, 3), np.float32)
        elif not problem:
            try:
                points = read_set(person.points, person.scores, self._format)
            except ValueError as error:
                problem = str(error)
        self._add(points, number, members, name, problem and where + problem)

    def _add(
        self, points: NDArray[np.float32] | None, number: int, members: dict[str, Any], name: str,
        problem: str,
    ) -> None:  # fmt: skip
        if points is not None and self._shares and look_like_pixels(points):
            points = None
            problem = PIXELS
        if points is None:
            self._problems[len(self._points)] = problem
            points = np.full((self._count, 3), np.nan, np.float32)
        self._points.append(points)
        self._of_frame.append(self._frames)
        self._numbers.append(number)
        self._objects.append(members)
        self._sources.append(name)

    def lines(self) -> Lines:
        """All of them."""
        keypoints = np.array(self._points, np.float32).reshape(-1, self._count, 3)
        return Lines(
            keypoints, self._of_frame, self._numbers, self._problems, frozenset(self._nobody),
            self._objects, self._listed, self._sources,
        )  # fmt: skip
