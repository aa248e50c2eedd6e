"""Constants of lib/optional/: body.h, stand.h, quality.h, uncertainty.c; from training people.

    run.py fitting.body TRAIN.npz

The network knows the training people, so the poses are of bodies that are varied as in its training
(cameras.vary_bodies), on the views of tools/data/views.py.  Whoever trains a network anew runs this
again.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

from data import cameras
from data.bodies import GOOD, Bodies, ankle_height, bodies, bone_lengths, by_type
from data.mocap import MocapError, Motion, load_motion
from data.views import views
from edmlift.joints import BONE_TYPE, BONES, JOINTS, LIMBS
from edmlift.library import Library, Poses
from edmlift.metrics import rigid_errors
from training.recipe import MAX_MISSING
from training.views import draw_masks

SEED = 5
POSES = 600  # of each subject, drawn again where it has fewer: every body counts alike
VIEWS = 8  # of each pose, for uncertainty
LEG_BONES = slice(7, 13)  # from the neck to the ankles, both sides: half of their sum counts
JOINT_TYPE = ("head", "neck", "shoulder", "elbow", "wrist", "hip", "knee", "ankle")


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

FEATURES = ("margin", "residual", "misfit", "missing", "bones")
CLAMPS = {"margin": 2.0, "residual": 0.5, "misfit": 0.5, "missing": 4.0, "bones": 4.0}


def misfit(joints: np.ndarray, keypoints: np.ndarray) -> np.ndarray:
    """RMS difference [F] in metres of the seen joints of poses [F,14,3], seen orthographically,
    from keypoints [F,14,3] at their best scale and place."""
    seen = keypoints[..., 2:] > 0
    count = seen.sum((1, 2))

    def centred(points: np.ndarray) -> np.ndarray:
        mean = (points * seen).sum(1) / count[:, None]
        return (points - mean[:, None]) * seen

    p, q = centred(joints[..., :2]), centred(keypoints[..., :2])
    scale = np.maximum((p * q).sum((1, 2)), 0) / (q**2).sum((1, 2))
    return np.sqrt(((p - scale[:, None, None] * q) ** 2).sum((1, 2)) / count)


def length_violation(joints: np.ndarray, allowed: dict[str, tuple[float, float]]) -> np.ndarray:
    """Metres [F] by which bones are shorter or longer than people's, in all."""
    lengths = by_type(bone_lengths(joints))
    parts = [
        np.maximum(0, np.maximum(least - lengths[kind], lengths[kind] - most)).sum(1)
        for kind, (least, most) in allowed.items()
    ]
    return np.sum(parts, 0)


def features(
    poses: Poses, keypoints: np.ndarray, allowed: dict[str, tuple[float, float]]
) -> np.ndarray:
    """What quality is computed from, [F,5]."""
    joints = poses.joints.astype(float)
    values = {
        "margin": poses.mirror_margin,
        "residual": poses.residual,
        "misfit": misfit(joints, keypoints),
        "missing": (keypoints[..., 2] <= 0).sum(1),
        "bones": length_violation(joints, allowed),
    }
    return np.stack([np.minimum(values[name], CLAMPS[name]) for name in FEATURES], 1)


def sigmoid(score: np.ndarray) -> np.ndarray:
    """From 0 to 1 without an exponential."""
    return (1 + score / np.hypot(1, score)) / 2


def fit_quality(x: np.ndarray, good: np.ndarray) -> dict[str, float]:
    """Weights and constant of the score whose sigmoid is the likeliest chance of a good pose."""
    mean, spread = x.mean(0), x.std(0)
    z = np.c_[(x - mean) / spread, np.ones(len(x))]

    def loss(weights: np.ndarray) -> tuple[float, np.ndarray]:
        score = z @ weights
        chance = np.clip(sigmoid(score), 1e-9, 1 - 1e-9)
        slope = np.where(good, -1 / chance, 1 / (1 - chance)) / np.hypot(1, score) ** 3 / 2
        return -np.log(np.where(good, chance, 1 - chance)).mean(), z.T @ slope / len(z)

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


def uncertainty(library: Library, joints: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Mean errors in mm of a kind of joint [8,9]: seen, by how many are not (0 to 4); not seen,
    with all its neighbours seen; not seen, without, by how many are not (2 to 4)."""
    truth = cameras.look(np.tile(joints, (VIEWS, 1, 1)), rng)
    seen = draw_hidden(len(truth), rng)
    points = cameras.detector_noise(cameras.project(truth), rng)
    poses = library.lift(cameras.keypoints(points, seen))
    fine = poses.status == "ok"
    seen = seen[fine]
    error = 1000 * rigid_errors(poses.joints[fine].astype(float), truth[fine])
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


def quality_data(
    library: Library, joints: np.ndarray, allowed: dict[str, tuple[float, float]]
) -> tuple[np.ndarray, np.ndarray]:
    """Features [N,5] and errors [N] in metres of poses seen in every way of the protocol."""
    x, errors = [], []
    for column in views(joints, SEED).values():
        poses = library.lift(column.keypoints)
        fine = poses.status == "ok"
        x.append(features(poses, column.keypoints, allowed)[fine])
        error = rigid_errors(poses.joints[fine].astype(float), column.truth[fine])
        errors.append(error.mean(1))
    return np.concatenate(x), np.concatenate(errors)


@dataclass(frozen=True)
class Constants:
    """What the C files have; a test compares."""

    ankle: float
    shares: dict[str, float]
    bone_range: dict[str, tuple[float, float]]
    quality: dict[str, float]
    uncertainty: np.ndarray
    disagreement: float  # largest ratio of the heights that bones of one person stand for


def fit(library: Library, motion: Motion) -> Constants:
    """All constants."""
    rng = np.random.default_rng(SEED)
    ankle = ankle_height(motion)
    people = bodies(motion, ankle)
    share = shares(people)
    joints = draw_people(motion, rng)
    x, error = quality_data(library, joints, bone_ranges(people))
    own = np.concatenate([by_type(people.bone)[kind] / share[kind] for kind in BONE_TYPE], 1)
    return Constants(
        ankle,
        share,
        bone_ranges(people),
        fit_quality(x, error < GOOD),
        uncertainty(library, joints, rng),
        float((own.max(1) / own.min(1)).max()),
    )


def report(found: Constants) -> str:
    """The constants as text, by the file that holds them."""
    lines = [f"stand.h: ankle {found.ankle:.2f} m", "body.h: proportions of the standing height"]
    lines += [f"  {kind} {share:.3f}" for kind, share in found.shares.items()]
    lines += [f"  bones of one person disagree by a factor of {found.disagreement:.2f} at most"]
    lines += ["quality.h: range of bones, metres"]
    lines += [f"  {kind} {low:.2f} {high:.2f}" for kind, (low, high) in found.bone_range.items()]
    lines += ["quality.h: weights"]
    lines += [f"  {name} {weight:.3f}" for name, weight in found.quality.items()]
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
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--model", default="fconn_f32")
    args = parser.parse_args()
    try:
        found = fit(Library(args.model), load_motion(args.motion))
    except (MocapError, OSError, ValueError) as error:
        print(f"body: {error}", file=sys.stderr)
        return 1
    print(report(found), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
