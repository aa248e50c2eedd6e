"""quantise.py: integers that cannot overflow, that C and NumPy compute alike, and that stay near
the float network; and what export_weights.py makes of them."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from builds import need_cross_compiler
from motions import people
from support import ROOT, build_model, load_network

from edmlift.joints import JOINTS
from export import quantise
from export.calibrate import activations, calibrate
from export.cli import main
from export.kinds import read_network
from export.layers import ExportError, Layer
from export.quantise import ACTIVATION, METRE, WORD, Dense
from reports import targets

LIB = ROOT / "lib"
FORMS = ("w16", "w8")
SHAPE = (91, 120, 128, 91)
MANIFEST = {
    "fewest_joints": 10,
    "objective": "none",
    "refine_steps": 0,
    "mirror": [0.5, -1.25, 0.1, 2, 0],
    "metrics": {"gt": 50.0, "n10": 60.0},
    "metrics_w16": {"gt": 50.1, "n10": 59.5},
}


@pytest.fixture(scope="module")
def edms() -> np.ndarray:
    return np.random.default_rng(3).uniform(0, 3, (500, 91))


@pytest.fixture(scope="module")
def layers(edms) -> list[Layer]:
    """A random network whose distances are of the size of a trained one's; with a dead unit, one
    of no weights, and one whose weights are tiny and those of its readers large."""
    rng = np.random.default_rng(1)
    net = []
    for n, m in zip(SHAPE[:-1], SHAPE[1:], strict=True):
        weight = rng.normal(0.02, 0.7 / np.sqrt(n), (n, m)).astype(np.float32)
        net.append(Layer(weight, rng.normal(0, 0.1, m).astype(np.float32)))
    net[0].weight[:, 5] = 0
    net[0].bias[5] = 0
    net[0].weight[:, 7] *= 1e-3
    net[1].weight[7] *= 300
    net[1].bias[9] = -1
    return scaled_to(net, edms, 2.5)


def scaled_to(layers: list[Layer], edms: np.ndarray, reach: float) -> list[Layer]:
    """The network with distances up to `reach`."""
    by = np.float32(reach / activations(layers, edms)[-1].max())
    return [*layers[:-1], Layer(layers[-1].weight * by, layers[-1].bias * by)]


@pytest.fixture(scope="module")
def calibration(layers, edms) -> dict:
    return calibrate(layers, edms)


@pytest.fixture
def folder(tmp_path: Path, layers, calibration) -> Path:
    """A folder with net.npz and its manifest."""
    save(tmp_path / "net.npz", layers)
    (tmp_path / "net.json").write_text(json.dumps(MANIFEST | {"calibration": calibration}))
    return tmp_path


def save(path: Path, layers: list[Layer]) -> None:
    arrays = {f"weight{k}": layer.weight for k, layer in enumerate(layers)}
    np.savez(path, **arrays, **{f"bias{k}": layer.bias for k, layer in enumerate(layers)})


def export(folder: Path, form: str, **changes: object) -> tuple[int, Path]:
    """Exit status and header of an export, after changes of the manifest; None takes a key away."""
    manifest = json.loads((folder / "net.json").read_text()) | changes
    kept = {name: value for name, value in manifest.items() if value is not None}
    (folder / "net.json").write_text(json.dumps(kept))
    out = folder / "out.h"
    options = [] if form == "f32" else ["--quantise", form]
    return main([str(folder / "net.npz"), *options, "--out", str(out)]), out


def parsed(text: str) -> dict[str, tuple[str, list[int]]]:
    """The arrays of a header: name -> C type, values."""
    pattern = r"static const (\w+_t)(?: EDML_ALIGN4)? (\w+)\[([\d *]+)\] = \{(.*?)\};"
    arrays = {}
    for kind, name, size, body in re.findall(pattern, text, re.DOTALL):
        words = re.sub(r"EDML_(BYTES_)?BLOCK\(|\)|\s", "", body).split(",")
        values = [int(word) for word in words if word]
        assert len(values) == np.prod([int(n) for n in size.split("*")])
        arrays[name] = kind, values
    return arrays


# ---- The network in integers -------------------------------------------------------------------


@pytest.mark.parametrize(("form", "percent"), [("w16", 0.05), ("w8", 2)])
def test_it_stays_near_the_float_network(layers, calibration, edms, form, percent):
    exact = activations(layers, edms)[-1]
    assert exact.max() < 3 and (exact > 0).mean() > 0.5  # something to be near to
    whole = quantise.run(quantise.quantise(layers, calibration, form), np.rint(edms * METRE))
    error = 100 * np.sqrt(np.mean((whole / METRE - exact) ** 2) / np.mean(exact**2))
    assert error < percent
    assert calibration["rms"][form]["percent"] == pytest.approx(error, abs=1e-3)


def test_evening_out_leaves_the_float_network_alone(layers, edms):
    even = quantise.equalised(layers)
    before, after = (activations(net, edms)[-1] for net in (layers, even))
    assert np.allclose(before, after, rtol=0, atol=1e-12)
    spread = [np.abs(net[1].weight).max(1) for net in (layers, even)]
    assert spread[1].max() / spread[1].min() < 0.1 * spread[0].max() / spread[0].min()


@pytest.mark.parametrize("form", FORMS)
def test_the_order_in_memory_does_not_matter(layers, calibration, form):
    other = [Layer(np.asfortranarray(weight), bias) for weight, bias in layers]
    networks = [quantise.quantise(net, calibration, form) for net in (layers, other)]
    for one, two in zip(*networks, strict=True):
        assert all(map(np.array_equal, one, two))


def test_biases_make_up_for_rounded_weights(layers, calibration, edms):
    exact = activations(layers, edms)[-1]
    bias = {}
    for name, mean in {
        "corrected": calibration["mean"],
        "not": [np.zeros_like(m) for m in calibration["mean"]],
    }.items():
        network = quantise.quantise(layers, calibration | {"mean": mean}, "w8")
        off = quantise.run(network, np.rint(edms * METRE)) / METRE - exact
        bias[name] = np.sqrt(np.mean(off.mean(0) ** 2))
    assert bias["corrected"] < 0.5 * bias["not"]


@pytest.mark.parametrize("form", FORMS)
def test_no_sum_can_overflow_and_scales_are_the_largest(layers, calibration, form):
    most = np.iinfo(quantise.WEIGHT_TYPES[form]).max
    for dense in quantise.quantise(layers, calibration, form):
        for row, bias in enumerate(dense.bias.tolist()):
            weights = dense.weight[:, row].tolist()
            assert all(abs(w) <= most for w in weights)
            highest = bias + sum(ACTIVATION * w for w in weights if w > 0)
            lowest = bias + sum(ACTIVATION * w for w in weights if w < 0)
            assert lowest > -WORD and highest < WORD
            full = max(map(abs, weights)) == most or max(highest, -lowest) > 0.999 * WORD
            assert full or not any(weights)
            assert 0 < dense.multiplier[row] < WORD


def test_sums_at_the_bound_are_computed(layers, calibration):
    """Inputs that drive a row to its bound: the model of the kernel agrees with the bound."""
    dense = quantise.quantise(layers, calibration, "w16")[1]
    weight, bias = dense.weight.astype(np.int64), dense.bias.astype(np.int64)
    _, highest = quantise.sum_bounds(weight, bias, reach(dense))
    x = np.where(dense.weight[:, 3] > 0, ACTIVATION, 0)
    assert x @ dense.weight[:, 3].astype(np.int64) + dense.bias[3] == highest[3]
    assert highest[3] > 2**30


def reach(dense: Dense) -> np.ndarray:
    return quantise.input_ranges(quantise.DENSE, 0, dense)


def prove(dense: Dense, number: int) -> None:
    quantise.prove(dense, number, reach(dense))


def dense_of(weight: list[int], bias: int, **changes: int) -> Dense:
    column = np.array(weight, np.int16)[:, None]
    layer = Dense(column, np.array([bias], np.int32), np.array([1], np.int32), 32, 1)
    return layer._replace(**changes)


@pytest.mark.parametrize(
    ("weight", "room"), [([32767, 32767], 2 * 32767**2), ([1, -5, 7], 8 * 32767)]
)
def test_the_proof_is_exact(weight, room):
    most = WORD - 1 - room
    prove(dense_of(weight, most), 0)
    with pytest.raises(ExportError, match="layer 2: sums of row 0 .* beyond 32 bits"):
        prove(dense_of(weight, most + 1), 2)
    flipped = [-w for w in weight]
    prove(dense_of(flipped, -most), 0)
    with pytest.raises(ExportError, match="beyond 32 bits"):
        prove(dense_of(flipped, -most - 1), 0)


@pytest.mark.parametrize("changes", [{"shift": 0}, {"shift": 33}, {"multiplier": np.array([0])}])
def test_the_proof_looks_at_multiplier_and_shift(changes):
    with pytest.raises(ExportError, match="multiplier or shift"):
        prove(dense_of([1], 0, **changes), 0)


@pytest.mark.filterwarnings("ignore:invalid value encountered in cast")  # of a bias
def test_a_network_that_could_overflow_is_not_written(folder, capsys, monkeypatch):
    def of_weights_alone(rows: quantise.Rows, most: int) -> np.ndarray:
        return most / np.maximum(np.abs(rows.weight).max(0), quantise.VANISHING)

    monkeypatch.setattr(quantise, "largest_scales", of_weights_alone)
    (folder / "out.h").write_text("before")
    status, out = export(folder, "w16")
    assert status == 1 and out.read_text() == "before"
    assert re.search(r"layer 0: sums of row \d+ reach .* beyond 32 bits", capsys.readouterr().err)
    assert export(folder, "w8")[0] == 0  # weights of 8 bits leave room


# ---- Headers -----------------------------------------------------------------------------------


@pytest.mark.parametrize("form", FORMS)
def test_the_header_holds_the_network(folder, layers, calibration, form):
    status, out = export(folder, form)
    text = out.read_text()
    arrays = parsed(text)
    checksum = 2166136261
    table = []
    for k, dense in enumerate(quantise.quantise(layers, calibration, form)):
        inputs, outputs = dense.weight.shape
        groups, filled = -(-outputs // 8), -(-inputs // 8) * 8
        weight = [
            int(dense.weight[i, 8 * g + r]) if 8 * g + r < outputs and i < inputs else 0
            for g in range(groups)
            for i in range(filled)
            for r in range(8)
        ]
        padding = groups * 8 - outputs
        kind = {"w16": "int16_t", "w8": "int8_t"}[form]
        name = f"fconn_{form}"
        assert arrays[f"{name}_weight{k}"] == (kind, weight)
        assert arrays[f"{name}_bias{k}"] == ("int32_t", dense.bias.tolist() + [0] * padding)
        assert arrays[f"{name}_multiplier{k}"] == (
            "int32_t", dense.multiplier.tolist() + [1] * padding
        )  # fmt: skip
        names = ", ".join(f"{name}_{array}{k}" for array in ("weight", "bias", "multiplier"))
        table.append(f"    {{{filled}, {outputs}, {names}, {dense.shift}, {dense.clamp}}},")
        assert dense.clamp == (3 << 16 if k == 2 else 32767)
    for kind, values in arrays.values():  # in the header's order
        for value in values:
            for byte in value.to_bytes(int(re.search(r"\d+", kind)[0]) // 8, "little", signed=True):
                checksum = (checksum ^ byte) * 16777619 % 2**32
    assert status == 0 and len(arrays) == 9
    assert f"edml_dense_{form} fconn_{form}_layers[] = {{\n" + "\n".join(table) + "\n};" in text
    model = text.split(f"const edml_model edml_fconn_{form} = {{\n")[1].splitlines()
    assert model[:6] == [
        f'    "fconn_{form}",',
        f"    0x{checksum:08x}u, /* checksum */",
        "    NULL,",
        f"    edml__fconn_{form},",
        f"    edml__fconn_checksum_{form},",
        f"    fconn_{form}_layers,",
    ]


def test_the_header_says_what_was_measured(folder, calibration, capsys):
    _, out = export(folder, "w16")
    head = out.read_text().partition("*/")[0]
    rms = calibration["rms"]["w16"]
    assert f" * RMS error   {rms['mm']:g} mm, {rms['percent']:g} %: " in head
    assert " 500 training views\n" in head
    assert " * error, mm   gt 50.1, n10 59.5\n * loss, mm    gt +0.1, n10 -0.5\n" in head
    assert re.search(r" \* bits        .*: (1\d to 1\d(, |\n)){3}", head)
    assert " * accumulator proven within 32 bits, 0.0 to spare\n" in head
    printed = capsys.readouterr().out
    assert f"RMS error: {rms['mm']:g} mm" in printed and "bytes of flash" in printed
    _, out = export(folder, "w8")
    head = out.read_text().partition("*/")[0]
    assert " * error, mm   not measured\n * loss, mm    not measured\n" in head
    assert " * bits        of the rows' weights, layer by layer: 8 to 8, 8 to 8, 8 to 8\n" in head


def test_bits():
    dense = dense_of([0, 3], 0)._replace(weight=np.array([[3, -128, 0], [2, 5, 0]], np.int16))
    assert quantise.weight_bits(dense) == (3, 9)
    assert quantise.spare_bits([dense_of([2**13, -1], 0)]) == pytest.approx(3, abs=1e-4)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("compiler", ["gcc", "clang", "g++", "clang++"])
def test_the_header_compiles(folder, form, compiler):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    _, out = export(folder, form)
    language = ["-x", "c++", "-std=c++17"] if "++" in compiler else ["-std=c99"]
    (folder / "main.c").write_text('#include "network/kernels.h"\n#include "out.h"\n')
    warnings = ["-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"]
    paths = [f"-I{ROOT / 'lib'}", f"-I{ROOT / 'include'}"]
    command = [compiler, *language, *warnings, *paths, "-fsyntax-only", str(folder / "main.c")]
    result = subprocess.run(command, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")


NETWORK_C = """\
#include "network/kernels.h"
#include "out.h"
#include <stdio.h>

