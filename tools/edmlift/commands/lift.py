"""edmlift lift."""

import argparse
import sys
from pathlib import Path
from typing import BinaryIO, TextIO

from edmlift.commands.arguments import DOCUMENTATION, add_lift_options, intrinsics
from edmlift.commands.errors import TROUBLE, CommandError, OptionError
from edmlift.commands.inputs import check_lift_options, lift_lines
from edmlift.commands.lift_tables import (
    TABLES,
    add_table_options,
    check_no_table_options,
    lift_table,
)
from edmlift.commands.motion_output import (
    MOTION,
    PLAIN_SUFFIXES,
    add_motion_options,
    check_motion_options,
    write_motion_file,
)
from edmlift.files import csv_lines, json_lines
from edmlift.keypoint_files import Lines, is_json, read_lines, read_source
from edmlift.motion import MOTION_SUFFIXES
from edmlift.placing import place
from edmlift.tables import is_table

SHOWN = 20  # of what cannot be read, a line each


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "lift",
        help="lift a file of 2D poses to 3D",
        description="Lifts a file of 2D poses to 3D, a line of input to a line of output.",
        epilog=DOCUMENTATION
        + "\n"
        + TABLES
        + "\n"
        + MOTION
        + "\nposes: status,x0,y0,z0,...,x13,y13,z13,misfit in metres; x right, y down, z away\n"
        "from the camera, origin between the hips.  A pose that cannot be lifted has another\n"
        "status than ok and empty fields; a frame without people has nobody; a line that is not a\n"
        "pose has bad_line, and the exit status is 1.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "keypoints",
        help="file of 2D poses, or folder of JSON files or tables; - is the standard input",
    )
    parser.add_argument("-o", "--out", metavar="FILE", help="default: the standard output")
    add_lift_options(parser)
    parser.add_argument("--fixed", action="store_true", help="lift in fixed point")
    parser.add_argument("--header", action="store_true", help="names of the columns first")
    parser.add_argument("--json", action="store_true", help="the input is JSON, whatever its name")
    add_motion_options(parser)
    add_table_options(parser)
    parser.add_argument(
        "--camera", type=intrinsics, metavar="FX,FY,CX,CY",
        help="of a camera that stands still, in pixels: in motion files and tables alone",
    )  # fmt: skip
    parser.set_defaults(run=_lift)


def _lift(options: argparse.Namespace) -> int:
    source = options.keypoints
    if source != "-" and is_table(source):
        return lift_table(options)
    check_no_table_options(options)
    as_json = options.json or (source != "-" and is_json(source))
    if as_json and options.header:
        raise OptionError("--header is for CSV, not for JSON lines")
    is_motion = _is_motion(options)
    check_lift_options(options)
    if source == "-":
        data = _bytes_of(sys.stdin, "input").read()
        lines = read_lines(data, options.format, as_json, source)
    else:
        lines = read_source(source, options.format, as_json)
    poses = lift_lines(lines, options)
    _say_problems(lines, source)
    for warning in poses.warnings:
        print(f"edmlift: warning: {warning}", file=sys.stderr)
    if is_motion:
        _check_one_person(lines, source)
        root = None if options.camera is None else place(poses, options.camera)
        write_motion_file(poses, options, root)
        return TROUBLE if lines.problems else 0
    text = json_lines(poses, lines.objects) if as_json else csv_lines(poses, options.header)
    out = "".join(f"{line}\n" for line in text).encode()
    if options.out is None:
        _bytes_of(sys.stdout, "output").write(out)
    else:
        Path(options.out).write_bytes(out)
    return TROUBLE if lines.problems else 0


def _say_problems(lines: Lines, source: str) -> None:
    """A line each of the first, because a file that is no text has many."""
    problems = list(lines.problems.items())
    for index, problem in problems[:SHOWN]:
        print(f"edmlift: {lines.where(index)}: {problem}", file=sys.stderr)
    if len(problems) > SHOWN:
        more = len(problems) - SHOWN
        print(f"edmlift: {source}: {more:,} more cannot be read", file=sys.stderr)
    if not lines.numbers:
        print(f"edmlift: warning: {source}: holds no keypoints", file=sys.stderr)


def _is_motion(options: argparse.Namespace) -> bool:
    """Is a motion file asked for?  Checks the options that are for these alone."""
    suffix = "" if options.out is None else Path(options.out).suffix.lower()
    if options.motion or suffix in set(MOTION_SUFFIXES) - set(PLAIN_SUFFIXES):
        check_motion_options(options)
        if options.header:
            raise OptionError("--header is not for motion files, which have names anyway")
        return True
    for name in ("fps", "camera"):
        if getattr(options, name) is not None:
            raise OptionError(
                f"--{name} is for motion files: -o must end in {', '.join(MOTION_SUFFIXES)} "
                "(.csv with --motion)"
            )
    return False


def _check_one_person(lines: Lines, source: str) -> None:
    """Several people of a frame would be frames of one."""
    if len(set(lines.frames)) < len(lines.frames):
        raise CommandError(
            f"{source}: has several people a frame, but a motion file is one person's: "
            "edmlift.track_people() tells them apart"
        )


def _bytes_of(stream: TextIO | None, name: str) -> BinaryIO:
    """A standard stream, in UTF-8 whatever the terminal has."""
    if stream is None:
        raise CommandError(f"the standard {name} is closed")
    return stream.buffer
