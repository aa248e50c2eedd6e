"""weights.py and export_weights.py: every format gives the same header, which holds exactly the
weights.  What quantised headers hold is tested in test_quantise.py."""

import hashlib
import json
import pickle
import re
import shutil
import struct
import subprocess
import sys
import types
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from exports import MANIFEST, Net, export, make_net, refused
from support import ROOT

from export.build import FLAGS
from export.cli import main
from export.header import hex_float, write_header
from export.layers import ExportError
from export.readers import READERS, read_layers
from export.settings import ModelSettings
from model import constants
from reports.targets import INCLUDES, WITHOUT_MODELS, compile_each, run

LIB = ROOT / "lib"
SHAPE = (91, 128, 128, 91)


@pytest.fixture
def net() -> Net:
    """A random network, [in, out] and [out]; its square layer would betray a transposition."""
    return make_net(SHAPE)


# ---- A network as each format holds it ---------------------------------------------------------


def save_npz(path: Path, net: Net) -> None:
    arrays = {}
    for k, (weight, bias) in enumerate(net):
        arrays |= {f"weight{k}": weight, f"bias{k}": bias}
    np.savez(path, **arrays)


def state_dict(net: Net) -> dict[str, np.ndarray]:
    """PyTorch's names and orientation, as of an nn.Sequential whose numbers reach two digits."""
    state = {}
    for k, (weight, bias) in enumerate(net):
        prefix = f"net.{8 + 2 * k}"
        state |= {f"{prefix}.weight": np.ascontiguousarray(weight.T), f"{prefix}.bias": bias}
    return state


def save_safetensors(path: Path, net: Net) -> None:
    from safetensors.numpy import save_file

    save_file(state_dict(net), path)


def onnx_nodes(net: Net, gemm: bool) -> tuple[list, list]:
    """Nodes and initializers: Gemm with the weights transposed, or MatMul and Add."""
    from onnx import helper, numpy_helper

    nodes, tensors, value = [], [], "x"
    for k, (weight, bias) in enumerate(net):
        stored = np.ascontiguousarray(weight.T) if gemm else weight
        tensors += [numpy_helper.from_array(stored, f"w{k}")]
        tensors += [numpy_helper.from_array(bias, f"b{k}")]
        if gemm:
            nodes += [helper.make_node("Gemm", [value, f"w{k}", f"b{k}"], [f"y{k}"], transB=1)]
        else:
            nodes += [helper.make_node("MatMul", [value, f"w{k}"], [f"m{k}"])]
            nodes += [helper.make_node("Add", [f"b{k}", f"m{k}"], [f"y{k}"])]
        nodes += [helper.make_node("Relu", [f"y{k}"], [f"z{k}"])]
        value = f"z{k}"
    return nodes, tensors


def save_graph(path: Path, nodes: list, tensors: list) -> None:
    import onnx
    from onnx import TensorProto, helper

    ends = [("x", "first"), (nodes[-1].output[0], "last")]
    values = [helper.make_tensor_value_info(n, TensorProto.FLOAT, [1, 91]) for n, _ in ends]
    graph = helper.make_graph(nodes, "net", values[:1], values[1:], tensors)
    onnx.save(helper.make_model(graph), path)


def save_onnx_gemm(path: Path, net: Net) -> None:
    save_graph(path, *onnx_nodes(net, gemm=True))


def save_onnx_matmul(path: Path, net: Net) -> None:
    """Without the last Relu, and with the first weights in a Constant node, the last bias
    behind an Identity."""
    from onnx import helper

    nodes, tensors = onnx_nodes(net, gemm=False)
    first = helper.make_node("Constant", [], ["w0"], value=tensors[0])
    last = helper.make_node("Identity", [tensors[-1].name], ["same"])
    nodes[-2].input[0] = "same"
    save_graph(path, [first, last, *nodes[:-1]], tensors[1:])


def filters(weight: np.ndarray) -> np.ndarray:
    return weight[None, None]  # [1, 1, in, out]


def cell(*items: object) -> np.ndarray:
    """A MATLAB cell array, 1 x n."""
    array = np.empty((1, len(items)), object)
    for i, item in enumerate(items):
        array[0, i] = item
    return array


def simple_layers(net: Net) -> list[dict]:
    """SimpleNN's layers, with a dropout and a loss as training leaves them behind."""
    layers = []
    for weight, bias in net:
        weights = cell(filters(weight), bias[None])
        layers += [{"type": "conv", "weights": weights, "stride": 1.0, "pad": 0.0}]
        layers += [{"type": "relu", "leak": 0.0}, {"type": "dropout", "rate": 0.5}]
    return [*layers, {"type": "pdist", "p": 2.0}]


def save_mat_simple(path: Path, net: Net) -> None:
    import scipy.io

    scipy.io.savemat(path, {"net": {"layers": cell(*simple_layers(net))}})


def struct_array(items: list[dict]) -> np.ndarray:
    """A MATLAB struct array, 1 x n."""
    array = np.empty((1, len(items)), [(name, object) for name in items[0]])
    for i, item in enumerate(items):
        array[0, i] = tuple(item.values())
    return array


