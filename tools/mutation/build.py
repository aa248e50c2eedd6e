"""A build of the C tests that has many mutants of lib/ in it."""

import os
import random
import re
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from data.paths import LIB, ROOT
from mutation.operators import Mutant, apply, enumerators, mutants_of, schema
from reports.targets import ToolError

HARNESS = ROOT / "tests" / "mutation"
WORK = ROOT / "build" / "mutation"
TREE = WORK / "tree"
Numbered = dict[int, tuple[str, Mutant]]  # number: file as in "lib/lift/mds.h", mutant
_LINKED = ("include", "gen", "cmake", "examples", "CMakeLists.txt")
_COPIED = ("unit", "support", "vectors", "overflow", "fuzz")  # others include ../../lib from there
_COMPILE = ("cc", "-std=c99", "-w", f"-I{ROOT / 'include'}")


def texts() -> dict[str, str]:
    """The texts of lib/ by their names, "lib/lift/mds.h"."""
    paths = sorted(p for p in LIB.rglob("*.[ch]") if p.parent.name != "models")
    return {str(p.relative_to(ROOT)): p.read_text("utf-8") for p in paths}


def all_mutants() -> Numbered:
    """Every mutant of every text, numbered from 1."""
    sources = texts()
    public = [path.read_text("utf-8") for path in (ROOT / "include").rglob("*.h")]
    constants = set().union(*map(enumerators, [*sources.values(), *public]))
    found = [(name, m) for name, text in sources.items() for m in mutants_of(text, constants)]
    return dict(enumerate(found, 1))


def sources_of(tree: Path) -> list[Path]:
    return sorted(p for p in (tree / "lib").glob("*/*.c") if p.parent.name != "models")


def write_if_new(path: Path, text: str) -> None:
    """Keeps the time of a file that has the text already, so that it is not compiled again."""
    if not path.exists() or path.read_text("utf-8") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")


def write_texts(mutants: Numbered, tree: Path = TREE) -> None:
    """The texts of lib/ with these mutants."""
    for name, text in texts().items():
        of_this = {n: mutant for n, (file, mutant) in mutants.items() if file == name}
        write_if_new(tree / name, schema(text, of_this))


def make_tree(tree: Path = TREE) -> None:
    """What a build of the tests needs beside the texts of lib/."""
    tree.mkdir(parents=True, exist_ok=True)
    for name in _LINKED:
        if not (tree / name).exists():
            (tree / name).symlink_to(ROOT / name)
    for part in _COPIED:
        shutil.copytree(ROOT / "tests" / part, tree / "tests" / part, dirs_exist_ok=True)
    for path in [*(LIB / "models").glob("*.c"), *(ROOT / "tests").glob("*.*")]:
        write_if_new(tree / path.relative_to(ROOT), path.read_text("utf-8"))


