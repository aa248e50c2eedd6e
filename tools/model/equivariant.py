"""A fully connected network that treats left and right alike, in JAX, to be trained.

Each unit has a mirror unit.  If what the network reads is mirrored, mirror units change places,
whatever the weights: only the sums of the two (even) and their differences (odd) are multiplied,
each by weights of its own.  So every weight counts for left and for right, and layers are as wide
as those of a network of twice as many.

Training standardises the inputs.  Where they are all far from zero, as softened distances are, a
few steps push many units to where they never fire again.  The weights that are saved have mean and
spread in their first layer.

Inputs come as sums and differences already.  An output row is a pair as well: what the network
says of something, and of its mirror image.  What inputs and outputs mean is lifter.py's business.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np

from model.layout import Layout

# weight0 [even + odd inputs, units], bias0 [units], weight1 ...; of the inputs, mean and spread
# [even + odd inputs], which are not trained.
Params = dict[str, jax.Array]
LEAST_SPREAD = 1e-3  # of an input


def init(
    layout: Layout, hidden: Sequence[int], bias: np.ndarray, inputs: np.ndarray, seed: int
) -> Params:
    """He initialisation; the output rows start at `bias` [rows].

    inputs  [F,even + odd] of training views, by which they are standardised
    """
    is_even = np.arange(inputs.shape[1]) < layout.even  # odd ones are as often negative
    rng = np.random.default_rng(seed)
    widths = [inputs.shape[1], *(2 * width for width in hidden)]
    params = {"mean": inputs.mean(0) * is_even}
    spread = np.sqrt(np.mean((inputs - params["mean"]) ** 2, 0))
    params["spread"] = np.maximum(spread, LEAST_SPREAD)
    for layer, (rows, units) in enumerate(zip(widths, (*hidden, len(bias)), strict=True)):
        params[f"weight{layer}"] = rng.normal(0, np.sqrt(1 / rows), (rows, units))
        params[f"bias{layer}"] = np.zeros(units)
    params[f"weight{layer}"] *= 0.1
    params[f"bias{layer}"] = bias
    return {name: jnp.asarray(value, jnp.float32) for name, value in params.items()}


def plain(params: Params, layout: Layout) -> Params:
    """Weights and biases alone, for inputs as they are; zero where the layout has nothing."""
    kept = {name: v for name, v in params.items() if name.startswith(("weight", "bias"))}
    mean, spread = (jax.lax.stop_gradient(params[name]) for name in ("mean", "spread"))
    first = params["weight0"] / spread[:, None]
    kept |= {"weight0": first, "bias0": params["bias0"] - mean @ first}
    return masked(kept, layout)


def masked(params: Params, layout: Layout) -> Params:
    """The parameters without what the layout does not have: those weights are zero."""
    last = layer_count(params) - 1
    weight, bias = params[f"weight{last}"], params[f"bias{last}"]
    half = len(weight) // 2
    weight = jnp.concatenate([weight[:half] * layout.has_even, weight[half:] * layout.has_odd])
    return params | {f"weight{last}": weight, f"bias{last}": bias * layout.has_even}


def layer_count(params: Params) -> int:
    """Layers of a network."""
    return sum(name.startswith("weight") for name in params)


def forward(
    params: Params, layout: Layout, even: jax.Array, odd: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """Rows [B,rows] and their mirror images, from even and odd inputs, [B,n] each."""
    params = plain(params, layout)
    last = layer_count(params) - 1
    for layer in range(last + 1):
        weight = params[f"weight{layer}"]
        alike = even @ weight[: even.shape[1]] + params[f"bias{layer}"]
        unlike = odd @ weight[even.shape[1] :]
        first, second = alike + unlike, alike - unlike
        if layer < last:
            first, second = jax.nn.relu(first), jax.nn.relu(second)
            even, odd = first + second, first - second
    return first, second


def to_arrays(params: Params, layout: Layout) -> dict[str, np.ndarray]:
    """The arrays of an .npz: weights and biases."""
    return {name: np.asarray(value) for name, value in plain(params, layout).items()}


def fires(params: Params, layout: Layout, even: jax.Array, odd: jax.Array) -> list[jax.Array]:
    """How often each pair of hidden units fires, either of the two: a layer [units] each."""
    rates, params = [], plain(params, layout)
    for layer in range(layer_count(params) - 1):
        weight = params[f"weight{layer}"]
        alike = even @ weight[: even.shape[1]] + params[f"bias{layer}"]
        unlike = odd @ weight[even.shape[1] :]
        rates.append(jnp.mean(alike + jnp.abs(unlike) > 0, 0))
        first, second = jax.nn.relu(alike + unlike), jax.nn.relu(alike - unlike)
        even, odd = first + second, first - second
    return rates
