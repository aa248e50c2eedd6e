"""tools/demo in a folder that looks like a new clone."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from data.paths import ROOT

PARTS = ["include", "lib", "gen", "examples", "tools"]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_demo_makes_what_it_names(tmp_path: Path) -> None:
    for part in PARTS:
        shutil.copytree(ROOT / part, tmp_path / part, ignore=shutil.ignore_patterns("__pycache__"))
    environment = tmp_path / "build" / "venv-demo"  # the tests' own, which has more
    (environment / "bin").mkdir(parents=True)
    python = environment / "bin" / "python"
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    shutil.copy(ROOT / "tools" / "requirements-demo.txt", environment / "requirements.txt")

    known = {n: v for n, v in os.environ.items() if not n.startswith(("EDMLIFT_", "PYTHONPATH"))}
    done = subprocess.run(
        [tmp_path / "tools" / "demo"], capture_output=True, text=True, env=known, timeout=900
    )
    assert done.returncode == 0, done.stdout + done.stderr
    made = [tmp_path / "build" / "demo" / name for name in ("walk.html", "walk.gif", "walk.png")]
    for path in made:
        assert str(path) in done.stdout and path.stat().st_size > 50_000, path
    assert "39 of 39 poses lifted; mean error" in done.stdout