int main(void)
{
    static edml_work_q work;
    const edml_model *model = &edml_fconn_FORM;
    int32_t x[EDML_PAIRS], y[EDML_MAX_VALUES];
    if (edml_model_check(model) != EDML_OK) return 1;
    while (fread(x, sizeof x, 1, stdin) == 1) {
        model->predict_q(y, x, model, &work.of.network.units);
        if (fwrite(y, sizeof x, 1, stdout) != 1) return 1;
    }
    return 0;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_the_library_computes_the_network(folder, layers, calibration, edms, form):
    export(folder, form)
    (folder / "main.c").write_text(NETWORK_C.replace("FORM", form))
    checks = ["-fsanitize=undefined", "-fno-sanitize-recover=all"]
    command = ["gcc", "-std=c99", *checks, *targets.INCLUDES]
    objects = targets.compile_each(command, folder, targets.WITHOUT_MODELS)
    targets.run(*command, folder / "main.c", *objects, "-lm", "-o", folder / "main")
    highest = 127 << 24
    alternating = np.where(np.arange(91) % 2, highest, 0)
    extremes = [np.zeros(91), np.full(91, highest), np.full(91, 2**31 - 1), alternating]
    x = np.concatenate([np.rint(edms * METRE), extremes]).astype(np.int32)
    result = subprocess.run([str(folder / "main")], input=x.tobytes(), capture_output=True)
    assert result.returncode == 0, result.stderr
    y = np.frombuffer(result.stdout, np.int32).reshape(-1, 91)
    assert np.array_equal(y, quantise.run(quantise.quantise(layers, calibration, form), x))
    assert y.max() > METRE


@pytest.mark.parametrize("form", FORMS)
def test_without_an_fpu_no_float_code_is_linked(tmp_path, form):
    target = targets.TARGETS["cortex-m3"]
    need_cross_compiler(target)
    asked, defined = set(), set()
    network = [f"network/{n}" for n in (f"equivariant_{form}", "predict_q", "model")]
    for name in (*network, f"models/distances_{form}", "lift/imputation"):
        item = tmp_path / f"{name.replace('/', '_')}.o"
        compile_it = targets.compiler(target, "-Os")
        targets.run(*compile_it, "-c", LIB / f"{name}.c", "-o", item)
        for line in targets.run(f"{target.system.cross}nm", item).splitlines():
            *_, kind, symbol = line.split()
            (asked if kind == "U" else defined).add(symbol)
    assert asked - defined <= {"memcpy"}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", ["distances", "direct", "fconn"])
def test_the_shipped_network_is_the_network_in_numpy(tmp_path, name, form):
    weights = ROOT / "gen" / f"{name}.npz"
    kind, layers = read_network(weights)
    calibration = json.loads(weights.with_suffix(".json").read_text())["calibration"]
    network = quantise.quantise(layers, calibration, form, kind.plan)
    inputs = np.random.default_rng(3).uniform(-8, 8, (100, kind.inputs)) * METRE
    inputs = np.rint(np.abs(inputs) if kind.even_inputs == 0 else inputs).astype(np.int64)
    out = tmp_path / "out.h"
    assert main([str(weights), "--quantise", form, "--out", str(out)]) == 0
    run = load_network(build_model(out), f"{name}_{form}", kind.outputs)
    assert np.array_equal(run(inputs), quantise.run(network, inputs, kind.plan))


# ---- Calibration -------------------------------------------------------------------------------


@pytest.fixture
def motion(tmp_path: Path) -> Path:
    made_up = people(60)
    fields = {name: getattr(made_up, name) for name in ("joints", "subject", "trial", "frame")}
    np.savez(tmp_path / "motion.npz", **fields, joint_names=JOINTS, up="y", unit="m")
    return tmp_path / "motion.npz"


def calibrated(folder: Path, motion: Path) -> str:
    twice = [str(motion), str(motion)]
    arguments = ["--calibrate", *twice, "--quantise", "w8", "--out", str(folder / "out.h")]
    assert main([str(folder / "net.npz"), *arguments]) == 0
    return (folder / "net.json").read_text()


def test_calibration_is_the_same_each_time(folder, motion):
    export(folder, "f32", calibration=None)
    first = calibrated(folder, motion)
    header = (folder / "out.h").read_bytes()
    assert calibrated(folder, motion) == first
    manifest = json.loads(first)
    assert {name: manifest[name] for name in MANIFEST} == MANIFEST
    assert manifest["calibration"]["views"] == 120
    assert len(first.splitlines()) < 60  # lists of numbers take a line each
    assert export(folder, "w8")[1].read_bytes() == header  # without the motion


def test_calibration_measures_the_network(layers, edms):
    noted = calibrate(layers, edms)
    x = edms
    means, largest = [], []
    for weight, bias in quantise.equalised(layers):
        means.append(x.mean(0))
        x = np.maximum(x @ weight + bias, 0)
        largest.append(x.max())
    assert noted["views"] == 500
    assert noted["largest"] == pytest.approx(largest[:2], abs=1e-4)
    for mean, expected in zip(noted["mean"], means, strict=True):
        assert np.allclose(mean, expected, atol=1e-4)


def test_motion_that_is_not_there(folder, capsys):
    before = (folder / "net.json").read_text()
    assert main([str(folder / "net.npz"), "--calibrate", str(folder / "nothing.npz")]) == 1
    line = capsys.readouterr().err
    assert "nothing.npz" in line and line.count("\n") == 1
    assert (folder / "net.json").read_text() == before


# ---- What is refused ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"calibration": None}, "no calibration; run once with --calibrate"),
        ({"calibration": {"weights": "0"}}, "the calibration is of other weights"),
    ],
)
@pytest.mark.parametrize("form", FORMS)
def test_manifest(folder, capsys, form, changes, message):
    status, out = export(folder, form, **changes)
    line = capsys.readouterr().err
    assert status == 1 and message in line and line.count("\n") == 1
    assert not out.exists()
    assert export(folder, "f32")[0] == 0  # floats need none of it


