"""Reprojection error by body part of poses lifted from annotated images: the paper's LSP table.

    evaluate.py reproject joints.mat                        LSP's annotations
    evaluate.py reproject ANNOTATED.csv --size 1920 1080    28 or 42 numbers a line (lift_stdin's)
    evaluate.py reproject ANNOTATED --detections DETECTED   lifts from a detector's joints instead

Each pose is lifted, placed before a camera whose focal length is swept for, and seen by it; the
error is the mean distance in pixels from the annotated joints.  Without --size the image is taken
to be the joints' box with a fifth of it around, as LSP's crops are.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import scipy.io

from edmlift.joints import JOINTS, indices
from edmlift.library import Library, Placements
from evaluation.command import Evaluation, Tables
from reports.markdown import table

# LSP's order: the right leg from the ankle up, the left one from the hip down, the arms likewise
# from the right wrist to the left, neck, head (its top).  The index there of each of our joints:
LSP = [13, 12, 8, 7, 6, 9, 10, 11, 2, 1, 0, 3, 4, 5]

PARTS = {
    "feet": ("right_ankle", "left_ankle"),
    "knees": ("right_knee", "left_knee"),
    "hips": ("right_hip", "left_hip"),
    "hands": ("right_wrist", "left_wrist"),
    "elbows": ("right_elbow", "left_elbow"),
    "shoulders": ("right_shoulder", "left_shoulder"),
    "head": ("head",),
    "neck": ("neck_base",),
}
MARGIN = 0.2  # of the joints' box


def read_keypoints(path: Path) -> np.ndarray:
    """Keypoints [F,14,3] of a .mat of LSP's layout, or of lines of numbers."""
    return read_lsp(path) if path.suffix == ".mat" else read_lines(path)


def read_lsp(path: Path) -> np.ndarray:
    """`joints` [3,14,F]: rows x, y, occluded; [14,3,F] and a third row `visible` in LSP extended.

    Hidden joints are annotated as well, and count as seen; zeros in LSP extended do not.
    """
    contents = scipy.io.loadmat(path)
    if "joints" not in contents:
        raise ValueError(f"{path}: no variable `joints`")
    joints = contents["joints"].astype(float)
    if joints.ndim != 3 or joints.shape[:2] not in ((3, 14), (14, 3)):
        raise ValueError(f"{path}: joints are {joints.shape}, not (3, 14, N) or (14, 3, N)")
    joints = joints.transpose(2, 1, 0) if joints.shape[0] == 3 else joints.transpose(2, 0, 1)
    at = joints[:, LSP, :2]
    seen = np.isfinite(at).all(-1) & (at != 0).any(-1)
    return np.where(seen[..., None], np.concatenate([at, np.ones_like(at[..., :1])], -1), 0.0)


def read_lines(path: Path) -> np.ndarray:
    """Lines of 28 (x y) or 42 (x y c) numbers, separated by commas or blanks."""
    lines = [line.replace(",", " ") for line in path.read_text().splitlines()]
    numbers = np.loadtxt(lines, ndmin=2)
    count = len(JOINTS)
    if numbers.shape[1] == 3 * count:
        return numbers.reshape(-1, count, 3)
    if numbers.shape[1] != 2 * count:
        raise ValueError(f"{path}: lines of {numbers.shape[1]} numbers, not 28 or 42")
    at = numbers.reshape(-1, count, 2)
    return np.concatenate([at, np.ones_like(at[..., :1])], -1)


def frame(keypoints: np.ndarray, size: tuple[float, float] | None) -> tuple[np.ndarray, np.ndarray]:
    """Corner and size [F,2] of each image."""
    if size is not None:
        return np.zeros((len(keypoints), 2)), np.tile(np.asarray(size, float), (len(keypoints), 1))
    seen = keypoints[..., 2:] > 0
    low = np.where(seen, keypoints[..., :2], np.inf).min(1)
    high = np.where(seen, keypoints[..., :2], -np.inf).max(1)
    known = seen.any((1, 2))[:, None]
    low, high = np.where(known, low, 0), np.where(known, high, 1)
    around = MARGIN * (high - low)
    return low - around, high - low + 2 * around


def project(placed: Placements, size: np.ndarray) -> np.ndarray:
    """Where the joints of placements are seen [F,14,2], in images of these sizes [F,2]."""
    at = placed.joints[..., :2] / placed.joints[..., 2:]
    return placed.focal[:, None, None] * at + size[:, None] / 2


def errors(points: np.ndarray, annotated: np.ndarray) -> dict[str, float]:
    """Mean distance in pixels of points [F,14,2] from annotated joints [F,14,3], by body part."""
    distance = np.linalg.norm(points - annotated[..., :2], axis=-1)
    distance = np.where(annotated[..., 2] > 0, distance, np.nan)
    result = {part: float(np.nanmean(distance[:, indices(j)])) for part, j in PARTS.items()}
    result["mean"] = float(np.nanmean(distance))
    return result


def reproject(
    library: Library, keypoints: np.ndarray, size: tuple[float, float] | None
) -> tuple[np.ndarray, np.ndarray]:
    """Where the joints of the lifted and placed poses are seen [F,14,2], and statuses [F]."""
    corner, sizes = frame(keypoints, size)
    moved = keypoints.copy()
    moved[..., :2] -= corner[:, None]
    lifted = library.lift(moved)
    placed = library.place_sweep(np.nan_to_num(lifted.joints), moved, sizes)
    status = np.where(lifted.status == "ok", placed.status, lifted.status)
    points = project(placed, sizes) + corner[:, None]
    return np.where((status == "ok")[:, None, None], points, np.nan), status


def report(rows: dict[str, dict[str, float]]) -> str:
    """A row a source of the 2D, a column a part of the body."""
    columns = [*PARTS, "mean"]
    cells = {title: [f"{row[c]:.2f}" for c in columns] for title, row in rows.items()}
    return table("pixels", columns, cells)


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("annotated", type=Path, help=".mat of LSP's layout, or lines of numbers")
    parser.add_argument("--detections", type=Path, help="a detector's joints of the same images")
    parser.add_argument("--size", type=float, nargs=2, metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--model", default="distances_f32", help="(%(default)s)")


def tables(args: argparse.Namespace) -> Tables:
    library, annotated = Library(args.model), read_keypoints(args.annotated)
    sources = {"annotated": annotated}
    if args.detections:
        sources["detected"] = read_keypoints(args.detections)
        if len(sources["detected"]) != len(annotated):
            raise ValueError(f"{len(sources['detected'])} detections of {len(annotated)} images")
    rows = {}
    for title, source in sources.items():
        points, status = reproject(library, source, args.size)
        if title == "detected":
            at = np.where(source[..., 2:] > 0, source[..., :2], np.nan)
            rows["detections"] = errors(at, annotated)
        rows[f"lifted from {title}"] = errors(points, annotated)
        print(f"{title}: {(status == 'ok').sum()} of {len(status)} poses placed", file=sys.stderr)
    return {"reproject": report(rows)}


EVALUATION = Evaluation(__doc__, tables, options)
