"""Motion capture to poses of the project's 14 joints: metres, world frame, y up.

    run.py data.mocap FOLDER --out FILE.npz [--set train]

reads every ASF/AMC trial (CMU's layout: NN/NN.asf, NN/NN_TT.amc) and BVH file below a folder, or
with --set those of CMU's that tools/data/cmu.py lists; drops bad frames, thins the rest and writes
one .npz.  `load_motion` reads such an .npz, or a folder directly.  A broken file raises
`MocapError`, whose message names the file and the line.
"""

import argparse
import hashlib
import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation
from tqdm import tqdm

from data.archives import load_npz, one_line
from data.cmu import SETS, Trials
from edmlift.joints import INDEX, JOINTS, indices, mid_hip
from edmlift.messages import OneLineError

LARGEST = 1 << 30  # bytes of the arrays of an .npz: six million poses
AMC_FPS = 120.0  # CMU's rate; an AMC file does not say
INCH = 0.0254  # metres; an ASF file's unit is an inch divided by its `length`
CGSPEED_UNIT = INCH / 0.45  # metres per unit of the well-known BVH conversion of CMU's data

# The ASF bone whose end is each joint (CMU's names).
ASF_BONES = {
    "head": "head",
    "neck_base": "thorax",
    "right_shoulder": "rclavicle",
    "right_elbow": "rhumerus",
    "right_wrist": "rwrist",
    "left_shoulder": "lclavicle",
    "left_elbow": "lhumerus",
    "left_wrist": "lwrist",
    "right_hip": "rhipjoint",
    "right_knee": "rfemur",
    "right_ankle": "rtibia",
    "left_hip": "lhipjoint",
    "left_knee": "lfemur",
    "left_ankle": "ltibia",
}

# The BVH node that sits at each joint, the most telling name first: `RightShoulder` is the
# shoulder in old files, but the collar bone's start where there is a `RightArm`.
BVH_TRUNK = {
    "head": ("Head end", "HeadTop_End", "head end"),
    "neck_base": ("Neck", "neck"),
}
BVH_LIMBS = {
    "shoulder": ("{Side}Arm", "{Side}UpArm", "{Side}UpperArm", "{Side}Shoulder", "{s}Shldr"),
    "elbow": ("{Side}ForeArm", "{Side}LowArm", "{Side}LowerArm", "{Side}Elbow", "{s}ForeArm"),
    "wrist": ("{Side}FingerBase", "{Side}Hand", "{Side}Wrist", "{s}Hand"),
    "hip": ("{Side}UpLeg", "{Side}UpperLeg", "{Side}Hip", "{s}Thigh"),
    "knee": ("{Side}Leg", "{Side}LowLeg", "{Side}LowerLeg", "{Side}Knee", "{s}Shin"),
    "ankle": ("{Side}Foot", "{Side}Ankle", "{s}Foot"),
}
BVH_NODES = BVH_TRUNK | {
    f"{side}_{joint}": tuple(name.format(Side=side.title(), s=side[0]) for name in names)
    for side in ("right", "left")
    for joint, names in BVH_LIMBS.items()
}

# The cgspeed conversion lost the length of these ASF bones: its nodes at their ends have offset 0.
BVH_LOST = {
    "Neck": "thorax",
    "RightShoulder": "thorax",
    "LeftShoulder": "thorax",
    "RightFingerBase": "rwrist",
    "LeftFingerBase": "lwrist",
}

# Names of joints in files that were made before: their names today.
OLDER_NAMES = {"head_top": "head", "neck": "neck_base"}

# What an .npz holds: in words, and the kinds of NumPy's types.
TYPES = dict.fromkeys(("joints", "subject", "trial", "frame", "action"), ("numbers", "fiu"))
TYPES |= dict.fromkeys(("joint_names", "action_names", "up", "unit"), ("text", "US"))
DIMENSIONS = {"joint_names": 1, "action_names": 1, "up": 0, "unit": 0}  # of text

STATURE = 1.6  # metres, head to ankle of an adult ...
STATURE_RANGE = (0.8, 2.6)  # ... and what may still be a person
T_POSE_DEGREES = 15.0  # limbs of a T-pose are straight, its arms level, to within this
MOST_DIGITS = 15  # of a frame's number
FAST_MARGIN = 0.1  # seconds dropped on both sides of an impossible speed


