"""A network as a chain of steps, and how batch normalisation is folded into its layers.

A reader gives what the file has: Linear, Scale, RELU.  fold() makes of them layers with a ReLU
between, which is what the C kernels run.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from export.layers import ExportError, Layer, check_order, to_float32

RELU = "relu"


class Linear(NamedTuple):
    """y = x @ weight + bias, as the file has them."""

    weight: Any  # [in, out]
    bias: Any  # [out], or None where the file has none


class Scale(NamedTuple):
    """y = x * scale + shift for each unit: batch normalisation once trained, in float64."""

    scale: np.ndarray  # [units], or one for all
    shift: np.ndarray
    name: str


Step: TypeAlias = Linear | Scale | str  # of strings RELU alone


class ExportWarning(UserWarning):
    """What a reader has taken for granted, in one line."""


# ---- What cannot run, and what to do -----------------------------------------------------------

ACTIVATIONS = (
    "leakyrelu prelu elu selu celu sigmoid hardsigmoid logistic tanh hardtanh softmax logsoftmax "
    "softplus softsign gelu swish hardswish silu mish relu6 relun1to1 clip thresholdedrelu "
    "exponential exp sin cos erf"
).split()
OF_EACH_INPUT = "layernormalization groupnormalization instancenormalization unitnormalization"
NOT_DENSE = ("conv", "pool", "lstm", "gru", "rnn", "attention", "embedding", "einsum")
BRANCHING = ("concat", "split", "slice", "gather", "merge")


def why_not(kind: str) -> str:
    """Why a layer or an operator of this name cannot run, and what to do."""
    plain = kind.lower().replace("_", "")
    if plain in ACTIVATIONS:
        return "the C kernels apply ReLU and no other activation; train with ReLU"
    if plain in OF_EACH_INPUT.split():
        return "it depends on each input and cannot be folded; train with batch normalisation"
    if any(part in plain for part in NOT_DENSE):
        return "not a fully connected layer; train a network of those and ReLU"
    if any(part in plain for part in BRANCHING):
        return "layers must follow each other; train a network without branches"
    return "only fully connected layers, ReLU and what folds into them; train without it"


# ---- Batch normalisation -----------------------------------------------------------------------


def batch_norm(
    gamma: Any, beta: Any, mean: Any, variance: Any, *, epsilon: float, name: str
) -> Scale:
    """What batch normalisation does once trained; gamma None is 1, beta None 0."""
    mean, variance = vector(mean, f"{name}: mean"), vector(variance, f"{name}: variance")
    gamma = np.ones_like(mean) if gamma is None else vector(gamma, f"{name}: scale")
    beta = np.zeros_like(mean) if beta is None else vector(beta, f"{name}: shift")
    if sizes := {len(other) for other in (gamma, beta, variance)} - {len(mean)}:
        raise ExportError(f"{name}: statistics of {len(mean)} and {sizes.pop()} units")
    if not (np.isfinite(epsilon) and epsilon >= 0):
        raise ExportError(f"{name}: epsilon is {epsilon:g}")
    if not np.all(variance >= 0) or not np.all(variance + epsilon > 0):
        raise ExportError(f"{name}: variance is {variance.min():g}")
    scale = gamma / np.sqrt(variance + epsilon)
    return Scale(scale, beta - mean * scale, name)


def vector(values: Any, name: str) -> np.ndarray:
    """Values of units in float64; raises ExportError where they are none."""
    to_float32(values, name, 1)
    return np.asarray(values, float)


def constant(values: Any, name: str) -> np.ndarray:
    """A number for all units or one for each, whatever axes of length 1 it has: float64 [n]."""
    values = np.asarray(values)
    if values.size != (values.shape[-1] if values.ndim else 1):
        raise ExportError(f"{name} is not one number for each unit, but {values.shape}")
    return vector(values.reshape(-1), name)


# ---- Folding -----------------------------------------------------------------------------------


def chained(layers: Iterable[tuple[Any, Any]]) -> list[Step]:
    """Layers with a ReLU between, as files have them that hold layers alone."""
    steps: list[Step] = []
    for layer in layers:
        steps += [RELU, Linear(*layer)] if steps else [Linear(*layer)]
    return steps


def fold(steps: Iterable[Step]) -> list[Layer]:
    """The layers, with every Scale folded into the layer before it or, where it comes first or
    after a ReLU, into the one behind it.  Either is exact but for the rounding of the weights to
    float32.  Raises ExportError where a Scale has neither, or the steps are no such chain."""
    done: list[Linear | str] = []
    waiting: Scale | None = None  # for the layer behind it
    for step in steps:
        if isinstance(step, Scale):
            last = done[-1] if done else None
            if isinstance(last, Linear):
                done[-1] = scaled_outputs(last, step)
            else:
                waiting = step if waiting is None else joined(waiting, step)
        elif isinstance(step, Linear):
            done.append(step if waiting is None else scaled_inputs(step, waiting))
            waiting = None
        else:
            refuse_waiting(waiting, "and a ReLU behind it")
            done.append(step)
    refuse_waiting(waiting, "and no layer behind it")
    check_order(["dense" if isinstance(step, Linear) else step for step in done])
    return [Layer(*step) for step in done if isinstance(step, Linear)]


def refuse_waiting(scale: Scale | None, behind: str) -> None:
    """Raises ExportError if there is a Scale that no layer takes up."""
    if scale is not None:
        raise ExportError(
            f"{scale.name} cannot be folded: it has no layer before it {behind}; "
            "train with it between a fully connected layer and its ReLU"
        )


def joined(first: Scale, second: Scale) -> Scale:
    """One that does what two do."""
    if len(first.scale) != 1:
        check_units(len(first.scale), second)
    return Scale(first.scale * second.scale, first.shift * second.scale + second.shift, second.name)


def scaled_outputs(layer: Linear, scale: Scale) -> Linear:
    """(x @ W + b) * s + t = x @ (W s) + (b s + t)."""
    weight, bias = in_float64(layer)
    check_units(weight.shape[1], scale)
    return Linear(weight * scale.scale, bias * scale.scale + scale.shift)


def scaled_inputs(layer: Linear, scale: Scale) -> Linear:
    """(x * s + t) @ W + b = x @ (s W) + (b + t @ W)."""
    weight, bias = in_float64(layer)
    check_units(weight.shape[0], scale)
    shift = np.broadcast_to(scale.shift, len(weight))
    return Linear(weight * scale.scale.reshape(-1, 1), bias + shift @ weight)


def in_float64(layer: Linear) -> tuple[np.ndarray, np.ndarray]:
    """Weight and bias, which is 0 where none was given."""
    to_float32(layer.weight, "weight", 2)
    weight = np.asarray(layer.weight, float)
    if layer.bias is None:
        return weight, np.zeros(weight.shape[1])
    return weight, vector(layer.bias, "bias")


def check_units(count: int, scale: Scale) -> None:
    """Raises ExportError if a Scale is of another number of units."""
    if len(scale.scale) not in (1, count):
        raise ExportError(f"{scale.name} is of {len(scale.scale)} units, not of {count}")
