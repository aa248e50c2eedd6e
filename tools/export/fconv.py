"""FConv as lib/network/fconv.h computes it: its layers, and what quantising must know of them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from edmlift.joints import PAIRS
from export.layers import ExportError, Layer, to_float32
from export.quantise import Activate, Plan
from model.constants import CHANNELS, GROUP
from model.fconv_weights import NAMES, SIDE, STAGES, TAPS, Stage

REACH = TAPS // 2

# ---- Layers ------------------------------------------------------------------------------------


def is_fconv(arrays: Mapping[str, Any]) -> bool:
    """Are these arrays, by their names, meant to be an FConv?"""
    return any(name.startswith(("conv1_", "conv2_", "deconv")) for name in arrays)


def layers_of(arrays: Mapping[str, Any]) -> list[Layer]:
    """The five layers, weights as [7 * 7 * in, out] in the order [y, x, in], the last [in, 1].
    Raises ExportError where the C kernel cannot run them."""
    known = {f"{name}_{part}" for name in NAMES for part in ("weight", "bias")}
    if unknown := sorted(arrays.keys() - known):
        hint = ": fold the batch normalisation first" if unknown[0].startswith("bn") else ""
        raise ExportError(f"unknown array {unknown[0]}{hint}")
    layers, channels = [], 1
    for name in NAMES:
        last = name == NAMES[-1]
        weight = to_float32(arrays.get(f"{name}_weight"), f"{name}_weight", 1 if last else 4)
        bias = to_float32(arrays.get(f"{name}_bias"), f"{name}_bias", 1) + np.float32(0)  # not -0
        kernel = (TAPS, TAPS, channels)
        if weight.shape[:3] != ((channels,) if last else kernel):
            raise ExportError(f"{name}_weight is {weight.shape}, not of {channels} channels, 7x7")
        outputs = 1 if last else weight.shape[-1]
        if len(bias) != outputs:
            raise ExportError(f"{name} has {outputs} outputs, but {len(bias)} biases")
        if not last and (outputs % GROUP or not GROUP <= outputs <= CHANNELS):
            raise ExportError(f"{name} has {outputs} channels, not 8, 16 ... {CHANNELS}")
        layers.append(Layer(weight.reshape(-1, outputs), bias))
        channels = outputs
    return layers


# On each axis of a transposed convolution: the taps of odd pixels, then of even ones (fconv.h).
UP_ORDER = [6, 4, 2, 0, 5, 3, 1]


def as_c_has_it(k: int, weight: np.ndarray) -> np.ndarray:
    """The weights [inputs, out] of layer k, their inputs in the order of lib/network/fconv.h."""
    if k == len(STAGES) or not STAGES[k].up:
        return weight
    kernel = weight.reshape(TAPS, TAPS, -1, weight.shape[-1])
    return kernel[UP_ORDER][:, UP_ORDER].reshape(weight.shape)


def multiply_adds(layers: Sequence[Layer]) -> int:
    """Multiplications of a prediction; windows at the border have fewer."""
    counts = [tap_shares(k).sum() * stage.side**2 for k, stage in enumerate(STAGES)]
    channels = [layer.weight.size / TAPS**2 for layer in layers[:-1]]
    last = layers[-1].weight.size * SIDE**2
    return round(sum(n * c for n, c in zip(counts, channels, strict=True))) + last


# ---- The network, for quantising ---------------------------------------------------------------


def meeting(tap: int, size: int, stage: Stage) -> tuple[slice, slice]:
    """The outputs of an axis that see an input of `size` through a tap, and those inputs."""
    i = np.arange(size)
    o = 2 * i - REACH + tap if stage.up else i + REACH - tap
    i = i[(o >= 0) & (o < stage.side)]
    o = o[(o >= 0) & (o < stage.side)]
    if len(i) == 0:
        return slice(0), slice(0)
    return slice(o[0], o[-1] + 1, 2 if stage.up else 1), slice(i[0], i[-1] + 1)


def size_before(k: int) -> int:
    """The side of the map that layer k reads."""
    return (14, 7, 4, 7)[k]


def tap_shares(k: int) -> np.ndarray:
    """The share of the outputs of layer k that see an input through each tap: [49], or [1]."""
    if k == len(STAGES):
        return np.ones(1)
    stage = STAGES[k]
    ends = [meeting(tap, size_before(k), stage)[1] for tap in range(TAPS)]
    counts = np.array([end.stop - (end.start or 0) for end in ends])
    return np.outer(counts, counts).reshape(-1) / stage.side**2


def convolved(maps: np.ndarray, k: int, layer: Any) -> np.ndarray:
    """Sums [F,side,side,out] of layer k on maps [F,n,n,in]."""
    stage, (inputs, outputs) = STAGES[k], layer.weight.shape
    kernel = layer.weight.astype(float).reshape(TAPS, TAPS, inputs // TAPS**2, outputs)
    sums = np.zeros((len(maps), stage.side, stage.side, outputs)) + layer.bias
    for y, x in np.ndindex(TAPS, TAPS):
        (out_y, in_y), (out_x, in_x) = (meeting(tap, maps.shape[1], stage) for tap in (y, x))
        seen = maps[:, in_y, in_x]
        product = seen.reshape(-1, seen.shape[-1]) @ kernel[y, x]
        sums[:, out_y, out_x] += product.reshape(*seen.shape[:-1], outputs)
    return sums


def pooled(maps: np.ndarray) -> np.ndarray:
    """The largest of each 2x2 of maps [F,n,n,C] that are 0 or more."""
    odd = maps.shape[1] % 2
    maps = np.pad(maps, ((0, 0), (0, odd), (0, odd), (0, 0)))
    half = maps.shape[1] // 2
    return maps.reshape(len(maps), half, 2, half, 2, -1).max((2, 4))


def forward(layers: Sequence[Any], edms: np.ndarray, activate: Activate) -> list[np.ndarray]:
    """quantise.Plan.forward of an FConv, in batches that fit memory."""
    batches = [
        forward_batch(layers, edms[at : at + 256], activate) for at in range(0, len(edms), 256)
    ]
    return [np.concatenate(values) for values in zip(*batches, strict=True)]


def forward_batch(layers: Sequence[Any], edms: np.ndarray, activate: Activate) -> list[np.ndarray]:
    """forward() of as many EDMs as memory holds."""
    maps = np.zeros((len(edms), SIDE, SIDE, 1), edms.dtype)
    maps[:, PAIRS[0], PAIRS[1], 0] = edms
    values = [maps + maps.swapaxes(1, 2)]
    for k, stage in enumerate(STAGES):
        maps = activate(k, convolved(values[-1], k, layers[k]))
        values.append(maps if stage.up else pooled(maps))
    last = layers[-1]
    z = (values[-1] @ last.weight.astype(float) + last.bias)[..., 0]
    both = (z + z.swapaxes(1, 2))[:, PAIRS[0], PAIRS[1]]
    return [*values, activate(len(STAGES), both[..., None])[..., 0]]


PLAN = Plan(forward, tap_shares=tap_shares, sums=2, views=2000)
