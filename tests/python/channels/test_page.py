"""The page that lifts in the browser: in Chromium, with a fake camera that shows a real video."""

import itertools
import json
import re
import shutil
import socket
import subprocess
import sys
import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from support import EXAMPLES, ROOT, need_library

import edmlift
from channels.browser import page as pages
from channels.browser import web
from channels.browser.detectors import DETECTORS, packages_of
from channels.browser.npm_packages import Package, install, is_there
from channels.browser.static_server import POLICY, make_server
from channels.version import version
from data import crops
from data.videos import CLIPS, find_wheel
from edmlift.drawing.scene import DRAWN, JOINT_SIDE
from edmlift.joint_angles import flexion
from edmlift.joints import JOINTS
from reports.browser import Page, find_browser
from reports.targets import ToolError

LIMIT = 300_000  # bytes of a page without detectors, over the network
USED = {name: DETECTORS[name] for name in ("blazepose-lite", "movenet-lightning")}
AXE = Package(
    "axe-core",
    "4.14.1",
    "sha512-FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ==",
    1,
    "MPL-2.0, Deque Systems",
    "",
    ("axe.min.js",),
)
# A woman who walks by, 390 pixels tall: frames, and her place, which moves to the left.
WALK = range(60, 150, 3)
SIDE = 480  # pixels of what is cut out around her
READY = "Boolean(window.edmliftPage) && edmliftPage.state().status === 'ok'"


# ---- What is served ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page with two detectors."""
    for program in ("clang", "wasm-ld", "npm"):
        if shutil.which(program) is None:
            pytest.skip(f"no {program}")
    return web.make_page(USED, tmp_path_factory.mktemp("page") / "page")


@contextmanager
def served(folder: Path, port: int = 0) -> Iterator[str]:
    """Serves a folder; its address.  At the end nobody answers, also who is still connected."""
    server = make_server(folder, port)
    connections = []
    accept = server.get_request
    server.get_request = lambda: connections.append(accept()) or connections[-1]
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://localhost:{server.server_address[1]}/"
    finally:
        server.shutdown()
        server.server_close()
        for connection, _ in connections:
            with suppress(OSError):
                connection.shutdown(socket.SHUT_RDWR)


@pytest.fixture(scope="module")
def address(folder: Path) -> Iterator[str]:
    with served(folder) as found:
        yield found


@pytest.fixture(scope="module")
def video() -> Path:
    """The video of sports2d."""
    place = web.BUILD / "videos"
    place.mkdir(parents=True, exist_ok=True)
    clip = CLIPS["street"]
    if not (place / clip.video).exists():
        with zipfile.ZipFile(find_wheel(place, clip.package)) as wheel:
            wheel.extract(clip.video, place)
    return place / clip.video


