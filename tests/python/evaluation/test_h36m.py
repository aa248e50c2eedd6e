"""Human3.6M and HumanEva-I, on small files made up here in the layout of VideoPose3D."""

import io
import json
import os
import pickle
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
from builds import long_but
from support import run_tool

from data.array_pickles import load_arrays
from data.h36m import H36M, HUMANEVA, read_cameras, read_positions
from data.mocap import MocapError, load_motion
from data.views import Column
from edmlift.joints import INDEX, JOINTS, indices
from edmlift.library import Library, Poses
from evaluation import h36m

# A standing person, metres, facing -y, z up; x is the person's left.
STANDING = {
    "head": (0, 0, 1.65),
    "neck_base": (0, 0, 1.42),
    "right_shoulder": (-0.18, 0, 1.42),
    "right_elbow": (-0.22, 0, 1.14),
    "right_wrist": (-0.22, -0.1, 0.9),
    "left_shoulder": (0.18, 0, 1.42),
    "left_elbow": (0.22, 0, 1.14),
    "left_wrist": (0.22, -0.1, 0.9),
    "right_hip": (-0.12, 0, 0.92),
    "right_knee": (-0.12, -0.03, 0.5),
    "right_ankle": (-0.12, 0, 0.08),
    "left_hip": (0.12, 0, 0.92),
    "left_knee": (0.12, -0.03, 0.5),
    "left_ankle": (0.12, 0, 0.08),
}
# Where the two projects' sources say that each joint is.
PLACES = {
    "h36m": "15 13 25 26 27 17 18 19 1 2 3 6 7 8",
    "humaneva": "14 1 5 6 7 2 3 4 11 12 13 8 9 10",
}
LAYOUTS = {"h36m": H36M, "humaneva": HUMANEVA}


def walk(name: str, frames: int, seed: int) -> np.ndarray:
    """Somebody who swings the limbs and turns, [F,N,3] as the files have it."""
    rng = np.random.default_rng(seed)
    pose = np.array([STANDING[joint] for joint in JOINTS]) + rng.normal(0, 0.01, (14, 3))
    poses = np.repeat(pose[None], frames, 0)
    swing = 0.3 * np.sin(np.arange(frames) / 4 + seed)
    for joint, sign in (("wrist", 1), ("elbow", 0.5), ("ankle", -1), ("knee", -0.5)):
        poses[:, INDEX[f"right_{joint}"], 1] += sign * swing
        poses[:, INDEX[f"left_{joint}"], 1] -= sign * swing
    turn = np.arange(frames) / 30 + seed
    c, s, zero = np.cos(turn), np.sin(turn), np.zeros(frames)
    about_z = np.array([[c, -s, zero], [s, c, zero], [zero, zero, zero + 1]])
    raw = np.full((frames, LAYOUTS[name].keypoints, 3), 7.0)  # no joint of ours: far off
    raw[:, list(map(int, PLACES[name].split()))] = np.einsum("ijf,fkj->fki", about_z, poses)
    return raw.astype(np.float32)


def made_up(name: str, frames: int = 70) -> dict:
    if name == "h36m":
        subjects = ("S1", "S5", "S6", "S7", "S8", "S9", "S11")
        sequences = [f"{a}{take}" for a in h36m.H36M_ACTIONS for take in ("", " 1")]
    else:
        subjects = tuple(f"{side}/S{n}" for side in ("Train", "Validate") for n in (1, 2, 3))
        sequences = ["Walking 1 chunk0", "Walking 1 chunk2", "Jog 1 chunk0", "Box 1 chunk0"]
        sequences += ["Gestures 1 chunk0"]
    return {
        subject: {s: walk(name, frames, 31 * i + j) for j, s in enumerate(sequences)}
        for i, subject in enumerate(subjects)
    }


