"""Motion capture and licensed data from anywhere: each file is read, or refused in one line."""

import io
import json
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fuzzed import check_message, file_of, files, folder, fuzzed
from hypothesis import strategies as st

from data import mocap
from data.array_pickles import load_arrays
from data.h36m import H36M, read_cameras, read_positions
from edmlift.joints import JOINTS

NUMBER_WORDS = [b"1e300", b"nan", b"-0", b"1_0", b"9" * 5000, b"\n", b" ", b"\xff", b"#"]

# ---- ASF and AMC ---------------------------------------------------------------------------------


def asf_text() -> str:
    lines = [":version 1.10", ":units", "  length 0.45", "  angle deg", ":root"]
    lines += [
        "order TX TY TZ RX RY RZ",
        "axis XYZ",
        "position 0 0 0",
        "orientation 0 0 0",
        ":bonedata",
    ]
    for name in mocap.ASF_BONES.values():
        lines += [
            "begin",
            f"name {name}",
            "direction 0 1 0",
            "length 7",
            "axis 0 0 0 XYZ",
            "dof rx ry",
        ]
        lines += ["end"]
    return "\n".join(
        [*lines, ":hierarchy", "begin", f"root {' '.join(mocap.ASF_BONES.values())}", "end\n"]
    )


def amc_text() -> str:
    lines = [":FULLY-SPECIFIED", ":DEGREES"]
    for number in (1, 2):
        lines += [str(number), "root 0 17 0 0 10 0"]
        lines += [f"{name} {number} 20" for name in mocap.ASF_BONES.values()]
    return "\n".join(lines) + "\n"


ASF_WORDS = [
    *NUMBER_WORDS,
    b"begin",
    b"end",
    b":root",
    b"root",
    b"head",
    b"dof",
    b"rz",
    b"axis",
    b"lfemur",
]


@fuzzed(st.tuples(files([asf_text().encode()], ASF_WORDS), files([amc_text().encode()], ASF_WORDS)))
def test_asf_amc(given: tuple[bytes, bytes]) -> None:
    with folder() as place:
        asf, amc = place / "07.asf", place / "07_01.amc"
        asf.write_bytes(given[0])
        amc.write_bytes(given[1])
        try:
            trial = mocap.read_amc(amc, mocap.read_asf(asf))
            assert trial.joints.shape[1:] == (14, 3)
            mocap.clean(trial, mocap.Cleaning())
        except mocap.MocapError as error:
            check_message(error)


# ---- BVH -----------------------------------------------------------------------------------------


def bvh_text() -> str:
    """A chain of all joints that are looked for."""
    names = [choices[-1].replace("{s}", "r") for choices in mocap.BVH_NODES.values()]
    channels = "CHANNELS 3 Zrotation Yrotation Xrotation"
    lines = ["HIERARCHY", "ROOT hip", "{", "OFFSET 0 0 0"]
    lines += ["CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"]
    names = [name for name in names if not name.endswith(" end")] + ["head"]
    for name in names:
        lines += [f"JOINT {name}", "{", "OFFSET 0 9 1", channels]
    lines += ["End Site", "{", "OFFSET 0 9 1", "}"] + ["}"] * (len(names) + 1)
    values = " ".join(["0"] * (6 + 3 * len(names)))
    return "\n".join([*lines, "MOTION", "Frames: 2", "Frame Time: 0.01", values, values, ""])


BVH_WORDS = [
    *NUMBER_WORDS,
    b"{",
    b"}",
    b"JOINT",
    b"End Site",
    b"OFFSET",
    b"MOTION",
    b"Frames:",
    b"ROOT x",
]


@fuzzed(files([bvh_text().encode()], BVH_WORDS))
def test_bvh(data: bytes) -> None:
    with file_of(data, "07_02.bvh") as path:
        try:
            trial = mocap.read_bvh(path)
            assert trial.joints.shape[1:] == (14, 3)
            mocap.clean(trial, mocap.Cleaning())
        except mocap.MocapError as error:
            check_message(error)


def refusal(read: Callable[[Path], Any], text: str, name: str) -> str:
    with file_of(text.encode(), name) as path, pytest.raises(mocap.MocapError) as error:
        read(path)
    return str(error.value)


