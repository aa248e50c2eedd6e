"""Lifts the detections of examples/data/detections and says how far off they are.

    evaluate.py detections [--update docs/detections.md] [--picture docs/detections.png]

Four cameras see one man walk on a beam: his joints, triangulated from the detections of all four,
are the reference for what is lifted from each.  BlazePose's own 3D is measured beside it.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import edmlift
from data.paths import EXAMPLES
from data.triangulate import read_cameras, triangulate
from edmlift.joints import MIRROR, mid_hip
from edmlift.library import Library
from edmlift.metrics import joint_errors, rigid_errors
from evaluation.command import Evaluation, Tables
from evaluation.measures import MIRROR_IMAGE
from reports.markdown import table

DATA = EXAMPLES / "detections"
CAMERAS = DATA / "beam_cameras.json"
FORMAT = "blazepose33"
KEYPOINTS = 33
SURE = 0.5  # visibility
SCALED = "similarity"  # alignment with scale
BEAM = ("beam1", "beam2", "beam3", "beam4")
SIZES = {"street": (1768, 994)}  # those of the beam's cameras are in their file
DRAWN = ((0, 2), (0, 8), (1, 8), (1, 12), (2, 2), (3, 12))  # view, frame

# Each keypoint's counterpart on the other side.
SIDE_PAIRS = ((1, 4), (2, 5), (3, 6), (7, 8), (9, 10))  # of the face; then the body's
SIDE_PAIRS += tuple((i, i + 1) for i in range(11, KEYPOINTS, 2))
SWAPPED = np.arange(KEYPOINTS)
for left, right in SIDE_PAIRS:
    SWAPPED[[left, right]] = right, left
LIMB_KEYPOINTS = [*range(11, 17), *range(23, 29)]  # shoulders to wrists, hips to ankles


@dataclass(frozen=True)
class Clip:
    """Detections of F frames, as the library takes them, and what else is known of them."""

    keypoints: np.ndarray  # [F,14,3] pixels and confidence
    sure: np.ndarray  # [F,14,3] of those of the detector's keypoints alone that it is sure of
    world: np.ndarray  # [F,14,3] BlazePose's 3D, metres, camera axes
    truth: np.ndarray  # [F,14,3] triangulated, metres, camera axes, from the camera; else NaN
    swapped: np.ndarray  # [F] the detector took left for right, as the other views show
    camera: tuple[float, ...] = ()  # focal length and centre, x and y, pixels, where known


def read(name: str, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Keypoints [F,33,3] in pixels, with visibility, and world landmarks [F,33,3] of a clip."""
    keypoints, world = (
        np.loadtxt(DATA / f"{file}.csv", delimiter=",").reshape(-1, KEYPOINTS, 3)
        for file in (name, f"{name}_world")
    )
    return keypoints * [*size, 1], world


def joints_3d(library: Library, points: np.ndarray) -> np.ndarray:
    """BlazePose's points in space [F,33,3] to joints [F,14,3], by the adapter of images.

    It treats every coordinate alike, so x and y go through it, and then z.
    """
    seen = np.ones((*points.shape[:2], 1))
    flat = [np.concatenate([points[..., axes], seen], -1) for axes in ([0, 1], [2, 2])]
    xy, z = (library.adapt(part, FORMAT)[..., :2] for part in flat)
    return np.concatenate([xy, z[..., :1]], -1).astype(float)


