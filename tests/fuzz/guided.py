"""Runs a test of tests/python/untrusted by Atheris: guided by coverage, or on an input's file.

    guided.py TARGET [OPTION of libFuzzer...] [FILE or FOLDER...]

TARGET is the name of the test without test_.  Hypothesis makes the test's files of the fuzzer's
bytes, so that an input is a file of choices, and not one that a reader reads.
"""

import importlib.util
import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import atheris

ROOT = Path(__file__).resolve().parents[2]
TESTS = ROOT / "tests" / "python"
LIBRARY = ROOT / "build" / "fuzz" / "build" / "libedmlift_shared.so"
READERS = ["edmlift", "export", "data"]  # whose coverage guides


def load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def find_test(name: str) -> Callable[..., None]:
    """The test, of whose module's imports the coverage is counted."""
    for path in sorted((TESTS / "untrusted").glob("test_*.py")):
        if f"def test_{name}(" in path.read_text("utf-8"):
            with atheris.instrument_imports(include=READERS):
                found: Callable[..., None] = getattr(load(path), f"test_{name}")
            return found
    sys.exit(f"guided.py: no target {name}: tools/fuzz --list names them")


def main() -> None:
    name = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    os.environ.setdefault("EDMLIFT_LIBRARY", str(LIBRARY))
    sys.path[:0] = [str(ROOT / "tools"), str(TESTS)]
    run = find_test(name).hypothesis.fuzz_one_input  # type: ignore[attr-defined]

    def one_input(data: bytes) -> None:
        run(data)  # and returns nothing

    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
