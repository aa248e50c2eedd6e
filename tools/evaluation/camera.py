"""How well poses are placed before the camera, where the truth is known.

    evaluate.py camera TEST.npz [--model distances_f32] [--quick]
                [--update docs/where-in-the-room.md]

Poses are seen exactly (gt) and as by a detector (cpm), and are either the true ones or lifted.  The
root is mid-hip.  The rotation of a lifted pose is compared with the one that aligns it with the
truth.  A figure is the mean over subjects of their means.  Poses that cannot be placed are counted,
and left out.
"""

import argparse

import numpy as np
from tqdm import tqdm

from data import cameras
from data.mocap import Motion
from data.views import Column, views
from edmlift.joints import mid_hip
from edmlift.library import Library, Placements
from edmlift.metrics import best_rotation
from evaluation.command import Evaluation, Tables, load
from evaluation.measures import by_subject
from reports.markdown import table

COLUMNS = ("gt", "cpm")
INTRINSICS = (cameras.FOCAL, cameras.FOCAL, cameras.CENTRE, cameras.CENTRE)
SIZE = (2 * cameras.CENTRE, 2 * cameras.CENTRE)  # of the image

ROWS = {
    "root": "root, cm",
    "depth": "of that along the line of sight, cm",
    "rotation": "rotation, degrees",
    "joints": "joints about the root, mm",
    "unplaced": "joints about the root before, mm",
    "reprojection": "reprojection, pixels",
    "refused": "refused",
    "sweep_focal": "focal length, %",
    "sweep_root": "root, cm",
    "sweep_reprojection": "reprojection, pixels",
    "sweep_refused": "refused",
}


def rotation_between(points: np.ndarray, onto: np.ndarray) -> np.ndarray:
    """Rotations [F,3,3] that align points [F,14,3] best with others."""
    return best_rotation(points, onto).swapaxes(1, 2)


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles [F] in degrees between rotations [F,3,3]."""
    chord = np.linalg.norm(a - b, axis=(1, 2)) / np.sqrt(8)
    return np.degrees(2 * np.arcsin(np.clip(chord, 0, 1)))


def joint_error(points: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Mean distances [F] of joints, mm."""
    return 1000 * np.linalg.norm(points - truth, axis=-1).mean(1)


def measure(placed: Placements, poses: np.ndarray, truth: np.ndarray) -> dict[str, np.ndarray]:
    """Figures [F] of each placement of poses whose true joints are `truth`, both [F,14,3]."""
    root = mid_hip(truth)
    rooted = truth - root[:, None]
    off = placed.translation - root
    sight = root / np.linalg.norm(root, axis=1, keepdims=True)
    return {
        "root": 100 * np.linalg.norm(off, axis=1),
        "depth": 100 * np.abs((off * sight).sum(1)),
        "rotation": angle_between(placed.rotation, rotation_between(poses, truth)),
        "joints": joint_error(placed.joints - placed.translation[:, None], rooted),
        "unplaced": joint_error(poses, rooted),
        "reprojection": placed.reprojection,
        "focal": 100 * np.abs(placed.focal / cameras.FOCAL - 1),
    }


def evaluate_poses(
    library: Library, poses: np.ndarray, column: Column, subject: np.ndarray
) -> dict[str, float | int]:
    """Figures of a column, with the camera known and with its focal length swept for."""
    figures = {}
    for prefix, placed in (
        ("", library.place(poses, column.keypoints, INTRINSICS)),
        ("sweep_", library.place_sweep(poses, column.keypoints, SIZE)),
    ):
        fine = placed.status == "ok"
        for name, values in measure(placed, poses, column.truth).items():
            figures[prefix + name] = by_subject(np.where(fine, values, np.nan), subject).mean()
        figures[prefix + "refused"] = int((~fine).sum())
    return figures


def evaluate(library: Library, motion: Motion) -> dict[str, dict[str, float | int]]:
    """Figures of each kind of pose and 2D: {title: {figure: value}}."""
    columns = views(motion.joints)
    result = {}
    for name in tqdm(COLUMNS, desc="camera", disable=None):
        column = columns[name]
        rooted = column.truth - mid_hip(column.truth)[:, None]
        result[f"true pose, {name}"] = evaluate_poses(library, rooted, column, motion.subject)
        lifted = library.lift(column.keypoints)
        fine = lifted.status == "ok"
        result[f"lifted, {name}"] = evaluate_poses(
            library, lifted.joints[fine], column.take(fine), motion.subject[fine]
        )
    return result


def report(figures: dict[str, dict[str, float | int]]) -> str:
    """Two tables, the known camera and the sweep, a column a kind of pose and 2D."""
    parts = []
    for corner, sweep in (("camera known", False), ("focal length swept for", True)):
        rows = {
            title: [c[key] for c in figures.values()]
            for key, title in ROWS.items()
            if key.startswith("sweep_") == sweep
        }
        parts.append(table(corner, list(figures), rows))
    return "\n".join(parts)


def tables(args: argparse.Namespace) -> Tables:
    return {"camera": report(evaluate(*load(args)))}


EVALUATION = Evaluation(__doc__, tables)
