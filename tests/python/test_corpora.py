"""The programs of docs/corpora.md, as they are: a few thousand rows by each, the same bits."""

import re
from pathlib import Path

import numpy as np
import pyarrow.dataset
import pytest
from builds import need
from support import ROOT, need_library

import edmlift
from edmlift.arrow import BAD_ROW
from reports import corpora, markdown
from reports.corpora import WAYS

ROWS = 3000  # of a file; more than one batch of no program
PAGE = (ROOT / "docs" / "corpora.md").read_text("utf-8")

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The corpus, and the poses of each program."""
    need_library()
    need("java")
    if not corpora.PYTHON.exists():
        pytest.skip(
            "no build/venv-corpora: tools/check makes it, by tools/requirements-corpora.txt"
        )
    folder = tmp_path_factory.mktemp("corpora")
    with pytest.MonkeyPatch.context() as patch:  # what pays off in a short run
        patch.setenv("JAVA_TOOL_OPTIONS", "-XX:TieredStopAtLevel=1 -XX:+UseSerialGC")
        costs = corpora.measure(ROWS, folder, list(WAYS))
    assert all(cost.seconds > 0 and cost.memory > 50e6 for cost in costs.values())
    return folder


@pytest.fixture(scope="module")
def keypoints(folder: Path) -> list:
    table = pyarrow.dataset.dataset(folder / "corpus").to_table()
    assert table["id"].to_pylist() == list(range(ROWS))
    return table["keypoints"].to_pylist()


@pytest.mark.parametrize("way", WAYS)
def test_a_program_writes_the_bits_of_lift(way: str, folder: Path, keypoints: list):
    found = corpora.read(folder / WAYS[way].name)
    whole = np.array([row is not None and len(row) == 17 for row in keypoints])
    people = np.array([row for row, there in zip(keypoints, whole, strict=True) if there])
    wanted = edmlift.lift(people, "direct_f32", format="coco17")
    status = np.array(found["status"].to_pylist())
    np.testing.assert_array_equal(status[whole], wanted.status)
    assert set(status[~whole]) == {BAD_ROW, "nobody"} and (wanted.status == "ok").sum() > 2000
    assert [pose is None for pose in found["pose"].to_pylist()] == list(status != "ok")
    poses = np.array(found["pose"].drop_null().to_pylist(), np.float32).reshape(-1, 14, 3)
    np.testing.assert_array_equal(poses.view(np.int32), wanted.joints[wanted.ok].view(np.int32))
    quality = found["quality"].drop_null().to_numpy()
    np.testing.assert_array_equal(quality, edmlift.quality(wanted)[wanted.ok])


def test_other_bits_have_another_hash(folder: Path):
    table = corpora.read(folder / WAYS["command"].name)
    quality = table["quality"].to_numpy(zero_copy_only=False).copy()
    quality[np.isfinite(quality)] += np.float32(1e-7)
    changed = table.set_column(2, "quality", pyarrow.array(quality, from_pandas=True))
    assert corpora.bits(table) == corpora.bits(table.slice(0)) != corpora.bits(changed)


def test_programs_show_their_progress(folder: Path):
    for way, shown in (("pyarrow", "3.00k/3.00k"), ("dask", "100% Completed"), ("spark", "[Stage")):
        assert shown in (folder / f"{way}.log").read_text("utf-8", errors="replace"), way


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
