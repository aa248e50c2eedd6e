"""edmlift convert."""

import argparse

from edmlift.commands.arguments import UP, direction
from edmlift.commands.motion_output import MOTION, check_motion_options, write_motion_file
from edmlift.files import read_poses


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "convert",
        help="make a motion file of lifted poses",
        description="Makes a motion file of poses as `edmlift lift` and lift_stdin write them.",
        epilog=MOTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("lifted", help="file of 3D poses, a frame a line")
    parser.add_argument("-o", "--out", metavar="FILE", required=True, help="motion file")
    parser.add_argument("--fps", type=float, metavar="N", help="frames a second")
    parser.add_argument("--up", type=direction, metavar="X,Y,Z", help=UP)
    parser.set_defaults(run=_convert)


def _convert(options: argparse.Namespace) -> int:
    check_motion_options(options)
    write_motion_file(read_poses(options.lifted), options)
    return 0
