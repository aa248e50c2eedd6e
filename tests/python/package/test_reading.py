"""What detectors write, read: the people, whose they are, and what is said when it cannot be."""

import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from package_support import ROOT, WALK, need_library

import edmlift
from edmlift import json_values
from edmlift.joints import JOINTS
from edmlift.keypoint_files import Lines, read_lines, read_objects
from edmlift.keypoint_sets import KEYPOINT_NAMES

CASES = ROOT / "tests" / "python" / "cases"
OPENPOSE = ("openpose_0.json", "openpose_1_nobody.json", "openpose_2_two.json")
PORTRAIT = (1080, 1920)


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def read(name: str, format: str | None = None) -> edmlift.Detections:
    return edmlift.read_detections(CASES / name, format)


def lift(name: str, format: str | None = None, **options: Any) -> edmlift.Poses:
    return edmlift.lift(read(name, format).keypoints, format=format, **options)


def furthest(a: edmlift.Poses, b: edmlift.Poses) -> float:
    """The largest distance between joints, mm; both have all poses."""
    assert a.ok.all() and b.ok.all() and len(a.joints)
    return 1000 * float(np.linalg.norm(a.joints - b.joints, axis=-1).max())


def mean(a: edmlift.Poses, b: edmlift.Poses) -> float:
    """The mean distance between joints, mm."""
    assert a.ok.all() and b.ok.all() and len(a.joints)
    return 1000 * float(np.linalg.norm(a.joints - b.joints, axis=-1).mean())


# ---- Whoever wrote it --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "format"),
    [
        ("mmpose.jsonl", "coco17"),
        ("ultralytics.jsonl", "coco17"),
        ("tfjs.jsonl", "coco17"),
        ("mediapipe.jsonl", "blazepose33"),
    ],
)
def test_the_same_poses_as_in_our_own_form(name: str, format: str):
    image = PORTRAIT if format == "blazepose33" else None
    own = lift("own_form.jsonl", "coco17")
    assert furthest(lift(name, format, image=image), own) < 0.1
    assert list(read(name, format).frame) == [0, 1, 2]


def test_a_folder_of_openpose(tmp_path: Path):
    for name in OPENPOSE:
        (tmp_path / name).write_bytes((CASES / name).read_bytes())
    (tmp_path / "notes.txt").write_text("not JSON")
    found = edmlift.read_detections(tmp_path, "body25")
    assert (list(found.frame), found.frames, list(found.empty)) == ([0, 2, 2], 3, [1])
    assert found.person == (None, None, None)  # person_id is -1
    assert found.objects[0]["version"] == 1.3 and found.objects[0]["person_id"] == [-1]
    assert edmlift.lift(found.keypoints, format="body25").ok.all()
    assert repr(found) == "Detections(3 people in 3 frames, 1 of them without people: body25)"


def test_alphapose():
    found = read("alphapose.json", "coco17")
    assert found.image == ("0.jpg", "1.jpg", "1.jpg", "2.jpg")
    assert found.person == (1, 1, 2, 1) and list(found.frame) == [0, 1, 1, 2]
    assert edmlift.lift(found.keypoints, format="coco17").ok.all()


def test_a_coco_document():
    results = json.loads((CASES / "alphapose.json").read_text())
    notes = [result | {"id": n, "num_keypoints": 17} for n, result in enumerate(results)]
    categories = [{"name": "person", "keypoints": list(KEYPOINT_NAMES["coco17"])}]
    document = {"info": {}, "images": [], "annotations": notes, "categories": categories}
    found = edmlift.Detections.of(document, "coco17")
    wanted = read("alphapose.json", "coco17")
    np.testing.assert_array_equal(found.keypoints, wanted.keypoints)
    assert found.image == wanted.image and found.person == wanted.person


def test_a_document_of_mmpose():
    frames = [json.loads(line) for line in (CASES / "mmpose.jsonl").read_text().splitlines()]
    found = edmlift.Detections.of({"meta_info": {}, "instance_info": frames}, "coco17")
    np.testing.assert_array_equal(found.keypoints, read("mmpose.jsonl", "coco17").keypoints)
    assert found.image == (0, 1, 2) and list(found.frame) == [0, 1, 2]


