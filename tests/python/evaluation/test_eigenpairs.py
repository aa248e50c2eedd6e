"""How far the scaling in C is from exact eigenpairs: the measure, and the page's figures."""

from pathlib import Path

import numpy as np
import pytest
from motions import people
from support import OTHERS_TEST, ROOT, TEST, need_motion

from data.mocap import load_motion
from evaluation import eigenpairs
from evaluation.command import by_set
from reports import markdown


def test_a_coordinates_sign_does_not_count():
    exact = np.random.default_rng(1).normal(size=(5, 14, 3))
    points = exact * [1, -1, 1]
    points[2, 3, 0] += 0.25
    found = eigenpairs.distances(points, exact)
    assert found[2, 3] == pytest.approx(0.25) and found.sum() == pytest.approx(0.25)


def test_a_sample_is_within_a_hundredth_of_a_millimetre():
    errors = eigenpairs.evaluate("distances_f32", people(60))
    for poses, mean, most, worst in errors.values():
        assert poses == 4 * 60
        assert 0 < mean < 0.002 and mean < most <= worst < 0.05


@pytest.mark.slow
@pytest.mark.claims("docs/accuracy-log.md", "eigenpairs")
def test_the_page_says_what_is_measured():
    found = {
        Path(name).stem: eigenpairs.evaluate("distances_f32", load_motion(need_motion(name)))
        for name in (TEST, OTHERS_TEST)
    }
    page = markdown.read(ROOT / "docs" / "accuracy-log.md", "eigenpairs")
    assert page.strip() == by_set(eigenpairs.report, found).strip()
    for errors in found.values():
        for _, mean, most, _ in errors.values():
            assert mean < 0.001 and most < 0.05
