"""Motion files: how far a skeleton of constant bones is from the poses, and what an hour costs.

    evaluate.py motion_files [--update docs/files.md]

The clips are those of examples/data.  The files are written to a temporary folder.
"""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

import edmlift
from edmlift.body import BONE_NAMES
from edmlift.motion.bones import constant_lengths
from evaluation.command import Evaluation, Tables
from reports.markdown import Figure, table

DATA = Path(__file__).resolve().parents[2] / "examples" / "data"
CLIPS = ("walk", "cartwheel", "kick")
FPS = 30
LONG = 65535  # frames, the most of a .c3d
MM, MB = 1000.0, 1e-6


def bone_lengths(joints: np.ndarray) -> dict[str, float]:
    """Median lengths of a clip [F,14,3] in metres, as fit_body() takes them."""
    starts, ends = np.array(edmlift.BONES).T
    lengths = np.median(np.linalg.norm(joints[:, ends] - joints[:, starts], axis=-1), axis=0)
    return dict(zip(BONE_NAMES, lengths.tolist(), strict=True))


def figures(poses: edmlift.Poses, truth: np.ndarray) -> list[Figure]:
    """How far joints move when bones get their median length, mean and most; errors before and
    after; mm."""
    joints = poses.joints[poses.ok].astype(float)
    rigid = constant_lengths(joints)
    moved = np.linalg.norm(rigid - joints, axis=-1)
    errors = [edmlift.mpjpe(given, truth[poses.ok], "rigid") for given in (joints, rigid)]
    return [MM * float(value) for value in (moved.mean(), moved.max(), *errors)]


def skeleton_table() -> str:
    """A row a clip and kind of poses."""
    rows: dict[str, list[Figure]] = {}
    for clip in CLIPS:
        keypoints = edmlift.read_keypoints(DATA / f"{clip}.csv")
        truth = edmlift.read_truth(DATA / f"{clip}_truth.csv")
        tracked = edmlift.track(keypoints, fps=FPS)
        known = edmlift.fit_body(tracked, bones=bone_lengths(truth))
        rows[f"{clip}, recorded"] = figures(edmlift.Poses.of(truth), truth)
        rows[f"{clip}, lifted"] = figures(edmlift.lift(keypoints), truth)
        rows[f"{clip}, tracked"] = figures(tracked, truth)
        rows[f"{clip}, tracked, bones known"] = figures(known, truth)
    heads = ["moved, mm", "the most", "error of the poses, mm", "of the file, mm"]
    return table("clip", heads, rows)


def cost_table() -> str:
    """A row a kind of file: megabytes and seconds of LONG frames."""
    walk = edmlift.lift(edmlift.read_keypoints(DATA / "walk.csv"))
    poses = edmlift.Poses.of(np.resize(walk.joints, (LONG, *walk.joints.shape[1:])))
    rows: dict[str, list[Figure]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for suffix in edmlift.MOTION_SUFFIXES:
            path = Path(folder) / f"long{suffix}"
            start = time.perf_counter()
            edmlift.write_motion(path, poses, fps=FPS, up=(0, -1, 0))
            rows[f"`{suffix}`"] = [MB * path.stat().st_size, time.perf_counter() - start]
    return table("file", ["MB", "seconds"], rows)


def options(_parser: argparse.ArgumentParser) -> None:
    """None: the clips are in the repository."""


def tables(_args: argparse.Namespace) -> Tables:
    return {"skeleton": skeleton_table(), "long": cost_table()}


EVALUATION = Evaluation(__doc__, tables, options)