@pytest.fixture(scope="module")
def camera(video: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the fake camera shows: a woman who walks by, cut out of the video."""
    path = tmp_path_factory.mktemp("camera") / "camera.y4m"
    frames = cv2.VideoCapture(str(video))
    with path.open("wb") as out:
        out.write(f"YUV4MPEG2 W{SIDE} H{SIDE} F10:1 Ip A1:1 C420jpeg\n".encode())
        for number in range(WALK.stop):
            there, frame = frames.read()
            assert there
            if number not in WALK:
                continue
            left = min(max(0, int(1403 - 9.6 * (number - 60) - SIDE / 2)), frame.shape[1] - SIDE)
            part = frame[-SIDE - 10 : -10, left : left + SIDE]
            out.write(b"FRAME\n" + cv2.cvtColor(part, cv2.COLOR_BGR2YUV_I420).tobytes())
    return path


@pytest.fixture(scope="module")
def browser(camera: Path) -> Iterator[Page]:
    program = find_browser()
    if program is None:
        pytest.skip("no Chromium (Debian: chromium)")
    fake = "--use-fake-device-for-media-stream", f"--use-file-for-fake-video-capture={camera}"
    with Page(program, timeout=120, flags=fake) as found:
        yield found


@pytest.fixture
def page(browser: Page, address: str) -> Iterator[Page]:
    """The page, as it is after it was opened."""
    browser.resize(1280, 800)
    browser.scheme("light")
    browser.allow_camera(True)
    browser.errors.clear()
    browser.visit(address)
    browser.until(READY)
    browser.settle()
    yield browser
    assert browser.errors == []


def state(page: Page) -> dict[str, Any]:
    found: dict[str, Any] = page.evaluate("edmliftPage.state()")
    return found


def pose(page: Page) -> dict[str, Any]:
    found: dict[str, Any] = page.evaluate("edmliftPage.pose()")
    return found


def text(page: Page, selector: str) -> str:
    """What an element shows; nothing if it is hidden."""
    element = f"document.querySelector({selector!r})"
    found: str = page.evaluate(f"{element}.checkVisibility() ? {element}.innerText : ''")
    return found


def choose(page: Page, selector: str, value: str) -> None:
    page.evaluate(
        f"(e => {{ e.value = {json.dumps(value)}; e.dispatchEvent(new Event('change')); }})"
        f"(document.querySelector({selector!r}))"
    )


def go_to(page: Page, source: str) -> None:
    page.click(f"[name=source][value={source}]")


def problem(page: Page) -> str:
    page.until("!document.querySelector('#problem').hidden")
    return text(page, "#problem")


# ---- What it consists of -----------------------------------------------------------------------


@pytest.mark.slow
def test_it_loads_little(browser: Page, folder: Path, address: str):
    """Over the network, and by count."""
    browser.visit(address)
    browser.until(READY)
    zipped, plain = pages.loaded_bytes(folder)
    assert zipped < browser.loaded < LIMIT and plain < 2.5 * zipped
    assert not [url for url in browser.requests if "/detectors/files/" in url]


@pytest.mark.slow
def test_the_folder_has_what_is_listed(folder: Path):
    listed = json.loads((folder / "files.json").read_text("utf-8"))
    assert listed["version"] == version() and listed["models"][0] == "direct_w16"
    assert len(listed["models"]) == 6 and list(listed["detectors"]) == list(USED)
    for name in listed["core"]:
        assert (folder / name).exists(), name
    for detector in listed["detectors"].values():
        for file in detector["files"]:
            assert (folder / file["path"]).stat().st_size == file["bytes"] > 0
    assert "@mediapipe/pose 0.5.1675469404" in (folder / pages.FILES / pages.LICENCES).read_text(
        "utf-8"
    )


@pytest.mark.slow
def test_the_docs_have_its_figures(folder: Path):
    docs = (ROOT / "docs" / "browser.md").read_text("utf-8")
    found = re.search(r"The page loads (\d+) KB \(gzip; (\d+) KB unpacked\)", docs)
    assert found
    for said, measured in zip(found.groups(), pages.loaded_bytes(folder), strict=True):
        assert int(said) == pytest.approx(measured / 1000, abs=3)
    download = sum(package.megabytes for package in packages_of(DETECTORS.values()))
    assert f"by npm ({download} MB)" in docs
    for package in packages_of(DETECTORS.values()):
        assert f"`{package.name}` {package.version} (" in docs
    listed = json.loads((folder / "files.json").read_text("utf-8"))["detectors"]
    for name, row in (("blazepose-lite", "BlazePose lite, heavy"),
                      ("movenet-lightning", "MoveNet lightning")):  # fmt: skip
        size = sum(file["bytes"] for file in listed[name]["files"])
        assert re.search(rf"^\| {row} \| {round(size / 1e6)}\D", docs, re.M), size


@pytest.mark.slow
def test_the_policy_is_said_alike(folder: Path):
    html = (folder / "index.html").read_text("utf-8")
    (meta,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]*)"', html)
    assert f"{meta}; frame-ancestors 'none'" == POLICY  # which a page cannot say itself
    docs = (ROOT / "docs" / "browser.md").read_text("utf-8")
    assert f"\nContent-Security-Policy: {POLICY}\n" in docs


@pytest.mark.slow
def test_every_script_is_loaded_or_a_worker(folder: Path):
    """What main.js imports, from file to file."""
    scripts = {p.name: p.read_text("utf-8") for p in pages.SOURCES.rglob("*.js")}
    everything = (pages.SOURCES / "index.html").read_text("utf-8") + "".join(scripts.values())
    for name in scripts:
        assert f'{name}"' in everything, name


def test_the_release_has_the_same_bytes_each_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pages, "package_files", lambda _: web.lift_files())
    archives = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        archives += pages.build(tmp_path / name)
    assert archives[0].name == f"edmlift-page-{version()}.zip"
    assert archives[0].read_bytes() == archives[1].read_bytes()
    with zipfile.ZipFile(archives[0]) as archive:
        names = archive.namelist()
    assert {"index.html", "sw.js", "lift/direct_w16.wasm", "view/figure.js"} <= set(names)
    assert not [name for name in names if name.startswith(pages.FILES)]


@pytest.mark.slow
def test_the_body_is_that_of_the_pictures(page: Page):
    body = page.evaluate("import('./body.js').then(module => module.BODY)")
    assert sorted(map(tuple, body["bones"])) == sorted(DRAWN)
    assert body["jointSides"] == JOINT_SIDE
    assert body["names"] == [name.replace("_", " ") for name in JOINTS]


def samples(page: Page) -> dict[str, np.ndarray]:
    found = page.evaluate("import('./samples.js').then(module => module.SAMPLES)")
    return {name: np.array(points) for name, points in found.items()}


@pytest.mark.slow
def test_the_samples_are_examples(page: Page):
    known = [
        np.loadtxt(EXAMPLES / f"{name}.csv", delimiter=",", ndmin=2).reshape(-1, 14, 3)[..., :2]
        for name in ("walk", "kick", "cartwheel", "tpose")
    ]
    for points in samples(page).values():
        assert (np.concatenate(known) == points).all((1, 2)).any()


@pytest.mark.slow
def test_crops_are_those_of_the_tools(page: Page):
    rng = np.random.default_rng(1)
    cases = []
    for _ in range(50):
        middle, size = rng.uniform(0, 600, 2), rng.uniform(20, 300)
        found = np.c_[rng.normal(middle, size, (17, 2)), rng.uniform(0.05, 1, 17)]
        cases.append(found)
    script = "import('./detectors/crops.js').then(m => {}.map(k => m.around(k, 640, 480)))"
    squares = page.evaluate(script.format(json.dumps([case.tolist() for case in cases])))
    for case, square in zip(cases, squares, strict=True):
        wanted = crops.around(case, (640, 480))
        numbers = [square[name] for name in ("left", "top", "side")]
        assert numbers == pytest.approx([wanted.left, wanted.top, wanted.side])


# ---- Joints that are dragged -------------------------------------------------------------------


@pytest.mark.slow
def test_poses_have_the_bits_of_the_library(page: Page):
    need_library()
    models = ("direct_w16", "distances_w8", "direct_f32")
    for model, (name, points) in itertools.product(models, samples(page).items()):
        choose(page, "#model", model)
        page.until(f"edmliftPage.state().model === '{model}'")
        choose(page, "#sample", name)
        found = pose(page)
        wanted = edmlift.lift(np.c_[points, np.ones(14)].astype(np.float32), model=model)
        assert np.float32(found["joints"]).tobytes() == wanted.joints.tobytes(), name
        assert np.float32(found["quality"]) == np.float32(edmlift.quality(wanted))


def place(page: Page, joint: int) -> tuple[float, float]:
    """Where a joint is in the window."""
    box = page.evaluate("document.querySelector('#joints').getBoundingClientRect().toJSON()")
    x, y = page.evaluate(f"edmliftPage.places().picture[{joint}]")
    return box["x"] + x, box["y"] + y


@pytest.mark.slow
def test_a_joint_is_dragged(page: Page):
    wrist = JOINTS.index("left_wrist")
    before, pose_before = page.evaluate("edmliftPage.joints()"), pose(page)
    figure = page.evaluate("edmliftPage.places().figure")
    start = place(page, wrist)
    page.drag(start, (60, -120))
    after = page.evaluate("edmliftPage.joints()")
    assert place(page, wrist) == pytest.approx((start[0] + 60, start[1] - 120), abs=0.01)
    assert [j for j in range(14) if after[j] != before[j]] == [wrist]
    assert state(page)["chosen"] == wrist and text(page, "#joint-now") == "left wrist"
    moved = np.reshape(pose(page)["joints"], (14, 3)) - np.reshape(pose_before["joints"], (14, 3))
    assert np.hypot(*moved[wrist, :2]) > 0.2  # metres
    assert page.evaluate("edmliftPage.places().figure") != figure
    page.until("document.querySelector('#spoken').textContent.startsWith('left wrist ')")
    page.drag(place(page, wrist), (2000, 2000))  # it stays in sight
    box = page.evaluate("document.querySelector('#joints').getBoundingClientRect().toJSON()")
    x, y = place(page, wrist)
    assert (x, y) == pytest.approx((box["right"] - 8, box["bottom"] - 8), abs=1)


@pytest.mark.slow
def test_a_joint_is_moved_and_hidden_by_keys(page: Page):
    knee = JOINTS.index("right_knee")
    page.evaluate(f"document.querySelectorAll('#joints button')[{knee}].focus()")
    start = page.evaluate("edmliftPage.joints()")[knee]
    for key, shift in (("ArrowLeft", False), ("ArrowUp", True)):
        page.key(key, shift)
    end = page.evaluate("edmliftPage.joints()")[knee]
    steps = start[0] - end[0], start[1] - end[1]
    assert steps[1] == pytest.approx(5 * steps[0]) and steps[0] > 1
    for key in (" ", "Delete", "Enter"):
        before = pose(page)["seen"][knee]
        page.key(key)
        assert pose(page)["seen"][knee] is not before
        label = page.evaluate("document.activeElement.ariaLabel")
        assert ("not seen" in label) is before and label.startswith("right knee: ")
        assert page.evaluate("document.querySelector('#seen').checked") is not before
    page.click("#seen")
    assert pose(page)["seen"][knee]
    x, y = place(page, knee)
    for count in (1, 2):
        for kind in ("mousePressed", "mouseReleased"):
            page.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left",
                      clickCount=count)  # fmt: skip
    page.settle()
    assert not pose(page)["seen"][knee]  # a double click


@pytest.mark.slow
def test_too_few_joints_are_refused(page: Page):
    for joint in range(5):
        page.evaluate(f"document.querySelectorAll('#joints button')[{joint + 9}].focus()")
        page.key("Delete")
    assert state(page)["status"] == "too_few_joints"
    assert text(page, "#refusal") == "No pose: 9 of 14 joints are seen, and 10 are needed."
    page.until("document.querySelector('#quality-number').innerText === '–'")
    assert page.evaluate("edmliftPage.places().figure.length") == 0
    choose(page, "#sample", "a kick")
    assert state(page)["status"] == "ok" and text(page, "#refusal") == ""


@pytest.mark.slow
def test_numbers_are_those_of_the_pose(page: Page):
    need_library()
    choose(page, "#sample", "arms out")
    found = pose(page)
    joints, keypoints = (np.reshape(found[name], (1, 14, 3)) for name in ("joints", "keypoints"))
    wanted = edmlift.Poses.of(joints, keypoints)
    angles = edmlift.angles(wanted)
    page.until(f"document.querySelector('#quality-number').innerText === "
               f"'{round(100 * found['quality'])} %'")  # fmt: skip
    rows = page.evaluate("[...document.querySelectorAll('#angles tr')].map(r => "
                         "[...r.cells].map(c => c.innerText))")  # fmt: skip
    shown = {row[0]: row[1:] for row in rows}
    assert sum(len(row) - 1 for row in rows) == len(angles)
    for name in ("elbow flexion", "knee flexion"):
        key = name.replace(" ", "_")
        wanted_texts = [f"{angles[f'{side}_{key}'][0]:.0f}°" for side in ("right", "left")]
        assert shown[name] == wanted_texts
    assert shown["heading"] == [f"{angles['heading'][0]:.0f}°".replace("-", "−")]
    assert 0 < state(page)["liftMs"] < 50


@pytest.mark.slow
def test_where_up_is_changes_the_pose(page: Page):
    before = pose(page)["joints"]
    page.click("#level")
    assert pose(page)["joints"] != before
    page.click("#level")
    assert pose(page)["joints"] == before


@pytest.mark.slow
def test_a_model_that_cannot_be_loaded(page: Page, folder: Path):
    hidden = folder / "lift" / "distances_f32.wasm"
    hidden.rename(hidden.with_suffix(".away"))
    try:
        choose(page, "#model", "distances_f32")
        assert problem(page).startswith("distances_f32 cannot be loaded: ")
    finally:
        hidden.with_suffix(".away").rename(hidden)
    assert page.evaluate("document.querySelector('#model').value") == "direct_w16"
    page.errors[:] = [error for error in page.errors if "404" not in error]


# ---- The figure --------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_figure_turns(page: Page):
    x, y = page.middle("#figure")
    page.drag((x, y), (-60, 20))
    assert state(page)["azimuth"] == pytest.approx(0) and state(page)["elevation"] > 20
    page.wheel(x, y, -200)
    assert state(page)["zoom"] > 1.2
    page.evaluate("document.querySelector('#figure').focus()")
    page.key("ArrowRight")
    assert state(page)["azimuth"] == pytest.approx(-6)
    page.key("2")
    page.until("edmliftPage.state().azimuth === 90")
    page.prefer(reduced_motion="reduce")
    page.click("[data-view=above]")
    assert state(page)["elevation"] == 90  # at once
    page.click("[data-view=reset]")
    assert state(page)["zoom"] == 1


@pytest.mark.slow
def test_fingers(page: Page):
    """A joint is dragged, and the figure turned, on a phone; the page does not scroll meanwhile."""
    page.resize(360, 740, 2, mobile=True)
    page.settle()
    wrist = JOINTS.index("right_wrist")
    before = page.evaluate("edmliftPage.joints()")[wrist]
    page.touch(place(page, wrist), (-40, 60))
    after = page.evaluate("edmliftPage.joints()")[wrist]
    assert after[0] < before[0] - 10 and after[1] > before[1] + 10
    assert page.evaluate("scrollY") == 0
    azimuth = state(page)["azimuth"]
    page.touch(page.middle("#figure"), (50, 0))
    assert state(page)["azimuth"] != azimuth


# ---- Footage -----------------------------------------------------------------------------------


def start_camera(page: Page, detector: str = "movenet-lightning") -> None:
    go_to(page, "camera")
    choose(page, "#detector", detector)
    page.click("#start")
    page.until("edmliftPage.state().detectorMs > 0 && edmliftPage.state().status === 'ok'")


def assert_a_walking_woman(found: dict[str, Any]) -> None:
    """Upright, of a human size, seen from her side."""
    need_library()
    joints = np.reshape(found["joints"], (14, 3))
    head, ankles, knees = joints[0], joints[[10, 13]], joints[[9, 12]]
    assert 1.1 < np.linalg.norm(head - ankles.mean(0)) < 2.0
    assert head[1] < 0 < knees[:, 1].min() and (knees[:, 1] < ankles[:, 1]).all()
    assert max(flexion(joints)) < 120 and found["quality"] > 0.5
    heading = edmlift.joint_angles.heading(joints)
    assert -170 < heading < -20  # to the left of the picture, more or less
    assert sum(found["seen"]) >= 12


def assert_all_from(page: Page, address: str) -> None:
    """Whatever the page and its workers fetched; the lift and a detector are among it."""
    for part in ("/lift/direct_w16.wasm", "/detectors/files/"):
        assert any(part in url for url in page.requests)
    assert all(url.startswith((address, f"blob:{address}")) for url in page.requests)


def forget_gpu_messages(page: Page) -> None:
    """Forgets what MediaPipe and Chromium say of WebGL without a graphics processor."""
    words = ("WebGL", "gl_context", "OpenGL")
    page.errors[:] = [e for e in page.errors if not any(word in e for word in words)]


@pytest.mark.slow
def test_the_camera_is_lifted(page: Page, address: str):
    start_camera(page)
    seen = []
    for _ in range(4):
        page.evaluate("new Promise(done => setTimeout(done, 250))")
        found = pose(page)
        if found and found["status"] == "ok":
            seen.append(found)
    assert len(seen) >= 2
    for found in seen:
        assert_a_walking_woman(found)
    page.until("document.querySelector('#rate').innerText.endsWith('/s')")
    assert text(page, "#detector-ms").endswith(" ms")
    assert page.evaluate("document.querySelector('#mirror').checked")
    page.click("#stop")
    assert state(page)["status"] is None and text(page, "#start") == "Start the camera"
    assert_all_from(page, address)


@pytest.mark.slow
def test_blazepose_is_lifted(page: Page, address: str):
    """After MoveNet, while the camera goes on."""
    start_camera(page)
    choose(page, "#detector", "blazepose-lite")
    page.until("edmliftPage.state().detector === 'blazepose-lite'")
    page.until("edmliftPage.state().detectorMs > 0 && edmliftPage.state().status === 'ok'")
    found = pose(page)
    page.click("#stop")
    forget_gpu_messages(page)
    assert state(page)["detector"] == "blazepose-lite"
    assert_all_from(page, address)
    assert_a_walking_woman(found)


@pytest.mark.slow
def test_a_reader_who_does_not_wait(page: Page):
    """Goes on to something else while a detector is started."""
    go_to(page, "camera")
    choose(page, "#detector", "blazepose-lite")
    page.click("#start")
    go_to(page, "drag")
    go_to(page, "video")
    go_to(page, "drag")
    page.evaluate("new Promise(done => setTimeout(done, 1500))")
    shown = (
        "['progress', 'invitation', 'problem'].filter(id => !document.getElementById(id).hidden)"
    )
    assert page.evaluate(shown) == []
    assert state(page)["detector"] is None and state(page)["status"] == "ok"
    assert page.evaluate("document.querySelectorAll('video').length") == 0
    forget_gpu_messages(page)


# A detector that answers when it is told to.
SLOW_DETECTOR = """
  const said = [];
  let answer;
  const detector = {
    cut: () => said.push("cut"),
    async detect(frame) {
      said.push(frame);
      await new Promise((resolve) => (answer = resolve));
      said.push("answered");
      return null;
    },
  };
  const lifting = { cut: () => {} };
  const footage = { now: () => ({ frame: "b", time: 1 }), next: async () => null };
  const { Watching } = await import("./watching.js");
  const watching = new Watching(footage, detector, lifting, () => {});
  const first = watching.look({ frame: "a", time: 0 });
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "script",
    [
        """
        watching.cut();
        answer();
        await first;
        watching.look({ frame: "b", time: 1 });""",
        """
        const another = new Watching(footage, detector, lifting, () => {});
        watching.stop();
        another.run();
        answer();
        await new Promise((done) => setTimeout(done, 0));""",
    ],
    ids=["wound", "another"],
)
def test_a_frame_that_does_not_follow_waits_for_the_one_before(page: Page, script: str):
    """A detector that looks remembers then where the person was, and takes the answer to one frame
    for that to another."""
    said = page.evaluate(f"(async () => {{{SLOW_DETECTOR}{script} return said; }})()")
    assert said == ["cut", "a", "answered", "cut", "b"]