def dag_fields(net: Net) -> dict[str, list[dict]]:
    """What DagNN's saveobj() writes.  The params are not in the order of the layers."""
    params, layers, value = [], [], "input"

    def layer(kind: str, name: str, names: np.ndarray, block: dict) -> None:
        nonlocal value
        item = {"name": name, "type": f"dagnn.{kind}", "inputs": cell(value)}
        layers.append(item | {"outputs": cell(name), "params": names, "block": block})
        value = name

    for k, (weight, bias) in enumerate(net):
        params.insert(0, {"name": f"fc{k}f", "value": filters(weight)})
        params.insert(0, {"name": f"fc{k}b", "value": bias[:, None]})
        layer("Conv", f"fc{k}", cell(f"fc{k}f", f"fc{k}b"), {"pad": np.zeros((1, 4))})
        layer("ReLU", f"relu{k}", cell(), {"leak": 0.0})
        layer("DropOut", f"drop{k}", cell(), {"rate": 0.5})
    layer("Loss", "loss", cell(), {"loss": "l2"})
    layers[-1]["inputs"] = cell(f"drop{len(net) - 1}", "label")
    return {"params": params, "layers": layers}


def save_mat_dag(path: Path, net: Net) -> None:
    import scipy.io

    fields = {name: struct_array(items) for name, items in dag_fields(net).items()}
    scipy.io.savemat(path, {"net": fields})


class MatlabFile:
    """Writes values as MATLAB's version 7.3 does: HDF5 with the axes the other way round."""

    def __init__(self, path: Path) -> None:
        import h5py

        self.h5py = h5py
        self.file = h5py.File(path, "w", userblock_size=512)
        self.count = 0

    def close(self, path: Path) -> None:
        self.file.close()
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file".ljust(124) + struct.pack("<H", 0x200) + b"IM")

    def reference(self, value: object):
        self.count += 1
        name = f"#refs#/{self.count}"
        self.write(name, value)
        return self.file[name].ref

    def references(self, name: str, values: list) -> None:
        links = [[self.reference(value)] for value in values]
        self.file.create_dataset(name, data=links, dtype=self.h5py.ref_dtype)

    def write(self, name: str, value: object) -> None:
        if isinstance(value, dict):
            kind = "struct"
            self.file.create_group(name)
            for field, item in value.items():
                self.write(f"{name}/{field}", item)
        elif isinstance(value, list):  # an array of structs, whose fields have no class
            kind = "struct"
            self.file.create_group(name)
            for field in value[0]:
                self.references(f"{name}/{field}", [item[field] for item in value])
        elif isinstance(value, str):
            kind = "char"
            self.file[name] = np.array([[ord(c)] for c in value], np.uint16)
        elif isinstance(value, np.ndarray) and value.dtype == object and value.size:
            kind = "cell"
            self.references(name, list(value.flat))
        elif isinstance(value, np.ndarray) and value.dtype == object:
            kind = "cell"
            self.file[name] = np.zeros(2, np.uint64)
            self.file[name].attrs["MATLAB_empty"] = np.uint8(1)
        else:
            array = np.atleast_2d(value)
            kind = "single" if array.dtype == np.float32 else "double"
            self.file[name] = np.ascontiguousarray(array.T)
        self.file[name].attrs["MATLAB_class"] = np.bytes_(kind)


def save_mat73(path: Path, net_struct: dict) -> None:
    matlab = MatlabFile(path)
    matlab.write("net", net_struct)
    matlab.close(path)


def save_mat73_simple(path: Path, net: Net) -> None:
    save_mat73(path, {"layers": cell(*simple_layers(net))})


def save_mat73_dag(path: Path, net: Net) -> None:
    save_mat73(path, dag_fields(net))


def save_torch(path: Path, net: Net) -> None:
    torch = pytest.importorskip("torch")
    torch.save({name: torch.from_numpy(a) for name, a in state_dict(net).items()}, path)


FORMATS: dict[str, tuple[str, Callable[[Path, Net], None]]] = {
    "npz": (".npz", save_npz),
    "safetensors": (".safetensors", save_safetensors),
    "onnx Gemm": (".onnx", save_onnx_gemm),
    "onnx MatMul": (".onnx", save_onnx_matmul),
    "mat SimpleNN": (".mat", save_mat_simple),
    "mat DagNN": (".mat", save_mat_dag),
    "mat 7.3 SimpleNN": (".mat", save_mat73_simple),
    "mat 7.3 DagNN": (".mat", save_mat73_dag),
    "torch": (".pt", save_torch),
}


# ---- Help --------------------------------------------------------------------------------------


def parsed_arrays(text: str) -> dict[str, np.ndarray]:
    """The float arrays of a header: name -> values, float32."""
    arrays = {}
    pattern = r"static const float (\w+)\[([\d *]+)\] = \{(.*?)\};"
    for name, size, body in re.findall(pattern, text, re.DOTALL):
        words = [word.strip() for word in body.split(",") if word.strip()]
        values = [float.fromhex(word.removesuffix("F")) for word in words]
        assert len(values) == np.prod([int(n) for n in size.split("*")])
        assert all(word == "0" or word.endswith("F") for word in words)
        array = np.array(values, np.float32)
        assert np.array_equal(array, np.array(values))  # each is exactly a float32
        arrays[name] = array
    return arrays


