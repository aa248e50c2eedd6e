"""A page to look at poses in a browser: one HTML file that needs nothing else."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from edmlift.joint_angles import LEVEL
from edmlift.keypoints import image_size
from edmlift.lifting import Poses, batched
from edmlift.viewing.pages import page_of
from edmlift.viewing.photographs import PICTURE_SIDE, jpegs
from edmlift.viewing.recording import recording_of

__all__ = ["PICTURE_SIDE", "SUFFIXES", "view"]

SUFFIXES = (".html", ".htm")


def view(
    poses: Poses,
    path: str | Path,
    *,
    truth: ArrayLike | None = None,
    title: str | None = None,
    pictures: Sequence[Any] | None = None,
    fps: float = 30.0,
    image: tuple[float, float] | None = None,
    up: ArrayLike = LEVEL,
    quality: ArrayLike | None = None,
    picture_side: int = PICTURE_SIDE,
) -> None:
    """Writes a page that shows poses in a browser: the 2D joints, a figure that can be turned, a
    time line and the angles over time (docs/view.md).  The file needs no network and no other file.

    poses         as from `lift` or `track`; one that was refused shows its status
    path          .html
    truth         [F,14,3] metres, origin midway between the hips: a second figure, dashed
    title         heading of the page; default: the name of the file
    pictures      what the keypoints were seen in: one for all frames, or F; paths, or arrays
                  [h,w,3].  They need the extra: pip install 'edmlift[draw]'
    fps           frames a second, over 0 and at most 1000
    image         (width, height) in pixels; default: the pictures', or what the joints take
    up            where upwards is in the camera's axes, of any length, [3] or one a pose [F,3]: the
                  floor is level then; the default is a level camera
    quality       [F] as `edmlift.quality` returns it, drawn over time
    picture_side  pixels, 64 or more: pictures are reduced until their longer side is this

    The page has 230 bytes a pose, and 360 with truth: an hour at 30 frames a second is 25 or 39 MB,
    besides pictures.  ValueError: there is no pose, arguments are wrong, or the pictures take over
    64 MB.
    """
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{path}: must end in .html")
    given, _ = batched(poses)
    count = len(given.joints)
    if count == 0:
        raise ValueError("view() needs poses, and there is none")
    if not (np.isfinite(fps) and 0 < fps <= 1000):
        raise ValueError(f"fps must be over 0 and at most 1000, not {fps}")
    photographs = jpegs(pictures, count, picture_side)
    if image is None and photographs:
        image = (photographs[0]["width"], photographs[0]["height"])
    size = None if image is None else image_size(image)
    recording = recording_of(given, _truth(truth, count), _quality(quality, count), fps, up, size)
    text = page_of(path.stem if title is None else title, recording, photographs)
    path.write_text(text, encoding="utf-8", newline="\n")


def _truth(truth: ArrayLike | None, count: int) -> np.ndarray | None:
    if truth is None:
        return None
    points = np.asarray(truth, float)
    points = points[None] if points.ndim == 2 else points
    if points.shape != (count, 14, 3):
        raise ValueError(f"truth must be [{count},14,3], not {list(np.shape(truth))}")
    return points


def _quality(quality: ArrayLike | None, count: int) -> np.ndarray | None:
    if quality is None:
        return None
    chances = np.asarray(quality, float).reshape(-1)
    if len(chances) != count:
        raise ValueError(f"quality must be [{count}], not {list(np.shape(quality))}")
    return chances
