"""Sample motion: a few people in the layout of the motion data, made of the clips of examples/data.

The figures of it say nothing of the library; they show that the programs which measure still do.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import edmlift
from data import cameras
from data.make_samples import CAMERA_DISTANCE, CAMERA_HEIGHT, FPS
from data.mocap import AMC_FPS, Motion, save_motion
from data.paths import EXAMPLES
from edmlift.joints import MIRROR, mid_hip

FRAMES = 16  # of a person, in a row: of fewer there is no video


@dataclass(frozen=True)
class Person:
    """Who moves as a clip says, but in another size, or with left and right swapped."""

    number: int
    clip: str
    size: float = 1.0
    mirrored: bool = False


# By the names of the motion data (docs/motion-data.md).
SETS = {
    "cmu14_train": (Person(1, "cartwheel", 1.1), Person(3, "kick", mirrored=True)),
    "labs14_train": (Person(5001, "walk", 0.95), Person(5002, "cartwheel", mirrored=True)),
    "cmu14_test": (Person(2, "walk"), Person(9, "kick", 1.05)),
    "labs14_test": (Person(5006, "cartwheel"), Person(5007, "walk", 1.1, mirrored=True)),
}


def in_the_world(clip: str) -> np.ndarray:
    """Joints [F,14,3] of a clip: metres, y up, the floor at 0."""
    points = edmlift.read_keypoints(EXAMPLES / f"{clip}.csv")[..., :2].astype(float)
    joints = edmlift.read_truth(EXAMPLES / f"{clip}_truth.csv").astype(float)
    seen = joints + places(joints, points)[:, None]
    away = mid_hip(seen)[:, 2].mean()
    pitch = np.arccos(min(1.0, CAMERA_DISTANCE / away))  # the camera looks down so much
    x, y, z = np.moveaxis(seen, -1, 0)
    up = CAMERA_HEIGHT - np.cos(pitch) * y - np.sin(pitch) * z
    return np.stack([x, up, np.sin(pitch) * y - np.cos(pitch) * z], -1)


def places(joints: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Where mid-hip [F,3] is in the camera's axes, of poses [F,14,3] about it that are seen at
    points [F,14,2]: x - u z = 0 and y - v z = 0 for all joints, by least squares."""
    sight = (points - cameras.CENTRE) / cameras.FOCAL
    found = []
    for pose, (u, v) in zip(joints, np.moveaxis(sight, -1, 1), strict=True):
        one, none = np.ones_like(u), np.zeros_like(u)
        factors = np.concatenate([np.stack([one, none, -u], 1), np.stack([none, one, -v], 1)])
        x, y, z = pose.T
        found.append(np.linalg.lstsq(factors, np.concatenate([u * z - x, v * z - y]))[0])
    return np.array(found)


def joints_of(person: Person) -> np.ndarray:
    """Of a person [F,14,3], in the world."""
    joints = person.size * in_the_world(person.clip)[:FRAMES]
    return joints[:, MIRROR] * [-1, 1, 1] if person.mirrored else joints


def motion_of(name: str) -> Motion:
    """The motion of a set of people."""
    people = SETS[name]
    joints = [joints_of(person) for person in people]
    subject = np.repeat([person.number for person in people], list(map(len, joints)))
    frame = np.concatenate([np.arange(len(part)) for part in joints]) * round(AMC_FPS / FPS)
    together, ones = np.concatenate(joints).astype(np.float32), np.ones_like(subject)
    return Motion(together, subject, ones, frame, -ones, (), name)


def write(folder: Path) -> None:
    """Writes all sets, NAME.npz."""
    for name in SETS:
        save_motion(motion_of(name), folder / f"{name}.npz", FPS)
