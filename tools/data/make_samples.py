"""Makes the sample clips of examples/data: 2D keypoints and their 3D truth.

    run.py data.make_samples [--wheel pybullet-3.2.7-...whl] [--out examples/data]

Three clips come from the pybullet package's wheel (zlib licence), whose humanoid they move; the
T-pose is written by hand below.  Each is seen by one camera that stands still.  World frame of the
clips: metres, y up, x the subject's forward, z the subject's right.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from data import cameras
from edmlift.joints import JOINTS, mid_hip

PYBULLET = "pybullet==3.2.7"
MODEL = "pybullet_data/humanoid/humanoid.urdf"
CLIP = "pybullet_data/data/motions/humanoid3d_{}.txt"
MODEL_SCALE = 0.25  # metres per unit of the model: pybullet loads it with globalScaling 0.25
FPS = 30.0

# What a motion frame holds after its duration and the root's position, and how many numbers:
# a quaternion w x y z, or an angle about the model's z axis.
CHANNELS = {
    "root": 4,
    "chest": 4,
    "neck": 4,
    "right_hip": 4,
    "right_knee": 1,
    "right_ankle": 4,
    "right_shoulder": 4,
    "right_elbow": 1,
    "left_hip": 4,
    "left_knee": 1,
    "left_ankle": 4,
    "left_shoulder": 4,
    "left_elbow": 1,
}

# An adult of 1.75 m holding a T-pose: metres, x forward, y up, z right.
T_POSE = {
    "head": (0.02, 1.75, 0.00),
    "neck_base": (0.00, 1.48, 0.00),
    "right_shoulder": (-0.01, 1.44, 0.18),
    "right_elbow": (-0.02, 1.44, 0.46),
    "right_wrist": (0.00, 1.43, 0.71),
    "left_shoulder": (-0.01, 1.44, -0.18),
    "left_elbow": (-0.02, 1.44, -0.46),
    "left_wrist": (0.00, 1.43, -0.71),
    "right_hip": (0.00, 0.92, 0.10),
    "right_knee": (0.02, 0.50, 0.11),
    "right_ankle": (-0.02, 0.09, 0.12),
    "left_hip": (0.00, 0.92, -0.10),
    "left_knee": (0.02, 0.50, -0.11),
    "left_ankle": (-0.02, 0.09, -0.12),
}


@dataclass(frozen=True)
class View:
    """Where a clip's camera stands, and what the files say of their origin."""

    yaw: float  # degrees from the subject's forward to the camera, towards the subject's right
    origin: str


PYBULLET_ORIGIN = "humanoid3d_{}.txt of pybullet_data 3.2.7 (zlib licence), altered; see README.md"
VIEWS = {
    "walk": View(45.0, PYBULLET_ORIGIN.format("walk")),
    "cartwheel": View(45.0, PYBULLET_ORIGIN.format("cartwheel")),
    "kick": View(45.0, PYBULLET_ORIGIN.format("kick")),
    "tpose": View(20.0, "written by hand for edmlift (MIT licence)"),
}
CAMERA_DISTANCE = 4.0  # metres over the ground, to the middle of the clip
CAMERA_HEIGHT = 1.5  # metres


@dataclass(frozen=True)
class Link:
    """A joint of the model and the link that it moves."""

    name: str
    parent: str
    offset: np.ndarray  # [3] from the parent's joint, metres


def read_model(robot: ElementTree.Element) -> tuple[list[Link], np.ndarray]:
    """The model's links, parents first, and the head's top [3] relative to the neck, metres."""
    links = []
    for joint in robot.iter("joint"):
        offset = _vector(joint.find("origin")) * MODEL_SCALE
        links.append(
            Link(joint.find("child").get("link"), joint.find("parent").get("link"), offset)
        )
    head = robot.find("link[@name='neck']/collision")
    radius = float(head.find("geometry/sphere").get("radius"))
    top = (_vector(head.find("origin")) + [0.0, radius, 0.0]) * MODEL_SCALE
    return links, top


def _vector(origin: ElementTree.Element) -> np.ndarray:
    return np.array([float(word) for word in origin.get("xyz").split()])


def read_clip(text: str) -> np.ndarray:
    """Frames [F,44] of a motion file, thinned to about 30 a second."""
    frames = np.array(json.loads(text)["Frames"])
    return frames[:: max(1, round(1 / (FPS * frames[0, 0])))]


