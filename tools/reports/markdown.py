"""Tables that a tool writes into Markdown: between <!-- begin NAME --> and <!-- end NAME -->."""

import re
from pathlib import Path


def read(path: Path, name: str) -> str:
    """The text between the marks; ValueError if there are none."""
    return _find(path, name)[1]


def write(path: Path, name: str, table: str) -> None:
    """Replaces the text between the marks."""
    match = _find(path, name)
    text = match.string
    path.write_text(text[: match.start(1)] + table.strip("\n") + "\n" + text[match.end(1) :])


def write_those(path: Path, tables: dict[str, str]) -> None:
    """Writes the tables, by name, for which the file has marks; ValueError if it has none."""
    names = [name for name in tables if f"<!-- begin {name} -->" in path.read_text()]
    if not names:
        raise ValueError(f"{path}: no <!-- begin NAME --> with NAME of {', '.join(tables)}")
    for name in names:
        write(path, name, tables[name])


def _find(path: Path, name: str) -> re.Match:
    match = re.search(f"<!-- begin {name} -->\n(.*?)<!-- end {name} -->", path.read_text(), re.S)
    if not match:
        raise ValueError(f"{path}: no <!-- begin {name} --> ... <!-- end {name} -->")
    return match
