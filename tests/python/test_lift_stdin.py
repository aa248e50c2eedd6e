"""Every promise of examples/lift_stdin: a line of input to a line of output, whatever the line.

test_lift_stdin_detectors.py has what detectors write.
"""

import json
import os
import random
import re
import select
import subprocess
from pathlib import Path

import numpy as np
import pytest
from stdin_support import PROGRAM, WALK, as_json, objects, run, text
from support import need_library

import edmlift as package
from edmlift import library as edmlift
from edmlift.joints import MIRROR
from edmlift.tracking import track

ROOT = Path(__file__).resolve().parents[2]
HEADER = (ROOT / "include" / "edmlift.h").read_text()
STATUSES = set(re.findall(r'X\(EDML_\w+, +-?\d+, "(\w+)"\)', HEADER)) | {"bad_line", "nobody"}
VERSION = re.search(r'EDML_VERSION_STRING "(.+)"', HEADER).group(1)
COLUMNS = 44
LINE_MAX = 4096
RIGHT_ARM, LEGS = [3, 4], [8, 9, 10, 11, 12, 13]


def unseen(joints: list[int], pose: np.ndarray = WALK[0]) -> np.ndarray:
    pose = pose.copy()
    pose[joints, 2] = 0
    return pose


GOOD = text(WALK[0])
OTHER = text(WALK[20])
FREE = ("--hold-bones", "0")  # of a video: as edml_track_lift() has its poses


def rows(result: subprocess.CompletedProcess) -> list[list[str]]:
    """Fields of the output lines; each line is whole."""
    output = result.stdout.decode("ascii")
    assert output == "" or output.endswith("\n")
    table = [line.split(",") for line in output.split("\n")[:-1]]
    assert all(len(row) == COLUMNS for row in table)
    return table


def lift(data: str | bytes, *options: str) -> list[list[str]]:
    """Output of input without a bad line."""
    result = run(data, *options)
    assert result.returncode == 0
    return rows(result)


def statuses(table: list[list[str]]) -> list[str]:
    return [row[0] for row in table]


def numbers(row: list[str]) -> np.ndarray:
    return np.array([float(field) for field in row[1:]])


ANSWER, OTHER_ANSWER = lift(f"{GOOD}\n{OTHER}\n")


# ---- Formats that are read -------------------------------------------------------------------


@pytest.mark.parametrize("separator", [",", " ", "\t", "   ", ", ", " , ", "\t,\t"])
@pytest.mark.parametrize("columns", [2, 3])
def test_28_and_42_numbers_with_any_separator(separator: str, columns: int):
    assert lift(text(WALK[0, :, :columns], separator) + "\n") == [ANSWER]


def test_mixed_separators_and_blanks_around():
    fields = GOOD.split(",")
    mixed = "".join(a + b for a, b in zip(fields, [",", " ", "\t", " ,", ", "] * 9, strict=False))
    assert lift(f" \t{mixed.rstrip(' ,')} \t\n") == [ANSWER]


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(f"# names\n\n{GOOD}\n \t\n  # more, 1, 2\n{OTHER}\n\n", id="comments"),
        pytest.param(f"{GOOD}\r\n\r\n# x\r\n{OTHER}\r\n", id="crlf"),
        pytest.param(f"{GOOD}\n{OTHER}", id="no final newline"),
        pytest.param(f"\ufeff{GOOD}\n{OTHER}\n", id="byte order mark"),
        pytest.param(f"\ufeff# names\r\n{GOOD}\r\n{OTHER}", id="byte order mark and comment"),
        pytest.param(f"#\0\n{GOOD}\n{OTHER}\n", id="zero byte in a comment"),
    ],
)
def test_what_is_between_the_poses_does_not_matter(data: str):
    assert lift(data) == [ANSWER, OTHER_ANSWER]


@pytest.mark.parametrize("data", ["", "\n", "# only a comment", "\ufeff", "\r\n\r\n"])
def test_no_poses_no_output(data: str):
    result = run(data)
    assert (result.returncode, result.stdout, result.stderr) == (0, b"", b"")


def test_byte_order_mark_counts_only_at_the_start():
    result = run(f"{GOOD}\n\ufeff{OTHER}\n")
    assert statuses(rows(result)) == ["ok", "bad_line"]


# ---- Poses that are refused ------------------------------------------------------------------


def with_number(value: str, place: int) -> str:
    fields = GOOD.split(",")
    fields[place] = value
    return ",".join(fields)


@pytest.mark.parametrize("value", ["inf", "Infinity", "1e999"])
@pytest.mark.parametrize("place", [0, 40, 41])  # x of the first joint, y and c of the last
def test_not_finite(value: str, place: int):
    assert lift(with_number(value, place)) == [["not_finite"] + [""] * 43]


