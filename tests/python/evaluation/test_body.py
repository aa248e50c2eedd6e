"""Size, quality, uncertainty and standing: constants and documents say what the scripts find."""

import re

import numpy as np
import pytest
from support import ROOT, TEST, TRAIN, need_motion

from data.bodies import bone_lengths
from data.mocap import load_motion
from edmlift.joints import BONE_TYPE, BONES, JOINTS
from edmlift.library import Library
from evaluation import body
from fitting import body as fit_body
from model.constants import number
from model.manifest import read_manifest
from reports import markdown

PAGE = ROOT / "docs" / "body.md"
WALK = np.loadtxt(ROOT / "examples" / "data" / "walk.csv", delimiter=",", ndmin=2)
TYPE = [next(k for k, ends in BONE_TYPE.items() if JOINTS[end] in ends) for _, end in BONES]


@pytest.fixture(scope="module")
def walk() -> np.ndarray:
    """Keypoints [F,14,3]."""
    points = WALK.reshape(len(WALK), 14, -1)
    return np.concatenate([points[..., :2], np.ones_like(points[..., :1])], -1)


def text_of(name: str) -> str:
    return (ROOT / "lib" / "optional" / name).read_text()


# ---- What the tools say ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(library: Library) -> fit_body.Constants:
    return fit_body.fit(library, load_motion(need_motion(TRAIN)))


def test_sizes_are_the_scripts(found: fit_body.Constants):
    numbers = [float(n) for n in re.findall(r"REAL\((0\.\d{3}|1\.0)\)", text_of("body.h"))]
    assert numbers[:14] == [found.shares[kind] for kind in TYPE] + [1.0]
    assert number("HEAD_TO_ANKLE") == found.shares["chain"]
    assert found.disagreement < number("MAX_HEIGHT_RATIO")
    assert number("ANKLE_HEIGHT") == found.ankle


def test_the_model_of_quality_is_the_scripts(found: fit_body.Constants):
    pairs = re.findall(r"\{REAL\((.{4})\), REAL\((.{4})\)\}", text_of("quality.h"))
    assert [tuple(map(float, p)) for p in pairs] == [found.bone_range[kind] for kind in TYPE]
    names = {"margin": "PER_MARGIN", "residual": "PER_RESIDUAL", "misfit": "PER_MISFIT",
             "missing": "PER_MISSING", "bones": "PER_VIOLATION",
             "constant": "QUALITY_CONSTANT"}  # fmt: skip
    signs = {"margin": 1, "constant": 1}
    for name, macro in names.items():
        ours = signs.get(name, -1) * number(macro)
        assert ours == pytest.approx(found.quality[name], abs=0.0051), name
    clamps = {"margin": "MAX_MARGIN", "residual": "MAX_METRES", "misfit": "MAX_METRES",
              "missing": "MAX_MISSING", "bones": "MAX_VIOLATION"}  # fmt: skip
    for name, macro in clamps.items():
        assert number(macro) == fit_body.CLAMPS[name], name


def test_errors_of_joints_are_the_scripts(found: fit_body.Constants):
    rows = re.findall(r"^static const joint_error (\w+) = (.*);", text_of("uncertainty.c"), re.M)
    assert [name for name, _ in rows] == list(fit_body.JOINT_TYPE)
    table = np.array([[int(n) for n in re.findall(r"\d+", row)] for _, row in rows])
    assert np.abs(table - found.uncertainty).max() <= 1


@pytest.fixture(scope="module")
def tables(library: Library) -> dict[str, str]:
    return body.evaluate(library, load_motion(need_motion(TEST)), read_manifest("fconn"))


@pytest.mark.parametrize("name", ["sizes", "quality", "kept", "partial"])
def test_tables_are_those_of_the_page(tables: dict[str, str], name: str):
    assert markdown.read(PAGE, name).strip() == tables[name].strip()


