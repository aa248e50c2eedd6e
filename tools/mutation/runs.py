"""Which tests reach a mutant, and which of them fails."""

import math
import os
import re
import subprocess
import tempfile
from collections import Counter
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from reports.targets import ToolError

SLOWER, AT_LEAST = 5.0, 0.2  # a test may take so many times its usual seconds, and so many more


class Test(NamedTuple):
    """A test function of one program."""

    program: str
    name: str
    seconds: float  # of the processor
    reached: frozenset[int]  # numbers of mutants


def environment(**values: object) -> dict[str, str]:
    own = {key: value for key, value in os.environ.items() if not key.startswith("EDML_")}
    return own | {f"EDML_{key.upper()}": str(value) for key, value in values.items()}


def run(program: Path, **values: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program], env=environment(**values), capture_output=True, text=True,
                          errors="replace", check=False)  # fmt: skip


def _measure(name: str, program: Path) -> list[Test]:
    """Each test of a program, run alone: what it reaches."""
    tests = []
    with tempfile.TemporaryDirectory() as folder:
        for test in re.findall(r"^LIST (\w+)$", run(program, list=1).stdout, re.M):
            file = Path(folder) / test
            done = run(program, tests=f",{test}:0,", reached=file)
            if done.returncode != 0:
                raise ToolError(f"{name}: {test} fails without a mutant:\n{done.stdout[-1000:]}")
            _, seconds, *numbers = file.read_text().split()
            tests.append(Test(name, test, float(seconds), frozenset(map(int, numbers))))
    if not tests:
        raise ToolError(f"{name} has no tests")
    return tests


def measure(programs: Mapping[str, Path]) -> list[Test]:
    """All tests of the programs with what they reach."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [t for tests in pool.map(_measure, programs, programs.values()) for t in tests]


class Suite:
    """Programs and their tests, to run mutants by."""

    def __init__(self, programs: Mapping[str, Path], budget: float = math.inf) -> None:
        """budget  seconds that a mutant's tests usually take in all: no more programs are run"""
        self.programs = programs
        self.budget = budget
        self.tests = measure(programs)
        self.kills: Counter[tuple[str, str]] = Counter()  # in a place, by a program

    def killer(self, number: int, place: str) -> str | None:
        """The first test found that fails with the mutant, "test_mds: NAME"; None: it lives.

        Programs go in the order of the mutants that they killed in this place, then of the time
        that they take.
        """
        reaching: dict[str, list[Test]] = {}
        for test in self.tests:
            if number in test.reached:
                reaching.setdefault(test.program, []).append(test)

        seconds = {name: sum(t.seconds for t in tests) for name, tests in reaching.items()}
        spent = 0.0
        for name in sorted(reaching, key=lambda name: (-self.kills[place, name], seconds[name])):
            spent += seconds[name]
            if spent > self.budget:
                break
            if found := self._fails(number, reaching[name]):
                self.kills[place, name] += 1
                return f"{name}: {found}"
        return None

    def _fails(self, number: int, tests: list[Test]) -> str | None:
        wanted = ",".join(f"{t.name}:{SLOWER * t.seconds + AT_LEAST:.3f}" for t in tests)
        done = run(self.programs[tests[0].program], mutant=number, tests=f",{wanted},")
        if done.returncode == 0:
            return None
        failed = re.search(r":(\w+):FAIL", done.stdout)
        if failed:
            return failed[1]
        return "a sanitizer" if done.returncode > 0 else f"ends by signal {-done.returncode}"

    def is_reached(self, number: int) -> bool:
        return any(number in test.reached for test in self.tests)
