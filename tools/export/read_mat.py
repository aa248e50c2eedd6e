"""Reads .mat: MatConvNet's networks, version 5 to 7.3 of MATLAB's files."""

import math
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io

from export.chain import RELU, Linear, Step, why_not
from export.layers import ExportError
from export.limits import H5, LARGEST, check_size


def read_mat(path: Path) -> list[Step]:
    """MatConvNet: a SimpleNN, or what DagNN's saveobj() gives; as `net` or field by field."""
    net = load_mat(path)
    if "layers" not in net:
        raise ExportError("holds no net.layers: neither a SimpleNN nor a saved DagNN")
    params = {item["name"]: item["value"] for item in as_list(net.get("params", []))}
    steps: list[Step] = []
    value = None
    for item in as_list(net["layers"]):
        kind = item["type"].removeprefix("dagnn.").lower()
        if kind == "pdist" or kind.endswith("loss"):
            continue  # only training uses it
        if value is not None and as_list(item["inputs"]) != value:
            raise ExportError(f"layer {item['name']} does not follow on {value[0]}")
        value = as_list(item["outputs"]) if "outputs" in item else None  # a SimpleNN has none
        check_mat_options(item)
        if kind == "conv":
            steps.append(mat_dense(item, params))
        elif kind == "relu":
            steps.append(RELU)
        elif kind != "dropout":  # idle once trained: training scaled what it let through
            raise ExportError(f"unsupported MatConvNet layer {item['type']}: {why_not(kind)}")
    return steps


def check_mat_options(item: Mapping[str, Any]) -> None:
    """A padded convolution is not a fully connected layer, a leaking ReLU is not a ReLU."""
    options = item.get("block", item)
    for name in ("pad", "leak"):
        if np.any(options.get(name, 0)):
            raise ExportError(f"unsupported {name} in MatConvNet layer {item['type']}")


def mat_dense(item: Mapping[str, Any], params: Mapping[str, Any]) -> Linear:
    """Filters [h, w, c, out] as [in, out]: vl_nnconv sums over h, w, c, and h runs fastest."""
    if "weights" in item:
        arrays = as_list(item["weights"])
    else:
        arrays = [params[name] for name in as_list(item["params"])]
    filters = arrays[0]
    biases = arrays[1].reshape(-1) if len(arrays) > 1 and arrays[1].size else None
    return Linear(filters.reshape(-1, filters.shape[-1], order="F"), biases)


def as_list(value: Any) -> list[Any]:
    """A cell or struct array as a list; SciPy hands out one of a single element bare."""
    many = isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object)
    return list(value) if many else [value]


def load_mat(path: Path) -> dict[str, Any]:
    """The fields of `net`, or of the file: structs as dicts, cells as lists, text as str."""
    import h5py

    if h5py.is_hdf5(path):  # version 7.3
        with h5py.File(path) as file:
            reader = MatlabH5(file)
            root = file if "net" not in file else reader.child(file, "net")
            names = [name for name in ("layers", "params") if name in root]
            return {name: reader.plain(reader.child(root, name)) for name in names}
    check_unpacked(path)
    # mat_dtype, because MATLAB stores integers, such as biases of zero, as bytes.
    variables = scipy.io.loadmat(path, simplify_cells=True, mat_dtype=True)
    return variables.get("net", variables)


HEADER, TAG, COMPRESSED = 128, 8, 15  # of version 5: bytes, bytes, type of an element
# What opens an array, struct or cell, by the order of the bytes.
VALUE = {"<": b"\x0e\0\0\0", ">": b"\0\0\0\x0e"}
SIZES, HEAD = 32, 32 + 4 * 32  # bytes before an array's sizes, and with the most that SciPy reads
INT32, UINT32 = 5, 6  # types of elements
CELL, STRUCT, OBJECT = 1, 2, 3  # classes of arrays whose elements are values again
CHAR, NUMERIC = 4, range(6, 16)  # classes of arrays of letters, and of numbers: double to uint64
COMPLEX = 0x800  # a flag of an array: its numbers, then their imaginary parts
# Types of elements that are letters and numbers.
TYPES = {CHAR: {1, 2, 3, 4, 16, 17, 18}} | dict.fromkeys(NUMERIC, {1, 2, 3, 4, 5, 6, 7, 9, 12, 13})
MOST_VALUES = 5_000  # a network of 20 layers has 400


