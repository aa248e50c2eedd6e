"""What tests share: where the data are, and skips that say where to get what is missing."""

import ctypes
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from builds import need

from reports.targets import INCLUDES, SOURCES, library_flags

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "data"
MOTION = Path(os.environ.get("EDMLIFT_DATA", ROOT.parent / "shared" / "data"))
TRAIN, TEST = "cmu14_train.npz", "cmu14_test.npz"


def need_library() -> None:
    """Skips the test where the library is not built; one that is named must be there."""
    built = ROOT / "build" / "dev" / "libedmlift_tools.so"
    if "EDMLIFT_LIBRARY" not in os.environ and not built.exists():
        pytest.skip("the tools' library is not built: cmake -B build/dev -DEDMLIFT_TOOLS=ON")


def need_motion(name: str) -> Path:
    """A file or folder of the motion data; skips the test where it is not there."""
    if not (MOTION / name).exists():
        pytest.skip("no motion data: docs/motion-data.md says where to get them (EDMLIFT_DATA)")
    return MOTION / name


def run_tool(program: str, *arguments: object) -> subprocess.CompletedProcess:
    """A program of tools/, such as "evaluate.py", or one by the name that run.py gives it."""
    words = [program] if program.endswith(".py") else ["run.py", program]
    command = [sys.executable, str(ROOT / "tools" / words[0]), *words[1:], *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def read_joints(name: str, numbers: int) -> np.ndarray:
    """Joints [F,14,numbers] of a file of examples/data."""
    rows = np.loadtxt(EXAMPLES / f"{name}.csv", delimiter=",", ndmin=2)
    return rows.reshape(len(rows), 14, numbers)


def build_model(header: Path, *options: str) -> Path:
    """A shared library of the C library's sources and the model of a generated header."""
    need("gcc")
    model, shared = header.with_suffix(".c"), header.with_suffix(".so")
    model.write_text(f'#include "network/kernels.h"\n#include "{header.name}"\n')
    sources = [source for source in SOURCES if source.parent.name != "models"]
    flags = ["gcc", *library_flags(), "-O2", "-fPIC", "-shared", *INCLUDES, *options]
    subprocess.run([*flags, model, *sources, "-lm", "-o", shared], check=True)
    return shared


def load_model(shared: Path, name: str) -> Callable[[np.ndarray], np.ndarray]:
    """edml_predict() of a model: EDMs [F,91] -> distances [F,91]; its checksum is checked."""
    c = ctypes.CDLL(str(shared))
    model = ctypes.byref(ctypes.c_char.in_dll(c, f"edml_{name}"))
    c.edml_model_work_bytes.restype = ctypes.c_size_t
    assert c.edml_model_check(model) == 0
    size = ctypes.c_size_t(c.edml_model_work_bytes(model))
    work = ctypes.create_string_buffer(size.value)

    def predict(edms: np.ndarray) -> np.ndarray:
        edms = np.ascontiguousarray(edms, np.float32)
        out = np.zeros_like(edms)
        for edm, distance in zip(edms, out, strict=True):
            arrays = (ctypes.c_void_p(array.ctypes.data) for array in (distance, edm))
            assert c.edml_predict(*arrays, model, work, size) == 0
        return out

    return predict
