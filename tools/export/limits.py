"""How much of a file of weights is read: sizes are checked before memory is taken."""

import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

import numpy as np

from data import archives
from export.layers import ExportError

# Bytes of a file, of what is packed in it, and of a manifest.  The largest shipped network, FConv,
# has 1.2 MB; a checkpoint with the state of its optimiser has three times its weights.
LARGEST = 64 << 20
LARGEST_MANIFEST = 4 << 20


def check_size(size: int, what: str, largest: int = LARGEST) -> None:
    """Raises ExportError where something takes more bytes than any network that fits."""
    if size > largest:
        raise ExportError(
            f"{what} takes {size / 2**20:.0f} MB, at most {largest >> 20} are read: "
            "nothing that belongs to a network that fits is as large"
        )


def read_members(file: Path | IO[bytes], names: Iterable[str] | None = None) -> dict[str, bytes]:
    """The members of a zip archive, or those of these names that it has: name -> bytes."""
    return archives.read_members(file, LARGEST, names)


def check_archive(path: Path) -> None:
    """Raises ArchiveError where an archive that another library will read unpacks to too much."""
    with zipfile.ZipFile(path) as archive:
        archives.check_members(archive, LARGEST)


class H5:
    """Reads an HDF5 file: nothing outside of it, and no more than LARGEST bytes of arrays."""

    def __init__(self) -> None:
        self.left = LARGEST

    def child(self, group: Any, name: str) -> Any:
        """What is at a path below a group, or None."""
        import h5py

        for part in name.strip("/").split("/"):
            if not isinstance(group, h5py.Group):
                return None
            link = group.get(part, getlink=True)
            if link is None:
                return None
            if not isinstance(link, h5py.HardLink):
                raise ExportError(f"{part} is a link to elsewhere")
            group = group[part]
        return group

    def array(self, dataset: Any) -> np.ndarray:
        """The values of a dataset."""
        name = dataset.name or "a dataset"
        if dataset.is_virtual or dataset.external:
            raise ExportError(f"{name} lies in another file")
        size = (dataset.size or 0) * max(dataset.dtype.itemsize, 1)
        check_size(size, name)
        self.left -= size
        if self.left < 0:
            raise ExportError(f"its arrays take more than {LARGEST >> 20} MB together")
        return dataset[()]
