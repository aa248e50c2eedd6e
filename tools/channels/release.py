"""Builds all that a release has, twice, compares the bytes, and tries each file as a user would.

    python tools/run.py channels.release [CHANNEL...] [--draft] [--no-check] [--out DIR]

The files come into build/dist, with SHA256SUMS beside them.  A release is made of what is
committed, and of a version that the changelog has a date for; --draft makes one all the same.
"""

import argparse
import hashlib
import importlib
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from channels.version import version
from data.paths import ROOT
from reports.targets import ToolError

FOLDER = Path(__file__).parent
SUMS = "SHA256SUMS"


class ReleaseError(Exception):
    """Why there is no release, in a sentence."""


def channels() -> dict[str, ModuleType]:
    """The modules of the folders beside this with a build() of their own, by name."""
    paths = {path.stem: path for path in FOLDER.glob("*/*.py")}
    modules = {
        name: importlib.import_module(f"channels.{path.parent.name}.{name}")
        for name, path in sorted(paths.items())
    }
    return {n: m for n, m in modules.items() if _module_of(getattr(m, "build", None)) == m.__name__}


def _module_of(function: object) -> str | None:
    return getattr(function, "__module__", None)


def is_committed() -> None:
    """ReleaseError where the working copy has what no commit has."""
    changed = subprocess.run(
        ["git", "status", "--porcelain"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    if changed:
        first = ", ".join(line[3:] for line in changed[:3])
        raise ReleaseError(
            f"commit first, or give --draft: {len(changed)} changed, such as {first}"
        )


def is_dated() -> None:
    """ReleaseError where the changelog's newest heading is not this version, with a date."""
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    heading = next(line for line in text.splitlines() if line.startswith("## "))
    if not heading.startswith(f"## {version()}, 2"):
        raise ReleaseError(
            f'CHANGELOG.md begins with "{heading}": write "## {version()}, YEAR-MONTH-DAY", '
            "or give --draft"
        )


@contextmanager
def timed(text: str) -> Iterator[None]:
    """One line of output: the text, and the seconds when it is done."""
    print(f"{text:<44}", end="", flush=True)
    start = time.monotonic()
    try:
        yield
    except BaseException:
        print("failed", flush=True)
        raise
    print(f"{time.monotonic() - start:4.0f} s", flush=True)


def build_twice(build: Callable[[Path], list[Path]], first: Path, second: Path) -> list[Path]:
    """The files of the first folder; ReleaseError where the second build has other bytes."""
    files = build(first)
    again = {path.name: path for path in build(second)}
    for path in files:
        other = again.pop(path.name, None)
        if other is None or other.read_bytes() != path.read_bytes():
            raise ReleaseError(f"{path.name} has other bytes when it is built again")
    if again:
        raise ReleaseError(f"{', '.join(again)}: there when built again, but not at first")
    return files


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def is_ours(out: Path) -> None:
    """ReleaseError where a folder is not an earlier release's, whose files may go."""
    if out.is_dir() and any(out.iterdir()) and not (out / SUMS).is_file():
        raise ReleaseError(f"{out} has other files than a release's: give --out another folder")
    if out.exists() and not out.is_dir():
        raise ReleaseError(f"{out} is not a folder")


def release(wanted: dict[str, ModuleType], out: Path, check: bool) -> list[Path]:
    """Builds and checks these channels; their files and SHA256SUMS are then in `out`, alone."""
    is_ours(out)
    files: dict[str, list[Path]] = {}
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent, prefix="release-") as name:
        first, second = Path(name, "first"), Path(name, "second")
        for channel, module in wanted.items():
            for folder in (first, second):
                folder.mkdir(exist_ok=True)
            with timed(f"Building {channel}, twice"):
                files[channel] = build_twice(module.build, first, second)
        for channel, module in wanted.items():
            if check and hasattr(module, "check"):
                with timed(f"Trying {channel}"):
                    module.check(files[channel])
        every = sorted(path for paths in files.values() for path in paths)
        lines = "".join(f"{digest(path)}  {path.name}\n" for path in every)
        (first / SUMS).write_text(lines, "utf-8")
        shutil.rmtree(out, ignore_errors=True)
        first.rename(out)
    return [out / path.name for path in every]


def parser(known: dict[str, ModuleType]) -> argparse.ArgumentParser:
    about = "\n".join(
        f"  {name:<14} {(module.__doc__ or '').partition(chr(10))[0]}"
        for name, module in known.items()
    )
    options = argparse.ArgumentParser(
        prog="tools/release", description=__doc__.partition("\n")[0],
        epilog=f"channels:\n{about}", formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    options.add_argument("channel", nargs="*", metavar="CHANNEL", help="all, if none is named")
    options.add_argument("--draft", action="store_true",
                         help="also of changes without a commit, and without a date")  # fmt: skip
    options.add_argument("--no-check", action="store_true", help="build alone")
    options.add_argument("--options-only", action="store_true", help=argparse.SUPPRESS)
    options.add_argument("--out", type=Path, default=ROOT / "build" / "dist", help="build/dist")
    return options


def main() -> int:
    known = channels()
    options = parser(known)
    given = options.parse_args()
    if unknown := [name for name in given.channel if name not in known]:
        options.error(f"there is no channel {', '.join(unknown)}; there are {', '.join(known)}")
    if given.options_only:
        return 0
    wanted = {name: known[name] for name in given.channel or known}
    try:
        if not given.draft:
            is_committed()
            is_dated()
        files = release(wanted, given.out, not given.no_check)
    except (ReleaseError, ToolError, OSError, ValueError, subprocess.CalledProcessError) as error:
        print(f"no release: {error}", file=sys.stderr)
        return 1
    print(f"\nedmlift {version()}, in {given.out}:")
    for path in files:
        print(f"  {path.stat().st_size:>10,}  {path.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
