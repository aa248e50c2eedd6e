"""Layers of a network, as a file has them and as the C kernels can run them."""

import hashlib
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from edmlift.messages import OneLineError
from model.constants import MAX_UNITS, PAIR_COUNT


class ExportError(OneLineError):
    """What is wrong with the weights or the manifest, in one line."""


class Layer(NamedTuple):
    """y = relu(x @ weight + bias); the kind of network may have no ReLU behind the last one."""

    weight: np.ndarray  # float32 [in, out]
    bias: np.ndarray  # float32 [out]


def check_layers(
    layers: Iterable[tuple[Any, Any]],
    first: int = PAIR_COUNT,
    last: int = PAIR_COUNT,
    units: int = 1,
) -> list[Layer]:
    """The layers in float32, if the C kernels can run them; else ExportError.

    first, last  inputs of the first layer, outputs of the last one
    units        how many an output of the others is: 2 in an equivariant network
    """
    checked = [
        Layer(
            to_float32(weight, f"layer {k}: weight", 2),
            to_float32(bias, f"layer {k}: bias", 1) + np.float32(0),  # which makes 0 of -0
        )
        for k, (weight, bias) in enumerate(layers)
    ]
    if not checked:
        raise ExportError("holds no layers")
    width = first
    for k, (weight, bias) in enumerate(checked):
        inputs, outputs = weight.shape
        if inputs != width:
            before = "the image gives" if k == 0 else f"layer {k - 1} gives"
            raise ExportError(f"layer {k} takes {inputs} values, {before} {width}")
        if len(bias) != outputs:
            raise ExportError(f"layer {k} has {outputs} outputs, but {len(bias)} biases")
        width = units * outputs
        if width > MAX_UNITS:
            raise ExportError(f"layer {k} is {width} wide, at most {MAX_UNITS} fit")
    if outputs != last:
        raise ExportError(f"the last layer gives {outputs} values, not {last}")
    return checked


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


def check_order(order: Sequence[str]) -> None:
    """Refuses all but dense, relu, dense, relu ...; behind the last layer the relu may be missing,
    because the C kernel applies it and a distance is not negative."""
    if list(order) != (["dense", "relu"] * len(order))[: len(order)]:
        raise ExportError(f"want one relu between layers, not {', '.join(order)}")