WARNINGS = ["-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wvla", "-Werror"]


def compile_header(compiler: str, flags: list[str], header: Path, lib: Path = LIB):
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    source = header.with_suffix(".c")
    source.write_text(f'#include "network/kernels.h"\n#include "{header.name}"\n')
    paths = [f"-I{lib}", f"-I{ROOT / 'include'}", f"-I{header.parent}"]
    command = [compiler, *flags, *WARNINGS, "-fsyntax-only", *paths, str(source)]
    return subprocess.run(command, capture_output=True, text=True)


# ---- Every format ------------------------------------------------------------------------------


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_gives_the_same_header(tmp_path: Path, net: Net, form: str) -> None:
    suffix, save = FORMATS[form]
    weights = tmp_path / f"theirs{suffix}"
    save(weights, net)
    status, header = export(tmp_path, weights)
    assert status == 0
    lines = header.read_text().splitlines()
    assert lines[1] == f" * Generated by tools/export_weights.py from {weights.name}"
    write_header(net, ModelSettings(**MANIFEST), "fconn", "other", tmp_path / "direct.h")
    direct = (tmp_path / "direct.h").read_text().splitlines()
    assert lines[:1] + lines[2:] == direct[:1] + direct[2:]


class FakeTensor:
    """What read_torch() asks of a tensor."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def detach(self) -> "FakeTensor":
        return self

    def float(self) -> "FakeTensor":
        return FakeTensor(self.array.astype(np.float32))

    def numel(self) -> int:
        return self.array.size

    def numpy(self) -> np.ndarray:
        return self.array


@pytest.fixture
def fake_torch(monkeypatch, net: Net) -> dict:
    """A module torch whose load() gives a checkpoint; returns the checkpoint, to be changed."""
    checkpoint = {"state_dict": {name: FakeTensor(a) for name, a in state_dict(net).items()}}

    def load(path: Path, map_location: str, weights_only: bool) -> dict:
        assert (map_location, weights_only) == ("cpu", True)  # no code in the file may run
        return checkpoint

    module = types.ModuleType("torch")
    module.load = load
    module.is_tensor = lambda value: isinstance(value, FakeTensor)
    monkeypatch.setitem(sys.modules, "torch", module)
    return checkpoint


@pytest.mark.parametrize("nested", [True, False])
def test_torch_state_dict(tmp_path: Path, net: Net, fake_torch: dict, nested: bool) -> None:
    if not nested:
        fake_torch |= fake_torch.pop("state_dict")
    weights = tmp_path / "net.pth"
    weights.write_bytes(b"not read")
    for (weight, bias), layer in zip(net, read_layers(weights), strict=True):
        assert np.array_equal(layer.weight, weight)
        assert np.array_equal(layer.bias, bias)


def test_torch_entry_that_is_no_tensor(tmp_path: Path, capsys, fake_torch: dict) -> None:
    fake_torch["state_dict"]["epoch"] = 3
    (tmp_path / "net.pt").write_bytes(b"not read")
    assert "unsupported tensor epoch" in refused(tmp_path, capsys, tmp_path / "net.pt")


def test_torch_view_that_is_larger_than_its_storage(
    tmp_path: Path, capsys, fake_torch: dict
) -> None:
    """A tensor of stride 0 takes 4 bytes in the file, whatever its shape."""
    view = np.broadcast_to(np.float32(0), (1 << 20, 1 << 20))
    fake_torch["state_dict"]["net.8.weight"] = FakeTensor(view)
    (tmp_path / "net.pt").write_bytes(b"not read")
    line = refused(tmp_path, capsys, tmp_path / "net.pt")
    assert "net.8.weight takes 4194304 MB, at most 64 are read" in line


def test_torch_module(tmp_path: Path, capsys, fake_torch: dict, monkeypatch) -> None:
    """PyTorch's own message says how to run what is in the file."""

    def load(path: Path, map_location: str, weights_only: bool) -> dict:
        raise pickle.UnpicklingError("re-run with weights_only=False")

    monkeypatch.setattr(sys.modules["torch"], "load", load)
    (tmp_path / "net.pt").write_bytes(b"not read")
    line = refused(tmp_path, capsys, tmp_path / "net.pt")
    assert "holds more than tensors, such as a whole module: save model.state_dict()\n" in line
    monkeypatch.setattr(sys.modules["torch"], "load", lambda *_, **__: [1, 2])
    line = refused(tmp_path, capsys, tmp_path / "net.pt")
    assert "holds no state dict: save model.state_dict()\n" in line


