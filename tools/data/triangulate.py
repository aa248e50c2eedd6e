"""Points in space from the images of several calibrated cameras: a reference for real detections.

Detectors mistake left for right; `triangulate` finds the one view of a frame that does.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

UNDISTORT_STEPS = 10  # of fixed point iteration: to 1e-9 for the few percent of real lenses


@dataclass(frozen=True)
class Camera:
    """A camera of known place; distances in metres, the image in pixels."""

    size: tuple[int, int]  # width, height
    focal: np.ndarray  # [2]
    centre: np.ndarray  # [2]
    distortion: np.ndarray  # [4] radial k1, k2, tangential p1, p2
    rotation: np.ndarray  # [3,3] world to camera axes (x right, y down, z away)
    position: np.ndarray  # [3] world

    def look(self, points: np.ndarray) -> np.ndarray:
        """World [...,3] -> camera axes [...,3]."""
        return (points - self.position) @ self.rotation.T

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """Pixels [...,2] -> x/z and y/z without the lens's distortion [...,2]."""
        k1, k2, p1, p2 = self.distortion
        seen = (pixels - self.centre) / self.focal
        ray = seen
        for _ in range(UNDISTORT_STEPS):
            x, y = ray[..., 0], ray[..., 1]
            r = x * x + y * y
            shift = [2 * p1 * x * y + p2 * (r + 2 * x * x), p1 * (r + 2 * y * y) + 2 * p2 * x * y]
            ray = (seen - np.stack(shift, -1)) / (1 + r * (k1 + r * k2))[..., None]
        return ray


def read_cameras(path: Path) -> list[Camera]:
    """The cameras of a JSON list of objects whose members are those of Camera."""
    numbers = json.loads(path.read_text())
    return [
        Camera(tuple(c.pop("size")), **{name: np.array(value) for name, value in c.items()})
        for c in numbers
    ]


def triangulate(
    views: list[Camera], pixels: np.ndarray, weights: np.ndarray, counterpart: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points from V views, and which view of each frame has left and right swapped, if one has.

    pixels [V,F,N,2]; weights [V,F,N], such as confidences; counterpart [N]: index of each
    point's counterpart -> points [F,N,3] world, metres; swapped [V,F]; errors [V,F,N]: distances
    from the pixels, those of swapped views from the counterparts'.
    """
    tries = [()] + [(view,) for view in range(len(views))]
    results = []
    for swap in tries:
        at, weight = pixels.copy(), weights.copy()
        for view in swap:
            at[view], weight[view] = at[view][:, counterpart], weight[view][:, counterpart]
        results.append(_intersect(views, at, weight))
    points, errors = (np.stack(part) for part in zip(*results, strict=True))
    best = errors.mean((1, 3)).argmin(0)  # [F] into tries
    frames = np.arange(pixels.shape[1])
    swapped = best == np.arange(1, len(tries))[:, None]
    return points[best, frames], swapped, np.moveaxis(errors[best, :, frames], 0, 1)


def _intersect(
    views: list[Camera], pixels: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The direct linear transform: points [F,N,3] nearest to their rays, and errors in pixels."""
    rays = np.stack([c.rays(at) for c, at in zip(views, pixels, strict=True)])
    matrix = np.stack([np.hstack([c.rotation, -c.rotation @ c.position[:, None]]) for c in views])
    matrix = matrix[:, None, None]  # [V,1,1,3,4]
    rows = rays[..., None] * matrix[..., 2:, :] - matrix[..., :2, :]
    rows = np.moveaxis(rows * weights[..., None, None], 0, 2)  # [F,N,V,2,4]
    right = np.linalg.svd(rows.reshape(*rows.shape[:2], -1, 4))[2][..., -1, :]
    points = right[..., :3] / right[..., 3:]
    seen = np.stack([c.look(points) for c in views])
    focal = np.stack([c.focal for c in views])[:, None, None]
    return points, np.linalg.norm(focal * (seen[..., :2] / seen[..., 2:] - rays), axis=-1)
