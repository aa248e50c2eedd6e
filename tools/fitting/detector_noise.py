"""Measures how real detectors err, joint by joint: tables for docs/detections.md.

    run.py fitting.detector_noise [--update docs/detections.md]

Four cameras see one man, and each detector's keypoints are held against what is triangulated from
them.  Errors are in the image's axes, in millimetres at the man's distance, an axis.  A view in
which all joints are shifted alike says how well its camera was calibrated, and a lift does not see
it: this `shift` is left out.  Of what is left,

    offset  is the mean over the clip, by view and joint
    slow    is what half-seconds differ from it
    fast    is what frames differ from their half-second

so that the squares of the three add up to the mean square of all.  What a detector gets wrong in
all views alike is in its triangulation, too: there only another detector shows it, by a table of
its own.

The last table is what the imitated detector of data/cameras.py could take from this.  Nothing does.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from data import cameras
from data.detections import (
    BEAM,
    BLAZEPOSE,
    CAMERAS,
    DETECTORS,
    FIRST,
    LIGHTNING,
    RATE,
    THUNDER,
    Clip,
    Detector,
    beside,
    read_beam,
)
from data.triangulate import read_cameras
from edmlift.joints import INDEX, JOINTS, mid_hip, mid_shoulder
from edmlift.library import Library
from fitting.body import JOINT_TYPE, joint_types
from reports import markdown
from reports.markdown import table

PERSISTS = 0.5  # seconds
PARTS = ("offset", "slow", "fast", "all")
MEDIAN = np.sqrt(2 * np.log(2))  # distance, in sigmas of an axis
SIDE = np.array([name.startswith("right_") - int(name.startswith("left_")) for name in JOINTS])
TYPICAL = float(np.mean(cameras.PROTOCOL.distance)) / cameras.FOCAL  # metres a pixel, in training


# ---- Noise -----------------------------------------------------------------------------------


def errors(clips: Mapping[str, Clip]) -> np.ndarray:
    """Errors [V,F,14,2] in metres of all views, left and right put right: as large as they must be,
    if views err independently, for the triangulation to leave what it does."""
    views = read_cameras(CAMERAS)
    found = []
    for view, clip in zip(views, clips.values(), strict=True):
        found.append(beside(view, clip.right()[..., :2].astype(float), clip.truth))
    return np.stack(found) * unfitted(len(views))


def later(library: Library, detector: Detector) -> dict[str, Clip]:
    """The views of the man on the beam, without the first frame."""
    clips = read_beam(library, detector)[0]
    return {name: clip.frames(slice(FIRST, None)) for name, clip in clips.items()}


def unfitted(views: int) -> float:
    """By how much errors are larger than the residuals of a point fitted to them."""
    return float(np.sqrt(2 * views / (2 * views - 3)))


def split(error: np.ndarray, window: float) -> dict[str, np.ndarray]:
    """PARTS of errors [V,F,N,2] and "all" of them, root mean squares an axis, [N]; and the
    "shift" of whole views, [1].  Windows have about so many frames."""
    shift = error.mean((1, 2), keepdims=True)
    error = error - shift
    offset = error.mean(1, keepdims=True)
    pieces = np.array_split(error, max(1, round(error.shape[1] / window)), 1)
    slow = np.concatenate([np.broadcast_to(p.mean(1, keepdims=True), p.shape) for p in pieces], 1)
    parts = {"offset": offset, "slow": slow - offset, "fast": error - slow, "all": error}
    return {name: rms(part) for name, part in (parts | {"shift": shift}).items()}


def rms(error: np.ndarray) -> np.ndarray:
    """Of errors [V,F,N,2], by joint."""
    return np.sqrt((error**2).mean((0, 1, 3)))


def by_kind(values: np.ndarray) -> np.ndarray:
    """Root mean squares of right and left: [14] -> [8], as JOINT_TYPE."""
    kinds = joint_types()
    return np.array([np.sqrt((values[kinds == k] ** 2).mean()) for k in range(len(JOINT_TYPE))])


def noise(error: np.ndarray) -> dict[str, np.ndarray]:
    """What split() finds, by kind of joint [8] but for the shift; "usual" is what sigma would be by
    the median distance, which a few mistakes do not move."""
    parts = split(error, PERSISTS * RATE)
    distance = np.linalg.norm(error - error.mean((1, 2), keepdims=True), axis=-1)
    parts["usual"] = np.median(distance, (0, 1)) / MEDIAN
    shift = parts.pop("shift")
    return {name: by_kind(value) for name, value in parts.items()} | {"shift": shift}


# ---- What a joint is ---------------------------------------------------------------------------


def trunk_axes(joints: np.ndarray) -> np.ndarray:
    """Rows [F,3,3] of poses [F,14,3]: to the right of the person, up along the trunk, forward."""
    up = mid_shoulder(joints) - mid_hip(joints)
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    across = sum(
        joints[:, INDEX[f"right_{name}"]] - joints[:, INDEX[f"left_{name}"]]
        for name in ("shoulder", "hip")
    )
    right = across - (across * up).sum(-1, keepdims=True) * up
    right /= np.linalg.norm(right, axis=-1, keepdims=True)
    return np.stack([right, up, np.cross(up, right)], 1)


def redefined(joints: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Where joints [F,14,3] are on average, seen from others' [F,14,3], by kind: [8,3] metres
    outward, up and forward."""
    apart = np.einsum("fij,fnj->fni", trunk_axes(others), joints - others).mean(0)
    apart[:, 0] *= SIDE
    kinds = joint_types()
    return np.array([apart[kinds == k].mean(0) for k in range(len(JOINT_TYPE))])


