"""Training: gradients, draws, resuming, and errors; on a handful of made-up poses."""

import dataclasses
import json
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from builds import long_but
from motions import STANDING, people, write_motion
from support import run_tool

from data.mocap import MocapError
from edmlift.joints import PAIRS
from export.kinds import read_network
from export.settings import read_settings
from model import constants, fconn, fconv, jax_stages, layout, reference
from model.manifest import NEAREST
from training import manifest, mirror, views
from training.loss import make_optimizer, mds_poses
from training.recipe import MAX_MISSING, RECIPES, Recipe, scale_epochs
from training.run import Run, split

SHORT = Recipe(l2_epochs=2, pose_epochs=2, batch=50)


@pytest.mark.slow
def test_the_mds_is_the_references():
    distance = reference.distances(STANDING) * np.random.default_rng(1).uniform(0.8, 1.2, 91)
    mine = np.asarray(jax_stages.classical_mds(jnp.asarray(distance[None], jnp.float32)))[0]
    expected = reference.mds(distance)
    assert np.allclose(reference.distances(mine), reference.distances(expected), atol=1e-5)


@pytest.mark.slow
def test_the_gradient_through_the_mds_is_the_slope():
    rng = np.random.default_rng(2)
    start = reference.distances(STANDING) * rng.uniform(0.9, 1.1, 91)
    weight = rng.normal(size=(14, 14))

    def value(distance):  # of the Gram matrix of the points: it does not depend on their signs
        points = jax_stages.classical_mds(distance[None])[0]
        return jnp.sum(jnp.asarray(weight) * (points @ points.T))

    jax.clear_caches()  # what other tests traced is of 32 bits
    with jax.enable_x64():
        gradient = jax.grad(value)(jnp.asarray(start))
        for k in rng.choice(91, 12, replace=False):
            step = np.zeros(91)
            step[k] = 1e-6
            slope = (value(jnp.asarray(start + step)) - value(jnp.asarray(start - step))) / 2e-6
            # The regularised gaps cost a share of 1e-6 / gap^2.
            assert float(gradient[k]) == pytest.approx(float(slope), rel=1e-2, abs=1e-3)


def test_draws_hide_none_some_or_a_limb():
    seen = views.draw_masks(4000, np.random.default_rng(4))
    missing = (~seen).sum(1)
    assert (missing == 0).mean() == pytest.approx(0.5, abs=0.03)
    assert missing.max() == MAX_MISSING


def test_balancing_evens_out_the_subjects():
    subject = np.repeat([1, 2], [900, 100])
    joints = np.zeros((1000, 14, 3)) + subject[:, None, None]
    motion = dataclasses.replace(people(1000), joints=joints, subject=subject)
    rng = np.random.default_rng(5)
    share = [
        (views.pick_poses([motion], dataclasses.replace(SHORT, balance=b), rng) == 2).mean()
        for b in (0.0, 0.5, 1.0)
    ]
    assert share == pytest.approx([0.1, 0.25, 0.5], abs=0.05)


def test_other_motions_have_their_share():
    first, second = people(300), dataclasses.replace(people(100), joints=people(100).joints + 9)
    third = dataclasses.replace(people(100), joints=people(100).joints + 99)
    recipe = dataclasses.replace(SHORT, others=0.4, balance=0.0)
    joints = views.pick_poses([first, second, third], recipe, np.random.default_rng(6))
    assert len(joints) == 500
    place = joints[:, 0, 1]
    shares = [(place < 5).mean(), ((place > 5) & (place < 50)).mean(), (place > 50).mean()]
    assert shares == pytest.approx([0.6, 0.2, 0.2], abs=0.08)


@pytest.mark.slow
def test_the_loss_falls_and_a_resumed_run_is_the_same(tmp_path):
    whole, losses = Run([people()], SHORT, 7), []
    while whole.epoch < whole.epochs:
        losses.append(whole.advance(whole.draw(whole.epoch)))
        if whole.epoch == 2:
            whole.save_state(tmp_path / "state")
    assert losses[1] < losses[0] and losses[3] < losses[2]
    resumed = Run([people()], SHORT, 7)
    resumed.load_state(tmp_path / "state")
    while resumed.epoch < resumed.epochs:
        resumed.advance(resumed.draw(resumed.epoch))
    for name, values in whole.params.items():
        assert np.array_equal(values, resumed.params[name]), name


