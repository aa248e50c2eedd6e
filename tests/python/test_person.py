"""Size, quality, uncertainty and floor: constants and documents say what the scripts find."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import evaluate_person
import fit_person
import marks
from edmlift import library as edmlift
from edmlift.joints import BONE_TYPE, BONES, JOINTS
from mocap import load_motion

DATA = Path(os.environ.get("EDMLIFT_DATA", ROOT.parent / "shared" / "data"))
PAGE = ROOT / "docs" / "body.md"
WALK = np.loadtxt(ROOT / "examples" / "data" / "walk.csv", delimiter=",", ndmin=2)
TYPE = [next(k for k, ends in BONE_TYPE.items() if JOINTS[end] in ends) for _, end in BONES]


@pytest.fixture(scope="module")
def library() -> edmlift.Library:
    if not Path(os.environ.get("EDMLIFT_LIBRARY", edmlift.LIBRARY)).exists():
        pytest.skip("the tools' library is not built")
    return edmlift.Library()


@pytest.fixture(scope="module")
def walk() -> np.ndarray:
    """Keypoints [F,14,3]."""
    points = WALK.reshape(len(WALK), 14, -1)
    return np.concatenate([points[..., :2], np.ones_like(points[..., :1])], -1)


def need(name: str) -> Path:
    if not (DATA / name).exists():
        pytest.skip("needs the motion data")
    return DATA / name


def text_of(name: str) -> str:
    return (ROOT / "lib" / name).read_text()


def constant(name: str, file: str) -> float:
    return float(re.search(rf"^#define {name} (?:REAL\()?([\d.]+)", text_of(file), re.M)[1])


# ---- What the tools say ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(library: edmlift.Library) -> fit_person.Constants:
    return fit_person.fit(library, load_motion(need("cmu14_train.npz")))


def test_sizes_are_the_scripts(found: fit_person.Constants):
    numbers = [float(n) for n in re.findall(r"REAL\((0\.\d{3}|1\.0)\)", text_of("person.inc"))]
    assert numbers[:14] == [found.shares[kind] for kind in TYPE] + [1.0]
    assert constant("CHAIN", "person.inc") == found.shares["chain"]
    assert found.disagreement < constant("AGREE", "person.inc")
    assert constant("ANKLE", "floor.inc") == found.ankle


def test_the_model_of_quality_is_the_scripts(found: fit_person.Constants):
    pairs = re.findall(r"\{REAL\((.{4})\), REAL\((.{4})\)\}", text_of("quality.inc"))
    assert [tuple(map(float, p)) for p in pairs] == [found.limits[kind] for kind in TYPE]
    names = {"margin": "MARGIN", "residual": "RESIDUAL", "misfit": "MISFIT", "missing": "MISSING",
             "bones": "BEYOND", "constant": "CONSTANT"}  # fmt: skip
    signs = {"margin": 1, "constant": 1}
    for name, macro in names.items():
        ours = signs.get(name, -1) * constant(macro, "quality.inc")
        assert ours == pytest.approx(found.quality[name], abs=0.0051), name
    most = {"margin": "MOST_MARGIN", "residual": "MOST_METRES", "misfit": "MOST_METRES",
            "missing": "MOST_MISSING", "bones": "MOST_BEYOND"}  # fmt: skip
    for name, macro in most.items():
        assert constant(macro, "quality.inc") == fit_person.MOST[name], name


def test_errors_of_joints_are_the_scripts(found: fit_person.Constants):
    rows = re.findall(r"^static const joint_error (\w+) = (.*);", text_of("uncertainty.c"), re.M)
    assert [name for name, _ in rows] == [t.removesuffix("_top") for t in fit_person.JOINT_TYPE]
    table = np.array([[int(n) for n in re.findall(r"\d+", row)] for _, row in rows])
    assert np.abs(table - found.uncertainty).max() <= 1


@pytest.fixture(scope="module")
def tables(library: edmlift.Library) -> dict[str, str]:
    return evaluate_person.evaluate(library, load_motion(need("cmu14_test.npz")))


@pytest.mark.parametrize("name", ["sizes", "quality", "kept", "partial"])
def test_tables_are_those_of_the_page(tables: dict[str, str], name: str):
    assert marks.read(PAGE, name).strip() == tables[name].strip()


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


def test_quality_is_computed_as_it_was_fitted(library: edmlift.Library, walk: np.ndarray):
    rng = np.random.default_rng(1)
    walk = walk[:: max(1, len(walk) // 60)].copy()
    walk[..., :2] += rng.normal(0, 8, walk[..., :2].shape)
    walk[rng.random(walk.shape[:2]) < 0.1, 2] = 0
    poses = library.lift(walk)
    fine = poses.status == "ok"
    assert fine.sum() > 20
    limits = re.findall(r"\{REAL\((.{4})\), REAL\((.{4})\)\}", text_of("quality.inc"))
    allowed = {k: tuple(map(float, p)) for k, p in zip(TYPE, limits, strict=True)}
    x = fit_person.features(poses, walk, allowed)[fine]
    c = [constant(n, "quality.inc") for n in ("MARGIN", "RESIDUAL", "MISFIT", "MISSING", "BEYOND")]
    score = constant("CONSTANT", "quality.inc") + x @ (np.array(c) * [1, -1, -1, -1, -1])
    expected = fit_person.sigmoid(score)
    assert library.quality(poses, walk)[fine] == pytest.approx(expected, abs=1e-4)


def test_a_height_and_bones_reach_the_library(library: edmlift.Library, walk: np.ndarray):
    poses = library.lift(walk[:3])
    tall, status = library.fit_person(poses.joints, height=np.array([1.5, 1.75, 2.0]))
    assert (status == "ok").all()
    chain = fit_person.chain(fit_person.bone_lengths(tall))
    assert chain == pytest.approx(constant("CHAIN", "person.inc") * np.array([1.5, 1.75, 2]), 1e-4)
    bones = np.zeros(13)
    bones[8] = 0.41
    known, _ = library.fit_person(poses.joints, bones=bones)
    assert fit_person.bone_lengths(known)[:, 8] == pytest.approx(0.41, abs=1e-5)
    wrong, status = library.fit_person(poses.joints, height=10)
    assert (status == "person").all() and np.isnan(wrong).all()


def test_a_walk_stands_on_the_floor(library: edmlift.Library, walk: np.ndarray):
    for pose in library.lift(walk[:20]).joints:
        status, stood = library.floor(pose, (0, -1, 0))
        assert status == "ok"
        assert stood[[10, 13], 1].min() == pytest.approx(0.07, abs=1e-5)
        assert stood[0, 1] > 1.2  # the head
    assert library.floor(pose, (0, 0, 0))[0] == "degenerate"


def test_too_few_joints_have_no_uncertainty(library: edmlift.Library):
    seen = np.ones((2, 14), bool)
    seen[1, :5] = False
    told = library.uncertainty(seen)
    assert np.isfinite(told[0]).all() and np.isnan(told[1]).all()
