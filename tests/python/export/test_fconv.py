"""The weights of an FConv and what export_weights.py makes of them: folding, short weights, headers
that C runs as the oracle says, and errors."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from builds import long_but
from support import ROOT, build_model, load_network

from export import cli, fconv, quantise
from export.calibrate import activations, calibrate
from export.cli import main
from export.kinds import FCONV, read_network
from export.layers import ExportError, Layer, digest
from export.quantise import METRE
from model import reference
from model.fconv_weights import NAMES, STAGES, fold, round_weights, unit_of

sys.path.insert(0, str(ROOT / "tests" / "vectors"))

import make_fconv_vectors  # noqa: E402

MANIFEST = {
    "fewest_joints": 10,
    "objective": "none",
    "refine_steps": 0,
    "mirror": [0.5, -1.25, 0.1, 2, 0],
}
WIDTHS = {"small": (8, 24, 16, 8), "paper": (64, 64, 64, 64)}


def trained(widths: tuple[int, ...], seed: int = 1) -> dict[str, np.ndarray]:
    """Random arrays as training gives them: distances of about 0.8 m."""
    rng = np.random.default_rng(seed)
    params, channels = {}, 1
    for stage, outputs in zip(STAGES, widths, strict=True):
        deviation = np.sqrt((8 if stage.up else 2) / (49 * channels))
        params[f"{stage.name}_weight"] = rng.normal(0, deviation, (7, 7, channels, outputs))
        params[f"{stage.name}_bias"] = rng.normal(0, 0.05, outputs)
        channels = outputs
    for bn, outputs in (("bn1", widths[0]), ("bn2", widths[1])):
        params[f"{bn}_scale"] = rng.uniform(-0.5, 1.5, outputs)
        params[f"{bn}_shift"] = rng.normal(0, 0.2, outputs)
        params[f"{bn}_mean"] = rng.normal(0, 0.2, outputs)
        params[f"{bn}_variance"] = rng.uniform(0.5, 2, outputs)
    params["conv3_weight"] = rng.normal(0, 0.15 / np.sqrt(channels), channels)
    params["conv3_bias"] = np.array([0.8])
    return {name: array.astype(np.float32) for name, array in params.items()}


@pytest.fixture(scope="module")
def edms() -> np.ndarray:
    """[20,91], multiples of 1/4096; some pairs were not seen."""
    edms = np.random.default_rng(2).uniform(0.1, 2.5, (20, 91))
    edms[3:6, ::3] = 0
    return (np.rint(edms * 4096) / 4096).astype(np.float32)


@pytest.fixture(scope="module", params=long_but(["small"], WIDTHS))
def params(request: pytest.FixtureRequest) -> dict[str, np.ndarray]:
    """Trained arrays, of the paper's width and of others."""
    return trained(WIDTHS[request.param])


@pytest.fixture
def folder(tmp_path: Path, params, edms) -> Path:
    """A folder with net.npz, folded and short, and its manifest, calibrated."""
    return save(tmp_path, round_weights(fold(params)), edms)


def save(folder: Path, arrays: dict[str, np.ndarray], edms: np.ndarray | None = None) -> Path:
    np.savez(folder / "net.npz", **arrays)
    manifest = dict(MANIFEST)
    if edms is not None:
        layers = fconv.layers_of(arrays)
        manifest["calibration"] = calibrate(layers, edms, fconv.PLAN, FCONV.parts)
    (folder / "net.json").write_text(json.dumps(manifest))
    return folder


def export(folder: Path, form: str = "f32") -> tuple[int, Path]:
    out = folder / f"net_{form}.h"
    options = [] if form == "f32" else ["--quantise", form]
    arguments = [folder / "net.npz", "--name", "their", *options, "--out", out]
    return main([str(argument) for argument in arguments]), out


# ---- Weights -----------------------------------------------------------------------------------


