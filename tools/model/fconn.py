"""FConn, the paper's first network (section 3.2), in JAX, to be trained.

Fully connected layers, a ReLU behind each: 91-128-128-91, 40,027 parameters.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

Params = dict[str, jax.Array]  # weight0 [inputs,outputs], bias0 [outputs], weight1 ...


def init(mean_output: np.ndarray, seed: int, hidden: Sequence[int] = (128, 128)) -> Params:
    """He initialisation; the last bias starts at the mean EDM [91], because a dead ReLU stays
    dead."""
    rng = np.random.default_rng(seed)
    widths = (len(mean_output), *hidden, len(mean_output))
    params = {}
    for layer, (inputs, outputs) in enumerate(zip(widths[:-1], widths[1:], strict=True)):
        params[f"weight{layer}"] = rng.normal(0, np.sqrt(2 / inputs), (inputs, outputs))
        params[f"bias{layer}"] = np.zeros(outputs)
    params[f"weight{layer}"] *= 0.1
    params[f"bias{layer}"] = mean_output
    return {name: jnp.asarray(value, jnp.float32) for name, value in params.items()}


def predict(params: Params, edm: jax.Array) -> jax.Array:
    """Distances of normalised 2D distances, [B,91] -> [B,91] metres."""
    return forward(params, edm, None, 0.0)[0]


def forward(
    params: Params, edm: jax.Array, key: jax.Array | None, dropout: float
) -> tuple[jax.Array, Params]:
    """The same with dropout behind each hidden layer; and the parameters that are observed instead
    of trained: none."""
    x = edm
    last = sum(name.startswith("weight") for name in params) - 1
    for layer in range(last + 1):
        x = jax.nn.relu(x @ params[f"weight{layer}"] + params[f"bias{layer}"])
        if dropout > 0 and layer < last:
            keep = jax.random.bernoulli(jax.random.fold_in(key, layer), 1 - dropout, x.shape)
            x = jnp.where(keep, x / (1 - dropout), 0.0)
    return x, {}


def to_arrays(params: Params) -> dict[str, np.ndarray]:
    """The arrays of gen/fconn.npz."""
    return {n: np.asarray(v) for n, v in params.items() if n.startswith(("weight", "bias"))}