def test_landmarks_of_mediapipe_tasks():
    sets = [json.loads(line)["keypoints"] for line in (CASES / "mediapipe.jsonl").open()]
    result = {"landmarks": sets[:2], "worldLandmarks": [[]], "segmentationMasks": None}
    found = edmlift.Detections.of(
        [result, {"landmarks": []}, {"landmarks": [sets[2]]}], "blazepose33"
    )
    wanted = read("mediapipe.jsonl", "blazepose33")
    np.testing.assert_array_equal(found.keypoints, wanted.keypoints)
    assert list(found.frame) == [0, 0, 2] and list(found.empty) == [1]
    one = edmlift.Detections.of({"poseLandmarks": sets[0], "ea": 3}, "blazepose33")
    np.testing.assert_array_equal(one.keypoints, wanted.keypoints[:1])


def test_boxes_of_people_are_no_keypoints():
    """Roboflow's people have x and y, of their box."""
    points = [{"x": x, "y": y, "confidence": c} for x, y, c in WALK[0].tolist()]
    person = {"x": 320, "y": 240, "width": 9, "height": 9, "keypoints": points}
    found = edmlift.Detections.of({"predictions": [person, person]})
    np.testing.assert_array_equal(found.keypoints, np.float32(WALK[[0, 0]]))


def test_arrays_in_memory():
    for given in (WALK[0], WALK[0].astype(np.float64).tolist(), tuple(map(tuple, WALK[0]))):
        np.testing.assert_array_equal(edmlift.Detections.of(given).keypoints, np.float32(WALK[:1]))
    people = edmlift.Detections.of(WALK[:3])
    assert list(people.frame) == [0, 0, 0]
    frames = edmlift.Detections.of([list(WALK[:2]), [], [WALK[2]]])
    assert list(frames.frame) == [0, 0, 2] and list(frames.empty) == [1]
    pose = {"keypoints": WALK[0, :, :2], "keypoint_scores": WALK[0, :, 2], "score": np.float32(1)}
    np.testing.assert_array_equal(edmlift.Detections.of([pose]).keypoints, np.float32(WALK[:1]))


def test_names_place_keypoints():
    points = [{"name": n, "x": x, "y": y} for n, (x, y, _) in zip(JOINTS, WALK[0], strict=True)]
    shuffled = random.Random(1).sample(points, 14)
    assert shuffled != points
    found = edmlift.Detections.of({"keypoints": shuffled})
    np.testing.assert_array_equal(found.keypoints[0, :, :2], np.float32(WALK[0, :, :2]))
    for change, problem in (
        ({"name": "tail"}, "no keypoint named 'tail'"),
        ({"name": None}, "keypoint 3 has no name"),
        ({"name": "head"}, "two keypoints are named 'head'"),
    ):
        wrong = [points[n] | (change if n == 3 else {}) for n in range(14)]
        with pytest.raises(ValueError, match=problem):
            edmlift.Detections.of({"keypoints": wrong})
    rng = np.random.default_rng(1)
    unknown = [{"name": f"k{n}", "x": n, "y": rng.uniform()} for n in range(16)]
    assert edmlift.Detections.of(unknown, "mpii16").keypoints.shape == (1, 16, 3)


@pytest.mark.parametrize("format", KEYPOINT_NAMES)
def test_names_are_those_of_the_librarys_formats(format: str):
    layout, names = edmlift.formats.find_format(format), KEYPOINT_NAMES[format]
    assert len(names) == len(set(names)) == layout.keypoints
    assert [names[n] for n in layout.limb] == list(JOINTS[2:])
    assert [names[n] for n in layout.ears] == ["left_ear", "right_ear"]
    assert [names[n] for n in layout.face] == ["left_eye", "right_eye", "nose"]


# ---- Cases -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["zeros_yolo.csv", "zeros_two_columns.csv"])
def test_zeros_with_a_confidence_were_not_seen(name: str):
    complete, found = lift("zeros_complete.csv", "coco17"), lift(name, "coco17")
    assert mean(found, complete) < 100  # 216 where they are places
    assert not found.seen[:, [3, 4]].any() and found.seen.sum() == 12 * len(found.seen)


