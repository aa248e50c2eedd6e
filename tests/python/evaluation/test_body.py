"""Size, quality, uncertainty and standing: constants and documents say what the scripts find."""

import re
from pathlib import Path

import numpy as np
import pytest
from support import OTHERS_TEST, OTHERS_TRAIN, ROOT, TEST, TRAIN, need_library, need_motion

from data.bodies import bone_lengths
from data.mocap import load_motion
from edmlift.joints import BONE_TYPE, BONES, JOINTS
from edmlift.library import Library
from evaluation import body
from fitting import body as fit_body
from model.constants import number
from reports import markdown

PAGE = ROOT / "docs" / "body.md"
WALK = np.loadtxt(ROOT / "examples" / "data" / "walk.csv", delimiter=",", ndmin=2)
TYPE = [next(k for k, ends in BONE_TYPE.items() if JOINTS[end] in ends) for _, end in BONES]


@pytest.fixture(scope="module")
def walk() -> np.ndarray:
    """Keypoints [F,14,3]."""
    points = WALK.reshape(len(WALK), 14, -1)
    return np.concatenate([points[..., :2], np.ones_like(points[..., :1])], -1)


# The names of quality.h.
WEIGHTS = {"misfit": "PER_MISFIT", "missing": "PER_MISSING", "bones": "PER_VIOLATION",
           "side": "PER_SIDE", "constant": "QUALITY_CONSTANT"}  # fmt: skip
CLAMPS = {"misfit": "MAX_METRES", "missing": "MAX_MISSING", "bones": "MAX_VIOLATION"}
SIGNS = {"misfit": -1, "missing": -1, "bones": -1, "side": 1, "constant": 1}


def text_of(name: str) -> str:
    return (ROOT / "lib" / "optional" / name).read_text()


# ---- What the tools say ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def found() -> fit_body.Constants:
    need_library()
    lifters = {model: Library(f"{model}_f32") for model in fit_body.MODELS}
    return fit_body.fit(lifters, [load_motion(need_motion(n)) for n in (TRAIN, OTHERS_TRAIN)])


@pytest.mark.long
@pytest.mark.claims("lib/optional/body.h", "HEAD_TO_ANKLE", "proportion")
def test_sizes_are_the_scripts(found: fit_body.Constants):
    numbers = [float(n) for n in re.findall(r"REAL\((0\.\d{3}|1\.0)\)", text_of("body.h"))]
    assert numbers[:14] == [found.shares[kind] for kind in TYPE] + [1.0]
    assert number("HEAD_TO_ANKLE") == found.shares["chain"]
    assert found.disagreement < number("MAX_HEIGHT_RATIO")
    assert number("ANKLE_HEIGHT") == found.ankle


@pytest.mark.long
@pytest.mark.claims("lib/optional/quality.h", "PER_MISFIT", "PER_MISSING", "PER_VIOLATION")
@pytest.mark.claims("lib/optional/quality.h", "PER_SIDE", "QUALITY_CONSTANT")
def test_the_model_of_quality_is_the_scripts(found: fit_body.Constants):
    pairs = re.findall(r"\{REAL\((.{4})\), REAL\((.{4})\)\}", text_of("quality.h"))
    assert [tuple(map(float, p)) for p in pairs] == [found.bone_range[kind] for kind in TYPE]
    for name, macro in WEIGHTS.items():
        ours = SIGNS[name] * number(macro)
        assert ours == pytest.approx(found.quality[name], abs=0.0051), name
    for name, macro in CLAMPS.items():
        assert number(macro) == fit_body.CLAMPS[name], name


@pytest.mark.long
def test_nine_of_ten_training_poses_above_nine_tenths_are_good(found: fit_body.Constants):
    """With bodies that the networks do not know, for each model and laboratory."""
    assert len(found.kept) == 4
    assert all(share > 0.3 and good >= 0.9 for share, good in found.kept.values())


@pytest.mark.long
@pytest.mark.claims("lib/optional/uncertainty.c", "joint_error")
def test_errors_of_joints_are_the_scripts(found: fit_body.Constants):
    rows = re.findall(r"^static const joint_error (\w+) = (.*);", text_of("uncertainty.c"), re.M)
    assert [name for name, _ in rows] == list(fit_body.JOINT_TYPE)
    table = np.array([[int(n) for n in re.findall(r"\d+", row)] for _, row in rows])
    assert np.abs(table - found.uncertainty).max() <= 1


