"""Puts tools/ on the path, so that tests import what scripts there import."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))


def run_tool(program: str, *arguments: object) -> subprocess.CompletedProcess:
    """A program of the tools, by the name that tools/run.py gives it, as a command."""
    command = [sys.executable, str(ROOT / "tools" / "run.py"), program, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)
