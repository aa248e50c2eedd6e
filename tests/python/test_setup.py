"""tools/demo and tools/check say what is wrong before they begin; what tools/check then runs."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from support import ROOT


def copy_tools(root: Path, program: str) -> Path:
    """A checkout that has this program alone."""
    (root / "tools").mkdir(parents=True)
    for name in (program, "setup.sh"):
        shutil.copy(ROOT / "tools" / name, root / "tools")
    return root / "tools" / program


def said_in(root: Path, program: str) -> str:
    """What a program says in a checkout in which it cannot build."""
    command = copy_tools(root, program)
    done = subprocess.run([command], capture_output=True, text=True, check=False)
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


def test_a_file_counts_as_a_command_that_is_there(tmp_path: Path) -> None:
    """Such as a C library of another processor, which no command tells of."""
    there = tmp_path / "libc.a"
    there.touch()
    copy_tools(tmp_path, "demo")
    pairs = f"{there}:first {tmp_path}/libm.a:second no-such-command:third"
    script = f"source tools/setup.sh; missing_packages {pairs}"
    said = subprocess.run(["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert said.stdout.split()[-2:] == ["second", "third"] and "first" not in said.stdout


def test_installing_waits_for_another_program_that_installs(tmp_path: Path) -> None:
    copy_tools(tmp_path, "demo")
    stub = tmp_path / "apt-get"
    stub.write_text('#!/bin/sh\necho "$*"\n')
    stub.chmod(0o755)
    script = 'source tools/setup.sh; as_root() { "$@"; }; PATH=.:$PATH apt_install lld'
    said = subprocess.run(["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert "DPkg::Lock::Timeout=" in said.stdout and said.stdout.endswith(" lld\n"), said.stderr


# ---- tools/check ---------------------------------------------------------------------------------

STUB = """#!/bin/sh
name=$(basename "$0")
echo "$name $*${PYTEST_ADDOPTS:+ $PYTEST_ADDOPTS}" >>"$CALLS"
case "$name $*" in
"cmake -S"*) mkdir -p build/check/Testing/Temporary ;;
"ctest "*)
    echo "SKIPPED [1] x.py:1: no $#" >Testing/Temporary/LastTest.log
    test "$FAILS" != tests
    ;;
"python tools/run.py"*) test "$FAILS" != branches ;;
esac
"""


@pytest.fixture
def check(tmp_path: Path):
    """Runs tools/check where everything that it calls is a stub."""
    program, stubs, calls = copy_tools(tmp_path, "check"), tmp_path / "stubs", tmp_path / "calls"
    venvs = {"": "requirements.txt"}
    venvs |= {f"-{n}": f"requirements-{n}.txt" for n in ("platformio", "corpora")}
    for suffix, wanted in venvs.items():
        binaries = tmp_path / "build" / f"venv{suffix}" / "bin"
        binaries.mkdir(parents=True)
        shutil.copy(ROOT / "tools" / wanted, tmp_path / "tools")
        shutil.copy(ROOT / "tools" / wanted, binaries.parent / "requirements.txt")
        for name in ("python", "ruff"):
            (binaries / name).write_text(STUB)
            (binaries / name).chmod(0o755)
    with (tmp_path / "tools" / "setup.sh").open("a") as setup:
        setup.write("need_packages() { :; }\n")  # it would install them
    stubs.mkdir()
    for name in ("cmake", "ctest", "ccache"):
        (stubs / name).write_text(STUB)
        (stubs / name).chmod(0o755)

    def run(*options: str, fails: str = "no") -> tuple[subprocess.CompletedProcess, list[str]]:
        calls.write_text("")
        about = {"PATH": f"{stubs}:{os.environ['PATH']}", "CALLS": str(calls), "FAILS": fails}
        done = subprocess.run([program, *options], env=about, capture_output=True, text=True)
        return done, calls.read_text().splitlines()

    return run


def test_check_runs_all_tests_and_says_what_was_skipped_and_how_long_it_took(check) -> None:
    done, calls = check()
    assert done.returncode == 0, done.stderr
    assert [" ".join(c.split()) for c in calls if c.startswith("ctest")] == [
        "ctest --output-on-failure --parallel 2 --label-exclude python",
        "ctest --output-on-failure --parallel 2 --label-regex python -m 'not long'",
    ]
    assert "cmake --build build/check" in calls
    assert calls[-2:] == [
        "cmake --build build/check --target coverage",
        "python tools/run.py reports.branches build/check/tests/coverage.json",
    ]
    assert "Skipped:\n  [1] x.py:1: no 5\n" in done.stdout
    times = done.stdout.partition("\nTimes:\n")[2].splitlines()
    assert [line.split(maxsplit=2)[2] for line in times] == [
        "packages and Python environments", "build", "C tests", "Python tests", "coverage", "in all"
    ]  # fmt: skip


@pytest.mark.parametrize("part", ["tests", "branches"])
def test_check_goes_on_after_a_failure_and_fails_at_the_end(check, part: str) -> None:
    done, calls = check(fails=part)
    assert done.returncode == 1 and "coverage" in calls[-1] and " s  in all" in done.stdout


def test_a_quick_check_builds_and_runs_what_is_quick(check) -> None:
    done, calls = check("--quick")
    assert done.returncode == 0, done.stderr
    assert "cmake --build build/check --target quick" in calls
    c, python = (call for call in calls if call.startswith("ctest"))
    assert "--label-regex quick" in c
    assert "--label-regex python" in python and "-m 'not slow'" in python


def test_a_long_check_runs_all_python_tests(check) -> None:
    done, calls = check("--long")
    assert done.returncode == 0, done.stderr
    assert [c for c in calls if "-m 'not" in c] == []


def test_compilers_are_links_to_ccache(check, tmp_path: Path) -> None:
    check("--quick")
    links = tmp_path / "build" / "ccache" / "compilers"
    assert (links / "cc").resolve() == (tmp_path / "stubs" / "ccache").resolve()


def test_the_help_of_check_names_its_options(check) -> None:
    done, calls = check("--help")
    assert (done.returncode, done.stderr, calls) == (0, "", [])
    assert "tools/check --quick " in done.stdout and "#" not in done.stdout


def test_an_option_that_check_does_not_have(check) -> None:
    done, calls = check("--quick", "--fast")
    assert (done.returncode, done.stdout, calls) == (2, "", [])
    there_are = "there are --quick, --long and --help"
    assert done.stderr == f"tools/check: unknown option --fast; {there_are}.\n"
