"""Plots are small files of the same bytes, and show the figures that they are given."""

import numpy as np
import pytest
from PIL import Image

from data.mocap import Motion
from data.views import NOISE, views
from edmlift.joints import mid_hip
from edmlift.library import Poses
from evaluation import accuracy
from evaluation.measures import evaluate
from reports import plots


class Perfect:
    """Lifts to the truth, moved by more from pose to pose."""

    def __init__(self, truth):
        self.truth = truth

    def lift(self, keypoints):
        joints = self.truth.copy()
        joints[:, 4] += np.linspace(0, 0.5, len(keypoints))[:, None]
        return Poses.of(joints)


@pytest.fixture(scope="module")
def report():
    joints = np.random.default_rng(2).normal(0, 0.3, (40, 14, 3)) + [0, 1, 0]
    number = np.repeat([0, 1, 2, 3], 10)
    motion = Motion(joints, number, number, number, number, (), "made up")
    truth = views(joints)["gt"].truth
    lifter = Perfect(truth - mid_hip(truth)[:, None])
    return evaluate(lifter, motion), accuracy.examples(lifter, motion)


@pytest.mark.slow
def test_plots_are_small_and_the_same_again(tmp_path, report):
    figures, examples = report
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        plots.write_all(tmp_path / folder, figures, {"rival": figures}, accuracy.PAPER, examples)
    files = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert files == sorted(f"{name}.png" for name in plots.NAMES)
    for name in files:
        data = (tmp_path / "a" / name).read_bytes()
        assert len(data) < 150_000 and data == (tmp_path / "b" / name).read_bytes()
        with Image.open(tmp_path / "a" / name) as picture:
            assert len(picture.getcolors()) > 4  # something is drawn


def test_bars_and_lines_have_the_figures(report):
    figures, _ = report
    (ax,) = plots.errors(figures, {}).axes
    heights = [bar.get_height() for bar in ax.containers[0]]
    assert heights == [column["error"] for column in figures.values()]
    (ax,) = plots.noise(figures, {}, accuracy.PAPER).axes
    lines = {line.get_label(): line.get_ydata() for line in ax.get_lines()}
    assert list(lines["edmlift"]) == [figures[n]["error"] for n in ("gt", *NOISE)]
    assert 62.2 in lines["the paper's FConv, on other data"]


def test_no_rival_is_left_out(report):
    figures, _ = report
    many = {f"rival {n}": figures for n in range(9)}
    for figure in (plots.errors(figures, many), plots.noise(figures, many, accuracy.PAPER)):
        titles = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        assert set(many) <= set(titles)


def test_examples_run_from_the_best_to_the_worst(tmp_path, report, monkeypatch):
    _, examples = report
    drawn = {}
    monkeypatch.setattr(plots.edmlift, "draw", lambda *_, **options: drawn.update(options))
    plots.draw_examples(tmp_path / "x.png", **examples)
    error = examples["error"][drawn["frames"]]
    assert error[0] == examples["error"].min() and error[-1] == examples["error"].max()
    assert (np.diff(error) >= 0).all()
    assert drawn["names"][0].startswith("best: ") and drawn["names"][-1].startswith("worst: ")
