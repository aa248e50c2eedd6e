"""The command line: edmlift lift, convert, draw, view, models, formats."""

import argparse
import contextlib
import math
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO, TextIO

import numpy as np

from edmlift._binding import JOINT_COUNT
from edmlift._version import __version__
from edmlift.drawing import COLUMNS, MAX_COLUMNS, draw, draw_joint_diagram, spread
from edmlift.files import csv_lines, json_lines, read_poses, read_truth
from edmlift.formats import FORMATS, find_format
from edmlift.joint_angles import LEVEL
from edmlift.keypoint_files import Lines, is_json, read_lines, read_source
from edmlift.keypoints import DETECTOR_THRESHOLD, read_joints
from edmlift.lifting import Poses, lift
from edmlift.metrics import mpjpe
from edmlift.motion import MOTION_SUFFIXES, check_motion, write_motion
from edmlift.networks import models
from edmlift.placing import Placements, place
from edmlift.plausibility import quality
from edmlift.viewing import PICTURE_SIDE, view

_UP = "upwards in the camera's axes, as 0,-1,0 of a level camera (default: not known)"
TROUBLE, WRONG_OPTION = 1, 2  # exit statuses; argparse has the second, too
_DOCUMENTATION = """\
keypoints: x,y or x,y,c of each joint, a pose a line, perhaps with a heading; or JSON as
detectors write it, in files that end in .jsonl, .ndjson or .json, or a folder of these
(docs/detectors.md)
"""
_PLAIN_SUFFIXES = (".csv",)  # of motion files that --motion asks for
_MOTION = f"""\
motion files: FILE may end in {", ".join(s for s in MOTION_SUFFIXES if s not in _PLAIN_SUFFIXES)},
for OpenSim, Blender and others; --motion makes one of a .csv, too.  Their axes are y up, x right,
z towards the camera; with --up the person stands on the floor.
"""


class CommandError(Exception):
    """What is wrong, in one line."""


class OptionError(CommandError):
    """What is wrong with an option."""


@contextlib.contextmanager
def _options() -> Iterator[None]:
    """A ValueError in here is about an option."""
    try:
        yield
    except ValueError as error:
        raise OptionError(str(error)) from None


