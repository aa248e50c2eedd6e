"""One panel: the 2D input, or a pose from one side."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edmlift.drawing.canvas import Canvas, load_picture
from edmlift.drawing.palette import (
    CAMERA,
    FADE,
    FAINT,
    PAPER,
    SHADOW,
    SIDES,
    SKIN,
    TRUTH,
    WHITE,
    mix,
)
from edmlift.drawing.scene import (
    DRAWN,
    GRID,
    JOINT_SIDE,
    MIDDLE,
    TORSO,
    Array,
    Scene,
    View,
    floor_half,
    look,
    with_middle,
)
from edmlift.joints import INDEX

_VEIL = 0.25  # of white over a photo
_RIM = 1.55  # of a bone's width: with its white rim
_HEAD = 0.105  # metres: radius of the head that is drawn
_Item = tuple[float, Callable[[], None]]  # depth, and what draws it


def image_panel(scene: Scene, i: int, width: float, height: float, photo: Any = None) -> Canvas:
    """The 2D input of pose i, on its photo; joints that were not seen are left out."""
    panel = Canvas(width, height, PAPER)
    (x, y), (w, h) = scene.image_centre[i], scene.image_size
    scale = panel.height / h
    w = panel.width / scale
    if photo is not None:
        panel.picture(load_picture(photo), (x - w / 2, y - h / 2, x + w / 2, y + h / 2), _VEIL)
    at = (scene.keypoints[i] - [x - w / 2, y - h / 2, 0]) * [scale, scale, 0]
    at[~scene.seen[i]] = np.nan
    neck = at[INDEX["head"]] - at[INDEX["neck_base"]]
    head = 0.4 * float(np.hypot(neck[0], neck[1])) if photo is None else None
    _skeleton(panel, at, scene.seen[i], head)
    return panel


def pose_panel(scene: Scene, i: int, view: View, width: float, height: float) -> Canvas:
    """The 3D pose i from one side, or its status if there is none."""
    panel = Canvas(width, height, WHITE)
    if scene.status[i] != "ok":
        middle = (panel.width / 2, panel.height / 2)
        panel.text(middle, scene.status[i], 13, FAINT, "mm")
        return panel
    to_pixels = _projection(panel, scene, view)
    _floor(panel, to_pixels, scene, view)
    points = scene.poses[i]
    shadow = to_pixels(with_middle(points) * [1, 0, 1])
    for a, b, _ in DRAWN:
        panel.line(shadow[[a, b]], SHADOW, 0.9 * _limb_width(panel))
    left, right, bottom, top = scene.view_window(view)
    _skeleton(panel, to_pixels(points), scene.seen[i], _HEAD * panel.height / (top - bottom))
    if scene.truth is not None:
        truth = to_pixels(with_middle(scene.truth[i]))
        for a, b, _ in DRAWN:
            panel.dashes(truth[a], truth[b], TRUTH, 0.3 * _limb_width(panel))
    return panel


def _limb_width(panel: Canvas) -> float:
    """Pixels; thinner in a small panel."""
    return float(np.clip(min(panel.height, 1.6 * panel.width) / 56, 2.4, 7.5))


def _projection(panel: Canvas, scene: Scene, view: View) -> Callable[[Array], Array]:
    """Metres [N,3] to pixels of the panel and depth [N,3]."""
    left, right, bottom, top = scene.view_window(view)
    scale = min(panel.width / (right - left), panel.height / (top - bottom))
    x0 = panel.width / 2 - scale * (left + right) / 2
    y0 = panel.height / 2 + scale * (bottom + top) / 2

    def to_pixels(points: Array) -> Array:
        at = look(points, view)
        return np.stack([x0 + scale * at[:, 0], y0 - scale * at[:, 1], at[:, 2]], -1)

    return to_pixels


def _floor(panel: Canvas, to_pixels: Callable[[Array], Array], scene: Scene, view: View) -> None:
    """A grid, and a wedge on it that points from the camera to the person."""
    half = floor_half(scene.window[1])
    corners = np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]])
    panel.polygon(to_pixels(corners), PAPER)
    for offset in np.arange(-half, half + GRID / 2, GRID):
        away = np.array([[offset, 0, -half], [offset, 0, half]])
        for line in (away, away[:, ::-1]):
            panel.line(to_pixels(line), WHITE, 1.2, round_ends=False)
    edge, tip, side = -half + 0.03, -half + 0.15, 0.06
    wedge = np.array([[-side, 0, edge], [side, 0, edge], [0, 0, tip]])
    panel.polygon(to_pixels(wedge), CAMERA)


def _skeleton(panel: Canvas, at: Array, seen: NDArray[np.bool_], head: float | None) -> None:
    """Bones and joints of points [14,3], pixels and depth, the farthest first, and a body with a
    head of so many pixels' radius; None: without."""
    at, width = with_middle(at), _limb_width(panel)
    known: NDArray[np.bool_] = np.all(np.isfinite(at), axis=1)
    items: list[_Item] = []
    if head is not None:
        items += _body(panel, at, head)
    depth = at[known, 2]
    far, spread = (depth.min(), np.ptp(depth)) if len(depth) else (0.0, 0.0)

    def faded(side: str, near: float) -> str:
        amount = FADE * (1 - (near - far) / spread) if spread > 1e-6 else 0.0
        return mix(SIDES[side], WHITE, amount * min(1.0, spread / 0.5))

    for a, b, side in DRAWN:
        if not (known[a] and known[b]):
            continue
        ends, near = at[[a, b], :2], float(at[[a, b], 2].mean())
        if head is None:  # before a photo, the rim has no gaps
            panel.line(ends, WHITE, _RIM * width)
        items.append((near, _bone(panel, ends, faded(side, near), width, rim=head is not None)))
    for j in np.flatnonzero(known[:MIDDLE]):
        near = float(at[j, 2])
        colour = faded(JOINT_SIDE[j], near)
        items.append((near + 0.03, _joint(panel, at[j, :2], colour, width, bool(seen[j]))))
    for _, draw in sorted(items, key=lambda item: item[0]):
        draw()


