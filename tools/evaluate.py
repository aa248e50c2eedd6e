"""Accuracy of a model on motion capture, through the C library: Markdown and JSON.

    evaluate.py TEST.npz [--model fconn_f32] [--out build/report] [--quick]
    evaluate.py TEST.npz --manifest gen/fconn.json --update README.md

Poses are seen by virtual cameras with a fixed seed (tools/cameras.py), exact, noisy, as by a
detector, and with joints missing.  The error of a pose is the mean distance of its 14 joints from
the truth after rigid alignment without scale; a figure is the mean over subjects of their means.
Poses that the library refuses are counted, and left out of the means.
"""

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

import cameras
import marks
from edmlift import Library
from mirror import rigid_errors
from mocap import MocapError, Motion, load_motion
from skeleton import JOINTS, LIMBS, mid_hip

SEED = 20170714
NOISE = {"n5": 5.0, "n10": 10.0, "n15": 15.0, "n20": 20.0}  # pixels
PCK = 0.150  # metres: a joint within this counts as found
RESAMPLES = 1000  # of the subjects, for the confidence interval


@dataclass(frozen=True)
class Column:
    """2D input [F,14,3], the joints that it shows [F,14], and the truth in camera axes [F,14,3]."""

    keypoints: np.ndarray
    seen: np.ndarray
    truth: np.ndarray


STRESS = {"rolled": cameras.ROLLED, "close": cameras.CLOSE}


def views(joints: np.ndarray, seed: int = SEED) -> dict[str, Column]:
    """The columns of the protocol, and two with exact 2D of other cameras: rolled and close."""
    rng = np.random.default_rng(seed)
    truth = cameras.look(joints, rng)
    exact = cameras.project(truth)
    whole = np.ones(exact.shape[:2], bool)
    points = {"gt": (exact, whole)}
    for name, sigma in NOISE.items():
        points[name] = (cameras.gaussian_noise(exact, sigma, rng), whole)
    points["cpm"] = (cameras.detector_noise(exact, rng), whole)
    points["rand2"] = (exact, cameras.hide_random(len(exact), 2, rng))
    for limb in LIMBS:
        points[limb] = (exact, cameras.hide_limb(len(exact), limb))
    columns = {
        n: Column(cameras.keypoints(p, seen), seen, truth) for n, (p, seen) in points.items()
    }
    for name, rig in STRESS.items():
        other = cameras.look(joints, rng, rig)
        columns[name] = Column(cameras.keypoints(cameras.project(other)), whole, other)
    return columns


