"""Puts tools/ on the path, as for its programs; and says what was skipped and why."""

import os
import sys
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.path.insert(0, str(ROOT / "tests" / "python"))  # for the tests in folders

# A test trains for a few steps, so that compiling them is nearly all that it does.  JAX compiles
# fast instead of well, in a quarter of the time; and it keeps what it compiled for the tests and
# programs that compile the same.
os.environ.setdefault(
    "XLA_FLAGS", "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false"
)
os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(ROOT / "build" / "jax"))
os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.2")

# Compilers by ccache, as in tools/setup.sh, which makes the folder.
CCACHE = ROOT / "build" / "ccache"
if "CCACHE_DIR" not in os.environ and (CCACHE / "compilers").is_dir():
    os.environ["CCACHE_DIR"] = str(CCACHE)
    os.environ["PATH"] = f"{CCACHE / 'compilers'}{os.pathsep}{os.environ['PATH']}"

from claims import (  # noqa: E402
    pytest_deselected,
    pytest_itemcollected,
    pytest_runtest_call,
    pytest_sessionfinish,
    pytest_testnodedown,
    write_unchecked,
)
from support import need_library  # noqa: E402

from edmlift.library import Library  # noqa: E402

__all__ = [  # hooks
    "pytest_deselected",
    "pytest_itemcollected",
    "pytest_runtest_call",
    "pytest_sessionfinish",
    "pytest_testnodedown",
]


@pytest.fixture(scope="session")
def library() -> Library:
    """The C library with its default model."""
    need_library()
    return Library()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What is long is slow, too.  Files with the most slow tests first: all cores of pytest-xdist
    are then busy to the end."""
    for item in items:
        if item.get_closest_marker("long"):
            item.add_marker("slow")
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: -slow[item.path])


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """What was skipped and why, a line a reason, however pytest was called."""
    reasons = Counter(
        str(report.longrepr[2]).removeprefix("Skipped: ")
        for report in terminalreporter.stats.get("skipped", [])
        if isinstance(report.longrepr, tuple)
    )
    if reasons:
        terminalreporter.section("skipped")
        for reason, count in reasons.most_common():
            terminalreporter.write_line(f"{count:4d}  {reason}")
    write_unchecked(terminalreporter)
