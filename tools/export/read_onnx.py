"""Reads .onnx: a chain of Gemm, or MatMul and Add, with Relu between."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from export.layers import ExportError, Layer, check_order


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
