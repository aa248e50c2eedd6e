"""Reads Keras: .keras, and .h5 of whole models and of weights, of Keras 2 and 3, by h5py.

A whole model says which layers follow each other and how they are activated.  Files of weights
do not: their layers are taken to have a ReLU between, as a PyTorch state dict's are.
"""

import io
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from export.chain import RELU, Linear, Step, batch_norm, chained, why_not
from export.layers import ExportError
from export.limits import H5, read_members
from export.read_state import natural

Weights = Mapping[str, np.ndarray]  # of a layer, by the variable's name: kernel, bias ...
Item = Mapping[str, Any]  # of a config

# ---- Files -------------------------------------------------------------------------------------


def read_keras(path: Path) -> list[Step]:
    """A model that model.save("x.keras") wrote: a zip archive of a config and weights."""
    import h5py

    wanted = ("config.json", "model.weights.h5")
    members = read_members(path, wanted)
    if missing := [name for name in wanted if name not in members]:
        raise ExportError(f"holds no {missing[0]}: save by model.save('x.keras')")
    layers = layers_of(json.loads(members["config.json"]))
    with h5py.File(io.BytesIO(members["model.weights.h5"])) as file:
        return keras_steps(layers, numbered_weights(file, layers))


def read_h5(path: Path) -> list[Step]:
    """What model.save("x.h5") or model.save_weights() wrote."""
    import h5py

    with h5py.File(path) as file:
        if "model_config" in file.attrs:
            layers = layers_of(json.loads(file.attrs["model_config"]))
            return keras_steps(layers, named_weights(file))
        if CONTAINERS[0] in file:
            return weights_alone(numbered_alone(file))
        return weights_alone(named_weights(file))


def weights_alone(weights: Mapping[str, Weights]) -> list[Step]:
    """The chain of a file without a config, which does not say where ReLUs are."""
    weights = {name: values for name, values in weights.items() if values}
    if not weights:
        raise ExportError("holds no weights of Keras")
    for name, values in weights.items():
        if set(values) - {"kernel", "bias"} or "kernel" not in values:
            raise ExportError(
                f"layer {name} has {', '.join(values)}: weights alone do not say where it "
                "stands; save the whole model by model.save('x.keras')"
            )
    return chained([dense_of(values) for values in weights.values()])


def named_weights(file: Any) -> dict[str, Weights]:
    """Weights of a file in which groups are named as layers, in the order of the layers."""
    import h5py

    reader = H5()
    root = reader.child(file, "model_weights")
    root = file if root is None else root
    order = [text_of(name) for name in root.attrs.get("layer_names", sorted(root, key=natural))]
    weights: dict[str, Weights] = {}
    for name in order:
        group, found = reader.child(root, name), dict[str, Any]()
        if not isinstance(group, h5py.Group):
            raise ExportError(f"holds no layer {name}")
        for path in paths_below(group):
            kind = path.rpartition("/")[2].partition(":")[0]
            if kind in found:
                raise ExportError(f"layer {name} has two of {kind}: a model within a model")
            found[kind] = reader.array(reader.child(group, path))
        weights[name] = found
    return weights


def paths_below(group: Any) -> list[str]:
    """Where datasets are below a group.  Links to other files are not followed."""
    import h5py

    paths: list[str] = []
    group.visititems(
        lambda path, item: paths.append(path) if isinstance(item, h5py.Dataset) else None
    )
    return paths


def text_of(name: Any) -> str:
    """A name that HDF5 keeps as bytes or as text."""
    return name.decode("utf-8") if isinstance(name, bytes) else str(name)


# ---- Numbered weights --------------------------------------------------------------------------

CONTAINERS = ("layers", "_layer_checkpoint_dependencies")
SEPARATORS = ("/", "\\")  # Keras on Windows has written names with backslashes
# Layers' variables by number, and the option by which a layer has them.
VARIABLES = {
    "dense": (("kernel", None), ("bias", "use_bias")),
    "batch_normalization": (
        ("gamma", "scale"),
        ("beta", "center"),
        ("moving_mean", None),
        ("moving_variance", None),
    ),
}