def test_the_paper_has_as_many_parameters():
    counted = [a.size for name, a in trained(WIDTHS["paper"]).items()
               if not name.endswith(("mean", "variance"))]  # fmt: skip
    assert sum(counted) == 605_825


def test_folding_changes_nothing(params, edms):
    folded = fold(params)
    assert not any(name.startswith("bn") for name in folded)
    before, after = (np.array([reference.fconv(p, e) for e in edms[:4]]) for p in (params, folded))
    assert np.ptp(before) > 0.05  # something to be changed
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-5)
    again = fold(folded)
    assert all(np.array_equal(again[name], array) for name, array in folded.items())


def test_short_weights_are_near_and_exact_in_half_precision(params):
    folded = fold(params)
    folded["conv1_weight"][0, 0, 0, 0] = -1e-9  # would be a negative zero
    for name, short in round_weights(folded).items():
        if name.endswith("bias"):
            assert np.array_equal(short, folded[name])
            continue
        unit = unit_of(short.astype(np.float32))
        steps = short.astype(float) / 2.0**unit
        assert short.dtype == np.float16 and np.array_equal(steps, np.rint(steps))
        assert 1023 < np.abs(steps).max() <= 2047
        assert np.abs(short - folded[name].astype(float)).max() <= 2.0 ** (unit - 1)
        assert not np.signbit(short[short == 0]).any()


def test_weights_that_are_not_short_have_no_unit():
    assert unit_of(np.array([1.0, 1 / 3])) is None
    assert unit_of(np.array([1.0, -0.0])) is None
    assert unit_of(np.zeros(3)) is None
    assert unit_of(np.array([0.5, 0.25])) is not None


def test_the_batch_of_quantise_is_the_reference(params, edms):
    folded = fold(params)
    layers = fconv.layers_of(folded)
    batch = activations(layers, edms[:4].astype(float), fconv.PLAN)[-1]
    for edm, distance in zip(edms, batch, strict=False):
        np.testing.assert_allclose(distance, reference.fconv(folded, edm), rtol=0, atol=1e-12)


def test_taps_count_in_their_share_of_pixels():
    """Measured on the sums of a map of ones under kernels of a single tap."""
    for k, stage in enumerate(STAGES):
        side = fconv.size_before(k)
        kernel = np.eye(49).reshape(49, 49)
        layer = Layer(kernel, np.zeros(49))
        sums = fconv.convolved(np.ones((1, side, side, 1)), k, layer)
        assert sums.shape == (1, stage.side, stage.side, 49)
        np.testing.assert_allclose(sums.mean((0, 1, 2)), fconv.tap_shares(k))


# ---- C -----------------------------------------------------------------------------------------

WARNINGS = "-pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Wshadow -Werror".split()


def predict(folder: Path, form: str, edms: np.ndarray) -> np.ndarray:
    """Distances [F,91] of the exported model; of w8 both are integers."""
    status, header = export(folder, form)
    assert status == 0
    return load_network(build_model(header, *WARNINGS), f"their_{form}", 91)(edms)


@pytest.mark.slow
def test_c_is_the_oracle(folder, edms):
    with np.load(folder / "net.npz") as file:
        arrays = dict(file)
    found = predict(folder, "f32", edms)
    for edm, distance in zip(edms[:6], found, strict=False):
        np.testing.assert_allclose(distance, reference.fconv(arrays, edm), rtol=0, atol=1e-5)


@pytest.mark.slow
def test_c_in_integers_is_numpy_exactly(folder, edms):
    _, layers = read_network(folder / "net.npz")
    calibration = json.loads((folder / "net.json").read_text())["calibration"]
    network = quantise.quantise(layers, calibration, "w8", fconv.PLAN)
    whole = np.rint(edms.astype(float) * METRE).astype(np.int64)
    expected = quantise.run(network, whole, fconv.PLAN)
    assert np.array_equal(predict(folder, "w8", whole), expected)
    exact = activations(layers, edms.astype(float), fconv.PLAN)[-1]
    error = np.sqrt(np.mean((expected / METRE - exact) ** 2))
    assert error < 5e-3
    assert calibration["rms"]["w8"]["mm"] == pytest.approx(1000 * error, abs=2e-3)


