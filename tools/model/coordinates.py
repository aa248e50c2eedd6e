"""Networks from 2D joints straight to 3D joints, in JAX: the rivals that are trained.

Layers are (weight, bias) or, where batch normalisation follows, (weight,
bias, gain, shift); every layer but the last ends in a ReLU.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from edmlift.joints import JOINTS
from model import jax_stages

Params = list[tuple[jax.Array, ...]]
Statistics = list[tuple[jax.Array, jax.Array]]  # mean and variance [M] of each normalised layer
OUTPUTS = 3 * len(JOINTS)


def inputs(
    keypoints: jax.Array, mask: bool = False, imputation: jax.Array | None = None
) -> jax.Array:
    """2D joints, normalised as those behind the EDM (section 3.1 of the paper).

    keypoints [B,14,3], pixels and confidence (0: not seen) -> [B,28]: the centre of the seen
    joints' box is the origin, half its height is 1; joints that are not seen are zero, or where
    `imputation` [14,14] expects them (fitting/imputation.py).  With `mask` [B,42]; its last 14 are
    1 for seen joints.
    """
    points, seen = keypoints[..., :2], keypoints[..., 2:] > 0
    low, high = (edge[:, None] for edge in jax_stages.box(keypoints))
    scaled = (points - (low + high) / 2) / ((high - low)[..., 1:] / 2)
    if imputation is None:
        scaled = jnp.where(seen, scaled, 0.0)
    else:
        scaled = jax_stages.impute(scaled, seen[..., 0], imputation)
    flat = scaled.reshape(len(points), -1)
    return jnp.concatenate([flat, seen[..., 0].astype(flat.dtype)], 1) if mask else flat


def init(widths: Sequence[int], mean: np.ndarray, normalised: bool, seed: int) -> Params:
    """He initialisation; the last bias starts at the mean pose [14,3], metres."""
    rng = np.random.default_rng(seed)
    layers = []
    for rows, columns in zip(widths[:-1], widths[1:], strict=True):
        weight, zeros = rng.normal(0, np.sqrt(2 / rows), (rows, columns)), np.zeros(columns)
        layers.append((weight, zeros, zeros + 1, zeros) if normalised else (weight, zeros))
    layers[-1] = (0.1 * layers[-1][0], mean.ravel())
    return [tuple(jnp.asarray(a, jnp.float32) for a in layer) for layer in layers]


def count(params: Params) -> int:
    """Parameters of all layers."""
    return sum(array.size for layer in params for array in layer)


class Pass:
    """One pass through the hidden layers: normalises by `statistics`, or by those of the batch.

    With a key, dropout follows each layer.  `used` are the statistics by which it normalised.
    """

    def __init__(
        self, statistics: Statistics | None, key: jax.Array | None, dropout: float
    ) -> None:
        self._given = iter(statistics) if statistics is not None else None
        self._key, self._dropout = key, dropout
        self.used: Statistics = []

    def layer(
        self, x: jax.Array, weight: jax.Array, bias: jax.Array, *norm: jax.Array
    ) -> jax.Array:
        """One layer with its normalisation, ReLU and dropout."""
        x = x @ weight + bias
        if norm:
            mean, variance = next(self._given) if self._given else (x.mean(0), x.var(0))
            self.used.append((mean, variance))
            gain, shift = norm
            x = (x - mean) * jax.lax.rsqrt(variance + 1e-5) * gain + shift
        x = jax.nn.relu(x)
        if self._key is None or self._dropout == 0.0:
            return x
        self._key, key = jax.random.split(self._key)
        keep = jax.random.bernoulli(key, 1 - self._dropout, x.shape)
        return jnp.where(keep, x / (1 - self._dropout), 0.0)


def forward(
    params: Params,
    x: jax.Array,
    residual: bool = False,
    statistics: Statistics | None = None,
    key: jax.Array | None = None,
    dropout: float = 0.0,
) -> tuple[jax.Array, Statistics]:
    """[B,28] or [B,42] -> centred poses [B,14,3], metres, and the statistics that were used.

    With `residual`, after the first layer each two have a skip around them, as in Martinez et al.,
    "A simple yet effective baseline for 3d human pose estimation" (ICCV 2017).
    """
    first, *rest, (weight, bias) = params
    run = Pass(statistics, key, dropout)
    x = run.layer(x, *first)
    if residual:
        for one, two in zip(rest[::2], rest[1::2], strict=True):
            x = x + run.layer(run.layer(x, *one), *two)
    else:
        for layer in rest:
            x = run.layer(x, *layer)
    points = (x @ weight + bias).reshape(len(x), -1, 3)
    return points - points.mean(1, keepdims=True), run.used


def camera_errors(points: jax.Array, truth: jax.Array) -> jax.Array:
    """Distance of each joint without alignment but of the centres, [B,14], metres."""
    truth = truth - truth.mean(1, keepdims=True)
    return jnp.sqrt(jnp.sum((points - truth) ** 2, -1) + 1e-12)
