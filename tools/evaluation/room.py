"""What a video tells of the room: the person's path, the camera's focal length, and the bones.

    evaluate.py room TEST.npz OTHERS.npz [--update docs/where-in-the-room.md docs/body.md]

Clips are those of `evaluate.py video`, each seen by one of its cameras, exactly (gt) and by its
imitated detectors.  Every pose is tracked.  The path is that of mid-hip before a camera that is
known.  Focal lengths are drawn evenly by their logarithm, from 0.7 to 2.2 times the image's height,
and their errors are those of the logarithm.  Limbs are upper arms, forearms, thighs and shins.  A
figure is the mean over subjects of the means of their clips.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

import edmlift
from data import cameras
from data.bodies import bone_lengths
from data.mocap import Motion, load_motion
from data.views import SEED
from edmlift.joints import BONES, JOINTS, mid_hip
from edmlift.lifting import Poses
from edmlift.metrics import joint_errors
from edmlift.networks import find_model
from edmlift.placing import place_joints, place_joints_by_sweep
from edmlift.tracking import MEASURED_POSES, Tracked
from evaluation import video
from evaluation.command import Evaluation, Tables, by_set
from evaluation.measures import by_subject
from reports.markdown import table

INTRINSICS = (cameras.FOCAL, cameras.FOCAL, cameras.CENTRE, cameras.CENTRE)
IMAGE = (2 * cameras.CENTRE, 2 * cameras.CENTRE)
HELD = {"": 0, ", bones held": MEASURED_POSES}  # titles, and the setting of the track
PATH_COLUMNS = ("gt", "noisy")
BONE_COLUMNS = ("gt", "noisy", "both")
FOCAL_COLUMNS = ("gt", "noisy")
FACTORS = (0.7, 2.2)  # focal lengths, image heights
USUAL = 1.2
POSES = (1, 15, 60)  # that say what the focal length is
LIMBS = [b for b, (_, end) in enumerate(BONES) if JOINTS[end].split("_")[-1] in
         ("elbow", "wrist", "knee", "ankle")]  # fmt: skip

Figures = dict[str, dict[str, float]]  # by column and row


@dataclass(frozen=True)
class Seen:
    """A clip and its columns of keypoints."""

    clip: video.Clip
    views: dict[str, video.View]

    def track(self, column: str, held: int) -> Tracked:
        """The frames of a column, tracked, with bones of so many poses."""
        keypoints = self.views[column].keypoints
        return edmlift.track(keypoints, time_ms=self.clip.time, hold_bones=held)


def watch(motion: Motion) -> list[Seen]:
    """The clips of a motion, each before one camera."""
    rng = np.random.default_rng(SEED)
    clips = video.cut(motion, rng)[:: video.CAMERAS]
    return [Seen(clip, video.views(clip, rng)) for clip in clips]


def means(parts: list[dict[str, float]], clips: list[Seen]) -> dict[str, float]:
    """Each figure of the clips, as the mean over their subjects."""
    subject = np.array([seen.clip.subject for seen in clips])
    return {
        key: float(by_subject(np.array([p[key] for p in parts]), subject).mean())
        for key in parts[0]
    }


# ---- The path --------------------------------------------------------------------------------


def path_figures(roots: np.ndarray, clip: video.Clip, way: str) -> dict[str, float]:
    """Figures of a path [F,3], in mm."""
    truth = mid_hip(clip.truth)
    sight = truth / np.linalg.norm(truth, axis=1, keepdims=True)
    off = 1000 * (roots - truth)
    along = (off * sight).sum(1)
    across = np.linalg.norm(off - along[:, None] * sight, axis=1)
    return {
        f"root, mm: {way}": np.nanmean(np.linalg.norm(off, axis=1)),
        f"of that across the line of sight, mm: {way}": np.nanmean(across),
        f"second difference, mm: {way}": np.nanmean(video.jitter(roots[:, None], clip)),
    }


def paths(clips: list[Seen]) -> Figures:
    """Placements of each frame alone, and filtered."""
    model, result = find_model(), {}
    for held, poses in HELD.items():
        for name in tqdm(PATH_COLUMNS, desc=f"path{held}", disable=None):
            parts = []
            for seen in clips:
                tracked = seen.track(name, poses)
                alone = place_joints(model, tracked, np.array(INTRINSICS, np.float32))
                filtered = edmlift.place(tracked, INTRINSICS)
                truth = video.jitter(mid_hip(seen.clip.truth)[:, None], seen.clip)
                parts.append(
                    path_figures(alone.translation.astype(float), seen.clip, "alone")
                    | path_figures(filtered.translation.astype(float), seen.clip, "filtered")
                    | {"second difference, mm: true": np.nanmean(truth)}
                )
            result[name + held] = means(parts, clips)
    return result


# ---- The focal length ------------------------------------------------------------------------


def through(keypoints: np.ndarray, factor: float) -> np.ndarray:
    """Keypoints [F,14,3] as a camera with another focal length sees them, in image heights."""
    zoomed = keypoints.copy()
    zoom = factor * IMAGE[1] / cameras.FOCAL
    zoomed[..., :2] = cameras.CENTRE + zoom * (keypoints[..., :2] - cameras.CENTRE)
    return zoomed


def focal_errors(tracked: Tracked, factor: float) -> dict[str, float]:
    """Errors of the focal length, %, by the number of poses that it is found from."""

    def first(count: int) -> Poses:
        return Poses.of(tracked.joints[:count], tracked.keypoints[:count], tracked.status[:count])

    few = first(POSES[-1])
    sizes = np.tile(np.array(IMAGE, np.float32), (len(few.joints), 1))
    each = place_joints_by_sweep(find_model(), few, sizes).focal

    def error(focal: np.ndarray | float) -> float:
        return float(100 * np.nanmean(np.abs(np.log(focal / (factor * IMAGE[1])))))

    figures = {
        "1.2 image heights for everyone": error(USUAL * IMAGE[1]),
        "the best of each": error(each),
    }
    for count in POSES:
        figures[f"of {count} pose{'s' * (count > 1)}"] = error(
            edmlift.focal_length(first(count), IMAGE)
        )
    return figures


def focal_lengths(clips: list[Seen]) -> Figures:
    """Each clip through a lens of its own."""
    rng, result = np.random.default_rng(SEED), {}
    factors = np.exp(rng.uniform(*np.log(FACTORS), len(clips)))
    for name in tqdm(FOCAL_COLUMNS, desc="focal", disable=None):
        parts = []
        for seen, factor in zip(clips, factors, strict=True):
            keypoints = through(seen.views[name].keypoints, factor)
            tracked = edmlift.track(keypoints, time_ms=seen.clip.time)
            parts.append(focal_errors(tracked, factor))
        result[name] = means(parts, clips)
    return result


# ---- Bones -----------------------------------------------------------------------------------


def bone_figures(tracked: Tracked, clip: video.Clip, way: str) -> dict[str, float]:
    """Figures of a clip's poses, in mm."""
    fine = tracked.ok
    joints, truth = tracked.joints[fine].astype(float), clip.truth[fine]
    lengths, true = bone_lengths(joints)[:, LIMBS], bone_lengths(clip.truth)[:, LIMBS].mean(0)
    return {
        f"error, mm: {way}": 1000 * joint_errors(joints, truth, "rigid").mean(),
        f"standard deviation of limbs, mm: {way}": 1000 * lengths.std(0).mean(),
        f"error of limbs' lengths, mm: {way}": 1000 * np.abs(lengths - true).mean(),
    }