def test_a_chain_of_thousands_of_joints() -> None:
    """Deeper than Python's recursion."""
    head, _, rest = bvh_text().partition("JOINT")
    joint = "JOINT a{}\n{{\nOFFSET 0 9 1\nCHANNELS 3 Zrotation Yrotation Xrotation\n"
    ends = "End Site\n{\nOFFSET 0 9 1\n}\n" + "}\n" * 5001
    text = f"{head}{''.join(map(joint.format, range(5000)))}{ends}{rest[rest.index('MOTION') :]}"
    assert "no joint for head" in refusal(mocap.read_bvh, text, "07_03.bvh")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("Frames: 2", "Frames: 9999999999999", "frames announced, 2 found"),
        ("CHANNELS 3", "CHANNELS 999999999", "CHANNELS 999999999, but 3 names"),
    ],
)
def test_numbers_that_announce_more_than_there_is(before: str, after: str, message: str) -> None:
    text = bvh_text().replace(before, after)
    assert message in refusal(mocap.read_bvh, text, "07_04.bvh")


def test_bones_in_a_ring() -> None:
    text, _, bones = asf_text().partition("root ")
    names = bones.split()[:-1]
    ring = "".join(f"{a} {b}\n" for a, b in zip(names, names[1:] + names[:1], strict=True))
    text = f"{text}root {names[0]}\n{ring}end\n"
    assert "has two parents" in refusal(mocap.read_asf, text, "07.asf")


# ---- .npz ----------------------------------------------------------------------------------------

FRAMES = 3
STANDING = np.zeros((FRAMES, 14, 3), np.float32)
STANDING[:, [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")], 1] = -1.6
MOTION: dict[str, Any] = {
    "joints": STANDING, "subject": np.arange(FRAMES), "trial": np.arange(FRAMES),
    "frame": np.arange(FRAMES), "joint_names": np.array(JOINTS), "up": np.array("y"),
    "unit": np.array("m"), "fps": np.array(15.0), "action": np.arange(FRAMES),
    "action_names": np.array(["walk"]),
}  # fmt: skip


def npy(array: Any) -> bytes:
    data = io.BytesIO()
    np.save(data, array)
    return data.getvalue()


def archive_of(members: dict[str, bytes]) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, member in members.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), member)
    return data.getvalue()


MEMBERS = {name: npy(array) for name, array in MOTION.items()}
NPY_WORDS = [
    b"(3,)",
    b"(3, 14, 3)",
    b"<f4",
    b"<U14",
    b"|O",
    b"(9999999999,)",
    b"\x93NUMPY",
    b"True",
    b"'",
]
ARRAYS = st.builds(
    lambda shape, dtype: npy(np.ones(shape, dtype)),
    st.sampled_from([(3,), (3, 14, 3), (), (14,), (0, 14, 3), (2,)]),
    st.sampled_from("f4 f8 i8 U3 S9 ? c8 M8[s] V4 f4,i2".split()),
)
ODD_MOTION = st.builds(
    lambda changes: archive_of(MEMBERS | changes),
    st.dictionaries(
        st.sampled_from(list(MEMBERS)),
        st.one_of(ARRAYS, files(list(MEMBERS.values()), NPY_WORDS)), min_size=1, max_size=3,
    ),
)  # fmt: skip
ZIP_WORDS = [
    b"PK\x03\x04",
    b"PK\x01\x02",
    b"\xff\xff\xff\xff",
    b"joints.npy",
    b"\x08\x00",
    b"\x0c\x00",
]


@fuzzed(st.one_of(ODD_MOTION, files([archive_of(MEMBERS)], ZIP_WORDS)))
def test_motion_npz(data: bytes) -> None:
    with file_of(data, "motion.npz") as path:
        try:
            motion = mocap.load_motion(path)
            assert motion.joints.shape[1:] == (14, 3) and np.isfinite(motion.joints).all()
        except mocap.MocapError as error:
            check_message(error)


# ---- Pickles of arrays ---------------------------------------------------------------------------

