"""C3D, the binary file of marker positions of motion capture, by ezc3d."""

from pathlib import Path

import numpy as np

from edmlift.joints import JOINTS
from edmlift.motion.clip import Clip
from edmlift.packages import need

_MOST_FRAMES = 65535  # the format counts them in 16 bits
_MILLIMETRES = 1000.0  # programs take them for granted


def write_c3d(path: Path, clip: Clip) -> None:
    """Millimetres; the residual is -1 where there is no pose, otherwise 0."""
    count = len(clip.joints)
    if count > _MOST_FRAMES:
        raise ValueError(
            f"{path}: a .c3d file holds at most {_MOST_FRAMES} frames, not {count}: write the clip "
            "in parts, or to another kind of file"
        )
    file = need("ezc3d", "a .c3d file").c3d()
    point = file["parameters"]["POINT"]
    point["RATE"]["value"] = [clip.rate]
    point["UNITS"]["value"] = ["mm"]
    point["LABELS"]["value"] = list(JOINTS)
    for name, axis in (("X_SCREEN", "+X"), ("Y_SCREEN", "+Y")):  # to the right, and up
        file.add_parameter("POINT", name, [axis])
    points = np.ones((4, len(JOINTS), count))
    points[:3] = _MILLIMETRES * clip.joints.transpose(2, 1, 0)
    file["data"]["points"] = points
    file["data"]["meta_points"]["residuals"] = np.where(clip.ok, 0.0, -1.0) * points[3:]
    file.write(str(path))