def camera_tables(name: str) -> dict:
    """Cameras at four sides, 4 m away and 1.5 m up: x along, y down, z towards the middle."""
    intrinsic, extrinsic = [], []
    ids = ("54138969", "55011271", "58860488", "60457274") if name == "h36m" else ("C1", "C2", "C3")
    for i, camera in enumerate(ids):
        half = np.pi * i / len(ids)
        # A quarter turn about x, from z up to z ahead, then i/N of a turn about the world's z.
        quarter = np.sqrt(0.5)
        q = [quarter * np.cos(half), -quarter * np.cos(half), -quarter * np.sin(half)]
        place = [4000 * np.sin(2 * half), -4000 * np.cos(2 * half), 1500]
        lens = {
            "focal_length": [1145.0, 1143.0],
            "center": [512.0, 515.0],
            "radial_distortion": [-0.2, 0.24, -0.003],
            "tangential_distortion": [-0.001, -0.0014],
        }
        intrinsic.append({"id": camera, **(lens if name == "h36m" else {})})
        extrinsic.append({"orientation": [*q, quarter * np.sin(half)], "translation": place})
    people = ("S1", "S5", "S6", "S7", "S8", "S9", "S11") if name == "h36m" else ("S1", "S2", "S3")
    places = {person: extrinsic for person in people} | {"S4": [{} for _ in ids]}
    kinds = (("intrinsic", intrinsic), ("extrinsic", places))
    return {f"{name}_cameras_{kind}_params": value for kind, value in kinds}


def write_positions(path: Path, positions) -> Path:
    np.savez_compressed(path, positions_3d=positions)
    return path


def write_cameras(path: Path, name: str) -> Path:
    tables = json.loads(json.dumps(camera_tables(name), default=float))
    if path.suffix == ".json":
        path.write_text(json.dumps(tables))
    else:
        lines = [f"{key} = {value!r}" for key, value in tables.items()]
        path.write_text("\n".join(["raise SystemExit('read, not run')", *lines]))
    return path


DATA_SETS = ["h36m", "humaneva"]


@pytest.fixture(scope="module", params=DATA_SETS)
def files(request, tmp_path_factory) -> tuple[str, Path, Path]:
    """Name, positions and cameras of a data set."""
    folder = tmp_path_factory.mktemp(request.param)
    positions = write_positions(folder / "data_3d.npz", made_up(request.param))
    return (
        request.param,
        positions,
        write_cameras(folder / f"{request.param}_dataset.py", request.param),
    )


# Loaders


def test_joints_are_ours_and_y_points_up(files):
    name, positions, _ = files
    data = read_positions(positions, LAYOUTS[name])
    raw = made_up(name)
    assert {s: list(v) for s, v in data.items()} == {s: list(v) for s, v in raw.items()}
    for subject in data:
        for sequence, joints in data[subject].items():
            x, y, z = np.moveaxis(raw[subject][sequence], -1, 0)
            ours = list(map(int, PLACES[name].split()))
            np.testing.assert_allclose(joints, np.stack([x, z, -y], -1)[:, ours], atol=1e-6)
            left = joints[:, INDEX["left_hip"]] - joints[:, INDEX["right_hip"]]
            up = joints[:, INDEX["neck_base"]] - joints[:, INDEX["right_hip"]]
            ahead = joints[:, INDEX["right_wrist"]] + joints[:, INDEX["left_wrist"]]
            ahead -= joints[:, INDEX["right_elbow"]] + joints[:, INDEX["left_elbow"]]
            assert (np.einsum("fi,fi->f", np.cross(left, up), ahead) > 0).all()  # not mirrored


def test_the_h36m_joints_are_those_of_the_adapter():
    """The 17 that VideoPose3D keeps of 32, in the order of edml_h36m17_right_first."""
    kept = [0, 1, 2, 3, 6, 7, 8, 12, 13, 14, 15, 17, 18, 19, 25, 26, 27]
    layout = Library().format("h36m17_right_first")
    assert [kept[i] for i in layout.limb] == list(H36M.joints[2:])
    assert kept[layout.centre] == H36M.joints[INDEX["head"]]


def by_quaternion(q: list[float], v: np.ndarray) -> np.ndarray:
    """VideoPose3D's world to camera: turned by the inverse of q, w x y z."""
    w, u = q[0], -np.array(q[1:])
    return v + 2 * w * np.cross(u, v) + 2 * np.cross(u, np.cross(u, v))


