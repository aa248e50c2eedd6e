"""Motion files: poses of a video, for programs that show and analyse motion (docs/files.md)."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from edmlift.lifting import Poses
from edmlift.motion.bvh import write_bvh
from edmlift.motion.c3d import write_c3d
from edmlift.motion.clip import Clip, clip_of
from edmlift.motion.gltf import write_glb
from edmlift.motion.tables import write_arrow, write_csv, write_parquet
from edmlift.motion.trc import write_trc
from edmlift.placing import Placements

__all__ = ["MOTION_SUFFIXES", "MotionFormat", "check_motion", "write_motion"]


@dataclass(frozen=True)
class MotionFormat:
    """What a kind of file is made of."""

    write: Callable[[Path, Clip], None]
    has_rate: bool = True  # the file cannot do without frames a second
    has_bones: bool = False  # of constant length, that rotate


_FORMATS = {
    ".trc": MotionFormat(write_trc),
    ".c3d": MotionFormat(write_c3d),
    ".bvh": MotionFormat(write_bvh, has_bones=True),
    ".glb": MotionFormat(write_glb, has_bones=True),
    ".csv": MotionFormat(write_csv, has_rate=False),
    ".parquet": MotionFormat(write_parquet, has_rate=False),
    ".arrow": MotionFormat(write_arrow, has_rate=False),
    ".feather": MotionFormat(write_arrow, has_rate=False),
}
MOTION_SUFFIXES = tuple(_FORMATS)


def write_motion(
    path: str | Path,
    poses: Poses,
    *,
    fps: float | None = None,
    up: ArrayLike | None = None,
    root: Placements | ArrayLike | None = None,
) -> None:
    """Writes poses of a video to a file of the kind that its name ends in: .trc (OpenSim), .c3d,
    .bvh, .glb (glTF), .csv with a column a joint and axis, .parquet, .arrow or .feather.

    poses  as from `track` or `lift`, a frame each; one pose is one frame
    fps    frames a second; .csv and the tables do without, and have no times then
    up     where upwards is in the camera's axes, of any length, [3] or one a pose [F,3]; (0, -1, 0)
           is a level camera.  With it the person stands on the floor, which is at y = 0
    root   where the person is: placements as from `place`, or mid-hip in the camera's axes [F,3],
           in metres.  With it the person moves through the room

    Axes are y up, x right and z towards the camera, as for OpenSim, Blender's importers and glTF;
    metres, but millimetres in .c3d.  Without `up` the camera is taken to be level.  The origin is
    mid-hip; with `up` the floor below it; with `root` the camera; with both the floor below the
    camera, which then must stand still.

    With `root` the floor is one for all frames: the median of those that the lower foot of each
    frame stands on.  Without it the lower foot is on the floor in every frame, as by `stand`.

    .bvh and .glb have bones that keep their length, the median of the clip, and rotate; what they
    say of a bone's rotation about itself is invented (docs/files.md).  Where a pose was refused
    they hold the last one, with a warning.  Other files have none there: NaN in .trc, a residual of
    -1 in .c3d, nothing in tables.

    ValueError: the arguments are wrong, or there is no pose at all.  ImportError: the file needs a
    package that is not there: pip install "edmlift[files]".
    """
    path = Path(path)
    kind = check_motion(path, fps)
    try:
        clip = clip_of(poses, fps, up, root, rigid=kind.has_bones)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    kind.write(path, clip)


def check_motion(path: str | Path, fps: float | None) -> MotionFormat:
    """The kind of file that a name stands for; ValueError where there is none, or no rate."""
    suffix = Path(path).suffix.lower()
    kind = _FORMATS.get(suffix)
    if kind is None:
        raise ValueError(f"{path}: a motion file must end in {', '.join(MOTION_SUFFIXES)}")
    if kind.has_rate and fps is None:
        raise ValueError(f"{path}: a {suffix} file needs the frames a second (fps)")
    if fps is not None and not (np.isfinite(fps) and fps > 0):
        raise ValueError(f"fps must be over 0, not {fps}")
    return kind