def scaled_errors(points: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Joint errors [F,14] after alignment by rotation, translation and scale."""
    points = points - points.mean(1, keepdims=True)
    truth = truth - truth.mean(1, keepdims=True)
    u, s, vt = np.linalg.svd(np.einsum("fni,fnj->fij", points, truth))
    sign = np.sign(np.linalg.det(u @ vt))
    u[:, :, 2] *= sign[:, None]
    s[:, 2] *= sign
    scale = s.sum(1) / (points**2).sum((1, 2))
    aligned = np.einsum("fni,fij->fnj", points, u @ vt) * scale[:, None, None]
    return np.linalg.norm(aligned - truth, axis=-1)


def by_subject(values: np.ndarray, subject: np.ndarray) -> np.ndarray:
    """Mean of the values [F] of each subject; NaN values are left out."""
    return np.array([np.nanmean(values[subject == s]) for s in np.unique(subject)])


def measure(library: Library, column: Column, subject: np.ndarray) -> dict:
    """All figures of a column, mm unless said otherwise."""
    poses = library.lift(column.keypoints)
    fine = poses.status == "ok"
    joints, truth, seen = poses.joints[fine].astype(float), column.truth[fine], column.seen[fine]
    subject = subject[fine]
    error = 1000 * rigid_errors(joints, truth)
    mirrored = 1000 * rigid_errors(joints * [1, 1, -1], truth)
    right = error.mean(1) <= mirrored.mean(1)
    oracle = np.where(right[:, None], error, mirrored)
    rooted = joints - (truth - mid_hip(truth)[:, None])
    hidden = np.where(seen, np.nan, error)
    means = by_subject(error.mean(1), subject)
    result = {
        "error": means.mean(),
        "interval": bootstrap(means),
        "oracle_mirror": by_subject(oracle.mean(1), subject).mean(),
        "mirror_right_percent": 100 * by_subject(right.astype(float), subject).mean(),
        "mirror_right_percent_of_frames": 100 * right.mean(),
        "with_scale": by_subject(1000 * scaled_errors(joints, truth).mean(1), subject).mean(),
        "camera_axes": by_subject(1000 * np.linalg.norm(rooted, axis=-1).mean(1), subject).mean(),
        "pck150_percent": 100 * by_subject((error < 1000 * PCK).mean(1), subject).mean(),
        "refused": int((~fine).sum()),
        "by_joint": {
            name: by_subject(error[:, j], subject).mean() for j, name in enumerate(JOINTS)
        },
    }
    if not seen.all():
        result["hidden_joints"] = by_subject(np.nanmean(hidden, 1), subject).mean()
    return result


def bootstrap(means: np.ndarray) -> list[float]:
    """95 % interval of the mean over subjects, by resampling the subjects."""
    rng = np.random.default_rng(SEED)
    draws = rng.choice(means, (RESAMPLES, len(means))).mean(1)
    return np.percentile(draws, [2.5, 97.5]).tolist()


def evaluate(library: Library, motion: Motion) -> dict:
    """Figures of every column: {column: {figure: value}}."""
    bar = tqdm(views(motion.joints).items(), desc="evaluate", disable=None)
    return {name: measure(library, column, motion.subject) for name, column in bar}


ROWS = {
    "error": "error",
    "interval": "95 % interval",
    "oracle_mirror": "better mirror image",
    "with_scale": "with scale",
    "hidden_joints": "hidden joints",
    "camera_axes": "camera axes, no alignment",
    "mirror_right_percent": "mirror right, %",
    "mirror_right_percent_of_frames": "mirror right, % of frames",
    "pck150_percent": "PCK at 150 mm, %",
    "refused": "refused",
}


def cell(value: float | int | list[float] | None) -> str:
    """A figure as text."""
    if value is None:
        return ""
    if isinstance(value, list):
        return "-".join(f"{v:.0f}" for v in value)
    return str(value) if isinstance(value, int) else f"{value:.1f}"


def markdown(figures: dict) -> str:
    """The figures as two tables, a column a condition: first the means, then joint by joint."""
    rows = {title: [c.get(key) for c in figures.values()] for key, title in ROWS.items()}
    joints = {j: [c["by_joint"][j] for c in figures.values()] for j in JOINTS}
    return table("mm", list(figures), rows) + "\n" + table("joint, mm", list(figures), joints)


def table(corner: str, columns: list[str], rows: dict[str, list]) -> str:
    lines = [f"| {corner} | " + " | ".join(columns) + " |", "|---" + "|--:" * len(columns) + "|"]
    lines += [f"| {title} | " + " | ".join(map(cell, row)) + " |" for title, row in rows.items()]
    return "\n".join(lines) + "\n"


def note_errors(manifest: Path, figures: dict) -> None:
    """Writes the error of each column into a model's manifest, where the exporter finds it."""
    settings = json.loads(manifest.read_text())
    settings["metrics"] = {name: round(column["error"], 1) for name, column in figures.items()}
    manifest.write_text(json.dumps(settings, indent=2) + "\n")


def rounded(value):
    """Figures to 3 decimals, so that files do not change with the last bits."""
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return value if isinstance(value, int) else round(float(value), 3)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--model", default="fconn_f32")
    parser.add_argument("--out", type=Path, help="folder for accuracy.md and accuracy.json")
    parser.add_argument("--manifest", type=Path, help="JSON of the model: note the errors there")
    parser.add_argument("--update", type=Path, help="Markdown file with marks for the table")
    parser.add_argument("--quick", action="store_true", help="every 20th pose")
    args = parser.parse_args()
    try:
        motion, library = load_motion(args.motion), Library(args.model)
    except (MocapError, OSError, ValueError) as error:
        print(f"evaluate: {error}", file=sys.stderr)
        return 1
    if args.quick:
        motion = motion.take(np.arange(0, len(motion.joints), 20))
    figures = rounded(evaluate(library, motion))
    text = markdown(figures)
    print(text, end="")
    if args.out:
        args.out.mkdir(parents=True, exist_ok=True)
        (args.out / "accuracy.md").write_text(text)
        (args.out / "accuracy.json").write_text(json.dumps(figures, indent=2) + "\n")
    if args.manifest:
        note_errors(args.manifest, figures)
    if args.update:
        marks.write(args.update, "accuracy", text.partition("\n\n")[0])
    return 0


if __name__ == "__main__":
    sys.exit(main())
