"""Trained rivals: their networks, their training, and the JSON; on a handful of made-up poses."""

import dataclasses
import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from motions import people, write_motion
from support import run_tool

from edmlift.joints import JOINTS, MIRROR
from experiments import rivals
from model import coordinates, jax_stages, lifter
from training.recipe import EVEN_NOISE, RECIPES
from training.views import Views, draw_2d, imputation_of, pick_poses

PLAIN = rivals.plain(hidden=(16, 16), pose_epochs=3, batch=50, average=0.9)
ALIKE = rivals.alike(hidden=(16, 16), pose_epochs=3, batch=50, average=0.9)
RESIDUAL = rivals.rival(network="residual", hidden=(16,) * 5, pose_epochs=3, batch=100, average=0.9)
SMALL = pytest.mark.parametrize("recipe", [PLAIN, RESIDUAL, ALIKE], ids=rivals.NETWORKS)


def views(count: int = 400) -> Views:
    return draw_2d(people(count).joints, PLAIN, np.random.default_rng(3))


def upright(keypoints: np.ndarray) -> jax_stages.Image:
    return jax_stages.body_frame(jnp.asarray(keypoints), imputation_of(PLAIN), upright=True)


@pytest.mark.slow
def test_the_input_is_the_image_as_it_is_with_missing_joints_imputed():
    keypoints = views().keypoints
    image = upright(keypoints)
    points, seen = np.asarray(image.at), keypoints[..., 2] > 0
    assert np.array_equal(image.seen > 0, seen) and (~seen).sum() > 100
    assert np.allclose(image.down, [0, 1])
    top, bottom = (f(np.where(seen, points[..., 1], 0), 1) for f in (np.min, np.max))
    assert np.allclose(top, -1, atol=1e-5) and np.allclose(bottom, 1, atol=1e-5)
    # Where each is expected, given all the others.
    expected = imputation_of(PLAIN) @ points
    assert np.allclose(expected[~seen], points[~seen], atol=1e-3)
    x = np.asarray(coordinates.inputs(image))
    assert x.shape == (400, coordinates.INPUTS)
    assert np.array_equal(x[:, :28].reshape(-1, 14, 2), points)
    assert np.array_equal(x[:, 28:] > 0, seen)


def test_neither_size_nor_place_nor_a_joint_that_is_not_seen_matters():
    keypoints = views().keypoints
    other = keypoints * [2, 2, 1] + [30, -70, 0]
    other = np.where(keypoints[..., 2:] > 0, other, [9e3, -9e3, 0]).astype(np.float32)
    given, moved = (np.asarray(coordinates.inputs(upright(k))) for k in (keypoints, other))
    assert np.allclose(given, moved, atol=1e-3)


@pytest.mark.slow
def test_rivals_have_the_parameters_that_they_are_named_for():
    sizes = {}
    for name, recipe in rivals.RIVALS.items():
        run = rivals.RivalRun([people(1100)], recipe, 0)
        sizes[name] = rivals.parameters(recipe, run.params["layers"])
    assert sizes["mlp40k"] == pytest.approx(40_027, rel=0.01)  # FConn's
    assert sizes["equivariant40k"] == pytest.approx(40_027, rel=0.01)
    assert sizes["martinez"] == pytest.approx(4.3e6, rel=0.01)


def test_all_rivals_are_trained_as_the_librarys_networks():
    own = {"network", "hidden", "pose_epochs", "rate", "up", "fuse", *EVEN_NOISE}
    noise = [EVEN_NOISE, {key: getattr(RECIPES["direct"], key) for key in EVEN_NOISE}]
    of_the_large_one = {"batch", "average", "adam", "straightened"}
    for recipe in (*rivals.RIVALS.values(), *rivals.TRIALS.values()):
        free = own | of_the_large_one if recipe.network == "residual" else own
        for name, value in dataclasses.asdict(RECIPES["direct"]).items():
            assert name in free or getattr(recipe, name) == value, name
        assert {key: getattr(recipe, key) for key in EVEN_NOISE} in noise


def test_the_residual_network_is_martinez():
    rng = np.random.default_rng(4)
    params = coordinates.init((42, *(16,) * 5, 42), np.zeros((14, 3)), True, 5)
    params = [tuple(np.asarray(a) + rng.normal(0, 0.1, a.shape) for a in row) for row in params]
    x = rng.normal(size=(9, 42))

    def layer(x, weight, bias, gain, shift):
        y = x @ weight + bias
        return np.maximum((y - y.mean(0)) / np.sqrt(y.var(0) + 1e-5) * gain + shift, 0)

    y = layer(x, *params[0])
    y = y + layer(layer(y, *params[1]), *params[2])
    y = y + layer(layer(y, *params[3]), *params[4])
    expected = (y @ params[5][0] + params[5][1]).reshape(9, 14, 3)
    expected -= expected.mean(1, keepdims=True)
    points, statistics = coordinates.forward(params, jnp.asarray(x), residual=True)
    assert len(statistics) == 5 and np.allclose(points, expected, atol=1e-4)