def test_cameras_see_what_videopose3d_says_they_see(files):
    name, positions, cameras = files
    tables = camera_tables(name)
    raw = made_up(name)
    data = read_positions(positions, LAYOUTS[name])
    subject = list(raw)[-1]
    sequence = list(raw[subject])[0]
    person = subject.rpartition("/")[2]
    rig = read_cameras(cameras, LAYOUTS[name])
    ours = list(map(int, PLACES[name].split()))
    assert "S4" not in rig and len(rig[person]) == len(tables[f"{name}_cameras_intrinsic_params"])
    for camera, where in zip(
        rig[person], tables[f"{name}_cameras_extrinsic_params"][person], strict=True
    ):
        moved = raw[subject][sequence][:, ours] - np.array(where["translation"]) / 1000
        expected = by_quaternion(where["orientation"], moved)
        seen = camera.look(data[subject][sequence])
        np.testing.assert_allclose(seen, expected, atol=1e-6)
        assert (seen[..., 2] > 2).all() and (np.diff(seen[:, [0, 10], 1]) > 1).all()  # y down


def test_a_lens_bends_as_browns_model_says(files):
    name, _, cameras = files
    camera = next(iter(read_cameras(cameras, LAYOUTS[name]).values()))[0]
    x, y = 0.2, -0.3
    (pixel,) = camera.project(np.array([[x * 4, y * 4, 4.0]]))
    if name == "humaneva":  # no lens given
        assert pixel == pytest.approx([1145 * x + 500, 1145 * y + 500])
        return
    r2 = x * x + y * y
    k, (p1, p2) = 1 - 0.2 * r2 + 0.24 * r2**2 - 0.003 * r2**3, (-0.001, -0.0014)
    bent = [
        x * k + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * k + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    ]
    assert pixel == pytest.approx([1145 * bent[0] + 512, 1143 * bent[1] + 515])


def test_cameras_as_json_are_the_same(files, tmp_path):
    name, _, cameras = files
    other = read_cameras(write_cameras(tmp_path / "c.json", name), LAYOUTS[name])
    for subject, rig in read_cameras(cameras, LAYOUTS[name]).items():
        for one, two in zip(rig, other[subject], strict=True):
            assert one.name == two.name and np.array_equal(one.axes, two.axes)


# Errors

PERSON = {"S1": {"Walking": walk("h36m", 5, 0)}}


def changed(change) -> dict:
    joints = PERSON["S1"]["Walking"].copy()
    return {"S1": {"Walking": change(joints)}}


def with_nan(joints: np.ndarray) -> np.ndarray:
    joints[3, 26] = np.nan
    return joints


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        (changed(lambda j: j * 1000), "S1: the unit is not metres: head to ankle is 15"),
        (changed(lambda j: j[..., [0, 2, 1]]), "S1: z does not point up"),
        (changed(lambda j: -j), "S1: z does not point up"),
        (changed(with_nan), "S1, 'Walking': frame 3, right_elbow is not finite"),
        (changed(lambda j: j[:, :17]), r"S1, 'Walking': shape \(5, 17, 3\), must be \(F, 32, 3\)"),
        (changed(lambda j: j[:0]), "S1, 'Walking': no frames"),
        (changed(lambda j: None), "S1, 'Walking': shape None"),
        ({"S1": 3}, "S1 is not a dictionary of sequences"),
        ({}, "positions_3d is not a dictionary"),
        (np.zeros((5, 32, 3)), "not a dictionary"),
        ({"S1": {"Walking": Path("somewhere")}}, "which is no array"),
    ],
)
def test_what_is_no_pose_is_refused_by_name(tmp_path, positions, message):
    path = write_positions(tmp_path / "bad.npz", positions)
    with pytest.raises(MocapError, match=message) as error:
        read_positions(path, H36M)
    assert str(path) in str(error.value)


def pickled(payload: bytes, path: Path) -> Path:
    """A file whose positions_3d is this pickle."""
    header = io.BytesIO()
    described = {"descr": "|O", "fortran_order": False, "shape": ()}
    np.lib.format.write_array_header_1_0(header, described)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("positions_3d.npy", header.getvalue() + payload)
    return path


class Reduced:
    """Pickles as a call, and perhaps a state."""

    def __init__(self, *parts):
        self.parts = parts

    def __reduce__(self):
        return self.parts


POINTERS = b"A" * 768
PARTS = (3, "|", None, ("a",), {"a": (np.dtype("O"), 0)}, 8, 1, 0)  # objects that hide in a field
HIDDEN = Reduced(np.dtype, ("V8", False, True), PARTS)
RECONSTRUCT, BEGUN = np.zeros(1).__reduce__()[:2]


