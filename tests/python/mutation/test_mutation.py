"""The mutants of a text, its choice at run time, and the list of the equivalent ones."""

import re
import subprocess
from pathlib import Path

import pytest
from builds import need

from mutation import build, results
from mutation.operators import Mutant, apply, enumerators, mutants_of, schema
from mutation.runs import Suite
from reports import markdown

TEXT = """\
/* a + b in a comment */
#define LIMIT 7
enum { MOST = 3 };
static const int table[2] = {1 + 2, 3};

static int clamp(int a) { return a < LIMIT ? a : LIMIT; }

edml_status check(int *out, int n)
{
    static const int kept[MOST] = {4, 5, 6};
    if (n < 0 || out == NULL) return EDML_ERR_ARGUMENT;
    for (int i = 0; i < n; i++) out[i] = -clamp(kept[i % 3] + n);
    return EDML_OK;
}
"""


def mutants() -> list[Mutant]:
    return mutants_of(TEXT, enumerators(TEXT))


def test_each_fault_is_at_its_place() -> None:
    found = {(m.line, m.operator, m.change) for m in mutants()}
    expected = {
        (6, "boundary", "a < LIMIT -> a <= LIMIT"),
        (6, "comparison", "a < LIMIT -> a >= LIMIT"),
        (6, "constant", "LIMIT -> LIMIT / 2"),
        (11, "logical", "n < 0 || out == NULL -> n < 0 && out == NULL"),
        (11, "deleted if", "n < 0 || out == NULL -> 0, the statement never runs"),
        (11, "comparison", "out == NULL -> out != NULL"),
        (11, "status", "EDML_ERR_ARGUMENT -> EDML_OK"),
        (12, "deleted statement", "out[i] = -clamp(kept[i % 3] + n); -> (deleted)"),
        (12, "sign", "-clamp(kept[i % 3] + n) -> clamp(kept[i % 3] + n)"),
        (12, "arithmetic", "kept[i % 3] + n -> kept[i % 3] - n"),
        (12, "constant", "3 -> 3 + 1"),
        (13, "status", "EDML_OK -> EDML_ERR_ARGUMENT"),
    }
    assert expected <= found
    assert {line for line, _, _ in found} == {6, 11, 12, 13}  # no comment, table or declaration


def test_one_fault_changes_its_text_alone() -> None:
    for mutant in mutants():
        other = apply(TEXT, mutant)
        assert other != TEXT
        assert other.splitlines()[: mutant.line - 1] == TEXT.splitlines()[: mutant.line - 1]


def strip_choices(text: str) -> str:
    """What is compiled if no mutant is chosen, without spaces and parentheses."""
    text = text.replace("\\n", "")
    while match := re.search(r"\(EDML_MUTANT\(\d+\) \? ", text):
        depth, at = 0, match.end()
        while depth or text[at] != ":":  # the end of the mutant
            depth += {"(": 1, ")": -1}.get(text[at], 0)
            at += 1
        text = text[: match.start()] + "(" + text[at + 1 :]
    return re.sub(r"if \(!EDML_MUTANT\(\d+\)\)|[\s(){}]", "", text)


def test_without_a_choice_the_text_is_the_original() -> None:
    numbered = dict(enumerate(mutants(), 1))
    assert strip_choices(schema(TEXT, numbered)) == strip_choices(TEXT)
    assert schema(TEXT, numbered).count("\n") == TEXT.count("\n")
    for number in numbered:
        assert f"EDML_MUTANT({number})" in schema(TEXT, numbered)


UNITY = """
typedef void (*UnityTestFunction)(void);
struct unity { int TestFailures; };
extern struct unity Unity;
void UnityDefaultTestRun(UnityTestFunction test, const char *name, int line);
"""
RUNNER = """
#include "unity.h"
struct unity Unity;
void UnityDefaultTestRun(UnityTestFunction test, const char *name, int line)
{
    (void)name, (void)line, test();
}
"""
PROGRAM = """
#include <stdio.h>
#include "unity.h"
static int sum(int n)
{
    int s = 0;
    while (n > 0 && n < 1000) { s += n; n = n - 1; }
    return s;
}
static int unused(int n) { return n + 1; }
static void expect(int right)
{
    if (!right) puts("t:1:expect:FAIL");
    Unity.TestFailures += !right;
}
static void adds(void) { expect(sum(4) == 10); }
static void none(void) { expect(sum(0) == 0 && unused != 0); }
int main(void)
{
    UnityDefaultTestRun(adds, "adds", 1);
    UnityDefaultTestRun(none, "none", 2);
    return Unity.TestFailures;
}
"""


