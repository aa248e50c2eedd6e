"""Human3.6M and HumanEva-I in the layout of the project VideoPose3D, as poses of our 14 joints.

Positions come from an .npz whose `positions_3d` is a dictionary, subject -> sequence -> [F,N,3],
metres, world frame, z up; cameras from VideoPose3D's own source (h36m_dataset.py or
humaneva_dataset.py: its literals are read, nothing is run) or JSON with the same two tables.
What comes out has y up, as all motion capture here.  A file of another layout, with other units or
with NaN raises `MocapError`, which names the file, the subject, the sequence, the frame.
"""

import ast
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from data import cameras
from data.archives import ArchiveError, check_size, npy_header, one_line, read_members
from data.array_pickles import load_arrays
from data.mocap import STATURE_RANGE, MocapError
from edmlift.joints import INDEX, JOINTS, indices

LARGEST_CAMERAS = 1 << 20  # bytes of tables of cameras: VideoPose3D's have 9 KB
LARGEST = 2 << 30  # bytes of positions: Human3.6M's are a sixth of that
MILLIMETRE = 0.001
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # takes a world with z up to ours
LEAST_RISE = 0.3  # metres, head over ankles, median: people sit, but not on their heads


@dataclass(frozen=True)
class Layout:
    """A data set as VideoPose3D stores it."""

    name: str
    prefix: str  # of the tables in its cameras' file
    keypoints: int  # joints in the file
    joints: tuple[int, ...]  # which of them are ours
    fps: float
    source: str  # where the data are to be had


H36M = Layout(
    "Human3.6M",
    "h36m",
    32,
    (15, 13, 25, 26, 27, 17, 18, 19, 1, 2, 3, 6, 7, 8),
    50.0,
    "register at the Human3.6M page (vision.imar.ro/human3.6m), then make data_3d_h36m.npz with "
    "data/prepare_data_h36m.py of the project VideoPose3D",
)
HUMANEVA = Layout(
    "HumanEva-I",
    "humaneva",
    15,
    (14, 1, 5, 6, 7, 2, 3, 4, 11, 12, 13, 8, 9, 10),
    60.0,
    "register at the HumanEva page (humaneva.is.tue.mpg.de), then make data_3d_humaneva15.npz with "
    "data/prepare_data_humaneva.py of the project VideoPose3D",
)

Sequences = dict[str, dict[str, np.ndarray]]  # subject -> sequence -> [F,14,3] metres, y up


# Positions


def read_positions(path: Path, layout: Layout) -> Sequences:
    """Reads and checks a file of positions; every sequence of every subject."""
    everything = _positions_3d(path, layout)
    if not isinstance(everything, dict) or not everything:
        raise MocapError(f"{path}: positions_3d is not a dictionary of subjects")
    result: Sequences = {}
    size = 0
    for subject, sequences in everything.items():
        if not isinstance(sequences, dict):
            raise MocapError(f"{path}: {subject} is not a dictionary of sequences")
        size += sum(8 * getattr(array, "size", 0) for array in sequences.values())
        try:  # the same array may be there many times
            check_size(size, "everything together", LARGEST)
        except ArchiveError as error:
            raise MocapError(f"{path}: {error}") from None
        result[subject] = {
            name: _joints(f"{path}: {subject}, '{name}'", array, layout)
            for name, array in sequences.items()
        }
        if result[subject]:
            _check_people(f"{path}: {subject}", np.concatenate(list(result[subject].values())))
    return result


def _positions_3d(path: Path, layout: Layout) -> Any:
    """The object stored under positions_3d."""
    if not path.exists():
        raise MocapError(f"{path}: no such file; for {layout.name}, {layout.source}")
    try:
        members = read_members(path, LARGEST, ["positions_3d.npy"])
        if not members:
            raise ValueError("holds no positions_3d, as VideoPose3D's layout has it")
        data = members["positions_3d.npy"]
        shape, _, dtype, start = npy_header(data)
        if shape != () or not dtype.hasobject:
            raise ValueError(f"positions_3d is an array {shape} of {dtype}, not a dictionary")
        return load_arrays(data[start:]).item()
    except Exception as error:  # a damaged archive or pickle may raise nearly anything
        raise MocapError(f"{path}: not readable ({one_line(error)})") from None


def _joints(where: str, array: Any, layout: Layout) -> np.ndarray:
    """Our joints of a sequence, y up: [F,N,3] -> [F,14,3]."""
    shape = getattr(array, "shape", None)
    if shape is None or len(shape) != 3 or shape[1:] != (layout.keypoints, 3):
        raise MocapError(f"{where}: shape {shape}, must be (F, {layout.keypoints}, 3)")
    if shape[0] == 0:
        raise MocapError(f"{where}: no frames")
    joints = np.asarray(array, float)[:, layout.joints] @ Y_UP.T
    if not np.isfinite(joints).all():
        frame, joint = np.argwhere(~np.isfinite(joints))[0, :2]
        raise MocapError(f"{where}: frame {frame}, {JOINTS[joint]} is not finite")
    return joints