@pytest.mark.parametrize(
    "sequence",
    [
        Reduced(np._core.numeric._frombuffer, (POINTERS, HIDDEN, (1, 32, 3), "C")),
        Reduced(np._core.numeric._frombuffer, (POINTERS, np.dtype("O"), (1, 32, 3), "C")),
        Reduced(RECONSTRUCT, BEGUN, (1, (1, 32, 3), np.dtype("O"), False, POINTERS)),
        Reduced(RECONSTRUCT, BEGUN, (1, (1, 32, 3), HIDDEN, False, POINTERS)),
        Reduced(np._core.multiarray.scalar, (np.dtype("f8"), b"short")),
        [[[[[[[1.0]]]]]]],
    ],
)
def test_pointers_of_a_pickle_are_not_followed(sequence, tmp_path):
    outer = np.empty((), object)
    outer[()] = {"S1": {"Walking": sequence}}
    path = pickled(pickle.dumps(outer, protocol=2), tmp_path / "evil.npz")
    with pytest.raises(MocapError, match="not readable"):
        read_positions(path, H36M)


@pytest.mark.parametrize(
    "payload", [b"]p99999999999\n.", b"\x80\x02]r\xff\xff\xff\x7f.", b"]q\x02.", b"]p-1\n."]
)
def test_what_a_pickle_remembers_takes_no_memory(payload, tmp_path):
    """Room for 99,999,999,999 things that were seen before, of which there is one."""
    path = pickled(payload, tmp_path / "evil.npz")
    with pytest.raises(MocapError, match="not readable .* remembers thing -?[0-9]+ of [12]"):
        read_positions(path, H36M)


def test_a_list_that_is_in_many_places_is_read_once():
    """A thousand times the same list of a thousand times the same: 10^12 numbers in a few bytes."""
    thing = [1.0]
    for _ in range(3):
        thing = [thing] * 10_000
    found = load_arrays(pickle.dumps(thing))
    assert len(found) == 10_000 and found[0] is found[-1] and found[0][0] == [[1.0]] * 10_000


def test_an_array_that_is_in_many_places_takes_the_memory_of_many(tmp_path):
    outer = np.empty((), object)
    array = np.zeros((1000, 32, 3), np.float32)
    outer[()] = {"S1": {f"Walking {n}": array for n in range(3000)}}
    path = pickled(pickle.dumps(outer, protocol=4), tmp_path / "same.npz")
    with pytest.raises(MocapError, match="everything together takes 2197 MB, at most 2048"):
        read_positions(path, H36M)


def test_other_files_are_refused(tmp_path):
    path = tmp_path / "bad.npz"
    with pytest.raises(MocapError, match="no such file; for Human3.6M, register at the Human3.6M"):
        read_positions(path, H36M)
    with pytest.raises(MocapError, match="no such file; for HumanEva-I, register at the HumanEva"):
        read_positions(path, HUMANEVA)
    path.write_text("no archive")
    with pytest.raises(MocapError, match="not readable"):
        read_positions(path, H36M)
    np.savez(path, joints=np.zeros(3))
    with pytest.raises(MocapError, match="as VideoPose3D's layout has it"):
        read_positions(path, H36M)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\n", "no table h36m_cameras_intrinsic_params"),
        ("h36m_cameras_intrinsic_params = open('x')\n", "neither Python nor JSON"),
        ("def (\n", "neither Python nor JSON"),
        (
            "h36m_cameras_intrinsic_params = [{'id': '1'}]\n"
            "h36m_cameras_extrinsic_params = {'S1': [{'orientation': [1, 0, 0]}]}\n",
            "not cameras as VideoPose3D has them .*4 finite numbers",
        ),
    ],
)
def test_other_cameras_are_refused(tmp_path, text, message):
    path = tmp_path / "cameras.py"
    with pytest.raises(MocapError, match="no such file; take common/h36m_dataset.py"):
        read_cameras(path, H36M)
    path.write_text(text)
    with pytest.raises(MocapError, match=message):
        read_cameras(path, H36M)


LENS = '{"id": "1", "center": [512, %s], "focal_length": [1145, 1143]}'


