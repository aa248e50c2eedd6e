"""BVH, the text file of a skeleton and its rotations that animation programs read."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from edmlift.motion.bones import LEAVES, NODES, local, offsets, rotations
from edmlift.motion.clip import Clip
from edmlift.motion.held import held

_F64 = NDArray[np.float64]
_POSITION, _ROTATION = "Xposition Yposition Zposition", "Zrotation Xrotation Yrotation"


def write_bvh(path: Path, clip: Clip) -> None:
    """Metres and degrees; the root's offset is 0, because programs differ in what they make of
    one."""
    clip = held(path, clip)
    rest = offsets(clip.joints)
    rest[0] = 0.0
    order = list(_depth_first(0))
    turning = [i for i in order if i not in LEAVES]
    angles = np.degrees(_continuous(_euler(local(rotations(clip.joints))[:, turning])))
    hips = (clip.joints[:, _HIPS[0]] + clip.joints[:, _HIPS[1]]) / 2
    count = len(clip.joints)
    rows = np.concatenate([hips, angles.reshape(count, -1)], axis=1)
    line = " ".join(["%.5f"] * 3 + ["%.4f"] * (rows.shape[1] - 3)) + "\n"
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write("HIERARCHY\n")
        file.writelines(f"{text}\n" for text in _hierarchy(0, rest, 0))
        file.write(f"MOTION\nFrames: {count}\nFrame Time: {1 / clip.rate:.9g}\n")
        file.writelines(line % tuple(row.tolist()) for row in rows)


_HIPS = tuple(node.place for node in NODES if node.name in ("right_hip", "left_hip"))


def _children(i: int) -> list[int]:
    return [n for n, node in enumerate(NODES) if node.parent == i]


def _depth_first(i: int) -> Iterator[int]:
    """Nodes in the order of the file."""
    yield i
    for child in _children(i):
        yield from _depth_first(child)


def _hierarchy(i: int, rest: _F64, depth: int) -> Iterator[str]:
    """Lines of a node and those below it."""
    indent = "\t" * depth
    if i in LEAVES:
        yield f"{indent}End Site"
    else:
        yield f"{indent}{'JOINT' if depth else 'ROOT'} {NODES[i].name}"
    yield indent + "{"
    yield indent + "\tOFFSET " + " ".join(f"{value + 0.0:.5f}" for value in rest[i])
    if i not in LEAVES:
        names = f"{_POSITION} {_ROTATION}" if depth == 0 else _ROTATION
        yield f"{indent}\tCHANNELS {len(names.split())} {names}"
    for child in _children(i):
        yield from _hierarchy(child, rest, depth + 1)
    yield indent + "}"


def _euler(turned: _F64) -> _F64:
    """Angles z, x, y [..., 3] in radians: a rotation about y, then x, then z, is the matrix."""
    z = np.arctan2(-turned[..., 0, 1], turned[..., 1, 1])
    cosine, sine = np.cos(z)[..., None], np.sin(z)[..., None]
    # What is left without z: exact also where x is a right angle, and z is any.
    first = cosine * turned[..., 0, :] + sine * turned[..., 1, :]
    second = cosine * turned[..., 1, :] - sine * turned[..., 0, :]
    x = np.arctan2(turned[..., 2, 1], second[..., 1])
    y = np.arctan2(first[..., 2], first[..., 0])
    return np.stack([z, x, y], axis=-1)


def _continuous(angles: _F64) -> _F64:
    """The same rotations [F,N,3] by angles that change little from frame to frame: each has two
    sets, and any number of turns."""
    out = angles.copy()
    other = np.stack([angles[..., 0] + np.pi, np.pi - angles[..., 1], angles[..., 2] + np.pi], -1)
    for frame in range(1, len(out)):
        before = out[frame - 1]
        sets = [given[frame] - _turns(given[frame] - before) for given in (angles, other)]
        first, second = (np.abs(given - before).sum(-1, keepdims=True) for given in sets)
        out[frame] = np.where(first <= second, *sets)
    return out


def _turns(angles: _F64) -> _F64:
    """The whole turns in angles."""
    return np.asarray(2 * np.pi * np.rint(angles / (2 * np.pi)))
