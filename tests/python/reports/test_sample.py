"""Whatever measures motion does so of the sample motion: the tables are those of tests/sample."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from builds import long_but
from support import ROOT, need_library

sys.path.insert(0, str(ROOT / "tests" / "sample"))

import make_tables  # noqa: E402
import motion  # noqa: E402

from data.mocap import load_motion  # noqa: E402
from edmlift.joints import mid_hip  # noqa: E402
from reports import markdown  # noqa: E402

NUMBER = re.compile(r"[+-]?\d+(?:\.(\d+))?")
TIMES = "time, ms"  # the last column of a table whose figures depend on the machine


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the sample motion."""
    need_library()
    folder = tmp_path_factory.mktemp("people")
    motion.write(folder)
    return folder


def plain(text: str) -> str:
    """A text without commas between thousands, and without times."""
    text = re.sub(r"(?<=\d),(?=\d{3})", "", text)
    return re.sub(r"[^|]+\|$", "|", text, flags=re.M) if TIMES in text else text


def same(found: str, kept: str) -> None:
    """The same words; numbers are as far apart as rounding goes, a unit of the last digit.

    The lifts have the same bits everywhere.  What NumPy makes of them and the keypoints that it
    draws differ by some 1e-16 of their size, so that a figure may be rounded to the other side.
    """
    found, kept = plain(found), plain(kept)
    assert NUMBER.sub("#", found) == NUMBER.sub("#", kept)
    for ours, theirs in zip(NUMBER.finditer(found), NUMBER.finditer(kept), strict=True):
        unit = 10.0 ** -len(theirs[1] or "")
        assert abs(float(ours[0]) - float(theirs[0])) <= 1.001 * unit, (ours[0], theirs[0])


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    long_but(
        [words for words in make_tables.commands() if "reports.operations" not in words],
        make_tables.commands(),
    ),
    ids=lambda words: words[1],
)
def test_the_tables_are_those_of_the_sample(words: list[str], people: Path, tmp_path: Path):
    if problem := make_tables.lacks(words):
        pytest.skip(problem)
    found = make_tables.tables(words, people, tmp_path)
    assert found, "no table is written"
    for name, text in found.items():
        same(text, markdown.read(make_tables.PAGE, name))
    if "--plots" in words:
        plots = tmp_path / words[words.index("--plots") + 1]
        assert len(list(plots.glob("*.png"))) > 2


def test_another_figure_is_found():
    kept = "| a | 1,234 | +0.1 | 50.0 |\n"
    same("| a | 1,235 | 0.0 | 50.1 |\n".replace(" 0.0", " +0.0"), kept)
    for other in ("| a | 1,236 | +0.1 | 50.0 |\n", "| a | 1,234 | +0.1 | 50.2 |\n", "| b |\n"):
        with pytest.raises(AssertionError):
            same(other, kept)
    timed = f"| a | {TIMES} |\n| b | 1.0 | {{}} |\n"
    same(timed.format(5), timed.format("0.1"))


def test_a_program_that_fails_is_found(people: Path, tmp_path: Path):
    words = ["tools/evaluate.py", "camera", "none.npz", "--update", "docs/where-in-the-room.md"]
    with pytest.raises(ValueError, match=r"evaluate camera: none.npz: no such file"):
        make_tables.tables(words, people, tmp_path)


def test_the_people_are_real_enough(people: Path):
    """They stand on the floor, are as tall as their models, and differ from set to set."""
    sums = set()
    for name in motion.SETS:
        found = load_motion(people / f"{name}.npz")
        assert len(np.unique(found.subject)) == 2 and len(found.joints) == 2 * motion.FRAMES
        lowest, highest = found.joints[..., 1].min(), found.joints[..., 1].max()
        assert 0.02 < lowest < 0.12 and 1.4 < highest < 1.9
        sums.add(found.sha256)
    assert len(sums) == len(motion.SETS)
    walk = motion.in_the_world("walk")
    speed = np.linalg.norm(np.diff(mid_hip(walk), axis=0), axis=1) * 30
    assert 0.6 < speed.mean() < 1.6 and walk[..., 1].min() > 0
