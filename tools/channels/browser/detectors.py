"""The detectors of the page, and the packages that they are in."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from channels.browser.npm_packages import Package

LICENCES = "LICENCES.txt"

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

    def paths(self, packages: Path) -> list[Path]:
        """Its files in the folder of the packages."""
        every = (packages / p.full_name / name for p in self.packages for name in p.files)
        return [path for path in every if path.name not in self.leaves]

    def under(self, place: str) -> list[str]:
        """Its files in a page, where `place` is its folder."""
        return [place + path.name for path in self.paths(Path())]


NETWORKS = {kind: f"pose_landmark_{kind}.tflite" for kind in ("lite", "full", "heavy")}
DETECTORS = {
    f"blazepose-{kind}": Detector((BLAZEPOSE,), tuple(set(NETWORKS.values()) - {NETWORKS[kind]}))
    for kind in NETWORKS
} | {"movenet-lightning": Detector((MOVENET, TFJS_WASM))}


def packages_of(detectors: Iterable[Detector]) -> list[Package]:
    """Their packages, each once."""
    return list(dict.fromkeys(package for detector in detectors for package in detector.packages))


def licences(detectors: Iterable[Detector]) -> str:
    """Whose files these are, for who gives them on."""
    lines = [f"{p.name} {p.version} (npm): {p.licence}\n" for p in packages_of(detectors)]
    return "The detectors in this folder are from these packages, unchanged:\n\n" + "".join(lines)
