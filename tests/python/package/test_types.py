"""The package's types, for those who call it."""

import sys
from pathlib import Path

import pytest
from package_support import ROOT

from reports.targets import run


@pytest.mark.slow
def test_types(tmp_path: Path):
    cache = f"--cache-dir={tmp_path}"
    run(sys.executable, "-m", "mypy", "--strict", cache, "tools/edmlift", cwd=ROOT)
