"""The page: what is in it, what cannot be, and what it does in a browser."""

import base64
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from package_support import DATA, ROOT, WALK, need_library

import edmlift
from edmlift.__main__ import main
from edmlift.drawing.palette import SIDES, rgb
from edmlift.drawing.palette import TRUTH as TRUTH_COLOUR
from edmlift.drawing.scene import level
from edmlift.joint_angles import flexion, heading, lean
from edmlift.viewing import pages, photographs
from reports.browser import Page, find_browser

TRUTH = edmlift.read_truth(DATA / "walk_truth.csv")
MISSING = -32768
FRAMES = len(TRUTH)
REFUSED = [5, 6, 7, 30]
HOUR = 108_000  # frames, at 30 a second

pytestmark = pytest.mark.filterwarnings("error")


def poses(count: int = FRAMES) -> edmlift.Poses:
    """The walk's truth, as if it had been lifted."""
    return edmlift.Poses.of(TRUTH[:count], WALK[:count])


def gappy() -> edmlift.Poses:
    """The walk, with frames that were refused and a wrist that was never seen."""
    status = np.full(FRAMES, "ok", "U20")
    status[REFUSED] = "too_few_joints"
    keypoints = WALK.copy()
    keypoints[:, 4] = 0
    joints = np.where((status == "ok")[:, None, None], TRUTH, np.nan)
    return edmlift.Poses.of(joints, keypoints, status)


def data_of(path: Path) -> dict[str, Any]:
    """The data of a page, unpacked."""
    text = path.read_text("utf-8")
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


def unpacked(text: str, kind: str = "<i2") -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), kind)


# ---- Data --------------------------------------------------------------------------------------


def test_poses_are_in_millimetres(tmp_path: Path):
    edmlift.view(gappy(), tmp_path / "x.html", truth=TRUTH + 0.1)
    data = data_of(tmp_path / "x.html")
    assert data["frames"] == FRAMES and data["joints"] == list(edmlift.JOINTS)
    found = unpacked(data["poses"]).reshape(FRAMES, 14, 3)
    assert (found[REFUSED] == MISSING).all()
    ok = np.setdiff1d(np.arange(FRAMES), REFUSED)
    assert np.abs(found[ok] / 1000 - TRUTH[ok]).max() < 0.00051
    truth = unpacked(data["truth"]).reshape(FRAMES, 14, 3)
    assert np.abs(truth / 1000 - TRUTH - 0.1).max() < 0.00051
    names = np.array(data["statuses"])[unpacked(data["status"], "<u2")]
    assert (names == gappy().status).all()
    assert (unpacked(data["seen"], "<u2") == (1 << 14) - 1 - (1 << 4)).all()


def test_image_points(tmp_path: Path):
    edmlift.view(gappy(), tmp_path / "x.html")
    image = data_of(tmp_path / "x.html")["image"]
    counts = unpacked(image["points"]).reshape(FRAMES, 14, 2)
    assert (counts[:, 4] == MISSING).all()
    points = image["origin"] + image["step"] * counts
    seen = np.arange(14) != 4
    assert np.abs(points - WALK[..., :2])[:, seen].max() < 0.1
    left, top, right, bottom = image["box"]
    x, y = WALK[:, seen, 0], WALK[:, seen, 1]
    assert left < x.min() and x.max() < right and top < y.min() and y.max() < bottom
    edmlift.view(gappy(), tmp_path / "x.html", image=(1000, 800))
    assert data_of(tmp_path / "x.html")["image"]["box"] == [0, 0, 1000, 800]


def test_a_wild_keypoint_does_not_spoil_the_others(tmp_path: Path):
    keypoints = np.tile(WALK, (10, 1, 1))
    keypoints[50, 7, :2] = 1e6, -1e6
    edmlift.view(edmlift.Poses.of(np.tile(TRUTH, (10, 1, 1)), keypoints), tmp_path / "x.html")
    image = data_of(tmp_path / "x.html")["image"]
    assert image["box"][2] < 1000 and image["step"] < 0.1