def test_movenet_as_it_comes():
    found = lift("movenet_y_x.csv", "movenet17", image=PORTRAIT)
    assert furthest(found, lift("movenet_right.csv", "coco17")) < 1 and found.warnings == ()
    with pytest.raises(ValueError, match="'movenet17' are normalised: give the image's size"):
        lift("movenet_y_x.csv", "movenet17")


def test_shares_are_no_pixels():
    (warning,) = lift("movenet_y_x.csv", "coco17").warnings
    assert "all keypoints are within 0 and 1" in warning and "movenet17" in warning


def test_y_before_x_is_said():
    assert edmlift.lift(WALK).warnings == ()
    swapped = WALK[..., [1, 0, 2]]
    (warning,) = edmlift.lift(swapped).warnings
    assert "horizontal" in warning and "movenet17" in warning and "on its side" in warning
    assert edmlift.lift(swapped[:4]).warnings == ()
    assert edmlift.track(swapped, fps=30).warnings == (warning,)


def test_another_order_is_said():
    (warning,) = lift("seventeen_coco.csv", "h36m17_right_first").warnings
    assert "quality under 0.2" in warning and "coco17" in warning
    for name, format in (("coco", "coco17"), ("h36m", "h36m17_right_first")):
        assert lift(f"seventeen_{name}.csv", format).warnings == ()


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("image", [None, PORTRAIT])
def test_a_selfie(image: tuple[int, int] | None, fixed: bool):
    found = lift("mirrored.csv", mirrored=True, image=image, fixed=fixed)
    wanted = lift("not_mirrored.csv", image=image, fixed=fixed)
    assert furthest(found, wanted) < (0.5 if fixed else 0.1)  # fixed point rounds elsewhere
    assert furthest(lift("mirrored.csv", fixed=fixed), found) > 100


def test_a_selfie_of_a_detector_a_video_and_a_camera():
    keypoints = edmlift.read_keypoints(CASES / "mediapipe.jsonl", "blazepose33")
    mirror = keypoints.copy()
    mirror[..., 0] = 1 - mirror[..., 0]
    pairs = [(1, 4), (2, 5), (3, 6), (7, 8), (9, 10), *((n, n + 1) for n in range(11, 33, 2))]
    for pair in pairs:
        mirror[:, pair] = mirror[:, pair[::-1]]
    options = {"format": "blazepose33", "image": PORTRAIT}
    plain = edmlift.lift(keypoints, **options)
    assert furthest(edmlift.lift(mirror, mirrored=True, **options), plain) < 0.1
    np.testing.assert_allclose(
        edmlift.adapt(mirror, mirrored=True, **options), edmlift.adapt(keypoints, **options),
        atol=1e-3,
    )  # fmt: skip
    tracked = edmlift.track(mirror, fps=30, mirrored=True, **options)
    assert furthest(tracked, edmlift.track(keypoints, fps=30, **options)) < 0.1
    camera = (1500, 1500, 540, 960)
    seen = edmlift.lift(mirror, mirrored=True, camera=camera, **options)
    assert furthest(seen, edmlift.lift(keypoints, camera=camera, **options)) < 0.1
    with pytest.raises(ValueError, match="mirrored= with camera= needs image="):
        edmlift.lift(WALK, mirrored=True, camera=camera)


def test_scores_over_one():
    assert furthest(lift("scores.csv", "coco17"), lift("scores_over_one.csv", "coco17")) < 0.1
    fixed = [lift(f"scores{n}.csv", "coco17", fixed=True) for n in ("", "_over_one")]
    assert furthest(*fixed) < 0.1


# ---- Several people in a video -----------------------------------------------------------------


def test_two_people_in_either_order():
    found = read("two_people.jsonl")
    people = edmlift.track_people(found, fps=30)
    assert people.ok.all() and sorted(set(people.person)) == [0, 1] and people.warnings == ()
    first, second = people.of_person(0), people.of_person(1)
    assert list(first.frame) == list(second.frame) == list(range(39))
    alone = edmlift.track(edmlift.read_keypoints(CASES / "person_alone.csv"), fps=30)
    assert mean(first, alone) < 15
    assert np.abs(np.diff(second.keypoints[:, 8, 0])).max() < 30  # pixels; the other is 400 away
    assert list(people.person[::2]) == [int(n % 5 == 3) for n in range(39)]  # as they are listed