def test_dropout_is_for_training_only():
    params = coordinates.init((42, *(16,) * 5, 42), np.zeros((14, 3)), True, 5)
    x = jnp.asarray(np.random.default_rng(6).normal(size=(9, 42)), jnp.float32)
    still, used = coordinates.forward(params, x, True, None, None, 0.5)
    assert np.array_equal(still, coordinates.forward(params, x, True)[0])
    moved, _ = coordinates.forward(params, x, True, None, jax.random.key(0), 0.5)
    assert not np.array_equal(still, moved)
    assert np.allclose(still, coordinates.forward(params, x, True, used)[0], atol=1e-6)


@pytest.mark.slow
def test_the_equivariant_one_treats_left_and_right_alike_and_the_plain_one_does_not():
    keypoints = views(60).keypoints
    mirrored = keypoints[:, MIRROR] * [-1, 1, 1] + [1000, 0, 0] * (keypoints[:, MIRROR, 2:] > 0)
    off = {}
    for recipe in (ALIKE, PLAIN):
        run = rivals.RivalRun([people()], recipe, 7)
        run.advance(run.draw(0))
        lifted = [run.settle().lift(k).joints for k in (keypoints, mirrored)]
        off[recipe.network] = np.abs(lifted[1][:, MIRROR] * [-1, 1, 1] - lifted[0]).max()
    assert off["equivariant"] < 1e-4 and off["plain"] > 0.01


@pytest.mark.slow
def test_the_equivariant_one_uses_neither_gates_nor_up():
    """So those weights are not counted: they stay as they were."""
    run = rivals.RivalRun([people()], ALIKE, 7)
    before = run.params["layers"]
    run.advance(run.draw(0))
    moved = {n: np.asarray(run.carry[0]["layers"][n] != before[n]) for n in before}
    even, count = lifter.layout("direct").even, rivals.UP_INPUTS
    rows = np.r_[even - count + 1 : even, len(moved["weight0"]) - 1]
    assert not moved["weight0"][rows].any() and moved["weight0"].sum() > 500
    gates = slice(3 * lifter.ROWS, None)
    assert not moved["weight2"][:, gates].any() and not moved["bias2"][gates].any()
    assert not any(moved[name].any() for name in ("fusion", "mean", "spread"))


@pytest.mark.slow
@SMALL
def test_the_loss_falls_and_a_resumed_run_is_the_same(tmp_path, recipe):
    whole, losses = rivals.RivalRun([people()], recipe, 7), []
    while whole.epoch < whole.epochs:
        losses.append(whole.advance(whole.draw(whole.epoch)))
        if whole.epoch == 2:
            whole.curve = {2: {"gt": 1.0}}
            whole.save_state(tmp_path / "a.state")
    assert losses[-1] < losses[0]
    resumed = rivals.RivalRun([people()], recipe, 7)
    resumed.load_state(tmp_path / "a.state")
    assert resumed.epoch == 2 and resumed.curve == {2: {"gt": 1.0}}
    resumed.advance(resumed.draw(resumed.epoch))
    for one, two in zip(*map(jax.tree.leaves, (whole.carry, resumed.carry)), strict=True):
        assert np.array_equal(one, two)


def test_a_state_of_another_recipe_or_motion_is_refused(tmp_path):
    rivals.RivalRun([people()], PLAIN, 7).save_state(tmp_path / "a.state")
    for other in (
        rivals.RivalRun([people()], PLAIN, 8),
        rivals.RivalRun([people(390)], PLAIN, 7),
        rivals.RivalRun([people()], dataclasses.replace(PLAIN, rigid=0.25), 7),
    ):
        with pytest.raises(ValueError, match="remove it to start anew"):
            other.load_state(tmp_path / "a.state")


@pytest.mark.slow
def test_a_lifter_has_the_averaged_weights_and_their_own_normalisation():
    run = rivals.RivalRun([people()], RESIDUAL, 7)
    for epoch in range(3):
        run.advance(run.draw(epoch))
    keypoints = views().keypoints
    lifter = run.settle()
    whole = lifter.lift(keypoints)
    assert (whole.status == "ok").all() and np.isfinite(whole.joints).all()
    hips = whole.joints[:, [JOINTS.index("right_hip"), JOINTS.index("left_hip")]]
    assert np.abs(hips.mean(1)).max() < 1e-6
    # By fixed statistics: a pose is lifted alone as it is among others ...
    assert np.allclose(lifter.lift(keypoints[:1]).joints, whole.joints[:1], atol=1e-5)
    # ... which are those that the averaged weights have on training views, without dropout.
    last = rivals.Rival(RESIDUAL, run.carry[0], lifter.statistics).lift(keypoints)
    assert np.abs(last.joints - whole.joints).max() > 1e-4
    rng = np.random.default_rng([7, 1 << 31])
    seen = draw_2d(pick_poses(run.motions, RESIDUAL, rng), RESIDUAL, rng).keypoints
    assert np.array_equal(seen, run.some_views())
    weight, bias, *_ = run.params["layers"][0]
    first = coordinates.inputs(upright(seen)) @ weight + bias
    assert np.allclose(lifter.statistics[0][0], first.mean(0), atol=1e-4)
    assert np.allclose(lifter.statistics[0][1], first.var(0), rtol=1e-3)


