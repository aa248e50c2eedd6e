"""edmlift draw."""

import argparse
from pathlib import Path

import numpy as np

from edmlift.commands.arguments import DOCUMENTATION, add_lift_options, add_shown_files
from edmlift.commands.errors import OptionError, about_options
from edmlift.commands.inputs import read_drawn, read_truth_of
from edmlift.drawing import COLUMNS, MAX_COLUMNS, draw, draw_joint_diagram, spread
from edmlift.lifting import Poses
from edmlift.metrics import mpjpe


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "draw",
        help="draw 2D poses beside the 3D ones lifted from them",
        description="Draws 2D poses beside the 3D ones lifted from them: a .png has a column a\n"
        "pose, each from the camera, the side and above; a .gif the sequence beside the figure,\n"
        "which rotates.  With --truth, the mean errors are printed as well.",
        epilog=DOCUMENTATION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("keypoints", nargs="?", help="file of 2D poses")
    add_shown_files(parser)
    parser.add_argument("--out", metavar="FILE", help="picture: .png or .gif")
    parser.add_argument(
        "--joint-diagram", metavar="FILE", help="draw the numbers and names of the joints, no more"
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--frames", type=int, metavar="N", help=f"columns, 1 to {MAX_COLUMNS} (default: {COLUMNS})"
    )
    which.add_argument("--frame", type=int, metavar="I", help="this frame alone, counted from 0")
    parser.add_argument("--title", help="heading of the picture")
    parser.add_argument(
        "--pitch", type=float, default=0.0, metavar="DEGREES",
        help="by which the camera looked down: the floor is level then (default: 0)",
    )  # fmt: skip
    parser.add_argument(
        "--fps", type=float, default=20.0, help="frames a second of a .gif (default: 20)"
    )
    add_lift_options(parser)
    parser.set_defaults(run=_draw)


def _draw(options: argparse.Namespace) -> int:
    if options.joint_diagram:
        draw_joint_diagram(options.joint_diagram)
        return 0
    if options.keypoints is None or options.out is None:
        raise OptionError("draw needs a file of 2D poses and --out, or --joint-diagram")
    poses = read_drawn(options)
    truth = read_truth_of(options, len(poses.joints))
    with about_options():
        draw(
            poses, options.out, truth=truth, title=options.title, pitch=options.pitch,
            frames=_frames(options, len(poses.joints)), pictures=options.pictures, fps=options.fps,
        )  # fmt: skip
    if truth is not None:
        _print_errors(poses, truth)
    return 0


def _frames(options: argparse.Namespace, count: int) -> list[int] | None:
    """The frames of a sheet; None for all of an animation."""
    if Path(options.out).suffix.lower() == ".gif":
        if (options.frame, options.frames) != (None, None):
            raise OptionError("--frame and --frames are for a .png; a .gif has the whole sequence")
        return None
    if options.frame is not None:
        if not 0 <= options.frame < count:
            raise OptionError(f"--frame {options.frame}: there are frames 0 to {count - 1}")
        return [options.frame]
    if options.frames is not None and not 1 <= options.frames <= MAX_COLUMNS:
        raise OptionError(f"--frames {options.frames}: must be 1 to {MAX_COLUMNS}")
    return spread(count, options.frames or COLUMNS)


def _print_errors(poses: Poses, truth: np.ndarray) -> None:
    text = f"{int(poses.ok.sum())} of {len(poses.joints)} poses lifted"
    if poses.ok.any():
        root, rigid = (1e3 * mpjpe(poses.joints, truth, align) for align in ("root", "rigid"))
        text += f"; mean error {root:.1f} mm root-relative, {rigid:.1f} mm after rigid alignment"
    print(text)
