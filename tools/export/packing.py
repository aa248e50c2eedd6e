"""Layers as flash holds them, and their checksum."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from export.layers import Layer
from export.quantise import Dense
from model.constants import GROUP


class Packed(NamedTuple):
    """A layer as lib/network/layers.h lays it out; outputs are filled up to full groups."""

    inputs: int
    outputs: int
    arrays: dict[str, np.ndarray]  # weight [groups,inputs,GROUP]; bias, multiplier [groups*GROUP]
    numbers: tuple[int, ...] = ()  # what follows the arrays


def groups_of(outputs: int) -> int:
    """How many groups of rows hold the outputs."""
    return -(-outputs // GROUP)


def pack(layer: Layer | Dense, weight: np.ndarray) -> Packed:
    """The layer with its weights [in, out] in the kernel's order."""
    inputs, outputs = weight.shape
    padding = groups_of(outputs) * GROUP - outputs
    weight = np.pad(weight, ((0, 0), (0, padding)))
    weight = np.ascontiguousarray(weight.reshape(inputs, -1, GROUP).transpose(1, 0, 2))
    arrays = {"weight": weight, "bias": np.pad(layer.bias, (0, padding))}
    if isinstance(layer, Layer):
        return Packed(inputs, outputs, arrays)
    arrays["multiplier"] = np.pad(layer.multiplier, (0, padding), constant_values=1)
    return Packed(inputs, outputs, arrays, (layer.shift, layer.clamp))


def fnv1a(packed: Iterable[Packed]) -> int:
    """FNV-1a over the bytes of each layer's arrays, little-endian."""
    value = 2166136261
    for layer in packed:
        for array in layer.arrays.values():
            for byte in array.astype(array.dtype.newbyteorder("<")).tobytes():
                value = (value ^ byte) * 16777619 & 0xFFFFFFFF
    return value