class MocapError(OneLineError, ValueError):
    """A file that cannot be used; the message names the file and, for a text file, the line."""


@dataclass(frozen=True)
class Motion:
    """Poses of many trials, one after the other."""

    joints: np.ndarray  # [F,14,3] float32, metres, world frame, y up
    subject: np.ndarray  # [F] int
    trial: np.ndarray  # [F] int
    frame: np.ndarray  # [F] int, index in the original file
    action: np.ndarray  # [F] int, index into action_names; -1 where unknown
    action_names: tuple[str, ...]
    source: str  # name of the file or folder

    def take(self, which: np.ndarray) -> "Motion":
        """Some of the poses: a mask or indices."""
        arrays = ("joints", "subject", "trial", "frame", "action")
        return replace(self, **{name: getattr(self, name)[which] for name in arrays})

    @property
    def sha256(self) -> str:
        """Of the joints, by which manifests know the data."""
        return hashlib.sha256(np.ascontiguousarray(self.joints).tobytes()).hexdigest()


@dataclass(frozen=True)
class Trial:
    """One recording, as the file has it."""

    joints: np.ndarray  # [F,14,3] metres
    blank: np.ndarray  # [F] bool: every channel of the frame is zero
    fps: float


# Text files


class TextFile:
    """The non-blank lines of a file as (number, words), and errors that name the line."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise MocapError(f"{path}: {error.strerror}") from None
        numbered = enumerate(text.splitlines(), 1)
        self.rows = [(number, line.split()) for number, line in numbered if line.strip()]
        self.last = self.rows[-1][0] if self.rows else 1

    def error(self, number: int, message: str) -> MocapError:
        return MocapError(f"{self.path}:{number}: {message}")

    def numbers(self, number: int, words: list[str], count: int) -> list[float]:
        """The words of a line as `count` finite numbers."""
        if len(words) != count:
            raise self.error(number, f"{count} numbers expected, {len(words)} found")
        try:
            values = [float(word) for word in words]
        except ValueError as error:
            raise self.error(number, f"not a number ({error})") from None
        if not all(map(math.isfinite, values)):
            raise self.error(number, f"not a finite number in {' '.join(words)!r}")
        return values


Row = tuple[int, list[str]]  # line number, words


# ASF and AMC


@dataclass(frozen=True)
class Bone:
    """An ASF bone; the root is one of no length."""

    name: str
    parent: str  # "" for the root
    offset: np.ndarray  # [3] start to end at rest, metres
    axis: Rotation  # the frame in which the channels rotate the bone
    channels: tuple[str, ...]  # of tx ty tz rx ry rz, in the order of the AMC's numbers

    @property
    def rotations(self) -> str:
        """Axes of the rotation channels, the first applied first."""
        return "".join(channel[1] for channel in self.channels if channel[0] == "r")


@dataclass(frozen=True)
class Skeleton:
    """An ASF file: bones from the root on, every parent before its children."""

    bones: dict[str, Bone]
    unit: float  # metres per unit of the AMC's translations

    def needed(self) -> list[Bone]:
        """The bones on the way to our joints, parents first."""
        names = set()
        for name in ASF_BONES.values():
            while name:
                names.add(name)
                name = self.bones[name].parent
        return [bone for bone in self.bones.values() if bone.name in names]


def read_asf(path: Path) -> Skeleton:
    """Reads an ASF skeleton."""
    text = TextFile(path)
    sections = _asf_sections(text)
    for name in (":units", ":root", ":bonedata", ":hierarchy"):
        if name not in sections:
            raise text.error(text.last, f"the file ends without a section {name}")
    unit = _asf_unit(text, sections[":units"])
    blocks = {
        _asf_field(text, block, "name")[1][0]: block
        for block in _asf_blocks(text, sections[":bonedata"])
    }
    bones = {"root": _asf_root(text, dict(_fields(sections[":root"])))}
    for name, (number, parent) in _asf_parents(text, sections[":hierarchy"]).items():
        if name not in blocks:
            raise text.error(number, f"bone {name} is not in :bonedata")
        bones[name] = _asf_bone(text, name, parent, blocks[name], unit)
    missing = [name for name in ASF_BONES.values() if name not in bones]
    if missing:
        raise text.error(text.last, f"bone {missing[0]} is missing from :hierarchy")
    return Skeleton(bones, unit)


Fields = dict[str, Row]  # first word of a line -> line number, the other words


def _fields(rows: list[Row]) -> Iterator[tuple[str, Row]]:
    return ((words[0], (number, words[1:])) for number, words in rows)


def _asf_sections(text: TextFile) -> dict[str, list[Row]]:
    sections: dict[str, list[Row]] = {}
    rows = None
    for number, words in text.rows:
        if words[0].startswith("#"):
            continue
        if words[0].startswith(":"):
            rows = sections.setdefault(words[0], [])
        elif rows is None:
            raise text.error(number, "text before the first :section; not an ASF file")
        else:
            rows.append((number, words))
    return sections


def _asf_blocks(text: TextFile, rows: list[Row]) -> Iterator[Fields]:
    """The fields of each begin ... end block."""
    block: list[Row] | None = None
    for number, words in rows:
        if words == ["begin"]:
            block = []
        elif block is None:
            raise text.error(number, "'begin' expected")
        elif words == ["end"]:
            yield dict(_fields(block)) | {"end": (number, [])}
            block = None
        else:
            block.append((number, words))
    if block is not None:
        raise text.error(text.last, "a block ends without 'end'; is the file cut off?")


def _asf_field(text: TextFile, block: Fields, name: str) -> Row:
    number, words = block.get(name, (0, []))
    if not words:
        raise text.error(block["end"][0], f"a bone without '{name}' ends here")
    return number, words


def _asf_unit(text: TextFile, rows: list[Row]) -> float:
    fields = dict(_fields(rows))
    number, words = fields.get("length", (rows[0][0] if rows else text.last, []))
    (length,) = text.numbers(number, words, 1)
    if length <= 0:
        raise text.error(number, "the unit of length must be positive")
    number, words = fields.get("angle", (number, ["deg"]))
    if words != ["deg"]:
        raise text.error(number, "only 'angle deg' is supported")
    return INCH / length


def _asf_root(text: TextFile, fields: Fields) -> Bone:
    number, words = fields.get("order", (text.last, []))
    channels = tuple(word.lower() for word in words)
    if sorted(channels) != ["rx", "ry", "rz", "tx", "ty", "tz"]:
        raise text.error(number, "the root's order must name TX TY TZ RX RY RZ")
    for name in ("position", "orientation"):
        number, words = fields.get(name, (number, ["0"] * 3))
        if any(text.numbers(number, words, 3)):
            raise text.error(number, f"a root {name} other than 0 0 0 is not supported")
    return Bone("root", "", np.zeros(3), Rotation.identity(), channels)


def _asf_bone(text: TextFile, name: str, parent: str, block: Fields, unit: float) -> Bone:
    direction = text.numbers(*_asf_field(text, block, "direction"), 3)
    (length,) = text.numbers(*_asf_field(text, block, "length"), 1)
    number, words = _asf_field(text, block, "axis")
    angles = text.numbers(number, words[:3], 3)
    order = "".join(words[3:]).lower()
    if sorted(order) != ["x", "y", "z"]:
        raise text.error(number, "the axis must end in an order such as XYZ")
    number, words = block.get("dof", (number, []))
    channels = tuple(word.lower() for word in words)
    if not set(channels) <= {"rx", "ry", "rz"} or len(set(channels)) < len(channels):
        raise text.error(number, f"dof {' '.join(words)!r}: only rx, ry and rz are supported")
    offset = np.array(direction) * length * unit
    if name in ASF_BONES.values() and not offset.any():
        raise text.error(number, f"bone {name} has no length")
    axis = Rotation.from_euler(order, angles, degrees=True)
    return Bone(name, parent, offset, axis, channels)


def _asf_parents(text: TextFile, rows: list[Row]) -> dict[str, tuple[int, str]]:
    """Bone -> (line, parent) for every bone that hangs from the root, parents first."""
    children: dict[str, Row] = {}
    for number, words in rows:
        if words not in (["begin"], ["end"]):
            children[words[0]] = (number, words[1:])
    parents: dict[str, tuple[int, str]] = {}
    queue = ["root"]
    for parent in queue:  # grows as it is walked
        number, names = children.get(parent, (0, []))
        for name in names:
            if name in parents or name == "root":
                raise text.error(number, f"bone {name} has two parents")
            parents[name] = (number, parent)
            queue.append(name)
    return parents


def read_amc(path: Path, skeleton: Skeleton) -> Trial:
    """Reads an AMC trial of `skeleton`."""
    channels = _amc_channels(TextFile(path), skeleton)
    rotation: dict[str, Rotation] = {}
    end: dict[str, np.ndarray] = {}
    for bone in skeleton.needed():
        own = bone.axis * _rotation(bone, channels) * bone.axis.inv()
        if bone.parent:
            rotation[bone.name] = rotation[bone.parent] * own
            end[bone.name] = end[bone.parent] + rotation[bone.name].apply(bone.offset)
        else:
            rotation[bone.name] = own
            place = [bone.channels.index(channel) for channel in ("tx", "ty", "tz")]
            end[bone.name] = channels[bone.name][:, place] * skeleton.unit
    joints = np.stack([end[ASF_BONES[joint]] for joint in JOINTS], 1)
    return Trial(joints, ~np.hstack(list(channels.values())).any(1), AMC_FPS)


def _rotation(bone: Bone, channels: dict[str, np.ndarray]) -> Rotation:
    if not bone.rotations:
        return Rotation.identity()
    columns = [i for i, channel in enumerate(bone.channels) if channel[0] == "r"]
    return Rotation.from_euler(bone.rotations, channels[bone.name][:, columns], degrees=True)


def _amc_channels(text: TextFile, skeleton: Skeleton) -> dict[str, np.ndarray]:
    """Numbers [F,C] of each moving bone on the way to our joints."""
    values: dict[str, list[list[float]]] = {b.name: [] for b in skeleton.needed() if b.channels}
    frames = previous = 0

    def check_frame(number: int) -> None:
        for name, rows in values.items():
            if len(rows) != frames:
                count = len(rows) - frames + 1
                raise text.error(number, f"bone {name} has {count} lines in the frame before this")

    for number, words in text.rows:
        if words[0].startswith("#"):
            continue
        if words[0].startswith(":"):
            if words[0].upper() == ":RADIANS":
                raise text.error(number, "angles in radians are not supported")
        elif len(words) == 1 and words[0].isdecimal() and len(words[0]) <= MOST_DIGITS:
            check_frame(number)
            if frames and int(words[0]) != previous + 1:
                raise text.error(number, f"frame {words[0]} follows frame {previous}")
            previous = int(words[0])
            frames += 1
        elif frames == 0 or words[0] not in skeleton.bones:
            raise text.error(number, f"{words[0]!r} is neither a frame number nor a bone")
        else:
            row = text.numbers(number, words[1:], len(skeleton.bones[words[0]].channels))
            if words[0] in values:
                values[words[0]].append(row)
    if frames == 0:
        raise text.error(text.last, "no frames")
    check_frame(text.last + 1)
    return {name: np.array(rows) for name, rows in values.items()}


# BVH


@dataclass
class Node:
    """A joint or end site of a BVH file."""

    name: str  # "NAME end" for the end site below NAME
    parent: str  # "" for the root
    line: int
    offset: np.ndarray | None = None  # [3] from the parent at rest, metres
    channels: tuple[str, ...] = ()


def read_bvh(path: Path, unit: float = CGSPEED_UNIT, offsets_from: Skeleton | None = None) -> Trial:
    """Reads a BVH trial; `unit` is metres per unit of the file.

    Where one of our joints has offset 0 from its parent the file has lost a bone, and is refused
    unless `offsets_from`, the same person's ASF skeleton, restores it.
    """
    text = TextFile(path)
    nodes, start = _bvh_nodes(text, unit)
    ours = _bvh_joints(text, nodes)
    if offsets_from:
        _bvh_restore(text, nodes, offsets_from)
    for joint, name in ours.items():
        if not nodes[name].offset.any():
            raise text.error(
                nodes[name].line,
                f"{name} ({joint}) has offset 0 0 0: a bone's length is lost. Take the ASF/AMC "
                "original, or restore the length from the person's skeleton (--offsets)",
            )
    values, fps = _bvh_values(text, nodes, start)
    places = _bvh_places(nodes, values, unit)
    joints = np.stack([places[ours[joint]] for joint in JOINTS], 1)
    return Trial(joints, ~values.any(1), fps)


def _bvh_nodes(text: TextFile, unit: float) -> tuple[dict[str, Node], int]:
    """The nodes, parents first, and the index of the row after MOTION."""
    nodes: dict[str, Node] = {}
    path: list[Node] = []  # from the root to the node being read
    for index, (number, words) in enumerate(text.rows):
        words = [word for word in words if word != "{"]  # "}" alone shows the nesting
        match words:
            case [] | ["HIERARCHY"]:
                pass
            case ["ROOT", name] if not nodes:
                _bvh_open(text, number, name, nodes, path)
            case ["JOINT", name] if path:
                _bvh_open(text, number, name, nodes, path)
            case ["End", "Site"] if path:
                _bvh_open(text, number, f"{path[-1].name} end", nodes, path)
            case ["OFFSET", *rest] if path:
                path[-1].line = number
                path[-1].offset = np.array(text.numbers(number, rest, 3)) * unit
            case ["CHANNELS", count, *names] if path:
                path[-1].channels = _bvh_channels(text, number, count, names, not path[-1].parent)
            case ["}"] if path:
                node = path.pop()
                if node.offset is None or not (node.channels or node.parent):
                    raise text.error(number, f"{node.name} ends without OFFSET or CHANNELS")
            case ["MOTION"] if nodes and not path:
                return nodes, index + 1
            case _:
                raise text.error(number, f"{' '.join(words)!r} is not expected here")
    raise text.error(text.last, "the file ends before MOTION")


def _bvh_open(
    text: TextFile, number: int, name: str, nodes: dict[str, Node], path: list[Node]
) -> None:
    """Adds a node below the last one of `path`, and to `path`."""
    name = name.rpartition(":")[2]  # some exporters write NAMESPACE:NAME
    if name in nodes:
        raise text.error(number, f"a second joint {name}")
    nodes[name] = Node(name, path[-1].name if path else "", number)
    path.append(nodes[name])


def _bvh_channels(
    text: TextFile, number: int, count: str, names: list[str], root: bool
) -> tuple[str, ...]:
    rotations = ["Xrotation", "Yrotation", "Zrotation"]
    moves = ["Xposition", "Yposition", "Zposition"]
    if count != str(len(names)):
        raise text.error(number, f"CHANNELS {count}, but {len(names)} names")
    if sorted(names) != sorted(rotations + moves if root else rotations):
        raise text.error(
            number, "each joint must have three rotations, the root three positions besides"
        )
    return tuple(names)


def _bvh_joints(text: TextFile, nodes: dict[str, Node]) -> dict[str, str]:
    """Our joint -> name of the file's node."""
    found = {}
    for joint, names in BVH_NODES.items():
        known = [name for name in names if name in nodes]
        if not known:
            raise text.error(text.last, f"no joint for {joint}; known names: {', '.join(names)}")
        found[joint] = known[0]
    return found