def test_curves_are_the_angles_of_the_package(tmp_path: Path):
    up = np.array([0.0, -1.0, -0.3])
    quality = np.linspace(0, 1, FRAMES)
    edmlift.view(poses(), tmp_path / "x.html", up=up, quality=quality, truth=TRUTH)
    curves = {row["name"]: row for row in data_of(tmp_path / "x.html")["curves"]}
    assert list(curves) == ["Elbows", "Knees", "Trunk lean", "Heading", "Quality", "Error"]

    def values(name: str, line: int) -> np.ndarray:
        row = curves[name]
        return row["step"] * unpacked(row["lines"][line]["values"])

    bends = flexion(TRUTH)
    for line in (0, 1):
        assert values("Elbows", line) == pytest.approx(bends[:, line], abs=0.051)
        assert values("Knees", line) == pytest.approx(bends[:, 2 + line], abs=0.051)
    assert values("Trunk lean", 0) == pytest.approx(lean(TRUTH, up), abs=0.051)
    assert values("Heading", 0) == pytest.approx(heading(TRUTH, up), abs=0.051)
    assert values("Quality", 0) == pytest.approx(quality, abs=0.00051)
    assert values("Error", 0) == pytest.approx(0)
    assert [line["dashed"] for line in curves["Knees"]["lines"]] == [False, False, True, True]
    for row in curves.values():
        known = np.concatenate([row["step"] * unpacked(line["values"]) for line in row["lines"]])
        assert row["low"] <= known.min() and known.max() <= row["high"]


def test_the_floor_is_level(tmp_path: Path):
    """The axes of a camera that looks down, and of one that is rolled as well."""
    pitch, roll = np.radians(30), np.radians(20)
    up = np.array([0, -np.cos(pitch), -np.sin(pitch)])
    edmlift.view(poses(), tmp_path / "x.html", up=up)
    found = unpacked(data_of(tmp_path / "x.html")["poses"]).reshape(-1, 14, 3) / 1000
    assert np.abs(found - level(TRUTH, 30)).max() < 0.001
    c, s = np.cos(roll), np.sin(roll)
    rolled = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])  # about the camera's axis
    turned = edmlift.Poses.of((TRUTH @ rolled.T).astype(np.float32), WALK)
    edmlift.view(turned, tmp_path / "y.html", up=np.tile(rolled @ up, (FRAMES, 1)))
    again = unpacked(data_of(tmp_path / "y.html")["poses"]).reshape(-1, 14, 3) / 1000
    assert np.abs(again - found).max() < 0.002


def test_a_camera_that_looks_straight_down(tmp_path: Path):
    """What is up in its image is ahead."""
    edmlift.view(poses(), tmp_path / "x.html", up=(0, 0, -1))
    found = unpacked(data_of(tmp_path / "x.html")["poses"]).reshape(-1, 14, 3) / 1000
    assert np.abs(found - TRUTH[..., [0, 2, 1]] * [1, 1, -1]).max() < 0.001


def test_poses_of_all_kinds(tmp_path: Path):
    out = tmp_path / "x.html"
    edmlift.view(edmlift.Poses.of(TRUTH), out)  # where they were seen is not known
    assert data_of(out)["image"] is None
    edmlift.view(edmlift.Poses.of(TRUTH[3], WALK[3]), out, truth=TRUTH[3])
    assert data_of(out)["frames"] == 1
    nothing = edmlift.Poses.of(TRUTH * np.nan, WALK * 0, ["degenerate"] * FRAMES)
    edmlift.view(nothing, out)
    assert data_of(out)["statuses"] == ["degenerate"]


@pytest.mark.long
def test_an_hour_is_small(tmp_path: Path):
    """The sizes that the docstring and docs/view.md name."""
    empty, many, both = (tmp_path / f"{name}.html" for name in ("empty", "many", "both"))
    hour = np.arange(HOUR) % FRAMES
    recording = edmlift.Poses.of(TRUTH[hour], WALK[hour])
    edmlift.view(poses(1), empty)
    edmlift.view(recording, many, quality=np.ones(HOUR))
    edmlift.view(recording, both, truth=TRUTH[hour])
    assert empty.stat().st_size < 80_000
    assert many.stat().st_size / HOUR == pytest.approx(230, abs=5)
    assert both.stat().st_size / HOUR == pytest.approx(360, abs=5)


# ---- Text --------------------------------------------------------------------------------------

NASTY = '</title></script><script>window.hacked = 1</script><img src=x onerror="hacked=1">&amp;$x'


def nasty() -> edmlift.Poses:
    """A status that would be markup if it could."""
    return edmlift.Poses.of(TRUTH[:2] * [np.nan], WALK[:2], [NASTY, NASTY + "\u2028"])


