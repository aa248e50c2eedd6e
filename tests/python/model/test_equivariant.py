"""The equivariant FConn: NumPy, JAX, the exporter and C agree, whatever the weights."""

import json
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest
from support import build_model, load_model

from edmlift import joints as skeleton
from export import cli, quantise
from export import equivariant as layout
from export.calibrate import activations, calibrate
from export.kinds import EQUIVARIANT, read_network
from export.layers import ExportError, Layer
from export.quantise import METRE, WORD
from model import equivariant, reference

MANIFEST = {
    "fewest_joints": 10,
    "max_aspect": 3,
    "missing": "imputed",
    "objective": "none",
    "refine_steps": 0,
    "mirror": [0.5, -1.25, 0.1, 2, 0],
}


@pytest.fixture(scope="module")
def edms() -> np.ndarray:
    """On a grid on which floats are exact in Q24."""
    return (np.random.default_rng(3).integers(0, 3 << 20, (200, 91)) / (1 << 20)).astype(np.float32)


@pytest.fixture(scope="module")
def params() -> dict:
    """Random weights; distances of the size of a trained network's."""
    start = equivariant.init(np.full(91, 0.8), 4, hidden=(40, 56))
    rng = np.random.default_rng(5)
    return {
        name: value * 3 if name == "weight2" else value + rng.normal(0, 0.02, value.shape)
        for name, value in start.items()
        if name != "bias2"
    } | {"bias2": start["bias2"]}


@pytest.fixture
def folder(tmp_path: Path, params, edms) -> Path:
    np.savez(tmp_path / "net.npz", **equivariant.to_arrays(params))
    kind, layers = read_network(tmp_path / "net.npz")
    assert kind is EQUIVARIANT
    calibration = calibrate(layers, edms.astype(float), layout.PLAN)
    (tmp_path / "net.json").write_text(json.dumps(MANIFEST | {"calibration": calibration}))
    return tmp_path


def pairs(params) -> list[Layer]:
    arrays = equivariant.to_arrays(params)
    return [Layer(arrays[f"weight{k}"], arrays[f"bias{k}"]) for k in range(3)]


def predict(folder: Path, form: str, edms: np.ndarray) -> np.ndarray:
    """Distances [F,91] by edml_predict() of the exported model."""
    options = [] if form == "f32" else ["--quantise", form]
    header = folder / f"their_{form}.h"
    command = [str(folder / "net.npz"), "--name", "their", "--out", str(header), *options]
    assert cli.main(command) == 0
    return load_model(build_model(header), f"their_{form}")(edms)


def test_mirror_pairs_are_pairs_with_left_for_right():
    assert len(skeleton.PAIR_MIRROR) == 49
    assert sorted(set(skeleton.PAIR_MIRROR.ravel())) == list(range(91))
    for first, second in skeleton.PAIR_MIRROR:
        joints = {skeleton.MIRROR[axis[first]] for axis in skeleton.PAIRS}
        assert joints == {axis[second] for axis in skeleton.PAIRS}
    own = skeleton.PAIR_MIRROR[:, 0] == skeleton.PAIR_MIRROR[:, 1]
    assert own.tolist() == [False] * 42 + [True] * skeleton.SELF_MIRRORED


def test_training_is_the_oracle(params, edms):
    found = np.asarray(equivariant.predict(params, jnp.asarray(edms)))
    assert found.std() > 0.1
    for edm, distance in zip(edms, found, strict=True):
        np.testing.assert_allclose(distance, reference.net(pairs(params), edm), atol=2e-5)


def test_left_and_right_are_alike(params, edms):
    swapped = np.empty(91, int)
    swapped[skeleton.PAIR_MIRROR] = skeleton.PAIR_MIRROR[:, ::-1]
    there = np.asarray(equivariant.predict(params, jnp.asarray(edms[:, swapped])))
    back = np.asarray(equivariant.predict(params, jnp.asarray(edms)))[:, swapped]
    np.testing.assert_allclose(there, back, atol=1e-5)
    assert np.abs(there - back[:, swapped]).mean() > 0.02


