"""Keypoints and poses from anywhere: each file is read, or refused in one line."""

import json
from pathlib import Path

import numpy as np
import pytest
from fuzzed import CASES, check_message, file_of, files, fuzzed, run_quietly
from hypothesis import strategies as st
from support import need_library

import edmlift
from edmlift import cli
from edmlift.formats import FORMATS

MESSAGES = (edmlift.FileError, ValueError)
NAMES = ["keypoints", "people", "instances", "landmarks", "annotations", "keypoint_scores", "t"]
NAMES += ["status", "joints", "id", "track_id", "frame", "image_id", "x", "y", "visible", "score"]
FORMAT = st.sampled_from([None, None, "coco17", "body25", "blazepose33", "movenet17"])
POSE = [[500 + 10 * n, 300 + 7 * n * n % 90, 0.9] for n in range(33)]


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def small(name: str) -> bytes:
    """The beginning of one of the cases: what detectors write."""
    return (CASES / name).read_bytes()[:3000]


# ---- Lines of numbers ----------------------------------------------------------------------------

CSV_SEEDS = [small(p.name) for p in sorted(CASES.glob("*.csv")) if p.stat().st_size < 100_000]
CSV_WORDS = [b",", b"\n", b" ", b"\t", b"#", b"nan", b"inf", b"-1", b"1e39", b"null", b'"', b"x0"]
CSV_WORDS += [b"1_0", b"\xc2\xb2", b"\xff", b"\xef\xbb\xbf", b"status,", b"9" * 400, b"\0", b"-"]


@fuzzed(st.tuples(files(CSV_SEEDS, CSV_WORDS), FORMAT))
def test_keypoints_csv(given: tuple[bytes, str | None]) -> None:
    data, name = given
    with file_of(data, "keypoints.csv") as path:
        check_reading(path, name)


def check_reading(path: Path, name: str | None) -> None:
    """Both readers take or refuse a file; what is skipped is none of the people."""
    count = 14 if name is None else FORMATS[name]
    try:
        points = edmlift.read_keypoints(path, name)
        assert points.dtype == np.float32 and points.shape[1:] == (count, 3)
    except MESSAGES as error:
        check_message(error)
        points = None
    try:
        found = edmlift.read_detections(path, name, bad_lines="skip")
        assert found.keypoints.shape[1:] == (count, 3)
        assert len(found.frame) == len(found) and found.frames >= len(set(found.frame))
        if points is not None:
            assert len(found) <= len(points)
    except MESSAGES as error:
        check_message(error)


# ---- JSON ----------------------------------------------------------------------------------------

JSON_SEEDS = [
    small(p.name) for suffix in ("json", "jsonl") for p in sorted(CASES.glob(f"*.{suffix}"))
]
JSON_WORDS = [word.encode() for word in '{ } [ ] , : " null NaN 1e999 -Infinity # \\u0073'.split()]
JSON_WORDS += [f'"{name}":'.encode() for name in NAMES] + [b"\n", b"\xff", b"[[", b"\\ud800"]
NUMBERS = st.one_of(
    st.integers(-10, 2000), st.floats(width=32), st.sampled_from([1e308, 1e39, 10**40])
)
SETS = st.one_of(
    st.builds(
        lambda n, m: [point[:m] for point in POSE[:n]],
        st.sampled_from([0, 13, 14, 17, 25, 33]),
        st.integers(1, 4),
    ),
    st.builds(lambda n: [v for point in POSE[:n] for v in point], st.sampled_from([14, 17, 25])),
    st.builds(lambda n: [{"x": x, "y": y, "visibility": c} for x, y, c in POSE[:n]], st.just(14)),
    st.builds(lambda n: {"x": [1.0] * n, "y": [2.0] * n}, st.sampled_from([13, 14])),
)
LEAVES = st.one_of(st.none(), st.booleans(), NUMBERS, st.text(max_size=4), SETS)
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.sampled_from(NAMES), inner, max_size=5)
    ),
    max_leaves=12,
)
TEXTS = st.builds(
    lambda values, indent: "\n".join(json.dumps(v, indent=indent) for v in values).encode(),
    st.lists(VALUES, min_size=1, max_size=4),
    st.sampled_from([None, None, 1]),
)


@fuzzed(st.tuples(st.one_of(files(JSON_SEEDS, JSON_WORDS), TEXTS), FORMAT))
def test_keypoints_json(given: tuple[bytes, str | None]) -> None:
    data, name = given
    with file_of(data, "keypoints.json") as path:
        check_reading(path, name)


# ---- The command line ----------------------------------------------------------------------------


@fuzzed(st.one_of(files(CSV_SEEDS, CSV_WORDS), files(JSON_SEEDS, JSON_WORDS), TEXTS), examples=25)
def test_lift_command(data: bytes) -> None:
    """The answer is whole, and poses can be read from it; or there is none, and a line says why."""
    as_json = data[:1] in (b"{", b"[")
    with file_of(data, "in.jsonl" if as_json else "in.csv") as path:
        out = path.with_name("out.jsonl" if as_json else "out.csv")
        status, printed, messages = run_quietly(cli.main, "lift", path, "-o", out)
        assert status in (0, 1) and printed == ""
        assert status == 0 or messages
        if not out.exists():
            assert status == 1 and messages.count("\n") == 1
            return
        poses = edmlift.read_poses(out)
        assert np.isfinite(poses.joints[poses.ok]).all()
        if as_json:
            for line in out.read_text("utf-8").splitlines():
                assert isinstance(json.loads(line), dict)


# ---- Lifted poses --------------------------------------------------------------------------------

LINE = ",".join(["ok", *(f"{n / 50:.3f}" for n in range(42)), "0.02"])
TRUTH = ",".join(f"{n / 50:.3f}" for n in range(42))
OBJECT = json.dumps({"status": "ok", "joints": [[0.1, n / 9, 2] for n in range(14)], "misfit": 0.1})
POSES = [
    f"{LINE}\n{LINE}\n".encode(),
    f"nobody{',' * 43}\n{LINE}\n".encode(),
    f"{TRUTH}\n".encode(),
]
POSE_OBJECTS = [f"{OBJECT}\n{OBJECT}\n".encode(), b'{"status":"degenerate"}\n']


@fuzzed(st.one_of(files(POSES, CSV_WORDS), files(POSE_OBJECTS, JSON_WORDS)))
def test_poses(data: bytes) -> None:
    name = "poses.jsonl" if data[:1] == b"{" else "poses.csv"
    with file_of(data, name) as path:
        for read in (edmlift.read_poses, edmlift.read_truth):
            try:
                read(path)
            except MESSAGES as error:
                check_message(error)


@fuzzed(
    st.tuples(files(POSES[:2], CSV_WORDS, most=3), st.sampled_from("trc bvh glb csv c3d".split())),
    examples=25,
)
def test_motion_files(given: tuple[bytes, str]) -> None:
    """A motion file of any poses is whole, or there is none."""
    data, suffix = given
    with file_of(data, "poses.csv") as path:
        out = path.with_name(f"out.{suffix}")
        status, printed, messages = run_quietly(cli.main, "convert", path, "-o", out, "--fps", "30")
        assert status in (0, 1) and printed == ""
        assert out.exists() == (status == 0) and (status == 0 or messages.count("\n") == 1)
        assert [p.name for p in path.parent.iterdir() if p not in (path, out)] == []