@pytest.mark.parametrize("value", ["nan", "NaN", "-nan", "null", "", " "])
@pytest.mark.parametrize("place", [0, 40, 41])  # x of the first joint, y and c of the last
def test_what_is_no_number_was_not_seen(value: str, place: int):
    assert lift(with_number(value, place)) == lift(text(unseen([place // 3])))


def test_a_confidence_of_minus_infinity_was_not_seen():
    assert lift(with_number("-inf", 41)) == lift(text(unseen([13])))


@pytest.mark.parametrize("mark", [0, -1])
@pytest.mark.parametrize("columns", [2, 3])
def test_a_keypoint_in_the_corner_was_not_seen(mark: float, columns: int):
    """However sure of it the detector is; but one coordinate alone is a place."""
    pose = WALK[0].copy()
    pose[4, :2] = mark
    expected = lift(text(unseen([4])))
    assert lift(text(pose[:, :columns])) == expected
    for place in ([mark, mark - 1], [mark + 0.001, mark]):
        pose[4, :2] = place
        assert lift(text(pose[:, :columns])) != expected


def test_not_finite_is_ignored_in_a_joint_that_was_not_seen():
    pose = unseen([4])
    pose[4, :2] = np.nan
    assert lift(text(pose)) == lift(text(unseen([4])))


def test_equal_points_are_degenerate():
    assert lift(",".join(["512"] * 28)) == [["degenerate"] + [""] * 43]


@pytest.mark.parametrize("count", [28, 42])
def test_all_zeros_were_not_seen(count: int):
    assert statuses(lift(",".join(["0"] * count))) == ["too_few_joints"]


def test_missing_arm_is_lifted_and_its_place_does_not_matter():
    here, there = unseen(RIGHT_ARM), unseen(RIGHT_ARM)
    there[RIGHT_ARM, :2] = 1e6
    table = lift(f"{text(here)}\n{text(there)}\n")
    assert statuses(table) == ["ok", "ok"]
    assert table[0] == table[1]
    assert np.isfinite(numbers(table[0])).all()


def test_too_few_joints():
    assert lift(text(unseen(LEGS + RIGHT_ARM))) == [["too_few_joints"] + [""] * 43]


def test_refused_poses_are_counted():
    far = with_number("inf", 0)
    result = run(f"{far}\n{GOOD}\n{text(unseen(LEGS + RIGHT_ARM))}\n{far}\n")
    assert statuses(rows(result)) == ["not_finite", "ok", "too_few_joints", "not_finite"]
    message = "lift_stdin: refused poses: 3, the first in line 1: not_finite\n"
    assert result.stderr.decode() == message
    assert result.returncode == 0


# ---- Bad lines -------------------------------------------------------------------------------

FIELDS = GOOD.split(",")
BAD = {
    "27": ",".join(FIELDS[:27]),
    "29": ",".join(FIELDS[:29]),
    "41": ",".join(FIELDS[:41]),
    "43": ",".join([*FIELDS, "1"]),
    "one": "1",
    "text": "head,neck_base",
    "text last": ",".join([*FIELDS[:41], "one"]),
    "text glued": with_number("1x", 5),
    "semicolons": ";".join(FIELDS),
    "trailing comma": GOOD + ",",
    "trailing comma, blank": GOOD + ", ",
    "trailing comma, cr": GOOD + ",\r",
    "leading comma": "," + GOOD,
    "comma": ",",
    "zero byte": GOOD.replace(",", "\0", 1),
    "zero byte first": "\0" + GOOD,
    "zero byte last": GOOD + "\0",
    "zero byte alone": "\0",
    "comment behind": GOOD + " # walk",
    "4097 bytes": GOOD.ljust(LINE_MAX + 1),
    "4097 bytes with cr": GOOD.ljust(LINE_MAX) + "\r",
    "a megabyte": "1," * 500_000,
    "a megabyte of blanks behind": GOOD.ljust(1 << 20),
}


@pytest.mark.parametrize("bad", BAD.values(), ids=BAD.keys())
def test_bad_line_is_named_and_shifts_nothing(bad: str):
    result = run(f"# names\n{GOOD}\n\n{bad}\n{OTHER}\n")
    assert rows(result) == [ANSWER, ["bad_line"] + [""] * 43, OTHER_ANSWER]
    assert result.returncode == 1
    message, count = result.stderr.decode().splitlines()
    assert message.startswith("lift_stdin: line 4: ")
    assert count == "lift_stdin: bad lines: 1"


@pytest.mark.parametrize("bad", BAD.values(), ids=BAD.keys())
def test_bad_last_line_without_newline(bad: str):
    result = run(f"{GOOD}\n{bad}")
    assert statuses(rows(result)) == ["ok", "bad_line"]
    assert result.returncode == 1


def test_line_of_4096_bytes_is_read():
    assert lift(f"{GOOD.ljust(LINE_MAX)}\n{OTHER}\n") == [ANSWER, OTHER_ANSWER]
    assert lift(f"{GOOD.rjust(LINE_MAX)}") == [ANSWER]


def test_long_line_is_not_split_into_poses():
    result = run(" ".join([GOOD] * 40) + "\n" + OTHER)
    assert statuses(rows(result)) == ["bad_line", "ok"]


@pytest.mark.parametrize("skipped", ["# " + "names " * 1000, " " * 5000], ids=["comment", "blanks"])
def test_long_lines_are_skipped_like_short_ones(skipped: str):
    assert lift(f"{skipped}\n{GOOD}\n") == [ANSWER]


# ---- Output ----------------------------------------------------------------------------------


def test_numbers_are_the_librarys_to_six_digits():
    need_library()
    table = lift("\n".join(map(text, WALK)))
    poses = edmlift.Library().lift(WALK)
    assert statuses(table) == list(poses.status) == ["ok"] * len(WALK)
    expected = np.column_stack([poses.joints.reshape(-1, 42), poses.misfit])
    np.testing.assert_allclose([numbers(row) for row in table], expected, rtol=5.01e-6, atol=1e-12)


def test_origin_is_mid_hip_and_the_size_is_human():
    joints = numbers(ANSWER)[:42].reshape(14, 3)
    np.testing.assert_allclose(joints[8] + joints[11], 0, atol=2e-6)
    assert 1.2 < np.ptp(joints[:, 1]) < 2.2  # metres; head to ankle of somebody who walks


def test_the_decimal_point_is_no_matter_of_the_locale():
    environment = os.environ | {"LC_ALL": "de_DE.UTF-8"}
    result = subprocess.run([PROGRAM], input=GOOD.encode(), capture_output=True, env=environment)
    assert rows(result) == [ANSWER]


def test_header():
    header, answer = lift(GOOD, "--header")
    assert header[:4] == ["status", "x0", "y0", "z0"]
    assert header[-2:] == ["z13", "misfit"]
    assert answer == ANSWER
    assert lift("", "--header") == [header]


def read_line(pipe, seconds: float) -> bytes:
    """A line, or what has come of it when the time is up."""
    line = b""
    while not line.endswith(b"\n") and select.select([pipe], [], [], seconds)[0]:
        line += os.read(pipe.fileno(), 4096)
    return line


def test_answers_come_line_by_line():
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "bufsize": 0}
    with subprocess.Popen([PROGRAM, "--header"], **pipes) as process:
        assert read_line(process.stdout, 10).startswith(b"status,")
        for pose, status in ((GOOD, b"ok,"), ("x", b"bad_line,"), (OTHER, b"ok,")):
            process.stdin.write(pose.encode() + b"\n")
            assert read_line(process.stdout, 10).startswith(status)
        process.stdin.close()
        assert process.wait(10) == 1


needs_dev_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")


@needs_dev_full
@pytest.mark.parametrize("options", [[], ["--header"]], ids=["poses", "header"])
def test_write_error(options: list[str]):
    with open("/dev/full", "wb") as full:
        result = subprocess.run(
            [PROGRAM, *options], input=GOOD.encode(), stdout=full, stderr=subprocess.PIPE
        )
    assert result.returncode == 2
    assert b"lift_stdin: cannot write output" in result.stderr


@needs_dev_full
@pytest.mark.parametrize("option", ["--help", "--version", "--list-models", "--list-formats"])
def test_write_error_of_an_option_that_prints(option: str):
    with open("/dev/full", "wb") as full:
        result = subprocess.run([PROGRAM, option], stdout=full, stderr=subprocess.PIPE)
    assert result.returncode == 2


def test_read_error(tmp_path: Path):
    folder = os.open(tmp_path, os.O_RDONLY)
    result = subprocess.run([PROGRAM], stdin=folder, capture_output=True)
    os.close(folder)
    assert (result.returncode, result.stdout) == (2, b"")
    assert result.stderr.decode() == "lift_stdin: cannot read input\n"


# ---- Options ---------------------------------------------------------------------------------


def test_threshold():
    pose = WALK[0].copy()
    pose[RIGHT_ARM, 2] = 0.3
    pose[5, 2] = 0.31
    weak, without = f"{text(pose)}\n", lift(text(unseen(RIGHT_ARM)))
    assert lift(weak) == [ANSWER]
    assert lift(weak, "--threshold", "0.29") == [ANSWER]
    assert lift(weak, "--threshold", "0.3") == without
    assert lift(weak, "--threshold=0.3") == without
    assert statuses(lift(weak, "--threshold", "1")) == ["too_few_joints"]


def test_threshold_does_not_touch_28_numbers():
    assert lift(text(WALK[0, :, :2]), "--threshold", "2") == [ANSWER]


def test_negative_confidence_was_not_seen():
    pose = unseen(RIGHT_ARM)
    pose[RIGHT_ARM, 2] = -1
    assert lift(text(pose)) == lift(text(unseen(RIGHT_ARM)))


@pytest.mark.parametrize("value", ["", "x", "0.5x", "-1", "nan", "inf"])
def test_bad_threshold(value: str):
    result = run(GOOD, f"--threshold={value}")
    assert (result.returncode, result.stdout) == (2, b"")
    assert b"--threshold" in result.stderr


def models() -> list[str]:
    result = run("", "--list-models")
    assert (result.returncode, result.stderr) == (0, b"")
    return result.stdout.decode().split()


def test_every_listed_model_lifts():
    assert models()
    assert lift(GOOD, "--model", models()[0]) == [ANSWER]
    for model in models():
        assert statuses(lift(GOOD, "--model", model)) == ["ok"]
        assert lift(GOOD, f"--model={model}") == lift(GOOD, "--model", model)


@pytest.mark.parametrize("model", ["", "none", "distances"])
def test_unknown_model_lists_the_known(model: str):
    result = run(GOOD, "--model", model)
    assert (result.returncode, result.stdout) == (2, b"")
    first, *rest = result.stderr.decode().splitlines()
    assert f"'{model}'" in first
    assert rest == models()


def test_help_names_every_option():
    result = run("", "--help")
    assert (result.returncode, result.stderr) == (0, b"")
    options = "--format --image --json --up --camera --focal --fixed --model --threshold --header"
    options += " --height --quality --mirrored"
    for word in (*options.split(), "--list-formats", "--list-models", "--version", "bad_line"):
        assert word in result.stdout.decode()
    assert max(map(len, result.stdout.decode().splitlines())) <= 100


def test_version_is_the_headers():
    result = run("", "--version")
    assert result.returncode == 0
    assert VERSION in result.stdout.decode().split()


@pytest.mark.parametrize("option", ["--wrong", "--headers", "--header=1", "-x", "poses.csv", ""])
def test_unknown_option(option: str):
    result = run(GOOD, option)
    assert (result.returncode, result.stdout) == (2, b"")
    assert f"'{option}'" in result.stderr.decode()


@pytest.mark.parametrize("option", ["--model", "--threshold", "--format", "--image"])
def test_option_without_its_value(option: str):
    result = run(GOOD, option)
    assert (result.returncode, result.stdout) == (2, b"")
    assert f"{option} needs a value" in result.stderr.decode()


# ---- Keypoints of detectors ------------------------------------------------------------------


def formats() -> dict[str, int]:
    """Name and number of keypoints of every format."""
    result = run("", "--list-formats")
    assert (result.returncode, result.stderr) == (0, b"")
    return {name: int(count) for name, count in map(str.split, result.stdout.decode().splitlines())}


COCO_LIMBS = [6, 8, 10, 5, 7, 9, 12, 14, 16, 11, 13, 15]


def coco(pose: np.ndarray = WALK[0]) -> np.ndarray:
    """Keypoints [17,3] of a person whose ears are where the joint called head is."""
    keypoints = np.zeros((17, 3))
    keypoints[COCO_LIMBS] = pose[2:]
    keypoints[3] = pose[0] + [6, 0, 0]
    keypoints[4] = pose[0] - [6, 0, 0]
    return keypoints


def test_coco_is_lifted_like_the_joints_that_it_shows():
    shoulder, hip = WALK[0, [2, 5]].mean(0), WALK[0, [8, 11]].mean(0)
    expected = WALK[0].copy()
    expected[1] = shoulder + 0.12 * (hip - shoulder)
    found = numbers(lift(text(coco()), "--format", "coco17")[0])
    np.testing.assert_allclose(found, numbers(lift(text(expected))[0]), atol=1e-3)


@pytest.mark.parametrize("format", formats())
def test_every_format_is_read_with_and_without_confidence(format: str):
    count = formats()[format]
    image = ("--image", "1920,1080") if format in ("blazepose33", "movenet17") else ()
    rng = np.random.default_rng(1)
    points = rng.uniform(0.2, 0.8, (count, 3)).round(3)
    for columns in (2, 3):
        statuses_ = statuses(lift(text(points[:, :columns]), "--format", format, *image))
        assert statuses_ == ["ok"]


@pytest.mark.parametrize("numbers_on_line", [28, 33, 35, 50, 52, 99])
def test_a_wrong_count_names_both_counts_and_the_formats_that_have_it(numbers_on_line: int):
    result = run(",".join(["1"] * numbers_on_line), "--format=coco17")
    assert statuses(rows(result)) == ["bad_line"]
    those = [name for name, n in formats().items() if numbers_on_line in (2 * n, 3 * n)]
    hint = f"; formats with {numbers_on_line}: {', '.join(those)}: name one by --format"
    message = f"line 1: {numbers_on_line} numbers, but coco17 has 34 or 51{hint if those else ''}\n"
    assert message in result.stderr.decode()


SEVENTEEN = "coco17, movenet17, h36m17_right_first, h36m17_left_first: name one by --format"


@pytest.mark.parametrize("line, hint, json_", [
    (" ".join(["1"] * 51), f"but a pose has 28 or 42; formats with 51: {SEVENTEEN}", False),
    ('{"keypoints": []}', "JSON: give --json", False),
    ("[[1, 2]]", "JSON: give --json", False),
    (json.dumps({"keypoints": [[1, 2]] * 17}), f"14; formats with 17: {SEVENTEEN}", True),
    (json.dumps({"keypoints": [1, 2, 3] * 17}), f"28 or 42; formats with 51: {SEVENTEEN}", True),
    ('{"keypoints": [[1, 2]]}', "1 keypoints, but a pose has 14", True),
    ("{}", 'has no member "keypoints", nor another that people have', True),
])  # fmt: skip
def test_what_newcomers_try_gets_a_hint(line: str, hint: str, json_: bool):
    result = run(line, *(["--json"] if json_ else []))
    assert result.returncode == 1 and f"{hint}\n" in result.stderr.decode()


@pytest.mark.parametrize("format", ["", "coco", "COCO17"])
def test_unknown_format_lists_the_known(format: str):
    result = run(GOOD, "--format", format)
    assert (result.returncode, result.stdout) == (2, b"")
    first, *rest = result.stderr.decode().splitlines()
    assert f"'{format}'" in first
    assert rest == [f"{name} {count}" for name, count in formats().items()]


def blazepose(pose: np.ndarray, width: float, height: float) -> np.ndarray:
    keypoints = np.zeros((33, 3))
    keypoints[[12, 14, 16, 11, 13, 15, 24, 26, 28, 23, 25, 27]] = pose[2:]
    keypoints[[7, 8]] = pose[0]
    return keypoints / [width, height, 1]


@pytest.mark.parametrize("size", [(1000, 1000), (1920, 1080), (900, 800)])
def test_shares_of_the_image_are_multiplied_by_its_size(size: tuple[int, int]):
    line = ",".join(f"{number:.9g}" for number in np.ravel(blazepose(WALK[0], *size)))
    found = lift(line, "--format", "blazepose33", "--image", "{},{}".format(*size))[0]
    expected = lift(text(coco()), "--format", "coco17")[0]
    np.testing.assert_allclose(numbers(found), numbers(expected), atol=2e-3)


def test_pixels_are_not_normalised_coordinates():
    keypoints = blazepose(WALK[0], 1, 1)
    keypoints[0] = [1e6, 1e6, 0]  # not seen
    result = run(text(keypoints), "--format", "blazepose33", "--image", "1000,1000")
    assert result.returncode == 1 and statuses(rows(result)) == ["bad_line"]
    assert b"line 1: keypoints of this format are normalised" in result.stderr


def test_blazepose_wants_the_size_of_the_image():
    without = run("", "--format", "blazepose33")
    assert without.returncode == 2 and b"--image WIDTH,HEIGHT" in without.stderr


def test_keypoints_outside_the_image_are_not_seen():
    """Of joints as of a detector's normalised keypoints."""
    height = int(np.ceil(np.sort(WALK[0][:, 1])[-3]))  # of an image without the ankles
    outside = np.flatnonzero(WALK[0][:, 1] > height)
    assert len(outside) == 2
    expected = lift(text(unseen(list(outside))))
    assert expected != lift(text(WALK[0]))
    assert lift(text(WALK[0]), "--image", f"1000,{height}") == expected
    assert lift(text(WALK[0]), "--image", "1000,1000") == lift(text(WALK[0]))
    blaze = "--format", "blazepose33", "--image", f"1000,{height}"
    sure, hidden = (blazepose(WALK[0], 1000, height) for _ in range(2))
    hidden[sure[:, 1] > 1, 2] = 0
    assert lift(text(sure), *blaze) == lift(text(hidden), *blaze)


@pytest.mark.parametrize(
    "size",
    ["", "640", "640,", ",480", "640,480,3", "0,480", "-640,480", "640x480", "1e3,480", " 640,480",
     "99999999999999999999,1"],
)  # fmt: skip
def test_bad_image_size(size: str):
    result = run("", "--format=blazepose33", f"--image={size}")
    assert (result.returncode, result.stdout) == (2, b"")
    assert f"'{size}'" in result.stderr.decode()


def test_threshold_is_for_the_keypoints_of_the_detector():
    """Not for the guessed head and neck, which have half of their confidence."""
    keypoints = coco()
    keypoints[keypoints[:, 2] > 0, 2] = 0.5
    found = lift(text(keypoints), "--format=coco17", "--threshold=0.4")
    assert found == lift(text(coco()), "--format=coco17")


# ---- JSON ------------------------------------------------------------------------------------


def answer(row: list[str]) -> dict:
    """The members that --json adds, of a row without it."""
    values = [float(field) for field in row[1:]] if row[0] == "ok" else []
    return {
        "status": row[0],
        "joints": [values[n : n + 3] for n in range(0, 42, 3)] if values else None,
        "misfit": values[42] if values else None,
    }


MEMBERS = {"id": 7, "t": 0.25, "tags": {"a": [1, {"b": [None, True, "]}"]}], "é\\": '😀\n"'}}


@pytest.mark.parametrize("ascii_only", [True, False])
def test_json_members_come_through_and_the_answer_is_added(ascii_only: bool):
    line = {**MEMBERS, "keypoints": WALK[0].tolist(), "after": [[]]}
    result = run(json.dumps(line, ensure_ascii=ascii_only) + "\n", "--json")
    assert (result.returncode, result.stderr) == (0, b"")
    assert objects(result) == [line | answer(ANSWER)]
    start = json.dumps(line, ensure_ascii=ascii_only)[:-1].encode()
    assert result.stdout.startswith(start + b',"status":"ok",')  # byte for byte


def test_json_keypoints_that_were_not_seen():
    pose = WALK[0]
    expected = answer(lift(text(unseen([4])))[0])
    for nothing in (None, [None, None], [None, None, 0.9], [1, 2, 0], [1, 2, -1]):
        points = pose.tolist()
        points[4] = nothing
        (found,) = objects(run(json.dumps({"keypoints": points}), "--json"))
        assert {name: found[name] for name in expected} == expected
    points = pose[:, :2].tolist()
    points[4] = [None, None]
    (found,) = objects(run(json.dumps({"keypoints": points}), "--json"))
    assert found["joints"] == expected["joints"]


@pytest.mark.parametrize("nobody", [None, []])
def test_json_of_a_frame_without_anybody(nobody):
    result = run(json.dumps({"id": 7, "keypoints": nobody, "t": 1}), "--json")
    assert result.returncode == 0
    assert objects(result) == [{"id": 7, "keypoints": nobody, "t": 1} | answer(["nobody"])]


def test_json_names_the_member_that_is_the_answers():
    result = run(as_json(WALK[0], misfit=1), "--json")
    assert b'line 1: has a member "misfit", which the answer adds' in result.stderr


def test_json_of_a_detector():
    (found,) = objects(run(as_json(coco()), "--json", "--format", "coco17"))
    assert found["joints"] == answer(lift(text(coco()), "--format", "coco17")[0])["joints"]


def test_json_refused_poses_are_not_bad_lines():
    result = run(as_json(unseen(LEGS), id=3) + "\n" + as_json(WALK[0], id=4), "--json")
    assert result.returncode == 0
    few, good = objects(result)
    assert few["id"] == 3 and few["status"] == "too_few_joints" and few["joints"] is None
    assert good["id"] == 4 and good["status"] == "ok"


def keypoints_with(value: str) -> str:
    return '{"keypoints":[' + ",".join(["[1,2]"] * 13 + [value]) + "]}"


BAD_JSON = {
    "csv": GOOD,
    "array": "[true]",
    "string": '"keypoints"',
    "word": "nul",
    "number": "1",
    "cut": as_json(WALK[0])[:-1],
    "comma": as_json(WALK[0])[:-1] + ",}",
    "no keypoints": "{}",
    "keypoints in another object": '{"a":' + as_json(WALK[0]) + "}",
    "keypoints twice": as_json(WALK[0])[:-1] + ',"keypoints":[]}',
    "keypoints object": '{"keypoints":{}}',
    "13 keypoints": as_json(WALK[0, :13]),
    "15 keypoints": as_json(np.vstack([WALK[0], WALK[0, :1]])),
    "has a status": as_json(WALK[0], id=7, status="ok", t=0.5),
    "has an escaped status": as_json(WALK[0], id=7).replace('"id"', '"\\u0073t\\u0061tus"'),
    "has joints": as_json(WALK[0], joints=[]),
    "keypoint empty": keypoints_with("[]"),
    "keypoint one": keypoints_with("[1]"),
    "keypoint four": keypoints_with("[1,2,3,4]"),
    "keypoint text": keypoints_with('["1","2"]'),
    "keypoint bool": keypoints_with("[true,2]"),
    "keypoint nested": keypoints_with("[[1],2]"),
    "keypoint x null": keypoints_with("[null,2]"),
    "keypoint y null": keypoints_with("[1,null,1]"),
    "keypoint c null": keypoints_with("[1,2,null]"),
    "keypoint nan": keypoints_with("[NaN,2]"),
    "keypoint infinity": keypoints_with("[1,-Infinity]"),
    "keypoint hexadecimal": keypoints_with("[0x1p3,2]"),
    "keypoint plus": keypoints_with("[+1,2]"),
    "keypoint zeros": keypoints_with("[01,2]"),
    "keypoint point": keypoints_with("[1.,2]"),
    "keypoint flat": keypoints_with("1,2"),
    "tab in a string": as_json(WALK[0])[:-1] + ',"a":"\t"}',
    "bad escape": as_json(WALK[0])[:-1] + ',"a":"\\x"}',
    "zero byte": as_json(WALK[0])[:-1] + ',"a":"\0"}',
    "too deep": '{"a":' + "[" * 32 + "]" * 32 + "," + as_json(WALK[0])[1:],
    "deep": '{"a":' + "[" * 50000,
    "65537 bytes": as_json(WALK[0], a="x" * (65537 - len(as_json(WALK[0], a="")))),
}


def members(line: str) -> dict | None:
    """What a bad line is to keep: the members of an object that the answer does not have."""

    def refuse(constant: str):
        raise ValueError(constant)

    if len(line) > 65536 or "[" * 32 in line:
        return None
    try:
        found = json.loads(line, parse_constant=refuse)
    except (ValueError, RecursionError):
        return None
    if not isinstance(found, dict):
        return None
    return {name: value for name, value in found.items() if name not in answer(ANSWER)}


@pytest.mark.parametrize("bad", BAD_JSON.values(), ids=BAD_JSON.keys())
def test_bad_json_is_named_and_shifts_nothing(bad: str):
    good, other = as_json(WALK[0]), as_json(WALK[20])
    result = run(f"{good}\n\n{bad}\n{other}\n", "--json")
    first, named, last = objects(result)
    assert named == (members(bad) or {}) | answer(["bad_line"])
    assert first["joints"] == answer(ANSWER)["joints"]
    assert last["joints"] == answer(OTHER_ANSWER)["joints"]
    assert result.returncode == 1
    message, count = result.stderr.decode().splitlines()
    assert message.startswith("lift_stdin: line 3: ")
    assert count == "lift_stdin: bad lines: 1"


@pytest.mark.parametrize(
    "bad", [b"\xff", b"\xc0\x80", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\xc3"]
)
def test_json_that_is_not_utf_8_is_bad(bad: bytes):
    line = as_json(WALK[0], a="?").encode().replace(b"?", bad)
    result = run(line, "--json")
    assert (objects(result), result.returncode) == ([answer(["bad_line"])], 1)


def test_json_as_long_and_as_deep_as_can_be():
    deep = json.loads("[" * 31 + "]" * 31)
    long = as_json(WALK[0], a="x" * (65536 - len(as_json(WALK[0], a=""))))
    assert len(long) == 65536
    for line in (long, as_json(WALK[0]).ljust(1 << 20), as_json(WALK[0], a=deep)):
        (found,) = objects(run(line, "--json"))
        assert found["joints"] == answer(ANSWER)["joints"]


def test_json_has_no_header():
    result = run("", "--json", "--header")
    assert (result.returncode, result.stdout) == (2, b"")


def refuse_constant(name: str) -> None:
    raise ValueError(name)


def is_pose(line: bytes) -> bool:
    """Is the first value a person, by Python's parser and the description of keypoints?"""
    number = (int, float)
    decoder = json.JSONDecoder(
        parse_constant=refuse_constant, object_pairs_hook=lambda pairs: pairs
    )
    try:
        line.decode("utf-8")
        object, end = decoder.raw_decode(line.decode("utf-8").lstrip())
    except ValueError:
        return False
    names = [pair[0] for pair in object] if line.lstrip()[:1] == b"{" else []
    if names.count("keypoints") != 1 or {"status", "joints", "misfit"} & set(names):
        return False
    keypoints = dict(object)["keypoints"]
    if not isinstance(keypoints, list) or len(keypoints) != 14:
        return False
    return all(
        point is None
        or isinstance(point, list)
        and len(point) in (2, 3)
        and (point[:2] == [None, None] or all(type(v) in number for v in point[:2]))
        and all(type(v) in number for v in point[2:])
        for point in keypoints
    )


def broken_json(count: int) -> list[bytes]:
    """Lines with some bytes replaced or cut."""
    rng = random.Random(2)
    seed = as_json(WALK[0], **MEMBERS).encode()
    small = keypoints_with("null").encode()
    lines = []
    for _ in range(count):
        line = bytearray(rng.choice([seed, small, small]))
        for _ in range(rng.randrange(4)):
            line[rng.randrange(len(line))] = rng.choice(b'[]{}",:\\-0.1eEnu \t\xc3\xa9')
        lines.append(bytes(line[: rng.choice([len(line), rng.randrange(1, len(line))])]))
    return [line for line in lines if not re.match(rb"[ \t\r]*(#|$)", line)]


@pytest.mark.slow
def test_400_texts_of_broken_json():
    """Bad if and only if Python says so."""
    lines = broken_json(400)
    found = [objects(run(line, "--json"))[0] for line in lines]
    bad = [one["status"] == "bad_line" for one in found]
    assert bad == [not is_pose(line) for line in lines]
    assert 0.2 < np.mean(bad) < 0.95
    for one, line in zip(found, lines, strict=True):
        if one["status"] != "bad_line":
            assert json.loads(line).items() <= one.items()


def test_3000_lines_of_broken_json():
    """What is broken ends at a byte that no value has: nobody behind it is lost."""
    lines = broken_json(3000)
    good = [as_json(WALK[0], number=n).encode() for n in range(len(lines))]
    stream = b"\n".join(b"\n\1\n".join(pair) for pair in zip(lines, good, strict=True))
    found = objects(run(stream, "--json"))
    assert {one["status"] for one in found} <= STATUSES
    passed = [one for one in found if "number" in one and one["status"] == "ok"]
    assert [one["number"] for one in passed] == list(range(len(lines)))
    assert all(one["joints"] == answer(ANSWER)["joints"] for one in passed)


# ---- Anything at all -------------------------------------------------------------------------


def garbage(rng: random.Random) -> bytes:
    """A line of one of many kinds, without a newline."""
    kind = rng.randrange(6)
    if kind == 0:
        return rng.randbytes(rng.randrange(200)).replace(b"\n", b" ")
    if kind == 1:
        words = ["1", "-2.5", "nan", "inf", "1e38", "-1e-40", "0x1p3", "", "#", "\t", "ok", "\0"]
        return rng.choice([",", " "]).join(rng.choices(words, k=rng.randrange(50))).encode()
    if kind == 2:
        size = rng.choice([LINE_MAX - 1, LINE_MAX, LINE_MAX + 1, 3 * LINE_MAX])
        return rng.choice([GOOD.encode(), b"1,", b"x", b"\0"]).ljust(size)
    if kind == 3:
        scale = 10 ** rng.uniform(-40, 40)
        return ",".join(f"{rng.gauss(0, scale):g}" for _ in range(rng.choice([28, 42]))).encode()
    line = bytearray(GOOD.encode())
    for _ in range(rng.randrange(1, 6)):
        line[rng.randrange(len(line))] = rng.choice(b",.- e0123456789\t\r\0#x\xff")
    return bytes(line)


def test_5000_lines_of_garbage():
    rng = random.Random(1)
    lines = [garbage(rng) for _ in range(5000)]
    poses = [line for line in lines if not re.match(rb"[ \t\r]*(#|$)", line)]
    result = run(b"\n".join(lines) + b"\n")
    table = rows(result)
    assert result.returncode == 1
    assert len(table) == len(poses)
    assert set(statuses(table)) <= STATUSES
    for row in table:
        if row[0] == "ok":
            assert np.isfinite(numbers(row)).all()
        else:
            assert row[1:] == [""] * 43
    bad = statuses(table).count("bad_line")
    assert result.stderr.decode().endswith(f"lift_stdin: bad lines: {bad}\n")
    assert result.stderr.decode().count("lift_stdin: line ") == bad


# ---- Fixed point -------------------------------------------------------------------------------


def test_fixed_point_prints_what_the_library_lifts() -> None:
    table = lift("\n".join(map(text, WALK)), "--fixed")
    poses = edmlift.Library("distances_w16", fixed=True).lift(WALK)
    assert statuses(table) == list(poses.status)
    found = np.array([numbers(row)[:42] for row in table]).reshape(-1, 14, 3)
    np.testing.assert_allclose(found, poses.joints, atol=2e-6)
    assert not np.array_equal(found[0], numbers(ANSWER)[:42].reshape(14, 3))


@pytest.mark.parametrize("model", ["distances_w16", "distances_w8", "direct_w16", "fconn_w16"])
def test_a_quantised_network_runs_in_float_and_in_fixed_point(model: str) -> None:
    plain, fixed = (lift(GOOD, "--model", model, *more)[0] for more in ([], ["--fixed"]))
    assert plain[0] == fixed[0] == "ok"
    np.testing.assert_allclose(numbers(fixed)[:42], numbers(plain)[:42], atol=1e-3)


def test_fixed_point_refuses_what_it_cannot_hold() -> None:
    far, nan, huge, sure = (WALK[0].copy() for _ in range(4))
    far[:, 0] += 8192
    nan[3, 2] = np.nan
    huge[5, 1] = 1e30
    sure[2, 2] = np.inf
    lines = "\n".join(map(text, (far, nan, huge, sure, unseen([3]), unseen(LEGS), WALK[0])))
    table = lift(lines, "--fixed")
    expected = ["not_finite", "ok", "not_finite", "not_finite", "ok", "too_few_joints", "ok"]
    assert statuses(table) == expected


def test_fixed_point_reads_formats_and_json() -> None:
    keypoints = np.zeros((17, 3))
    keypoints[5:, 2] = keypoints[:5, 2] = 0.9
    order = [5, 2, 6, 3, 7, 4, 11, 8, 12, 9, 13, 10]  # of COCO's shoulders to ankles
    keypoints[5:, :2] = WALK[0][order, :2]
    keypoints[:5, :2] = WALK[0][0, :2] + [[0, 25], [5, 22], [-5, 22], [10, 24], [-10, 24]]
    plain = lift(text(keypoints), "--format", "coco17")[0]
    fixed = lift(text(keypoints), "--format", "coco17", "--fixed")[0]
    assert plain[0] == fixed[0] == "ok"
    np.testing.assert_allclose(numbers(fixed)[:42], numbers(plain)[:42], atol=5e-3)
    line = json.dumps({"keypoints": keypoints.tolist()})
    answer = json.loads(run(line, "--format", "coco17", "--fixed", "--json").stdout)
    np.testing.assert_allclose(np.ravel(answer["joints"]), numbers(fixed)[:42], atol=2e-6)


def test_fixed_point_says_which_networks_it_takes() -> None:
    result = run(GOOD, "--fixed", "--model", "direct_f32")
    assert result.returncode == 2 and result.stdout == b""
    assert result.stderr == (
        b"lift_stdin: --fixed needs a quantised network, such as distances_w16\n"
    )


# ---- Upward ------------------------------------------------------------------------------------

AS_UP = [["--up", "0,-1,0"], ["--up=0,-9.81,0"], ["--up", "0,-1e-3,0"]]


@pytest.mark.parametrize("options", AS_UP)
def test_up_is_the_librarys_whatever_its_length(
    library: edmlift.Library, options: list[str]
) -> None:
    table = lift("\n".join(map(text, WALK)), *options)
    poses = library.lift(WALK, up=[0, -1, 0])
    joints = np.array([numbers(row)[:42] for row in table]).reshape(-1, 14, 3)
    np.testing.assert_allclose(joints, poses.joints, rtol=1e-5, atol=1e-5)
    assert np.abs(joints - library.lift(WALK).joints).max() > 1e-3


def test_up_in_fixed_point_and_in_a_video() -> None:
    plain, fixed = (lift(GOOD, "--up", "0,-1,0", *more)[0] for more in ([], ["--fixed"]))
    np.testing.assert_allclose(numbers(fixed)[:42], numbers(plain)[:42], atol=0.02)
    (tracked,) = lift(GOOD, "--up", "0,-1,0", "--track", "30", *FREE)
    np.testing.assert_allclose(numbers(tracked)[:42], numbers(plain)[:42], atol=1e-5)


@pytest.mark.parametrize("value", ["", "0,0,0", "1,2", "1,2,3,4", "nan,0,1", "inf,0,0", "a,b,c"])
def test_bad_up(value: str) -> None:
    result = run(GOOD, f"--up={value}")
    assert (result.returncode, result.stdout) == (2, b"") and b"--up" in result.stderr


# ---- The camera ----------------------------------------------------------------------------------

PLACED = ["placement", "root_x", "root_y", "root_z", "reprojection", "focal"]
CAMERA = (1145.0, 1145.0, 500.0, 500.0)


def place(data: str, *options: str) -> list[list[str]]:
    """Rows with the fields of --camera or --focal."""
    result = run(data, *options)
    assert result.returncode == 0
    table = [line.split(",") for line in result.stdout.decode("ascii").splitlines()]
    assert all(len(row) == COLUMNS + len(PLACED) for row in table)
    return table


def check_placements(table: list[list[str]], placed: edmlift.Placements, atol: float) -> None:
    """Roots, reprojections and focal lengths are the library's; joints are about the root."""
    assert [row[COLUMNS] for row in table] == list(placed.status)
    found = np.array([row[COLUMNS + 1 :] for row in table], float)
    np.testing.assert_allclose(found[:, :3], placed.translation, rtol=1e-5, atol=atol)
    np.testing.assert_allclose(found[:, 3], placed.reprojection, rtol=1e-5, atol=10 * atol)
    np.testing.assert_allclose(found[:, 4], placed.focal, rtol=1e-5)
    joints = np.array([row[1:43] for row in table], float).reshape(-1, 14, 3) + found[:, None, :3]
    np.testing.assert_allclose(joints, placed.joints, rtol=1e-5, atol=2 * atol)


@pytest.fixture(scope="module")
def library() -> edmlift.Library:
    return edmlift.Library()


@pytest.mark.parametrize("option", ["--camera=1145,1145,500,500", "--focal=1145"])
def test_poses_are_placed_as_by_the_library(library: edmlift.Library, option: str) -> None:
    image = ["--image", "1000,1000"] if "focal" in option else []
    table = place("\n".join(map(text, WALK)), option, *image)
    lifted = library.lift(WALK, camera=CAMERA).joints
    check_placements(table, library.place(lifted, WALK, CAMERA), 1e-5)


def test_the_focal_length_is_swept_for(library: edmlift.Library) -> None:
    table = place("\n".join(map(text, WALK)), "--focal", "sweep", "--image", "1000,1000")
    lifted = library.lift(WALK).joints
    check_placements(table, library.place_sweep(lifted, WALK, (1000, 1000)), 1e-5)


def test_fixed_point_places_nearly_there() -> None:
    options = "--model", "distances_w16", "--camera", "1145,1145,500,500"
    lines = "\n".join(map(text, WALK))
    plain, fixed = place(lines, *options), place(lines, *options, "--fixed")
    for a, b in zip(plain, fixed, strict=True):
        assert a[COLUMNS] == b[COLUMNS] == "ok"
        np.testing.assert_allclose(numbers(b[:COLUMNS]), numbers(a[:COLUMNS]), atol=0.01)
        np.testing.assert_allclose(
            [float(n) for n in b[-5:]], [float(n) for n in a[-5:]], rtol=0.005, atol=0.01
        )
    (swept,) = place(GOOD, "--fixed", "--focal", "sweep", "--image", "1000,1000")
    assert swept[COLUMNS] == "ok" and 500 <= float(swept[-1]) <= 4000


def test_what_cannot_be_placed_is_lifted_all_the_same() -> None:
    lines = "\n".join([GOOD, text(unseen(LEGS)), text(WALK[1])])
    near, refused, last = place(lines, "--camera", "60,60,500,500")
    assert near[:COLUMNS] == ANSWER and near[COLUMNS:] == ["camera", *[""] * 5]
    assert refused[0] == "too_few_joints" and refused[1:] == [""] * (COLUMNS + 5)
    assert last[0] == "ok"


def test_bad_lines_have_as_many_fields() -> None:
    result = run("x\n", "--camera", "1145,1145,500,500")
    assert result.stdout == b"bad_line" + b"," * (COLUMNS + 5) + b"\n"


def test_the_header_of_placements() -> None:
    (header,) = place("", "--header", "--camera", "1,1,0,0")
    assert header[COLUMNS:] == PLACED
    assert header[:COLUMNS] == lift("", "--header")[0]


def test_json_of_placements() -> None:
    row = place(GOOD, "--camera", "1145,1145,500,500")[0]
    (found,) = objects(run(as_json(WALK[0]), "--json", "--camera", "1145,1145,500,500"))
    assert found["placement"] == "ok" and found["joints"] == answer(row[:COLUMNS])["joints"]
    values = [*found["root"], found["reprojection"], found["focal"]]
    assert values == [float(field) for field in row[COLUMNS + 1 :]]
    (none,) = objects(run(as_json(WALK[0]), "--json", "--camera", "60,60,500,500"))
    assert none["placement"] == "camera" and none["joints"] is not None
    assert none["root"] is none["reprojection"] is none["focal"] is None
    (bad,) = objects(run("{}", "--json", "--camera", "60,60,500,500"))
    assert bad["status"] == "bad_line" and bad["placement"] is bad["root"] is None


def test_json_members_of_a_placement_are_the_answers_only_with_a_camera() -> None:
    line = as_json(WALK[0], root=3)
    assert objects(run(line, "--json"))[0]["root"] == 3
    assert run(line, "--json", "--camera", "1145,1145,500,500").returncode == 1


@pytest.mark.parametrize(
    "options",
    [
        ["--camera", "1145,1145,500"],
        ["--camera", "1145,1145,500,500,0"],
        ["--camera", "0,1145,500,500"],
        ["--camera", "1145,-1,500,500"],
        ["--camera", "nan,1145,500,500"],
        ["--camera", "a"],
        ["--camera", ""],
        ["--focal", "0", "--image", "640,480"],
        ["--focal", "inf", "--image", "640,480"],
        ["--focal", "swept", "--image", "640,480"],
        ["--focal", "sweep"],
        ["--focal", "500"],
        ["--camera", "1,1,0,0", "--focal", "sweep", "--image", "640,480"],
    ],
)
def test_bad_camera(options: list[str]) -> None:
    result = run(GOOD, *options)
    assert (result.returncode, result.stdout) == (2, b"")
    assert options[0].encode() in result.stderr or b"--focal" in result.stderr


# Video


def test_track_is_the_librarys():
    keypoints = WALK.copy()
    keypoints[10] = keypoints[10, MIRROR]
    table = rows(run("\n".join(text(pose) for pose in keypoints), "--track", "30", *FREE))
    times = np.arange(len(WALK)) * 1000 // 30
    tracked = edmlift.Library().track().lift(keypoints, times)
    joints = np.array([numbers(row)[:42] for row in table]).reshape(-1, 14, 3)
    np.testing.assert_allclose(joints, tracked.joints, rtol=1e-5, atol=1e-5)
    assert np.abs(joints - edmlift.Library().lift(keypoints).joints).max() > 0.05


def test_a_tracked_pose_is_placed_by_its_own_keypoints():
    """With right and left put right in two frames, the placements are those of the clean video."""
    exchanged = WALK.copy()
    exchanged[20:22] = exchanged[20:22, MIRROR]
    options = ("--track", "30", "--camera", "1145,1145,500,500")
    clean, found = (place("\n".join(map(text, poses)), *options) for poses in (WALK, exchanged))
    assert found == clean


def test_a_bad_line_is_a_frame_of_the_track():
    lines = [text(pose) for pose in WALK[:6]]
    lines[3] = "nonsense"
    table = rows(run("# c\n\n" + "\n".join(lines), "--track=10", *FREE))
    times = np.array([0, 100, 200, 400, 500])
    tracked = edmlift.Library().track().lift(WALK[[0, 1, 2, 4, 5]], times)
    assert statuses(table) == ["ok"] * 3 + ["bad_line"] + ["ok"] * 2
    joints = np.array([numbers(row)[:42] for row in table if row[0] == "ok"]).reshape(-1, 14, 3)
    np.testing.assert_allclose(joints, tracked.joints, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("value", ["0", "-1", "x", "", "1001", "nan", "30,1"])
def test_bad_track(value: str):
    result = run(GOOD, "--track", value)
    assert result.returncode == 2 and b"--track" in result.stderr and result.stdout == b""


def test_track_at_the_times_of_the_objects():
    times = np.array([0, 30, 70, 290, 290, 580, 610])  # milliseconds; a frame that is not later
    frames = WALK[: len(times)]
    lines = [as_json(pose, t=time / 1000 + 1.7e9) for pose, time in zip(frames, times, strict=True)]
    answers = objects(run("\n".join(lines), "--json", "--track", "t", *FREE))
    tracked = edmlift.Library().track().lift(frames, (times + 1.7e12) % 2**32)
    assert [answer["status"] for answer in answers] == tracked.status.tolist()
    assert tracked.status.tolist() == ["ok"] * 4 + ["time"] + ["ok"] * 2
    joints = [answer["joints"] for answer in answers if answer["status"] == "ok"]
    fine = tracked.status == "ok"
    np.testing.assert_allclose(joints, tracked.joints[fine], rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize(
    "members, wrong",
    [
        ({}, "has no t"),
        ({"t": -1}, "0 or more"),
        ({"t": "1"}, "0 or more"),
        ({"t": None}, "0 or more"),
        ({"t": 1e12}, "below 1e12"),
    ],
)
def test_a_bad_time_is_a_bad_line(members: dict, wrong: str):
    result = run(as_json(WALK[0], **members), "--json", "--track", "t")
    assert result.returncode == 1 and wrong in result.stderr.decode()
    assert objects(result)[0]["status"] == "bad_line"


def test_a_time_twice_is_a_bad_line():
    line = as_json(WALK[0], t=1)[:-1] + ', "t": 2}'
    assert b"t twice" in run(line, "--json", "--track", "t").stderr


def test_times_are_for_json():
    result = run(GOOD, "--track", "t")
    assert result.returncode == 2 and b"--json" in result.stderr and result.stdout == b""


SETTINGS = {"smooth_image": (1, 0.5), "smooth_space": (0.5, 0.25), "noise_full": 0.5}


@pytest.mark.parametrize("name", SETTINGS)
def test_the_tracks_settings(name: str):
    setting = SETTINGS[name]
    value = str(setting) if isinstance(setting, float) else ",".join(map(str, setting))
    noisy = WALK.copy()
    noisy[..., :2] += np.round(np.random.default_rng(5).normal(0, 5, noisy[..., :2].shape), 2)
    data = "\n".join(map(text, noisy))
    table = rows(run(data, "--track", "30", f"--{name.replace('_', '-')}", value))
    joints = np.array([numbers(row)[:42] for row in table]).reshape(-1, 14, 3)
    plain, other = (
        track(noisy, time_ms=np.arange(len(WALK)) * 1000 // 30, **options).joints
        for options in ({}, {name: setting})
    )
    np.testing.assert_allclose(joints, other, rtol=1e-5, atol=1e-5)
    assert np.abs(other - plain).max() > 1e-3


@pytest.mark.parametrize(
    "option, value",
    [
        ("--smooth-image", "0,1"), ("--smooth-image", "1"), ("--smooth-space", "1,-1"),
        ("--smooth-space", "1,nan"), ("--smooth-space", "inf,1"), ("--noise-full", "-1"),
        ("--noise-full", "x"),
    ],
)  # fmt: skip
def test_bad_settings_of_the_track(option: str, value: str):
    result = run(GOOD, "--track", "30", option, value)
    assert result.returncode == 2 and option in result.stderr.decode() and result.stdout == b""


def test_the_tracks_settings_are_for_the_track():
    result = run(GOOD, "--noise-full", "1")
    assert result.returncode == 2 and b"--track" in result.stderr


def test_a_track_in_fixed_point():
    """The same as in float, within a centimetre, with swapped sides and another person."""
    keypoints = WALK.copy()
    keypoints[20:22] = keypoints[20:22, MIRROR]
    keypoints[30] = keypoints[5] + [400, 0, 0]
    data = "\n".join(map(text, keypoints))
    options = ("--track", "30", "--camera", "1145,1145,500,500", "--smooth-space", "1,1")
    plain, fixed = (place(data, *options, *more) for more in ((), ("--fixed",)))
    joints, joints_fixed = (
        np.array([row[1:43] for row in table], float) for table in (plain, fixed)
    )
    np.testing.assert_allclose(joints_fixed, joints, atol=0.01)
    alone, tracked = (rows(run(data, "--fixed", *more)) for more in ((), ("--track", "30")))
    off = [
        np.abs(np.subtract(numbers(a)[:42], numbers(b)[:42])).max()
        for a, b in zip(alone, tracked, strict=True)
    ]
    assert off[20] > 0.1 and off[30] == 0
    times = "\n".join(as_json(pose, t=n / 30) for n, pose in enumerate(keypoints))
    answers = objects(run(times, "--json", "--track", "t", "--fixed"))
    assert [answer["status"] for answer in answers] == ["ok"] * len(keypoints)


def test_two_people_in_fixed_point():
    """Whom the detector lists in either order: each keeps the number that a float track gives."""
    data = (ROOT / "tests" / "python" / "cases" / "two_people.jsonl").read_text()
    plain, fixed = (
        objects(run(data, "--json", "--track", "30", *more)) for more in ((), ("--fixed",))
    )
    people = [[answer["person"] for answer in answers] for answers in (plain, fixed)]
    assert people[0] == people[1] and sorted(set(people[0])) == [0, 1]


@pytest.mark.parametrize("setting", [("--smooth-image", "1,33"), ("--noise-full", "65")])
def test_settings_out_of_the_range_of_integers(setting: tuple[str, str]):
    result = run(GOOD, "--track", "30", "--fixed", *setting)
    assert result.returncode == 2 and setting[0] in result.stderr.decode()


# ---- The person ------------------------------------------------------------------------------


def person_rows(*options: str) -> list[list[str]]:
    result = run("\n".join(map(text, WALK)), *options)
    assert (result.returncode, result.stderr) == (0, b"")
    return [line.split(",") for line in result.stdout.decode().splitlines()]


def joints_of(table: list[list[str]]) -> np.ndarray:
    return np.array([row[1:43] for row in table], float).reshape(-1, 14, 3)


@pytest.mark.parametrize(("fixed", "atol"), [([], 1e-5), (["--fixed"], 1e-2)])
def test_quality_is_the_librarys_and_follows_the_misfit(fixed: list[str], atol: float):
    library = edmlift.Library()
    header, *table = person_rows("--quality", "--header", *fixed)
    assert header[-2:] == ["misfit", "quality"]
    plain = person_rows(*fixed)
    assert [row[:-1] for row in table] == plain
    quality = library.quality(library.lift(WALK))
    assert np.allclose([float(row[-1]) for row in table], quality, atol=atol)


@pytest.mark.parametrize(("fixed", "atol"), [([], 1e-5), (["--fixed"], 1e-2)])
def test_a_height_sizes_poses(fixed: list[str], atol: float):
    library = edmlift.Library()
    fitted, _ = library.fit_body(library.lift(WALK).joints, height=1.5)
    assert np.allclose(joints_of(person_rows("--height", "1.5", *fixed)), fitted, atol=atol)


def test_a_person_half_as_tall_is_half_as_far():
    camera = "--camera=1145,1145,500,500"
    tall, small = (person_rows(camera, f"--height={h}", "--quality") for h in ("1.8", "0.9"))
    depths = np.array([[float(row[-3]) for row in table] for table in (tall, small)])
    assert np.allclose(depths[0], 2 * depths[1], rtol=1e-3)
    assert [row[44] for row in tall] == [row[44] for row in small]  # quality is the lift's


def test_quality_of_what_is_refused_is_empty():
    few, bad = run(text(unseen(LEGS)) + "\nbad\n", "--quality").stdout.decode().splitlines()
    assert few == "too_few_joints" + 44 * "," and bad == "bad_line" + 44 * ","


def test_quality_is_of_single_lifts():
    result = run(GOOD, "--quality", "--track", "30")
    assert result.returncode == 2 and b"--track" in result.stderr


def test_json_of_quality():
    line = as_json(WALK[0], quality=3)
    (bad,) = objects(run(line, "--json", "--quality"))
    assert bad["status"] == "bad_line" and bad["quality"] is None
    (passed,) = objects(run(line, "--json"))
    assert passed["status"] == "ok" and passed["quality"] == 3
    (found,) = objects(run(as_json(WALK[0]), "--json", "--quality"))
    assert found["quality"] == float(person_rows("--quality")[0][-1])


@pytest.mark.parametrize("height", ["10", "0", "-1.7", "0.4", "170", "nan", "inf", "", "1.7 m"])
def test_a_height_that_no_one_has(height: str):
    result = run(GOOD, "--height", height)
    assert (result.returncode, result.stdout) == (2, b"")
    assert f"'{height}'" in result.stderr.decode()


def far_poses(count: int) -> np.ndarray:
    """Joints at the corners of wide and high boxes: some limbs are stretched beyond all measure."""
    rng = np.random.default_rng(3)
    joints = rng.choice([-100.0, 100.0], (count, 14, 3)) * rng.uniform(0, 1, (count, 1, 3))
    joints[:, :, 2] = 1
    return joints


@pytest.mark.parametrize("as_json_lines", [False, True])
def test_a_pose_without_quality_is_lifted_all_the_same(as_json_lines: bool):
    """edml_quality() refuses a joint beyond 4 m: its pose has the quality 0."""
    options = ["--json"] if as_json_lines else []
    lines = "\n".join(map(as_json if as_json_lines else text, far_poses(2000)))
    plain, rated = (run(lines, *options, *more).stdout.decode() for more in ([], ["--quality"]))
    for without, line in zip(plain.splitlines(), rated.splitlines(), strict=True):
        whole = without.rstrip("}")
        assert line.startswith(whole)
        if as_json_lines:
            found = json.loads(line)
            joints, quality = found["joints"], found["quality"]
        else:
            row = line.split(",")
            joints = [float(field) for field in row[1:43]] if row[0] == "ok" else None
            quality = float(row[-1]) if row[0] == "ok" else None
        if joints is None:
            assert quality is None
        else:
            assert (quality == 0) == (np.abs(joints).max() >= 4)


# ---- Angles ------------------------------------------------------------------------------------


@pytest.mark.parametrize("fixed, atol", [([], 1e-3), (["--fixed", "--model=distances_w16"], 0.2)])
def test_angles_are_the_librarys_and_come_last(fixed: list[str], atol: float):
    """But for the keypoints' rounding, and that of the network's input, in fixed point."""
    need_library()
    data = "\n".join(map(text, WALK)) + "\n"
    up = "0.1,-1,0.2"
    header, *table = (
        line.split(",")
        for line in run(data, "--angles", "--quality", "--header", f"--up={up}", *fixed)
        .stdout.decode()
        .splitlines()
    )
    names = header[COLUMNS + 1 :]
    assert header[COLUMNS] == "quality" and tuple(names) == package.ANGLES
    direction = [float(x) for x in up.split(",")]
    poses = package.lift(
        WALK, up=direction, model="distances_w16" if fixed else None, fixed=bool(fixed)
    )
    found = np.array([[float(x or "nan") for x in row[COLUMNS + 1 :]] for row in table])
    expected = np.stack([*package.angles(poses, direction).values()], 1)
    np.testing.assert_allclose(found, expected, atol=atol)
    assert np.isnan(found).any() and not np.isnan(found).all()


def test_angles_of_what_was_not_seen_and_of_what_is_refused_are_empty():
    lines = "\n".join([text(unseen([4])), text(unseen(LEGS)), "bad", ""])
    header, one, few, bad = (
        line.split(",") for line in run(lines, "--angles", "--header").stdout.decode().splitlines()
    )
    assert len(header) == len(one) == len(few) == len(bad) == COLUMNS + len(package.ANGLES)
    empty = [name for name, field in zip(header, one, strict=True) if field == ""]
    assert "right_elbow_flexion" in empty
    assert not {"left_elbow_flexion", "heading", "trunk_lean", "right_knee_flexion"} & {*empty}
    assert few[0] == "too_few_joints" and bad[0] == "bad_line"
    assert not any(few[COLUMNS:]) and not any(bad[COLUMNS:])


def test_json_of_angles():
    (bad,) = objects(run(as_json(WALK[0], angles=3), "--json", "--angles"))
    assert bad["status"] == "bad_line" and bad["angles"] is None
    (passed,) = objects(run(as_json(WALK[0], angles=3), "--json"))
    assert passed["status"] == "ok" and passed["angles"] == 3
    (found,) = objects(run(as_json(unseen([4])), "--json", "--angles"))
    assert tuple(found["angles"]) == package.ANGLES
    assert found["angles"]["right_elbow_flexion"] is None
    (row,) = run(text(unseen([4])) + "\n", "--angles").stdout.decode().splitlines()
    fields = row.split(",")[COLUMNS:]
    assert [float(f) if f else None for f in fields] == [*found["angles"].values()]
    (few,) = objects(run(as_json(unseen(LEGS)), "--json", "--angles"))
    assert few["status"] == "too_few_joints" and few["angles"] is None