@pytest.mark.parametrize(
    "changes",
    [
        {"largest": [1.0]},
        {"largest": [0, 1.0]},
        {"largest": [float("nan"), 1.0]},
        {"largest": "1"},
        {"mean": []},
        {"mean": [[1.0], [1.0, 2.0], [0.5] * 91]},
        {"mean": [[float("nan")] * 91, [0] * 120, [0] * 128]},
        {"rms": {}},
    ],
)
def test_damaged_calibration(folder, capsys, calibration, changes):
    status, out = export(folder, "w16", calibration=calibration | changes)
    line = capsys.readouterr().err
    assert status == 1 and "calibration" in line and line.count("\n") == 1
    assert not out.exists()


def test_a_hidden_layer_that_is_never_active(layers, edms):
    dead = [layers[0], Layer(layers[1].weight * 0, layers[1].bias * 0 - 1), layers[2]]
    with pytest.raises(ExportError, match="a hidden layer is always zero"):
        calibrate(dead, edms)


def test_networks_of_other_depths(edms):
    rng = np.random.default_rng(2)
    single = [Layer(rng.normal(0, 0.05, (91, 91)).astype(np.float32), np.ones(91, np.float32))]
    for depth in (1, 4):
        net = scaled_to(single * depth, edms, 2.5)
        noted = calibrate(net, edms)
        assert noted["rms"]["w16"]["percent"] < 0.1