def compile_choices(folder: Path, text: str, count: int) -> Path:
    """A program of Unity's shape with the harness."""
    need("cc")
    for name, content in (("unity.h", UNITY), ("runner.c", RUNNER), ("test.c", text)):
        (folder / name).write_text(content)
    program, harness = folder / "program", build.HARNESS
    command = ["cc", f"-I{folder}", f"-DEDML_MUTANTS={count}", "-include", harness / "harness.h",
               "-Wl,--wrap=UnityDefaultTestRun", harness / "harness.c", folder / "runner.c",
               folder / "test.c", "-o", program]  # fmt: skip
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return program


def test_mutants_are_killed_by_the_tests_that_reach_them(tmp_path: Path) -> None:
    """Among them an endless loop, and one of a function that no test calls."""
    numbered = {
        n: m for n, m in enumerate(mutants_of(PROGRAM, set()), 1) if m.function in ("sum", "unused")
    }
    program = compile_choices(tmp_path, schema(PROGRAM, numbered), max(numbered))
    suite = Suite({"program": program})
    assert [test.name for test in suite.tests] == ["adds", "none"]
    fate = {m.change: suite.killer(n, "here") for n, m in numbered.items()}
    assert fate["s += n -> s -= n"] == "program: expect"
    assert fate["n = n - 1; -> (deleted)"] in ("program: ends by signal 27", "program: expect")
    assert fate["0 -> 0 + 1"] is not None
    assert fate["n < 1000 -> n <= 1000"] is None
    assert fate["n + 1 -> n - 1"] is None
    reached = {m.function for n, m in numbered.items() if suite.is_reached(n)}
    assert reached == {"sum"}


def test_the_argued_mutants_exist() -> None:
    """argued() raises if a line or a change is not there any more."""
    reasons = results.argued(build.all_mutants())
    listed = results.arguments()
    assert len(reasons) >= sum(len(argument.changes) for argument in listed)
    assert all(len(argument.reason.split()) >= 4 for argument in listed)


def test_an_argument_of_a_line_that_is_gone_is_found(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    gone = tmp_path / "argued.toml"
    listed = results.ARGUED.read_text("utf-8")
    gone.write_text(listed.replace('line = "', 'line = "was ', 1), "utf-8")
    monkeypatch.setattr(results, "ARGUED", gone)
    monkeypatch.setattr(results, "ROOT", tmp_path)
    with pytest.raises(ValueError, match=r"argued.toml: no mutant lib/.* \| was "):
        results.argued(build.all_mutants())


def test_scores_leave_out_the_equivalent_ones() -> None:
    one = mutants()[0]
    found = results.Results(
        {n: ("lib/optional/quality.h", one) for n in range(10)}, frozenset(range(5)),
        dict.fromkeys(range(8), "test"), {8: "why not"},
    )  # fmt: skip
    assert found.row(set(range(10))) == [10, 8, 1, 1, pytest.approx(100 * 8 / 9)]
    assert found.living() == [9]
    assert "| `lib/optional/quality.h` | 10 | 8 | 1 | 1 | 88.9 |" in results.file_table(found)


def test_the_page_has_the_scores_that_are_asked_for() -> None:
    page = Path(build.ROOT, "docs", "mutation.md")
    rows = [line.split("|") for line in markdown.read(page, "mutation_scores").splitlines()[2:]]
    scores = {row[1].strip(): float(row[-2]) for row in rows}
    assert len(scores) == 1 + len(results.PARTS)
    for part, score in scores.items():
        assert score >= (92 if part.startswith("all") else 90), part
