"""The programs of docs/corpora.md, as they are: a few thousand rows by each, the same bits."""

import re
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow.dataset
import pytest
from builds import long_but
from support import ROOT, need_library

import edmlift
from edmlift.arrow import BAD_ROW
from reports import corpora, markdown
from reports.corpora import WAYS

ROWS = 3000  # of a file; more than one batch of no program
# Programs by what they need: no more than the tests do, or Java and 900 MB of packages.
NEED = {"little": ("command", "pyarrow"), "much": ("dask", "spark")}
PROGRESS = {"pyarrow": "3.00k/3.00k", "dask": "100% Completed", "spark": "[Stage"}
PAGE = (ROOT / "docs" / "corpora.md").read_text("utf-8")

pytestmark = pytest.mark.slow


class Made(NamedTuple):
    """A corpus, and what some of the programs made of it."""

    ways: tuple[str, ...]
    folder: Path

    def poses(self, way: str) -> pyarrow.Table:
        return corpora.read(self.folder / WAYS[way].name)


@pytest.fixture(scope="module", params=long_but(["little"], NEED))
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Made:
    need_library()
    folder = tmp_path_factory.mktemp("corpora")
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "little":
            patch.setattr(corpora, "PYTHON", Path(sys.executable))
        elif lacking := corpora.lacks():
            pytest.skip(lacking)
        # What pays off in a short run.
        patch.setenv("JAVA_TOOL_OPTIONS", "-XX:TieredStopAtLevel=1 -XX:+UseSerialGC")
        costs = corpora.measure(ROWS, folder, list(NEED[request.param]))
    assert all(cost.seconds > 0 and cost.memory > 50e6 for cost in costs.values())
    return Made(NEED[request.param], folder)


@pytest.fixture(scope="module")
def keypoints(made: Made) -> list:
    table = pyarrow.dataset.dataset(made.folder / "corpus").to_table()
    assert table["id"].to_pylist() == list(range(ROWS))
    return table["keypoints"].to_pylist()


def test_programs_write_the_bits_of_lift(made: Made, keypoints: list):
    whole = np.array([row is not None and len(row) == 17 for row in keypoints])
    people = np.array([row for row, there in zip(keypoints, whole, strict=True) if there])
    wanted = edmlift.lift(people, "direct_f32", format="coco17")
    quality = edmlift.quality(wanted)[wanted.ok]
    for way in made.ways:
        found = made.poses(way)
        status = np.array(found["status"].to_pylist())
        np.testing.assert_array_equal(status[whole], wanted.status)
        assert set(status[~whole]) == {BAD_ROW, "nobody"} and (wanted.status == "ok").sum() > 2000
        assert [pose is None for pose in found["pose"].to_pylist()] == list(status != "ok")
        poses = np.array(found["pose"].drop_null().to_pylist(), np.float32).reshape(-1, 14, 3)
        np.testing.assert_array_equal(poses.view(np.int32), wanted.joints[wanted.ok].view(np.int32))
        np.testing.assert_array_equal(found["quality"].drop_null().to_numpy(), quality)


def test_other_bits_have_another_hash(made: Made):
    table = made.poses(made.ways[0])
    quality = table["quality"].to_numpy(zero_copy_only=False).copy()
    quality[np.isfinite(quality)] += np.float32(1e-7)
    changed = table.set_column(2, "quality", pyarrow.array(quality, from_pandas=True))
    assert corpora.bits(table) == corpora.bits(table.slice(0)) != corpora.bits(changed)


def test_programs_show_their_progress(made: Made):
    for way in set(made.ways) & PROGRESS.keys():
        printed = (made.folder / f"{way}.log").read_text("utf-8", errors="replace")
        assert PROGRESS[way] in printed, way


def test_the_page_shows_the_programs():
    programs = sorted(corpora.PROGRAMS.glob("*.py"))
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert {path.read_text("utf-8") for path in programs} == set(blocks)
    arguments = [way.arguments[0] for way in WAYS.values() if way.arguments[0] != "-m"]
    assert sorted(arguments) == [str(path) for path in programs]
    for path in programs:
        assert f"(../examples/corpora/{path.name})" in PAGE


def test_the_table_is_that_of_the_programs():
    rows = re.findall(r"^\| ([^|]+?) \| (\d+) \|", markdown.read(corpora.PAGE, corpora.MARK), re.M)
    assert rows == [(way.title, str(way.lines)) for way in WAYS.values()]
