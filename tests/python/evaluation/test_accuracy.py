"""The metric measures what it says, on lifters whose errors are known."""

import json
from dataclasses import dataclass

import numpy as np
import pytest
from motions import people, write_motion
from scipy.spatial.transform import Rotation

from data.views import NOISE, Column, views
from edmlift.joints import INDEX, mid_hip
from edmlift.library import Poses
from evaluation import accuracy, cli, command, forms, measures
from reports import markdown


@dataclass
class Pretend:
    """A lifter that returns prepared joints."""

    joints: np.ndarray
    status: str = "ok"

    def lift(self, keypoints):
        assert len(keypoints) == len(self.joints)
        return Poses.of(self.joints, status=self.status)


@pytest.fixture
def truth():
    return np.random.default_rng(0).normal(0, 0.4, (60, 14, 3)) + [0, 0, 4]


SUBJECT = np.repeat([1, 2, 3], [40, 15, 5])


def figures(joints, truth, seen=None):
    seen = np.ones(truth.shape[:2], bool) if seen is None else seen
    column = Column(np.zeros((*truth.shape[:2], 3)), seen, truth)
    return measures.measure(Pretend(joints), column, SUBJECT)


def test_a_rotated_and_moved_truth_has_no_error(truth):
    moved = truth @ Rotation.random(rng=np.random.default_rng(1)).as_matrix() + [1, 2, 3]
    result = figures(moved, truth)
    assert result["error"] == pytest.approx(0, abs=1e-3)
    assert result["mirror_right_percent"] == 100 and result["pck150_percent"] == 100
    assert result["camera_axes"] > 100  # no alignment there


def test_the_mirror_image_is_wrong_but_for_the_oracle(truth):
    result = figures(truth * [1, 1, -1], truth)
    assert result["error"] > 50 and result["mirror_right_percent"] == 0
    assert result["oracle_mirror"] == pytest.approx(0, abs=1e-3)


def test_size_counts_unless_scaled(truth):
    result = figures(truth * 1.1, truth)
    assert result["with_scale"] == pytest.approx(0, abs=1e-3)
    centred = truth - truth.mean(1, keepdims=True)
    expected = [(100 * np.linalg.norm(centred[s == SUBJECT], axis=-1)).mean() for s in (1, 2, 3)]
    assert result["error"] == pytest.approx(np.mean(expected))


def test_subjects_count_alike(truth):
    joints = truth.copy()
    joints[SUBJECT == 3] *= [1, 1, -1]  # 5 of 60 frames, 1 of 3 subjects
    result = figures(joints, truth)
    assert result["mirror_right_percent"] == pytest.approx(200 / 3)
    assert result["mirror_right_percent_of_frames"] == pytest.approx(100 * 55 / 60)
    low, high = result["interval"]
    assert low == pytest.approx(0, abs=1e-3) and high > result["error"]


def test_hidden_joints_are_told_apart(truth):
    seen = np.ones((60, 14), bool)
    seen[:, INDEX["left_wrist"]] = False
    joints = truth.copy()
    joints[:, INDEX["left_wrist"]] += [0.2, 0, 0]
    result = figures(joints, truth, seen)
    assert result["hidden_joints"] == pytest.approx(result["by_joint"]["left_wrist"])
    assert result["hidden_joints"] > 5 * result["by_joint"]["right_knee"]
    assert "hidden_joints" not in figures(joints, truth)


def test_camera_axes_compares_without_rotating(truth):
    rooted = truth - mid_hip(truth)[:, None]
    assert figures(rooted, truth)["camera_axes"] == pytest.approx(0, abs=1e-3)