def test_c_is_the_oracle(folder, params, edms):
    found = predict(folder, "f32", edms)
    for edm, distance in zip(edms, found, strict=True):
        np.testing.assert_allclose(distance, reference.net(pairs(params), edm), atol=1e-5)


@pytest.mark.parametrize("form", ["w16", "w8"])
def test_c_in_integers_is_numpy_exactly(folder, params, edms, form):
    calibration = json.loads((folder / "net.json").read_text())["calibration"]
    network = quantise.quantise(pairs(params), calibration, form, layout.PLAN)
    whole = np.rint(edms.astype(float) * METRE).astype(np.int64)
    expected = quantise.run(network, whole, layout.PLAN)
    assert np.array_equal(predict(folder, form, edms), (expected / METRE).astype(np.float32))
    exact = activations(pairs(params), edms.astype(float), layout.PLAN)[-1]
    error = np.sqrt(np.mean((expected / METRE - exact) ** 2) / np.mean(exact**2))
    assert error < {"w16": 0.003, "w8": 0.03}[form]  # a random network enlarges roundings


@pytest.mark.parametrize("form", ["w16", "w8"])
def test_no_sum_can_overflow(folder, params, form):
    """Both units of a mirror pair are within 0 and the largest activation; checked are the sums of
    even and of odd weights, and their sum and difference."""
    calibration = json.loads((folder / "net.json").read_text())["calibration"]
    network = quantise.quantise(pairs(params), calibration, form, layout.PLAN)
    most, fullest = quantise.ACTIVATION // 2, 0
    for k, dense in enumerate(network):
        assert dense.clamp == (most if k < 2 else 3 * METRE)
        even, odd = np.split(
            dense.weight.astype(np.int64), [49 if k == 0 else len(dense.weight) // 2]
        )
        up, down = (np.maximum(sign * even, 0).sum(0) * 2 * most for sign in (1, -1))
        aside = np.abs(odd).sum(0) * most
        highest, lowest = dense.bias + up + aside, dense.bias - down - aside
        assert highest.max() < WORD and lowest.min() >= -WORD
        fullest = max(fullest, highest.max(), -lowest.min())
    assert form == "w8" or fullest > 0.99 * WORD  # no bit is wasted


def refused(folder: Path, capsys, **arrays: np.ndarray) -> str:
    with np.load(folder / "net.npz") as file:
        both = dict(file) | arrays
    np.savez(folder / "net.npz", **both)
    assert cli.main([str(folder / "net.npz"), "--out", str(folder / "x.h")]) == 1
    assert not (folder / "x.h").exists()
    return capsys.readouterr().err


def test_other_shapes_are_refused(folder, capsys):
    odd = {"weight0": np.ones((91, 36), np.float32), "bias0": np.ones(36, np.float32)}
    odd |= {"weight1": np.ones((72, 56), np.float32)}
    assert "layer 0: 36 outputs, not a multiple of 8" in refused(folder, capsys, **odd)
    wide = {"weight0": np.ones((91, 104), np.float32), "bias0": np.ones(104, np.float32)}
    wide |= {"weight1": np.ones((208, 56), np.float32)}
    assert "layer 0 is 208 wide, at most 192 fit" in refused(folder, capsys, **wide)
    short = {"weight1": np.ones((40, 56), np.float32), **odd}
    short |= {"weight0": np.ones((91, 40), np.float32), "bias0": np.ones(40, np.float32)}
    short["weight1"] = np.ones((40, 56), np.float32)
    assert "layer 1 takes 40 values, layer 0 gives 80" in refused(folder, capsys, **short)


def test_dropout_is_refused(params, edms):
    with pytest.raises(ValueError, match="no dropout"):
        equivariant.forward(params, jnp.asarray(edms), None, 0.5)


def test_what_a_hidden_layer_cannot_be(params):
    layers = pairs(params)
    crooked = layers[2].weight.copy()
    crooked[-1, 45] = 1e-3
    with pytest.raises(ExportError, match="the last 7 outputs, their own mirror, have odd weights"):
        layout.checked([*layers[:2], (crooked, layers[2].bias)])
    with pytest.raises(ExportError, match="the last layer gives 48 values, not 49"):
        layout.checked([*layers[:2], (layers[2].weight[:, :48], layers[2].bias[:48])])
