"""Layers as flash holds them, and their checksum."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from export.layers import Layer
from export.quantise import Dense
from model.constants import CHUNK, GROUP


class Packed(NamedTuple):
    """A layer as lib/network/layers.h lays it out; outputs are filled up to full groups."""

    inputs: int  # in blocks filled up
    outputs: int
    arrays: dict[str, np.ndarray]  # weight [groups,inputs,GROUP]; bias, multiplier [groups*GROUP]
    numbers: tuple[int, ...] = ()  # what follows the arrays
    in_blocks: bool = False  # of GROUP rows and CHUNK inputs


def groups_of(outputs: int) -> int:
    """How many groups of rows hold the outputs."""
    return -(-outputs // GROUP)


def pack(layer: Layer | Dense, weight: np.ndarray, parts: Sequence[int] | None = None) -> Packed:
    """The layer with its weights [in, out] in the kernel's order.

    parts  how many inputs there are of each kind, where integers come in blocks
    """
    if in_blocks := parts is not None and isinstance(layer, Dense):
        weight = filled_up(weight, parts)
    inputs, outputs = weight.shape
    padding = groups_of(outputs) * GROUP - outputs
    weight = np.pad(weight, ((0, 0), (0, padding)))
    packed = weight.reshape(inputs, -1, GROUP).transpose(1, 0, 2)
    arrays = {"weight": np.ascontiguousarray(packed), "bias": np.pad(layer.bias, (0, padding))}
    if isinstance(layer, Layer):
        return Packed(inputs, outputs, arrays)
    arrays["multiplier"] = np.pad(layer.multiplier, (0, padding), constant_values=1)
    return Packed(inputs, outputs, arrays, (layer.shift, layer.clamp), in_blocks)


def filled_up(weight: np.ndarray, parts: Sequence[int]) -> np.ndarray:
    """Weights [in, out] whose inputs of each kind are filled up to whole chunks with zeros."""
    kinds = np.split(weight, np.cumsum(parts)[:-1])
    return np.concatenate([np.pad(kind, ((0, -len(kind) % CHUNK), (0, 0))) for kind in kinds])


def fnv1a(packed: Iterable[Packed]) -> int:
    """FNV-1a over the bytes of each layer's arrays, little-endian."""
    value = 2166136261
    for layer in packed:
        for array in layer.arrays.values():
            for byte in array.astype(array.dtype.newbyteorder("<")).tobytes():
                value = (value ^ byte) * 16777619 & 0xFFFFFFFF
    return value
