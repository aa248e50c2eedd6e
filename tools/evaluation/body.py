"""Effect of known body measurements, and how true quality and uncertainty are.

    evaluate.py body TEST.npz [--model fconn_f32] [--update docs/body.md] [--quick]

Standing heights are estimated as tools/data/bodies.py says, bones are the true ones.
"""

import argparse
from itertools import pairwise
from typing import Any

import numpy as np
from tqdm import tqdm

from data import cameras
from data.bodies import GOOD, ankle_height, bodies
from data.mocap import Motion
from data.views import SEED, Column, views
from edmlift.joints import BONES, JOINTS, PAIRS, indices
from edmlift.library import Library
from edmlift.metrics import joint_errors, rigid_errors
from evaluation.command import Evaluation, Tables, base_model, load
from evaluation.measures import by_subject, mean_error
from model.manifest import read_manifest
from reports.markdown import table

SIZED = ("gt", "cpm", "rand2", "close")  # columns
LEG_JOINTS = ("right_knee", "right_ankle", "left_knee", "left_ankle")
# What is not seen.
PARTIAL = {
    "all seen": (),
    "no ankles (behind a counter)": ("right_ankle", "left_ankle"),
    "no wrists": ("right_wrist", "left_wrist"),
    "no right arm": ("right_elbow", "right_wrist"),
    "no right leg": ("right_knee", "right_ankle"),
    "no right arm, no right leg": ("right_elbow", "right_wrist", "right_knee", "right_ankle"),
    "no arms": ("right_elbow", "right_wrist", "left_elbow", "left_wrist"),
    "no legs, hips seen": LEG_JOINTS,
    "no legs, no hips (at a desk)": ("right_hip", "left_hip", *LEG_JOINTS),
}


def matrix_way(
    library: Library, column: Column, bone: np.ndarray, manifest: dict[str, Any]
) -> np.ndarray:
    """Poses [F,14,3] if known bones [F,13] replace their distances in the network's matrix, and
    the others are scaled alike: the alternative to edml_fit_body()."""
    fewest, aspect = manifest["fewest_joints"], manifest["max_aspect"]
    pairs = [np.flatnonzero((PAIRS[0] == min(b)) & (PAIRS[1] == max(b)))[0] for b in BONES]
    joints = np.zeros_like(column.truth)
    for pose, keypoints, known in zip(joints, column.keypoints, bone, strict=True):
        distance = library.predict(library.edm(keypoints, fewest, aspect, impute=True)[1])
        distance *= known.sum() / distance[pairs].sum()
        distance[pairs] = known
        pose[:] = library.mirror(library.mds(distance))[0]
    return joints


def known_measurements(height: np.ndarray, bone: np.ndarray) -> dict[str, dict[str, Any]]:
    """What Library.fit_body() is told of people with heights [F] and bones [F,13], by title."""
    legs_and_arms = np.ones(len(BONES))
    legs_and_arms[[0, 1, 4, 7, 10]] = 0  # all but head, clavicles and trunk
    return {
        "nothing": {},
        "height": {"height": height},
        "height 5 % too large": {"height": 1.05 * height},
        "height 5 % too small": {"height": 0.95 * height},
        "1.75 m for everyone": {"height": 1.75},
        "bones": {"bones": bone},
        "bones 5 % too large": {"bones": 1.05 * bone},
        "bones 5 % too small": {"bones": 0.95 * bone},
        "upper arms, forearms, thighs and shins": {"bones": bone * legs_and_arms},
        "the same, and height": {"height": height, "bones": bone * legs_and_arms},
    }


def sizes(
    library: Library, motion: Motion, columns: dict[str, Column], manifest: dict[str, Any]
) -> str:
    """Table of errors by what is known of the person."""
    people = bodies(motion, ankle_height(motion))
    who = np.searchsorted(people.subject, motion.subject)
    height, bone = people.height[who], people.bone[who]
    known = known_measurements(height, bone)
    rows: dict[str, list[float]] = {title: [] for title in known}
    rows["bones, put into the matrix instead"] = []
    rows["(the scale that fits the truth best)"] = []
    for name in tqdm(SIZED, desc="sizes", disable=None):
        column = columns[name]
        poses = library.lift(column.keypoints)
        for title, person in known.items():
            joints, status = library.fit_body(poses.joints, **person)
            if (status != "ok").any():
                raise ValueError(f"{title}, {name}: {status[status != 'ok'][0]}")
            rows[title].append(mean_error(joints.astype(float), column.truth, motion.subject))
        inside = matrix_way(library, column, bone, manifest)
        rows["bones, put into the matrix instead"].append(
            mean_error(inside, column.truth, motion.subject)
        )
        best = joint_errors(poses.joints, column.truth, "similarity").mean(1)
        rows["(the scale that fits the truth best)"].append(
            1000 * by_subject(best, motion.subject).mean()
        )
    return table("known, mm", list(SIZED), rows)


