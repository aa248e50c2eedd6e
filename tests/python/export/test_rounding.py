"""rounding.py: errors of weights that make up for each other."""

import base64

import numpy as np
import pytest

from export.calibrate import calibrate
from export.layers import ExportError, Layer
from export.quantise import METRE, quantise, run
from export.rounding import compensated, from_text, to_text

RNG = np.random.default_rng(11)
PARTS = {"parts": lambda k, weight: [len(weight)]}


def correlated(count: int, inputs: int) -> np.ndarray:
    """Inputs that are sums of an eighth as many causes or more, and a little of their own."""
    causes = -(-inputs // 8)
    common = RNG.normal(size=(count, causes)) @ RNG.normal(size=(causes, inputs))
    return common + 0.1 * RNG.normal(size=(count, inputs))


def test_sums_of_correlated_inputs_stay_nearer_also_on_others():
    x = correlated(4000, 30)
    weight = RNG.normal(0, 3, (30, 8))
    rounded = compensated(weight, x[:2000], 127)
    assert np.array_equal(rounded, np.rint(rounded)) and not np.array_equal(rounded, weight.round())
    others = x[2000:]
    error = np.std(others @ (rounded - weight)), np.std(others @ (weight.round() - weight))
    assert error[0] < 0.5 * error[1]


def test_inputs_that_do_not_vary_together_are_rounded_to_nearest():
    x = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]], float)
    weight = np.array([[0.4, 1.6], [-0.6, 3.2]])
    assert np.array_equal(compensated(weight, x, 127), [[0, 2], [-1, 3]])


def test_inputs_that_never_vary_are_rounded_to_nearest():
    assert np.array_equal(compensated(np.array([[0.4], [1.6]]), np.zeros((9, 2)), 127), [[0], [2]])


def test_no_integer_is_larger_than_the_largest():
    x = correlated(2000, 12)
    rounded = compensated(np.full((12, 3), 126.6), x, 127)
    assert np.abs(rounded).max() == 127


def test_steps_come_back_from_their_text():
    steps = [RNG.integers(-3, 4, shape) for shape in ((40, 7), (7, 5))]
    for known, found in zip(steps, from_text(to_text(steps), [(40, 7), (7, 5)]), strict=True):
        assert np.array_equal(known, found)


@pytest.mark.parametrize(
    "text",
    ["", "no base64!", "AAAA", to_text([np.zeros((3, 3))]), to_text([np.zeros((40, 8))]), None],
)
def test_a_damaged_text_is_an_error(text):
    with pytest.raises(ValueError):
        from_text(text, [(40, 7)])


def test_a_text_with_more_behind_it_or_one_letter_changed_is_an_error():
    text = to_text([RNG.integers(-3, 4, (40, 7))])
    raw = base64.b64decode(text)
    flipped = bytearray(raw)
    flipped[len(raw) // 2] ^= 1
    for damaged in (raw + b"more", bytes(flipped), raw[:-1]):
        with pytest.raises(ValueError):
            from_text(base64.b64encode(damaged).decode(), [(40, 7)])


def network() -> list[Layer]:
    sizes = (91, 40, 40, 91)
    pairs = zip(sizes, sizes[1:], strict=False)
    return [
        Layer(RNG.normal(0, (2 / a) ** 0.5, (a, b)).astype("f4"), np.full(b, 0.1, "f4"))
        for a, b in pairs
    ]


def test_a_network_of_8_bits_is_nearer_with_its_steps():
    layers = network()
    edms = np.clip(0.3 + 0.05 * correlated(3000, 91), 0, 3)
    calibration = calibrate(layers, edms[:2000], **PARTS)
    without = calibration | {"steps": {}}
    others, exact = edms[2000:], edms[2000:]
    for layer in layers:
        exact = np.maximum(exact @ layer.weight.astype(float) + layer.bias, 0)
    errors = [
        np.std(run(quantise(layers, known, "w8"), np.rint(others * METRE)) / METRE - exact)
        for known in (calibration, without)
    ]
    assert errors[0] < 0.95 * errors[1]
    assert calibration["rms"]["w8"]["mm"] < 1000 * errors[1]


LARGE = to_text([np.full((91, 40), 100), np.zeros((40, 40)), np.zeros((40, 91))])


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        ({"steps": {"w8": LARGE}}, "steps leave the integers"),
        ({"largest": [1.0, 1.0, 1.0]}, "another number of layers"),
        ({"mean": [[0.0] * 91, [0.0] * 40, [0.0]]}, "a mean is not of the inputs"),
    ],
)
def test_a_damaged_calibration_makes_no_other_weights(damage, message):
    layers = network()
    calibration = calibrate(layers, np.abs(correlated(500, 91)) * 0.1, **PARTS)
    with pytest.raises(ExportError, match=message):
        quantise(layers, calibration | damage, "w8")
