"""Accuracy of the models on motion capture: tables, JSON and plots, for each set of people.

    evaluate.py accuracy TEST.npz OTHERS.npz [--train TRAIN.npz OTHERS.npz] [--quick]
                [--models distances direct fconn] [--out build/report]
    evaluate.py accuracy TEST.npz OTHERS.npz --train TRAIN.npz OTHERS.npz --manifests gen
                --update docs/accuracy.md docs/accuracy-log.md --plots docs/accuracy

The sets of people stand side by side: CMU's, at whose laboratory most of the training people were,
and those of other laboratories.  A figure of the first alone says how the library does in one
studio.  All figures are of the float networks; what the quantised ones and fixed point lose against
them has tables of its own, and so have what it helps to know where up is, and angles.  Views and
columns are those of tools/data/views.py, errors those of tools/evaluation/measures.py.

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
from tqdm import tqdm

from data.mocap import Motion, load_motion
from data.views import views
from edmlift.joints import JOINTS
from edmlift.library import Library
from evaluation import angles, baselines, forms
from evaluation.command import Evaluation, Tables, by_set, load_sets, set_options
from evaluation.measures import (
    Figures,
    Lifter,
    both_errors,
    evaluate,
    lift,
    mean_errors,
    rounded,
    tilted,
)
from model.manifest import write_manifest
from reports import plots
from reports.markdown import table

MODELS = ("distances", "direct", "fconn")
TAKE_UP = ("distances", "direct")  # those that make use of it
WRONG_UP = 10.0  # degrees
ANGLES = ("gt", "cpm", "gt, up given")  # of angles.VIEWS
EXAMPLES = "cpm"  # the column of which poses are drawn

# The paper's own errors of its FConv: Human3.6M, protocol 3.  Other people, cameras and training.
PAPER = {"gt": 62.2, "n5": 67.1, "n10": 79.1, "n15": 96.1, "n20": 115.6, "cpm": 76.5}
PAPER |= {"rand2": 106.8, "left_arm": 109.4, "right_leg": 100.2}
RIVALS = {"mean pose": baselines.MeanPose, "nearest neighbour": baselines.NearestNeighbour}
TITLES = {
    "direct": "edmlift, direct",
    "distances": "edmlift, distances",
    "fconn": "edmlift, the paper's FConn",
    "fconv": "edmlift, the paper's FConv",
}
ROWS = {
    "error": "error",
    "interval": "95 % interval",
    "camera_axes": "camera axes, no alignment",
    "mirror_right_percent": "mirror right, %",
    "mirror_right_percent_of_frames": "mirror right, % of frames",
    "with_scale": "with scale",
    "hidden_joints": "hidden joints",
    "pck150_percent": "PCK at 150 mm, %",
    "refused": "refused",
}
COMPARED = {"error": "error, mm", "camera_axes": "camera axes, mm"}  # with the rivals
UPS = {"error": "error", "camera_axes": "camera axes"}
TOLD = {"": "", "given": ", up given", "wrong": f", up wrong by {WRONG_UP:.0f} degrees"}

Columns = dict[str, Figures]  # {column: {figure: value}}


# ---- Measuring -------------------------------------------------------------------------------


def examples(library: Lifter, motion: Motion) -> dict[str, np.ndarray]:
    """What plots.draw_examples() takes: the poses of a column that are lifted."""
    column = views(motion.joints)[EXAMPLES]
    poses = lift(library, column)
    fine = poses.status == "ok"
    joints, truth = poses.joints[fine].astype(float), column.truth[fine]
    error = mean_errors(joints, truth)
    return {"keypoints": column.keypoints[fine], "poses": joints, "truth": truth, "error": error}


def evaluate_up(lifter: Lifter, motion: Motion) -> dict[str, Columns]:
    """Errors with up not told, told, and told wrongly: {key of TOLD: {column: {figure: mm}}}."""
    columns = views(motion.joints)
    found: dict[str, Columns] = {key: {} for key in TOLD}
    for name, column in tqdm(columns.items(), desc="up", disable=None):
        ups = {"": None, "given": column.up, "wrong": tilted(column.up, WRONG_UP)}
        for key, up in ups.items():
            found[key][name] = both_errors(lifter, column, motion.subject, up)
    return found


def evaluate_rivals(train: list[Motion], test: Motion) -> dict[str, Columns]:
    """Figures of the rivals, the trained ones first: {title: {column: {figure: value}}}."""
    made = {n: rounded(evaluate(rival(train), test)) for n, rival in RIVALS.items()}
    columns = list(next(iter(made.values())))
    try:
        trained = baselines.read_trained(baselines.TRAINED, test, train, columns)
    except ValueError as error:
        print(f"evaluate accuracy: trained rivals are left out: {error}", file=sys.stderr)
        trained = {}
    return trained | made


# ---- Tables ----------------------------------------------------------------------------------


def means_table(figures: Columns) -> str:
    """A column a condition, a row a mean."""
    rows = {title: [c.get(key) for c in figures.values()] for key, title in ROWS.items()}
    return table("mm", list(figures), rows)


def joints_table(figures: Columns) -> str:
    """A column a condition, a row a joint."""
    rows = {j: [c["by_joint"][j] for c in figures.values()] for j in JOINTS}
    return table("joint, mm", list(figures), rows)


def up_table(found: dict[str, Columns]) -> str:
    """A row a figure and what is told of up, a column a condition."""
    rows = {
        f"{title}{told}": [column[figure] for column in found[key].values()]
        for figure, title in UPS.items()
        for key, told in TOLD.items()
    }
    return table("mm", list(found[""]), rows)


def rivals_table(figures: dict[str, Columns], others: dict[str, Columns]) -> str:
    """Errors of the models, {model: ...}, of the rivals, and the paper's own; a table a figure."""
    rows = {TITLES.get(model, model): found for model, found in figures.items()} | others
    columns = list(next(iter(rows.values())))
    texts = []
    for key, title in COMPARED.items():
        cells = {t: [row[name].get(key) for name in columns] for t, row in rows.items()}
        if key == "error":
            cells["the paper's FConv, on other data"] = [PAPER.get(name) for name in columns]
        texts.append(table(title, columns, cells))
    return "\n".join(texts)


