"""What tests of lift_stdin share: how it is run, poses, and what it answers.

EDMLIFT_LIFT_STDIN names the program; without it, the one in build/dev, or skipped if not built.
"""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from support import EXAMPLES, ROOT

PROGRAM = Path(
    os.environ.get("EDMLIFT_LIFT_STDIN", ROOT / "build" / "dev" / "examples" / "lift_stdin")
)
if "EDMLIFT_LIFT_STDIN" not in os.environ and not PROGRAM.exists():
    pytest.skip("lift_stdin is not built", allow_module_level=True)

WALK = np.loadtxt(EXAMPLES / "walk.csv", delimiter=",").reshape(-1, 14, 3)


def text(pose: np.ndarray, separator: str = ",") -> str:
    """A line without its end; pose [14,2] or [14,3]."""
    return separator.join(f"{number:g}" for number in np.ravel(pose))


def run(data: str | bytes, *options: str) -> subprocess.CompletedProcess:
    data = data.encode() if isinstance(data, str) else data
    return subprocess.run([PROGRAM, *options], input=data, capture_output=True, timeout=300)


def as_json(pose: np.ndarray, **members) -> str:
    return json.dumps(members | {"keypoints": np.round(pose, 6).tolist()})


def objects(result: subprocess.CompletedProcess) -> list[dict]:
    return [json.loads(line) for line in result.stdout.decode("utf-8").splitlines()]