def _bvh_restore(text: TextFile, nodes: dict[str, Node], skeleton: Skeleton) -> None:
    """Gives the nodes at the end of lost bones the skeleton's offsets."""
    for name, bone in BVH_LOST.items():
        if name in nodes and not nodes[name].offset.any():
            nodes[name].offset = skeleton.bones[bone].offset
    thigh = nodes.get("RightLeg")
    if thigh and not np.allclose(thigh.offset, skeleton.bones["rfemur"].offset, atol=0.001):
        raise text.error(thigh.line, "the thigh is not the skeleton's: another person's --offsets?")


def _bvh_values(text: TextFile, nodes: dict[str, Node], start: int) -> tuple[np.ndarray, float]:
    """Channel values [F,C] and frames per second."""
    rows = text.rows[start:]
    if len(rows) < 2 or rows[0][1][0] != "Frames:" or rows[1][1][:2] != ["Frame", "Time:"]:
        raise text.error(rows[0][0] if rows else text.last, "'Frames:', 'Frame Time:' expected")
    (count,) = text.numbers(rows[0][0], rows[0][1][1:], 1)
    (period,) = text.numbers(rows[1][0], rows[1][1][2:], 1)
    if period <= 0:
        raise text.error(rows[1][0], "the frame time must be positive")
    if len(rows) - 2 != count or count < 1:
        raise text.error(text.last, f"{count:g} frames announced, {len(rows) - 2} found")
    width = sum(len(node.channels) for node in nodes.values())
    values = [text.numbers(number, words, width) for number, words in rows[2:]]
    return np.array(values), 1 / period


