"""Networks for one column alone: the views that they see, and the table."""

import dataclasses
import json

import numpy as np
import pytest
from motions import people, write_motion
from support import ROOT

from experiments import ablations, columns
from reports import markdown
from training.views import draw_2d


def test_such_a_network_sees_the_views_of_its_column_and_no_others():
    motion = people(200)
    recipes = (ablations.ABLATIONS[columns.ALONE.format(name)] for name in ("gt", "n10"))
    exact, noisy = (draw_2d(motion.joints, r, np.random.default_rng(1)) for r in recipes)
    assert (exact.keypoints[..., 2] > 0).all() and not exact.up.any()
    off = (noisy.keypoints - exact.keypoints)[..., :2]
    assert abs(off.std() - 10) < 0.5


@pytest.mark.long
def test_the_command_trains_for_a_column_and_measures_on_the_test(tmp_path, monkeypatch, capsys):
    motion = {"a": people(80), "b": people(20)}
    paths = [write_motion(tmp_path / f"{name}.npz", m) for name, m in motion.items()]
    page, results = tmp_path / "page.md", tmp_path / "columns.json"
    page.write_text("<!-- begin columns -->\n<!-- end columns -->\n")
    command = ["columns", "--train", paths[0], paths[0], "--test", paths[1], "--columns", "n10"]
    command += ["--epochs", 1, "--out", tmp_path / "out", "--json", results, "--update", page]
    monkeypatch.setattr("sys.argv", [str(word) for word in command])
    name = columns.ALONE.format("n10")
    small = dataclasses.replace(ablations.ABLATIONS[name], hidden=(8, 8), batch=40)
    monkeypatch.setitem(ablations.ABLATIONS, name, small)
    assert columns.main() == 0, capsys.readouterr().err
    found = json.loads(results.read_text())["n10"]
    assert found["epochs"] == 1 and list(found["for this column"]) == ["b.npz"]
    assert found["for this column"]["b.npz"]["error"] > found["for all columns"]["b.npz"]["error"]
    assert "| n10 | " in page.read_text()
    (tmp_path / "a.npz").unlink()
    assert columns.main() == 1 and "a.npz" in capsys.readouterr().err


@pytest.mark.claims("docs/accuracy-log.md", "columns")
def test_the_page_has_the_results():
    page = ROOT / "docs" / "accuracy-log.md"
    results = json.loads(columns.RESULTS.read_text())
    assert markdown.read(page, "columns").strip() == columns.report(results).strip()
