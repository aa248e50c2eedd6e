"""Coefficients of lib/joints/adapt.h, by least squares over views with modelled heads.

    run.py fitting.adapters TRAIN.npz [--update docs/detectors.md]

The models take `head` and `neck_base` where the training skeletons have them, which is not where
detectors report a head and a neck.  So every adapter puts

    head = s + HEAD (e - s)     s: between the shoulders, e: what is seen of the head
    neck = s + TRUNK (h - s)    h: between the hips

and this finds HEAD for every e, and TRUNK.  The heads are tools/data/head_model.py's, so the errors
are those of a model: they rank the rules, and do not say how well a detector sees.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from data import cameras
from data.head_model import HEAD_BREADTH, NOSE_BEFORE_EAR, landmarks, low_necks
from data.mocap import MocapError, Motion, load_motion
from edmlift.joints import INDEX, mid_hip, mid_shoulder
from reports import markdown

SEED = 14
POSES = 600  # of each subject, drawn again where it has fewer: every body counts alike
PROFILE, FRONTAL = 0.7, 0.5  # cosines to the line of sight
EARS, EYES = ("left_ear", "right_ear"), ("left_eye", "right_eye")
FACE = (*EYES, "nose")

# What adapt.h calls them, and the points of which e is the mean.
EVIDENCE = {
    "CROWN": ("crown",),
    "CENTRE": ("h36m_head",),
    "BOTH_EARS": EARS,
    "ONE_EAR": ("left_ear",),
    "FACE": FACE,
}


class Views:
    """Projections [F,2] by name, in metres at the distance of the person, and in which of them [F]
    e may be what is seen: a single ear from its side, eyes and nose from the front."""

    def __init__(self, motion: Motion, seed: int = SEED) -> None:
        rng = np.random.default_rng(seed)
        joints = motion.joints.astype(float)
        low = low_necks(joints, motion.subject)
        draw = [rng.choice(np.flatnonzero((motion.subject == s) & low), POSES)
                for s in np.unique(motion.subject[low])]  # fmt: skip
        chosen = np.concatenate(draw)
        joints, subject = joints[chosen], motion.subject[chosen]
        points = landmarks(joints, subject, rng)
        space = cameras.look(np.concatenate([joints, np.stack([*points.values()], 1)], 1), rng)
        scale = mid_hip(space)[:, 2] / cameras.FOCAL
        image = (cameras.project(space) - cameras.CENTRE) * scale[:, None, None]
        self.points = {name: image[:, 14 + n] for n, name in enumerate(points)}
        away = {name: space[:, 14 + n, 2] for n, name in enumerate(points)}
        every = np.ones(len(image), bool)
        nose = away["nose"] - (away["left_ear"] + away["right_ear"]) / 2
        self.seen = {name: every for name in EVIDENCE} | {
            "ONE_EAR": away["left_ear"] - away["right_ear"] < -PROFILE * HEAD_BREADTH / 1000,
            "FACE": nose < -FRONTAL * NOSE_BEFORE_EAR / 1000,
        }
        self.shoulder, self.hip = mid_shoulder(image), mid_hip(image)
        self.head, self.neck = image[:, INDEX["head"]], image[:, INDEX["neck_base"]]

    def mean(self, *names: str) -> np.ndarray:
        """The middle [F,2] of some points."""
        return np.mean([self.points[name] for name in names], 0)


def coefficient(start: np.ndarray, through: np.ndarray, target: np.ndarray) -> float:
    """k of start + k (through - start) nearest to target, to two digits."""
    line = through - start
    return round(float((line * (target - start)).sum() / (line**2).sum()), 2)


def fit(views: Views) -> dict[str, float]:
    """The constants of lib/joints/adapt.h by name."""
    found = {}
    for name, points in EVIDENCE.items():
        seen = views.seen[name]
        through, target = views.mean(*points)[seen], views.head[seen]
        found[name] = coefficient(views.shoulder[seen], through, target)
    found["TRUNK"] = coefficient(views.shoulder, views.hip, views.neck)
    return found


def report(views: Views, k: dict[str, float]) -> str:
    """How far the points of our rules and of others are from the joints that the models take."""
    s, nose, eyes = views.shoulder, views.mean("nose"), views.mean(*EYES)
    titles = {"CROWN": "the crown", "CENTRE": "Human3.6M's head",
              "BOTH_EARS": "the middle of both ears", "ONE_EAR": "an ear, seen from its side",
              "FACE": "the middle of eyes and nose, seen from the front"}  # fmt: skip
    rows = []
    for name, title in titles.items():
        point = s + k[name] * (views.mean(*EVIDENCE[name]) - s)
        rule = f"s + {k[name]:.2f} (e - s), e: {title}"
        rows.append(_row("head", rule, (point - views.head)[views.seen[name]]))
    upright = np.stack([views.mean(*EYES, *EARS)[:, 0], (2 * eyes - nose)[:, 1]], 1)
    for rule, point in {
        "the crown itself": views.mean("crown"),
        "the middle of the eyes (mmpose, MotionBERT)": eyes,
        "the eyes twice less the nose, as high (MHFormer)": upright,
        "the nose twice less s (SMAP)": 2 * nose - s,
    }.items():
        rows.append(_row("head", rule, point - views.head))
    for rule, point in {
        f"s + {k['TRUNK']:.2f} (h - s)": s + k["TRUNK"] * (views.hip - s),
        "s (OpenPose)": s,
        "base of the neck (AI Challenger, CrowdPose)": views.mean("collar"),
        "upper neck (MPII, LSP, CPM)": views.mean("upper_neck"),
    }.items():
        rows.append(_row("neck", rule, point - views.neck))
    return markdown.table("joint", ["put at", "mean, mm", "95 %, mm"], rows, left=2)


def _row(joint: str, rule: str, difference: np.ndarray) -> tuple[str, list[str]]:
    error = 1000 * np.linalg.norm(difference, axis=1)
    return joint, [rule, f"{error.mean():.0f}", f"{np.percentile(error, 95):.0f}"]


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--update", type=Path, help="Markdown file with marks for the table")
    args = parser.parse_args()
    try:
        views = Views(load_motion(args.motion))
    except (MocapError, OSError) as error:
        print(f"adapters: {error}", file=sys.stderr)
        return 1
    found = fit(views)
    for name, value in found.items():
        print(f"#define {name} REAL({value:.2f})")
    text = report(views, found)
    print(text, end="")
    if args.update:
        markdown.write(args.update, "rules", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