def _check_people(where: str, joints: np.ndarray) -> None:
    """Refuses units other than metres, and an axis other than z upwards; medians over a person."""
    up = joints[:, [INDEX["head"]]] - joints[:, indices(("right_ankle", "left_ankle"))]
    stature = np.median(np.linalg.norm(up, axis=-1))
    if not STATURE_RANGE[0] <= stature <= STATURE_RANGE[1]:
        raise MocapError(f"{where}: the unit is not metres: head to ankle is {stature:.4g}")
    rise = np.median(up[..., 1])
    if rise < LEAST_RISE:
        raise MocapError(f"{where}: z does not point up: the head is {rise:.2f} m over the ankles")


# Cameras


@dataclass(frozen=True)
class Camera:
    """A pinhole with Brown's lens: x right, y down, z away."""

    name: str
    position: np.ndarray  # [3] metres, world with y up
    axes: np.ndarray  # [3,3] rows are the camera's axes in that world
    focal: np.ndarray  # [2] pixels
    centre: np.ndarray  # [2] pixels
    radial: np.ndarray  # [3] of r^2, r^4, r^6
    tangential: np.ndarray  # [2]

    def look(self, joints: np.ndarray) -> np.ndarray:
        """Joints [F,14,3] of the world, in the camera's axes."""
        return (joints - self.position) @ self.axes.T

    def project(self, joints: np.ndarray) -> np.ndarray:
        """Camera axes, metres [F,14,3] -> pixels [F,14,2]."""
        x = joints[..., :2] / joints[..., 2:]
        r2 = (x**2).sum(-1, keepdims=True)
        radial = 1 + r2 * (self.radial[0] + r2 * (self.radial[1] + r2 * self.radial[2]))
        across = self.tangential[::-1]
        bent = x * (radial + 2 * (x @ across)[..., None]) + across * r2
        return self.focal * bent + self.centre


def read_cameras(path: Path, layout: Layout) -> dict[str, list[Camera]]:
    """Cameras of each subject that has any: {"S1": [...], ...}, in the file's order."""
    tables = _camera_tables(path, layout)
    names = [f"{layout.prefix}_cameras_{kind}_params" for kind in ("intrinsic", "extrinsic")]
    for name in names:
        if name not in tables:
            raise MocapError(f"{path}: no table {name}")
    intrinsic, extrinsic = (tables[name] for name in names)
    try:
        return {
            subject: [_camera(*both) for both in zip(intrinsic, places, strict=True)]
            for subject, places in extrinsic.items()
            if all(places)
        }
    except (KeyError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        what = one_line(error)
        raise MocapError(f"{path}: not cameras as VideoPose3D has them ({what})") from None


def _camera_tables(path: Path, layout: Layout) -> dict[str, Any]:
    try:
        check_size(path.stat().st_size, "the file", LARGEST_CAMERAS)
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise MocapError(
            f"{path}: no such file; take common/{layout.prefix}_dataset.py of the project "
            "VideoPose3D, or JSON with its two tables of cameras"
        ) from None
    except (OSError, ArchiveError, UnicodeDecodeError) as error:
        raise MocapError(f"{path}: not readable ({error})") from None
    try:
        return _tables_of_json(text) if path.suffix == ".json" else _tables_of_python(text)
    except (ValueError, SyntaxError, RecursionError, MemoryError) as error:  # or nested too deeply
        raise MocapError(
            f"{path}: neither Python nor JSON with tables of cameras ({one_line(error)})"
        ) from None


def _tables_of_json(text: str) -> dict[str, Any]:
    tables = json.loads(text)
    return tables if isinstance(tables, dict) else {}


def _tables_of_python(text: str) -> dict[str, Any]:
    return {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in ast.parse(text).body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and re.fullmatch(r"\w+_cameras_\w+_params", node.targets[0].id)
    }


def _camera(intrinsic: dict, extrinsic: dict) -> Camera:
    """VideoPose3D's: a quaternion w x y z from camera to world, a position in mm.

    HumanEva's has no lens; then it is our virtual cameras': exact 2D of a pinhole with square
    pixels lifts the same whatever its focal length.
    """
    w, *xyz = _vector(extrinsic["orientation"], 4)
    to_world = Y_UP @ Rotation.from_quat([*xyz, w]).as_matrix()
    return Camera(
        str(intrinsic["id"]),
        Y_UP @ _vector(extrinsic["translation"], 3) * MILLIMETRE,
        to_world.T,
        _vector(intrinsic.get("focal_length", [cameras.FOCAL] * 2), 2),
        _vector(intrinsic.get("center", [cameras.CENTRE] * 2), 2),
        _vector(intrinsic.get("radial_distortion", [0.0] * 3), 3),
        _vector(intrinsic.get("tangential_distortion", [0.0] * 2), 2),
    )


def _vector(values: Sequence[float], count: int) -> np.ndarray:
    vector = np.array(values, float)
    if vector.shape != (count,) or not np.isfinite(vector).all():
        raise ValueError(f"{count} finite numbers expected, {values} found")
    return vector
