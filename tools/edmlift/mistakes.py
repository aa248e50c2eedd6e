"""What looks like a mistake in a run of poses, which are plausible all the same."""

import numpy as np
from numpy.typing import NDArray

from edmlift.formats import BY_IMAGE, BY_SQUARE, find_format, formats_with
from edmlift.joints import INDEX, mid_hip, mid_shoulder

FEWEST_POSES = 5  # of a run: fewer say nothing
LOW_QUALITY = 0.2  # the least that is ordinary, also of a detector's poses
ON_ITS_SIDE = 0.9  # share of the poses
SECOND = 1000  # ms
_TRUNK = [INDEX[f"{side}_{part}"] for side in ("right", "left") for part in ("shoulder", "hip")]


def likely_mistakes(
    joints: NDArray[np.float32],
    quality: NDArray[np.float32],
    given: NDArray[np.float32],
    format: str | None,
) -> tuple[str, ...]:
    """Warnings of lifted poses: their joints in the image [F,14,3], their quality [N], and the
    keypoints of the format that were given [F,K,3], c 0 where not seen."""
    if len(joints) < FEWEST_POSES:
        return ()
    found = [
        _shares_for_pixels(given, format),
        _y_before_x(joints, format),
        _wrong_order(quality, given.shape[1], format),
    ]
    return tuple(text for text in found if text)


def _shares_for_pixels(given: NDArray[np.float32], format: str | None) -> str:
    normalised = 0 if format is None else find_format(format).normalised
    seen = given[given[..., 2] > 0][:, :2]
    if normalised in (BY_IMAGE, BY_SQUARE) or not ((seen >= 0) & (seen <= 1)).all():
        return ""
    return (
        "all keypoints are within 0 and 1, but this format has pixels: multiply x by the width of "
        "the image and y by its height; MoveNet's own output, y first, is the format movenet17"
    )


def _y_before_x(joints: NDArray[np.float32], format: str | None) -> str:
    whole = joints[(joints[:, _TRUNK, 2] > 0).all(1), :, :2]
    if len(whole) < FEWEST_POSES:
        return ""
    across, along = np.abs(mid_shoulder(whole) - mid_hip(whole)).T
    count = int((across > along).sum())
    if not count > ON_ITS_SIDE * len(whole):
        return ""
    own = format is not None and find_format(format).normalised == BY_SQUARE
    what = "x, y, score" if own else "y, x, score (MoveNet's format is movenet17)"
    return (
        f"the trunk is nearer to the horizontal than to the vertical in {count} of {len(whole)} "
        f"poses: are the keypoints {what}? If people lie there, or the camera is on its side, all "
        "is well"
    )


def _wrong_order(quality: NDArray[np.float32], count: int, format: str | None) -> str:
    low = int((quality < LOW_QUALITY).sum())
    if not 2 * low > len(quality):
        return ""
    others = [name for name in formats_with(count) if name != format]
    return (
        f"{low} of {len(quality)} poses have a quality under {LOW_QUALITY}: are the keypoints in "
        f"the order of {format or 'the 14 joints'}? Others with {count} keypoints: "
        f"{', '.join(others) or 'none'}"
    )


def wrong_unit_of_time(times: NDArray[np.generic]) -> tuple[str, ...]:
    """A warning if no two of a video's times [F], in ms, are within a second."""
    if len(times) < FEWEST_POSES or (np.abs(np.diff(times.astype(float))) <= SECOND).any():
        return ()
    return (
        "no two frames are within a second, so that each starts the track anew: are the times in "
        "another unit? `t` is in seconds, time_ms in milliseconds",
    )
