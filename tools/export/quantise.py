"""Turns a network into integers, as lib/network/layers.h defines them for edml_dense_w16 and _w8.

Rows of weights have a scale each, as large as the bits of a weight and the 32-bit accumulator
allow.  Calibration, on views of the training people, tells what the hidden layers reach, which
decides the scale of their activations (larger ones are clamped, in C as here, so that no input can
overflow), and what each input of a layer is on average: times the rounding errors of a row, that
is how far its sum would be off on average, and the bias makes up for it.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from export.layers import ExportError, Layer
from export.rounding import from_text
from export.unit_order import in_order
from model.constants import ACTIVATION, INPUT_SHIFT, OUTPUT_SHIFT

WEIGHT_TYPES = {"w16": np.int16, "w8": np.int8}
WORD = 1 << 31
METRE = 1 << 24  # of what the network gives, Q24
FARTHEST = 3 * METRE >> OUTPUT_SHIFT  # what the stages behind the network are made for
VANISHING = 1e-6  # weights below it need not tell the scale of their row
BISECTIONS = 50


class Dense(NamedTuple):
    """y = clamp(((x @ weight + bias) multiplier + 2^(shift - 1)) >> shift, 0, clamp).

    Without a ReLU y has the sign of the sum, and its size is as if that were positive.
    """

    weight: np.ndarray  # int16 or int8 [in, out]
    bias: np.ndarray  # int32 [out]
    multiplier: np.ndarray  # int32 [out], 1 and up
    shift: int  # 2 to 32
    clamp: int


Activate = Callable[[int, np.ndarray], np.ndarray]


def from_zero(k: int, layer: Any) -> tuple[np.ndarray, np.ndarray]:
    """Plan.ranges of inputs that are activations."""
    return np.zeros(len(layer.weight), int), np.full(len(layer.weight), ACTIVATION)


def input_value(number: np.ndarray) -> np.ndarray:
    """Numbers within +-8, Q24, as the first layer reads them: Q12 to nearest, below 8."""
    rounded = (number.astype(np.int64) + (1 << INPUT_SHIFT - 1)) >> INPUT_SHIFT
    return np.minimum(rounded, (1 << 27 - INPUT_SHIFT) - 1)


def mean_of_channels(k: int, inputs: np.ndarray) -> np.ndarray:
    """Plan.mean of inputs [...,channels]."""
    return inputs.reshape(-1, inputs.shape[-1]).mean(0)


class Plan(NamedTuple):
    """What quantising must know of a kind of network beyond its layers."""

    # Layers, what the network reads [F,in], and what makes the sums of layer k its output -> what
    # goes into each layer, and the outputs [F,out].  A layer may have several inputs a channel, its
    # taps.
    forward: Callable[[Sequence[Any], np.ndarray, Activate], list[np.ndarray]]
    # The share of the outputs of layer k in which each tap counts, [taps].
    tap_shares: Callable[[int], np.ndarray] = lambda k: np.ones(1)
    # The largest activation among the inputs of a layer behind the first.
    largest: Callable[[np.ndarray], float] = lambda inputs: float(inputs.max())
    # The mean of each input of layer k, or of each channel.
    mean: Callable[[int, np.ndarray], np.ndarray] = mean_of_channels
    # Least and largest value of each input [in] of layer k, integers.
    ranges: Callable[[int, Any], tuple[np.ndarray, np.ndarray]] = from_zero
    headroom: float = 1.25  # of the activations over the largest one in calibration
    spare: int = 0  # bits of an activation that are left to sums of them
    sums: int = 1  # of the last layer; an output is their mean
    signed: bool = False  # the last layer has no ReLU
    measured: Any = slice(None)  # outputs, in metres, by which errors are measured
    views: int | None = None  # to calibrate on; all

    @property
    def activation(self) -> int:
        """The largest there is."""
        return ACTIVATION >> self.spare


def dense_forward(
    layers: Sequence[Any], inputs: np.ndarray, activate: Activate
) -> list[np.ndarray]:
    """Plan.forward of fully connected layers."""
    values = [inputs]
    for k, layer in enumerate(layers):
        values.append(activate(k, values[-1] @ layer.weight.astype(float) + layer.bias))
    return values


DENSE = Plan(dense_forward)


def quantise(
    layers: Sequence[Layer], calibration: Mapping[str, Any], form: str, plan: Plan = DENSE
) -> list[Dense]:
    """The network in integers, form "w16" or "w8"; raises ExportError where that cannot be."""
    kind = WEIGHT_TYPES[form]
    every = rows_of(layers, calibration, plan)
    if (known := calibration.get("steps", {})) and form in known:
        steps = from_text(known[form], [rows.weight.shape for rows in every])
        every = [rows._replace(steps=of_layer) for rows, of_layer in zip(every, steps, strict=True)]
    dense = []
    for k, rows in enumerate(every):
        scale = largest_scales(rows._replace(steps=0), np.iinfo(kind).max)
        dense.append(quantise_layer(rows, scale, kind))
        prove(dense[k], k, rows.reach, rows.word)
    return in_order(dense, calibration)


def rows_of(layers: Sequence[Layer], calibration: Mapping[str, Any], plan: Plan) -> list["Rows"]:
    """Each layer as it is to be quantised."""
    largest = calibration["largest"]
    mean = [np.array(values, float) for values in calibration["mean"]]
    if (len(largest), len(mean)) != (len(layers) - 1, len(layers)):
        raise ExportError("calibration: of another number of layers")
    if not all(0 < x < np.inf for x in largest):
        raise ExportError("calibration: a hidden layer is always zero, or not finite")
    if not all(np.isfinite(values).all() for values in mean):
        raise ExportError("calibration: a mean is not finite")
    inputs = [(plan.tap_shares(k)[:, None] * values).reshape(-1) for k, values in enumerate(mean)]
    if [len(values) for values in inputs] != [len(layer.weight) for layer in layers]:
        raise ExportError("calibration: a mean is not of the inputs")
    hidden = [plan.activation / (plan.headroom * x) for x in largest]
    scales = [METRE >> INPUT_SHIFT, *hidden, (METRE >> OUTPUT_SHIFT) / plan.sums]
    rows = []
    for k, (weight, bias) in enumerate(equalised(layers)):
        inner = k < len(layers) - 1
        rows.append(
            Rows(
                weight,
                bias,
                mean=inputs[k],
                x_scale=scales[k],
                y_scale=scales[k + 1],
                reach=input_ranges(plan, k, layers[k]),
                clamp=plan.activation if inner else FARTHEST,
                least_shift=32 if inner else 2,
                word=WORD if inner else WORD // plan.sums,
            )
        )
    return rows


def input_ranges(plan: Plan, k: int, layer: Any) -> np.ndarray:
    """Least and largest inputs of layer k, integers, [2,in]."""
    return np.array(plan.ranges(k, layer))


def equalised(layers: Sequence[Layer]) -> list[Layer]:
    """The same network, in double, with hidden units of another size, which a ReLU lets through.

    A weight that is large only because its unit is small makes its whole row coarse; so a unit is
    multiplied by the root of the largest weight that reads it, and those weights divided by it.
    """
    # In C's order, because the last bits of NumPy's sums depend on it.
    even = [Layer(*(np.array(array, float, order="C") for array in layer)) for layer in layers]
    for k in range(len(even) - 1):
        unit, reader = even[k], even[k + 1]
        taps = reader.weight.reshape(-1, len(unit.bias), len(reader.bias))
        peak = np.abs(taps).max((0, 2))
        size = np.sqrt(np.where(peak > 0, peak, 1))
        even[k] = Layer(unit.weight * size, unit.bias * size)
        even[k + 1] = Layer((taps / size[:, None]).reshape(reader.weight.shape), reader.bias)
    return even


class Rows(NamedTuple):
    """A layer to be quantised; its input is to be integers, multiples of 1 / x_scale, and so is its
    output, of 1 / y_scale."""

    weight: np.ndarray  # [in, out]
    bias: np.ndarray  # [out]
    mean: np.ndarray  # [in], of the input
    x_scale: float
    y_scale: float
    reach: np.ndarray  # [2,in], least and largest of the input
    clamp: int  # of the output
    least_shift: int
    word: int  # the sums stay below, and above its negative
    steps: np.ndarray | int = 0  # of the integers from the nearest, [in, out]

    def rounded(self, scale: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Integers, still in double: weights times their row's scale [out], and biases."""
        weight = np.rint(self.weight * scale) + self.steps
        lost = ((self.weight * scale - weight) * self.mean[:, None]).sum(0)
        return weight, np.rint((self.bias * scale + lost) * self.x_scale)


