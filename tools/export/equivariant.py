"""FConn with left and right alike, as its weights are kept and as lib/twin.inc computes it.

An .npz with weight0 [91, units], bias0 [units], weight1 [2 units, ...] ...: of each weight the
even inputs come first, then the odd ones, as in tools/twin.py; the last layer has 49 outputs, of
which twins are made.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from edmlift.joints import PAIR_TWINS, SELF_TWINS
from export.quantise import ACTIVATION, Activate, Plan, edm_value
from export.weights import TWINS, ExportError, Layer, check_layers

ROWS = 8  # EDML_ROWS


def is_twin(arrays: Mapping[str, np.ndarray]) -> bool:
    """Is it this kind of network, and not the paper's FConn with 91 outputs?"""
    return any(name.startswith("bias") and np.shape(x) == (TWINS,) for name, x in arrays.items())


def even_inputs(k: int, layer: Any) -> int:
    """How many of the inputs of layer k are even."""
    return TWINS if k == 0 else layer.weight.shape[0] // 2


def checked(layers: Iterable[tuple[Any, Any]]) -> list[Layer]:
    """The layers in float32, if the C kernel can run them; else ExportError."""
    layers = check_layers(layers, twins=True)
    for k, layer in enumerate(layers[:-1]):
        if len(layer.bias) % ROWS:
            raise ExportError(f"layer {k}: {len(layer.bias)} twins, not a multiple of {ROWS}")
    last = layers[-1].weight
    if last[even_inputs(len(layers) - 1, layers[-1]) :, -SELF_TWINS:].any():
        raise ExportError(f"the last {SELF_TWINS} outputs, their own twins, have odd weights")
    return layers


def shape(layers: Sequence[Layer]) -> str:
    widths = [2 * len(layer.bias) for layer in layers[:-1]]
    return "-".join(map(str, [91, *widths, 91])) + ", left and right alike"


def multiply_adds(layers: Sequence[Layer]) -> int:
    return sum(layer.weight.size for layer in layers)


def even_and_odd(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Sums and differences of twins, side by side: [F,2 units]."""
    return np.concatenate([first + second, first - second], 1)


def forward(layers: Sequence[Any], edms: np.ndarray, activate: Activate) -> list[np.ndarray]:
    """quantise.Plan.forward."""
    inputs = even_and_odd(edms[:, PAIR_TWINS[:, 0]], edms[:, PAIR_TWINS[:, 1]])[:, :-SELF_TWINS]
    values = [inputs]
    for k, layer in enumerate(layers):
        even, weight = even_inputs(k, layer), layer.weight.astype(float)
        alike = inputs[:, :even] @ weight[:even] + layer.bias
        unlike = inputs[:, even:] @ weight[even:]
        first, second = activate(k, alike + unlike), activate(k, alike - unlike)
        inputs = even_and_odd(first, second)
        values.append(inputs)
    distances = np.empty(edms.shape, first.dtype)
    distances[:, PAIR_TWINS[:, 0]], distances[:, PAIR_TWINS[:, 1]] = first, second
    return [*values[:-1], distances]


def largest(inputs: np.ndarray) -> float:
    """The largest activation of which even and odd inputs [F,2 units] were made."""
    even, odd = np.split(inputs, 2, axis=1)
    return float((even + np.abs(odd)).max() / 2)


def ranges(k: int, layer: Any) -> tuple[np.ndarray, np.ndarray]:
    """What the inputs of layer k are within, sums and differences of two in whole numbers."""
    least, most = (-MIDDLE, LARGEST - MIDDLE) if k == 0 else (0, ACTIVATION >> SPARE)
    odd = np.arange(layer.weight.shape[0]) >= even_inputs(k, layer)
    return np.where(odd, least - most, 2 * least), np.where(odd, most - least, 2 * most)


def centre(k: int, layer: Any) -> np.ndarray:
    """What is taken from the inputs of layer k, in whole numbers: from even ones of the first."""
    even = np.arange(layer.weight.shape[0]) < even_inputs(k, layer)
    return 2 * MIDDLE * (even & (k == 0))


SPARE = 1  # bits of an activation that are left to sums of two
SOFT = 2458  # twin.SOFT in Q12
MIDDLE = 14336  # EDML_MIDDLE
LARGEST = 30481  # that the first layer can read, before MIDDLE is taken from it


def soften(edms: np.ndarray) -> np.ndarray:
    """What the first layer reads of EDMs [F,91]."""
    return edms**2 / (edms + SOFT / 4096)


def soften_whole(edms: np.ndarray) -> np.ndarray:
    """The same of EDMs in Q24, in Q12: first_input() of lib/twin_int.h."""
    distance = edm_value(edms)  # Q12
    sums = distance + SOFT
    return (distance**2 + sums // 2) // sums - MIDDLE


PLAN = Plan(
    forward, soften, soften_whole, largest=largest, ranges=ranges, centre=centre, spare=SPARE
)
