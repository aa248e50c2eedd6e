"""The lift of the equivariant networks, in JAX: keypoints to a pose, as lib/lift/lift.h does it.

`direct` reads the joints' coordinates in the image and gives points.  `distances` is the paper's
idea beside it: it reads the 91 distances in the image as well, softened, and gives those in space,
of which classical MDS makes points too.  They are rotated, and if need be reflected, onto the
others, and a mean of the two is the pose.  Both see the image in the body's frame
(jax_stages.body_frame), know which joints were seen, and give each joint a gate: how far to believe
its image.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from edmlift.joints import JOINTS, PAIR_MIRROR, PAIRS
from model import equivariant, jax_stages
from model.constants import LONGEST_2D, MIDDLE_SOFT, MISSING_INPUT, Q12, SOFTENING
from model.jax_stages import Image
from model.layout import FIRST, MIDDLE, PAIR_ROWS, PAIR_SIDES, ROWS, SECOND, SIDES, layout

Params = dict[str, Any]


def inputs(kind: str, image: Image, up: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Even and odd inputs, [B,n] each, within +-8.

    up  [B,3], a unit vector in the camera's axes, or 0 where it is not known
    """
    x, y = image.at[..., 0], image.at[..., 1]
    missing = MISSING_INPUT * (1 - image.seen)
    known = jnp.sum(up**2, 1, keepdims=True)
    turned = jax_stages.turned(up[:, None], image.down)[:, 0]
    even = [_difference(x), _sum(y), _sum(missing), 2 * (turned[:, 1:2] + known), 4 * turned[:, 2:]]
    odd = [_sum(x), _difference(y), _difference(missing), 2 * turned[:, :1]]
    even.append(known)
    if kind == "distances":
        soft = soften(jax_stages.edm_2d(image))
        first, second = soft[:, PAIR_MIRROR[:, 0]], soft[:, PAIR_MIRROR[:, 1]]
        even.insert(0, first + second - 2 * MIDDLE_SOFT)
        odd.insert(0, (first - second)[:, :PAIR_SIDES])
    return jnp.concatenate(even, 1), jnp.concatenate(odd, 1)


def soften(edm: jax.Array) -> jax.Array:
    """2D distances without their kink at zero, which noise makes longer: d^2 / (d + softening)."""
    edm = jnp.minimum(edm, LONGEST_2D)
    return edm**2 / (edm + SOFTENING / Q12)


def _sum(values: jax.Array) -> jax.Array:
    return values[:, FIRST] + values[:, SECOND]


def _difference(values: jax.Array) -> jax.Array:
    return values[:, FIRST[MIDDLE:]] - values[:, SECOND[MIDDLE:]]


class Output(NamedTuple):
    """What a network gives, in the body's frame."""

    points: jax.Array  # [B,14,3] metres, about their mean
    gates: jax.Array  # [B,14]
    distances: jax.Array | None  # [B,91] metres; None: not this kind


def run(kind: str, params: Params, image: Image, up: jax.Array) -> Output:
    """The network."""
    first, second = equivariant.forward(params, layout(kind), *inputs(kind, image, up))

    def joints(part: int, sign: int = 1) -> jax.Array:
        """[B,14] of a part of ROWS rows, the last one being part 0."""
        end = first.shape[1] - part * ROWS
        rows = slice(end - ROWS, end)
        values = jnp.zeros((len(first), len(JOINTS))).at[:, FIRST].set(first[:, rows])
        sides = slice(end - SIDES, end)
        return values.at[:, SECOND[MIDDLE:]].set(sign * second[:, sides])

    points, distances = jnp.stack([joints(3, -1), joints(2), joints(1)], -1), None
    if kind == "distances":
        distances = jnp.zeros((len(first), len(PAIRS[0])))
        distances = distances.at[:, PAIR_MIRROR[:, 0]].set(jax.nn.relu(first[:, :PAIR_ROWS]))
        distances = distances.at[:, PAIR_MIRROR[:, 1]].set(jax.nn.relu(second[:, :PAIR_ROWS]))
    return Output(points - points.mean(1, keepdims=True), joints(0), distances)


def poses(params: Params, image: Image, output: Output) -> jax.Array:
    """Poses [B,14,3] in camera axes, about the mean of the seen joints."""
    points = output.points
    if output.distances is not None:
        aligned = jax_stages.align(jax_stages.classical_mds(output.distances), points)
        points = points + jax.nn.sigmoid(params["mds_share"]) * (aligned - points)
    shares = jax_stages.gate_shares(output.gates)
    points = jax_stages.fuse(points, image, shares, params["fusion"])
    return jax_stages.turned_back(points, image.down)


def init(
    kind: str, hidden: tuple[int, ...], joints: np.ndarray, inputs: np.ndarray, seed: int
) -> Params:
    """Parameters to start from, of training people [F,14,3] in metres and inputs() [F,n] of views
    of them."""
    middle = joints - joints.mean(1, keepdims=True)
    height = -(middle[:, FIRST] + middle[:, SECOND])[..., 1].mean(0) / 2  # y is down
    # Of the gates: most of the image is believed.
    bias = np.concatenate([np.zeros(ROWS), height, np.zeros(ROWS), np.full(ROWS, 0.1)])
    if kind == "distances":
        mean = np.linalg.norm(joints[:, PAIRS[0]] - joints[:, PAIRS[1]], axis=-1).mean(0)
        bias = np.concatenate([mean[PAIR_MIRROR].mean(1), bias])
    params = equivariant.init(layout(kind), hidden, bias, inputs, seed)
    params |= {"fusion": jax_stages.FUSION}
    return params | ({"mds_share": jnp.zeros(())} if kind == "distances" else {})