def test_torch_archive_that_unpacks_to_much_more(tmp_path: Path, capsys, fake_torch: dict) -> None:
    with zipfile.ZipFile(tmp_path / "net.pt", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("data/0", bytes(70 << 20))
    line = refused(tmp_path, capsys, tmp_path / "net.pt")
    assert "the unpacked archive takes 70 MB, at most 64 are read" in line


def test_torch_not_installed(tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    (tmp_path / "net.pt").write_bytes(b"not read")
    assert "pip install torch" in refused(tmp_path, capsys, tmp_path / "net.pt")


def test_bfloat16_and_float64(tmp_path: Path, net: Net) -> None:
    import ml_dtypes
    from safetensors.numpy import save_file

    weights = tmp_path / "net.safetensors"
    net[0][0][0, 3] = 1.0  # the largest float32 rounds to infinity
    for kind in (ml_dtypes.bfloat16, np.float64):
        save_file({name: a.astype(kind) for name, a in state_dict(net).items()}, weights)
        for (weight, _), layer in zip(net, read_layers(weights), strict=True):
            assert layer.weight.dtype == np.float32
            assert np.array_equal(layer.weight, weight.astype(kind).astype(np.float32))


def test_filters_that_span_an_image(tmp_path: Path) -> None:
    """vl_nnconv's [h, w, c, out] on an input [h, w, c], which MATLAB flattens with h fastest."""
    import scipy.io

    rng = np.random.default_rng(2)
    image, bias = rng.normal(size=(7, 13)), rng.normal(size=91)
    filters = rng.normal(size=(7, 13, 1, 91))
    layer = {"type": "conv", "weights": cell(filters, bias[None])}
    scipy.io.savemat(tmp_path / "net.mat", {"layers": cell(layer)})  # without `net`
    [(weight, read_bias)] = read_layers(tmp_path / "net.mat")
    expected = np.einsum("hw,hwo->o", image, filters[:, :, 0])
    assert np.allclose(image.ravel(order="F") @ weight, expected, atol=1e-4)
    assert np.array_equal(read_bias, bias.astype(np.float32))


# ---- The header --------------------------------------------------------------------------------


@pytest.fixture
def header(tmp_path: Path, net: Net) -> Path:
    save_npz(tmp_path / "fconn.npz", net)
    return export(tmp_path, tmp_path / "fconn.npz")[1]


def test_values_are_exact_and_packed(header: Path, net: Net) -> None:
    arrays = parsed_arrays(header.read_text())
    assert len(arrays) == 2 * len(net)
    for k, (weight, bias) in enumerate(net):
        inputs, outputs = weight.shape
        groups = (outputs + 7) // 8
        expected = np.zeros((groups, inputs, 8), np.float32)
        expected_bias = np.zeros(groups * 8, np.float32)
        for row in range(outputs):
            expected[row // 8, :, row % 8] = weight[:, row]
            expected_bias[row] = bias[row]
        # Bit by bit, for the checksum tells -0 from 0.
        assert arrays[f"fconn_f32_weight{k}"].tobytes() == expected.tobytes()
        assert arrays[f"fconn_f32_bias{k}"].tobytes() == expected_bias.tobytes()


def test_checksum(header: Path) -> None:
    text = header.read_text()
    value = 2166136261
    for array in parsed_arrays(text).values():  # in the header's order: weight0, bias0, ...
        for (word,) in struct.iter_unpack("<I", array.tobytes()):
            for byte in word.to_bytes(4, "little"):
                value = ((value ^ byte) * 16777619) % 2**32
    assert f"    0x{value:08x}u, /* checksum */" in text


def test_opening_comment(header: Path, net: Net) -> None:
    sha = hashlib.sha256()
    for weight, bias in net:
        sha.update(weight.tobytes() + bias.tobytes())
    assert header.read_text().split("*/")[0].splitlines() == [
        "/* edml_fconn_f32: a trained network.  Do not edit.",
        " * Generated by tools/export_weights.py from fconn.npz",
        " *",
        " * layers      91-128-128-91, relu after each",
        f" * weights     sha256 {sha.hexdigest()[:16]}",
        " * parameters  40027, 39680 multiply-adds",
        " * quantiser   none (float32)",
        " * error, mm   gt 45.25, n10 60",
        " * training    recipe mds, seed 7",
        " ",
    ]


def test_model(header: Path) -> None:
    model = header.read_text().split("const edml_model edml_fconn_f32 = {\n")[1].splitlines()
    assert model[0] == '    "fconn_f32",'
    assert model[2:] == [
        "    edml__fconn_f32,",
        "    NULL,",
        "    edml__fconn_checksum_f32,",
        "    fconn_f32_layers,",
        "    3, /* layers */",
        "    EDML_READS_DISTANCES,",
        "    EDML_GIVES_DISTANCES,",
        "    91, /* inputs */",
        "    0, /* even ones */",
        "    91, /* outputs */",
        "    10, /* fewest joints */",
        "    sizeof(edml_work),",
        "    0,",
        "    NULL,",
        "    edml__scale_and_orient,",
        "    NULL,",
        "    EDML_STRESS_NONE,",
        "    0, /* refinement steps */",
        f"    {{{{0x1p-1F, {1 << 23}}}, {{-0x1.4p0F, {-5 << 22}}}, {{0x1.99999ap-4F, 1677722}}, "
        f"{{0x1p1F, {2 << 24}}}, {{0, 0}}}}, /* mirror */",
        f"    {{{{0x1.8p-1F, {3 << 22}}}, {{0x1p-2F, {1 << 22}}}, {{0x1p-2F, {1 << 22}}}}}, "
        "/* fusion: share 0.75, misfit 0.5 m, distance 4 m */",
        "    {0, 0}, /* MDS share: 0 */",
        "};",
    ]


def test_same_input_same_bytes(tmp_path: Path, header: Path) -> None:
    first = header.read_bytes()
    header.unlink()
    assert export(tmp_path, tmp_path / "fconn.npz")[1].read_bytes() == first
    assert b"\r" not in first
    assert str(tmp_path).encode() not in first


def test_summary(tmp_path: Path, header: Path, capsys) -> None:
    capsys.readouterr()
    export(tmp_path, tmp_path / "fconn.npz")
    checksum = re.search(r"(0x\w+)u, /\* checksum", header.read_text())[1]
    flash = 4 * ((91 + 1) * 128 + (128 + 1) * 128 + (128 + 1) * 96)
    assert capsys.readouterr().out == (
        f"edml_fconn_f32: 91-128-128-91, 40027 parameters, {flash} bytes of flash, "
        f"checksum {checksum}: {header}\n"
    )


def test_manifest_beside_the_weights(tmp_path: Path, net: Net) -> None:
    save_npz(tmp_path / "fconn.npz", net)
    (tmp_path / "fconn.json").write_text(json.dumps(MANIFEST))
    assert main([str(tmp_path / "fconn.npz"), "--out", str(tmp_path / "out.h")]) == 0


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (-0.0, "-0x0p0F"), (0.1875, "0x1.8p-3F"), (1.0, "0x1p0F"), (-16.0, "-0x1p4F")],
)
def test_hex_float(value: float, text: str) -> None:
    assert hex_float(value) == text


# C++ knows hexadecimal floats since 2017; before, GCC takes them as an extension.
COMPILERS = {
    "gcc": ["gcc", "-std=c99"],
    "clang": ["clang", "-std=c99"],
    "g++": ["g++", "-x", "c++", "-std=c++17"],
    "g++ 11": ["g++", "-x", "c++", "-std=gnu++11"],
    "clang++": ["clang++", "-x", "c++", "-std=c++17"],
}


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", ["fconn", "their_net2"])
def test_compiles(tmp_path: Path, net: Net, compiler: str, name: str) -> None:
    save_npz(tmp_path / "net.npz", net)
    awkward = {"metrics": {"a */ b /* c": 1.5}, "recipe": {"name": "??/\n\\", "seed": "é"}}
    awkward |= {"objective": "eq2", "refine_steps": 255}
    status, header = export(tmp_path, tmp_path / "net.npz", MANIFEST | awkward, name)
    assert status == 0
    result = compile_header(*COMPILERS[compiler][:1], COMPILERS[compiler][1:], header)
    assert (result.returncode, result.stderr) == (0, "")


CHECKSUM_C = """\
#include "network/kernels.h"
#include "out.h"
#include <string.h>

void edml__fconn_f32(float *d, const float *e, const edml_model *m, void *x)
{ (void)d, (void)e, (void)m, (void)x; }
uint32_t edml__fconn_checksum_f32(const edml_model *m) { return m->checksum; }
edml_status edml__scale_and_orient(edml_work *w, const edml_model *m)
{ (void)w, (void)m; return EDML_OK; }

static uint32_t fnv1a(uint32_t h, const float *value, int count)
{
    for (int i = 0; i < count; i++) {
        uint32_t word;
        memcpy(&word, value + i, sizeof word);
        for (int shift = 0; shift < 32; shift += 8) h = (h ^ (word >> shift & 255)) * 16777619u;
    }
    return h;
}

int main(void)
{
    const edml_dense_f32 *layer = (const edml_dense_f32 *)edml_fconn_f32.layers;
    uint32_t h = 2166136261u;
    for (int i = 0; i < edml_fconn_f32.layer_count; i++, layer++) {
        int rows = (layer->outputs + 7) / 8 * 8;
        h = fnv1a(h, layer->weight, rows * layer->inputs);
        h = fnv1a(h, layer->bias, rows);
    }
    return h != edml_fconn_f32.checksum;
}
"""


@pytest.mark.parametrize("compiler", COMPILERS)
def test_compiled_data_match_the_checksum(tmp_path: Path, header: Path, compiler: str) -> None:
    """As the target will see them: every constant has reached its exact bits."""
    command = COMPILERS[compiler]
    if shutil.which(command[0]) is None:
        pytest.skip(f"no {command[0]}")
    (tmp_path / "main.c").write_text(CHECKSUM_C)
    paths = [f"-I{ROOT / 'lib'}", f"-I{ROOT / 'include'}", "-o", str(tmp_path / "main")]
    subprocess.run([*command, str(tmp_path / "main.c"), *paths], check=True)
    assert subprocess.run([str(tmp_path / "main")]).returncode == 0


NETWORK_C = """\
#include "network/kernels.h"
#include "out.h"
#include <stdio.h>

int main(void)
{
    static edml_work work;
    const edml_model *model = &edml_fconn_f32;
    float x[EDML_PAIRS], y[EDML_MAX_VALUES];
    if (edml_model_check(model) != EDML_OK || fread(x, sizeof x, 1, stdin) != 1) return 1;
    model->predict_f32(y, x, model, &work.of.network.units);
    return fwrite(y, sizeof x, 1, stdout) != 1;
}
"""


def test_the_library_computes_the_network(tmp_path: Path) -> None:
    net = make_net((91, 120, 128, 91))
    net[0][0][0, 3] = 0.5  # the largest float32 would leave nothing to compare
    save_npz(tmp_path / "net.npz", net)
    export(tmp_path, tmp_path / "net.npz")
    (tmp_path / "main.c").write_text(NETWORK_C)
    command = ["cc", *FLAGS, *INCLUDES]
    objects = compile_each(command, tmp_path, WITHOUT_MODELS)
    run(*command, tmp_path / "main.c", *objects, "-lm", "-o", tmp_path / "main")
    x = np.random.default_rng(3).uniform(0, 2, 91).astype(np.float32)
    result = subprocess.run([str(tmp_path / "main")], input=x.tobytes(), capture_output=True)
    assert result.returncode == 0
    expected = x.astype(np.float64)
    for weight, bias in net:
        expected = np.maximum(expected @ weight.astype(np.float64) + bias, 0)
    assert expected.max() > 0.1
    assert np.allclose(np.frombuffer(result.stdout, np.float32), expected, rtol=1e-5, atol=1e-4)


def test_other_format_does_not_compile(tmp_path: Path, header: Path) -> None:
    lib = shutil.copytree(LIB, tmp_path / "lib")
    text = (lib / "network" / "model.h").read_text()
    line = f"EDML_WEIGHTS_FORMAT {constants.WEIGHTS_FORMAT}"
    other = text.replace(line, f"{line}1")
    assert other != text
    (lib / "network" / "model.h").write_text(other)
    result = compile_header("gcc", ["-std=c99"], header, lib)
    assert result.returncode != 0
    assert "regenerate with tools/export_weights.py" in result.stderr


# ---- What is refused ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ((90, 128, 91), "layer 0 takes 90 values, the image gives 91"),
        ((91, 128, 90), "the last layer gives 90 values, not 91"),
        ((91, 193, 91), "layer 0 is 193 wide, at most 192 fit"),
    ],
)
def test_shape(tmp_path: Path, capsys, shape: tuple[int, ...], message: str) -> None:
    save_npz(tmp_path / "net.npz", make_net(shape))
    assert message in refused(tmp_path, capsys, tmp_path / "net.npz")