def test_data_cannot_be_markup(tmp_path: Path):
    out = tmp_path / "x.html"
    edmlift.view(nasty(), out, title=NASTY)
    text = out.read_text("utf-8")
    assert text.count("<script") == 2 and text.count("</script>") == 2 and "<img" not in text
    assert data_of(out)["title"] == NASTY and data_of(out)["statuses"][0] == NASTY


def test_a_title_that_has_no_utf_8(tmp_path: Path):
    edmlift.view(poses(1), tmp_path / "x.html", title="a\udcffb")
    assert data_of(tmp_path / "x.html")["title"] == "a?b"


def test_the_page_needs_nothing_else(tmp_path: Path):
    edmlift.view(poses(), tmp_path / "x.html")
    text = (tmp_path / "x.html").read_text("utf-8")
    code = re.sub(r'(?<=id="data">).*?(?=</script>)', "", text, flags=re.S)
    assert not re.findall(r"https?:|['\"(]//|@import|url\(|\bimport\b|fetch\(|XMLHttp", code)
    assert "default-src 'none'" in text and "unsafe" not in text
    assert not re.search(r"\son\w+=|\sstyle=", text)  # the policy would not let them


def test_every_script_is_in_the_page():
    folder = Path(pages.__file__).parent / "page"
    assert {path.stem for path in folder.glob("*.js")} == set(pages.SCRIPTS)


def luminance(colour: str) -> float:
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4
              for v in (part / 255 for part in rgb(colour))]  # fmt: skip
    return float(np.dot(linear, [0.2126, 0.7152, 0.0722]))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_contrast(tmp_path: Path, scheme: str):
    """WCAG 2, AA: 4.5 for text, 3 for lines."""
    edmlift.view(poses(1), tmp_path / "x.html")
    style = (tmp_path / "x.html").read_text("utf-8").partition("<style>")[2]
    light, dark = re.findall(r":root \{(.*?)\}", style, re.S)[:2]
    parts = (light, dark) if scheme == "dark" else (light,)
    colours = {name: value for part in parts
               for name, value in re.findall(r"--(\w+): (#\w{6});", part)}  # fmt: skip
    drawn = {**SIDES, "truth": TRUTH_COLOUR}  # in the pictures of `edmlift draw`, too
    same = drawn if scheme == "light" else {side: SIDES[side] for side in ("right", "left")}
    assert {name: colours[name] for name in same} == same
    for names, wanted in (("text faint refused", 4.5), ("right left trunk truth focus", 3.0)):
        for name in names.split():
            for behind in ("page", "panel"):
                pair = sorted(luminance(colours[part]) for part in (name, behind))
                ratio = (pair[1] + 0.05) / (pair[0] + 0.05)
                assert ratio >= wanted, f"{name} on {behind}: {ratio:.2f}"


# ---- Pictures ----------------------------------------------------------------------------------


def photo(colour: tuple[int, int, int] = (40, 200, 90), width: int = 1000) -> np.ndarray:
    return np.full((800, width, 3), colour, np.uint8)


def test_pictures_are_reduced(tmp_path: Path):
    image = pytest.importorskip("PIL.Image", reason="no Pillow")
    image.fromarray(photo()).save(tmp_path / "photo.png")
    out = tmp_path / "x.html"
    for pictures in ([photo()], [tmp_path / "photo.png"] * FRAMES):
        edmlift.view(poses(), out, pictures=pictures, picture_side=320)
        found = data_of(out)["pictures"]
        assert len(found) == len(pictures)
        assert (found[0]["width"], found[0]["height"]) == (1000, 800)
        (tmp_path / "x.jpg").write_bytes(base64.b64decode(found[-1]["data"]))
        with image.open(tmp_path / "x.jpg") as reduced:
            assert reduced.format == "JPEG" and reduced.size == (320, 256)
        assert data_of(out)["image"]["box"] == [0, 0, 1000, 800]


def test_small_pictures_stay(tmp_path: Path):
    image = pytest.importorskip("PIL.Image", reason="no Pillow")
    edmlift.view(poses(1), tmp_path / "x.html", pictures=[photo(width=200)[:100]])
    (found,) = data_of(tmp_path / "x.html")["pictures"]
    (tmp_path / "x.jpg").write_bytes(base64.b64decode(found["data"]))
    with image.open(tmp_path / "x.jpg") as same:
        assert same.size == (200, 100)


