"""Options that several commands have, and the types of their values."""

import argparse

from edmlift.keypoints import DETECTOR_THRESHOLD

UP = "upwards in the camera's axes, as 0,-1,0 of a level camera (default: not known)"
DOCUMENTATION = """\
keypoints: x,y or x,y,c of each joint, a pose a line, perhaps with a heading; or JSON as
detectors write it, in files that end in .jsonl, .ndjson or .json, or a folder of these
(docs/detectors.md)
"""


def add_shown_files(parser: argparse.ArgumentParser) -> None:
    """What is shown beside the keypoints, and where they were seen."""
    parser.add_argument(
        "lifted", nargs="?", help="3D poses as `edmlift lift` writes them (default: lifts)"
    )
    parser.add_argument("--truth", metavar="FILE", help="true 3D poses, 42 numbers a line, metres")
    parser.add_argument(
        "--pictures", nargs="+", metavar="FILE",
        help="what the keypoints were seen in: one picture, or one for each pose",
    )  # fmt: skip


def add_lift_options(parser: argparse.ArgumentParser) -> None:
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
        "--image", type=size, metavar="W,H",
        help="size of the image in pixels: keypoints outside are not seen; blazepose33 and "
        "movenet17 need it",
    )  # fmt: skip
    parser.add_argument(
        "--mirrored", action="store_true",
        help="the picture is a mirror image, as selfie cameras show it",
    )  # fmt: skip
    parser.add_argument("--up", type=direction, metavar="X,Y,Z", help=UP)
    parser.add_argument(
        "--threads", type=int, metavar="N", help="processors to use at most (default: all)"
    )


def size(text: str) -> tuple[float, float]:
    try:
        width, height = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be W,H in pixels, not {text!r}") from None
    return width, height


def direction(text: str) -> tuple[float, float, float]:
    try:
        x, y, z = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be X,Y,Z, not {text!r}") from None
    return x, y, z


def intrinsics(text: str) -> tuple[float, float, float, float]:
    try:
        fx, fy, cx, cy = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be FX,FY,CX,CY, not {text!r}") from None
    return fx, fy, cx, cy