def test_weights_that_are_not_short_work_too(tmp_path, edms):
    folded = fold(trained(WIDTHS["small"]))
    found = predict(save(tmp_path, folded), "f32", edms[:2])
    for edm, distance in zip(edms, found, strict=False):
        np.testing.assert_allclose(distance, reference.fconv(folded, edm), rtol=0, atol=1e-5)


# ---- The header --------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_same_weights_give_the_same_header(folder):
    for form in ("f32", "w8"):
        first = export(folder, form)[1].read_bytes()
        assert export(folder, form)[1].read_bytes() == first


@pytest.mark.slow
def test_it_says_what_it_is(folder, params):
    text = export(folder, "w8")[1].read_text()
    weights = sum(params[f"{name}_weight"].size for name in NAMES)
    biases = sum(params[f"{name}_bias"].size for name in NAMES)
    assert f"parameters  {weights + biases}, " in text
    assert "conv1 " in text and "proven within 32 bits" in text and "RMS error" in text
    if len(params["conv1_bias"]) == 64:
        # Windows of whole maps: 14^2, 7^2 and twice 7^2 pixels; those at the border have less.
        counted = int(text.split("parameters")[1].split()[1])
        assert 14e6 < counted < 49 * 64 * (196 + 64 * (49 + 16 + 49))
        assert export(folder, "f32")[1].stat().st_size < 5_000_000


def test_no_header_where_a_sum_could_overflow(tmp_path, monkeypatch, capsys):
    """Rows of like weights: 8 bits of each would be more than the sum has room for."""
    arrays = fold(trained(WIDTHS["small"]))
    arrays["deconv1_weight"][:] = 0.1
    save(tmp_path, arrays)
    (tmp_path / "net.json").write_text(json.dumps(MANIFEST | {"calibration": made_up(arrays)}))
    assert export(tmp_path, "w8")[0] == 0  # it takes fewer bits
    assert "8 to 8, 8 to 8, 7 to 7, 8 to 8" in capsys.readouterr().out
    export(tmp_path, "w8")[1].unlink()
    monkeypatch.setattr(
        quantise, "largest_scales", lambda rows, most: most / np.abs(rows.weight).max(0)
    )
    status, out = export(tmp_path, "w8")
    assert status == 1 and not out.exists()
    assert "layer 2: sums of row 0" in (said := capsys.readouterr().err)
    assert "beyond 32 bits" in said


def made_up(arrays: dict[str, np.ndarray]) -> dict:
    layers = fconv.layers_of(arrays)
    widths = [1, *(len(layer.bias) for layer in layers[:-1])]
    return {
        "weights": digest(layers),
        "views": 1,
        "largest": [4.0] * 4,
        "mean": [[0.3] * width for width in widths],
        "rms": {form: {"mm": 1, "percent": 1} for form in ("w16", "w8")},
    }


@pytest.mark.slow
def test_the_last_layers_sums_leave_a_bit_for_adding_two(folder):
    _, layers = read_network(folder / "net.npz")
    calibration = json.loads((folder / "net.json").read_text())["calibration"]
    network = quantise.quantise(layers, calibration, "w8", fconv.PLAN)
    for k, dense in enumerate(network):
        reach = quantise.input_ranges(fconv.PLAN, k, dense)
        weight, bias = dense.weight.astype(np.int64), dense.bias.astype(np.int64)
        bounds = quantise.sum_bounds(weight, bias, reach)
        limit = 1 << (30 if k == 4 else 31)
        assert -limit < bounds[0].min() and bounds[1].max() < limit
    with pytest.raises(ExportError, match="beyond 31 bits"):
        quantise.prove(network[4]._replace(bias=np.array([1 << 30], np.int64)), 4, reach, 1 << 30)