def test_who_is_there_for_one_frame_does_not_smear():
    lines = edmlift.read_keypoints(CASES / "other_person_once.csv")
    people = edmlift.track_people(edmlift.Detections.of([[pose] for pose in lines]), fps=30)
    assert list(np.flatnonzero(people.person)) == [15]
    alone = edmlift.track(edmlift.read_keypoints(CASES / "person_alone.csv"), fps=30)
    after = np.arange(16, 39)
    off = 1000 * np.linalg.norm(people.joints[after] - alone.joints[after], axis=-1).mean(1)
    assert off.max() < 15


def test_ids_are_the_detectors():
    frames = [
        [{"track_id": i, "keypoints": WALK[n] + [400 * (i == 9), 0, 0]} for i in ids]
        for n, ids in enumerate([(7, 9), (9, 7), (7,), (9, 7)])
    ]
    people = edmlift.track_people(edmlift.Detections.of(frames), fps=30)
    assert list(people.person) == [0, 1, 1, 0, 0, 1, 0]
    assert furthest(people.of_person(0), edmlift.track(WALK[:4], fps=30)) < 1e-3


def test_a_track_without_its_person_for_a_second_ends():
    person = {"keypoints": WALK[0]}
    for ids, wanted in (({}, [0, 0, 1]), ({"idx": 5}, [0, 0, 1])):
        frames = [{"t": t, "people": [person | ids]} for t in (0, 0.9, 2)]
        found = edmlift.Detections.of(frames)
        assert list(edmlift.track_people(found).person) == wanted
    many = [{"t": t, "people": [person]} for t in range(0, 50, 10)]
    (warning,) = edmlift.track_people(edmlift.Detections.of(many)).warnings
    assert "no two frames are within a second" in warning


def test_times():
    seconds, doubled = read("times_seconds.jsonl"), read("times_doubled.jsonl")
    assert edmlift.track_people(seconds).warnings == ()
    people = edmlift.track_people(doubled)
    assert list(people.status).count("time") == 2 and people.ok.sum() == 37
    assert not people.person.any()
    (warning,) = edmlift.track_people(read("times_ms.jsonl")).warnings
    assert "seconds" in warning and "another unit" in warning
    times = 1000.0 * np.arange(0, 39) * 30
    (warning,) = edmlift.track(WALK, time_ms=times).warnings
    assert "another unit" in warning


def test_what_track_people_cannot_do():
    with pytest.raises(ValueError, match="needs fps=, or a finite `t`"):
        edmlift.track_people(read("two_people.jsonl"))
    with pytest.raises(ValueError, match="fps must be over 0"):
        edmlift.track_people(read("two_people.jsonl"), fps=0)
    nobody = edmlift.track_people(edmlift.Detections.of([]), fps=30)
    assert nobody.joints.shape == (0, 14, 3) and nobody.person.shape == (0,)


# ---- Nobody, and what cannot be read -----------------------------------------------------------

POSE = json.dumps({"keypoints": WALK[0].tolist()})


def lines_of(text: str | bytes, format: str | None = None) -> Lines:
    data = text if isinstance(text, bytes) else text.encode()
    return read_lines(data, format, True, "in.json")


