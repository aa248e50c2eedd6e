"""Operations of the fixed-point lift on motion capture, and that none of them overflows.

    run.py reports.operations TEST.npz [--update docs/no-fpu.md]

Every view of the protocol is lifted in integers that watch themselves (tests/overflow); their
results must be the library's, bit for bit.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from data.mocap import MocapError, Motion, load_motion
from data.paths import ROOT
from data.views import views
from edmlift.library import to_q16
from reports import markdown
from reports.targets import INCLUDES, SMALL_SOURCES, ToolError, library_flags, object_name, run

CHECK = ROOT / "tests" / "overflow"
KINDS = {
    "sums": "sums, differences, halves",
    "products": "products",
    "ratios": "ratios",
    "roots": "square roots",
}


def build(folder: Path) -> Path:
    """tests/overflow/count.c with the library and the lift in integers that watch themselves."""
    program, watched = folder / "count", folder / "watched.o"
    includes = [*INCLUDES, f"-I{CHECK}"]
    run("c++", "-std=gnu++11", "-O2", *includes, "-c", CHECK / "lift.cpp", "-o", watched)
    flags = [*library_flags(), "-O2", *includes]
    plain = [folder / "count.o", *(folder / object_name(source) for source in SMALL_SOURCES)]
    for item, source in zip(plain, [CHECK / "count.c", *SMALL_SOURCES], strict=True):
        run("cc", *flags, "-c", source, "-o", item)
    run("c++", *plain, watched, "-lm", "-o", program)
    return program


def count(motion: Motion) -> dict[str, Any]:
    """What tests/overflow/count.c prints of every view of the protocol."""
    keypoints = np.concatenate([column.keypoints for column in views(motion.joints).values()])
    with tempfile.TemporaryDirectory() as name:
        program = build(Path(name))
        done = subprocess.run([program], input=to_q16(keypoints).tobytes(), capture_output=True)
    if done.returncode != 0:
        raise ToolError(f"{program.name}: {done.stderr.decode()}")
    return json.loads(done.stdout)


def report(counts: dict[str, Any]) -> str:
    """The table, and a sentence that says what was checked."""
    rows = {title: [f"{number:,}" for number in counts[kind]] for kind, title in KINDS.items()}
    verdict = (
        f"{counts['lifted']:,} lifts, {counts['overflows']} overflows, "
        f"{counts['differences']} results other than the library's.\n"
    )
    return markdown.table("operations of a lift", ["mean", "largest"], rows) + "\n" + verdict


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--update", type=Path, metavar="FILE", help="Markdown file with marks")
    args = parser.parse_args()
    try:
        text = report(count(load_motion(args.motion)))
        print(text, end="")
        if args.update:
            markdown.write(args.update, "operations", text)
    except (MocapError, ToolError, OSError, ValueError) as error:
        print(f"operations: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