@pytest.mark.parametrize("suffix", ["json", "py"])
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[" * 5000, "neither Python nor JSON"),
        ("{'a':" * 5000, "neither Python nor JSON"),
        ("5", "no table h36m_cameras_intrinsic_params"),
        (LENS % ("9" * 400), "not cameras as VideoPose3D has them"),
        (LENS % ("[" * 500), "neither Python nor JSON"),
    ],
)
def test_cameras_of_anything_are_refused_in_a_line(tmp_path, suffix, text, message):
    """Too deep for Python's recursion, no tables, and numbers too large for a float."""
    names = "h36m_cameras_intrinsic_params", "h36m_cameras_extrinsic_params"
    if text.startswith('{"id"'):
        place = '{"S1": [{"orientation": [1, 0, 0, 0], "translation": [1, 2, 3]}]}'
        tables = f"[{text}]", place
        if suffix == "json":
            pairs = zip(names, tables, strict=True)
            text = "{" + ", ".join(f'"{name}": {table}' for name, table in pairs) + "}"
        else:
            text = "".join(f"{n} = {table}\n" for n, table in zip(names, tables, strict=True))
    path = tmp_path / f"cameras.{suffix}"
    path.write_text(text)
    with pytest.raises(MocapError, match=message) as error:
        read_cameras(path, H36M)
    assert "\n" not in str(error.value)


def test_cameras_of_gigabytes_are_refused(tmp_path):
    path = tmp_path / "cameras.py"
    path.touch()
    os.truncate(path, 1 << 40)
    with pytest.raises(MocapError, match="the file takes 1048576 MB, at most 1 are read"):
        read_cameras(path, H36M)


# Protocols


@pytest.mark.parametrize(
    ("number", "people", "views_a_pose", "every"),
    [(1, {9, 11}, 4, 8), (2, {9, 11}, 1, 8), (3, {11}, 1, 64)],
)
def test_protocols_take_what_the_paper_says(tmp_path, number, people, views_a_pose, every):
    protocol = h36m.H36M_PROTOCOLS[number]
    data = read_positions(write_positions(tmp_path / "d.npz", made_up("h36m")), H36M)
    rig = read_cameras(write_cameras(tmp_path / "c.py", "h36m"), H36M)
    motion = h36m.test_motion(data, protocol)
    assert set(motion.subject) == people and (motion.frame % every == 0).all()
    assert len(motion.joints) == len(people) * 15 * 2 * len(range(0, 70, every))
    views = h36m.project(motion, rig, protocol)
    assert len(views.truth) == views_a_pose * len(motion.joints)
    if views_a_pose == 1:
        first = motion.joints[motion.subject == min(people)].astype(float)
        seen = rig[f"S{min(people)}"][3].look(first)
        np.testing.assert_array_equal(views.truth[: len(first)], seen)
    trained = {h36m.number_of(s) for s in protocol.train}
    assert trained == {1, 5, 6, 7, 8} | ({9} if number == 3 else set())
    assert not trained & people


def test_the_papers_rows_have_its_averages():
    for protocol in (*h36m.H36M_PROTOCOLS.values(), h36m.HUMANEVA):
        for _, row in protocol.paper:
            size = 3 if protocol.by_person else 15
            blocks = np.reshape(row, (-1, size + 1))
            assert len(row) == len(h36m.with_averages([0.0] * (len(blocks) * size), protocol))
            np.testing.assert_allclose(blocks[:, :-1].mean(1), blocks[:, -1], atol=0.02)


class Known:
    """A lifter whose answer is prepared."""

    def __init__(self, joints: np.ndarray):
        self.joints = joints

    def lift(self, keypoints):
        status = np.where(np.isnan(self.joints).any((1, 2)), "degenerate", "ok")
        return Poses.of(self.joints, status=status)


def test_figures_are_of_each_column_and_of_hidden_joints():
    truth = np.random.default_rng(0).normal(0, 0.4, (6, 14, 3))
    lifted = truth @ [[0, 1, 0], [0, 0, 1], [1, 0, 0]] + [1, 2, 3]
    lifted[3:] *= [1, 1, -1]
    lifted[5] = np.nan
    seen = np.ones((6, 14), bool)
    seen[:, INDEX["left_knee"]] = False
    views = h36m.Views(truth, truth[..., :2], np.repeat([0, 1], 3), ["a", "b"])
    condition = Column(np.ones((6, 14, 3)), seen, truth)
    figures = h36m.measure(Known(lifted), condition, views, adapted=False)
    assert figures["error"][0] == pytest.approx(0, abs=1e-3) and figures["error"][1] > 50
    assert figures["mirror"] == pytest.approx([0, 0], abs=1e-3)
    assert figures["hidden"][0] == pytest.approx(0, abs=1e-3) and figures["hidden"][1] > 0
    assert figures["refused"] == [0, 1]
    lifted[3:] = np.nan
    with pytest.raises(MocapError, match="every pose of 'b' was refused"):
        h36m.measure(Known(lifted), condition, views, adapted=False)