def check_unpacked(path: Path) -> None:
    """Raises ExportError if the variables of a file of version 5 unpack to too much, or are so
    many that SciPy, which reads cells within cells by recursion, might run out of stack; or if an
    array has no two sizes, or its numbers or letters are of no type."""
    data = path.read_bytes()
    order = {b"IM": "<", b"MI": ">"}.get(data[126:HEADER])
    if order is None:  # version 4, which has neither
        return
    at, total, count = HEADER, 0, count_values(data, order)
    while at + TAG <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, at)
        at += TAG
        if kind == COMPRESSED:
            unpacked = zlib.decompressobj().decompress(data[at : at + size], LARGEST - total + 1)
            total += len(unpacked)
            check_size(total, "the unpacked file")
            count += count_values(unpacked, order)
        at += size
    check_count(count)


def count_values(data: bytes, order: str) -> int:
    """How many values these bytes have, or say that they have: of a cell or a struct as many as its
    sizes say, because SciPy takes memory for so many."""
    count, at = 0, data.find(VALUE[order])
    while at >= 0:
        count += elements_at(data[at : at + HEAD], order)
        check_numbers(data, at, order)
        at = data.find(VALUE[order], at + 1)
    return count


def elements_at(head: bytes, order: str) -> int:
    """Of the array that begins so: its tag, flags, the tag of its sizes, and these."""
    if len(head) < SIZES:
        return 1
    flags, _, tag, size = struct.unpack_from(f"{order}4I", head, 16)
    if tag & 0xFFFF not in (INT32, UINT32):  # no array, or one that SciPy refuses
        return 1
    if tag >> 16 or size < 8:  # a short element has one size; SciPy crashes where there is none
        raise ExportError("holds an array of less than two dimensions")
    if flags & 0xFF not in (CELL, STRUCT, OBJECT):
        return 1
    dimensions = min(size, len(head) - SIZES) // 4
    return max(1, math.prod(struct.unpack_from(f"{order}{dimensions}I", head, SIZES)))


def check_numbers(data: bytes, at: int, order: str) -> None:
    """Raises ExportError where the array that begins there has numbers or letters of no type: SciPy
    would look it up all the same, and crash."""
    if at + SIZES > len(data):
        return
    flags, _, tag, size = struct.unpack_from(f"{order}4I", data, at + 16)
    if flags & 0xFF not in TYPES or tag not in (INT32, UINT32):
        return
    at = element_behind(data, element_behind(data, at + 24, order), order)  # sizes, then the name
    for _ in range(2 if flags & COMPLEX else 1):
        if at + TAG > len(data):
            return
        (kind,) = struct.unpack_from(f"{order}I", data, at)
        if kind & 0xFFFF not in TYPES[flags & 0xFF]:
            raise ExportError(f"holds numbers or text of an unknown type, {kind & 0xFFFF}")
        at = element_behind(data, at, order)


def element_behind(data: bytes, at: int, order: str) -> int:
    """Where the next element begins; a short one has its bytes in its tag."""
    if at + TAG > len(data):
        return len(data)
    kind, size = struct.unpack_from(f"{order}2I", data, at)
    return at + TAG + (0 if kind >> 16 else -(-size // TAG) * TAG)


def check_count(count: int) -> None:
    """Raises ExportError where there are more values than a network has."""
    if count > MOST_VALUES:
        raise ExportError(f"holds more than {MOST_VALUES} values")


class MatlabH5(H5):
    """Reads MATLAB's values from an HDF5 file, whose axes run the other way round."""

    def __init__(self, file: Any) -> None:
        super().__init__()
        self.file, self.count = file, 0

    def plain(self, item: Any) -> Any:
        """A value as Python has it."""
        import h5py

        self.count += 1  # a cell can hold itself, or one that holds another twice
        check_count(self.count)
        kind = item.attrs.get("MATLAB_class")
        if isinstance(item, h5py.Group):
            members = {name: self.child(item, name) for name in item}
            fields = {name: self.plain(field) for name, field in members.items()}
            if any("MATLAB_class" not in field.attrs for field in members.values()):
                # An array of structs: each field is a list over the elements.
                rows = zip(*fields.values(), strict=True)
                return [dict(zip(fields, row, strict=True)) for row in rows]
            return fields
        if "MATLAB_empty" in item.attrs:
            return "" if kind == b"char" else np.zeros(0)
        values = self.array(item)
        if item.dtype == h5py.ref_dtype:
            return [self.plain(self.file[reference]) for reference in values.flat]
        if kind == b"char":
            return "".join(map(chr, values.flat))
        return values.T