@pytest.mark.slow
def test_a_state_of_another_recipe_is_refused(tmp_path):
    Run([people()], SHORT, 7).save_state(tmp_path / "state")
    with pytest.raises(ValueError, match="another recipe or seed"):
        Run([people()], SHORT, 8).load_state(tmp_path / "state")


def test_held_out_people_are_kept_out():
    other = dataclasses.replace(people(), subject=people().subject + 2)
    rest, held = split([people(), other], [2, 3])
    assert [set(motion.subject) for motion in rest] == [{1, 4}, {4, 5, 6}]
    assert [set(motion.subject) for motion in held] == [{2, 3}, {3}]
    with pytest.raises(MocapError, match="no subject .*9"):
        split([people()], [9])


def test_too_few_poses_are_an_error():
    with pytest.raises(MocapError, match="do not fill a batch"):
        Run([people(20)], SHORT, 0)


def test_the_papers_recipe_is_the_papers():
    paper = RECIPES["paper"]
    assert (paper.l2_epochs, paper.pose_epochs, paper.batch) == (500, 0, 200)
    assert (paper.dropout, paper.rate, paper.drop_rate_at) == (0.5, 1e-3, 0.5)


@pytest.mark.slow
def test_muon_orthogonalises_the_steps_of_matrices_alone():
    """All singular values of a matrix's step are alike; a bias's is about Adam's."""
    rng = np.random.default_rng(6)
    params = {"weight0": jnp.zeros((20, 12)), "bias0": jnp.zeros(12), "fusion": jnp.zeros(2)}
    causes = rng.normal(size=(20, 12)) @ np.diag(np.geomspace(1, 0.2, 12))
    gradient = {"weight0": jnp.asarray(causes), "bias0": jnp.ones(12), "fusion": jnp.ones(2)}
    steps = {}
    for adam in (False, True):
        recipe = dataclasses.replace(SHORT, adam=adam, clip=0.0, rate=1e-3)
        optimizer = make_optimizer(recipe, 1)
        state = optimizer.init(params)
        for _ in range(2):  # the rate starts at zero
            steps[adam], state = optimizer.update(gradient, state, params)
    values = np.linalg.svd(steps[False]["weight0"], compute_uv=False)
    assert values.max() < 2 * values.min()
    assert np.ptp(np.linalg.svd(steps[True]["weight0"], compute_uv=False)) > 0.5 * values.mean()
    assert np.allclose(steps[False]["bias0"], steps[True]["bias0"], rtol=0.2)
    assert np.allclose(steps[False]["fusion"], steps[True]["fusion"], rtol=0.2)


def test_the_papers_networks_are_trained_by_adam():
    known = {name: recipe.adam for name, recipe in RECIPES.items()}
    assert not known.pop("distances") and not known.pop("direct") and all(known.values())


def test_epochs_are_scaled_to_a_total():
    assert scale_epochs(RECIPES["distances"], None) is RECIPES["distances"]
    few = scale_epochs(Recipe(l2_epochs=20, pose_epochs=980), 60)
    assert (few.l2_epochs, few.pose_epochs) == (10, 50)  # enough of L2 to begin with
    assert scale_epochs(RECIPES["paper"], 7).epochs == 7


@pytest.mark.slow
def test_dropout_is_for_training_only():
    params = fconn.init(np.ones(91), 0)
    x = jnp.ones((3, 91))
    still = fconn.predict(params, x)
    assert np.array_equal(still, fconn.forward(params, x, jax.random.key(0), 0.0)[0])
    assert not np.array_equal(still, fconn.forward(params, x, jax.random.key(0), 0.5)[0])


@pytest.mark.slow
def test_fconv_drops_where_the_paper_does(monkeypatch):
    """Behind both poolings and the first deconvolution; here all, and the last bias is left."""
    shapes = []

    def all_dropped(key, keep, shape):
        shapes.append(shape[1:])
        return jnp.zeros(shape, bool)

    monkeypatch.setattr(jax.random, "bernoulli", all_dropped)
    params = fconv.init(np.ones(91), 0)
    out, _ = fconv.forward(params, jnp.ones((3, 91)), jax.random.key(0), 0.5)
    assert shapes == [(7, 7, 64), (4, 4, 64), (7, 7, 64)]
    assert np.allclose(out, params["conv3_bias"])


