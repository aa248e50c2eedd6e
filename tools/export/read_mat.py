"""Reads .mat: MatConvNet's networks, version 5 to 7.3 of MATLAB's files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io

from export.layers import ExportError, Layer, check_order


def read_mat(path: Path) -> list[Layer]:
    """MatConvNet: a SimpleNN, or what DagNN's saveobj() gives; as `net` or field by field."""
    net = load_mat(path)
    if "layers" not in net:
        raise ExportError("holds no net.layers: neither a SimpleNN nor a saved DagNN")
    params = {item["name"]: item["value"] for item in as_list(net.get("params", []))}
    layers, order, value = [], [], None
    for item in as_list(net["layers"]):
        kind = item["type"].removeprefix("dagnn.").lower()
        if kind == "pdist" or kind.endswith("loss"):
            continue  # only training uses it
        if value is not None and as_list(item["inputs"]) != value:
            raise ExportError(f"layer {item['name']} does not follow on {value[0]}")
        value = as_list(item["outputs"]) if "outputs" in item else None  # a SimpleNN has none
        check_mat_options(item)
        if kind == "conv":
            layers.append(mat_dense(item, params))
            order.append("dense")
        elif kind == "relu":
            order.append("relu")
        elif kind != "dropout":  # idle once trained: training scaled what it let through
            raise ExportError(f"unsupported MatConvNet layer {item['type']}: only conv and relu")
    check_order(order)
    return layers


def check_mat_options(item: Mapping[str, Any]) -> None:
    """A padded convolution is not a fully connected layer, a leaking ReLU is not a ReLU."""
    options = item.get("block", item)
    for name in ("pad", "leak"):
        if np.any(options.get(name, 0)):
            raise ExportError(f"unsupported {name} in MatConvNet layer {item['type']}")


def mat_dense(item: Mapping[str, Any], params: Mapping[str, Any]) -> Layer:
    """Filters [h, w, c, out] as [in, out]: vl_nnconv sums over h, w, c, and h runs fastest."""
    if "weights" in item:
        arrays = as_list(item["weights"])
    else:
        arrays = [params[name] for name in as_list(item["params"])]
    filters = arrays[0]
    biases = arrays[1].reshape(-1) if len(arrays) > 1 and arrays[1].size else None
    return Layer(filters.reshape(-1, filters.shape[-1], order="F"), biases)


def as_list(value: Any) -> list[Any]:
    """A cell or struct array as a list; SciPy hands out one of a single element bare."""
    many = isinstance(value, list) or (isinstance(value, np.ndarray) and value.dtype == object)
    return list(value) if many else [value]


def load_mat(path: Path) -> dict[str, Any]:
    """The fields of `net`, or of the file: structs as dicts, cells as lists, text as str."""
    import h5py

    if h5py.is_hdf5(path):  # version 7.3
        with h5py.File(path) as file:
            root = file.get("net", file)
            names = [name for name in ("layers", "params") if name in root]
            return {name: plain_h5(file, root[name]) for name in names}
    # mat_dtype, because MATLAB stores integers, such as biases of zero, as bytes.
    variables = scipy.io.loadmat(path, simplify_cells=True, mat_dtype=True)
    return variables.get("net", variables)


def plain_h5(file: Any, item: Any) -> Any:
    """A MATLAB value in an HDF5 file, whose axes run the other way round."""
    import h5py

    kind = item.attrs.get("MATLAB_class")
    if isinstance(item, h5py.Group):
        fields = {name: plain_h5(file, field) for name, field in item.items()}
        if any("MATLAB_class" not in field.attrs for field in item.values()):
            # An array of structs: each field is a list over the elements.
            rows = zip(*fields.values(), strict=True)
            return [dict(zip(fields, row, strict=True)) for row in rows]
        return fields
    if "MATLAB_empty" in item.attrs:
        return "" if kind == b"char" else np.zeros(0)
    if item.dtype == h5py.ref_dtype:
        return [plain_h5(file, file[reference]) for reference in item[()].flat]
    if kind == b"char":
        return "".join(map(chr, item[()].flat))
    return item[()].T
