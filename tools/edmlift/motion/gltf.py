"""glTF in its binary form (.glb): an animated skeleton with a simple figure, by pygltflib."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edmlift._version import __version__
from edmlift.drawing.palette import SIDES, rgb
from edmlift.joints import mid_hip
from edmlift.motion.bones import LEAVES, NODES, local, offsets, rotations
from edmlift.motion.clip import Clip
from edmlift.motion.held import held
from edmlift.packages import need

_F64 = NDArray[np.float64]
_FLOAT, _BYTE = 5126, 5121  # component types
_ARRAY_BUFFER = 34962
_ANKLE = 0.07  # metres above the floor, of the figure at rest
# Of the length of the bone to a node: half its width, and from where it is as wide.
_SHAPES = {"head": (0.34, 0.55), "neck_base": (0.2, 0.75)}
_SHAPE = (0.14, 0.2)


@dataclass
class _Buffer:
    """The binary part of a file, and the accessors into it."""

    package: Any  # pygltflib
    data: bytearray = field(default_factory=bytearray)
    views: list[Any] = field(default_factory=list)
    accessors: list[Any] = field(default_factory=list)

    def add(
        self, values: NDArray[Any], kind: str, target: int | None = None, *, bounds: bool = False
    ) -> int:
        """The number of a new accessor; bounds: with its minimum and maximum."""
        component = _BYTE if values.dtype == np.uint8 else _FLOAT
        flat = values.reshape(len(values), -1)
        self.views.append(
            self.package.BufferView(
                buffer=0, byteOffset=len(self.data), byteLength=values.nbytes, target=target
            )
        )
        self.accessors.append(
            self.package.Accessor(
                bufferView=len(self.views) - 1, componentType=component, count=len(values),
                type=kind, min=flat.min(0).tolist() if bounds else None,
                max=flat.max(0).tolist() if bounds else None,
            )
        )  # fmt: skip
        self.data += np.ascontiguousarray(values).tobytes()  # a multiple of 4 bytes
        return len(self.accessors) - 1


def write_glb(path: Path, clip: Clip) -> None:
    """Metres and quaternions; the asset faces z, as glTF has it."""
    gltf = need("pygltflib", "a .glb file")
    clip = held(path, clip)
    rest = offsets(clip.joints)
    at = np.zeros((len(NODES), 3))
    for i, node in enumerate(NODES[1:], 1):
        at[i] = at[node.parent] + rest[i]
    rest[0] = [0.0, _ANKLE - at[:, 1].min(), 0.0]
    at += rest[0]

    buffer = _Buffer(gltf)
    nodes = [
        gltf.Node(
            name=node.name, translation=rest[i].tolist(),
            children=[n for n, other in enumerate(NODES) if other.parent == i],
        )
        for i, node in enumerate(NODES)
    ]  # fmt: skip
    nodes.append(gltf.Node(name="figure", mesh=0, skin=0))
    inverse = np.tile(np.eye(4, dtype=np.float32), (len(NODES), 1, 1))
    inverse[:, 3, :3] = -at  # in columns
    skin = gltf.Skin(
        inverseBindMatrices=buffer.add(inverse, "MAT4"), skeleton=0, joints=list(range(len(NODES)))
    )
    primitives, materials = _figure(gltf, buffer, at)
    model = gltf.GLTF2(
        asset=gltf.Asset(version="2.0", generator=f"edmlift {__version__}"),
        scene=0,
        scenes=[gltf.Scene(nodes=[0, len(NODES)])],
        nodes=nodes,
        meshes=[gltf.Mesh(name="figure", primitives=primitives)],
        materials=materials,
        skins=[skin],
        animations=[_animation(gltf, buffer, clip, path.stem)],
        accessors=buffer.accessors,
        bufferViews=buffer.views,
        buffers=[gltf.Buffer(byteLength=len(buffer.data))],
    )
    model.set_binary_blob(bytes(buffer.data))
    model.save_binary(str(path))


def _animation(gltf: Any, buffer: _Buffer, clip: Clip, name: str) -> Any:
    """Where the root is, and how nodes are rotated, in each frame."""
    times = buffer.add(clip.times.astype(np.float32), "SCALAR", bounds=True)
    path = buffer.add(mid_hip(clip.joints).astype(np.float32), "VEC3")
    samplers = [gltf.AnimationSampler(input=times, output=path, interpolation="LINEAR")]
    channels = [_channel(gltf, 0, 0, "translation")]
    turned = local(rotations(clip.joints))
    for i in range(len(NODES)):
        if i in LEAVES:
            continue
        values = buffer.add(_quaternions(turned[:, i]).astype(np.float32), "VEC4")
        channels.append(_channel(gltf, len(samplers), i, "rotation"))
        samplers.append(gltf.AnimationSampler(input=times, output=values, interpolation="LINEAR"))
    return gltf.Animation(name=name, samplers=samplers, channels=channels)


def _channel(gltf: Any, sampler: int, node: int, path: str) -> Any:
    target = gltf.AnimationChannelTarget(node=node, path=path)
    return gltf.AnimationChannel(sampler=sampler, target=target)


def _quaternions(turned: _F64) -> _F64:
    """x, y, z, w [F,4] of rotations [F,3,3]; of the two of each, the one nearer to the last."""
    m = turned
    trace = np.trace(m, axis1=-2, axis2=-1)
    # Row n is the quaternion times 4 times its component n: the longest is the most exact.
    rows = np.empty((len(m), 4, 4))
    rows[:, 3, 3] = 1 + trace
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        rows[:, i, i] = 1 - trace + 2 * m[:, i, i]
        rows[:, i, j] = rows[:, j, i] = m[:, i, j] + m[:, j, i]
        rows[:, i, 3] = rows[:, 3, i] = m[:, k, j] - m[:, j, k]
    longest = np.diagonal(rows, axis1=-2, axis2=-1).argmax(-1)
    out = np.take_along_axis(rows, longest[:, None, None], 1)[:, 0]
    out /= np.linalg.norm(out, axis=-1, keepdims=True)
    same = np.where((out[1:] * out[:-1]).sum(-1) < 0, -1.0, 1.0)
    out[1:] *= np.cumprod(same)[:, None]
    return out


# ---- The figure: a double pyramid a bone, that moves with it -----------------------------------


def _figure(gltf: Any, buffer: _Buffer, at: _F64) -> tuple[list[Any], list[Any]]:
    """Primitives and materials, each of the subject's right, left and trunk; at [N,3] is rest."""
    primitives: list[Any] = []
    materials: list[Any] = []
    for side, colour in SIDES.items():
        points, owners = [], []
        for i, node in enumerate(NODES):
            if node.parent < 0 or _side(node.name) != side:
                continue
            if np.linalg.norm(at[i] - at[node.parent]) > 0 and not node.name.endswith("clavicle"):
                points.append(_bone(at[node.parent], at[i], *_SHAPES.get(node.name, _SHAPE)))
                owners += [node.parent] * len(points[-1])
        corners = np.concatenate(points)
        joints = np.zeros((len(corners), 4), np.uint8)
        joints[:, 0] = owners
        weights = np.zeros((len(corners), 4), np.float32)
        weights[:, 0] = 1
        attributes = gltf.Attributes(
            POSITION=buffer.add(
                corners.astype(np.float32), "VEC3", _ARRAY_BUFFER, bounds=True
            ),
            NORMAL=buffer.add(_normals(corners).astype(np.float32), "VEC3", _ARRAY_BUFFER),
            JOINTS_0=buffer.add(joints, "VEC4", _ARRAY_BUFFER),
            WEIGHTS_0=buffer.add(weights, "VEC4", _ARRAY_BUFFER),
        )  # fmt: skip
        primitives.append(gltf.Primitive(attributes=attributes, material=len(materials)))
        linear = [(value / 255) ** 2.2 for value in rgb(colour)]
        surface = gltf.PbrMetallicRoughness(
            baseColorFactor=[*linear, 1.0], metallicFactor=0.0, roughnessFactor=0.8
        )
        materials.append(gltf.Material(name=side, pbrMetallicRoughness=surface, alphaCutoff=None))
    return primitives, materials


def _side(name: str) -> str:
    side = name.partition("_")[0]
    return side if side in ("right", "left") else "trunk"


def _bone(start: _F64, end: _F64, thick: float, widest: float) -> _F64:
    """Corners [24,3] of the 8 triangles of a bone, counterclockwise from outside."""
    along = end - start
    length = float(np.linalg.norm(along))
    least = np.eye(3)[np.abs(along).argmin()]
    side = np.cross(along / length, least)
    side *= thick * length / np.linalg.norm(side)
    other = np.cross(along / length, side)
    middle = start + widest * along
    ring = [middle + side, middle + other, middle - side, middle - other]
    corners = []
    for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
        corners += [start, b, a, end, a, b]
    return np.array(corners)


def _normals(corners: _F64) -> _F64:
    """A normal a corner [n,3], of triangles."""
    a, b, c = corners.reshape(-1, 3, 3).transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.asarray(np.repeat(normal, 3, axis=0))