@pytest.mark.slow
def test_a_video_is_lifted(page: Page, video: Path):
    go_to(page, "video")
    choose(page, "#detector", "movenet-lightning")
    page.give_file("#file", video)
    page.until("edmliftPage.state().time !== null")
    page.click("#play")
    assert page.evaluate("document.querySelector('#play').ariaLabel") == "Play"
    seek(page, 3.0)
    assert state(page)["status"] == "ok" and text(page, "#now") == "3.0 s"
    assert pose(page)["quality"] > 0.3
    mirrored_back(page)
    seek(page, 7.6)  # both have left the picture
    assert pose(page) is None and text(page, "#refusal") == "Nobody is seen."
    page.until("document.querySelector('#quality-number').innerText === '–'")


def mirrored_back(page: Page) -> None:
    """A video that is taken for a mirrored selfie: joints stay where they are, under the other
    side's name, and the pose is mirrored."""
    exchange = {"right": "left", "left": "right"}
    sides = [name.partition("_") for name in JOINTS]
    other = [JOINTS.index("".join((exchange.get(a, a), b, c))) for a, b, c in sides]
    found = []
    for _ in range(2):  # each is the first frame of a track
        joint = pose(page)["joints"][0]
        page.click("#selfie")
        page.until(f"edmliftPage.pose().joints[0] !== {joint}")
        page.settle()
        places = page.evaluate("edmliftPage.places()")
        drawn = np.array([place[:2] for place in places["figure"][:14]])
        found.append((np.reshape(pose(page)["joints"], (14, 3)), places["picture"], drawn))
    (selfie, picture, figure), (plain, plain_picture, plain_figure) = found
    assert selfie == pytest.approx(plain[other] * [-1, 1, 1], abs=1e-3)
    assert np.array(picture) == pytest.approx(np.array(plain_picture)[other], abs=0.5)
    assert figure == pytest.approx(plain_figure[other], abs=2)


