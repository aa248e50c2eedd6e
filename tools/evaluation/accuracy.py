"""Accuracy of a model on motion capture, through the C library: Markdown, JSON and plots.

    run.py evaluation.accuracy TEST.npz [--train TRAIN.npz] [--model fconn] [--out build/report] [--quick]
    run.py evaluation.accuracy TEST.npz --train TRAIN.npz --manifest gen/fconn.json
                --update README.md docs/accuracy.md --plots docs/accuracy

All figures are of the float network; what the quantised ones and fixed point lose against it has a
table of its own.

Poses are seen by virtual cameras with a fixed seed (tools/cameras.py), exact, noisy, as by a
detector, and with joints missing.  The error of a pose is the mean distance of its 14 joints from
the truth after rigid alignment without scale; a figure is the mean over subjects of their means.
Poses that the library refuses are counted, and left out of the means.

With --train, rows of rivals stand beside (tools/rivals.py): of those that are made of the training
people, and of those that tools/train_rivals.py trained on them and measured on these poses.
"""

import argparse
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from tqdm import tqdm

from data import cameras
from data.mocap import MocapError, Motion, load_motion
from edmlift.joints import JOINTS, LIMBS, mid_hip
from edmlift.library import Library, Poses
from edmlift.metrics import rigid_errors
from evaluation import baselines
from export.weights import manifest_text
from reports import markdown, plots

SEED = 20170714
NOISE = {"n5": 5.0, "n10": 10.0, "n15": 15.0, "n20": 20.0}  # pixels
PCK = 0.150  # metres: a joint within this counts as found
RESAMPLES = 1000  # of the subjects, for the confidence interval
EXAMPLES = "cpm"  # the column of which poses are drawn

# The paper's own errors of its FConv: Human3.6M, protocol 3.  Other people, cameras and training.
PAPER = {"gt": 62.2, "n5": 67.1, "n10": 79.1, "n15": 96.1, "n20": 115.6, "cpm": 76.5}
PAPER |= {"rand2": 106.8, "left_arm": 109.4, "right_leg": 100.2}
RIVALS = {"mean pose": baselines.MeanPose, "nearest neighbour": baselines.NearestNeighbour}


class Lifter(Protocol):
    """The library, or a rival."""

    def lift(self, keypoints: np.ndarray) -> Poses: ...


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
    columns = conditions(truth, cameras.project(truth), rng)
    for name, rig in STRESS.items():
        other = cameras.look(joints, rng, rig)
        whole = np.ones(other.shape[:2], bool)
        columns[name] = Column(cameras.keypoints(cameras.project(other)), whole, other)
    return columns


def conditions(truth: np.ndarray, exact: np.ndarray, rng: np.random.Generator) -> dict[str, Column]:
    """Views of poses, exact, noisy, as by a detector and with joints missing.

    truth [F,14,3] camera axes, metres; exact [F,14,2], where a camera sees it, pixels.
    """
    whole = np.ones(exact.shape[:2], bool)
    points = {"gt": (exact, whole)}
    for name, sigma in NOISE.items():
        points[name] = (cameras.gaussian_noise(exact, sigma, rng), whole)
    points["cpm"] = (cameras.detector_noise(exact, rng), whole)
    points["rand2"] = (exact, cameras.hide_random(len(exact), 2, rng))
    for limb in LIMBS:
        points[limb] = (exact, cameras.hide_limb(len(exact), limb))
    return {n: Column(cameras.keypoints(p, seen), seen, truth) for n, (p, seen) in points.items()}


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


def measure(library: Lifter, column: Column, subject: np.ndarray) -> dict:
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


def evaluate(library: Lifter, motion: Motion) -> dict:
    """Figures of every column: {column: {figure: value}}."""
    bar = tqdm(views(motion.joints).items(), desc="accuracy", disable=None)
    return {name: measure(library, column, motion.subject) for name, column in bar}


def examples(library: Lifter, motion: Motion) -> dict[str, np.ndarray]:
    """What plots.draw_examples() takes: the poses of a column that are lifted."""
    column = views(motion.joints)[EXAMPLES]
    poses = library.lift(column.keypoints)
    fine = poses.status == "ok"
    joints, truth = poses.joints[fine].astype(float), column.truth[fine]
    error = 1000 * rigid_errors(joints, truth).mean(1)
    return {"keypoints": column.keypoints[fine], "poses": joints, "truth": truth, "error": error}