def pose_model(frames: np.ndarray, links: list[Link], head_end: np.ndarray) -> np.ndarray:
    """Forward kinematics: frames [F,44] -> our joints [F,14,3], world, metres."""
    relative = _rotations(frames)
    rotation = {"base": Rotation.identity(len(frames))}
    place = {"base": frames[:, 1:4]}
    for link in links:
        place[link.name] = place[link.parent] + rotation[link.parent].apply(link.offset)
        own = relative.get(link.name, Rotation.identity())
        rotation[link.name] = rotation[link.parent] * own
    place["head"] = place["neck"] + rotation["neck"].apply(head_end)
    place["neck_base"] = place["neck"]
    return np.stack([place[joint] for joint in JOINTS], 1)


def _rotations(frames: np.ndarray) -> dict[str, Rotation]:
    """Each link's rotation [F] relative to its parent."""
    rotations = {}
    column = 4
    for name, width in CHANNELS.items():
        values = frames[:, column : column + width]
        if width == 4:
            rotations[name] = Rotation.from_quat(values[:, [1, 2, 3, 0]])
        else:
            rotations[name] = Rotation.from_euler("z", values)
        column += width
    return rotations


def view(joints: np.ndarray, yaw: float) -> np.ndarray:
    """One clip in the axes of its camera, which aims at the clip's mean mid-hip."""
    aim = mid_hip(joints).mean(0)
    angle = np.radians(yaw)
    aside = CAMERA_DISTANCE * np.array([np.cos(angle), 0.0, np.sin(angle)])
    position = np.array([aim[0], CAMERA_HEIGHT, aim[2]]) + aside
    return cameras.look_from(joints, position, aim)


def write_clip(folder: Path, name: str, joints: np.ndarray) -> None:
    """Writes NAME.csv and NAME_truth.csv from world joints [F,14,3]."""
    seen = view(joints, VIEWS[name].yaw)
    points = cameras.keypoints(cameras.project(seen))
    truth = seen - mid_hip(seen)[:, None]
    origin = f"# Origin: {VIEWS[name].origin}"
    order = f"# {', '.join(JOINTS)}"
    _write_csv(
        folder / f"{name}.csv",
        (
            f"# {name}: 2D keypoints, one pose a line, x,y,c of each joint; image 1000 x 1000",
            "# pixels, y down; c: confidence. Joints (left and right are the subject's):",
            order,
            origin,
        ),
        points.reshape(len(points), -1),
        ("%.2f", "%.2f", "%d"),
    )
    _write_csv(
        folder / f"{name}_truth.csv",
        (
            f"# {name}: 3D truth of {name}.csv, one pose a line, x,y,z of each joint; metres;",
            "# camera axes: x right, y down, z away; origin mid-hip. Joints:",
            order,
            origin,
        ),
        truth.reshape(len(truth), -1),
        ("%.4f", "%.4f", "%.4f"),
    )


def _write_csv(
    path: Path, comments: tuple[str, ...], rows: np.ndarray, formats: tuple[str, ...]
) -> None:
    """Comments, then a line of 42 numbers a pose; `formats` are those of one joint."""
    pattern = ",".join(formats * len(JOINTS))
    rows = np.round(rows, 4) + 0.0  # no -0.0000
    lines = [*comments, *(pattern % tuple(row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


def download_wheel(folder: Path) -> Path:
    """The pybullet wheel; its data are the same on every platform, so one platform's is named."""
    options = "--no-deps --only-binary=:all: --python-version 3.11 --platform manylinux2014_x86_64"
    command = [sys.executable, "-m", "pip", "download", *options.split(), "-d", folder, PYBULLET]
    subprocess.run(command, check=True)
    return next(folder.glob("pybullet-*.whl"))


def write_samples(wheel: Path, folder: Path) -> None:
    """Writes every clip's two files."""
    with zipfile.ZipFile(wheel) as archive:
        # A stray byte follows the closing tag.
        model = archive.read(MODEL).decode().rpartition("</robot>")
        links, head_end = read_model(ElementTree.fromstring(model[0] + model[1]))
        for name in ("walk", "cartwheel", "kick"):
            frames = read_clip(archive.read(CLIP.format(name)).decode())
            write_clip(folder, name, pose_model(frames, links, head_end))
    write_clip(folder, "tpose", np.array([[T_POSE[joint] for joint in JOINTS]]))


def main() -> None:
    parser = argparse.ArgumentParser(description="Makes the sample clips of examples/data.")
    parser.add_argument(
        "--wheel", type=Path, help=f"wheel of {PYBULLET}; downloaded with pip where not given"
    )
    parser.add_argument(
        "--out", type=Path, default=Path("examples/data"), help="folder; default %(default)s"
    )
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        write_samples(args.wheel or download_wheel(Path(scratch)), args.out)


if __name__ == "__main__":
    main()
