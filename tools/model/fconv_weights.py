"""The weights of FConv, the paper's convolutional network: as they are trained and as they ship.

A trained file has these arrays, a shipped one those without a star:

    conv1_weight [7,7,1,C], conv1_bias [C]        convolution, pad 3       14x14 -> 14x14 -> 7x7
    bn1_scale, _shift, _mean, _variance [C]  *    before the ReLU and the pooling of 2x2
    conv2_weight [7,7,C,C], conv2_bias, bn2_ *    the same                 7x7 -> 7x7 -> 4x4
    deconv1_weight [7,7,C,C], deconv1_bias [C]    transposed, stride 2     4x4 -> 7x7
    deconv2_weight [7,7,C,C], deconv2_bias [C]    the same                 7x7 -> 14x14
    conv3_weight [C], conv3_bias [1]              1x1                      -> 14x14

with C = 64, kernels as [y, x, in, out].  fold() puts the batch normalisation into the weights,
round_weights() makes them short enough to print.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

Params = Mapping[str, np.ndarray]

TAPS = 7
SIDE = 14  # of the matrices
EPSILON = 1e-5  # of batch normalisation
DIGITS = 2047  # steps of a short weight


class Stage(NamedTuple):
    """A layer of 7x7 and the map that it gives, before a pooling."""

    name: str
    side: int
    up: bool  # transposed, of stride 2; else a pooling of 2x2 follows


STAGES = (
    Stage("conv1", SIDE, False),
    Stage("conv2", 7, False),
    Stage("deconv1", 7, True),
    Stage("deconv2", SIDE, True),
)
NAMES = (*(stage.name for stage in STAGES), "conv3")



def fold(params: Params) -> dict[str, np.ndarray]:
    """The same network in float32 without batch normalisation, which goes into what is before."""
    wide = {name: np.asarray(array, float) for name, array in params.items()}
    folded = {}
    for name in NAMES:
        weight, bias = wide[f"{name}_weight"], wide[f"{name}_bias"]
        bn = f"bn{name[-1]}"
        if name.startswith("conv") and f"{bn}_scale" in wide:
            scale = wide[f"{bn}_scale"] / np.sqrt(wide[f"{bn}_variance"] + EPSILON)
            weight = weight * scale
            bias = (bias - wide[f"{bn}_mean"]) * scale + wide[f"{bn}_shift"]
        folded |= {f"{name}_weight": weight, f"{name}_bias": bias}
    return {name: array.astype(np.float32) for name, array in folded.items()}


def round_weights(params: Params) -> dict[str, np.ndarray]:
    """Weights of up to four digits: integers, up to 2047, times a power of two an array, which
    float16 holds exactly.  Biases stay as they are."""
    short = dict(params)
    for name in NAMES:
        weight = np.asarray(params[f"{name}_weight"], float)
        largest = np.abs(weight).max()
        if largest > 0:
            step = max(2.0 ** np.ceil(np.log2(largest / DIGITS)), 2.0**-24)
            rounded = np.rint(weight / step) * step + 0.0  # no negative zero
            short[f"{name}_weight"] = rounded.astype(np.float16)
    return short


def unit_of(weight: np.ndarray) -> int | None:
    """The exponent of the power of two of which all weights are short multiples, or None."""
    largest = float(np.abs(weight).max(initial=0))
    if largest == 0 or np.any(np.signbit(weight) & (weight == 0)):
        return None
    exponent = int(np.ceil(np.log2(largest / DIGITS)))
    steps = weight.astype(float) / 2.0**exponent
    return exponent if np.array_equal(steps, np.rint(steps)) else None
