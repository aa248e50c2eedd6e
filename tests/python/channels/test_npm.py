"""The npm package: installed as users do, and run in Node.js; the bits are the library's."""

import base64
import http.server
import json
import re
import shutil
import tarfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builds import need
from support import EXAMPLES, ROOT, need_library

import edmlift
from channels.browser import npm, npm_figures
from channels.version import version
from edmlift import _binding
from edmlift.formats import BY_IMAGE, BY_SQUARE, NOT_NORMALISED, find_format
from reports import markdown
from reports.targets import run

ANSWER = ROOT / "tests" / "channels" / "npm" / "answer.mjs"
SIZE = (1000, 800)  # of pictures, pixels
UP = (0.1, -1.0, 0.2)
W8_GZIPPED = 60_000


# ---- The package -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def tarball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("clang", "wasm-ld")
    (archive,) = npm.build(tmp_path_factory.mktemp("npm"))
    return archive


@pytest.fixture(scope="module")
def project(tarball: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty folder, in which the package is installed."""
    need("node")
    folder = tmp_path_factory.mktemp("project")
    npm.install(tarball, folder)
    shutil.copy(ANSWER, folder)
    return folder


@pytest.mark.slow
def test_the_tarball_has_the_same_bytes_each_time(tarball: Path, tmp_path: Path) -> None:
    (again,) = npm.build(tmp_path)
    assert again.name == tarball.name == f"edmlift-{version()}.tgz"
    assert again.read_bytes() == tarball.read_bytes()


@pytest.mark.slow
def test_the_tarball_has_what_npm_asks_for(tarball: Path) -> None:
    programs = [f"{model}{variant}.wasm" for model in npm.MODELS for variant in npm.VARIANTS]
    with tarfile.open(tarball) as archive:
        assert {entry.mode for entry in archive} == {0o644}
        names = {name.removeprefix("package/") for name in archive.getnames()}
        package = json.load(archive.extractfile("package/package.json"))
    assert names == {*npm.TEXTS, "LICENSE", *programs}
    assert package["version"] == version() and package["license"] == "MIT"
    assert {package["main"], package["types"]} <= {f"./{name}" for name in names}


@pytest.mark.slow
def test_a_page_loads_little(project: Path) -> None:
    for variant in npm.VARIANTS:
        program = project / "node_modules" / "edmlift" / f"direct_w8{variant}.wasm"
        assert npm_figures.gzipped(program) < W8_GZIPPED


@pytest.mark.slow
@pytest.mark.claims("docs/browser.md", "browser_models")
def test_the_page_says_how_large_models_are(project: Path) -> None:
    """Within 3 %, by which compilers differ."""
    folder = project / "node_modules" / "edmlift"
    rows = markdown.read(npm.PAGE, npm_figures.NAME).splitlines()[2:]
    assert len(rows) == len(npm.MODELS)
    for row in rows:
        model, plain_bytes, gzip_bytes = (cell.strip(" `") for cell in row.split("|")[1:4])
        program = folder / f"{model}.wasm"
        sizes = program.stat().st_size, npm_figures.gzipped(program)
        assert sizes == pytest.approx([read_count(plain_bytes), read_count(gzip_bytes)], rel=0.03)


def read_count(text: str) -> int:
    return int(text.replace(",", ""))


@pytest.mark.slow
def test_the_page_shows_the_example_and_what_it_prints(tarball: Path) -> None:
    assert f"```js\n{npm.EXAMPLE.read_text('utf-8')}```" in npm.PAGE.read_text("utf-8")
    npm.check([tarball])


# ---- What it answers ---------------------------------------------------------------------------


def plain(value: Any) -> Any:
    """As JSON has it: lists, and what is not finite as text."""
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, dict):
        return {name: plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}[str(value)]
    return value


def revive(found: dict[str, Any]) -> Any:
    return base64.b64decode(found["base64"]) if "base64" in found else found


def ask(project: Path, *jobs: tuple[dict[str, Any], list[list[Any]]]) -> list[Any]:
    """What the package answers: a list of answers for each job, or an error."""
    text = json.dumps([{"load": load, "calls": plain(calls)} for load, calls in jobs])
    said = run("node", "answer.mjs", cwd=project, input=text)
    return json.loads(said, object_hook=revive)


def floats(data: bytes) -> np.ndarray:
    return np.frombuffer(data, np.float32)


def number(found: Any) -> np.float32:
    return np.float32(float(found))


def assert_pose(found: dict[str, Any], poses: edmlift.Poses, n: int) -> None:
    """A pose of the package is pose n of the library's, bit for bit."""
    assert found["status"] == poses.status[n]
    assert_same(floats(found["joints"]), poses.joints[n].ravel())
    assert_same(floats(found["keypoints"]), poses.keypoints[n].ravel())
    assert_same(number(found["misfit"]), poses.misfit[n])
    assert found["seen"] == poses.seen[n].tolist()


def assert_same(found: Any, wanted: Any) -> None:
    """Same bits, but for those of NaN."""
    found, wanted = np.asarray(found), np.asarray(wanted)
    assert found.dtype == wanted.dtype == np.float32 and found.shape == wanted.shape
    same = found.view(np.uint32) == wanted.view(np.uint32)
    assert (same | np.isnan(found) & np.isnan(wanted)).all()


def joints_of(name: str, count: int) -> np.ndarray:
    """The first poses [count,14,3] of a sample."""
    return np.loadtxt(EXAMPLES / f"{name}.csv", delimiter=",").reshape(-1, 14, 3)[:count]


def some_joints(count: int) -> np.ndarray:
    """Poses [count,14,3]: with all joints, without some, or too many, and some that are none."""
    joints = joints_of("cartwheel", count)
    rng = np.random.default_rng(1)
    for n, pose in enumerate(joints):
        pose[rng.permutation(14)[: n % 7], 2] = 0
    joints[0, 3, 0] = np.inf
    joints[1, :, :2] = 7
    return joints


def keypoints_of(name: str, joints: np.ndarray) -> np.ndarray:
    """Joints [F,14,3] as a detector of this format gives them [F,K,3]; some keypoints are not sure,
    missing or outside the picture."""
    layout = find_format(name)
    rng = np.random.default_rng(len(name))
    found = np.zeros((len(joints), layout.keypoints, 3))
    found[:, :, :2] = joints[:, :1, :2] + rng.normal(0, 10, found[:, :, :2].shape)
    found[:, list(layout.limb), :2] = joints[:, 2:, :2]
    found[..., 2] = rng.random(found.shape[:2]) ** 0.25
    found[0, :2, :2], found[1, 0, :2], found[2, 0] = -1, (0, 0), np.nan
    width, height = SIZE
    side = max(SIZE)
    if layout.normalised == BY_IMAGE:
        found[..., :2] /= SIZE
    if layout.normalised == BY_SQUARE:
        found[..., 0] += (side - width) / 2
        found[..., 1] += (side - height) / 2
        found[..., :2] = found[..., 1::-1] / side
    return found


def as_objects(keypoints: np.ndarray, *names: str) -> list[dict[str, float]]:
    """Keypoints [K,len(names)], each as an object."""
    return [dict(zip(names, keypoint, strict=True)) for keypoint in keypoints.tolist()]


@pytest.mark.slow
@pytest.mark.parametrize("variant", npm.VARIANTS)
def test_every_model_has_the_bits_of_the_library(variant: str, project: Path) -> None:
    need_library()
    joints = some_joints(48)
    calls = [["lift", pose] for pose in joints] + [["liftMany", np.tile(joints, (3, 1, 1)).ravel()]]
    folder = project / "node_modules" / "edmlift"
    jobs = [({"wasm": str(folder / f"{m}{variant}.wasm")}, calls) for m in npm.MODELS]
    for model, (*single, many) in zip(npm.MODELS, ask(project, *jobs), strict=True):
        wanted = edmlift.lift(joints, model)
        statuses = set(wanted.status)
        assert statuses == {"ok", "too_few_joints", "not_finite", "degenerate"}
        quality = edmlift.quality(wanted)
        for n, found in enumerate(single):
            assert_pose(found, wanted, n)
            assert_same(number(found["quality"]), quality[n])
        assert many["count"] == 3 * len(joints)
        assert_same(floats(many["joints"]), np.tile(wanted.joints.ravel(), 3))
        assert [code == 0 for code in many["status"]] == np.tile(wanted.ok, 3).tolist()


OPTIONS = [
    {},
    {"threshold": 0.6},
    {"up": UP},
    {"mirrored": True},
    {"focal": 900},
    {"camera": (900, 910, 480, 410), "mirrored": True},
]


@pytest.mark.slow
@pytest.mark.parametrize("options", OPTIONS, ids=lambda options: "-".join(options) or "plain")
def test_every_format_is_read_as_in_python(options: dict[str, Any], project: Path) -> None:
    need_library()
    given = {"width": SIZE[0], "height": SIZE[1]} | options
    same = {name: value for name, value in options.items() if name != "focal"}
    if "focal" in options:
        same["camera"] = (options["focal"], options["focal"], SIZE[0] / 2, SIZE[1] / 2)
    sets = {name: keypoints_of(name, joints_of("kick", 12)) for name in edmlift.FORMATS}
    calls = [
        ["lift", pose, given | {"format": name}] for name, poses in sets.items() for pose in poses
    ]
    (answers,) = ask(project, ({"model": "direct_w16"}, calls))
    remaining = iter(answers)
    for name, keypoints in sets.items():
        wanted = edmlift.lift(keypoints, "direct_w16", format=name, image=SIZE, **same)
        assert wanted.ok.any()
        for n in range(len(keypoints)):
            assert_pose(next(remaining), wanted, n)


@pytest.mark.slow
def test_keypoints_in_every_form(project: Path) -> None:
    need_library()
    keypoints, square = (
        keypoints_of(name, joints_of("kick", 4))[3] for name in ("coco17", "movenet17")
    )
    objects = [as_objects(keypoints, "x", "y", name) for name in ("score", "visibility", "c")]
    forms = [keypoints, keypoints.ravel(), *objects]
    bare = [keypoints[:, :2], keypoints[:, :2].ravel(), as_objects(keypoints[:, :2], "x", "y")]
    size = {"width": SIZE[0], "height": SIZE[1], "format": "movenet17"}
    flipped = as_objects(square, "y", "x", "score")
    calls = [["lift", form, {"format": "coco17"}] for form in forms]
    calls += [["lift", form, {"format": "coco17", "threshold": 5}] for form in bare]
    calls += [["lift", square, size], ["lift", flipped, size]]
    missing = [*keypoints[:5].tolist(), None, *keypoints[6:].tolist()]
    calls += [["lift", missing, {"format": "coco17"}]]
    (answers,) = ask(project, ({}, calls))
    model = "direct_w8"
    whole = edmlift.lift(keypoints[None], model, format="coco17")
    unsure = edmlift.lift(keypoints[None, :, :2], model, format="coco17", threshold=5)
    shares = edmlift.lift(square[None], model, format="movenet17", image=SIZE)
    assert whole.ok.all() and unsure.ok.all() and shares.ok.all()
    for found in answers[:5]:
        assert_pose(found, whole, 0)
    for found in answers[5:8]:
        assert found["status"] == "ok" and found["joints"] == answers[5]["joints"]
        assert_same(floats(found["joints"]), unsure.joints.ravel())
    for found in answers[8:10]:
        assert_pose(found, shares, 0)
    assert answers[10]["seen"].count(False) >= 1


@pytest.mark.slow
def test_angles(project: Path) -> None:
    need_library()
    joints = some_joints(24)
    calls = [["angles", pose, {}, {"up": UP}] for pose in joints]
    calls += [["angles", pose] for pose in joints]
    (answers,) = ask(project, ({"model": "direct_f32"}, calls))
    poses = edmlift.lift(joints, "direct_f32")
    for part, up in ((answers[: len(joints)], UP), (answers[len(joints) :], None)):
        wanted = edmlift.angles(poses, up)
        for name, values in wanted.items():
            assert_same(np.array([number(found[name]) for found in part]), values)
        assert list(part[0]) == list(edmlift.ANGLES)


TRACKS = [
    ("coco17", {"fps": 30}),
    ("coco17", {"holdBones": 0, "up": UP}),
    ("blazepose33", {"threshold": 0.3, "mirrored": True, "holdBones": 20}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "options"), TRACKS)
def test_a_track(name: str, options: dict[str, Any], project: Path) -> None:
    """With a frame that is empty, of exchanged sides, of another person ...; frames without
    fps have times, of which one comes twice and one late."""
    need_library()
    joints = joints_of("walk", 39)
    joints[20] = joints[20, list(edmlift.MIRROR)]
    joints[24:26, :, 0] -= 350
    walk = keypoints_of(name, joints)
    walk[10], walk[15, -2:] = 0, 0
    ms = np.arange(len(walk)) * 1000 / 30
    if "fps" not in options:
        ms += 1500 * (np.arange(len(walk)) >= 30) - 100.5
        ms[35] = ms[34]
    given = options | {"format": name, "width": SIZE[0], "height": SIZE[1]}
    frames = [[k] if "fps" in options else [k, t] for k, t in zip(walk, ms, strict=True)]
    ((answers,),) = ask(project, ({"model": "distances_w8"}, [["track", given, frames]]))
    same = {key: options[key] for key in ("threshold", "mirrored") if key in options}
    track = edmlift.Track(
        "distances_w8", format=name, image=SIZE, hold_bones=options.get("holdBones", 60), **same
    )
    for n, found in enumerate(answers):
        if "fps" not in options:
            assert_same(number(found["distance"]), np.float32(track.distance(walk[n], ms[n])))
        assert_tracked(found, track.lift(walk[n : n + 1], ms[n : n + 1], options.get("up")))
    assert {"ok", "too_few_joints"} <= {found["status"] for found in answers}
    assert any(found["swapped"]["arms"] for found in answers)
    assert any(found["aside"] for found in answers)
    assert any(any(found["held"]) for found in answers)


def assert_tracked(found: dict[str, Any], wanted: edmlift.Tracked) -> None:
    assert_pose(found, wanted, 0)
    assert found["held"] == wanted.held[0].tolist()
    assert list(found["swapped"].values()) == wanted.swapped[0].tolist()
    assert (found["mirrored"], found["aside"]) == (wanted.mirrored[0], wanted.aside[0])
    assert found["elapsed"] == wanted.elapsed[0]


# ---- Names and types ---------------------------------------------------------------------------


def union(name: str) -> set[str]:
    """The strings of a type of index.d.ts."""
    text = (npm.NPM / "index.d.ts").read_text("utf-8")
    return set(re.findall(r'"(\w+)"', re.search(rf"type {name} =(.*?);", text, re.S)[1]))


@pytest.mark.slow
def test_names_are_those_of_the_library(project: Path) -> None:
    need_library()
    ((names,),) = ask(project, ({}, [["names"]]))
    c = _binding.load()
    assert names["JOINTS"] == list(edmlift.JOINTS)
    assert names["BONES"] == [list(bone) for bone in edmlift.BONES]
    assert names["ANGLES"] == list(edmlift.ANGLES)
    count = len(names["STATUSES"])
    assert names["STATUSES"] == [c.edml_status_name(-n).decode() for n in range(count)]
    assert c.edml_status_name(-count) == b"?"
    assert names["formats"] == {"edmlift14": 14, **edmlift.FORMATS}
    assert (names["model"], names["version"]) == ("direct_w8", version())
    assert {find_format(name).normalised for name in edmlift.FORMATS} == {
        NOT_NORMALISED, BY_IMAGE, BY_SQUARE
    }  # fmt: skip


def test_types_name_what_there_is() -> None:
    need_library()
    assert union("ModelName") == set(npm.MODELS) <= set(edmlift.models())
    assert union("Format") == {"edmlift14", *edmlift.FORMATS}


def test_every_format_has_room() -> None:
    need_library()
    glue = (npm.NPM / "glue.c").read_text("utf-8")
    assert int(re.search(r"KEYPOINTS = (\d+)", glue)[1]) >= max(edmlift.FORMATS.values())


# ---- What is wrong -----------------------------------------------------------------------------

POSE = [[100.0 + 10 * k, 100.0 + k * k, 0.9] for k in range(17)]
COCO = {"format": "coco17"}
WRONG_CALLS = [
    (["lift", POSE], 'format "edmlift14" has 14 keypoints, not 17; these may be of .*coco17'),
    (["lift", POSE[:5], COCO], 'format "coco17" has 17 keypoints, not 5$'),
    (["lift", [1.0] * 35, COCO], 'format "coco17" has 34 or 51 numbers, not 35$'),
    (["lift", {"keypoints": POSE}, COCO], "keypoints must be an array of 17, not"),
    (["lift", [{"position": 1}] * 17, COCO], "keypoint 0 must be { x, y, score }, "),
    (["lift", [*POSE[:16], [1, "2", 1]], COCO], "keypoint 16 must be"),
    (["lift", POSE, {"format": "coco18x"}], 'format "coco18x" is not known; there are edmlift14, '),
    (["lift", POSE, {"format": "movenet17"}], "normalised: give width and height"),
    (["lift", POSE, {"format": "movenet17", "width": 9, "height": 9}], "are in pixels: divide"),
    (["lift", POSE, COCO | {"image": [9, 9]}], r"lift\(\) has no option image; there are format, "),
    (["lift", POSE, COCO | {"width": 9}], "width and height must both be pixels, over 0, not 9"),
    (["lift", POSE, COCO | {"focal": 900}], "focal needs width and height"),
    (["lift", POSE, COCO | {"camera": [1, 2]}], "camera must be fx, fy, cx, cy"),
    (["lift", POSE, COCO | {"camera": [1, 0, 2, 2]}], "fx, fy over 0, not 1,0,2,2"),
    (["lift", POSE, COCO | {"camera": [9, 9, 2, 2], "mirrored": True}], "needs width and height"),
    (["lift", POSE, COCO | {"up": [0, 0, 0]}], "up must be three finite numbers, not all 0"),
    (["lift", POSE, COCO | {"threshold": -1}], "threshold must be a finite number of 0 or more"),
    (["lift", POSE, None], "options of lift.. must be an object, not null"),
    (["liftMany", [1.0] * 50, COCO], 'format "coco17" has 51 numbers a person, and 50 are no'),
    (["angles", POSE, COCO, {"upwards": 1}], "has no option upwards; there are up"),
    (["track", COCO | {"fps": 0}, []], "fps must be over 0 and at most 1000, not 0"),
    (["track", COCO | {"holdBones": 61}, []], "holdBones must be 0 to 60 poses, not 61"),
    (["track", COCO | {"focal": 9}, []], "has no option focal"),
    (["track", COCO, [[POSE]]], "a frame needs its time in milliseconds, or its track fps"),
]  # fmt: skip


@pytest.mark.slow
def test_wrong_calls_are_told_what_is_wrong(project: Path) -> None:
    (answers,) = ask(project, ({}, [call for call, _ in WRONG_CALLS]))
    for (call, pattern), found in zip(WRONG_CALLS, answers, strict=True):
        assert re.search(pattern, found["error"]), (call, found)


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A web server that prints nothing."""

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def served(project: Path) -> Iterator[str]:
    """The address of a web server of the project."""

    def handler(*given: Any) -> Quiet:
        return Quiet(*given, directory=str(project))

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.mark.slow
def test_a_model_is_loaded_from_everywhere(project: Path, served: str) -> None:
    file = project / "node_modules" / "edmlift" / "distances_w16.wasm"
    places = [str(file), file.as_uri(), f"{served}/node_modules/edmlift/distances_w16.wasm"]
    for (found,) in ask(project, *(({"wasm": place}, [["names"]]) for place in places)):
        assert found["model"] == "distances_w16"


@pytest.mark.slow
def test_wrong_files_are_told_what_is_wrong(project: Path, served: str) -> None:
    program = project / "node_modules" / "edmlift" / "direct_w8.wasm"
    damaged = bytearray(program.read_bytes())
    damaged[len(damaged) * 7 // 10] ^= 1  # a weight: they fill half of the file
    (project / "damaged.wasm").write_bytes(damaged)
    (project / "page.wasm").write_text("<!doctype html>")
    (project / "other.wasm").write_bytes(b"\0asm\1\0\0\0")
    wrong = [
        ({"model": "direct"}, r'RangeError: model "direct" is not known; there are direct_w8, '),
        ({"modell": "direct"}, r"load\(\) has no option modell; there are model, wasm"),
        ({"wasm": "nowhere.wasm"}, "wasm cannot be loaded from nowhere.wasm: .*beside index.js"),
        ({"wasm": f"{served}/nowhere.wasm"}, "the server answered 404 .*The .wasm files must"),
        ({"wasm": "page.wasm"}, "is no WebAssembly that can run here"),
        ({"wasm": "other.wasm"}, "is not a file of this package"),
        ({"wasm": "damaged.wasm"}, "is damaged: its weights have another checksum"),
        ({"wasm": {"a": 1}}, r"wasm must be a URL, an answer of fetch\(\), the"),
        ({"wasm": str(program), "model": "direct_f32"}, 'the model "direct_w8", not "direct_f32"'),
    ]  # fmt: skip
    answers = ask(project, *((load, []) for load, _ in wrong))
    for (load, pattern), found in zip(wrong, answers, strict=True):
        assert re.search(pattern, found["error"]), (load, found)
