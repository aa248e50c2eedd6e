"""Each figure of a page is compared by a test that says so, or is known not to be; a run that skips
such a test names what it did not check."""

import ast
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from claims import NEVER, UNCOMPARED, Claim
from support import ROOT

from reports import markdown

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def claimed() -> Iterator[Claim]:
    """What the tests claim; in their text, because nothing has to be imported for that."""
    for path in (ROOT / "tests" / "python").rglob("test_*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and re.search(r"\bclaims$", ast.unparse(node.func)):
                file, *names = (ast.literal_eval(word) for word in node.args)
                assert names, f"{path.name}: all of {file}?"
                yield from ((file, name) for name in names)


def test_every_table_is_compared_or_known_not_to_be(record_property: Callable[[str, object], None]):
    tables = {
        (page.relative_to(ROOT).as_posix(), name)
        for page in PAGES
        for name in re.findall(r"<!-- begin (\w+) -->", page.read_text("utf-8"))
    }
    found = set(claimed())
    assert not found & UNCOMPARED.keys()
    assert tables - found - UNCOMPARED.keys() == set(), "neither claimed nor in UNCOMPARED"
    assert UNCOMPARED.keys() <= tables
    record_property(NEVER, list(UNCOMPARED.items()))  # for the end of the run


def test_what_is_claimed_is_there():
    for file, name in claimed():
        path = ROOT / file
        if path.suffix == ".md":
            assert markdown.read(path, name).strip() or name in ("people", "recipes")
        else:
            assert re.search(rf"\b{name}\b", path.read_text("utf-8")), (file, name)


def run(*arguments: object, **environment: str) -> subprocess.CompletedProcess:
    """pytest of a process of its own, whose worker runs the tests, as in tools/check."""
    command = [sys.executable, "-m", "pytest", "-q", "-n", "1", *map(str, arguments)]
    inherited = {name: text for name, text in os.environ.items() if name != "PYTEST_ADDOPTS"}
    return subprocess.run(
        command, cwd=ROOT, env=inherited | environment, capture_output=True, text=True
    )


@pytest.mark.slow
def test_a_run_without_the_motion_data_names_what_it_did_not_check():
    tests = ROOT / "tests" / "python"
    done = run(tests / "evaluation" / "test_room.py", tests / "test_unchecked.py",
               "-k", "the_pages or known", EDMLIFT_DATA="nowhere")  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    said = [line for line in done.stdout.splitlines() if line.startswith("UNCHECKED ")]
    why = "(no motion data: docs/motion-data.md says where to get them (EDMLIFT_DATA))"
    assert f"UNCHECKED docs/where-in-the-room.md: path, focal {why}" in said
    assert f"UNCHECKED docs/body.md: held_bones {why}" in said
    assert "UNCHECKED docs/costs.md: cycles (the emulator of an RP2040 takes minutes)" in said


CONFTEST = f"""import sys
sys.path[:0] = [{str(ROOT / "tools")!r}, {str(ROOT / "tests" / "python")!r}]
from claims import *
def pytest_configure(config):
    for mark in ("claims", "long"):
        config.addinivalue_line("markers", f"{{mark}}: x")
def pytest_terminal_summary(terminalreporter):
    write_unchecked(terminalreporter)
"""


def run_claim(folder: Path, *options: str, mark: str = "") -> subprocess.CompletedProcess:
    """Of a test that claims a table and reads nothing, with a mark."""
    (folder / "conftest.py").write_text(CONFTEST)
    (folder / "test_it.py").write_text(
        f"import pytest\n{mark}\n@pytest.mark.claims('docs/body.md', 'sizes')\n"
        "def test_it(): pass\ndef test_other(): pass\n"
    )
    return run("-p", "no:cacheprovider", "--rootdir", folder, "-c", os.devnull, folder, *options)


@pytest.mark.slow
def test_a_claim_without_a_comparison_fails(tmp_path):
    done = run_claim(tmp_path)
    assert done.returncode == 1 and "claims, but does not read: [('docs/body.md'" in done.stdout


@pytest.mark.slow
def test_a_run_without_long_tests_names_what_it_did_not_check(tmp_path):
    done = run_claim(tmp_path, "-m", "not long", mark="@pytest.mark.long")
    assert done.returncode == 0, done.stdout
    assert "UNCHECKED docs/body.md: sizes (tools/check --long compares all of it)" in done.stdout
