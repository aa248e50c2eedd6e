"""What tests of untrusted files share.

A test is a property of files that Hypothesis makes up.  pytest runs it on EXAMPLES of them, the
same each time; tools/fuzz runs it for as long as it is told, guided by coverage
(tests/fuzz/guided.py).
"""

import contextlib
import io
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "tests" / "python" / "cases"
EXAMPLES = 60


def fuzzed(strategy: st.SearchStrategy, examples: int = EXAMPLES) -> Callable:
    """A test of what the strategy makes up."""

    def decorate(test: Callable) -> Callable:
        limits = settings(
            max_examples=examples,
            deadline=None,
            derandomize=True,
            database=None,
            suppress_health_check=list(HealthCheck),
        )
        return limits(given(strategy)(test))

    return decorate


@contextlib.contextmanager
def folder() -> Iterator[Path]:
    """An empty one, in memory where there is a file system in memory."""
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as name:
        yield Path(name)


@contextlib.contextmanager
def file_of(data: bytes, name: str) -> Iterator[Path]:
    """A file with these bytes in a folder of its own."""
    with folder() as place:
        (place / name).write_bytes(data)
        yield place / name


def check_message(error: BaseException) -> None:
    """What is wrong is said, in one line."""
    text = str(error)
    assert text and "\n" not in text, repr(error)


def run_quietly(main: Callable[[Sequence[str]], int], *arguments: object) -> tuple[int, str, str]:
    """Exit status, output and messages of a command."""
    out, messages = io.TextIOWrapper(io.BytesIO(), "utf-8"), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(messages):
        status = main([str(argument) for argument in arguments])
        out.flush()
    return status, out.buffer.getvalue().decode("utf-8"), messages.getvalue()  # type: ignore[attr-defined]


# ---- Files ---------------------------------------------------------------------------------------

Edit = tuple[int, int, bytes]  # where, in 65536ths; bytes that go; bytes that come


def edits(words: Sequence[bytes], most: int = 6) -> st.SearchStrategy[list[Edit]]:
    """Some changes of a file: words that matter to its reader, or any bytes."""
    coming = st.one_of(st.sampled_from(list(words)), st.binary(max_size=8))
    one = st.tuples(st.integers(0, 65535), st.sampled_from([0, 0, 1, 1, 2, 4, 8, 100]), coming)
    return st.lists(one, max_size=most)


def edited(data: bytes, changes: Sequence[Edit]) -> bytes:
    text = bytearray(data)
    for where, going, coming in changes:
        at = where * (len(text) + 1) >> 16
        text[at : at + going] = coming
    return bytes(text)


def files(
    seeds: Sequence[bytes], words: Sequence[bytes], most: int = 6
) -> st.SearchStrategy[bytes]:
    """Seeds with some changes, and now and then cut off."""
    cut = st.one_of(st.none(), st.none(), st.integers(0, 65535))

    def made(seed: bytes, changes: list[Edit], end: int | None) -> bytes:
        data = edited(seed, changes)
        return data if end is None else data[: end * (len(data) + 1) >> 16]

    return st.builds(made, st.sampled_from(list(seeds)), edits(words, most), cut)
