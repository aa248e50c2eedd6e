"""Turns trained weights into a C header for gen/: one model, constant data in flash.

    export_weights.py gen/fconn.npz
    export_weights.py theirs.onnx --manifest theirs.json --name theirs --out gen/theirs_f32.h

Reads .npz (train.py's), .safetensors, .onnx, .pt and .pth (PyTorch), .mat (MatConvNet).  Each
format is a function path -> layers in READERS; what follows is common to all.  What a model
needs beside its layers comes from the manifest, the JSON file beside the weights.  The same
layers and settings give the same header, whatever file they came from.
"""

import argparse
import contextlib
import dataclasses
import hashlib
import json
import os
import re
import sys
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

# What lib/model.h fixes; the header refuses to compile with another format.
FORMAT = 2
PAIRS = 91  # EDML_PAIRS
ROWS = 8  # EDML_ROWS
WIDEST = 128  # EDML_LAYER_WIDEST

GEN = Path(__file__).resolve().parent.parent / "gen"
OBJECTIVES = ("none", "square", "raw", "eq2")  # edml_objective: EDML_STRESS_NONE ...


class ExportError(Exception):
    """What is wrong with the weights or the manifest, in one line."""


class Layer(NamedTuple):
    """y = relu(x @ weight + bias)."""

    weight: np.ndarray  # float32 [in, out]
    bias: np.ndarray  # float32 [out]


# ---- Settings ----------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class Settings:
    """What belongs to a model beside its layers.  Raises ExportError where a value cannot be."""

    fewest_joints: int  # seen joints below which edml_lift refuses
    widest: float  # largest normalised 2D distance in training
    objective: str  # of the refinement, one of OBJECTIVES
    refine_steps: int
    mirror: Sequence[float]  # weights of arms, forearms, head, thighs, shins
    recipe: Mapping[str, Any] = dataclasses.field(default_factory=dict)  # at least name and seed
    data: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    metrics: Mapping[str, float] = dataclasses.field(default_factory=dict)  # column -> mm

    def __post_init__(self) -> None:
        # Four joints are what turning a pose to the camera takes; the others are uint8_t.
        check_setting("fewest_joints", is_whole(self.fewest_joints, 4, 14), "4 to 14")
        check_setting("widest", is_real(self.widest) and np.float32(self.widest) > 0, "over 0")
        check_setting("objective", self.objective in OBJECTIVES, f"one of {', '.join(OBJECTIVES)}")
        check_setting("refine_steps", is_whole(self.refine_steps, 0, 255), "0 to 255")
        mirror = isinstance(self.mirror, list | tuple) and len(self.mirror) == 5
        check_setting("mirror", mirror and all(map(is_real, self.mirror)), "five numbers")
        for name in ("recipe", "data", "metrics"):
            check_setting(name, isinstance(getattr(self, name), Mapping), "an object")
        check_setting("metrics", all(map(is_real, self.metrics.values())), "numbers by column")


REQUIRED = tuple(
    field.name
    for field in dataclasses.fields(Settings)
    if field.default_factory is dataclasses.MISSING
)


def check_setting(name: str, good: bool, want: str) -> None:
    if not good:
        raise ExportError(f"manifest: {name} must be {want}")