def test_the_adapter_moves_head_and_neck_alone():
    keypoints = np.random.default_rng(1).normal(500, 90, (9, 14, 3))
    keypoints[..., 2] = 1
    keypoints[3, INDEX["left_knee"]] = 0
    adapted = h36m.adapt(Library(), keypoints)
    np.testing.assert_allclose(adapted[:, 2:], keypoints[:, 2:], rtol=1e-6)
    s = keypoints[:, indices(("right_shoulder", "left_shoulder")), :2].mean(1)
    h = keypoints[:, indices(("right_hip", "left_hip")), :2].mean(1)
    np.testing.assert_allclose(adapted[:, INDEX["neck_base"], :2], s + 0.12 * (h - s), rtol=1e-2)


# The command


def command(*options) -> subprocess.CompletedProcess:
    return run_tool("evaluate.py", "h36m", *options)


def rows_of(text: str) -> dict[str, list[str]]:
    cells = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines()]
    return {row[0]: row[1:] for row in cells}


def options_of(files) -> list:
    name, positions, cameras = files
    protocol = ["--protocol", 3] if name == "h36m" else []
    return [name, positions, "--cameras", cameras, *protocol]


def test_one_command_prints_the_table(files, tmp_path):
    done = command(*options_of(files), "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "table.md").read_text() == done.stdout
    rows = rows_of(done.stdout)
    blocks, size = (1, 15) if files[0] == "h36m" else (3, 3)
    for name in ("gt", "n20", "cpm", "rand2", "left_arm, hidden joints"):
        figures = np.reshape(list(map(float, rows[name])), (blocks, size + 1))
        assert figures.min() > 0 and figures.max() < 500
        np.testing.assert_allclose(figures[:, :-1].mean(1), figures[:, -1], atol=0.11)
    assert float(rows["n20"][-1]) > float(rows["gt"][-1])
    assert float(rows["gt, better mirror image"][-1]) <= float(rows["gt"][-1])
    assert any(row.startswith("the paper's FConv") for row in rows)
    people = {1, 5, 6, 7, 8, 9} if files[0] == "h36m" else {1, 2, 3}
    assert set(load_motion(tmp_path / "test.npz").subject) == ({11} if len(people) == 6 else people)
    assert set(load_motion(tmp_path / "train.npz").subject) == people


@pytest.mark.slow
@pytest.mark.parametrize("files", long_but(["h36m"], DATA_SETS), indirect=True)
def test_training_uses_the_training_people(files, tmp_path):
    done = command(*options_of(files), "--train", "--epochs", 1, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    manifest = json.loads((tmp_path / "trained.json").read_text())
    (motion,) = manifest["data"]["files"]
    assert motion["subjects"] == ([1, 5, 6, 7, 8, 9] if files[0] == "h36m" else [1, 2, 3])
    assert float(rows_of(done.stdout)["gt"][-1]) > 0
    untrained = command(*options_of(files), "--out", tmp_path / "shipped")
    assert rows_of(untrained.stdout)["gt"] != rows_of(done.stdout)["gt"]


def test_a_missing_action_or_person_is_named(tmp_path):
    cameras = write_cameras(tmp_path / "c.py", "h36m")
    options = ["h36m", tmp_path / "d.npz", "--cameras", cameras, "--protocol", 3, "--out", tmp_path]
    people = made_up("h36m", 3)
    del people["S11"]["Photo"], people["S11"]["Photo 1"]
    write_positions(tmp_path / "d.npz", people)
    done = command(*options)
    assert done.returncode == 1 and "S11 has no sequence 'Photo'" in done.stderr
    del people["S11"]
    write_positions(tmp_path / "d.npz", people)
    done = command(*options)
    assert done.returncode == 1 and "no subject S11; there are S1, S5" in done.stderr
    done = command(*options, "--action", "Dancing")
    assert done.returncode == 1 and "no action 'Dancing'; there are Directions" in done.stderr
    done = command(*options[:4])
    assert done.returncode == 1 and "--protocol 1, 2 or 3 goes with h36m" in done.stderr