def adapt(library: Library, keypoints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """BlazePose's keypoints [F,33,3] to joints [F,14,3]: all, and those of visibility over SURE."""
    visibility = keypoints[..., 2:]
    sure = np.concatenate([keypoints[..., :2], np.where(visibility > SURE, visibility, 0)], -1)
    return library.adapt(keypoints, FORMAT), library.adapt(sure, FORMAT)


def read_street(library: Library) -> Clip:
    """The clip of the street, which has no reference."""
    keypoints, world = read("street", SIZES["street"])
    unknown = np.full((len(world), 14, 3), np.nan)
    swapped = np.zeros(len(world), bool)
    return Clip(*adapt(library, keypoints), joints_3d(library, world), unknown, swapped)


def read_beam(library: Library) -> tuple[dict[str, Clip], np.ndarray]:
    """The four views, and the distances [4,F,12] of limb joints in the image from the reference,
    in pixels."""
    views = read_cameras(CAMERAS)
    found = [read(name, view.size) for name, view in zip(BEAM, views, strict=True)]
    seen = np.stack([keypoints for keypoints, _ in found])
    points, swapped, errors = triangulate(views, seen[..., :2], seen[..., 2], SWAPPED)
    truth = joints_3d(library, points)
    clips = {
        name: Clip(
            *adapt(library, keypoints),
            joints_3d(library, world),
            view.look(truth),
            mistaken,
            (*view.focal, *view.centre),
        )
        for name, view, (keypoints, world), mistaken in zip(
            BEAM, views, found, swapped, strict=True
        )
    }
    return clips, errors[:, :, LIMB_KEYPOINTS]


def put_right(joints: np.ndarray, swapped: np.ndarray) -> np.ndarray:
    """Swaps left and right of joints [F,14,D] where the detector had swapped them."""
    return np.where(swapped[:, None, None], joints[:, MIRROR], joints)


def millimetres(errors: np.ndarray) -> float:
    """Mean of errors in metres, NaN left out, mm."""
    return 1000 * float(np.nanmean(errors))


def measure(library: Library, clip: Clip) -> dict[str, float | int]:
    """The figures of a clip: ROWS says what they are."""
    poses = library.lift(clip.keypoints)
    fine = poses.status == "ok"
    joints, world = poses.joints[fine].astype(float), clip.world[fine]
    figures = {
        "frames": len(fine),
        "refused": int((~fine).sum()),
        "lift_world": millimetres(rigid_errors(joints, world)),
        "lift_world_scaled": millimetres(joint_errors(joints, world, SCALED)),
    }
    if np.isfinite(clip.truth).all():
        figures |= _against_truth(library, clip)
    return figures


def _against_truth(library: Library, clip: Clip) -> dict[str, float | int]:
    keypoints, sure = (put_right(k, clip.swapped) for k in (clip.keypoints, clip.sure))
    detected, right, of_sure = (
        library.lift(k).joints.astype(float) for k in (clip.keypoints, keypoints, sure)
    )
    world = put_right(clip.world, clip.swapped)
    placed = library.place(right, keypoints, clip.camera).joints.astype(float)
    chosen = rigid_errors(right, clip.truth).mean(1)
    other = rigid_errors(right * MIRROR_IMAGE, clip.truth).mean(1)
    distance = mid_hip(placed)[:, 2] / mid_hip(clip.truth)[:, 2] - 1
    return {
        "swapped": int(clip.swapped.sum()),
        "lift": millimetres(rigid_errors(detected, clip.truth)),
        "world": millimetres(rigid_errors(clip.world, clip.truth)),
        "lift_right": millimetres(chosen),
        "lift_sure": millimetres(rigid_errors(of_sure, clip.truth)),
        "lift_right_scaled": millimetres(joint_errors(right, clip.truth, SCALED)),
        "lift_right_worst": millimetres(chosen.max()),
        "lift_right_axes": millimetres(joint_errors(right, clip.truth, "root")),
        "placed_axes": millimetres(joint_errors(placed, clip.truth, "root")),
        "placed_distance": 100 * float(np.abs(distance).mean()),
        "mirror": 100 * float((chosen <= other).mean()),
        "world_right": millimetres(rigid_errors(world, clip.truth)),
        "world_right_scaled": millimetres(joint_errors(world, clip.truth, SCALED)),
        "world_right_axes": millimetres(joint_errors(world, clip.truth, "root")),
    }


ROWS = {
    "frames": "frames",
    "refused": "refused",
    "swapped": "frames with left and right swapped by the detector",
    "lift": "**lift**",
    "world": "BlazePose's 3D",
    "lift_right": "**lift, sides put right**",
    "lift_sure": "lift, sides put right, keypoints of visibility over 0.5 only",
    "lift_right_scaled": "lift, sides put right, scaled",
    "lift_right_worst": "lift, sides put right, worst frame",
    "mirror": "lift, sides put right: mirror image right, %",
    "world_right": "BlazePose's 3D, sides put right",
    "world_right_scaled": "BlazePose's 3D, sides put right, scaled",
    "lift_right_axes": "lift, sides put right, not aligned",
    "placed_axes": "the same after `edml_place`, not aligned",
    "placed_distance": "its distance to the camera, % off",
    "world_right_axes": "BlazePose's 3D, sides put right, not aligned",
    "lift_world": "lift, against BlazePose's 3D",
    "lift_world_scaled": "lift, against BlazePose's 3D, scaled",
}


def report(figures: dict[str, dict]) -> str:
    """A column a clip."""
    rows = {title: [clip.get(key) for clip in figures.values()] for key, title in ROWS.items()}
    return table("mm", list(figures), rows)


def picture(library: Library, clips: dict[str, Clip], path: Path) -> None:
    """Draws what was lifted of a few frames, and the reference."""
    keypoints, truth = (
        np.concatenate([getattr(clips[name], field) for name in BEAM])
        for field in ("keypoints", "truth")
    )
    poses = library.lift(keypoints)
    truth = truth - mid_hip(truth)[:, None]
    frames = [len(clips[BEAM[0]].keypoints) * view + frame for view, frame in DRAWN]
    names = [f"camera {view + 1}, frame {frame}" for view, frame in DRAWN]
    title = "edmlift: detections of BlazePose, lifted, and triangulated from four cameras"
    edmlift.draw(poses, path, truth=truth, title=title, frames=frames, names=names)


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--model", default="fconn_f32", help="(%(default)s)")
    parser.add_argument("--picture", type=Path, help="where to draw a few frames")


def tables(args: argparse.Namespace) -> Tables:
    library = Library(args.model)
    clips, errors = read_beam(library)
    figures = {
        name: measure(library, clip)
        for name, clip in (clips | {"street": read_street(library)}).items()
    }
    pixels = f"reference: {np.median(errors):.1f} pixels from the detections (median)\n"
    if args.picture:
        picture(library, clips, args.picture)
    return {"detections": report(figures), "reference": pixels}


EVALUATION = Evaluation(__doc__, tables, options)