def test_widths_that_do_not_chain(tmp_path: Path, capsys, net: Net) -> None:
    save_npz(tmp_path / "net.npz", [net[0], *make_net((127, 91))])
    line = refused(tmp_path, capsys, tmp_path / "net.npz")
    assert "layer 1 takes 127 values, layer 0 gives 128" in line


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_not_finite(tmp_path: Path, capsys, net: Net, value: float) -> None:
    net[1][0][3, 5] = value
    save_npz(tmp_path / "net.npz", net)
    assert f"layer 1: weight[3, 5] is {value}" in refused(tmp_path, capsys, tmp_path / "net.npz")


def test_too_large_for_float32(tmp_path: Path, capsys, net: Net) -> None:
    bias = net[2][1].astype(np.float64)
    bias[4] = 1e39
    save_npz(tmp_path / "net.npz", [*net[:2], (net[2][0], bias)])
    assert "layer 2: bias[4] is inf" in refused(tmp_path, capsys, tmp_path / "net.npz")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bias1": None}, "layer 1 has no bias"),
        ({"weight2": None}, "layer 2 has no weight"),
        ({"weight1": None, "bias1": None}, "the 2 layers are not numbered 0 to 1"),
        ({"scale": np.ones(3)}, "unknown array scale"),
        ({"bias0": np.ones(127)}, "layer 0 has 128 outputs, but 127 biases"),
        ({"bias0": np.ones((1, 128))}, "layer 0: bias has 2 dimensions, not 1"),
        ({"weight0": np.ones((91, 128), np.int8)}, "layer 0: weight is of type int8"),
        ({"bias0": np.ones(128, [("a", "f4")])}, "not floating point"),
        ({"bias0": np.array([None] * 128)}, "not a readable .npz file"),
        ({f"{kind}{k}": None for kind in ("weight", "bias") for k in range(3)}, "no layers"),
    ],
)
def test_arrays(tmp_path: Path, capsys, net: Net, changes: dict, message: str) -> None:
    arrays = {f"weight{k}": weight for k, (weight, _) in enumerate(net)}
    arrays |= {f"bias{k}": bias for k, (_, bias) in enumerate(net)} | changes
    np.savez(tmp_path / "net.npz", **{n: a for n, a in arrays.items() if a is not None})
    assert message in refused(tmp_path, capsys, tmp_path / "net.npz")


