"""TFLite networks of float numbers are exported; others are refused with the reason."""

from collections.abc import Callable
from pathlib import Path

import flatbuffers
import numpy as np
import pytest
import tflite
from exports import check_exported, poses, refused, small_net
from test_batch_norm import linear, make_norm, normalised, relu

from export.layers import ExportError
from export.readers import read_layers

NET, NORM = small_net(91, 64, 91), make_norm(64)
TYPES = {"float32": tflite.TensorType.FLOAT32, "float16": tflite.TensorType.FLOAT16}
TYPES |= {"int8": tflite.TensorType.INT8, "int32": tflite.TensorType.INT32}


class Model:
    """A model of one graph, an operator behind the other, as TFLite's converter writes it."""

    def __init__(self, width: int = 91, kind: str = "float32") -> None:
        self.tensors: list[tuple] = []  # shape, type, values
        self.operators: list[tuple] = []  # name, inputs, output, options
        self.value = self.tensor((1, width), kind)

    def tensor(self, shape: tuple, kind: str, values: np.ndarray | None = None) -> int:
        self.tensors.append((shape, kind, values))
        return len(self.tensors) - 1

    def constant(self, values: np.ndarray) -> int:
        return self.tensor(values.shape, values.dtype.name, values)

    def add(
        self, name: str, *constants: int, width: int, kind: str = "float32", **options: int
    ) -> "Model":
        """An operator on the last value and constants."""
        inputs = [self.value, *constants]
        self.value = self.tensor((1, width), kind)
        self.operators.append((name, inputs, self.value, options))
        return self

    def dense(self, layer: tuple, fused: int = 0, half: bool = False) -> "Model":
        weight = self.constant(np.ascontiguousarray(layer[0].T).astype("f2" if half else "f4"))
        if half:
            wide = self.tensor(layer[0].T.shape, "float32")
            self.operators.append(("DEQUANTIZE", [weight], wide, {}))
            weight = wide
        bias = -1 if layer[1] is None else self.constant(layer[1])
        width = layer[0].shape[1]
        options = {"FusedActivationFunction": fused}
        return self.add("FULLY_CONNECTED", weight, bias, width=width, **options)

    # ---- The flatbuffer

    def save(self, path: Path) -> Path:
        b = flatbuffers.Builder(0)
        buffers = [self.table(b, "Buffer")]  # buffer 0 is empty
        tensors = []
        for shape, kind, values in self.tensors:
            number = 0
            if values is not None:
                data = b.CreateByteVector(values.tobytes())
                number = len(buffers)
                buffers.append(self.table(b, "Buffer", Data=data))
            name = b.CreateString(f"t{len(tensors)}")
            fields = {"Shape": b.CreateNumpyVector(np.array(shape, np.int32)), "Name": name}
            tensors.append(self.table(b, "Tensor", Type=TYPES[kind], Buffer=number, **fields))
        names = sorted({name for name, *_ in self.operators})
        codes = [self.code(b, name) for name in names]
        operators = [self.operator(b, names, *operator) for operator in self.operators]
        graph = self.table(
            b,
            "SubGraph",
            Tensors=self.vector(b, tensors),
            Inputs=b.CreateNumpyVector(np.array([0], np.int32)),
            Outputs=b.CreateNumpyVector(np.array([self.value], np.int32)),
            Operators=self.vector(b, operators),
        )
        model = self.table(
            b,
            "Model",
            Version=3,
            OperatorCodes=self.vector(b, codes),
            Subgraphs=self.vector(b, [graph]),
            Buffers=self.vector(b, buffers),
        )
        b.Finish(model, b"TFL3")
        path.write_bytes(bytes(b.Output()))
        return path

    @staticmethod
    def table(b: flatbuffers.Builder, kind: str, **fields: int) -> int:
        getattr(tflite, f"{kind}Start")(b)
        for name, value in fields.items():
            getattr(tflite, f"{kind}Add{name}")(b, value)
        return getattr(tflite, f"{kind}End")(b)

    @staticmethod
    def vector(b: flatbuffers.Builder, items: list[int]) -> int:
        b.StartVector(4, len(items), 4)
        for item in reversed(items):
            b.PrependUOffsetTRelative(item)
        return b.EndVector()

    def code(self, b: flatbuffers.Builder, name: str) -> int:
        number = getattr(tflite.BuiltinOperator, name)
        old = min(number, 127)
        return self.table(b, "OperatorCode", DeprecatedBuiltinCode=old, BuiltinCode=number)

    def operator(
        self,
        b: flatbuffers.Builder,
        names: list,
        name: str,
        inputs: list,
        output: int,
        options: dict,
    ) -> int:
        fields = {
            "OpcodeIndex": names.index(name),
            "Inputs": b.CreateNumpyVector(np.array(inputs, np.int32)),
            "Outputs": b.CreateNumpyVector(np.array([output], np.int32)),
        }
        if options:
            kind = {"FULLY_CONNECTED": "FullyConnected"}.get(name, name.capitalize()) + "Options"
            fields["BuiltinOptions"] = self.table(b, kind, **options)
            fields["BuiltinOptionsType"] = getattr(tflite.BuiltinOptions, kind)
        return self.table(b, "Operator", **fields)