def test_too_many_pictures():
    pytest.importorskip("PIL.Image", reason="no Pillow")
    rng = np.random.default_rng(1)
    noise = rng.integers(0, 255, (300, 400, 3), np.uint8)
    bytes_each = len(base64.b64decode(photographs.jpegs([noise], 1, 400)[0]["data"]))
    with pytest.raises(ValueError, match=r"400 pixels would take about \d+ MB.*: 256 would do"):
        photographs.jpegs([noise] * 40, 40, 400, limit=20 * bytes_each)
    with pytest.raises(ValueError, match="give fewer frames"):
        photographs.jpegs([noise] * 40, 40, 80, limit=2000)


def test_pictures_need_pillow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("edmlift.drawing.canvas.Image", None)
    with pytest.raises(ImportError, match=re.escape("pip install 'edmlift[draw]'")):
        edmlift.view(poses(), tmp_path / "x.html", pictures=["photo.png"])
    edmlift.view(poses(), tmp_path / "x.html")  # without pictures nobody needs it


# ---- Errors ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("x.png", {}, "must end in .html"),
        ("x", {}, "must end in .html"),
        ("x.html", {"fps": 0}, "fps must be over 0"),
        ("x.html", {"fps": math.inf}, "fps must be over 0"),
        ("x.html", {"truth": TRUTH[:3]}, "truth must be [39,14,3], not [3, 14, 3]"),
        ("x.html", {"quality": [1.0]}, "quality must be [39], not [1]"),
        ("x.html", {"up": (0, 0, 0)}, "up must be three finite numbers"),
        ("x.html", {"image": (0, 100)}, "image must be (width, height)"),
        ("x.html", {"pictures": [1, 2]}, "pictures must be 1, or 39"),
        ("x.html", {"pictures": [photo()], "picture_side": 10}, "picture_side must be 64 or more"),
        ("x.html", {"pictures": ["walk.mp4"]}, "walk.mp4 is a video: give its frames"),
    ],
)
def test_what_cannot_be_viewed(name: str, options: dict, message: str, tmp_path: Path):
    with pytest.raises(ValueError, match=re.escape(message)):
        edmlift.view(poses(), tmp_path / name, **options)
    assert not list(tmp_path.iterdir())


def test_no_poses_at_all(tmp_path: Path):
    with pytest.raises(ValueError, match="needs poses"):
        edmlift.view(edmlift.Poses.of(TRUTH[:0]), tmp_path / "x.html")


def test_a_picture_that_is_not_there(tmp_path: Path):
    pytest.importorskip("PIL.Image", reason="no Pillow")
    with pytest.raises(FileNotFoundError):
        edmlift.view(poses(), tmp_path / "x.html", pictures=[tmp_path / "none.jpg"])


# ---- The command -------------------------------------------------------------------------------


def run(*arguments: object) -> int:
    return main([str(argument) for argument in arguments])


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture):
    need_library()
    out = tmp_path / "walk.html"
    truth = DATA / "walk_truth.csv"
    assert run("view", DATA / "walk.csv", "-o", out, "--truth", truth, "--pitch", "8.5") == 0
    assert re.fullmatch(rf"{out}: 39 of 39 poses, 0\.\d MB\n", capsys.readouterr().out)
    data = data_of(out)
    assert data["title"] == "walk" and data["fps"] == 30
    assert {"Quality", "Error"} < {row["name"] for row in data["curves"]}
    street = DATA / "detections" / "street.csv"
    options = ("--format", "blazepose33", "--image", "1768,994", "--fps", "3", "--title", "A <i>")
    assert run("view", street, "-o", out, *options) == 0
    data = data_of(out)
    assert data["title"] == "A <i>" and data["fps"] == 3 and len(data["statuses"]) > 1
    assert data["image"]["box"] == [0, 0, 1768, 994]


def test_the_command_knows_no_quality_of_what_was_lifted_before(tmp_path: Path):
    edmlift.write_poses(tmp_path / "lifted.csv", poses())
    out = tmp_path / "x.html"
    assert run("view", DATA / "walk.csv", tmp_path / "lifted.csv", "--out", out) == 0
    assert "Quality" not in {row["name"] for row in data_of(out)["curves"]}