def seek(page: Page, seconds: float) -> None:
    """Until the frame is lifted."""
    page.evaluate(
        f"(e => {{ e.value = {seconds}; e.dispatchEvent(new Event('input')); }})"
        "(document.querySelector('#time'))"
    )
    page.until(f"Math.abs(edmliftPage.state().time - {1000 * seconds}) < 40")


@pytest.mark.slow
def test_a_file_that_is_no_video(page: Page, tmp_path: Path):
    (tmp_path / "notes.mp4").write_text("no video")
    go_to(page, "video")
    choose(page, "#detector", "movenet-lightning")
    page.give_file("#file", tmp_path / "notes.mp4")
    assert problem(page).startswith("This browser cannot play notes.mp4.")
    assert text(page, "#start") == "Choose a video file"
    page.errors[:] = [error for error in page.errors if "ERR_FILE_NOT_FOUND" not in error]


@pytest.mark.slow
def test_a_camera_that_is_not_allowed(page: Page):
    page.allow_camera(False)
    go_to(page, "camera")
    choose(page, "#detector", "movenet-lightning")
    page.click("#start")
    assert problem(page).startswith("The browser may not use the camera.")
    assert text(page, "#start") == "Start the camera"


@pytest.mark.slow
def test_cameras_that_do_not_start(page: Page):
    go_to(page, "camera")
    choose(page, "#detector", "movenet-lightning")
    throws = (
        "navigator.mediaDevices.getUserMedia = async () => {{ throw new DOMException('', '{}'); }}"
    )
    for before, said in (
        (throws.format("NotFoundError"), "There is no camera."),
        (throws.format("NotReadableError"), "The camera does not start"),
        ("Object.defineProperty(navigator, 'mediaDevices', {value: undefined})",
         "The browser gives cameras only to pages of https:// and http://localhost."),
    ):  # fmt: skip
        page.evaluate(before + "; true")
        page.click("#start")
        page.until(f"document.querySelector('#problem').textContent.startsWith({said!r})")


