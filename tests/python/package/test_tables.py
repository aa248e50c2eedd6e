"""edmlift lift, of tables: files of any size, written whole or not at all."""

import fcntl
import os
import pty
import signal
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

import numpy as np
import pytest
from package_support import DATA, ROOT, WALK, need_library

pa = pytest.importorskip("pyarrow", reason="no pyarrow: pip install pyarrow")
pytest.importorskip("tqdm", reason="no tqdm: pip install tqdm")

import pyarrow.feather  # noqa: E402
import pyarrow.parquet as pq  # noqa: E402

import edmlift  # noqa: E402
import edmlift.arrow  # noqa: E402
import edmlift.arrow_files  # noqa: E402
from edmlift.cli import main  # noqa: E402

COCO = edmlift.read_keypoints(DATA / "detections" / "beam1_thunder.csv", "coco17")
OPTIONS = ("--format", "coco17", "--model", "direct_w16")
LIFTER = edmlift.arrow.Lifter(format="coco17", model="direct_w16")


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def run(*arguments: object) -> int:
    return main([str(argument) for argument in ("lift", *arguments)])


def fails(capsys: pytest.CaptureFixture, *arguments: object, status: int = 1) -> str:
    assert run(*arguments) == status
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1, printed.err
    return printed.err


def people(count: int = 20) -> "pa.Table":
    keypoints = pa.FixedSizeListArray.from_arrays(np.resize(COCO, count * 51), 51)
    return pa.table({"id": range(count), "keypoints": keypoints})


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "corpus.parquet"
    pq.write_table(people(), path)
    return path


@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".feather"])
def test_a_table_becomes_a_table(suffix: str, source: Path, tmp_path: Path, capfd):
    out = tmp_path / f"poses{suffix}"
    assert run(source, "-o", out, *OPTIONS) == 0
    read = pq.read_table if suffix == ".parquet" else pyarrow.feather.read_table
    wanted = LIFTER(people())
    found = read(out)
    assert found.equals(wanted)
    assert (
        found.schema.field("pose").metadata.items() >= wanted.schema.field("pose").metadata.items()
    )
    printed = capfd.readouterr()
    assert printed.out == "" and printed.err == f"edmlift: {out}: 20 rows: 20 ok\n"
    again = tmp_path / "again.parquet"  # any kind is read
    assert run(out, "-o", again, *OPTIONS, "--prefix", "again_") == 0
    assert pq.read_table(again)["again_pose"].equals(wanted["pose"])


def test_a_folder_as_spark_leaves_it(tmp_path: Path, capfd):
    """Parts in folders that are columns, small row groups, and what is not data."""
    corpus, out = tmp_path / "corpus.parquet", tmp_path / "poses.parquet"
    for split, rows in (("test", (0, 9)), ("train", (9, 20))):
        (corpus / f"split={split}").mkdir(parents=True)
        part = people()[rows[0] : rows[1]]
        pq.write_table(part, corpus / f"split={split}" / "part-0.parquet", row_group_size=2)
    (corpus / "_SUCCESS").touch()
    (corpus / "_temporary").mkdir()
    (corpus / "_temporary" / "broken.parquet").write_bytes(b"x")
    assert run(corpus, "-o", out, *OPTIONS) == 0
    found = pq.read_table(out)
    wanted = LIFTER(people())
    assert found.select(wanted.schema.names).equals(wanted)
    assert found["split"].to_pylist() == ["test"] * 9 + ["train"] * 11
    assert pq.read_metadata(out).num_row_groups == 1


def test_row_groups_are_large_whatever_is_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(edmlift.arrow_files, "ROWS", 100)
    source, out = tmp_path / "x.parquet", tmp_path / "y.parquet"
    pq.write_table(people(330), source, row_group_size=30)
    counts = edmlift.arrow_files.lift_files(source, out, LIFTER)
    about = pq.read_metadata(out)
    groups = [about.row_group(i).num_rows for i in range(about.num_row_groups)]
    assert groups == [100, 100, 100, 30]
    assert counts == {"ok": 330}
    assert (
        pq.read_table(out)["pose"]
        .combine_chunks()
        .equals(LIFTER(people(330))["pose"].combine_chunks())
    )


def test_columns_are_named(tmp_path: Path, capfd):
    source, out = tmp_path / "x.parquet", tmp_path / "y.parquet"
    walk = pa.table({"points": WALK.tolist(), "f": [1145.0] * len(WALK), "c": [500] * len(WALK),
                     "g": [[0, -0.99, -0.1]] * len(WALK), "w": [1000] * len(WALK)})  # fmt: skip
    pq.write_table(walk, source)
    columns = ("keypoints=points", "camera=f,1145,c,500", "up=g", "image=w,w")
    assert run(source, "-o", out, *(word for c in columns for word in ("--column", c))) == 0
    wanted = edmlift.lift(
        WALK, up=(0, -0.99, -0.1), image=(1000, 1000), camera=(1145, 1145, 500, 500)
    )
    found = np.array(pq.read_table(out)["pose"].to_pylist(), np.float32).reshape(-1, 14, 3)
    np.testing.assert_array_equal(found, wanted.joints)
    same = ("--camera", "1145,1145,500,500", "--up", "0,-.99,-.1", "--image", "1000,1000")
    assert run(source, "-o", out, "--column", columns[0], *same, "--threads", "1") == 0
    found = np.array(pq.read_table(out)["pose"].to_pylist(), np.float32).reshape(-1, 14, 3)
    np.testing.assert_array_equal(found, wanted.joints)


