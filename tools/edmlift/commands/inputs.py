"""What commands read: keypoints, which they lift, with poses and truth from other files."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from edmlift.commands.errors import CommandError, about_options
from edmlift.files import read_poses, read_truth
from edmlift.keypoint_files import Lines, read_source
from edmlift.keypoint_sets import count_of
from edmlift.keypoints import read_joints
from edmlift.lifting import Poses, lift

_LIFT_OPTIONS = (
    "model", "up", "format", "threshold", "image", "camera", "mirrored", "fixed", "threads",
)  # fmt: skip


def check_lift_options(options: argparse.Namespace) -> None:
    """Before a file is read: lifts nobody by these options."""
    with about_options():
        lift(np.zeros((0, count_of(options.format), 3)), **lift_options(options))


def lift_options(options: argparse.Namespace) -> dict[str, Any]:
    """What `lift` is to be given beside the keypoints."""
    return {name: getattr(options, name) for name in _LIFT_OPTIONS}


def lift_lines(lines: Lines, options: argparse.Namespace) -> Poses:
    """Poses of lines; what holds no person has the status of that."""
    poses = lift(lines.keypoints, **lift_options(options))
    return replace(poses, status=lines.statuses(poses.status))


def read_drawn(options: argparse.Namespace) -> Poses:
    """What is drawn: the keypoints of a file, with the poses of another or lifted here."""
    path = Path(options.keypoints)
    options.fixed, options.camera = False, None
    if options.lifted is None:
        check_lift_options(options)
    lines = read_source(path, options.format)
    if len(lines.problems) == len(lines.numbers):
        raise CommandError(
            ": ".join([f"{path}: holds no pose", *list(lines.problems.values())[:1]])
        )
    if options.lifted is None:
        return lift_lines(lines, options)
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


def read_truth_of(options: argparse.Namespace, count: int) -> np.ndarray | None:
    """The truth of so many poses, if there is a file of it."""
    truth = read_truth(options.truth) if options.truth else None
    if truth is not None and len(truth) != count:
        raise CommandError(
            f"the files must hold equally many poses: {options.keypoints} has {count}, "
            f"{options.truth} has {len(truth)}"
        )
    return truth
