"""Reads trained weights: .npz (train.py's), .safetensors, .onnx, .pt and .pth (PyTorch), .mat
(MatConvNet).

Each format is a function path -> layers in READERS.
"""

import re
import zipfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from export.layers import ExportError, Layer, check_layers, one_line
from export.read_mat import read_mat
from export.read_onnx import read_onnx


def load_npz(path: Path) -> dict[str, np.ndarray]:
    """The arrays of a file."""
    if not zipfile.is_zipfile(path):  # np.load would take it for a pickle
        raise ExportError("not a readable .npz file: no zip archive")
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def read_npz(path: Path) -> list[Layer]:
    """The project's own: weight0 [in, out], bias0 [out], weight1 ..."""
    arrays, tensors = load_npz(path), {}
    for name, array in arrays.items():
        match = re.fullmatch(r"(weight|bias)(\d+)", name)
        if match is None:
            raise ExportError(f"unknown array {name}: want weight0, bias0, weight1 ...")
        tensors[f"{match[2]}.{match[1]}"] = array
    layers = pair_up(tensors)
    if layers and f"weight{len(layers) - 1}" not in arrays:
        raise ExportError(f"the {len(layers)} layers are not numbered 0 to {len(layers) - 1}")
    return layers


def read_safetensors(path: Path) -> list[Layer]:
    """A PyTorch state dict: fc1.weight [out, in], fc1.bias [out] ..."""
    from safetensors.numpy import load_file

    return transposed(pair_up(load_file(path)))


def read_torch(path: Path) -> list[Layer]:
    """A PyTorch state dict, bare or as the "state_dict" of a checkpoint."""
    try:
        import torch
    except ImportError:
        raise ExportError(
            f"reading {path.suffix} needs PyTorch: pip install torch, or save as .safetensors"
        ) from None
    state = torch.load(path, map_location="cpu", weights_only=True)
    state = state.get("state_dict", state)
    # float(), because NumPy has no bfloat16.  What is no tensor fails by its name in pair_up().
    return transposed(
        pair_up(
            {
                name: value.detach().float().numpy() if torch.is_tensor(value) else None
                for name, value in state.items()
            }
        )
    )


def pair_up(tensors: Mapping[str, Any]) -> list[Layer]:
    """Layers of tensors named PREFIX.weight and PREFIX.bias, in the natural order of the prefixes.

    That names tell the order is the convention of nn.Sequential and of numbered modules;
    safetensors keeps no other.
    """
    pairs: dict[str, dict[str, Any]] = {}
    for name, tensor in tensors.items():
        prefix, _, kind = name.rpartition(".")
        if kind not in ("weight", "bias"):
            raise ExportError(f"unsupported tensor {name}: only weight and bias of linear layers")
        pairs.setdefault(prefix, {})[kind] = tensor
    for prefix, pair in pairs.items():
        if missing := {"weight", "bias"} - pair.keys():
            raise ExportError(f"layer {prefix or 0} has no {missing.pop()}")
    return [Layer(**pairs[prefix]) for prefix in sorted(pairs, key=natural)]


def natural(text: str) -> list[str | int]:
    """Sort key by which fc2 precedes fc10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", text)]


def transposed(layers: Iterable[Layer]) -> list[Layer]:
    """PyTorch's [out, in] to [in, out]."""
    return [Layer(weight.T, bias) for weight, bias in layers]


READERS: dict[str, Callable[[Path], list[Layer]]] = {
    ".npz": read_npz,
    ".safetensors": read_safetensors,
    ".onnx": read_onnx,
    ".pt": read_torch,
    ".pth": read_torch,
    ".mat": read_mat,
}


def read_layers(path: Path) -> list[Layer]:
    """The layers in a file of weights, fit for a header.  Raises ExportError, never another."""
    return check_layers(read_file(path, READERS))


def read_file(path: Path, readers: Mapping[str, Callable[[Path], Any]]) -> Any:
    """What the reader of its suffix makes of a file.  Raises ExportError, never another."""
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise ExportError(f"unknown suffix '{path.suffix}': one of {', '.join(readers)}")
    if not path.is_file():
        raise ExportError("no such file")
    if path.stat().st_size == 0:
        raise ExportError("the file is empty")
    try:
        return reader(path)
    except ExportError:
        raise
    except Exception as error:  # a damaged file makes the libraries raise whatever they like
        raise ExportError(f"not a readable {path.suffix} file: {one_line(error)}") from error
