"""The rules that choose the mirror image, side by side.

    evaluate.py mirror TEST.npz OTHERS.npz [--models distances direct fconn] [--quick]
                [--update docs/accuracy-log.md]

The lift chooses first: `fconn` by a linear score of five weights (lib/lift/mirror.h); `direct` and
`distances` give points, which are in one mirror image.  The joint limits then reflect that choice
where the mirror image violates fewer of them (lib/optional/joint_limits.h).  Measured on what the
network makes of exact 2D, of noise of 20 pixels and of a detector's noise; the linear score on true
poses, too, and with noise on them.
"""

import argparse
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from data.mocap import Motion
from data.views import SEED, views
from edmlift.joints import mid_hip
from edmlift.library import Library
from evaluation.command import Evaluation, Tables, by_set, load_sets, set_options
from evaluation.measures import MIRROR_IMAGE, by_subject, mean_errors
from reports.markdown import Figure, table

NOISE = 0.030  # metres, each coordinate of a joint
SAME = 1e-3  # mm: errors of one and the same pose
# Columns of data/views.py.
NETWORK = {"network, exact 2D": "gt", "network, 20 px": "n20", "network, detector": "cpm"}
MODELS = ("distances", "direct", "fconn")
OWN = {"distances": "the network", "direct": "the network", "fconn": "linear score"}
RULES = ("by chance", "joint limits, else by chance", "{}", "joint limits, else {}",
         "better mirror image")  # fmt: skip
CHOSEN, LIMITS = RULES[2], RULES[3]  # with what the lift goes by: OWN


@dataclass(frozen=True)
class Choices:
    """What the rules make of F poses; errors are in mm."""

    error: np.ndarray  # [F] of the one that the lift chose
    mirrored: np.ndarray  # [F] of its mirror image
    by_limits: np.ndarray  # [F] of what the joint limits then choose
    fewer: np.ndarray  # [F] by how many violations that has fewer than its mirror image
    violations: np.ndarray  # [F] how many it has
    subject: np.ndarray  # [F]
    action: np.ndarray  # [F]

    def take(self, which: np.ndarray) -> "Choices":
        """Some of the poses: a mask or indices."""
        return Choices(**{name: values[which] for name, values in vars(self).items()})

    @property
    def least(self) -> np.ndarray:
        """Error of the better mirror image, [F] mm."""
        return np.minimum(self.error, self.mirrored)


def choose(library: Library, joints: np.ndarray, truth: np.ndarray, motion: Motion) -> Choices:
    """The choices for poses [F,14,3], as the lift chose them; those that are NaN are left out.
    truth [F,14,3]."""
    fine = np.isfinite(joints).all((1, 2))
    joints, truth = joints[fine].astype(float), truth[fine]
    reflected, fewer = library.reflect_by_joint_limits(joints)
    return Choices(
        mean_errors(joints, truth),
        mean_errors(joints * MIRROR_IMAGE, truth),
        mean_errors(reflected.astype(float), truth),
        fewer,
        library.joint_limits(reflected),
        motion.subject[fine],
        motion.action[fine],
    )


def scored(library: Library, joints: np.ndarray) -> np.ndarray:
    """The mirror images of poses [F,14,3] that the linear score chooses, mid-hip at the origin."""
    joints = joints - mid_hip(joints)[:, None]
    return np.stack([library.mirror(pose) for pose in joints])


def choices(library: Library, motion: Motion, score: bool) -> dict[str, Choices]:
    """By what the poses are; score: the model has the linear score's weights."""
    columns = views(motion.joints)
    truth = columns["gt"].truth
    given = {}
    if score:
        noisy = truth + np.random.default_rng(SEED).normal(0, NOISE, truth.shape)
        given["true poses"] = scored(library, truth), truth
        given[f"with {1000 * NOISE:.0f} mm of noise"] = scored(library, noisy), truth
    for name, column in NETWORK.items():
        given[name] = library.lift(columns[column].keypoints).joints, columns[column].truth
    bar = tqdm(given.items(), desc="mirror images", disable=None)
    return {name: choose(library, joints, true, motion) for name, (joints, true) in bar}


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


def rules_table(found: dict[str, Choices], own: str) -> str:
    """A row a rule: choices that are right, %, and the mean error, mm; own: the lift's rule."""
    of = {name: rules(c) for name, c in found.items()}
    heads = [head for name in of for head in (f"{name}: %", "mm")]
    rows = {rule.format(own): [v for name in of for v in of[name][rule]] for rule in RULES}
    reflected = [int((np.abs(c.by_limits - c.error) > SAME).sum()) for c in found.values()]
    undecided = [int((c.fewer == 0).sum()) for c in found.values()]
    for title, counts in (("reflected", reflected), ("undecided", undecided)):
        rows[f"joint limits: poses {title}"] = [cell for n in counts for cell in (n, None)]
    return table("", heads, rows)


def violations_table(found: dict[str, Choices]) -> str:
    """Poses and their mean errors, by how many joint limits they violate once chosen."""
    rows = {}
    for name, c in found.items():
        rows[name] = [
            cell
            for which in (c.violations == 0, c.violations == 1, c.violations >= 2)
            for cell in (int(which.sum()), c.by_limits[which].mean() if which.any() else None)
        ]
    heads = [head for bones in ("none", "one", "more") for head in (f"{bones}: poses", "mm")]
    return table("violations", heads, rows)


def actions_table(found: dict[str, Choices], names: tuple[str, ...]) -> str:
    """Right choices by action: the lift and joint limits; then errors of the last poses."""
    heads = ["poses", "people"]
    for name in found:
        heads += [f"{name}: lift, %", "limits, %"]
    heads += [f"{name}: lift, mm", "limits, mm"]
    rows = {}
    for action in np.unique(found[name].action):
        of = {key: c.take(c.action == action) for key, c in found.items()}
        last = of[name]
        cells: list[Figure] = [len(last.error), len(np.unique(last.subject))]
        for c in of.values():
            cells += [rules(c)[rule][0] for rule in (CHOSEN, LIMITS)]
        cells += [rules(last)[rule][1] for rule in (CHOSEN, LIMITS)]
        rows[names[action] if 0 <= action < len(names) else "unknown"] = cells
    return table("", heads, rows)


def evaluate(library: Library, model: str, motions: Mapping[str, Motion]) -> Tables:
    """All tables of a model; their marks end in its name."""
    own = OWN[model]
    found = {s: choices(library, motion, own == OWN["fconn"]) for s, motion in motions.items()}
    named = {s: (found[s], motion.action_names) for s, motion in motions.items()}
    return {
        f"mirror_{model}": by_set(lambda c: rules_table(c, own), found),
        f"violations_{model}": by_set(violations_table, found),
        f"mirror_actions_{model}": by_set(lambda both: actions_table(*both), named),
    }


def options(parser: argparse.ArgumentParser) -> None:
    set_options(parser, MODELS)


def tables(args: argparse.Namespace) -> Tables:
    motions, found = load_sets(args), Tables()
    for model in args.models:
        found |= evaluate(Library(f"{model}_f32"), model, motions)
    return found


EVALUATION = Evaluation(__doc__, tables, options)
