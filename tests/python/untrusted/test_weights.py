"""Weights and manifests from anywhere: each is exported whole, or refused in one line."""

import io
import json
import zipfile
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io
from fuzzed import CASES, check_message, files, folder, fuzzed
from hypothesis import strategies as st

from export.header import write_header
from export.kinds import read_network
from export.layers import ExportError
from export.settings import read_settings

MANIFEST: dict[str, Any] = {
    "fewest_joints": 10, "objective": "none", "refine_steps": 0, "mirror": [0.5, -1.25, 0.1, 2, 0],
    "fusion": {"share": 0.75, "misfit": 0.5, "distance": 4}, "recipe": {"name": "mds", "seed": 7},
    "data": {"frames": 1000}, "metrics": {"gt": 45.25}, "missing": "imputed", "mds_share": 0.5,
}  # fmt: skip
SHAPE = (91, 3, 91)
NET = [
    (np.linspace(-1, 1, n * m, dtype=np.float32).reshape(n, m), np.full(m, 0.25, np.float32))
    for n, m in zip(SHAPE[:-1], SHAPE[1:], strict=True)
]


def export(path: Path, manifest: str) -> None:
    """What export_weights.py does of a file and a manifest."""
    settings_file, out = path.with_name("settings.json"), path.with_name("out.h")
    settings_file.write_text(manifest, "utf-8", errors="surrogateescape")
    out.write_text("before")
    try:
        kind, layers = read_network(path)
        settings = read_settings(settings_file, kind.needs)
        line = write_header(layers, settings, kind.model, path.name, out, "f32", kind)
    except ExportError as error:
        check_message(error)
        assert out.read_text() == "before"
    else:
        assert "\n" not in line
        check_header(out.read_text("ascii"))
    assert {p.name for p in path.parent.iterdir()} <= {path.name, "settings.json", "out.h"}


def check_header(text: str) -> None:
    """It has one comment at its head, and no text from outside behind it."""
    head, _, rest = text.partition("*/")
    assert head.startswith("/* edml_") and head.count("/*") == 1
    assert rest.rstrip().endswith("};") and "nan" not in rest and "inf" not in rest


def check(data: bytes, name: str) -> None:
    with folder() as place:
        (place / name).write_bytes(data)
        export(place / name, json.dumps(MANIFEST))


# ---- .npz ----------------------------------------------------------------------------------------


def npy(array: np.ndarray) -> bytes:
    data = io.BytesIO()
    np.save(data, array)
    return data.getvalue()


def npz(members: dict[str, bytes], packed: bool) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED if packed else zipfile.ZIP_STORED) as out:
        for name, member in members.items():
            out.writestr(zipfile.ZipInfo(f"{name}.npy"), member)
    return data.getvalue()


MEMBERS = {f"{kind}{k}": npy(part) for k, pair in enumerate(NET)
           for kind, part in zip(("weight", "bias"), pair, strict=True)}  # fmt: skip
