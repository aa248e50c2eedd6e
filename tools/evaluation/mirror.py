"""The rules that choose the mirror image, side by side: Markdown.

    run.py evaluation.mirror TEST.npz [--model fconn_f32] [--update docs/accuracy.md] [--quick]

Through the C library: the linear score of lib/mirror.inc, and the joint limits of lib/limits.inc,
which turn what the score has chosen where the mirror image has fewer bones beyond them.  On true
poses, on true poses with noise, and on what the network makes of exact 2D, of noise of 20 pixels
and of a detector's (views of tools/evaluate.py).  Errors and means are those of evaluate.py.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from data.mocap import MocapError, Motion, load_motion
from edmlift.joints import mid_hip
from edmlift.library import Library
from edmlift.metrics import rigid_errors
from evaluation.accuracy import SEED, Column, by_subject, table, views
from reports import markdown

NOISE = 0.030  # metres, each coordinate of a joint
SAME = 1e-3  # mm: errors of one and the same pose
# Columns of evaluate.py.
NETWORK = {"network, exact 2D": "gt", "network, 20 px": "n20", "network, detector": "cpm"}
RULES = ("by chance", "joint limits, else by chance", "linear score",
         "joint limits, else linear score", "better mirror image")  # fmt: skip
SCORE, LIMITS = RULES[2], RULES[3]


@dataclass(frozen=True)
class Choices:
    """Of F poses: the error in mm of the one that the linear score chose, of its mirror image, and
    of what the joint limits then choose; how many bones fewer that has beyond the limits; how many
    it has; whose pose it is, and what it does."""

    error: np.ndarray
    mirrored: np.ndarray
    by_limits: np.ndarray
    fewer: np.ndarray
    beyond: np.ndarray
    subject: np.ndarray
    action: np.ndarray

    def take(self, which: np.ndarray) -> "Choices":
        return Choices(**{name: values[which] for name, values in vars(self).items()})

    @property
    def least(self) -> np.ndarray:
        return np.minimum(self.error, self.mirrored)


def choose(library: Library, joints: np.ndarray, truth: np.ndarray, motion: Motion) -> Choices:
    """Of poses [F,14,3], as the linear score chose them, and the truth [F,14,3]; of those only
    that are not NaN."""
    fine = np.isfinite(joints).all((1, 2))
    joints, truth = joints[fine].astype(float), truth[fine]
    turned, fewer = library.mirror_by_limits(joints)

    def mean_error(poses: np.ndarray) -> np.ndarray:
        return 1000 * rigid_errors(poses.astype(float), truth).mean(1)

    return Choices(
        mean_error(joints), mean_error(joints * [1, 1, -1]), mean_error(turned),
        fewer, library.limits(turned), motion.subject[fine], motion.action[fine],
    )  # fmt: skip


def scored(library: Library, joints: np.ndarray) -> np.ndarray:
    """The mirror images of poses [F,14,3] that the linear score chooses, mid-hip at the origin."""
    joints = joints - mid_hip(joints)[:, None]
    return np.stack([library.mirror(pose)[0] for pose in joints])


def choices(library: Library, motion: Motion) -> dict[str, Choices]:
    """By what the poses are."""
    columns = views(motion.joints)
    truth = columns["gt"].truth
    noisy = truth + np.random.default_rng(SEED).normal(0, NOISE, truth.shape)
    whole = np.ones(truth.shape[:2], bool)
    given = {
        "true poses": Column(scored(library, truth), whole, truth),
        f"with {1000 * NOISE:.0f} mm of noise": Column(scored(library, noisy), whole, truth),
    }
    for name, column in NETWORK.items():
        lifted = library.lift(columns[column].keypoints).joints
        given[name] = Column(lifted, whole, columns[column].truth)
    bar = tqdm(given.items(), desc="mirror images", disable=None)
    return {name: choose(library, c.keypoints, c.truth, motion) for name, c in bar}


def rules(c: Choices) -> dict[str, tuple[float, float]]:
    """Choices that are right, %, and mean error, mm, of each of RULES."""
    chance, undecided = (c.error + c.mirrored) / 2, c.fewer == 0
    errors = (chance, np.where(undecided, chance, c.by_limits), c.error, c.by_limits, c.least)
    half = np.full(len(chance), 0.5)
    right = [(error - c.least < SAME).astype(float) for error in errors]
    right[0], right[1] = half, np.where(undecided, half, right[1])
    return {
        name: (100 * by_subject(good, c.subject).mean(), by_subject(error, c.subject).mean())
        for name, good, error in zip(RULES, right, errors, strict=True)
    }


def rules_table(found: dict[str, Choices]) -> str:
    of = {name: rules(c) for name, c in found.items()}
    heads = [head for name in of for head in (f"{name}: %", "mm")]
    rows = {rule: [value for name in of for value in of[name][rule]] for rule in RULES}
    turned = [int((np.abs(c.by_limits - c.error) > SAME).sum()) for c in found.values()]
    undecided = [int((c.fewer == 0).sum()) for c in found.values()]
    for title, counts in (("turned", turned), ("undecided", undecided)):
        rows[f"joint limits: poses {title}"] = [cell for n in counts for cell in (n, None)]
    return table("", heads, rows)


def beyond_table(found: dict[str, Choices]) -> str:
    """Poses and their mean errors, by how many bones they have beyond the limits once chosen."""
    rows = {}
    for name, c in found.items():
        rows[name] = [
            cell
            for which in (c.beyond == 0, c.beyond == 1, c.beyond >= 2)
            for cell in (int(which.sum()), c.by_limits[which].mean() if which.any() else None)
        ]
    heads = [head for bones in ("none", "one", "more") for head in (f"{bones}: poses", "mm")]
    return table("bones beyond", heads, rows)


def actions_table(found: dict[str, Choices], names: tuple[str, ...]) -> str:
    """Right choices by action: linear score and joint limits; then errors of the last poses."""
    heads = ["poses", "people"]
    for name in found:
        heads += [f"{name}: score, %", "limits, %"]
    heads += [f"{name}: score, mm", "limits, mm"]
    rows = {}
    for action in np.unique(found[name].action):
        of = {key: c.take(c.action == action) for key, c in found.items()}
        last = of[name]
        cells: list[float | int] = [len(last.error), len(np.unique(last.subject))]
        for c in of.values():
            cells += [rules(c)[rule][0] for rule in (SCORE, LIMITS)]
        cells += [rules(last)[rule][1] for rule in (SCORE, LIMITS)]
        rows[names[action] if 0 <= action < len(names) else "unknown"] = cells
    return table("", heads, rows)


def evaluate(library: Library, motion: Motion) -> dict[str, str]:
    """The tables, by the names of their marks."""
    found = choices(library, motion)
    return {
        "mirror": rules_table(found),
        "beyond": beyond_table(found),
        "mirror_actions": actions_table(found, motion.action_names),
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--model", default="fconn_f32")
    parser.add_argument("--update", type=Path, help="Markdown file with marks for the tables")
    parser.add_argument("--quick", action="store_true", help="every 20th pose")
    args = parser.parse_args()
    try:
        motion = load_motion(args.motion)
        if args.quick:
            motion = motion.take(np.arange(0, len(motion.joints), 20))
        tables = evaluate(Library(args.model), motion)
        print("\n".join(tables.values()))
        if args.update:
            markdown.write_those(args.update, tables)
    except (MocapError, OSError, ValueError) as error:
        print(f"mirror: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
