"""Builds the C library with a network of one's own as its only model, to measure it."""

import subprocess
from pathlib import Path

from data.paths import LIB, ROOT
from edmlift.library import Library
from export.cli import main as export_weights
from export.kinds import read_network
from export.layers import ExportError

FLAGS = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-w"]


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
    shared = folder / "libtrial.so"
    sources = [path for path in sorted(LIB.rglob("*.c")) if path.parent.name != "models"]
    include = [f"-I{ROOT / 'include'}", f"-I{LIB}"]
    command = ["cc", *FLAGS, *include, str(model), *map(str, sources), "-lm", "-o", str(shared)]
    try:
        subprocess.run(command, check=True, capture_output=True, text=True)
    except OSError as error:
        raise ExportError(f"no C compiler: {error}") from None
    except subprocess.CalledProcessError as error:
        raise ExportError(f"the library does not compile: {error.stderr}") from None
    return Library(name, shared)