def bones(clips: list[Seen]) -> Figures:
    """Tracked poses as they are, and with held bones."""
    result = {}
    for name in tqdm(BONE_COLUMNS, desc="bones", disable=None):
        parts = [
            bone_figures(seen.track(name, 0), seen.clip, "as lifted")
            | bone_figures(seen.track(name, MEASURED_POSES), seen.clip, "held")
            for seen in clips
        ]
        result[name] = means(parts, clips)
    return result


# ---- The tables ------------------------------------------------------------------------------


def report(figures: Figures) -> str:
    """A column a kind of keypoints; rows with the same beginning stand together."""
    rows = list(next(iter(figures.values())))
    begins = list(dict.fromkeys(row.partition(":")[0] for row in rows))
    rows.sort(key=lambda row: begins.index(row.partition(":")[0]))
    return table("", list(figures), {r: [f[r] for f in figures.values()] for r in rows})


def tables(args: argparse.Namespace) -> Tables:
    motions = [load_motion(path) for path in args.motion]
    clips = {Path(motion.source).stem: watch(motion) for motion in motions}
    return {
        "path": by_set(lambda c: report(paths(c)), clips),
        "focal": by_set(lambda c: report(focal_lengths(c)), clips),
        "held_bones": by_set(lambda c: report(bones(c)), clips),
    }


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("motion", type=Path, nargs="+", help=".npz or folder, a set of people each")


EVALUATION = Evaluation(__doc__, tables, options)
