"""Makes MoveNet's part of examples/data/detections: thunder and lightning on the videos.

    run.py data.detect_movenet [--wheels FOLDER] [--out FOLDER]

Not part of tools/check: it wants node 18 or later with npm, and downloads the networks (145 MB, of
which it keeps 17), TensorFlow.js and the videos (60 MB, unless FOLDER has their wheels).  All of it
goes to build/movenet and to a temporary folder.

MoveNet is shown a square.  It is used as Google's programs use it: it sees every frame of a video,
of each the part around what it found in the one before (data/crops.py), of the first the whole
frame.  Its keypoints are not smoothed.  One frame in so many is written.
"""

import json
import shutil
import subprocess
import tarfile
import tempfile
from pathlib import Path

import cv2
import numpy as np

from data import crops
from data.paths import ROOT
from data.videos import Clip, options, unpack, write_rows

SIDES = {"thunder": 256, "lightning": 192}  # of the networks' square input, pixels
KEYPOINTS = 17
FILES = Path(__file__).parent / "movenet"
INSTALLED = ROOT / "build" / "movenet"


def install(folder: Path) -> None:
    """Puts TensorFlow.js, movenet.mjs and the networks into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in FILES.iterdir():
        shutil.copy(file, folder)
    options = ["--no-audit", "--no-fund", "--no-package-lock"]
    subprocess.run(["npm", "install", *options], cwd=folder, check=True)
    names = [f"movenet-{variant}.{kind}" for variant in SIDES for kind in ("json", "bin")]
    if all((folder / name).exists() for name in names):
        return
    pack = ["npm", "pack", "--silent", models_package()]
    done = subprocess.run(pack, cwd=folder, check=True, capture_output=True, text=True)
    archive = folder / done.stdout.split()[-1]
    with tarfile.open(archive) as packed:
        for name in names:
            (folder / name).write_bytes(packed.extractfile(f"package/models/{name}").read())
    archive.unlink()


def models_package() -> str:
    """Name and version of the package that has the networks."""
    return json.loads((FILES / "package.json").read_text())["config"]["models"]


class Network:
    """A network of MoveNet, in a process of its own."""

    def __init__(self, variant: str, folder: Path = INSTALLED) -> None:
        self.side = SIDES[variant]
        model = folder / f"movenet-{variant}.json"
        command = ["node", folder / "movenet.mjs", model, str(self.side)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def detect(self, image: np.ndarray, square: crops.Square) -> np.ndarray:
        """Keypoints [17,3] in pixels of an image in OpenCV's colours: x, y and score."""
        how = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        part = cv2.warpAffine(image, square.to_pixels(self.side), (self.side, self.side), flags=how)
        self.process.stdin.write(cv2.cvtColor(part, cv2.COLOR_BGR2RGB).tobytes())
        self.process.stdin.flush()
        found = np.zeros((KEYPOINTS, 3), np.float32)
        if self.process.stdout.readinto(memoryview(found).cast("B")) != found.nbytes:
            raise RuntimeError("movenet.mjs has stopped")
        return square.to_image(found.astype(float))

    def close(self) -> None:
        self.process.stdin.close()
        self.process.wait()


def detect(network: Network, video: Path) -> tuple[np.ndarray, tuple[int, int], float]:
    """Keypoints [F,17,3] of all frames of a video, the image's size, and frames a second."""
    capture = cv2.VideoCapture(str(video))
    size = tuple(int(capture.get(n)) for n in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT))
    square = crops.whole(size)
    found = []
    while True:
        more, image = capture.read()
        if not more:
            return np.array(found), size, capture.get(cv2.CAP_PROP_FPS)
        found.append(network.detect(image, square))
        square = crops.around(found[-1], size)


def write_clip(path: Path, variant: str, clip: Clip, video: Path, network: Network) -> None:
    """Writes a file of keypoints."""
    found, (width, height), rate = detect(network, video)
    text = (
        f"# {path.stem}: detections, one frame a line, x,y,score of MoveNet's 17 keypoints;",
        f"# pixels of {width} x {height}, y down; {rate / clip.every:g} lines a second.",
        f"# Origin: MoveNet {variant} (singlepose, 4; Apache-2.0) of {models_package()} on",
        f"# {clip.origin}; see README.md",
    )
    write_rows(path, text, found[:: clip.every], ("%.1f", "%.1f", "%.3f"))


def main() -> None:
    args = options(__doc__)
    install(INSTALLED)
    with tempfile.TemporaryDirectory() as scratch:
        for name, clip, video in unpack(args.wheels or Path(scratch), Path(scratch)):
            for variant in SIDES:
                network = Network(variant)
                write_clip(args.out / f"{name}_{variant}.csv", variant, clip, video, network)
                network.close()


if __name__ == "__main__":
    main()
