"""How many files a change touches, before the library was one house and now: a table in Markdown.

    run.py reports.touched [--update docs/how-it-works.md]

The changes are those of the history.  THEN are the files of their commits; NOW are those that the
same change touches today, new ones first.  A test looks whether each is there.
"""

import argparse
import sys
from pathlib import Path

from data.paths import ROOT
from reports import markdown

Files = dict[str, tuple[list[str], list[str]]]  # part -> (new, edited)

THEN: dict[str, Files] = {
    "a detector format": {
        "library": ([], ["include/edmlift.h", "lib/formats.c"]),
        "tests": ([], ["tests/test_adapt.c"]),
    },
    "a network (FConv, commit 91ee116)": {
        "library": (
            ["lib/fconv.c", "lib/fconv.inc", "lib/fconv_f32.c", "lib/fconv_q7.c",
             "lib/pipeline_fconv_f32.c", "lib/pipeline_fconv_q24.c"],
            ["CMakeLists.txt", "include/edmlift.h", "lib/lift.inc", "lib/model.h", "lib/real_f32.h",
             "lib/real_q24.h"],
        ),
    },
    "a stage with settings, trained (fusion, commit 23a60c4)": {
        "library": (
            ["lib/blend.inc"],
            ["include/edmlift.h", "lib/lift.inc", "lib/model.h", "lib/orient.inc",
             "lib/pipeline_f32.c", "lib/pipeline_q24.c"],
        ),
        "tests": (
            ["tests/test_blend.c"],
            ["tests/CMakeLists.txt", "tests/bench/stages.h", "tests/check/check.cpp",
             "tests/python/test_reference.py", "tests/q24.c", "tests/q24.h", "tests/test_fconv.c",
             "tests/test_lift.c", "tests/test_lift_q24.c", "tests/tolerance.h"],
        ),
        "tools": (
            [],
            ["tools/edmlift.py", "tools/export_weights.py", "tools/fconn.py", "tools/network.py",
             "tools/reference.py", "tools/size_report.py", "tools/train.py", "tools/weights.py"],
        ),
    },
    "an optional part (joint limits, commits a171f54 and e5e831b)": {
        "library": (
            ["lib/limits.c", "lib/limits.h", "lib/limits.inc", "lib/limits_f32.c",
             "lib/limits_q24.c", "lib/torso.inc"],
            ["CMakeLists.txt", "include/edmlift.h", "lib/mirror.inc", "lib/pipeline_f32.c",
             "lib/pipeline_q24.c", "lib/real_f32.h"],
        ),
        "tests": (
            ["tests/check/limits.cpp", "tests/test_limits.c"],
            ["tests/CMakeLists.txt", "tests/check/check.cpp", "tests/check/check.h", "tests/q24.c",
             "tests/q24.h", "tests/test_check.c", "tests/tolerance.h"],
        ),
        "tools": (
            ["tools/evaluate_mirror.py", "tools/learn_limits.py"],
            ["tools/edmlift.py", "tools/reference.py"],
        ),
    },
}  # fmt: skip

NOW: dict[str, Files] = {
    "a detector format": {
        "library": ([], ["include/edmlift.h", "lib/joints/formats.c"]),
        "tests": ([], ["tests/unit/test_adapt.c"]),
    },
    "a network (FConv, commit 91ee116)": {
        "library": (
            ["lib/network/fconv.h", "lib/network/fconv_f32.c", "lib/network/fconv_w8.c",
             "lib/models/fconv_f32.c", "lib/models/fconv_w8.c"],
            ["include/edmlift.h"],
        ),
    },
    "a stage with settings, trained (fusion, commit 23a60c4)": {
        "library": (
            ["lib/lift/fuse.h"],
            ["include/edmlift/stages.h", "lib/api/api_q.h", "lib/lift/lift.h",
             "lib/network/model.h"],
        ),
        "tests": (
            ["tests/unit/test_fuse.c"],
            ["tests/overflow/api_checked.h", "tests/overflow/lift.cpp",
             "tests/python/model/test_reference.py", "tests/support/as_float.h",
             "tests/support/q24.c", "tests/support/q24.h", "tests/support/tolerance.h",
             "tests/targets/bench/stages.h", "tests/unit/test_fconv.c", "tests/unit/test_lift.c"],
        ),
        "tools": (
            [],
            ["tools/edmlift/_binding.py", "tools/edmlift/stages.py", "tools/export/header.py",
             "tools/export/settings.py", "tools/model/jax_stages.py", "tools/model/manifest.py",
             "tools/model/reference.py", "tools/reports/size.py", "tools/training/loss.py",
             "tools/training/recipe.py"],
        ),
    },
    "an optional part (joint limits, commits a171f54 and e5e831b)": {
        "library": (
            ["lib/optional/joint_limit_maps.c", "lib/optional/joint_limit_maps.h",
             "lib/optional/joint_limits.h", "lib/optional/joint_limits_f32.c",
             "lib/optional/joint_limits_q.c"],
            ["include/edmlift/body.h", "lib/api/api_q.h"],
        ),
        "tests": (
            ["tests/overflow/joint_limits.cpp", "tests/unit/test_joint_limits.c"],
            ["tests/overflow/api_checked.h", "tests/overflow/overflow.h",
             "tests/overflow/test_overflow.c", "tests/support/as_float.h", "tests/support/q24.c",
             "tests/support/q24.h", "tests/support/tolerance.h", "tests/unit/test_contract.c"],
        ),
        "tools": (
            ["tools/evaluation/mirror.py", "tools/fitting/joint_limits.py"],
            ["tools/edmlift/__init__.py", "tools/edmlift/_binding.py",
             "tools/edmlift/plausibility.py", "tools/model/reference.py"],
        ),
    },
}  # fmt: skip


def missing() -> list[str]:
    """Files of NOW that are not there."""
    named = [
        f for parts in NOW.values() for lists in parts.values() for part in lists for f in part
    ]
    return [name for name in named if not (ROOT / name).exists()]


def table() -> str:
    """A row a change; "6 + 1" is six new files and one edited."""
    parts = ("library", "tests", "tools")
    head = [f"{part}, {when}" for part in parts for when in ("then", "now")]
    rows = []
    for change, then in THEN.items():
        cells = []
        for part in parts:
            for files in (then, NOW[change]):
                new, edited = files.get(part, ([], []))
                cells.append(f"{len(new)} + {len(edited)}" if new or edited else "")
        rows.append(f"| {change} | {' | '.join(cells)} |")
    return "\n".join(
        [f"| new + edited files | {' | '.join(head)} |", "|---|" + "--:|" * len(head), *rows]
    )


def main(arguments: list[str] | None = None) -> int:
    """The command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog="reports.touched", description=__doc__.split("\n")[0])
    parser.add_argument("--update", type=Path, metavar="FILE", help="write between the marks there")
    options = parser.parse_args(arguments)
    gone = missing()
    if gone:
        print(f"reports.touched: not there: {', '.join(gone)}", file=sys.stderr)
        return 1
    if options.update:
        markdown.write(options.update, "files_touched", table())
    else:
        print(table())
    return 0


if __name__ == "__main__":
    sys.exit(main())
