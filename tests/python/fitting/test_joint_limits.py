"""Joint limits: header, library and page are what is learned, counted and measured."""

import re
from pathlib import Path

import numpy as np
import pytest
from support import OTHERS_TEST, ROOT, TEST, TRAIN, need_motion, run_tool

from data.mocap import Motion, load_motion, save_motion
from edmlift.joints import JOINTS, MIRROR, mid_hip
from edmlift.library import Library
from evaluation import mirror
from fitting import joint_limits
from model import reference
from model.constants import JOINT_LIMITS_FORMAT
from reports import markdown

PAGE = ROOT / "docs" / "accuracy-log.md"
CLIPS = ("walk", "kick", "cartwheel", "tpose")


@pytest.fixture(scope="module")
def fixed(library: Library) -> Library:
    return Library("fconn_w16", fixed=True)


@pytest.fixture(scope="module")
def maps() -> dict[str, np.ndarray]:
    return joint_limits.read_header(joint_limits.OUT)


@pytest.fixture(scope="module")
def clips() -> np.ndarray:
    """True poses [F,14,3] of the sample data: not of the motion that was learned from."""
    folder = ROOT / "examples" / "data"
    rows = [np.loadtxt(folder / f"{c}_truth.csv", delimiter=",", ndmin=2) for c in CLIPS]
    return np.concatenate(rows).reshape(-1, 14, 3)


def someone(count: int, joints: np.ndarray) -> Motion:
    """Motion of one person, the poses given over and over."""
    number = np.arange(count)
    return Motion(
        np.resize(joints, (count, 14, 3)).astype(np.float32), np.ones(count, int), number, number,
        np.zeros(count, int), ("walk",), "made up",
    )  # fmt: skip


# ---- What is learned -------------------------------------------------------------------------


@pytest.mark.claims("gen/joint_limits.h", "edml__joint_limit_maps")
@pytest.mark.slow
def test_the_header_is_learned_from_the_training_people_byte_for_byte(tmp_path: Path):
    out = tmp_path / "joint_limits.h"
    done = run_tool("fitting.joint_limits", need_motion(TRAIN), "--out", out)
    assert done.returncode == 0, done.stderr
    assert out.read_bytes() == joint_limits.OUT.read_bytes()


def test_the_table_is_small_and_of_this_format():
    text = joint_limits.OUT.read_text()
    assert f"#if EDML_JOINT_LIMITS_FORMAT != {JOINT_LIMITS_FORMAT}\n#error" in text
    size = int(re.search(r"size +(\d+) bytes", text)[1])
    assert size == 2 * len(re.findall(r"0x\w{4}\b", text)) <= 8192


def test_a_header_is_read_as_it_was_written(clips: np.ndarray, tmp_path: Path):
    learned = joint_limits.learn(clips)
    path = tmp_path / "header.h"
    path.write_text(joint_limits.header(learned, someone(len(clips), clips)))
    read = joint_limits.read_header(path)
    assert list(read) == list(learned)
    assert all((read[kind] == learned[kind]).all() for kind in read)
    path.write_text("{0x1234, 0x5678}")
    with pytest.raises(ValueError, match="2 rows, must be 2096"):
        joint_limits.read_header(path)


def test_what_was_learned_is_human_and_so_is_what_is_near(clips: np.ndarray):
    learned = joint_limits.learn(clips)
    assert (reference.violations(clips, learned) == 0).all()
    mirrored = clips[:, MIRROR] * [-1, 1, 1]
    assert (reference.violations(mirrored, learned) == 0).all()
    shin = clips[:, 10] - clips[:, 9]
    aside = np.cross(shin, [0.0, 0.0, 1.0])
    aside *= np.linalg.norm(shin, axis=1)[:, None] / np.linalg.norm(aside, axis=1)[:, None]
    for degrees, most in ((2, 0.02), (60, 1.0)):
        bent, angle = clips.copy(), np.deg2rad(degrees)
        bent[:, 10] = clips[:, 9] + np.cos(angle) * shin + np.sin(angle) * aside
        beyond = (reference.violations(bent, learned) > 0).mean()
        assert beyond <= most and (degrees < 60 or beyond > 0.5)


def test_directions_around_are_five_degrees_off():
    direction = reference.unit(np.random.default_rng(1).normal(size=(50, 3)))
    near = joint_limits.around(direction)
    assert near.shape == (50, 9, 3)
    np.testing.assert_allclose(np.linalg.norm(near, axis=-1), 1)
    cosine = (near * direction[:, None]).sum(-1)
    np.testing.assert_allclose(np.degrees(np.arccos(cosine[:, 1:])), 5)


