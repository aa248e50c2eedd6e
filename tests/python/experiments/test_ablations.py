"""Networks without a part of them, and the paper's recipes: what each goes without, the tables."""

import dataclasses
import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from builds import long_but
from motions import people, write_motion
from support import ROOT

from data import cameras
from experiments import ablations
from reports import markdown
from training import loss
from training.views import Views, draw_2d


def test_the_papers_regimes_draw_what_they_say():
    joints = people(2000).joints
    off = []
    for name in list(ablations.ABLATIONS)[:2]:
        views = draw_2d(joints, ablations.ABLATIONS[name], np.random.default_rng(0))
        points = cameras.project(views.truth.astype(float))
        off.append(np.linalg.norm(views.keypoints[..., :2] - points, axis=-1).max(1))
    exact, both = off
    assert exact.max() < 0.01
    assert (both < 0.01).mean() == pytest.approx(0.5, abs=0.05)


def recipe_without(kind: str, name: str) -> ablations.Part:
    return ablations.part(
        kind, without=name, hidden=(8, 8), batch=50, l2_epochs=0, pose_epochs=2
    )


def lifted(recipe: ablations.Part, params: loss.Params, views: Views) -> np.ndarray:
    return np.asarray(ablations.lift(recipe, params, views)[0])


@pytest.mark.slow
def test_with_all_its_parts_it_is_the_lift_of_training():
    for kind in ("distances", "direct"):
        recipe = recipe_without(kind, "")
        run = ablations.PartRun([people()], recipe, 7)
        views = draw_2d(people(60).joints, recipe, np.random.default_rng(1))
        expected = loss.lift(recipe, run.params, views)[0]
        assert np.array_equal(lifted(recipe, run.params, views), expected)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "name"),
    long_but(
        [("direct", "gates"), ("direct", "image"), ("distances", "mds")],
        [("direct", "image"), ("distances", "mds")]
        + [(kind, name) for kind in ("distances", "direct") for name in ("frame", "gates", "mask")],
    ),
)
def test_a_part_that_is_left_out_is_missed_and_its_loss_falls(kind, name):
    recipe = recipe_without(kind, name)
    run = ablations.PartRun([people()], recipe, 7)
    losses = [run.advance(run.draw(epoch)) for epoch in range(2)]
    assert losses[1] < losses[0]
    views = draw_2d(people(60).joints, recipe, np.random.default_rng(1))
    whole = dataclasses.replace(recipe, without="")
    assert np.abs(lifted(recipe, run.params, views) - lifted(whole, run.params, views)).max() > 1e-3


def rolled(views: Views, angle: float) -> Views:
    """The same views by a camera that is rolled."""
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    points = (views.keypoints[..., :2] - cameras.CENTRE) @ turn + cameras.CENTRE
    return views._replace(keypoints=cameras.keypoints(points), up=0 * views.up)


@pytest.mark.slow
def test_without_the_bodys_frame_a_rolled_camera_matters():
    exact = {"iid": 0.0, "detector": 0.0, "masks": False}
    recipe = dataclasses.replace(recipe_without("direct", "frame"), **exact)
    params = ablations.PartRun([people()], recipe, 7).params
    views = rolled(draw_2d(people(60).joints, recipe, np.random.default_rng(1)), 0.0)
    for name, differs in (("frame", True), ("", False)):
        part = dataclasses.replace(recipe, without=name)
        depths = [lifted(part, params, rolled(views, a))[..., 2] for a in (0.0, 0.8)]
        assert (np.abs(depths[0] - depths[1]).max() > 0.01) == differs


@pytest.mark.slow
def test_without_the_mask_only_coordinates_tell():
    recipe = recipe_without("direct", "mask")
    params = jax.tree.map(jnp.asarray, ablations.PartRun([people()], recipe, 7).params)
    views = draw_2d(people(60).joints, recipe, np.random.default_rng(1))
    _, blind = ablations.lift(recipe, params, views)
    _, told = ablations.lift(dataclasses.replace(recipe, without=""), params, views)
    whole = (views.keypoints[..., 2] > 0).all(1)
    same = np.abs(np.asarray(blind.points - told.points)).max((1, 2)) < 1e-6
    assert np.array_equal(same, whole) and 10 < whole.sum() < 50


@pytest.fixture
def short(monkeypatch):
    """The command on two of the people held out; small networks."""
    kinds = {"direct": recipe_without("direct", "gates"), "paper": ablations.paper(batch=50)}
    monkeypatch.setattr(ablations, "ABLATIONS", kinds)
    monkeypatch.setattr(ablations, "HELD_OUT", [2, 3])

    def run(*options):
        monkeypatch.setattr("sys.argv", ["ablations", *map(str, options)])
        return ablations.main()

    return run


@pytest.mark.long
def test_the_command_trains_measures_and_writes_a_table_a_motion(tmp_path, short):
    motions = [write_motion(tmp_path / f"{n}.npz", people(c)) for n, c in (("a", 400), ("b", 120))]
    page, results = tmp_path / "page.md", tmp_path / "results.json"
    page.write_text("<!-- begin recipes -->\n<!-- end recipes -->\n")
    out = ("--out", tmp_path / "out", "--json", results, "--update", page)
    assert short("--train", *motions, "--epochs", 2, *out, "--recipes", "paper", "direct") == 0
    entries = json.loads(results.read_text())
    assert list(entries) == ["direct", "paper"]  # in the order of the recipes
    assert entries["direct"]["data"]["held_out"] == [2, 3]
    assert entries["direct"]["data"]["files"][1]["subjects"] == [1, 4]
    assert entries["direct"]["validation"]["b gt_up_camera"] > 0
    assert "a gt_camera" not in entries["paper"]["validation"]  # an MDS has no camera
    lines = page.read_text().splitlines()
    assert sum(line.startswith("| direct |") for line in lines) == 2
    assert "| a, people held out, mm | gt | gt, camera axes |" in page.read_text()


def test_missing_motion_is_a_clear_error(tmp_path, short, capsys):
    assert short("--train", tmp_path / "none.npz", "--out", tmp_path / "out") == 1
    assert "none.npz" in capsys.readouterr().err


@pytest.mark.claims("docs/accuracy-log.md", "recipes")
def test_the_page_has_the_results():
    page = ROOT / "docs" / "accuracy-log.md"
    if not ablations.RESULTS.exists():  # as the page then says
        assert markdown.read(page, "recipes").strip() == ""
        return
    results = json.loads(ablations.RESULTS.read_text())
    assert list(results) == list(ablations.ABLATIONS)
    assert markdown.read(page, "recipes").strip() == ablations.report(results).strip()