def _said(command: Iterable[str | Path]) -> str:
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def compiled_numbers(tree: Path = TREE) -> set[int]:
    """Numbers of the mutants that the preprocessor leaves in what this machine compiles."""
    include = ["-include", HARNESS / "harness.h"]
    commands = [[*_COMPILE, *include, "-E", "-P", path] for path in sources_of(tree)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outputs = list(pool.map(_said, commands))
    return {int(n) for text in outputs for n in re.findall(r"edml_mutant_reached\[(\d+)\]", text)}


def sample(mutants: Numbered, size: int, seed: int) -> Numbered:
    """So many of them, or all."""
    if size >= len(mutants):
        return mutants
    chosen = random.Random(seed).sample(sorted(mutants), size)
    return {number: mutants[number] for number in sorted(chosen)}


# ---- Those that do not compile -------------------------------------------------------------------


class Alone:
    """Compiles single mutants, in a tree of their own."""

    def __init__(self, tree: Path = WORK / "alone") -> None:
        self.tree = tree
        make_tree(tree)
        write_texts({}, tree)
        self.users = self._users()
        self._originals: dict[tuple[str, ...], list[bytes] | None] = {}

    def _users(self) -> dict[str, list[Path]]:
        """The sources that include each text."""
        users: dict[str, list[Path]] = {}
        for source in sources_of(self.tree):
            for path in _said([*_COMPILE, "-MM", source]).replace("\\\n", " ").split()[1:]:
                resolved = os.path.normpath(path)
                if resolved.startswith(str(self.tree / "lib")):
                    users.setdefault(os.path.relpath(resolved, self.tree), []).append(source)
        return users

    def objects(self, name: str, mutant: Mutant | None, *options: str) -> list[bytes] | None:
        """The object files of the sources that include the text with the mutant; None: an error."""
        text = texts()[name]
        write_if_new(self.tree / name, apply(text, mutant) if mutant else text)
        try:
            return [self._object(source, options) for source in self.users.get(name, [])]
        except ToolError:
            return None
        finally:
            write_if_new(self.tree / name, text)

    def _object(self, source: Path, options: Sequence[str]) -> bytes:
        out = self.tree / "out.o"
        step([*_COMPILE, "-c", *options, source, "-o", out])
        return out.read_bytes()

    def original(self, name: str, *options: str) -> list[bytes] | None:
        """The object files of the text as it is."""
        key = (name, *options)
        if key not in self._originals:
            self._originals[key] = self.objects(name, None, *options)
        return self._originals[key]

    def compiles(self, name: str, mutant: Mutant) -> bool:
        return self.objects(name, mutant, "-O0") is not None


def errors_of_tree() -> list[tuple[str, int]]:
    """Files of lib/ and lines of which the compiler complains."""
    include = ["-include", HARNESS / "harness.h"]
    commands = [[*_COMPILE, *include, "-fsyntax-only", path] for path in sources_of(TREE)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        said = "".join(pool.map(_said, commands))
    found = re.findall(r"^([^:\n]+):(\d+):\d+: (?:error|note: in expansion)", said, re.M)
    if not found and "error" in said:
        raise ToolError(said)
    return [(os.path.relpath(file, TREE), int(line)) for file, line in found]


def write_what_compiles(mutants: Numbered, alone: Alone) -> Numbered:
    """Writes the texts into the tree without the mutants that are errors, and returns the others.

    One that compiles alone may still be none in a choice at run time, because its type is another.
    """
    while True:
        write_texts(mutants)
        places = set(errors_of_tree())
        if not places:
            return mutants
        suspects = [n for n, (file, mutant) in mutants.items()
                    if any((file, mutant.line + k) in places for k in range(6))]  # fmt: skip
        dropped = {n for n in suspects if not alone.compiles(*mutants[n])} or set(suspects)
        if not dropped:
            raise ToolError(f"errors where there is no mutant: {sorted(places)[0]}")
        mutants = {n: found for n, found in mutants.items() if n not in dropped}


# ---- The build -----------------------------------------------------------------------------------


FLAGS = {
    "plain": ("-O2",),
    "sanitized": ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
}
BUDGET = {"plain": 60.0, "sanitized": 4.0}  # seconds of the processor that a mutant's tests take


def build_tests(name: str, most: int) -> dict[str, Path]:
    """Builds the unit tests with the texts of the tree, into build/mutation/NAME; their programs.

    name  of FLAGS
    most  the largest number of a mutant
    """
    folder, flags = WORK / name, FLAGS[name]
    harness = WORK / f"{name}.o"
    step(["cmake", "-S", TREE, "-B", folder, *(["-G", "Ninja"] if shutil.which("ninja") else []),
          "-DEDMLIFT_TESTS=ON", "-DEDMLIFT_EXAMPLES=OFF", "-DEDMLIFT_INSTALL=OFF",
          "-DCMAKE_BUILD_TYPE=None", f"-DEDML_HARNESS={harness}",
          f"-DEDML_FLAGS={';'.join(flags)}",
          f"-DCMAKE_PROJECT_INCLUDE={HARNESS / 'harness.cmake'}"])  # fmt: skip
    names = tests_of(folder)
    step(["cc", *flags, f"-DEDML_MUTANTS={most}", f"-I{unity_of(folder)}", "-c",
          HARNESS / "harness.c", "-o", harness])  # fmt: skip
    programs = {test: folder / "tests" / "unit" / test for test in names}
    for program in programs.values():
        program.unlink(missing_ok=True)  # to be linked with the harness
    step(["cmake", "--build", folder, "--parallel", str(os.cpu_count() or 1), "--target", *names])
    return programs


def step(command: Iterable[str | Path]) -> None:
    """Runs it; ToolError with the end of what it said if it fails."""
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ToolError("\n".join((done.stdout + done.stderr).splitlines()[-30:]))


def tests_of(folder: Path) -> list[str]:
    """Names of the unit tests that CMake knows, without those under sanitizers."""
    text = (folder / "tests" / "unit" / "CTestTestfile.cmake").read_text("utf-8")
    return re.findall(r"^add_test\(\W*(test_\w+)", text, re.M)


def unity_of(folder: Path) -> Path:
    found = sorted(folder.rglob("unity.h"))
    return found[0].parent if found else Path("/usr/include/unity")
