"""The 14 joints: a figure with their numbers and names."""

from pathlib import Path

import numpy as np

from edmlift.drawing.canvas import Canvas, save_picture
from edmlift.drawing.palette import FAINT, SIDES, SKIN, TEXT, WHITE, mix
from edmlift.drawing.scene import DRAWN, JOINT_SIDE, MIDDLE, TORSO, Array, with_middle
from edmlift.joints import INDEX, JOINTS

WIDTH, HEIGHT = 760, 620
_LEFT_NAMES, _RIGHT_NAMES = 190.0, 570.0  # where the names of a side end, and begin

# A person who faces the reader, so that the right side is on the left: x from the middle, y down.
_HALF = {
    "shoulder": (64, 162),
    "elbow": (106, 256),
    "wrist": (130, 350),
    "hip": (34, 322),
    "knee": (44, 448),
    "ankle": (48, 562),
}
_MIDDLE = {"head": (0, 84), "neck_base": (0, 190)}
_NOTES = {"head": "as high as the ears", "neck_base": "below the shoulders' line"}


def joint_positions() -> Array:
    """Pixels [14,2] of the joints in the diagram."""
    at = np.zeros((len(JOINTS), 2))
    for name, j in INDEX.items():
        side, _, part = name.partition("_")
        x, y = _MIDDLE[name] if name in _MIDDLE else _HALF[part]
        at[j] = WIDTH / 2 + (-x if side == "right" else x), y
    return at


def draw_joint_diagram(path: str | Path) -> None:
    """Writes a PNG with the numbers and names of the joints."""
    canvas = Canvas(WIDTH, HEIGHT, WHITE)
    at = joint_positions()
    points = with_middle(at)
    for j in range(len(JOINTS)):
        _name(canvas, j, at[j])
    torso = at[TORSO]
    canvas.polygon(torso, SKIN)
    canvas.line(np.vstack([torso, torso[:1]]), SKIN, 26)
    canvas.disc(at[INDEX["head"]], 42, SKIN)
    for a, b, side in DRAWN:
        canvas.line(points[[a, b]], mix(SIDES[side], WHITE, 0.25), 8)
    canvas.disc(points[MIDDLE], 5, SIDES["trunk"])
    canvas.text(points[MIDDLE] + [0, 20], "origin", 12, FAINT, "mm")
    for j in range(len(JOINTS)):
        canvas.disc(at[j], 15, SIDES[JOINT_SIDE[j]], WHITE, 2)
        canvas.text(at[j], str(j), 15, WHITE, "mm")
    for x, side, anchor in ((_LEFT_NAMES, "right", "rm"), (_RIGHT_NAMES, "left", "lm")):
        canvas.text((x, 34), f"subject's {side}", 18, SIDES[side], anchor)
    canvas.text((WIDTH / 2, HEIGHT - 18), "The subject faces the camera.", 13, FAINT, "mm")
    save_picture(canvas, Path(path))


def _name(canvas: Canvas, j: int, at: Array) -> None:
    """The joint's name beside the figure, and a line to it."""
    side, colour = JOINT_SIDE[j], SIDES[JOINT_SIDE[j]]
    left = side == "right"
    x = _LEFT_NAMES if left else _RIGHT_NAMES
    canvas.line(np.array([at, [x + (8 if left else -8), at[1]]]), mix(colour, WHITE, 0.6), 1.4)
    canvas.text((x, at[1]), JOINTS[j], 17, TEXT, "rm" if left else "lm")
    if JOINTS[j] in _NOTES:
        canvas.text((x, at[1] + 17), _NOTES[JOINTS[j]], 12, FAINT)