def quantise_layer(rows: Rows, scale: np.ndarray, kind: type) -> Dense:
    """A layer whose rows have these scales [out]."""
    ratio = rows.y_scale / (scale * rows.x_scale)  # of an output to its sum
    shift = int(min(32, 30 - np.floor(np.log2(ratio.max()))))
    if shift < rows.least_shift:
        raise ExportError("a layer's outputs are too large to quantise")
    multiplier = np.clip(np.rint(ratio * 2.0**shift), 1, WORD - 1).astype(np.int32)
    weight, bias = rows.rounded(scale)
    if np.abs(weight).max() > np.iinfo(kind).max:
        raise ExportError("calibration: steps leave the integers of a weight")
    return Dense(weight.astype(kind), bias.astype(np.int32), multiplier, shift, rows.clamp)


def largest_scales(rows: Rows, most: int) -> np.ndarray:
    """The largest scale [out] of each row, by bisection, with which its weights stay within +-most
    and its sums within their word."""
    low = np.zeros(len(rows.bias))
    high = scale = most / np.maximum(np.abs(rows.weight).max(0), VANISHING)
    for _ in range(BISECTIONS):
        lowest, highest = sum_bounds(*rows.rounded(scale), rows.reach)
        fits = (lowest > -rows.word) & (highest < rows.word)
        low, high = np.where(fits, scale, low), np.where(fits, high, scale)
        scale = (low + high) / 2
    return low


