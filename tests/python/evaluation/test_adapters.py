"""Adapters: their numbers are the script's, and their documentation says what is."""

import re

import numpy as np
import pytest
from support import ROOT, TEST, TRAIN, need_motion

import edmlift
from data import head_model
from data.mocap import load_motion
from edmlift.library import Library
from evaluation import adapters
from fitting import adapters as fit_adapters
from reports import markdown

PAGE = ROOT / "docs" / "detectors.md"
TEXT = (ROOT / "lib" / "joints" / "adapt.h").read_text()
CONSTANTS = {n: float(v) for n, v in re.findall(r"^#define (\w+) REAL\((.*)\)", TEXT, re.M)}
HEADER = (ROOT / "include" / "edmlift.h").read_text()
WALK = np.loadtxt(ROOT / "examples" / "data" / "walk_truth.csv", delimiter=",", ndmin=2)
WALK = WALK.reshape(-1, 14, 3) * [1, -1, -1]  # from the camera's axes to y up
ONE = np.zeros(len(WALK), int)


# ---- What the tools say ----------------------------------------------------------------------


@pytest.mark.claims("docs/detectors.md", "rules")
@pytest.mark.claims("lib/joints/adapt.h", "CROWN", "CENTRE", "BOTH_EARS", "ONE_EAR", "FACE")
@pytest.mark.claims("lib/joints/adapt.h", "TRUNK")
def test_the_constants_and_their_errors_are_the_scripts():
    views = fit_adapters.Views(load_motion(need_motion(TRAIN)))
    found = fit_adapters.fit(views)
    assert found == CONSTANTS
    assert markdown.read(PAGE, "rules") == fit_adapters.report(views, found)
    assert all(abs(value) < 1.5 for value in found.values())  # as adapt.h's ranges say


@pytest.mark.slow
@pytest.mark.claims("docs/detectors.md", "adapters")
def test_the_costs_are_those_of_the_page_and_the_readme(library: Library):
    figures = adapters.evaluate(library, load_motion(need_motion(TEST)))
    assert markdown.read(PAGE, "adapters") == adapters.report(figures)
    assert all(c["refused"] == 0 for way in figures.values() for c in way.values())
    error = {title: round(columns["exact"]["all"], 1) for title, columns in figures.items()}
    own = error["the models' own head and neck"]
    both, eyes = error["coco17, both ears"] - own, error["coco17, eyes and nose"] - own
    mpii = error["*not adapted:* crown and upper neck (MPII)"] - own
    page = " ".join(PAGE.read_text().split())
    crown = error["mpii16, crown"] - own
    assert f"costs {both:.1f} mm with both ears, {crown:.1f} mm with a crown" in page
    assert f"and {eyes:.1f} mm with eyes and nose" in page
    assert f"would cost {mpii:.0f} mm" in page


def test_the_page_lists_every_format_and_its_keypoints(library: Library):
    table = PAGE.read_text().partition("## All formats\n\n|")[2].partition("\n\n")[0]
    listed = {}
    for row in table.splitlines()[2:]:
        names, counts = row.split("|")[1:3]
        names, counts = re.findall(r"`(\w+)`", names), re.findall(r"\d+", counts)
        listed |= dict(zip(names, map(int, counts * len(names)), strict=False))
    declared = " ".join(re.findall(r"^extern const edml_format (edml.*?);", HEADER, re.M))
    names = re.findall(r"edml_(\w+)", declared)
    assert listed == {name: library.format(name).keypoints for name in names}
    assert set(names) == set(edmlift.FORMATS)
    assert all(library.format(name).name.decode() == name for name in names)


# ---- The head model --------------------------------------------------------------------------


def sizes(points: dict[str, np.ndarray], a: str, b: str) -> np.ndarray:
    return 1000 * np.linalg.norm(points[a] - points[b], axis=1)


def test_a_modelled_head_has_the_sizes_that_are_published():
    points = head_model.landmarks(WALK, ONE, np.random.default_rng(0))
    ears = (points["left_ear"] + points["right_ear"]) / 2
    np.testing.assert_allclose(sizes(points, "left_ear", "right_ear"), head_model.HEAD_BREADTH)
    np.testing.assert_allclose(sizes(points, "left_eye", "right_eye"), head_model.PUPILS)
    np.testing.assert_allclose(
        sizes(points | {"ears": ears}, "crown", "ears"), head_model.TRAGION_TO_CROWN
    )


def test_ears_are_as_high_above_the_shoulders_as_published_on_the_mean():
    points = head_model.landmarks(WALK, ONE, np.random.default_rng(0))
    ears = (points["left_ear"] + points["right_ear"]) / 2
    shoulder = head_model.mid_shoulder(WALK)
    hip = (WALK[:, 8] + WALK[:, 11]) / 2
    up = (shoulder - hip) / np.linalg.norm(shoulder - hip, axis=1, keepdims=True)
    height = 1000 * ((ears - shoulder) * up).sum(1)
    assert height.mean() == pytest.approx(head_model.EAR)


def test_the_face_is_in_front_and_left_is_left():
    points = head_model.landmarks(WALK, ONE, np.random.default_rng(0))
    left = WALK[:, 5] - WALK[:, 2]
    forward = np.cross(left, WALK[:, 1] - (WALK[:, 8] + WALK[:, 11]) / 2)
    ears = points["left_ear"] - points["right_ear"]
    nose = points["nose"] - (points["left_ear"] + points["right_ear"]) / 2
    assert ((ears * left).sum(1) > 0).mean() > 0.95  # heads turn
    assert ((nose * forward).sum(1) > 0).mean() > 0.95


def test_a_taller_person_has_a_larger_head():
    both = np.concatenate([WALK, 1.2 * WALK])
    subject = np.repeat([1, 2], len(WALK))
    points = head_model.landmarks(both, subject, np.random.default_rng(0))
    breadth = sizes(points, "left_ear", "right_ear").reshape(2, -1).mean(1)
    assert breadth[1] / breadth[0] == pytest.approx(1.2)
    assert breadth.mean() == pytest.approx(head_model.HEAD_BREADTH)


# ---- The binding -----------------------------------------------------------------------------


def test_adapt_copies_limbs(library: Library):
    keypoints = np.random.default_rng(0).uniform(0.1, 1, (5, 17, 3)).astype(np.float32)
    joints = library.adapt(keypoints, "coco17")
    np.testing.assert_array_equal(joints[:, 2:], keypoints[:, list(library.format("coco17").limb)])
    for wrong in (keypoints[:, :16], keypoints[0]):
        with pytest.raises(ValueError, match="17"):
            library.adapt(wrong, "coco17")


def test_a_coefficient_is_the_nearest():
    rng = np.random.default_rng(0)
    start, through = rng.normal(size=(2, 50, 2))
    target = start + 0.7 * (through - start) + rng.normal(0, 1e-3, (50, 2))
    assert fit_adapters.coefficient(start, through, target) == 0.7