# ---- What is exported --------------------------------------------------------------------------

RELU = tflite.ActivationFunctionType.RELU


def plain() -> Model:
    return Model().dense(NET[0], RELU).dense(NET[1])


def arithmetic() -> Model:
    """What the converter makes of batch normalisation behind a ReLU."""
    scale = NORM["weight"] / np.sqrt(NORM["running_var"] + 1e-5)
    shift = NORM["bias"] - NORM["running_mean"] * scale
    m = Model().dense(NET[0]).add("RELU", width=64)
    m.add("MUL", m.constant(scale[None].astype("f4")), width=64, FusedActivationFunction=0)
    m.add("ADD", m.constant(shift.astype("f4")), width=64)
    return m.dense(NET[1], RELU)


def reshaped() -> Model:
    m = Model()
    m.tensors[0] = ((1, 7, 13), "float32", None)
    m.add("RESHAPE", m.constant(np.array([-1, 91], np.int32)), width=91)
    return m.dense(NET[0], RELU).dense(NET[1])


HALF = [(weight.astype("f2").astype("f4"), bias) for weight, bias in NET]


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (plain, lambda x: linear(relu(linear(x, NET[0])), NET[1])),
        (arithmetic, lambda x: linear(normalised(relu(linear(x, NET[0])), NORM), NET[1])),
        (reshaped, lambda x: linear(relu(linear(x, NET[0])), NET[1])),
        (
            lambda: Model().dense(NET[0], RELU, half=True).dense(NET[1], half=True),
            lambda x: linear(relu(linear(x, HALF[0])), HALF[1]),
        ),
        (
            lambda: Model().dense((NET[0][0], None), RELU).dense(NET[1]),
            lambda x: linear(relu(x @ NET[0][0]), NET[1]),
        ),
    ],
    ids=["plain", "batch normalisation", "reshaped", "float16", "no bias"],
)
def test_exported(tmp_path: Path, make: Callable, expected: Callable) -> None:
    path = make().save(tmp_path / "net.tflite")
    check_exported(tmp_path, path, expected(poses()), in_c=make is arithmetic)


def test_the_runtime_computes_the_same(tmp_path: Path) -> None:
    """LiteRT, where it is installed: what the tests write are models that it takes."""
    interpreter = pytest.importorskip("ai_edge_litert.interpreter")
    for make in (plain, arithmetic):
        run = interpreter.Interpreter(str(make().save(tmp_path / "net.tflite")))
        run.allocate_tensors()
        for x in poses():
            run.set_tensor(run.get_input_details()[0]["index"], x[None])
            run.invoke()
            y, values = run.get_tensor(run.get_output_details()[0]["index"])[0], x.astype(float)
            for weight, bias in read_layers(tmp_path / "net.tflite"):
                values = relu(values @ weight + bias)
            assert np.allclose(values, relu(y), rtol=1e-4, atol=1e-5)


# ---- What is refused ---------------------------------------------------------------------------


def changed(number: int, change: tuple) -> Model:
    """plain() with a tensor exchanged."""
    model = plain()
    model.tensors[number] = change
    return model