def test_fconv_has_the_papers_parameters():
    params = fconv.init(np.ones(91), 0)
    observed = ("_mean", "_variance")
    assert sum(p.size for n, p in params.items() if not n.endswith(observed)) == 605825


@pytest.mark.slow
def test_the_convolutions_are_convolutions():
    rng = np.random.default_rng(0)
    layout = ("NHWC", "HWIO", "NHWC")

    def draw(*shape):
        return jnp.asarray(rng.normal(size=shape), jnp.float32)

    def plain(x, weight, pad, dilation=1):
        return jax.lax.conv_general_dilated(
            x, weight, (1, 1), (pad, pad), (dilation, dilation), dimension_numbers=layout
        )

    x, w = draw(2, 14, 14), draw(7, 7, 1, 3)
    assert np.allclose(fconv.conv1(x, w), plain(x[..., None], w, (3, 3)), atol=1e-4)
    x, w = draw(2, 7, 7, 4), draw(7, 7, 4, 4)
    assert np.allclose(fconv.conv2(x, w), plain(x, w, (3, 3)), atol=1e-4)
    for n, size, pad in (
        (4, 7, (3, 3)),
        (7, 14, (3, 4)),
    ):
        x = draw(2, n, n, 4)
        expected = plain(x, w[::-1, ::-1], pad, dilation=2)  # a transposed one turns it round
        assert np.allclose(fconv.deconv(x, w, size), expected, atol=1e-4)


@pytest.mark.slow
def test_fconv_normalises_by_the_batch_and_later_by_what_it_saw(monkeypatch):
    monkeypatch.setattr(fconv, "MOMENTUM", 0.5)
    params = fconv.init(np.ones(91), 0)
    edm = jnp.asarray(np.random.default_rng(1).uniform(0, 2, (40, 91)), jnp.float32)
    for _ in range(25):  # until the running means have forgotten where they began
        by_batch, observed = batch_forward(params, edm)
        params |= observed
    assert set(observed) == {"bn1_mean", "bn1_variance", "bn2_mean", "bn2_variance"}
    assert np.allclose(by_batch, fconv.predict(params, edm), atol=1e-4)


@jax.jit
def batch_forward(params, edm):
    return fconv.forward(params, edm, None, 0.0)


@pytest.mark.long
def test_fconvs_loss_falls():
    run = Run([people(100)], dataclasses.replace(SHORT, network="fconv"), 7)
    losses = [run.advance(run.draw(run.epoch)) for _ in range(4)]
    assert losses[1] < losses[0] and losses[3] < losses[2]


def test_the_mirror_weights_tell_people_from_their_reflections():
    truth = people().joints.astype(float)
    flipped = np.arange(len(truth)) % 2 == 0  # the network's handedness is arbitrary
    either = np.where(flipped[:, None, None], truth * [1, 1, -1], truth)
    weights = mirror.fit_mirror(either, truth)
    score = reference.mirror_features(truth) @ weights
    assert (score > 0).mean() > 0.95


def test_the_refinement_that_is_chosen_is_the_best():
    truth = people(12).joints.astype(float)
    exact = np.array([reference.distances(t) for t in truth])
    noisy = exact * np.random.default_rng(6).uniform(0.7, 1.3, exact.shape)
    errors = manifest.refinement_errors(noisy, truth)
    assert list(errors) == ["none", "square", "raw", "eq2"]
    assert errors["raw"] < errors["none"]  # independent errors: raw stress averages them out
    assert manifest.refinement_errors(exact, truth)["none"] == pytest.approx(0, abs=0.01)


def trained(folder: Path, recipe: str, *options: object) -> tuple[dict, dict, str]:
    """Manifest, arrays and what train.py prints, of a few epochs on two motions."""
    path = write_motion(folder / "motion.npz", people())
    out = folder / "net.npz"
    few = ("--recipe", recipe, "--epochs", 2, "--hold-out", 4)
    done = run_tool("train.py", path, path, "--out", out, *few, *options)
    assert done.returncode == 0, done.stderr
    assert not out.with_suffix(".state").exists()
    with np.load(out) as weights:
        arrays = dict(weights)
    return json.loads(out.with_suffix(".json").read_text()), arrays, done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("kind", long_but(["distances"], layout.KINDS))