def test_a_rare_parent_takes_the_maps_of_all():
    rng = np.random.default_rng(2)
    often, rarely = reference.unit(np.array([[1.0, 2, 3], [-1.0, -2, -3]]))
    parent = np.concatenate([np.tile(often, (60, 1)), np.tile(rarely, (40, 1))])
    bone = reference.unit(rng.normal(size=(100, 3)))
    learned = joint_limits.learn_maps(bone, parent)
    of_often = learned[reference.octahedral(often, 8)]
    of_rarely = learned[reference.octahedral(rarely, 8)]
    assert of_often.sum() < of_rarely.sum()
    assert (of_rarely == learned.any((0, 1))).all()


# ---- The map ---------------------------------------------------------------------------------


def test_no_cell_of_the_octahedral_map_is_five_times_as_large_as_another():
    rng = np.random.default_rng(3)
    row, column = reference.octahedral(reference.unit(rng.normal(size=(200_000, 3))))
    count = np.zeros((16, 16))
    np.add.at(count, (row, column), 1)
    assert count.max() < 5 * count.min()


def test_a_straight_limb_is_in_one_place_wherever_it_points():
    parent = reference.unit(np.random.default_rng(4).normal(size=(100, 3)))
    np.testing.assert_allclose(
        reference.unbent(parent, parent), np.tile(reference.STRAIGHT, (100, 1)), atol=1e-12
    )


# ---- The library -----------------------------------------------------------------------------


def test_true_motion_is_human_and_its_mirror_image_is_not(library: Library, clips: np.ndarray):
    beyond = library.joint_limits(clips)
    assert (beyond[:86] == 0).all()  # walk and kick; the cartwheel's shins now and then
    assert (beyond == 0).mean() > 0.95 and beyond.max() == 1
    assert (library.joint_limits(clips * [1, 1, -1]) == 0).mean() <= 0.01
    for handed in ([1, 1, 1], [1, 1, -1]):
        chosen, fewer = library.reflect_by_joint_limits(clips * handed)
        right = np.abs(chosen - clips).max((1, 2)) < 1e-6
        assert right[fewer > 0].all() and (fewer > 0).mean() > 0.95


def test_the_library_counts_as_numpy_does(
    library: Library, fixed: Library, clips: np.ndarray, maps
):
    rng = np.random.default_rng(5)
    for noise in (0.0, 0.03, 0.3):
        poses = np.tile(clips, (4, 1, 1))
        poses = (poses + rng.normal(0, noise, poses.shape)).astype(np.float32)
        expected = reference.violations(poses.astype(float), maps)
        assert (library.joint_limits(poses) != expected).sum() <= 1  # at the border of a cell
        assert (fixed.joint_limits(poses) != expected).sum() <= 3
        mirrored = reference.violations(poses * [1.0, 1, -1], maps)
        for one, most in ((library, 1), (fixed, 3)):
            chosen, fewer = one.reflect_by_joint_limits(poses)
            reflected = np.abs(chosen - poses).max((1, 2)) > 1e-3
            assert (fewer != np.abs(expected - mirrored)).sum() <= most
            assert (reflected != (mirrored < expected)).sum() <= most


# ---- The figures -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def tables(library: Library) -> dict[str, str]:
    motions = {Path(name).stem: load_motion(need_motion(name)) for name in (TEST, OTHERS_TEST)}
    found = {}
    for model in mirror.MODELS:
        found |= mirror.evaluate(Library(f"{model}_f32"), model, motions)
    return found


@pytest.mark.claims("docs/accuracy-log.md", "mirror_distances", "mirror_direct", "mirror_fconn")
@pytest.mark.claims("docs/accuracy-log.md", "mirror_actions_distances")
@pytest.mark.claims("docs/accuracy-log.md", "violations_distances", "violations_fconn")
@pytest.mark.slow
def test_tables_are_those_of_the_page(tables: dict[str, str]):
    assert len(tables) == 3 * len(mirror.MODELS)
    shown = [name for name in tables if f"<!-- begin {name} -->" in PAGE.read_text("utf-8")]
    assert {"mirror_distances", "mirror_fconn", "violations_distances"} <= set(shown)
    for name in shown:
        assert markdown.read(PAGE, name).strip() == tables[name].strip()


def set_of(text: str, number: int) -> str:
    """The table of one of the sets of people."""
    return text.split("**\n\n")[number + 1]


def row_of(table: str, title: str) -> list[float]:
    (line,) = [row for row in table.splitlines() if row.startswith(f"| {title} |")]
    return [float(cell) for cell in line.split("|")[2:-1]]


