"""The differentiable half of the pipeline, in JAX: keypoints -> EDM, and EDM -> points.

The networks between them are fconn.py and fconv.py.

Only training uses it; figures and poses that a table reports come from the C library.
"""

import jax
import jax.numpy as jnp

from skeleton import JOINTS, PAIRS

COUNT = len(JOINTS)


def edm_2d(keypoints: jax.Array) -> jax.Array:
    """Normalised 2D distances of a batch (section 3.1 of the paper).

    keypoints [B,14,3], pixels and confidence (0: not seen) -> [B,91].  One factor for x and y:
    half the vertical extent of the seen joints.  Pairs with a joint that is not seen are zero.
    """
    seen = keypoints[..., 2] > 0
    y = keypoints[..., 1]
    top = jnp.min(jnp.where(seen, y, jnp.inf), 1)
    bottom = jnp.max(jnp.where(seen, y, -jnp.inf), 1)
    delta = keypoints[:, PAIRS[0], :2] - keypoints[:, PAIRS[1], :2]
    distance = jnp.sqrt(jnp.sum(delta**2, -1)) / ((bottom - top) / 2)[:, None]
    return jnp.where(seen[:, PAIRS[0]] & seen[:, PAIRS[1]], distance, 0.0)


def edm_3d(points: jax.Array) -> jax.Array:
    """Distances between the joints: [B,14,3] -> [B,91] (eq. 1)."""
    return jnp.linalg.norm(points[:, PAIRS[0]] - points[:, PAIRS[1]], axis=-1)


@jax.custom_vjp
def top_three(gram: jax.Array) -> jax.Array:
    """Points of a Gram matrix: [B,14,14] -> [B,14,3] = V3 sqrt(w3), negative w clamped."""
    return _top_three_forward(gram)[0]


def _top_three_forward(gram):
    values, vectors = jnp.linalg.eigh(gram, symmetrize_input=False)
    root = jnp.sqrt(jnp.maximum(values[:, -3:], 1e-9))
    return vectors[:, :, -3:] * root[:, None, :], (values, vectors, root)


def _top_three_backward(saved, gradient):
    """Eigenvectors turn by 1/(w_j - w_i): regularised as d / (d^2 + eps), or near-equal
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
