"""What the tests of ESP-IDF and Zephyr share."""

import re
from pathlib import Path

import numpy as np
from support import ROOT, need_library

import edmlift
from channels.firmware import rtos
from channels.firmware.stand_ins import Project
from reports import markdown

BITS = (ROOT / "tests" / "bits.txt").read_text("utf-8").splitlines(keepends=True)
DIRECT_BITS = "".join(line for line in BITS if "direct" in line)


def pose_of(program: Path) -> str:
    """What an example prints of its pose, millimetres, by this machine's library."""
    need_library()
    found = re.findall(r"\{(\d+), (\d+), ([01])\}", program.read_text("utf-8"))
    joints = edmlift.lift(np.array(found, np.float32), "direct_w16").joints
    numbers = np.trunc(1000 * joints + np.copysign(np.float32(0.5), joints)).astype(int)
    lines = zip(edmlift.JOINTS, numbers, strict=True)
    return "".join("{:<14} {:5d} {:5d} {:5d}\n".format(name, *xyz) for name, xyz in lines)


def check_page(name: str, projects: list[Project]) -> None:
    """A system's page has what these projects print and take."""
    for mark, text in rtos.texts(name, projects).items():
        assert markdown.read(rtos.PAGES[name], mark) == text, mark
