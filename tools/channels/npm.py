"""The npm package: the library as WebAssembly, a file a model, with SIMD and without.

    python tools/run.py channels.npm build/npm      what is in the package, in a folder

It needs clang and wasm-ld.  index.js takes the files with SIMD where the engine has it.
"""

import argparse
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from channels.archives import write_tar
from channels.version import version
from data.paths import LIB, ROOT
from reports.targets import INCLUDES, ToolError, run

NPM = ROOT / "tools" / "npm"
TEXTS = ("package.json", "index.js", "index.d.ts", "README.md")
MODELS = ("direct_w8", "direct_w16", "direct_f32", "distances_w8", "distances_w16", "distances_f32")
# What is added to a model's name, and the compiler's options for it.
VARIANTS = {"": ["-msimd128"], "_scalar": []}
# Loops that the compiler makes vectors of, or unrolls, are longer and no faster: the kernels say
# themselves where they want either.
COMPILE = [
    "clang", "--target=wasm32", "-std=c99", "-O2",
    "-fno-vectorize", "-fno-slp-vectorize", "-fno-unroll-loops",
    "-mbulk-memory", "-mnontrapping-fptoint",
    "-fvisibility=hidden", "-ffreestanding", f"-I{NPM / 'libc'}",
    "-ffunction-sections", "-fdata-sections", *INCLUDES,
]  # fmt: skip
# All of glue.c is exported, and nothing of the library.
LINK = [
    "wasm-ld", "--no-entry", "--export-dynamic", "--gc-sections", "--strip-all", "--stack-first",
    "-z", "stack-size=16384",
]  # fmt: skip


def build(folder: Path) -> list[Path]:
    """edmlift-VERSION.tgz, as `npm pack` would make it."""
    with tempfile.TemporaryDirectory() as temporary:
        files = package_files(Path(temporary))
        archive = write_tar(
            folder / f"edmlift-{version()}.tgz", {f"package/{f.name}": f for f in files}
        )
    return [archive]


def package_files(folder: Path) -> list[Path]:
    """All that the package has; what is compiled comes into the folder."""
    texts = [*(NPM / name for name in TEXTS), ROOT / "LICENSE"]
    return [*texts, *compile_models(folder)]


def compile_models(
    folder: Path, models: Sequence[str] = MODELS, variants: Iterable[str] = VARIANTS
) -> list[Path]:
    """MODEL.wasm and MODEL_scalar.wasm in a folder."""
    programs = []
    with tempfile.TemporaryDirectory() as temporary:
        for variant in variants:
            library = compile_library(Path(temporary), VARIANTS[variant])
            for model in models:
                glue = Path(temporary) / "glue.o"
                options = [*VARIANTS[variant], "-fvisibility=default", f"-DMODEL={model}"]
                run(*COMPILE, *options, "-c", NPM / "glue.c", "-o", glue)
                program = folder / f"{model}{variant}.wasm"
                run(*LINK, glue, *library, "-o", program)
                programs.append(program)
    return programs


def compile_library(folder: Path, options: Sequence[str]) -> list[Path]:
    """The library's object files."""
    objects = []
    for source in sorted(LIB.rglob("*.c")):
        if source.match("models/fcon*.c") or source.match("*_q.c") and source.stem != "predict_q":
            continue
        item = folder / f"{source.parent.name}_{source.stem}.o"
        run(*COMPILE, *options, "-c", source, "-o", item)
        objects.append(item)
    return objects


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where the package's files are written")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    try:
        for file in package_files(folder):
            if file.parent != folder:
                (folder / file.name).write_bytes(file.read_bytes())
    except ToolError as error:
        print(f"channels.npm: {error}", file=sys.stderr)
        return 1
    print(f"{folder}: the npm package {version()}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
