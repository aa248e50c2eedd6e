"""Accuracy of a model on motion capture: tables, JSON and plots.

    evaluate.py accuracy TEST.npz [--train TRAIN.npz] [--model fconn] [--out build/report] [--quick]
    evaluate.py accuracy TEST.npz --train TRAIN.npz --manifest gen/fconn.json
                --update docs/accuracy.md docs/accuracy-log.md --plots docs/accuracy

All figures are of the float network; what the quantised ones and fixed point lose against it has a
table of its own.  Views and columns are those of tools/data/views.py, errors those of
tools/evaluation/measures.py.

With --train, rows of rivals stand beside (tools/evaluation/baselines.py): of those that are made of
the training people, and of those that tools/experiments/rivals.py trained on them and measured on
these poses.
"""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from data.mocap import Motion, load_motion
from data.views import views
from edmlift.joints import JOINTS
from edmlift.library import Library
from evaluation import baselines, forms
from evaluation.command import Evaluation, Tables, base_model, load, motion_options
from evaluation.measures import Figures, evaluate, mean_errors, rounded
from model.manifest import write_manifest
from reports import plots
from reports.markdown import table

EXAMPLES = "cpm"  # the column of which poses are drawn

# The paper's own errors of its FConv: Human3.6M, protocol 3.  Other people, cameras and training.
PAPER = {"gt": 62.2, "n5": 67.1, "n10": 79.1, "n15": 96.1, "n20": 115.6, "cpm": 76.5}
PAPER |= {"rand2": 106.8, "left_arm": 109.4, "right_leg": 100.2}
RIVALS = {"mean pose": baselines.MeanPose, "nearest neighbour": baselines.NearestNeighbour}
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


def examples(library: Library, motion: Motion) -> dict[str, np.ndarray]:
    """What plots.draw_examples() takes: the poses of a column that are lifted."""
    column = views(motion.joints)[EXAMPLES]
    poses = library.lift(column.keypoints)
    fine = poses.status == "ok"
    joints, truth = poses.joints[fine].astype(float), column.truth[fine]
    error = mean_errors(joints, truth)
    return {"keypoints": column.keypoints[fine], "poses": joints, "truth": truth, "error": error}


def evaluate_rivals(train: Motion, test: Motion) -> dict[str, dict[str, Figures]]:
    """Figures of the rivals, the trained ones first: {title: {column: {figure: value}}}."""
    made = {n: rounded(evaluate(rival(train), test)) for n, rival in RIVALS.items()}
    columns = list(next(iter(made.values())))
    try:
        trained = baselines.read_trained(baselines.TRAINED, test, train, columns)
    except ValueError as error:
        print(f"evaluate accuracy: trained rivals are left out: {error}", file=sys.stderr)
        trained = {}
    return trained | made


def means_table(figures: dict[str, Figures]) -> str:
    """A column a condition, a row a mean."""
    rows = {title: [c.get(key) for c in figures.values()] for key, title in ROWS.items()}
    return table("mm", list(figures), rows)


def joints_table(figures: dict[str, Figures]) -> str:
    """A column a condition, a row a joint."""
    rows = {j: [c["by_joint"][j] for c in figures.values()] for j in JOINTS}
    return table("joint, mm", list(figures), rows)


def rivals_table(figures: dict[str, Figures], others: dict[str, dict[str, Figures]]) -> str:
    """Errors of the library, of the rivals, and the paper's own."""
    rows = {"edmlift": figures} | others
    cells = {title: [row[name]["error"] for name in figures] for title, row in rows.items()}
    cells["the paper's FConv, on other data"] = [PAPER.get(name) for name in figures]
    return table("error, mm", list(figures), cells)


def column_errors(figures: dict[str, Figures]) -> dict[str, float]:
    """The error of each column, as manifests have it."""
    return {name: round(column["error"], 1) for name, column in figures.items()}


def record_errors(
    manifest: Path, figures: dict[str, Figures], lost: dict[str, dict[str, Figures]]
) -> None:
    """Writes the errors into a model's manifest, where the exporter finds them."""
    settings = json.loads(manifest.read_text())
    settings["metrics"] = column_errors(figures)
    settings |= {f"metrics_{f}": column_errors(lost[f]) for f in ("w16", "w8") if f in lost}
    write_manifest(manifest, settings)


def write_report(folder: Path, tables: Tables, figures: dict[str, Any]) -> None:
    """accuracy.md, with the plots, and accuracy.json."""
    pictures = "\n\n".join(f"![{name}]({name}.png)" for name in plots.NAMES)
    text = "\n\n".join(table.strip("\n") for table in tables.values())
    (folder / "accuracy.md").write_text(f"{text}\n\n{pictures}\n")
    (folder / "accuracy.json").write_text(json.dumps(figures, indent=2) + "\n")


def options(parser: argparse.ArgumentParser) -> None:
    motion_options(parser)
    parser.add_argument("--train", type=Path, help="motion of other people, for the rivals")
    parser.add_argument("--out", type=Path, help="folder for accuracy.md, accuracy.json and plots")
    parser.add_argument("--plots", type=Path, help="folder for the plots alone")
    parser.add_argument("--manifest", type=Path, help="JSON of the model: note the errors there")


def tables(args: argparse.Namespace) -> Tables:
    """The tables; the plots and files that the options name are written."""
    model = base_model(args)
    args.model = f"{model}_f32"
    library, motion = load(args)
    train = load_motion(args.train) if args.train else None
    figures = rounded(evaluate(library, motion))
    lost = rounded(forms.evaluate_forms(model, motion))
    others = evaluate_rivals(train, motion) if train else {}
    found = {
        "accuracy": means_table(figures),
        "joints": joints_table(figures),
        "forms": forms.report(figures, lost),
    }
    if others:
        found["rivals"] = rivals_table(figures, others)
    for folder in filter(None, (args.out, args.plots)):
        folder.mkdir(parents=True, exist_ok=True)
        plots.write_all(folder, figures, others, PAPER, examples(library, motion))
    if args.out:
        write_report(args.out, found, {"float": figures, **lost, **others})
    if args.manifest:
        record_errors(args.manifest, figures, lost)
    return found


EVALUATION = Evaluation(__doc__, tables, options)
