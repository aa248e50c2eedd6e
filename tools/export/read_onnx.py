"""Reads .onnx: a chain of Gemm, or MatMul and Add, with Relu between, and what folds into it."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from export.chain import RELU, Linear, Scale, Step, batch_norm, constant, why_not
from export.layers import ExportError
from export.limits import check_size

# ---- The file ----------------------------------------------------------------------------------


def load_onnx(path: Path) -> Any:
    """The model, with tensors that lie in files beside it."""
    import onnx

    model = onnx.load(path, load_external_data=False)
    helper = onnx.external_data_helper
    total = 0
    for tensor in tensors_of(model.graph):
        if helper.uses_external_data(tensor):
            total += external_size(tensor, path.parent)
            check_size(total, "the data beside the file")
            helper.load_external_data_for_tensor(tensor, str(path.parent))
            tensor.data_location = onnx.TensorProto.DEFAULT
    return model


def tensors_of(graph: Any) -> list[Any]:
    """Initializers, and the values of Constant nodes."""
    values = [item.t for node in graph.node for item in node.attribute if item.name == "value"]
    return [*graph.initializer, *values]


def external_size(tensor: Any, folder: Path) -> int:
    """How many bytes of another file a tensor takes, which must be as many as it needs."""
    import onnx

    where = {item.key: item.value for item in tensor.external_data}
    name = where.get("location", "")
    file = folder / name
    if not name or not file.resolve().is_relative_to(folder.resolve()):
        raise ExportError(f"{tensor.name} lies in another folder: {name or 'no file named'}")
    if not file.is_file():
        raise ExportError(f"{tensor.name} lies in {name}, which is missing: keep it beside")
    item = np.dtype(onnx.helper.tensor_dtype_to_np_dtype(tensor.data_type)).itemsize
    needed = math.prod(tensor.dims) * item
    start = int(where.get("offset", 0))
    length = int(where.get("length", file.stat().st_size - start))
    if length != needed or not 0 <= start <= file.stat().st_size - length:
        raise ExportError(f"{tensor.name} does not lie whole in {name}")
    return length


# ---- The chain ---------------------------------------------------------------------------------


def read_onnx(path: Path) -> list[Step]:
    """The chain from the only input; a Relu at the end may be left out."""
    import onnx

    graph = load_onnx(path).graph
    constants = {item.name: onnx.numpy_helper.to_array(item) for item in graph.initializer}
    inputs = [item.name for item in graph.input if item.name not in constants]
    if len(inputs) != 1:
        raise ExportError(f"the graph has {len(inputs)} inputs, not one")
    value, steps = inputs[0], list[Step]()
    for node in graph.node:
        attributes = {item.name: onnx.helper.get_attribute_value(item) for item in node.attribute}
        if node.op_type == "Constant" and "value" in attributes:
            constants[node.output[0]] = onnx.numpy_helper.to_array(attributes["value"])
        elif node.op_type == "Identity" and node.input[0] in constants:
            # PyTorch's exporter shares equal biases this way.
            constants[node.output[0]] = constants[node.input[0]]
        else:
            steps += onnx_steps(node, attributes, onnx_operands(node, value, constants), steps)
            value = node.output[0]
    if value not in [item.name for item in graph.output]:
        raise ExportError(f"the graph does not end with the chain's last value, {value}")
    return steps


COMMUTATIVE = ("Add", "Mul")
ARITHMETIC = (*COMMUTATIVE, "Sub", "Div")
ONNX_OPERATORS = (
    "Gemm", "MatMul", "Relu", "BatchNormalization", *ARITHMETIC, "Identity", "Dropout", "Flatten",
    "Reshape",
)  # fmt: skip


def onnx_operands(node: Any, value: str, constants: Mapping[str, np.ndarray]) -> list[np.ndarray]:
    """A node's constants; its other input must be the chain's value so far."""
    if node.op_type not in ONNX_OPERATORS or node.domain not in ("", "ai.onnx"):
        raise ExportError(f"unsupported ONNX operator {node.op_type}: {why_not(node.op_type)}")
    given = [name for name in node.input if name]  # an input left out has no name
    names = [name for name in given if name != value]
    follows = node.op_type in COMMUTATIVE or node.input[0] == value
    if len(names) != len(given) - 1 or not follows:
        raise ExportError(
            f"{node.op_type} of {node.output[0]} does not follow on {value}: "
            "layers must follow each other, without branches"
        )
    for name in names:
        if name not in constants:
            raise ExportError(f"{node.op_type} of {node.output[0]}: {name} is not a constant")
    return [constants[name] for name in names]


def onnx_steps(
    node: Any,
    attributes: Mapping[str, Any],
    operands: Sequence[np.ndarray],
    before: list[Step],
) -> list[Step]:
    """What a node does; an Add that brings a MatMul's bias changes the last step before it."""
    name = f"{node.op_type} of {node.output[0]}"
    if node.op_type == "Relu":
        return [RELU]
    if node.op_type in ("Gemm", "MatMul"):
        return [onnx_dense(node, attributes, operands)]
    if node.op_type == "BatchNormalization":
        if attributes.get("training_mode", 0):
            raise ExportError(f"{name} is in training: export the network in evaluation mode")
        if len(operands) != 4:
            raise ExportError(f"{name} has {len(operands)} constants, not 4")
        gamma, beta, mean, variance = operands
        epsilon = attributes.get("epsilon", 1e-5)
        return [batch_norm(gamma, beta, mean, variance, epsilon=epsilon, name=name)]
    if node.op_type in ARITHMETIC:
        return onnx_arithmetic(node.op_type, operands[0], before, name)
    check_onnx_idle(node.op_type, attributes, operands, before, name)
    return []