def _bone(panel: Canvas, ends: Array, colour: str, width: float, rim: bool) -> Callable[[], None]:
    """A line; with a white rim that is shorter, so that it does not cut into the neighbours."""
    inner = np.array([[0.78, 0.22], [0.22, 0.78]]) @ ends

    def draw() -> None:
        if rim:
            panel.line(inner, WHITE, _RIM * width)
        panel.line(ends, colour, width)

    return draw


def _joint(panel: Canvas, at: Array, colour: str, width: float, seen: bool) -> Callable[[], None]:
    def draw() -> None:
        if seen:
            panel.disc(at, 0.95 * width, colour, WHITE, 0.22 * width)
        else:
            panel.disc(at, 0.9 * width, WHITE, colour, 0.34 * width)

    return draw


def _body(panel: Canvas, at: Array, radius: float) -> list[_Item]:
    """Torso and head, as far as they are known: flat shapes behind their own bones."""
    items: list[_Item] = []
    torso, head, neck = at[TORSO], at[INDEX["head"]], at[INDEX["neck_base"]]
    if np.isfinite(torso).all():
        near = float(torso[:, 2].min()) - 0.02
        items.append((near, lambda: _soft_polygon(panel, torso[:, :2])))
    if np.isfinite(head).all() and np.isfinite(neck).all():
        near = min(float(head[2]), float(neck[2])) - 0.02
        items.append((near, lambda: panel.disc(head[:2], radius, SKIN)))
    return items


def _soft_polygon(panel: Canvas, corners: Array) -> None:
    panel.polygon(corners, SKIN)
    panel.line(np.vstack([corners, corners[:1]]), SKIN, 1.2 * _limb_width(panel))
