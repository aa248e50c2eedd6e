"""Whole pictures: a sheet of frames, a strip for one pose, and an animation that rotates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from edmlift.drawing.canvas import Canvas, save_animation, save_picture, text_width
from edmlift.drawing.palette import FAINT, SIDE_NAMES, SIDES, TEXT, TRUTH, WHITE
from edmlift.drawing.panels import image_panel, pose_panel
from edmlift.drawing.scene import ABOVE, CAMERA, GRID, SIDE, VIEWS, Scene, View

# Sizes in pixels.
MARGIN, GAP = 18, 12
TITLE, LABEL, LEGEND = 40, 24, 34  # heights of the lines of text
ROW_NAMES = 26
SHEET_WIDTH = 1500
STRIP_HIGH, ANIMATION_HIGH = 460, 360
ROTATION_FRAMES = 80  # of an animation, in about which the figure rotates once

Photos = Sequence[Any]  # a frame's each: what load_picture() takes, or None


def save_sheet(
    scene: Scene, path: Path, title: str | None, names: Sequence[str], photos: Photos
) -> None:
    """A column a frame: the 2D input above the pose from the camera, the side and above."""
    draw = _draw_strip if len(names) == 1 else _draw_columns
    save_picture(draw(scene, title, names, photos), path, any(p is not None for p in photos))


def save_rotating(
    scene: Scene, path: Path, title: str | None, photos: Photos, frame_ms: int
) -> None:
    """The sequence, again and again, while the figure makes whole rotations."""
    count = len(scene.poses)
    total = count * max(1, round(ROTATION_FRAMES / count))
    rotations = max(1, round(total / ROTATION_FRAMES))

    def frame(k: int) -> Canvas:
        return _draw_rotated(scene, k % count, 360.0 * rotations * k / total, title, photos)

    def frames() -> Iterator[Canvas]:
        return (frame(k) for k in range(total))

    photo = any(p is not None for p in photos)
    sample = [frame(int(total * part)) for part in (0.0, 0.3, 0.6)] if photo else []
    save_animation(frames(), path, frame_ms, sample)


def _draw_columns(scene: Scene, title: str | None, names: Sequence[str], photos: Photos) -> Canvas:
    width = min(300, (SHEET_WIDTH - 2 * MARGIN - ROW_NAMES) / len(names) - GAP)
    high = width / scene.aspect
    rows: list[tuple[str, View | None, float]] = [("2D input", None, high)] * scene.has_image
    scale = width / (scene.window[1] - scene.window[0])
    rows += [(v.name, v, scene.panel_size(v, scale)[1]) for v in VIEWS]
    wide = 2 * MARGIN + ROW_NAMES + len(names) * (width + GAP) - GAP
    top = _top(title) + LABEL
    figure = _figure(
        wide, top + sum(h + GAP for *_, h in rows) - GAP + LEGEND + MARGIN / 2, title, scene
    )
    for column, name in enumerate(names):
        x = MARGIN + ROW_NAMES + column * (width + GAP)
        figure.text((x + width / 2, top - LABEL / 2), name, 13, FAINT, "mm")
    y = float(top)
    for row, view, height in rows:
        figure.upright_text((MARGIN + 6, y + height / 2), row, 14, TEXT)
        for column in range(len(names)):
            x = MARGIN + ROW_NAMES + column * (width + GAP)
            panel = _panel(scene, column, view, width, height, photos[column])
            figure.paste(panel, x, y)
        y += height + GAP
    return figure


def _draw_strip(scene: Scene, title: str | None, _names: Sequence[str], photos: Photos) -> Canvas:
    """One pose: 2D input, and the pose from the camera, the side and above."""
    high = STRIP_HIGH
    panels: list[tuple[str, View | None, float]] = []
    if scene.has_image:
        panels.append(("2D input", None, _image_width(scene, high)))
    scale = high / (scene.window[3] - scene.window[2])
    panels += [(v.name, v, scene.panel_size(v, scale)[0]) for v in VIEWS]
    top = _top(title) + LABEL
    wide = 2 * MARGIN + sum(w + GAP for *_, w in panels) - GAP
    figure = _figure(wide, top + high + LEGEND + MARGIN / 2, title, scene)
    x = float(MARGIN)
    for name, view, width in panels:
        figure.text((x + width / 2, top - LABEL / 2), name, 14, TEXT, "mm")
        height = high if view is None else scene.panel_size(view, scale)[1]
        panel = _panel(scene, 0, view, width, height, photos[0])
        figure.paste(panel, x, top + (high - height) / 2)
        x += width + GAP
    return figure


def _draw_rotated(
    scene: Scene, i: int, azimuth: float, title: str | None, photos: Photos
) -> Canvas:
    """2D input, the pose from one direction, and small ones from the camera, the side and above."""
    high = ANIMATION_HIGH
    image = _image_width(scene, high) if scene.has_image else 0.0
    large, _ = scene.panel_size(CAMERA, high / (scene.window[3] - scene.window[2]))
    scale = (high - LABEL - GAP) / sum(scene.panel_size(v, 1.0)[1] for v in (CAMERA, ABOVE))
    narrow, upper = scene.panel_size(CAMERA, scale)
    above, lower = scene.panel_size(ABOVE, scale)
    side = max(2 * narrow + GAP, above)
    top = float(_top(title) + LABEL)
    wide = 2 * MARGIN + (image + GAP if image else 0) + large + 2 * GAP + side
    figure = _figure(wide, top + high + LEGEND + MARGIN / 2, title, scene)

    def put(panel: Canvas, name: str, x: float, y: float) -> None:
        figure.text((x + panel.width / 2, y - LABEL / 2), name, 14, TEXT, "mm")
        figure.paste(panel, x, y)

    x = float(MARGIN)
    if image:
        put(image_panel(scene, i, image, high, photos[i]), "2D input", x, top)
        x += image + GAP
    put(pose_panel(scene, i, View("", azimuth), large, high), "lifted to 3D", x, top)
    x += large + 2 * GAP
    put(pose_panel(scene, i, CAMERA, narrow, upper), CAMERA.name, x, top)
    put(pose_panel(scene, i, SIDE, narrow, upper), SIDE.name, x + narrow + GAP, top)
    y = top + upper + GAP + LABEL
    put(pose_panel(scene, i, ABOVE, above, lower), ABOVE.name, x + (side - above) / 2, y)
    return figure


def _panel(
    scene: Scene, i: int, view: View | None, width: float, height: float,
    photo: Any,
) -> Canvas:  # fmt: skip
    if view is None:
        return image_panel(scene, i, width, height, photo)
    return pose_panel(scene, i, view, width, height)


def _image_width(scene: Scene, high: float) -> float:
    return float(high * scene.image_size[0] / scene.image_size[1])


def _top(title: str | None) -> int:
    return MARGIN // 2 + (TITLE if title else 0)


def _figure(wide: float, high: float, title: str | None, scene: Scene) -> Canvas:
    """The title above and the legend below the panels."""
    figure = Canvas(wide, high, WHITE)
    if title:
        figure.text((MARGIN, MARGIN / 2 + TITLE / 2), title, 21, TEXT)
    x, y = float(MARGIN), figure.height - LEGEND / 2 - 2
    for side, colour in SIDES.items():
        figure.line([(x + 3, y), (x + 19, y)], colour, 5)
        x = _legend_text(figure, x + 28, y, SIDE_NAMES[side])
    if scene.truth is not None:
        figure.dashes((x, y), (x + 24, y), TRUTH, 2)
        x = _legend_text(figure, x + 30, y, "truth")
    if scene.has_image and not scene.seen.all():
        figure.disc((x + 6, y), 5.5, WHITE, FAINT, 1.8)
        x = _legend_text(figure, x + 18, y, "not seen in 2D")
    note = f"wedge: the camera; squares: {100 * GRID:.0f} cm"
    if x + text_width(note, 13) < figure.width - MARGIN:
        figure.text((figure.width - MARGIN, y), note, 13, FAINT, "rm")
    return figure


def _legend_text(figure: Canvas, x: float, y: float, text: str) -> float:
    """Writes a legend's text; where the next entry may begin."""
    figure.text((x, y), text, 13, TEXT)
    return x + text_width(text, 13) + 18


def spread(count: int, columns: int) -> list[int]:
    """Indices of at most `columns` of `count` frames, evenly spread, half a step from both ends."""
    columns = min(columns, count)
    return [int(v) for v in (np.arange(columns) + 0.5) * count / max(columns, 1)]