@pytest.mark.slow
def test_the_score_and_the_limits_are_right_of_true_poses(tables: dict[str, str]):
    table, violations = (set_of(tables[f"{name}_fconn"], 0) for name in ("mirror", "violations"))
    score, limits, chance, best = (
        np.array(row_of(table, mirror.RULES[n].format("linear score"))) for n in (2, 3, 0, 4)
    )
    assert (chance[::2] == 50).all() and (best[::2] == 100).all()
    assert limits[0] >= 99 and score[0] >= 99  # true poses
    (line,) = [row for row in violations.splitlines() if row.startswith("| true poses |")]
    none, one, more = (int(cell) for cell in line.split("|")[2:8:2])
    assert none >= 0.99 * (none + one + more)
    assert (limits[1::2] < chance[1::2]).all() and (limits[1::2] >= best[1::2]).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "number", "least"),
    [("distances", 0, 99.5), ("direct", 0, 99.5), ("distances", 1, 96.0), ("direct", 1, 98.0)],
)
def test_the_lift_chooses_the_right_mirror_image(
    tables: dict[str, str], model: str, number: int, least: float
):
    """Of exact 2D: of CMU's people, and of those of other laboratories."""
    table = set_of(tables[f"mirror_{model}"], number)
    assert row_of(table, mirror.OWN[model])[0] >= least


def test_rules_weigh_people_alike():
    """Two poses of one person, one of another; the score is right, wrong, right."""
    c = mirror.Choices(
        error=np.array([10.0, 40, 20]), mirrored=np.array([30.0, 20, 60]),
        by_limits=np.array([10.0, 20, 20]), fewer=np.array([1, 2, 0]), violations=np.zeros(3, int),
        subject=np.array([1, 1, 2]), action=np.zeros(3, int),
    )  # fmt: skip
    found = mirror.rules(c)
    assert found[mirror.CHOSEN] == (75.0, 22.5)
    assert found[mirror.LIMITS] == (100.0, 17.5)
    assert found["joint limits, else by chance"] == (75.0, (15 + 40) / 2)
    assert found["by chance"] == (50.0, (25 + 40) / 2)
    assert found["better mirror image"] == (100.0, 17.5)


# ---- Command lines ---------------------------------------------------------------------------


def test_quick_tables_reach_the_page(library: Library, clips: np.ndarray, tmp_path: Path):
    standing = (clips - mid_hip(clips)[:, None]) * [1, -1, -1] + [0, 1, 0]
    save_motion(someone(60, standing), tmp_path / "motion.npz", 15)
    page = tmp_path / "page.md"
    page.write_text("<!-- begin mirror_fconn -->\n<!-- end mirror_fconn -->\n")
    done = run_tool("evaluate.py", "mirror", tmp_path / "motion.npz", "--quick", "--update", page)
    assert done.returncode == 0, done.stderr
    assert "| linear score |" in markdown.read(page, "mirror_fconn")
    assert "| the network |" in done.stdout
    assert "| unknown | 3 | 1 |" in done.stdout


@pytest.mark.parametrize("tool", ["joint_limits", "evaluate mirror"])
def test_errors_name_the_file_and_what_is_wrong(tool: str, clips: np.ndarray, tmp_path: Path):
    motion, out = tmp_path / "motion.npz", tmp_path / "out.h"
    words = ["evaluate.py", "mirror", motion]
    if tool == "joint_limits":
        words = ["fitting.joint_limits", motion, "--out", out]
    done = run_tool(*words)
    assert done.returncode == 1 and f"{tool}: {motion}: no such file" in done.stderr
    bad = someone(5, clips)
    bad.joints[3, 4] = np.nan
    save_motion(bad, motion, 15)
    done = run_tool(*words)
    assert done.returncode == 1 and f"frame 3, {JOINTS[4]} is not finite" in done.stderr
    save_motion(someone(5, 100 * clips), motion, 15)
    done = run_tool(*words)
    assert done.returncode == 1 and "the units look wrong" in done.stderr
    assert not out.exists() and "Traceback" not in done.stderr


def test_a_page_without_marks_is_an_error(library: Library, clips: np.ndarray, tmp_path: Path):
    save_motion(someone(20, clips), tmp_path / "motion.npz", 15)
    page = tmp_path / "page.md"
    page.write_text("nothing\n")
    done = run_tool("evaluate.py", "mirror", tmp_path / "motion.npz", "--quick", "--update", page)
    assert done.returncode == 1 and f"{page}: no <!-- begin NAME -->" in done.stderr
