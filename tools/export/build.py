"""Builds the C library with a network of one's own as its only model, to measure it."""

import subprocess
import tempfile
from pathlib import Path

from data.paths import LIB, ROOT
from edmlift.library import Library
from export.cli import main as export_weights
from export.kinds import read_network
from export.layers import ExportError

FLAGS = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC"]


def build_library(weights: Path, folder: Path, form: str = "f32") -> Library:
    """The library with these weights, compiled into a folder.  Raises ExportError.

    Its only model has the name of its kind and of the form: edml_distances_f32.
    """
    folder.mkdir(parents=True, exist_ok=True)
    kind, _ = read_network(weights)
    name = f"{kind.model}_{form}"
    header = folder / f"{name}.h"
    options = [] if form == "f32" else ["--quantise", form]
    if export_weights([str(weights), "--out", str(header), *options]) != 0:
        raise ExportError(f"{weights}: not exported")
    model = folder / "model.c"
    model.write_text(f'#include "network/kernels.h"\n#include "{header.name}"\n')
    return Library(name, compile_shared(model, folder / "libtrial.so"))


def compile_shared(model: Path, shared: Path, *options: str) -> Path:
    """The shared library of a model's C file and of lib/ without its models.  Raises ExportError.

    Each file of lib/ is compiled by itself, so that ccache knows it the next time.
    """
    command = ["cc", *FLAGS, f"-I{ROOT / 'include'}", f"-I{LIB}", *options]
    sources = [path for path in sorted(LIB.rglob("*.c")) if path.parent.name != "models"]
    with tempfile.TemporaryDirectory() as folder:
        objects = [f"{folder}/{number}.o" for number in range(len(sources))]
        for source, item in zip(sources, objects, strict=True):
            _compile(*command, "-c", str(source), "-o", item)
        _compile(*command, "-shared", str(model), *objects, "-lm", "-o", str(shared))
    return shared


def _compile(*command: str) -> None:
    try:
        subprocess.run(command, check=True, capture_output=True, text=True)
    except OSError as error:
        raise ExportError(f"no C compiler: {error}") from None
    except subprocess.CalledProcessError as error:
        raise ExportError(f"the library does not compile: {error.stderr}") from None
