"""What a lifter must beat: rows of the table.

Two are made of the training people without training, here; each has `lift` as the library has, and
answers with poses of people, not rotated to the camera.  The figures of those that are trained come
from the JSON of tools/experiments/rivals.py.
"""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from data import cameras
from data.mocap import Motion
from data.paths import DOCS
from edmlift.joints import mid_hip
from edmlift.library import Poses
from edmlift.metrics import procrustes

TRAINED = DOCS / "accuracy" / "rivals.json"
TITLES = {
    "mlp40k": "Cartesian network, 40 K",
    "equivariant40k": "the same, left and right alike",
    "martinez": "residual network, 4.3 M",
}
SEED = 20170715  # of the cameras that see the training people
ROUNDS = 10  # of alignment to the mean
BLOCK = 512  # poses that are compared with all others at once


def read_trained(
    path: Path, test: Motion, train: Sequence[Motion], columns: list[str]
) -> dict[str, dict]:
    """Figures of the trained rivals, {title: {column: {figure: value}}}, from their JSON.

    ValueError if they were trained or measured on other people, or not on all of the columns.
    """
    people = [motion.sha256 for motion in train]
    again = "tools/experiments/rivals.py measures again"
    if not path.exists():
        raise ValueError(f"{path}: not there; {again}")
    rows = {}
    entries = json.loads(path.read_text()).get("rivals", {})
    if not entries:
        raise ValueError(f"{path}: has no rivals; {again}")
    for name, entry in entries.items():
        if [file["sha256"] for file in entry["data"]["files"]] != people:
            sources = " and ".join(motion.source for motion in train)
            other = f"{name} was trained on other poses than those of {sources}"
            raise ValueError(f"{path}: {other}; {again}")
        tests = {found["sha256"]: found["figures"] for found in entry["tests"]}
        if test.sha256 not in tests:
            other = f"{name} was measured on other poses than those of {test.source}"
            raise ValueError(f"{path}: {other}; {again}")
        figures = tests[test.sha256]
        missing = [column for column in columns if column not in figures]
        if missing:
            raise ValueError(f"{path}: {name} has no column {', '.join(missing)}; {again}")
        rows[TITLES[name]] = figures
    return rows


class MeanPose:
    """The same pose for everyone: the mean of the training poses, each rotated to it."""

    def __init__(self, train: Sequence[Motion]) -> None:
        joints = np.concatenate([motion.joints for motion in train])
        poses = joints - joints.mean(1, keepdims=True)
        mean = poses[0]
        for _ in range(ROUNDS):
            mean = procrustes(poses, np.broadcast_to(mean, poses.shape)).mean(0)
        self._pose = mean - mid_hip(mean)

    def lift(self, keypoints: np.ndarray) -> Poses:
        """The mean pose for all keypoints [F,14,3]."""
        return Poses.of(np.repeat(self._pose[None], len(keypoints), 0))


class NearestNeighbour:
    """The training pose of which one view has the nearest 2D distances, of the joints seen."""

    def __init__(self, train: Sequence[Motion]) -> None:
        joints = np.concatenate([motion.joints for motion in train])
        self._truth = cameras.look(joints, np.random.default_rng(SEED))
        self._points = cameras.project(self._truth)

    def lift(self, keypoints: np.ndarray) -> Poses:
        """Poses with the same joints hidden are compared with views that hide them as well."""
        nearest = np.zeros(len(keypoints), int)
        masks, group = np.unique(keypoints[..., 2] > 0, axis=0, return_inverse=True)
        for number, seen in enumerate(masks):
            members = np.flatnonzero(group.ravel() == number)
            nearest[members] = _nearest(
                _distances(keypoints[members][:, seen, :2]), _distances(self._points[:, seen])
            )
        truth = self._truth[nearest]
        return Poses.of(truth - mid_hip(truth)[:, None])


def _distances(points: np.ndarray) -> np.ndarray:
    """Pairwise distances [F,P] of points [F,N,2], half the vertical extent is 1 (section 3.1)."""
    first, second = np.triu_indices(points.shape[1], 1)
    half = np.ptp(points[..., 1], axis=1, keepdims=True) / 2
    distance = np.linalg.norm(points[:, first] - points[:, second], axis=-1)
    return (distance / half).astype(np.float32)


def _nearest(these: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Index of the nearest row of others [G,P] to each of these [F,P]."""
    squares = (others**2).sum(1)
    blocks = [these[i : i + BLOCK] for i in range(0, len(these), BLOCK)]
    return np.concatenate([(squares - 2 * block @ others.T).argmin(1) for block in blocks])
