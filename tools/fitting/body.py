"""Constants of lib/optional/: body.h, stand.h, quality.h, uncertainty.c; from training people.

    run.py fitting.body TRAIN.npz OTHERS.npz [--models distances direct]

The networks know the training people, so the poses are of bodies that are varied as in their
training (cameras.vary_bodies), on the views of tools/data/views.py.  One set of constants serves
all of the models; each model and each file of people counts alike for quality, each person for
uncertainty.  Proportions are those of the first file, whose people are seen to stand.  Whoever
trains a network anew runs this again.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from scipy.optimize import minimize

from data import cameras
from data.bodies import GOOD, Bodies, ankle_height, bodies, bone_lengths, by_type
from data.mocap import MocapError, Motion, load_motion
from data.views import views
from edmlift.joints import BONE_TYPE, BONES, JOINTS, LIMBS, indices
from edmlift.library import Library, Poses
from edmlift.metrics import rigid_errors
from training.recipe import MAX_MISSING
from training.views import draw_masks

MODELS = ("distances", "direct")
SEED = 5
POSES = 600  # of each subject, drawn again where it has fewer: every body counts alike
VIEWS = 8  # of each pose, for uncertainty
LEG_BONES = slice(7, 13)  # from the neck to the ankles, both sides: half of their sum counts
JOINT_TYPE = ("head", "neck", "shoulder", "elbow", "wrist", "hip", "knee", "ankle")


class Lifter(Protocol):
    """The library, or what stands for it."""

    def lift(self, keypoints: np.ndarray) -> Poses:
        """Poses of keypoints [F,14,3]."""


# ---- People ----------------------------------------------------------------------------------


def chain(bones: np.ndarray) -> np.ndarray:
    """Head to ankle along the bones, the mean of both sides: [..., 13] -> [...]."""
    return bones[..., 0] + bones[..., LEG_BONES].sum(-1) / 2


def shares(people: Bodies) -> dict[str, float]:
    """Lengths of the bones, and of the chain, relative to the standing height."""
    found = by_type(people.bone / people.height[:, None])
    found["chain"] = chain(people.bone) / people.height
    return {kind: round(float(value.mean()), 3) for kind, value in found.items()}


def bone_ranges(people: Bodies) -> dict[str, tuple[float, float]]:
    """Shortest and longest bones of people, metres, to the centimetre outwards."""
    return {
        kind: (np.floor(100 * value.min()) / 100, np.ceil(100 * value.max()) / 100)
        for kind, value in by_type(people.bone).items()
    }


# ---- Quality ---------------------------------------------------------------------------------

# What quality is computed from, and the limits that it is clamped to.  Tried and left out, because
# they told nothing more of people held out, or hardly: how far the finished pose is from the image,
# how far the trunk, arms and legs point at the camera, which way the body faces, how large it is,
# and whether arms or legs are hidden.
CLAMPS = {"misfit": 0.5, "missing": 4.0, "bones": 4.0, "side": 1.0}
FEATURES = tuple(CLAMPS)
KEPT = 0.9  # the quality above which the report counts poses


def side_view(joints: np.ndarray) -> np.ndarray:
    """How far people [F,14,3] are seen from the side [F]: the share along the line of sight of the
    line from the torso's right to its left, 0 to 1.  Depths of limbs are surer then."""
    left, right = (
        joints[:, indices((f"{side}_shoulder", f"{side}_hip"))].sum(1) for side in ("left", "right")
    )
    across = left - right
    return np.abs(across[:, 2]) / np.maximum(np.linalg.norm(across, axis=1), 1e-9)


def length_violation(joints: np.ndarray, allowed: dict[str, tuple[float, float]]) -> np.ndarray:
    """Metres [F] by which bones are shorter or longer than people's, in all."""
    lengths = by_type(bone_lengths(joints))
    parts = [
        np.maximum(0, np.maximum(least - lengths[kind], lengths[kind] - most)).sum(1)
        for kind, (least, most) in allowed.items()
    ]
    return np.sum(parts, 0)


def features(poses: Poses, allowed: dict[str, tuple[float, float]]) -> np.ndarray:
    """What quality is computed from, [F,4]."""
    joints = poses.joints.astype(float)
    values = {
        "misfit": poses.misfit,
        "missing": (~poses.seen).sum(1),
        "bones": length_violation(joints, allowed),
        "side": side_view(joints),
    }
    return np.stack([np.minimum(values[name], CLAMPS[name]) for name in FEATURES], 1)