# The other forms of a model, where it has them: its suffix, and whether all is in fixed point.
FORMS = {
    "q15": ("q15", False),
    "q7": ("q7", False),
    "fixed": ("q15", True),
    "fixed_q7": ("q7", True),
}


def lose(libraries: dict[str, Library], column: Column, subject: np.ndarray) -> dict:
    """What the forms lose against "f32" in a column: {form: {figure: value}}.

    error: as of measure(); moved: mean distance of the joints of a pose from where the float lift
    has them, mm, and its 99.9th percentile, of poses with the same mirror image; mirrored: poses
    with the other one; refused: poses with another status.
    """
    poses = {form: library.lift(column.keypoints) for form, library in libraries.items()}
    plain = poses.pop("f32")
    result = {}
    for form, lifted in poses.items():
        fine = (lifted.status == "ok") & (plain.status == "ok")
        joints, base = lifted.joints[fine].astype(float), plain.joints[fine].astype(float)
        error = 1000 * rigid_errors(joints, column.truth[fine]).mean(1)
        moved = 1000 * np.linalg.norm(joints - base, axis=-1).mean(1)
        other = rigid_errors(joints * [1, 1, -1], base).mean(1) < rigid_errors(joints, base).mean(1)
        result[form] = {
            "error": by_subject(error, subject[fine]).mean(),
            "moved": moved[~other].mean(),
            "moved_999": np.percentile(moved[~other], 99.9),
            "mirrored": int(other.sum()),
            "refused": int((lifted.status != plain.status).sum()),
        }
    return result


def evaluate_forms(model: str, motion: Motion) -> dict:
    """What the forms of a model lose: {form: {column: {figure: value}}}."""
    libraries = {"f32": (plain := Library(f"{model}_f32"))}
    forms = {f: form for f, form in FORMS.items() if plain.has(f"{model}_{form[0]}")}
    libraries |= {f: Library(f"{model}_{q}", fixed=fixed) for f, (q, fixed) in forms.items()}
    bar = tqdm(views(motion.joints).items(), desc="number formats", disable=None)
    columns = {name: lose(libraries, column, motion.subject) for name, column in bar}
    return {form: {name: columns[name][form] for name in columns} for form in forms}


def evaluate_rivals(train: Motion, test: Motion) -> dict:
    """Figures of the rivals, the trained ones first: {title: {column: {figure: value}}}."""
    made = {n: rounded(evaluate(rival(train), test)) for n, rival in RIVALS.items()}
    columns = list(next(iter(made.values())))
    try:
        trained = baselines.read_trained(baselines.TRAINED, test, train, columns)
    except ValueError as error:
        print(f"accuracy: trained rivals are left out: {error}", file=sys.stderr)
        trained = {}
    return trained | made


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


FORM_ROWS = {
    "q15": "16-bit network",
    "q7": "8-bit network",
    "fixed": "all fixed point, 16-bit network",
    "fixed_q7": "all fixed point, 8-bit network",
}


def forms_markdown(figures: dict, forms: dict) -> str:
    """Two tables: the error that each form adds in each column; and how far it moves poses."""
    columns = list(figures)
    titles = {form: FORM_ROWS[form] for form in forms}
    rows = {
        title: [signed(forms[form][name]["error"] - figures[name]["error"]) for name in columns]
        for form, title in titles.items()
    }
    moved = {}
    for form, title in titles.items():
        cells = forms[form].values()
        moved[title] = [
            max(c["moved"] for c in cells),
            max(c["moved_999"] for c in cells),
            max(c["mirrored"] for c in cells),
            max(c["refused"] for c in cells),
        ]
    how = ["mean, mm", "99.9th percentile, mm", "other mirror image, poses", "other status, poses"]
    return table("mm added", columns, rows) + "\n" + table("worst column", how, moved)


def signed(difference: float) -> str:
    """Two decimals and a sign, unless they are zeros."""
    text = f"{difference:+.2f}"
    return "0.00" if float(text) == 0 else text


def cell(value: float | int | str | list[float] | None) -> str:
    """A figure as text."""
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        return "-".join(f"{v:.0f}" for v in value)
    return str(value) if isinstance(value, int) else f"{value:.1f}"