LEAVES = st.one_of(
    st.none(), st.integers(), st.floats(), st.text(max_size=3), st.binary(max_size=9),
    st.sampled_from(["f4", "f8", "i2", ">f4", "U2", "O", "c8", "M8[s]", "f4,i2"]).map(
        lambda kind: np.zeros(3, kind)
    ),
    st.just(np.zeros((2, 32, 3), "f4")), st.just(np.float64(2)), st.just(np.zeros((0, 32, 3))),
)  # fmt: skip
THINGS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=2), inner, max_size=3)
    ),
    max_leaves=8,
)
PICKLES = st.builds(
    lambda thing, protocol: pickle.dumps(thing, protocol), THINGS, st.integers(0, 5)
)
PERSON = {"S1": {"Walking": np.zeros((2, 32, 3), np.float32)}}
PICKLE_WORDS = [
    b"c",
    b".",
    b"R",
    b"b",
    b"(",
    b"t",
    b"e",
    b"s",
    b"0",
    b"2",
    b"q\xff",
    b"r\xff\xff\xff\x7f",
]
PICKLE_WORDS += [
    b"cos\nsystem\n",
    b"h\x01",
    b"\x94",
    b"p99999999999\n",
    b"\x8e\xff\xff\xff\xff\x7f\0\0\0",
]
PICKLE_WORDS += [
    b"cnumpy\ndtype\n",
    b"V8",
    b"O8",
    b"\x95\xff\xff\xff\xff\0\0\0\0",
    b"]",
    b"}",
    b"B\xff\xff\xff\x7f",
]
SEEDS = [pickle.dumps(PERSON, protocol) for protocol in (0, 2, 4)]


def positions_file(payload: bytes) -> bytes:
    """A file of positions whose pickle is this."""
    header = io.BytesIO()
    described = {"descr": "|O", "fortran_order": False, "shape": ()}
    np.lib.format.write_array_header_1_0(header, described)
    return archive_of({"positions_3d": header.getvalue() + payload})


@fuzzed(st.one_of(PICKLES, files(SEEDS, PICKLE_WORDS)))
def test_array_pickle(payload: bytes) -> None:
    try:
        check_plain(load_arrays(payload))
    except (pickle.UnpicklingError, *DAMAGED) as error:
        assert not isinstance(error, MemoryError)
    with file_of(positions_file(payload), "positions.npz") as path:
        try:
            read_positions(path, H36M)
        except mocap.MocapError as error:
            check_message(error)


# What a damaged pickle raises.
DAMAGED = (ValueError, TypeError, AttributeError, LookupError, EOFError, ArithmeticError)


def check_plain(thing: Any) -> None:
    """Dictionaries, lists, numbers, text and arrays of these."""
    if isinstance(thing, dict):
        for part in thing.values():
            check_plain(part)
    elif isinstance(thing, list):
        for part in thing:
            check_plain(part)
    elif isinstance(thing, np.ndarray) and thing.dtype.hasobject:
        for part in thing.ravel():
            check_plain(part)
    else:
        plain = (type(None), bool, int, float, str, bytes, bytearray, np.generic, np.ndarray)
        assert isinstance(thing, plain), type(thing)


# ---- Cameras -------------------------------------------------------------------------------------

LENS = {"id": "1", "center": [512, 515], "focal_length": [1145, 1143]}
LENS |= {"radial_distortion": [-0.2, 0.24, -0.003], "tangential_distortion": [0, 0]}
TABLES = {
    "h36m_cameras_intrinsic_params": [LENS],
    "h36m_cameras_extrinsic_params": {
        "S1": [{"orientation": [0.5, 0.5, -0.5, 0.5], "translation": [1, 2, 3]}],
        "S4": [{}],
    },
}
AS_JSON = json.dumps(TABLES).encode()
AS_PYTHON = "".join(f"{name} = {value!r}\n" for name, value in TABLES.items()).encode()
CAMERA_WORDS = [
    b"[",
    b"]",
    b"{",
    b"}",
    b"(",
    b")",
    b"'",
    b'"',
    b"None",
    b"1e999",
    b"NaN",
    b"9" * 5000,
]
CAMERA_WORDS += [b"[" * 2000, b"-", b"+1j", b"b'x'", b"\0", b"\xff", b"=", b"\n", b"x.y", b"*"]


@fuzzed(st.tuples(files([AS_JSON, AS_PYTHON], CAMERA_WORDS), st.sampled_from(["json", "py"])))
def test_cameras(given: tuple[bytes, str]) -> None:
    data, suffix = given
    with file_of(data, f"cameras.{suffix}") as path:
        try:
            for cameras in read_cameras(path, H36M).values():
                assert all(np.isfinite(camera.position).all() for camera in cameras)
        except mocap.MocapError as error:
            check_message(error)
