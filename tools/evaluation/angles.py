"""How well angles come out: bent elbows and knees, the trunk's lean, and which way people face.

Lean and heading are told against the true vertical, which the camera is taken to know.  Limbs that
are straight are measured by themselves, because a lifter that guesses bends them: their flexion
cannot be below 0, so that what it makes of them shows in the bias.
"""

from collections.abc import Sequence

import numpy as np

from data.mocap import Motion
from data.views import Column, views
from edmlift import joint_angles as angles
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


def measure(lifter: Lifter, column: Column, subject: np.ndarray, know_up: bool) -> Figures:
    """Mean absolute difference and bias of each angle, degrees, over people: {angle: [2]}.

    A person of whom nothing is told, as of one without a straight elbow, does not count."""
    poses = lift(lifter, column, column.up if know_up else None)
    fine = poses.status == "ok"
    few = column.take(fine)
    found = off(poses.joints[fine].astype(float), few.truth, few.up)
    return {name: _means(values, subject[fine]) for name, values in found.items()}


def _means(values: np.ndarray, subject: np.ndarray) -> list[float]:
    """Of differences [F,n]: mean absolute, and mean, over subjects."""
    each = np.repeat(subject, values.shape[1])
    told = np.isfinite(values.ravel())
    flat, each = values.ravel()[told], each[told]
    if not len(flat):
        return [np.nan, np.nan]
    return [float(by_subject(part, each).mean()) for part in (np.abs(flat), flat)]


def evaluate(lifter: Lifter, motion: Motion, titles: Sequence[str] = tuple(VIEWS)) -> Figures:
    """Figures of each of these VIEWS: {title: {angle: [absolute, bias]}}."""
    columns = views(motion.joints)
    told = {title: VIEWS[title] for title in titles}
    return {t: measure(lifter, columns[c], motion.subject, up) for t, (c, up) in told.items()}


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
