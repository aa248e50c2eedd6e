"""FConn that treats left and right alike, in JAX, to be trained: an equivariant network.

A pair of joints has a mirror pair, the same with left for right, and so has each hidden unit.  If
mirror pairs change places in the input they do in the output, whatever the weights: only the sums
of the two (even) and their differences (odd) are multiplied, each by weights of its own.  So every
weight counts for left and for right, and layers are as wide as those of a network of twice as many:

    91 - 2 x 96 - 2 x 96 - 91, a ReLU behind each; 36,817 parameters

What it reads of a distance d is d^2 / (d + softening).  A distance has a kink where two joints are
at the same place in the image, as those of a limb that points at the camera, and noise makes such
a distance longer.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from edmlift.joints import PAIR_MIRROR, SELF_MIRRORED
from model import fconn
from model.constants import Q12, SOFTENING

Params = dict[str, jax.Array]  # weight0 [even + odd inputs, units], bias0 [units], weight1 ...
MIRROR_PAIRS = len(PAIR_MIRROR)  # 49; the last 7, such as that of the knees, are their own
ODD = MIRROR_PAIRS - SELF_MIRRORED


def init(mean_output: np.ndarray, seed: int, hidden: Sequence[int] = (96, 96)) -> Params:
    """He initialisation; the last bias starts at the mean EDM [91], because a dead ReLU stays
    dead."""
    rng = np.random.default_rng(seed)
    inputs = (len(mean_output), *(2 * width for width in hidden))
    params = {}
    for layer, (rows, units) in enumerate(zip(inputs, (*hidden, MIRROR_PAIRS), strict=True)):
        params[f"weight{layer}"] = rng.normal(0, np.sqrt(1 / rows), (rows, units))
        params[f"bias{layer}"] = np.zeros(units)
    params[f"weight{layer}"] *= 0.1
    params[f"weight{layer}"][hidden[-1] :, ODD:] = 0  # a pair that is its own has nothing odd
    params[f"bias{layer}"] = mean_output[PAIR_MIRROR].mean(1)
    return {name: jnp.asarray(value, jnp.float32) for name, value in params.items()}


def soften(edm: np.ndarray | jax.Array) -> np.ndarray | jax.Array:
    """Normalised 2D distances without their kink at zero; far from it, less by the softening."""
    return edm**2 / (edm + SOFTENING / Q12)


def even_and_odd(first: jax.Array, second: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Sums and differences of mirror pairs, [B,units] each."""
    return first + second, first - second


def predict(params: Params, edm: jax.Array) -> jax.Array:
    """Distances of normalised 2D distances, [B,91] -> [B,91] metres."""
    return forward(params, edm, None, 0.0)[0]


def forward(
    params: Params, edm: jax.Array, key: jax.Array | None, dropout: float
) -> tuple[jax.Array, Params]:
    """The same, and the parameters that are observed instead of trained: none.  There is no
    dropout, so the key is not used."""
    if dropout > 0:
        raise ValueError("no dropout in this network")
    soft = soften(edm)
    even, odd = even_and_odd(soft[:, PAIR_MIRROR[:, 0]], soft[:, PAIR_MIRROR[:, 1]])
    odd = odd[:, :ODD]
    layers = sum(name.startswith("weight") for name in params)
    for layer in range(layers):
        weight = params[f"weight{layer}"]
        alike = even @ weight[: even.shape[1]] + params[f"bias{layer}"]
        unlike = odd @ weight[even.shape[1] :]
        if layer == layers - 1:
            unlike = unlike.at[:, ODD:].set(0)
        first, second = jax.nn.relu(alike + unlike), jax.nn.relu(alike - unlike)
        even, odd = even_and_odd(first, second)
    distances = jnp.zeros_like(edm).at[:, PAIR_MIRROR[:, 0]].set(first)
    return distances.at[:, PAIR_MIRROR[:, 1]].set(second), {}


to_arrays = fconn.to_arrays  # the arrays of gen/fconn.npz
