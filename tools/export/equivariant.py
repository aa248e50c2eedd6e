"""The equivariant networks, as their weights are kept and as lib/network/equivariant.h has them.

An .npz with weight0 [inputs, units], bias0 [units], weight1 [2 units, ...] ...: in each weight the
even inputs come first, then the odd ones (model/layout.py).  The last layer, which has no ReLU,
gives rows, and for each its mirror row.
"""

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from export.layers import ExportError, Layer, check_layers
from export.quantise import ACTIVATION, Activate, Plan
from model.constants import GROUP, INPUT_SHIFT
from model.layout import KINDS, ROWS, Layout, layout

SPARE = 1  # bits of an activation that are left to sums of two
HEADROOM = 1.5  # at 1.25 one made-up person of 200 is clamped, and 9 mm off
LARGEST_INPUT = 1 << 27 - INPUT_SHIFT  # +-8

# ---- Layers ------------------------------------------------------------------------------------


def kind_of(arrays: Mapping[str, np.ndarray]) -> str | None:
    """Which of KINDS arrays are meant to be, by the rows of the last layer or the inputs."""
    weights = sorted((name for name in arrays if name.startswith("weight")), key=len_and_name)
    shapes = [np.shape(arrays[name]) for name in weights]
    for kind in KINDS:
        known = layout(kind)
        if shapes and shapes[-1][1:] == (len(known.has_even),):
            return kind
        if shapes and shapes[0][:1] == (known.even + known.odd,):
            return kind
    return None


def len_and_name(name: str) -> tuple[int, str]:
    """Sort key by which weight2 precedes weight10."""
    return len(name), name


def even_inputs(first: int, k: int, weight: np.ndarray) -> int:
    """How many of the inputs of layer k, weights [in, out], are even; first: of the network's."""
    return first if k == 0 else len(weight) // 2


def parts(first: int, k: int, weight: np.ndarray) -> tuple[int, int]:
    """How many of the inputs of layer k are even and odd."""
    even = even_inputs(first, k, weight)
    return even, len(weight) - even


def checker(known: Layout) -> Callable[[Iterable[tuple[Any, Any]]], list[Layer]]:
    """A function that returns layers in float32, if the C kernel can run them; else ExportError."""

    def checked(layers: Iterable[tuple[Any, Any]]) -> list[Layer]:
        layers = check_layers(layers, known.even + known.odd, len(known.has_even), units=2)
        for k, layer in enumerate(layers[:-1]):
            if len(layer.bias) % GROUP:
                raise ExportError(
                    f"layer {k}: {len(layer.bias)} outputs, not a multiple of {GROUP}"
                )
        weight, bias = layers[-1]
        even = even_inputs(known.even, len(layers) - 1, layers[-1].weight)
        parts = {
            "even weight": (weight[:even], known.has_even),
            "odd weight": (weight[even:], known.has_odd),
            "bias": (bias[None], known.has_even),
        }
        for name, (values, allowed) in parts.items():
            for row in np.flatnonzero(values.any(0) & ~allowed):
                raise ExportError(f"output row {row}, its own mirror image, has an {name}")
        return layers

    return checked


def shape(known: Layout, layers: Sequence[Layer]) -> str:
    """The widths as text."""
    widths = [2 * len(layer.bias) for layer in layers[:-1]]
    outputs = int(known.has_even.sum() + known.has_odd.sum())
    text = "-".join(map(str, [known.even + known.odd, *widths, outputs]))
    return f"{text}, equivariant to left and right"


# ---- The network, for quantising ---------------------------------------------------------------


def forward(
    first: int, layers: Sequence[Any], inputs: np.ndarray, activate: Activate
) -> list[np.ndarray]:
    """quantise.Plan.forward: inputs are even, then odd; the outputs are rows, then mirror rows."""
    values = [inputs]
    for k, layer in enumerate(layers):
        x, even = values[-1], even_inputs(first, k, layer.weight)
        weight = layer.weight.astype(float)
        alike = x[:, :even] @ weight[:even] + layer.bias
        unlike = x[:, even:] @ weight[even:]
        both = activate(k, alike + unlike), activate(k, alike - unlike)
        last = k == len(layers) - 1
        values.append(np.concatenate(both if last else (both[0] + both[1], both[0] - both[1]), 1))
    return values


def largest(inputs: np.ndarray) -> float:
    """The largest activation of which even and odd inputs [F,2 units] were made."""
    even, odd = np.split(inputs, 2, axis=1)
    return float((even + np.abs(odd)).max() / 2)


def mean(first: int, k: int, inputs: np.ndarray) -> np.ndarray:
    """Of inputs [F,in] of layer k and of their mirror images, in which the odd ones are minus
    themselves."""
    even = first if k == 0 else inputs.shape[1] // 2
    return inputs.mean(0) * (np.arange(inputs.shape[1]) < even)


def ranges(first: int, k: int, layer: Any) -> tuple[np.ndarray, np.ndarray]:
    """What the inputs of layer k are within, and minus the odd ones: integers."""
    count = layer.weight.shape[0]
    if k == 0:
        return np.full(count, -LARGEST_INPUT), np.full(count, LARGEST_INPUT)
    most = ACTIVATION >> SPARE
    odd = np.arange(count) >= even_inputs(first, k, layer.weight)
    return np.where(odd, -most, 0), np.where(odd, most, 2 * most)


def in_metres(known: Layout) -> np.ndarray:
    """Which of the rows and the mirror rows are numbers in metres: all but the gates, which come
    last, and the mirror rows that say the same as the row."""
    count = len(known.has_even)
    metres = np.arange(count) < count - ROWS
    return np.flatnonzero(np.concatenate([metres, metres & known.has_even & known.has_odd]))


def plan_of(known: Layout) -> Plan:
    """What quantising must know of a network."""
    return Plan(
        functools.partial(forward, known.even),
        largest=largest,
        mean=functools.partial(mean, known.even),
        ranges=functools.partial(ranges, known.even),
        headroom=HEADROOM,
        spare=SPARE,
        signed=True,
        measured=in_metres(known),
    )
