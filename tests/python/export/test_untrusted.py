"""Weights and manifests from anywhere: sizes are checked before memory is taken, nothing outside
of the file is read, and whatever is wrong is said in one line."""

import io
import json
import os
import struct
import tracemalloc
import zipfile
import zlib
from pathlib import Path

import h5py
import numpy as np
import onnx
import pytest
import scipy.io
from exports import MANIFEST, check_exported, poses, refused, small_net
from onnx import TensorProto
from test_batch_norm import Onnx, by_onnx, linear, relu

from export.cli import main
from export.kinds import read_network
from export.layers import ExportError
from export.limits import LARGEST

NET = small_net(91, 64, 91)
TOO_LARGE = "at most 64 are read"


def save_npz(path: Path, **changes: bytes) -> Path:
    """NET; changes: what a member holds instead."""
    arrays = {f"weight{k}": layer[0] for k, layer in enumerate(NET)}
    arrays |= {f"bias{k}": layer[1] for k, layer in enumerate(NET)}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            data = io.BytesIO()
            np.save(data, array)
            archive.writestr(f"{name}.npy", changes.get(name, data.getvalue()))
    return path


def npy_header(shape: tuple[int, ...], dtype: str = "<f4") -> bytes:
    data = io.BytesIO()
    header = {"descr": dtype, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(data, header)
    return data.getvalue()


def peak_of_reading(path: Path) -> int:
    """The most memory, bytes, that it takes to refuse a file."""
    tracemalloc.start()
    with pytest.raises(ExportError):
        read_network(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak


# ---- .npz --------------------------------------------------------------------------------------


def test_npz_that_unpacks_to_much_more(tmp_path: Path, capsys) -> None:
    """Zeros: before, 1.4 MB took 2.8 GB of memory."""
    path = tmp_path / "net.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("weight0.npy", npy_header((128 << 18,)) + bytes(128 << 20))
    assert path.stat().st_size < 1 << 20
    assert f"the unpacked archive takes 128 MB, {TOO_LARGE}" in refused(tmp_path, capsys, path)
    assert peak_of_reading(path) < 1 << 20


def test_npz_that_lies_about_its_size(tmp_path: Path, capsys) -> None:
    """The directory says 1000 bytes of a member that unpacks to 128 MB."""
    path = tmp_path / "net.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("weight0.npy", bytes(128 << 20))
    data = bytearray(path.read_bytes())
    for mark, place in (b"PK\x03\x04", 22), (b"PK\x01\x02", 24):
        at = data.index(mark) + place
        assert struct.unpack_from("<I", data, at) == (128 << 20,)
        struct.pack_into("<I", data, at, 1000)
    path.write_bytes(data)
    assert "BadZipFile: Bad CRC-32" in refused(tmp_path, capsys, path)
    assert peak_of_reading(path) < 1 << 20


@pytest.mark.parametrize(
    ("member", "message"),
    [
        (npy_header((91, 1 << 40)), "buffer is smaller than requested size"),
        (npy_header((1 << 62, 1 << 62)), "not a readable .npz file: "),
        (npy_header((91, 64), "|O"), "not a readable .npz file: "),
        (npy_header((91, 64), "|V0"), "not a readable .npz file: "),
        (npy_header((91, 64)), "not a readable .npz file: "),
        (b"\x93NUMPY\x09\x00", "unknown version (9, 0) of .npy"),
        (b"\x93NUMPY\x01\x00\xff\xff" + b"(" * 65535, "not a readable .npz file: "),
        (b"cos\nsystem\n(S'exit 1'\ntR.", "not a readable .npz file: "),
        (b"", "not a readable .npz file: "),
    ],
)
def test_npz_member(tmp_path: Path, capsys, member: bytes, message: str) -> None:
    path = save_npz(tmp_path / "net.npz", weight0=member)
    assert message in refused(tmp_path, capsys, path)


def test_npz_of_another_compression(tmp_path: Path, capsys) -> None:
    with zipfile.ZipFile(tmp_path / "net.npz", "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("weight0.npy", npy_header((1,)))
    line = refused(tmp_path, capsys, tmp_path / "net.npz")
    assert "weight0.npy is compressed by a method other than deflate" in line


def test_npz_by_column(tmp_path: Path) -> None:
    """What NumPy writes of a transposed array, and of other types of floating point."""
    arrays = {f"weight{k}": np.asfortranarray(layer[0]) for k, layer in enumerate(NET)}
    arrays |= {f"bias{k}": layer[1].astype(">f8") for k, layer in enumerate(NET)}
    np.savez_compressed(tmp_path / "net.npz", **arrays)
    expected = linear(relu(linear(poses(), NET[0])), NET[1])
    check_exported(tmp_path, tmp_path / "net.npz", expected)


# ---- Every format ------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".npz", ".safetensors", ".onnx", ".keras", ".h5", ".tflite"])
def test_file_of_gigabytes(tmp_path: Path, capsys, suffix: str) -> None:
    path = tmp_path / f"net{suffix}"
    path.touch()
    os.truncate(path, 1 << 40)  # which takes no room on the disk
    assert f"the file takes 1048576 MB, {TOO_LARGE}" in refused(tmp_path, capsys, path)


def test_safetensors_that_says_more_than_it_has(tmp_path: Path, capsys) -> None:
    size = 1 << 40
    header = {"fc1.weight": {"dtype": "F32", "shape": [size // 4], "data_offsets": [0, size]}}
    for text in (json.dumps(header), "[" * 100_000, json.dumps(header).replace("F32", "F99")):
        data = text.encode()
        path = tmp_path / "net.safetensors"
        path.write_bytes(struct.pack("<Q", len(data)) + data)
        assert "not a readable .safetensors file" in refused(tmp_path, capsys, path)
    path.write_bytes(struct.pack("<Q", 1 << 60) + data)
    assert "not a readable .safetensors file" in refused(tmp_path, capsys, path)


# ---- HDF5 --------------------------------------------------------------------------------------


def keras_file(path: Path) -> h5py.File:
    """A file of weights whose dense/kernel is still to be written."""
    file = h5py.File(path, "w")
    file["dense/bias"] = NET[0][1]
    return file


def test_h5_that_is_larger_than_its_file(tmp_path: Path, capsys) -> None:
    """A dataset of which nothing is stored reads as zeros."""
    path = tmp_path / "net.h5"
    with keras_file(path) as file:
        file.create_dataset("dense/kernel", (1 << 20, 1 << 20), "f4", chunks=(1024, 1024))
    assert path.stat().st_size < 1 << 20
    line = refused(tmp_path, capsys, path)
    assert f"/dense/kernel takes 4194304 MB, {TOO_LARGE}" in line


def test_h5_whose_datasets_are_too_large_together(tmp_path: Path, capsys) -> None:
    with keras_file(tmp_path / "net.h5") as file:
        for k in range(4):
            file.create_dataset(f"dense_{k}/kernel", (LARGEST // 8,), "f4", chunks=(1024,))
    assert "more than 64 MB together" in refused(tmp_path, capsys, tmp_path / "net.h5")


def test_h5_that_lies_elsewhere(tmp_path: Path, capsys) -> None:
    """Links and storage in other files, of which the header would tell."""
    (tmp_path / "secret").write_bytes(bytes(range(256)) * 91)
    with h5py.File(tmp_path / "other", "w") as file:
        file["kernel"] = NET[0][0]
    path = tmp_path / "net.h5"
    with keras_file(path) as file:
        file["dense/kernel"] = h5py.ExternalLink(str(tmp_path / "other"), "kernel")
    assert "has bias" in refused(tmp_path, capsys, path)
    with h5py.File(path, "w") as file:
        file["dense"] = h5py.ExternalLink(str(tmp_path / "other"), "/")
    assert "dense is a link to elsewhere" in refused(tmp_path, capsys, path)
    with keras_file(path) as file:
        external = [(str(tmp_path / "secret"), 0, 91 * 64 * 4)]
        file.create_dataset("dense/kernel", (91, 64), "f4", external=external)
    assert "/dense/kernel lies in another file" in refused(tmp_path, capsys, path)
    with keras_file(path) as file:
        virtual = h5py.VirtualLayout((91, 64), "f4")
        virtual[:] = h5py.VirtualSource(str(tmp_path / "other"), "kernel", (91, 64))
        file.create_virtual_dataset("dense/kernel", virtual)
    assert "/dense/kernel lies in another file" in refused(tmp_path, capsys, path)


def test_h5_that_holds_itself(tmp_path: Path, capsys) -> None:
    with h5py.File(tmp_path / "net.h5", "w") as file:
        file.create_group("dense")["again"] = file["/"]
    refused(tmp_path, capsys, tmp_path / "net.h5")


def test_h5_of_other_types(tmp_path: Path, capsys) -> None:
    for values in (np.arange(5824).reshape(91, 64), np.array([b"x"] * 9), np.zeros((), "f4")):
        path = tmp_path / "net.h5"
        with keras_file(path) as file:
            file["dense/kernel"] = values
        line = refused(tmp_path, capsys, path)
        assert "layer 0: weight" in line
    with keras_file(path) as file:
        file.create_dataset("dense/kernel", (3,), h5py.string_dtype())
    assert "layer 0: weight" in refused(tmp_path, capsys, path)


def test_keras_archive_that_unpacks_to_gigabytes(tmp_path: Path, capsys) -> None:
    path = tmp_path / "net.keras"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("config.json", "{}")
        archive.writestr("model.weights.h5", bytes(70 << 20))
    assert f"the unpacked archive takes 70 MB, {TOO_LARGE}" in refused(tmp_path, capsys, path)


def test_keras_config_that_is_nested_deeply(tmp_path: Path, capsys) -> None:
    path = tmp_path / "net.keras"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("config.json", "[" * 1_000_000)
        archive.writestr("model.weights.h5", b"")
    assert "not a readable .keras file: RecursionError" in refused(tmp_path, capsys, path)
    nodes: list = []
    for _ in range(900):
        nodes = [nodes]
    layer = {"class_name": "Dense", "name": "d", "config": {"name": "d"}, "inbound_nodes": nodes}
    model = {"class_name": "Functional", "config": {"layers": [layer]}}
    with h5py.File(tmp_path / "net.h5", "w") as file:
        file.attrs["model_config"] = json.dumps(model)
    refused(tmp_path, capsys, tmp_path / "net.h5")


# ---- .onnx with data beside it -----------------------------------------------------------------


def save_external(tmp_path: Path, **changes: str) -> tuple[Path, np.ndarray]:
    """NET as PyTorch's exporter writes it: the tensors lie in net.onnx.data.  Returns what it
    computes; changes: of where the first tensor lies."""
    path = tmp_path / "net.onnx"
    model = Onnx().gemm(NET[0]).add("Relu").gemm(NET[1]).save(path)
    expected = by_onnx(model)
    onnx.save(model, path, save_as_external_data=True, size_threshold=0, location="net.onnx.data")
    model = onnx.load(path, load_external_data=False)
    for entry in model.graph.initializer[0].external_data:
        entry.value = changes.get(entry.key, entry.value)
    path.write_bytes(model.SerializeToString())
    return path, expected


def test_external_data(tmp_path: Path) -> None:
    path, expected = save_external(tmp_path)
    assert path.stat().st_size < 1000
    check_exported(tmp_path, path, expected)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"location": "../secret"}, "lies in another folder: ../secret"),
        ({"location": "/etc/passwd"}, "lies in another folder: /etc/passwd"),
        ({"location": ""}, "lies in another folder: no file named"),
        ({"location": "gone"}, "lies in gone, which is missing: keep it beside"),
        ({"location": "link"}, "lies in another folder: link"),
        ({"length": str(1 << 50)}, "c0 does not lie whole in net.onnx.data"),
        ({"length": "5"}, "c0 does not lie whole in net.onnx.data"),
        ({"length": "-1"}, "c0 does not lie whole in net.onnx.data"),
        ({"offset": str(1 << 50)}, "c0 does not lie whole in net.onnx.data"),
        ({"offset": "-8"}, "c0 does not lie whole in net.onnx.data"),
        ({"offset": "x"}, "not a readable .onnx file: ValueError"),
    ],
)
def test_external_data_refused(tmp_path: Path, capsys, changes: dict, message: str) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (tmp_path / "secret").write_bytes(bytes(91 * 64 * 4))
    (folder / "link").symlink_to(tmp_path / "secret")
    path, _ = save_external(folder, **changes)
    assert message in refused(tmp_path, capsys, path)


def test_external_data_of_gigabytes(tmp_path: Path, capsys) -> None:
    path, _ = save_external(tmp_path)
    os.truncate(tmp_path / "net.onnx.data", 1 << 40)
    model = onnx.load(path, load_external_data=False)
    first = model.graph.initializer[0]
    first.dims[:] = [1 << 18, 1 << 18]
    for entry in first.external_data:
        entry.value = {"length": str(1 << 38), "offset": "0"}.get(entry.key, entry.value)
    path.write_bytes(model.SerializeToString())
    assert f"the data beside the file takes 262144 MB, {TOO_LARGE}" in refused(
        tmp_path, capsys, path
    )


def test_onnx_tensor_that_says_more_than_it_has(tmp_path: Path, capsys) -> None:
    path = tmp_path / "net.onnx"
    model = Onnx().gemm(NET[0]).add("Relu").gemm(NET[1]).save(path)
    for dims in ([1 << 40, 1 << 20], [-91, -64], [91]):
        model.graph.initializer[0].dims[:] = dims
        path.write_bytes(model.SerializeToString())
        refused(tmp_path, capsys, path)
    model.graph.initializer[0].dims[:] = [64, 91]
    for kind in (TensorProto.INT32, TensorProto.STRING, TensorProto.COMPLEX64, 99):
        model.graph.initializer[0].data_type = kind
        path.write_bytes(model.SerializeToString())
        refused(tmp_path, capsys, path)


# ---- .mat --------------------------------------------------------------------------------------


def test_mat_that_unpacks_to_gigabytes(tmp_path: Path, capsys) -> None:
    packed = zlib.compressobj()
    data = b"".join(packed.compress(bytes(1 << 20)) for _ in range(128)) + packed.flush()
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM"
    path = tmp_path / "net.mat"
    path.write_bytes(header + struct.pack("<II", 15, len(data)) + data)
    assert TOO_LARGE in refused(tmp_path, capsys, path)


def element(kind: int, data: bytes) -> bytes:
    return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)


@pytest.mark.parametrize("compressed", [False, True])
def test_mat_of_cells_within_cells(tmp_path: Path, capsys, compressed: bool) -> None:
    """100,000 deep: SciPy would run out of stack, which ends the process."""
    cell = element(6, struct.pack("<II", 1, 0)) + element(5, struct.pack("<ii", 1, 1))
    cell += element(1, b"")
    size, cells = 8 + len(cell), 100_000
    tags = (struct.pack("<II", 14, size * left - 8) for left in range(cells, 0, -1))
    data = b"".join(tag + cell for tag in tags)
    if compressed:
        data = zlib.compress(data)
        data = struct.pack("<II", 15, len(data)) + data
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM"
    path = tmp_path / "net.mat"
    path.write_bytes(header + data)
    assert "holds more than 5000 values" in refused(tmp_path, capsys, path)


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("numbers", [np.ones((3, 4), np.float32), np.full((3, 4), 1j)])
def test_mat_with_numbers_of_no_type(tmp_path: Path, capsys, numbers, compressed: bool) -> None:
    """SciPy looks up the type without asking, and crashes."""
    path = tmp_path / "net.mat"
    scipy.io.savemat(path, {"net": {"layers": numbers}}, do_compression=False)
    data = path.read_bytes()
    kind = 7 if numbers.dtype == np.float32 else 9
    tag = struct.pack("<II", kind, numbers.real.nbytes)
    at = data.rindex(tag)  # of the imaginary parts, where there are any
    data = data[:at] + struct.pack("<I", 14) + data[at + 4 :]
    if compressed:
        packed = zlib.compress(data[128:])
        data = data[:128] + struct.pack("<II", 15, len(packed)) + packed
    path.write_bytes(data)
    assert "holds numbers or text of an unknown type, 14" in refused(tmp_path, capsys, path)


def test_mat_with_letters_of_no_type(tmp_path: Path, capsys) -> None:
    path = tmp_path / "net.mat"
    scipy.io.savemat(path, {"net": {"layers": "conv"}}, do_compression=False)
    data = path.read_bytes()
    at = data.rindex(struct.pack("<I", 4 << 16 | 16))  # a short element of UTF-8
    path.write_bytes(data[:at] + struct.pack("<I", 4 << 16 | 0xFF10) + data[at + 4 :])
    assert "holds numbers or text of an unknown type, 65296" in refused(tmp_path, capsys, path)


MANY = "holds more than 5000 values"
FLAT = "holds an array of less than two dimensions"


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        (element(5, struct.pack("<II", 1 << 30, 1)), MANY),
        (element(5, struct.pack("<II", 1, 0xFFFFFFFF)), MANY),
        (element(6, struct.pack("<4I", 1, 1, 1, 5001)), MANY),
        (struct.pack("<HHI", 5, 4, 1), FLAT),  # a short element
        (struct.pack("<II", 5, 0), FLAT),
    ],
)
@pytest.mark.parametrize("kind", [1, 2], ids=["cell", "struct"])
def test_mat_of_other_sizes(tmp_path: Path, capsys, kind: int, sizes: bytes, message: str) -> None:
    """SciPy takes memory for as many values as there may be, and crashes where no size is."""
    head = element(6, struct.pack("<II", kind, 0)) + sizes + element(1, b"net")
    if kind == 2:  # without fields
        head += element(5, struct.pack("<i", 8)) + element(1, b"")
    path = tmp_path / "net.mat"
    header = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM"
    path.write_bytes(header + element(14, head))
    assert message in refused(tmp_path, capsys, path)


@pytest.mark.slow
def test_mat_of_cells_that_hold_each_other(tmp_path: Path) -> None:
    """Thirty cells, of which each holds the next one ten times: 10^30 values."""
    path = tmp_path / "net.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        below = file.create_dataset("#refs#/end", data=[[1.0]])
        for k in range(30):
            links = np.array([[below.ref] * 10], dtype=h5py.ref_dtype)
            below = file.create_dataset(f"#refs#/{k}", data=links, dtype=h5py.ref_dtype)
        file["layers"] = below
    with pytest.raises(ExportError, match="holds more than 5000 values"):
        read_network(path)


# ---- Manifests ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[" * 100_000, "manifest settings.json is nested too deeply"),
        ('{"a":' * 100_000, "manifest settings.json is nested too deeply"),
        (json.dumps(MANIFEST)[:-1] + ', "x": ' + "[" * 50_000, "is nested too deeply"),
        (json.dumps(MANIFEST)[:-1] + ', "mds_share": 1e999}', "mds_share must be 0 to 1"),
        (json.dumps(MANIFEST)[:-1] + ', "mds_share": NaN}', "mds_share must be 0 to 1"),
        (json.dumps(MANIFEST)[:-1] + ', "refine_steps": ' + "9" * 5000 + "}", "manifest"),
        (json.dumps(MANIFEST)[:-1] + ', "objective": []}', "objective must be one of none,"),
        (json.dumps(MANIFEST)[:-1] + ', "missing": {}}', "missing must be one of zero, imputed"),
        ("\0" * 1000, "manifest settings.json: "),
    ],
)
def test_manifest(tmp_path: Path, capsys, monkeypatch, text: str, message: str) -> None:
    path = save_npz(tmp_path / "net.npz")
    monkeypatch.setattr("exports.json.dumps", lambda value: text)
    assert message in refused(tmp_path, capsys, path)


def test_manifest_of_gigabytes(tmp_path: Path, capsys) -> None:
    path = save_npz(tmp_path / "net.npz")
    manifest, out = path.with_suffix(".json"), tmp_path / "out.h"
    manifest.touch()
    os.truncate(manifest, 1 << 40)
    assert main([str(path), "--out", str(out)]) == 1
    assert "manifest net.json takes 1048576 MB, at most 4 are read" in capsys.readouterr().err
    assert not out.exists()
