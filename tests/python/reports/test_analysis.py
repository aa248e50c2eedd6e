"""The analysers find what they should, nothing in the library, and the page has each reason."""

from pathlib import Path

import pytest
from builds import need
from support import ROOT

from reports import analysis, markdown
from reports.command import Disagreement
from reports.targets import INCLUDES, ToolError, library_flags

GCC = ["gcc", *library_flags(), *INCLUDES]
FAULTS = """\
#include <stdlib.h>
int twice(const char *text);
int twice(const char *text)
{
    int *n = malloc(sizeof *n);
    if (n == NULL) return 0;
    *n = atoi(text);
    free(n);
    return 2 * *n;
}
"""


@pytest.fixture
def faulty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A source with two faults, in a repository of its own."""
    monkeypatch.setattr(analysis, "ROOT", tmp_path)
    source = tmp_path / "faulty.c"
    source.write_text(FAULTS, "utf-8")
    (tmp_path / ".clang-tidy").write_text(analysis.CONFIG.read_text("utf-8"), "utf-8")
    return source


@pytest.mark.slow
def test_clang_tidy_finds_nothing():
    need("clang-tidy")
    sources = [ROOT / "lib" / "lift" / "lift_f32.c", ROOT / "examples" / "lift_stdin" / "options.c"]
    assert analysis.tidy(sources, []) == set()


@pytest.mark.slow
def test_gccs_analyser_finds_nothing():
    need("gcc")
    sources = [ROOT / "lib" / "lift" / "lift_f32.c", ROOT / "examples" / "lift_stdin" / "options.c"]
    assert analysis.analyse(sources, GCC) == set()


def test_clang_tidy_finds_faults(faulty: Path):
    need("clang-tidy")
    found = {(finding.check, finding.file) for finding in analysis.tidy([faulty], [])}
    assert found == {("cert-err34-c", "faulty.c"), ("clang-analyzer-unix.Malloc", "faulty.c")}


def test_gccs_analyser_finds_faults(faulty: Path):
    need("gcc")
    found = {(finding.check, finding.file) for finding in analysis.analyse([faulty], GCC)}
    assert found == {("use-after-free", "faulty.c")}


def test_a_source_that_does_not_compile_is_an_error(faulty: Path):
    need("gcc")
    faulty.write_text('#include "nowhere.h"\n', "utf-8")
    with pytest.raises(ToolError, match=r"fatal error: nowhere\.h"):
        analysis.analyse([faulty], GCC)


def test_a_finding_without_a_reason_is_an_error():
    analysis.refuse([])
    with pytest.raises(Disagreement, match=r"without a reason:\nlib/a\.c:1:2: cert-x"):
        analysis.refuse([analysis.Finding("cert-x", "lib/a.c", "1:2")])


@pytest.mark.claims("docs/analysis.md", "tidy")
def test_the_page_has_what_is_turned_off_and_why():
    rows = markdown.read(analysis.PAGE, "tidy").splitlines()[2:]
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    assert {name: reason for name, _, reason in cells} == analysis.turned_off()
    assert all(int(count) > 0 for _, count, _ in cells), "else it need not be turned off"


@pytest.mark.claims("docs/analysis.md", "analyser")
def test_the_page_has_what_is_explained():
    rows = markdown.read(analysis.PAGE, "analyser").splitlines()[2:]
    titles = [row.strip("|").split("|")[0].strip() for row in rows]
    assert titles == [", ".join(what) for what in analysis.EXPLAINED]


def test_a_check_that_is_turned_off_without_a_reason_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    text = analysis.CONFIG.read_text("utf-8").replace("  clang-analyzer-*,", "  -cert-msc30-c,")
    (tmp_path / ".clang-tidy").write_text(text, "utf-8")
    monkeypatch.setattr(analysis, "CONFIG", tmp_path / ".clang-tidy")
    with pytest.raises(ValueError, match="cert-msc30-c without a reason"):
        analysis.turned_off()
