"""How fast the Python package lifts: thousands of poses a second, as Markdown.

    run.py channels.python.wheel_figures            prints both tables
    run.py channels.python.wheel_figures --update   writes those of docs/python.md

The library is that of this machine's wheel.  On one core it is the processor's time that counts, on
all of them the clock's; the best of some rounds, because other programs run as well.
"""

import math
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from ctypes import c_int
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

import edmlift
from channels.python.platforms import PLATFORMS, Platform, compile_library
from channels.python.wheel_checks import host
from channels.python.wheels import SOURCE, write_source
from data.paths import DOCS, EXAMPLES
from edmlift._binding import POSE, load, pointer
from edmlift.networks import find_model
from reports import markdown
from reports.command import Table, run_report
from reports.targets import INCLUDES, SOURCES, ToolError, library_flags, run

PAGE = DOCS / "python.md"
PEOPLE, ROUNDS, NOISE = 100_000, 9, 3.0  # pixels
SOME = 12_500  # so few that all cores are free now and then
MODELS = ("distances_f32", "distances_w16", "direct_f32", "direct_w16")
AVX2 = "-mcpu=x86_64_v3"
CALLS = ["C library", "`lift()`", '`lift(format="coco17")`', "`lift()`, all cores"]


def people() -> np.ndarray:
    """Joints [F,14,3] of people who differ, as a processor learns the branches of those who do
    not."""
    clips = [np.loadtxt(EXAMPLES / f"{name}.csv", delimiter=",") for name in ("walk", "kick")]
    poses = np.concatenate(clips).reshape(-1, 14, 3)
    draw = np.random.default_rng(0)
    joints = poses[draw.integers(0, len(poses), PEOPLE)]
    joints[..., :2] += draw.normal(0, NOISE, (PEOPLE, 14, 2))
    return joints.astype(np.float32)


def as_coco(joints: np.ndarray) -> np.ndarray:
    """Keypoints [F,17,3] of the format coco17 that have the joints' limbs; the nose is the head."""
    nose_and_eyes = np.repeat(joints[:, :1], 5, 1)
    order = [5, 2, 6, 3, 7, 4, 11, 8, 12, 9, 13, 10]  # left and right, from the shoulders down
    return np.concatenate([nose_and_eyes, joints[:, order]], 1)


def rates(
    calls: Sequence[Callable[[], object]], clock: Callable[[], float], count: int = PEOPLE
) -> list[int]:
    """Thousands of people a second by each call of `count`, in turns; ROUNDS of all PEOPLE."""
    least = [math.inf] * len(calls)
    for _ in range(ROUNDS * PEOPLE // count):
        for n, call in enumerate(calls):
            start = clock()
            call()
            least[n] = min(least[n], clock() - start)
    return [round(count / seconds / 1000) for seconds in least]


def c_call(name: str, library: Path, joints: np.ndarray) -> Callable[[], object]:
    """edml_lift() of one person after the other, in C."""
    model = find_model(name, c=load(library))
    poses, status = np.zeros(len(joints), POSE), np.zeros(len(joints), c_int)
    work = model.work()
    rest = (None, None, len(joints), model.address, work, model.work_bytes)
    arrays = (poses, status, joints)
    return lambda: model.c.edml_lift_many(*map(pointer, arrays), *rest)


def speeds(library: Path) -> str:
    """Each model by the C library alone, and by the package."""
    os.environ["EDMLIFT_LIBRARY"] = str(library)
    joints = people()
    keypoints = as_coco(joints)
    rows = {}
    for name in MODELS:
        calls = [
            c_call(name, library, joints),
            partial(edmlift.lift, joints, name, threads=1),
            partial(edmlift.lift, keypoints, name, format="coco17", threads=1),
        ]
        on_all_cores = [partial(edmlift.lift, joints[:SOME], name)]
        rows[f"`{name}`"] = [
            *rates(calls, time.process_time), *rates(on_all_cores, time.perf_counter, SOME)
        ]  # fmt: skip
    return markdown.table("thousand poses a second", CALLS, rows)


def builds(platform: Platform, library: Path, folder: Path) -> str:
    """The C library of the wheel, for a later processor, and compiled as pip does from source."""
    later = compile_library(replace(platform, processor=(AVX2,)), folder)
    compiled = folder / "compiled.so"
    flags = [*library_flags(), "-O2", "-fPIC", "-shared", *INCLUDES]
    run("cc", *flags, *SOURCES, "-lm", "-o", compiled)
    libraries = {"wheel": library, "for AVX2": later, "from source, `cc -O2`": compiled}
    joints = people()
    rows = {
        f"`{name}`": rates(
            [c_call(name, path, joints) for path in libraries.values()], time.process_time
        )
        for name in MODELS
    }
    return markdown.table("thousand poses a second", list(libraries), rows)


def tables() -> Iterator[Table]:
    """Both tables."""
    if host() not in PLATFORMS:
        raise ToolError(f"there is no wheel for {host()}")
    platform = PLATFORMS[host()]
    write_source(SOURCE)
    library = compile_library(platform, SOURCE)
    with tempfile.TemporaryDirectory() as name:
        for file in ("edmlift.c", "edmlift.h"):
            (Path(name) / file).symlink_to(SOURCE / file)
        yield Table(PAGE, "python_builds", builds(platform, library, Path(name)))
    yield Table(PAGE, "python_speed", speeds(library))


def main() -> int:
    return run_report("wheel_figures", __doc__, tables, comparable=False)


if __name__ == "__main__":
    sys.exit(main())
