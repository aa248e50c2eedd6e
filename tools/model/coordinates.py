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
INPUTS = OUTPUTS = 3 * len(JOINTS)


def inputs(image: jax_stages.Image) -> jax.Array:
    """What the networks read of an image, upright: coordinates, and 1 for joints that are seen:
    [B,42]."""
    return jnp.concatenate([image.at.reshape(len(image.at), -1), image.seen], 1)


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
    """[B,42] -> centred poses [B,14,3], metres, and the statistics that were used.

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
