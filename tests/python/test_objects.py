"""What the library's object files may contain and ask for."""

import re

import pytest
from builds import need, need_cross_compiler

from firmware import CROSS, INCLUDES, PICOLIBC, SOURCES, TARGETS, library_flags, run

# Arithmetic that a processor lacks: the compiler's own helpers.
HELPERS = re.compile(r"__aeabi_\w+|__gnu_thumb1_\w+")
ALLOWED = {"sqrtf", "memcpy", "memset"}

COMPILERS = {
    "gcc": ["gcc"],
    "clang": ["clang"],
    "cortex-m0": [f"{CROSS}gcc", PICOLIBC, "-mthumb", *TARGETS["cortex-m0"].flags],
    "cortex-m4f": [f"{CROSS}gcc", PICOLIBC, "-mthumb", *TARGETS["cortex-m4f"].flags],
}


@pytest.fixture(scope="module", params=COMPILERS)
def objects(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    """Prefix of the binary utilities, and an object file for each source."""
    compiler, *flags = COMPILERS[request.param]
    need_cross_compiler() if compiler.startswith(CROSS) else need(compiler)
    out = tmp_path_factory.mktemp("objects")
    files = []
    for source in SOURCES:
        files.append(out / f"{source.stem}.o")
        run(compiler, *library_flags(), "-O2", *flags, *INCLUDES, "-c", source, "-o", files[-1])
    return CROSS if compiler.startswith(CROSS) else "", files


def symbols(objects, kinds: str) -> set[str]:
    prefix, files = objects
    lines = [line.split() for file in files for line in run(f"{prefix}nm", file).splitlines()]
    return {words[-1] for words in lines if words[-2] in kinds}


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


def test_nothing_is_asked_for_but_a_square_root_and_memory(objects) -> None:
    asked = symbols(objects, "U") - symbols(objects, "TRDBC")
    assert {name for name in asked - ALLOWED if not HELPERS.fullmatch(name)} == set()


def test_every_global_name_has_the_prefix(objects) -> None:
    names = symbols(objects, "TRDBCVW")
    assert {name for name in names if not name.startswith("edml_")} == set()
