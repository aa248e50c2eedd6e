"""Motion files, read back by other readers than the writers' packages."""

import json
import os
import shutil
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from package_support import DATA, ROOT, WALK, need_library

import edmlift
from edmlift.cli import main
from edmlift.joints import INDEX, mid_hip
from edmlift.motion import bones
from edmlift.motion.bvh import _continuous, _euler
from edmlift.motion.gltf import _quaternions

CASES = ROOT / "tests" / "python" / "cases"
TRUTH = edmlift.read_truth(DATA / "walk_truth.csv")
CAMERA = (1145, 1145, 500, 500)  # of the walk: 1.5 m above the floor, level but for
PITCH = np.radians(8.5)
UP = np.array([0, -np.cos(PITCH), -np.sin(PITCH)])
LEVEL = (0, -1, 0)
FPS = 30
REFUSED = 7  # the frame of `lifted` that has no pose
TREES = (".bvh", ".glb")
ANKLE = 0.07  # metres above the floor
COORDINATES = [f"{joint}_{axis}" for joint in edmlift.JOINTS for axis in "xyz"]


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


@pytest.fixture(scope="module")
def lifted() -> edmlift.Poses:
    """The walk, with a frame in which nobody was seen."""
    need_library()
    keypoints = WALK.copy()
    keypoints[REFUSED, :, 2] = 0
    return edmlift.lift(keypoints)


def true_walk() -> edmlift.Poses:
    return edmlift.Poses.of(TRUTH, WALK)


def write(path: Path, poses: edmlift.Poses, **options: object) -> Path:
    """A motion file; frames that are held are no news here."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        edmlift.write_motion(path, poses, **({"fps": FPS} | options))
    return path


def y_up(joints: np.ndarray) -> np.ndarray:
    """Joints in the axes of motion files, from mid-hip, before a level camera."""
    return joints * [1, -1, -1]


def read_trc(path: Path) -> tuple[dict[str, str], list[str], np.ndarray, np.ndarray]:
    """Header, names, times [F] and markers [F,n,3] of a TRC file."""
    kind, keys, values, names, axes, blank, *rows = path.read_text("utf-8").split("\n")
    assert kind.startswith("PathFileType\t4\t(X/Y/Z)\t") and blank.strip() == "" == rows.pop()
    header = dict(zip(keys.split("\t"), values.split("\t"), strict=True))
    frame, time, *markers = (name for name in names.split("\t") if name)
    assert (frame, time) == ("Frame#", "Time")
    wanted = [f"{axis}{n}" for n in range(1, len(markers) + 1) for axis in "XYZ"]
    assert axes.split() == wanted and int(header["NumMarkers"]) == len(markers)
    table = np.array([[float(field) for field in row.split("\t")] for row in rows])
    assert len(table) == int(header["NumFrames"]) == int(header["OrigNumFrames"])
    np.testing.assert_array_equal(table[:, 0], np.arange(1, len(table) + 1))
    return header, markers, table[:, 1], table[:, 2:].reshape(len(table), -1, 3)


# ---- TRC ---------------------------------------------------------------------------------------


def test_the_file_that_users_ask_for(tmp_path: Path):
    wanted = read_trc(CASES / "walk_three_frames.trc")
    poses = edmlift.Poses.of(y_up(wanted[3]))
    header, names, times, joints = read_trc(write(tmp_path / "walk.trc", poses))
    assert header == wanted[0] and names == list(edmlift.JOINTS)
    np.testing.assert_allclose(times, wanted[2], atol=1e-5)
    np.testing.assert_allclose(joints, wanted[3], atol=6e-5)


@pytest.mark.parametrize("up", [[], ["--up", "0,-1,0"]])
def test_the_file_that_users_ask_for_from_the_command_line(up: list[str], tmp_path: Path):
    out, source = tmp_path / "walk.trc", CASES / "walk_three_frames.csv"
    assert main(["lift", str(source), "-o", str(out), "--fps", "30", *up]) == 0
    header, _, times, joints = read_trc(out)
    wanted = read_trc(CASES / "walk_three_frames.trc")
    assert header == wanted[0]
    if up:  # from the floor
        ankles = joints[:, [INDEX["right_ankle"], INDEX["left_ankle"]], 1]
        np.testing.assert_allclose(ankles.min(1), ANKLE, atol=1e-5)
    joints = joints - mid_hip(joints)[:, None]
    assert np.linalg.norm(joints - wanted[3], axis=-1).mean() < 0.06


def test_trc_of_a_walk(lifted: edmlift.Poses, tmp_path: Path):
    header, names, times, joints = read_trc(write(tmp_path / "x.trc", lifted, fps=29.97))
    assert header["DataRate"] == header["CameraRate"] == "29.97" and header["Units"] == "m"
    assert names == list(edmlift.JOINTS)
    np.testing.assert_allclose(times, np.arange(len(WALK)) / 29.97, atol=1e-5)
    assert np.isnan(joints[REFUSED]).all()
    np.testing.assert_allclose(joints, y_up(lifted.joints), atol=1e-5)


def test_opensim_reads_the_trc(lifted: edmlift.Poses, tmp_path: Path):
    opensim = pytest.importorskip("opensim", reason="no OpenSim: pip install opensim")
    table = opensim.TimeSeriesTableVec3(str(write(tmp_path / "x.trc", lifted)))
    assert list(table.getColumnLabels()) == list(edmlift.JOINTS)
    assert table.getNumRows() == len(WALK) and table.getTableMetaDataString("Units") == "m"
    rows = [table.getRowAtIndex(i) for i in range(len(WALK))]
    joints = np.array([[[row[j][k] for k in range(3)] for j in range(14)] for row in rows])
    np.testing.assert_allclose(joints, y_up(lifted.joints), atol=1e-5)


# ---- The world ---------------------------------------------------------------------------------


def joints_of(path: Path, *arguments: object, **options: object) -> np.ndarray:
    return read_trc(write(path, *arguments, **options))[3]


def test_on_the_floor_as_stand_has_it(lifted: edmlift.Poses, tmp_path: Path):
    for up in (UP, np.tile(UP, (len(WALK), 1))):
        joints = joints_of(tmp_path / "x.trc", lifted, up=up)
        np.testing.assert_allclose(joints, edmlift.stand(lifted, up), atol=1e-5)


def test_a_person_walks_through_the_room(tmp_path: Path):
    poses = true_walk()
    placed = edmlift.place(poses, CAMERA)
    joints = joints_of(tmp_path / "x.trc", poses, up=UP, root=placed)
    ankles = joints[:, [INDEX["right_ankle"], INDEX["left_ankle"]], 1].min(1)
    np.testing.assert_allclose(ankles, ANKLE, atol=0.025)  # one floor, not one a frame
    assert np.ptp(ankles) > 0.005
    hips = mid_hip(joints)
    np.testing.assert_allclose(hips[:, 1], 0.87, atol=0.03)
    # One cycle of a walk, towards the camera and to the right by 45 degrees, 4 m before it.
    way = hips[-1] - hips[0]
    assert np.hypot(way[0], way[2]) == pytest.approx(1.24, abs=0.05)
    assert np.degrees(np.arctan2(way[0], way[2])) == pytest.approx(45, abs=3)
    np.testing.assert_allclose(hips.mean(0)[[0, 2]], [0, -4], atol=0.1)
    # The camera, from which the placements are, is 1.5 m above the floor.
    camera_y = hips[:, 1] - np.array([0, -np.cos(PITCH), -np.sin(PITCH)]) @ placed.translation.T
    np.testing.assert_allclose(camera_y, 1.5, atol=0.03)
    np.testing.assert_allclose(camera_y, camera_y[0], atol=1e-4)


def test_a_path_by_itself(tmp_path: Path):
    """Mid-hip in the camera's axes; without up the origin is the camera."""
    poses = true_walk()
    path = edmlift.place(poses, CAMERA).translation
    joints = joints_of(tmp_path / "x.trc", poses, root=path)
    np.testing.assert_allclose(joints, y_up(TRUTH + path[:, None]), atol=1e-4)
    path[3] = np.nan
    joints = joints_of(tmp_path / "x.trc", poses, up=UP, root=path)
    assert np.isnan(joints[3]).all() and np.isfinite(np.delete(joints, 3, 0)).all()
    assert "\n3,0.100000,not_placed,,," in write(
        tmp_path / "x.csv", poses, root=path
    ).read_text()  # fmt: skip


