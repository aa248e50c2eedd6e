"""What a track makes of a video.

    evaluate.py video MOTION [--fps 30] [--model distances_f32] [--update docs/video.md --name NAME]
    evaluate.py video MOTION --noise-full 0    # with filters that always act in full

MOTION is an .npz, whose clips are the frames that follow one another within 0.2 s, or a folder of
motion capture, read at --fps frames a second.  A clip is seen by four fixed cameras, exactly (gt)
and by an imitated detector: noisy; also with joints that come and go (missing); with right and left
swapped now and then (swapped); with both.  Each frame is lifted by itself, and by
edml_track_lift().  A figure is the mean over subjects of the means of their frames.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from data import cameras
from data.bodies import bone_lengths
from data.mocap import AMC_FPS, Cleaning, Motion, load_motion, read_folder
from data.views import SEED
from edmlift.joints import MIRROR, indices, mid_hip
from edmlift.library import Library, Poses, Tracked
from evaluation.command import Evaluation, Tables
from evaluation.measures import MIRROR_IMAGE, by_subject, mean_errors
from reports.markdown import Figure, table

LONGEST_STEP = 0.2  # seconds between frames of a clip
SHORTEST = 15  # frames of a clip
CAMERAS = 4

# The imitated detector: half of the variance of its noise is new in every frame, half is slow.
SLOW = 0.5  # seconds, the time constant of the slow half
HIDDEN_SHARE, HIDDEN_SECONDS = 0.05, 0.2  # of the joints' time, mean length of a spell
MOST_HIDDEN = 4  # joints that a lift can miss
SWAPPED_SHARE, SWAPPED_SECONDS = 0.04, 0.1

RIGHT_ARM = indices(("right_shoulder", "right_elbow", "right_wrist"))
RIGHT_LEG = indices(("right_hip", "right_knee", "right_ankle"))
GROUPS = tuple([*side, *MIRROR[side].tolist()] for side in (RIGHT_ARM, RIGHT_LEG))


@dataclass(frozen=True)
class Clip:
    """Contiguous frames of one trial."""

    truth: np.ndarray  # [F,14,3] camera axes, metres
    time: np.ndarray  # [F] ms
    subject: int

    @property
    def seconds(self) -> np.ndarray:
        """Time from the frame before, [F]; of the first frame that to the second."""
        step = np.diff(self.time) / 1000
        return np.concatenate([step[:1], step])


def cut(motion: Motion, rng: np.random.Generator) -> list[Clip]:
    """The clips of a motion, each before CAMERAS of its own."""
    order = np.lexsort((motion.frame, motion.trial, motion.subject))
    motion = motion.take(order)
    step = np.diff(motion.frame) / AMC_FPS
    same = (np.diff(motion.subject) == 0) & (np.diff(motion.trial) == 0)
    cuts = np.flatnonzero(~(same & (step <= LONGEST_STEP))) + 1
    clips = []
    for which in np.split(np.arange(len(motion.frame)), cuts):
        if len(which) < SHORTEST:
            continue
        time = np.round(1000 * motion.frame[which] / AMC_FPS).astype(int)
        for _ in range(CAMERAS):
            truth = watch(motion.joints[which].astype(float), rng)
            clips.append(Clip(truth, time, int(motion.subject[which[0]])))
    return clips


def watch(joints: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Joints [F,14,3] in the axes of one camera, as far from all the person's path as PROTOCOL."""
    rig, pelvis = cameras.PROTOCOL, mid_hip(joints)
    centre = (pelvis.min(0) + pelvis.max(0)) / 2
    reach = np.linalg.norm(pelvis - centre, axis=1).max()
    away, yaw = rng.uniform(*rig.distance) + reach, rng.uniform(0, 2 * np.pi)
    camera = centre + away * np.array([np.cos(yaw), 0, np.sin(yaw)])
    camera[1] = rng.uniform(*rig.height)
    aim = centre + rng.normal(0, rig.aim_sigma, 3)
    return cameras.look_from(joints, camera, aim, np.radians(rng.normal(0, rig.roll_sigma)))


def spells(
    clip: Clip, count: int, share: float, mean: float, rng: np.random.Generator
) -> np.ndarray:
    """Mask [F,count] true for `share` of the time, in spells of `mean` seconds on average."""
    on = np.zeros((len(clip.time), count), bool)
    draw = rng.random(on.shape)
    ends = 1 - np.exp(-clip.seconds / mean)
    begins = ends * share / (1 - share)
    on[0] = draw[0] < share
    for f in range(1, len(on)):
        on[f] = np.where(on[f - 1], draw[f] >= ends[f], draw[f] < begins[f])
    return on


