"""What a lifter must beat, made of the training people without training: rows of the table.

Each has `lift` as edmlift.Library has, for tools/evaluate.py; both answer with poses of people, not
turned to the camera.
"""

import numpy as np

import cameras
from edmlift import Poses
from mocap import Motion
from skeleton import mid_hip

SEED = 20170715  # of the cameras that see the training people
ROUNDS = 10  # of alignment to the mean
BLOCK = 512  # poses that are compared with all others at once


class MeanPose:
    """The same pose for everyone: the mean of the training poses, each turned to it."""

    def __init__(self, train: Motion):
        poses = train.joints - train.joints.mean(1, keepdims=True)
        mean = poses[0]
        for _ in range(ROUNDS):
            u, _, vt = np.linalg.svd(np.einsum("fni,nj->fij", poses, mean))
            u[:, :, 2] *= np.sign(np.linalg.det(u @ vt))[:, None]
            mean = np.einsum("fni,fij->nj", poses, u @ vt) / len(poses)
        self._pose = mean - mid_hip(mean)

    def lift(self, keypoints: np.ndarray) -> Poses:
        return _all_fine(np.repeat(self._pose[None], len(keypoints), 0))


class NearestNeighbour:
    """The training pose of which one view has the nearest 2D distances, of the joints seen."""

    def __init__(self, train: Motion):
        self._truth = cameras.look(train.joints, np.random.default_rng(SEED))
        self._points = cameras.project(self._truth)

    def lift(self, keypoints: np.ndarray) -> Poses:
        """Poses with the same joints hidden are compared with views that hide these, too."""
        nearest = np.zeros(len(keypoints), int)
        masks, group = np.unique(keypoints[..., 2] > 0, axis=0, return_inverse=True)
        for number, seen in enumerate(masks):
            members = np.flatnonzero(group.ravel() == number)
            nearest[members] = _nearest(
                _distances(keypoints[members][:, seen, :2]), _distances(self._points[:, seen])
            )
        truth = self._truth[nearest]
        return _all_fine(truth - mid_hip(truth)[:, None])


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


def _all_fine(joints: np.ndarray) -> Poses:
    nothing = np.zeros(len(joints))
    return Poses(joints, nothing, nothing, np.full(len(joints), "ok"))