ARRAYS = st.builds(
    lambda shape, dtype, order: npy(np.ones(shape, dtype, order)),
    st.one_of(st.sampled_from([(91, 3), (3,), (3, 91), (91,), (), (0,), (1, 1, 1)]),
              st.lists(st.integers(0, 4), max_size=4).map(tuple)),
    st.sampled_from("f4 f2 f8 >f8 i4 ?  U3 S2 c8 M8[s] V4 f4,i2".split()),
    st.sampled_from("CF"),
)  # fmt: skip
NPY_WORDS = [b"(91, 3)", b"<f4", b"|O", b"True", b"\x93NUMPY", b"\x01\x00", b"\x02\x00", b"'", b"{"]
NPY_WORDS += [b"(9999999999,)", b"(-1,)", b"('a',)", b"1e9", b"nan", b"\xff\xff"]
CHANGED = st.dictionaries(
    st.sampled_from([*MEMBERS, "weight2", "bias2", "other", "weight-1", "mds_share"]),
    st.one_of(ARRAYS, files(list(MEMBERS.values()), NPY_WORDS)), max_size=3,
)  # fmt: skip
NPZ = st.builds(lambda changes, packed: npz(MEMBERS | changes, packed), CHANGED, st.booleans())
ZIP_WORDS = [b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06", b"\xff\xff\xff\xff", b"weight0.npy"]


@fuzzed(st.one_of(NPZ, files([npz(MEMBERS, True), npz(MEMBERS, False)], ZIP_WORDS)))
def test_weights_npz(data: bytes) -> None:
    check(data, "net.npz")


# ---- Other formats -------------------------------------------------------------------------------


def safetensors(**changes: Any) -> bytes:
    arrays = {"fc1.weight": NET[0][0].T, "fc1.bias": NET[0][1], "fc2.weight": NET[1][0].T}
    arrays["fc2.bias"] = NET[1][1]
    header, data = {}, b""
    for name, array in arrays.items():
        end = len(data) + array.nbytes
        header[name] = {"dtype": "F32", "shape": array.shape, "data_offsets": [len(data), end]}
        data += np.ascontiguousarray(array).tobytes()
    text = json.dumps(header | changes).encode()
    return len(text).to_bytes(8, "little") + text + data


WORDS = [
    b"fc1.weight",
    b".running_mean",
    b"[",
    b"]",
    b"{",
    b"F16",
    b"BF16",
    b"I64",
    b"-1",
    b"\xff" * 8,
]


@fuzzed(files([safetensors(), safetensors(__metadata__={"a": "b"})], WORDS))
def test_weights_safetensors(data: bytes) -> None:
    check(data, "net.safetensors")


def onnx_model() -> bytes:
    from onnx import TensorProto, helper, numpy_helper

    nodes, constants, value = [], [], "x"
    for k, (weight, bias) in enumerate(NET):
        constants += [
            numpy_helper.from_array(weight, f"w{k}"),
            numpy_helper.from_array(bias, f"b{k}"),
        ]
        nodes.append(helper.make_node("Gemm", [value, f"w{k}", f"b{k}"], [f"y{k}"]))
        nodes.append(helper.make_node("Relu", [f"y{k}"], [f"z{k}"]))
        value = f"z{k}"
    ends = [helper.make_tensor_value_info(n, TensorProto.FLOAT, [1, 91]) for n in ("x", value)]
    graph = helper.make_graph(nodes, "net", ends[:1], ends[1:], constants)
    return helper.make_model(graph).SerializeToString()


ONNX_WORDS = [b"Relu", b"Gemm", b"MatMul", b"Add", b"transB", b"alpha", b"net.onnx.data", b"../x"]
ONNX_WORDS += [
    b"Sigmoid",
    b"BatchNormalization",
    b"Constant",
    b"location",
    b"offset",
    b"w0",
    b"\xff\xff\x7f",
]


@fuzzed(files([onnx_model()], ONNX_WORDS))
def test_weights_onnx(data: bytes) -> None:
    check(data, "net.onnx")


def keras_weights() -> bytes:
    """As save_weights() of Keras 2 writes them."""
    data = io.BytesIO()
    with h5py.File(data, "w") as file:
        file.attrs["layer_names"] = ["dense", "dense_1"]
        for name, (weight, bias) in zip(("dense", "dense_1"), NET, strict=True):
            file[f"{name}/{name}/kernel:0"], file[f"{name}/{name}/bias:0"] = weight, bias
    return data.getvalue()


def keras_config() -> bytes:
    layers: list[dict[str, Any]] = [{"class_name": "InputLayer", "config": {"name": "input"}}]
    for k, (weight, _) in enumerate(NET):
        name = f"dense_{k}" if k else "dense"
        config = {"name": name, "units": weight.shape[1], "activation": "relu", "use_bias": True}
        layers.append({"class_name": "Dense", "config": config})
    return json.dumps({"class_name": "Sequential", "config": {"layers": layers}}).encode()


def keras_archive(config: bytes) -> bytes:
    weights, data = io.BytesIO(), io.BytesIO()
    with h5py.File(weights, "w") as file:
        for k, pair in enumerate(NET):
            for n, part in enumerate(pair):
                file[f"layers/dense{f'_{k}' if k else ''}/vars/{n}"] = part
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr("config.json", config)
        archive.writestr("model.weights.h5", weights.getvalue())
    return data.getvalue()


H5_WORDS = [
    b"dense",
    b"kernel:0",
    b"layer_names",
    b"SNOD",
    b"TREE",
    b"HEAP",
    b"\x89HDF",
    b"\xff" * 8,
]
KERAS_WORDS = [
    b"relu",
    b"Functional",
    b"Dense",
    b"null",
    b"[",
    b"{",
    b'"',
    b"inbound_nodes",
    b"1e9",
]
KERAS_WORDS += [b"output_layers", b"BatchNormalization", b"LeakyReLU", b"false", b"units", b":"]


@fuzzed(files([keras_weights()], H5_WORDS))
def test_weights_h5(data: bytes) -> None:
    check(data, "net.h5")


@fuzzed(files([keras_config()], KERAS_WORDS))
def test_weights_keras(config: bytes) -> None:
    check(keras_archive(config), "net.keras")


TFLITE_WORDS = [b"TFL3", b"\xff\xff\xff\xff", b"\x00\x00\x00\x80", b"\x01\x00", b"RELU"]


@fuzzed(files([(CASES / "weights_empty.tflite").read_bytes()], TFLITE_WORDS))
def test_weights_tflite(data: bytes) -> None:
    check(data, "net.tflite")


def matlab() -> bytes:
    """A SimpleNN of MatConvNet."""
    layers = np.empty(2 * len(NET), object)
    for k, (weight, bias) in enumerate(NET):
        parts = np.empty(2, object)
        parts[:] = [weight.reshape(1, 1, *weight.shape), bias[:, None]]
        layers[2 * k] = {"type": "conv", "weights": parts, "name": f"fc{k}"}
        layers[2 * k + 1] = {"type": "relu", "name": f"relu{k}"}
    data = io.BytesIO()
    scipy.io.savemat(data, {"net": {"layers": layers}})
    return data.getvalue()


MAT_WORDS = [
    b"conv",
    b"relu",
    b"layers",
    b"\x0e\0\0\0",
    b"\x0f\0\0\0",
    b"\xff\xff\xff\x7f",
    b"MI",
    b"dagnn.",
]


@fuzzed(files([matlab()], MAT_WORDS))
def test_weights_mat(data: bytes) -> None:
    check(data, "net.mat")


# ---- Manifests -----------------------------------------------------------------------------------

MANIFEST_WORDS = [b"[", b"]", b"{", b"}", b'"', b":", b",", b"NaN", b"1e999", b"-1", b"null", b"*/"]
MANIFEST_WORDS += [b"9" * 5000, b"true", b"\\u002a/", b"\xff", b"\n", b"??/", b"none", b"square"]
ODD = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.just("*/ x /*"),
    st.lists(st.floats(), max_size=6),
    st.dictionaries(st.text(max_size=4), st.floats(), max_size=3),
)  # fmt: skip
ODD_MANIFESTS = st.builds(
    lambda changes: json.dumps(MANIFEST | changes).encode(),
    st.dictionaries(st.sampled_from(list(MANIFEST)), ODD, max_size=3),
)


@fuzzed(st.one_of(ODD_MANIFESTS, files([json.dumps(MANIFEST).encode()], MANIFEST_WORDS)))
def test_manifest(text: bytes) -> None:
    with folder() as place:
        (place / "net.npz").write_bytes(npz(MEMBERS, True))
        export(place / "net.npz", text.decode("utf-8", "surrogateescape"))