@pytest.mark.parametrize(
    ("text", "members"),
    [
        ("[]", {}),
        ("null", {}),
        ('{"version": 1.3, "people": []}', {"version": 1.3}),
        ('{"t": 1, "x": [1], "poses": null, "b": 2}', {"t": 1}),
        ('{"id": 7, "keypoints": [], "b": 2}', {"id": 7, "keypoints": [], "b": 2}),
        ('{"id": 7, "landmarks": null}', {"id": 7, "landmarks": None}),
    ],
)
def test_nobody(text: str, members: dict[str, Any]):
    lines = lines_of(f"{text}\n{POSE}")
    assert lines.nobody == {0} and not lines.problems and list(lines.frames) == [0, 1]
    assert lines.objects[0] == members


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ('{"people": [null]}', "1 keypoints, but a pose has 14"),
        ('{"people": [7]}', "1 numbers, but a pose has 28 or 42"),
        ('{"people": [{"score": 1}]}', 'no member "keypoints"'),
        ('{"people": 7}', 'no member "keypoints"'),
        ('{"people": [], "keypoints": []}', 'has "people" and "keypoints"'),
        ('{"keypoints": [[[1, 2]], [[1, 2]]], "keypoint_scores": [1]}', "beside several people"),
        ('{"keypoints": {"x": [1], "y": [1, 2]}}', "differ in length"),
        ('{"keypoints": {"x": [1], "y": [2]}}', "1 keypoints, but a pose has 14"),
        ('{"keypoints": 7}', "keypoints is not an array"),
        ('{"keypoints": [{"x": 1}]}', "1 keypoints, but"),
    ],
)
def test_what_is_wrong_is_said(text: str, problem: str):
    lines = lines_of(f"{text}\n{POSE}")
    assert list(lines.problems) == [0] and problem in lines.problems[0]
    assert lines.where(0) == "in.json:1" and lines.where(1) == "in.json:2"


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (lambda p: {"keypoint_scores": [1] * 13, **p}, "13 keypoint_scores of 14 keypoints"),
        (lambda p: {"keypoint_scores": ["1"] * 14, **p}, "not an array of numbers"),
        (
            lambda p: {"keypoints": sum(p["keypoints"], [])[:41]},
            "41 numbers, but a pose has 28 or",
        ),
        (lambda p: {"keypoints": [*p["keypoints"][:13], {"x": 1}]}, "keypoint 13 is not null"),
        (lambda p: {"keypoints": [*p["keypoints"][:13], {"x": 1, "y": None}]}, "keypoint 13"),
        (lambda p: {"keypoints": [*p["keypoints"][:13], [None, 1]]}, "keypoint 13"),
        (lambda p: {"keypoints": [*p["keypoints"][:13], [1, 2, None]]}, "keypoint 13"),
    ],
)
def test_a_bad_keypoint_is_named(change: Any, problem: str):
    (found,) = lines_of(json.dumps(change(json.loads(POSE)))).problems.values()
    assert problem in found


def test_a_wrong_count_names_formats_that_fit():
    lines = lines_of(json.dumps({"keypoints": [[1, 2]] * 17}))
    assert lines.problems[0] == (
        "17 keypoints, but a pose has 14; formats with 17 keypoints: coco17, movenet17, "
        "h36m17_right_first, h36m17_left_first: name one"
    )
    assert (
        "formats with 25 keypoints: body25, body25b"
        in lines_of(json.dumps({"people": [{"pose_keypoints_2d": [1.0] * 75}]}), "coco17").problems[
            0
        ]
    )


def test_values_follow_one_another_with_and_without_line_ends():
    pretty = json.dumps(json.loads(POSE), indent=1)
    lines = lines_of(
        f"\ufeff# a comment\n{POSE}{POSE} {pretty}\n  # another\n\n[{POSE},\n{POSE}]\n"
    )
    assert not lines.problems and len(lines.numbers) == 5
    ends = pretty.count("\n")
    assert list(lines.numbers) == [2, 2, 2, 5 + ends, 5 + ends]
    assert list(lines.frames) == [0, 1, 2, 3, 3]


@pytest.mark.parametrize(
    ("text", "statuses"),
    [
        ("1,2,3\nP", "xP"),  # CSV
        ("{}P", "xP"),
        ("P,\nP", "PxP"),
        ('{"a": \n1,\n"b" 2}\nP\n', "xP"),  # the fault is in line 3: go on at the next {
        ('{"keypoints": [[1, 2]\nP', "xP"),  # cut: the fault is where the next begins
        ("[\nP,\nP,\nP", "xP"),  # never closed, as the last line shows
        ("[\nP\nP]\nP", "xPxP"),  # a comma is missing before line 3
        ('{"a": "\n"}\nP', "xxP"),  # a line end in a string
        ('{"keypoints": [NaN]}P\nP', "xP"),
        ("[" * 50000 + "\nP", "xP"),
        (b'{"a": "\xff"}\nP', "xP"),
        (b"\0\nP", "xP"),
    ],
)
def test_where_reading_goes_on(text: str | bytes, statuses: str):
    data = text if isinstance(text, bytes) else text.encode()
    lines = lines_of(data.replace(b"P", POSE.encode()))
    found = ["x" if n in lines.problems else "P" for n in range(len(lines.numbers))]
    assert "".join(found) == statuses


