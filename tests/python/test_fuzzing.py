"""What is fuzzed is all that there is, SECURITY.md lists it, and figures of runs add up."""

import json
import re
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import pytest
from support import ROOT, run_tool
from test_house import public_functions

from fuzzing import command, runs
from fuzzing.runs import Figures
from fuzzing.targets import FUZZ, Target, all_targets, library_targets, reader_targets
from reports import markdown

PAGE = ROOT / "docs" / "fuzzing.md"
NAMES = [target.name for target in all_targets()]


def named_in(text: str) -> list[str]:
    return re.findall(r"`(\w+)`", text)


def rows_of(table: str) -> list[list[str]]:
    lines = [line for line in table.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


# ---- What is fuzzed ------------------------------------------------------------------------------


def test_security_lists_the_targets() -> None:
    rows = rows_of(markdown.read(ROOT / "SECURITY.md", "untrusted"))
    listed = [name for row in rows for name in named_in(row[-1])]
    assert sorted(listed) == sorted({name.removesuffix("_q") for name in NAMES})
    assert all(cell for row in rows for cell in row)


def test_targets_are_named_once() -> None:
    assert len(set(NAMES)) == len(NAMES)
    assert {"lift", "lift_q", "agree", "lift_stdin", "keypoints_json", "manifest"} < set(NAMES)
    assert "agree_q" not in NAMES
    folder = {path.stem for path in (FUZZ / "targets").glob("*.c")}
    assert folder == {name.removesuffix("_q") for name in library_targets()}


@pytest.mark.parametrize("function", sorted(public_functions()))
def test_every_public_function_is_fuzzed(function: str) -> None:
    """A text of both arithmetics calls one of fixed point by the name of the float one."""
    texts = {path.stem: path.read_text("utf-8") for path in (FUZZ / "targets").glob("*.c")}
    both = {name.removesuffix("_q") for name in library_targets() if name.endswith("_q")}
    plain = function.removesuffix("_q")
    assert any(
        re.search(rf"\b{function}\(", code) or (name in both and re.search(rf"\b{plain}\(", code))
        for name, code in ((name, without_comments(text)) for name, text in texts.items())
    )


def without_comments(text: str) -> str:
    return re.sub(r"/\*.*?\*/", "", text, flags=re.S)


def test_every_format_of_weights_is_fuzzed() -> None:
    """But for PyTorch's files, which its own loader reads."""
    from export.readers import READERS

    formats = {f"weights_{suffix[1:]}" for suffix in READERS} - {"weights_pt", "weights_pth"}
    assert formats - {"weights_hdf5"} <= set(reader_targets())


# ---- Figures -------------------------------------------------------------------------------------


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Of runs that found two inputs of lift."""
    monkeypatch.setattr(runs, "LOG", tmp_path / "log.jsonl")
    monkeypatch.setattr("fuzzing.targets.OUT", tmp_path)
    (tmp_path / "findings" / "lift").mkdir(parents=True)
    for name in ("crash-1", "fast-2"):
        (tmp_path / "findings" / "lift" / name).touch()
    return tmp_path / "log.jsonl"


def note(log: Path, name: str, sources: str, *numbers: int) -> None:
    with log.open("a") as file:
        file.write(json.dumps(asdict(Figures(name, sources, *numbers))) + "\n")


def test_figures_of_the_same_sources_add_up(log: Path) -> None:
    targets = [Target("lift", "library", "lib"), Target("lift_q", "library", "lib")]
    sources = runs.logged(targets[0]).sources
    note(log, "lift", sources, 1000, 20, 7, 0)
    note(log, "lift", "of before", 5000, 5000, 900, 1)
    note(log, "lift", sources, 100, 3, 9, 7)
    note(log, "lift_q", sources, 10, 1600, 5, 0)
    rows = rows_of(command.table_of(targets, with_lines=False))
    assert rows[0] == ["`lift`", "1,100", "23", "", "9", "", "2"]
    assert rows[1] == ["`lift_q`", "10", "1,600", "110", "5", "", "0"]
    assert rows[2] == ["all", "1,110", "1,623", "110", "", "", "2"]


def test_lines_are_those_of_the_targets_folder() -> None:
    report = f"SF:{ROOT}/lib/lift/mds.h\nDA:1,5\nDA:2,0\nSF:{ROOT}/libc/x.h\nDA:3,1\n"
    ran, known = runs.read_lcov(report, Target("lift", "library", "lib"))
    assert ran == {(f"{ROOT}/lib/lift/mds.h", 1)} and len(known) == 2


def test_comments_are_no_sources(tmp_path: Path) -> None:
    hashes = []
    for text in ("int a; /* one\n * two */\nint b;\n", "int a;\nint b;\n", "int a;\nint c;\n"):
        (tmp_path / "a.c").write_text(text)
        hashes.append(runs.hash_of([tmp_path / "a.c"]))
    assert hashes[0] == hashes[1] != hashes[2]


def numbers_of(row: Sequence[str]) -> list[int]:
    return [int(cell.replace(",", "") or 0) for cell in row[1:]]


def test_the_page_has_the_figures_of_every_target() -> None:
    *rows, everything = rows_of(markdown.read(PAGE, "fuzzing"))
    assert [named_in(row[0]) for row in rows] == [[name] for name in NAMES]
    assert all(numbers_of(row)[0] > 0 for row in rows)
    guided, fast, watched, _, _, findings = numbers_of(everything)
    assert [guided, fast, watched] == [sum(numbers_of(row)[n] for row in rows) for n in range(3)]
    assert guided + fast >= 100_000_000 and findings == 0


# ---- The command ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["nobody"], "no target nobody: tools/fuzz --list names them"),
        (["--minutes", "-1"], "--minutes must be 0 or more"),
        (["--guided", "1.5"], "--guided 0 to 1"),
    ],
)
def test_what_the_command_cannot_do(arguments: list[str], message: str) -> None:
    done = run_tool("fuzzing.command", *arguments)
    assert done.returncode != 0 and message in done.stderr
    assert "Traceback" not in done.stderr