def test_what_the_command_cannot_do(tmp_path: Path, capsys: pytest.CaptureFixture):
    edmlift.write_poses(tmp_path / "lifted.csv", poses())
    both = (DATA / "walk.csv", tmp_path / "lifted.csv")
    for status, message, options in (
        (1, "must hold equally many poses", ("--truth", DATA / "kick_truth.csv")),
        (2, "must end in .html", ("-o", tmp_path / "x.png")),
        (2, "both say where up is", ("--pitch", "8", "--up", "0,-1,0")),
        (2, "pitch must be -90 to 90", ("--pitch", "91")),
        (2, "is a video", ("--pictures", "walk.mov")),
        (1, "No such file", ("--pictures", "none.png")),
    ):
        assert run("view", *both, "-o", tmp_path / "x.html", *options) == status
        assert message in capsys.readouterr().err
    assert not (tmp_path / "x.html").exists()


def test_the_program_of_the_docs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """And the sizes there, which test_an_hour_is_small() measures."""
    need_library()
    text = (ROOT / "docs" / "view.md").read_text("utf-8")
    (program,) = re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    exec(program, {})
    assert data_of(tmp_path / "walk.html")["title"] == "A walk"
    for here in (text, edmlift.view.__doc__):
        sizes = " ".join(here.split())
        assert "230 bytes a pose, and 360" in sizes and "25 or 39 MB" in sizes


def test_the_picture_in_the_docs():
    image = pytest.importorskip("PIL.Image", reason="no Pillow")
    path = ROOT / "docs" / "view.png"
    assert path.stat().st_size < 150_000
    with image.open(path) as picture:
        assert picture.size == (1280, 800)


# ---- In a browser ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def browser() -> Iterator[Page]:
    program = find_browser()
    if program is None:
        pytest.skip("no Chromium (Debian: chromium)")
    with Page(program) as page:
        yield page


@pytest.fixture
def page(browser: Page) -> Iterator[Page]:
    """The browser at a desk, in the light; nothing may be fetched or go wrong."""
    browser.resize(1280, 800)
    browser.scheme("light")
    browser.errors.clear()
    yield browser
    assert browser.errors == []
    assert all(url.startswith("file:") for url in browser.requests)
    assert len(browser.requests) <= 1


def opened(page: Page, path: Path, given: edmlift.Poses, anchor: str = "", **options: Any) -> None:
    edmlift.view(given, path, **options)
    page.open(path, anchor)
    page.until("Boolean(window.edmliftView)")
    page.settle()


def state(page: Page) -> dict[str, Any]:
    found: dict[str, Any] = page.evaluate("edmliftView.state()")
    return found


def pixel(page: Page, selector: str, x: float, y: float) -> list[int]:
    """Red, green, blue and alpha of a canvas, at shares of its width and height."""
    found: list[int] = page.evaluate(
        f"(() => {{ const c = document.querySelector({selector!r}); return Array.from("
        f"c.getContext('2d').getImageData({x} * c.width, {y} * c.height, 1, 1).data); }})()"
    )
    page.errors[:] = [e for e in page.errors if "willReadFrequently" not in e]  # ours, of reading
    return found


