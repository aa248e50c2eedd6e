"""Networks measured on people whom they never saw: the folds, the figures, and the tables."""

import json
from dataclasses import replace

import numpy as np
import pytest
from motions import people, write_motion
from support import ROOT

from data.views import views
from edmlift.joints import mid_hip
from edmlift.library import Poses
from evaluation.measures import person_errors
from experiments import folds
from reports import markdown, plots

LIBRARY, OTHER = next(iter(folds.OURS)), next(iter(folds.RIVALS))


def test_every_person_is_dealt_once_and_the_hands_are_alike():
    subject = np.repeat([3, 5, 8, 9, 11], [10, 50, 40, 1, 30])
    assert folds.deal(subject, 2) == [[5, 9, 11], [3, 8]]
    assert sorted(sum(folds.deal(subject, 5), [])) == [3, 5, 8, 9, 11]
    for hands in (1, 6):
        with pytest.raises(ValueError, match="must be 2 to 5"):
            folds.deal(subject, hands)


class Off:
    """Lifts to the truth but for one joint, by 14 mm times the person's number, which alignment
    makes a mean of 2 mm; refuses some."""

    def __init__(self, truth, subject, refused):
        self.joints = truth - mid_hip(truth)[:, None]
        self.joints[:, 4, 0] += 0.014 * subject
        self.status = np.where(refused, "degenerate", "ok")

    def lift(self, keypoints):
        return Poses.of(self.joints, status=self.status)


def test_errors_are_each_persons_own_and_refused_poses_are_left_out():
    motion = people(80)
    column = views(motion.joints)["gt"]
    refused = np.arange(80) % 8 == 0
    lifter = Off(column.truth, motion.subject, refused)
    lifter.joints[refused] += np.random.default_rng(1).normal(0, 1, (10, 14, 3))
    errors = person_errors(lifter, column, motion.subject)
    assert list(errors) == ["1", "2", "3", "4"]
    assert all(1.9 * n < errors[str(n)] < 2.1 * n for n in range(1, 5))


@pytest.fixture
def short(tmp_path, monkeypatch):
    """The command on made-up people, with what lifts in place of networks: fold -> who trained."""
    motion = write_motion(tmp_path / "motion.npz", people())
    more = people(90)
    more = write_motion(tmp_path / "more.npz", replace(more, subject=more.subject + 4))
    trained = []

    def lifters(rest, held, epochs, folder, seed):
        trained.append(tuple({s for m in two for s in m.subject.tolist()} for two in (rest, held)))
        subject = np.concatenate([motion.subject for motion in held])
        columns = views(np.concatenate([motion.joints for motion in held]))
        for number, title in enumerate((LIBRARY, OTHER)):
            yield title, Off(columns["gt"].truth, subject + number, subject < 0)

    def run(*options):
        command = ["folds", "--train", motion, more, "--folds", 2]
        command += ["--out", tmp_path / "out", *options]
        monkeypatch.setattr("sys.argv", [str(word) for word in command])
        return folds.main()

    monkeypatch.setattr(folds, "lifters", lifters)
    return run, trained


def test_the_command_writes_tables_json_and_picture_and_goes_on(tmp_path, short, capsys):
    run, trained = short
    page, results = tmp_path / "page.md", tmp_path / "people.json"
    page.write_text("<!-- begin people -->\n<!-- end people -->\n")
    options = ("--json", results, "--update", page, "--plots", tmp_path)
    assert run(*options) == 0
    odd, even = {1, 3, 5, 7}, {2, 4, 6, 8}
    assert trained == [(even, odd), (odd, even)]  # never the same people
    found = json.loads(results.read_text())
    assert set(found["errors"][OTHER]["gt"]) == set("12345678")
    lines = page.read_text().splitlines()
    assert any(line.startswith(f"| {LIBRARY} against {OTHER} | 8 |") for line in lines)
    assert (tmp_path / "people.png").stat().st_size > 5000
    once = results.read_bytes()
    assert run(*options) == 0 and len(trained) == 2 and results.read_bytes() == once
    assert run(*options, "--epochs", 7) == 1  # of another run
    assert "remove it to start anew" in capsys.readouterr().err


def test_errors_of_the_command_are_clear(tmp_path, short, capsys):
    run, _ = short
    assert run("--folds", 9) == 1
    assert "9 folds of 8 people" in capsys.readouterr().err
    (tmp_path / "motion.npz").unlink()
    assert run() == 1
    assert "motion.npz" in capsys.readouterr().err


@pytest.mark.long
def test_the_networks_are_trained_and_lift(tmp_path):
    rest, held = [people(300), people(100)], [people(60)]
    view = views(held[0].joints)["rand2"]
    titles = []
    for title, lifter in folds.lifters(rest, held, 2, tmp_path, 0):
        poses = lifter.lift(view.keypoints)
        assert (poses.status == "ok").all() and np.isfinite(poses.joints).all()
        titles.append(title)
    assert titles == [*folds.OURS, *folds.RIVALS]


def test_bars_and_marks_have_the_figures():
    errors = {"edmlift": {"gt": {"7": 50.0, "3": 40.0}}, "rival": {"gt": {"7": 45.0, "3": 60.0}}}
    (ax,) = plots.people(errors, "gt").axes
    assert [bar.get_height() for bar in ax.containers[0]] == [40, 50]
    assert list(ax.get_lines()[0].get_ydata()) == [60, 45]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["3", "7"]


@pytest.mark.claims("docs/accuracy-log.md", "people")
def test_the_page_has_the_results():
    page = ROOT / "docs" / "accuracy-log.md"
    if not folds.RESULTS.exists():  # as the page then says
        assert markdown.read(page, "people").strip() == ""
        return
    errors = json.loads(folds.RESULTS.read_text())["errors"]
    assert markdown.read(page, "people").strip() == folds.report(errors).strip()
    check_words(errors)


def check_words(errors: dict[str, dict[str, dict[str, float]]]) -> None:
    """What the page says in front of the table."""
    plain, alike = (errors[title] for title in folds.RIVALS)

    def behind(mine: dict, rival: dict) -> dict[str, float]:
        """In the mean of each column, mm."""
        means = {c: float(np.mean([*mine[c].values()])) for c in mine}
        return {c: means[c] - float(np.mean([*rival[c].values()])) for c in mine}

    def ahead_for(mine: dict, column: str) -> int:
        return sum(error < alike[column][who] for who, error in mine[column].items())

    distances, direct = (errors[title] for title in folds.OURS)
    assert max(behind(distances, plain).values()) < 0 > max(behind(direct, plain).values())
    assert max(behind(distances, alike).values()) < 0
    worse = {c: mm for c, mm in behind(direct, alike).items() if mm > 0}
    assert set(worse) == {"right_leg", "left_leg"} and max(worse.values()) < 0.55
    assert ahead_for(distances, "gt") == ahead_for(direct, "gt") == 24
    noisy = [ahead_for(direct, c) for c in ("n5", "n10", "n15", "n20", "cpm")]
    assert (min(noisy), max(noisy)) == (7, 15)