def onnx_arithmetic(kind: str, operand: np.ndarray, before: list[Step], name: str) -> list[Step]:
    """A Scale, or nothing where it is an Add that brings a bias."""
    last = before[-1] if before else None
    if kind == "Add" and isinstance(last, Linear) and last.bias is None:
        before[-1] = Linear(last.weight, operand.reshape(-1))
        return []
    return [scale_of(kind, constant(operand, name), name)]


def scale_of(kind: str, values: np.ndarray, name: str) -> Scale:
    """x + values, x - values, x * values or x / values."""
    one, zero = np.ones_like(values), np.zeros_like(values)
    if kind == "Div" and not values.all():
        raise ExportError(f"{name} divides by 0")
    scale = {"Mul": values, "Div": 1 / values} if kind in ("Mul", "Div") else {}
    shift = {"Add": values, "Sub": -values}
    return Scale(scale.get(kind, one), shift.get(kind, zero), name)


def check_onnx_idle(
    kind: str,
    attributes: Mapping[str, Any],
    operands: Sequence[np.ndarray],
    before: Sequence[Step],
    name: str,
) -> None:
    """Raises ExportError unless the node passes on what it gets, in a row for each person."""
    if kind == "Dropout" and len(operands) > 1 and np.any(operands[1]):
        raise ExportError(f"{name} is in training: export the network in evaluation mode")
    if kind == "Flatten" and attributes.get("axis", 1) != 1:
        raise ExportError(f"{name} has axis {attributes['axis']}, not 1")
    if kind == "Reshape":
        shape = operands[0].reshape(-1).tolist() if operands else []
        check_row(shape, before, name)


def check_row(shape: Sequence[int], before: Sequence[Step], name: str) -> None:
    """Raises ExportError unless a shape is of one row for each person."""
    layers = [step for step in before if isinstance(step, Linear)]
    width = layers[-1].weight.shape[-1] if layers else None
    row = len(shape) == 2 and shape[0] in (0, 1, -1) and shape[1] not in (0, 1)
    # Where no layer has come yet, the next one has to be of this width.
    if not row or (width is not None and shape[1] not in (-1, width)):
        raise ExportError(f"{name} is to {list(shape)}, not to a row for each person")


def onnx_dense(node: Any, attributes: Mapping[str, Any], operands: Sequence[np.ndarray]) -> Linear:
    """The layer of a Gemm or a MatMul; without a bias yet where an Add is to bring it."""
    plain = {"alpha": 1.0, "beta": 1.0, "transA": 0}
    for name, want in plain.items():
        if attributes.get(name, want) != want:
            raise ExportError(f"unsupported {name} {attributes[name]:g} in Gemm {node.output[0]}")
    weight = operands[0].T if attributes.get("transB", 0) else operands[0]
    bias = operands[1].reshape(-1) if len(operands) > 1 else None
    return Linear(weight, bias)
