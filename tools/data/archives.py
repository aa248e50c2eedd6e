"""Archives of arrays from anywhere (.npz and other zip files): sizes are checked before memory is
taken, and nothing but arrays of plain numbers and text is made of them."""

import io
import math
import sys
import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

# Compressions that can be read in steps.
COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


class ArchiveError(ValueError):
    """What is wrong with an archive, in one line."""


def one_line(error: Exception) -> str:
    """An error's kind and message, without line breaks."""
    return " ".join(f"{type(error).__name__}: {error}".split())


def check_size(size: int, what: str, largest: int) -> None:
    """Raises ArchiveError where something takes more bytes than may be read."""
    if size > largest:
        raise ArchiveError(f"{what} takes {size / 2**20:.0f} MB, at most {largest >> 20} are read")


def read_members(
    file: Path | IO[bytes], largest: int, names: Iterable[str] | None = None
) -> dict[str, bytes]:
    """The members of a zip archive, or those of these names that it has: name -> bytes.

    largest  bytes that all of them may take, unpacked
    """
    with zipfile.ZipFile(file) as archive:
        check_members(archive, largest)
        wanted = set(archive.namelist() if names is None else names)
        return {
            info.filename: read_member(archive, info)
            for info in archive.infolist()
            if info.filename in wanted
        }


def check_members(archive: zipfile.ZipFile, largest: int) -> None:
    """Raises ArchiveError where an archive says that it unpacks to too much."""
    check_size(sum(info.file_size for info in archive.infolist()), "the unpacked archive", largest)


def read_member(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    """A member, of which no more is unpacked than the archive says that there is."""
    if info.compress_type not in COMPRESSIONS:
        raise ArchiveError(f"{info.filename} is compressed by a method other than deflate")
    with archive.open(info) as member:
        data = member.read(info.file_size)
    if len(data) != info.file_size:
        raise ArchiveError(f"{info.filename} is cut off")
    return data


def npy_header(data: bytes) -> tuple[tuple[int, ...], bool, "np.dtype[Any]", int]:
    """Of an .npy file: shape, whether columns come first, type, and where the values begin."""
    file = io.BytesIO(data)
    version = np.lib.format.read_magic(file)
    if version == (1, 0):
        header = np.lib.format.read_array_header_1_0(file)
    elif version == (2, 0):
        header = np.lib.format.read_array_header_2_0(file)
    else:
        raise ArchiveError(f"unknown version {version} of .npy")
    return *header, file.tell()


def npy_array(data: bytes) -> NDArray[Any]:
    """The array of an .npy file, which may not hold objects."""
    shape, by_column, dtype, start = npy_header(data)
    values = np.frombuffer(data, dtype, math.prod(shape), start)
    if dtype.kind == "U" and values.nbytes:
        codes = values.view(np.dtype("u4").newbyteorder(dtype.byteorder))
        if codes.max() > sys.maxunicode:  # Python would make strings of them that it cannot read
            raise ArchiveError(f"text with the code {codes.max():#x}, which is of no letter")
    return values.reshape(shape, order="F" if by_column else "C")


def load_npz(path: Path, largest: int) -> dict[str, NDArray[Any]]:
    """The arrays of a file.  ArchiveError, or whatever a damaged file raises."""
    if not zipfile.is_zipfile(path):
        raise ArchiveError("no zip archive")
    members = read_members(path, largest)
    return {name.removesuffix(".npy"): npy_array(data) for name, data in members.items()}