@pytest.fixture(scope="module")
def tables() -> dict[str, str]:
    need_library()
    motions = {Path(name).stem: load_motion(need_motion(name)) for name in (TEST, OTHERS_TEST)}
    return body.evaluate(body.MODELS, motions)


@pytest.mark.long
@pytest.mark.claims("docs/body.md", "sizes", "partial", "quality_distances", "quality_direct")
@pytest.mark.claims("docs/body.md", "kept_distances", "kept_direct")
def test_tables_are_those_of_the_page(tables: dict[str, str]):
    assert set(tables) == {"sizes", "partial", *QUALITIES}
    for name, text in tables.items():
        assert markdown.read(PAGE, name).strip() == text.strip()


QUALITIES = [f"{kind}_{model}" for kind in ("quality", "kept") for model in body.MODELS]


def row_of(table: str, title: str) -> list[float]:
    (line,) = [row for row in table.splitlines() if row.startswith(f"| {title} |")]
    return [float(cell) for cell in line.split("|")[2:-1]]


def sets_of(text: str) -> list[str]:
    """The tables of the sets of people."""
    return text.split("**\n\n")[1:]


@pytest.mark.long
def test_knowing_the_person_helps(tables: dict[str, str]):
    for table in sets_of(tables["sizes"]):
        nothing = np.array(row_of(table, "nothing"))
        assert (row_of(table, "bones") < nothing - 1).all()
        assert (np.array(row_of(table, body.MATRIX)) > row_of(table, "bones")).all()


@pytest.mark.long
@pytest.mark.parametrize("model", body.MODELS)
def test_nine_of_ten_poses_above_nine_tenths_are_good(tables: dict[str, str], model: str):
    quality = sets_of(tables[f"quality_{model}"])
    assert len(quality) == 2  # laboratories
    for table in quality:
        _, told, good, _ = row_of(table, "0.9 to 1.0")
        assert told > 90 and good >= 90


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
    x = fit_body.features(poses, allowed)[fine]
    weights = {name: SIGNS[name] * number(macro) for name, macro in WEIGHTS.items()}
    expected = fit_body.quality_of(x, weights)
    assert library.quality(poses)[fine] == pytest.approx(expected, abs=1e-4)


# ---- The fit ----------------------------------------------------------------------------------


def made_up(title: str, count: int, chance: float) -> fit_body.Sample:
    rng = np.random.default_rng(count)
    x = rng.uniform(0, 1, (count, len(fit_body.FEATURES))) * [0.1, 4, 0.2, 1]
    return fit_body.Sample(title, x, rng.random(count) < chance)


def test_every_sample_counts_alike_in_the_fit():
    """However many poses it has: a good half and a bad one are even odds."""
    weights = fit_body.fit_quality([made_up("few", 500, 1.0), made_up("many", 5000, 0.0)])
    assert list(weights) == [*fit_body.FEATURES, "constant"]
    both = np.concatenate([made_up("", n, 0.5).x for n in (500, 5000)])
    assert fit_body.quality_of(both, weights).mean() == pytest.approx(0.5, abs=0.02)


def test_the_fit_finds_the_weights_of_made_up_poses():
    true = {"misfit": -16.0, "missing": -0.5, "bones": -7.0, "side": 0.9, "constant": 2.3}
    x = made_up("", 40_000, 0).x
    good = np.random.default_rng(1).random(len(x)) < fit_body.quality_of(x, true)
    weights = fit_body.fit_quality([fit_body.Sample("", x, good)])
    found = fit_body.quality_of(x, weights)
    assert np.abs(found - fit_body.quality_of(x, true)).max() < 0.05
    share, right = fit_body.kept(fit_body.Sample("", x, good), weights)
    assert share == pytest.approx((found > 0.9).mean()) and right > 0.9


def test_the_view_from_the_side_is_told_of_the_torso():
    pose = np.zeros((3, 14, 3))
    pose[0, [5, 11], 0], pose[1, [5, 11], 2] = 0.3, -0.3  # from the front; from a side
    pose[2, [5, 11]] = (0.3, 0, 0.3)
    assert fit_body.side_view(pose) == pytest.approx([0, 1, 0.5**0.5])
    assert fit_body.side_view(np.zeros((1, 14, 3))) == [0]


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