def test_what_is_told_of_up_reaches_the_lifter(truth):
    """Of a lifter that believes it: it turns the truth by as much as up is wrong."""

    class Believer(Pretend):
        def lift(self, keypoints, up=None):
            self.told.append(up)
            return super().lift(keypoints)

    up = np.tile([0.0, -1.0, 0.0], (60, 1))
    column = Column(np.zeros((60, 14, 3)), np.ones((60, 14), bool), truth, up)
    rooted = truth - mid_hip(truth)[:, None]
    lifter = Believer(rooted + [0, 0, 0.01])
    lifter.told = []
    wrong = measures.tilted(up, 10)
    for told in (None, up, wrong):
        found = measures.both_errors(lifter, column, SUBJECT, told)
        assert found["error"] == pytest.approx(0, abs=1e-3)
        assert found["camera_axes"] == pytest.approx(10, abs=1e-3)
    assert lifter.told[0] is None and lifter.told[1] is up and lifter.told[2] is wrong
    assert np.degrees(np.arccos((wrong * up).sum(1))) == pytest.approx(10)
    assert np.abs(wrong.mean(0) - np.cos(np.radians(10)) * up[0]).max() < 0.1  # to any side


class Half(Pretend):
    """Refuses every other pose."""

    def lift(self, keypoints):
        poses = super().lift(keypoints)
        status = np.where(np.arange(len(keypoints)) % 2, poses.status, "degenerate")
        joints = np.where(np.arange(len(keypoints))[:, None, None] % 2, poses.joints, np.nan)
        return Poses.of(joints, status=status)


def test_refused_poses_are_counted_and_left_out(truth):
    column = Column(np.zeros((60, 14, 3)), np.ones((60, 14), bool), truth)
    result = measures.measure(Half(truth), column, SUBJECT)
    assert result["refused"] == 30 and result["error"] == pytest.approx(0, abs=1e-3)


def test_views_are_the_protocols_columns():
    joints = np.random.default_rng(2).normal(0, 0.3, (200, 14, 3)) + [0, 1, 0]
    columns = views(joints)
    limbs = ["right_arm", "left_arm", "right_leg", "left_leg"]
    noisy = ["n5", "n10", "n15", "n20", "cpm"]
    assert list(columns) == ["gt", *noisy, "rand2", *limbs, "rolled", "close", "sideways"]
    exact = columns["gt"].keypoints[..., :2]
    for name, sigma in NOISE.items():
        off = columns[name].keypoints[..., :2] - exact
        assert off.std() == pytest.approx(sigma, rel=0.05)
    assert (columns["rand2"].seen.sum(1) == 12).all()
    again = views(joints)
    assert all(np.array_equal(columns[n].keypoints, again[n].keypoints) for n in columns)
    assert columns["gt"].truth is columns["left_leg"].truth
    near, far = (np.linalg.norm(mid_hip(columns[n].truth), axis=1) for n in ("close", "gt"))
    assert near.min() > 1.4 and near.max() < 3.01 < far.max()


def test_tables_have_a_row_a_figure(truth):
    found = {"gt": figures(truth, truth)}
    assert "| error | 0.0 |" in accuracy.means_table(found)
    assert "| left_wrist | 0.0 |" in accuracy.joints_table(found)


def test_what_a_form_loses_is_told_from_the_float_lift(truth):
    column = Column(np.zeros((60, 14, 3)), np.ones((60, 14), bool), truth)
    near = truth + [0, 0.003, 0]
    near[:6] *= [1, 1, -1]
    result = forms.lose({"f32": Pretend(truth), "near": Pretend(near)}, column, SUBJECT)
    assert list(result) == ["near"]
    assert result["near"]["moved"] == pytest.approx(3, rel=1e-4)
    assert result["near"]["moved_999"] == pytest.approx(3, rel=1e-4)
    assert result["near"]["mirrored"] == 6 and result["near"]["refused"] == 0
    assert result["near"]["error"] > 5  # of the six; moving costs nothing
    half = forms.lose({"f32": Pretend(truth), "half": Half(near)}, column, SUBJECT)["half"]
    assert half["refused"] == 30 and half["moved"] == pytest.approx(3, rel=1e-4)