def test_bad_rows_and_mistakes_are_said_but_are_no_failure(tmp_path: Path, capfd):
    source, out = tmp_path / "x.parquet", tmp_path / "y.parquet"
    keypoints = COCO.tolist()
    keypoints[3], keypoints[4] = keypoints[3][:5], None
    pq.write_table(pa.table({"keypoints": keypoints}), source)
    assert run(source, "-o", out, "--format", "h36m17_right_first") == 0
    err = capfd.readouterr().err.splitlines()
    assert err[0].startswith("edmlift: warning: 18 of 18 poses have a quality under 0.2")
    assert err[1] == (
        "edmlift: warning: 1 of 20 rows are bad_row; the first of them: 5 keypoints, but "
        "h36m17_right_first has 17"
    )
    assert err[2] == f"edmlift: {out}: 20 rows: 18 ok, 1 bad_row, 1 nobody"


def test_an_empty_table(tmp_path: Path, capfd):
    source, out = tmp_path / "x.parquet", tmp_path / "y.parquet"
    pq.write_table(people()[:0], source)
    assert run(source, "-o", out, *OPTIONS) == 0
    assert pq.read_table(out).schema.names[-1] == "status"
    assert capfd.readouterr().err == f"edmlift: {out}: no rows\n"


def test_what_cannot_be_done(source: Path, tmp_path: Path, capsys: pytest.CaptureFixture):
    out = tmp_path / "poses.parquet"
    for message, *arguments in [
        ("the poses of a table go into a table: -o must end in .parquet, .arrow", source),
        ("-o must end in", source, "-o", "x.csv"),
        ("--fps is not for tables", source, "-o", out, "--fps", 30),
        ("--header is not for tables", source, "-o", out, "--header"),
        ("--up and --column up= both", source, "-o", out, "--up", "0,-1,0", "--column", "up=g"),
        ("image must be 2 numbers or names", source, "-o", out, "--column", "image=a,b,c"),
        ("there are coco17", source, "-o", out, "--format", "coco"),
        ("--column is for tables", DATA / "walk.csv", "--column", "up=g"),
        ("--prefix is for tables", DATA / "walk.csv", "--prefix", "x"),
    ]:
        assert message in fails(capsys, *arguments, status=2)
    (tmp_path / "broken.parquet").write_bytes(b"PAR1")
    (tmp_path / "folder.parquet").mkdir()
    (tmp_path / "both").mkdir()
    for suffix in ("arrow", "parquet"):
        (tmp_path / "both" / f"x.{suffix}").touch()
    (tmp_path / "differ").mkdir()
    pq.write_table(people(), tmp_path / "differ" / "0.parquet")
    pq.write_table(pa.table({"id": [1], "keypoints": [1]}), tmp_path / "differ" / "1.parquet")
    pq.write_table(pa.table([[1], [2]], ["a", "a"]), tmp_path / "twice.parquet")
    for message, *arguments in [
        ('there is no column "g"', source, "-o", out, *OPTIONS, "--column", "up=g"),
        ("none.parquet", tmp_path / "none.parquet", "-o", out),
        ("broken.parquet", tmp_path / "broken.parquet", "-o", out),
        ("files of several kinds: .arrow, .parquet", tmp_path / "both", "-o", out),
        ("is a folder, but one file is written", source, "-o", tmp_path / "folder.parquet"),
        ("differ: Unsupported cast", tmp_path / "differ", "-o", out, *OPTIONS),
        ("twice.parquet: Can't unify", tmp_path / "twice.parquet", "-o", out, *OPTIONS),
        ("No such file or directory", source, "-o", tmp_path / "none" / "x.parquet", *OPTIONS),
        ("a folder without files that end in .parquet", tmp_path / "folder.parquet", "-o", out),
    ]:
        assert message in fails(capsys, *arguments)
    assert not out.exists() and not list(tmp_path.glob("*.part"))


def test_a_column_option_is_explained(source: Path, capsys: pytest.CaptureFixture):
    for text in ("up", "upwards=g", "image=w,"):
        with pytest.raises(SystemExit):
            run(source, "-o", "x.parquet", "--column", text)
        message = "must be NAME=COLUMN with NAME of keypoints, scores, up, image, camera"
        assert message in capsys.readouterr().err


# ---- As a program --------------------------------------------------------------------------------


def program(*arguments: object) -> list[str]:
    return [sys.executable, "-m", "edmlift", "lift", *map(str, arguments)]


ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT / "tools")}


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_what_is_stopped_half_way_leaves_nothing_under_the_name(
    number: signal.Signals, tmp_path: Path
):
    """While the first rows are lifted; what was there before stays."""
    source, out = tmp_path / "x.parquet", tmp_path / "y.parquet"
    pq.write_table(people(100_000), source)
    out.write_bytes(b"before")
    command = program(source, "-o", out, "--format", "coco17", "--threads", 1)
    with subprocess.Popen(command, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True) as running:
        part = tmp_path / "y.parquet.part"
        while not part.exists():
            assert running.poll() is None, running.stderr.read()
            time.sleep(0.01)
        running.send_signal(number)
        said = running.stderr.read()
    assert out.read_bytes() == b"before"
    if number == signal.SIGINT:
        assert said == "edmlift: interrupted\n" and running.returncode == 130
        assert not part.exists()


def test_progress_is_shown_on_a_terminal(source: Path, tmp_path: Path):
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("4H", 24, 80, 0, 0))
    done = subprocess.run(
        program(source, "-o", tmp_path / "y.parquet", *OPTIONS), env=ENVIRONMENT, stderr=theirs
    )
    os.close(theirs)
    shown = os.read(ours, 100_000).decode()
    os.close(ours)
    assert done.returncode == 0 and "100%" in shown and "20.0/20.0" in shown and "poses/s" in shown