def test_state_dict_of_another_network(tmp_path: Path, capsys, net: Net) -> None:
    from safetensors.numpy import save_file

    for name, array, message in [
        ("norm.running_mean", np.ones(128), "unsupported tensor norm.running_mean"),
        ("norm.weight", np.ones(128), "layer norm has no bias"),
        ("².weight", np.ones(128), "layer ² has no bias"),
        ("9" * 5000 + ".weight", np.ones(128), "a tensor's name of 5007 letters"),
    ]:
        save_file(state_dict(net) | {name: array}, tmp_path / "net.safetensors")
        assert message in refused(tmp_path, capsys, tmp_path / "net.safetensors")


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize("content", [b"", b"nonsense\0" * 50, b"PK\x03\x04", b"\x89HDF\r\n\x1a\n"])
def test_damaged_file(tmp_path: Path, capsys, suffix: str, content: bytes) -> None:
    if suffix in (".pt", ".pth"):
        pytest.importorskip("torch") if content else None
    weights = tmp_path / f"net{suffix}"
    weights.write_bytes(content)
    line = refused(tmp_path, capsys, weights)
    assert ("the file is empty" in line) == (not content)


@pytest.mark.parametrize("form", [form for form in FORMATS if form != "torch"])
def test_truncated_file(tmp_path: Path, capsys, net: Net, form: str) -> None:
    suffix, save = FORMATS[form]
    weights = tmp_path / f"net{suffix}"
    save(weights, net)
    content = weights.read_bytes()
    weights.write_bytes(content[: len(content) * 2 // 3])
    refused(tmp_path, capsys, weights)


def test_unknown_suffix(tmp_path: Path, capsys) -> None:
    (tmp_path / "net.pb").write_bytes(b"x")
    line = refused(tmp_path, capsys, tmp_path / "net.pb")
    known = ".npz, .safetensors, .pt, .pth, .onnx, .keras, .h5, .hdf5, .tflite, .mat"
    assert f"unknown suffix '.pb': one of {known}\n" in line


def test_no_such_file(tmp_path: Path, capsys) -> None:
    assert "no such file" in refused(tmp_path, capsys, tmp_path / "net.npz")


def sigmoid(nodes: list) -> list:
    nodes[1].op_type = "Sigmoid"
    return nodes


def no_relu(nodes: list) -> list:
    nodes[2].input[0] = nodes[0].output[0]
    return [nodes[0], *nodes[2:]]


def no_bias(nodes: list) -> list:
    del nodes[2].input[2]
    return nodes


def scaled(nodes: list) -> list:
    from onnx import helper

    nodes[2].attribute.append(helper.make_attribute("alpha", 0.5))
    return nodes


def skipping(nodes: list) -> list:
    nodes[4].input[0] = nodes[1].output[0]
    return nodes


def on_two_lines(nodes: list) -> list:
    nodes[4].output[0] = "y\n2"
    return skipping(nodes)


def variable(nodes: list) -> list:
    nodes[2].input[1] = "nowhere"
    return nodes


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (sigmoid, "unsupported ONNX operator Sigmoid"),
        (no_relu, "want one relu between layers, not dense, dense, relu, dense, relu"),
        (no_bias, "layer 1: bias is missing"),
        (scaled, "unsupported alpha 0.5 in Gemm y1"),
        (skipping, "Gemm of y2 does not follow on z1"),
        (on_two_lines, "Gemm of y 2 does not follow on z1"),
        (variable, "Gemm of y1: nowhere is not a constant"),
    ],
)
def test_onnx_graph(tmp_path: Path, capsys, net: Net, change: Callable, message: str) -> None:
    nodes, tensors = onnx_nodes(net, gemm=True)
    save_graph(tmp_path / "net.onnx", change(nodes), tensors)
    assert message in refused(tmp_path, capsys, tmp_path / "net.onnx")


