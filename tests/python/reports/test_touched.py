"""How many files a change touches: the table of docs/how-it-works.md."""

import pytest

from data.paths import DOCS
from reports import markdown, touched


def test_the_files_of_a_change_are_there():
    assert touched.missing() == []


@pytest.mark.claims("docs/how-it-works.md", "files_touched")
def test_the_table_is_the_pages():
    assert markdown.read(DOCS / "how-it-works.md", "files_touched").strip() == touched.table()


def test_a_file_that_is_gone_is_said(monkeypatch, capsys):
    gone = {"a change": {"library": ([], ["lib/nowhere.c"])}}
    monkeypatch.setattr(touched, "NOW", gone)
    assert touched.main([]) == 1
    assert "lib/nowhere.c" in capsys.readouterr().err
