"""What the library's object files may contain and ask for."""

import re

import pytest
from builds import long_but, need, need_cross_compiler

from reports.targets import INCLUDES, TARGETS, compile_each, compiler, library_flags, run

# Arithmetic that a processor lacks: the compiler's own helpers.
HELPERS = re.compile(r"__aeabi_\w+|__gnu_thumb1_\w+|__[a-z]+?([sd][if]){1,2}\d?")
ALLOWED = {"sqrtf", "memcpy", "memset"}

HOSTS = ["gcc", "clang"]
CORES = ["cortex-m0plus", "cortex-m4f", "rv32imc"]


@pytest.fixture(scope="module", params=long_but(["gcc", "cortex-m4f"], [*HOSTS, *CORES]))
def objects(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    """Prefix of the binary utilities, and an object file for each source."""
    if request.param in HOSTS:
        need(request.param)
        prefix, command = "", [request.param, *library_flags(), "-O2", *INCLUDES]
    else:
        target = TARGETS[request.param]
        need_cross_compiler(target)
        prefix, command = target.system.cross, compiler(target, "-O2")
    return prefix, compile_each(command, tmp_path_factory.mktemp("objects"))


def symbols(objects, kinds: str) -> set[str]:
    prefix, files = objects
    lines = [line.split() for file in files for line in run(f"{prefix}nm", file).splitlines()]
    return {words[-1] for words in lines if words[-2] in kinds}


@pytest.mark.slow
def test_no_variable_memory(objects) -> None:
    """.data and .bss are empty, whatever the sections are called."""
    prefix, files = objects
    for file in files:
        _, data, bss, *_ = run(f"{prefix}size", file).splitlines()[1].split()
        # .data.rel.ro holds constant tables of pointers, in code that may be moved.
        writable = re.findall(
            r"^\.(data|bss)(?!\.rel\.ro)\S*\s+([1-9]\d*)", run(f"{prefix}size", "-A", file), re.M
        )
        assert not writable and int(bss) == 0, file.name
        if prefix:
            assert int(data) == 0, file.name


@pytest.mark.slow
def test_nothing_is_asked_for_but_a_square_root_and_memory(objects) -> None:
    asked = symbols(objects, "U") - symbols(objects, "TRDBC")
    assert {name for name in asked - ALLOWED if not HELPERS.fullmatch(name)} == set()


@pytest.mark.slow
def test_every_global_name_has_the_prefix(objects) -> None:
    names = symbols(objects, "TRDBCVW")
    assert {name for name in names if not name.startswith("edml_")} == set()