def test_onnx_matmul_without_add(tmp_path: Path, capsys, net: Net) -> None:
    nodes, tensors = onnx_nodes(net, gemm=False)
    nodes[2].input[0] = nodes[0].output[0]  # MatMul, Relu; the Add is left out
    save_graph(tmp_path / "net.onnx", [nodes[0], *nodes[2:]], tensors)
    assert "layer 0: bias is missing" in refused(tmp_path, capsys, tmp_path / "net.onnx")


@pytest.mark.parametrize(
    ("number", "change", "message"),
    [
        (1, {"type": "sigmoid"}, "unsupported MatConvNet layer sigmoid"),
        (1, {"leak": 0.1}, "unsupported leak in MatConvNet layer relu"),
        (0, {"pad": 1.0}, "unsupported pad in MatConvNet layer conv"),
        (0, {"weights": cell(np.ones((1, 1, 91, 128)))}, "layer 0: bias is missing"),
        (0, {"weights": cell(np.ones((1, 1, 91, 128)), np.zeros((0, 0)))}, "bias is missing"),
        (1, {"type": "dropout"}, "want one relu between layers"),
    ],
)
@pytest.mark.parametrize("version", [5, 7.3])
def test_mat_layer(
    tmp_path: Path, capsys, net: Net, number: int, change: dict, message: str, version: float
) -> None:
    import scipy.io

    layers = simple_layers(net)
    layers[number] |= change
    struct = {"layers": cell(*layers)}
    path = tmp_path / "net.mat"
    save_mat73(path, struct) if version == 7.3 else scipy.io.savemat(path, {"net": struct})
    assert message in refused(tmp_path, capsys, path)


