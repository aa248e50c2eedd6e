"""The kinds of networks that C has kernels for; a new one is an entry and a file of its own."""

import dataclasses
import functools
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
from model.layout import layout


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

    model: str  # name of its models, unless told otherwise
    name: str  # of its kernels, lib/network/NAME_FORM.c
    shape: Callable[[Sequence[Layer]], str]  # as a text
    plan: Plan
    # Its layers in float32, if the kernel can run them; else ExportError.
    checked: Callable[[Iterable[tuple[Any, Any]]], list[Layer]]
    work: str = "edml_work"  # type of a lift's work memory; the fixed-point lift's ends in _q
    forms: tuple[str, ...] = ("f32", "w16", "w8")  # of weights, that it has a kernel for
    multiply_adds: Callable[[Sequence[Layer]], int] = weight_count
    reads: tuple[str, ...] = ("DISTANCES",)  # EDML_READS_...
    gives: tuple[str, ...] = ("DISTANCES",)  # EDML_GIVES_...
    inputs: int = PAIR_COUNT
    even_inputs: int = 0
    outputs: int = PAIR_COUNT  # of an equivariant network: rows
    # Settings that its manifests must have; the others have a default.
    needs: tuple[str, ...] = ("fewest_joints", "objective", "refine_steps", "mirror")
    # Weights [in, out] of layer k, their inputs as the kernel has them.
    order: Callable[[int, np.ndarray], np.ndarray] = lambda k, weight: weight
    # How many of the inputs of layer k are of each kind, where its integers come in blocks.
    parts: Callable[[int, np.ndarray], Sequence[int]] | None = None
    # The exponent of a unit in which weights are short texts, or None.
    unit: Callable[[np.ndarray], int | None] = lambda weight: None

    @property
    def alone(self) -> bool:
        """Does it give distances and nothing else?"""
        return tuple(self.gives) == ("DISTANCES",)

    @property
    def scale(self) -> str:
        """The function of lift/scale.h that makes points of its distances, "" if it gives none."""
        if self.alone:
            return "edml__scale_and_orient"
        return "edml__scale_and_align" if "DISTANCES" in self.gives else ""

    @property
    def of_body(self) -> bool:
        """Does it read the body's coordinates (model/lifter.py), or distances alone?"""
        return "BODY" in self.reads


def equivariant_kind(model: str, reads: Sequence[str], gives: Sequence[str], *needs: str) -> Kind:
    """A kind of network of model/lifter.py."""
    known = layout(model)
    return Kind(
        model,
        "equivariant",
        shape=functools.partial(equivariant.shape, known),
        plan=equivariant.plan_of(known),
        checked=equivariant.checker(known),
        reads=(*reads,),
        gives=(*gives, "GATES"),
        inputs=known.even + known.odd,
        even_inputs=known.even,
        outputs=len(known.has_even),
        needs=("fewest_joints", "fusion", *needs),
        parts=functools.partial(equivariant.parts, known.even),
    )


DISTANCES = equivariant_kind(
    "distances", ["BODY", "DISTANCES"], ["DISTANCES", "POINTS"], "mds_share"
)
DIRECT = equivariant_kind("direct", ["BODY"], ["POINTS"])
FCONN = Kind(
    "fconn", "fconn", dense_text, DENSE, check_layers, parts=lambda k, weight: [len(weight)]
)
FCONV = Kind(
    "fconv",
    "fconv",
    fconv_text,
    fconv.PLAN,
    list,
    work="edml_fconv_work",
    forms=("f32", "w8"),
    multiply_adds=fconv.multiply_adds,
    order=fconv.as_c_has_it,
    parts=lambda k, weight: [len(weight)],
    unit=fconv_weights.unit_of,
)
EQUIVARIANT = {kind.model: kind for kind in (DISTANCES, DIRECT)}


def read_network(path: Path) -> tuple[Kind, list[Layer]]:
    """The layers in a file of weights, and what kind of network they make."""
    if path.suffix.lower() == ".npz":
        arrays = read_file(path, {".npz": load_npz})
        if fconv.is_fconv(arrays):
            return FCONV, fconv.layers_of(arrays)
        if model := equivariant.kind_of(arrays):
            kind = EQUIVARIANT[model]
            return kind, kind.checked(read_file(path, {".npz": read_npz}))
    return FCONN, read_layers(path)
