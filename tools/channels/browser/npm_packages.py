"""Packages of npm that are used as they are: of one version, with these bytes; none is run."""

import base64
import hashlib
import re
import shutil
import subprocess
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path

from reports.targets import ToolError


@dataclass(frozen=True)
class Package:
    """A package, and which of its files are kept."""

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


def is_there(package: Package, folder: Path) -> bool:
    """Is a package installed in the folder?"""
    return all((folder / package.full_name / name).exists() for name in package.files)


def install(package: Package, folder: Path) -> None:
    """Downloads a package, checks its bytes, and puts its files into the folder."""
    with tempfile.TemporaryDirectory() as scratch:
        archive = _download(package, Path(scratch))
        digest = base64.b64encode(hashlib.sha512(archive.read_bytes()).digest()).decode()
        if f"sha512-{digest}" != package.integrity:
            raise ToolError(f"{package.full_name} has other bytes than it had: nothing is kept")
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
    command = ["npm", "pack", "--loglevel=error", "--ignore-scripts", package.full_name]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        reason = re.search(r"^npm (?:error|ERR!) (?!code|syscall|errno)(.+)$", done.stderr, re.M)
        said = reason[1] if reason else "npm does not say why"
        raise ToolError(f"{package.full_name} cannot be downloaded: {said}")
    (archive,) = folder.glob("*.tgz")
    return archive
