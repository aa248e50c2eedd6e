"""tools/demo and tools/check say what is wrong before they begin."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from support import ROOT


def said_in(root: Path, program: str) -> str:
    """What a program says in a checkout in which it cannot build."""
    (root / "tools").mkdir()
    for name in (program, "setup.sh"):
        shutil.copy(ROOT / "tools" / name, root / "tools")
    done = subprocess.run([root / "tools" / program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (1, "")
    return done.stderr


@pytest.mark.parametrize("program", ["demo", "check", "bench"])
def test_a_build_folder_that_cannot_be_made(tmp_path: Path, program: str) -> None:
    (tmp_path / "build").write_text("a file is in the way")
    line = f"Cannot write into {tmp_path}/build: copy the repository to a folder of your own.\n"
    assert said_in(tmp_path, program) == line


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_checkout_that_was_built_before(tmp_path: Path) -> None:
    (tmp_path / "build" / "log").mkdir(parents=True)
    (tmp_path / "build" / "log").chmod(0o555)
    assert "Cannot write into" in said_in(tmp_path, "demo")
