"""Files that Keras itself has written, and of older versions, are exported or refused by name."""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
from exports import check_exported, poses, refused, small_net
from test_batch_norm import linear, make_norm, normalised, relu

KERAS_NORM = {
    "gamma": "weight",
    "beta": "bias",
    "moving_mean": "running_mean",
    "moving_variance": "running_var",
}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What make_keras.py writes."""
    folder = tmp_path_factory.mktemp("keras")
    np.save(folder / "poses.npy", poses())
    script = Path(__file__).with_name("make_keras.py")
    done = subprocess.run([sys.executable, script, folder], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("end", [".keras", ".h5"])
@pytest.mark.parametrize("model", ["plain", "norms", "no_bias", "functional", "many"])
def test_model(tmp_path: Path, folder: Path, model: str, end: str) -> None:
    expected = np.load(folder / f"{model}.npy")
    check_exported(tmp_path, folder / f"{model}{end}", expected, in_c=model == "norms")


@pytest.mark.slow
@pytest.mark.parametrize("model", ["plain", "no_bias", "many"])
def test_weights_alone(tmp_path: Path, folder: Path, model: str) -> None:
    """With a ReLU between the layers; dense_10 comes behind dense_9."""
    expected = np.load(folder / f"{model}.npy")
    check_exported(tmp_path, folder / f"{model}.weights.h5", expected)


@pytest.mark.parametrize("end", [".keras", ".h5"])
@pytest.mark.parametrize(
    ("model", "message"),
    [
        ("branching", "unsupported Keras layer Add: "),
        ("two_ends", "not its last layer"),
        ("leaky", "unsupported Keras layer LeakyReLU: the C kernels apply ReLU and no other"),
        ("slope", "is a ReLU with negative_slope: the C kernels apply ReLU"),
        ("relu6", "is a ReLU with max_value: the C kernels apply ReLU"),
        ("tanh", "has the activation tanh: the C kernels apply ReLU and no other activation"),
        ("layer_norm", "unsupported Keras layer LayerNormalization: it depends on each input"),
        ("nested", "unsupported Keras layer Sequential"),
        ("end", "cannot be folded: it has no layer before it and no layer behind it"),
    ],
)
def test_refused(tmp_path: Path, capsys, folder: Path, model: str, end: str, message: str) -> None:
    line = refused(tmp_path, capsys, folder / f"{model}{end}")
    if model == "branching":
        message = "does not follow on"
    assert message in line


@pytest.mark.parametrize("model", ["norms", "functional"])
def test_weights_alone_do_not_say_where_batch_norm_stands(
    tmp_path: Path, capsys, folder: Path, model: str
) -> None:
    line = refused(tmp_path, capsys, folder / f"{model}.weights.h5")
    assert "weights alone do not say where it stands; save the whole model" in line


@pytest.mark.parametrize("end", [".keras", ".h5", ".weights.h5"])
@pytest.mark.parametrize("share", [0.3, 0.7, 0.99])
def test_truncated(tmp_path: Path, capsys, folder: Path, end: str, share: float) -> None:
    data = (folder / f"plain{end}").read_bytes()
    (tmp_path / f"net{end}").write_bytes(data[: int(len(data) * share)])
    refused(tmp_path, capsys, tmp_path / f"net{end}")


# ---- Keras 2 -----------------------------------------------------------------------------------

NET, NORM = small_net(91, 64, 91), make_norm(64)


def dense_config(name: str, activation: str) -> dict:
    config = {"name": name, "activation": activation, "use_bias": True}
    return {"class_name": "Dense", "config": config}


CONFIGS = [
    {"class_name": "InputLayer", "config": {"name": "input_1"}},
    dense_config("dense", "linear"),
    {
        "class_name": "BatchNormalization",
        "config": {"name": "bn", "axis": [1], "epsilon": 0.001, "scale": True, "center": True},
    },
    {"class_name": "Activation", "config": {"name": "activation", "activation": "relu"}},
    dense_config("dense_1", "linear"),
]


def expected() -> np.ndarray:
    hidden = relu(normalised(linear(poses(), NET[0]), NORM, 0.001))
    return linear(hidden, NET[1])


def functional_config() -> dict:
    """With Keras 2's inbound nodes."""
    layers = []
    for k, layer in enumerate(CONFIGS):
        name = layer["config"]["name"]
        before = [[[CONFIGS[k - 1]["config"]["name"], 0, 0, {}]]] if k else []
        layers.append(layer | {"name": name, "inbound_nodes": before})
    ends = {"input_layers": [["input_1", 0, 0]], "output_layers": [["dense_1", 0, 0]]}
    return {"class_name": "Functional", "config": {"name": "model", "layers": layers} | ends}


