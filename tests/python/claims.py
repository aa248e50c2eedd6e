"""Which figures of the pages a run did not check, by name: hooks of pytest, which conftest.py has.

A test that compares figures with what is measured says which, by a file and the names of tables, or
of constants, in it:

    @pytest.mark.claims("docs/body.md", "sizes", "partial")

It fails where it reads none of these tables.  What tests claim that were skipped, or left out by
their marks, is listed at the end of a run, and what no test can compare.
"""

from collections import defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

from reports import markdown

ROOT = Path(__file__).resolve().parents[2]
CLAIMS, NEVER = "claims", "never compared"  # names of user properties
LEFT_OUT = "tools/check --long compares all of it"

Claim = tuple[str, str]  # a file, and a table or constant in it

# Tables that no test compares, and why.
UNCOMPARED: dict[Claim, str] = {
    ("docs/accuracy-log.md", "points"): "solving them takes minutes",
    ("docs/corpora.md", "corpora"): "times of one machine",
    ("docs/costs.md", "cycles"): "the emulator of an RP2040 takes minutes",
    ("docs/coverage.md", "branches"): "gcov counts them after all C tests",
    ("docs/fconv.md", "accuracy_fconv"): "measuring it takes ten minutes",
    ("docs/fconv.md", "forms_fconv"): "measuring it takes ten minutes",
    ("docs/files.md", "long"): "times of one machine",
    ("docs/fuzzing.md", "fuzzing"): "counts of a run of hours",
    ("docs/mutation.md", "mutation_alive"): "running a thousand mutants takes an hour",
    ("docs/mutation.md", "mutation_faults"): "running a thousand mutants takes an hour",
    ("docs/mutation.md", "mutation_files"): "running a thousand mutants takes an hour",
    ("docs/mutation.md", "mutation_scores"): "running a thousand mutants takes an hour",
    ("docs/proof.md", "proof"): "proving all of it takes half an hour; a test proves a part",
    ("docs/proof.md", "reached"): "proving all of it takes half an hour",
    ("docs/python.md", "python_builds"): "building all wheels takes minutes",
    ("docs/python.md", "python_speed"): "times of one machine",
    ("docs/targets.md", "bits"): "compiling and emulating all targets takes minutes",
}

_read: set[Claim] = set()  # tables that tests of this process have read
_left_out: set[Claim] = set()  # what tests claim that their marks left out
_find = markdown._find


def _noted(path: Path, name: str) -> object:
    if path.is_relative_to(ROOT):
        _read.add((path.relative_to(ROOT).as_posix(), name))
    return _find(path, name)


markdown._find = _noted


def claims_of(item: pytest.Item) -> list[Claim]:
    """What a test claims."""
    marks = item.iter_markers("claims")
    return [(mark.args[0], name) for mark in marks for name in mark.args[1:]]


def pytest_itemcollected(item: pytest.Item) -> None:
    item.user_properties.append((CLAIMS, claims_of(item)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """A test that passes has read the tables that it claims."""
    result = yield
    tables = {claim for claim in claims_of(item) if claim[0].endswith(".md")}
    assert tables <= _read, f"claims, but does not read: {sorted(tables - _read)}"
    return result


def pytest_deselected(items: list[pytest.Item]) -> None:
    """By `-m`: `-k` asks for certain tests."""
    if items[0].config.option.markexpr and not items[0].config.option.keyword:
        _left_out.update(claim for item in items for claim in claims_of(item))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """A worker of pytest-xdist says what it left out."""
    if (output := getattr(session.config, "workeroutput", None)) is not None:
        output[CLAIMS] = sorted(_left_out)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """What a worker has said."""
    _left_out.update(map(tuple, getattr(node, "workeroutput", {}).get(CLAIMS, [])))


def unchecked(reports: dict[str, list[pytest.TestReport]]) -> dict[tuple[str, str], list[str]]:
    """{(file, why): names} of what was skipped, or is never compared, by reports of outcomes."""
    found: dict[tuple[str, str], list[str]] = defaultdict(list)

    def add(claim: Claim, why: str) -> None:
        names = found[claim[0], why]
        if claim[1] not in names:
            names.append(claim[1])

    for report in reports.get("skipped", []):
        reason = str(report.longrepr[2]).removeprefix("Skipped: ")
        for claim in dict(getattr(report, "user_properties", [])).get(CLAIMS, []):
            add(tuple(claim), reason)
    for report in reports.get("passed", []):
        for claim, why in dict(report.user_properties).get(NEVER, []):
            add(tuple(claim), why)
    for claim in sorted(_left_out):
        add(claim, LEFT_OUT)
    return found


def write_unchecked(reporter: pytest.TerminalReporter) -> None:
    """A line a file and reason, which tools/check looks for."""
    if found := unchecked(reporter.stats):
        reporter.section("figures that were not checked")
        for (path, why), names in sorted(found.items()):
            reporter.write_line(f"UNCHECKED {path}: {', '.join(names)} ({why})")
