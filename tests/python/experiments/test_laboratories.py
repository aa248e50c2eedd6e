"""Networks trained without a laboratory: who is left out, who is measured, and the table."""

import dataclasses
import json

import numpy as np
import pytest
from motions import people, write_motion
from support import ROOT

from data.mocap import MocapError
from edmlift.joints import mid_hip
from experiments import laboratories
from experiments.runs import finish, library_of
from model.layout import KINDS
from reports import markdown
from training.loss import lift
from training.recipe import RECIPES
from training.run import Run
from training.views import draw_2d


def of(numbers, count: int = 120):
    """Motion of these people."""
    motion = people(count)
    subject = np.array(numbers)[np.arange(count) % len(numbers)]
    return dataclasses.replace(motion, subject=subject, joints=motion.joints + count / 1000)


def test_all_of_a_laboratory_are_left_out_and_nobody_else():
    train = [of([1, 2]), of([85, 5001, 5101])]
    left = {
        name: [np.unique(m.subject).tolist() for m in laboratories.without(train, numbers)]
        for name, numbers in laboratories.LABORATORIES.items()
    }
    assert left == {
        "CMU": [[5001, 5101]],
        "UI-PRMD": [[1, 2], [85, 5101]],
        "ACCAD": [[1, 2], [85, 5001]],
    }


def test_people_of_the_test_are_measured_if_there_are_any():
    train, test = [of([1, 2]), of([85, 5001, 5101])], [of([3]), of([5006, 5007])]
    whom = {
        name: np.unique(laboratories.whom(numbers, train, test).subject).tolist()
        for name, numbers in laboratories.LABORATORIES.items()
    }
    assert whom == {"CMU": [3], "UI-PRMD": [5006, 5007], "ACCAD": [5101]}
    with pytest.raises(MocapError, match="no subject of 9 to 9"):
        laboratories.whom(range(9, 10), train, test)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_the_library_of_a_run_lifts_as_training_does(tmp_path, kind):
    recipe = dataclasses.replace(RECIPES[kind], l2_epochs=0, pose_epochs=1, batch=60)
    motion = of([1, 2])
    run = finish(Run([motion], recipe, 3), [motion], tmp_path / f"{kind}.state")
    views = draw_2d(people(70).joints, recipe, np.random.default_rng(1))
    lifted = library_of(run, tmp_path / f"{kind}.npz").lift(views.keypoints)
    blind = views._replace(up=np.zeros((70, 3), np.float32))
    expected = np.asarray(lift(recipe, run.params, blind)[0], float)
    assert (lifted.status == "ok").all()
    assert np.abs(lifted.joints - expected + mid_hip(expected)[:, None]).max() < 1e-4


@pytest.mark.long
def test_the_command_trains_without_each_and_with_all(tmp_path, monkeypatch, capsys):
    motions = {"a": of([1, 2]), "b": of([85, 5001, 5101]), "c": of([3], 20), "d": of([5006], 21)}
    paths = {name: write_motion(tmp_path / f"{name}.npz", m) for name, m in motions.items()}
    page, results = tmp_path / "page.md", tmp_path / "laboratories.json"
    page.write_text("<!-- begin laboratories -->\n<!-- end laboratories -->\n")
    command = ["laboratories", "--train", paths["a"], paths["b"], "--test", paths["c"], paths["d"]]
    command += ["--epochs", 1, "--out", tmp_path / "out", "--json", results, "--update", page]
    monkeypatch.setattr("sys.argv", [str(word) for word in command])
    monkeypatch.setattr(laboratories, "COLUMNS", ("gt", "cpm"))
    small = dataclasses.replace(RECIPES["direct"], hidden=(8, 8), batch=40)
    monkeypatch.setitem(RECIPES, "direct", small)
    assert laboratories.main() == 0, capsys.readouterr().err
    found = json.loads(results.read_text())["direct"]
    assert list(found) == ["CMU", "UI-PRMD", "ACCAD"]
    assert found["ACCAD"]["test"] == {"source": "b.npz", "poses": 40}
    assert list(found["ACCAD"]["figures"]) == ["left out", "these people in training"]
    assert list(found["CMU"]["figures"]) == ["left out", "others of it in training"]
    assert found["CMU"]["data"]["files"][0]["subjects"] == [5001, 5101]
    assert "| direct: UI-PRMD, left out | " in page.read_text()
    (tmp_path / "a.npz").unlink()
    assert laboratories.main() == 1 and "a.npz" in capsys.readouterr().err


@pytest.mark.claims("docs/accuracy-log.md", "laboratories")
def test_the_page_has_the_results():
    page = ROOT / "docs" / "accuracy-log.md"
    results = json.loads(laboratories.RESULTS.read_text())
    assert markdown.read(page, "laboratories").strip() == laboratories.report(results).strip()
