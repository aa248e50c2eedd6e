"""A page's folder, which any server can serve: scripts, the lift, detectors, and the list of them."""

import gzip
import hashlib
import json
import shutil
from pathlib import Path

from channels.version import version
from page.packages import DETECTORS, LICENCES, Detector, licences

SOURCES = Path(__file__).parent
SHARED = SOURCES.parent / "edmlift" / "viewing" / "page"
SHARED_FILES = (
    "joints.js", "paint.js", "skeleton.js", "figure.js", "turning.js", "look.css",
)  # fmt: skip
DEFAULT_MODEL = "direct_w16"
WORKER = "sw.js"  # the service worker
LIST = "files.json"
FILES = "detectors/files"  # of the detectors, in the page


def build_site(
    folder: Path, lift: Path, packages: Path, detectors: dict[str, Detector] = DETECTORS
) -> Path:
    """Writes a page into a folder, which is made anew.

    lift       the npm package of edmlift, unpacked
    packages   folder of the detectors' packages, as `install` leaves it
    """
    shutil.rmtree(folder, ignore_errors=True)
    for source in sorted(SOURCES.rglob("*")):
        if source.is_file() and source.suffix != ".py" and "__pycache__" not in source.parts:
            _copy(source, folder / source.relative_to(SOURCES))
    for name in SHARED_FILES:
        _copy(SHARED / name, folder / "view" / name)
    for source in sorted(lift.iterdir()):
        if source.suffix in (".js", ".wasm") or source.name == "LICENSE":
            _copy(source, folder / "lift" / source.name)
    _copy_detectors(folder, packages, detectors)
    _write_list(folder, detectors)
    return folder


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def _copy_detectors(folder: Path, packages: Path, detectors: dict[str, Detector]) -> None:
    for detector in detectors.values():
        for package in detector.packages:
            for name in package.files:
                if Path(name).name in detector.files:
                    source = packages / package.full_name / name
                    _copy(source, folder / FILES / detector.folder / source.name)
    if detectors:
        (folder / FILES / LICENCES).write_text(licences(detectors), "utf-8")


def models_of(folder: Path) -> list[str]:
    """The networks of a page, the default first."""
    names = sorted(path.stem for path in (folder / "lift").glob("*.wasm"))
    names = [name for name in names if not name.endswith("_scalar")]
    return sorted(names, key=lambda name: name != DEFAULT_MODEL)


def core_files(folder: Path) -> list[str]:
    """What a browser loads when the page is opened, and keeps."""
    others = [f"lift/{path.name}" for path in (folder / "lift").glob("*.wasm")]
    others.remove(f"lift/{DEFAULT_MODEL}.wasm")
    others += [WORKER, LIST, "lift/LICENSE"]
    names = (path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    return sorted(n for n in names if n not in others and not n.startswith(f"{FILES}/"))


def _write_list(folder: Path, detectors: dict[str, Detector]) -> None:
    """The list for main.js and for the service worker, whose bytes change with any file."""
    listed = {
        "version": version(),
        "models": models_of(folder),
        "core": ["./", *core_files(folder)],
        "detectors": {name: _listed(folder, detector) for name, detector in detectors.items()},
    }
    (folder / LIST).write_text(json.dumps(listed, indent=1) + "\n", "utf-8")
    text = (folder / WORKER).read_text("utf-8")
    assert text.count('"BUILD"') == 1
    text = text.replace('"BUILD"', json.dumps(_hash(folder)))
    (folder / WORKER).write_text(text, "utf-8")


def _listed(folder: Path, detector: Detector) -> dict[str, object]:
    place = f"{FILES}/{detector.folder}"
    files = [f"{place}/{name}" for name in detector.files]
    sizes = [{"path": name, "bytes": (folder / name).stat().st_size} for name in files]
    return {"folder": f"{place}/", "files": sizes}


def _hash(folder: Path) -> str:
    digest = hashlib.sha256()
    for name in [*core_files(folder), LIST, WORKER]:
        digest.update(name.encode() + b"\0" + (folder / name).read_bytes())
    return digest.hexdigest()[:16]


def loaded_bytes(folder: Path) -> tuple[int, int]:
    """What opening the page loads: over the network, as gzip, and unpacked; without detectors."""
    contents = [(folder / name).read_bytes() for name in [*core_files(folder), LIST, WORKER]]
    return sum(len(gzip.compress(data, 6)) for data in contents), sum(map(len, contents))
