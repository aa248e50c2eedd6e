"""Imports of the research tools point down, run at the top of a file, and make no circle."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from support import ROOT

TOOLS = ROOT / "tools"
FOLDERS = (
    "edmlift", "data", "model", "reports", "training", "fitting", "export", "evaluation",
    "experiments", "channels", "fuzzing",
)  # fmt: skip
# What each may import besides itself; tools/README.md says the same.
MAY_IMPORT = {
    "edmlift": (),
    "data": ("edmlift",),
    "model": ("edmlift", "data"),
    "reports": ("edmlift", "data", "model"),
    "training": ("edmlift", "data", "model"),
    "fitting": ("edmlift", "data", "model", "reports", "training"),
    "export": ("edmlift", "data", "model", "training"),
    "evaluation": ("edmlift", "data", "model", "reports", "export"),
    "experiments": ("edmlift", "data", "model", "reports", "training", "export", "evaluation"),
    "channels": ("edmlift", "data", "reports"),
    "fuzzing": ("edmlift", "data", "reports"),
}
# Packages that not everyone has; only these may be imported inside a function.
OPTIONAL = {"torch", "onnx", "onnxruntime", "h5py", "safetensors", "tflite"}
FILES = sorted(path for folder in FOLDERS for path in (TOOLS / folder).rglob("*.py"))
ENTRIES = sorted(TOOLS.glob("*.py"))


def name_of(path: Path) -> str:
    """data/mocap.py -> "data.mocap"."""
    parts = path.relative_to(TOOLS).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(path) for path in FILES}


def imported(tree: ast.AST) -> Iterator[tuple[ast.AST, str]]:
    """Each import of a file: its statement, and the dotted name of the module."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield node, inner if inner in MODULES else node.module


def ours(path: Path) -> set[str]:
    """The modules of these folders that a file imports."""
    names = {name for _, name in imported(ast.parse(path.read_text("utf-8")))}
    return names & MODULES


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_arrows_point_down(path: Path):
    folder = name_of(path).partition(".")[0]
    others = {name.partition(".")[0] for name in ours(path)} - {folder}
    assert others <= set(MAY_IMPORT[folder])


def test_no_circle():
    graph = {name_of(path): ours(path) - {name_of(path)} for path in FILES}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(f"import circle: {' -> '.join(error.args[1])}")


@pytest.mark.parametrize("path", [*FILES, *ENTRIES], ids=name_of)
def test_only_optional_packages_are_imported_inside_a_function(path: Path):
    tree = ast.parse(path.read_text("utf-8"))
    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
    inside = {name.partition(".")[0] for function in functions for _, name in imported(function)}
    assert inside <= OPTIONAL


def test_the_page_says_so():
    page = (TOOLS / "README.md").read_text("utf-8")
    for folder, others in MAY_IMPORT.items():
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{folder}/` |")]
        assert row.rstrip(" |").rpartition("|")[2].split() == [
            *(f"`{other}`" for other in others)
        ] or not others, folder


def test_the_oracle_imports_no_script():
    assert ours(TOOLS / "model" / "reference.py") == {"edmlift.joints", "model.constants"}
