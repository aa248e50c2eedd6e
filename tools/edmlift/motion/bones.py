"""A skeleton of bones that keep their length and rotate, as BVH and glTF want it.

Its root is mid-hip.  At rest a person stands in a T, arms along x and palms down, faces z, and the
left is towards x: each bone lies along an axis, and nothing is rotated.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from edmlift.joint_angles import unit
from edmlift.joints import INDEX, JOINTS, mid_hip

_F64 = NDArray[np.float64]
_HIPS = len(JOINTS)  # mid-hip behind the 14 joints
_X, _Y, _Z = np.eye(3)
_STRAIGHT = np.sin(np.radians(20.0))  # a limb less bent than this hardly says how it is rolled
_NO_LENGTH = 1e-3  # metres; a shorter bone has no direction


@dataclass(frozen=True)
class Node:
    """A joint of the skeleton, and the bone from its parent's."""

    name: str
    parent: int  # -1: the root
    place: int  # index of the joint, or mid-hip
    rest: _F64  # [3] direction from the parent at rest


def _nodes() -> tuple[Node, ...]:
    nodes = [
        Node("hips", -1, _HIPS, _Y),
        Node("spine", 0, _HIPS, _Y),
        Node("neck_base", 1, INDEX["neck_base"], _Y),
        Node("head", 2, INDEX["head"], _Y),
    ]
    for side, out in (("right", -_X), ("left", _X)):
        arm, at_neck = len(nodes), INDEX["neck_base"]
        nodes += [
            Node(f"{side}_clavicle", 1, at_neck, _Y),
            Node(f"{side}_shoulder", arm, INDEX[f"{side}_shoulder"], out),
            Node(f"{side}_elbow", arm + 1, INDEX[f"{side}_elbow"], out),
            Node(f"{side}_wrist", arm + 2, INDEX[f"{side}_wrist"], out),
            Node(f"{side}_hip", 0, INDEX[f"{side}_hip"], out),
            Node(f"{side}_knee", arm + 4, INDEX[f"{side}_knee"], -_Y),
            Node(f"{side}_ankle", arm + 5, INDEX[f"{side}_ankle"], -_Y),
        ]
    return tuple(nodes)


NODES = _nodes()
NUMBER = {node.name: i for i, node in enumerate(NODES)}
LEAVES = tuple(i for i in range(len(NODES)) if all(node.parent != i for node in NODES))
# The axis at rest about which elbows and knees bend forward and backward: of arms, palms down.
_HINGES = {
    "right_shoulder": _Y, "left_shoulder": -_Y, "right_hip": _X, "left_hip": _X,
}  # fmt: skip


def places(joints: _F64) -> _F64:
    """Where the nodes are [F,N,3], of joints [F,14,3]."""
    points = np.concatenate([joints, mid_hip(joints)[:, None]], axis=1)
    return np.asarray(points[:, [node.place for node in NODES]])


def constant_lengths(joints: _F64) -> _F64:
    """Joints [F,14,3] whose bones have the median length of these, and their directions; mid-hip
    stays."""
    at = places(joints)
    out = np.empty_like(at)
    out[:, 0] = at[:, 0]
    lengths = _lengths(at)
    for i, node in enumerate(NODES[1:], 1):
        bone = at[:, i] - at[:, node.parent]
        direction = unit(bone) if lengths[i] > 0 else bone
        out[:, i] = out[:, node.parent] + lengths[i] * direction
    fitted = np.empty_like(joints)
    for i, node in enumerate(NODES):
        if node.place != _HIPS:
            fitted[:, node.place] = out[:, i]
    return fitted


def _lengths(at: _F64) -> _F64:
    """Median lengths [N] of the bones that lead to nodes; both halves of the hip line are alike."""
    parents = [max(node.parent, 0) for node in NODES]
    each = np.linalg.norm(at - at[:, parents], axis=-1)
    none = np.array([node.place == NODES[p].place for node, p in zip(NODES, parents, strict=True)])
    short = np.flatnonzero((each < _NO_LENGTH).any(0) & ~none)
    if short.size:
        raise ValueError(f"the bone to {NODES[short[0]].name} has no length in some frame")
    return np.asarray(np.median(each, axis=0))


def offsets(joints: _F64) -> _F64:
    """Where the nodes are at rest [N,3], from their parents; joints [F,14,3] are of constant
    length."""
    lengths = _lengths(places(joints))
    return np.stack([length * node.rest for length, node in zip(lengths, NODES, strict=True)])