def test_the_page_has_the_numbers(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", gappy(), quality=np.full(FRAMES, 0.5))
    found = np.array(page.evaluate("edmliftView.pose(3)")).reshape(14, 3)
    assert np.abs(found - TRUTH[3]).max() < 0.00051
    assert page.evaluate("edmliftView.pose(6)") is None
    page.evaluate("edmliftView.go(3)")
    page.settle()
    points = page.evaluate("edmliftView.points().image")
    assert points[4] is None
    given = np.delete(WALK[3, :, :2], 4, 0)
    drawn = np.array([point for point in points if point is not None])
    box = np.reshape(data_of(tmp_path / "x.html")["image"]["box"], (2, 2))
    size = page.evaluate("(c => [c.clientWidth, c.clientHeight])(document.querySelector('#image'))")
    scale = min(np.array(size) / (box[1] - box[0]))
    assert drawn == pytest.approx(np.array(size) / 2 + scale * (given - box.mean(0)), abs=0.2)
    texts = page.evaluate("[...document.querySelectorAll('.row-values')].map(e => e.innerText)")
    right, left = flexion(TRUTH[3])[2:]
    assert texts[1].split() == ["right", f"{right:.0f}°", "left", f"{left:.0f}°"]
    assert texts[2] == f"{lean(TRUTH[3]):.0f}°" and texts[-1] == "0.50"


@pytest.mark.parametrize(
    ("key", "azimuth", "axis", "sign"), [("1", 0, 0, 1), ("2", 90, 2, 1), ("3", 180, 0, -1)]
)
def test_views(page: Page, tmp_path: Path, key: str, azimuth: int, axis: int, sign: int):
    """x, z and -x to the right, as `draw` has it, and y down; in perspective, so not to the
    pixel."""
    opened(page, tmp_path / "x.html", poses(), "#frame=9")
    assert state(page)["frame"] == 9
    page.key(key)
    page.until(f"(edmliftView.state().azimuth + 360) % 360 === {azimuth}")
    page.settle()
    drawn = np.array([point[:2] for point in page.evaluate("edmliftView.points().figure")])[:14]
    assert sign * np.corrcoef(drawn[:, 0], TRUTH[9, :, axis])[0, 1] > 0.96
    assert np.corrcoef(drawn[:, 1], TRUTH[9, :, 1])[0, 1] > 0.96


def test_keys_move_in_time(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses())
    for key, shift, frame in (("ArrowRight", False, 1), ("ArrowRight", True, 11),
                              ("ArrowLeft", False, 10),
                              ("End", False, 38), ("ArrowRight", True, 38),
                              ("Home", False, 0), ("ArrowLeft", True, 0)):  # fmt: skip
        page.key(key, shift)
        assert state(page)["frame"] == frame
    page.key(" ")
    page.until("edmliftView.state().frame > 5")
    assert state(page)["playing"]
    page.key(" ")
    stopped = state(page)
    assert not stopped["playing"]
    page.settle()
    assert state(page)["frame"] == stopped["frame"]


def test_it_plays_at_its_speed_and_rests(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses(), fps=10.0)
    page.click("#play")
    passed = page.evaluate(
        "new Promise(done => { const start = performance.now(); (function look() {"
        "edmliftView.state().frame >= 10 ? done(performance.now() - start)"
        ": requestAnimationFrame(look); })(); })"
    )
    assert 700 < passed < 2500  # a second, on a machine that may have more to do
    page.click("#play")
    drawn = state(page)["draws"]
    page.evaluate("new Promise(done => setTimeout(done, 200))")
    assert state(page)["draws"] <= drawn + 1  # nothing is drawn when nothing changes
    assert state(page)["milliseconds"] < 16  # 60 frames a second


def test_the_figure_turns_and_zooms(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses(), truth=TRUTH)
    x, y = page.middle("#figure")
    before = state(page)
    page.drag((x, y), (-60, 20))
    turned = state(page)
    assert turned["azimuth"] - before["azimuth"] == pytest.approx(30)
    assert turned["elevation"] - before["elevation"] == pytest.approx(8)
    page.wheel(x, y, -200)
    zoomed = state(page)
    assert zoomed["zoom"] > 1.2 and zoomed["azimuth"] == turned["azimuth"]
    page.wheel(x, y, 200, shift=True)
    assert state(page)["azimuth"] != turned["azimuth"]
    page.evaluate("document.querySelector('#figure').focus()")
    moved = state(page)
    page.key("ArrowRight")
    page.key("ArrowUp")
    assert state(page)["azimuth"] < moved["azimuth"]
    assert state(page)["elevation"] < moved["elevation"]
    assert state(page)["frame"] == 0  # the arrows are the figure's now
    page.key("0")
    page.until("edmliftView.state().zoom === 1")
    assert state(page)["azimuth"] % 360 == before["azimuth"] % 360
    page.click("[data-view=above]")
    page.until("edmliftView.state().elevation === 90")


def test_curves_and_slider_move_in_time(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses())
    page.click(".plot")
    assert state(page)["frame"] == 19
    x, y = page.middle(".plot")
    page.drag((x, y), (-2000, 0))
    assert state(page)["frame"] == 0
    page.click("#time")
    assert state(page)["frame"] == 19
    page.key("ArrowRight")  # the slider's own
    assert state(page)["frame"] == 20
    at, plot = page.evaluate(
        "['.cursor', '.plot'].map(s => document.querySelector(s).getBoundingClientRect().x)"
    )
    width = page.evaluate("document.querySelector('.plot').clientWidth")
    assert at - plot == pytest.approx(8 + 20 / 38 * (width - 16), abs=1)


def test_refused_frames_are_marked(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", gappy())
    link = page.evaluate("document.querySelector('#summary button').innerText")
    assert link == "4 without a pose"
    assert not page.evaluate("document.querySelector('#refusal').checkVisibility()")
    for frame in (5, 6, 7, 30, 5):
        page.key("r")
        assert state(page)["frame"] == frame
        assert page.evaluate("document.querySelector('#refusal').innerText") == (
            "no pose: too few joints"
        )
    label = page.evaluate("document.querySelector('#time').getAttribute('aria-valuetext')")
    assert label == "frame 5 of 39, 0.17 s, no pose: too few joints"
    width = page.evaluate("document.querySelector('#strip').clientWidth")
    for frame, marked in ((6, True), (30, True), (20, False), (3, False)):
        share = (8 + frame / 38 * (width - 16)) / width
        assert (pixel(page, "#strip", share, 0.25)[3] > 0) == marked
    box = page.evaluate("document.querySelector('#time').getBoundingClientRect().toJSON()")
    page.hover(box["x"] + 8 + 30 / 38 * (box["width"] - 16), box["y"] + 20)
    tip = page.evaluate("document.querySelector('.track .tip').innerText")
    assert tip == "frame 30, 1.00 s, no pose: too few joints"


def test_names_truth_and_tips(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", gappy(), truth=TRUTH)
    assert state(page)["truth"] and not state(page)["names"]
    page.click("#truth")
    page.key("n")
    assert not state(page)["truth"] and state(page)["names"]
    assert page.evaluate("document.querySelector('#names').getAttribute('aria-pressed')") == "true"
    for part, joint in (("image", 0), ("figure", 7)):
        box = page.evaluate(f"document.querySelector('#{part}').getBoundingClientRect().toJSON()")
        x, y = page.evaluate(f"edmliftView.points().{part}[{joint}].slice(0, 2)")
        page.hover(box["x"] + x, box["y"] + y)
        assert state(page)["hovered"] == joint
        tip = page.evaluate(f"document.querySelector('#{part}-panel .tip').innerText")
        x, y, z = TRUTH[0, joint]
        numbers = f"x {x:.3f}  y {y:.3f}  z {z:.3f} m".replace("-", "−")
        assert tip.splitlines()[:2] == [edmlift.JOINTS[joint].replace("_", " "), numbers]
    page.click("summary")
    page.settle()
    cells = page.evaluate("document.querySelectorAll('#joints tr')[4].innerText").split("\t")
    assert cells[0] == "right wrist" and cells[4] == "not seen"


def test_a_finger_shows_a_joint(page: Page, tmp_path: Path):
    page.resize(390, 844, mobile=True)
    opened(page, tmp_path / "x.html", poses())
    box = page.evaluate("document.querySelector('#image').getBoundingClientRect().toJSON()")
    x, y = page.evaluate("edmliftView.points().image[13]")
    point = {"x": box["x"] + x, "y": box["y"] + y}
    page.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[point])
    page.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    page.until("edmliftView.state().hovered === 13")
    assert "left ankle" in page.evaluate("document.querySelector('#image-panel .tip').innerText")


def test_the_dialog_of_keys(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses())
    page.key("?")
    assert page.evaluate("document.querySelector('#keys').open")
    page.key("ArrowRight")
    assert state(page)["frame"] == 0  # the page rests behind it
    page.key("Escape")
    assert not page.evaluate("document.querySelector('#keys').open")


def test_tab_reaches_everything_and_shows_where(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", gappy(), truth=TRUTH)
    reached = []
    for _ in range(40):
        page.key("Tab")
        if page.evaluate("document.activeElement === document.body"):
            break
        name, outline = page.evaluate(
            "(e => [e.id || e.ariaLabel || e.innerText, getComputedStyle(e).outlineStyle])"
            "(document.activeElement)"
        )
        assert name not in reached and outline == "solid", name
        reached.append(name)
    wanted = {"names", "truth", "help", "figure", "Camera", "Reset", "back", "play", "forward",
              "time", "speed", "Joints in this frame"}  # fmt: skip
    assert wanted <= set(reached)
    nameless = page.evaluate(
        "[...document.querySelectorAll('button, select, input, canvas')].filter(e => !(e.ariaLabel"
        "|| e.innerText?.trim() || e.labels?.length || e.ariaHidden)).map(e => e.outerHTML)"
    )
    assert nameless == []


def test_data_cannot_be_markup_in_a_browser(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", nasty(), title=NASTY)
    assert page.evaluate("document.title") == NASTY
    assert page.evaluate("document.querySelector('h1').textContent") == NASTY
    words = NASTY.replace("_", " ")
    assert page.evaluate("document.querySelector('#refusal').textContent") == f"no pose: {words}"
    assert page.evaluate("typeof window.hacked") == "undefined"
    assert page.evaluate("document.images.length") == 0


def test_the_policy_holds(page: Page, tmp_path: Path):
    """Neither another script nor an address gets past it."""
    opened(page, tmp_path / "x.html", poses())
    page.evaluate(
        "(() => { const s = document.createElement('script'); s.textContent = 'window.hacked = 1';"
        "document.body.append(s); })()"
    )
    assert page.evaluate("typeof window.hacked") == "undefined"
    fetched = page.evaluate("fetch('https://example.invalid/').then(() => 'got', () => 'refused')")
    assert fetched == "refused"
    assert len(page.errors) >= 2 and all("Content Security Policy" in e for e in page.errors)
    page.errors.clear()
    page.requests.clear()


@pytest.mark.parametrize("size", [(1280, 800), (844, 390), (390, 844), (320, 568)])
def test_it_fits_the_screen(page: Page, tmp_path: Path, size: tuple[int, int]):
    page.resize(*size, mobile=size[0] < 1000)
    opened(page, tmp_path / "x.html", gappy(), truth=TRUTH, title="A walk, lifted from 2D joints")
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    for part in ("#image", "#figure", ".plot"):
        box = page.evaluate(f"document.querySelector('{part}').getBoundingClientRect().toJSON()")
        assert box["width"] > 100 and box["height"] >= 40
    play = page.evaluate("document.querySelector('#play').getBoundingClientRect().toJSON()")
    assert play["y"] > 0 and play["bottom"] <= size[1]  # without scrolling
    if size == (1280, 800):
        assert page.evaluate("document.documentElement.scrollHeight") <= size[1]


def test_light_and_dark(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses())
    backgrounds = []
    for scheme in ("light", "dark"):
        page.scheme(scheme)
        page.settle()
        page.settle()
        backgrounds.append(pixel(page, ".plot canvas", 0.5, 0.1)[:3])
    assert min(backgrounds[0]) > 230 and max(backgrounds[1]) < 50


@pytest.mark.slow
def test_a_picture_is_behind_the_joints(page: Page, tmp_path: Path):
    pytest.importorskip("PIL.Image", reason="no Pillow")
    colours = [(200, 60, 40), (40, 60, 200)]
    given = [photo(colours[frame % 2], 1000) for frame in range(4)]
    opened(page, tmp_path / "x.html", poses(4), pictures=given)
    for frame in (0, 1, 3):
        page.evaluate(f"edmliftView.go({frame})")
        page.settle()
        shown = pixel(page, "#image", 0.02, 0.9)[:3]
        wanted = 0.82 * np.array(colours[frame % 2])  # darkened a little
        assert np.abs(shown - wanted).max() < 6


@pytest.mark.slow
def test_one_pose_has_no_time_line(page: Page, tmp_path: Path):
    opened(page, tmp_path / "x.html", poses(1))
    assert not page.evaluate("document.querySelector('#transport').checkVisibility()")
    assert page.evaluate("document.querySelector('.row-values').innerText").count("°") == 2
    page.key(" ")
    assert not state(page)["playing"]


@pytest.mark.long
def test_an_hour_opens(page: Page, tmp_path: Path):
    hour = np.arange(HOUR) % FRAMES
    status = np.where(np.arange(HOUR) % 5000 == 4999, "degenerate", "ok")
    recording = edmlift.Poses.of(TRUTH[hour], WALK[hour], status)
    opened(page, tmp_path / "x.html", recording, truth=TRUTH[hour])
    assert page.evaluate("performance.now()") < 20_000  # about 1 s on an idle core
    page.key("r")
    assert state(page)["frame"] == 4999
    options = page.evaluate("[...document.querySelector('#span').options].map(o => o.text)")
    assert options == ["all", "1 min", "10 s", "3 s"]
    page.evaluate(
        "(s => { s.value = 300; s.dispatchEvent(new Event('change')); })"
        "(document.querySelector('#span'))"
    )
    page.click(".plot")
    assert state(page)["frame"] == pytest.approx(4999, abs=1)  # it is in the middle now
