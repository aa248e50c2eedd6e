"""The order of a quantised layer's units.

A processor that multiplies pairs of inputs leaves out a pair that is zero (lib/network/rows_dsp.h).
So units that are often zero together lie side by side.  Sums of integers have no order: what the
network gives does not change by a bit.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from export.layers import ExportError


def pairs_together(zero: np.ndarray) -> list[int]:
    """An order of units, by which many pairs of neighbours are zero.

    zero  [F,n] which unit is zero in which view.  Pairs are taken as they come, from the most
    frequent down, and then two pairs exchange units for as long as that is better.
    """
    zero = zero.astype(np.float32)
    both = zero.T @ zero
    count = len(both)
    first, second = np.triu_indices(count, 1)
    free, pairs = np.ones(count, bool), []
    for n in np.argsort(-both[first, second], kind="stable"):
        if free[first[n]] and free[second[n]]:
            free[[first[n], second[n]]] = False
            pairs.append([int(first[n]), int(second[n])])
    while any([exchange(pairs, both, i, j) for i in range(len(pairs)) for j in range(i)]):
        pass
    return [unit for pair in pairs for unit in pair] + np.flatnonzero(free).tolist()


def exchange(pairs: list[list[int]], both: np.ndarray, i: int, j: int) -> bool:
    """Gives pairs i and j their best partners; returns whether they had others."""
    (a, b), (c, d) = pairs[i], pairs[j]
    ways = [[[a, b], [c, d]], [[a, c], [b, d]], [[a, d], [b, c]]]
    best = max(ways, key=lambda way: sum(both[tuple(pair)] for pair in way))
    pairs[i], pairs[j] = best
    return best is not ways[0]


def orders_of(layers: Sequence[Any], values: Sequence[np.ndarray]) -> list[list[int]]:
    """The order of each hidden layer's units.

    values  what goes into each layer [...,n]: units, or sums and then differences of two
    """
    hidden = zip(layers[:-1], values[1:], strict=True)
    zeros = (x.reshape(-1, x.shape[-1])[:, : len(layer.bias)] == 0 for layer, x in hidden)
    return [pairs_together(zero) for zero in zeros]


def in_order(network: Sequence[Any], calibration: Mapping[str, Any]) -> list[Any]:
    """A quantised network with its units in the order that the calibration notes, if it does."""
    network = list(network)
    for k, order in enumerate(calibration.get("order", [])):
        count = len(network[k].bias) if k < len(network) - 1 else 0
        if sorted(order) != list(range(count)):
            raise ExportError(f"calibration: no order of the {count} units of hidden layer {k}")
        dense, following = network[k], network[k + 1]
        network[k] = dense._replace(
            weight=dense.weight[:, order],
            bias=dense.bias[order],
            multiplier=dense.multiplier[order],
        )
        rows = following.weight.reshape(-1, count, following.weight.shape[1])
        network[k + 1] = following._replace(weight=rows[:, order].reshape(following.weight.shape))
    return network
