"""FConv, the paper's second network (section 3.2), in JAX, to be trained.

    14x14 -> conv 7x7, 64, BN, ReLU, max pool -> 7x7x64
    -> conv 7x7, 64, BN, ReLU, max pool -> 4x4x64
    -> deconv 7x7, 64, stride 2, ReLU -> 7x7x64 -> deconv 7x7, 64, stride 2, ReLU -> 14x14x64
    -> conv 1x1 -> 14x14, mean of it and its transpose, ReLU

605,825 parameters; the means and variances of the batch normalisation (BN) come on top.  The
convolutions are matrix products, which on a processor take a quarter of the time of XLA's own.
"""

import jax
import jax.numpy as jnp
import numpy as np

from edmlift.joints import JOINTS, PAIRS
from model.constants import CHANNELS
from model.fconv_weights import EPSILON, fold, round_weights
from model.fconv_weights import TAPS as WIDTH

COUNT = len(JOINTS)
MOMENTUM = 0.99  # of the running means and variances

Params = dict[str, jax.Array]


def init(mean_output: np.ndarray, seed: int) -> Params:
    """He initialisation; the last bias starts at the mean distance, because a dead ReLU stays
    dead."""
    rng = np.random.default_rng(seed)

    def kernel(inputs: int, taps: float) -> np.ndarray:
        return rng.normal(0, np.sqrt(2 / (inputs * taps)), (WIDTH, WIDTH, inputs, CHANNELS))

    params = {
        "conv1_weight": kernel(1, WIDTH**2),
        "conv2_weight": kernel(CHANNELS, WIDTH**2),
        "deconv1_weight": kernel(CHANNELS, WIDTH**2 / 4),  # a stride of 2 leaves a quarter of them
        "deconv2_weight": kernel(CHANNELS, WIDTH**2 / 4),
        "conv3_weight": rng.normal(0, 0.1 / np.sqrt(CHANNELS), CHANNELS),
        "conv3_bias": np.full(1, mean_output.mean()),
    }
    for layer in ("conv1", "conv2", "deconv1", "deconv2"):
        params[f"{layer}_bias"] = np.zeros(CHANNELS)
    for bn in ("bn1", "bn2"):
        params |= {f"{bn}_scale": np.ones(CHANNELS), f"{bn}_shift": np.zeros(CHANNELS)}
        params |= {f"{bn}_mean": np.zeros(CHANNELS), f"{bn}_variance": np.ones(CHANNELS)}
    return {name: jnp.asarray(value, jnp.float32) for name, value in params.items()}


def predict(params: Params, edm: jax.Array) -> jax.Array:
    """Distances of normalised 2D distances, [B,91] -> [B,91] metres."""
    return forward(params, edm, None, 0.0, batch=False)[0]


