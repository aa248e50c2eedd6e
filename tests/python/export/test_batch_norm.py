"""Batch normalisation is folded into the layers of state dicts and of .onnx, or refused with the
reason; what is exported computes what the network did."""

import warnings
from pathlib import Path

import numpy as np
import onnx
import pytest
from exports import check_exported, export, poses, refused, small_net
from onnx import TensorProto, helper, numpy_helper
from onnx.reference import ReferenceEvaluator
from safetensors.numpy import load_file, save_file

from export.chain import ExportWarning, Linear, Scale, fold
from export.layers import ExportError
from export.readers import READERS, read_layers

CASES = Path(__file__).parents[1] / "cases"
EPSILON = 1e-5
Norm = dict[str, np.ndarray]


def make_norm(units: int, seed: int = 9) -> Norm:
    """Batch normalisation as PyTorch names it, far from the identity; a scale is negative."""
    rng = np.random.default_rng(seed)
    gamma = rng.uniform(0.5, 1.5, units)
    gamma[0] = -gamma[0]
    norm = {
        "weight": gamma,
        "bias": rng.normal(0, 0.3, units),
        "running_mean": rng.normal(0, 0.5, units),
        "running_var": rng.uniform(0.2, 3, units),
    }
    return {name: values.astype(np.float32) for name, values in norm.items()}


def normalised(x: np.ndarray, norm: Norm, epsilon: float = EPSILON) -> np.ndarray:
    """The definition: (x - mean) / sqrt(var + epsilon) * gamma + beta."""
    unit = (x - norm["running_mean"]) / np.sqrt(norm["running_var"].astype(float) + epsilon)
    return unit * norm.get("weight", 1) + norm.get("bias", 0)