def detector_noise(clip: Clip, rng: np.random.Generator) -> np.ndarray:
    """Errors [F,14,2] in pixels, of the size of cameras.detector_noise()."""
    shape = (len(clip.time), len(MIRROR), 2)
    fast = cameras.detector_noise(np.zeros(shape), rng) / np.sqrt(2)
    draw = cameras.detector_noise(np.zeros(shape), rng) / np.sqrt(2)
    slow = draw.copy()
    keep = np.exp(-clip.seconds / SLOW)
    for f in range(1, len(slow)):
        slow[f] = keep[f] * slow[f - 1] + np.sqrt(1 - keep[f] ** 2) * draw[f]
    return fast + slow


@dataclass(frozen=True)
class View:
    """What the detector says of a clip: keypoints [F,14,3], and what it got wrong."""

    keypoints: np.ndarray
    swapped: np.ndarray  # [F,2] arms, legs


def swap(keypoints: np.ndarray, swapped: np.ndarray) -> np.ndarray:
    """Right and left of arms and legs swapped where [F,2] says so."""
    out = keypoints.copy()
    for g, group in enumerate(GROUPS):
        which = np.ix_(swapped[:, g], group)
        out[which] = keypoints[swapped[:, g]][:, MIRROR[group]]
    return out


def views(clip: Clip, rng: np.random.Generator) -> dict[str, View]:
    """The columns of the table."""
    exact = cameras.project(clip.truth)
    noisy = cameras.keypoints(exact + detector_noise(clip, rng))
    hidden = spells(clip, len(MIRROR), HIDDEN_SHARE, HIDDEN_SECONDS, rng)
    hidden &= hidden.cumsum(1) <= MOST_HIDDEN
    missing = np.where(hidden[..., None], 0, noisy)
    kind = spells(clip, 3, SWAPPED_SHARE / 3, SWAPPED_SECONDS, rng)  # arms, legs, all
    wrong = kind[:, :2] | kind[:, 2:]
    right = np.zeros_like(wrong)
    return {
        "gt": View(cameras.keypoints(exact), right),
        "noisy": View(noisy, right),
        "missing": View(missing, right),
        "swapped": View(swap(noisy, wrong), wrong),
        "both": View(swap(missing, wrong), wrong),
    }


def jitter(joints: np.ndarray, clip: Clip) -> np.ndarray:
    """Second differences [F], mm, mean over joints; NaN where steps in time differ."""
    step = np.diff(clip.time)
    even = np.abs(np.diff(step)) <= 1 + (step[1:] < 40)  # whole ms of thirtieths of a second
    size = 1000 * np.linalg.norm(np.diff(joints, 2, axis=0), axis=-1).mean(1)
    out = np.full(len(joints), np.nan)
    out[1:-1] = np.where(even, size, np.nan)
    return out


LAGS = np.arange(-2, 4.01, 0.1)  # frames


