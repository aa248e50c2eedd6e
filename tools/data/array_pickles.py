"""Dictionaries of arrays out of pickles from anywhere: arrays of numbers, and no more.

NumPy's own classes are not let in: the state of a dtype or an array in a pickle may be one that no
array has, such as bytes that are taken for pointers.  Stand-ins read the state, check it and build
the arrays.
"""

import io
import pickle
import pickletools
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

_PLAIN = re.compile(r"[fiu][1248]|b1|O8")
_DEPTH = 5  # of what is within each other: an array of a dictionary of dictionaries of arrays
_OBJECT_FLAGS = 63  # of a dtype of objects in a pickle; plain ones have 0


def load_arrays(data: bytes) -> Any:
    """What a pickle holds: dictionaries, lists, numbers, text and NumPy's arrays of these.

    pickle.UnpicklingError, or whatever a damaged pickle raises: it holds something else
    """
    _check_memo(data)
    return _Plain().of(_Arrays(io.BytesIO(data)).load())


def _check_memo(data: bytes) -> None:
    """Refuses numbers of things to be remembered that are beyond how many there can be: the
    unpickler makes room for as many, gigabytes for a file of ten bytes."""
    for count, (code, argument, _) in enumerate(pickletools.genops(data)):
        if code.name in ("PUT", "BINPUT", "LONG_BINPUT") and not 0 <= int(argument) <= count:
            raise pickle.UnpicklingError(f"remembers thing {argument} of {count}")


class _Arrays(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        known = _STAND_INS.get((module.replace("numpy._core", "numpy.core"), name))
        if known is None:
            raise pickle.UnpicklingError(f"holds {module}.{name}, which is no array")
        return known


class _Dtype:
    """numpy.dtype: its text, and a state that only a plain one has."""

    def __init__(self, text: str, _align: Any = False, _copy: Any = True):
        if not isinstance(text, str) or not _PLAIN.fullmatch(text):
            raise pickle.UnpicklingError(f"holds an array of {text!r}, not of numbers")
        self.text, self.order = text, "|"

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _version, order, *structure, _size, _alignment, flags = state[:8]
        wanted = _OBJECT_FLAGS if self.text == "O8" else 0
        if order not in ("<", ">", "|", "=") or structure != [None] * 3 or flags != wanted:
            raise pickle.UnpicklingError("holds an array whose type has parts, not numbers")
        self.order = order

    def known(self) -> "np.dtype[Any]":
        return np.dtype("O" if self.text == "O8" else self.order + self.text)


class _Array:
    """numpy.ndarray, as _reconstruct() begins it and its state ends it."""

    def __init__(self, *_begun: Any):
        self.value: Any = None

    @classmethod
    def of(cls, value: NDArray[Any]) -> "_Array":
        made = cls()
        made.value = value
        return made

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        _version, shape, dtype, is_fortran, data = state
        self.value = _built(data, dtype, shape, "F" if is_fortran else "C")


def _built(data: Any, dtype: Any, shape: Any, order: str) -> NDArray[Any]:
    kind = dtype.known()
    if not kind.hasobject:
        numbers: NDArray[Any] = np.frombuffer(data, kind).reshape(shape, order=order)  # type: ignore[call-overload]
        return numbers
    if not isinstance(data, list):  # bytes would be pointers
        raise pickle.UnpicklingError("holds an array of objects without objects")
    objects = np.empty(len(data), object)
    for n, part in enumerate(data):
        objects[n] = part
    return objects.reshape(shape, order=order)  # type: ignore[call-overload,no-any-return]


def _from_buffer(data: Any, dtype: Any, shape: Any, order: str) -> _Array:
    if dtype.known().hasobject:
        raise pickle.UnpicklingError("holds an array of objects without objects")
    return _Array.of(_built(data, dtype, shape, order))


def _scalar(dtype: Any, data: Any) -> Any:
    return _from_buffer(data, dtype, (1,), "C").value[0]


def _encoded(text: str, encoding: str) -> bytes:
    if encoding != "latin1":  # as Python 2's bytes are written
        raise pickle.UnpicklingError(f"holds text in {encoding}")
    return text.encode("latin1")


_STAND_INS = {
    ("numpy", "ndarray"): _Array,
    ("numpy", "dtype"): _Dtype,
    ("numpy.core.multiarray", "_reconstruct"): _Array,
    ("numpy.core.multiarray", "scalar"): _scalar,
    ("numpy.core.numeric", "_frombuffer"): _from_buffer,
    ("_codecs", "encode"): _encoded,
}


class _Plain:
    """Things with arrays in place of what stands for them.  What is in several places is made once:
    a list of a thousand times the same list of a thousand is small in a file."""

    def __init__(self) -> None:
        self.known: dict[int, Any] = {}

    def of(self, value: Any, depth: int = _DEPTH) -> Any:
        if depth == 0:
            raise pickle.UnpicklingError("holds things within things within things")
        if isinstance(value, _Array):
            value = value.value
        if id(value) not in self.known:
            self.known[id(value)] = self._made(value, depth - 1)
        return self.known[id(value)]

    def _made(self, value: Any, depth: int) -> Any:
        if isinstance(value, dict):
            return {key: self.of(part, depth) for key, part in value.items()}
        if isinstance(value, list | tuple):
            return [self.of(part, depth) for part in value]
        if isinstance(value, np.ndarray) and value.dtype.hasobject:
            parts = [self.of(part, depth) for part in value.ravel()]
            return _built(parts, _Dtype("O8"), value.shape, "C")
        return value
