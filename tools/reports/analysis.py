"""What clang-tidy and gcc's analyser say of lib/, include/ and examples/, as Markdown.

    run.py reports.analysis             prints the tables: four minutes
    run.py reports.analysis --update    writes them to docs/analysis.md
    run.py reports.analysis --check     compares them

A finding is an error, unless its check is turned off in .clang-tidy, which has the reason, or this
file explains it.  What it explains is tried: MemorySanitizer runs the library over hard input.
"""

import re
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from data.paths import DOCS, ROOT
from reports import markdown
from reports.bits import EXPECTED, PROGRAM
from reports.command import Disagreement, Table, run_report
from reports.targets import (
    INCLUDES,
    SMALL_SOURCES,
    TARGETS,
    ToolError,
    compiler,
    library_flags,
    run,
)

PAGE, CONFIG = DOCS / "analysis.md", ROOT / ".clang-tidy"
FAMILIES = "-*,bugprone-*,cert-*,clang-analyzer-*"
LIBRARY = [source for source in SMALL_SOURCES if source.parent.name != "models"]
FOLDERS = [ROOT / "examples" / name for name in (".", "lift_stdin", "firmware")]
EXAMPLES = [path for folder in FOLDERS for path in sorted(folder.glob("*.c"))]
NETWORK = [source for source in LIBRARY if source.parent.name == "network"]
# The kernels of other processors: what they are called, the flags, and whose they are.
KERNELS = {
    "this machine": ([], [*LIBRARY, *EXAMPLES]),
    "no vectors": (["-U__SSE2__"], NETWORK),
    "no vectors, blocks by row": (["-U__SSE2__", "-DEDML_BLOCKS_BY_ROW"], NETWORK),
}
CORE = TARGETS["cortex-m4f"]
EXPLAINED = {
    ("use-of-uninitialized-value", "lib/lift"):
        "a false alarm: assembly writes a product, and a loop the lengths of three axes, of which "
        "the analyser follows one turn; neither MemorySanitizer nor Frama-C finds one",
    ("use-of-uninitialized-value", "lib/network"):
        "a false alarm: one loop writes so many sums or places as a layer has, and another reads "
        "as many, which the analyser does not relate; MemorySanitizer finds none",
    ("use-of-uninitialized-value", "lib/number"):
        "a false alarm: a loop writes the lengths of three axes, of which the analyser follows one "
        "turn; neither MemorySanitizer nor Frama-C finds one",
}  # fmt: skip


class Finding(NamedTuple):
    check: str
    file: str  # below the root
    place: str  # line:column

    @property
    def folder(self) -> str:
        return str(Path(self.file).parent)


Findings = set[Finding]  # a header's are one, whoever includes it
FOUND = re.compile(
    r"^(\S+?):(\d+:\d+): (?:warning|error): .*\[(?:-Wanalyzer-)?([\w.-]+)\S*\]$", re.M
)


def read_findings(text: str) -> Findings:
    """What a tool printed; ToolError where it could not read a source."""
    if broken := re.search(r"^.*(?:clang-diagnostic-error|fatal error: ).*$", text, re.M):
        raise ToolError(broken[0])
    return {
        Finding(check, str((ROOT / file).resolve().relative_to(ROOT)), place)
        for file, place, check in FOUND.findall(text)
    }


def all_findings(commands: Iterable[Sequence[object]]) -> Findings:
    """Of commands that look at a source each, two at a time."""

    def look(command: Sequence[object]) -> Findings:
        words = list(map(str, command))
        try:
            done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            raise ToolError(f"{words[0]} is not installed; tools/check installs it") from None
        return read_findings(done.stdout + done.stderr)

    with ThreadPoolExecutor(2) as pool:
        return set().union(*pool.map(look, commands))


# ---- clang-tidy --------------------------------------------------------------------------------


def turned_off() -> dict[str, str]:
    """The checks that .clang-tidy turns off, and why; ValueError where one has no reason."""
    text = CONFIG.read_text("utf-8")
    reasons = dict(re.findall(r"^#   (\S+): (.*)$", text, re.M))
    checks = re.search(r"^Checks: >-\n((?:  .*\n)+)", text, re.M)[1]
    names = re.findall(r"^  -([a-z]\S*?),?$", checks, re.M)
    if names != list(reasons):
        raise ValueError(f"{CONFIG.name}: {', '.join(set(names) ^ set(reasons))} without a reason")
    return reasons


def tidy(sources: Sequence[Path], flags: Sequence[str], *options: str) -> Findings:
    """By the checks of .clang-tidy."""
    return all_findings(
        ["clang-tidy", "--quiet", *options, source, "--", "-std=c99", *flags, *INCLUDES]
        for source in sources
    )


def count_turned_off() -> Counter[str]:
    """How often the checks that are turned off would speak; Disagreement where another does."""
    findings: Findings = set()
    for flags, sources in KERNELS.values():
        findings |= tidy(sources, flags, f"--checks={FAMILIES}")
    refuse(found for found in findings if found.check not in turned_off())
    return Counter(found.check for found in findings)


# ---- gcc -fanalyzer ----------------------------------------------------------------------------


def analyse(sources: Sequence[Path], command: Sequence[str]) -> Findings:
    """By gcc's analyser."""
    with tempfile.TemporaryDirectory() as folder:
        item = Path(folder) / "x.o"
        return all_findings(
            [*command, "-fanalyzer", "-O1", "-c", source, "-o", f"{item}{n}"]
            for n, source in enumerate(sources)
        )


def count_analysed() -> dict[str, Counter[tuple[str, str]]]:
    """How often it speaks, by check and folder, of each kind of kernels; Disagreement where
    nothing explains it."""
    host = ["gcc", *library_flags(), *INCLUDES]
    found = {name: analyse(where, [*host, *flags]) for name, (flags, where) in KERNELS.items()}
    found[CORE.name] = analyse(LIBRARY, compiler(CORE, "-O1"))
    refuse(f for of in found.values() for f in of if (f.check, f.folder) not in EXPLAINED)
    return {name: Counter((f.check, f.folder) for f in of) for name, of in found.items()}


def sanitise_memory() -> None:
    """Runs the library over hard input by MemorySanitizer; ToolError where it reads what nobody
    wrote."""
    for flags, _ in KERNELS.values():
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "bits"
            run(
                "clang", *library_flags(), "-O1", "-fsanitize=memory", *flags, *INCLUDES, PROGRAM,
                *SMALL_SOURCES, "-lm", "-o", program,
            )  # fmt: skip
            if run(program) != EXPECTED.read_text("utf-8"):
                raise Disagreement("other bits with MemorySanitizer")


# ---- The page ----------------------------------------------------------------------------------


def refuse(findings: Iterable[Finding]) -> None:
    """Raises Disagreement where there is one."""
    if lines := sorted({f"{f.file}:{f.place}: {f.check}" for f in findings}):
        raise Disagreement("findings without a reason:\n" + "\n".join(lines))


def tables() -> Iterator[Table]:
    """The page's: what is turned off, and what is explained."""
    counts = count_turned_off()
    off = {name: [counts[name], reason] for name, reason in turned_off().items()}
    analysed = count_analysed()
    sanitise_memory()
    explained = {
        f"{check}, {folder}": [*(of[check, folder] for of in analysed.values()), reason]
        for (check, folder), reason in EXPLAINED.items()
    }
    yield Table(PAGE, "tidy", markdown.table("turned off", ["would speak", "because"], off))
    yield Table(PAGE, "analyser", markdown.table("finding", [*analysed, "because"], explained))


def main() -> int:
    return run_report("analysis", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
