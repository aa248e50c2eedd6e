"""Operations of the fixed-point lift on motion capture, and that none of them overflows.

    count_operations.py TEST.npz                              prints the table
    count_operations.py TEST.npz --update docs/fixed_point.md writes it between the marks in a file

Every view of the protocol is lifted in integers that watch themselves (tests/overflow), whose results
must be the library's bit for bit.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import marks
from edmlift.library import to_q16
from evaluate import table, views
from firmware import INCLUDES, ROOT, SOURCES, ToolError, library_flags, run
from mocap import MocapError, Motion, load_motion

CHECK = ROOT / "tests" / "overflow"
KINDS = {
    "sums": "sums, differences, halves",
    "products": "products",
    "ratios": "ratios",
    "roots": "square roots",
}


def build(folder: Path) -> Path:
    """tests/overflow/count.c with the library and the integers that watch themselves."""
    includes = [*INCLUDES, f"-I{CHECK}"]
    watched = [folder / f"{source.stem}.o" for source in CHECK.glob("*.cpp")]
    for item in watched:
        source = CHECK / f"{item.stem}.cpp"
        run("c++", "-std=gnu++11", "-O2", *includes, "-c", source, "-o", item)
    program = folder / "count"
    flags = [*library_flags(), "-O2", *includes]
    plain = [folder / f"{source.stem}.plain.o" for source in [*SOURCES, CHECK / "count.c"]]
    for item, source in zip(plain, [*SOURCES, CHECK / "count.c"], strict=True):
        run("cc", *flags, "-c", source, "-o", item)
    run("c++", *plain, *watched, "-lm", "-o", program)
    return program


def count(motion: Motion) -> dict:
    """What tests/overflow/count.c prints of every view of the protocol."""
    keypoints = np.concatenate([column.keypoints for column in views(motion.joints).values()])
    with tempfile.TemporaryDirectory() as name:
        program = build(Path(name))
        done = subprocess.run([program], input=to_q16(keypoints).tobytes(), capture_output=True)
    if done.returncode != 0:
        raise ToolError(f"{program.name}: {done.stderr.decode()}")
    return json.loads(done.stdout)


def markdown(counts: dict) -> str:
    rows = {title: [f"{number:,}" for number in counts[kind]] for kind, title in KINDS.items()}
    verdict = (
        f"{counts['lifted']:,} lifts, {counts['overflows']} overflows, "
        f"{counts['differences']} results other than the library's.\n"
    )
    return table("operations of a lift", ["mean", "largest"], rows) + "\n" + verdict


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--update", type=Path, metavar="FILE", help="Markdown file with marks")
    args = parser.parse_args()
    try:
        text = markdown(count(load_motion(args.motion)))
        print(text, end="")
        if args.update:
            marks.write(args.update, "operations", text)
    except (MocapError, ToolError, OSError, ValueError) as error:
        print(f"count_operations: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
