"""How much of a file of weights is read: sizes are checked before memory is taken."""

import io
import math
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

import numpy as np

from export.layers import ExportError

# Bytes of a file, of what is packed in it, and of a manifest.  The largest shipped network, FConv,
# has 1.2 MB; a checkpoint with the state of its optimiser has three times its weights.
LARGEST = 64 << 20
LARGEST_MANIFEST = 4 << 20
# Compressions that can be read in steps.
COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


def check_size(size: int, what: str, largest: int = LARGEST) -> None:
    """Raises ExportError where something takes more bytes than any network that fits."""
    if size > largest:
        raise ExportError(
            f"{what} takes {size / 2**20:.0f} MB, at most {largest >> 20} are read: "
            "nothing that belongs to a network that fits is as large"
        )


def read_members(file: Path | IO[bytes], names: Iterable[str] | None = None) -> dict[str, bytes]:
    """The members of a zip archive, or those of these names that it has: name -> bytes."""
    with zipfile.ZipFile(file) as archive:
        check_members(archive)
        wanted = set(archive.namelist() if names is None else names)
        return {
            info.filename: read_member(archive, info)
            for info in archive.infolist()
            if info.filename in wanted
        }


def check_archive(path: Path) -> None:
    """check_members() of a file that another library will read."""
    with zipfile.ZipFile(path) as archive:
        check_members(archive)


def check_members(archive: zipfile.ZipFile) -> None:
    """Raises ExportError where an archive says that it unpacks to too much."""
    check_size(sum(info.file_size for info in archive.infolist()), "the unpacked archive")


def read_member(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    """A member, of which no more is unpacked than the archive says that there is."""
    if info.compress_type not in COMPRESSIONS:
        raise ExportError(f"{info.filename} is compressed by a method other than deflate")
    with archive.open(info) as member:
        data = member.read(info.file_size)
    if len(data) != info.file_size:
        raise ExportError(f"{info.filename} is cut off")
    return data


def npy_array(data: bytes) -> np.ndarray:
    """The array of an .npy file, which may not hold objects."""
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        shape, by_column, dtype = np.lib.format.read_array_header_1_0(file)
    elif version == (2, 0):
        shape, by_column, dtype = np.lib.format.read_array_header_2_0(file)
    else:
        raise ExportError(f"unknown version {version} of .npy")
    values = np.frombuffer(data, dtype, math.prod(shape), file.tell())
    return values.reshape(shape, order="F" if by_column else "C")


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
