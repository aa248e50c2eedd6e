"""The equivariant networks: NumPy, JAX, the exporter and C agree, whatever the weights."""

import ctypes
import json
from pathlib import Path
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
import pytest
from motions import people
from support import build_model, load_network

from edmlift import joints as skeleton
from edmlift.joints import mid_hip
from export import cli, quantise
from export.calibrate import activations, calibrate
from export.kinds import EQUIVARIANT, Kind, read_network
from export.layers import ExportError, Layer
from export.quantise import METRE, WORD
from model import constants, equivariant, jax_stages, layout, lifter, reference
from training.recipe import RECIPES
from training.views import Views, draw_2d

HIDDEN = (40, 56)
POSITIONS = 5e-5  # metres
FUSION = {"share": 1.0, "misfit": 0.5, "distance": 4.0}
MANIFEST = {"fewest_joints": 10, "missing": "imputed", "fusion": FUSION, "mds_share": 0.25}
FORMS = ("w16", "w8")


class Net(NamedTuple):
    """A random network and what it reads."""

    kind: Kind
    params: dict  # of model/lifter.py
    layers: list[Layer]
    inputs: np.ndarray  # [F,in], on a grid on which floats are exact in Q24

    @property
    def rows(self) -> int:
        return len(self.layers[-1].bias)

    @property
    def model(self) -> reference.Model:
        settings = {name: MANIFEST[name] for name in ("fewest_joints", "fusion", "mds_share")}
        return reference.Model(self.layers, imputation=constants.imputation(), **settings)


@pytest.fixture(scope="module")
def views() -> Views:
    """Some with joints missing, half of them with up."""
    return draw_2d(people(200).joints, RECIPES["distances"], np.random.default_rng(3))


@pytest.fixture(scope="module")
def image(views) -> jax_stages.Image:
    return jax_stages.body_frame(views.keypoints, constants.imputation())


@pytest.fixture(scope="module", params=layout.KINDS)
def net(request, views, image) -> Net:
    """Random weights; outputs of the size of a trained network's."""
    name = request.param
    known, rng = layout.layout(name), np.random.default_rng(5)
    inputs = np.concatenate(lifter.inputs(name, image, views.up), 1)
    inputs = (np.rint(inputs * 2**20) / 2**20).astype(np.float32)
    params = lifter.init(name, HIDDEN, people().joints, inputs, 4)
    params |= {
        part: value + jnp.asarray(rng.normal(0, 0.02, value.shape), jnp.float32)
        for part, value in params.items()
        if part.startswith(("weight", "bias"))
    }
    rows = equivariant.forward(params, known, inputs[:, : known.even], inputs[:, known.even :])
    params["weight2"] /= np.abs(rows[0] - params["bias2"]).max()
    params |= {"fusion": jnp.log(jnp.array([0.5, 4.0])), "mds_share": -jnp.log(3.0)}
    arrays = equivariant.to_arrays(params, known)
    layers = [
        Layer(*(arrays[f"{part}{k}"].astype(np.float32) for part in ("weight", "bias")))
        for k in range(3)
    ]
    return Net(EQUIVARIANT[name], params, layers, inputs)


@pytest.fixture
def folder(tmp_path: Path, net: Net) -> Path:
    save(tmp_path / "net.npz", net.layers)
    kind, layers = read_network(tmp_path / "net.npz")
    assert kind is net.kind
    calibration = calibrate(layers, net.inputs.astype(float), kind.plan)
    (tmp_path / "net.json").write_text(json.dumps(MANIFEST | {"calibration": calibration}))
    return tmp_path


def save(path: Path, layers: list[Layer]) -> None:
    arrays = {f"weight{k}": layer.weight for k, layer in enumerate(layers)}
    np.savez(path, **arrays, **{f"bias{k}": layer.bias for k, layer in enumerate(layers)})


def integers(folder: Path, net: Net, form: str) -> list[quantise.Dense]:
    calibration = json.loads((folder / "net.json").read_text())["calibration"]
    return quantise.quantise(net.layers, calibration, form, net.kind.plan)


def exported(folder: Path, form: str) -> Path:
    """A shared library with edml_their_FORM."""
    options = [] if form == "f32" else ["--quantise", form]
    header = folder / f"their_{form}.h"
    command = [str(folder / "net.npz"), "--name", "their", "--out", str(header), *options]
    assert cli.main(command) == 0
    return build_model(header)


