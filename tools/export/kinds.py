"""The kinds of networks that C has kernels for; a new one is an entry and a file of its own."""

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from export import equivariant, fconv
from export.layers import Layer, check_layers
from export.quantise import DENSE, Plan
from export.readers import load_npz, read_file, read_layers, read_npz
from model import fconv_weights
from model.constants import PAIR_COUNT


def dense_text(layers: Iterable[Layer]) -> str:
    """The widths as text."""
    return "-".join(map(str, [PAIR_COUNT, *(len(layer.bias) for layer in layers)]))


def weight_count(layers: Iterable[Layer]) -> int:
    """Multiplications of fully connected layers."""
    return sum(layer.weight.size for layer in layers)


def fconv_text(layers: Sequence[Layer]) -> str:
    """The channels as text."""
    both = zip(fconv.NAMES, layers, strict=True)
    return ", ".join(f"{name} {len(layer.bias)}" for name, layer in both)


@dataclasses.dataclass(frozen=True)
class Kind:
    """What differs between kinds of networks; each has a list of layers."""

    name: str  # of its kernels, lib/network/NAME_FORM.c
    model: str  # name of its models, unless told otherwise
    work: str  # type of a lift's work memory; the fixed-point lift's ends in _q
    forms: tuple[str, ...]  # of weights, that it has a kernel for
    shape: Callable[[Sequence[Layer]], str]  # as a text
    multiply_adds: Callable[[Sequence[Layer]], int]
    plan: Plan
    # Its layers in float32, if the kernel can run them; else ExportError.
    checked: Callable[[Iterable[tuple[Any, Any]]], list[Layer]]
    # Weights [in, out] of layer k, their inputs as the kernel has them.
    order: Callable[[int, np.ndarray], np.ndarray] = lambda k, weight: weight
    # The exponent of a unit in which weights are short texts, or None.
    unit: Callable[[np.ndarray], int | None] = lambda weight: None


FCONN = Kind(
    "fconn", "fconn", "edml_work", ("f32", "w16", "w8"), dense_text, weight_count, DENSE,
    check_layers,
)  # fmt: skip
EQUIVARIANT = Kind(
    "equivariant", "fconn", "edml_work", FCONN.forms, equivariant.shape, weight_count,
    equivariant.PLAN, equivariant.checked,
)  # fmt: skip
FCONV = Kind(
    "fconv", "fconv", "edml_fconv_work", ("f32", "w8"), fconv_text, fconv.multiply_adds, fconv.PLAN,
    list, fconv.as_c_has_it, fconv_weights.unit_of,
)  # fmt: skip


def read_network(path: Path) -> tuple[Kind, list[Layer]]:
    """The layers in a file of weights, and what kind of network they make."""
    if path.suffix.lower() == ".npz":
        arrays = read_file(path, {".npz": load_npz})
        if fconv.is_fconv(arrays):
            return FCONV, fconv.layers_of(arrays)
        if equivariant.is_equivariant(arrays):
            return EQUIVARIANT, equivariant.checked(read_npz(path))
    return FCONN, read_layers(path)