def numbered_weights(file: Any, layers: Sequence[Item]) -> dict[str, Weights]:
    """Weights of the layers of a config, in groups that are named by class and place: dense,
    dense_1 ..."""
    reader, weights, places = H5(), dict[str, Weights](), Counter[str]()
    for layer in layers:
        kind, config = snake_case(layer["class_name"]), layer["config"]
        group = f"{kind}_{places[kind]}" if places[kind] else kind
        places[kind] += 1
        variables, name = variables_in(reader, file, group), config["name"]
        if not variables or kind not in VARIABLES:
            continue
        said = text_of(variables.attrs.get("name", name))
        if said != name:
            raise ExportError(f"the weights of layer {name} are those of {said}")
        names = [kind for kind, flag in VARIABLES[kind] if flag is None or config.get(flag, True)]
        weights[name] = numbered(reader, variables, names, name)
    return weights


def numbered_alone(file: Any) -> dict[str, Weights]:
    """Weights in such groups where there is no config."""
    reader, weights = H5(), dict[str, Weights]()
    for group in sorted(reader.child(file, CONTAINERS[0]), key=natural):
        kind = re.sub(r"_\d+$", "", group)
        if variables := variables_in(reader, file, group):
            names = [name for name, _ in VARIABLES.get(kind, ())][: len(variables)]
            weights[group] = numbered(reader, variables, names, group)
    return weights


def variables_in(reader: H5, file: Any, group: str) -> Any:
    """The group of a layer's variables, or None."""
    for root in CONTAINERS:
        for separator in SEPARATORS:
            variables = reader.child(file, separator.join([root, group, "vars"]))
            if variables is not None:
                return variables
    return None


def numbered(reader: H5, variables: Any, names: Sequence[str], layer: str) -> Weights:
    """Variables 0, 1 ... by name."""
    if sorted(variables, key=natural) != [str(k) for k in range(len(names))]:
        raise ExportError(
            f"layer {layer} has {len(variables)} variables, not {', '.join(names) or 'none'}"
        )
    return {name: reader.array(reader.child(variables, str(k))) for k, name in enumerate(names)}