def rotations(joints: _F64) -> _F64:
    """Rotations of the nodes [F,N,3,3] from rest, in the world; the leaves' are their parents'."""
    at = places(joints)
    turned = np.empty((len(at), len(NODES), 3, 3))
    trunk = at[:, NUMBER["neck_base"]] - at[:, 0]
    hips = at[:, NUMBER["left_hip"]] - at[:, NUMBER["right_hip"]]
    shoulders = at[:, NUMBER["left_shoulder"]] - at[:, NUMBER["right_shoulder"]]
    turned[:, 0] = _frame(_X, hips, _Y, trunk)
    turned[:, 1] = _frame(_Y, trunk, _X, shoulders)
    for i, node in enumerate(NODES[2:], 2):
        ends = [n for n, other in enumerate(NODES) if other.parent == i]
        parent = turned[:, node.parent]
        if not ends:
            turned[:, i] = parent
        elif node.name in _HINGES:
            bent = ends[0]
            (end,) = (n for n, other in enumerate(NODES) if other.parent == bent)
            upper, lower = at[:, bent] - at[:, i], at[:, end] - at[:, bent]
            axis = _bending_axis(parent, NODES[bent].rest, _HINGES[node.name], upper, lower)
            turned[:, i] = _frame(NODES[bent].rest, upper, _HINGES[node.name], axis)
            turned[:, bent] = _frame(NODES[end].rest, lower, _HINGES[node.name], axis)
        elif NODES[node.parent].name not in _HINGES:
            bone = at[:, ends[0]] - at[:, i]
            turned[:, i] = _swing(parent @ NODES[ends[0]].rest, unit(bone)) @ parent
    return turned


def local(turned: _F64) -> _F64:
    """Rotations of nodes [F,N,3,3] from their parents."""
    out = turned.copy()
    for i, node in enumerate(NODES[1:], 1):
        out[:, i] = np.swapaxes(turned[:, node.parent], -1, -2) @ turned[:, i]
    return out


def _bending_axis(parent: _F64, rest: _F64, hinge: _F64, upper: _F64, lower: _F64) -> _F64:
    """The axis [F,3] that an elbow or knee bends about.

    The more it is bent, the more its own bones say; of a straight limb it is the axis that the
    torso's gives when the limb turns away from rest by the shortest way.
    """
    along, behind = unit(upper), unit(lower)
    default = (_swing(parent @ rest, along) @ parent) @ hinge
    cross = np.cross(along, behind)
    axis = cross * np.linalg.norm(cross, axis=-1, keepdims=True) + default * _STRAIGHT**2
    nothing = np.linalg.norm(axis, axis=-1, keepdims=True) < 1e-9
    return np.where(nothing, default, axis)


def _frame(rest: _F64, along: _F64, rest_side: _F64, side: _F64) -> _F64:
    """Rotations [F,3,3] that bring the axis `rest` onto `along`, and the axis `rest_side` as near
    to `side` as that lets it."""
    first = unit(along)
    third = np.cross(first, side)
    lost = np.linalg.norm(third, axis=-1) < 1e-9 * np.linalg.norm(side, axis=-1)
    third = unit(np.where(lost[:, None], _perpendicular(first), third))
    now = np.stack([first, np.cross(third, first), third], axis=-1)
    before = np.stack([rest, rest_side, np.cross(rest, rest_side)], axis=-1)
    return np.asarray(now @ before.T)


def _swing(start: _F64, end: _F64) -> _F64:
    """The smallest rotations [F,3,3] from unit vectors to others."""
    cosine = (start * end).sum(-1)
    axis = np.cross(start, end)
    cross = np.zeros((len(start), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = axis
    cross -= np.swapaxes(cross, -1, -2)
    opposite = cosine < -1 + 1e-9
    scale = 1 / np.where(opposite, 1.0, 1 + cosine)
    out = np.eye(3) + cross + cross @ cross * scale[:, None, None]
    half_turn = _perpendicular(start)
    flipped = 2 * half_turn[:, :, None] * half_turn[:, None] - np.eye(3)
    return np.where(opposite[:, None, None], flipped, out)


def _perpendicular(vectors: _F64) -> _F64:
    """Unit vectors at a right angle to others [F,3]."""
    least = np.eye(3)[np.abs(vectors).argmin(-1)]
    return unit(np.cross(vectors, least))
