"""Where the people are in what detectors write, as parsed from JSON or as objects in memory.

A frame is an object with people in an array; a person is an object with a keypoint set, or a bare
keypoint set.  docs/detectors.md has the table of what is known.  An array tells what it is by its
first element that is not null.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from edmlift.json_values import NOT_JSON, Twice

PERSON_NAMES = (
    "keypoints", "pose_keypoints_2d", "landmarks", "landmark", "poseLandmarks", "pose_landmarks",
)  # fmt: skip
FRAME_NAMES = ("people", "instances", "poses", "predictions", "annotations")
FRAMES_NAME = "instance_info"
SCORES_NAME = "keypoint_scores"
FRAME_KEYS = ("image_id", "frame_id", "frame", "t")  # which frame a person of an array is of


@dataclass(frozen=True)
class Person:
    """Somebody who was found; or nobody, or what could not be read."""

    members: dict[str, Any]  # for the answer
    points: Any = None  # a keypoint set; None: nobody
    scores: Any = None  # the confidences, where they stand beside it
    problem: str = ""  # what is wrong here


@dataclass
class Frame:
    """The people of a frame; if there are none, nobody, with the members of the frame."""

    people: list[Person] = field(default_factory=list)
    key: Any = None  # what the people of an array have in common


def is_one_person(value: Any) -> bool:
    """Is this one person, and neither a frame nor several people?"""
    if isinstance(value, dict):
        names = _names(value)
        return not names or (names[0] in PERSON_NAMES and not _is_several(value[names[0]]))
    return not isinstance(value, list) or (bool(value) and not _is_people(value))


def find_frames(value: Any) -> Iterator[Frame]:
    """The frames of a value, in its order."""
    if value is None:
        yield Frame([Person({})])
    elif isinstance(value, list):
        yield from _frames_of_array(value, {})
    elif isinstance(value, dict):
        yield from _frames_of_object(value, {})
    else:
        yield Frame([Person({}, problem=NOT_JSON)])


def is_scalar(value: Any) -> bool:
    """A number, a string, a boolean or null."""
    return value is None or isinstance(value, str | int | float)


def is_set_of_lists(value: Any) -> bool:
    """{"x": [...], "y": [...]} and perhaps "visible"."""
    return isinstance(value, dict) and all(isinstance(value.get(axis), list) for axis in "xy")


def is_number(value: Any) -> bool:
    """A number of JSON, which a boolean is not."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_people(array: list[Any]) -> bool:
    """Is this an array of people or frames, and not a keypoint set?"""
    first = next((value for value in array if value is not None), None)
    if isinstance(first, dict):
        return bool(_names(first)) or not is_scalar(first.get("x", []))
    if isinstance(first, list):
        numbers = all(value is None or is_number(value) for value in first)
        return not (numbers and len(first) in (2, 3))
    return not array


def _names(value: dict[str, Any]) -> list[str]:
    """The members of an object that hold people."""
    return [
        name
        for name, member in value.items()
        if name in PERSON_NAMES
        or (name in FRAME_NAMES and (member is None or isinstance(member, list)))
        or (name == FRAMES_NAME and isinstance(member, list))
    ]


def _frames_of_object(value: dict[str, Any], head: dict[str, Any]) -> Iterator[Frame]:
    names = _names(value)
    if isinstance(value, Twice) and value.name in (*names, SCORES_NAME):
        yield Frame([Person(head | value, problem=f"has {value.name} twice")], _key(value))
    elif len(names) > 1:
        problem = f'has "{names[0]}" and "{names[1]}": which are the people?'
        yield Frame([Person(head | value, problem=problem)], _key(value))
    elif names and (names[0] not in PERSON_NAMES or _is_several(value[names[0]])):
        yield from _frames_of_member(value, names[0])
    else:
        yield Frame([_person(value, head)], _key(value))


def _is_several(points: Any) -> bool:
    """Does the member of a person hold several keypoint sets?"""
    return isinstance(points, list) and len(points) > 0 and _is_people(points)


def _frames_of_member(value: dict[str, Any], name: str) -> Iterator[Frame]:
    """Of an object that is a frame, or holds frames."""
    head: dict[str, Any] = {}
    for before, member in value.items():
        if before == name:
            break
        if is_scalar(member):
            head[before] = member
    if SCORES_NAME in value:
        problem = f"has {SCORES_NAME} beside several people: each needs its own"
        yield Frame([Person(head, problem=problem)])
        return
    yield from _frames_of_array(value[name] or [], {} if name == FRAMES_NAME else head)


def _frames_of_array(array: list[Any], head: dict[str, Any]) -> Iterator[Frame]:
    """Of people or frames, or of one person's keypoints.  People with the same key, one behind
    another, are a frame; so are those without one."""
    if not array:
        yield Frame([Person(head)])
        return
    if not _is_people(array):
        yield Frame([_bare(array, head)])
        return
    group: Frame | None = None
    for element in array:
        frames = list(_frames_of_element(element, head))
        alone = len(frames) == 1 and is_one_person(element)
        if group is not None and alone and frames[0].key == group.key:
            group.people += frames[0].people
            continue
        if group is not None:
            yield group
        group = frames[0] if alone else None
        if not alone:
            yield from frames
    if group is not None:
        yield group


def _frames_of_element(element: Any, head: dict[str, Any]) -> Iterator[Frame]:
    if isinstance(element, dict):
        yield from _frames_of_object(element, head)
    elif isinstance(element, list):
        yield from _frames_of_array(element, head)
    else:
        yield Frame([Person(head, problem="not a person: an object or an array is")])


def _key(value: dict[str, Any]) -> Any:
    """What tells the frame of a person: a member's name and value, or None."""
    return next(((name, value[name]) for name in FRAME_KEYS if name in value), None)


def _bare(points: Any, head: dict[str, Any]) -> Person:
    return Person(head | {"keypoints": points}, points)


def _person(value: dict[str, Any], head: dict[str, Any]) -> Person:
    """A person from an object that holds one keypoint set at most."""
    members = {name: head[name] for name in head if name not in value} | value
    name = next(iter(_names(value)), None)
    if name is None:
        if is_set_of_lists(value):
            return _bare(value, head)
        return Person(members, problem='has no member "keypoints"')
    points = value[name]
    if points is None or points == []:
        return Person(members)
    return Person(members, points, value.get(SCORES_NAME))
