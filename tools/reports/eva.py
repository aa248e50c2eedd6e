"""What Frama-C's EVA proves of fixed point, as Markdown: no overflow, no index out of bounds.

    run.py reports.eva              prints the tables: seven minutes of a core
    run.py reports.eva --update     writes them to docs/proof.md
    run.py reports.eva NAME ...     runs these programs of tests/proof alone, on few sets of joints

EVA reads the texts of lib/ behind the words of tests/proof/proof.h.  Any alarm is an error.  What
EVA cannot see the texts say with ASSUME, ADD_TO, MUL_TO, DIV_TO, SHIFT_TO and TRUNCATE_TO, each
with its reason.
"""

import argparse
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from data.paths import DOCS, LIB, ROOT
from reports import markdown
from reports.command import Disagreement
from reports.targets import ToolError

PAGE = DOCS / "proof.md"
PROGRAMS = ROOT / "tests" / "proof"
# As a core of 32 bits without vector instructions compiles the library.
COMPILED = "-std=c99 -Iinclude -Ilib -Itests/proof -DEDML_BLOCKS_BY_ROW -U__SSE2__"
OPTIONS = (
    "-machdep", "gcc_x86_32", "-eva", "-eva-no-show-progress", "-eva-print-callstacks",
    "-warn-signed-downcast", "-eva-min-loop-unroll", "14", "-eva-auto-loop-unroll", "256",
    "-eva-msg-key=-loop-unroll,-final-states,-initial-state", "-metrics", "-metrics-eva-cover",
)  # fmt: skip
FEW_SETS, SETS = 1, 4  # joints missing at most, in the sets that are tried by imputation


class Program(NamedTuple):
    """One of tests/proof."""

    what: str  # goes in and comes out
    sources: tuple[str, ...] = ()  # beside it, below lib/
    options: tuple[str, ...] = ()


NETWORK = ("network/equivariant_w16", "network/predict_q")
# Where what a function returns says whether it wrote.
SPLIT = (
    "-eva-split-return", "full", "-eva-partition-history", "2",
    "-eva-interprocedural-history", "-eva-interprocedural-splits",
)  # fmt: skip
JOINTS = ("lift/imputation", "joints/joints")
ALL: dict[str, Program] = {
    "numbers": Program(
        "numbers of each length, normalised", ("number/fixed",), ("-eva-slevel", "200")
    ),
    "soften": Program("a distance of the image, softened"),
    "impute": Program("missing joints, for each set of seen joints", JOINTS),
    "body_frame": Program("keypoints to the body's frame", JOINTS),
    "network_direct": Program(
        "image and upward direction to points, by `edml_direct_w16`",
        (*NETWORK, "models/direct_w16", *JOINTS),
    ),
    "fuse": Program("points and image to a pose", JOINTS[1:]),
    "jacobi": Program("a symmetric matrix to its eigenvalues and vectors"),
    "mds": Program("distances to points", JOINTS[1:]),
    "network_distances": Program(
        "image and upward direction to distances and points, by `edml_distances_w16`",
        (*NETWORK, "models/distances_w16", *JOINTS),
    ),
    "network_fconn": Program(
        "image to distances, by `edml_fconn_w16`",
        ("network/fconn_w16", "network/predict_q", "models/fconn_w16", *JOINTS),
        ("-eva-min-loop-unroll", "16"),  # layers of 128 rows, 8 at a time
    ),
    "refine": Program(
        "points of distances moved downhill, by each objective",
        options=("-eva-partition-history", "1"),
    ),
    "orient": Program(
        "points of distances to the body's axes, by the image alone",
        JOINTS[1:],
        (*SPLIT, "-eva-slevel", "100"),
    ),
    "align": Program(
        "points of distances to the axes of the network's points",
        ("models/distances_w16", *JOINTS),
        (*SPLIT, "-eva-slevel", "100"),
    ),
    "mirror": Program(
        "points to those of the person or of their mirror image", ("models/fconn_w16", *JOINTS)
    ),
    "with_camera": Program(
        "keypoints and upward direction to a camera that looks at the person, and a pose back",
        JOINTS[1:],
        SPLIT,
    ),
    "place": Program("pose, keypoints and camera to a placement", JOINTS[1:], SPLIT),
}
FUNCTION = r"^\w[\w *()]*?\b(\w+)\([^;{]*\)\s*{(?:.*?)(?:^}|}$)"
SCOPE = ("api", "geometry", "lift", "optional/camera")  # folders of lib/: lift and placement
WORDS = "ASSUME|ADD_TO|MUL_TO|DIV_TO|SHIFT_TO|TRUNCATE_TO"


