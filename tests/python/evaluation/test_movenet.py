"""MoveNet's detections, lifted, beside BlazePose's."""

from pathlib import Path

import numpy as np
import pytest
from support import ROOT

from data.detections import BLAZEPOSE, DETECTORS, FIRST, LIGHTNING, THUNDER, read_street
from edmlift.library import Library
from evaluation import detections
from reports import markdown

PAGE = ROOT / "docs" / "detections.md"
MOVENET = (THUNDER, LIGHTNING)


@pytest.fixture(scope="module")
def read(library: Library) -> dict:
    """Four views and errors of each detector."""
    return {detector.name: detections.read_beam(library, detector) for detector in DETECTORS}


@pytest.fixture(scope="module")
def columns(library: Library, read: dict) -> dict[str, dict]:
    beams = {name: beam for name, (beam, _) in read.items()}
    return detections.compare(library, beams, {name: errors for name, (_, errors) in read.items()})


@pytest.mark.claims("docs/detections.md", "detectors")
def test_the_table_is_the_pages(columns):
    assert markdown.read(PAGE, "detectors") == detections.report_detectors(columns)


# Measured 71.2 to 80.0 mm; a tenth is left for other weights.
@pytest.mark.parametrize("name", [detector.name for detector in DETECTORS])
def test_what_is_lifted_is_near_every_reference(columns, name: str):
    for other in DETECTORS:
        assert columns[name][f"**lift, against that of {other.name}**"] < 88


@pytest.mark.parametrize("detector", MOVENET, ids=lambda d: d.name)
def test_movenet_knows_left_from_right_once_it_has_found_him(read, detector):
    for clip in read[detector.name][0].values():
        assert not clip.swapped[FIRST:].any()


@pytest.mark.parametrize("detector", MOVENET, ids=lambda d: d.name)
def test_it_has_no_joints_in_space_of_its_own(library, read, detector):
    for clip in (*read[detector.name][0].values(), read_street(library, detector)):
        assert np.isnan(clip.world).all()
        figures = detections.measure(library, clip)
        assert not {"world", "lift_world"} & set(figures)


@pytest.mark.parametrize("detector", MOVENET, ids=lambda d: d.name)
def test_the_people_of_the_street_are_lifted(library, detector):
    clip = read_street(library, detector)
    assert (library.lift(clip.keypoints).status == "ok").all()


def test_pictures_of_both_detectors_are_drawn(library, read, tmp_path: Path):
    beams = {name: beam for name, (beam, _) in read.items()}
    detections.draw(library, beams, tmp_path / "sheet.png")
    sizes = {path.name: path.stat().st_size for path in tmp_path.iterdir()}
    assert set(sizes) == {f"sheet{d.ending}.png" for d in (BLAZEPOSE, THUNDER)}
    assert all(50_000 < size < 250_000 for size in sizes.values())
