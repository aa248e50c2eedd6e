"""The sdist: what `pip install` compiles where no wheel fits."""

import subprocess
import sys
from pathlib import Path

from data.paths import ROOT


def build(folder: Path) -> list[Path]:
    """Writes edmlift-VERSION.tar.gz, by scikit-build-core."""
    code = "import sys, scikit_build_core.build as b; print(b.build_sdist(sys.argv[1]))"
    done = subprocess.run(
        [sys.executable, "-c", code, folder], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        raise OSError(f"scikit-build-core made no sdist: {done.stderr.strip().splitlines()[-1]}")
    return [folder / done.stdout.splitlines()[-1]]
