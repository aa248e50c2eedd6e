"""What is fuzzed: the targets of tests/fuzz, by name."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from data.paths import ROOT

FUZZ = ROOT / "tests" / "fuzz"
READERS = ROOT / "tests" / "python" / "untrusted"
OUT = ROOT / "build" / "fuzz"
BUILD = OUT / "build"
LONGEST = 1024  # bytes of an input of the library; driver.h
LONGEST_FILE = 8192


@dataclass(frozen=True)
class Target:
    """A fuzzer's target."""

    name: str
    program: str  # "library", "stdin" or "readers"
    measured: str  # the folder whose lines its coverage counts; "": none

    @property
    def corpus(self) -> Path:
        return OUT / "corpus" / self.name

    @property
    def findings(self) -> Path:
        return OUT / "findings" / self.name

    @property
    def guided(self) -> list[str]:
        """The command that runs it guided by coverage, before its options or an input's file."""
        if self.program == "readers":
            python = ROOT / "build" / "venv-fuzz" / "bin" / "python"
            return [shown(python), shown(FUZZ / "guided.py"), self.name]
        command = [shown(BUILD / f"fuzz_{self.program}_guided")]
        return [*command, f"-target={self.name}"] if self.program == "library" else command

    @property
    def options(self) -> list[str]:
        """libFuzzer's, of its inputs."""
        if self.program == "library":
            return [f"-max_len={LONGEST}", "-len_control=0"]
        if self.program == "readers":
            return ["-max_len=4096", "-len_control=0"]
        dictionary = [f"-dict={shown(FUZZ / 'stdin.dict')}"] if self.program == "stdin" else []
        return [f"-max_len={LONGEST_FILE}", *dictionary]

    @property
    def seeds(self) -> list[str]:
        """Folders to begin with, besides its corpus."""
        return [shown(ROOT / "tests" / "python" / "cases")] if self.program == "stdin" else []

    def unguided(self, kind: str) -> list[str]:
        """The command that runs pseudo-random inputs, "fast" or counting "coverage"."""
        return [str(BUILD / f"fuzz_{self.program}_{kind}"), self.name]


def shown(path: Path) -> str:
    """As seen from the root of the repository."""
    return str(path.relative_to(ROOT))


def library_targets() -> list[str]:
    """The names in the tables of tests/fuzz/fuzz.h."""
    text = (FUZZ / "fuzz.h").read_text("utf-8")
    names = []
    for table, both in re.findall(
        r"#define FUZZ_TARGETS_OF_(BOTH|ONE)\(X\)((?:.*\\\n)*.*\n)", text
    ):
        for name in re.findall(r"X\((\w+)\)", both):
            names += [name, f"{name}_q"] if table == "BOTH" else [name]
    return names


def watched_one_in() -> int:
    """Of how many pseudo-random inputs of fixed point one is computed once more, in integers that
    watch themselves: WATCHED_ONE_IN of tests/fuzz/fuzz.c."""
    return int(re.findall(r"WATCHED_ONE_IN = (\d+)", (FUZZ / "fuzz.c").read_text("utf-8"))[0])


def reader_targets() -> list[str]:
    """The names of the tests of tests/python/untrusted, without test_."""
    return [
        name
        for path in sorted(READERS.glob("test_*.py"))
        for name in re.findall(
            r"^@fuzzed\(.*?^def test_(\w+)\(", path.read_text("utf-8"), re.M | re.S
        )
    ]


def all_targets() -> list[Target]:
    return [
        *(Target(name, "library", "lib") for name in library_targets()),
        Target("lift_stdin", "stdin", "examples/lift_stdin"),
        *(Target(name, "readers", "") for name in reader_targets()),
    ]


SOURCES = {
    "library": ("lib", "include"),
    "stdin": ("lib", "include", "examples/lift_stdin"),
    "readers": ("tools/edmlift", "tools/export", "tools/data"),
}


def sources_of(target: Target) -> Sequence[Path]:
    """What a run of the target is a run of: if these change, its figures are of something else."""
    files = (path for folder in SOURCES[target.program] for path in (ROOT / folder).rglob("*"))
    return sorted(path for path in files if path.suffix in (".c", ".h", ".py"))
