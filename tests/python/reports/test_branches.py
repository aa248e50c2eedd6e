"""Branches that no C test takes: what of gcovr's counts and of the arguments does not agree."""

import json
from collections import Counter
from pathlib import Path

import pytest

from data.paths import DOCS, ROOT
from reports import branches, markdown
from reports.branches import Argument

FILE = "lib/network/checksum.h"
TEXT = (ROOT / FILE).read_text("utf-8").splitlines()
FLIP = next(n for n, line in enumerate(TEXT, 1) if "size_t flip" in line)
LINE = TEXT[FLIP - 1].strip()
ARGUED = Argument(FILE, LINE, 1, "a machine of another order of bytes")


def coverage(*counts: int) -> dict:
    """As of gcovr, of one line's branches."""
    line = {"line_number": FLIP, "count": 1, "branches": [{"count": n} for n in counts]}
    comment = {"line_number": 1, "count": 0}
    return {"files": [{"file": FILE, "lines": [comment, line]}]}


def compared(counts: tuple[int, ...], *argued: Argument) -> list[str]:
    return branches.compare(branches.untaken(coverage(*counts)), argued)


def test_what_is_taken_or_argued_is_right() -> None:
    assert compared((7, 1)) == []
    assert compared((7, 0), ARGUED) == []


def test_a_branch_that_is_neither_is_said() -> None:
    assert compared((0, 7)) == [f"{FILE}: 1 branches are not taken, 0 are argued: {LINE}"]
    assert compared((0, 0), ARGUED) == [f"{FILE}: 2 branches are not taken, 1 are argued: {LINE}"]


def test_an_argument_whose_branch_is_taken_is_said() -> None:
    assert compared((7, 1), ARGUED) == [f"{FILE}: 0 branches are not taken, 1 are argued: {LINE}"]


def test_an_argument_whose_line_is_gone_is_said() -> None:
    gone = ARGUED._replace(line="const size_t flip = 0;")
    assert compared((7, 1), gone) == [
        f"{FILE}: there is no such line, 1 are argued: const size_t flip = 0;"
    ]
    nowhere = ARGUED._replace(file="lib/nowhere.h")
    assert "there is no such line" in compared((7, 1), nowhere)[0]


def test_the_program_fails_where_they_do_not_agree(tmp_path: Path, monkeypatch, capsys) -> None:
    found = tmp_path / "coverage.json"
    assert branches.main([str(found)]) == 1
    assert "there is no" in capsys.readouterr().err
    found.write_text(json.dumps(coverage(7, 0)))
    monkeypatch.setattr(branches, "arguments", lambda: [ARGUED])
    assert branches.main([str(found)]) == 0
    assert "all are taken but 1" in capsys.readouterr().out
    found.write_text(json.dumps(coverage(7, 1)))
    assert branches.main([str(found), "--update"]) == 1  # and writes nothing
    assert "tests/coverage/argued.toml" in capsys.readouterr().err


def test_the_tables_of_a_run() -> None:
    assert "| `lib/network` | 2 | 1 | 1 |\n| all | 2 | 1 | 1 |" in branches.count_table(
        coverage(7, 0)
    )
    assert "a \\|\\| b" in branches.argued_table([ARGUED._replace(line="a || b")])


def test_each_argued_line_is_there_once() -> None:
    argued = branches.arguments()
    assert argued and set(Counter(one.place for one in argued).values()) == {1}
    for one in argued:
        assert one.line in branches.lines_of(one.file), one.place
        assert one.untaken > 0 and one.reason


@pytest.mark.claims("docs/coverage.md", "branches_argued")
def test_the_table_is_the_pages() -> None:
    table = branches.argued_table(branches.arguments())
    assert markdown.read(DOCS / "coverage.md", "branches_argued").strip() == table.strip()
