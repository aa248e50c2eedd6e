"""The page that lifts what a camera, a video or a dragged skeleton shows, in the browser.

    python tools/run.py channels.browser.page build/page   the page without a detector

Any server can serve the folder.  `tools/web` builds one with detectors, and serves it
(docs/browser.md).  What the page is made of is in tools/page; what `edmlift view` has as well, in
tools/edmlift/viewing.
"""

import argparse
import gzip
import hashlib
import json
import shutil
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from channels.archives import write_zip
from channels.browser.detectors import LICENCES, Detector, licences
from channels.browser.npm import package_files
from channels.version import version
from data.paths import ROOT
from reports.targets import ToolError

SOURCES = ROOT / "tools" / "page"
SHARED = ROOT / "tools" / "edmlift" / "viewing" / "page"
SHARED_FILES = (
    "joints.js", "paint.js", "skeleton.js", "figure.js", "turning.js", "look.css",
)  # fmt: skip
DEFAULT_MODEL = "direct_w16"
WORKER = "sw.js"  # the service worker
LIST = "files.json"
FILES = "detectors/files"  # of the detectors, in the page


def build(folder: Path) -> list[Path]:
    """edmlift-page-VERSION.zip: the page without a detector."""
    with tempfile.TemporaryDirectory() as temporary:
        lift, page = Path(temporary) / "lift", Path(temporary) / "page"
        lift.mkdir()
        build_page(page, package_files(lift))
        files = {p.relative_to(page).as_posix(): p for p in page.rglob("*") if p.is_file()}
        return [write_zip(folder / f"edmlift-page-{version()}.zip", files)]


def build_page(
    folder: Path,
    lift: Iterable[Path],
    detectors: Mapping[str, Detector] | None = None,
    packages: Path = Path(),
) -> Path:
    """Writes a page into a folder, which is made anew.

    lift       the files of the npm package
    packages   folder of the detectors' packages, as npm_packages.install() leaves it
    """
    detectors = detectors or {}
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(SOURCES, folder)
    _copy((SHARED / name for name in SHARED_FILES), folder / "view")
    _copy((f for f in lift if f.suffix in (".js", ".wasm") or f.name == "LICENSE"), folder / "lift")
    for detector in detectors.values():
        _copy(detector.paths(packages), folder / FILES / detector.folder)
    if detectors:
        (folder / FILES / LICENCES).write_text(licences(detectors.values()), "utf-8")
    _write_list(folder, detectors)
    return folder


def _copy(files: Iterable[Path], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for file in files:
        shutil.copyfile(file, folder / file.name)


def core_files(folder: Path) -> list[str]:
    """What a browser loads when the page is opened, and keeps."""
    left_out = {WORKER, LIST, "lift/LICENSE"}
    left_out |= {f"lift/{program.name}" for program in (folder / "lift").glob("*.wasm")}
    left_out -= {f"lift/{DEFAULT_MODEL}.wasm"}
    names = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    return sorted(n for n in names - left_out if not n.startswith(f"{FILES}/"))


def _models(folder: Path) -> list[str]:
    """The networks of a page, the default first."""
    names = {program.stem.removesuffix("_scalar") for program in (folder / "lift").glob("*.wasm")}
    return sorted(names, key=lambda name: (name != DEFAULT_MODEL, name))


def _write_list(folder: Path, detectors: Mapping[str, Detector]) -> None:
    """The list for main.js and for the service worker, whose bytes change with any file."""
    listed = {
        "version": version(),
        "models": _models(folder),
        "core": ["./", *core_files(folder)],
        "detectors": {name: _listed(folder, detector) for name, detector in detectors.items()},
    }
    (folder / LIST).write_text(json.dumps(listed, indent=1) + "\n", "utf-8")
    text = (folder / WORKER).read_text("utf-8")
    assert text.count('"BUILD"') == 1
    text = text.replace('"BUILD"', json.dumps(_hash(folder)))
    (folder / WORKER).write_text(text, "utf-8")


def _listed(folder: Path, detector: Detector) -> dict[str, object]:
    place = f"{FILES}/{detector.folder}/"
    sizes = ({"path": p, "bytes": (folder / p).stat().st_size} for p in detector.under(place))
    return {"folder": place, "files": list(sizes)}


def _hash(folder: Path) -> str:
    digest = hashlib.sha256()
    for name in [*core_files(folder), LIST, WORKER]:
        digest.update(name.encode() + b"\0" + (folder / name).read_bytes())
    return digest.hexdigest()[:16]


def loaded_bytes(folder: Path) -> tuple[int, int]:
    """What opening the page loads: over the network, as gzip, and unpacked; without detectors."""
    contents = [(folder / name).read_bytes() for name in [*core_files(folder), LIST, WORKER]]
    return sum(len(gzip.compress(data, 6)) for data in contents), sum(map(len, contents))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where the page is written; it is made anew")
    folder = parser.parse_args().folder
    try:
        with tempfile.TemporaryDirectory() as temporary:
            build_page(folder, package_files(Path(temporary)))
    except ToolError as error:
        print(f"channels.browser.page: {error}", file=sys.stderr)
        return 1
    print(f"{folder}: the page, {loaded_bytes(folder)[0] / 1000:.0f} KB to load")
    return 0


if __name__ == "__main__":
    sys.exit(main())
