"""An archive has what was put in, and the same bytes each time."""

import tarfile
import zipfile
from pathlib import Path

import pytest

from channels.archives import write_tar, write_zip


@pytest.fixture
def files(tmp_path: Path) -> dict[str, bytes | Path]:
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    return {"top/run": program, "top/a.txt": b"a" * 1000}


def test_a_zip_file(tmp_path: Path, files: dict[str, bytes | Path]):
    one = write_zip(tmp_path / "one.zip", files)
    with zipfile.ZipFile(one) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == ["top/a.txt", "top/run"]
        assert archive.read("top/run") == b"#!/bin/sh\n"
        modes = [entry.external_attr >> 16 for entry in archive.infolist()]
    assert modes == [0o100644, 0o100755]
    backwards = dict(reversed(files.items()))
    assert write_zip(tmp_path / "two.zip", backwards).read_bytes() == one.read_bytes()


def test_a_tar_file(tmp_path: Path, files: dict[str, bytes | Path]):
    one = write_tar(tmp_path / "one.tgz", files)
    with tarfile.open(one) as archive:
        assert archive.getnames() == ["top/a.txt", "top/run"]
        assert [entry.mode for entry in archive] == [0o644, 0o755]
        assert archive.extractfile("top/a.txt").read() == b"a" * 1000
    backwards = dict(reversed(files.items()))
    assert write_tar(tmp_path / "two.tgz", backwards).read_bytes() == one.read_bytes()
