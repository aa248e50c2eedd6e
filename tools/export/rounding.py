"""Rounds weights of 8 bits so that their errors make up for each other.

Inputs of a layer are correlated, as units are: what one weight of a row is off by, the others can
take back, those of inputs that vary along with its own.  So weights are rounded input by input, and
each error is spread over the inputs that follow (E. Frantar et al., "GPTQ: Accurate post-training
quantization for generative pre-trained transformers", ICLR 2023).  Which way each weight went is
kept in the manifest, because it takes the training views to find out.
"""

import base64
import zlib
from collections.abc import Sequence

import numpy as np

DAMPING = 0.01  # of the covariance, in parts of its mean variance


def compensated(weight: np.ndarray, inputs: np.ndarray, most: int) -> np.ndarray:
    """Integers within +-most [in, out] for weights that are multiples of one.

    inputs  [F,in] about their mean, for which the sums of rows are to stay as they are
    """
    covariance = inputs.T @ inputs / len(inputs)
    variance = np.diag(covariance)
    if not variance.any():
        return np.clip(np.rint(weight), -most, most)
    order = np.argsort(-variance, kind="stable")
    covariance = covariance[np.ix_(order, order)] + DAMPING * variance.mean() * np.eye(len(order))
    spread = np.linalg.cholesky(np.linalg.inv(covariance)).T  # upper
    left, rounded = weight[order].astype(float), np.zeros(weight.shape)
    for i in range(len(order)):
        rounded[order[i]] = np.clip(np.rint(left[i]), -most, most)
        error = (left[i] - rounded[order[i]]) / spread[i, i]
        left[i + 1 :] -= spread[i, i + 1 :, None] * error
    return rounded


def to_text(steps: Sequence[np.ndarray]) -> str:
    """The steps of each layer [in, out] from the nearest integers, within +-127, for JSON."""
    whole = b"".join(layer.astype(np.int8).tobytes() for layer in steps)
    return base64.b64encode(zlib.compress(whole, 9)).decode()


def from_text(text: str, shapes: Sequence[tuple[int, int]]) -> list[np.ndarray]:
    """The steps of layers of these shapes; ValueError where the text is not of them.  It has a
    checksum, so that one letter does not make other weights."""
    stream = zlib.decompressobj()
    try:
        whole = np.frombuffer(stream.decompress(base64.b64decode(text, validate=True)), np.int8)
    except (TypeError, zlib.error) as error:
        raise ValueError(f"steps: {error}") from error
    sizes = [rows * columns for rows, columns in shapes]
    if not stream.eof or stream.unused_data or len(whole) != sum(sizes):
        raise ValueError("steps: not of these layers")
    parts = np.split(whole.astype(float), np.cumsum(sizes)[:-1])
    return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]
