"""The detectors' packages: from npm, of these versions, with these bytes; only what a page needs is kept."""

import base64
import hashlib
import shutil
import subprocess
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path

LICENCES = "LICENCES.txt"


class DetectorError(RuntimeError):
    """A detector cannot be installed; the message says what to do."""


@dataclass(frozen=True)
class Package:
    """A package of npm."""

    name: str
    version: str
    integrity: str  # of its archive, as npm writes it
    megabytes: int  # to download
    licence: str
    folder: str  # in the package, where the files are
    files: tuple[str, ...]

    @property
    def full_name(self) -> str:
        return f"{self.name}@{self.version}"


BLAZEPOSE = Package(
    "@mediapipe/pose",
    "0.5.1675469404",
    "sha512-DFZsNWTsSphRIZppnUCuunzBiHP2FdJXR9ehc7mMi4KG+oPaOH0Em3d6kr7Py+TSyTXC1doH88KcF28k2sBxsQ==",
    41,
    "Apache-2.0, The MediaPipe Authors",
    "",
    (
        "pose.js", "pose_solution_packed_assets_loader.js", "pose_solution_simd_wasm_bin.js",
        "pose_web.binarypb", "pose_solution_packed_assets.data", "pose_solution_simd_wasm_bin.wasm",
        "pose_landmark_lite.tflite", "pose_landmark_full.tflite", "pose_landmark_heavy.tflite",
    ),
)  # fmt: skip
MOVENET = Package(
    "@vladmandic/human",
    "3.3.6",
    "sha512-Nr5mPfq1gQ+uKeXY5uM3Fj8UxvF5CEh2s6txM5wRThqaW0mF9huooOuZSrT8hhGho0hGaXLFdAwfD/2+teCv6A==",
    29,
    "MIT, Vladimir Mandic; in it MoveNet and TensorFlow.js, Apache-2.0, Google",
    "",
    ("dist/tfjs.esm.js", "models/movenet-lightning.json", "models/movenet-lightning.bin"),
)
TFJS_WASM = Package(
    "@tensorflow/tfjs-backend-wasm",
    "4.22.0",
    "sha512-/IYhReRIp4jg/wYW0OwbbJZG8ON87mbz0PgkiP3CdcACRSvUN0h8rvC0O3YcDtkTQtFWF/tcXq/KlVDyV49wmA==",
    3,
    "Apache-2.0, Google",
    "dist/",
    ("tfjs-backend-wasm-simd.wasm",),
)


@dataclass(frozen=True)
class Detector:
    """What a page can find joints with; detectors/detectors.js starts it by its name."""

    packages: tuple[Package, ...]
    leaves: tuple[str, ...] = ()  # files of its packages that it does not need

    @property
    def folder(self) -> str:
        """Of its files in a page; the versions are in the name, because browsers keep them."""
        first = self.packages[0]
        return f"{first.name.rpartition('/')[2]}-{first.version}"

    @property
    def files(self) -> list[str]:
        names = [Path(file).name for package in self.packages for file in package.files]
        return [name for name in names if name not in self.leaves]


NETWORKS = {kind: f"pose_landmark_{kind}.tflite" for kind in ("lite", "full", "heavy")}
DETECTORS = {
    f"blazepose-{kind}": Detector((BLAZEPOSE,), tuple(set(NETWORKS.values()) - {NETWORKS[kind]}))
    for kind in NETWORKS
} | {"movenet-lightning": Detector((MOVENET, TFJS_WASM))}


def need_npm() -> None:
    """DetectorError where npm is missing."""
    if shutil.which("npm") is None:
        raise DetectorError(
            "npm is missing, which downloads the detectors. Install it (Debian: npm; others: "
            "nodejs.org), or say --no-detector: the page then has joints to drag, and neither "
            "camera nor video."
        )


def missing(detectors: dict[str, Detector], folder: Path) -> list[Package]:
    """The packages whose files are not in the folder yet."""
    packages = dict.fromkeys(p for detector in detectors.values() for p in detector.packages)
    return [p for p in packages if not all((folder / p.full_name / f).exists() for f in p.files)]


def install(package: Package, folder: Path) -> None:
    """Downloads a package, checks its bytes, and puts its files into the folder."""
    with tempfile.TemporaryDirectory() as scratch:
        archive = _download(package, Path(scratch))
        digest = base64.b64encode(hashlib.sha512(archive.read_bytes()).digest()).decode()
        if f"sha512-{digest}" != package.integrity:
            raise DetectorError(f"{package.full_name} has other bytes than it had: nothing is kept")
        wanted = Path(scratch) / "wanted"
        with tarfile.open(archive) as packed:
            for name in package.files:
                data = packed.extractfile(f"package/{package.folder}{name}")
                assert data is not None  # its integrity says that it is there
                (wanted / name).parent.mkdir(parents=True, exist_ok=True)
                (wanted / name).write_bytes(data.read())
        place = folder / package.full_name
        shutil.rmtree(place, ignore_errors=True)
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(wanted, place)


def _download(package: Package, folder: Path) -> Path:
    command = ["npm", "pack", "--silent", "--ignore-scripts", package.full_name]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip().splitlines()
        raise DetectorError(
            f"npm cannot download {package.full_name} ({said[-1] if said else 'no reason given'}). "
            "Look at the network, or say --no-detector."
        )
    (archive,) = folder.glob("*.tgz")
    return archive


def licences(detectors: dict[str, Detector]) -> str:
    """Whose files these are, for who gives them on."""
    packages = dict.fromkeys(p for detector in detectors.values() for p in detector.packages)
    lines = [f"{p.name} {p.version} (npm): {p.licence}\n" for p in packages]
    return "The detectors in this folder are from these packages, unchanged:\n\n" + "".join(lines)
