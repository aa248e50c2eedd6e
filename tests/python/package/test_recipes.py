"""The recipes of docs/detectors.md, examples/python, on what each detector gives.

The detectors' packages are not installed here: in their place stands what they return, with real
detections (examples/data/detections) and documented ones (tests/python/cases) inside.
"""

import json
import re
import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from package_support import DATA, ROOT, need_library

import edmlift

CASES = ROOT / "tests" / "python" / "cases"
RECIPES = sorted((ROOT / "examples" / "python").glob("*.py"))
WIDTH, HEIGHT = 1080, 1920  # of beam1, which the camera's own sizes say as well


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def module(monkeypatch: pytest.MonkeyPatch, name: str, **members: Any) -> ModuleType:
    """A package of this name, which the recipe imports."""
    made = ModuleType(name)
    vars(made).update(members)
    monkeypatch.setitem(sys.modules, name, made)
    return made


def run(name: str) -> dict[str, Any]:
    return runpy.run_path(str(ROOT / "examples" / "python" / f"{name}.py"))


def furthest(a: np.ndarray, b: np.ndarray) -> float:
    """The largest distance between joints, mm."""
    assert a.shape == b.shape and np.isfinite(a).all()
    return 1000 * float(np.linalg.norm(a - b, axis=-1).max())


@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.stem)
def test_the_page_shows_the_recipe(path: Path):
    page = (ROOT / "docs" / "detectors.md").read_text("utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    text = path.read_text("utf-8")
    assert text in blocks and f"(../examples/python/{path.name})" in page
    lines = [line for line in text.splitlines() if line and not line.startswith(('"', "import"))]
    assert len([line for line in lines if not line.startswith("from")]) <= 7


def test_every_recipe_is_tested():
    tested = re.findall(r'run\("(\w+)"\)', Path(__file__).read_text("utf-8"))
    assert {path.stem for path in RECIPES} == set(tested)


def test_movenet(monkeypatch: pytest.MonkeyPatch):
    """A real frame, as the tensor has it."""
    frame = edmlift.read_keypoints(DATA / "detections" / "beam1_thunder.csv", "coco17")[3]
    side = max(WIDTH, HEIGHT)
    shares = (frame[:, :2] + [(side - WIDTH) / 2, (side - HEIGHT) / 2]) / side
    tensor = np.concatenate([shares[:, ::-1], frame[:, 2:]], -1)[None, None]
    output = SimpleNamespace(numpy=lambda: tensor.astype(np.float32))
    model = SimpleNamespace(signatures={"serving_default": lambda given: {"output_0": output}})
    module(monkeypatch, "tensorflow_hub", load=lambda address: model)
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    io = SimpleNamespace(decode_jpeg=lambda data: image, read_file=lambda name: b"")
    pad = SimpleNamespace(resize_with_pad=lambda given, height, width: np.zeros((1, 256, 256, 3)))
    module(monkeypatch, "tensorflow", io=io, image=pad, cast=np.ndarray.astype, int32=np.int32)
    poses = run("movenet")["poses"]
    wanted = edmlift.lift(frame[None], format="coco17", image=(WIDTH, HEIGHT))
    assert poses.ok.all() and furthest(poses.joints, wanted.joints) < 1


def test_blazepose(monkeypatch: pytest.MonkeyPatch):
    """Real frames: each is somebody in the picture."""
    frames = edmlift.read_keypoints(DATA / "detections" / "beam1.csv", "blazepose33")[3:5]

    def landmark(x: float, y: float, visibility: float) -> SimpleNamespace:
        return SimpleNamespace(x=x, y=y, z=0.1, visibility=visibility, presence=visibility)

    found = SimpleNamespace(pose_landmarks=[[landmark(*p) for p in f.tolist()] for f in frames])
    landmarker = SimpleNamespace(
        create_from_model_path=lambda path: SimpleNamespace(detect=lambda image: found)
    )
    image = SimpleNamespace(width=WIDTH, height=HEIGHT)
    module(
        monkeypatch, "mediapipe",
        Image=SimpleNamespace(create_from_file=lambda path: image),
        tasks=SimpleNamespace(vision=SimpleNamespace(PoseLandmarker=landmarker)),
    )  # fmt: skip
    wanted = edmlift.lift(frames, format="blazepose33", image=(WIDTH, HEIGHT))
    assert furthest(run("blazepose")["poses"].joints, wanted.joints) == 0
    found.pose_landmarks = []
    assert run("blazepose")["poses"].joints.shape == (0, 14, 3)


def documented() -> np.ndarray:
    """The poses [3,14,3] of mmpose.jsonl and ultralytics.jsonl, tracked."""
    keypoints = edmlift.read_keypoints(CASES / "own_form.jsonl", "coco17")
    return edmlift.track(keypoints, fps=30, format="coco17").joints


def test_yolo_pose(monkeypatch: pytest.MonkeyPatch):
    """With the ids that its tracker gives."""
    frames = [json.loads(line) for line in (CASES / "ultralytics.jsonl").read_text().splitlines()]
    for frame in frames:
        frame[0]["track_id"] = 4
    results = [SimpleNamespace(summary=lambda frame=frame: frame) for frame in frames]
    model = SimpleNamespace(track=lambda source, stream: iter(results))
    module(monkeypatch, "ultralytics", YOLO=lambda weights: model)
    people = run("yolo_pose")["people"]
    assert list(people.person) == [0, 0, 0]
    assert furthest(people.joints, documented()) < 1e-3


def test_rtmpose(monkeypatch: pytest.MonkeyPatch):
    frames = [json.loads(line) for line in (CASES / "mmpose.jsonl").read_text().splitlines()]
    results = [{"visualization": [], "predictions": [frame["instances"]]} for frame in frames]
    module(monkeypatch, "mmpose")
    module(monkeypatch, "mmpose.apis", MMPoseInferencer=lambda name: lambda source: iter(results))
    people = run("rtmpose")["people"]
    assert list(people.person) == [0, 0, 0]
    assert furthest(people.joints, documented()) < 1e-3


def test_openpose(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture):
    (tmp_path / "dance").mkdir()
    for source in CASES.glob("openpose_*.json"):
        (tmp_path / "dance" / source.name).write_bytes(source.read_bytes())
    monkeypatch.chdir(tmp_path)
    people = run("openpose")["people"]
    assert people.ok.all() and list(people.person) == [0, 1, 0]
    assert capsys.readouterr().out.splitlines()[0].startswith("0 TrackedPeople(joints [2, 14, 3]")
