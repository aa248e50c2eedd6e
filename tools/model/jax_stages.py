"""The differentiable half of the pipeline, in JAX: keypoints -> EDM, and EDM -> pose.

The networks between them are equivariant.py, fconn.py and fconv.py.  Only training uses these
stages; figures and poses that a table reports come from the C library.
"""

import jax
import jax.numpy as jnp

from edmlift.joints import JOINTS, PAIRS
from model.constants import LIGHT_RIDGE, MIN_RIDGE

COUNT = len(JOINTS)
TINY = 1e-9


def box(keypoints: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Least and largest x and y of the joints that are seen: [B,14,3] -> [B,2] each."""
    seen, points = keypoints[..., 2:] > 0, keypoints[..., :2]
    low = jnp.min(jnp.where(seen, points, jnp.inf), 1)
    return low, jnp.max(jnp.where(seen, points, -jnp.inf), 1)


def edm_2d(keypoints: jax.Array, imputation: jax.Array | None = None) -> jax.Array:
    """Normalised 2D distances of a batch (section 3.1 of the paper).

    keypoints [B,14,3], pixels and confidence (0: not seen) -> [B,91].  One factor for x and y:
    half the vertical extent of the seen joints.  Joints that are not seen are where `imputation`
    [14,14] expects them (fitting/imputation.py); without one, pairs with such a joint are zero.
    """
    seen = keypoints[..., 2] > 0
    low, high = box(keypoints)
    points = keypoints[..., :2]
    if imputation is not None:
        points = impute(points, seen, imputation)
    delta = points[:, PAIRS[0]] - points[:, PAIRS[1]]
    distance = jnp.sqrt(jnp.sum(delta**2, -1)) / ((high - low)[:, 1:] / 2)
    if imputation is not None:
        return distance
    return jnp.where(seen[:, PAIRS[0]] & seen[:, PAIRS[1]], distance, 0.0)


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


def orient(points: jax.Array, keypoints: jax.Array) -> jax.Array:
    """The orient stage: [B,14,3] in the axes of the camera of keypoints [B,14,3], about the mean of
    the seen joints."""
    seen = (keypoints[..., 2:] > 0).astype(points.dtype)
    points = about_mean(points, seen)
    image = about_mean(keypoints[..., :2], seen) * seen
    squares = jnp.einsum("bni,bnj->bij", points * seen, points)
    spread = jnp.trace(squares, axis1=1, axis2=2)[:, None, None]
    squares = squares / spread
    size = jnp.sqrt(spread * jnp.sum(image**2, (1, 2), keepdims=True))
    products = jnp.einsum("bni,bnk->bik", points, image) / size

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


# What fuse() takes, as it is trained: [log-odds of the weight, log of the misfit, log of the
# distance].
FUSION = jnp.array([1.4, -2.7, 1.5])


def fusion_settings(trained: jax.Array) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Weight (0 to 1), misfit (metres) and distance (metres) of the trained numbers."""
    return jax.nn.sigmoid(trained[0]), jnp.exp(trained[1]), jnp.exp(trained[2])


def fuse(points: jax.Array, keypoints: jax.Array, trained: jax.Array) -> jax.Array:
    """The fuse stage: [B,14,3] in camera axes, the seen joints moved to where the image of
    keypoints [B,14,3] has them; mean of the seen at 0."""
    weight, misfit, distance = fusion_settings(trained)
    middle = sum(box(keypoints))[:, None] / 2
    seen = (keypoints[..., 2:] > 0).astype(points.dtype)
    points = about_mean(points, seen)
    image = (keypoints[..., :2] - middle) * (1 + points[..., 2:] / distance)
    image = about_mean(image, seen) * seen
    flat = points[..., :2] * seen
    scale = jnp.sum(flat * image, (1, 2), keepdims=True) / jnp.sum(image**2, (1, 2), keepdims=True)
    off = scale * image - flat
    square = jnp.sum(off**2, (1, 2), keepdims=True) / jnp.sum(seen, 1, keepdims=True)
    part = weight * misfit**2 / (misfit**2 + square)
    return points.at[..., :2].add(part * off)


def poses(
    distances: jax.Array, keypoints: jax.Array, truth: jax.Array, trained: jax.Array
) -> jax.Array:
    """The pipeline behind the network, with the true mirror image: distances [B,91], keypoints
    and truth [B,14,3] -> [B,14,3] in camera axes, about the mean of the seen joints."""
    points = orient(classical_mds(distances), keypoints)
    depth = truth[..., 2] - truth[..., 2].mean(1, keepdims=True)
    behind = jnp.sum(points[..., 2] * depth, 1) < 0
    points = points.at[..., 2].multiply(jnp.where(behind, -1.0, 1.0)[:, None])
    return fuse(points, keypoints, trained)


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