# ---- Options -----------------------------------------------------------------------------------


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="edmlift", description="2D joints of a person in, a 3D pose in metres out."
    )
    parser.add_argument("--version", action="version", version=f"edmlift {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _add_lift(commands)
    _add_convert(commands)
    _add_draw(commands)
    _add_view(commands)
    names = commands.add_parser("models", help="print the names of the networks")
    names.set_defaults(run=_print_models)
    names = commands.add_parser("formats", help="print the detectors' formats and their keypoints")
    names.set_defaults(run=_print_formats)
    return parser


def _add_lift(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "lift",
        help="lift a file of 2D poses to 3D",
        description="Lifts a file of 2D poses to 3D, a line of input to a line of output.",
        epilog=_DOCUMENTATION
        + "\n"
        + _MOTION
        + "\nposes: status,x0,y0,z0,...,x13,y13,z13,misfit in metres; x right, y down, z away\n"
        "from the camera, origin between the hips.  A pose that cannot be lifted has another\n"
        "status than ok and empty fields; a frame without people has nobody; a line that is not a\n"
        "pose has bad_line, and the exit status is 1.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "keypoints", help="file of 2D poses, or folder of JSON files; - is the standard input"
    )
    parser.add_argument("-o", "--out", metavar="FILE", help="default: the standard output")
    _add_lift_options(parser)
    parser.add_argument("--fixed", action="store_true", help="lift in fixed point")
    parser.add_argument("--header", action="store_true", help="names of the columns first")
    parser.add_argument("--json", action="store_true", help="the input is JSON, whatever its name")
    _add_motion_options(parser)
    parser.add_argument(
        "--camera", type=_intrinsics, metavar="FX,FY,CX,CY",
        help="of a camera that stands still, in pixels: the person moves through the room",
    )  # fmt: skip
    parser.set_defaults(run=_lift)


def _add_convert(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "convert",
        help="make a motion file of lifted poses",
        description="Makes a motion file of poses as `edmlift lift` and lift_stdin write them.",
        epilog=_MOTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("lifted", help="file of 3D poses, a frame a line")
    parser.add_argument("-o", "--out", metavar="FILE", required=True, help="motion file")
    parser.add_argument("--fps", type=float, metavar="N", help="frames a second")
    parser.add_argument("--up", type=_direction, metavar="X,Y,Z", help=_UP)
    parser.set_defaults(run=_convert)


def _add_motion_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--fps", type=float, metavar="N", help="frames a second of a motion file")
    parser.add_argument(
        "--motion", action="store_true", help="a .csv is a motion file: a column a joint and axis"
    )


def _add_lift_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--model", metavar="NAME", help="see `edmlift models`")
    parser.add_argument(
        "--format", metavar="NAME", help="the detector's, see `edmlift formats` (default: joints)"
    )
    parser.add_argument(
        "--threshold", type=float, metavar="C",
        help="keypoints with confidence <= C are not seen "
        f"(default: {DETECTOR_THRESHOLD} with --format, else 0)",
    )  # fmt: skip
    parser.add_argument(
        "--image", type=_size, metavar="W,H",
        help="size of the image in pixels: keypoints outside are not seen; blazepose33 and "
        "movenet17 need it",
    )  # fmt: skip
    parser.add_argument(
        "--mirrored", action="store_true",
        help="the picture is a mirror image, as selfie cameras show it",
    )  # fmt: skip
    parser.add_argument("--up", type=_direction, metavar="X,Y,Z", help=_UP)


def _size(text: str) -> tuple[float, float]:
    try:
        width, height = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be W,H in pixels, not {text!r}") from None
    return width, height


def _direction(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be X,Y,Z, not {text!r}") from None
    return x, y, z


def _intrinsics(text: str) -> tuple[float, float, float, float]:
    try:
        fx, fy, cx, cy = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be FX,FY,CX,CY, not {text!r}") from None
    return fx, fy, cx, cy


def _add_draw(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "draw",
        help="draw 2D poses beside the 3D ones lifted from them",
        description="Draws 2D poses beside the 3D ones lifted from them: a .png has a column a\n"
        "pose, each from the camera, the side and above; a .gif the sequence beside the figure,\n"
        "which rotates.  With --truth, the mean errors are printed as well.",
        epilog=_DOCUMENTATION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("keypoints", nargs="?", help="file of 2D poses")
    parser.add_argument(
        "lifted", nargs="?", help="3D poses as `edmlift lift` writes them (default: lifts)"
    )
    parser.add_argument("--out", metavar="FILE", help="picture: .png or .gif")
    parser.add_argument(
        "--joint-diagram", metavar="FILE", help="draw the numbers and names of the joints, no more"
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--frames", type=int, metavar="N", help=f"columns, 1 to {MAX_COLUMNS} (default: {COLUMNS})"
    )
    which.add_argument("--frame", type=int, metavar="I", help="this frame alone, counted from 0")
    parser.add_argument("--truth", metavar="FILE", help="true 3D poses, 42 numbers a line, metres")
    parser.add_argument(
        "--pictures", nargs="+", metavar="FILE",
        help="what the keypoints were seen in: one picture, or one for each pose",
    )  # fmt: skip
    parser.add_argument("--title", help="heading of the picture")
    parser.add_argument(
        "--pitch", type=float, default=0.0, metavar="DEGREES",
        help="by which the camera looked down: the floor is level then (default: 0)",
    )  # fmt: skip
    parser.add_argument(
        "--fps", type=float, default=20.0, help="frames a second of a .gif (default: 20)"
    )
    _add_lift_options(parser)
    parser.set_defaults(run=_draw)


def _add_view(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    parser = commands.add_parser(
        "view",
        help="write a page to look at poses in a browser",
        description="Writes one HTML file that shows 2D poses beside the 3D ones lifted from\n"
        "them: a figure to turn, a time line, angles over time.  It needs no network.",
        epilog=_DOCUMENTATION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("keypoints", help="file of 2D poses")
    parser.add_argument(
        "lifted", nargs="?", help="3D poses as `edmlift lift` writes them (default: lifts)"
    )
    parser.add_argument("-o", "--out", metavar="FILE", required=True, help="page: .html")
    parser.add_argument("--truth", metavar="FILE", help="true 3D poses, 42 numbers a line, metres")
    parser.add_argument(
        "--pictures", nargs="+", metavar="FILE",
        help="what the keypoints were seen in: one picture, or one for each pose",
    )  # fmt: skip
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
    _add_lift_options(parser)
    parser.set_defaults(run=_view)


# ---- Commands ----------------------------------------------------------------------------------


def _print_models(_options: argparse.Namespace) -> int:
    print(*models(), sep="\n")
    return 0


def _print_formats(_options: argparse.Namespace) -> int:
    for name, keypoints in FORMATS.items():
        print(name, keypoints)
    return 0


def _lift(options: argparse.Namespace) -> int:
    source = options.keypoints
    as_json = options.json or (source != "-" and is_json(source))
    if as_json and options.header:
        raise OptionError("--header is for CSV, not for JSON lines")
    is_motion = _is_motion(options)
    _check_lift_options(options)
    if source == "-":
        data = _bytes_of(sys.stdin, "input").read()
        lines = read_lines(data, options.format, as_json, source)
    else:
        lines = read_source(source, options.format, as_json)
    poses = _lift_lines(lines, options)
    for index, problem in lines.problems.items():
        print(f"edmlift: {lines.where(index)}: {problem}", file=sys.stderr)
    for warning in poses.warnings:
        print(f"edmlift: warning: {warning}", file=sys.stderr)
    if is_motion:
        _check_one_person(lines, source)
        root = None if options.camera is None else place(poses, options.camera)
        _write_motion(poses, options, root)
        return TROUBLE if lines.problems else 0
    text = json_lines(poses, lines.objects) if as_json else csv_lines(poses, options.header)
    out = "".join(f"{line}\n" for line in text).encode()
    if options.out is None:
        _bytes_of(sys.stdout, "output").write(out)
    else:
        Path(options.out).write_bytes(out)
    return TROUBLE if lines.problems else 0


def _convert(options: argparse.Namespace) -> int:
    _check_motion(options)
    _write_motion(read_poses(options.lifted), options)
    return 0


def _is_motion(options: argparse.Namespace) -> bool:
    """Is a motion file asked for?  Checks the options that are for these alone."""
    suffix = "" if options.out is None else Path(options.out).suffix.lower()
    if options.motion or suffix in set(MOTION_SUFFIXES) - set(_PLAIN_SUFFIXES):
        _check_motion(options)
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


def _check_motion(options: argparse.Namespace) -> None:
    """Before a file is read: can a motion file be made of that name, at that rate?"""
    if options.out is None:
        raise OptionError("a motion file must have a name: -o FILE")
    with _options():
        check_motion(options.out, options.fps)


def _write_motion(
    poses: Poses, options: argparse.Namespace, root: Placements | None = None
) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)
        write_motion(options.out, poses, fps=options.fps, up=options.up, root=root)
    for warning in caught:
        print(f"edmlift: {warning.message}", file=sys.stderr)


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


def _check_lift_options(options: argparse.Namespace) -> None:
    """Before a file is read: lifts nobody by these options."""
    with _options():
        count = JOINT_COUNT if options.format is None else find_format(options.format).keypoints
        lift(
            np.zeros((0, count, 3)), options.model, options.up, format=options.format,
            threshold=options.threshold, image=options.image, camera=options.camera,
            mirrored=options.mirrored,
            fixed=options.fixed,
        )  # fmt: skip


def _lift_lines(lines: Lines, options: argparse.Namespace) -> Poses:
    """Poses of lines; what holds no person has the status of that."""
    poses = lift(
        lines.keypoints, options.model, options.up, format=options.format,
        threshold=options.threshold, image=options.image, camera=options.camera,
        mirrored=options.mirrored, fixed=options.fixed,
    )  # fmt: skip
    return replace(poses, status=lines.statuses(poses.status))


def _draw(options: argparse.Namespace) -> int:
    if options.joint_diagram:
        draw_joint_diagram(options.joint_diagram)
        return 0
    if options.keypoints is None or options.out is None:
        raise OptionError("draw needs a file of 2D poses and --out, or --joint-diagram")
    poses = _read_drawn(options)
    truth = _read_truth(options, len(poses.joints))
    with _options():
        draw(
            poses, options.out, truth=truth, title=options.title, pitch=options.pitch,
            frames=_frames(options, len(poses.joints)), pictures=options.pictures, fps=options.fps,
        )  # fmt: skip
    if truth is not None:
        _print_errors(poses, truth)
    return 0


def _view(options: argparse.Namespace) -> int:
    up = _upwards(options)
    poses = _read_drawn(options)
    truth = _read_truth(options, len(poses.joints))
    with _options():
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


def _read_truth(options: argparse.Namespace, count: int) -> np.ndarray | None:
    """The truth of so many poses, if there is a file of it."""
    truth = read_truth(options.truth) if options.truth else None
    if truth is not None and len(truth) != count:
        raise CommandError(
            f"the files must hold equally many poses: {options.keypoints} has {count}, "
            f"{options.truth} has {len(truth)}"
        )
    return truth


def _read_drawn(options: argparse.Namespace) -> Poses:
    """What is drawn: the keypoints of a file, with the poses of another or lifted here."""
    path = Path(options.keypoints)
    options.fixed, options.camera = False, None
    if options.lifted is None:
        _check_lift_options(options)
    lines = read_source(path, options.format)
    if len(lines.problems) == len(lines.numbers):
        raise CommandError(
            ": ".join([f"{path}: holds no pose", *list(lines.problems.values())[:1]])
        )
    if options.lifted is None:
        return _lift_lines(lines, options)
    joints, _ = read_joints(
        lines.keypoints, options.format, options.threshold, options.image, options.mirrored
    )
    poses = read_poses(options.lifted)
    if len(poses.joints) != len(joints):
        raise CommandError(
            f"the files must hold equally many poses: {options.keypoints} has {len(joints)}, "
            f"{options.lifted} has {len(poses.joints)}"
        )
    return replace(poses, keypoints=joints, seen=joints[..., 2] > 0)


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


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command; returns its exit status: 0, 1 for trouble with files, 2 for wrong options."""
    options = _parser().parse_args(arguments)
    code = TROUBLE
    try:
        status: int = options.run(options)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except BrokenPipeError:  # whoever read the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return TROUBLE
    except OSError as error:
        name = f"{error.filename}: " if error.filename else ""
        message = f"{name}{error.strerror or error}"
    except (CommandError, ImportError, ValueError) as error:
        message = str(error)
        if isinstance(error, OptionError):
            code = WRONG_OPTION
    print(f"edmlift: {message}", file=sys.stderr)
    return code
