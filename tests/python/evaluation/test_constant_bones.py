"""What the page on motion files says of skeletons whose bones keep their length."""

import numpy as np
import pytest
from support import ROOT, need_library

import edmlift
from evaluation import motion_files
from reports import markdown

PAGE = ROOT / "docs" / "files.md"


@pytest.mark.claims("docs/files.md", "skeleton")
def test_the_page_has_what_is_measured():
    need_library()
    assert markdown.read(PAGE, "skeleton").strip() == motion_files.skeleton_table().strip()


def test_the_page_has_every_file():
    rows = markdown.read(PAGE, "long").strip().splitlines()[2:]
    assert [row.split("`")[1] for row in rows] == list(edmlift.MOTION_SUFFIXES)


def test_figures_of_bones_that_change_and_of_bones_that_do_not():
    truth = edmlift.read_truth(motion_files.DATA / "walk_truth.csv")
    still = edmlift.Poses.of(np.repeat(truth[:1], 5, axis=0))
    assert motion_files.figures(still, still.joints) == pytest.approx([0, 0, 0, 0], abs=1e-3)
    grown = still.joints.copy()
    grown[-1] *= 1.1
    moved, most, before, after = motion_files.figures(edmlift.Poses.of(grown), still.joints)
    farthest = 100 * np.linalg.norm(truth[0], axis=-1).max()
    assert most == pytest.approx(farthest, rel=0.01) and 0 < moved < most / 5
    assert before > 5 * after