# ---- Errors ------------------------------------------------------------------------------------


def without(name):
    return lambda arrays: arrays.pop(name)


def reshaped(name, *shape):
    return lambda arrays: arrays.update({name: np.zeros(shape, np.float32)})


def spoilt(name):
    def spoil(arrays):
        arrays[name] = arrays[name].copy()
        arrays[name].flat[5] = np.nan

    return spoil


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without("conv2_bias"), "conv2_bias is missing"),
        (without("conv3_weight"), "conv3_weight is missing"),
        (reshaped("conv1_weight", 7, 7, 2, 8), r"conv1_weight is (7, 7, 2, 8)"),
        (reshaped("deconv1_weight", 5, 5, 24, 16), r"deconv1_weight is (5, 5, 24, 16)"),
        (reshaped("conv2_weight", 7, 7, 8), "conv2_weight has 3 dimensions"),
        (reshaped("conv3_weight", 9), "conv3_weight is (9,)"),
        (reshaped("conv3_bias", 2), "conv3 has 1 outputs, but 2 biases"),
        (reshaped("conv2_bias", 8), "conv2 has 24 outputs, but 8 biases"),
        (reshaped("deconv2_weight", 7, 7, 16, 9), "9"),
        (reshaped("bn1_scale", 8), "bn1_scale: fold the batch normalisation first"),
        (reshaped("conv4_weight", 8), "unknown array conv4_weight"),
        (spoilt("deconv2_weight"), "deconv2_weight[0, 0, 0, 5] is nan"),
        (spoilt("conv1_bias"), "conv1_bias[5] is nan"),
    ],
)
def test_bad_weights_are_named(tmp_path, capsys, change, message):
    arrays = fold(trained(WIDTHS["small"]))
    change(arrays)
    np.savez(tmp_path / "net.npz", **arrays)
    (tmp_path / "net.json").write_text(json.dumps(MANIFEST))
    status, out = export(tmp_path)
    said = capsys.readouterr().err
    assert status == 1 and not out.exists()
    assert message in said and said.count("\n") == 1


def test_channels_come_in_groups_that_fit(tmp_path, capsys):
    for width, fine in ((12, False), (72, False), (16, True)):
        save(tmp_path, fold(trained((8, 8, 8, width))))
        assert export(tmp_path)[0] == (0 if fine else 1)
        assert fine or "8, 16 ... 64" in capsys.readouterr().err


@pytest.mark.slow
def test_it_has_no_16_bit_form(folder, capsys):
    assert export(folder, "w16")[0] == 1
    assert "an fconv is quantised as w8 only" in capsys.readouterr().err


def test_quantising_needs_its_own_calibration(tmp_path, edms, capsys):
    arrays = fold(trained(WIDTHS["small"]))
    save(tmp_path, arrays)
    assert export(tmp_path, "w8")[0] == 1 and "no calibration" in capsys.readouterr().err
    save(tmp_path, arrays, edms)
    other = fold(trained(WIDTHS["small"], seed=2))
    np.savez(tmp_path / "net.npz", **other)
    assert export(tmp_path, "w8")[0] == 1 and "other weights" in capsys.readouterr().err


def test_the_name_follows_the_kind(tmp_path, monkeypatch):
    save(tmp_path, fold(trained(WIDTHS["small"])))
    monkeypatch.setattr(cli, "GEN", tmp_path)
    assert main([str(tmp_path / "net.npz")]) == 0
    assert "edml_fconv_f32" in (tmp_path / "fconv_f32.h").read_text()


# ---- The small network of the C tests ----------------------------------------------------------


def test_its_vectors_are_up_to_date():
    kept = (ROOT / "tests" / "vectors" / "fconv_vectors.h").read_text("utf-8")
    assert kept == make_fconv_vectors.vectors(), "run tests/vectors/make_fconv_vectors.py"
