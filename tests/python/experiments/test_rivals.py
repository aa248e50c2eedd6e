"""Trained rivals: their networks, their training, and the JSON; on a handful of made-up poses."""

import dataclasses
import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from motions import people
from scipy.spatial.transform import Rotation
from support import run_tool

from data.mocap import MocapError, Motion
from edmlift.joints import JOINTS, PAIRS
from experiments import rivals
from model import coordinates, jax_stages
from training.recipe import RECIPES, Recipe
from training.views import draw_2d, imputation_of, pick_poses

PLAIN = rivals.recipe(hidden=(16, 16), mds_epochs=3, batch=50, average=0.9)
RESIDUAL = rivals.martinez(hidden=(16,) * 5, mds_epochs=3, batch=100, average=0.9)
COLUMNS = ("gt", "n10", "cpm", "rand2")


def views(count: int = 400) -> tuple[np.ndarray, np.ndarray]:
    return draw_2d(people(count).joints, PLAIN, np.random.default_rng(3))


def test_the_input_is_what_the_distances_are_made_of():
    keypoints, _ = views()
    x = coordinates.inputs(jnp.asarray(keypoints), mask=True)
    points, seen = x[:, :28].reshape(-1, 14, 2), np.asarray(x[:, 28:]) > 0
    assert np.array_equal(seen, keypoints[..., 2] > 0) and (~seen).sum() > 100
    distance = jnp.linalg.norm(points[:, PAIRS[0]] - points[:, PAIRS[1]], axis=-1)
    both = seen[:, PAIRS[0]] & seen[:, PAIRS[1]]
    expected = jax_stages.edm_2d(jnp.asarray(keypoints))
    assert np.allclose(np.where(both, distance, 0), expected, atol=1e-4)
    assert (np.asarray(points)[~seen] == 0).all()
    top, bottom = (f(np.asarray(points)[..., 1], 1) for f in (np.min, np.max))
    assert np.allclose(top, -1, atol=1e-5) and np.allclose(bottom, 1, atol=1e-5)


def test_missing_joints_may_be_imputed():
    keypoints, _ = views()
    seen = keypoints[..., 2] > 0
    zero = np.asarray(coordinates.inputs(jnp.asarray(keypoints))).reshape(-1, 14, 2)
    imputation = imputation_of(RECIPES["mds"])
    imputed = coordinates.inputs(jnp.asarray(keypoints), imputation=imputation)
    imputed = np.asarray(imputed).reshape(-1, 14, 2)
    assert np.allclose(imputed[seen], zero[seen], atol=1e-4)
    # Where each is expected, given all the others.
    assert np.allclose((imputation @ imputed)[~seen], imputed[~seen], atol=1e-3)
    assert np.abs(imputed[~seen]).mean() > 0.1


def test_neither_size_nor_place_nor_a_joint_that_is_not_seen_matters():
    keypoints, _ = views()
    other = keypoints * [2, 2, 1] + [30, -70, 0]
    other = np.where(keypoints[..., 2:] > 0, other, [9e3, -9e3, 0]).astype(np.float32)
    given, moved = (np.asarray(coordinates.inputs(jnp.asarray(k))) for k in (keypoints, other))
    assert given.shape == (400, 28) and np.allclose(given, moved, atol=1e-4)


def test_rivals_have_the_parameters_that_they_are_named_for():
    runs = {n: rivals.RivalRun(people(1100), r, 0) for n, r in rivals.RIVALS.items()}
    sizes = {name: coordinates.count(run.layers) for name, run in runs.items()}
    assert sizes["mlp40k"] == sizes["mlp40k_guess"] == sizes["mlp40k_blend"]
    assert sizes["mlp40k"] == pytest.approx(40_027, rel=0.01)  # FConn's
    assert sizes["mlp25k"] == 28 * 128 + 128 + 128 * 128 + 128 + 128 * 42 + 42 == 25_642
    assert sizes["martinez"] == pytest.approx(4.3e6, rel=0.01)


def test_all_rivals_see_what_fconn_sees():
    drawn = ("noise", "detector", "bodies", "masks", "balance")
    known = {field.name for field in dataclasses.fields(Recipe)}
    drawn += tuple(known & {"flip", "mix", "adapted"})
    for recipe in (*rivals.RIVALS.values(), *rivals.TRIALS.values()):
        for name in drawn:
            assert getattr(recipe, name) == getattr(RECIPES["mds"], name), name


