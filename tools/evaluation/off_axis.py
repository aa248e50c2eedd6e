"""What a lift costs off the camera's axis, with the camera not told and told.

    evaluate.py off_axis TEST.npz OTHERS.npz [--models direct_f32] [--quick]
                [--update docs/where-in-the-room.md]

Exactly seen poses are turned about the camera by 0 to 30 degrees, each sideways and a little up or
down.  A figure is the mean error of a joint about mid-hip in the camera's axes: the mean over
subjects of their means, in mm.
"""

import argparse

import numpy as np
from tqdm import tqdm

from data import cameras
from data.mocap import Motion
from data.views import SEED, views
from edmlift.joints import mid_hip
from edmlift.library import Library
from evaluation.camera import INTRINSICS, joint_error
from evaluation.command import Evaluation, Tables, by_set, load_sets, set_options
from evaluation.measures import by_subject
from reports.markdown import table

DEGREES = (0, 10, 20, 30)
RISE = 0.6  # the largest turn up or down, a share of that sideways
MODELS = ("direct_f32",)
TOLD = {"": None, ", camera known": INTRINSICS}

Errors = dict[str, list[float]]  # mm at each of DEGREES


def turned(truth: np.ndarray, degrees: float, towards: np.ndarray) -> np.ndarray:
    """Joints [F,14,3] in camera axes, turned about the camera in directions [F] in radians: degrees
    to the right at 0, RISE of them down at pi / 2."""
    shares = np.stack([np.cos(towards), RISE * np.sin(towards)])[..., None]
    yaw, pitch = np.radians(degrees) * shares
    x, y, z = np.moveaxis(truth, -1, 0)
    y, z = np.cos(pitch) * y + np.sin(pitch) * z, np.cos(pitch) * z - np.sin(pitch) * y
    x, z = np.cos(yaw) * x + np.sin(yaw) * z, np.cos(yaw) * z - np.sin(yaw) * x
    return np.stack([x, y, z], -1)


def evaluate(models: list[str], motion: Motion) -> Errors:
    """The errors of each model, with the camera not told and told."""
    truth = views(motion.joints)["gt"].truth
    towards = np.random.default_rng(SEED).uniform(0, 2 * np.pi, len(truth))
    result: Errors = {f"{model}{title}": [] for model in models for title in TOLD}
    for degrees in tqdm(DEGREES, desc="off_axis", disable=None):
        there = turned(truth, degrees, towards)
        rooted = there - mid_hip(there)[:, None]
        keypoints = cameras.keypoints(cameras.project(there))
        for model in models:
            for title, camera in TOLD.items():
                lifted = Library(model).lift(keypoints, camera=camera)
                error = joint_error(lifted.joints, rooted)
                result[f"{model}{title}"].append(by_subject(error, motion.subject).mean())
    return result


def report(errors: Errors) -> str:
    """A row for each model and what it is told."""
    return table("mm", [f"{degrees} degrees" for degrees in DEGREES], errors)


def tables(args: argparse.Namespace) -> Tables:
    found = {name: evaluate(args.models, motion) for name, motion in load_sets(args).items()}
    return {"off_axis": by_set(report, found)}


EVALUATION = Evaluation(__doc__, tables, lambda parser: set_options(parser, MODELS))
