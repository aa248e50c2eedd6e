"""`edmlift lift` and lift_stdin give the same answers to what detectors write."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from package_support import LIFT_STDIN, ROOT, WALK, need_library, need_lift_stdin

import edmlift
from edmlift import cli
from edmlift.joints import JOINTS

CASES = ROOT / "tests" / "python" / "cases"
PORTRAIT = "--image 1080,1920"
INPUTS = {
    "openpose_0.json": "--format body25",
    "openpose_1_nobody.json": "--format body25",
    "openpose_2_two.json": "--format body25",
    "alphapose.json": "--format coco17",
    "mmpose.jsonl": "--format coco17",
    "ultralytics.jsonl": "--format coco17",
    "tfjs.jsonl": "--format coco17",
    "mediapipe.jsonl": f"--format blazepose33 {PORTRAIT}",
    "own_form.jsonl": "--format coco17",
    "two_people.jsonl": "",
    "times_ms.jsonl": "",
    "zeros_complete.csv": "--format coco17",
    "zeros_yolo.csv": "--format coco17",
    "zeros_two_columns.csv": "--format coco17",
    "movenet_y_x.csv": f"--format movenet17 {PORTRAIT}",
    "movenet_right.csv": "--format coco17",
    "seventeen_coco.csv": "--format h36m17_right_first",
    "seventeen_h36m.csv": "--format h36m17_left_first",
    "mirrored.csv": f"--mirrored {PORTRAIT}",
    "not_mirrored.csv": "",
    "scores.csv": "--format coco17",
    "scores_over_one.csv": "--format coco17",
    "legs_out_of_frame.csv": "--format blazepose33 --image 1280,720",
}
POSE = WALK[0].round(2).tolist()
FLAT = sum(POSE, [])
OBJECTS = [{"x": x, "y": y, "visibility": c} for x, y, c in POSE]
COLUMNS = {"x": 0, "y": 1, "visible": 2}
NAMED = [{"name": n, "x": x, "y": y} for n, (x, y, _) in zip(JOINTS, POSE, strict=True)]


def person(points: object, name: str = "keypoints", **members: object) -> dict[str, object]:
    return {**members, name: points}


# Values of JSON and what is wrong with some; each is a line.
VALUES: dict[str, object] = {
    "flat": person(FLAT),
    "flat of two": person(sum((p[:2] for p in POSE), [])),
    "objects": person(OBJECTS, "landmarks"),
    "lists": person({name: [p[n] for p in POSE] for name, n in COLUMNS.items()}),
    "names": person(NAMED[::-1]),
    "unknown name": person([NAMED[0] | {"name": "tail"}, *NAMED[1:]]),
    "no name": person([*NAMED[:13], OBJECTS[13]]),
    "name twice": person([NAMED[1], *NAMED[1:]]),
    "null": None,
    "nobody": [],
    "empty frame": {"t": 3, "a": [1], "people": [], "b": 1},
    "frame of null": {"t": 3, "poses": None},
    "nobody of our own": person([], id=3),
    "bare": POSE,
    "bare and flat": FLAT,
    "bare people": [POSE, FLAT, OBJECTS],
    "people": {"t": 3, "id": 1, "s": "\N{SNOWMAN}", "people": [person(POSE, id=5), person(FLAT)]},
    "bad one among people": {"people": [person(POSE), person(POSE[:13], id=5), person(POSE)]},
    "no person among people": {"people": [person(POSE), {"id": 5}]},
    "landmarks of several": {"t": 1, "landmarks": [OBJECTS, OBJECTS[::-1]]},
    "frames": {"meta_info": {}, "instance_info": [{"frame_id": n, "instances": [person(POSE)]}
                                                  for n in range(2)]},
    "images": [person(POSE, image_id=1), person(POSE, image_id=1), person(POSE, image_id=2)],
    "document": {"images": [{"id": 1}], "annotations": [person(FLAT, image_id=1, id=9)]},
    "scores": person([p[:2] for p in POSE], keypoint_scores=[p[2] for p in POSE]),
    "scores beside": {**person([p[:2] for p in POSE]), "keypoint_scores": [0.05] * 14},
    "too few scores": person(POSE, keypoint_scores=[1] * 13),
    "41 numbers": person(FLAT[:41]),
    "15 keypoints": person([*POSE, [1, 2, 3]]),
    "status": person(POSE, status=1),
    "status of a frame": {"misfit": 1, "people": [person(POSE)]},
    "two names": {"keypoints": POSE, "landmarks": OBJECTS},
    "no keypoints": {"a": 1},
    "zeros": person([[0, 0, 0.9] if n in (3, 4) else p for n, p in enumerate(POSE)]),
    "minus ones": person([[-1, -1, 0.9] if n in (3, 4) else p for n, p in enumerate(POSE)]),
    "nulls": person([*POSE[:3], None, [None, None], *POSE[5:]]),
    "negative": person([[*p[:2], -0.5] if n == 4 else p for n, p in enumerate(POSE)]),
    "infinite": person([[1e999, *p[1:]] if n == 4 else p for n, p in enumerate(POSE)]),
    "box and keypoints": {"predictions": [person(OBJECTS, x=3, y=4)]},
}  # fmt: skip
TEXTS = {
    "one line": "{0}{0} {0}\n",
    "pretty": json.dumps(person(POSE), indent=1) + "\n{0}",
    "an array a line": "[\n{0},\n{0}\n]\n{0}",
    "comments": "# a\n{0}\n  # b\n\n{0}",
    "csv": "1,2,3\n{0}",
    "behind": "{0},\n{0}",
    "cut": '{{"keypoints":[[1,2]\n{0}',
    "fault further on": '{{"a":\n1,\n"b" 2}}\n{0}',
    "nan": '{{"keypoints":[NaN]}}\n{0}',
    "twice": '{{"keypoints":[],"keypoints":[]}}\n{0}',
}
HEADING = ",".join(f"{name}_{a}" for name in reversed(JOINTS) for a in ("y", "x", "score"))
REVERSED = ",".join(f"{p[n]:g}" for p in reversed(POSE) for n in (1, 0, 2))
LINES = {
    "heading": f"frame,{HEADING}\n7,{REVERSED}\n8,{REVERSED},9\n",
    "numbers": ",".join(f"x{n},y{n},c{n}" for n in range(14)) + f"\n{','.join(map(str, FLAT))}\n",
    "index without a name": f",{HEADING}\n7,{REVERSED}\n",
    "words": f"words\n{','.join(map(str, FLAT))}\n",
    "blanks": ",".join(["", "null", "0.9", *map(str, FLAT[3:])]) + "\n",
    "nan confidence": ",".join(["1", "2", "nan", *map(str, FLAT[3:])]) + "\n",
    "trailing comma": ",".join(map(str, FLAT)) + ",\n",
}


@pytest.fixture(autouse=True)
def _programs() -> None:
    need_library()
    need_lift_stdin()
    help_ = subprocess.run([LIFT_STDIN, "--help"], capture_output=True, text=True, check=True)
    if "--mirrored" not in help_.stdout:
        pytest.skip("this lift_stdin does not read what detectors write yet")


def both(data: bytes, options: list[str], path: Path, capfd: pytest.CaptureFixture):
    """Exit status and lines of lift_stdin and of `edmlift lift`."""
    theirs = subprocess.run([LIFT_STDIN, *options], input=data, capture_output=True, timeout=60)
    path.write_bytes(data)
    capfd.readouterr()
    status = cli.main(["lift", str(path), *options])
    ours = capfd.readouterr().out
    return (theirs.returncode, theirs.stdout.decode().splitlines()), (status, ours.splitlines())


def parsed(lines: list[str]) -> list[dict[str, object]]:
    return [json.loads(line) for line in lines]


@pytest.mark.parametrize("fixed", [[], ["--fixed"]], ids=["float", "fixed"])
@pytest.mark.parametrize("name", INPUTS)
def test_inputs(name: str, fixed: list[str], tmp_path: Path, capfd: pytest.CaptureFixture):
    as_json = ["--json"] if name.endswith(("json", "jsonl")) else []
    options = [*as_json, *INPUTS[name].split(), *fixed]
    theirs, ours = both((CASES / name).read_bytes(), options, tmp_path / name, capfd)
    assert ours[0] == theirs[0] == 0 and len(ours[1]) > 0
    if as_json:
        assert parsed(ours[1]) == parsed(theirs[1])
    else:
        assert ours[1] == theirs[1]


@pytest.mark.parametrize("name", VALUES)
def test_values(name: str, tmp_path: Path, capfd: pytest.CaptureFixture):
    text = "\n".join([json.dumps(VALUES[name]).replace("Infinity", "1e999"), json.dumps(POSE)])
    theirs, ours = both(text.encode(), ["--json"], tmp_path / "in.json", capfd)
    assert parsed(ours[1]) == parsed(theirs[1]) and ours[0] == theirs[0]


@pytest.mark.parametrize("name", TEXTS)
def test_texts(name: str, tmp_path: Path, capfd: pytest.CaptureFixture):
    text = TEXTS[name].format(json.dumps(person(POSE))) if name != "pretty" else TEXTS[name]
    text = text.replace("{0}", json.dumps(person(POSE)))
    theirs, ours = both(text.encode(), ["--json"], tmp_path / "in.json", capfd)
    assert parsed(ours[1]) == parsed(theirs[1]) and ours[0] == theirs[0]


@pytest.mark.parametrize("name", LINES)
def test_lines(name: str, tmp_path: Path, capfd: pytest.CaptureFixture):
    theirs, ours = both(LINES[name].encode(), [], tmp_path / "in.csv", capfd)
    assert ours == theirs


@pytest.mark.parametrize("score", [0.0999, 0.1, 0.1001, 0.2, 0.3])
def test_the_default_threshold(score: float, tmp_path: Path, capfd: pytest.CaptureFixture):
    keypoints = np.loadtxt(CASES / "seventeen_coco.csv", delimiter=",", max_rows=1).reshape(17, 3)
    keypoints[[8, 10], 2] = score  # the right elbow and wrist
    line = ",".join(f"{v:g}" for v in keypoints.ravel()).encode()
    for options in (["--format", "coco17"], ["--format", "coco17", "--threshold", "0.2"]):
        theirs, ours = both(line, options, tmp_path / "in.csv", capfd)
        assert ours == theirs and ours[1][0].startswith("ok,")


def test_a_folder_is_its_files_one_behind_another(tmp_path: Path, capfd: pytest.CaptureFixture):
    data = [(CASES / name).read_bytes() for name in INPUTS if name.startswith("openpose")]
    for number, one in enumerate(data):
        (tmp_path / f"{number}.json").write_bytes(one)
    options = ["--format", "body25"]
    theirs = subprocess.run(
        [LIFT_STDIN, "--json", *options], input=b"".join(data), capture_output=True, check=True
    )
    assert cli.main(["lift", str(tmp_path), *options]) == 0
    ours = parsed(capfd.readouterr().out.splitlines())
    assert ours == parsed(theirs.stdout.decode().splitlines())
    assert [one["status"] for one in ours] == ["ok", "nobody", "ok", "ok"]


TRACKED = {
    "two_people.jsonl": "--track 30",
    "alphapose.json": "--track 30 --format coco17",
    "times_seconds.jsonl": "--track t",
    "times_doubled.jsonl": "--track t",
    "times_ms.jsonl": "--track t",
}


def compare_tracks(path: Path, options: list[str]) -> list[int | None]:
    """That track_people() is lift_stdin --track; returns the numbers of people."""
    data = path.read_bytes()
    theirs = subprocess.run(
        [LIFT_STDIN, "--json", *options], input=data, capture_output=True, check=True
    )
    found = edmlift.read_detections(path, "coco17" if "coco17" in options else None)
    people = edmlift.track_people(found, fps=None if "t" in options else 30)
    answers = parsed(theirs.stdout.decode().splitlines())
    answers = [one for one in answers if one["status"] != "nobody"]
    assert [one["status"] for one in answers] == people.status.tolist()
    joints = np.array([one["joints"] for one in answers if one["status"] == "ok"])
    np.testing.assert_allclose(joints, people.joints[people.ok], rtol=1e-5, atol=1e-5)
    numbers = [None if number < 0 else number for number in people.person.tolist()]
    if found.listed.all():
        assert [one["person"] for one in answers] == numbers
    return numbers


@pytest.mark.parametrize("name", TRACKED)
def test_tracks(name: str):
    assert len(compare_tracks(CASES / name, TRACKED[name].split())) > 0


def test_tracks_of_ids_of_who_comes_back_and_of_who_is_refused(tmp_path: Path):
    def at(x: float, **members: object) -> dict[str, object]:
        return person([[p[0] + x, *p[1:]] for p in POSE], **members)

    few = person([[*p[:2], 0.0] if n > 7 else p for n, p in enumerate(POSE)])
    frames = [
        [at(0), at(400)], [at(400), at(0)], [few, at(401)], [], [few], [at(1), at(402), at(-400)],
        *[[at(402)]] * 40, [at(1)], [at(0, track_id=5), at(1, track_id=-1), at(0, track_id=6)],
        [at(0, track_id=6), at(0, track_id=5)], [at(0, idx=5), at(0, idx="5")],
        [at(0, person_id=[9])], [at(0, id=9)], [at(0, id=True)],
    ]  # fmt: skip
    path = tmp_path / "in.jsonl"
    path.write_text("\n".join(json.dumps({"people": frame}) for frame in frames))
    numbers = compare_tracks(path, ["--track", "30"])
    assert numbers[:4] == [0, 1, 1, 0] and len(set(numbers)) > 6