def test_small_differences_have_no_sign():
    assert markdown.signed(-0.004) == "0.00" and markdown.signed(-0.006) == "-0.01"


def test_rivals_stand_beside_the_models_and_the_paper(truth):
    mine = {"gt": figures(truth, truth), "close": figures(truth, truth)}
    rival = {name: figures(truth * 1.1, truth) for name in mine}
    text = accuracy.rivals_table({"direct": mine, "distances": rival}, {"nearest": rival})
    aligned, camera = text.split("\n\n")
    assert "| edmlift, direct | 0.0 | 0.0 |" in aligned
    assert f"| nearest | {rival['gt']['error']:.1f} |" in aligned
    assert aligned.splitlines()[-1] == "| the paper's FConv, on other data | 62.2 |  |"
    assert f"| nearest | {rival['gt']['camera_axes']:.1f} |" in camera and "paper" not in camera


def test_sets_of_people_stand_one_after_the_other():
    text = command.by_set("| {} |\n".format, {"cmu14_test": 1, "theirs": 2})
    assert text == "**CMU's people**\n\n| 1 |\n\n**theirs**\n\n| 2 |\n"


def test_errors_go_into_the_manifest_by_set(tmp_path):
    manifest = tmp_path / "net.json"
    manifest.write_text('{"mirror": [1, 2]}')
    figures = {s: {"gt": {"error": e}} for s, e in (("one", 50.04), ("two", 60.0))}
    lost = {s: {"w8": {"gt": {"error": f["gt"]["error"] + 1}}} for s, f in figures.items()}
    accuracy.record_errors(manifest, figures, lost)
    assert json.loads(manifest.read_text()) == {
        "mirror": [1, 2], "metrics": {"gt": 50.0}, "metrics_w8": {"gt": 51.0},
        "metrics_others": {"two": {"gt": 60.0}},
    }  # fmt: skip


class Fake(Pretend):
    """In place of the library, with every model: lifts to the truth, and a little off."""

    def __init__(self, model, fixed=False):
        self.off = 0.0 if model.endswith("f32") else 0.001

    def has(self, model):
        return not model.endswith("w8")

    def lift(self, keypoints, up=None):
        truth = self.truths[len(keypoints)]
        joints = truth - mid_hip(truth)[:, None]
        joints[:, 0, 0] += self.off
        return Poses.of(joints)


def test_the_command_has_a_table_a_model_and_set(tmp_path, monkeypatch, capsys):
    sets = {"cmu14_test": people(80), "labs14_test": people(40)}
    paths = [write_motion(tmp_path / f"{name}.npz", motion) for name, motion in sets.items()]
    Fake.truths = {len(m.joints): views(m.joints)["gt"].truth for m in sets.values()}
    for module in (accuracy, forms):
        monkeypatch.setattr(module, "Library", Fake)
    page = tmp_path / "page.md"
    names = ("accuracy_direct", "up_direct", "forms_direct", "joints_direct", "angles")
    page.write_text("".join(f"<!-- begin {n} -->\n<!-- end {n} -->\n" for n in names))
    given = ["accuracy", *map(str, paths), "--models", "direct", "fconn", "--update", str(page)]
    assert cli.main(given) == 0
    printed = capsys.readouterr().out
    for name in names:
        text = markdown.read(page, name)
        assert text.index("**CMU's people**") < text.index("**Other laboratories' people**")
        assert text.strip() in printed
    head, rule, error, *_ = markdown.read(page, "accuracy_direct").splitlines()[2:]
    assert head.endswith(" close | sideways |") and error.startswith("| error | 0.0 |")
    assert "fixed point, 16-bit" in markdown.read(page, "forms_direct")
    assert "| camera axes, up given | 0.0 |" in markdown.read(page, "up_direct")
    heads = markdown.read(page, "angles").splitlines()[2]
    assert heads == "| degrees | direct, gt | direct, cpm | direct, gt, up given |"
