"""Branches of lib/ that no C unit test takes: each is argued, or this fails.

    run.py reports.branches COVERAGE_JSON            compares with tests/coverage/argued.toml
    run.py reports.branches COVERAGE_JSON --update   and writes the tables of docs/coverage.md

COVERAGE_JSON is what the target `coverage` makes with gcovr: build/check/tests/coverage.json after
tools/check.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import tomllib

from data.paths import DOCS, LIB, ROOT
from reports import markdown

ARGUED = ROOT / "tests" / "coverage" / "argued.toml"
PAGE = DOCS / "coverage.md"

Place = tuple[str, str]  # a file, and the text of a line in it, or of several that are alike


class Argument(NamedTuple):
    """Why no input takes some branches of a line."""

    file: str
    line: str  # the line's text
    untaken: int  # so many of its branches
    reason: str

    @property
    def place(self) -> Place:
        return self.file, self.line


def arguments() -> list[Argument]:
    return [Argument(**entry) for entry in tomllib.loads(ARGUED.read_text("utf-8"))["argument"]]


def lines_of(file: str) -> list[str]:
    """Texts of the lines of a file of the repository; none if it is gone."""
    path = ROOT / file
    return [line.strip() for line in path.read_text("utf-8").splitlines()] if path.exists() else []


def untaken(coverage: Mapping) -> dict[Place, int]:
    """How many branches were not taken, of each line that has such."""
    found: Counter[Place] = Counter()
    for file in coverage["files"]:
        text = lines_of(file["file"])
        for line in file["lines"]:
            missed = sum(branch["count"] == 0 for branch in line.get("branches", []))
            if missed:
                found[file["file"], text[line["line_number"] - 1]] += missed
    return dict(found)


def compare(found: Mapping[Place, int], argued: Iterable[Argument]) -> list[str]:
    """What is wrong: a sentence for each branch and each argument that stands alone."""
    wrong = []
    by_place = {argument.place: argument.untaken for argument in argued}
    for file, line in [*found, *(place for place in by_place if place not in found)]:
        missed, known = found.get((file, line), 0), by_place.get((file, line), 0)
        if missed == known:
            continue
        gone = line not in lines_of(file)
        said = "there is no such line" if gone else f"{missed} branches are not taken"
        wrong.append(f"{file}: {said}, {known} are argued: {line}")
    return wrong


def argued_table(argued: Iterable[Argument]) -> str:
    """A row an argument."""
    rows = []
    for one in argued:
        code = one.line.replace("|", "\\|")
        rows.append((f"`{one.file}`", [f"`{code}`", str(one.untaken), one.reason]))
    return markdown.table("file", ["line", "not taken", "why"], rows, left=4)


def count_table(coverage: Mapping) -> str:
    """Branches of each folder of lib/, and how many were taken."""
    all_of: Counter[str] = Counter()
    taken: Counter[str] = Counter()
    for file in coverage["files"]:
        folder = Path(file["file"]).parent.as_posix()
        counts = [b["count"] for line in file["lines"] for b in line.get("branches", [])]
        for name in (folder, "all"):
            all_of[name] += len(counts)
            taken[name] += sum(count > 0 for count in counts)
    names = sorted(name for name in all_of if name != "all" and all_of[name])
    rows = {f"`{n}`" if n != "all" else n: [all_of[n], taken[n], all_of[n] - taken[n]]
            for n in [*names, "all"]}  # fmt: skip
    columns = ["branches", "taken", "argued"]
    return markdown.table("folder", columns, rows, markdown.counted)


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="branches", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("coverage", type=Path, metavar="COVERAGE_JSON")
    parser.add_argument("--update", action="store_true", help=f"writes {PAGE.relative_to(ROOT)}")
    options = parser.parse_args(argv)
    if not options.coverage.exists():
        print(f"branches: there is no {options.coverage}; tools/check makes it.", file=sys.stderr)
        return 1
    coverage = json.loads(options.coverage.read_text("utf-8"))
    known = arguments()
    wrong = compare(untaken(coverage), known)
    for line in wrong:
        print(f"branches: {line}", file=sys.stderr)
    if wrong:
        print(f"branches: write a test that takes it, or {ARGUED.relative_to(ROOT)}.",
              file=sys.stderr)  # fmt: skip
        return 1
    print(f"Branches of {LIB.name}/: all are taken but {sum(a.untaken for a in known)}, "
          f"which {ARGUED.relative_to(ROOT)} argues.")  # fmt: skip
    if options.update:
        markdown.write_those(
            PAGE, {"branches": count_table(coverage), "branches_argued": argued_table(known)}
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