def oracle(net: Net, inputs: np.ndarray) -> np.ndarray:
    """Rows and mirror rows [F,2 rows] of the reference."""
    even = net.kind.even_inputs
    rows = [reference.equivariant(net.layers, x[:even], x[even:]) for x in inputs.astype(float)]
    return np.array(rows).reshape(len(inputs), -1)


# ---- NumPy and JAX -----------------------------------------------------------------------------


def test_mirror_pairs_are_pairs_with_left_for_right():
    assert len(skeleton.PAIR_MIRROR) == 49
    assert sorted(set(skeleton.PAIR_MIRROR.ravel())) == list(range(91))
    for first, second in skeleton.PAIR_MIRROR:
        joints = {skeleton.MIRROR[axis[first]] for axis in skeleton.PAIRS}
        assert joints == {axis[second] for axis in skeleton.PAIRS}
    own = skeleton.PAIR_MIRROR[:, 0] == skeleton.PAIR_MIRROR[:, 1]
    assert own.tolist() == [False] * 42 + [True] * skeleton.SELF_MIRRORED


@pytest.mark.slow
@pytest.mark.parametrize("imputed", [True, False])
def test_the_body_frame_is_the_oracles(views, imputed):
    table = constants.imputation() if imputed else None
    mine = jax_stages.body_frame(views.keypoints, table)
    edms = jax_stages.edm_2d(mine, imputed)
    for k, keypoints in enumerate(views.keypoints.astype(float)):
        theirs = reference.body_frame(keypoints, 10, table)
        np.testing.assert_allclose(mine.at[k], theirs.at, atol=2e-4)
        np.testing.assert_allclose(mine.down[k], theirs.down, atol=1e-4)
        assert np.array_equal(mine.seen[k], theirs.seen)
        both = theirs.seen[skeleton.PAIRS[0]] & theirs.seen[skeleton.PAIRS[1]] | imputed
        np.testing.assert_allclose(edms[k], reference.edm(theirs) * both, atol=4e-4)


def test_the_body_frame_stands_a_turned_person_up(views):
    """However the camera is rolled: the same joints."""
    table = constants.imputation()
    whole = np.column_stack([views.truth[0, :, :2], np.ones(14)]).astype(float)
    upright = reference.body_frame(whole, 10, table)
    for angle in (0.5, 2.0, np.pi):
        rolled = whole.copy()
        axes = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        rolled[:, :2] = whole[:, :2] @ np.array(axes)
        np.testing.assert_allclose(
            reference.body_frame(rolled, 10, table).at, upright.at, atol=1e-9
        )


@pytest.mark.slow
def test_inputs_are_the_oracles(net, views, image):
    mine = [np.asarray(x) for x in lifter.inputs(net.kind.model, image, views.up)]
    assert [x.shape[1] for x in mine] == [
        net.kind.even_inputs, net.kind.inputs - net.kind.even_inputs
    ]  # fmt: skip
    assert max(np.abs(x).max() for x in mine) < 8
    for k, up in enumerate(views.up):
        at = reference.Image(*(np.asarray(part[k], float) for part in image))
        at = reference.Image(at.at, at.seen > 0, at.down)
        told = up.astype(float) if up.any() else None
        theirs = reference.inputs(at, told, net.kind.model == "distances")
        for one, other in zip(mine, theirs, strict=True):
            np.testing.assert_allclose(one[k], other, atol=1e-4)


@pytest.mark.slow
def test_the_network_is_the_oracles(net):
    even = net.kind.even_inputs
    known = layout.layout(net.kind.model)
    rows = equivariant.forward(net.params, known, net.inputs[:, :even], net.inputs[:, even:])
    expected = oracle(net, net.inputs)
    assert expected.std(0).max() > 0.03
    np.testing.assert_allclose(np.concatenate(rows, 1), expected, atol=5e-5)
    plain = activations(net.layers, net.inputs.astype(float), net.kind.plan)[-1]
    np.testing.assert_allclose(plain, expected, atol=1e-9)


def jax_poses(net: Net, views: Views) -> np.ndarray:
    """[F,14,3], mid-hip at 0."""
    image = jax_stages.body_frame(views.keypoints, constants.imputation())
    output = lifter.run(net.kind.model, net.params, image, views.up)
    pose = np.asarray(lifter.poses(net.params, image, output), float)
    return pose - mid_hip(pose)[:, None]