def test_a_fault_further_on_is_named_by_both_lines():
    lines = lines_of('\n{"a":\n1,\n"b" 2}')
    assert lines.where(0) == "in.json:2"
    assert lines.problems[0].endswith("(NaN and Infinity are not JSON); see line 4")


def test_members_of_the_frame_and_the_person():
    frame = {"t": 2, "note": [1], "id": 1, "instances": [{"id": 5, **json.loads(POSE)}], "z": 0}
    (members,) = edmlift.Detections.of(frame).objects
    assert list(members) == ["t", "id", "keypoints"] and members["id"] == 5
    with pytest.raises(ValueError, match='has a member "status"'):
        edmlift.Detections.of({"status": "x", "people": [json.loads(POSE)]})


def test_bad_lines_can_be_skipped(tmp_path: Path):
    path = tmp_path / "in.jsonl"
    path.write_text(f"{POSE}\n{{}}\n[]\n{POSE}\n")
    with pytest.raises(edmlift.FileError, match=r'in\.jsonl:2: has no member "keypoints"'):
        edmlift.read_detections(path)
    found = edmlift.read_detections(path, bad_lines="skip")
    assert list(found.frame) == [0, 3] and found.frames == 4 and list(found.empty) == [2]
    with pytest.raises(ValueError, match="'raise' or 'skip'"):
        edmlift.read_detections(path, bad_lines="nan")
    with pytest.raises(edmlift.FileError, match="a folder without files that end in .jsonl"):
        (tmp_path / "empty").mkdir()
        edmlift.read_detections(tmp_path / "empty")


# ---- Headings ----------------------------------------------------------------------------------


def csv(text: str, format: str | None = None) -> Lines:
    return read_lines(text.encode(), format, False, "in.csv")


def columns(pattern: str, names: Any) -> str:
    return ",".join(pattern.format(name) for name in names)


@pytest.mark.parametrize("separator", [",", " , "])
def test_a_heading_says_which_column_is_what(separator: str):
    names = ["frame", *(f"{j}_{a}" for a in ("y", "score", "x") for j in reversed(JOINTS)), "who"]
    values = ["7", *map(str, WALK[0, ::-1, [1, 2, 0]].ravel()), "me"]
    lines = csv(f"# made by hand\n{separator.join(names)}\n{separator.join(values)}\n")
    assert not lines.problems and list(lines.numbers) == [3]
    np.testing.assert_allclose(lines.keypoints[0], WALK[0], rtol=1e-6)


def test_headings_of_numbers_without_confidences_and_in_capitals():
    numbers = ",".join(map(str, range(34)))
    plain = csv(numbers, "coco17").keypoints
    heading = ",".join(f"X{n},Y{n}" for n in range(17))
    np.testing.assert_array_equal(csv(f"{heading}\n{numbers}", "coco17").keypoints, plain)
    heading = ",".join(f"{n}_x,{n}_y" for n in KEYPOINT_NAMES["coco17"])
    np.testing.assert_array_equal(csv(f"{heading}\n{numbers}", "coco17").keypoints, plain)
    np.testing.assert_array_equal(csv(f",{heading}\n0,{numbers}", "coco17").keypoints, plain)


def test_blank_fields_were_not_seen():
    fields = [f"{v:g}" for v in WALK[0].ravel()]
    fields[9:12] = ["", "null", "0.9"]
    fields[12:15] = ["nan", "5", ""]
    (pose,) = csv(",".join(fields)).keypoints
    assert list(edmlift.lift(pose).seen) == [n not in (3, 4) for n in range(14)]