class Found(NamedTuple):
    """What EVA says of a program."""

    alarms: list[str]
    reached: dict[str, tuple[int, int]]  # of each function: statements reached, and all
    properties: int  # proved: preconditions of functions, and ranges


class Assumption(NamedTuple):
    """A line of lib/ that EVA believes."""

    file: str  # below lib/
    text: str
    reason: str  # "" where it has none


# ---- EVA ---------------------------------------------------------------------------------------


def analyse(name: str, most_missing: int = SETS, folder: Path = PROGRAMS) -> Found:
    """Runs EVA on a program of a folder.  ToolError where that fails."""
    program = ALL[name]
    sources = [f"lib/{source}.c" for source in program.sources]
    command = [
        "frama-c", *OPTIONS, *program.options,
        f"-cpp-extra-args={COMPILED} -DMOST_MISSING={most_missing}",
        str(folder / f"{name}.c"), *sources,
    ]  # fmt: skip
    here = os.environ | {"PWD": str(ROOT)}  # where Frama-C looks for the sources
    try:
        done = subprocess.run(
            command, cwd=ROOT, env=here, capture_output=True, text=True, check=False
        )
    except FileNotFoundError:
        raise ToolError("frama-c is not installed: apt-get install frama-c-base (0.9 GB)") from None
    if done.returncode != 0 or "ANALYSIS SUMMARY" not in done.stdout:
        raise ToolError(f"frama-c, {name}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    return read_output(done.stdout)


def read_output(text: str) -> Found:
    """What EVA printed."""
    alarms = re.findall(r"^\[eva:alarm\] (.*?)(?=^\[|^Frama|\Z)", text, re.M | re.S)
    counted = re.search(r"^  (\d+) alarms? generated", text, re.M)
    if counted is None or bool(int(counted[1])) and not alarms:
        raise ToolError("frama-c: cannot read what it says of alarms")
    functions = re.findall(r"^  (\w+): (\d+) stmts out of (\d+)", text, re.M)
    valid = sum(map(int, re.findall(r"(\d+) valid", text)))
    return Found(
        [" ".join(alarm.split()) for alarm in alarms],
        {name: (int(part), int(whole)) for name, part, whole in functions},
        valid,
    )


def demand_no_alarm(name: str, found: Found) -> None:
    if found.alarms:
        raise Disagreement(f"{name}: {len(found.alarms)} alarms\n" + "\n".join(found.alarms))


# ---- The library's texts -----------------------------------------------------------------------


def own_functions() -> set[str]:
    """The functions of lib/, with the names that they have in fixed point as well."""
    text = "\n".join(path.read_text("utf-8") for path in LIB.rglob("*.[ch]"))
    names = set(re.findall(r"^\w[\w *()]*?\b(\w+)\([^;{]*\)\s*{", text, re.M))
    return names | {f"{name}_q" for name in names if name.startswith("edml_")} | {
        name for name in re.findall(r"\((edml__\w+)\)\(", text)
    }  # fmt: skip


def is_assumption(line: str) -> bool:
    return re.search(rf"\b({WORDS})\(", line) is not None and not line.startswith("#define")


def comment_of(line: str) -> str:
    found = re.search(r"/\* (.*?) \*/$|^\s*(?:/\*|\*) (.*?)(?: \*/)?$", line)
    return (found[1] or found[2]) if found else ""


def assumptions_of(text: str, file: str) -> list[Assumption]:
    """Of a file.  The reason is behind the assumption, or above it: of several they share one."""
    found = []
    reason = ""
    for line in text.splitlines():
        if is_assumption(line):
            reason = comment_of(line) or reason
            found.append(Assumption(file, re.sub(r"\s*/\*.*", "", line).strip(), reason))
        elif comment_of(line) or line.endswith((";", "{", "}")):
            reason = comment_of(line)
    return found


def assumptions() -> list[Assumption]:
    """Of lib/."""
    return [
        assumption
        for path in sorted(LIB.rglob("*.h")) if not path.name.startswith("real_")
        for assumption in assumptions_of(path.read_text("utf-8"), str(path.relative_to(LIB)))
    ]  # fmt: skip


# ---- Tables ------------------------------------------------------------------------------------


def proof_table(found: dict[str, Found]) -> str:
    """A row a program, and one of all."""
    own = own_functions()
    rows: dict[str, Sequence[markdown.Figure]] = {}
    union: dict[str, tuple[int, int]] = {}
    for name, of in found.items():
        reached = {n: s for n, s in of.reached.items() if n in own}
        rows[f"`{name}`"] = [ALL[name].what, *sums(reached), of.properties, len(of.alarms)]
        for function, statements in reached.items():
            union[function] = max(statements, union.get(function, (0, 0)))
    rows["all"] = ["", *sums(union), *(sum(int(row[n]) for row in rows.values()) for n in (4, 5))]
    columns = ["", "functions", "statements reached", "of", "properties proved", "alarms left"]
    return markdown.table("program", columns, rows, markdown.counted, left=2)


def share_reached(found: dict[str, Found]) -> str:
    """How much of lift and placement the programs reach; of float, which has the same text, not."""
    reached = {name.removesuffix("_q") for of in found.values() for name in of.reached}
    texts = {
        match[1]: match[0].count("\n") + 1
        for folder in SCOPE for path in (LIB / folder).glob("*.h") if path.name != "api_f32.h"
        for match in re.finditer(FUNCTION, path.read_text("utf-8"), re.M | re.S)
    }  # fmt: skip
    part = [lines for name, lines in texts.items() if name in reached]
    folders = ", ".join(f"`{folder}`" for folder in SCOPE)
    return (
        f"They reach {len(part)} of the {len(texts)} functions, and {sum(part):,} of their "
        f"{sum(texts.values()):,} lines, in {folders} of `lib/`.\n"
    )


def sums(reached: dict[str, tuple[int, int]]) -> tuple[int, int, int]:
    """Functions, their statements that are reached, and all."""
    return len(reached), *(sum(s[n] for s in reached.values()) for n in (0, 1))


def escaped(text: str) -> str:
    """In a cell."""
    return text.replace("|", "\\|")


def assumed_table(found: Sequence[Assumption]) -> str:
    """A row an assumption.  Disagreement where one has no reason."""
    if without := [f"{a.file}: {a.text}" for a in found if not a.reason]:
        raise Disagreement("no reason beside it: " + "; ".join(without))
    rows = [(f"`{a.file}`", [escaped(f"`{a.text}`"), escaped(a.reason)]) for a in found]
    return markdown.table("file", ["assumed", "why"], rows, left=3)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", choices=[*ALL, []], metavar="NAME")
    parser.add_argument("--update", action="store_true")
    args = parser.parse_args()
    try:
        if args.update:
            markdown.write(PAGE, "assumed", assumed_table(assumptions()))
        found = {}
        for name in args.names or ALL:
            print(f"{name}: {ALL[name].what}", file=sys.stderr, flush=True)
            found[name] = analyse(name, FEW_SETS if args.names else SETS)
            demand_no_alarm(name, found[name])
        print(proof_table(found))
        if args.update and not args.names:
            markdown.write(PAGE, "proof", proof_table(found))
            markdown.write(PAGE, "reached", share_reached(found))
    except (Disagreement, ToolError, OSError, ValueError) as error:
        print(f"eva: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
