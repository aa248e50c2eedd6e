"""How well angles come out: how limbs bend and lift, the trunk's lean, and which way people face.

    evaluate.py angles TEST.npz OTHERS.npz [--models distances direct] [--update docs/angles.md]
                [--quick]

prints a table of all angles of docs/angles.md; that of docs/accuracy.md, of some, comes out of
`evaluate.py accuracy`.

Lean and heading are told against the true vertical, which the camera is taken to know.  Limbs that
are straight are measured by themselves, because a lifter that guesses bends them: their flexion
cannot be below 0, so that what it makes of them shows in the bias.
"""

import argparse
from collections.abc import Callable, Sequence

import numpy as np

from data.mocap import Motion
from data.views import Column, views
from edmlift import joint_angles as angles
from edmlift.library import Library
from evaluation.command import Evaluation, Tables, by_set, load_sets, set_options
from evaluation.measures import Figures, Lifter, by_subject, lift
from reports.markdown import table

STRAIGHT = 15.0  # degrees: a limb that is bent by less
FACING = 60.0  # degrees: heading is told of people whose sides are nearer to level
# What is lifted, by its title: the column, and whether the lift knows where up is.
VIEWS = {
    "gt": ("gt", False),
    "n10": ("n10", False),
    "cpm": ("cpm", False),
    "sideways": ("sideways", False),
    "gt, up given": ("gt", True),
    "cpm, up given": ("cpm", True),
}
MODELS = ("distances", "direct")
EVERY = ("gt", "cpm")  # of VIEWS: those of the table of all angles
LIMBS = {"elbows": (0, 1), "knees": (2, 3)}  # of angles.BENDING


def off(joints: np.ndarray, truth: np.ndarray, up: np.ndarray) -> dict[str, np.ndarray]:
    """By how many degrees the angles of poses [F,14,3] differ from the true ones, [F,n] each; NaN
    where there is nothing to tell."""
    true = angles.flexion(truth)
    flexion = angles.flexion(joints) - true
    straight = np.where(true < STRAIGHT, flexion, np.nan)
    faces = angles.side_slope(truth, up) < FACING
    turn = angles.turn(angles.heading(truth, up), angles.heading(joints, up))
    found = {}
    for name, which in LIMBS.items():
        found[name] = flexion[:, which]
        found[f"straight {name}"] = straight[:, which]
    found["lean of the trunk"] = (angles.lean(joints, up) - angles.lean(truth, up))[:, None]
    found["heading"] = np.where(faces, turn, np.nan)[:, None]
    return found


def every_off(joints: np.ndarray, truth: np.ndarray, up: np.ndarray) -> dict[str, np.ndarray]:
    """The same of all angles of the library, right and left together, by their names in words."""
    found, true = (angles.every(poses, up) for poses in (joints, truth))
    differences = angles.turn(true, found)
    columns: dict[str, list[np.ndarray]] = {}
    for n, name in enumerate(angles.ANGLES):
        both = name.removeprefix("right_").removeprefix("left_").replace("_", " ")
        columns.setdefault(both, []).append(differences[:, n])
    return {name: np.stack(sides, 1) for name, sides in columns.items()}


def measure(
    lifter: Lifter,
    column: Column,
    subject: np.ndarray,
    know_up: bool,
    differences: Callable[..., dict[str, np.ndarray]] = off,
) -> Figures:
    """Mean absolute difference and bias of each angle, degrees, over people: {angle: [2]}.

    A person of whom nothing is told, as of one without a straight elbow, does not count."""
    poses = lift(lifter, column, column.up if know_up else None)
    fine = poses.status == "ok"
    few = column.take(fine)
    found = differences(poses.joints[fine].astype(float), few.truth, few.up)
    return {name: _means(values, subject[fine]) for name, values in found.items()}


def _means(values: np.ndarray, subject: np.ndarray) -> list[float]:
    """Of differences [F,n]: mean absolute, and mean, over subjects."""
    each = np.repeat(subject, values.shape[1])
    told = np.isfinite(values.ravel())
    flat, each = values.ravel()[told], each[told]
    if not len(flat):
        return [np.nan, np.nan]
    return [float(by_subject(part, each).mean()) for part in (np.abs(flat), flat)]


def evaluate(
    lifter: Lifter,
    motion: Motion,
    titles: Sequence[str] = tuple(VIEWS),
    differences: Callable[..., dict[str, np.ndarray]] = off,
) -> Figures:
    """Figures of each of these VIEWS: {title: {angle: [absolute, bias]}}."""
    columns = views(motion.joints)
    told = {title: VIEWS[title] for title in titles}
    return {
        title: measure(lifter, columns[name], motion.subject, know_up, differences)
        for title, (name, know_up) in told.items()
    }


def report(figures: dict[str, Figures]) -> str:
    """A row an angle and kind of figure, a column a lifter and view, of {title: evaluate()}."""
    columns = {
        f"{lifter}, {view}": found for lifter, row in figures.items() for view, found in row.items()
    }
    rows = {}
    for name in next(iter(columns.values())):
        for k, kind in enumerate(("", ", bias")):
            pairs = [found[name] for found in columns.values()]
            rows[f"{name}{kind}"] = [f"{p[k]:+.1f}" if k else p[k] for p in pairs]
    return table("degrees", list(columns), rows)


def options(parser: argparse.ArgumentParser) -> None:
    set_options(parser, MODELS)


def every_by_set(
    models: Sequence[str], motions: dict[str, Motion]
) -> dict[str, dict[str, Figures]]:
    """Figures of all angles: {set: {model: evaluate()}}."""
    return {
        name: {m: evaluate(Library(f"{m}_f32"), motion, EVERY, every_off) for m in models}
        for name, motion in motions.items()
    }


def tables(args: argparse.Namespace) -> Tables:
    """The table of all angles, of each set of people."""
    return {"angle_errors": by_set(report, every_by_set(args.models, load_sets(args)))}


EVALUATION = Evaluation(__doc__, tables, options)