def _bvh_places(nodes: dict[str, Node], values: np.ndarray, unit: float) -> dict[str, np.ndarray]:
    """World position [F,3] of each node, metres."""
    world: dict[str, Rotation] = {}
    place: dict[str, np.ndarray] = {}
    column = 0
    for node in nodes.values():
        own = dict(zip(node.channels, values[:, column:].T, strict=False))
        column += len(node.channels)
        names = [name for name in node.channels if name.endswith("rotation")]
        rotation = Rotation.identity()
        if names:
            angles = np.stack([own[name] for name in names], 1)
            rotation = Rotation.from_euler("".join(n[0] for n in names), angles, degrees=True)
        if node.parent:
            world[node.name] = world[node.parent] * rotation
            place[node.name] = place[node.parent] + world[node.parent].apply(node.offset)
        else:
            world[node.name] = rotation
            move = np.stack([own[f"{axis}position"] for axis in "XYZ"], 1) * unit
            place[node.name] = node.offset + move
    return place


# Cleaning


@dataclass(frozen=True)
class Cleaning:
    """How a folder is read."""

    fps: float = 15.0  # thin to this rate ...
    min_move: float = 0.020  # ... and to this mean joint movement relative to the root, metres
    max_joint_speed: float = 16.0  # m/s, relative to the root
    max_pelvis_speed: float = 12.0  # m/s
    bvh_unit: float = CGSPEED_UNIT  # metres
    offsets: Skeleton | None = None  # restores lost bones of BVH files


