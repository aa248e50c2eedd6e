"""Keypoints and poses in files: what lift_stdin reads and writes."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from package_support import DATA, LIFT_STDIN, WALK, need_library, need_lift_stdin

import edmlift
from edmlift import files
from edmlift.keypoint_files import read_lines

SAMPLES = [path.stem for path in sorted(DATA.glob("*.csv")) if not path.stem.endswith("_truth")]


def lift_stdin(data: bytes, *options: str) -> bytes:
    need_lift_stdin()
    result = subprocess.run([LIFT_STDIN, *options], input=data, capture_output=True, timeout=60)
    assert result.returncode in (0, 1)
    return result.stdout


def as_json(keypoints: np.ndarray) -> str:
    return "".join(f"{json.dumps({'id': i, 'keypoints': k.tolist()})}\n"
                   for i, k in enumerate(keypoints))  # fmt: skip


# ---- The same as lift_stdin --------------------------------------------------------------------


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("name", SAMPLES)
def test_the_same_bytes_as_lift_stdin(name: str, fixed: bool, tmp_path: Path):
    need_library()
    source, out = DATA / f"{name}.csv", tmp_path / "out.csv"
    poses = edmlift.lift(edmlift.read_keypoints(source), fixed=fixed)
    edmlift.write_poses(out, poses, header=True)
    options = ["--header", *["--fixed"] * fixed]
    assert out.read_bytes() == lift_stdin(source.read_bytes(), *options)


def test_the_same_poses_as_lift_stdin_from_a_detector(tmp_path: Path):
    need_library()
    source = DATA / "detections" / "beam1.csv"
    poses = edmlift.lift(
        edmlift.read_keypoints(source, "blazepose33"),
        format="blazepose33", image=(1080, 1920), threshold=0.5,
    )  # fmt: skip
    edmlift.write_poses(tmp_path / "out.csv", poses)
    options = "--format blazepose33 --image 1080,1920 --threshold 0.5".split()
    assert (tmp_path / "out.csv").read_bytes() == lift_stdin(source.read_bytes(), *options)


def test_json_lines_are_those_of_lift_stdin(tmp_path: Path):
    need_library()
    text = as_json(WALK[:4])
    (tmp_path / "in.jsonl").write_text(text)
    lines = read_lines(text.encode(), None, True)
    answer = list(files.json_lines(edmlift.lift(lines.keypoints), lines.objects))
    theirs = lift_stdin(text.encode(), "--json").decode().splitlines()
    assert [json.loads(line) for line in answer] == [json.loads(line) for line in theirs]
    np.testing.assert_array_equal(
        edmlift.read_keypoints(tmp_path / "in.jsonl"), np.float32(WALK[:4])
    )


# ---- Round trips -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["out.csv", "out.jsonl"])
def test_poses_come_back(name: str, tmp_path: Path):
    need_library()
    keypoints = WALK.copy()
    keypoints[3, :, 2] = 0
    poses = edmlift.lift(keypoints)
    edmlift.write_poses(tmp_path / name, poses)
    back = edmlift.read_poses(tmp_path / name)
    assert list(back.status) == list(poses.status)
    for field in ("joints", "misfit"):
        found, wanted = getattr(back, field), getattr(poses, field)
        np.testing.assert_allclose(found, wanted, rtol=1e-5, atol=1e-6)
        assert found.dtype == np.float32
    edmlift.write_poses(tmp_path / name, back)
    again = edmlift.read_poses(tmp_path / name)
    np.testing.assert_array_equal(again.joints, back.joints)


def test_one_pose_is_one_line(tmp_path: Path):
    need_library()
    edmlift.write_poses(tmp_path / "one.csv", edmlift.lift(WALK[0]))
    assert (tmp_path / "one.csv").read_text().count("\n") == 1


def test_truth():
    truth = edmlift.read_truth(DATA / "walk_truth.csv")
    assert truth.shape == WALK.shape and truth.dtype == np.float32
    np.testing.assert_allclose(truth[:, 8] + truth[:, 11], 0, atol=2e-4)  # mid-hip


# ---- What is read ------------------------------------------------------------------------------


def test_whatever_separates_numbers(tmp_path: Path):
    path = tmp_path / "in.csv"
    numbers = np.arange(1, 29)
    path.write_bytes(
        b"\xef\xbb\xbf# names\r\n\r\n"
        + " \t".join(map(str, numbers)).encode()
        + b"\r\n"
        + ",".join(f"{n}, {n},0.3" for n in range(14)).encode()
    )
    keypoints = edmlift.read_keypoints(path)
    assert keypoints.shape == (2, 14, 3)
    np.testing.assert_array_equal(keypoints[0, :, :2].ravel(), numbers)
    assert (keypoints[0, :, 2] == 1).all() and (keypoints[1, :, 2] == np.float32(0.3)).all()


def test_keypoints_that_json_has_not(tmp_path: Path):
    path = tmp_path / "in.jsonl"
    pose = WALK[0].tolist()
    pose[3], pose[4], pose[5] = None, [None, None], [1, 2]
    path.write_text("\n".join(json.dumps({"keypoints": k}) for k in (pose, None, [])))
    keypoints = edmlift.read_keypoints(path)
    np.testing.assert_array_equal(keypoints[0, 3:6], [[0, 0, 0], [0, 0, 0], [1, 2, 1]])
    assert not keypoints[1:].any()


def test_a_file_of_a_detectors_keypoints(tmp_path: Path):
    need_library()
    path = tmp_path / "in.csv"
    path.write_text(" ".join(map(str, range(34))) + "\n")
    assert edmlift.read_keypoints(path, "coco17").shape == (1, 17, 3)
    with pytest.raises(edmlift.FileError, match="a pose has 28 or 42; a detector's .* format"):
        edmlift.read_keypoints(path)
    with pytest.raises(ValueError, match="there are coco17"):
        edmlift.read_keypoints(path, "coco")


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("1,,2", "3 numbers, but a pose has 28 or 42"),
        ("1,2,", "3 numbers, but a pose has 28 or 42"),
        ("1,2;3", "field 2 is not a number"),
        ("1_0 2", "field 1 is not a number"),
        ("1 2 3", "3 numbers, but a pose has 28 or 42"),
    ],
)
def test_a_bad_line_is_named(line: str, problem: str, tmp_path: Path):
    path = tmp_path / "in.csv"
    good = ",".join(f"{v:g}" for v in WALK[0].ravel())
    path.write_text(f"# names\n{good}\n\n{line}\n{good}\n")
    with pytest.raises(edmlift.FileError) as error:
        edmlift.read_keypoints(path)
    assert str(error.value).startswith(f"{path}:4: ") and problem in str(error.value)
    keypoints = edmlift.read_keypoints(path, bad_lines="nan")
    assert keypoints.shape == (3, 14, 3)
    assert np.isnan(keypoints[1]).all() and np.isfinite(keypoints[[0, 2]]).all()
    with pytest.raises(ValueError, match="'raise' or 'nan'"):
        edmlift.read_keypoints(path, bad_lines="skip")


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("[1]", "1 numbers, but a pose has 28 or 42"),
        ("1", "not a JSON object or array"),
        ("[1, 2", "not a JSON object or array"),
        ('{"keypoints": [], "keypoints": []}', "has keypoints twice"),
        ('{"keypoints": [], "landmarks": []}', 'has "keypoints" and "landmarks"'),
        ('{"keypoints": [[NaN, 1]]}', "not a JSON object"),
        ("{" * 100_000, "not a JSON object"),
        ("{}", 'has no member "keypoints"'),
        ('{"keypoints": 5}', "keypoints is not an array"),
        ('{"keypoints": [[1, 2]]}', "1 keypoints, but a pose has 14"),
        (json.dumps({"keypoints": [[1, 2]] * 13 + [[True, 2]]}), "keypoint 13 is not null"),
        ('{"keypoints": null, "status": 1}', 'a member "status", which the answer adds'),
    ],
)
def test_a_bad_object_is_named(line: str, problem: str, tmp_path: Path):
    path = tmp_path / "in.jsonl"
    path.write_text(line)
    with pytest.raises(edmlift.FileError) as error:
        edmlift.read_keypoints(path)
    assert str(error.value).startswith(f"{path}:1: ") and problem in str(error.value)


def test_what_are_no_poses(tmp_path: Path):
    for path, problem in (
        (DATA / "walk.csv", r"walk\.csv:5: not a pose as lift_stdin writes it"),
        (DATA / "walk_truth.csv", r"walk_truth\.csv:5: not a pose"),
    ):
        with pytest.raises(edmlift.FileError, match=problem):
            edmlift.read_poses(path)
    with pytest.raises(edmlift.FileError, match=r"28 numbers, but a 3D pose has 42"):
        edmlift.read_truth(_write(tmp_path / "in.csv", " ".join(["1"] * 28)))
    for text, problem in (
        ("{}", 'no member "status"'),
        ('{"status": "ok"}', "missing or malformed"),
    ):
        with pytest.raises(edmlift.FileError, match=problem):
            edmlift.read_poses(_write(tmp_path / "in.jsonl", text))


def _write(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_a_file_that_is_not_there(tmp_path: Path):
    with pytest.raises(FileNotFoundError):
        edmlift.read_keypoints(tmp_path / "none.csv")


def test_an_empty_file_holds_no_poses(tmp_path: Path):
    path = _write(tmp_path / "in.csv", "# nothing\n")
    assert edmlift.read_keypoints(path).shape == (0, 14, 3)
    assert edmlift.read_poses(path).joints.shape == (0, 14, 3)
    assert edmlift.read_truth(path).shape == (0, 14, 3)


def test_a_header_is_not_for_json(tmp_path: Path):
    need_library()
    with pytest.raises(ValueError, match="not for JSON"):
        edmlift.write_poses(tmp_path / "x.jsonl", edmlift.lift(WALK), header=True)


# ---- What Python takes and lift_stdin does not, and the reverse ---------------------------------


def test_an_integer_beyond_all_floats_is_not_finite():
    joints = WALK[0].tolist()
    for digits in ("9" * 400, "-" + "9" * 400):
        line = json.dumps({"keypoints": joints}).replace(json.dumps(joints[0][0]), digits, 1)
        lines = read_lines(line.encode(), None, True)
        assert not lines.problems and edmlift.lift(lines.keypoints).status[0] == "not_finite"


def test_half_a_surrogate_pair_comes_out_as_it_went_in():
    line = json.dumps({"name": "\ud800 \N{SNOWMAN}", "keypoints": WALK[0].tolist()})
    lines = read_lines(line.encode(), None, True)
    (written,) = files.json_lines(edmlift.lift(lines.keypoints), lines.objects)
    answer = json.loads(written.encode("utf-8"))
    assert answer["name"] == "\ud800 \N{SNOWMAN}" and answer["status"] == "ok"


def test_digits_of_other_scripts_are_no_numbers():
    lines = read_lines("1\n\u0663,1,1".encode(), None, False)
    assert lines.problems[1] == ("field 1 is not a number (commas or blanks separate them)")
