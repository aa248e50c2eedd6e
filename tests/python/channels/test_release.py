"""A release: built twice, compared, tried, and in its folder only when all of it is right."""

import hashlib
import itertools
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from support import ROOT, run_tool

from channels import release
from channels.release import ReleaseError
from channels.version import version

PAGE = (ROOT / "docs" / "release.md").read_text("utf-8")


def channel(
    name: str,
    content: Callable[[], bytes],
    check: Callable[[list[Path]], None] = lambda files: None,
) -> dict[str, SimpleNamespace]:
    """A channel that writes one file."""

    def build(folder: Path) -> list[Path]:
        (folder / name).write_bytes(content())
        return [folder / name]

    return {name: SimpleNamespace(build=build, check=check)}


def test_the_files_and_their_sums(tmp_path: Path):
    tried = []
    wanted = channel("b.zip", lambda: b"b", tried.extend) | channel("a.zip", lambda: b"a")
    out = tmp_path / "dist"
    assert release.release(wanted, out, check=True) == [out / "a.zip", out / "b.zip"]
    assert [path.name for path in tried] == ["b.zip"]
    assert sorted(path.name for path in out.iterdir()) == ["SHA256SUMS", "a.zip", "b.zip"]
    told = subprocess.run(["sha256sum", "-c", "SHA256SUMS"], cwd=out, capture_output=True)
    assert told.returncode == 0, told.stderr
    assert hashlib.sha256(b"a").hexdigest() in (out / "SHA256SUMS").read_text()
    release.release(channel("c.zip", lambda: b"c"), out, check=False)
    assert sorted(path.name for path in out.iterdir()) == ["SHA256SUMS", "c.zip"]


def test_other_bytes_the_second_time(tmp_path: Path):
    count = itertools.count()
    wanted = channel("a.zip", lambda: str(next(count)).encode())
    with pytest.raises(ReleaseError, match=r"a\.zip has other bytes"):
        release.release(wanted, tmp_path / "dist", check=False)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_does_not_work(tmp_path: Path):
    def refuse(files: list[Path]) -> None:
        raise ReleaseError("the sketch does not run")

    with pytest.raises(ReleaseError, match="the sketch does not run"):
        release.release(channel("a.zip", lambda: b"a", refuse), tmp_path / "dist", check=True)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_of_someone_else(tmp_path: Path):
    (tmp_path / "mine.txt").write_text("keep")
    with pytest.raises(ReleaseError, match="has other files"):
        release.release(channel("a.zip", lambda: b"a"), tmp_path, check=False)
    assert (tmp_path / "mine.txt").read_text() == "keep"


@pytest.mark.parametrize(
    ("heading", "right"),
    [("## {}, 2026-12-01", True), ("## {}, unreleased", False), ("## 0.0.1, 2026-12-01", False)],
)
def test_the_changelog_has_a_date(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, heading: str, right: bool
):
    (tmp_path / "CHANGELOG.md").write_text(f"# Changelog\n\n{heading.format(version())}\n")
    monkeypatch.setattr(release, "ROOT", tmp_path)
    if right:
        release.is_dated()
    else:
        with pytest.raises(ReleaseError, match=r"begins with .*--draft"):
            release.is_dated()


def test_changes_without_a_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(release, "ROOT", tmp_path)
    subprocess.run(["git", "init", "-q", tmp_path], check=True)
    release.is_committed()
    (tmp_path / "new.c").write_text("int x;\n")
    with pytest.raises(
        ReleaseError, match=r"commit first, or give --draft: 1 changed, such as new\.c"
    ):
        release.is_committed()


def test_each_channel_says_what_it_is():
    known = release.channels()
    assert list(known) == ["arduino", "esp_idf", "npm", "one_file", "page", "wheels"]
    assert all((module.__doc__ or "").strip() for module in known.values())
    assert "release" not in known and (ROOT / "tools" / "release").is_file()


def test_the_page_has_the_names_of_the_files():
    """As the channels write them, and other pages say them; V or VERSION is the version."""
    sources = "".join(p.read_text("utf-8") for p in (ROOT / "tools" / "channels").rglob("*.py"))
    named = set(re.findall(r"^\| `(edmlift-.+?)` \|", PAGE, re.M))
    assert len(named) == 8
    for name in named - {"edmlift-V.tar.gz", "edmlift-V-py3-none-PLATFORM.whl"}:  # Python's own
        stem = re.sub(r"\.(zip|tgz|tar\.gz)$", "", name).replace("V", "{version()}")
        assert stem in sources, name
    for path in (ROOT / "docs").glob("*.md"):
        said = re.findall(r"\bedmlift-[\w-]+\.(?:zip|tgz|tar\.gz|whl)\b", path.read_text("utf-8"))
        assert {name.replace("VERSION", "V") for name in said} <= named, path.name


def test_wrong_options_are_told_before_anything_is_installed():
    done = run_tool("channels.release", "--options-only", "npm", "pypi")
    assert done.returncode == 2
    assert "there is no channel pypi; there are arduino, esp_idf, npm, " in done.stderr
    done = run_tool("channels.release", "--options-only", "npm", "--draft")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    script = (ROOT / "tools" / "release").read_text("utf-8")
    assert script.index("--options-only") < script.index("need_packages")
