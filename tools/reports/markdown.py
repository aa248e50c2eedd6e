"""Markdown: tables of figures, and the marks in a page between which a tool writes them.

A page has <!-- begin NAME --> and <!-- end NAME --> around each text that a tool writes.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

Figure = float | int | str | list[float] | None


def cell(value: Figure) -> str:
    """A figure as text: a decimal for numbers, "low-high" for a list, nothing for None."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        return "-".join(f"{v:.0f}" for v in value)
    return str(value) if isinstance(value, int) else f"{value:.1f}"


def counted(value: Figure) -> str:
    """The same with commas between the thousands of an integer."""
    return f"{value:,}" if isinstance(value, int) else cell(value)


Rows = Mapping[str, Sequence[Figure]] | Iterable[tuple[str, Sequence[Figure]]]


def table(
    corner: str,
    columns: Sequence[str],
    rows: Rows,
    text: Callable[[Figure], str] = cell,
    left: int = 1,
) -> str:
    """A table with a title in front of each row.

    text  makes a cell of a figure; left: so many columns, the titles included, stand to the left
    """
    pairs = rows.items() if isinstance(rows, Mapping) else rows
    rule = "|---" * left + "|--:" * (len(columns) + 1 - left) + "|"
    lines = [f"| {corner} | " + " | ".join(columns) + " |", rule]
    lines += [f"| {title} | " + " | ".join(map(text, row)) + " |" for title, row in pairs]
    return "\n".join(lines) + "\n"


def signed(difference: float) -> str:
    """Two decimals and a sign, unless they are zeros."""
    text = f"{difference:+.2f}"
    return "0.00" if float(text) == 0 else text


def read(path: Path, name: str) -> str:
    """The text between the marks; ValueError if there are none."""
    return _find(path, name)[1]


def write(path: Path, name: str, text: str) -> None:
    """Replaces the text between the marks; ValueError if there are none."""
    match = _find(path, name)
    page = match.string
    path.write_text(page[: match.start(1)] + text.strip("\n") + "\n" + page[match.end(1) :])


def write_those(path: Path, texts: Mapping[str, str]) -> None:
    """Writes the texts, by name, for which the page has marks; ValueError if it has none."""
    names = [name for name in texts if f"<!-- begin {name} -->" in path.read_text()]
    if not names:
        raise ValueError(f"{path}: no <!-- begin NAME --> with NAME of {', '.join(texts)}")
    for name in names:
        write(path, name, texts[name])


def _find(path: Path, name: str) -> re.Match[str]:
    match = re.search(f"<!-- begin {name} -->\n(.*?)<!-- end {name} -->", path.read_text(), re.S)
    if not match:
        raise ValueError(f"{path}: no <!-- begin {name} --> ... <!-- end {name} -->")
    return match