def clean(trial: Trial, cleaning: Cleaning) -> np.ndarray:
    """Indices of the frames worth keeping, ascending."""
    bad = trial.blank | is_t_pose(trial.joints)
    bad |= _too_fast(trial, bad, cleaning)
    root = mid_hip(trial.joints)
    pose = trial.joints - root[:, None]
    kept: list[int] = []
    for frame in range(0, len(pose), max(1, round(trial.fps / cleaning.fps))):
        if bad[frame]:
            continue
        if kept:
            moved = np.linalg.norm(pose[frame] - pose[kept[-1]], axis=-1).mean()
            if moved < cleaning.min_move:
                continue
        kept.append(frame)
    return np.array(kept, int)


def is_t_pose(joints: np.ndarray) -> np.ndarray:
    """True where a calibration pose is held: arms spread, limbs straight; [F,14,3] -> [F]."""

    def along(start: str, end: str) -> np.ndarray:
        v = joints[:, INDEX[end]] - joints[:, INDEX[start]]
        return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-9)

    right, left = along("left_shoulder", "right_shoulder"), along("right_shoulder", "left_shoulder")
    pairs = [
        (right, along("right_shoulder", "right_elbow")),
        (right, along("right_elbow", "right_wrist")),
        (left, along("left_shoulder", "left_elbow")),
        (left, along("left_elbow", "left_wrist")),
        (along("right_hip", "right_knee"), along("right_knee", "right_ankle")),
        (along("left_hip", "left_knee"), along("left_knee", "left_ankle")),
    ]
    cosines = [(a * b).sum(-1) for a, b in pairs]
    return np.min(cosines, 0) > np.cos(np.radians(T_POSE_DEGREES))


