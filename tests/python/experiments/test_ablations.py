"""The paper's recipes: what they draw, a network trained and measured through C, and the tables."""

import json

import numpy as np
import pytest
from motions import people, write_motion
from support import ROOT, run_tool

from data import cameras
from experiments import ablations
from export.build import build_library
from reports import markdown
from training.loss import NETWORKS
from training.recipe import Recipe
from training.views import draw_2d


def run(*arguments):
    return run_tool("experiments.ablations", *arguments)


def test_the_regimes_draw_what_they_say():
    joints = people(2000).joints
    off = {}
    for name in list(ablations.ABLATIONS)[:3]:
        recipe = ablations.ABLATIONS[name]
        keypoints, truth = draw_2d(joints, recipe, np.random.default_rng(0))
        exact = cameras.project(truth.astype(float))
        off[name] = np.linalg.norm(keypoints[..., :2] - exact, axis=-1).max(1)
    exact, detector, both = off.values()
    assert exact.max() < 0.01
    assert (detector > 1).all()
    assert (both < 0.01).mean() == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("network", NETWORKS)
def test_the_library_of_a_network_is_that_network(tmp_path, network):
    motion = people(200)
    recipe = Recipe(network=network, l2_epochs=2, mds_epochs=0, batch=100)
    weights = tmp_path / "0.npz"
    trained = ablations.run_recipe(motion, recipe, 3, weights)
    library = build_library(weights, tmp_path / "library")
    edm = np.random.default_rng(1).uniform(0, 2, 91).astype(np.float32)
    expected = np.asarray(trained.network.predict(trained.params, edm[None]))[0]
    # FConv's weights are rounded to 12 bits.
    assert np.allclose(library.predict(edm), expected, atol=2e-3 if network == "fconv" else 1e-5)


def test_the_command_trains_measures_and_writes_both_tables(tmp_path):
    motion = write_motion(tmp_path / "motion.npz", people())
    page, results = tmp_path / "page.md", tmp_path / "results.json"
    page.write_text("<!-- begin recipes -->\n<!-- end recipes -->\n")
    names = list(ablations.ABLATIONS)[:2]
    out = ("--out", tmp_path / "out", "--json", results, "--update", page)
    done = run(motion, motion, "--epochs", 2, *out, "--recipes", *names[::-1])
    assert done.returncode == 0, done.stderr
    entries = json.loads(results.read_text())
    assert list(entries) == names  # in the order of the recipes, not in that of the command
    assert entries[names[0]]["figures"]["rand2"]["hidden_joints"] > 0
    lines = page.read_text().splitlines()
    assert sum(line.startswith(f"| {names[0]} |") for line in lines) == 2
    assert "| hidden joints, mm | rand2 | right_arm" in page.read_text()


def test_the_page_has_the_results():
    page = ROOT / "docs" / "accuracy-log.md"
    results = json.loads(ablations.RESULTS.read_text())
    assert list(results) == list(ablations.ABLATIONS)
    assert markdown.read(page, "recipes").strip() == ablations.report(results).strip()


def test_missing_motion_is_a_clear_error(tmp_path):
    done = run(tmp_path / "none.npz", tmp_path / "none.npz", "--out", tmp_path / "out")
    assert done.returncode == 1 and "none.npz" in done.stderr and "Traceback" not in done.stderr