def test_mat_dag_that_branches(tmp_path: Path, capsys, net: Net) -> None:
    fields = dag_fields(net)
    fields["layers"][6]["inputs"] = cell("relu0")
    save_mat73(tmp_path / "net.mat", fields)
    line = refused(tmp_path, capsys, tmp_path / "net.mat")
    assert "layer fc2 does not follow on drop1" in line


def test_mat_without_a_network(tmp_path: Path, capsys) -> None:
    import scipy.io

    scipy.io.savemat(tmp_path / "net.mat", {"x": np.ones(3)})
    assert "holds no net.layers" in refused(tmp_path, capsys, tmp_path / "net.mat")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fewest_joints": 3}, "fewest_joints must be 4 to 14"),
        ({"fewest_joints": 10.5}, "fewest_joints must be 4 to 14"),
        ({"fewest_joints": True}, "fewest_joints must be 4 to 14"),
        ({"missing": "guess"}, "missing must be one of zero, imputed"),
        ({"missing": "imputed", "fewest_joints": 4}, "fewest_joints must be 5 or more"),
        ({"objective": "stress"}, "objective must be one of none, square, raw, eq2"),
        ({"refine_steps": 256}, "refine_steps must be 0 to 255"),
        ({"mirror": [1, 2, 3, 4]}, "mirror must be five numbers"),
        ({"mirror": [1, 2, 3, 4, 1e39]}, "mirror must be five numbers"),
        ({"mirror": [1, 2, 3, 4, -128]}, "mirror must be five numbers between -128 and 128"),
        (
            {"fusion": [0.5, 0.1, 4]},
            "fusion must be share 0 to 1, misfit 0.01 to 1 and distance 3",
        ),
        ({"fusion": {"share": 0.5, "misfit": 0.1}}, "fusion must be"),
        ({"fusion": {"share": 1.1, "misfit": 0.1, "distance": 4}}, "fusion must be"),
        ({"fusion": {"share": 0.5, "misfit": 0.001, "distance": 4}}, "fusion must be"),
        ({"fusion": {"share": 0.5, "misfit": 0.1, "distance": 2.9}}, "fusion must be"),
        ({"fusion": {"share": float("nan"), "misfit": 0.1, "distance": 4}}, "fusion must be"),
        ({"fusion": {"weight": 0.5, "misfit": 0.1, "distance": 4}}, "fusion must be"),
        ({"mds_share": 1.5}, "mds_share must be 0 to 1"),
        ({"mds_share": None}, "mds_share must be 0 to 1"),
        ({"metrics": {"gt": "45"}}, "metrics must be numbers by column"),
        ({"metrics_w8": {"gt": None}}, "metrics_w8 must be numbers by column"),
        ({"calibration": []}, "calibration must be an object"),
        ({"recipe": "mds"}, "recipe must be an object"),
    ],
)
def test_setting(tmp_path: Path, capsys, net: Net, change: dict, message: str) -> None:
    save_npz(tmp_path / "net.npz", net)
    assert message in refused(tmp_path, capsys, tmp_path / "net.npz", MANIFEST | change)


def test_incomplete_manifest(tmp_path: Path, capsys, net: Net) -> None:
    save_npz(tmp_path / "net.npz", net)
    line = refused(tmp_path, capsys, tmp_path / "net.npz", {"mirror": [0] * 5})
    assert "settings.json lacks fewest_joints, objective, refine_steps\n" in line


@pytest.mark.parametrize("text", [None, "", "{", "[]", "\xff"])
def test_unreadable_manifest(tmp_path: Path, capsys, net: Net, text: str | None) -> None:
    save_npz(tmp_path / "net.npz", net)
    if text is not None:
        (tmp_path / "net.json").write_text(text, "latin-1")
    assert main([str(tmp_path / "net.npz"), "--out", str(tmp_path / "out.h")]) == 1
    line = capsys.readouterr().err
    assert "manifest net.json" in line
    assert line.count("\n") == 1
    if text is None:
        assert "write one with fewest_joints, objective, refine_steps, mirror" in line
    assert not (tmp_path / "out.h").exists()


@pytest.mark.parametrize("name", ["", "2x", "a__b", "_a", "a b", "A", 'a"'])
def test_name(tmp_path: Path, net: Net, name: str) -> None:
    with pytest.raises(ExportError, match="lower-case"):
        write_header(net, ModelSettings(**MANIFEST), name, "net.npz", tmp_path / "out.h")
    assert list(tmp_path.iterdir()) == []


def test_place_that_cannot_be_written(tmp_path: Path, net: Net) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    for path in ("nowhere/out.h", "file/out.h", "folder"):
        with pytest.raises(ExportError, match="cannot write"):
            write_header(net, ModelSettings(**MANIFEST), "fconn", "net.npz", tmp_path / path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]
