"""Reads trained weights: .npz (train.py's), .safetensors, .onnx, .pt and .pth (PyTorch), .mat
(MatConvNet).

Each format is a function path -> layers in READERS; what follows is common to all.
"""

import hashlib
import json
import re
import zipfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

PAIRS = 91  # EDML_PAIRS
TWINS = 49  # of them, one of each twins: skeleton.PAIR_TWINS
WIDEST = 192  # EDML_LAYER_WIDEST

# What a manifest says of lib/blend.inc if poses are not to be moved: share, and metres.
NO_BLEND = {"share": 0.0, "misfit": 1.0, "distance": 1000.0}


class ExportError(Exception):
    """What is wrong with the weights or the manifest, in one line."""


class Layer(NamedTuple):
    """y = relu(x @ weight + bias)."""

    weight: np.ndarray  # float32 [in, out]
    bias: np.ndarray  # float32 [out]


# ---- Readers: path -> layers -------------------------------------------------------------------


def load_npz(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a file."""
    if not zipfile.is_zipfile(path):  # np.load would take it for a pickle
        raise ExportError("not a readable .npz file: no zip archive")
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def read_npz(path: Path) -> list[Layer]:
    """The project's own: weight0 [in, out], bias0 [out], weight1 ..."""
    arrays, tensors = load_npz(path), {}
    for name, array in arrays.items():
        match = re.fullmatch(r"(weight|bias)(\d+)", name)
        if match is None:
            raise ExportError(f"unknown array {name}: want weight0, bias0, weight1 ...")
        tensors[f"{match[2]}.{match[1]}"] = array
    layers = pair_up(tensors)
    if layers and f"weight{len(layers) - 1}" not in arrays:
        raise ExportError(f"the {len(layers)} layers are not numbered 0 to {len(layers) - 1}")
    return layers


def read_safetensors(path: Path) -> list[Layer]:
    """A PyTorch state dict: fc1.weight [out, in], fc1.bias [out] ..."""
    from safetensors.numpy import load_file

    return transposed(pair_up(load_file(path)))


def read_torch(path: Path) -> list[Layer]:
    """A PyTorch state dict, bare or as the "state_dict" of a checkpoint."""
    try:
        import torch
    except ImportError:
        raise ExportError(
            f"reading {path.suffix} needs PyTorch: pip install torch, or save as .safetensors"
        ) from None
    state = torch.load(path, map_location="cpu", weights_only=True)
    state = state.get("state_dict", state)
    # float(), for NumPy has no bfloat16.  What is no tensor fails by its name in pair_up().
    return transposed(
        pair_up(
            {
                name: value.detach().float().numpy() if torch.is_tensor(value) else None
                for name, value in state.items()
            }
        )
    )


def pair_up(tensors: Mapping[str, Any]) -> list[Layer]:
    """Layers of tensors named PREFIX.weight and PREFIX.bias, in the natural order of the prefixes.

    That names tell the order is the convention of nn.Sequential and of numbered modules;
    safetensors keeps no other.
    """
    pairs: dict[str, dict[str, Any]] = {}
    for name, tensor in tensors.items():
        prefix, _, kind = name.rpartition(".")
        if kind not in ("weight", "bias"):
            raise ExportError(f"unsupported tensor {name}: only weight and bias of linear layers")
        pairs.setdefault(prefix, {})[kind] = tensor
    for prefix, pair in pairs.items():
        if missing := {"weight", "bias"} - pair.keys():
            raise ExportError(f"layer {prefix or 0} has no {missing.pop()}")
    return [Layer(**pairs[prefix]) for prefix in sorted(pairs, key=natural)]


def natural(text: str) -> list[str | int]:
    """Sort key by which fc2 precedes fc10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", text)]


def transposed(layers: Iterable[Layer]) -> list[Layer]:
    """PyTorch's [out, in] to [in, out]."""
    return [Layer(weight.T, bias) for weight, bias in layers]


def read_onnx(path: Path) -> list[Layer]:
    """A chain of Gemm, or MatMul and Add, with Relu between; a Relu at the end may be left out."""
    import onnx

    graph = onnx.load(path).graph
    constants = {item.name: onnx.numpy_helper.to_array(item) for item in graph.initializer}
    inputs = [item.name for item in graph.input if item.name not in constants]
    if len(inputs) != 1:
        raise ExportError(f"the graph has {len(inputs)} inputs, not one")
    [value], layers, order = inputs, [], []
    for node in graph.node:
        attributes = {item.name: onnx.helper.get_attribute_value(item) for item in node.attribute}
        if node.op_type == "Constant" and "value" in attributes:
            constants[node.output[0]] = onnx.numpy_helper.to_array(attributes["value"])
        elif node.op_type == "Identity" and node.input[0] in constants:
            # PyTorch's exporter shares equal biases this way.
            constants[node.output[0]] = constants[node.input[0]]
        else:
            add_onnx_node(layers, order, node, attributes, onnx_operands(node, value, constants))
            value = node.output[0]
    if value not in [item.name for item in graph.output]:
        raise ExportError(f"the graph does not end with the chain's last value, {value}")
    check_order(order)
    return layers


ONNX_OPERATORS = ("Gemm", "MatMul", "Add", "Relu")


def onnx_operands(node: Any, value: str, constants: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    """A node's constants; its other input must be the chain's value so far."""
    if node.op_type not in ONNX_OPERATORS:
        known = ", ".join(ONNX_OPERATORS)
        raise ExportError(f"unsupported ONNX operator {node.op_type}: only {known}")
    names = [name for name in node.input if name != value]
    if len(names) != len(node.input) - 1 or (node.op_type != "Add" and node.input[0] != value):
        raise ExportError(f"{node.op_type} of {node.output[0]} does not follow on {value}")
    for name in names:
        if name not in constants:
            raise ExportError(f"{node.op_type} of {node.output[0]}: {name} is not a constant")
    return [constants[name] for name in names]


def add_onnx_node(
    layers: list[Layer],
    order: list[str],
    node: Any,
    attributes: Mapping[str, Any],
    operands: list[np.ndarray],
) -> None:
    """Appends what the node does to the layers and to the order of dense and relu."""
    if node.op_type == "Relu":
        order.append("relu")
    elif node.op_type == "Add":
        if order[-1:] != ["dense"] or layers[-1].bias is not None:
            raise ExportError(f"Add of {node.output[0]} does not follow on a MatMul")
        layers[-1] = Layer(layers[-1].weight, operands[0].reshape(-1))
    else:
        layers.append(onnx_dense(node, attributes, operands))
        order.append("dense")


def onnx_dense(node: Any, attributes: Mapping[str, Any], operands: list[np.ndarray]) -> Layer:
    """The layer of a Gemm or a MatMul; without a bias yet where an Add is to bring it."""
    plain = {"alpha": 1.0, "beta": 1.0, "transA": 0}
    for name, want in plain.items():
        if attributes.get(name, want) != want:
            raise ExportError(f"unsupported {name} {attributes[name]:g} in Gemm {node.output[0]}")
    weight = operands[0].T if attributes.get("transB", 0) else operands[0]
    bias = operands[1].reshape(-1) if len(operands) > 1 else None
    return Layer(weight, bias)


def check_order(order: list[str]) -> None:
    """Dense, relu, dense, relu ...; after the last layer the relu may be missing, for the C
    kernel applies it and a distance is not negative."""
    if order != (["dense", "relu"] * len(order))[: len(order)]:
        raise ExportError(f"want one relu between layers, not {', '.join(order)}")


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
    import scipy.io

    # mat_dtype, for MATLAB stores whole numbers, such as biases of zero, as bytes.
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


READERS: dict[str, Callable[[Path], list[Layer]]] = {
    ".npz": read_npz,
    ".safetensors": read_safetensors,
    ".onnx": read_onnx,
    ".pt": read_torch,
    ".pth": read_torch,
    ".mat": read_mat,
}


def read_layers(path: Path) -> list[Layer]:
    """The layers in a file of weights, fit for a header.  Raises ExportError, never another."""
    return check_layers(read_file(path, READERS))


def read_file(path: Path, readers: Mapping[str, Callable[[Path], Any]]) -> Any:
    """What the reader of its suffix makes of a file.  Raises ExportError, never another."""
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise ExportError(f"unknown suffix '{path.suffix}': one of {', '.join(readers)}")
    if not path.is_file():
        raise ExportError("no such file")
    if path.stat().st_size == 0:
        raise ExportError("the file is empty")
    try:
        return reader(path)
    except ExportError:
        raise
    except Exception as error:  # a damaged file makes the libraries raise whatever they like
        raise ExportError(f"not a readable {path.suffix} file: {one_line(error)}") from error


def one_line(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


# ---- Checks ------------------------------------------------------------------------------------


def check_layers(layers: Iterable[tuple[Any, Any]], twins: bool = False) -> list[Layer]:
    """The layers in float32, if the C kernels can run them; else ExportError.

    With `twins`, of a network that twin_weights.py describes: an output is two units.
    """
    units, last = (2, TWINS) if twins else (1, PAIRS)
    layers = [
        Layer(to_float32(weight, f"layer {k}: weight", 2), to_float32(bias, f"layer {k}: bias", 1))
        for k, (weight, bias) in enumerate(layers)
    ]
    if not layers:
        raise ExportError("holds no layers")
    width = PAIRS
    for k, (weight, bias) in enumerate(layers):
        inputs, outputs = weight.shape
        if inputs != width:
            before = "the pose has" if k == 0 else f"layer {k - 1} gives"
            raise ExportError(f"layer {k} takes {inputs} values, {before} {width}")
        if len(bias) != outputs:
            raise ExportError(f"layer {k} has {outputs} outputs, but {len(bias)} biases")
        width = units * outputs
        if width > WIDEST:
            raise ExportError(f"layer {k} is {width} wide, at most {WIDEST} fit")
    if outputs != last:
        raise ExportError(f"the last layer gives {outputs} values, not {last}")
    return layers


def to_float32(array: Any, name: str, dimensions: int) -> np.ndarray:
    """The array in float32; raises ExportError on another shape, on integers, NaN, infinity."""
    if array is None:
        raise ExportError(f"{name} is missing")
    array = np.asarray(array)
    if array.ndim != dimensions:
        raise ExportError(f"{name} has {array.ndim} dimensions, not {dimensions}")
    if array.dtype.kind != "f" and array.dtype.name != "bfloat16":
        raise ExportError(f"{name} is of type {array.dtype}, not floating point")
    with np.errstate(over="ignore"):
        array = array.astype(np.float32)
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        index = ", ".join(map(str, bad[0]))
        raise ExportError(f"{name}[{index}] is {array[tuple(bad[0])]} in float32")
    return array


def digest(layers: Iterable[Layer]) -> str:
    """What tells a set of weights from another, whatever the file and the packing."""
    sha = hashlib.sha256()
    for layer in layers:
        for array in layer:
            sha.update(array.astype("<f4").tobytes())
    return sha.hexdigest()[:16]


def manifest_text(manifest: Mapping[str, Any]) -> str:
    """JSON with each list of numbers on one line, for some are as long as a layer is wide."""
    numbers = re.compile(r"\[([-+.\deE,\s]+)\]")
    text = json.dumps(manifest, indent=2)
    return numbers.sub(lambda match: f"[{' '.join(match[1].split())}]", text) + "\n"
