"""What detectors write, as examples/lift_stdin reads it: people, frames, likely mistakes.

tests/python/cases/README.md says where the files come from.
"""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from stdin_support import PROGRAM, WALK, as_json, objects, run, text

from edmlift.formats import FORMATS
from edmlift.joints import MIRROR

CASES = Path(__file__).parent / "cases"
COCO_NAMES = """nose left_eye right_eye left_ear right_ear left_shoulder right_shoulder left_elbow
right_elbow left_wrist right_wrist left_hip right_hip left_knee right_knee left_ankle
right_ankle""".split()
COCO = "--format", "coco17"


def case(*names: str) -> str:
    """Files, one behind another."""
    return "".join((CASES / name).read_text() for name in names)


def answers(data: str | bytes, *options: str) -> list[dict]:
    """Of JSON without a bad value."""
    result = run(data, "--json", *options)
    assert result.returncode == 0, result.stderr
    return objects(result)


def joints(table: list[dict]) -> np.ndarray:
    """[P,14,3] in metres, of people who were lifted."""
    assert {one["status"] for one in table} == {"ok"}
    return np.array([one["joints"] for one in table])


def lift(data: str, *options: str) -> np.ndarray:
    """[F,14,3] in metres, of CSV whose every line can be lifted."""
    result = run(data, *options)
    table = [line.split(",") for line in result.stdout.decode().splitlines()]
    assert result.returncode == 0 and {row[0] for row in table} == {"ok"}
    return np.array([row[1:43] for row in table], float).reshape(-1, 14, 3)