def report(figures: dict) -> str:
    """The figures as two tables, a column a condition: first the means, then joint by joint."""
    rows = {title: [c.get(key) for c in figures.values()] for key, title in ROWS.items()}
    joints = {j: [c["by_joint"][j] for c in figures.values()] for j in JOINTS}
    return table("mm", list(figures), rows) + "\n" + table("joint, mm", list(figures), joints)


def rivals_markdown(figures: dict, others: dict) -> str:
    """Errors of the library, of the rivals, and the paper's own."""
    rows = {"edmlift": figures} | others
    cells = {title: [row[name]["error"] for name in figures] for title, row in rows.items()}
    cells["the paper's FConv, on other data"] = [PAPER.get(name) for name in figures]
    return table("error, mm", list(figures), cells)


def table(corner: str, columns: list[str], rows: dict[str, list]) -> str:
    lines = [f"| {corner} | " + " | ".join(columns) + " |", "|---" + "|--:" * len(columns) + "|"]
    lines += [f"| {title} | " + " | ".join(map(cell, row)) + " |" for title, row in rows.items()]
    return "\n".join(lines) + "\n"


def noted(figures: dict) -> dict[str, float]:
    """The error of each column, as manifests have it."""
    return {name: round(column["error"], 1) for name, column in figures.items()}


def note_errors(manifest: Path, figures: dict, forms: dict) -> None:
    """Writes the errors into a model's manifest, where the exporter finds them."""
    settings = json.loads(manifest.read_text())
    settings["metrics"] = noted(figures)
    settings |= {f"metrics_{f}": noted(forms[f]) for f in ("q15", "q7") if f in forms}
    manifest.write_text(manifest_text(settings))


def rounded(value):
    """Figures to 3 decimals, so that files do not change with the last bits."""
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    if isinstance(value, list):
        return [rounded(v) for v in value]
    return value if isinstance(value, int) else round(float(value), 3)


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--train", type=Path, help="motion of other people, for the rivals")
    parser.add_argument("--model", default="fconn", help="its name without _f32 (%(default)s)")
    parser.add_argument("--out", type=Path, help="folder for accuracy.md, accuracy.json and plots")
    parser.add_argument("--plots", type=Path, help="folder for the plots alone")
    parser.add_argument("--manifest", type=Path, help="JSON of the model: note the errors there")
    parser.add_argument(
        "--update", type=Path, nargs="+", default=[], help="Markdown files with marks for tables"
    )
    parser.add_argument("--quick", action="store_true", help="every 20th pose")
    return parser.parse_args()


def main() -> int:
    args = options()
    try:
        motion, library = load_motion(args.motion), Library(f"{args.model}_f32")
        train = load_motion(args.train) if args.train else None
    except (MocapError, OSError, ValueError) as error:
        print(f"accuracy: {error}", file=sys.stderr)
        return 1
    if args.quick:
        motion = motion.take(np.arange(0, len(motion.joints), 20))
    figures = rounded(evaluate(library, motion))
    forms = rounded(evaluate_forms(args.model, motion))
    others = evaluate_rivals(train, motion) if train else {}
    means, joints = report(figures).split("\n\n")
    tables = {"accuracy": means, "joints": joints, "forms": forms_markdown(figures, forms)}
    if others:
        tables["rivals"] = rivals_markdown(figures, others)
    print("\n\n".join(text.strip("\n") for text in tables.values()))
    for folder in filter(None, (args.out, args.plots)):
        folder.mkdir(parents=True, exist_ok=True)
        plots.write_all(folder, figures, others, PAPER, examples(library, motion))
    if args.out:
        write_report(args.out, tables, {"float": figures, **forms, **others})
    if args.manifest:
        note_errors(args.manifest, figures, forms)
    for page in args.update:
        markdown.write_those(page, tables)
    return 0


def write_report(folder: Path, tables: dict[str, str], figures: dict) -> None:
    """accuracy.md, with the plots, and accuracy.json."""
    pictures = "\n\n".join(f"![{name}]({name}.png)" for name in plots.NAMES)
    text = "\n\n".join(table.strip("\n") for table in tables.values())
    (folder / "accuracy.md").write_text(f"{text}\n\n{pictures}\n")
    (folder / "accuracy.json").write_text(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    sys.exit(main())
