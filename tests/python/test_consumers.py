"""The library in somebody else's project: every documented way to use it, as C and as C++."""

import os
import re
import shutil
from pathlib import Path

import pytest
from builds import long_but, need, need_cross_compiler

from reports.targets import (
    INCLUDES,
    ROOT,
    TARGETS,
    ToolError,
    compile_each,
    compiler,
    library_flags,
    run,
)

CONSUMER = ROOT / "tests" / "install"
MODELS = "-DEDMLIFT_MODELS=distances_f32;direct_w8"  # of eleven, which takes less time
SAID = "ok left_ankle\n"
PAIRS = {"gcc": "g++", "clang": "clang++"}


def configure(source: Path, build: Path, *settings: str) -> None:
    need("cmake")
    run("cmake", "-S", source, "-B", build, "-DCMAKE_BUILD_TYPE=Release", *settings)


@pytest.fixture(scope="module", params=long_but(["static"], ["static", "shared"]))
def installed(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Prefix under which the library is installed."""
    folder = tmp_path_factory.mktemp(request.param)
    shared = "ON" if request.param == "shared" else "OFF"
    configure(ROOT, folder / "build", f"-DBUILD_SHARED_LIBS={shared}", "-DEDMLIFT_EXAMPLES=OFF",
              "-DCMAKE_INSTALL_LIBDIR=lib", MODELS)  # fmt: skip
    run("cmake", "--build", folder / "build")
    run("cmake", "--install", folder / "build", "--prefix", folder / "prefix")
    return folder / "prefix"


def build_and_run(build: Path, *settings: str) -> None:
    configure(CONSUMER, build, *settings)
    run("cmake", "--build", build)
    assert run(build / "consumer_c") == run(build / "consumer_cpp") == SAID


@pytest.mark.slow
@pytest.mark.parametrize("compiler", PAIRS)
def test_find_package(compiler: str, installed: Path, tmp_path: Path) -> None:
    need(compiler, PAIRS[compiler])
    build_and_run(
        tmp_path, "-DWAY=package", f"-DCMAKE_PREFIX_PATH={installed}",
        f"-DCMAKE_C_COMPILER={compiler}", f"-DCMAKE_CXX_COMPILER={PAIRS[compiler]}",
    )  # fmt: skip


@pytest.mark.parametrize("version", ["99.0", "1.999", "0.1"])
def test_find_package_refuses_other_versions(version: str, installed: Path, tmp_path: Path) -> None:
    """Newer than it is, or of another major version."""
    with pytest.raises(ToolError, match="compatible with requested version"):
        configure(CONSUMER, tmp_path, "-DWAY=package", f"-DVERSION_WANTED={version}",
                  f"-DCMAKE_PREFIX_PATH={installed}")  # fmt: skip


@pytest.mark.parametrize("compiler", [*PAIRS.keys(), *PAIRS.values()])
def test_pkg_config(compiler: str, installed: Path, tmp_path: Path) -> None:
    need("pkg-config", compiler)
    paths = os.environ | {
        "PKG_CONFIG_PATH": str(installed / "lib" / "pkgconfig"),
        "LD_LIBRARY_PATH": str(installed / "lib"),
    }
    flags = run("pkg-config", "--cflags", "--libs", "edmlift >= 1.0", env=paths).split()
    language = "c++" if compiler.endswith("++") else "c"
    run(compiler, "-x", language, CONSUMER / "consumer.c", "-x", "none", *flags,
        "-o", tmp_path / "consumer")  # fmt: skip
    assert run(tmp_path / "consumer", env=paths) == SAID


def test_pkg_config_refuses_newer_versions(installed: Path) -> None:
    need("pkg-config")
    paths = os.environ | {"PKG_CONFIG_PATH": str(installed / "lib" / "pkgconfig")}
    with pytest.raises(ToolError):
        run("pkg-config", "--libs", "edmlift >= 99", env=paths)


def test_the_public_headers_are_installed_and_no_others(installed: Path) -> None:
    found = {file.relative_to(installed) for file in (installed / "include").rglob("*.*")}
    assert found == {file.relative_to(ROOT) for file in (ROOT / "include").rglob("*.h")}
    assert Path("include/edmlift.h") in found and Path("include/edmlift/camera.h") in found


@pytest.mark.slow
@pytest.mark.parametrize("way", ["subdirectory", "fetch"])
def test_in_another_cmake_project(way: str, tmp_path: Path) -> None:
    need("g++")
    build_and_run(
        tmp_path,
        f"-DWAY={way}",
        f"-DEDMLIFT_SOURCE={ROOT}",
        MODELS,
    )
    run("cmake", "--install", tmp_path, "--prefix", tmp_path / "prefix")
    assert not (tmp_path / "prefix").exists()  # it is the other project's affair


@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
@pytest.mark.parametrize("cc", ["gcc", "clang"])
def test_flags_that_let_nan_through_do_not_compile(cc: str, flag: str, tmp_path: Path) -> None:
    need(cc)
    source, out = ROOT / "lib" / "lift" / "lift_f32.c", tmp_path / "x.o"
    with pytest.raises(ToolError, match="compile it without -ffast-math"):
        run(cc, "-std=c99", flag, "-w", *INCLUDES, "-c", source, "-o", out)


@pytest.mark.slow
def test_vendored_with_a_makefile(tmp_path: Path) -> None:
    need("make", "cc")
    less = shutil.ignore_patterns("fconv*", "*.json", "*.npz")
    for folder in ("include", "lib", "gen"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=less)
    for name in ("consumer.c", "Makefile"):
        shutil.copy(CONSUMER / name, tmp_path)
    run("make", "-s", "-C", tmp_path)
    assert run(tmp_path / "consumer") == SAID


@pytest.mark.parametrize(
    "command",
    ["gcc -std=c99", "clang -std=c99", "g++ -std=c++11 -x c++", "clang++ -std=c++11 -x c++"],
)
def test_the_headers_stand_alone_without_a_warning(command: str, tmp_path: Path) -> None:
    compiler, *options = command.split()
    need(compiler)
    program = tmp_path / "header.c"
    headers = sorted((ROOT / "include").rglob("*.h"))
    program.write_text("".join(f'#include "{header}"\n' for header in [*headers, *headers]))
    warnings = "-pedantic -Wall -Wextra -Wconversion -Wshadow -Werror".split()
    run(compiler, *options, *warnings, f"-I{ROOT / 'include'}", "-fsyntax-only", program)


ADAPTING = """#include "edmlift.h"
int main(void) {
    edml_keypoint in[17] = {{0, 0, 0}}, joint[EDML_JOINTS];
    edml_adapt(joint, in, &edml_coco17);
    return joint[0].c > 0;
}
"""


def linked_names(program: Path, folder: Path) -> set[str]:
    """Global names of a program with the library, less what the linker drops."""
    need("gcc")
    command = ["gcc", *library_flags(), "-O2", *INCLUDES]
    objects = compile_each(command, folder)
    run(*command, "-Wl,--gc-sections", program, *objects, "-lm", "-o", folder / "program")
    return {line.split()[-1] for line in run("nm", folder / "program").splitlines()}


def test_a_program_that_lifts_has_nothing_of_the_adapters(tmp_path: Path) -> None:
    names = linked_names(ROOT / "examples" / "lift.c", tmp_path)
    assert "edml_lift" in names
    header = (ROOT / "include" / "edmlift.h").read_text("utf-8")
    section = header.partition("---- Detectors' keypoints")[2]
    adapters = set(re.findall(r"\bedml_\w+", section)) - {"edml_lift", "edml_keypoint"}
    assert {"edml_adapt", "edml_formats", "edml_format_find", "edml_coco17"} < adapters
    assert names & (adapters | {"edml_adapt_q"}) == set()


def test_a_program_that_lifts_has_nothing_of_the_track(tmp_path: Path) -> None:
    names = linked_names(ROOT / "examples" / "lift.c", tmp_path)
    assert "edml_lift" in names and names & {"edml_track_start", "edml_track_lift"} == set()


def test_a_program_that_adapts_one_format_has_no_other(tmp_path: Path) -> None:
    program = tmp_path / "adapting.c"
    program.write_text(ADAPTING, "utf-8")
    names = {name for name in linked_names(program, tmp_path) if name.startswith("edml_")}
    assert names == {"edml_adapt", "edml_coco17"}


@pytest.mark.parametrize("core", ["cortex-m4f", "rv32imc"])
def test_the_readmes_program_fits_the_stack_of_a_small_task(core: str, tmp_path: Path) -> None:
    """Such as ESP-IDF's main task, which has 3,584 bytes: its own frame is under 1 KB."""
    need_cross_compiler(TARGETS[core])
    source, item = ROOT / "examples" / "lift.c", tmp_path / "lift.o"
    run(*compiler(TARGETS[core], "-Os"), "-fstack-usage", "-c", source, "-o", item)
    place, size, kind = item.with_suffix(".su").read_text("utf-8").split("\t")
    assert place.endswith(":main") and kind.strip() == "static" and 0 < int(size) < 1024
