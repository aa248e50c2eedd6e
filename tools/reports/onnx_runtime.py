"""How fast ONNX Runtime runs the float network of a model on one core.

    run.py reports.onnx_runtime [--model distances]

One at a time, which is mostly the call from Python, and a thousand at a time.  What it gives is
first compared with what the oracle gives.  Needs tools/requirements-bench.txt; part of tools/bench.
"""

import argparse
import sys
import time
from collections.abc import Callable

import numpy as np

from data.paths import GEN
from model import reference
from model.layout import KINDS, Layout, layout
from reports import markdown

BATCH, CALLS, ROUNDS = 1000, 2000, 5
CLOSE = 1e-4


def network(layers: reference.Layers, inputs: Layout) -> bytes:
    """The network as an ONNX model: from [N,inputs] to rows, then mirror rows, [N,2*rows]."""
    import onnx
    from onnx import TensorProto, helper, numpy_helper

    nodes, numbers = [], []

    def number(name: str, values: np.ndarray) -> str:
        numbers.append(numpy_helper.from_array(values, name))
        return name

    def add(operator: str, *names: str, to: str) -> str:
        nodes.append(helper.make_node(operator, names, [to]))
        return to

    split = number("split", np.array([inputs.even, inputs.odd], np.int64))
    nodes.append(helper.make_node("Split", ["x", split], ["even", "odd"], axis=1))
    even, odd, count = "even", "odd", inputs.even
    for n, (weight, bias) in enumerate(layers):
        e, o = number(f"e{n}", weight[:count]), number(f"o{n}", weight[count:])
        p = add("Gemm", even, e, number(f"b{n}", bias), to=f"p{n}")
        q = add("MatMul", odd, o, to=f"q{n}")
        both = [add(how, p, q, to=f"{how}{n}") for how in ("Add", "Sub")]
        if n < len(layers) - 1:
            both = [add("Relu", sums, to=f"Relu{sums}") for sums in both]
            even, odd = (add(how, *both, to=f"{how}Of{n}") for how in ("Add", "Sub"))
            count = len(bias)
    nodes.append(helper.make_node("Concat", both, ["out"], axis=1))
    ends = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, ["N", width])
        for name, width in (("x", inputs.even + inputs.odd), ("out", 2 * len(layers[-1][1])))
    ]
    graph = helper.make_graph(nodes, "edmlift", ends[:1], ends[1:], numbers)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    onnx.checker.check_model(model)
    return model.SerializeToString()


def session_of(model: bytes) -> Callable[[np.ndarray], np.ndarray]:
    """The model on one core."""
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    session = onnxruntime.InferenceSession(model, options, ["CPUExecutionProvider"])
    return lambda x: session.run(None, {"x": x})[0]


def rate(run: Callable[[np.ndarray], np.ndarray], x: np.ndarray, calls: int) -> float:
    """Rows of x [N,inputs] a second, the best of some rounds."""
    best = 0.0
    for _ in range(ROUNDS):
        start = time.process_time()
        for _ in range(calls):
            run(x)
        best = max(best, len(x) * calls / (time.process_time() - start))
    return best


def measure(model: str) -> dict[str, float]:
    """Networks a second, by how many go in at a time; ValueError if it gives something else."""
    layers, inputs = reference.read_model(GEN / f"{model}.npz").layers, layout(model)
    run = session_of(network(layers, inputs))
    width = inputs.even + inputs.odd
    x = np.random.default_rng(0).normal(0, 1, (BATCH, width)).astype(np.float32)
    for one, found in zip(x[:10], run(x[:10]), strict=True):
        wanted = reference.equivariant(layers, one[: inputs.even], one[inputs.even :])
        if np.abs(found - wanted.ravel()).max() > CLOSE * np.abs(wanted).max():
            raise ValueError(f"ONNX Runtime gives something else than {model}")
    single, batched = rate(run, x[:1], CALLS), rate(run, x, CALLS // 100)
    return {"one at a time": single, f"{BATCH} at a time": batched}


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--model", choices=KINDS, default="distances")
    args = parser.parse_args()
    try:
        found = measure(args.model)
    except (ImportError, OSError, ValueError) as error:
        print(f"onnx_runtime: {error}", file=sys.stderr)
        return 1
    rows = {f"ONNX Runtime, {name}": [f"{count:.0f}"] for name, count in found.items()}
    print(markdown.table(f"the network of {args.model}, in float", ["a second"], rows), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