def test_the_residual_network_is_martinez():
    rng = np.random.default_rng(4)
    params = coordinates.init((28, *(16,) * 5, 42), np.zeros((14, 3)), True, 5)
    params = [tuple(np.asarray(a) + rng.normal(0, 0.1, a.shape) for a in row) for row in params]
    x = rng.normal(size=(9, 28))

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
    params = coordinates.init((28, *(16,) * 5, 42), np.zeros((14, 3)), True, 5)
    x = jnp.asarray(np.random.default_rng(6).normal(size=(9, 28)), jnp.float32)
    still, used = coordinates.forward(params, x, True, None, None, 0.5)
    assert np.array_equal(still, coordinates.forward(params, x, True)[0])
    moved, _ = coordinates.forward(params, x, True, None, jax.random.key(0), 0.5)
    assert not np.array_equal(still, moved)
    assert np.allclose(still, coordinates.forward(params, x, True, used)[0], atol=1e-6)


def test_the_losses_are_of_rotated_and_of_mirrored_poses():
    truth = jnp.asarray(views(20)[1])
    rotation = Rotation.from_euler("y", 90, degrees=True).as_matrix().astype(np.float32)
    centred = truth - truth.mean(1, keepdims=True)
    assert coordinates.camera_errors(centred, truth).max() < 1e-5
    assert coordinates.camera_errors(centred @ rotation, truth).mean() > 0.1
    assert jax_stages.joint_errors(centred @ rotation, truth, mirror=False).max() < 1e-3
    flipped = centred * jnp.array([1, 1, -1])
    assert jax_stages.joint_errors(flipped, truth, mirror=False).mean() > 0.01


@pytest.mark.parametrize("recipe", [PLAIN, RESIDUAL], ids=["plain", "residual"])
def test_the_loss_falls_and_a_resumed_run_is_the_same(tmp_path, recipe):
    whole, losses = rivals.RivalRun(people(), recipe, 7), []
    while whole.epoch < whole.epochs:
        losses.append(whole.advance(whole.draw(whole.epoch)))
        if whole.epoch == 2:
            whole.curve = {2: {"gt": 1.0}}
            whole.save_state(tmp_path / "a.state")
    assert losses[-1] < losses[0]
    resumed = rivals.RivalRun(people(), recipe, 7)
    resumed.load_state(tmp_path / "a.state")
    assert resumed.epoch == 2 and resumed.curve == {2: {"gt": 1.0}}
    resumed.advance(resumed.draw(resumed.epoch))
    for one, two in zip(*map(jax.tree.leaves, (whole.carry, resumed.carry)), strict=True):
        assert np.array_equal(one, two)


def test_a_run_alone_is_the_run_among_others(tmp_path):
    motion, recipes = people(), {"plain": PLAIN, "residual": RESIDUAL}
    together = {n: rivals.RivalRun(motion, r, 7) for n, r in recipes.items()}
    rivals.train_all(together, motion, tmp_path)
    alone = {"residual": rivals.RivalRun(motion, RESIDUAL, 7)}
    rivals.train_all(alone, motion, tmp_path)
    for one, two in zip(
        *(jax.tree.leaves(runs["residual"].carry) for runs in (together, alone)), strict=True
    ):
        assert np.array_equal(one, two)
    assert list(together["plain"].curve) == [1, 2, 3]
    assert set(together["plain"].curve[3]) == set(COLUMNS)


def test_a_state_of_another_recipe_or_motion_is_refused(tmp_path):
    rivals.RivalRun(people(), PLAIN, 7).save_state(tmp_path / "a.state")
    for other in (
        rivals.RivalRun(people(), PLAIN, 8),
        rivals.RivalRun(people(390), PLAIN, 7),
        rivals.RivalRun(people(), dataclasses.replace(PLAIN, rigid=0.25), 7),
    ):
        with pytest.raises(ValueError, match="remove it to start anew"):
            other.load_state(tmp_path / "a.state")


