"""How the library stands to MISRA C:2012, by cppcheck's addon: a table of rules and counts.

    run.py reports.misra             prints the table: two minutes
    run.py reports.misra --update    writes it to docs/misra.md
    run.py reports.misra --check     compares it

A rule that is broken and has no reason here is an error.
"""

import re
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from data.paths import DOCS, LIB, ROOT
from reports import markdown
from reports.command import Disagreement, Table, run_report
from reports.targets import INCLUDES, ToolError, run

PAGE = DOCS / "misra.md"
OPTIONS = (
    "--std=c99", "--language=c", "--addon=misra", "--enable=style", "--quiet",
    "--platform=arm32-wchar_t4", "--template={file}:{id}:{line}:{column}",
)  # fmt: skip
# Weights alone: their kernels are checked.
SOURCES = sorted(path for path in LIB.rglob("*.c") if path.parent.name != "models")
FOLDERS = ("include", "api", "geometry", "joints", "lift", "network", "number", "optional")


class Deviation(NamedTuple):
    """A rule that the library breaks."""

    category: str  # of MISRA's
    asks: str  # what it asks for, in our words
    reason: str  # why it is broken


R, A = "required", "advisory"
NO_BOOLEAN = "C99's `_Bool` is missing in some compilers for small cores; flags are `int`, 0 or 1"
TWICE = "a text that is compiled twice, in float and fixed point, has the same names"
DEVIATIONS = {
    "2.2": Deviation(R, "no dead code", "a false alarm: `0 - x` in unsigned arithmetic negates"),
    "2.3": Deviation(A, "no unused types", "the public ones are the user's"),
    "2.4": Deviation(A, "no unused tags", "constants of an enumeration are used without its tag"),
    "2.5": Deviation(A, "no unused macros", "one arithmetic's macros serve all stages"),
    "2.7": Deviation(
        R, "no unused parameters",
        "the body is assembly, which the checker cannot read",
    ),
    "5.5": Deviation(
        R, "names differ from macros",
        "a text that is compiled twice, in float and fixed point, has its public names by macros",
    ),
    "5.6": Deviation(R, "names of types are unique", TWICE),
    "5.7": Deviation(R, "tags are unique", TWICE),
    "5.9": Deviation(A, "names of static functions are unique", TWICE),
    "8.7": Deviation(A, "what one file uses is static", "the public functions are the user's"),
    "8.9": Deviation(
        A, "a constant is where it is used",
        "tables stand before the functions, with their source",
    ),
    "8.11": Deviation(
        A, "an external array has a size",
        "`edml_formats` ends with `NULL`, so that formats can be added",
    ),
    "9.2": Deviation(R, "braces for each aggregate", "members are copies of named constants"),
    "9.3": Deviation(R, "no part of an array is left out", "a false alarm"),
    "10.1": Deviation(R, "operands of a suitable kind", f"{NO_BOOLEAN}; sets of joints are bits"),
    "10.3": Deviation(
        R, "no assignment to a narrower kind",
        "constants of an enumeration, and 0, initialise numbers",
    ),
    "10.4": Deviation(
        R, "both operands of the same kind",
        "constants of an enumeration are the array sizes of the library",
    ),
    "10.6": Deviation(R, "no composite expression becomes wider", "constants"),
    "10.7": Deviation(R, "no composite expression becomes wider", "a shift by an `int`"),
    "10.8": Deviation(
        R, "no cast of a composite expression",
        "sums are narrowed where their range was shown",
    ),
    "11.5": Deviation(
        A, "no `void *` to an object",
        "work memory is the caller's, of a size that depends on the model",
    ),
    "12.1": Deviation(
        A, "parentheses show precedence",
        "arithmetic is written as in the equations",
    ),
    "12.3": Deviation(A, "no comma operator", "false alarms: declarations of several names"),
    "13.3": Deviation(
        A, "`++` stands alone",
        "loops over triangles of matrices go on by one entry",
    ),
    "14.2": Deviation(R, "a `for` loop has one counter", "pointers run to an end"),
    "14.4": Deviation(R, "a condition is Boolean", NO_BOOLEAN),
    "15.5": Deviation(
        A, "one `return` a function",
        "input is refused before anything is done with it",
    ),
    "15.6": Deviation(R, "braces around each body", "a body of one line has none"),
    "17.7": Deviation(R, "results are used", "`memcpy` and `memset` return their argument"),
    "17.8": Deviation(
        A, "parameters are not changed",
        "a pointer runs along its array; a word is shifted",
    ),
    "18.4": Deviation(
        A, "no `+` on pointers",
        "parts of work memory are arrays of the sizes beside them",
    ),
    "18.8": Deviation(
        R, "no arrays of variable length",
        "a false alarm: a constant of an enumeration is their size",
    ),
    "19.2": Deviation(A, "no unions", "work memory is used again by the stages that follow"),
    "20.1": Deviation(A, "`#include` comes first", "`edmlift/work.h` needs the types before it"),
    "20.5": Deviation(A, "no `#undef`", "a macro of one list is gone after it"),
    "20.7": Deviation(R, "parentheses around macro parameters", "parameters are names and types"),
    "20.10": Deviation(A, "no `#` or `##`", "names of float and fixed point are made of one text"),
}  # fmt: skip
OF_ALL_FILES = ("2.3", "2.4", "2.5", "5.6", "5.7", "5.9", "8.7")  # which the whole program breaks
Counts = dict[str, Counter[str]]  # of each rule: how often, by folder