@pytest.mark.slow
def test_a_browser_without_webgl(page: Page):
    page.evaluate("HTMLCanvasElement.prototype.getContext = (old => function (kind, ...rest) {"
                  "return kind === 'webgl2' ? null : old.call(this, kind, ...rest); })"
                  "(HTMLCanvasElement.prototype.getContext)")  # fmt: skip
    go_to(page, "camera")
    choose(page, "#detector", "blazepose-lite")
    page.click("#start")
    said = "BlazePose lite needs WebGL 2, which this browser does not offer. MoveNet does without:"
    assert problem(page).startswith(said)


@pytest.mark.slow
def test_a_browser_without_webassembly(browser: Page, address: str):
    number = browser.before_scripts("delete globalThis.WebAssembly")
    try:
        browser.visit(address)
        assert problem(browser).startswith("This browser has no WebAssembly")
    finally:
        browser.undo(number)
    browser.errors.clear()


@pytest.mark.slow
def test_a_page_without_a_detector(browser: Page, tmp_path: Path):
    with served(web.make_page({}, tmp_path / "page")) as address:
        browser.visit(address)
        browser.until(READY)
        go_to(browser, "camera")
        assert "tools/web installs one" in problem(browser) and text(browser, "#start") == ""


# ---- Without a network, and nothing to it ------------------------------------------------------


