"""Reads trained weights: .npz (train.py's), .safetensors, .pt and .pth (PyTorch), .onnx, .keras
and .h5 (Keras), .tflite, .mat (MatConvNet).

Each format is a function path -> steps in READERS; export/chain.py makes layers of them.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from data import archives
from data.archives import one_line
from export.chain import Step, chained, fold
from export.layers import ExportError, Layer, check_layers
from export.limits import LARGEST, check_size
from export.read_keras import read_h5, read_keras
from export.read_mat import read_mat
from export.read_onnx import read_onnx
from export.read_state import read_safetensors, read_torch
from export.read_tflite import read_tflite
from model.constants import PAIR_COUNT


def load_npz(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a file."""
    return archives.load_npz(path, LARGEST)


def read_npz(path: Path) -> list[Layer]:
    """The project's own: weight0 [in, out], bias0 [out], weight1 ..."""
    arrays = load_npz(path)
    layers: dict[int, dict[str, np.ndarray]] = {}
    for name, array in arrays.items():
        match = re.fullmatch(r"(weight|bias)(\d+)", name)
        if match is None:
            raise ExportError(f"unknown array {name}: want weight0, bias0, weight1 ...")
        layers.setdefault(int(match[2]), {})[match[1]] = array
    for k, pair in layers.items():
        if missing := {"weight", "bias"} - pair.keys():
            raise ExportError(f"layer {k} has no {missing.pop()}")
    if layers and f"weight{len(layers) - 1}" not in arrays:
        raise ExportError(f"the {len(layers)} layers are not numbered 0 to {len(layers) - 1}")
    return [Layer(**layers[k]) for k in sorted(layers)]


# What a file holds, in order.
READERS: dict[str, Callable[[Path], Sequence[Step]]] = {
    ".npz": lambda path: chained(read_npz(path)),
    ".safetensors": read_safetensors,
    ".pt": read_torch,
    ".pth": read_torch,
    ".onnx": read_onnx,
    ".keras": read_keras,
    ".h5": read_h5,
    ".hdf5": read_h5,
    ".tflite": read_tflite,
    ".mat": read_mat,
}


def read_layers(path: Path) -> list[Layer]:
    """The layers in a file of weights, fit for a header.  Raises ExportError, never another."""
    layers = read_file(path, {name: folding(read) for name, read in READERS.items()})
    refuse_coordinates(layers)
    return check_layers(layers)


def refuse_coordinates(layers: Sequence[Layer]) -> None:
    """Raises ExportError if the layers seem to go from coordinates to coordinates."""
    if not layers or any(np.ndim(layer.weight) != 2 for layer in layers):
        return
    inputs, outputs = layers[0].weight.shape[0], layers[-1].weight.shape[1]
    if inputs in COORDINATES and outputs in COORDINATES:
        raise ExportError(
            f"layer 0 takes {inputs} values, the image gives {PAIR_COUNT}, and the last gives "
            f"{outputs}: no kernel runs a network from coordinates to coordinates; train one "
            "from distances to distances, or the kind `direct` (docs/own-weights.md)"
        )


# Numbers of two or three coordinates of 12 to 33 joints.
COORDINATES = {axes * joints for axes in (2, 3) for joints in range(12, 34)} - {PAIR_COUNT}


def folding(read: Callable[[Path], Sequence[Step]]) -> Callable[[Path], list[Layer]]:
    """A reader's layers, batch normalisation folded into them."""
    return lambda path: fold(read(path))


def read_file(path: Path, readers: Mapping[str, Callable[[Path], Any]]) -> Any:
    """What the reader of its suffix makes of a file.  Raises ExportError, never another."""
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise ExportError(f"unknown suffix '{path.suffix}': one of {', '.join(readers)}")
    if not path.is_file():
        raise ExportError("no such file")
    if path.stat().st_size == 0:
        raise ExportError("the file is empty")
    check_size(path.stat().st_size, "the file")
    try:
        return reader(path)
    except ExportError:
        raise
    except archives.ArchiveError as error:
        raise ExportError(f"not a readable {path.suffix} file: {error}") from error
    except Exception as error:  # a damaged file makes the libraries raise whatever they like
        raise ExportError(f"not a readable {path.suffix} file: {one_line(error)}") from error