@pytest.mark.slow
def test_errors_are_aligned_and_in_the_cameras_axes():
    run = rivals.RivalRun([people()], PLAIN, 7)
    seen = views(30)
    points = run.settle().lift(seen.keypoints).joints
    aligned, in_camera = run.settle().errors(seen._replace(truth=points.astype(np.float32)))
    assert aligned.shape == (30,) and aligned.max() < 1e-3 and in_camera.max() < 1e-3
    turned = (points * [-1, 1, -1]).astype(np.float32)  # half round
    aligned, in_camera = run.settle().errors(seen._replace(truth=turned))
    assert aligned.max() < 1e-3 and in_camera.mean() > 0.1


def test_too_few_poses_are_an_error():
    with pytest.raises(ValueError, match="do not fill a batch"):
        rivals.RivalRun([people(20)], PLAIN, 0)


def run_rivals(*arguments):
    return run_tool("experiments.rivals", *arguments)


@pytest.fixture
def files(tmp_path) -> tuple[Path, ...]:
    counts = {"train": 400, "others": 100, "test": 60, "more": 40}
    return tuple(write_motion(tmp_path / f"{n}.npz", people(c)) for n, c in counts.items())


@pytest.mark.long
def test_the_command_adds_rivals_to_the_json(tmp_path, files):
    results = tmp_path / "rivals.json"
    options = ("--epochs", 2, "--out", tmp_path / "runs", "--json", results)
    motion = ("--train", *files[:2], "--test", *files[2:])
    for name in ("equivariant40k", "mlp40k"):
        done = run_rivals(*motion, "--rivals", name, *options)
        assert done.returncode == 0, done.stderr
    entries = json.loads(results.read_text())["rivals"]
    assert list(entries) == ["mlp40k", "equivariant40k"]  # the order of the table
    entry = entries["mlp40k"]
    assert entry["parameters"] == 39_851 and entry["recipe"]["pose_epochs"] == 2
    assert [file["poses"] for file in entry["data"]["files"]] == [400, 100]
    assert [test["poses"] for test in entry["tests"]] == [60, 40]
    assert entry["tests"][0]["sha256"] == people(60).sha256
    assert entry["training_people"]["epoch"] == [1, 2]
    assert "others gt_camera" in entry["training_people"]
    for test in entry["tests"]:
        figures = test["figures"]["rand2"]
        low, high = figures["interval"]
        assert 0 < low <= figures["error"] <= high and figures["camera_axes"] > 0
    again = results.read_bytes()
    done = run_rivals(*motion, "--rivals", "mlp40k", *options)  # finished: measured again
    assert done.returncode == 0 and results.read_bytes() == again


@pytest.mark.slow
def test_bad_input_is_a_clear_error(tmp_path, files):
    done = run_rivals("--train", tmp_path / "none.npz", "--out", tmp_path)
    assert done.returncode == 1 and "none.npz" in done.stderr and "Traceback" not in done.stderr
    done = run_rivals("--train", files[0], "--rivals", "mlp41k")
    assert done.returncode == 2 and "mlp40k" in done.stderr
    done = run_rivals("--train", files[0], "--rivals", "martinez", "--out", tmp_path)
    assert done.returncode == 1 and "batch of 1024" in done.stderr
    done = run_rivals("--train", files[0], "--trials", "--out", tmp_path)
    assert done.returncode == 1 and "no subject" in done.stderr


def test_trials_have_a_table():
    row = {"gt": 50.0, "gt_camera": 61.0, "rand2": 70.0}
    validation = {f"{stem} {n}": v for stem in ("cmu", "labs") for n, v in row.items()}
    recipe = {"pose_epochs": 3}
    entry = {"parameters": 39851, "recipe": recipe, "validation": validation}
    text = rivals.trials_table({"plain": entry})
    heads = "cmu gt | cmu gt, camera axes | labs gt | labs gt, camera axes"
    assert f"| parameters | epochs | {heads} |" in text
    assert "| plain | 39,851 | 3 | 50.0 | 61.0 | 50.0 | 61.0 |" in text
