"""Pictures of poses: PNG sheets and animated GIFs, by Pillow alone."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from edmlift.drawing.diagram import draw_joint_diagram
from edmlift.drawing.figure import save_rotating, save_sheet, spread
from edmlift.drawing.scene import scene_of
from edmlift.lifting import Poses, batched, picked

__all__ = ["COLUMNS", "MAX_COLUMNS", "SUFFIXES", "draw", "draw_joint_diagram", "spread"]

SUFFIXES = (".png", ".gif")
COLUMNS, MAX_COLUMNS = 6, 24
FARTHEST = 100.0  # metres: what is farther is no person, and the floor would have no end
_PATH_ASPECT = 1.5  # at most, of an animation's 2D panel, which shows the whole path


def draw(
    poses: Poses,
    path: str | Path,
    *,
    truth: ArrayLike | None = None,
    title: str | None = None,
    frames: Sequence[int] | None = None,
    names: Sequence[str] | None = None,
    pictures: Sequence[Any] | None = None,
    pitch: float = 0.0,
    fps: float = 20.0,
) -> None:
    """Draws poses beside their 2D input; needs the extra: pip install 'edmlift[draw]'.

    poses     as from `lift`; one that was refused is its status in words
    path      .png: a sheet, a column a frame, each from the camera, the side and above.  .gif: the
              sequence beside the figure, which rotates
    truth     [F,14,3] metres, drawn dashed over the poses
    frames    indices of the frames of a sheet; default: six, evenly spread
    names     of the columns; default: "frame" and its number
    pictures  what the keypoints were seen in: one for all frames, or F; paths, or arrays [h,w,3]
    pitch     degrees by which the camera looked down: the floor is level then
    fps       frames a second of a .gif, 1 to 50

    Raises ValueError where a pose that was lifted, or its truth, has joints that are not finite or
    farther than 100 m from its origin.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"{path}: must end in {' or '.join(SUFFIXES)}")
    given, _ = batched(poses)
    count = len(given.joints)
    true = None if truth is None else np.asarray(truth, float).reshape(-1, 14, 3)
    if count == 0 or (true is not None and len(true) != count):
        true_count = "no" if true is None else len(true)
        raise ValueError(f"draw() needs poses, and as many in truth: {count} and {true_count}")
    _check_reach(given.joints[given.ok], "poses")
    if true is not None:
        _check_reach(true[given.ok], "truth")
    if not (abs(pitch) <= 90 and 1 <= fps <= 50):
        raise ValueError(f"pitch must be -90 to 90 degrees, fps 1 to 50, not {pitch} and {fps}")
    photos = _photos(pictures, count)
    if suffix == ".gif":
        if frames is not None:
            raise ValueError("frames= is for sheets; a .gif shows the whole sequence")
        scene = scene_of(given, true, pitch, True, _PATH_ASPECT)
        save_rotating(scene, path, title, photos, 10 * round(100 / fps))
        return
    chosen = spread(count, COLUMNS) if frames is None else list(frames)
    if not chosen or not all(0 <= frame < count for frame in chosen):
        raise ValueError(f"frames must be from 0 to {count - 1}, not {chosen}")
    names = [f"frame {frame}" for frame in chosen] if names is None else names
    shown = None if true is None else true[chosen]
    scene = scene_of(picked(given, chosen), shown, pitch, False, 1.0)
    save_sheet(scene, path, title, names, [photos[frame] for frame in chosen])


def _check_reach(joints: ArrayLike, name: str) -> None:
    """Raises ValueError where joints [F,14,3] of lifted poses are not in reach of a picture."""
    reach = np.abs(np.asarray(joints, float)).max(initial=0)
    if not reach <= FARTHEST:
        raise ValueError(
            f"{name}: joints at {reach:g} m; a picture shows {FARTHEST:g} m around the person"
        )


def _photos(pictures: Sequence[Any] | None, count: int) -> list[Any]:
    if pictures is None:
        return [None] * count
    if len(pictures) not in (1, count):
        raise ValueError(f"pictures must be 1, or {count}, one a pose, not {len(pictures)}")
    return list(pictures) * (count if len(pictures) == 1 else 1)