def test_the_command_trains_an_equivariant_network(tmp_path, kind):
    written, arrays, printed = trained(tmp_path, kind)
    assert [file["subjects"] for file in written["data"]["files"]] == [[1, 2, 3]] * 2
    assert written["data"]["held_out"] == [4] and "motion gt" in written["validation"]
    hidden = RECIPES[kind].hidden
    layers = len(hidden) + 1
    known = layout.layout(kind)
    assert arrays["weight0"].shape == (known.even + known.odd, hidden[0])
    assert len(arrays[f"bias{layers - 1}"]) == len(known.has_even)
    assert len(arrays) == 2 * layers
    assert ("mds_share" in written) == (kind == "distances")
    assert written["fusion"]["share"] == 1 and written["fusion"]["distance"] >= NEAREST
    assert not {"mirror", "objective", "max_aspect"} & written.keys()
    silent = written["silent_units"]
    assert all(0 <= count < width for count, width in zip(silent, hidden, strict=True))
    assert f"never fire, layer by layer: {silent}" in printed
    read, layers = read_network(tmp_path / "net.npz")  # the exporter takes it
    assert read.model == kind and read_settings(tmp_path / "net.json", read.needs)


@pytest.mark.long
def test_the_command_trains_the_papers_network(tmp_path):
    written, arrays, _ = trained(tmp_path, "fconn")
    assert len(written["mirror"]) == 5 and 0 < written["fusion"]["share"] < 1
    assert written["objective"] in ("none", "square", "raw", "eq2")
    assert "silent_units" not in written and "mds_share" not in written
    assert arrays["weight0"].shape == (91, 128) and arrays["bias2"].shape == (91,)


def test_missing_motion_is_a_clear_error(tmp_path):
    done = run_tool("train.py", tmp_path / "none.npz", "--out", tmp_path / "net.npz")
    assert done.returncode == 1 and "none.npz" in done.stderr and "Traceback" not in done.stderr


def test_pairs_are_row_by_row():
    assert list(zip(*PAIRS, strict=True))[:3] == [(0, 1), (0, 2), (0, 3)]


@pytest.mark.slow
def test_orienting_and_fusing_are_the_references():
    rng = np.random.default_rng(8)
    seen = views.draw_2d(people(60).joints, SHORT, rng)
    distances = np.array([reference.distances(t) for t in seen.truth.astype(float)])
    distances *= rng.uniform(0.9, 1.1, distances.shape)
    table = constants.imputation()
    image = jax_stages.body_frame(seen.keypoints, table)
    params = {"fusion": jax_stages.FUSION, "share": jnp.array(0.4)}
    given = jnp.asarray(distances, jnp.float32)
    mine = np.asarray(mds_poses(params, image, given, seen.truth), float)
    settings = manifest.fusion_settings(params)
    share = np.full(14, settings.pop("share"))
    for pose, d, keypoints, true in zip(mine, distances, seen.keypoints, seen.truth, strict=True):
        at = reference.body_frame(keypoints.astype(float), 10, table)
        points = reference.orient(reference.mds(d), at)
        points = points * [1, 1, np.sign(points[:, 2] @ (true[:, 2] - true[:, 2].mean()))]
        points, _ = reference.fuse(points, at, share, **settings)
        right = reference.turned(points, at.down * [-1, 1])
        assert np.allclose(pose - pose.mean(0), right - right.mean(0), atol=1e-3)


@pytest.mark.slow
def test_the_fusion_is_trained_along():
    run = Run([people()], SHORT, 7)
    while run.epoch < run.epochs:
        run.advance(run.draw(run.epoch))
    assert not np.array_equal(run.params["fusion"], jax_stages.FUSION)
    assert manifest.fusion_settings(run.params)["share"] == 1
    assert float(run.params["mds_share"]) != 0
    plain = dataclasses.replace(SHORT, network="fconn", fuse=False)
    without = Run([people()], dataclasses.replace(plain, rigid=1.0), 7)
    assert "fusion" not in without.params
    assert manifest.fusion_settings(without.params)["share"] == 0
    with pytest.raises(ValueError, match="rigid must be 1 without the fuse stage"):
        Run([people()], plain, 7)


def test_the_fusion_takes_the_image_from_no_nearer_than_c_allows():
    _, distance = jax_stages.fusion_settings(jnp.array([-2.0, 0.5]))
    assert float(distance) == NEAREST