def _too_fast(trial: Trial, bad: np.ndarray, cleaning: Cleaning) -> np.ndarray:
    """True [F] around jumps between frames that are not `bad` already."""
    root = mid_hip(trial.joints)
    pose = trial.joints - root[:, None]
    joint_speed = np.linalg.norm(np.diff(pose, axis=0), axis=-1).max(-1) * trial.fps
    pelvis_speed = np.linalg.norm(np.diff(root, axis=0), axis=-1) * trial.fps
    jump = (joint_speed > cleaning.max_joint_speed) | (pelvis_speed > cleaning.max_pelvis_speed)
    margin = round(FAST_MARGIN * trial.fps)
    fast = np.zeros(len(pose), bool)
    for first in np.flatnonzero(jump & ~bad[:-1] & ~bad[1:]):  # from frame `first` to the next
        fast[max(0, first - margin) : first + 1 + margin + 1] = True
    return fast


# Folders and .npz files


def read_folder(
    folder: Path, cleaning: Cleaning | None = None, only: Trials | None = None
) -> Motion:
    """Reads every trial below a folder, or `only` some; broken files are reported on stderr and
    skipped."""
    cleaning = cleaning or Cleaning()
    paths = sorted(p for p in folder.rglob("*") if p.suffix.lower() in (".amc", ".bvh"))
    if only is not None:
        paths = [path for path in paths if _numbers_of(path) in only]
    if not paths:
        raise MocapError(f"{folder}: no .amc or .bvh file{'' if only is None else ' of the set'}")
    skeletons: dict[Path, Skeleton] = {}
    parts = []
    for path in tqdm(paths, desc=folder.name, unit="file", disable=None):
        try:
            parts.append(_read_trial(path, skeletons, cleaning))
        except MocapError as error:
            tqdm.write(f"skipped: {error}", file=sys.stderr)
    poses = sum(len(part[0]) for part in parts)
    print(
        f"{folder.name}: {len(parts)} files read, {len(paths) - len(parts)} skipped, "
        f"{poses} poses kept",
        file=sys.stderr,
    )
    if not poses:
        raise MocapError(f"{folder}: not one usable frame")
    joints, subject, trial, frame = (np.concatenate(column) for column in zip(*parts, strict=True))
    action = np.full(poses, -1)
    motion = Motion(joints.astype(np.float32), subject, trial, frame, action, (), folder.name)
    return _checked(motion, folder)


