"""The square of a video's frame that MoveNet is shown: where the person was in the frame before.

The rule is that of Google's own programs for MoveNet (the tutorial of TensorFlow Hub, those for
TensorFlow Lite and TensorFlow.js): a square about the middle of the hips in which all that was seen
of the person has room; the whole frame, padded, where the trunk was not seen.
"""

from dataclasses import dataclass

import numpy as np

SEEN = 0.2  # least score of a keypoint that counts
TRUNK_ROOM, BODY_ROOM = 1.9, 1.2  # half a side, in distances of keypoints from the mid-hip
SHOULDERS, HIPS = [5, 6], [11, 12]


@dataclass(frozen=True)
class Square:
    """A part of an image that may reach beyond it, in pixels from the image's corner."""

    left: float
    top: float
    side: float

    def to_image(self, found: np.ndarray) -> np.ndarray:
        """MoveNet's y, x and score [...,17,3], shares of the square, to x and y in pixels and
        score."""
        y, x, score = np.moveaxis(found, -1, 0)
        return np.stack([self.left + self.side * x, self.top + self.side * y, score], -1)

    def to_pixels(self, side: int) -> np.ndarray:
        """The affine map [2,3] from pixels of the square, drawn with so many a side, to those of
        the image; both have integers in their middles."""
        scale = self.side / side
        shift = (scale - 1) / 2
        return np.array([[scale, 0, self.left + shift], [0, scale, self.top + shift]])


def whole(size: tuple[int, int]) -> Square:
    """An image of a width and a height, padded on both sides."""
    width, height = size
    side = max(size)
    return Square((width - side) / 2, (height - side) / 2, side)


def around(keypoints: np.ndarray, size: tuple[int, int]) -> Square:
    """The square for the next frame, of keypoints [17,3] in pixels of this one."""
    at, score = keypoints[:, :2], keypoints[:, 2]
    if score[HIPS].max() <= SEEN or score[SHOULDERS].max() <= SEEN:
        return whole(size)
    centre = at[HIPS].mean(0)
    reach = np.abs(at - centre).max(1)
    half = max(
        TRUNK_ROOM * reach[SHOULDERS + HIPS].max(),
        BODY_ROOM * reach[score >= SEEN].max(),
    )
    half = min(half, max(*centre, *(size - centre)))
    if 2 * half > max(size):
        return whole(size)
    left, top = centre - half
    return Square(float(left), float(top), float(2 * half))