def sigmoid(score: np.ndarray) -> np.ndarray:
    """From 0 to 1 without an exponential."""
    return (1 + score / np.hypot(1, score)) / 2


@dataclass(frozen=True)
class Sample:
    """What a model makes of a file's people, in every view: N poses."""

    title: str
    x: np.ndarray  # [N,4] features
    good: np.ndarray  # [N] bool


def quality_of(x: np.ndarray, weights: dict[str, float]) -> np.ndarray:
    """The quality [N] of features [N,4]."""
    return sigmoid(x @ np.array([weights[name] for name in FEATURES]) + weights["constant"])


def fit_quality(samples: Sequence[Sample]) -> dict[str, float]:
    """Weights and constant of the score whose sigmoid is the likeliest chance of a good pose; all
    samples count alike."""
    x, good = (np.concatenate([getattr(s, name) for s in samples]) for name in ("x", "good"))
    share = np.concatenate([np.full(len(s.x), 1 / len(s.x) / len(samples)) for s in samples])
    mean, spread = x.mean(0), x.std(0)
    z = np.c_[(x - mean) / spread, np.ones(len(x))]

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        score = z @ weights
        chance = np.clip(sigmoid(score), 1e-9, 1 - 1e-9)
        slope = np.where(good, -1 / chance, 1 / (1 - chance)) / np.hypot(1, score) ** 3 / 2
        return -(share * np.log(np.where(good, chance, 1 - chance))).sum(), z.T @ (share * slope)

    found = minimize(loss, np.zeros(z.shape[1]), jac=True).x
    weights = found[:-1] / spread
    constant = found[-1] - (weights * mean).sum()
    named = dict(zip(FEATURES, weights, strict=True)) | {"constant": constant}
    return {name: round(float(value), 3) for name, value in named.items()}


# ---- Uncertainty -----------------------------------------------------------------------------


def has_hidden_neighbour(seen: np.ndarray) -> np.ndarray:
    """Mask [F,14] of the joints that have an unseen one at the other end of a bone."""
    hidden = np.zeros_like(seen)
    for start, end in BONES:
        hidden[:, end] |= ~seen[:, start]
        hidden[:, start] |= ~seen[:, end]
    return hidden


def joint_types() -> np.ndarray:
    """Row [14] of each joint in the tables."""
    kinds = [name.removeprefix("right_").removeprefix("left_") for name in JOINTS]
    return np.array([JOINT_TYPE.index(kind.removesuffix("_base")) for kind in kinds])


def draw_hidden(count: int, rng: np.random.Generator) -> np.ndarray:
    """Masks [F,14] as in training; every fourth pose lacks two limbs."""
    seen = draw_masks(count, rng)
    for i in range(0, count, 4):
        first, second = rng.choice(list(LIMBS), 2, replace=False)
        seen[i] = (cameras.hide_limb(1, first) & cameras.hide_limb(1, second))[0]
    return seen


