"""Reads .tflite (TensorFlow Lite, LiteRT): networks of float numbers, fully connected."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from export.chain import RELU, Linear, Step, constant, why_not
from export.layers import ExportError
from export.read_onnx import check_row, scale_of

MAGIC = slice(4, 8)


def read_tflite(path: Path) -> list[Step]:
    """The chain from the only input to the only output."""
    import tflite

    data = path.read_bytes()
    if data[MAGIC] != b"TFL3":
        raise ExportError("not a readable .tflite file: its mark TFL3 is missing")
    model = tflite.Model.GetRootAs(data, 0)
    if model.SubgraphsLength() != 1:
        raise ExportError(f"holds {model.SubgraphsLength()} networks, not one")
    return Graph(model).steps()


class Graph:
    """The only graph of a model."""

    def __init__(self, model: Any) -> None:
        import tflite

        self.model, self.graph = model, model.Subgraphs(0)
        self.operators = names_of(tflite.BuiltinOperator)
        self.types = names_of(tflite.TensorType)
        self.activations = names_of(tflite.ActivationFunctionType)
        self.widened: dict[int, np.ndarray] = {}  # tensors that DEQUANTIZE makes of constants

    def steps(self) -> list[Step]:
        """What the operators do, one after the other."""
        graph = self.graph
        if (graph.InputsLength(), graph.OutputsLength()) != (1, 1):
            raise ExportError(
                f"the graph has {graph.InputsLength()} inputs and {graph.OutputsLength()} "
                "outputs, not one of each"
            )
        value, steps = graph.Inputs(0), list[Step]()
        self.check_float(value)
        for k in range(graph.OperatorsLength()):
            operator = graph.Operators(k)
            kind = self.kind_of(operator)
            if operator.OutputsLength() != 1 or operator.InputsLength() < 1:
                raise ExportError(f"{kind} has {operator.OutputsLength()} outputs, not one")
            if kind == "DEQUANTIZE" and self.is_constant(operator.Inputs(0)):
                self.widened[operator.Outputs(0)] = self.half(operator.Inputs(0))
                continue
            steps += self.steps_of(operator, kind, value, steps)
            value = operator.Outputs(0)
            self.check_float(value)
        if value != graph.Outputs(0):
            raise ExportError("the graph does not end with the chain's last value")
        return steps

    def kind_of(self, operator: Any) -> str:
        """An operator's name."""
        code = self.model.OperatorCodes(operator.OpcodeIndex())
        number = max(code.BuiltinCode(), code.DeprecatedBuiltinCode())
        return self.operators.get(number, f"number {number}")

    def steps_of(self, operator: Any, kind: str, value: int, before: Sequence[Step]) -> list[Step]:
        """What an operator does to the chain's value."""
        import tflite

        name = f"{kind} of {self.name_of(operator.Outputs(0))}"
        if kind not in ("FULLY_CONNECTED", "RELU", "RESHAPE", *ARITHMETIC):
            if kind in ("QUANTIZE", "DEQUANTIZE"):
                raise ExportError(f"{name}: {QUANTISED}")
            raise ExportError(f"unsupported TFLite operator {kind}: {why_not(kind)}")
        operands = self.operands_of(operator, kind, value, name)
        if kind == "RELU":
            return [RELU]
        if kind == "RESHAPE":
            shape = self.graph.Tensors(operator.Outputs(0)).ShapeAsNumpy()
            check_row(np.asarray(shape).reshape(-1).tolist(), before, name)
            return []
        table = operator.BuiltinOptions()
        options = getattr(tflite, OPTIONS[kind])()
        if table is not None:
            options.Init(table.Bytes, table.Pos)
        fused = options.FusedActivationFunction() if table is not None else 0
        if kind == "FULLY_CONNECTED":
            if table is not None and options.WeightsFormat():
                raise ExportError(f"{name} has shuffled weights; convert without")
            step: Step = self.dense(operands, name)
        else:
            step = scale_of(ARITHMETIC[kind], constant(operands[0], name), name)
        return [step, *self.fused_steps(fused, name)]

    def operands_of(self, operator: Any, kind: str, value: int, name: str) -> list[np.ndarray]:
        """An operator's constants; its other input must be the chain's value so far."""
        given = [operator.Inputs(k) for k in range(operator.InputsLength())]
        given = [index for index in given if index >= 0]  # -1: left out
        others = [index for index in given if index != value]
        follows = kind in ("ADD", "MUL") or given[:1] == [value]
        if len(others) != len(given) - 1 or not follows:
            raise ExportError(
                f"{name} does not follow on {self.name_of(value)}: "
                "layers must follow each other, without branches"
            )
        return [] if kind == "RESHAPE" else [self.values(index) for index in others]

    def dense(self, operands: Sequence[np.ndarray], name: str) -> Linear:
        """Weights [out, in] and bias, which is 0 where there is none."""
        if len(operands) not in (1, 2) or operands[0].ndim != 2:
            raise ExportError(f"{name} has no weights of two dimensions")
        weight = operands[0].T
        none = np.zeros(weight.shape[1], np.float32)
        return Linear(weight, operands[1].reshape(-1) if len(operands) > 1 else none)

    def fused_steps(self, fused: int, name: str) -> list[Step]:
        """What an operator does behind its sums."""
        kind = self.activations.get(fused, f"number {fused}")
        if kind not in ("NONE", "RELU"):
            raise ExportError(f"{name} has the activation {kind}: {why_not(kind)}")
        return [RELU] if kind == "RELU" else []

    # ---- Tensors

    def name_of(self, index: int) -> str:
        """A tensor's name."""
        name = self.tensor(index).Name()
        return name.decode("utf-8", "replace") if name else f"tensor {index}"

    def tensor(self, index: int) -> Any:
        """A tensor, which must be one of the graph's."""
        if not 0 <= index < self.graph.TensorsLength():
            raise ExportError(f"names tensor {index} of {self.graph.TensorsLength()}")
        return self.graph.Tensors(index)

    def check_float(self, index: int) -> None:
        """Raises ExportError unless a tensor holds float32."""
        kind = self.types.get(self.tensor(index).Type(), "?")
        if kind != "FLOAT32":
            raise ExportError(f"{self.name_of(index)} is of {kind}: {QUANTISED}")

    def is_constant(self, index: int) -> bool:
        """Has a tensor its values in the file?"""
        return self.bytes_of(index) is not None

    def bytes_of(self, index: int) -> np.ndarray | None:
        """The bytes of a tensor's values, or None."""
        number = self.tensor(index).Buffer()
        if not 0 <= number < self.model.BuffersLength():
            raise ExportError(f"{self.name_of(index)} lies in buffer {number}, which is missing")
        buffer = self.model.Buffers(number)
        return None if buffer.DataIsNone() or not buffer.DataLength() else buffer.DataAsNumpy()

    def values(self, index: int) -> np.ndarray:
        """A constant in float32."""
        if index in self.widened:
            return self.widened[index]
        self.check_float(index)
        return self.array(index, np.dtype("<f4"))

    def half(self, index: int) -> np.ndarray:
        """A constant that is kept in 16 bits, which float32 holds exactly."""
        kind = self.types.get(self.tensor(index).Type(), "?")
        if kind != "FLOAT16":
            raise ExportError(f"{self.name_of(index)} is of {kind}: {QUANTISED}")
        return self.array(index, np.dtype("<f2")).astype(np.float32)

    def array(self, index: int, dtype: np.dtype) -> np.ndarray:
        """A constant in the type that it is of."""
        tensor, data = self.tensor(index), self.bytes_of(index)
        name = self.name_of(index)
        if data is None:
            raise ExportError(f"{name} is not a constant")
        if tensor.Sparsity() is not None:
            raise ExportError(f"{name} is sparse: convert without sparsity")
        shape = [tensor.Shape(k) for k in range(tensor.ShapeLength())]
        if min(shape, default=1) < 0 or math.prod(shape) * dtype.itemsize != len(data):
            raise ExportError(f"{name} has {len(data)} bytes, which are not {shape} of {dtype}")
        return np.frombuffer(data.tobytes(), dtype).reshape(shape)


ARITHMETIC = {"ADD": "Add", "SUB": "Sub", "MUL": "Mul", "DIV": "Div"}
OPTIONS = {
    "FULLY_CONNECTED": "FullyConnectedOptions",
    "ADD": "AddOptions",
    "SUB": "SubOptions",
    "MUL": "MulOptions",
    "DIV": "DivOptions",
}
QUANTISED = (
    "a quantised network rounds after each layer, which float weights do not; convert without "
    "converter.optimizations and quantise here, by --quantise"
)


def names_of(numbers: type) -> dict[int, str]:
    """The names of an enumeration's numbers."""
    return {value: name for name, value in vars(numbers).items() if isinstance(value, int)}