@pytest.mark.slow
def test_it_works_without_a_network(browser: Page, folder: Path):
    """Once it was loaded, with what was used; the rest is said to be missing."""
    browser.errors.clear()
    with served(folder) as address:
        browser.visit(address)
        browser.until(READY)
        start_camera(browser)
        go_to(browser, "drag")
        browser.until("!document.querySelector('#offline').hidden")
        (folder / "other.txt").write_text("not of the page")  # beside it on a server
        assert browser.evaluate("fetch('other.txt').then(() => caches.match('other.txt'))") is None
        browser.until("fetch('sw.js').then(() => Boolean(navigator.serviceWorker.controller))")
        assert browser.requests.count(f"{address}main.js") == 2  # the service worker's is one
        assert_all_from(browser, address)
    browser.visit(address)  # nobody serves it now
    browser.until(READY)
    assert state(browser)["model"] == "direct_w16"
    start_camera(browser)
    assert_a_walking_woman(pose(browser))
    browser.click("#stop")
    choose(browser, "#detector", "blazepose-lite")
    browser.click("#start")
    assert "BlazePose lite is not stored on this device yet" in problem(browser)
    browser.errors.clear()


@pytest.mark.slow
def test_the_policy_holds(page: Page, address: str):
    """Neither the page nor a worker of it gets past it."""
    fetched = "fetch('https://example.invalid/').then(() => 'got', () => 'refused')"
    assert page.evaluate(fetched) == "refused"
    beacon = page.evaluate("navigator.sendBeacon('https://example.invalid/', 'x')")
    loaded = page.evaluate("new Promise(done => { const image = new Image(); image.onload = () => "
                           "done('got'); image.onerror = () => done('refused'); "
                           "image.src = 'https://example.invalid/x.png'; })")  # fmt: skip
    assert loaded == "refused"
    refused = [error for error in page.errors if "Content Security Policy" in error]
    assert len(refused) >= 3 or not beacon
    page.errors.clear()
    for name in ("sw.js", "detectors/movenet-worker.js", "index.html"):
        policy = page.evaluate(f"fetch('{address}{name}', {{cache: 'reload'}})"
                               ".then(r => r.headers.get('content-security-policy'))")  # fmt: skip
        assert "connect-src 'self'" in policy and "default-src 'none'" in policy