def millimetres(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distances of joints."""
    return 1000 * np.linalg.norm(a - b, axis=-1)


def warnings(result: subprocess.CompletedProcess) -> list[str]:
    start = "lift_stdin: warning: "
    lines = result.stderr.decode().splitlines()
    return [line.removeprefix(start) for line in lines if line.startswith(start)]


WALKING = joints(answers("\n".join(map(as_json, WALK))))
A, B = as_json(WALK[0]), as_json(WALK[20])
POINTS = json.dumps(WALK[0].tolist())
OTHERS = json.dumps(WALK[20].tolist())

# ---- Files of detectors ------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["mmpose", "tfjs", "ultralytics", "mediapipe"])
def test_every_detectors_json_gives_the_pose_of_our_own(name: str):
    options = COCO
    if name == "mediapipe":  # has shares of a smaller number of digits
        options = "--format", "blazepose33", "--image", "1080,1920"
    found = joints(answers(case(f"{name}.jsonl"), *options))
    expected = joints(answers(case("own_form.jsonl"), *COCO))
    assert millimetres(found, expected).max() < 0.1


@pytest.mark.parametrize("indent", [None, 0, 2, 4])
def test_lines_of_json_and_documents_are_the_same(indent: int | None):
    lines = [json.loads(line) for line in case("mmpose.jsonl").splitlines()]
    expected = joints(answers(case("mmpose.jsonl"), *COCO))
    for data in (lines, {"meta_info": {"name": "coco"}, "instance_info": lines}):
        table = answers(json.dumps(data, indent=indent), *COCO)
        np.testing.assert_array_equal(joints(table), expected)
        assert [one["frame_id"] for one in table] == list(range(len(lines)))
        assert all("meta_info" not in one and one["bbox_score"] == 0.9 for one in table)


def test_openpose_writes_a_file_a_frame():
    names = "openpose_0.json", "openpose_1_nobody.json", "openpose_2_two.json"
    table = answers(case(*names), "--format", "body25")
    assert [one["status"] for one in table] == ["ok", "nobody", "ok", "ok"]
    assert {one["version"] for one in table} == {1.3}
    assert table[1] == {"version": 1.3, "status": "nobody", "joints": None, "misfit": None}
    two = json.loads(case(names[2]))["people"]
    assert [one["pose_keypoints_2d"] for one in table[2:]] == [
        one["pose_keypoints_2d"] for one in two
    ]
    assert run(case(*names), "--json", "--format", "body25").stderr == b""


def test_alphapose_writes_all_frames_into_one_list():
    table = answers(case("alphapose.json"), *COCO)
    given = json.loads(case("alphapose.json"))
    assert len(joints(table)) == 4
    assert [one.items() <= answer.items() for one, answer in zip(given, table, strict=True)]
    assert [one["image_id"] for one in table] == ["0.jpg", "1.jpg", "1.jpg", "2.jpg"]
    assert [one["idx"] for one in table] == [one["idx"] for one in given]


def test_coco_annotations_are_read_past_images_of_any_number():
    people = json.loads(case("alphapose.json"))
    images = [{"id": n, "file_name": f"{n:012}.jpg", "width": 640} for n in range(20000)]
    data = {"info": {"year": 2017}, "licence": 1, "images": images, "annotations": people}
    table = answers(json.dumps(data | {"categories": [{"keypoints": COCO_NAMES}]}), *COCO)
    expected = joints(answers(case("alphapose.json"), *COCO))
    np.testing.assert_array_equal(joints(table), expected)
    assert {one["licence"] for one in table} == {1} and "info" not in table[0]


LANDMARKS = [{"x": float(x), "y": float(y), "visibility": 1} for x, y, _ in WALK[0]]
OTHER_LANDMARKS = [{"x": float(x), "y": float(y), "z": 0, "c": 1} for x, y, _ in WALK[20]]
FLAT = WALK[0].ravel().tolist()
COLUMNS = dict(zip(("x", "y", "visible"), WALK[0].T.tolist(), strict=True))
X_Y = dict(zip("xy", WALK[0, :, :2].T.tolist(), strict=True))
APART = {"keypoints": WALK[0, :, :2].tolist(), "keypoint_scores": WALK[0, :, 2].tolist()}

ONE_PERSON = {
    "points": WALK[0].tolist(),
    "points in a frame": {"people": [WALK[0].tolist()]},
    "points of two numbers": WALK[0, :, :2].tolist(),
    "objects": LANDMARKS,
    "flat": FLAT,
    "flat, of two numbers": WALK[0, :, :2].ravel().tolist(),
    "columns": {"keypoints": COLUMNS},
    "columns without confidence": {"keypoints": X_Y},
    "columns alone": COLUMNS,
    "columns alone in a list": [COLUMNS],
    "columns alone in a frame": {"people": [X_Y]},
    "scores apart": APART,
    "flat in a list": [FLAT],
    "landmarks": {"landmarks": LANDMARKS},
    "landmark": {"landmark": LANDMARKS},
    "poseLandmarks": {"poseLandmarks": LANDMARKS},
    "list of landmarks": {"pose_landmarks": [LANDMARKS], "z": 1},
    "list of a list of landmarks": [LANDMARKS],
    "openpose": {"people": [{"pose_keypoints_2d": FLAT, "face_keypoints_2d": []}]},
    "poses": {"poses": [{"keypoints": LANDMARKS, "keypoints3D": []}]},
    "predictions": {"predictions": [{"x": 3, "y": 4, "width": 5, "keypoints": LANDMARKS}]},
    "predictions of mmpose": {"predictions": [[APART]]},
    "instance_info": {"instance_info": [{"instances": [APART]}]},
    "array of frames": [{"frame": 1, "people": [FLAT]}],
    "keypoints that are no array elsewhere": {"people": 1, "keypoints": FLAT},
    "deep": {"poses": [[[[[{"keypoints": FLAT}]]]]]},
}  # fmt: skip


@pytest.mark.parametrize("value", ONE_PERSON.values(), ids=ONE_PERSON.keys())
@pytest.mark.parametrize("indent", [None, 1])
def test_one_person_in_every_form(value, indent: int | None):
    np.testing.assert_array_equal(joints(answers(json.dumps(value, indent=indent))), WALKING[:1])


TWO_PEOPLE = {
    "top": [{"keypoints": FLAT}, {"keypoints": OTHER_LANDMARKS}],
    "sets": [WALK[0].tolist(), WALK[20].tolist()],
    "landmarks": {"a": 1, "landmarks": [LANDMARKS, OTHER_LANDMARKS], "worldLandmarks": [[], []]},
    "people": {"a": 1, "people": [FLAT, {"keypoints": OTHER_LANDMARKS}], "b": 2},
    "frames": [{"people": [FLAT]}, {"people": [{"keypoints": OTHER_LANDMARKS}]}],
    "nested": {"predictions": [[{"keypoints": FLAT}], [{"keypoints": OTHER_LANDMARKS}]]},
}


@pytest.mark.parametrize("name", TWO_PEOPLE)
def test_two_people_in_every_form(name: str):
    table = answers(json.dumps(TWO_PEOPLE[name]))
    np.testing.assert_array_equal(joints(table), WALKING[[0, 20]])
    assert all("b" not in one and ("a" in one) == ("a" in TWO_PEOPLE[name]) for one in table)
    if name == "landmarks":
        nobody = answers(json.dumps({"a": 1, "landmarks": [LANDMARKS, []]}))[1]
        assert nobody == {"a": 1, "status": "nobody", "joints": None, "misfit": None}
        assert [one["keypoints"] for one in table] == [LANDMARKS, OTHER_LANDMARKS]


@pytest.mark.parametrize("value", [[], None, {"people": []}, {"instances": None}, {"keypoints": []},
                                   {"pose_landmarks": []}, {"predictions": [[]]}])  # fmt: skip
def test_nobody(value):
    (one,) = answers(json.dumps(value))
    own = (
        value
        if isinstance(value, dict) and not {"people", "instances", "predictions"} & set(value)
        else {}
    )
    assert one == own | {"status": "nobody", "joints": None, "misfit": None}


def test_members_of_the_frame_stand_before_the_persons_unless_it_has_them():
    frame = {
        "a": 1,
        "t": 0.5,
        "tags": [1],
        "id": "frame",
        "people": [{"id": 7, "keypoints": FLAT}],
        "z": 1,
    }
    result = run(json.dumps(frame), "--json")
    expected = f'{{"a": 1,"t": 0.5,"id": 7, "keypoints": {json.dumps(FLAT)},"status":"ok",'
    assert result.stdout.decode().startswith(expected)


@pytest.mark.parametrize(
    "of_frame, own",
    [
        ("id", "id"),
        ("id", "\\u0069d"),
        ("\\u00e9\\n\\/", "\N{LATIN SMALL LETTER E WITH ACUTE}\\u000A/"),
        ("\\uD83D\\uDE00", "\N{GRINNING FACE}"),
    ],
)
def test_names_are_the_same_however_they_are_escaped(of_frame: str, own: str):
    frame = f'{{"{of_frame}": 1, "people": [{{"{own}": 2, "keypoints": {json.dumps(FLAT)}}}]}}'
    pairs = json.loads(run(frame, "--json").stdout, object_pairs_hook=list)
    assert [value for name, value in pairs if name == json.loads(f'"{own}"')] == [2]


def test_an_escaped_name_is_read():
    text = json.dumps({"keypoints": FLAT}).replace("keyp", "\\u006Beyp")
    np.testing.assert_array_equal(joints(answers(text)), WALKING[[0]])


def test_a_frames_members_are_its_own():
    (one,) = answers(json.dumps({"a": 1, "instance_info": [{"b": 2, "keypoints": FLAT}]}))
    assert "a" not in one and one["b"] == 2
    inner = {"b": 2, "people": [FLAT]}
    table = answers(json.dumps({"a": 1, "poses": [inner, {"keypoints": FLAT}]}))
    assert [("a" in one, "b" in one) for one in table] == [(False, True), (True, False)]


# ---- Names of keypoints ------------------------------------------------------------------------


def test_named_keypoints_are_placed_by_their_names():
    lines = [json.loads(line) for line in case("tfjs.jsonl").splitlines()]
    for line in lines:
        line["keypoints"].reverse()
    found = joints(answers("\n".join(map(json.dumps, lines)), *COCO))
    np.testing.assert_array_equal(found, joints(answers(case("tfjs.jsonl"), *COCO)))


@pytest.mark.parametrize(
    "changed, wrong",
    [
        ({0: "snout"}, 'coco17 has no keypoint "snout"'),
        ({0: None}, "only some"),
        ({16: None}, "only some keypoints have a name"),
        ({0: "left_eye"}, "two keypoints have the same name"),
    ],
)
def test_wrong_names_are_a_bad_line(changed: dict, wrong: str):
    line = json.loads(case("tfjs.jsonl").splitlines()[0])
    for n, name in changed.items():
        line["keypoints"][n] = {"x": 1, "y": 2} | ({"name": name} if name else {})
    result = run(json.dumps(line), "--json", *COCO)
    assert result.returncode == 1 and wrong in result.stderr.decode()


def test_a_format_without_names_takes_keypoints_by_order():
    named = [point | {"name": f"point {n}"} for n, point in enumerate(LANDMARKS)]
    table = answers(json.dumps({"keypoints": named}), "--format", "cpm14")
    plain = answers(json.dumps({"keypoints": LANDMARKS}), "--format", "cpm14")
    np.testing.assert_array_equal(joints(table), joints(plain))


# ---- What is wrong ------------------------------------------------------------------------------

BAD = {
    "score of another number": ({**APART, "keypoint_scores": [1]}, "keypoint_scores are not"),
    "scores null": ({**APART, "keypoint_scores": None}, "keypoint_scores are not"),
    "scores of several people": ({"landmarks": [FLAT, FLAT], "keypoint_scores": [1] * 14},
                                 "has keypoint_scores beside several people"),
    "columns of other lengths": ({"keypoints": X_Y | {"y": [1]}}, "arrays x and y"),
    "columns without y": ({"keypoints": {"x": [1] * 14}}, "arrays x and y"),
    "columns, 15": ({"keypoints": {"x": [1] * 15, "y": [1] * 15}}, "15 keypoints, but a pose has"),
    "flat with text": ({"keypoints": [*FLAT[:-1], "1"]}, "not all numbers"),
    "object without y": ({"keypoints": [{"x": 1}, *LANDMARKS[1:]]}, "keypoint 0 is not"),
    "object with text": ({"keypoints": [*LANDMARKS[1:], {"x": 1, "y": "2"}]}, "keypoint 13 is not"),
    "object with x null": ({"keypoints": [*LANDMARKS[1:], {"x": None, "y": 2}]}, "keypoint 13 is"),
    "keypoints twice": ({"keypoints": FLAT, "landmarks": LANDMARKS}, "more than one member"),
    "a person with people": ({"keypoints": FLAT, "people": [FLAT]}, "more than one member"),
    "a number among people": ({"people": [FLAT, 1]}, "not a person"),
    "numbers for people": ({"people": [1, 2]}, "2 numbers, but a pose has 28 or 42"),
    "a word among people": ({"people": ["you"]}, "not a person"),
    "null among people": ({"people": [None, {"keypoints": FLAT}]}, "not a person: null"),
    "no person": ({"people": [{"name": "you"}]}, 'has no member "keypoints"'),
    "no keypoints": ({"keypoints": True}, "keypoints is not an array"),
    "a member of the answer": ({"joints": 1, "people": [FLAT]}, "which the answer adds"),
}  # fmt: skip


@pytest.mark.parametrize("value, wrong", BAD.values(), ids=BAD.keys())
def test_bad_people_are_named_and_shift_nothing(value, wrong: str):
    result = run(f"{A}\n{json.dumps(value)}\n{B}\n", "--json")
    first, *bad, last = objects(result)
    assert result.returncode == 1 and result.stderr.decode().startswith("lift_stdin: line 2: ")
    assert wrong in result.stderr.decode() and "bad_line" in {one["status"] for one in bad}
    np.testing.assert_array_equal(joints([first, last]), WALKING[[0, 20]])


def test_messages_have_the_line_where_the_person_begins():
    document = json.dumps({"people": [FLAT, {"keypoints": 3}]}, indent=1)
    line = 1 + document[: document.index('{\n   "keypoints')].count("\n")
    result = run(document, "--json")
    assert f"lift_stdin: line {line}: keypoints is not an array" in result.stderr.decode()


MALFORMED = {
    "cut in a line": (A[:-1], 3),
    "behind": (A + ",", 3),
    "in a string": ('{"a": "', 3),
    "comment": ('{"a": 1} // why', 3),
    "quotes": ("{'keypoints': []}", 3),
    "NaN": ('{"keypoints": [[NaN, 1, 0]]}', 3),
    "words": ("Traceback (most recent call last):", 3),
    "a document": ('{\n "people": [\n  [1, 2,\n  }', 3),
    "a document cut": ('{\n "people": [\n  {"a": 1}', 3),
    "at a bracket": ('{\n "people": [1 2\n]\n}', 3),
}  # fmt: skip


@pytest.mark.parametrize("bad, line", MALFORMED.values(), ids=MALFORMED.keys())
def test_reading_goes_on_behind_what_is_no_json(bad: str, line: int):
    result = run(f"{A}\n\n{bad}\n{B}\n{A}", "--json")
    table = objects(result)
    assert [one for one in table if one["status"] == "bad_line"]
    assert f"lift_stdin: line {line}: not JSON" in result.stderr.decode()
    assert (table[-2]["status"], table[-1]["status"]) == ("ok", "ok")
    np.testing.assert_array_equal(joints(table[-2:]), WALKING[[20, 0]])


def test_people_of_a_document_that_breaks_off_have_their_answers():
    result = run('{"people": [' + POINTS + "," + OTHERS, "--json")
    assert [one["status"] for one in objects(result)] == ["ok", "ok", "bad_line"]


def test_a_person_and_a_frames_members_have_64_kib():
    """More of a person is a bad line, more of a frame is left out; both end where they end."""
    long = "x" * 70000
    table = objects(run(as_json(WALK[0], a=long) + B, "--json"))
    assert [one["status"] for one in table] == ["bad_line", "ok"] and "a" not in table[0]
    frame = {
        "a": 1,
        "image": long,
        "list": [[]] * 40000,
        "b": 2,
        "people": [FLAT, {"keypoints": FLAT}],
    }
    table = answers(json.dumps(frame))
    assert len(joints(table)) == 2
    assert all(one["a"] == 1 and one["b"] == 2 and "image" not in one for one in table)
    many = {"people": [WALK[0].tolist()] * 700}
    assert len(json.dumps(many)) > 200000 and len(joints(answers(json.dumps(many)))) == 700


@pytest.mark.skipif(not hasattr(os, "wait4"), reason="needs wait4()")
def test_memory_does_not_grow_with_the_input():
    """The most memory in use, KiB: of one pose, and of a document of 40 MB."""
    sizes = []
    for count in (1, 40000):
        with subprocess.Popen(
            [PROGRAM, "--json"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
        ) as process:
            process.stdin.write(b'{"images": [' + b'{"id": 1},' * count + b'{}], "people": [')
            for _ in range(count // 10):
                process.stdin.write(POINTS.encode() + b",\n" + b" " * 9000)
            process.stdin.write(POINTS.encode() + b"]}")
            process.stdin.close()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
        assert status == 0
        sizes.append(usage.ru_maxrss)
    assert sizes[1] < sizes[0] + 1024


def test_a_persons_answer_comes_before_more_is_read():
    """Also within a document, and at its end without the line's."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "bufsize": 0}
    parts = [
        (A, ["ok"]),
        ('[{"frame": 1, "people": [{"keypoints": ' + POINTS + "}", ["ok"]),
        (", " + OTHERS, ["ok"]),
        (', {"keypoints": []}', ["nobody"]),
        (', {"keypoints": 1}', ["bad_line"]),
        ("]}, []", ["nobody"]),
        ("][]", ["nobody"]),
        (A[:-1] + "]", ["bad_line"]),
        ("\n" + A + B, ["ok", "ok"]),
    ]
    with subprocess.Popen([PROGRAM, "--json"], **pipes) as process:
        for part, expected in parts:
            process.stdin.write(part.encode())
            found = [json.loads(process.stdout.readline())["status"] for _ in expected]
            assert found == expected
        process.stdin.close()
        assert process.stdout.read() == b""


# ---- Headings of CSV ---------------------------------------------------------------------------


def table_of(columns: dict[str, object], *, rows: int = 3) -> str:
    """CSV with a heading, of columns [rows]."""
    lines = [",".join(columns)]
    lines += [",".join(str(column[n]) for column in columns.values()) for n in range(rows)]
    return "\n".join(lines) + "\n"


def by_name(names: list[str], keypoints: np.ndarray, axes: tuple[str, ...]) -> dict[str, object]:
    return {
        f"{name}{axis}": [f"{value:.9g}" for value in keypoints[:, n, k]]
        for k, axis in enumerate(axes)
        for n, name in enumerate(names)
    }


JOINT_NAMES = """head neck_base right_shoulder right_elbow right_wrist left_shoulder left_elbow
left_wrist right_hip right_knee right_ankle left_hip left_knee left_ankle""".split()
BY_NUMBER = {
    f"{axis}{n}": [f"{value:g}" for value in WALK[:3, n, k]]
    for n in range(14)
    for k, axis in enumerate("xyc")
}
EXTRA = {"frame": [0, 1, 2], "file": ["a 1.png", "", "nan"]}
HEADINGS = {
    "by number": BY_NUMBER,
    "by number, in capitals and backwards": {k.upper(): v for k, v in reversed(BY_NUMBER.items())},
    "others": EXTRA | BY_NUMBER | {"x": [1, 2, 3], "left_x": [1, 2, 3], "who_": ["a", "b", "c"]},
    "an index without a name": {"": [0, 1, 2]} | BY_NUMBER,
    "by name": by_name(JOINT_NAMES, WALK[:3], ("_x", "_y", "_c")),
    "by name, score": EXTRA | by_name(JOINT_NAMES, WALK[:3], ("_x", "_y", "_score")),
    "by name, confidence": by_name(JOINT_NAMES, WALK[:3], ("_X", "_Y", "_Confidence")),
    "by name, visibility": by_name(JOINT_NAMES, WALK[:3], ("_x", "_y", "_visibility")),
    "no confidence": by_name(JOINT_NAMES, WALK[:3], ("_x", "_y")),
}


@pytest.mark.parametrize("columns", HEADINGS.values(), ids=HEADINGS.keys())
def test_a_heading_says_where_the_columns_are(columns: dict):
    data = table_of(columns)
    for text_ in (
        data,
        "# walk\n\n" + data.replace("\n", "\r\n"),
        "\ufeff" + data.replace(",", " , "),
    ):
        np.testing.assert_array_equal(lift(text_), WALKING[:3])


def test_a_heading_of_a_detectors_names():
    keypoints = np.loadtxt(CASES / "zeros_complete.csv", delimiter=",").reshape(-1, 17, 3)
    data = table_of(by_name(COCO_NAMES, keypoints, ("_x", "_y", "_c")), rows=len(keypoints))
    np.testing.assert_array_equal(lift(data, *COCO), lift(case("zeros_complete.csv"), *COCO))


def test_blank_fields_below_a_heading_were_not_seen():
    for nothing in ("", " ", "nan", "null", "NaN"):
        for axis in "xyc":
            hidden = WALK[:3].copy()
            hidden[1, 4, 2] = 0
            columns = {name: list(column) for name, column in BY_NUMBER.items()}
            columns[f"{axis}4"][1] = nothing
            np.testing.assert_array_equal(
                lift(table_of(columns)), lift("\n".join(map(text, hidden)))
            )


def without(*names: str) -> dict:
    return {name: column for name, column in BY_NUMBER.items() if name not in names}


COCO_COLUMNS = by_name(COCO_NAMES, np.ones((3, 17, 3)), ("_x", "_y", "_c"))
BAD_HEADINGS = {
    "no y": (without("y3"), [], "has no column right_elbow_y or y3"),
    "a confidence too few": (without("c3"), [], "a confidence for some keypoints only"),
    "twice": (BY_NUMBER | by_name(["head"], WALK[:3], ("_x",)), [], "more than one column head_x"),
    "others": ({f"column {n}": [1, 2, 3] for n in range(30)}, [], "x0,y0,c0,x1,... or head_x"),
    "of a detector": (COCO_COLUMNS, [], "a detector's keypoints need --format"),
    "too many": ({f"{a}{n}": [1, 2, 3] for n in range(17) for a in "xy"}, [],
                 "has 17 keypoints, but a pose has 14; formats with 17: coco17"),
    "of no names": ({f"column {n}": [1, 2, 3] for n in range(60)}, ["--format", "body25"],
                    "column x0"),
    "poses": ({"status": ["ok"] * 3} | {f"{a}{n}": [1] * 3 for n in range(14) for a in "xyz"}, [],
                 "is that of poses, which are lifted already"),
}  # fmt: skip


@pytest.mark.parametrize("columns, options, wrong", BAD_HEADINGS.values(), ids=BAD_HEADINGS.keys())
def test_an_unknown_heading_ends_the_program(columns: dict, options: list, wrong: str):
    result = run(table_of(columns), *options)
    assert (result.returncode, result.stdout) == (2, b"")
    assert (
        result.stderr.decode().startswith("lift_stdin: the heading ")
        and wrong in result.stderr.decode()
    )


def test_words_in_the_first_line_are_no_heading():
    result = run(f"Camera 0 is open, good luck\n{text(WALK[0])}\n")
    assert [line.split(b",")[0] for line in result.stdout.splitlines()] == [b"bad_line", b"ok"]


@pytest.mark.parametrize("row, wrong", [
    (",".join(["1"] * 41), "41 fields, but the heading has 42"),
    (",".join(["1"] * 43), "43 fields, but the heading has 42"),
    (",".join([*["1"] * 41, "x"]), "field 42 is not a number"),
    (",".join([*["1"] * 41, "1 2"]), "field 42 is not a number"),
    (" ".join(["1"] * 42), "field 1 is not a number"),
])  # fmt: skip
def test_bad_lines_below_a_heading(row: str, wrong: str):
    heading, first, *_ = table_of(BY_NUMBER).splitlines()
    result = run("\n".join([heading, first, row, first]))
    assert [line.split(b",")[0] for line in result.stdout.splitlines()] == [
        b"ok",
        b"bad_line",
        b"ok",
    ]
    assert f"line 3: {wrong}" in result.stderr.decode()


# ---- What was not seen --------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["zeros_yolo", "zeros_two_columns"])
@pytest.mark.parametrize("fixed", [[], ["--fixed"]])
def test_zeros_with_a_confidence_were_not_seen(name: str, fixed: list[str]):
    found = lift(case(f"{name}.csv"), *COCO, *fixed)
    assert millimetres(found, lift(case("zeros_complete.csv"), *COCO)).mean() < 100


def test_legs_out_of_the_frame_are_not_believed():
    options = "--format", "blazepose33", "--image", "1280,720", "--quality"
    result = run(case("legs_out_of_frame.csv"), *options)
    assert float(result.stdout.decode().split(",")[-1]) < 0.8
    keypoints = np.loadtxt(CASES / "legs_out_of_frame.csv", delimiter=",").reshape(33, 3)
    keypoints[[25, 26, 27, 28], 2] = 0  # knees and ankles
    assert run(text(keypoints), *options).stdout == result.stdout


def test_the_threshold_of_detectors_is_a_tenth():
    keypoints = np.loadtxt(CASES / "zeros_complete.csv", delimiter=",").reshape(-1, 17, 3)[0]
    keypoints[10, 2] = 0.1  # a wrist
    weak = text(keypoints)
    keypoints[10, 2] = 0
    np.testing.assert_array_equal(lift(weak, *COCO), lift(text(keypoints), *COCO))
    keypoints[10, 2] = 0.11
    kept = lift(text(keypoints), *COCO)
    np.testing.assert_array_equal(lift(weak, *COCO, "--threshold", "0"), kept)
    joint = WALK[0].copy()
    joint[4, 2] = 0.001
    np.testing.assert_array_equal(lift(text(joint)), WALKING[:1])


@pytest.mark.parametrize("options", [[], ["--fixed"], ["--camera", "1400,1400,540,960"]])
def test_scores_over_one_are_as_good_as_others(options: list[str]):
    found, expected = (
        lift(case(f"{name}.csv"), *COCO, *options) for name in ("scores_over_one", "scores")
    )
    assert millimetres(found, expected).max() < 0.1


# ---- MoveNet, and mirrors ----------------------------------------------------------------------


@pytest.mark.parametrize("fixed", [[], ["--fixed"]])
def test_movenet_as_it_writes(fixed: list[str]):
    options = "--format", "movenet17", "--image", "1080,1920", *fixed
    expected = lift(case("movenet_right.csv"), *COCO, *fixed)
    off = millimetres(lift(case("movenet_y_x.csv"), *options), expected)
    assert (off.mean() if fixed else off.max()) < 1
    keypoints = np.loadtxt(CASES / "movenet_y_x.csv", delimiter=",").reshape(-1, 17, 3)
    lines = "\n".join(json.dumps({"keypoints": pose.tolist()}) for pose in keypoints)
    flat = "\n".join(json.dumps([pose.ravel().tolist()]) for pose in keypoints)
    for data in (lines, flat):
        np.testing.assert_array_equal(
            joints(answers(data, *options)), lift(case("movenet_y_x.csv"), *options)
        )
    named = [
        [dict(zip("yxc", point, strict=True)) for point in pose.tolist()] for pose in keypoints
    ]
    np.testing.assert_array_equal(joints(answers("\n".join(map(json.dumps, named)), *options)),
                                  lift(case("movenet_y_x.csv"), *options))  # fmt: skip


@pytest.mark.parametrize("size", [(1000, 1600), (1600, 1000), (1000, 1000)])
def test_movenets_shares_are_of_a_padded_square(size: tuple[int, int]):
    """Placed by a camera, where an offset matters."""
    keypoints = np.zeros((len(WALK), 17, 3))
    keypoints[:, [6, 8, 10, 5, 7, 9, 12, 14, 16, 11, 13, 15]] = WALK[:, 2:]
    keypoints[:, 3:5] = WALK[:, :1]
    side = max(size)
    shares = keypoints.copy()
    shares[..., :2] = (keypoints[..., :2] + (side - np.array(size)) / 2)[..., ::-1] / side
    camera = "--camera", "1145,1145,500,500", "--image", "{},{}".format(*size)
    plain, found = (
        run("\n".join(",".join(f"{v:.9g}" for v in pose.ravel()) for pose in poses),
            "--format", name, *camera).stdout.decode().split()
        for poses, name in ((keypoints, "coco17"), (shares, "movenet17"))
    )  # fmt: skip
    assert {line.split(",")[44] for line in plain + found} == {"ok"}
    roots = [np.array([row.split(",")[45:48] for row in lines], float) for lines in (plain, found)]
    np.testing.assert_allclose(*roots, atol=2e-3)


def test_movenet_wants_the_size_of_the_image():
    result = run("", "--format", "movenet17")
    assert result.returncode == 2 and b"--image WIDTH,HEIGHT" in result.stderr
    result = run(case("seventeen_coco.csv"), "--format", "movenet17", "--image", "640,480")
    assert result.returncode == 1 and b"these look like pixels" in result.stderr


@pytest.mark.parametrize("options", [[], ["--fixed"], ["--image", "1080,1920"], ["--track", "30"]])
def test_a_mirrored_image(options: list[str]):
    found, expected = (
        lift(case(f"{name}.csv"), *more, *options)
        for name, more in (("mirrored", ["--mirrored"]), ("not_mirrored", []))
    )
    off = millimetres(found, expected)
    assert (off.mean() if options == ["--fixed"] else off.max()) < 0.1


def test_a_mirrored_image_of_a_detector():
    """A detector calls right what looks like a right side."""
    sides = [0, *(n + 1 if n % 2 else n - 1 for n in range(1, 17))]
    assert COCO_NAMES[sides[3]] == "right_ear" and COCO_NAMES[sides[16]] == "left_ankle"
    keypoints = np.loadtxt(CASES / "seventeen_coco.csv", delimiter=",").reshape(-1, 17, 2)
    mirrored = keypoints[:, sides] * [-1, 1] + [1000, 0]
    found = lift("\n".join(map(text, mirrored)), *COCO, "--mirrored", "--image", "1000,2000")
    plain = lift("\n".join(map(text, keypoints)), *COCO, "--image", "1000,2000")
    assert millimetres(found, plain).max() < 0.1


def test_a_mirrored_image_before_a_camera_needs_its_size():
    result = run("", "--mirrored", "--camera", "1000,1000,500,500")
    assert result.returncode == 2 and b"--image" in result.stderr
    camera = "--camera", "1145,1145,480,500", "--image", "1000,1000"
    mirrored = WALK[:, MIRROR] * [-1, 1, 1] + [1000, 0, 0]
    plain, found = (run("\n".join(map(text, poses)), *camera, *more).stdout.decode().split()
                    for poses, more in ((WALK, []), (mirrored, ["--mirrored"])))  # fmt: skip
    roots = [
        np.array([line.split(",")[45:48] for line in lines], float) for lines in (plain, found)
    ]
    np.testing.assert_allclose(*roots, atol=1e-3)


# ---- Several people in a video -----------------------------------------------------------------


def test_two_people_have_two_steady_tracks():
    """The detector exchanges them in every fifth frame."""
    table = answers(case("two_people.jsonl"), "--track", "30")
    people = [[one for one in table if one["person"] == n] for n in (0, 1)]
    assert len(table) == 78 and all(len(person) == 39 for person in people)
    alone = [json.loads(line) for line in case("two_people.jsonl").splitlines()]
    for person, first in zip(people, alone[0]["people"], strict=True):
        assert [one["frame"] for one in person] == list(range(39))
        hips = np.array([np.array(one["keypoints"])[[8, 11], :2].mean(0) for one in person])
        assert np.linalg.norm(hips[0] - np.array(first)[[8, 11], :2].mean(0)) == 0
        assert np.linalg.norm(np.diff(hips, axis=0), axis=1).max() < 50  # pixels
        lines = "\n".join(json.dumps({"keypoints": one["keypoints"]}) for one in person)
        np.testing.assert_array_equal(joints(answers(lines, "--track", "30")), joints(person))


def frames(ids: str | None, people: list[list[int]], **members) -> str:
    """Frames of people of the walk, 300 pixels apart, with ids or without."""
    return "\n".join(
        json.dumps({"frame": n, **members, "people": [
            {"keypoints": (WALK[n] + [300 * who, 0, 0]).tolist()} | ({ids: who} if ids else {})
            for who in frame
        ]})
        for n, frame in enumerate(people)
    )  # fmt: skip


@pytest.mark.parametrize("ids", ["idx", "track_id", "person_id", "id", None])
def test_tracks_by_id_or_by_the_nearest(ids: str | None):
    table = answers(frames(ids, [[1, 2], [2, 1], [1, 2], [1], [2, 1, 3]]), "--track", "30")
    assert [one["person"] for one in table] == [0, 1, 1, 0, 0, 1, 0, 1, 0, 2]
    tracked = joints(answers("\n".join(map(as_json, WALK[:5])), "--track", "30"))
    first = [one for one in table if one["person"] == 0]
    assert millimetres(joints(first), tracked).max() < 0.1


def test_an_openpose_id_is_a_list_of_one_and_minus_one_is_none():
    for ids in ("[-1]", "-1", "null"):
        data = frames("person_id", [[1, 2], [2, 1]])
        data = data.replace('"person_id": 1', f'"person_id": {ids}')
        data = data.replace('"person_id": 2', f'"person_id": {ids}')
        assert [one["person"] for one in answers(data, "--track", "30")] == [0, 1, 1, 0]
    data = (
        frames("person_id", [[1, 2], [2, 1]])
        .replace('_id": 1', '_id": [5]')
        .replace('_id": 2', '_id": [6]')
    )
    assert [one["person"] for one in answers(data, "--track", "30")] == [0, 1, 1, 0]


def test_the_id_of_an_annotation_is_not_a_persons():
    one = [{"image_id": n, "id": 100 + n, "keypoints": WALK[n].tolist()} for n in range(5)]
    table = answers(json.dumps(one), "--track", "30")
    assert {answer["person"] for answer in table} == {0}
    np.testing.assert_array_equal(
        joints(table), joints(answers("\n".join(map(as_json, WALK[:5])), "--track", "30"))
    )


def test_people_of_one_image_are_one_frame():
    places = [(n, who, WALK[n] + [300 * who, 0, 0]) for n in range(5) for who in (0, 1)]
    people = [{"image_id": n, "idx": who, "keypoints": at.tolist()} for n, who, at in places]
    table = answers(json.dumps(people), "--track", "30")
    assert [one["person"] for one in table] == [0, 1] * 5
    expected = joints(answers("\n".join(map(as_json, WALK[:5])), "--track", "30"))
    np.testing.assert_array_equal(joints(table[0::2]), expected)


def test_a_track_that_is_not_fed_for_a_second_ends():
    gap = [[1], [1], *[[2]] * 31, [1]]
    table = answers(frames("id", gap), "--track", "30")
    assert [one["person"] for one in table] == [0, 0, *[1] * 31, 2]
    table = answers(frames("id", gap), "--track", "60")
    assert [one["person"] for one in table][-1] == 0


def test_sixteen_people_have_tracks_at_a_time():
    people = [{"id": n, "keypoints": WALK[0].tolist()} for n in range(18)]
    table = answers(json.dumps({"people": people}), "--track", "30")
    assert [one["status"] for one in table] == ["ok"] * 16 + ["too_many_people"] * 2
    assert [one["person"] for one in table] == [*range(16), None, None]


def test_someone_who_is_refused_takes_no_track():
    hidden = WALK[0].copy()
    hidden[:, 0] += 400
    hidden[:8, 2] = 0
    lines = "\n".join(json.dumps({"people": [hidden.tolist(), one.tolist()]}) for one in WALK[:30])
    table = answers(lines, "--track", "30")
    assert [one["person"] for one in table] == [None, 0] * 30
    assert {one["status"] for one in table[0::2]} == {"too_few_joints"}


def test_a_lone_person_has_one_track_whatever_its_id():
    lines = "\n".join(as_json(pose, id=n) for n, pose in enumerate(WALK))
    table = answers(lines, "--track", "30")
    assert all("person" not in one for one in table)
    np.testing.assert_array_equal(
        joints(table), joints(answers("\n".join(map(as_json, WALK)), "--track", "30"))
    )


def test_times_stand_before_the_people():
    data = "\n".join(
        json.dumps({"t": n / 30, "people": [pose.tolist()]}) for n, pose in enumerate(WALK[:9])
    )
    found = joints(answers(data, "--track", "t"))
    expected = joints(answers("\n".join(map(as_json, WALK[:9])), "--track", "30"))
    assert millimetres(found, expected).max() < 1
    result = run(json.dumps({"people": [FLAT], "t": 1}), "--json", "--track", "t")
    assert result.returncode == 1 and b"has no t" in result.stderr


def test_the_number_of_a_person_is_the_answers_only_in_a_list():
    line = as_json(WALK[0], person=3)
    assert answers(line, "--track", "30")[0]["person"] == 3
    assert answers(f"[{line}]")[0]["person"] == 3
    assert b'has a member "person"' in run(f"[{line}]", "--json", "--track", "30").stderr


# ---- Likely mistakes ---------------------------------------------------------------------------


def test_right_input_has_no_warning():
    for data, options in (
        ("\n".join(map(text, WALK)), []),
        (case("seventeen_coco.csv"), COCO),
        (case("movenet_y_x.csv"), ["--format", "movenet17", "--image", "1080,1920"]),
        (case("zeros_yolo.csv"), COCO),
    ):
        assert run(data, *options).stderr == b""
    assert run(case("times_seconds.jsonl"), "--json", "--track", "t").stderr == b""
    assert warnings(run(case("times_doubled.jsonl"), "--json", "--track", "t")) == []


def test_y_before_x():
    data = "\n".join(text(pose[:, [1, 0, 2]]) for pose in WALK)
    (warning,) = warnings(run(data))
    assert (
        "is y before x" in warning and "movenet17" in warning and "camera is on its side" in warning
    )
    assert warnings(run("\n".join(data.splitlines()[:4]))) == []


def test_shares_for_pixels():
    (warning,) = warnings(run("\n".join(text(pose * [1e-3, 1e-3, 1]) for pose in WALK)))
    assert "within 0 and 1" in warning and "Multiply x by its width" in warning
    assert "within 0 and 1" in "".join(warnings(run(case("movenet_y_x.csv"), *COCO)))


def test_the_wrong_order_of_keypoints():
    (warning,) = warnings(run(case("seventeen_coco.csv"), "--format", "h36m17_right_first"))
    assert "quality under 0.2" in warning and "--format" in warning
    assert warnings(run(case("seventeen_h36m.csv"), "--format", "h36m17_right_first")) == []
    (warning,) = warnings(
        run(case("seventeen_coco.csv"), "--format", "h36m17_right_first", "--fixed")
    )


def test_milliseconds_for_seconds():
    (warning,) = warnings(run(case("times_ms.jsonl"), "--json", "--track", "t"))
    assert "milliseconds" in warning
    assert warnings(run(case("times_ms.jsonl"), "--json", "--track", "30")) == []


def test_every_format_of_the_library_is_listed():
    listed = run("", "--list-formats").stdout.decode().split()
    assert dict(zip(listed[0::2], map(int, listed[1::2]), strict=True)) == dict(FORMATS)