# ---- Files -----------------------------------------------------------------------------------


def column_errors(figures: Columns) -> dict[str, float]:
    """The error of each column, as manifests have it."""
    return {name: round(column["error"], 1) for name, column in figures.items()}


def record_errors(
    manifest: Path, figures: dict[str, Columns], lost: dict[str, dict[str, Columns]]
) -> None:
    """Writes the errors into a model's manifest, where the exporter finds them: those of the first
    set of people, and of the others by their names.

    figures: {set: {column: ...}}; lost: {set: {form: {column: ...}}}.
    """
    settings = json.loads(manifest.read_text())
    first, *others = figures
    settings["metrics"] = column_errors(figures[first])
    settings |= {
        f"metrics_{f}": column_errors(lost[first][f]) for f in ("w16", "w8") if f in lost[first]
    }
    settings["metrics_others"] = {name: column_errors(figures[name]) for name in others}
    write_manifest(manifest, settings)


def write_report(folder: Path, tables: Tables, figures: dict[str, Any]) -> None:
    """accuracy.md, with the plots, and accuracy.json."""
    pictures = "\n\n".join(f"![{name}]({name}.png)" for name in plots.NAMES)
    text = "\n\n".join(table.strip("\n") for table in tables.values())
    (folder / "accuracy.md").write_text(f"{text}\n\n{pictures}\n")
    (folder / "accuracy.json").write_text(json.dumps(figures, indent=2) + "\n")


# ---- The command -----------------------------------------------------------------------------


def options(parser: argparse.ArgumentParser) -> None:
    set_options(parser, MODELS)
    parser.add_argument(
        "--train", type=Path, nargs="+", default=[], help="motions of other people, for the rivals"
    )
    parser.add_argument("--out", type=Path, help="folder for accuracy.md, accuracy.json and plots")
    parser.add_argument("--plots", type=Path, help="folder for the plots alone")
    parser.add_argument("--manifests", type=Path, help="folder of MODEL.json: note errors there")


def tables(args: argparse.Namespace) -> Tables:
    """The tables; the plots and files that the options name are written."""
    motions = load_sets(args)
    train = [load_motion(path) for path in args.train]
    found: Tables = {}
    figures: dict[str, dict[str, Columns]] = {}  # {model: {set: ...}}
    for model in args.models:
        library = Library(f"{model}_f32")
        figures[model] = {s: rounded(evaluate(library, m)) for s, m in motions.items()}
        lost = {s: rounded(forms.evaluate_forms(model, m)) for s, m in motions.items()}
        found |= model_tables(model, figures[model]) | forms_table(model, figures[model], lost)
        if model in TAKE_UP:
            ups = {s: rounded(evaluate_up(library, m)) for s, m in motions.items()}
            found[f"up_{model}"] = by_set(up_table, ups)
        if args.manifests:
            record_errors(args.manifests / f"{model}.json", figures[model], lost)
    found["angles"] = by_set(angles.report, angles_by_set(args.models, motions))
    others = {s: evaluate_rivals(train, m) for s, m in motions.items()} if train else {}
    if others:
        compared = {s: ({m: f[s] for m, f in figures.items()}, o) for s, o in others.items()}
        found["rivals"] = by_set(lambda both: rivals_table(*both), compared)
    write_pictures(args, found, figures, others, motions)
    return found


def model_tables(model: str, figures: dict[str, Columns]) -> Tables:
    """The tables of a model by itself, whose marks end in its name."""
    return {
        f"accuracy_{model}": by_set(means_table, figures),
        f"joints_{model}": by_set(joints_table, figures),
    }


def forms_table(
    model: str, figures: dict[str, Columns], lost: dict[str, dict[str, Columns]]
) -> Tables:
    """That of what a model's forms lose."""
    both = {name: (figures[name], lost[name]) for name in figures}
    return {f"forms_{model}": by_set(lambda f: forms.report(*f), both)}


def angles_by_set(models: tuple[str, ...], motions: dict[str, Motion]) -> dict[str, Any]:
    """What angles.report() takes, for each set: those of the models that take up."""
    told = [model for model in models if model in TAKE_UP] or models
    views = {m: ANGLES if m in TAKE_UP else ANGLES[:2] for m in told}
    return {
        name: {m: angles.evaluate(Library(f"{m}_f32"), motion, v) for m, v in views.items()}
        for name, motion in motions.items()
    }


def write_pictures(
    args: argparse.Namespace,
    found: Tables,
    figures: dict[str, dict[str, Columns]],
    others: dict[str, dict[str, Columns]],
    motions: dict[str, Motion],
) -> None:
    """The plots, of the first model on the first set, and the report, where they are asked for."""
    model, first = args.models[0], next(iter(motions))
    for folder in filter(None, (args.out, args.plots)):
        folder.mkdir(parents=True, exist_ok=True)
        drawn = examples(Library(f"{model}_f32"), motions[first])
        plots.write_all(folder, figures[model][first], others.get(first, {}), PAPER, drawn)
    if args.out:
        write_report(args.out, found, {"models": figures, "rivals": others})


EVALUATION = Evaluation(__doc__, tables, options)