def squares_by_lag(joints: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """Sum of squared distances from the truth so many frames ago, for each of LAGS."""
    frame = np.arange(len(truth), dtype=float)
    inner = slice(4, -2)  # where the truth is known at every lag
    sums = np.zeros(len(LAGS))
    for n, lag in enumerate(LAGS):
        at = np.clip(frame[inner] - lag, 0, len(truth) - 1.001)
        low = at.astype(int)
        part = (at - low)[:, None, None]
        then = (1 - part) * truth[low] + part * truth[low + 1]
        sums[n] = np.nansum((joints[inner] - then) ** 2)
    return sums


def measure(poses: Poses, clip: Clip) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Figures [F] of a clip's poses, and their squares by lag."""
    joints = poses.joints.astype(float)
    rooted = clip.truth - mid_hip(clip.truth)[:, None]
    fine = poses.status == "ok"
    error, mirrored = (np.full(len(fine), np.nan) for _ in range(2))
    error[fine] = mean_errors(joints[fine], clip.truth[fine])
    mirrored[fine] = mean_errors(joints[fine] * MIRROR_IMAGE, clip.truth[fine])
    lengths = bone_lengths(joints)
    return {
        "error": error,
        "axes": 1000 * np.linalg.norm(joints - rooted, axis=-1).mean(1),
        "jitter": jitter(joints, clip),
        "mirror": np.where(fine, 100.0 * (error <= mirrored), np.nan),
        "length": 1000 * lengths.mean(1),
        "spread": 1000 * np.abs(lengths - np.nanmean(lengths, 0)).mean(1),
        "refused": 100.0 * ~fine,
    }, squares_by_lag(joints, rooted)


def swaps(tracked: Tracked, view: View) -> dict[str, int]:
    """Swaps of arms and of legs, counted separately in each frame that was lifted."""
    fine = tracked.status == "ok"
    said, true = tracked.swapped[fine], view.swapped[fine]
    return {
        "found": int((said & true).sum()),
        "missed": int((~said & true).sum()),
        "false": int((said & ~true).sum()),
    }


ROWS = {
    "error": "error, mm",
    "axes": "camera axes, no alignment, mm",
    "jitter": "jitter, mm",
    "lag": "lag, frames",
    "mirror": "mirror right, %",
    "length": "bone length, mm",
    "spread": "its spread over a clip, mm",
    "refused": "refused, %",
}
COUNTS = {"found": "swaps found", "missed": "swaps missed", "false": "false swaps"}


def summarise(parts: list[tuple[dict, np.ndarray]], subject: np.ndarray) -> dict[str, float]:
    """The figures of all clips; `subject` is that of every frame."""
    figures = {
        key: by_subject(np.concatenate([part[key] for part, _ in parts]), subject).mean()
        for key in parts[0][0]
    }
    figures["lag"] = LAGS[np.argmin(sum(squares for _, squares in parts))]
    return figures


def track(library: Library, view: View, clip: Clip, noise_full: float | None) -> Tracked:
    """The frames through a track, whose setting `noise_full` may be another one."""
    follower = library.track()
    if noise_full is not None:
        follower.state["noise_full"] = noise_full
    return follower.lift(view.keypoints, clip.time)


def evaluate(
    library: Library, clips: list[Clip], seed: int = SEED, noise_full: float | None = None
) -> dict[str, dict]:
    """Figures of each kind of detections: {column: {"alone": .., "tracked": .., count: ..}}."""
    rng = np.random.default_rng(seed)
    seen = [views(clip, rng) for clip in clips]
    subject = np.concatenate([np.full(len(clip.time), clip.subject) for clip in clips])
    result = {}
    for name in tqdm(seen[0], desc="video", disable=None):
        alone, tracked, counts = [], [], []
        for clip, view in zip(clips, seen, strict=True):
            alone.append(measure(library.lift(view[name].keypoints), clip))
            poses = track(library, view[name], clip, noise_full)
            tracked.append(measure(poses, clip))
            counts.append(swaps(poses, view[name]))
        result[name] = {
            "alone": summarise(alone, subject),
            "tracked": summarise(tracked, subject),
            **{key: sum(count[key] for count in counts) for key in COUNTS},
        }
    return result


def true_jitter(clips: list[Clip]) -> float:
    """Jitter of the motion itself, mm."""
    parts = [jitter(clip.truth - mid_hip(clip.truth)[:, None], clip) for clip in clips]
    subject = np.concatenate([np.full(len(clip.time), clip.subject) for clip in clips])
    return by_subject(np.concatenate(parts), subject).mean()


def report(figures: dict[str, dict], clips: list[Clip]) -> str:
    """A table, a column a kind of detections."""
    columns = figures.values()
    rows: dict[str, list[Figure]] = {}
    for key, title in ROWS.items():
        for way in ("alone", "tracked"):
            rows[f"{title}: {way}"] = [float(column[way][key]) for column in columns]
    for key, title in COUNTS.items():
        rows[title] = [column[key] for column in columns]
    people, frames = len({clip.subject for clip in clips}), sum(len(c.time) for c in clips)
    said = (
        f"{len(clips)} views, {CAMERAS} a clip, people: {people}, frames: {frames}; "
        f"their true jitter is {true_jitter(clips):.1f} mm.\n"
    )
    return table("", list(figures), rows) + "\n" + said


def load_video(path: Path, fps: float) -> Motion:
    """An .npz, or all frames of a folder at so many a second."""
    if path.is_dir():
        return read_folder(path, Cleaning(fps=fps, min_move=0.0))
    return load_motion(path)


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--fps", type=float, default=30.0, help="of a folder (default: 30)")
    parser.add_argument("--model", default="distances_f32", help="(%(default)s)")
    parser.add_argument("--noise-full", type=float, help="edml_track's, instead of its default")
    parser.add_argument("--name", default="video", help="of the marks (%(default)s)")


def tables(args: argparse.Namespace) -> Tables:
    motion, library = load_video(args.motion, args.fps), Library(args.model)
    clips = cut(motion, np.random.default_rng(SEED))
    if not clips:
        raise ValueError(f"{args.motion}: no {SHORTEST} frames in a row")
    return {args.name: report(evaluate(library, clips, noise_full=args.noise_full), clips)}


EVALUATION = Evaluation(__doc__, tables, options)
