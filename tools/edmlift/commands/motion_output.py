"""Motion files as the output of a command."""

import argparse
import sys
import warnings

from edmlift.commands.errors import OptionError, about_options
from edmlift.lifting import Poses
from edmlift.motion import MOTION_SUFFIXES, check_motion, write_motion
from edmlift.placing import Placements

PLAIN_SUFFIXES = (".csv",)  # of motion files that --motion asks for
MOTION = f"""\
motion files: FILE may end in {", ".join(s for s in MOTION_SUFFIXES if s not in PLAIN_SUFFIXES)},
for OpenSim, Blender and others; --motion makes one of a .csv, too.  Their axes are y up, x right,
z towards the camera; with --up the person stands on the floor.
"""


def add_motion_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--fps", type=float, metavar="N", help="frames a second of a motion file")
    parser.add_argument(
        "--motion", action="store_true", help="a .csv is a motion file: a column a joint and axis"
    )


def check_motion_options(options: argparse.Namespace) -> None:
    """Before a file is read: can a motion file be made of that name, at that rate?"""
    if options.out is None:
        raise OptionError("a motion file must have a name: -o FILE")
    with about_options():
        check_motion(options.out, options.fps)


def write_motion_file(
    poses: Poses, options: argparse.Namespace, root: Placements | None = None
) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        write_motion(options.out, poses, fps=options.fps, up=options.up, root=root)
    for warning in caught:
        print(f"edmlift: {warning.message}", file=sys.stderr)