def snake_case(name: str) -> str:
    """BatchNormalization -> batch_normalization, as Keras does."""
    name = re.sub(r"\W+", "", name)
    name = re.sub("(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub("([a-z])([A-Z])", r"\1_\2", name).lower()


# ---- The chain ---------------------------------------------------------------------------------


def layers_of(model: Item) -> list[Item]:
    """The layers of a model's config in the order in which they follow each other."""
    kind, config = model["class_name"], model["config"]
    if kind == "Sequential":
        return config["layers"] if isinstance(config, Mapping) else config
    if kind not in ("Functional", "Model"):
        raise ExportError(
            f"a model of class {kind}: save a Sequential or a functional model of its layers"
        )
    layers, name = config["layers"], None
    for layer in layers:
        before = inbound_of(layer.get("inbound_nodes", []))
        if before != ([] if name is None else [name]):
            raise ExportError(
                f"layer {layer['name']} does not follow on {name or 'the input'}: "
                "layers must follow each other, without branches"
            )
        name = layer["name"]
    ends = names_in(config.get("output_layers", []))
    if ends != [name]:
        raise ExportError(f"the model gives {', '.join(ends)}, not its last layer, {name}")
    return layers


def inbound_of(nodes: Any) -> list[str]:
    """The layers whose outputs a layer takes; of Keras 3 by their history."""
    if isinstance(nodes, Mapping):
        if "keras_history" in nodes:
            return [nodes["keras_history"][0]]
        return [name for value in nodes.values() for name in inbound_of(value)]
    if not isinstance(nodes, list):
        return []
    if len(nodes) >= 3 and isinstance(nodes[0], str):  # Keras 2: [name, node, tensor, ...]
        return [nodes[0]]
    return [name for value in nodes for name in inbound_of(value)]


def names_in(ends: Any) -> list[str]:
    """The layers of ["dense", 0, 0], or of a list of such."""
    ends = [ends] if ends and isinstance(ends[0], str) else ends
    return [end[0] for end in ends]


IDLE = (
    "InputLayer", "Dropout", "GaussianDropout", "GaussianNoise", "AlphaDropout", "Flatten",
    "ActivityRegularization", "Identity",
)  # fmt: skip
NORMS = ("BatchNormalization", "BatchNormalizationV1", "BatchNormalizationV2")


def keras_steps(layers: Sequence[Item], weights: Mapping[str, Weights]) -> list[Step]:
    """What the layers do, one after the other."""
    steps: list[Step] = []
    for layer in layers:
        kind, config = layer["class_name"], layer["config"]
        known = weights.get(config.get("name", ""), {})
        if kind == "Dense":
            steps += dense_steps(config, known)
        elif kind in NORMS:
            steps.append(norm_of(config, known))
        elif kind in ("Activation", "ReLU"):
            spec = config.get("activation") if kind == "Activation" else layer
            steps += activation_steps(spec, f"layer {config.get('name')}")
        elif kind not in IDLE:
            raise ExportError(f"unsupported Keras layer {kind}: {why_not(kind)}")
    return steps


def dense_steps(config: Item, weights: Weights) -> list[Step]:
    """A fully connected layer and its activation."""
    name = config.get("name")
    wanted = {"kernel"} | ({"bias"} if config.get("use_bias", True) else set())
    if set(weights) != wanted:
        have = ", ".join(weights) or "no weights"
        raise ExportError(f"layer {name} has {have}, not {' and '.join(sorted(wanted))}")
    return [dense_of(weights), *activation_steps(config.get("activation"), f"layer {name}")]


def dense_of(weights: Weights) -> Linear:
    """A layer, whose bias is 0 where Keras has none (use_bias=False)."""
    kernel = weights["kernel"]
    none = np.zeros(kernel.shape[-1] if kernel.ndim else 0, np.float32)
    return Linear(kernel, weights.get("bias", none))


def norm_of(config: Item, weights: Weights) -> Step:
    """Batch normalisation of the last axis."""
    name = f"layer {config.get('name')}"
    if config.get("axis", -1) not in (1, -1, [1], [-1]):
        raise ExportError(f"{name} normalises axis {config['axis']}, not the last")
    if missing := {"moving_mean", "moving_variance"} - set(weights):
        raise ExportError(f"{name} has no {missing.pop()}")
    gamma, beta, mean, variance = (
        weights.get(kind) for kind in ("gamma", "beta", "moving_mean", "moving_variance")
    )
    return batch_norm(
        gamma, beta, mean, variance, epsilon=float(config.get("epsilon", 1e-3)), name=name
    )


def activation_steps(spec: Any, name: str) -> list[Step]:
    """[RELU], or [] of a linear activation; spec is a name, or what Keras serialises."""
    options: Item = {}
    if isinstance(spec, Mapping):
        inner = spec.get("config")
        options = inner if isinstance(inner, Mapping) else {}
        spec = inner if isinstance(inner, str) else spec.get("class_name")
    kind = str(spec or "linear")
    if kind.lower() == "linear":
        return []
    if kind.lower() != "relu":
        raise ExportError(f"{name} has the activation {kind}: {why_not(kind)}")
    changed = [
        option
        for option in ("max_value", "negative_slope", "threshold")
        if options.get(option) not in (None, 0)
    ]
    if changed:
        raise ExportError(f"{name} is a ReLU with {changed[0]}: {why_not('relu6')}")
    return [RELU]