@pytest.mark.slow
def test_the_lift_is_the_oracles(net, views):
    mine = jax_poses(net, views)
    off = []
    for pose, keypoints, up in zip(mine, views.keypoints, views.up, strict=True):
        told = up.astype(float) if up.any() else None
        expected, misfit = reference.lift(net.model, keypoints.astype(float), told)
        assert misfit > 0
        off.append(np.abs(pose - expected).max())
    # Rounding chooses the mirror image or the axes of a few poses of a random network.
    assert np.median(off) < 1e-4 and np.mean(np.array(off) < 5e-3) > 0.95


@pytest.mark.slow
def test_left_and_right_are_alike(net, views):
    keypoints = views.keypoints[:, skeleton.MIRROR] * np.array([-1, 1, 1], np.float32)
    flipped = Views(keypoints, views.truth, views.up * np.array([-1, 1, 1], np.float32))
    back = skeleton.mirrored(jax_poses(net, flipped))
    there = jax_poses(net, views)
    off = np.abs(there - back).max((1, 2))
    assert np.median(off) < 1e-4 and np.mean(off < 5e-3) > 0.95
    assert np.abs(there - jax_poses(net, flipped)).mean() > 0.02


# ---- C -----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_c_is_the_oracle(folder, net):
    run = load_network(exported(folder, "f32"), "their_f32", net.rows)
    np.testing.assert_allclose(run(net.inputs), oracle(net, net.inputs), atol=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_c_in_integers_is_numpy_exactly(folder, net, form):
    network = integers(folder, net, form)
    highest = 8 * METRE - 1
    extremes = [np.full(net.kind.inputs, x) for x in (0, highest, -highest - 1)]
    extremes += [np.where(np.arange(net.kind.inputs) % 2, highest, -highest)]
    whole = np.concatenate([np.rint(net.inputs.astype(float) * METRE), extremes]).astype(np.int64)
    expected = quantise.run(network, whole, net.kind.plan)
    run = load_network(exported(folder, form), f"their_{form}", net.rows)
    assert np.array_equal(run(whole), expected)
    assert expected.min() < 0 and np.abs(expected).max() <= 3 * METRE
    exact = activations(net.layers, net.inputs.astype(float), net.kind.plan)[-1]
    of = net.kind.plan.measured
    error = (expected[:-4, of] / METRE - exact[:, of]) / np.sqrt(np.mean(exact[:, of] ** 2))
    error = np.sqrt(np.mean(error**2))
    assert error < {"w16": 0.003, "w8": 0.06}[form]  # a random network enlarges roundings
    noted = json.loads((folder / "net.json").read_text())["calibration"]["rms"][form]
    assert noted["percent"] == pytest.approx(100 * error, abs=2e-3)


class Pose(ctypes.Structure):
    _fields_ = [
        ("joint", ctypes.c_float * 42), ("misfit", ctypes.c_float), ("seen", ctypes.c_uint16)
    ]  # fmt: skip


def c_lift(shared: Path, name: str, keypoints: np.ndarray, up: np.ndarray) -> tuple:
    """edml_lift(): poses [F,14,3] and misfits [F]; an up of 0 is not told."""
    c = ctypes.CDLL(str(shared))
    model = ctypes.byref(ctypes.c_char.in_dll(c, f"edml_{name}"))
    c.edml_model_work_bytes.restype = ctypes.c_size_t
    size = ctypes.c_size_t(c.edml_model_work_bytes(model))
    work, poses = ctypes.create_string_buffer(size.value), []
    for k, direction in zip(keypoints, up, strict=True):
        arrays = [np.ascontiguousarray(array, np.float32) for array in (k, direction)]
        given, told = (ctypes.c_void_p(array.ctypes.data) for array in arrays)
        pose = Pose()
        told = told if direction.any() else None
        assert c.edml_lift(ctypes.byref(pose), given, told, model, work, size) == 0
        poses.append(pose)
    joints = np.array([pose.joint for pose in poses]).reshape(-1, 14, 3)
    return joints, np.array([pose.misfit for pose in poses])


@pytest.mark.slow
def test_the_lift_of_c_is_the_oracles(folder, net, views):
    joints, misfits = c_lift(exported(folder, "f32"), "their_f32", views.keypoints, 3 * views.up)
    off = []
    for k, (keypoints, up) in enumerate(zip(views.keypoints, views.up, strict=True)):
        told = up.astype(float) if up.any() else None
        expected, misfit = reference.lift(net.model, keypoints.astype(float), told)
        off.append(np.linalg.norm(joints[k] - expected, axis=1).max())
        assert misfits[k] == pytest.approx(misfit, abs=1e-3) or off[-1] > POSITIONS
    assert np.median(off) < POSITIONS and np.mean(np.array(off) < 1e-3) > 0.95


# ---- The proof ---------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_no_sum_can_overflow(folder, net, form):
    """Both units of a mirror pair are within 0 and the largest activation, inputs within +-8;
    checked are the sums of even and of odd weights, and their sum and difference."""
    most, fullest, network = quantise.ACTIVATION // 2, 0, integers(folder, net, form)
    for k, dense in enumerate(network):
        assert dense.clamp == (most if k < len(network) - 1 else 3 * METRE >> 8)
        count = net.kind.even_inputs if k == 0 else len(dense.weight) // 2
        even, odd = np.split(dense.weight.astype(np.int64), [count])
        if k == 0:
            up = down = np.abs(even).sum(0) * (1 << 15)
            aside = np.abs(odd).sum(0) * (1 << 15)
        else:
            up, down = (np.maximum(sign * even, 0).sum(0) * 2 * most for sign in (1, -1))
            aside = np.abs(odd).sum(0) * most
        highest, lowest = dense.bias + up + aside, dense.bias - down - aside
        assert highest.max() < WORD and lowest.min() > -WORD
        fullest = max(fullest, highest.max(), -lowest.min())
    assert form == "w8" or fullest > 0.99 * WORD  # no bit is wasted


@pytest.mark.slow
def test_calibration_measures_both_of_a_mirror_pair(folder, net):
    """Means of odd inputs are 0: a view's mirror image is as likely as the view."""
    noted = json.loads((folder / "net.json").read_text())["calibration"]
    count = net.kind.even_inputs
    for k, mean in enumerate(noted["mean"]):
        assert np.any(mean[:count]) and not np.any(mean[count:])
        count = HIDDEN[k] if k < len(HIDDEN) else None
    assert noted["views"] == len(net.inputs)


@pytest.mark.slow
def test_gates_do_not_count_as_metres(net):
    known = layout.layout(net.kind.model)
    rows = len(known.has_even)
    assert not set(net.kind.plan.measured) & {
        *range(rows - 8, rows),
        *range(2 * rows - 8, 2 * rows),
    }
    expected = 91 + 3 * 14 if net.kind.model == "distances" else 3 * 14
    assert len(net.kind.plan.measured) == expected


# ---- The header --------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_model_says_what_it_reads_and_gives(folder, net):
    exported(folder, "w16")
    text = (folder / "their_w16.h").read_text()
    model = text.split("const edml_model edml_their_w16 = {\n")[1].splitlines()
    of_distances = net.kind.model == "distances"
    assert model[2:] == [
        "    NULL,",
        "    edml__equivariant_w16,",
        "    edml__equivariant_checksum_w16,",
        "    their_w16_layers,",
        "    3, /* layers */",
        "    EDML_READS_BODY | EDML_READS_DISTANCES," if of_distances else "    EDML_READS_BODY,",
        "    EDML_GIVES_DISTANCES | EDML_GIVES_POINTS | EDML_GIVES_GATES,"
        if of_distances
        else "    EDML_GIVES_POINTS | EDML_GIVES_GATES,",
        f"    {137 if of_distances else 46}, /* inputs */",
        f"    {74 if of_distances else 25}, /* even ones */",
        f"    {81 if of_distances else 32}, /* outputs */",
        "    10, /* fewest joints */",
        "    sizeof(edml_work),",
        "    sizeof(edml_work_q),",
        "    &edml_default_imputation,",
        "    edml__scale_and_align," if of_distances else "    NULL,",
        "    edml__scale_and_align_q," if of_distances else "    NULL,",
        "    EDML_STRESS_NONE,",
        "    0, /* refinement steps */",
        "    {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}}, /* mirror */",
        f"    {{{{0x1p0F, {1 << 24}}}, {{0x1p-2F, {1 << 22}}}, {{0x1p-2F, {1 << 22}}}}}, "
        "/* fusion: share 1, misfit 0.5 m, distance 4 m */",
        f"    {{0x1p-2F, {1 << 22}}}, /* MDS share: 0.25 */",
        "};",
    ]
    outputs = "147" if of_distances else "56"
    shape = f"{137 if of_distances else 46}-80-112-{outputs}, equivariant to left and right"
    assert f" * layers      {shape}, relu after each but the last\n" in text


# ---- What is refused ---------------------------------------------------------------------------


def refused(folder: Path, capsys, layers: list[Layer]) -> str:
    save(folder / "net.npz", layers)
    assert cli.main([str(folder / "net.npz"), "--out", str(folder / "x.h")]) == 1
    assert not (folder / "x.h").exists()
    return capsys.readouterr().err


def ones(inputs: int, outputs: int) -> Layer:
    return Layer(np.ones((inputs, outputs), np.float32), np.ones(outputs, np.float32))


@pytest.mark.slow
def test_other_shapes_are_refused(folder, net, capsys):
    inputs, rows, last = net.kind.inputs, net.rows, net.layers[-1]
    said = refused(folder, capsys, [ones(inputs, 36), ones(72, 56), last])
    assert "layer 0: 36 outputs, not a multiple of 8" in said
    wide = constants.MAX_UNITS // 2 + 8
    said = refused(folder, capsys, [ones(inputs, wide), ones(2 * wide, 56), last])
    assert f"layer 0 is {2 * wide} wide, at most {constants.MAX_UNITS} fit" in said
    said = refused(folder, capsys, [ones(inputs, 40), ones(40, 56), last])
    assert "layer 1 takes 40 values, layer 0 gives 80" in said
    said = refused(folder, capsys, [ones(91, 40), ones(80, 56), last])
    assert f"layer 0 takes 91 values, the image gives {inputs}" in said
    said = refused(folder, capsys, [*net.layers[:2], ones(112, 48)])
    assert f"the last layer gives 48 values, not {rows}" in said


@pytest.mark.slow
@pytest.mark.parametrize("part", ["even weight", "odd weight", "bias"])
def test_rows_that_are_their_own_mirror_image(net, part):
    """The weights that such a row does not have must be 0."""
    known, last = layout.layout(net.kind.model), net.layers[-1]
    weight, bias = last.weight.copy(), last.bias.copy()
    half = len(weight) // 2
    if part == "odd weight":
        row = np.flatnonzero(~known.has_odd)[-1]
        weight[half + 3, row] = 1e-3
    elif known.has_even.all():
        return  # `distances` has no such row
    else:
        row = np.flatnonzero(~known.has_even)[0]
        weight[3, row], bias[row] = (1e-3, 0) if part == "even weight" else (0, 1e-3)
    with pytest.raises(ExportError, match=f"output row {row}, its own mirror image, has an {part}"):
        net.kind.checked([*net.layers[:2], (weight, bias)])


@pytest.mark.slow
def test_a_manifest_must_have_what_the_kind_needs(folder, net, capsys):
    (folder / "net.json").write_text(json.dumps({"missing": "imputed"}))
    assert cli.main([str(folder / "net.npz"), "--out", str(folder / "x.h")]) == 1
    needs = "fewest_joints, fusion"
    needs += ", mds_share" if net.kind.model == "distances" else ""
    assert f"net.json lacks {needs}\n" in capsys.readouterr().err


@pytest.mark.slow
def test_units_that_fire(net):
    """Of a pair: where the sum of its two activations is not 0."""
    count = net.kind.even_inputs
    even, odd = jnp.asarray(net.inputs[:, :count]), jnp.asarray(net.inputs[:, count:])
    rates = equivariant.fires(net.params, layout.layout(net.kind.model), even, odd)
    values = activations(net.layers, net.inputs.astype(float), net.kind.plan)[1:-1]
    for rate, value, units in zip(rates, values, HIDDEN, strict=True):
        np.testing.assert_allclose(rate, (value[:, :units] > 0).mean(0), atol=0.006)
    dead = net.params | {"bias1": net.params["bias1"].at[7].set(-1e3)}
    rates = equivariant.fires(dead, layout.layout(net.kind.model), even, odd)
    assert rates[1][7] == 0 and rates[1].mean() > 0.5
