"""Frames without a pose, in files that must have one in each."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from edmlift.motion.clip import Clip


def held(path: Path, clip: Clip) -> Clip:
    """A clip in which frames without a pose hold the last one, at the start the first; warns."""
    ok = clip.ok
    missing = int((~ok).sum())
    if missing == 0:
        return clip
    warnings.warn(
        f"{path}: {missing} of {len(ok)} frames have no pose, and hold the one before",
        stacklevel=4,  # who called write_motion()
    )
    last = np.maximum.accumulate(np.where(ok, np.arange(len(ok)), int(ok.argmax())))
    return replace(clip, joints=clip.joints[last])