def quality_figures(
    library: Library, columns: dict[str, Column]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Quality [F] and error [F] in metres of each column."""
    figures = {}
    for name, column in tqdm(columns.items(), desc="quality", disable=None):
        poses = library.lift(column.keypoints)
        error = rigid_errors(poses.joints.astype(float), column.truth).mean(1)
        figures[name] = library.quality(poses), error
    return figures


def percent(part: np.ndarray) -> float | str:
    """Share of a mask that is true, %; empty for an empty mask."""
    return 100 * float(part.mean()) if len(part) else ""


DECILES = (0, *np.arange(2, 11) / 10)  # the lowest two in one: hardly any pose is there


def deciles(figures: dict[str, tuple[np.ndarray, np.ndarray]]) -> str:
    """Table of what becomes of poses by their quality, over all columns."""
    quality, error = (np.concatenate(v) for v in zip(*figures.values(), strict=True))
    rows = {}
    for low, high in pairwise(DECILES):
        inside = (quality >= low) & (quality < high)
        told = 100 * float(quality[inside].mean()) if inside.any() else ""
        mean = 1000 * float(error[inside].mean()) if inside.any() else ""
        rows[f"{low:.1f} to {high:.1f}"] = [
            int(inside.sum()), told, percent(error[inside] < GOOD), mean
        ]  # fmt: skip
    return table("quality", ["poses", "mean quality, %", "under 100 mm, %", "mean error, mm"], rows)


def kept(figures: dict[str, tuple[np.ndarray, np.ndarray]]) -> str:
    """Table by column of what is left of it above 0.9."""
    shares, good, before, error = [], [], [], []
    for quality, errors in figures.values():
        above = quality > 0.9
        shares.append(percent(above))
        good.append(percent(errors[above] < GOOD))
        before.append(percent(errors < GOOD))
        error.append(1000 * float(errors[above].mean()) if above.any() else "")
    rows = {"of all poses, % under 100 mm": before, "quality over 0.9, % of poses": shares,
            "of these, % under 100 mm": good, "their mean error, mm": error}  # fmt: skip
    return table("", list(figures), rows)


def by_person(figures: dict[str, tuple[np.ndarray, np.ndarray]], subject: np.ndarray) -> str:
    """Table by person of what has quality over 0.9, over all columns."""
    quality, error = (np.concatenate(v) for v in zip(*figures.values(), strict=True))
    who = np.tile(subject, len(figures))
    people = np.unique(subject)
    above = [(who == s) & (quality > 0.9) for s in people]
    rows = {"quality over 0.9, % of poses": [percent(quality[who == s] > 0.9) for s in people],
            "of these, % under 100 mm": [percent(error[a] < GOOD) for a in above]}  # fmt: skip
    return table("person", [str(s) for s in people], rows)


def partial(library: Library, motion: Motion) -> str:
    """Table of what is lifted when part of the body is out of the picture: a detector's 2D."""
    rng = np.random.default_rng(SEED)
    truth = cameras.look(motion.joints, rng)
    points = cameras.detector_noise(cameras.project(truth), rng)
    rows = {}
    for title, names in PARTIAL.items():
        seen = np.ones((len(truth), len(JOINTS)), bool)
        hidden = indices(names)
        seen[:, hidden] = False
        poses = library.lift(cameras.keypoints(points, seen))
        fine = poses.status == "ok"
        if not fine.any():
            rows[title] = [14 - len(hidden), str(poses.status[0]).replace("_", " "), *[""] * 4]
            continue
        error = 1000 * rigid_errors(poses.joints[fine].astype(float), truth[fine])
        told = 1000 * library.uncertainty(seen[:1])[0]
        show = [j for j in range(14) if j not in hidden]
        subject = motion.subject[fine]
        figures = [
            cell
            for part in (show, hidden)
            for cell in ([by_subject(error[:, part].mean(1), subject).mean(), told[part].mean()]
                         if part else ["", ""])
        ]  # fmt: skip
        rows[title] = [14 - len(hidden), f"{int(fine.sum())} of {len(fine)}", *figures]
    titles = ["seen", "lifted", "seen joints, mm", "told", "unseen joints, mm", "told"]
    return table("", titles, rows)


def evaluate(library: Library, motion: Motion, manifest: dict[str, Any]) -> Tables:
    """All tables of the page."""
    columns = views(motion.joints)
    figures = quality_figures(library, columns)
    return {
        "sizes": sizes(library, motion, columns, manifest),
        "quality": deciles(figures),
        "kept": kept(figures) + "\n" + by_person(figures, motion.subject),
        "partial": partial(library, motion),
    }


def tables(args: argparse.Namespace) -> Tables:
    return evaluate(*load(args), read_manifest(base_model(args)))


EVALUATION = Evaluation(__doc__, tables)
