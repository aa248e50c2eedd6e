"""What tests share: where the data are, and skips that say where to get what is missing."""

import ctypes
import io
import os
import runpy
import subprocess
import sys
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from builds import need

from export.build import compile_shared

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "data"
MOTION = Path(os.environ.get("EDMLIFT_DATA", ROOT.parent / "shared" / "data"))
TRAIN, TEST = "cmu14_train.npz", "cmu14_test.npz"
OTHERS_TRAIN, OTHERS_TEST = "labs14_train.npz", "labs14_test.npz"  # of other laboratories


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
    """A program of tools/, such as "evaluate.py", or one by the name that run.py gives it.

    It runs in this process, because to import what it needs takes longer than most tests.
    """
    words = [program] if program.endswith(".py") else ["run.py", program]
    command = [str(ROOT / "tools" / words[0]), *words[1:], *map(str, arguments)]
    out, err, status = io.StringIO(), io.StringIO(), None
    with redirect_stdout(out), redirect_stderr(err), patch.object(sys, "argv", [*command]):
        try:
            runpy.run_path(command[0], run_name="__main__")
        except SystemExit as end:
            status = end.code
            if isinstance(status, str):  # as Python does
                print(status, file=err)
                status = 1
    return subprocess.CompletedProcess(command, status or 0, out.getvalue(), err.getvalue())


def read_joints(name: str, numbers: int) -> np.ndarray:
    """Joints [F,14,numbers] of a file of examples/data."""
    rows = np.loadtxt(EXAMPLES / f"{name}.csv", delimiter=",", ndmin=2)
    return rows.reshape(len(rows), 14, numbers)


RUN_NETWORK = """\
void run_network(const edml_model *model, void *values);
void run_network(const edml_model *model, void *values)
{
    static edml_fconv_work work;
    if (model->predict_f32 != NULL)
        model->predict_f32(values, values, model, &work.lift.of.network.units);
    else
        model->predict_q(values, values, model, &work.lift.of.network.units);
}
"""
VALUES = 196  # what a network reads and gives at most
ROWS = 8  # EDML_ROWS


def build_model(header: Path, *options: str) -> Path:
    """A shared library of the C library's sources and the model of a generated header."""
    need("cc")
    model = header.with_suffix(".c")
    model.write_text(f'#include "network/kernels.h"\n#include "{header.name}"\n{RUN_NETWORK}')
    return compile_shared(model, header.with_suffix(".so"), *options)


def load_network(shared: Path, name: str, rows: int) -> Callable[[np.ndarray], np.ndarray]:
    """The network of a model, whose checksum is checked: what it reads [F,in] -> [F,out].

    A quantised one reads and gives integers, Q24.  An equivariant one has `rows`, and gives them
    and then their mirror rows; others give as many values, 91.
    """
    c = ctypes.CDLL(str(shared))
    model = ctypes.byref(ctypes.c_char.in_dll(c, f"edml_{name}"))
    assert c.edml_model_check(model) == 0
    number = np.float32 if name.endswith("f32") else np.int32
    count = -(-rows // ROWS) * ROWS
    places = np.arange(rows) if rows == 91 else np.r_[:rows, count : count + rows]

    def run(inputs: np.ndarray) -> np.ndarray:
        values = np.zeros((len(inputs), VALUES), number)
        values[:, : inputs.shape[1]] = inputs
        for row in values:
            c.run_network(model, ctypes.c_void_p(row.ctypes.data))
        return values[:, places]

    return run
