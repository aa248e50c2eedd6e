"""The npm package: the library as WebAssembly, a file a model, with SIMD and without.

    python tools/run.py channels.browser.npm build/npm      what is in the package, in a folder

It needs clang and wasm-ld.  index.js takes the files with SIMD where the engine has it.
"""

import argparse
import shutil
import sys
import tarfile
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from channels.amalgamation.amalgamate import amalgamate
from channels.archives import write_tar
from channels.version import version
from data.paths import DOCS, ROOT
from reports.targets import ToolError, run
from reports.wasm import COMPILE, EXPORTED, LINK, NPM

PAGE, EXAMPLE = DOCS / "browser.md", ROOT / "examples" / "javascript" / "lift.mjs"
TEXTS = ("package.json", "index.js", "index.d.ts", "README.md")
MODELS = ("direct_w8", "direct_w16", "direct_f32", "distances_w8", "distances_w16", "distances_f32")
PARTS = ("angles", "body", "camera", "many", "video")
# What is added to a model's name, and the compiler's options for it.
VARIANTS = {"": ["-msimd128"], "_scalar": []}


def build(out: Path) -> list[Path]:
    """edmlift-VERSION.tgz, as `npm pack` would make it."""
    with tempfile.TemporaryDirectory() as temporary:
        files = {f"package/{file.name}": file for file in package_files(Path(temporary))}
        return [write_tar(out / f"edmlift-{version()}.tgz", files)]


def check(artefacts: Sequence[Path]) -> None:
    """Installs the package into an empty folder, and lifts a pose; raises ToolError."""
    (tarball,) = artefacts
    with tempfile.TemporaryDirectory() as temporary:
        install(tarball, Path(temporary))
        shutil.copy(EXAMPLE, temporary)
        said = run("node", EXAMPLE.name, cwd=temporary)
        if said not in PAGE.read_text("utf-8"):
            raise ToolError(f"{EXAMPLE.name} says what {PAGE.name} does not show:\n{said}")


def install(tarball: Path, folder: Path) -> None:
    """The package of a tarball into a project's folder."""
    if shutil.which("npm"):
        quiet = ("--offline", "--no-audit", "--no-fund", "--cache", folder / "cache")
        run("npm", "install", tarball.resolve(), *quiet, cwd=folder)
    else:  # which is 300 packages of Debian: as it does with a package that needs no others
        modules = folder / "node_modules"
        with tarfile.open(tarball) as archive:
            archive.extractall(modules, filter="data")
        (modules / "package").rename(modules / "edmlift")


def write_package(folder: Path) -> None:
    """All files of the package into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in package_files(folder):
        if file.parent != folder:
            (folder / file.name).write_bytes(file.read_bytes())


def package_files(folder: Path) -> list[Path]:
    """All that the package has; what is compiled comes into the folder."""
    texts = [*(NPM / name for name in TEXTS), ROOT / "LICENSE"]
    return [*texts, *compile_models(folder)]


def compile_models(folder: Path) -> list[Path]:
    """MODEL.wasm and MODEL_scalar.wasm in a folder."""
    with tempfile.TemporaryDirectory() as temporary:
        source = Path(temporary)
        amalgamate(MODELS, PARTS, source)
        return [
            program
            for variant, options in VARIANTS.items()
            for program in compile_variant(source, folder, variant, options)
        ]


def compile_variant(
    source: Path, folder: Path, variant: str, options: Sequence[str]
) -> Iterator[Path]:
    """A program a model; the library is compiled once for all.

    Commands name no folder of their own, so that ccache knows what was compiled in another.
    """
    library, glue = "edmlift.o", "glue.o"
    compiler = [*COMPILE, *options, "-I."]
    run(*compiler, "-c", "edmlift.c", "-o", library, cwd=source)
    for model in MODELS:
        program = folder.resolve() / f"{model}{variant}.wasm"
        run(*compiler, *EXPORTED, f"-DMODEL={model}", "-c", NPM / "glue.c", "-o", glue, cwd=source)
        run(*LINK, glue, library, "-o", program, cwd=source)
        program.chmod(0o644)  # it is no program to the system
        yield program


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where the package's files are written")
    folder = parser.parse_args().folder
    try:
        write_package(folder)
    except ToolError as error:
        print(f"channels.browser.npm: {error}", file=sys.stderr)
        return 1
    print(f"{folder}: the npm package {version()}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