def save_keras2(path: Path, config: dict | None, suffix: str = ":0") -> None:
    """As model.save(), or without a config as save_weights()."""
    weights = {
        "input_1": {},
        "dense": {"kernel": NET[0][0], "bias": NET[0][1]},
        "bn": {name: NORM[ours] for name, ours in KERAS_NORM.items()},
        "activation": {},
        "dense_1": {"kernel": NET[1][0], "bias": NET[1][1]},
    }
    with h5py.File(path, "w") as file:
        root = file
        if config is not None:
            file.attrs["model_config"] = json.dumps(config).encode()
            root = file.create_group("model_weights")
        root.attrs["layer_names"] = [name.encode() for name in weights]
        for layer, values in weights.items():
            group = root.create_group(layer)
            group.attrs["weight_names"] = [f"{layer}/{name}{suffix}".encode() for name in values]
            for name, array in values.items():
                group[f"{layer}/{name}{suffix}"] = array


@pytest.mark.parametrize(
    "config",
    [
        {"class_name": "Sequential", "config": {"name": "sequential", "layers": CONFIGS}},
        {"class_name": "Sequential", "config": CONFIGS[1:]},  # until 2.2
        functional_config(),
    ],
)
def test_keras_2(tmp_path: Path, config: dict) -> None:
    save_keras2(tmp_path / "net.h5", config)
    check_exported(tmp_path, tmp_path / "net.h5", expected())


def test_keras_2_weights_alone(tmp_path: Path, capsys) -> None:
    save_keras2(tmp_path / "net.hdf5", None)
    line = refused(tmp_path, capsys, tmp_path / "net.hdf5")
    assert "layer bn has beta, gamma, moving_mean, moving_variance: weights alone" in line


@pytest.mark.parametrize("names", ["layers/{}/vars", "layers\\{}\\vars"])
@pytest.mark.parametrize("container", ["layers", "_layer_checkpoint_dependencies"])
def test_keras_of_tensorflow_2(tmp_path: Path, names: str, container: str) -> None:
    """The .keras of TensorFlow 2.12 to 2.15, on Windows with backslashes."""
    model = {"class_name": "Sequential", "config": {"name": "sequential", "layers": CONFIGS}}
    weights = {
        "dense": NET[0],
        "batch_normalization": [NORM[ours] for ours in KERAS_NORM.values()],
        "dense_1": NET[1],
    }
    with h5py.File(tmp_path / "weights", "w") as file:
        for layer, values in weights.items():
            group = file.create_group(names.replace("layers", container).format(layer))
            for k, array in enumerate(values):
                group[str(k)] = array
    with zipfile.ZipFile(tmp_path / "net.keras", "w") as archive:
        archive.writestr("config.json", json.dumps(model))
        archive.write(tmp_path / "weights", "model.weights.h5")
    check_exported(tmp_path, tmp_path / "net.keras", expected())


def change_config(change: dict, number: int) -> dict:
    layers = json.loads(json.dumps(CONFIGS))
    layers[number]["config"] |= change
    return {"class_name": "Sequential", "config": {"name": "sequential", "layers": layers}}


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (change_config({"axis": [2]}, 2), "layer bn normalises axis [2], not the last"),
        (change_config({"epsilon": -1}, 2), "layer bn: epsilon is -1"),
        (change_config({"name": "other"}, 2), "layer other has no moving_"),
        (change_config({"name": "other"}, 1), "layer other has no weights, not bias and kernel"),
        (change_config({"use_bias": False}, 1), "layer dense has bias, kernel, not kernel"),
        (change_config({"activation": "elu"}, 1), "the activation elu: the C kernels apply ReLU"),
        (change_config({"activation": "relu"}, 3) | {"class_name": "Mine"}, "a model of class Min"),
        ({}, "not a readable .h5 file: KeyError"),
        ([], "not a readable .h5 file: "),
        ({"class_name": "Sequential", "config": {}}, "not a readable .h5 file: KeyError"),
    ],
)
def test_keras_2_refused(tmp_path: Path, capsys, config: dict, message: str) -> None:
    save_keras2(tmp_path / "net.h5", config)
    assert message in refused(tmp_path, capsys, tmp_path / "net.h5")


def test_archive_without_a_model(tmp_path: Path, capsys) -> None:
    with zipfile.ZipFile(tmp_path / "net.keras", "w") as archive:
        archive.writestr("config.json", "{}")
    line = refused(tmp_path, capsys, tmp_path / "net.keras")
    assert "holds no model.weights.h5: save by model.save('x.keras')" in line


def test_h5_of_something_else(tmp_path: Path, capsys) -> None:
    with h5py.File(tmp_path / "net.h5", "w") as file:
        file.create_group("frames").create_group("more")
    assert "holds no weights of Keras" in refused(tmp_path, capsys, tmp_path / "net.h5")
    with h5py.File(tmp_path / "net.h5", "w") as file:
        file["x"] = np.ones(3)
    assert "holds no layer x" in refused(tmp_path, capsys, tmp_path / "net.h5")
