"""What tests of the package share: sample data, and skips where the library is not built."""

import os
from pathlib import Path

import numpy as np
import pytest

from edmlift import _binding

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT / "examples" / "data"
WALK = np.loadtxt(DATA / "walk.csv", delimiter=",").reshape(-1, 14, 3)
LIFT_STDIN = Path(
    os.environ.get("EDMLIFT_LIFT_STDIN", ROOT / "build" / "dev" / "examples" / "lift_stdin")
)


def need_library() -> None:
    """Skips where the library is not built; one that is named must be there."""
    if "EDMLIFT_LIBRARY" not in os.environ and not _binding.default_path().exists():
        pytest.skip("the tools' library is not built: -DEDMLIFT_TOOLS=ON")


def need_lift_stdin() -> None:
    """Skips where lift_stdin is not built; one that is named must be there."""
    if "EDMLIFT_LIFT_STDIN" not in os.environ and not LIFT_STDIN.exists():
        pytest.skip("lift_stdin is not built")
