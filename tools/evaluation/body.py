"""Effect of known body measurements, and how true quality and uncertainty are.

    evaluate.py body TEST.npz OTHERS.npz [--models distances direct] [--update docs/body.md]
                [--quick]

Standing heights are estimated as tools/data/bodies.py says, bones are the true ones.  Sizes and
parts of bodies are measured with the first model, quality with each.
"""

import argparse
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from tqdm import tqdm

from data import cameras
from data.bodies import GOOD, bodies
from data.mocap import Motion
from data.views import SEED, Column, views
from edmlift.joints import BONES, JOINTS, PAIRS, indices
from edmlift.library import Library
from edmlift.metrics import joint_errors, rigid_errors
from evaluation.command import Evaluation, Tables, by_set, load_sets, set_options
from evaluation.measures import by_subject, mean_error
from model.constants import number
from model.manifest import read_manifest
from reports.markdown import table

MODELS = ("distances", "direct")
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


MATRIX = "bones, put into the matrix instead"


def network_gives_distances(manifest: dict[str, Any]) -> bool:
    """Whether a model goes through the scaling: `direct` does not."""
    return manifest["recipe"]["network"] != "direct"


def matrix_way(
    library: Library, column: Column, bone: np.ndarray, manifest: dict[str, Any]
) -> np.ndarray:
    """Poses [F,14,3] if known bones [F,13] replace their distances in the network's matrix, and
    the others are scaled alike: the alternative to edml_fit_body()."""
    pairs = [np.flatnonzero((PAIRS[0] == min(b)) & (PAIRS[1] == max(b)))[0] for b in BONES]
    joints = np.zeros_like(column.truth)
    for pose, keypoints, known in zip(joints, column.keypoints, bone, strict=True):
        _, image = library.body_frame(keypoints, manifest["fewest_joints"], impute=True)
        found = library.predict(image)
        distance = found.distance * known.sum() / found.distance[pairs].sum()
        distance[pairs] = known
        scaled = library.mds(distance)
        if found.points.any():  # of `distances`; `fconn` gives none
            pose[:] = library.align(scaled, found.points)
        else:
            pose[:] = library.mirror(library.orient(scaled, image))
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
    people = bodies(motion, number("ANKLE_HEIGHT"))
    who = np.searchsorted(people.subject, motion.subject)
    height, bone = people.height[who], people.bone[who]
    figures = {}
    for name in tqdm(SIZED, desc="sizes", disable=None):
        poses = library.lift(columns[name].keypoints)
        fine = poses.ok
        few = columns[name].take(fine), motion.subject[fine], bone[fine]
        known = known_measurements(height[fine], bone[fine])
        figures[name] = column_sizes(library, poses.joints[fine], known, *few, manifest)
    titles = figures[SIZED[0]]
    return table("known, mm", list(SIZED), {t: [f[t] for f in figures.values()] for t in titles})


def column_sizes(
    library: Library,
    joints: np.ndarray,
    known: dict[str, dict[str, Any]],
    column: Column,
    subject: np.ndarray,
    bone: np.ndarray,
    manifest: dict[str, Any],
) -> dict[str, float]:
    """Errors of lifted poses [F,14,3], by what is known of the people."""
    errors = {}
    for title, person in known.items():
        fitted, status = library.fit_body(joints, **person)
        if (status != "ok").any():
            raise ValueError(f"{title}: {status[status != 'ok'][0]}")
        errors[title] = mean_error(fitted.astype(float), column.truth, subject)
    if network_gives_distances(manifest):
        inside = matrix_way(library, column, bone, manifest)
        errors[MATRIX] = mean_error(inside, column.truth, subject)
    best = joint_errors(joints, column.truth, "similarity").mean(1)
    errors["(the scale that fits the truth best)"] = 1000 * by_subject(best, subject).mean()
    return errors


def quality_figures(
    library: Library, columns: dict[str, Column]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Quality [F] and error [F] in metres of each column; NaN where there is no pose."""
    figures = {}
    for name, column in tqdm(columns.items(), desc="quality", disable=None):
        poses = library.lift(column.keypoints)
        fine, error = poses.ok, np.full(len(poses.joints), np.nan)
        error[fine] = rigid_errors(poses.joints[fine].astype(float), column.truth[fine]).mean(1)
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


def qualities(library: Library, model: str, motions: Mapping[str, Motion]) -> Tables:
    """The tables of a model's quality; their marks end in its name."""
    figures = {s: quality_figures(library, views(m.joints)) for s, m in motions.items()}
    both = {s: (figures[s], motion.subject) for s, motion in motions.items()}
    return {
        f"quality_{model}": by_set(deciles, figures),
        f"kept_{model}": by_set(lambda f: f"{kept(f[0])}\n{by_person(*f)}", both),
    }


def evaluate(models: Sequence[str], motions: Mapping[str, Motion]) -> Tables:
    """All tables of the page."""
    libraries = {model: Library(f"{model}_f32") for model in models}
    first, manifest = libraries[models[0]], read_manifest(models[0])
    found = {
        "sizes": by_set(lambda m: sizes(first, m, views(m.joints), manifest), motions),
        "partial": by_set(lambda m: partial(first, m), motions),
    }
    for model, library in libraries.items():
        found |= qualities(library, model, motions)
    return found


def options(parser: argparse.ArgumentParser) -> None:
    set_options(parser, MODELS)


def tables(args: argparse.Namespace) -> Tables:
    return evaluate(args.models, load_sets(args))


EVALUATION = Evaluation(__doc__, tables, options)