def row_of(table: str, title: str) -> list[float]:
    (line,) = [row for row in table.splitlines() if row.startswith(f"| {title} |")]
    return [float(cell) for cell in line.split("|")[2:-1]]


def test_knowing_the_person_helps(tables: dict[str, str]):
    nothing = np.array(row_of(tables["sizes"], "nothing"))
    assert (row_of(tables["sizes"], "height") < nothing - 1).all()
    assert (row_of(tables["sizes"], "bones") < nothing - 1.5).all()
    assert (row_of(tables["sizes"], "bones, put into the matrix instead") > np.array(
        row_of(tables["sizes"], "bones"))).all()  # fmt: skip


def test_nine_of_ten_poses_above_nine_tenths_are_good(tables: dict[str, str]):
    _, told, good, _ = row_of(tables["quality"], "0.9 to 1.0")
    assert told > 90 and good >= 90
    page = " ".join(PAGE.read_text().split())
    assert f"above 0.9, {good:.0f} % are good" in page
    titles = ["0.0 to 0.2", *(f"{n / 10:.1f} to {(n + 1) / 10:.1f}" for n in range(2, 10))]
    shares = [row_of(tables["quality"], title)[2] for title in titles]
    assert shares == sorted(shares)


# ---- The library ------------------------------------------------------------------------------


def test_quality_is_computed_as_it_was_fitted(library: Library, walk: np.ndarray):
    rng = np.random.default_rng(1)
    walk = walk[:: max(1, len(walk) // 60)].copy()
    walk[..., :2] += rng.normal(0, 8, walk[..., :2].shape)
    walk[rng.random(walk.shape[:2]) < 0.1, 2] = 0
    poses = library.lift(walk)
    fine = poses.status == "ok"
    assert fine.sum() > 20
    ranges = re.findall(r"\{REAL\((.{4})\), REAL\((.{4})\)\}", text_of("quality.h"))
    allowed = {k: tuple(map(float, p)) for k, p in zip(TYPE, ranges, strict=True)}
    x = fit_body.features(poses, walk, allowed)[fine]
    inputs = ("MARGIN", "RESIDUAL", "MISFIT", "MISSING", "VIOLATION")
    c = [number(f"PER_{name}") for name in inputs]
    score = number("QUALITY_CONSTANT") + x @ (np.array(c) * [1, -1, -1, -1, -1])
    expected = fit_body.sigmoid(score)
    assert library.quality(poses)[fine] == pytest.approx(expected, abs=1e-4)


def test_a_height_and_bones_reach_the_library(library: Library, walk: np.ndarray):
    poses = library.lift(walk[:3])
    tall, status = library.fit_body(poses.joints, height=np.array([1.5, 1.75, 2.0]))
    assert (status == "ok").all()
    chain = fit_body.chain(bone_lengths(tall))
    assert chain == pytest.approx(number("HEAD_TO_ANKLE") * np.array([1.5, 1.75, 2]), 1e-4)
    bones = np.zeros(13)
    bones[8] = 0.41
    known, _ = library.fit_body(poses.joints, bones=bones)
    assert bone_lengths(known)[:, 8] == pytest.approx(0.41, abs=1e-5)
    wrong, status = library.fit_body(poses.joints, height=10)
    assert (status == "body").all() and np.isnan(wrong).all()


def test_a_walk_stands_on_the_floor(library: Library, walk: np.ndarray):
    for pose in library.lift(walk[:20]).joints:
        status, stood = library.stand(pose, (0, -1, 0))
        assert status == "ok"
        assert stood[[10, 13], 1].min() == pytest.approx(0.07, abs=1e-5)
        assert stood[0, 1] > 1.2  # the head
    assert library.stand(pose, (0, 0, 0))[0] == "degenerate"


def test_too_few_joints_have_no_uncertainty(library: Library):
    seen = np.ones((2, 14), bool)
    seen[1, :5] = False
    told = library.uncertainty(seen)
    assert np.isfinite(told[0]).all() and np.isnan(told[1]).all()
