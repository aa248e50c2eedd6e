"""The order of a quantised layer's units: what it is for, and that it changes nothing."""

import numpy as np
import pytest

from export import equivariant, quantise
from export.calibrate import calibrate
from export.layers import ExportError, Layer
from export.unit_order import in_order, orders_of, pairs_together
from model.layout import layout


def zero_pairs(zero: np.ndarray, order: list[int]) -> float:
    """The share of neighbours that are zero together."""
    zero = zero[:, order]
    return float(np.mean(zero[:, :-1:2] & zero[:, 1::2]))


def test_units_that_are_zero_together_become_neighbours():
    rng = np.random.default_rng(3)
    kinds = np.arange(12) % 6  # unit k is zero with unit k + 6, and with no other
    zero = rng.random((500, 6))[:, kinds] < 0.5
    order = pairs_together(zero)
    assert sorted(order) == list(range(12))
    assert zero_pairs(zero, order) == pytest.approx(zero.mean())


@pytest.mark.parametrize("count", [7, 8, 40])
def test_the_order_is_better_than_others_and_the_same_each_time(count):
    rng = np.random.default_rng(count)
    zero = rng.random((300, 4)) @ rng.normal(size=(4, count)) < 0
    order = pairs_together(zero)
    assert order == pairs_together(zero) and sorted(order) == list(range(count))
    best = zero_pairs(zero, order)
    assert all(best >= zero_pairs(zero, rng.permutation(count).tolist()) for _ in range(200))


def random_layers(inputs: int, units: int, outputs: int, halves: int) -> list[Layer]:
    rng = np.random.default_rng(5)
    rows = [inputs, halves * units, halves * units]
    columns = [units, units, outputs]
    return [
        Layer(rng.normal(0, 0.2, (row, column)), rng.normal(0, 0.2, column))
        for row, column in zip(rows, columns, strict=True)
    ]


@pytest.mark.parametrize("form", ["w16", "w8"])
@pytest.mark.parametrize("kind", ["dense", "equivariant"])
def test_what_a_network_gives_does_not_change_by_a_bit(kind, form):
    rng = np.random.default_rng(8)
    plan, halves, inputs = quantise.DENSE, 1, 91
    if kind == "equivariant":
        known = layout("direct")
        plan, halves, inputs = equivariant.plan_of(known), 2, known.even + known.odd
    outputs = 91 if kind == "dense" else len(known.has_even)
    layers = random_layers(inputs, 16, outputs, halves)
    views = np.abs(rng.normal(size=(400, inputs)))
    calibration = calibrate(layers, views, plan)
    without = {name: value for name, value in calibration.items() if name != "order"}
    read = np.rint(views * quantise.METRE)
    given = [
        quantise.run(quantise.quantise(layers, noted, form, plan), read, plan)
        for noted in (calibration, without)
    ]
    assert calibration["order"] != [list(range(16))] * 2
    assert np.array_equal(*given)


def test_orders_are_of_the_units_that_a_layer_gives():
    layers = random_layers(4, 8, 3, 2)
    even = np.array([[0, 1, 0, 1, 0, 1, 0, 1.0]] * 3 + [[1, 0, 1, 0, 1, 0, 1, 0.0]] * 2)
    odd = np.ones_like(even)
    values = [np.zeros((5, 4)), np.hstack([even, odd]), np.hstack([even, odd])]
    for order in orders_of(layers, values):
        assert all(a % 2 == b % 2 for a, b in zip(order[::2], order[1::2], strict=True))


@pytest.mark.parametrize(
    "orders", [[[0, 0, 1]], [[0, 1]], [[0, 1, 3]], [[2, 0, 1]] * 2, [["0", 1, 2]], [3], 3, [None]]
)
def test_what_is_no_order_is_refused(orders):
    dense = quantise.Dense(np.zeros((3, 3), int), np.zeros(3, int), np.ones(3, int), 32, 1)
    with pytest.raises((ExportError, TypeError, ValueError)):
        in_order([dense, dense], {"order": orders})
