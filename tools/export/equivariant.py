"""The equivariant FConn, as its weights are kept and as lib/network/equivariant.h computes it.

An .npz with weight0 [91, units], bias0 [units], weight1 [2 units, ...] ...: in each weight the even
inputs come first, then the odd ones, as in model/equivariant.py; the last layer has 49 outputs, one
for both of a mirror pair.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from edmlift.joints import PAIR_MIRROR, SELF_MIRRORED
from export.layers import ExportError, Layer, check_layers
from export.quantise import ACTIVATION, Activate, Plan, edm_value
from model.constants import EDM_SHIFT, GROUP, INPUT_ZERO_POINT, PAIR_COUNT, Q12, SOFTENING

OUTPUTS = len(PAIR_MIRROR)  # 49, of the last layer
SPARE = 1  # bits of an activation that are left to sums of two
LARGEST_EDM = 8 * Q12 - 1  # what edml's Q12 holds of a distance


def is_equivariant(arrays: Mapping[str, np.ndarray]) -> bool:
    """Is it this kind of network, and not the paper's FConn with 91 outputs?"""
    return any(name.startswith("bias") and np.shape(x) == (OUTPUTS,) for name, x in arrays.items())


def even_inputs(k: int, layer: Any) -> int:
    """How many of the inputs of layer k are even."""
    return OUTPUTS if k == 0 else layer.weight.shape[0] // 2


def checked(layers: Iterable[tuple[Any, Any]]) -> list[Layer]:
    """The layers in float32, if the C kernel can run them; else ExportError."""
    layers = check_layers(layers, units=2, last=OUTPUTS)
    for k, layer in enumerate(layers[:-1]):
        if len(layer.bias) % GROUP:
            raise ExportError(f"layer {k}: {len(layer.bias)} outputs, not a multiple of {GROUP}")
    last = layers[-1].weight
    if last[even_inputs(len(layers) - 1, layers[-1]) :, -SELF_MIRRORED:].any():
        raise ExportError(f"the last {SELF_MIRRORED} outputs, their own mirror, have odd weights")
    return layers


def shape(layers: Sequence[Layer]) -> str:
    """The widths as text."""
    widths = [2 * len(layer.bias) for layer in layers[:-1]]
    text = "-".join(map(str, [PAIR_COUNT, *widths, PAIR_COUNT]))
    return f"{text}, equivariant to left and right"


def even_and_odd(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Sums and differences of mirror pairs, side by side: [F,2 units]."""
    return np.concatenate([first + second, first - second], 1)


def forward(layers: Sequence[Any], edms: np.ndarray, activate: Activate) -> list[np.ndarray]:
    """quantise.Plan.forward."""
    inputs = even_and_odd(edms[:, PAIR_MIRROR[:, 0]], edms[:, PAIR_MIRROR[:, 1]])
    inputs = inputs[:, :-SELF_MIRRORED]  # the difference of a pair that is its own mirror is 0
    values = [inputs]
    for k, layer in enumerate(layers):
        even, weight = even_inputs(k, layer), layer.weight.astype(float)
        alike = inputs[:, :even] @ weight[:even] + layer.bias
        unlike = inputs[:, even:] @ weight[even:]
        first, second = activate(k, alike + unlike), activate(k, alike - unlike)
        inputs = even_and_odd(first, second)
        values.append(inputs)
    distances = np.empty(edms.shape, first.dtype)
    distances[:, PAIR_MIRROR[:, 0]], distances[:, PAIR_MIRROR[:, 1]] = first, second
    return [*values[:-1], distances]


def largest(inputs: np.ndarray) -> float:
    """The largest activation of which even and odd inputs [F,2 units] were made."""
    even, odd = np.split(inputs, 2, axis=1)
    return float((even + np.abs(odd)).max() / 2)


def ranges(k: int, layer: Any) -> tuple[np.ndarray, np.ndarray]:
    """What the inputs of layer k, sums and differences of two, are within: integers."""
    least, most = 0, ACTIVATION >> SPARE
    if k == 0:
        least, most = -INPUT_ZERO_POINT, LARGEST_INPUT - INPUT_ZERO_POINT
    odd = np.arange(layer.weight.shape[0]) >= even_inputs(k, layer)
    return np.where(odd, least - most, 2 * least), np.where(odd, most - least, 2 * most)


def centre(k: int, layer: Any) -> np.ndarray:
    """What is subtracted from the inputs of layer k, integers: from even ones of the first."""
    even = np.arange(layer.weight.shape[0]) < even_inputs(k, layer)
    return 2 * INPUT_ZERO_POINT * (even & (k == 0))


def soften(edms: np.ndarray) -> np.ndarray:
    """What the first layer reads of EDMs [F,91]."""
    return edms**2 / (edms + SOFTENING / Q12)


def soften_integers(edms: np.ndarray) -> np.ndarray:
    """The same of EDMs in Q24, in Q12 and less the zero point: soften() of lib/network."""
    distance = edm_value(edms)  # Q12
    sums = distance + SOFTENING
    return (distance**2 + sums // 2) // sums - INPUT_ZERO_POINT


LARGEST_INPUT = int(soften_integers(np.array([LARGEST_EDM << EDM_SHIFT]))[0]) + INPUT_ZERO_POINT


PLAN = Plan(
    forward, soften, soften_integers, largest=largest, ranges=ranges, centre=centre, spare=SPARE
)