# ---- For everybody -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def axe() -> str:
    packages = web.BUILD / "packages"
    if not is_there(AXE, packages):
        install(AXE, packages)
    return (packages / AXE.full_name / "axe.min.js").read_text("utf-8")


@pytest.mark.slow
def test_axe_finds_nothing(page: Page, axe: str):
    page.evaluate(axe + "; true")
    for scheme, size in (("light", (1280, 800)), ("dark", (360, 740))):
        page.scheme(scheme)
        page.resize(*size)
        for source in ("drag", "video", "camera"):
            go_to(page, source)
            page.settle()
            found = page.evaluate(
                "axe.run().then(r => r.violations.map(v => [v.id, v.help, "
                "v.nodes.map(n => n.html.slice(0, 200))]))"
            )
            assert found == [], (scheme, size, source)


@pytest.mark.slow
def test_tab_reaches_everything_and_shows_where(page: Page):
    reached = []
    for _ in range(60):
        page.key("Tab")
        if page.evaluate("document.activeElement === document.body"):
            break
        name, shown = page.evaluate(
            "(e => { const s = getComputedStyle(e.name === 'source' ? e.nextElementSibling : e);"
            "return [e.id || e.ariaLabel || e.value || e.innerText,"
            "s.outlineStyle === 'solid' || s.boxShadow !== 'none']; })"
            "(document.activeElement)"
        )
        assert name not in reached and shown, name
        reached.append(name)
    assert {"drag", "sample", "figure", "Front", "model", "level", "names", "seen"} <= {
        name.partition(":")[0] for name in reached
    }
    assert sum(": " in name for name in reached) == 14