def uncertainty(
    lifters: Sequence[Lifter], joints: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Mean errors in mm of a kind of joint [8,9]: seen, by how many are not (0 to 4); not seen,
    with all its neighbours seen; not seen, without, by how many are not (2 to 4)."""
    truth = cameras.look(np.tile(joints, (VIEWS, 1, 1)), rng)
    hidden = draw_hidden(len(truth), rng)
    points = cameras.detector_noise(cameras.project(truth), rng)
    errors, masks = [], []
    for lifter in lifters:
        poses = lifter.lift(cameras.keypoints(points, hidden))
        fine = poses.status == "ok"
        masks.append(hidden[fine])
        errors.append(1000 * rigid_errors(poses.joints[fine].astype(float), truth[fine]))
    seen, error = np.concatenate(masks), np.concatenate(errors)
    missing = np.broadcast_to((~seen).sum(1)[:, None], seen.shape)
    alone, lost = MAX_MISSING + 1, MAX_MISSING + missing
    state = np.where(seen, missing, np.where(has_hidden_neighbour(seen), lost, alone))
    table = np.zeros((len(JOINT_TYPE), 2 * MAX_MISSING + 1), int)
    for kind in range(len(table)):
        of = joint_types() == kind
        for column in range(table.shape[1]):
            table[kind, column] = round(error[:, of][state[:, of] == column].mean())
    return table


# ---- All of it -------------------------------------------------------------------------------


def draw_people(motion: Motion, rng: np.random.Generator) -> np.ndarray:
    """Poses of other people, [F,14,3]."""
    each = [rng.choice(np.flatnonzero(motion.subject == s), POSES)
            for s in np.unique(motion.subject)]  # fmt: skip
    return cameras.vary_bodies(motion.joints[np.concatenate(each)].astype(float), rng)


def sample(
    title: str, lifter: Lifter, joints: np.ndarray, allowed: dict[str, tuple[float, float]]
) -> Sample:
    """Poses seen in every way of the protocol."""
    x, good = [], []
    for column in views(joints, SEED).values():
        poses = lifter.lift(column.keypoints)
        fine = poses.status == "ok"
        x.append(features(poses, allowed)[fine])
        error = rigid_errors(poses.joints[fine].astype(float), column.truth[fine])
        good.append(error.mean(1) < GOOD)
    return Sample(title, np.concatenate(x), np.concatenate(good))


def widest(ranges: Sequence[dict[str, tuple[float, float]]]) -> dict[str, tuple[float, float]]:
    """What is within any of these ranges."""
    return {
        kind: (min(r[kind][0] for r in ranges), max(r[kind][1] for r in ranges))
        for kind in ranges[0]
    }


@dataclass(frozen=True)
class Constants:
    """What the C files have; a test compares."""

    ankle: float
    shares: dict[str, float]
    bone_range: dict[str, tuple[float, float]]
    quality: dict[str, float]
    uncertainty: np.ndarray
    disagreement: float  # largest ratio of the heights that bones of one person stand for
    kept: dict[str, tuple[float, float]]  # above KEPT: share of a sample's poses, and of good ones


def fit(lifters: dict[str, Lifter], motions: Sequence[Motion]) -> Constants:
    """All constants, of models by their names and files of people."""
    rng = np.random.default_rng(SEED)
    ankle = ankle_height(motions[0])
    people = [bodies(motion, ankle) for motion in motions]
    share = shares(people[0])
    allowed = widest([bone_ranges(some) for some in people])
    drawn = [draw_people(motion, rng) for motion in motions]
    samples = [
        sample(f"{name}, {motion.source}", lifter, joints, allowed)
        for name, lifter in lifters.items()
        for motion, joints in zip(motions, drawn, strict=True)
    ]
    weights = fit_quality(samples)
    bones = by_type(np.concatenate([some.bone for some in people]))
    own = np.concatenate([bones[kind] / share[kind] for kind in BONE_TYPE], 1)
    return Constants(
        ankle,
        share,
        allowed,
        weights,
        uncertainty([*lifters.values()], np.concatenate(drawn), rng),
        float((own.max(1) / own.min(1)).max()),
        {s.title: kept(s, weights) for s in samples},
    )


def kept(of: Sample, weights: dict[str, float]) -> tuple[float, float]:
    """Share of poses above KEPT, and of good ones among them."""
    above = quality_of(of.x, weights) > KEPT
    return float(above.mean()), float(of.good[above].mean()) if above.any() else float("nan")


def report(found: Constants) -> str:
    """The constants as text, by the file that holds them."""
    lines = [f"stand.h: ankle {found.ankle:.2f} m", "body.h: proportions of the standing height"]
    lines += [f"  {kind} {share:.3f}" for kind, share in found.shares.items()]
    lines += [f"  bones of one person disagree by a factor of {found.disagreement:.2f} at most"]
    lines += ["quality.h: range of bones, metres"]
    lines += [f"  {kind} {low:.2f} {high:.2f}" for kind, (low, high) in found.bone_range.items()]
    lines += ["quality.h: weights"]
    lines += [f"  {name} {weight:.3f}" for name, weight in found.quality.items()]
    lines += [f"  above {KEPT}, and of these under {1000 * GOOD:.0f} mm:"]
    lines += [
        f"  {title}: {100 * a:.1f} %, {100 * b:.1f} %" for title, (a, b) in found.kept.items()
    ]
    lines += ["uncertainty.c, mm"]
    lines += [
        f"  {kind} " + ", ".join(map(str, row))
        for kind, row in zip(JOINT_TYPE, found.uncertainty, strict=True)
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, nargs="+", help=".npz or folder of motion capture")
    parser.add_argument("--models", nargs="+", default=MODELS, help="(%(default)s)")
    args = parser.parse_args()
    try:
        lifters = {model: Library(f"{model}_f32") for model in args.models}
        found = fit(lifters, [load_motion(path) for path in args.motion])
    except (MocapError, OSError, ValueError) as error:
        print(f"body: {error}", file=sys.stderr)
        return 1
    print(report(found), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