def folder_of(file: str) -> str:
    """include/edmlift/body.h -> "include", lib/optional/camera/pnp.h -> "optional"."""
    parts = Path(file).resolve().relative_to(ROOT).parts
    return parts[0] if parts[0] == "include" else parts[1]


def count(sources: Sequence[Path]) -> Counts:
    """Breaks of each rule by sources and the headers that they include, each place once."""
    version = run("cppcheck", "--version")
    names = [str(source.relative_to(ROOT)) for source in sources]
    with tempfile.TemporaryDirectory() as folder:  # else it writes beside the sources
        done = subprocess.run(
            ["cppcheck", *OPTIONS, f"--cppcheck-build-dir={folder}", *INCLUDES, *names],
            cwd=ROOT, capture_output=True, text=True, check=False,
        )  # fmt: skip
    if done.returncode != 0 or "misra" not in done.stderr:
        raise ToolError(f"{version.strip()}: {done.stdout}{done.stderr}")
    found = set(re.findall(r"^(.*):misra-c2012-([\d.]+):(\d+:\d+)$", done.stderr, re.M))
    counts: Counts = {}
    for file, rule, _ in found:
        counts.setdefault(rule, Counter())[folder_of(file)] += 1
    if unknown := set(counts) - set(DEVIATIONS):
        places = sorted(f"{file}:{place}" for file, rule, place in found if rule in unknown)
        raise Disagreement(
            f"rules {', '.join(sorted(unknown))} have no reason: {', '.join(places)}"
        )
    return counts


def number(rule: str) -> tuple[int, ...]:
    return tuple(map(int, rule.split(".")))


def misra_table(counts: Counts) -> str:
    """A row a rule."""
    rows = {
        rule: [*DEVIATIONS[rule][:2], sum(counts[rule].values()),
               *(counts[rule][folder] for folder in FOLDERS), DEVIATIONS[rule].reason]
        for rule in sorted(counts, key=number)
    }  # fmt: skip
    return markdown.table("rule", ["", "asks for", "breaks", *FOLDERS, "why"], rows)


def read_table(text: str) -> Counts:
    """The counts of such a table."""
    counts: Counts = {}
    for line in text.strip().splitlines()[2:]:
        rule, _, _, _, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        numbers = map(int, cells[: len(FOLDERS)])
        counts[rule] = Counter({f: n for f, n in zip(FOLDERS, numbers, strict=True) if n})
    return counts


def check(counts: Counts, folders: Sequence[str] = FOLDERS) -> None:
    """Raises Disagreement where the page's counts in these folders are others; of some folders, by
    the rules for a single file."""
    written = read_table(markdown.read(PAGE, "misra"))
    left_out = () if len(folders) == len(FOLDERS) else OF_ALL_FILES
    for rule in sorted((written.keys() | counts.keys()) - set(left_out), key=number):
        for folder in folders:
            said, found = (c.get(rule, Counter())[folder] for c in (written, counts))
            if said != found:
                raise Disagreement(f"rule {rule} in {folder}: written {said}, found {found}")


def tables() -> Iterator[Table]:
    """The page's table."""
    counts = count(SOURCES)
    yield Table(PAGE, "misra", misra_table(counts), partial(check, counts))


def main() -> int:
    return run_report("misra", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