def linear(x: np.ndarray, layer: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    return x @ layer[0].astype(float) + layer[1]


def relu(x: np.ndarray) -> np.ndarray:
    return np.maximum(x, 0)


def module(name: str, values: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {f"{name}.{kind}": array for kind, array in values.items()}


def torch_linear(name: str, layer: tuple[np.ndarray, np.ndarray]) -> dict[str, np.ndarray]:
    """A Linear of a state dict."""
    return module(name, {"weight": np.ascontiguousarray(layer[0].T), "bias": layer[1]})


def torch_norm(name: str, norm: Norm) -> dict[str, np.ndarray]:
    """A BatchNorm1d of a state dict."""
    return module(name, norm) | {f"{name}.num_batches_tracked": np.array(7, np.int64)}


# ---- State dicts -------------------------------------------------------------------------------

# Names of layers, of the normalisation of 64 units, and where that stands.
PLACES = {
    "numbered alike": (("fc1", "fc2"), "bn1", "before the ReLU"),
    "blocks": (("blocks.0.linear", "blocks.1.linear"), "blocks.0.bn", "before the ReLU"),
    "lists": (("layers.0", "layers.1"), "norms.0", "before the ReLU"),
    "Sequential": (("net.0", "net.3"), "net.1", "before the ReLU"),
    "Sequential with dropout": (("net.0", "net.4"), "net.1", "before the ReLU"),
    "Sequential without a name": (("0", "3"), "1", "before the ReLU"),
    "nested Sequential": (("net.0.0", "net.1"), "net.0.1", "before the ReLU"),
    "Sequential of two digits": (("net.8", "net.11"), "net.10", "behind the ReLU"),
    "Sequential, behind the ReLU": (("net.0", "net.3"), "net.2", "behind the ReLU"),
}


@pytest.mark.parametrize("names", PLACES)
def test_state_dict(tmp_path: Path, names: str) -> None:
    (first, second), name, place = PLACES[names]
    net, norm = small_net(91, 64, 91), make_norm(64)
    state = torch_norm(name, norm) | torch_linear(first, net[0]) | torch_linear(second, net[1])
    save_file(state, tmp_path / "net.safetensors")
    hidden = linear(poses(), net[0])
    if place == "before the ReLU":
        hidden = relu(normalised(hidden, norm))
    else:
        hidden = normalised(relu(hidden), norm)
    with pytest.warns(ExportWarning, match=f"{name} is taken to stand b.*epsilon 1e-05"):
        check_exported(tmp_path, tmp_path / "net.safetensors", linear(hidden, net[1]))


def test_state_dict_that_begins_with_it(tmp_path: Path) -> None:
    net, norm = small_net(91, 64, 91), make_norm(91)
    state = torch_norm("0", norm) | torch_linear("1", net[0]) | torch_linear("3", net[1])
    save_file(state, tmp_path / "net.safetensors")
    expected = linear(relu(linear(normalised(poses(), norm), net[0])), net[1])
    with pytest.warns(ExportWarning, match="0 is taken to stand before 1"):
        check_exported(tmp_path, tmp_path / "net.safetensors", expected)


def test_state_dict_without_affine_and_bias(tmp_path: Path) -> None:
    """Linear(bias=False) and BatchNorm1d(affine=False)."""
    net, norm = small_net(91, 64, 91), make_norm(64)
    del norm["weight"], norm["bias"]
    state = torch_norm("bn1", norm) | torch_linear("fc1", net[0]) | torch_linear("fc2", net[1])
    del state["fc1.bias"]
    save_file(state, tmp_path / "net.safetensors")
    hidden = relu(normalised(poses() @ net[0][0].astype(float), norm))
    with pytest.warns(ExportWarning):
        check_exported(tmp_path, tmp_path / "net.safetensors", linear(hidden, net[1]))


def test_what_is_taken_for_granted_is_said(tmp_path: Path, capsys) -> None:
    status, _ = export(tmp_path, CASES / "weights_batch_norm.safetensors")
    printed = capsys.readouterr()
    assert status == 0
    assert printed.out.count("\n") == 1
    assert printed.err.count("\n") == 1
    assert "bn1 is taken to stand between fc1 and its ReLU, with epsilon 1e-05" in printed.err


@pytest.mark.parametrize(
    ("names", "norm", "message"),
    [
        (("fc1", "fc2"), "norm", "norm: its name does not say which layer it stands next to"),
        (("fc1", "fc2"), "bn3", "save the network as .onnx"),
        (("net.0", "net.4"), "net.2", "net.2: its name does not say"),
        (("net.2", "net.4"), "net.0", "net.0: its name does not say"),
    ],
)
def test_place_that_names_do_not_tell(
    tmp_path: Path, capsys, names: tuple[str, str], norm: str, message: str
) -> None:
    net = small_net(91, 64, 91)
    state = torch_linear(names[0], net[0]) | torch_linear(names[1], net[1])
    save_file(state | torch_norm(norm, make_norm(64)), tmp_path / "net.safetensors")
    assert message in refused(tmp_path, capsys, tmp_path / "net.safetensors")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bn1.running_var": None}, "unsupported tensor bn1.running_mean without the other"),
        ({"bn1.running_mean": None}, "unsupported tensor bn1.running_var without the other"),
        ({"bn1.running_var": -np.ones(64)}, "bn1: variance is -1"),
        ({"bn1.running_var": np.full(64, np.nan)}, "bn1: variance[0] is nan"),
        ({"bn1.running_mean": np.ones(63)}, "bn1: statistics of 63 and 64 units"),
        ({"bn1.weight": np.ones((64, 1))}, "bn1: scale has 2 dimensions, not 1"),
        ({"bn1.weight": np.ones(64, np.int32)}, "bn1: scale is of type int32"),
        (
            {"bn1.weight": np.full(64, 3e38), "bn1.running_var": np.zeros(64)},
            "layer 0: weight[0, 0] is",
        ),
        ({"ln1.weight": np.ones(64), "ln1.bias": np.ones(64)}, "layer normalisation depends on"),
        ({"act.weight": np.ones(1)}, "layer act has no bias: a PReLU cannot run, train with ReLU"),
        ({"fc1.weight": np.ones((32, 91)), "fc1.bias": np.ones(32)}, "bn1 is of 64 units, not"),
        ({"fc1.weight": np.ones((64, 91, 1))}, "weight has 3 dimensions, not 2"),
        ({"fc2.bias": None}, "layer fc2 has no bias"),
    ],
)
def test_state_dict_refused(tmp_path: Path, capsys, change: dict, message: str) -> None:
    net = small_net(91, 64, 91)
    state = torch_linear("fc1", net[0]) | torch_linear("fc2", net[1])
    state |= torch_norm("bn1", make_norm(64)) | change
    path = tmp_path / "net.safetensors"
    save_file({name: array for name, array in state.items() if array is not None}, path)
    assert message in refused(tmp_path, capsys, path)


def test_plain_layers_are_not_touched(tmp_path: Path) -> None:
    """-0 is kept: folding leaves alone what has nothing to fold."""
    net = small_net(91, 64, 91)
    net[0][0][0, 0] = -0.0
    save_file(torch_linear("fc1", net[0]) | torch_linear("fc2", net[1]), tmp_path / "a.safetensors")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        layers = read_layers(tmp_path / "a.safetensors")
    assert [layer.weight.tobytes() for layer in layers] == [weight.tobytes() for weight, _ in net]


# ---- ONNX --------------------------------------------------------------------------------------