def forward(
    params: Params, edm: jax.Array, key: jax.Array | None, dropout: float, batch: bool = True
) -> tuple[jax.Array, Params]:
    """The same normalised by the batch, with dropout behind both convolutions and the first
    deconvolution, as in the paper; and the running means and variances after it."""
    running = {}

    def normalise(x: jax.Array, bn: str) -> jax.Array:
        mean, variance = params[f"{bn}_mean"], params[f"{bn}_variance"]
        if batch:
            axes = tuple(range(x.ndim - 1))
            now = {f"{bn}_mean": x.mean(axes), f"{bn}_variance": x.var(axes)}
            for name, value in now.items():
                running[name] = MOMENTUM * params[name] + (1 - MOMENTUM) * value
            mean, variance = now.values()
        scale = params[f"{bn}_scale"] * jax.lax.rsqrt(variance + EPSILON)
        return jax.nn.relu((x - mean) * scale + params[f"{bn}_shift"])

    def drop(x: jax.Array, layer: int) -> jax.Array:
        if dropout == 0:
            return x
        keep = jax.random.bernoulli(jax.random.fold_in(key, layer), 1 - dropout, x.shape)
        return jnp.where(keep, x / (1 - dropout), 0.0)

    x = jnp.zeros((len(edm), COUNT, COUNT)).at[:, PAIRS[0], PAIRS[1]].set(edm)
    x = conv1(x + x.transpose(0, 2, 1), params["conv1_weight"]) + params["conv1_bias"]
    x = drop(max_pool(normalise(x, "bn1")), 0)
    x = conv2(x, params["conv2_weight"]) + params["conv2_bias"]
    x = drop(max_pool(normalise(x, "bn2")), 1)
    x = deconv(x, params["deconv1_weight"], COUNT // 2) + params["deconv1_bias"]
    x = drop(jax.nn.relu(x), 2)
    x = jax.nn.relu(deconv(x, params["deconv2_weight"], COUNT) + params["deconv2_bias"])
    z = x @ params["conv3_weight"] + params["conv3_bias"]
    z = jax.nn.relu((z + z.transpose(0, 2, 1)) / 2)
    return z[:, PAIRS[0], PAIRS[1]], running


def to_arrays(params: Params) -> dict[str, np.ndarray]:
    """The arrays of gen/fconv.npz: without batch normalisation, of short weights."""
    return round_weights(fold({name: np.asarray(value) for name, value in params.items()}))


def conv1(x: jax.Array, weight: jax.Array) -> jax.Array:
    """[B,14,14] * [7,7,1,C] -> [B,14,14,C]: the patch of every pixel times the kernel."""
    size, pad = x.shape[1], WIDTH // 2
    x = jnp.pad(x, ((0, 0), (pad, pad), (pad, pad)))
    patches = [x[:, a : a + size, b : b + size] for a in range(WIDTH) for b in range(WIDTH)]
    return jnp.stack(patches, -1) @ weight.reshape(WIDTH**2, -1)


def conv2(x: jax.Array, weight: jax.Array) -> jax.Array:
    """[B,7,7,C] * [7,7,C,C] -> [B,7,7,C]: seven whole rows times a Toeplitz matrix of the kernel.

    Every pixel of a row of 7 is under the kernel somewhere, so that no product is in vain but
    those with the padding above and below.
    """
    count, size, _, channels = x.shape
    pad = WIDTH // 2
    column = np.arange(size)[:, None] - np.arange(size)[None] + pad  # of the kernel: input, output
    column = np.where((column >= 0) & (column < WIDTH), column, WIDTH)  # WIDTH: a column of zeros
    toeplitz = jnp.pad(weight, ((0, 0), (0, 1), (0, 0), (0, 0)))[:, column]
    toeplitz = toeplitz.transpose(0, 1, 3, 2, 4).reshape(-1, size * channels)
    x = jnp.pad(x.reshape(count, size, -1), ((0, 0), (pad, pad), (0, 0)))
    rows = jnp.concatenate([x[:, a : a + size] for a in range(WIDTH)], -1)
    return (rows @ toeplitz).reshape(count, size, size, channels)


# An output pixel 2m or 2m + 1 is made of the inputs m - 1 to m + 2: by these taps of the kernel.
TAPS = np.array([[5, 6], [3, 4], [1, 2], [WIDTH, 0]])  # [input - (m - 1), odd]; WIDTH: a zero


def deconv(x: jax.Array, weight: jax.Array, size: int) -> jax.Array:
    """Transposed convolution of stride 2: [B,n,n,C] * [7,7,C,C] -> [B,size,size,C], size <= 2n.

    out[o] += x[i] weight[o - 2i + 3], on both axes: patches of 4x4 times the kernels of the four
    outputs that they make.
    """
    count, n, _, channels = x.shape
    kernels = jnp.pad(weight, ((0, 1), (0, 1), (0, 0), (0, 0)))[TAPS][:, :, TAPS]
    kernels = kernels.transpose(0, 2, 4, 1, 3, 5).reshape(16 * channels, -1)
    x = jnp.pad(x, ((0, 0), (1, 2), (1, 2), (0, 0)))
    patches = [x[:, a : a + n, b : b + n] for a in range(4) for b in range(4)]
    out = (jnp.concatenate(patches, -1) @ kernels).reshape(count, n, n, 2, 2, -1)
    out = out.transpose(0, 1, 3, 2, 4, 5).reshape(count, 2 * n, 2 * n, -1)
    return out[:, :size, :size]


def max_pool(x: jax.Array) -> jax.Array:
    """The largest of 2x2, of an odd rest alone: [B,n,n,C] -> [B,ceil(n/2),ceil(n/2),C], x >= 0."""
    count, n, _, channels = x.shape
    half = (n + 1) // 2
    x = jnp.pad(x, ((0, 0), (0, 2 * half - n), (0, 2 * half - n), (0, 0)))
    return x.reshape(count, half, 2, half, 2, channels).max((2, 4))
