"""The differentiable half of the pipeline, in JAX: keypoints -> EDM, and EDM -> pose.

The networks between them are equivariant.py, fconn.py and fconv.py.  Only training uses these
stages; figures and poses that a table reports come from the C library.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from edmlift.joints import JOINTS, PAIRS, indices
from model.constants import FARTHEST, GATE_SOFTNESS, LIGHT_RIDGE, MIN_RIDGE, WIDEST
from model.manifest import NEAREST

COUNT = len(JOINTS)
MAX_MISFIT = 1.0  # metres: nothing differs by so much; gates alone decide then
HIPS = jnp.array(indices(("right_hip", "left_hip")))
UPPER = jnp.array(indices(("head", "neck_base", "right_shoulder", "left_shoulder")))
TINY = 1e-9


class Image(NamedTuple):
    """Joints in the body's frame: the image about the body, its axis upright (body_frame())."""

    at: jax.Array  # [B,14,2]; imputed where they were not seen
    seen: jax.Array  # [B,14], 0 or 1
    down: jax.Array  # [B,2]: the body's axis in the image, a unit vector from the neck to the hips


def box(keypoints: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Least and largest x and y of the joints that are seen: [B,14,3] -> [B,2] each."""
    return extent(keypoints[..., :2], keypoints[..., 2] > 0)


def extent(points: jax.Array, seen: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Least and largest coordinates [B,2] of the points [B,14,2] that are seen [B,14]."""
    counts = seen[..., None] > 0
    low = jnp.min(jnp.where(counts, points, jnp.inf), 1)
    return low, jnp.max(jnp.where(counts, points, -jnp.inf), 1)


def body_frame(
    keypoints: jax.Array, imputation: jax.Array | None = None, upright: bool = False
) -> Image:
    """The image in the body's frame: [B,14,3], pixels and confidence (0: not seen) -> Image.

    The body's axis goes from the middle of head, neck and shoulders to that of the hips.  Half the
    extent of the seen joints along it is 1, unless they are WIDEST times as far from the mean
    across it.  Joints that are not seen are where `imputation` [14,14] expects them
    (fitting/imputation.py); without one they are at 0, and the axis is the image's own, as in
    section 3.1 of the paper.  With `upright` it is the image's own in any case, as for rivals.
    """
    seen = keypoints[..., 2] > 0
    low, high = box(keypoints)
    half = jnp.max(high - low, 1)[:, None, None] / 2
    points = (keypoints[..., :2] - ((low + high) / 2)[:, None]) / half
    down = jnp.tile(jnp.array([0.0, 1.0]), (len(points), 1))
    if imputation is not None:
        points = jnp.clip(impute(points, seen, imputation), -FARTHEST, FARTHEST)
    if imputation is not None and not upright:
        down = points[:, HIPS].mean(1) - points[:, UPPER].mean(1)
        down = down / jnp.sqrt(jnp.sum(down**2, 1, keepdims=True) + TINY)
    points = turned(points, down)
    counts = seen.astype(points.dtype) if imputation is None else jnp.ones(seen.shape)
    low, high = extent(points, seen)
    across = about_mean(points[..., :1], counts[..., None])
    along = points[..., 1:] - ((low + high) / 2)[:, None, 1:]
    wide = jnp.max(jnp.abs(across) * seen[..., None], (1, 2))
    half = jnp.maximum((high - low)[:, 1] / 2, wide / WIDEST)[:, None, None]
    at = jnp.clip(jnp.concatenate([across, along], -1) / half, -FARTHEST, FARTHEST)
    known = seen[..., None] | (imputation is not None)
    return Image(jnp.where(known, at, 0.0), seen.astype(points.dtype), down)


def turned(points: jax.Array, down: jax.Array) -> jax.Array:
    """Points [B,14,2 or 3] turned in the image so that the direction `down` [B,2] points down."""
    x, y = points[..., 0], points[..., 1]
    sine, cosine = down[:, :1], down[:, 1:]
    flat = jnp.stack([cosine * x - sine * y, sine * x + cosine * y], -1)
    return jnp.concatenate([flat, points[..., 2:]], -1)


def turned_back(points: jax.Array, down: jax.Array) -> jax.Array:
    """The inverse of turned()."""
    return turned(points, down * jnp.array([-1.0, 1.0]))


def edm_2d(image: Image, imputed: bool = True) -> jax.Array:
    """Distances between the joints in the body's frame, [B,91].  Where joints are not imputed,
    pairs with a joint that is not seen are zero."""
    delta = image.at[:, PAIRS[0]] - image.at[:, PAIRS[1]]
    distance = jnp.sqrt(jnp.sum(delta**2, -1) + TINY)
    if imputed:
        return distance
    return distance * image.seen[:, PAIRS[0]] * image.seen[:, PAIRS[1]]


def impute(points: jax.Array, seen: jax.Array, imputation: jax.Array) -> jax.Array:
    """The impute stage: points [B,14,2] of which `seen` [B,14] count -> all of them."""
    known = jnp.where(seen[..., None], points, 0)
    system = jnp.where(seen[..., None], 0, imputation)
    among = jnp.eye(COUNT) - system * ~seen[:, None, :]
    return jnp.linalg.solve(among, known + system @ known)


def edm_3d(points: jax.Array) -> jax.Array:
    """Distances between the joints: [B,14,3] -> [B,91] (eq. 1)."""
    return jnp.linalg.norm(points[:, PAIRS[0]] - points[:, PAIRS[1]], axis=-1)


@jax.custom_vjp
def top_three(gram: jax.Array) -> jax.Array:
    """Points of a Gram matrix: [B,14,14] -> [B,14,3] = V3 sqrt(w3), negative w clamped."""
    return _top_three_forward(gram)[0]


def _top_three_forward(gram: jax.Array) -> tuple[jax.Array, tuple[jax.Array, ...]]:
    values, vectors = jnp.linalg.eigh(gram, symmetrize_input=False)
    root = jnp.sqrt(jnp.maximum(values[:, -3:], 1e-9))
    return vectors[:, :, -3:] * root[:, None, :], (values, vectors, root)


def _top_three_backward(
    saved: tuple[jax.Array, ...], gradient: jax.Array
) -> tuple[jax.Array]:
    """Eigenvectors rotate by 1/(w_j - w_i): regularised as d / (d^2 + eps), or near-equal
    eigenvalues would throw the gradient to infinity."""
    values, vectors, root = saved
    inner = jnp.einsum("bni,bnj->bij", vectors, gradient)  # V' G, [B,14,3]
    gap = values[:, None, -3:] - values[:, :, None]
    factor = gap / (gap**2 + 1e-6)
    own = jax.nn.one_hot(jnp.arange(COUNT - 3, COUNT), COUNT, axis=0)
    middle = factor * inner * root[:, None, :] + own * inner / (2 * root[:, None, :])
    out = jnp.einsum("bni,bij,bmj->bnm", vectors, middle, vectors[:, :, -3:])
    return ((out + out.transpose(0, 2, 1)) / 2,)


top_three.defvjp(_top_three_forward, _top_three_backward)


def classical_mds(distances: jax.Array) -> jax.Array:
    """Classical multidimensional scaling: [B,91] -> centred points [B,14,3]."""
    squared = jnp.zeros((len(distances), COUNT, COUNT)).at[:, PAIRS[0], PAIRS[1]].set(distances**2)
    squared = squared + squared.transpose(0, 2, 1)
    row = squared.mean(1, keepdims=True)
    gram = -0.5 * (squared - row - row.transpose(0, 2, 1) + row.mean(2, keepdims=True))
    return top_three(gram)


def about_mean(points: jax.Array, seen: jax.Array) -> jax.Array:
    """[B,14,n] less the mean of the joints that are seen, [B,14,1]."""
    return points - jnp.sum(points * seen, 1, keepdims=True) / jnp.sum(seen, 1, keepdims=True)


def nearest_axes(rows: jax.Array) -> jax.Array:
    """The orthonormal pair nearest to two rows, in closed form: [B,2,3] -> [B,2,3]."""
    rows = rows / jnp.sqrt(jnp.sum(rows**2, (1, 2), keepdims=True) + TINY)
    products = jnp.einsum("bki,bli->bkl", rows, rows)
    a, b, c = products[:, 0, 0, None], products[:, 0, 1, None], products[:, 1, 1, None]
    root = jnp.sqrt(jnp.maximum(a * c - b * b, TINY))
    pair = jnp.stack(
        [(c + root) * rows[:, 0] - b * rows[:, 1], (a + root) * rows[:, 1] - b * rows[:, 0]], 1
    )
    return pair / jnp.sqrt(jnp.sum(pair**2, 2, keepdims=True) + TINY)


def orient(points: jax.Array, image: Image) -> jax.Array:
    """The orient stage: [B,14,3] in the axes of the body's frame, about the mean of the seen
    joints."""
    seen = image.seen[..., None]
    points = about_mean(points, seen)
    flat = about_mean(image.at, seen) * seen
    squares = jnp.einsum("bni,bnj->bij", points * seen, points)
    spread = jnp.trace(squares, axis1=1, axis2=2)[:, None, None]
    squares = squares / spread
    size = jnp.sqrt(spread * jnp.sum(flat**2, (1, 2), keepdims=True))
    products = jnp.einsum("bni,bnk->bik", points, flat) / size

    def rows(ridge: float | jax.Array) -> jax.Array:
        solution = jnp.linalg.solve(squares + ridge * jnp.eye(3), products)
        return nearest_axes(solution.transpose(0, 2, 1))

    pair = rows(LIGHT_RIDGE)
    across = jnp.einsum("bki,bij,bkj->b", pair, squares, pair)
    fit = jnp.einsum("bki,bik->b", pair, products)
    misfit = across * (across - fit**2) / jnp.maximum(fit**2, TINY)
    misfit = jnp.where(fit > 0, jnp.clip(misfit, 0, 1), 1.0)
    right, down = (rows(MIN_RIDGE + misfit[:, None, None])[:, k] for k in range(2))
    axes = jnp.stack([right, down, jnp.cross(right, down)], 1)
    return jnp.einsum("bki,bni->bnk", axes, points)


def align(points: jax.Array, onto: jax.Array) -> jax.Array:
    """The align stage: centred points [B,14,3] rotated, or rotated and reflected, onto others.

    The rotation is held constant under the gradient.
    """
    products = jnp.einsum("bni,bnj->bij", points, onto)
    u, _, vt = jnp.linalg.svd(jax.lax.stop_gradient(products))
    return jnp.einsum("bni,bij->bnj", points, u @ vt)


# What fuse() takes, as it is trained: [log of the misfit, log of the distance].
FUSION = jnp.array([-2.7, 1.5])


def fusion_settings(trained: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Misfit and distance (metres) of the trained numbers."""
    misfit = jnp.minimum(jnp.exp(trained[0]), MAX_MISFIT)
    return misfit, jnp.maximum(jnp.exp(trained[1]), NEAREST)


def gate_shares(gates: jax.Array) -> jax.Array:
    """Shares of the image, 0 to 1, of a network's gates."""
    return (1 + gates / (jnp.abs(gates) + GATE_SOFTNESS)) / 2


def fuse(points: jax.Array, image: Image, shares: jax.Array, trained: jax.Array) -> jax.Array:
    """The fuse stage: [B,14,3] in the body's frame, the seen joints moved to where the image has
    them, each by its share [B,14]; mean of the seen at 0."""
    misfit, distance = fusion_settings(trained)
    seen = image.seen[..., None]
    points = about_mean(points, seen)
    near = about_mean(image.at * (1 + points[..., 2:] / distance), seen) * seen
    flat = points[..., :2] * seen
    scale = jnp.sum(flat * near, (1, 2), keepdims=True) / jnp.sum(near**2, (1, 2), keepdims=True)
    off = scale * near - flat
    square = jnp.sum(off**2, (1, 2), keepdims=True) / jnp.sum(seen, 1, keepdims=True)
    part = shares[..., None] * misfit**2 / (misfit**2 + square)
    return points.at[..., :2].add(part * off)


def true_mirror(points: jax.Array, truth: jax.Array) -> jax.Array:
    """Points [B,14,3] or their reflection in depth, whichever is nearer to the truth [B,14,3]."""
    depth = truth[..., 2] - truth[..., 2].mean(1, keepdims=True)
    behind = jnp.sum(points[..., 2] * depth, 1) < 0
    return points.at[..., 2].multiply(jnp.where(behind, -1.0, 1.0)[:, None])


def camera_errors(points: jax.Array, truth: jax.Array) -> jax.Array:
    """Distance of each joint as poses() has it, only moved onto the mean, [B,14], metres."""
    difference = points - points.mean(1, keepdims=True) - truth + truth.mean(1, keepdims=True)
    return jnp.sqrt(jnp.sum(difference**2, -1) + TINY)


def joint_errors(points: jax.Array, truth: jax.Array, mirror: bool = True) -> jax.Array:
    """Distance of each joint after rigid alignment without scale, [B,14], metres.

    With `mirror`, the better of the pose and its reflection.  The alignment itself is held
    constant under the gradient.
    """
    points = points - points.mean(1, keepdims=True)
    truth = truth - truth.mean(1, keepdims=True)
    u, _, vt = jnp.linalg.svd(jax.lax.stop_gradient(jnp.einsum("bni,bnj->bij", points, truth)))
    if not mirror:
        flip = jnp.sign(jnp.linalg.det(u) * jnp.linalg.det(vt))
        u = u.at[:, :, 2].multiply(flip[:, None])
    aligned = jnp.einsum("bni,bij->bnj", points, u @ vt)
    return jnp.sqrt(jnp.sum((aligned - truth) ** 2, -1) + 1e-12)
