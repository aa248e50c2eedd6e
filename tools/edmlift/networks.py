"""The networks that the C library holds, by name."""

import ctypes
import functools
from dataclasses import dataclass

from edmlift._binding import load
from edmlift.formats import FORMATS

# Float; weights of 16 and of 8 bits.  A library may have been built without some.
NAMES = (
    "distances_f32", "distances_w16", "distances_w8", "direct_f32", "direct_w16", "direct_w8",
    "fconn_f32", "fconn_w16", "fconn_w8", "fconv_f32", "fconv_w8",
)  # fmt: skip
DEFAULT, DEFAULT_FIXED = "distances_f32", "distances_w16"


@dataclass(frozen=True)
class Model:
    """A network of the library `c`, and the arithmetic that lifts with it."""

    name: str
    fixed: bool
    c: ctypes.CDLL
    address: int
    work_bytes: int  # of scratch that a lift needs

    def work(self) -> "ctypes.Array[ctypes.c_char]":
        """New scratch for a call."""
        return ctypes.create_string_buffer(self.work_bytes)


def models(fixed: bool = False) -> tuple[str, ...]:
    """Names of the models that the library holds; with `fixed`, those that lift in fixed point."""
    return _names(load(), fixed)


def find_model(name: str | None = None, fixed: bool = False, c: ctypes.CDLL | None = None) -> Model:
    """The model of a name; without one "distances_f32", or "distances_w16" for a lift in fixed
    point.

    ValueError, which lists those that there are, where there is none, or where it cannot lift in
    that arithmetic.
    """
    c = c or load()
    name = name or (DEFAULT_FIXED if fixed else DEFAULT)
    if name not in _names(c, fixed):
        cannot = "does not lift in fixed point" if name in _names(c, False) else "is not known"
        hint = "; a detector's format is format=" if name in FORMATS else ""
        raise ValueError(f"model {name!r} {cannot}; there are {', '.join(_names(c, fixed))}{hint}")
    address = _address(c, name)
    return Model(name, fixed, c, address, _work_bytes(c, address, fixed))


@functools.cache
def _names(c: ctypes.CDLL, fixed: bool) -> tuple[str, ...]:
    held = [name for name in NAMES if hasattr(c, f"edml_{name}")]
    return tuple(name for name in held if _work_bytes(c, _address(c, name), fixed) > 0)


def _address(c: ctypes.CDLL, name: str) -> int:
    return ctypes.addressof(ctypes.c_char.in_dll(c, f"edml_{name}"))


def _work_bytes(c: ctypes.CDLL, address: int, fixed: bool) -> int:
    size: int = (c.edml_model_work_bytes_q if fixed else c.edml_model_work_bytes)(address)
    return size