@pytest.mark.parametrize(
    "heading",
    [
        columns("{0}_x,{0}_y", JOINTS[:-1]) + ",tail_x,tail_y",
        columns("{0}_x,{0}_z", JOINTS),
        columns("x{0},y{0}", range(14)) + ",x0",
        columns("x{0},y{0}", range(14)) + ",c0",
        columns("a{0},b{0},c{0}", range(14)),
    ],
)
def test_an_unknown_heading_says_what_is_known(heading: str):
    with pytest.raises(edmlift.FileError, match=r"in\.csv:1: a heading .* x0,y0,c0 .* head_x"):
        csv(f"{heading}\n{','.join('1' * 42)}\n")


def test_poses_are_no_keypoints(tmp_path: Path):
    edmlift.write_poses(tmp_path / "poses.csv", edmlift.lift(WALK), header=True)
    with pytest.raises(edmlift.FileError, match="poses, not keypoints"):
        edmlift.read_keypoints(tmp_path / "poses.csv")


def test_lines_behind_a_heading_have_its_fields():
    heading = columns("x{0},y{0}", range(14)) + ",note"
    lines = csv(f"{heading}\n{'1,' * 28}a\n{'1,' * 27}1\n{'1,' * 27}x,a\n")
    assert lines.problems == {
        1: "28 fields, but the heading has 29",
        2: "field 28 is not a number (commas or blanks separate them)",
    }


# ---- Anything at all ---------------------------------------------------------------------------


def someone(rng: random.Random, mark: int) -> tuple[Any, bool]:
    """A person in one of the forms, head at mark, 1; and whether it is an object."""
    points = WALK[0].tolist()
    points[0] = [mark, 1, 1]
    flat = sum(points, [])
    sets: list[Any] = [points, flat, [{"x": x, "y": y, "c": c} for x, y, c in points]]
    kind = rng.randrange(6)
    if kind < 3:
        if rng.random() < 0.4:
            return sets[kind], False
        name = rng.choice(["keypoints", "landmarks", "poseLandmarks", "pose_keypoints_2d"])
        return {"score": 0.5, name: sets[kind], "other": [1]}, True
    x, y, c = map(list, zip(*points, strict=True))
    if kind == 3:
        return {"keypoints": {"x": x, "y": y, "visible": c}}, True
    if kind == 4:
        return {"keypoints": [p[:2] for p in points], "keypoint_scores": c, "bbox": [[1, 2]]}, True
    named = [{"name": n, "x": x, "y": y} for n, (x, y, _) in zip(JOINTS, points, strict=True)]
    return {"id": 3, "keypoints": rng.sample(named, 14)}, True


def crowd(rng: random.Random, marks: list[int]) -> Any:
    """A value with these people, in one of the forms, however nested."""
    kind = rng.randrange(5)
    if kind == 0 and len(marks) == 1:
        return someone(rng, marks[0])[0]
    people = [someone(rng, mark) for mark in marks]
    if kind == 1 or not marks:
        name = rng.choice(["people", "instances", "poses", "predictions", "annotations"])
        return {"t": 1, name: [one for one, _ in people], "after": {"people": 3}}
    if kind == 2:
        cut = rng.randrange(len(marks) + 1)
        parts = [crowd(rng, marks[:cut]), crowd(rng, marks[cut:])]
        return {"instance_info": parts}
    if kind == 3:
        bare = [one for one, is_object in people if not is_object]
        if len(bare) == len(people):
            return {"landmarks": bare}
    return [one for one, _ in people]


def test_2000_crowds_come_out_whole():
    rng = random.Random(4)
    for turn in range(2000):
        marks = list(range(1, 1 + rng.randrange(6)))
        lines = read_objects(crowd(rng, marks), None)
        assert not lines.problems, (turn, lines.problems)
        people = [n for n in range(len(lines.numbers)) if n not in lines.nobody]
        assert list(lines.keypoints[people, 0, 0]) == marks, turn


def spoil(rng: random.Random, person: Any) -> Any:
    """A person with one thing wrong."""
    points = (
        person
        if isinstance(person, list)
        else next(
            v for k, v in person.items() if "keypoint" in k.lower() or "landmark" in k.lower()
        )
    )
    kind = rng.randrange(4)
    if isinstance(points, dict):
        axis = rng.choice(["x", "y", "visible"])
        points[axis] = [points[axis][:-1], [*points[axis], 1], "x", [{}] * 14][kind]
    elif kind == 0:
        points.pop(rng.randrange(len(points)))
    elif kind == 1:
        points.append(points[0])
    else:
        points[rng.randrange(1, len(points))] = rng.choice(["1", True, [], [[1, 2]], {"a": 1}])
    return person