def test_a_lifter_has_the_averaged_weights_and_their_own_normalisation():
    run = rivals.RivalRun(people(), RESIDUAL, 7)
    for epoch in range(3):
        run.advance(run.draw(epoch))
    keypoints, _ = views()
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
    chosen = pick_poses(run.motion.subject, RESIDUAL, rng)
    seen, _ = draw_2d(run.motion.joints[chosen], RESIDUAL, rng)
    first = coordinates.inputs(jnp.asarray(seen)) @ run.layers[0][0] + run.layers[0][1]
    assert np.allclose(lifter.statistics[0][0], first.mean(0), atol=1e-4)
    assert np.allclose(lifter.statistics[0][1], first.var(0), rtol=1e-3)


def test_a_rival_may_be_fused_with_the_image():
    run = rivals.RivalRun(people(), dataclasses.replace(PLAIN, fuse=True), 7)
    for epoch in range(3):
        run.advance(run.draw(epoch))
    keypoints, _ = views()
    lifter = run.settle()
    plain = dataclasses.replace(lifter, params={"layers": run.layers})
    expected = jax_stages.fuse(plain.lift(keypoints).joints, keypoints, run.params["fusion"])
    got = lifter.lift(keypoints).joints
    assert np.allclose(
        got - got.mean(1, keepdims=True), expected - expected.mean(1, keepdims=True), atol=1e-5
    )
    assert np.abs(got - plain.lift(keypoints).joints).max() > 0.01
    assert not np.array_equal(run.params["fusion"], jax_stages.FUSION)


def test_too_few_poses_are_an_error():
    with pytest.raises(MocapError, match="do not fill a batch"):
        rivals.RivalRun(people(20), PLAIN, 0)


def save(motion: Motion, path: Path) -> Path:
    arrays = {name: getattr(motion, name) for name in ("joints", "subject", "trial", "frame")}
    np.savez(path, **arrays, joint_names=np.array(JOINTS), up="y", unit="m")
    return path


def run_rivals(*arguments):
    return run_tool("experiments.rivals", *arguments)


@pytest.fixture
def files(tmp_path):
    return save(people(), tmp_path / "train.npz"), save(people(60), tmp_path / "test.npz")


def test_the_command_adds_rivals_to_the_json(tmp_path, files):
    results = tmp_path / "rivals.json"
    options = ("--epochs", 2, "--out", tmp_path / "runs", "--json", results)
    for name in ("mlp25k", "mlp40k"):
        done = run_rivals(*files, "--rivals", name, *options)
        assert done.returncode == 0, done.stderr
    entries = json.loads(results.read_text())["rivals"]
    assert list(entries) == ["mlp40k", "mlp25k"]  # the order of the table
    entry = entries["mlp25k"]
    assert entry["parameters"] == 25_642 and entry["recipe"]["epochs"] == 2
    assert entry["data"]["poses"] == 400 and entry["test"]["poses"] == 60
    assert entry["test"]["sha256"] == people(60).sha256 != entry["data"]["sha256"]
    assert list(entry["training_people"]) == ["1", "2"]
    error, (low, high) = (entry["figures"]["rand2"][key] for key in ("error", "interval"))
    assert 0 < low <= error <= high
    again = results.read_bytes()
    done = run_rivals(*files, "--rivals", "mlp25k", *options)  # finished: measured again
    assert done.returncode == 0 and results.read_bytes() == again


def test_bad_input_is_a_clear_error(tmp_path, files):
    done = run_rivals(tmp_path / "none.npz", files[1])
    assert done.returncode == 1 and "none.npz" in done.stderr and "Traceback" not in done.stderr
    done = run_rivals(*files, "--rivals", "mlp41k")
    assert done.returncode == 2 and "mlp25k" in done.stderr
    done = run_rivals(*files, "--rivals", "martinez", "--out", tmp_path)
    assert done.returncode == 1 and "batch of 1024" in done.stderr
    done = run_rivals(*files, "--trials", "--out", tmp_path)
    assert done.returncode == 1 and "no subject" in done.stderr


def test_trials_have_a_table(tmp_path):
    run = rivals.RivalRun(people(), PLAIN, 7)
    rivals.train_all({"plain": run}, people(40), tmp_path)
    text = rivals.trials_table({"plain": rivals.tried(run, [3])})
    assert "| parameters | epochs | gt | n10 | cpm | rand2 |" in text
    assert f"| plain | {coordinates.count(run.layers):,} | 3 |" in text