def sparse_order() -> Model:
    """An operator that does not follow on the last one."""
    model = plain()
    model.operators[1][1][0] = 0
    return model


QUANTISED = "a quantised network rounds after each layer, which float weights do not; convert"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Model(kind="int8").dense(NET[0], RELU).dense(NET[1]), f"is of INT8: {QUANTISED}"),
        (
            lambda: changed(1, ((64, 91), "int8", np.zeros((64, 91), np.int8))),
            f"t1 is of INT8: {QUANTISED}",
        ),
        (lambda: Model().add("QUANTIZE", width=91, kind="int8"), f"QUANTIZE of t1: {QUANTISED}"),
        (lambda: Model().dense(NET[0], 3).dense(NET[1]), "the activation RELU6: the C kernels"),
        (lambda: Model().dense(NET[0], 4).dense(NET[1]), "the activation TANH: the C kernels"),
        (
            lambda: Model().dense(NET[0]).add("LEAKY_RELU", width=64).dense(NET[1]),
            "unsupported TFLite operator LEAKY_RELU: the C kernels apply ReLU and no other",
        ),
        (
            lambda: Model().dense(NET[0]).add("LOGISTIC", width=64).dense(NET[1]),
            "unsupported TFLite operator LOGISTIC: the C kernels apply ReLU and no other",
        ),
        (lambda: Model().add("CONV_2D", width=91), "operator CONV_2D: not a fully connected layer"),
        (lambda: Model().add("GELU", width=91), "operator GELU: the C kernels apply ReLU"),
        (lambda: Model(28).dense((np.ones((28, 91), "f4"), None)), "takes 28 values, the image"),
        (sparse_order, "FULLY_CONNECTED of t6 does not follow on t3: layers must follow each"),
        (
            lambda: changed(1, ((64, 91), "float32", np.zeros(5, np.float32))),
            "t1 has 20 bytes, which are not [64, 91] of float32",
        ),
        (
            lambda: changed(1, ((2**31 - 1, 2**31 - 1), "float32", np.zeros(5, np.float32))),
            "t1 has 20 bytes, which are not",
        ),
        (lambda: changed(1, ((-64, -91), "float32", NET[0][0])), "which are not [-64, -91]"),
        (lambda: changed(1, ((64, 91), "float32", None)), "t1 is not a constant"),
        (
            lambda: Model().dense(NET[0], RELU).add("RESHAPE", width=32).dense(NET[1]),
            "RESHAPE of t4 is to [1, 32], not to a row for each person",
        ),
        (lambda: Model().dense(NET[0], RELU).add("ADD", 0, width=64), "t0 is not a constant"),
        (lambda: Model().dense(NET[0], RELU).add("ADD", 99, width=64), "names tensor 99 of 5"),
    ],
)
def test_refused(tmp_path: Path, capsys, make: Callable, message: str) -> None:
    assert message in refused(tmp_path, capsys, make().save(tmp_path / "net.tflite"))


def test_without_its_mark(tmp_path: Path, capsys) -> None:
    path = plain().save(tmp_path / "net.tflite")
    path.write_bytes(path.read_bytes().replace(b"TFL3", b"NONE"))
    assert "its mark TFL3 is missing" in refused(tmp_path, capsys, path)


def test_damaged(tmp_path: Path, capsys) -> None:
    """Any byte of what is no weight, and the file cut off anywhere: one line, or an export."""
    whole = bytearray(plain().save(tmp_path / "whole").read_bytes())
    rng, path = np.random.default_rng(8), tmp_path / "net.tflite"
    (tmp_path / "whole").unlink()
    for length in rng.integers(8, len(whole) - 8, 40):
        path.write_bytes(whole[:length])
        refused(tmp_path, capsys, path)
    tables = len(whole) - 2500  # behind the weights of the first layers
    for at in [*range(4, 400, 7), *rng.integers(tables, len(whole), 60)]:
        damaged = bytearray(whole)
        damaged[at] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        try_to_read(path)


def try_to_read(path: Path) -> None:
    """Reads a file whose numbers may be anything."""
    try:
        read_layers(path)
    except ExportError as error:
        assert "\n" not in str(error)