def test_2000_spoilt_people_are_named_and_no_others():
    rng = random.Random(5)
    for turn in range(2000):
        marks = list(range(1, 2 + rng.randrange(4)))
        people = [someone(rng, mark)[0] for mark in marks]
        bad = rng.randrange(len(people))
        people[bad] = spoil(rng, people[bad])
        lines = read_objects({"people": people}, None)
        assert list(lines.problems) == [bad], (turn, lines.problems, people[bad])
        found = [lines.keypoints[n, 0, 0] for n in range(len(people)) if n != bad]
        assert found == [mark for mark in marks if mark != bad + 1]


def anything(rng: random.Random, depth: int) -> Any:
    """Some JSON value of the words that mean something here."""
    names = ["people", "keypoints", "landmarks", "x", "y", "score", "name", "image_id", "a",
             "instance_info", "keypoint_scores", "t", "id", "visible", "predictions"]  # fmt: skip
    kind = rng.randrange(9 if depth else 5)
    if kind == 5:
        return [anything(rng, depth - 1)] * rng.choice([1, 2, 14, 42])
    if kind > 6:
        return {rng.choice(names): anything(rng, depth - 1) for _ in range(rng.randrange(5))}
    if kind == 6:
        return [anything(rng, depth - 1) for _ in range(rng.randrange(5))]
    return rng.choice([None, True, 1, -2.5, 1e400, "nose", 10**400, float("nan")])


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_3000_values_of_anything_are_read_or_refused():
    rng = random.Random(6)
    for _ in range(3000):
        value = anything(rng, 4)
        lines = read_objects(value, rng.choice([None, "coco17", "mpii16"]))
        for n, points in enumerate(lines.keypoints):
            assert n not in lines.problems or np.isnan(points).all()
            if n in lines.nobody:
                assert not points.any() and n not in lines.problems


def test_3000_files_of_changed_bytes_are_read_or_refused():
    rng = random.Random(7)
    names = (*OPENPOSE, "mmpose.jsonl", "ultralytics.jsonl")
    seeds = [(CASES / name).read_bytes() for name in names]
    bad = 0
    for _ in range(3000):
        data = bytearray(rng.choice(seeds))
        for _ in range(rng.randrange(1, 4)):
            data[rng.randrange(len(data))] = rng.choice(b'[]{}",:\\-0.1eEnu \n\t#\xc3\xa9\0')
        data = data[: rng.choice([len(data), rng.randrange(1, len(data))])]
        lines = read_lines(bytes(data), rng.choice(["body25", "coco17"]), True)
        assert list(lines.frames) == sorted(lines.frames)
        assert list(lines.numbers) == sorted(lines.numbers)
        bad += bool(lines.problems)
    assert 300 < bad < 3000


@pytest.mark.parametrize(
    "bad", ['{"a": NaN}', "[" * 5000, '{"a" 1}', '["text', "[1,", '{"a":\n1 2}']
)
def test_a_fault_costs_no_more_than_its_line(bad: str, monkeypatch: pytest.MonkeyPatch):
    """Before, each was looked for in all of the text that follows."""
    looked_at = []

    def decode_window(decoder: json.JSONDecoder, window: str) -> tuple:
        looked_at.append(len(window))
        return original(decoder, window)

    original = json_values._decode_window
    monkeypatch.setattr(json_values, "_decode_window", decode_window)
    text = f"{bad}\n" * 500
    found = list(json_values.read_values(text.encode()))
    assert found and all(problem for _, _, problem in found[:-1])
    assert sum(looked_at) < 20 * len(text)


def test_values_that_are_nested_deeply_are_one_problem_each():
    text = '{"keypoints":' * 5000 + "\n" + "[1]\n"
    (number, value, problem), after = json_values.read_values(text.encode())
    assert (number, value) == (1, None) and problem == json_values.NOT_JSON
    assert after == (2, [1], "")