def is_whole(value: object, low: int, high: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def is_real(value: object) -> bool:
    """A number that a float can hold."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and abs(value) <= float(np.finfo(np.float32).max)


def read_settings(path: Path) -> Settings:
    """The settings in a manifest; keys that Settings does not know are left to others."""
    try:
        manifest = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        keys = ", ".join(REQUIRED)
        raise ExportError(
            f"no manifest {path.name}: write one with {keys}, or name another by --manifest"
        ) from None
    except (OSError, ValueError) as error:
        raise ExportError(f"manifest {path.name}: {one_line(error)}") from error
    if not isinstance(manifest, dict):
        raise ExportError(f"manifest {path.name} is not a JSON object")
    if missing := [name for name in REQUIRED if name not in manifest]:
        raise ExportError(f"manifest {path.name} lacks {', '.join(missing)}")
    known = {field.name for field in dataclasses.fields(Settings)}
    return Settings(**{name: value for name, value in manifest.items() if name in known})


# ---- Readers: path -> layers -------------------------------------------------------------------


def read_npz(path: Path) -> list[Layer]:
    """The project's own: weight0 [in, out], bias0 [out], weight1 ..."""
    if not zipfile.is_zipfile(path):  # np.load would take it for a pickle
        raise ExportError("not a readable .npz file: no zip archive")
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    tensors = {}
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
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise ExportError(f"unknown suffix '{path.suffix}': one of {', '.join(READERS)}")
    if not path.is_file():
        raise ExportError("no such file")
    if path.stat().st_size == 0:
        raise ExportError("the file is empty")
    try:
        layers = reader(path)
    except ExportError:
        raise
    except Exception as error:  # a damaged file makes the libraries raise whatever they like
        raise ExportError(f"not a readable {path.suffix} file: {one_line(error)}") from error
    return check_layers(layers)


def one_line(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


# ---- Checks ------------------------------------------------------------------------------------


def check_layers(layers: Iterable[tuple[Any, Any]]) -> list[Layer]:
    """The layers in float32, if the C kernels can run them; else ExportError."""
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
        if groups_of(outputs) * ROWS > WIDEST:
            raise ExportError(f"layer {k} is {outputs} wide, at most {WIDEST} fit")
        width = outputs
    if width != PAIRS:
        raise ExportError(f"the last layer gives {width} values, not {PAIRS}")
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


# ---- What flash holds --------------------------------------------------------------------------


class Packed(NamedTuple):
    """A layer as lib/model.h lays it out; outputs are padded with zeros to whole groups."""

    inputs: int
    outputs: int
    weight: np.ndarray  # [groups, inputs, ROWS]
    bias: np.ndarray  # [groups * ROWS]


def groups_of(outputs: int) -> int:
    return -(-outputs // ROWS)


def pack(layer: Layer) -> Packed:
    inputs, outputs = layer.weight.shape
    padding = groups_of(outputs) * ROWS - outputs
    weight = np.pad(layer.weight, ((0, 0), (0, padding)))
    weight = np.ascontiguousarray(weight.reshape(inputs, -1, ROWS).transpose(1, 0, 2))
    return Packed(inputs, outputs, weight, np.pad(layer.bias, (0, padding)))


def fnv1a(packed: Iterable[Packed]) -> int:
    """FNV-1a over the bytes of each layer's weights, then biases, little-endian."""
    value = 2166136261
    for layer in packed:
        for array in (layer.weight, layer.bias):
            for byte in array.astype("<f4").tobytes():
                value = (value ^ byte) * 16777619 & 0xFFFFFFFF
    return value


def digest(layers: Iterable[Layer]) -> str:
    """What tells a set of weights from another, whatever the file and the packing."""
    sha = hashlib.sha256()
    for layer in layers:
        for array in layer:
            sha.update(array.astype("<f4").tobytes())
    return sha.hexdigest()[:16]


# ---- The header --------------------------------------------------------------------------------


def write_header(
    layers: Iterable[tuple[Any, Any]],
    settings: Settings,
    name: str,
    source_name: str,
    path: Path,
) -> str:
    """Writes the header of model edml_NAME_f32 and returns a line that sums it up.

    layers       (weight [in, out], bias [out]), floating point
    source_name  the file that the layers came from
    Raises ExportError, and then leaves what was at `path` as it was.
    """
    layers = check_layers(layers)
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise ExportError(f"name '{name}' must be lower-case letters, digits, single underscores")
    model = f"{name}_f32"
    packed = [pack(layer) for layer in layers]
    checksum = fnv1a(packed)
    parts = [
        comment_text(layers, settings, model, source_name, "none (float32)"),
        GUARD,
        *(layer_text(layer, model, k) for k, layer in enumerate(packed)),
        table_text(packed, model),
        model_text(settings, model, checksum, len(packed)),
    ]
    replace_file(path, "\n".join(parts))
    flash = sum(array.nbytes for layer in packed for array in (layer.weight, layer.bias))
    return (
        f"edml_{model}: {shape_text(layers)}, {parameter_count(layers)} parameters, "
        f"{flash} bytes of flash, checksum 0x{checksum:08x}: {path}"
    )


GUARD = f"""\
#if EDML_WEIGHTS_FORMAT != {FORMAT}
#error "regenerate with tools/export_weights.py"
#endif
"""


def comment_text(
    layers: Sequence[Layer], settings: Settings, model: str, source_name: str, quantiser: str
) -> str:
    """What opens the header.  No date, no path: the same weights give the same text."""
    multiply_adds = sum(layer.weight.size for layer in layers)
    recipe = settings.recipe
    errors = ", ".join(f"{column} {error:g}" for column, error in settings.metrics.items())
    lines = {
        "layers": f"{shape_text(layers)}, relu after each",
        "weights": f"sha256 {digest(layers)}",
        "parameters": f"{parameter_count(layers)}, {multiply_adds} multiply-adds",
        "quantiser": quantiser,
        "error, mm": errors or "not measured",
        "training": f"recipe {recipe.get('name', '?')}, seed {recipe.get('seed', '?')}",
    }
    table = "".join(f" * {title:<12}{in_comment(text)}\n" for title, text in lines.items())
    return (
        f"/* edml_{model}: a trained network.  Do not edit.\n"
        f" * Generated by tools/export_weights.py from {in_comment(source_name)}\n"
        f" *\n{table} */\n"
    )


def in_comment(text: str) -> str:
    """Text from outside as one line that can neither end nor open a comment."""
    text = text.encode("ascii", "replace").decode()
    text = "".join(c if c.isprintable() else "?" for c in text)
    return text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")


def shape_text(layers: Iterable[Layer]) -> str:
    return "-".join(map(str, [PAIRS, *(len(layer.bias) for layer in layers)]))


def parameter_count(layers: Iterable[Layer]) -> int:
    return sum(array.size for layer in layers for array in layer)


def layer_text(layer: Packed, model: str, number: int) -> str:
    """The two arrays of a layer, weights first."""
    groups = len(layer.weight)
    weight_size = f"{groups} * {layer.inputs} * {ROWS}"
    return array_text(f"{model}_weight{number}", weight_size, layer.weight) + array_text(
        f"{model}_bias{number}", f"{groups} * {ROWS}", layer.bias
    )


def array_text(name: str, size: str, values: np.ndarray) -> str:
    """ROWS values a line: of weights, those of one input."""
    lines = (", ".join(map(hex_float, row)) for row in values.reshape(-1, ROWS).tolist())
    body = "".join(f"    {line},\n" for line in lines)
    return f"static const float {name}[{size}] = {{\n{body}}};\n"


def hex_float(value: float) -> str:
    """A float32 as the shortest exact C99 constant: 0x1.8p-3F; zero as 0."""
    if value == 0:
        # The checksum tells negative zero from zero.
        return "-0x0p0F" if np.signbit(value) else "0"
    mantissa, exponent = float(value).hex().split("p")
    return f"{mantissa.rstrip('0').rstrip('.')}p{int(exponent)}F"


def table_text(packed: Sequence[Packed], model: str) -> str:
    rows = "".join(
        f"    {{{layer.inputs}, {layer.outputs}, {model}_weight{k}, {model}_bias{k}}},\n"
        for k, layer in enumerate(packed)
    )
    return f"static const edml_dense_f32 {model}_layers[] = {{\n{rows}}};\n"


def model_text(settings: Settings, model: str, checksum: int, count: int) -> str:
    """The model itself.  By position, for C++ has no designated initialisers before 2020; and
    declared first, for C++ would keep a constant to its file."""
    mirror = ", ".join(map(number_text, settings.mirror))
    return f"""\
extern const edml_model edml_{model};
const edml_model edml_{model} = {{
    "{model}",
    0x{checksum:08x}u, /* checksum */
    edml__fconn_f32,
    NULL, /* not quantised */
    edml__fconn_hash_f32,
    {model}_layers,
    {count}, /* layers */
    {settings.fewest_joints}, /* fewest joints */
    {number_text(settings.widest)}, /* widest: {settings.widest:g} */
    EDML_STRESS_{settings.objective.upper()},
    {settings.refine_steps}, /* refinement steps */
    {{{mirror}}}, /* mirror */
}};
"""


def number_text(value: float) -> str:
    """An edml_number: in float32 and in Q24, in whose range the value must be."""
    return f"{{{hex_float(float(np.float32(value)))}, {round(value * (1 << 24))}}}"


def replace_file(path: Path, text: str) -> None:
    """Writes the file whole or not at all."""
    scratch = path.with_name(path.name + ".tmp")
    try:
        scratch.write_text(text, "ascii", newline="\n")
        os.replace(scratch, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            scratch.unlink()
        raise ExportError(f"cannot write {path}: {error.strerror}") from error


# ---- Command line ------------------------------------------------------------------------------


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit status 0, or 1 with one line on stderr."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("weights", type=Path, help=" ".join(READERS))
    parser.add_argument("--name", default="fconn", help="the model is edml_NAME_f32 (%(default)s)")
    parser.add_argument("--out", type=Path, help="header to write (gen/NAME_f32.h)")
    parser.add_argument("--manifest", type=Path, help="settings (WEIGHTS with suffix .json)")
    options = parser.parse_args(arguments)
    weights, name = options.weights, options.name
    try:
        layers = read_layers(weights)
        settings = read_settings(options.manifest or weights.with_suffix(".json"))
        out = options.out or GEN / f"{name}_f32.h"
        print(write_header(layers, settings, name, weights.name, out))
    except ExportError as error:
        print(f"export_weights: {weights}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