@pytest.mark.slow
def test_it_fits_the_screen(page: Page):
    for size in ((1280, 800), (1024, 768), (740, 360), (360, 740), (320, 568)):
        fits(page, size)


def fits(page: Page, size: tuple[int, int]) -> None:
    page.resize(*size, mobile=size[0] < 1000)
    for source in ("drag", "video", "camera"):
        go_to(page, source)
        page.settle()
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    go_to(page, "drag")
    boxes = [
        page.evaluate(f"document.querySelector('#{name}').getBoundingClientRect().toJSON()")
        for name in ("picture", "figure")
    ]
    assert all(box["width"] > 140 and box["height"] > 140 for box in boxes)
    if size in ((1280, 800), (360, 740)):
        assert max(box["bottom"] for box in boxes) <= size[1]  # both, without scrolling
    if size == (1280, 800):
        assert page.evaluate("document.documentElement.scrollHeight") <= size[1]


# ---- tools/web ---------------------------------------------------------------------------------


def run_web(*options: object, **settings: Any) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "channels.browser.web", *map(str, options)]
    return subprocess.run(
        command, cwd=ROOT / "tools", capture_output=True, text=True, timeout=300, **settings
    )


@pytest.mark.slow
def test_a_page_is_exported(folder: Path, tmp_path: Path):
    """`folder`: what it needs is built."""
    out = tmp_path / "page"
    for _ in range(2):  # the second time over the first
        done = run_web("--no-detector", "--export", out)
        assert done.returncode == 0, done.stderr
        assert f"{out}: the page, " in done.stdout and "KB to load (gzip)" in done.stdout
    assert json.loads((out / "files.json").read_text("utf-8"))["detectors"] == {}
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.txt").write_text("all of it")
    done = run_web("--no-detector", "--export", tmp_path / "other")
    assert done.returncode == 1 and "has other files" in done.stderr
    assert (tmp_path / "other" / "thesis.txt").exists()


def test_without_npm(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(ToolError, match="npm is missing.*Debian: npm.*--no-detector"):
        web.install_detectors(USED, tmp_path)


def test_without_a_network_for_npm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    if shutil.which("npm") is None:
        pytest.skip("no npm")
    monkeypatch.setenv("npm_config_registry", "http://localhost:9/")
    monkeypatch.setenv("npm_config_fetch_retries", "0")
    with pytest.raises(ToolError, match="human@3.3.6 cannot be downloaded: .*ECONNREFUSED") as said:
        web.install_detectors({"movenet-lightning": DETECTORS["movenet-lightning"]}, tmp_path)
    assert str(said.value).endswith("\nThe page works without: --no-detector")


@pytest.mark.slow
def test_wrong_options(folder: Path):
    done = run_web("--detectors", "openpose")
    assert done.returncode == 2
    assert "no detector openpose; there are blazepose-lite, blazepose-full" in done.stderr
    with socket.create_server(("localhost", 0)) as taken:
        port = taken.getsockname()[1]
        done = run_web("--no-detector", "--port", port)
    assert done.returncode == 1 and f"port {port} cannot be used" in done.stderr
    assert done.stdout == ""  # before anything is built
    done = run_web("--no-detector", "--export", __file__)
    assert done.returncode == 1
    assert done.stderr == f"tools/web: {__file__} is a file: name a new folder, or an older page\n"


@pytest.mark.slow
def test_the_server_gives_its_folder_alone(folder: Path, address: str):
    port = int(address.rstrip("/").rpartition(":")[2])
    for path, wanted in (("/../web.py", 404), ("/%2e%2e/%2e%2e/x", 404), ("/lift", 404),
                         ("/index.html?x=1", 200)):  # fmt: skip
        with socket.create_connection(("localhost", port)) as connection:
            connection.sendall(f"GET {path} HTTP/1.0\r\n\r\n".encode())
            assert f" {wanted} ".encode() in connection.recv(100), path


@pytest.mark.slow
def test_other_bytes_are_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    package = packages_of(DETECTORS.values())[0]
    archive = tmp_path / "x.tgz"
    archive.write_bytes(b"other")
    monkeypatch.setattr("channels.browser.npm_packages._download", lambda *_: archive)
    with pytest.raises(ToolError, match="other bytes"):
        install(package, tmp_path / "packages")
    assert not (tmp_path / "packages").exists()
