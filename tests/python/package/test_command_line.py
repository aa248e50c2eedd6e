"""python -m edmlift: lift, draw, and what it says when it cannot."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from package_support import DATA, LIFT_STDIN, ROOT, WALK, need_library, need_lift_stdin

import edmlift
from edmlift.cli import main

WALK_CSV, TRUTH = DATA / "walk.csv", DATA / "walk_truth.csv"


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def run(*arguments: str | Path) -> int:
    return main([str(argument) for argument in arguments])


def fails(capsys: pytest.CaptureFixture, *arguments: str | Path, status: int = 1) -> str:
    """The one line that it says when it gives up."""
    assert run(*arguments) == status
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1
    assert printed.err.startswith("edmlift: ")
    return printed.err


@pytest.fixture
def lifted(tmp_path: Path) -> Path:
    out = tmp_path / "lifted.csv"
    assert run("lift", WALK_CSV, "--out", out) == 0
    return out


# ---- Lift --------------------------------------------------------------------------------------


@pytest.mark.parametrize("options", [[], ["--header"], ["--fixed"], ["--model", "fconn_w8"]])
def test_lift_prints_what_lift_stdin_does(options: list[str], capfd: pytest.CaptureFixture):
    need_lift_stdin()
    result = subprocess.run(
        [LIFT_STDIN, *options], input=WALK_CSV.read_bytes(), capture_output=True, check=True
    )
    assert run("lift", WALK_CSV, *options) == 0
    assert capfd.readouterr().out == result.stdout.decode()


def test_lift_as_a_program():
    command = [sys.executable, "-m", "edmlift", "lift", "-"]
    result = subprocess.run(
        command, input=WALK_CSV.read_bytes(), capture_output=True, cwd=ROOT / "tools", check=True
    )
    assert result.stdout.count(b"ok,") == len(WALK) and result.stderr == b""


def test_of_a_file_that_is_no_text_a_few_lines_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture
):
    source = tmp_path / "picture.png"
    source.write_bytes(b"\x89PNG\r\n" * 1500)
    assert run("lift", source) == 1
    printed = capsys.readouterr()
    assert printed.out.count("bad_line,") == 1500
    assert printed.err.count("field 1 is not a number") == 20
    assert printed.err.endswith(f"\nedmlift: {source}: 1,480 more cannot be read\n")


def test_a_file_without_keypoints_is_told(tmp_path: Path, capsys: pytest.CaptureFixture):
    source = tmp_path / "empty.csv"
    source.write_text("# nobody\n\n")
    assert run("lift", source) == 0
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == f"edmlift: warning: {source}: holds no keypoints\n"


def test_a_bad_line_is_said_and_shifts_nothing(tmp_path: Path, capsys: pytest.CaptureFixture):
    lines = WALK_CSV.read_text().splitlines()[4:7]
    source = tmp_path / "in.csv"
    source.write_text("\n".join(["# names", lines[0], "text", lines[1]]))
    assert run("lift", source) == 1
    printed = capsys.readouterr()
    assert [line.split(",")[0] for line in printed.out.splitlines()] == ["ok", "bad_line", "ok"]
    assert printed.err == (
        f"edmlift: {source}:3: field 1 is not a number (commas or blanks separate them)\n"
    )


def test_json_lines_keep_their_members(tmp_path: Path, capsys: pytest.CaptureFixture):
    source = tmp_path / "in.jsonl"
    source.write_text(json.dumps({"t": 1.5, "keypoints": WALK[0].tolist(), "name": "ä"}) + "\n{}\n")
    assert run("lift", source) == 1
    first, second = map(json.loads, capsys.readouterr().out.splitlines())
    assert first["t"] == 1.5 and first["name"] == "ä" and first["status"] == "ok"
    assert np.shape(first["joints"]) == (14, 3)
    assert second == {"status": "bad_line", "joints": None, "misfit": None}


def test_json_lines_of_any_name(tmp_path: Path, capsys: pytest.CaptureFixture):
    source = tmp_path / "in.txt"
    source.write_text(json.dumps({"keypoints": WALK[0].tolist()}) + "\n")
    assert run("lift", source, "--json") == 0
    assert json.loads(capsys.readouterr().out)["status"] == "ok"


def test_a_detectors_format(capsys: pytest.CaptureFixture):
    source = DATA / "detections" / "street.csv"
    options = "--format blazepose33 --image 1080,1920 --threshold 0.5".split()
    assert run("lift", source, *options) == 0
    statuses = [line.split(",")[0] for line in capsys.readouterr().out.splitlines()]
    assert statuses[0] == "too_few_joints" and statuses.count("ok") > 0.8 * len(statuses)


CASES = ROOT / "tests" / "python" / "cases"


def test_a_folder_and_a_frame_without_people(tmp_path: Path, capsys: pytest.CaptureFixture):
    for name in ("openpose_0.json", "openpose_1_nobody.json", "openpose_2_two.json"):
        (tmp_path / name).write_bytes((CASES / name).read_bytes())
    (tmp_path / "openpose_3.json").write_text('{"people": [{}]}')
    assert run("lift", tmp_path, "--format", "body25") == 1
    printed = capsys.readouterr()
    answers = [json.loads(line) for line in printed.out.splitlines()]
    assert [one["status"] for one in answers] == ["ok", "nobody", "ok", "ok", "bad_line"]
    assert answers[1] == {"version": 1.3, "status": "nobody", "joints": None, "misfit": None}
    assert printed.err == f'edmlift: {tmp_path}/openpose_3.json:1: has no member "keypoints"\n'


def test_likely_mistakes_are_said_once(capsys: pytest.CaptureFixture):
    options = ["--format", "h36m17_right_first"]
    assert run("lift", CASES / "seventeen_coco.csv", *options) == 0
    printed = capsys.readouterr()
    assert printed.out.count("\nok,") == 19 and printed.err.count("\n") == 1
    assert printed.err.startswith("edmlift: warning: 20 of 20 poses have a quality under 0.2")


def test_several_people_are_not_a_motion_of_one(tmp_path: Path, capsys: pytest.CaptureFixture):
    out = tmp_path / "x.bvh"
    message = fails(capsys, "lift", CASES / "two_people.jsonl", "-o", out, "--fps", "30")
    assert "several people a frame, but a motion file is one person's" in message
    assert not out.exists()


def test_a_mirror_image(capsys: pytest.CaptureFixture):
    for options in ([], ["--image", "1080,1920"]):
        assert run("lift", CASES / "mirrored.csv", "--mirrored", *options) == 0
        mirrored = capsys.readouterr().out
        assert run("lift", CASES / "not_mirrored.csv", *options) == 0
        plain = capsys.readouterr().out
        numbers = [np.array([line.split(",")[1:] for line in text.split()], float)
                   for text in (mirrored, plain)]  # fmt: skip
        np.testing.assert_allclose(*numbers, atol=1e-4)


def test_names(capsys: pytest.CaptureFixture):
    assert run("models") == 0
    assert capsys.readouterr().out.split() == list(edmlift.models())
    assert run("formats") == 0
    assert "coco17 17\n" in capsys.readouterr().out


def test_what_lift_cannot_do(tmp_path: Path, capsys: pytest.CaptureFixture):
    assert "none.csv: No such file" in fails(capsys, "lift", tmp_path / "none.csv")
    assert "a folder without files that end in .jsonl" in fails(capsys, "lift", tmp_path)
    (tmp_path / "in.jsonl").write_text("")
    for message, *options in [
        ("there are coco17", WALK_CSV, "--format", "coco"),
        ("there are distances_f32", WALK_CSV, "--model", "fconn"),
        ("does not lift in fixed point", WALK_CSV, "--fixed", "--model", "direct_f32"),
        ("threshold must be", WALK_CSV, "--threshold", "-1"),
        ("threshold must be", tmp_path / "none.csv", "--threshold", "nan"),
        ("not for JSON", tmp_path / "in.jsonl", "--header"),
        ("up must be", WALK_CSV, "--up", "0,0,0"),
    ]:
        assert message in fails(capsys, "lift", *options, status=2)


def test_the_json_option_overrules_the_name(tmp_path: Path, capsys: pytest.CaptureFixture):
    source = tmp_path / "in.txt"
    source.write_text(json.dumps({"keypoints": WALK[0].tolist()}) + "\n")
    assert run("lift", source, "--json") == 0
    assert json.loads(capsys.readouterr().out)["status"] == "ok"


def test_the_size_of_the_image_is_asked_for_in_plain_words(capsys: pytest.CaptureFixture):
    with pytest.raises(SystemExit):
        run("lift", WALK_CSV, "--image", "3")
    assert "argument --image: must be W,H in pixels, not '3'" in capsys.readouterr().err


def test_output_is_utf_8_whatever_the_terminal_has(tmp_path: Path):
    source = tmp_path / "in.jsonl"
    line = json.dumps({"name": "\N{SNOWMAN}", "keypoints": WALK[0].tolist()}, ensure_ascii=False)
    source.write_text(line, encoding="utf-8")
    result = subprocess.run(
        [sys.executable, "-m", "edmlift", "lift", source],
        capture_output=True, cwd=ROOT / "tools", env=os.environ | {"PYTHONIOENCODING": "ascii"},
    )  # fmt: skip
    assert result.stderr == b"" and "\N{SNOWMAN}".encode() in result.stdout


@pytest.mark.parametrize(("redirection", "name"), [("<&-", "input"), (">&-", "output")])
def test_a_closed_stream_is_said(redirection: str, name: str):
    source = "-" if name == "input" else str(WALK_CSV)
    command = f"{sys.executable} -m edmlift lift {source} {redirection}"
    result = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, cwd=ROOT / "tools"
    )
    assert result.stderr == f"edmlift: the standard {name} is closed\n" and result.returncode == 1


@pytest.mark.parametrize("options", [(), ("fly",), ("lift",), ("lift", "x", "--image", "3")])
def test_wrong_options_have_status_2(options: tuple[str, ...], capsys: pytest.CaptureFixture):
    with pytest.raises(SystemExit) as exit_:
        run(*options)
    assert exit_.value.code == 2
    printed = capsys.readouterr().err
    assert "usage: edmlift" in printed
    assert ("must be W,H in pixels, not '3'" in printed) == ("--image" in options)


@pytest.mark.parametrize("command", [[], ["lift"], ["draw"], ["view"]])
def test_help(command: list[str], capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "80")  # of the terminal
    with pytest.raises(SystemExit) as exit_:
        run(*command, "--help")
    assert exit_.value.code == 0
    printed = capsys.readouterr().out
    assert "usage: edmlift" in printed and max(map(len, printed.splitlines())) <= 100


def test_a_reader_who_has_seen_enough():
    command = f"{sys.executable} -m edmlift lift {WALK_CSV} | head -c 10"
    result = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, cwd=ROOT / "tools"
    )
    assert result.stderr == "" and result.returncode == 0


# ---- Draw --------------------------------------------------------------------------------------


def test_draw_prints_the_errors(tmp_path: Path, lifted: Path, capsys: pytest.CaptureFixture):
    pytest.importorskip("PIL", reason="no Pillow")
    for files in ([lifted], []):
        out = tmp_path / f"walk{len(files)}.png"
        assert run("draw", WALK_CSV, *files, "--out", out, "--truth", TRUTH, "--pitch", "8.5") == 0
        printed = capsys.readouterr()
        assert printed.err == "" and out.stat().st_size > 10_000
        assert printed.out.startswith("39 of 39 poses lifted; mean error ")
        assert printed.out.endswith(" mm after rigid alignment\n")


def test_draw_needs_no_library_for_what_is_lifted(tmp_path: Path, lifted: Path, monkeypatch):
    pytest.importorskip("PIL", reason="no Pillow")
    monkeypatch.setenv("EDMLIFT_LIBRARY", str(tmp_path / "none.so"))
    assert run("draw", WALK_CSV, lifted, "--out", tmp_path / "x.png", "--frame", "3") == 0


def test_draw_the_joints(tmp_path: Path):
    pytest.importorskip("PIL", reason="no Pillow")
    assert run("draw", "--joint-diagram", tmp_path / "joints.png") == 0
    assert (tmp_path / "joints.png").stat().st_size > 5_000


def test_draw_leaves_gaps_for_bad_lines(tmp_path: Path, capsys: pytest.CaptureFixture):
    pytest.importorskip("PIL", reason="no Pillow")
    lines = WALK_CSV.read_text().splitlines()[4:7]
    source = tmp_path / "in.csv"
    source.write_text("\n".join([lines[0], "text", lines[1]]))
    assert run("draw", source, "--out", tmp_path / "x.png") == 0
    (tmp_path / "t.csv").write_text("\n".join(TRUTH.read_text().splitlines()[4:7]))
    assert run("draw", source, "--out", tmp_path / "x.png", "--truth", tmp_path / "t.csv") == 0
    assert capsys.readouterr().out.startswith("2 of 3 poses lifted; ")


@pytest.mark.parametrize("far", ["1e300", "1e30", "-1e8"])
def test_draw_says_which_file_is_out_of_reach(tmp_path: Path, lifted: Path, capsys, far: str):
    pytest.importorskip("PIL", reason="no Pillow")
    out, strange = tmp_path / "x.png", tmp_path / "strange.csv"
    strange.write_text(re.sub(r"(?m)^ok,[^,]*", f"ok,{far}", lifted.read_text()))
    message = fails(capsys, "draw", WALK_CSV, strange, "--out", out, status=2)
    assert "poses: joints at " in message
    true = re.sub(r"(?m)^[-\d][^,]*", far, TRUTH.read_text())
    strange.write_text(true)
    message = fails(capsys, "draw", WALK_CSV, lifted, "--out", out, "--truth", strange, status=2)
    assert "truth: joints at " in message
    assert not out.exists()


def test_what_draw_cannot_do(tmp_path: Path, lifted: Path, capsys: pytest.CaptureFixture):
    pytest.importorskip("PIL", reason="no Pillow")
    out = tmp_path / "x.png"
    kick, kick_truth = DATA / "kick.csv", DATA / "kick_truth.csv"
    message = fails(capsys, "draw", kick, lifted, "--out", out)
    assert "kick.csv has 47, " in message and "lifted.csv has 39" in message
    message = fails(capsys, "draw", WALK_CSV, lifted, "--out", out, "--truth", kick_truth)
    assert "kick_truth.csv has 47" in message
    assert "not a pose as lift_stdin" in fails(capsys, "draw", WALK_CSV, WALK_CSV, "--out", out)
    message = fails(capsys, "draw", lifted, lifted, "--out", out)
    assert "lifted.csv:1: a heading that does not name all keypoints" in message
    bad = tmp_path / "bad.csv"
    bad.write_text("1,2\n3,4\n")
    assert "holds no pose: " in fails(capsys, "draw", bad, lifted, "--out", out)
    assert "--frame 39: " in fails(
        capsys, "draw", WALK_CSV, "--out", out, "--frame", "39", status=2
    )
    assert "--frames 25: " in fails(
        capsys, "draw", WALK_CSV, "--out", out, "--frames", "25", status=2
    )
    gif = tmp_path / "x.gif"
    assert "whole sequence" in fails(
        capsys, "draw", WALK_CSV, "--out", gif, "--frames", "3", status=2
    )
    assert "must end in" in fails(capsys, "draw", WALK_CSV, "--out", tmp_path / "x.jpg", status=2)
    assert "pitch must be" in fails(
        capsys, "draw", WALK_CSV, "--out", out, "--pitch", "91", status=2
    )
    assert "--joint-diagram" in fails(capsys, "draw", WALK_CSV, status=2)
    assert "No such file" in fails(capsys, "draw", WALK_CSV, "--out", tmp_path / "no" / "x.png")
    assert "none.png" in fails(capsys, "draw", WALK_CSV, "--out", out, "--pictures", "none.png")
    assert not out.exists() and not gif.exists()
