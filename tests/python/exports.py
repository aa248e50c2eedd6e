"""What tests of the exporter share: a network, a manifest, an export and a refused one."""

import json
from pathlib import Path

import numpy as np
from support import build_model, load_network

from export.cli import main
from export.readers import read_layers

MANIFEST = {
    "fewest_joints": 10,
    "objective": "none",
    "refine_steps": 0,
    "mirror": [0.5, -1.25, 0.1, 2, 0],
    "fusion": {"share": 0.75, "misfit": 0.5, "distance": 4},
    "recipe": {"name": "mds", "seed": 7},
    "data": {"frames": 1000},
    "metrics": {"gt": 45.25, "n10": 60},
}
Net = list[tuple[np.ndarray, np.ndarray]]


def make_net(shape: tuple[int, ...]) -> Net:
    rng = np.random.default_rng(1)
    net = [
        (rng.normal(0, 0.1, (n, m)).astype(np.float32), rng.normal(0, 0.1, m).astype(np.float32))
        for n, m in zip(shape[:-1], shape[1:], strict=True)
    ]
    # What a text might spoil: both zeros, a subnormal, extremes; and biases that are
    # integers, which a .mat holds as bytes.
    tiny, huge = np.finfo(np.float32).smallest_subnormal, np.finfo(np.float32).max
    net[0][0][0, :6] = [0.0, -0.0, tiny, -huge, 1.0, 0.1]
    net[0][1][:] = np.arange(len(net[0][1])) % 3
    return net


def export(tmp_path: Path, weights: Path, manifest: dict | None = None, name: str = "fconn"):
    """Exit status and header of an export."""
    settings = tmp_path / "settings.json"
    settings.write_text(json.dumps(MANIFEST if manifest is None else manifest))
    header = tmp_path / "out.h"
    arguments = [weights, "--manifest", settings, "--out", header, "--name", name]
    return main([str(argument) for argument in arguments]), header


def refused(tmp_path: Path, capsys, weights: Path, manifest: dict | None = None) -> str:
    """The one line that a failed export prints; what was there before must still be."""
    for before in (None, "before"):
        header = tmp_path / "out.h"
        header.write_text(before) if before else header.unlink(missing_ok=True)
        files = sorted(tmp_path.iterdir())
        status, _ = export(tmp_path, weights, manifest)
        printed = capsys.readouterr()
        assert (status, printed.out) == (1, "")
        assert sorted({*tmp_path.iterdir()} - {*files}) in ([], [tmp_path / "settings.json"])
        assert header.read_text() == before if before else not header.exists()
    assert printed.err.startswith("export_weights: ")
    assert printed.err.count("\n") == 1
    return printed.err


# ---- What a network computes -------------------------------------------------------------------


def small_net(*shape: int) -> Net:
    """A random network that computes numbers near 1 in all of its layers."""
    rng = np.random.default_rng(5)
    return [
        (
            rng.normal(0, n**-0.5, (n, m)).astype(np.float32),
            rng.normal(0, 0.3, m).astype(np.float32),
        )
        for n, m in zip(shape[:-1], shape[1:], strict=True)
    ]


def poses(count: int = 20) -> np.ndarray:
    """Made-up inputs [F,91] of a network of distances."""
    return np.random.default_rng(6).uniform(0, 2, (count, 91)).astype(np.float32)


def check_exported(tmp_path: Path, weights: Path, expected: np.ndarray, in_c: bool = False) -> None:
    """The file is exported, and its network computes what is expected [F,91] of poses(), behind
    the ReLU that the C kernel ends with: in NumPy, and compiled with the C library."""
    values = poses(len(expected)).astype(float)
    for weight, bias in read_layers(weights):
        values = np.maximum(values @ weight.astype(float) + bias, 0)
    expected = np.maximum(expected, 0)
    assert 0.1 < expected.max() < 100
    assert np.allclose(values, expected, rtol=1e-5, atol=1e-5)
    status, header = export(tmp_path, weights)
    assert status == 0
    if in_c:
        run = load_network(build_model(header), "fconn_f32", 91)
        assert np.allclose(run(poses(len(expected))), expected, rtol=1e-5, atol=1e-5)
