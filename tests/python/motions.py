"""Made-up motion for tests: a standing person, and noise around it."""

from pathlib import Path

import numpy as np

from data.mocap import Motion, save_motion

STANDING = np.zeros((14, 3))
STANDING[:, 1] = [1.7, 1.45, 1.4, 1.1, 0.85, 1.4, 1.1, 0.85, 0.9, 0.5, 0.1, 0.9, 0.5, 0.1]
STANDING[:, 0] = [0, 0, -0.2, -0.25, -0.3, 0.2, 0.25, 0.3, -0.1, -0.1, -0.1, 0.1, 0.1, 0.1]
STANDING[:, 2] = [0, 0, 0, -0.05, 0.1, 0, -0.05, 0.1, 0, 0.05, -0.05, 0, 0.05, -0.05]


def people(count: int = 400) -> Motion:
    rng = np.random.default_rng(0)
    joints = STANDING + rng.normal(0, 0.05, (count, 14, 3))
    numbers = np.arange(count)
    return Motion(
        joints=joints.astype(np.float32),
        subject=numbers % 4 + 1,
        trial=numbers * 0,
        frame=numbers,
        action=numbers * 0 - 1,
        action_names=(),
        source="made up",
    )


def write_motion(path: Path, motion: Motion) -> Path:
    """The motion in a file; returns its path."""
    save_motion(motion, path, fps=15)
    return path