def _read_trial(
    path: Path, skeletons: dict[Path, Skeleton], cleaning: Cleaning
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Joints, subject, trial and frame of the frames kept; `skeletons` caches the ASF files."""
    numbers = re.match(r"(\d+)_(\d+)", path.name)
    if not numbers:
        raise MocapError(f"{path}: the name must begin with SUBJECT_TRIAL, two numbers")
    if path.suffix.lower() == ".bvh":
        trial = read_bvh(path, cleaning.bvh_unit, cleaning.offsets)
    else:
        asf = path.with_name(f"{numbers[1]}.asf")
        if asf not in skeletons:
            skeletons[asf] = read_asf(asf)
        trial = read_amc(path, skeletons[asf])
    frame = clean(trial, cleaning)
    subject = np.full(len(frame), int(numbers[1]))
    return trial.joints[frame], subject, np.full(len(frame), int(numbers[2])), frame


def _numbers_of(path: Path) -> tuple[int, int] | None:
    """Subject and trial of a file name; None if it has none."""
    numbers = re.match(r"(\d+)_(\d+)", path.name)
    return (int(numbers[1]), int(numbers[2])) if numbers else None


def load_motion(path: Path) -> Motion:
    """Reads an .npz of this tool's layout, or a folder with the default cleaning."""
    return read_folder(path) if path.is_dir() else _load_npz(path)


def save_motion(motion: Motion, path: Path, fps: float) -> None:
    """Writes an .npz that `load_motion` reads; `fps` is noted in it."""
    with path.open("wb") as file:
        np.savez_compressed(
            file,
            joints=motion.joints,
            subject=motion.subject,
            trial=motion.trial,
            frame=motion.frame,
            joint_names=np.array(JOINTS),
            up="y",
            unit="m",
            fps=fps,
        )


def _load_npz(path: Path) -> Motion:
    if not path.exists():
        raise MocapError(f"{path}: no such file or folder")
    try:
        data = load_npz(path, LARGEST)
    except Exception as error:  # a damaged archive makes the libraries raise whatever they like
        raise MocapError(f"{path}: not a readable .npz file ({one_line(error)})") from None
    for key in ("joints", "subject", "trial", "frame", "joint_names", "up", "unit"):
        if key not in data:
            raise MocapError(f"{path}: key '{key}' is missing")
    _check_types(path, data)
    _check_names(path, data["joint_names"])
    for key, value in (("up", "y"), ("unit", "m")):
        if str(data[key]) != value:
            raise MocapError(f"{path}: {key} is '{data[key]}', must be '{value}'")
    action = data.get("action", np.full(data["frame"].shape, -1))
    motion = Motion(
        data["joints"].astype(np.float32),
        data["subject"].astype(int),
        data["trial"].astype(int),
        data["frame"].astype(int),
        action.astype(int),
        tuple(str(name) for name in data.get("action_names", ())),
        path.name,
    )
    return _checked(motion, path)


def _check_types(path: Path, data: dict[str, np.ndarray]) -> None:
    """Which arrays must be text, of how many dimensions, and which numbers."""
    for key, array in data.items():
        kinds = TYPES.get(key, ("numbers", array.dtype.kind))
        if array.dtype.kind not in kinds[1]:
            raise MocapError(f"{path}: {key} is of type {array.dtype}, must be {kinds[0]}")
        if array.ndim != (wanted := DIMENSIONS.get(key, array.ndim)):
            raise MocapError(f"{path}: {key} has {array.ndim} dimensions, must have {wanted}")


def _check_names(path: Path, names: np.ndarray) -> None:
    """Joint names must be ours, in our order.  r_ and l_ stand for right_ and left_; files made
    before the first release call the first two joints by other names."""
    if names.shape != (len(JOINTS),):
        raise MocapError(f"{path}: {names.size} joint names, must be {len(JOINTS)}")
    for i, (name, ours) in enumerate(zip(names.astype(str), JOINTS, strict=True)):
        if _current_name(str(name)) != ours:
            raise MocapError(f"{path}: joint {i} is '{name}', must be '{ours}'")


def _current_name(name: str) -> str:
    """The name that a joint of a file has today."""
    sides = {"r_": "right_", "l_": "left_"}
    return OLDER_NAMES.get(name, sides.get(name[:2], name[:2]) + name[2:])


def _checked(motion: Motion, path: Path) -> Motion:
    """The motion itself, if its shapes and values can be those of people."""
    joints = motion.joints
    if joints.ndim != 3 or joints.shape[1:] != (len(JOINTS), 3):
        raise MocapError(f"{path}: joints have shape {joints.shape}, must be [F,14,3]")
    if len(joints) == 0:
        raise MocapError(f"{path}: no frames")
    for key in ("subject", "trial", "frame", "action"):
        shape = getattr(motion, key).shape
        if shape != (len(joints),):
            raise MocapError(f"{path}: {key} has shape {shape}, must be ({len(joints)},)")
    if not np.isfinite(joints).all():
        frame, joint = np.argwhere(~np.isfinite(joints))[0, :2]
        raise MocapError(f"{path}: frame {frame}, {JOINTS[joint]} is not finite")
    ankles = joints[:, indices(("right_ankle", "left_ankle"))]
    stature = np.median(np.linalg.norm(joints[:, [INDEX["head"]]] - ankles, axis=-1))
    if not STATURE_RANGE[0] <= stature <= STATURE_RANGE[1]:
        raise MocapError(
            f"{path}: the units look wrong: head to ankle is {stature:.4g} m (median), "
            f"{stature / STATURE:.4g} times a person's"
        )
    return motion


def options() -> argparse.Namespace:
    defaults = Cleaning()
    parser = argparse.ArgumentParser(
        description="Reads motion capture (ASF/AMC in CMU's layout, BVH) below a folder and "
        "writes the poses of 14 joints, in metres and y up, to an .npz file.",
    )
    parser.add_argument("folder", type=Path, help="file names must begin with SUBJECT_TRIAL")
    parser.add_argument("--out", type=Path, required=True, help="the .npz file to write")
    parser.add_argument("--set", choices=SETS, help="only the trials of CMU's that we use")
    parser.add_argument(
        "--fps", type=float, default=defaults.fps, help="thin to this rate; default %(default)g"
    )
    parser.add_argument(
        "--min-move",
        type=float,
        default=defaults.min_move,
        help="drop a frame whose joints moved less, on average, since the last one kept; "
        "metres, default %(default)g",
    )
    parser.add_argument(
        "--max-joint-speed",
        type=float,
        default=defaults.max_joint_speed,
        help="drop frames around a joint faster than this relative to the pelvis; m/s, "
        "default %(default)g",
    )
    parser.add_argument(
        "--max-pelvis-speed",
        type=float,
        default=defaults.max_pelvis_speed,
        help="drop frames around a pelvis faster than this; m/s, default %(default)g",
    )
    parser.add_argument(
        "--bvh-unit",
        type=float,
        default=defaults.bvh_unit,
        help="metres per unit of the BVH files; default %(default).4f, CMU's",
    )
    parser.add_argument(
        "--offsets",
        type=Path,
        metavar="ASF",
        help="restore bones of no length in BVH files from this person's skeleton",
    )
    return parser.parse_args()


def main() -> int:
    args = options()
    try:
        cleaning = Cleaning(
            fps=args.fps,
            min_move=args.min_move,
            max_joint_speed=args.max_joint_speed,
            max_pelvis_speed=args.max_pelvis_speed,
            bvh_unit=args.bvh_unit,
            offsets=read_asf(args.offsets) if args.offsets else None,
        )
        only = SETS[args.set] if args.set else None
        save_motion(read_folder(args.folder, cleaning, only), args.out, args.fps)
    except MocapError as error:
        print(f"mocap: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
