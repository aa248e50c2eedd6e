"""JSON values one behind another: lines of them, one document, or files put together.

What is malformed is one problem, named by the line where the value began, and reading goes on at
the next line; or, if the value began on an earlier line than that of the fault, at the next line
that begins with { or [.
"""

import json
import re
from collections.abc import Iterator
from typing import Any

Value = tuple[int, Any, str]  # number of the line where it began, what it is, what is wrong with it

DEPTH = 32  # of arrays and objects within each other: as many as lift_stdin reads
NOT_JSON = "not a JSON object or array (NaN and Infinity are not JSON)"
_NOT_UTF_8 = "not in UTF-8"
_BLANKS = re.compile(r"[ \t\r\n]*")
_NEXT_LINE = re.compile(r"[^\n]*\n?")
_NEXT_BRACKET = re.compile(r"^(?=[{\[])", re.MULTILINE)
_BAD_BYTE = re.compile("[\udc80-\udcff]")  # as errors="surrogateescape" has them
_CONSTANT_OR_BRACKET = re.compile(r'"(?:[^"\\]|\\.)*"|([][{}])|(-?Infinity|NaN)', re.DOTALL)


class Twice(dict[str, Any]):
    """An object that has a member of the same name twice, `name`."""

    name = ""


def read_values(data: bytes) -> Iterator[Value]:
    """The values of a text in UTF-8.  Lines between them that begin with # are skipped."""
    text = data.decode("utf-8", "surrogateescape").removeprefix("\ufeff")
    decoder = json.JSONDecoder(object_pairs_hook=_object, parse_constant=_no_constant)
    lines = _LineNumbers(text)
    at = _skip(text, 0)
    while at < len(text):
        number = lines.of(at)
        value, end, fault = _decode(decoder, text, at)
        if fault is None:
            yield number, value, ""
            at = _skip(text, end)
            continue
        place, problem = fault
        further = text.count("\n", at, place)
        where = f"; see line {number + further}" if further else ""
        yield number, None, f"{problem}{where}"
        at = _skip(text, _resume(text, at, place))


def _decode(
    decoder: json.JSONDecoder, text: str, at: int
) -> tuple[Any, int, tuple[int, str] | None]:
    """The value that begins at this place, its end, and where and what the fault is.

    It is looked for in the rest of the line, and then in more and more of the text.  What is wrong
    there is wrong if its line is whole: no text, number or word goes on in another line.  So a
    fault costs no more than what was read up to it.
    """
    if text[at] not in "{[n":
        return None, at, (at, NOT_JSON)
    end = _end_of_line(text, at)
    while True:
        window = text[at:end]
        value, size, fault = _decode_window(decoder, window)
        if fault is None or end == len(text) or window.find("\n", fault[0]) >= 0:
            break
        end = min(len(text), at + 8 * (end - at))
    return value, at + size, None if fault is None else (at + fault[0], fault[1])


def _decode_window(
    decoder: json.JSONDecoder, window: str
) -> tuple[Any, int, tuple[int, str] | None]:
    try:
        value, end = decoder.raw_decode(window)
    except json.JSONDecodeError as error:
        return None, 0, (error.pos, NOT_JSON)
    except (ValueError, RecursionError):  # of _no_constant(), or nested too deep
        return None, 0, (_place_of_fault(window), NOT_JSON)
    wrong = _BAD_BYTE.search(window, 0, end)
    return value, end, None if wrong is None else (wrong.start(), _NOT_UTF_8)


def _place_of_fault(window: str) -> int:
    """Where the first constant is, or where things are in DEPTH others."""
    depth = 0
    for match in _CONSTANT_OR_BRACKET.finditer(window):
        depth += {"[": 1, "{": 1, "]": -1, "}": -1}.get(match[1], 0)
        if match[2] or depth > DEPTH:
            return match.start()
    return 0


def _resume(text: str, began: int, fault: int) -> int:
    """Where to go on behind a fault."""
    if text.find("\n", began, fault) < 0:
        return _end_of_line(text, fault)
    line = text.rfind("\n", 0, fault) + 1
    found = _NEXT_BRACKET.search(text, line)
    return len(text) if found is None else found.start()


def _skip(text: str, at: int) -> int:
    """Behind blanks, and lines that begin with #."""
    while True:
        end = _end_of(_BLANKS, text, at)
        line_begins = end == 0 or "\n" in text[at:end] or at == 0 or text[at - 1] == "\n"
        if end == len(text) or text[end] != "#" or not line_begins:
            return end
        at = _end_of_line(text, end)


def _end_of_line(text: str, at: int) -> int:
    return _end_of(_NEXT_LINE, text, at)


def _end_of(pattern: re.Pattern[str], text: str, at: int) -> int:
    found = pattern.match(text, at)
    return at if found is None else found.end()


class _LineNumbers:
    """Numbers of lines, from 1, of ascending places in a text."""

    def __init__(self, text: str):
        self._text, self._at, self._number = text, 0, 1

    def of(self, at: int) -> int:
        self._number += self._text.count("\n", self._at, at)
        self._at = at
        return self._number


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) == len(pairs):
        return found
    twice, seen = Twice(found), set[str]()
    for name, _ in pairs:
        if name in seen:
            twice.name = name
            break
        seen.add(name)
    return twice


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not JSON")