class Onnx:
    """Writes a chain of nodes with its constants."""

    def __init__(self) -> None:
        self.nodes, self.tensors, self.value = [], [], "x"

    def add(self, kind: str, *constants: np.ndarray, first: bool = False, **attributes) -> "Onnx":
        """A node behind the last one; first: its constant is the first operand."""
        names = [f"c{len(self.tensors) + k}" for k in range(len(constants))]
        for name, values in zip(names, constants, strict=True):
            self.tensors.append(numpy_helper.from_array(values, name))
        operands = [*names, self.value] if first else [self.value, *names]
        self.value = f"v{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, operands, [self.value], **attributes))
        return self

    def gemm(self, layer: tuple[np.ndarray, np.ndarray]) -> "Onnx":
        return self.add("Gemm", np.ascontiguousarray(layer[0].T), layer[1], transB=1)

    def norm(self, norm: Norm, **attributes) -> "Onnx":
        return self.add("BatchNormalization", *norm.values(), **attributes)

    def save(self, path: Path) -> onnx.ModelProto:
        ends = [
            helper.make_tensor_value_info(name, TensorProto.FLOAT, ["n", 91])
            for name in ("x", self.value)
        ]
        graph = helper.make_graph(self.nodes, "net", ends[:1], ends[1:], self.tensors)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)])
        onnx.save(model, path)
        return model


def by_onnx(model: onnx.ModelProto) -> np.ndarray:
    """What ONNX's own reference makes of poses()."""
    onnx.checker.check_model(model)
    return ReferenceEvaluator(model).run(None, {"x": poses()})[0].reshape(-1, 91)


NET = small_net(91, 64, 91)
SCALES = make_norm(64, 3)
CHAINS = {
    "behind a layer": lambda o: o.gemm(NET[0]).norm(make_norm(64)).add("Relu").gemm(NET[1]),
    "own epsilon": lambda o: (
        o.gemm(NET[0]).norm(make_norm(64), epsilon=0.5).add("Relu").gemm(NET[1])
    ),
    "behind a ReLU": lambda o: o.gemm(NET[0]).add("Relu").norm(make_norm(64)).gemm(NET[1]),
    "first": lambda o: o.norm(make_norm(91)).gemm(NET[0]).add("Relu").gemm(NET[1]),
    "everywhere": lambda o: (
        o.norm(make_norm(91))
        .add("Identity")
        .gemm(NET[0])
        .norm(make_norm(64))
        .add("Relu")
        .norm(make_norm(64, 2))
        .add("Dropout")
        .norm(make_norm(64, 4))
        .gemm(NET[1])
        .norm(make_norm(91, 5))
        .add("Relu")
    ),
    "MatMul, Add": lambda o: (
        o.add("MatMul", NET[0][0])
        .add("Add", NET[0][1])
        .norm(make_norm(64))
        .add("Relu")
        .gemm(NET[1])
    ),
    "MatMul without Add": lambda o: (
        o.add("MatMul", NET[0][0]).norm(make_norm(64)).add("Relu").gemm(NET[1])
    ),
    "rows": lambda o: (
        o.add("Flatten")
        .gemm(NET[0])
        .add("Reshape", np.array([-1, 64]))
        .norm(make_norm(64))
        .add("Relu")
        .add("Flatten", axis=1)
        .gemm(NET[1])
    ),
    "arithmetic": lambda o: (
        o.add("Sub", make_norm(91)["running_mean"])
        .add("Div", make_norm(91)["running_var"][None])
        .gemm(NET[0])
        .add("Mul", SCALES["weight"], first=True)
        .add("Add", SCALES["bias"])
        .add("Relu")
        .add("Mul", np.array(0.5, np.float32))
        .gemm(NET[1])
    ),
}


@pytest.mark.parametrize("chain", CHAINS)
def test_onnx(tmp_path: Path, chain: str) -> None:
    expected = by_onnx(CHAINS[chain](Onnx()).save(tmp_path / "net.onnx"))
    in_c = chain == "everywhere"
    check_exported(tmp_path, tmp_path / "net.onnx", expected, in_c)


