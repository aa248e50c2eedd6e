"""The keypoint orders of detectors, as the C library has them."""

import ctypes
from collections.abc import Iterator, Mapping

from edmlift._binding import Format, load

NOT_NORMALISED, BY_IMAGE, BY_SQUARE = range(3)  # edml_format.normalised


class _Formats(Mapping[str, int]):
    """Read from the library when first asked, so that importing the package does not need it."""

    def __getitem__(self, name: str) -> int:
        return int(_formats(load())[name].keypoints)

    def __iter__(self) -> Iterator[str]:
        return iter(_formats(load()))

    def __len__(self) -> int:
        return len(_formats(load()))

    def __repr__(self) -> str:
        return repr(dict(self))


# How many keypoints each detector's format has: {"coco17": 17, "body25": 25, ...}
FORMATS: Mapping[str, int] = _Formats()


def find_format(name: str, c: ctypes.CDLL | None = None) -> Format:
    """The format of a name; ValueError, which lists those that there are, if there is none."""
    known = _formats(c or load())
    if name not in known:
        raise ValueError(f"format {name!r} is not known; there are {', '.join(known)}")
    return known[name]


def _formats(c: ctypes.CDLL) -> dict[str, Format]:
    first = ctypes.POINTER(Format).in_dll(c, "edml_formats")
    listed = ctypes.cast(ctypes.byref(first), ctypes.POINTER(ctypes.POINTER(Format)))
    known: dict[str, Format] = {}
    while listed[len(known)]:  # NULL ends the list
        entry = listed[len(known)].contents
        known[entry.name.decode()] = entry
    return known


def formats_with(keypoints: int) -> list[str]:
    """The names of the formats that have so many keypoints."""
    return [name for name, count in FORMATS.items() if count == keypoints]
