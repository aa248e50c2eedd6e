"""FConn that treats left and right alike, in JAX: for training alone.

A pair of joints has a twin, the same with left for right, and so has each hidden unit.  If twins
change places in the input they do in the output, whatever the weights: only the sums of twins
(even) and their differences (odd) are multiplied, each by weights of its own.  So every weight
counts for left and for right, and layers are as wide as those of a network of twice as many:

    91 - 2 x 96 - 2 x 96 - 91, a ReLU behind each; 36,817 parameters

What it reads of a distance d is d^2 / (d + SOFT): a distance has a kink where two joints are at the
same place in the image, as those of a limb that points at the camera, and noise makes it longer.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from edmlift.joints import PAIR_TWINS, SELF_TWINS
from model import fconn

Params = dict[str, jax.Array]  # weight0 [even + odd inputs, units], bias0 [units], weight1 ...
SOFT = 2458 / 4096  # of the person's half height: a whole number in Q12
TWINS = len(PAIR_TWINS)  # 49; the last SELF_TWINS, such as that of the knees, are their own
ODD = TWINS - SELF_TWINS


def init(mean_output: np.ndarray, seed: int, hidden: Sequence[int] = (96, 96)) -> Params:
    """He initialisation; the last bias starts at the mean EDM [91], for a dead ReLU stays dead."""
    rng = np.random.default_rng(seed)
    inputs = (len(mean_output), *(2 * width for width in hidden))
    params = {}
    for layer, (rows, units) in enumerate(zip(inputs, (*hidden, TWINS), strict=True)):
        params[f"weight{layer}"] = rng.normal(0, np.sqrt(1 / rows), (rows, units))
        params[f"bias{layer}"] = np.zeros(units)
    params[f"weight{layer}"] *= 0.1
    params[f"weight{layer}"][hidden[-1] :, ODD:] = 0  # nothing odd about those
    params[f"bias{layer}"] = mean_output[PAIR_TWINS].mean(1)
    return {name: jnp.asarray(value, jnp.float32) for name, value in params.items()}


def soften(edm: np.ndarray | jax.Array) -> np.ndarray | jax.Array:
    """Normalised 2D distances, without their kink at zero; far from it, less by SOFT."""
    return edm**2 / (edm + SOFT)


def even_and_odd(first: jax.Array, second: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Sums and differences of twins, [B,units] each."""
    return first + second, first - second


def predict(params: Params, edm: jax.Array) -> jax.Array:
    """Distances of normalised 2D distances, [B,91] -> [B,91] metres."""
    return forward(params, edm, None, 0.0)[0]


def forward(
    params: Params, edm: jax.Array, key: jax.Array | None, dropout: float
) -> tuple[jax.Array, Params]:
    """The same; and what of the parameters is not trained but observed, which is nothing.  There is
    no dropout, so neither is there a key."""
    if dropout > 0:
        raise ValueError("no dropout in this network")
    soft = soften(edm)
    even, odd = even_and_odd(soft[:, PAIR_TWINS[:, 0]], soft[:, PAIR_TWINS[:, 1]])
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
    distances = jnp.zeros_like(edm).at[:, PAIR_TWINS[:, 0]].set(first)
    return distances.at[:, PAIR_TWINS[:, 1]].set(second), {}


shipped = fconn.shipped  # the arrays of gen/fconn.npz
