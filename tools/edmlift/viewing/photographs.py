"""The pictures of a page: reduced, as JPEG; the only part of it that needs Pillow."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from edmlift.drawing.canvas import load_picture, need_pillow

PICTURE_SIDE = 640  # pixels: the longer side, at most
_LIMIT = 64_000_000  # bytes of all pictures; browsers become slow with more
_QUALITY = 80  # of JPEG
_LEAST_SIDE = 64
_VIDEOS = (".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v")


def jpegs(
    pictures: Sequence[Any] | None, count: int, side: int, limit: int = _LIMIT
) -> list[dict[str, Any]]:
    """Pictures, each with its size before it was reduced: none, one, or one for each pose."""
    if pictures is None:
        return []
    if len(pictures) not in (1, count):
        raise ValueError(f"pictures must be 1, or {count}, one a pose, not {len(pictures)}")
    if side < _LEAST_SIDE:
        raise ValueError(f"picture_side must be {_LEAST_SIDE} or more, not {side}")
    need_pillow()
    found: list[dict[str, Any]] = []
    total = 0
    for n, picture in enumerate(pictures):
        data, size = _jpeg(picture, side)
        total += len(data)
        if total > limit:
            raise ValueError(_too_much(side, limit, total * len(pictures) / (n + 1)))
        text = base64.b64encode(data).decode()
        found.append({"width": size[0], "height": size[1], "data": text})
    return found


def _jpeg(source: Any, side: int) -> tuple[bytes, tuple[int, int]]:
    if isinstance(source, str | Path) and Path(source).suffix.lower() in _VIDEOS:
        raise ValueError(
            f"{source} is a video: give its frames as pictures, which "
            "`ffmpeg -i VIDEO frame%05d.jpg` writes"
        )
    picture = load_picture(source).convert("RGB")
    size = picture.size
    picture = picture.copy()
    picture.thumbnail((side, side))
    out = io.BytesIO()
    picture.save(out, "JPEG", quality=_QUALITY, optimize=True)
    return out.getvalue(), size


def _too_much(side: int, limit: int, estimate: float) -> str:
    """What to do about pictures that take too much."""
    fitting = int(0.95 * side * (limit / estimate) ** 0.5) // 16 * 16
    advice = f"{fitting} would do" if fitting >= _LEAST_SIDE else "give fewer frames"
    megabytes = f"{estimate / 1e6:.0f} MB, over the {limit / 1e6:.0f} MB of a page"
    return f"pictures of {side} pixels would take about {megabytes}: {advice}"
