"""Reads PyTorch's state dicts: .safetensors, .pt, .pth.

A state dict has the names of modules and their tensors, and nothing of what forward() does with
them.  What that leaves open is taken for granted with a warning, or refused.
"""

import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from pickle import UnpicklingError
from typing import Any
from zipfile import is_zipfile

import numpy as np

from export.chain import RELU, ExportWarning, Linear, Scale, Step, batch_norm
from export.layers import ExportError
from export.limits import check_archive, check_size

LONGEST_NAME = 1000  # of a tensor: Python makes no integers of more than 4,300 digits
EPSILON = 1e-5  # PyTorch's default; a state dict does not keep it

# ---- Files -------------------------------------------------------------------------------------


def read_safetensors(path: Path) -> list[Step]:
    """A PyTorch state dict: fc1.weight [out, in], fc1.bias [out] ..."""
    from safetensors.numpy import load_file

    return state_steps(load_file(path))  # which checks the sizes against the file's


def read_torch(path: Path) -> list[Step]:
    """A PyTorch state dict, bare or as the "state_dict" of a checkpoint."""
    try:
        import torch
    except ImportError:
        raise ExportError(
            f"reading {path.suffix} needs PyTorch: pip install torch, or save as .safetensors"
        ) from None
    if is_zipfile(path):
        check_archive(path)
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
    except UnpicklingError:  # whose message says how to run code in the file
        raise ExportError(
            "holds more than tensors, such as a whole module: save model.state_dict()"
        ) from None
    if not isinstance(state, Mapping):
        raise ExportError("holds no state dict: save model.state_dict()")
    state = state.get("state_dict", state)
    # What is no tensor fails by its name in state_steps().
    return state_steps(
        {
            name: torch_array(value, name) if torch.is_tensor(value) else None
            for name, value in state.items()
        }
    )


def torch_array(tensor: Any, name: str) -> np.ndarray:
    """A tensor's values.  float(), because NumPy has no bfloat16."""
    check_size(tensor.numel() * 4, name)  # a view can be larger than what it views
    return tensor.detach().float().numpy()


# ---- Modules -----------------------------------------------------------------------------------

STATISTICS = ("running_mean", "running_var")
Module = dict[str, Any]


def state_steps(tensors: Mapping[str, Any]) -> list[Step]:
    """Fully connected layers in the natural order of their names, a ReLU between, and the batch
    normalisation that belongs to them.

    That names tell the order is the convention of nn.Sequential and of numbered modules;
    safetensors keeps no other.
    """
    for name in tensors:
        if len(name) > LONGEST_NAME:
            raise ExportError(f"a tensor's name of {len(name)} letters")
    modules = modules_of(tensors)
    norms = {name for name, module in modules.items() if STATISTICS[0] in module}
    dense = [name for name in sorted(modules, key=natural) if name not in norms]
    before: dict[str, Scale] = {}
    behind: dict[str, Scale] = {}
    for name in sorted(norms, key=natural):
        owner, place = owner_of(name, dense)
        where = before if place == "before" else behind
        if owner in where:
            raise ExportError(f"{name} and {where[owner].name} both belong to {owner}")
        where[owner] = norm_of(name, modules[name])
        order = f"before {owner}" if place == "before" else f"between {owner} and its ReLU"
        warnings.warn(
            f"{name} is taken to stand {order}, with epsilon {EPSILON:g}: a state dict says "
            "neither, an .onnx file both",
            ExportWarning,
            stacklevel=2,
        )
    steps: list[Step] = []
    for name in dense:
        module = modules[name]
        if "bias" not in module and name not in behind:
            raise ExportError(f"layer {name or 0} has no bias{hint_of_norm(module)}")
        weight = module["weight"]
        steps += [RELU] if steps else []
        steps += [before[name]] if name in before else []
        # PyTorch has [out, in].
        steps.append(Linear(None if weight is None else weight.T, module.get("bias")))
        steps += [behind[name]] if name in behind else []
    return steps


def modules_of(tensors: Mapping[str, Any]) -> dict[str, Module]:
    """Tensors by module: PREFIX -> weight, bias, running_mean, running_var."""
    modules: dict[str, Module] = {}
    for name, tensor in tensors.items():
        prefix, _, kind = str(name).rpartition(".")
        if kind not in ("weight", "bias", "num_batches_tracked", *STATISTICS):
            raise ExportError(
                f"unsupported tensor {name}: only weight and bias of linear layers, and batch "
                "normalisation"
            )
        if kind != "num_batches_tracked":
            modules.setdefault(prefix, {})[kind] = tensor
    for prefix, module in modules.items():
        seen = [kind for kind in STATISTICS if kind in module]
        if len(seen) == 1:
            raise ExportError(f"unsupported tensor {prefix}.{seen[0]} without the other statistics")
        if not seen and "weight" not in module:
            raise ExportError(f"layer {prefix or 0} has no weight")
        if not seen and np.ndim(module["weight"]) == 1 and "bias" in module:
            raise ExportError(
                f"{prefix}.weight has one dimension, and there is no {prefix}.running_mean: layer "
                "normalisation depends on each input, so it cannot be folded; train with "
                "batch normalisation"
            )
    return modules


def hint_of_norm(module: Module) -> str:
    """What one number for each unit may be, where a layer is expected."""
    return ": a PReLU cannot run, train with ReLU" if np.ndim(module["weight"]) == 1 else ""


def norm_of(name: str, module: Module) -> Scale:
    """Batch normalisation, which may have neither weight nor bias (affine=False)."""
    return batch_norm(
        module.get("weight"),
        module.get("bias"),
        module["running_mean"],
        module["running_var"],
        epsilon=EPSILON,
        name=name,
    )


def owner_of(norm: str, dense: Sequence[str]) -> tuple[str, str]:
    """The layer that takes up batch normalisation of this name, and whether the normalisation
    stands before or behind it.

    In an nn.Sequential numbers are places: a module that is missing between a layer and the
    normalisation is an activation.  Elsewhere both have the same numbers: fc2 and bn2.
    """
    folder, _, place = norm.rpartition(".")
    places = {
        int(last): name
        for name in dense
        for parent, _, last in [name.rpartition(".")]
        if parent == folder and last.isdecimal()
    }
    if place.isdecimal() and places:
        if int(place) - 1 in places:
            return places[int(place) - 1], "behind"
        if int(place) + 1 in places:
            return places[int(place) + 1], "before"
    else:
        alike = [name for name in dense if numbers_in(name) == numbers_in(norm)]
        if len(alike) == 1:
            return alike[0], "behind"
    raise ExportError(
        f"{norm}: its name does not say which layer it stands next to; save the network as .onnx"
    )


def numbers_in(name: str) -> list[int]:
    """The numbers in a name: [0, 2] of stages.0.bn2."""
    return [int(digits) for digits in re.findall(r"\d+", name)]


def natural(text: str) -> list[str | int]:
    """Sort key by which fc2 precedes fc10."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", text)]
