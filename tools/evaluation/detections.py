"""Lifts the detections of examples/data/detections and says how far off they are.

    evaluate.py detections [--update docs/detections.md] [--picture docs/detections.png]

Four cameras see one man walk on a beam: his joints, triangulated from the detections of all four,
are the reference for what is lifted from each.  BlazePose's own 3D is measured beside it.  MoveNet
sees the same; each detector's keypoints are lifted and held against each one's triangulation.
Its picture is beside BlazePose's, detections_thunder.png.
"""

import argparse
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

import edmlift
from data.detections import (
    BEAM,
    BLAZEPOSE,
    DETECTORS,
    FIRST,
    THUNDER,
    Clip,
    Detector,
    put_right,
    read_beam,
    read_street,
)
from edmlift.joints import mid_hip
from edmlift.library import Library
from edmlift.metrics import joint_errors, rigid_errors
from evaluation.command import Evaluation, Tables
from evaluation.measures import MIRROR_IMAGE
from reports.markdown import table

SCALED = "similarity"  # alignment with scale
THRESHOLDS = (0.0, 0.1, 0.2, 0.3, 0.5)
DRAWN = ((0, 2), (0, 8), (1, 8), (1, 12), (2, 2), (3, 12))  # view, frame

Beam = dict[str, Clip]  # the four views, as one detector sees them


def millimetres(errors: np.ndarray) -> float:
    """Mean of errors in metres, NaN left out, mm."""
    return 1000 * float(np.nanmean(errors))


def measure(library: Library, clip: Clip) -> dict[str, float | int]:
    """The figures of a clip: ROWS says what they are."""
    poses = library.lift(clip.keypoints)
    fine = poses.status == "ok"
    joints, world = poses.joints[fine].astype(float), clip.world[fine]
    figures = {"frames": len(fine), "refused": int((~fine).sum())}
    if np.isfinite(world).all():
        figures["lift_world"] = millimetres(rigid_errors(joints, world))
        figures["lift_world_scaled"] = millimetres(joint_errors(joints, world, SCALED))
    if np.isfinite(clip.truth).all():
        figures |= _against_truth(library, clip)
    return figures


def _against_truth(library: Library, clip: Clip) -> dict[str, float | int]:
    keypoints, sure = (put_right(k, clip.swapped) for k in (clip.keypoints, clip.sure))
    detected, right, of_sure = (
        library.lift(k).joints.astype(float) for k in (clip.keypoints, keypoints, sure)
    )
    placed = library.place(right, keypoints, clip.camera).joints.astype(float)
    chosen = rigid_errors(right, clip.truth).mean(1)
    other = rigid_errors(right * MIRROR_IMAGE, clip.truth).mean(1)
    distance = mid_hip(placed)[:, 2] / mid_hip(clip.truth)[:, 2] - 1
    figures = {
        "swapped": int(clip.swapped.sum()),
        "lift": millimetres(rigid_errors(detected, clip.truth)),
        "lift_right": millimetres(chosen),
        "lift_sure": millimetres(rigid_errors(of_sure, clip.truth)),
        "lift_right_scaled": millimetres(joint_errors(right, clip.truth, SCALED)),
        "lift_right_worst": millimetres(chosen.max()),
        "lift_right_axes": millimetres(joint_errors(right, clip.truth, "root")),
        "placed_axes": millimetres(joint_errors(placed, clip.truth, "root")),
        "placed_distance": 100 * float(np.abs(distance).mean()),
        "mirror": 100 * float((chosen <= other).mean()),
    }
    return figures | (_world_against_truth(clip) if np.isfinite(clip.world).all() else {})


