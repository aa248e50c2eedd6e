"""edmlift view."""

import argparse
import math
from pathlib import Path

from edmlift.commands.arguments import DOCUMENTATION, add_lift_options, add_shown_files
from edmlift.commands.errors import OptionError, about_options
from edmlift.commands.inputs import read_drawn, read_truth_of
from edmlift.joint_angles import LEVEL
from edmlift.plausibility import quality
from edmlift.viewing import PICTURE_SIDE, view


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "view",
        help="write a page to look at poses in a browser",
        description="Writes one HTML file that shows 2D poses beside the 3D ones lifted from\n"
        "them: a figure to turn, a time line, angles over time.  It needs no network.",
        epilog=DOCUMENTATION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("keypoints", help="file of 2D poses")
    add_shown_files(parser)
    parser.add_argument("-o", "--out", metavar="FILE", required=True, help="page: .html")
    parser.add_argument(
        "--picture-side", type=int, default=PICTURE_SIDE, metavar="PIXELS",
        help=f"pictures are reduced to this longer side (default: {PICTURE_SIDE})",
    )  # fmt: skip
    parser.add_argument("--title", help="heading of the page (default: the name of the file)")
    parser.add_argument(
        "--pitch", type=float, metavar="DEGREES",
        help="by which the camera looked down, instead of --up: the floor is level then",
    )  # fmt: skip
    parser.add_argument(
        "--fps", type=float, default=30.0, help="frames a second of the recording (default: 30)"
    )
    add_lift_options(parser)
    parser.set_defaults(run=_view)


def _view(options: argparse.Namespace) -> int:
    up = _upwards(options)
    poses = read_drawn(options)
    truth = read_truth_of(options, len(poses.joints))
    with about_options():
        view(
            poses, options.out, truth=truth, title=options.title, pictures=options.pictures,
            fps=options.fps, image=options.image, up=up, picture_side=options.picture_side,
            quality=None if options.lifted else quality(poses),
        )  # fmt: skip
    size = Path(options.out).stat().st_size
    print(f"{options.out}: {int(poses.ok.sum())} of {len(poses.joints)} poses, {size / 1e6:.1f} MB")
    return 0


def _upwards(options: argparse.Namespace) -> tuple[float, float, float]:
    """Where up is, of the two options that say it; a level camera's without them."""
    if options.pitch is None:
        return options.up or LEVEL
    if options.up is not None:
        raise OptionError("--pitch and --up both say where up is: give one")
    if not abs(options.pitch) <= 90:
        raise OptionError(f"pitch must be -90 to 90 degrees, not {options.pitch}")
    pitch = math.radians(options.pitch)
    return 0.0, -math.cos(pitch), -math.sin(pitch)