@pytest.mark.parametrize(
    ("chain", "message"),
    [
        (
            lambda o: o.gemm(NET[0]).add("Relu").gemm(NET[1]).add("Relu").norm(make_norm(91)),
            "BatchNormalization of v4 cannot be folded: it has no layer before it and no layer",
        ),
        (
            lambda o: o.norm(make_norm(91)).add("Relu").gemm(NET[0]).add("Relu").gemm(NET[1]),
            "BatchNormalization of v0 cannot be folded: it has no layer before it and a ReLU",
        ),
        (lambda o: o.gemm(NET[0]).add("LeakyRelu").gemm(NET[1]), "LeakyRelu: the C kernels apply"),
        (lambda o: o.gemm(NET[0]).add("Tanh").gemm(NET[1]), "Tanh: the C kernels apply ReLU and"),
        (lambda o: o.gemm(NET[0]).add("Softmax").gemm(NET[1]), "no other activation; train with"),
        (
            lambda o: (
                o.gemm(NET[0]).add("LayerNormalization", SCALES["weight"]).add("Relu").gemm(NET[1])
            ),
            "LayerNormalization: it depends on each input and cannot be folded",
        ),
        (
            lambda o: o.gemm(NET[0]).add("Div", np.zeros(64, np.float32)).add("Relu").gemm(NET[1]),
            "Div of v1 divides by 0",
        ),
        (
            lambda o: o.gemm(NET[0]).add("Mul", np.ones((2, 64), np.float32)).gemm(NET[1]),
            "Mul of v1 is not one number for each unit",
        ),
        (lambda o: o.gemm(NET[0]).add("Flatten", axis=0).add("Relu"), "has axis 0, not 1"),
        (
            lambda o: o.gemm(NET[0]).add("Reshape", np.array([-1, 32])).add("Relu").gemm(NET[1]),
            "Reshape of v1 is to [-1, 32], not to a row for each person",
        ),
        (
            lambda o: o.gemm(NET[0]).norm(make_norm(64), training_mode=1).add("Relu").gemm(NET[1]),
            "BatchNormalization of v1 is in training: export the network in evaluation mode",
        ),
        (
            lambda o: o.gemm(NET[0]).add("Dropout", np.array(0.5, np.float32), np.array(True)),
            "Dropout of v1 is in training",
        ),
        (lambda o: o.gemm(NET[0]).add("Transpose").gemm(NET[1]), "unsupported ONNX operator Trans"),
    ],
)
def test_onnx_refused(tmp_path: Path, capsys, chain, message: str) -> None:
    chain(Onnx()).save(tmp_path / "net.onnx")
    assert message in refused(tmp_path, capsys, tmp_path / "net.onnx")


# ---- Folding -----------------------------------------------------------------------------------


def test_a_scale_of_one_number() -> None:
    one = Scale(np.array([2.0]), np.array([1.0]), "scale")
    weight, bias = np.eye(3)[:, :2], np.zeros(2)
    [behind] = fold([Linear(weight, bias), one])
    assert np.array_equal(behind.weight, 2 * weight) and np.array_equal(behind.bias, [1, 1])
    [before] = fold([one, one, Linear(weight, bias)])
    assert np.array_equal(before.weight, 4 * weight) and np.array_equal(before.bias, [3, 3])
    three = Scale(np.ones(3), np.zeros(3), "three")
    with pytest.raises(ExportError, match="three is of 3 units, not of 1"):
        fold([Linear(np.ones((4, 1)), np.zeros(1)), three])


# ---- The files that users brought --------------------------------------------------------------

BROUGHT = {
    "weights_plain.safetensors": None,
    "weights_batch_norm.safetensors": None,
    "weights_batch_norm.onnx": None,
    "weights_keras.h5": None,
    "weights_leaky_relu.onnx": "unsupported ONNX operator LeakyRelu: the C kernels apply ReLU "
    "and no other activation; train with ReLU",
    "weights_of_coordinates.safetensors": "layer 0 takes 28 values, the image gives 91, and the "
    "last gives 42: no kernel runs a network from coordinates to coordinates; train one from "
    "distances to distances, or the kind `direct` (docs/own-weights.md)",
    "weights_empty.tflite": "holds 0 networks, not one",
}


def test_every_file_has_a_line() -> None:
    assert {path.name for path in CASES.glob("weights_*")} == set(BROUGHT)


@pytest.mark.filterwarnings("ignore::export.chain.ExportWarning")
@pytest.mark.parametrize("name", BROUGHT)
def test_file_that_users_bring(tmp_path: Path, capsys, name: str) -> None:
    message = BROUGHT[name]
    if message is not None:
        line = refused(tmp_path, capsys, CASES / name)
        assert line == f"export_weights: {CASES / name}: {message}\n"
        return
    status, header = export(tmp_path, CASES / name)
    assert status == 0
    assert "91-64-91, relu after each" in header.read_text()


@pytest.mark.filterwarnings("ignore::export.chain.ExportWarning")
@pytest.mark.parametrize("name", ["weights_batch_norm.safetensors", "weights_batch_norm.onnx"])
def test_batch_norm_that_users_bring(tmp_path: Path, name: str) -> None:
    """What the exported network computes in C is what the file's does by the definition."""
    if name.endswith("onnx"):
        expected = by_onnx(onnx.load(CASES / name))
    else:
        state = load_file(CASES / name)
        norm = {kind: state[f"bn1.{kind}"] for kind in make_norm(1)}
        first, second = ((state[f"fc{k}.weight"].T, state[f"fc{k}.bias"]) for k in (1, 2))
        expected = linear(relu(normalised(linear(poses(), first), norm)), second)
    check_exported(tmp_path, CASES / name, expected, in_c=True)


def test_readers_know_what_the_help_says() -> None:
    assert set(READERS) >= {".npz", ".safetensors", ".pt", ".onnx", ".keras", ".h5", ".tflite"}
