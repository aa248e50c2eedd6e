"""A picture that shapes are drawn on, smooth at the edges; the only module that needs Pillow."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift.drawing.palette import flat_palette, rgb

try:
    from PIL import Image, ImageDraw, ImageFont
except ImportError:  # drawing is optional
    Image = ImageDraw = ImageFont = None  # type: ignore[assignment]
if TYPE_CHECKING:
    from PIL.Image import Image as PillowImage

SMOOTH = 3  # drawn so many times as large, then reduced
_PHOTO_COLOURS = 192  # of an animation with a photo


def need_pillow() -> None:
    """ImportError, which says how to get it, where Pillow is missing."""
    if Image is None:
        raise ImportError("drawing needs Pillow 10.1 or later: pip install 'edmlift[draw]'")


@functools.cache
def _font(size: float) -> Any:
    return ImageFont.load_default(size)


class Canvas:
    """A picture of so many pixels; coordinates are pixels, x right, y down."""

    def __init__(self, width: float, height: float, colour: str):
        need_pillow()
        self.width, self.height = round(width), round(height)
        size = (self.width * SMOOTH, self.height * SMOOTH)
        self._image = Image.new("RGB", size, rgb(colour))
        self._draw = ImageDraw.Draw(self._image)

    def polygon(self, points: ArrayLike, colour: str) -> None:
        self._draw.polygon(_scaled(points), fill=rgb(colour))

    def line(self, points: ArrayLike, colour: str, width: float, round_ends: bool = True) -> None:
        """A line through points [N,2]."""
        at = _scaled(points)
        self._draw.line(at, fill=rgb(colour), width=max(1, round(width * SMOOTH)), joint="curve")
        if round_ends:
            for end in (at[0], at[-1]):
                self._circle(end, width * SMOOTH / 2, colour)

    def dashes(self, start: ArrayLike, end: ArrayLike, colour: str, width: float) -> None:
        """A dashed line between two points."""
        start, end = np.asarray(start, float)[:2], np.asarray(end, float)[:2]
        count = max(1, int(np.hypot(*(end - start)) / (4.5 * width)))
        for n in range(count):
            ends = [start + (end - start) * (n + part) / count for part in (0.0, 0.62)]
            self.line(ends, colour, width, round_ends=False)

    def disc(
        self, centre: ArrayLike, radius: float, colour: str, rim: str = "", rim_width: float = 0
    ) -> None:
        """A disc, and a rim of another colour within the radius."""
        at = _scaled(centre)[0]
        self._circle(at, radius * SMOOTH, rim or colour)
        if rim:
            self._circle(at, (radius - rim_width) * SMOOTH, colour)

    def text(self, at: ArrayLike, text: str, size: float, colour: str, anchor: str = "lm") -> None:
        """Text at a point; the anchor is as in Pillow: "lm", left and middle."""
        font = _font(size * SMOOTH)
        self._draw.text(_scaled(at)[0], text, rgb(colour), font, anchor=anchor)

    def upright_text(self, at: Sequence[float], text: str, size: float, colour: str) -> None:
        """Text that runs upwards, its middle at a point."""
        font = _font(size * SMOOTH)
        left, top, right, bottom = font.getbbox(text)
        mask = Image.new("L", (round(right - left) + 2, round(bottom - top) + 2))
        ImageDraw.Draw(mask).text((1 - left, 1 - top), text, 255, font)
        mask = mask.transpose(Image.Transpose.ROTATE_90)
        corner = [round(v * SMOOTH - s / 2) for v, s in zip(at, mask.size, strict=True)]
        self._image.paste(rgb(colour), (corner[0], corner[1]), mask)

    def picture(self, picture: PillowImage, box: Sequence[float], veil: float) -> None:
        """Fills the canvas with a box (left, top, right, bottom) of a picture; `veil` of white."""
        left, top, right, bottom = box
        sizes = (self.width / (right - left), self.height / (bottom - top))
        part = picture.convert("RGB").transform(
            self._image.size, Image.Transform.EXTENT, (left, top, right, bottom),
            Image.Resampling.BICUBIC, fillcolor=(241, 243, 245),
        ) if max(sizes) * SMOOTH > 1 else _reduced(picture, box, self._image.size)  # fmt: skip
        white = Image.new("RGB", self._image.size, (255, 255, 255))
        self._image.paste(Image.blend(part, white, veil))

    def paste(self, other: Canvas, left: float, top: float) -> None:
        """Puts another canvas on this one."""
        self._image.paste(other._image, (round(left * SMOOTH), round(top * SMOOTH)))

    def image(self) -> PillowImage:
        """The picture at its size."""
        return self._image.reduce(SMOOTH)

    def _circle(self, at: tuple[float, float], radius: float, colour: str) -> None:
        x, y = at
        self._draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=rgb(colour))


def _reduced(picture: PillowImage, box: Sequence[float], size: tuple[int, int]) -> PillowImage:
    """A box of a picture that is larger than wanted."""
    left, top, right, bottom = box
    cut = picture.convert("RGB").crop((round(left), round(top), round(right), round(bottom)))
    return cut.resize(size, Image.Resampling.BOX)


def _scaled(points: ArrayLike) -> list[tuple[float, float]]:
    at: NDArray[np.float64] = np.atleast_2d(np.asarray(points, float))[:, :2] * SMOOTH
    return [(float(x), float(y)) for x, y in at]


def text_width(text: str, size: float) -> float:
    """Pixels that a text is wide."""
    return float(_font(size * SMOOTH).getlength(text)) / SMOOTH


def load_picture(source: str | Path | NDArray[np.uint8]) -> PillowImage:
    """A picture of a file, OSError if it is none, or of an array [height,width,3] of RGB bytes."""
    need_pillow()
    if isinstance(source, np.ndarray):
        return Image.fromarray(source)
    return _open(Path(source))


@functools.lru_cache(maxsize=1)  # one picture for all frames is read once, many are not kept
def _open(path: Path) -> PillowImage:
    with Image.open(path) as picture:
        return picture.convert("RGB")


def save_picture(canvas: Canvas, path: Path, photo: bool = False) -> None:
    """Writes a PNG; with a palette unless there is a photo in it."""
    image = canvas.image()
    if not photo:
        image = image.quantize(palette=_palette(), dither=Image.Dither.NONE)
    image.save(path, "PNG", optimize=True)


def save_animation(
    frames: Iterable[Canvas], path: Path, frame_ms: int, sample: Sequence[Canvas] = ()
) -> None:
    """Writes a GIF that goes on for ever; `sample` has the colours where there are photos."""
    palette = _palette(sample)
    images = (c.image().quantize(palette=palette, dither=Image.Dither.NONE) for c in frames)
    first = next(images)
    first.save(path, "GIF", save_all=True, append_images=images, duration=frame_ms, loop=0)


def _palette(sample: Sequence[Canvas] = ()) -> PillowImage:
    """The colours of all pictures, or of those with photos."""
    if not sample:
        holder = Image.new("P", (1, 1))
        holder.putpalette(flat_palette())
        return holder
    board = Image.new("RGB", (sample[0].width, sample[0].height * len(sample)))
    for n, canvas in enumerate(sample):
        board.paste(canvas.image(), (0, n * canvas.height))
    return board.quantize(_PHOTO_COLOURS, dither=Image.Dither.NONE)