def _world_against_truth(clip: Clip) -> dict[str, float]:
    right = put_right(clip.world, clip.swapped)
    return {
        "world": millimetres(rigid_errors(clip.world, clip.truth)),
        "world_right": millimetres(rigid_errors(right, clip.truth)),
        "world_right_scaled": millimetres(joint_errors(right, clip.truth, SCALED)),
        "world_right_axes": millimetres(joint_errors(right, clip.truth, "root")),
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


def against(library: Library, clips: Beam, truth: Beam, frames: slice) -> float:
    """Mean error in mm of one detector's lifts, sides put right, against the triangulation of
    another, over some frames of all views."""
    errors = [
        rigid_errors(library.lift(clip.right()[frames]).joints, of.truth[frames])
        for clip, of in zip(clips.values(), truth.values(), strict=True)
    ]
    return millimetres(np.stack(errors))


# Rows of the table of detectors that are those of clips, and what is made of the four views.
SHARED = {
    "lift_sure": ("lift, sure keypoints only", np.mean),
    "lift_right_worst": ("lift, worst frame", np.max),
    "mirror": ("lift, mirror image right, %", np.mean),
    "lift_right_axes": ("lift, not aligned", np.mean),
    "placed_axes": ("the same after `edml_place`, not aligned", np.mean),
}


def compare(
    library: Library, beams: Mapping[str, Beam], errors: Mapping[str, np.ndarray]
) -> dict[str, dict[str, float | int]]:
    """A column of the table of detectors for each: its figures by the titles of the rows."""
    later, first = slice(FIRST, None), slice(FIRST)
    columns = {}
    for name, clips in beams.items():
        views = [measure(library, clip.frames(later)) for clip in clips.values()]
        columns[name] = {
            "frames": sum(view["frames"] for view in views),
            "frames with left and right swapped": sum(view["swapped"] for view in views),
            "pixels from its own triangulation": float(np.median(errors[name][:, later])),
            **{
                f"**lift, against that of {other}**": against(library, clips, truth, later)
                for other, truth in beams.items()
            },
            **{
                title: float(summary([view[key] for view in views]))
                for key, (title, summary) in SHARED.items()
            },
            f"lift, first frame, against that of {BLAZEPOSE.name}": against(
                library, clips, beams[BLAZEPOSE.name], first
            ),
        }
    return columns


def report_detectors(columns: dict[str, dict]) -> str:
    """A column a detector."""
    titles = next(iter(columns.values()))
    return table("mm", list(columns), {t: [c[t] for c in columns.values()] for t in titles})


def compare_thresholds(library: Library) -> dict[str, dict[str, float]]:
    """A column a threshold of the confidence: the mean error of each detector's lifts, sides put
    right, over all views, and how many frames of the street are refused."""
    columns: dict[str, dict[str, float]] = {}
    for threshold in THRESHOLDS:
        column = columns[f"{threshold:g}"] = {}
        for detector in (replace(one, sure=threshold) for one in DETECTORS):
            clips = read_beam(library, detector)[0].values()
            views = [measure(library, clip.frames(slice(FIRST, None))) for clip in clips]
            column[detector.name] = float(np.mean([view["lift_sure"] for view in views]))
        for detector in (replace(one, sure=threshold) for one in DETECTORS):
            street = library.lift(read_street(library, detector).sure)
            column[f"{detector.name}: street, frames refused"] = int((~street.ok).sum())
    return columns


def picture(library: Library, clips: Beam, path: Path, detector: Detector = BLAZEPOSE) -> None:
    """Draws what was lifted of a few frames, and the reference."""
    keypoints, truth = (
        np.concatenate([getattr(clips[name], field) for name in BEAM])
        for field in ("keypoints", "truth")
    )
    poses = library.lift(keypoints)
    truth = truth - mid_hip(truth)[:, None]
    frames = [len(clips[BEAM[0]].keypoints) * view + frame for view, frame in DRAWN]
    names = [f"camera {view + 1}, frame {frame}" for view, frame in DRAWN]
    title = f"edmlift: detections of {detector.name}, lifted, and triangulated from four cameras"
    edmlift.draw(poses, path, truth=truth, title=title, frames=frames, names=names)


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--model", default="distances_f32", help="(%(default)s)")
    parser.add_argument("--picture", type=Path, help="where to draw a few frames")


def draw(library: Library, beams: Mapping[str, Beam], path: Path) -> None:
    """The pictures of BlazePose and of MoveNet, the larger one."""
    for detector in (BLAZEPOSE, THUNDER):
        beside = path.with_stem(path.stem + detector.ending)
        picture(library, beams[detector.name], beside, detector)


def tables(args: argparse.Namespace) -> Tables:
    library = Library(args.model)
    beams, errors = {}, {}
    for detector in DETECTORS:
        beams[detector.name], errors[detector.name] = read_beam(library, detector)
    clips = beams[BLAZEPOSE.name] | {"street": read_street(library)}
    pixels = np.median(errors[BLAZEPOSE.name])
    if args.picture:
        draw(library, beams, args.picture)
    return {
        "detections": report({name: measure(library, clip) for name, clip in clips.items()}),
        "reference": f"reference: {pixels:.1f} pixels from the detections (median)\n",
        "detectors": report_detectors(compare(library, beams, errors)),
        "thresholds": report_detectors(compare_thresholds(library)),
    }


EVALUATION = Evaluation(__doc__, tables, options)