# ---- Tables ----------------------------------------------------------------------------------


def short(name: str, column: str) -> str:
    """The title of a detector's first column."""
    return f"{name.removeprefix('MoveNet ')}: {column}"


def over_joints(values: np.ndarray) -> np.ndarray:
    """Root mean squares over the 14 joints of those by kind, [8,...]."""
    return np.sqrt(np.average(values**2, axis=0, weights=np.bincount(joint_types())))


def report_noise(found: Mapping[str, dict[str, np.ndarray]]) -> str:
    """A row a kind of joint, one for all, and one of shifts; columns of each detector's PARTS."""
    columns = [part if n else short(name, part) for name in found for n, part in enumerate(PARTS)]
    values = 1000 * np.stack([parts[part] for parts in found.values() for part in PARTS], 1)
    rows = {kind: row.tolist() for kind, row in zip(JOINT_TYPE, values, strict=True)}
    rows["**14 joints**"] = over_joints(values).tolist()
    blank = [None] * (len(PARTS) - 1)
    shifts = [[float(1000 * parts["shift"][0]), *blank] for parts in found.values()]
    rows["shift of a view, left out"] = sum(shifts, [])
    return table("mm", columns, rows)


def report_definitions(apart: Mapping[str, np.ndarray]) -> str:
    """A row a kind of joint: where a detector's are, seen from those of BlazePose."""
    axes = ("outward", "up", "forward")
    columns = [axis if n else short(name, axis) for name in apart for n, axis in enumerate(axes)]
    rows = {}
    for k, kind in enumerate(JOINT_TYPE):
        paired = (joint_types() == k).sum() == 2
        rows[kind] = [
            None if axis == 0 and not paired else float(1000 * of[k, axis])
            for of in apart.values()
            for axis in range(3)
        ]
    return table("mm", columns, rows)


def imitated_sigma() -> float:
    """Root mean square in pixels of the imitated detector's noise, of a joint of share 1."""
    good, bad = np.square(cameras.DETECTOR_SCALES)
    mean = (1 - cameras.DETECTOR_BAD) * good + cameras.DETECTOR_BAD * bad
    return cameras.DETECTOR_SIGMA * float(np.sqrt(mean))


def report_training(found: Mapping[str, dict[str, np.ndarray]]) -> str:
    """What the imitated detector could take: the noise of all detectors, with the same weight."""
    mean = {
        name: np.sqrt(np.mean([parts[name] ** 2 for parts in found.values()], 0))
        for name in (*PARTS, "usual")
    }
    lasting = (mean["offset"] ** 2 + mean["slow"] ** 2) / mean["all"] ** 2
    counts = np.bincount(joint_types())
    share = mean["all"] / np.average(mean["all"], weights=counts)
    today = by_kind(cameras.DETECTOR_SHARE)
    today_mm = 1000 * TYPICAL * imitated_sigma() * today
    columns = ["sigma, mm", "in training", "usual, mm", "share", "in training", "lasting, %"]
    values = zip(mean["all"], today_mm, mean["usual"], share, today, lasting, strict=True)
    rows = {
        kind: [float(1000 * v[0]), float(v[1]), float(1000 * v[2]), f"{v[3]:.2f}", f"{v[4]:.2f}",
               f"{100 * v[5]:.0f}"]
        for kind, v in zip(JOINT_TYPE, values, strict=True)
    }  # fmt: skip
    return table("joint", columns, rows)


def measure(library: Library) -> dict[str, str]:
    """The tables by the names of their marks."""
    beams = {detector.name: later(library, detector) for detector in DETECTORS}
    found = {name: noise(errors(clips)) for name, clips in beams.items()}
    truth = {name: clips[BEAM[0]].truth for name, clips in beams.items()}
    apart = {
        detector.name: redefined(truth[detector.name], truth[BLAZEPOSE.name])
        for detector in (THUNDER, LIGHTNING)
    }
    return {
        "noise": report_noise(found),
        "definitions": report_definitions(apart),
        "noise_for_training": report_training(found),
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--update", type=Path, help="Markdown file with marks")
    args = parser.parse_args()
    try:
        tables = measure(Library())
        print("\n".join(tables.values()), end="")
        if args.update:
            markdown.write_those(args.update, tables)
    except (OSError, ValueError) as error:
        print(f"detector_noise: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
