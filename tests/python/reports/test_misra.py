"""The table of MISRA's rules has the library's counts, and a reason for each."""

from collections import Counter

import pytest
from builds import need

from data.paths import LIB
from reports import markdown, misra
from reports.command import Disagreement

FOLDERS = ("joints", "number")  # whose sources take seconds, and not minutes


@pytest.mark.claims("docs/misra.md", "misra")
@pytest.mark.slow
def test_the_table_has_the_counts():
    need("cppcheck")
    sources = [path for path in misra.SOURCES if path.parent.name in FOLDERS]
    misra.check(misra.count(sources), FOLDERS)


def test_each_rule_of_the_table_has_a_reason_and_the_other_way_round():
    assert set(misra.read_table(markdown.read(misra.PAGE, "misra"))) == set(misra.DEVIATIONS)


def test_a_table_is_read_as_it_was_written():
    counts = {"10.1": Counter(lift=2, number=1), "2.7": Counter(network=4)}
    text = misra.misra_table(counts)
    assert [line.split("|")[1].strip() for line in text.splitlines()[2:]] == ["2.7", "10.1"]
    assert misra.read_table(text) == counts


def test_another_count_is_found():
    written = misra.read_table(markdown.read(misra.PAGE, "misra"))
    misra.check(written)
    with pytest.raises(Disagreement, match=r"rule 10\.1 in lift: written \d+, found \d+"):
        misra.check(written | {"10.1": written["10.1"] + Counter(lift=1)})


def test_a_rule_without_a_reason_is_an_error(monkeypatch: pytest.MonkeyPatch):
    need("cppcheck")
    monkeypatch.delitem(misra.DEVIATIONS, "20.5")
    with pytest.raises(Disagreement, match=r"rules 20\.5 have no reason: .*status\.c"):
        misra.count([LIB / "joints" / "status.c"])