def test_a_frame_that_was_not_placed_has_its_status(tmp_path: Path):
    keypoints = WALK.copy()
    keypoints[3, 6:, 2] = 0
    poses = edmlift.Poses.of(TRUTH, keypoints)
    placed = edmlift.place(poses, CAMERA)
    assert placed.status[3] == "too_few_joints"
    text = write(tmp_path / "x.csv", poses, root=placed, fps=None).read_text()
    assert "\n3,too_few_joints,,," in text


def test_one_pose_is_one_frame(tmp_path: Path):
    pose = edmlift.lift(WALK[0])
    placed = edmlift.place(pose, CAMERA)
    for options in ({}, {"up": UP}, {"root": placed}, {"root": placed.translation, "up": UP}):
        assert joints_of(tmp_path / "x.trc", pose, **options).shape == (1, 14, 3)
        write(tmp_path / "x.bvh", pose, **options)


# ---- C3D ---------------------------------------------------------------------------------------


def test_c3d_by_another_reader(lifted: edmlift.Poses, tmp_path: Path):
    pytest.importorskip("ezc3d", reason="no ezc3d")
    c3d = pytest.importorskip("c3d", reason="no other reader of C3D: pip install c3d")
    path = write(tmp_path / "x.c3d", lifted, fps=59.94)
    with path.open("rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # there are no analogue data
        reader = c3d.Reader(file)
        frames = {number: points for number, points, _ in reader.read_frames(copy=True)}
        labels = [label.strip() for label in reader.point_labels]
        units = reader.get("POINT:UNITS").string_value.strip()
        screen = [reader.get(f"POINT:{axis}_SCREEN").string_value.strip() for axis in "XY"]
    assert labels == list(edmlift.JOINTS) and units == "mm" and screen == ["+X", "+Y"]
    assert reader.point_rate == pytest.approx(59.94, rel=1e-6)
    assert list(frames) == list(range(1, len(WALK) + 1))
    points = np.array(list(frames.values()))
    assert (points[REFUSED, :, 3] == -1).all()
    there = np.arange(len(WALK)) != REFUSED
    assert (points[there, :, 3] == 0).all()
    np.testing.assert_allclose(points[there, :, :3] / 1000, y_up(lifted.joints)[there], atol=1e-6)


def test_c3d_does_not_drop_frames(tmp_path: Path):
    poses = edmlift.Poses.of(np.resize(TRUTH, (65536, 14, 3)))
    with pytest.raises(ValueError, match="at most 65535 frames, not 65536"):
        write(tmp_path / "x.c3d", poses)
    assert not (tmp_path / "x.c3d").exists()


# ---- BVH and glTF ------------------------------------------------------------------------------


def from_bvh(path: Path) -> tuple[float, dict[str, np.ndarray]]:
    """Seconds a frame, and where the nodes are [F,3], by bvhio; leaves by their parents' names."""
    bvhio = pytest.importorskip("bvhio", reason="no reader of BVH: pip install bvhio")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file, root = bvhio.readAsBvh(str(path)), bvhio.readAsHierarchy(str(path))
    # Its joints have y along their bone.
    ends = {j.Name: (0, np.linalg.norm(j.EndSite), 0) for j, _, _ in file.Root.layout()
            if not j.Children}  # fmt: skip
    found: dict[str, list[np.ndarray]] = {}
    for frame in range(file.FrameCount):
        root.loadPose(frame, recursive=True)
        for joint, _, _ in root.layout():
            found.setdefault(joint.Name, []).append(np.array(joint.PositionWorld))
            if joint.Name in ends:
                end = joint.pointToWorld(type(joint.PositionWorld)(*ends[joint.Name]))
                found.setdefault(f"{joint.Name} end", []).append(np.array(end))
    for leaf, parent in (("head", "neck_base"), ("right_wrist", "right_elbow"),
                         ("left_wrist", "left_elbow"), ("right_ankle", "right_knee"),
                         ("left_ankle", "left_knee")):  # fmt: skip
        found[leaf] = found.pop(f"{parent} end")
    return file.FrameTime, {name: np.array(at) for name, at in found.items()}


class Glb:
    """A .glb file by its specification alone."""

    def __init__(self, path: Path):
        data = path.read_bytes()
        magic, version, length, text, kind = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
        self.json = json.loads(data[20 : 20 + text])
        size, kind = struct.unpack_from("<I4s", data, 20 + text)
        assert kind == b"BIN\0" and 28 + text + size == len(data)
        self.bin = data[28 + text :]
        self.nodes = self.json["nodes"]

    def values(self, accessor: int) -> np.ndarray:
        given = self.json["accessors"][accessor]
        view = self.json["bufferViews"][given["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[given["type"]]
        kind = {5121: np.uint8, 5126: np.float32}[given["componentType"]]
        start = view.get("byteOffset", 0) + given.get("byteOffset", 0)
        values = np.frombuffer(self.bin, kind, given["count"] * width, start)
        return values.reshape(given["count"], width)

    @property
    def times(self) -> np.ndarray:
        return self.values(self.json["animations"][0]["samplers"][0]["input"])[:, 0]

    def matrices(self) -> dict[str, np.ndarray]:
        """Where the nodes are and how they are rotated [F,4,4], in the frames of the animation."""
        count = len(self.times)
        own = np.tile(np.eye(4), (len(self.nodes), count, 1, 1))
        for matrix, node in zip(own, self.nodes, strict=True):
            matrix[:, :3, 3] = node.get("translation", [0, 0, 0])
        (animation,) = self.json["animations"]
        for channel in animation["channels"]:
            target = channel["target"]
            sampler = animation["samplers"][channel["sampler"]]
            assert len(self.values(sampler["input"])) == count
            values = self.values(sampler["output"]).astype(float)
            if target["path"] == "translation":
                own[target["node"], :, :3, 3] = values
            else:
                np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1, atol=1e-6)
                own[target["node"], :, :3, :3] = from_quaternions(values)
        found = {}
        waiting = [(i, np.eye(4)[None]) for i in self.json["scenes"][0]["nodes"]]
        while waiting:
            i, parent = waiting.pop()
            found[self.nodes[i]["name"]] = parent @ own[i]
            waiting += [
                (n, found[self.nodes[i]["name"]]) for n in self.nodes[i].get("children", [])
            ]
        return found


def from_quaternions(q: np.ndarray) -> np.ndarray:
    """Rotations [F,3,3] of x, y, z, w [F,4], by what they do to the axes."""
    vector, scalar = q[:, None, :3], q[:, None, 3:]
    axes = np.eye(3)[None]
    cross = np.cross(vector, axes)
    return np.swapaxes(axes + 2 * (scalar * cross + np.cross(vector, cross)), -1, -2)


def tree(path: Path) -> dict[str, np.ndarray]:
    """Where the nodes of a .bvh or .glb are [F,3]."""
    if path.suffix == ".bvh":
        return from_bvh(path)[1]
    return {name: matrix[:, :3, 3] for name, matrix in Glb(path).matrices().items()}


def joints_in(nodes: dict[str, np.ndarray]) -> np.ndarray:
    return np.stack([nodes[name] for name in edmlift.JOINTS], axis=1)


def bone_lengths(joints: np.ndarray) -> np.ndarray:
    """[F,N] of the skeleton of the files."""
    at = bones.places(joints)
    return np.linalg.norm(at - at[:, [max(node.parent, 0) for node in bones.NODES]], axis=-1)


@pytest.mark.parametrize("suffix", TREES)
def test_a_skeleton_is_where_the_joints_are(suffix: str, tmp_path: Path):
    """Recorded bones hardly change their length."""
    found = joints_in(tree(write(tmp_path / f"x{suffix}", true_walk())))
    assert np.linalg.norm(found - y_up(TRUTH), axis=-1).max() < 0.0007
    rigid = bones.constant_lengths(TRUTH.astype(float))
    found = joints_in(tree(write(tmp_path / f"x{suffix}", edmlift.Poses.of(rigid))))
    np.testing.assert_allclose(found, y_up(rigid), atol=4e-5)


@pytest.mark.parametrize("suffix", TREES)
def test_bones_of_a_lifted_skeleton_keep_the_median_length(
    suffix: str, lifted: edmlift.Poses, tmp_path: Path
):
    nodes = tree(write(tmp_path / f"x{suffix}", lifted))
    found, wanted = joints_in(nodes), y_up(lifted.joints.astype(float))
    there = np.arange(len(WALK)) != REFUSED
    lengths, given = bone_lengths(found), bone_lengths(wanted[there])
    np.testing.assert_allclose(lengths, np.tile(np.median(given, 0), (len(WALK), 1)), atol=4e-5)
    # A joint is off by no more than what the bones up to mid-hip lost or gained.
    errors = np.linalg.norm(found - wanted, axis=-1)[there]
    changes = np.abs(given - np.median(given, 0))
    for i, node in enumerate(bones.NODES):
        chain, above = changes[:, i].copy(), node.parent
        while above > 0:
            chain += changes[:, above]
            above = bones.NODES[above].parent
        if node.place < 14:
            assert (errors[:, node.place] <= chain + 1e-4).all(), node.name
    assert 0.002 < errors.mean() < 0.012


@pytest.mark.parametrize("suffix", TREES)
def test_a_skeleton_stands_and_walks(suffix: str, tmp_path: Path):
    poses = true_walk()
    path = tmp_path / f"x{suffix}"
    found = joints_in(tree(write(path, poses, up=UP)))
    np.testing.assert_allclose(found, edmlift.stand(poses, UP), atol=0.001)
    placed = edmlift.place(poses, CAMERA)
    found = joints_in(tree(write(path, poses, up=UP, root=placed)))
    wanted = joints_of(tmp_path / "x.trc", poses, up=UP, root=placed)
    np.testing.assert_allclose(found, wanted, atol=0.001)


@pytest.mark.parametrize("suffix", TREES)
def test_a_skeleton_holds_its_last_pose(suffix: str, lifted: edmlift.Poses, tmp_path: Path):
    path, keypoints = tmp_path / f"x{suffix}", WALK.copy()
    keypoints[[0, REFUSED, REFUSED + 1], :, 2] = 0
    with pytest.warns(UserWarning, match="3 of 39 frames have no pose") as caught:
        edmlift.write_motion(path, edmlift.lift(keypoints), fps=FPS)
    assert [Path(warning.filename).name for warning in caught] == [Path(__file__).name]
    found = joints_in(tree(path))
    for frame, like in ((0, 1), (REFUSED, REFUSED - 1), (REFUSED + 1, REFUSED - 1)):
        np.testing.assert_array_equal(found[frame], found[like])
    assert np.abs(found[2] - found[1]).max() > 0.001


def test_the_hierarchy_of_bvh(tmp_path: Path):
    path = write(tmp_path / "x.bvh", true_walk(), fps=25)
    seconds, nodes = from_bvh(path)
    assert seconds == pytest.approx(0.04) and set(nodes) == {node.name for node in bones.NODES}
    text = path.read_text()
    assert text.count("JOINT") == 12 and text.count("End Site") == 5
    assert text.startswith("HIERARCHY\nROOT hips\n{\n\tOFFSET 0.00000 0.00000 0.00000\n")
    assert "\nFrames: 39\n" in text and "-0.00000" not in text.partition("MOTION")[0]


def test_the_figure_of_a_glb(tmp_path: Path):
    trimesh = pytest.importorskip("trimesh", reason="no other reader of glTF: pip install trimesh")
    path = write(tmp_path / "x.glb", true_walk(), up=UP)
    scene = trimesh.load(path)
    assert len(scene.geometry) == 3
    low, high = scene.bounds
    assert low[1] == pytest.approx(ANKLE) and 1.5 < high[1] < 1.8  # on the floor, at rest
    assert -low[0] == pytest.approx(high[0], abs=0.02) and high[0] > 0.6  # the arms of a T
    left = scene.geometry[list(scene.geometry)[1]]
    assert left.visual.material.name == "left" and left.bounds[0][0] > -0.1
    for mesh in scene.geometry.values():
        assert mesh.is_watertight or trimesh.Trimesh(mesh.vertices, mesh.faces).volume > 0


def test_the_figure_moves_with_the_bones(tmp_path: Path):
    """A tip of each bone's pyramid is at a joint, in every frame."""
    glb = Glb(write(tmp_path / "x.glb", true_walk()))
    matrices = glb.matrices()
    (skin,) = glb.json["skins"]
    inverse = glb.values(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    names = [glb.nodes[i]["name"] for i in skin["joints"]]
    tips = []
    for primitive in glb.json["meshes"][0]["primitives"]:
        at = glb.values(primitive["attributes"]["POSITION"])
        owner = glb.values(primitive["attributes"]["JOINTS_0"])[:, 0]
        assert (glb.values(primitive["attributes"]["WEIGHTS_0"])[:, 0] == 1).all()
        for corner, bone in zip(at[3::24], owner[3::24], strict=True):  # the far end of each
            moved = matrices[names[bone]] @ inverse[bone] @ [*corner, 1]
            tips.append(moved[:, :3])
    wanted = y_up(TRUTH)
    distances = np.linalg.norm(np.stack(tips, 1)[:, :, None] - wanted[:, None], axis=-1)
    assert len(tips) == 14 and distances.min(2).max() < 0.001
    assert len(np.unique(distances.argmin(2)[0])) == 14
    assert glb.json["animations"][0]["name"] == "x"
    np.testing.assert_allclose(glb.times, np.arange(39) / FPS, atol=1e-6)


def test_the_validator_of_gltf_finds_nothing(lifted: edmlift.Poses, tmp_path: Path):
    if shutil.which("npm") is None:
        pytest.skip("no npm, which brings the validator of glTF")
    get = ["npm", "install", "--prefix", tmp_path, "--no-audit", "gltf-validator@2.0.0-dev.3.10"]
    if subprocess.run(get, capture_output=True, timeout=300).returncode != 0:
        pytest.skip("npm cannot get gltf-validator: no network?")
    path = write(tmp_path / "x.glb", lifted, up=LEVEL)
    script = """
        const data = new Uint8Array(require("fs").readFileSync(process.argv[1]));
        require("gltf-validator").validateBytes(data)
            .then(report => console.log(JSON.stringify(report.issues)));
    """
    done = subprocess.run(
        ["node", "-e", script, path], capture_output=True, text=True, cwd=tmp_path, check=True
    )
    issues = json.loads(done.stdout)
    assert issues["messages"] == [] and not issues["truncated"]


# ---- Rotations ---------------------------------------------------------------------------------


def random_joints(count: int, seed: int = 1) -> np.ndarray:
    """People [F,14,3] whose bones point anywhere."""
    rng = np.random.default_rng(seed)
    return bones.constant_lengths(rng.normal(0, 0.3, (count, 14, 3)))


def forward(joints: np.ndarray) -> np.ndarray:
    """Joints by forward kinematics: of rotations from parents, and where nodes are at rest."""
    turned, rest = bones.local(bones.rotations(joints)), bones.offsets(joints)
    at, world = [mid_hip(joints)], [turned[:, 0]]
    for i, node in enumerate(bones.NODES[1:], 1):
        at.append(at[node.parent] + world[node.parent] @ rest[i])
        world.append(world[node.parent] @ turned[:, i])
    out = np.empty_like(joints)
    for node, points in zip(bones.NODES, at, strict=True):
        if node.place < 14:
            out[:, node.place] = points
    return out


def test_rotations_bring_any_skeleton_where_it_is():
    joints = random_joints(500)
    turned = bones.rotations(joints)
    identity = np.swapaxes(turned, -1, -2) @ turned
    np.testing.assert_allclose(identity, np.broadcast_to(np.eye(3), turned.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(turned), 1, atol=1e-12)
    np.testing.assert_allclose(forward(joints), joints, atol=1e-9)


def t_pose() -> np.ndarray:
    """A person [14,3] at rest, facing z, y up."""
    at = {
        "head": (0, 0.8, 0), "neck_base": (0, 0.5, 0), "left_shoulder": (0.2, 0.5, 0),
        "left_elbow": (0.5, 0.5, 0), "left_wrist": (0.7, 0.5, 0), "left_hip": (0.1, 0, 0),
        "left_knee": (0.1, -0.4, 0), "left_ankle": (0.1, -0.8, 0),
    }  # fmt: skip
    at |= {f"right{name[4:]}": (-p[0], *p[1:]) for name, p in at.items() if name[:4] == "left"}
    return np.array([at[name] for name in edmlift.JOINTS], float)


def test_nothing_is_rotated_at_rest_nor_at_exact_opposites():
    turned = bones.rotations(t_pose()[None])
    np.testing.assert_allclose(turned, np.broadcast_to(np.eye(3), turned.shape), atol=1e-12)
    joints = t_pose()
    joints[INDEX["head"]] = [0, 0.2, 0]  # upside down
    joints[INDEX["left_wrist"]] = [0.3, 0.5, 0]  # folded back
    np.testing.assert_allclose(forward(joints[None])[0], joints, atol=1e-12)


def test_elbows_and_knees_say_how_a_limb_is_rolled():
    """Bent by a right angle, they turn about the hinge: of arms y, of legs x."""
    joints = t_pose()
    for side, x in (("left", 0.5), ("right", -0.5)):
        joints[INDEX[f"{side}_wrist"]] = [x, 0.7, 0]  # the forearm points up, not forward
        joints[INDEX[f"{side}_ankle"]] = [0.1 * np.sign(x), -0.4, -0.4]
    turned = bones.local(bones.rotations(joints[None]))[0]
    number = {node.name: i for i, node in enumerate(bones.NODES)}
    for name, axis, sign in (("left_elbow", 1, -1), ("right_elbow", 1, 1),
                             ("left_knee", 0, 1), ("right_knee", 0, 1)):  # fmt: skip
        wanted = np.zeros((3, 3))
        one, two = (axis + 1) % 3, (axis + 2) % 3
        wanted[axis, axis], wanted[two, one], wanted[one, two] = 1, sign, -sign
        np.testing.assert_allclose(turned[number[name]], wanted, atol=0.15, err_msg=name)


def test_a_straight_limb_is_not_rolled_by_noise():
    rng = np.random.default_rng(2)
    joints = np.tile(t_pose(), (300, 1, 1)) + rng.normal(0, 0.005, (300, 14, 3))
    turned = bones.rotations(joints)
    angles = np.degrees(np.arccos((np.trace(turned, axis1=-2, axis2=-1) - 1) / 2))
    assert angles.max() < 20


def test_angles_and_quaternions_are_the_rotations():
    turned = bones.local(bones.rotations(random_joints(400)))
    right_angle = np.array([[[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]])
    turned = np.concatenate([turned, np.broadcast_to(right_angle, turned[:1].shape)])
    angles = _continuous(_euler(turned))
    np.testing.assert_allclose(from_euler(angles), turned, atol=1e-12)
    for i in range(turned.shape[1]):
        np.testing.assert_allclose(
            from_quaternions(_quaternions(turned[:, i])), turned[:, i], atol=1e-12
        )


def from_euler(angles: np.ndarray) -> np.ndarray:
    """Rotations of z, x, y [...,3] in radians: y first."""
    out = np.eye(3)
    for axis, angle in zip((2, 0, 1), np.moveaxis(angles, -1, 0), strict=True):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        turn = np.zeros((*angle.shape, 3, 3))
        turn[..., axis, axis] = 1
        turn[..., one, one] = turn[..., two, two] = np.cos(angle)
        turn[..., two, one], turn[..., one, two] = np.sin(angle), -np.sin(angle)
        out = out @ turn
    return out


def test_angles_and_quaternions_do_not_leap():
    """A person who turns about, twice, and lies down: a program interpolates between frames."""
    turns = np.linspace(0, 4 * np.pi, 241)[:, None]
    spin = from_euler(np.concatenate([0 * turns, turns / 4, turns], axis=1))
    joints = t_pose() @ np.swapaxes(spin, -1, -2)
    turned = bones.local(bones.rotations(joints))
    angles = _continuous(_euler(turned))
    assert np.abs(np.diff(angles, axis=0)).max() < 0.12
    quaternions = _quaternions(turned[:, 0])
    assert (quaternions[1:] * quaternions[:-1]).sum(-1).min() > 0.99


# ---- Tables ------------------------------------------------------------------------------------


@pytest.mark.parametrize("fps", [FPS, None])
@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".arrow", ".feather"])
def test_tables_by_another_reader(
    suffix: str, fps: float | None, lifted: edmlift.Poses, tmp_path: Path
):
    if suffix != ".csv":
        pytest.importorskip("pyarrow", reason="no pyarrow")
    polars = pytest.importorskip("polars", reason="no other reader of tables: pip install polars")
    path = write(tmp_path / f"x{suffix}", lifted, fps=fps, up=UP)
    read = {".csv": polars.read_csv, ".parquet": polars.read_parquet}.get(suffix, polars.read_ipc)
    table = read(path)
    assert table.columns == ["frame", *["time"] * (fps is not None), "status", "misfit",
                             *COORDINATES]  # fmt: skip
    assert table["frame"].to_list() == list(range(len(WALK)))
    assert table["status"].to_list() == list(lifted.status)
    if fps is not None:
        np.testing.assert_allclose(table["time"].to_numpy(), np.arange(len(WALK)) / fps, atol=1e-6)
    numbers = table.select("misfit", *COORDINATES)
    assert numbers[REFUSED].null_count().row(0) == (1,) * 43
    assert sum(numbers.null_count().row(0)) == 43
    joints = numbers.drop("misfit").to_numpy().reshape(-1, 14, 3)
    np.testing.assert_allclose(joints, edmlift.stand(lifted, UP), rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(numbers["misfit"].to_numpy(), lifted.misfit, rtol=1e-5)
    if suffix != ".csv":
        assert set(numbers.dtypes) == {polars.Float32}


def test_a_table_says_its_unit(lifted: edmlift.Poses, tmp_path: Path):
    polars = pytest.importorskip("polars", reason="no polars")
    pytest.importorskip("pyarrow", reason="no pyarrow")
    for up, floor in ((LEVEL, "y = 0"), (None, "not known")):
        about = polars.read_parquet_metadata(write(tmp_path / "x.parquet", lifted, up=up))
        assert about["unit"] == "m" and about["floor"] == floor
        assert about["axes"] == "x right, y up, z towards the camera"


# ---- What cannot be written --------------------------------------------------------------------


def test_what_is_no_motion_file(lifted: edmlift.Poses, tmp_path: Path):
    moving = np.tile(UP, (len(WALK), 1))
    moving[5] = [0.3, -1, 0]
    far = edmlift.Poses.of(1000 * TRUTH)
    no_shin = TRUTH.copy()
    no_shin[4, INDEX["left_ankle"]] = no_shin[4, INDEX["left_knee"]]
    path = np.zeros((len(WALK), 3))
    for name, poses, options, message in [
        ("x.fbx", lifted, {}, r"must end in \.trc, \.c3d, \.bvh, \.glb, \.csv"),
        ("x", lifted, {}, "must end in"),
        *[(f"x.{s}", lifted, {"fps": None}, f"a .{s} file needs the frames a second") for s in
          ("trc", "c3d", "bvh", "glb")],
        *[("x.csv", lifted, {"fps": fps}, "fps must be over 0") for fps in (0, -1, np.nan, np.inf)],
        ("x.trc", edmlift.lift(0 * WALK), {}, r"there is no pose to write \("),
        ("x.bvh", edmlift.Poses.of(np.zeros((0, 14, 3))), {}, r"no pose to write \(no frames\)"),
        ("x.trc", far, {}, "the pose of frame 0 is not within 4 m: are these metres"),
        ("x.glb", edmlift.Poses.of(no_shin), {}, "the bone to left_ankle has no length"),
        ("x.trc", lifted, {"up": (0, 0, 0)}, "up must"),
        ("x.trc", lifted, {"root": np.zeros((3, 3))}, r"root must be \[39,3\], not \[3, 3\]"),
        ("x.trc", lifted, {"root": edmlift.place(edmlift.lift(WALK[:4]), CAMERA)},
         "root has 4 placements, but there are 39 poses"),
        ("x.trc", lifted, {"root": path * np.nan}, r"no pose to write"),
        ("x.trc", lifted, {"root": path, "up": moving}, "camera that stands still"),
    ]:  # fmt: skip
        with pytest.raises(ValueError, match=message):
            write(tmp_path / name, poses, **options)
        assert not (tmp_path / name).exists()
    with pytest.raises(TypeError, match="must be Poses"):
        write(tmp_path / "x.trc", TRUTH)


@pytest.mark.parametrize(
    ("suffix", "module", "package"),
    [(".c3d", "ezc3d", "ezc3d"), (".glb", "pygltflib", "pygltflib"),
     (".parquet", "pyarrow.parquet", "pyarrow"), (".feather", "pyarrow.feather", "pyarrow")],
)  # fmt: skip
def test_a_package_that_is_missing(
    suffix: str, module: str, package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
):  # fmt: skip
    monkeypatch.setitem(sys.modules, module, None)
    out = tmp_path / f"x{suffix}"
    arguments = ["lift", str(DATA / "walk.csv"), "-o", str(out), "--fps", "30"]
    assert main(arguments) == 1 and not out.exists()
    said = f'a {suffix} file needs the package {package}: pip install "edmlift[files]"'
    assert capsys.readouterr().err == f"edmlift: {said}\n"


# ---- The command line --------------------------------------------------------------------------


def test_every_motion_file_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture
):  # fmt: skip
    for package in ("ezc3d", "pygltflib", "pyarrow"):
        pytest.importorskip(package, reason=f"no {package}")
    lines = (DATA / "walk.csv").read_text().splitlines()
    source = tmp_path / "in.csv"
    source.write_text("\n".join([*lines[:6], "text", *lines[6:]]))
    bad = f"edmlift: {source}:7: field 1 is not a number (commas or blanks separate them)\n"
    for suffix in edmlift.MOTION_SUFFIXES:
        out = tmp_path / f"x{suffix}"
        options = ["--fps", "30", "--up", "0,-1,0", *["--motion"] * (suffix == ".csv")]
        assert main(["lift", str(source), "-o", str(out), *options]) == 1
        said = capsys.readouterr().err
        held = f"edmlift: {out}: 1 of 40 frames have no pose, and hold the one before\n"
        assert said == bad + held * (suffix in TREES) and out.stat().st_size > 5000


def test_a_camera_on_the_command_line(tmp_path: Path):
    up = ",".join(str(value) for value in UP)
    options = ["--fps", "30", "--up", up, "--camera", "1145,1145,500,500"]
    out = tmp_path / "x.trc"
    assert main(["lift", str(DATA / "walk.csv"), "-o", str(out), *options]) == 0
    poses = edmlift.lift(WALK, up=UP, camera=CAMERA)
    wanted = joints_of(tmp_path / "y.trc", poses, up=UP, root=edmlift.place(poses, CAMERA))
    np.testing.assert_array_equal(read_trc(out)[3], wanted)


def test_lifted_poses_become_a_motion_file(tmp_path: Path, capsys: pytest.CaptureFixture):
    poses = edmlift.track(WALK, fps=FPS)
    edmlift.write_poses(tmp_path / "lifted.csv", poses, header=True)
    options = ["-o", str(tmp_path / "x.trc"), "--fps", "30", "--up", "0,-1,0"]
    assert main(["convert", str(tmp_path / "lifted.csv"), *options]) == 0
    wanted = joints_of(tmp_path / "y.trc", poses, up=LEVEL)
    np.testing.assert_allclose(read_trc(tmp_path / "x.trc")[3], wanted, atol=2e-5)
    assert main(["convert", str(tmp_path / "lifted.csv"), "-o", "x.trc"]) == 2
    assert "x.trc: a .trc file needs the frames a second" in capsys.readouterr().err


def test_the_page_shows_a_program_that_runs(tmp_path: Path):
    pytest.importorskip("pygltflib", reason="no pygltflib")
    example = ROOT / "examples" / "to_blender.py"
    page = (ROOT / "docs" / "files.md").read_text("utf-8")
    assert f"```python\n{example.read_text('utf-8')}```\n" in page
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    environment = os.environ | {"PYTHONPATH": str(ROOT / "tools")}
    done = subprocess.run(
        [sys.executable, example], cwd=tmp_path,
        env=environment, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0 and done.stderr == "", done.stderr
    hips = Glb(tmp_path / "walk.glb").matrices()["hips"][:, :3, 3]
    assert np.hypot(*(hips[-1] - hips[0])[[0, 2]]) == pytest.approx(1.24, abs=0.1)


def test_the_commands_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """But for lift_stdin's; what it prints is what `edmlift convert` reads (test_files.py)."""
    for package in ("ezc3d", "pygltflib", "pyarrow"):
        pytest.importorskip(package, reason=f"no {package}")
    page = (ROOT / "docs" / "files.md").read_text("utf-8")
    commands = [line.split()[1:] for line in page.splitlines() if line.startswith("edmlift ")]
    assert [words[0] for words in commands] == ["lift", "lift", "lift", "convert"]
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    edmlift.write_poses("lifted.csv", edmlift.track(WALK, fps=FPS))
    for words in commands:
        assert main(words) == 0 and Path(words[words.index("-o") + 1]).stat().st_size > 5000


def test_plain_csv_is_what_it_was(tmp_path: Path):
    out = tmp_path / "x.csv"
    assert main(["lift", str(DATA / "walk.csv"), "-o", str(out)]) == 0
    edmlift.write_poses(tmp_path / "y.csv", edmlift.lift(edmlift.read_keypoints(DATA / "walk.csv")))
    assert out.read_bytes() == (tmp_path / "y.csv").read_bytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["-o", "x.trc"], "x.trc: a .trc file needs the frames a second"),
        (["-o", "x.csv", "--fps", "30"], "--fps is for motion files: -o must end in .trc, .c3d"),
        (["--fps", "30"], "--fps is for motion files"),
        (["--camera", "1,1,0,0"], "--camera is for motion files"),
        (["--motion"], "a motion file must have a name: -o FILE"),
        (["-o", "x.txt", "--motion"], "x.txt: a motion file must end in .trc"),
        (["-o", "x.trc", "--fps", "0"], "fps must be over 0"),
        (["-o", "x.trc", "--fps", "30", "--header"], "--header is not for motion files"),
        (["-o", "x.trc", "--fps", "30", "--camera", "0,1,0,0"], "camera must"),
    ],
)
def test_what_the_command_line_refuses(
    options: list[str], message: str, capsys: pytest.CaptureFixture, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
):  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["lift", str(DATA / "walk.csv"), *options]) == 2
    printed = capsys.readouterr()
    assert message in printed.err and printed.out == "" and not list(tmp_path.iterdir())


def test_the_help_has_the_names(capsys: pytest.CaptureFixture):
    for command in ("lift", "convert"):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        said = capsys.readouterr().out
        assert all(suffix in said for suffix in edmlift.MOTION_SUFFIXES)
