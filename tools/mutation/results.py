"""What became of mutants: killed, equivalent (argued, or of the same code), or alive; as tables."""

from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

import tomllib

from data.paths import ROOT
from mutation.build import Alone, Numbered, texts
from mutation.operators import Mutant
from reports import markdown

ARGUED = ROOT / "tests" / "mutation" / "argued.toml"
PARTS = {  # by the beginnings of their files' names
    "camera": "lib/optional/camera/",
    "track": "lib/optional/video.h",
    "quality": "lib/optional/quality.h",
    "adapt": "lib/joints/adapt.h",
}


class Argument(NamedTuple):
    """Why mutants of a line change nothing that anybody can observe."""

    file: str
    line: str  # the line's text
    changes: list[str]  # of mutants of that line: "before -> after"
    reason: str


def arguments() -> list[Argument]:
    return [Argument(**entry) for entry in tomllib.loads(ARGUED.read_text("utf-8"))["argument"]]


def line_of(file: str, mutant: Mutant, sources: Mapping[str, str]) -> str:
    return sources[file].splitlines()[mutant.line - 1].strip()


def argued(mutants: Numbered) -> dict[int, str]:
    """Reasons of those that are in the list; ValueError if it has one that there is not."""
    sources = texts()
    at: dict[tuple[str, str, str], list[int]] = {}
    for number, (file, mutant) in mutants.items():
        at.setdefault((file, line_of(file, mutant, sources), mutant.change), []).append(number)
    reasons: dict[int, str] = {}
    for argument in arguments():
        for change in argument.changes:
            key = (argument.file, argument.line, change)
            if key not in at:
                raise ValueError(f"{ARGUED.relative_to(ROOT)}: no mutant {' | '.join(key)}")
            reasons |= dict.fromkeys(at[key], argument.reason)
    return reasons


def same_code(file: str, mutant: Mutant, alone: Alone) -> bool:
    """Does the compiler make the same code of the mutant?"""
    return alone.objects(file, mutant, "-O2") == alone.original(file, "-O2")


class Results(NamedTuple):
    """Outcomes by the number of the mutant."""

    mutants: Numbered  # that were run
    sampled: frozenset[int]  # of them, the sample of all lib/
    killers: dict[int, str]
    equivalent: dict[int, str]  # with the reason

    def living(self) -> list[int]:
        return [n for n in self.mutants if n not in self.killers and n not in self.equivalent]

    def row(self, numbers: set[int]) -> list[markdown.Figure]:
        """Mutants, killed, equivalent, alive, and the score in percent."""
        killed = sum(n in self.killers for n in numbers)
        equivalent = sum(n in self.equivalent for n in numbers)
        counted = len(numbers) - equivalent
        score = 100 * killed / counted if counted else None
        return [len(numbers), killed, equivalent, counted - killed, score]

    def part(self, beginning: str) -> set[int]:
        return {n for n, (file, _) in self.mutants.items() if file.startswith(beginning)}


COLUMNS = ["mutants", "killed", "equivalent", "alive", "score, %"]


def score_table(results: Results) -> str:
    """A row for the sample of all lib/, a row a part."""
    rows = {"all of `lib/`, a sample": results.row(set(results.sampled))}
    rows |= {
        f"{name}: `{start}`": results.row(results.part(start)) for name, start in PARTS.items()
    }
    return markdown.table("part", COLUMNS, rows)


def file_table(results: Results) -> str:
    files = Counter(file for file, _ in results.mutants.values())
    rows = {f"`{file}`": results.row(results.part(file)) for file in sorted(files)}
    return markdown.table("file", COLUMNS, rows)


def operator_table(results: Results) -> str:
    kinds: dict[str, set[int]] = {}
    for number, (_, mutant) in results.mutants.items():
        kinds.setdefault(mutant.operator, set()).add(number)
    return markdown.table("fault", COLUMNS, {k: results.row(kinds[k]) for k in sorted(kinds)})


def living_list(results: Results) -> str:
    """Those that no test kills, a line each."""
    lines = []
    for number in results.living():
        file, m = results.mutants[number]
        change = m.change.replace("|", "\\|")
        lines.append(f"- `{file}`, {m.line}, `{m.function}`: {m.operator}, `{change}`")
    return "\n".join(lines or ["None."]) + "\n"


def tables(results: Results) -> dict[str, str]:
    return {
        "mutation_scores": score_table(results),
        "mutation_files": file_table(results),
        "mutation_faults": operator_table(results),
        "mutation_alive": living_list(results),
    }