def sum_bounds(
    weight: np.ndarray, bias: np.ndarray, reach: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What the sums of a layer, and all sums on the way, cannot leave: lowest and highest [out].

    reach [2,in] is what the inputs cannot leave, 0 among it: in any order a sum is highest where
    only what adds to it has counted, and lowest where only what takes from it.
    """
    ends = [weight * end[:, None] for end in reach]
    return bias + np.minimum(*ends).sum(0), bias + np.maximum(*ends).sum(0)


def prove(dense: Dense, number: int, reach: np.ndarray, word: int = WORD) -> None:
    """Raises ExportError if any input could overflow the C kernel (checked on the integers that the
    header will hold)."""
    lowest, highest = sum_bounds(dense.weight.astype(np.int64), dense.bias.astype(np.int64), reach)
    for row in np.flatnonzero((lowest <= -word) | (highest >= word)):
        raise ExportError(
            f"layer {number}: sums of row {row} reach {lowest[row]} to {highest[row]}, "
            f"beyond {word.bit_length()} bits"
        )
    if not (dense.multiplier > 0).all() or not 2 <= dense.shift <= 32:
        raise ExportError(f"layer {number}: multiplier or shift out of range")
    if max(-lowest.min(), highest.max()) >= word >> 32 - dense.shift:
        raise ExportError(f"layer {number}: sums leave 32 bits when they are shifted to the left")


def run(network: Sequence[Dense], inputs: np.ndarray, plan: Plan = DENSE) -> np.ndarray:
    """Outputs [F,out] that the C kernel computes from what the network reads [F,in]: both integers,
    Q24."""

    def activate(k: int, sums: np.ndarray) -> np.ndarray:
        dense = network[k]  # sums are exact in double
        y = (sums.astype(np.int64) * dense.multiplier + (1 << dense.shift - 1)) >> dense.shift
        least = -dense.clamp if plan.signed and k == len(network) - 1 else 0
        return np.clip(y, least, dense.clamp)

    return plan.forward(network, input_value(inputs), activate)[-1] * (1 << OUTPUT_SHIFT)


# ---- What the header says ----------------------------------------------------------------------


def weight_bits(dense: Dense) -> tuple[int, int]:
    """The fewest and the most bits, sign included, that the weights of a row have."""
    peaks = [int(peak) for peak in np.abs(dense.weight.astype(int)).max(0) if peak > 0]
    return min(peaks, default=0).bit_length() + 1, max(peaks, default=0).bit_length() + 1


def spare_bits(network: Sequence[Dense], plan: Plan = DENSE) -> float:
    """How far the largest sum that any input can cause is from 32 bits, in bits."""
    bounds = [
        sum_bounds(d.weight.astype(np.int64), d.bias.astype(np.int64), input_ranges(plan, k, d))
        for k, d in enumerate(network)
    ]
    largest = max(int(np.abs(bound).max()) for pair in bounds for bound in pair)
    return float(np.log2(WORD / max(largest, 1)))
