"""examples/firmware: the presets build it, and it prints on every core what it prints here."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builds import long_but, need, need_core

from reports.targets import (
    INCLUDES,
    ROOT,
    TARGETS,
    Target,
    build,
    compile_each,
    compile_library,
    compiler,
    emulate,
    run,
)

EXAMPLE = ROOT / "examples" / "firmware"
VARIANTS = ["float", "fixed"]
MODELS = "-DEDMLIFT_MODELS=distances_w16;direct_w16"  # which the firmware names
PICOLIBC = Path("/usr/lib/picolibc/arm-none-eabi/include")  # as Debian has it
NO_FPU = ["cortex-m0plus", "cortex-m3", "rv32imc"]

# The compiler's float arithmetic on processors that have none, and what is made with it.
FLOAT_CODE = re.compile(
    r"__aeabi_c?[fd]\w+"  # __aeabi_fadd, __aeabi_d2iz, __aeabi_cfcmple
    r"|__aeabi_u?[il]2[fd]"  # __aeabi_i2f
    r"|__(add|sub|mul|div|neg|fix|fixuns|float|floatun|extend|trunc|cmp|unord|eq|ne|[lg][te])"
    r"(si|di)?[sdt]f\w*"  # __addsf3, __fixsfsi, __floatsisf, __gtsf2
    r"|\w*sqrtf?"
)


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder into which it was built for this machine."""
    need("cmake")
    folder = tmp_path_factory.mktemp("host")
    run("cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", MODELS)
    run("cmake", "--build", folder, "--target", *(f"firmware_{v}" for v in VARIANTS))
    return folder


@pytest.fixture(scope="module")
def expected(host: Path) -> dict[str, str]:
    """What each variant prints on this machine."""
    return {v: run(host / "examples" / "firmware" / f"firmware_{v}") for v in VARIANTS}


SOME_CORES = ["cortex-m0plus", "cortex-m55"]


@pytest.fixture(scope="module", params=long_but(SOME_CORES, TARGETS))
def core(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    """A preset's name and the folder into which it was built."""
    need("cmake")
    need_core(TARGETS[request.param])
    folder = tmp_path_factory.mktemp(request.param)
    run("cmake", "--preset", request.param, "-S", ROOT, "-B", folder, MODELS)
    run("cmake", "--build", folder)
    return request.param, folder


def table(text: str) -> np.ndarray:
    """Numbers [39,44] that it prints: index, misfit and joints."""
    model, *lines, last = text.splitlines()
    assert model.endswith(" is intact") and re.fullmatch(r"checksum \w{8}, 0 refused", last)
    rows = [line.split(",") for line in lines]
    assert len(rows) == 39 and all(row[1] == "ok" and len(row) == 45 for row in rows)
    return np.array([[int(cell) for cell in row[:1] + row[2:]] for row in rows])


@pytest.mark.slow
def test_all_poses_are_lifted_and_both_models_agree(expected: dict[str, str]) -> None:
    """To 0.2 m, and in the mean to 4 cm."""
    ours, theirs = (table(text) for text in expected.values())
    assert np.array_equal(ours[:, 0], theirs[:, 0])
    assert np.abs(ours - theirs).max() <= 200 and np.abs(ours - theirs).mean() <= 40


@pytest.mark.slow
def test_fixed_point_is_the_float_lift_of_the_same_model(
    tmp_path: Path, host: Path, expected: dict[str, str]
) -> None:
    """To 2 mm."""
    for file in EXAMPLE.iterdir():
        shutil.copy(file, tmp_path)
    header = tmp_path / "arithmetic.h"
    header.write_text(header.read_text("utf-8").replace("edml_distances_w16", "edml_direct_w16"))
    program = tmp_path / "other"
    run("gcc", *INCLUDES, tmp_path / "main.c", host / "libedmlift.a", "-lm", "-o", program)
    assert np.abs(table(run(program)) - table(expected["fixed"])).max() <= 2


@pytest.mark.slow
@pytest.mark.parametrize("variant", VARIANTS)
def test_a_core_prints_what_this_machine_prints(core, variant: str, expected) -> None:
    name, folder = core
    image = folder / "examples" / "firmware" / f"firmware_{variant}.elf"
    assert emulate(image, TARGETS[name]) == expected[variant]


@pytest.mark.slow
def test_the_readme_shows_what_it_prints(expected: dict[str, str]) -> None:
    """But for what a new calibration of the model changes."""
    text = (EXAMPLE / "README.md").read_text("utf-8")
    shown = text.partition("and prints\n\n```\n")[2].partition(", ...\n```")[0].splitlines()
    printed = expected["fixed"].splitlines()
    assert shown[0] == printed[0]
    for ours, theirs in zip(shown[1].split(","), printed[1].split(","), strict=False):
        if ours != theirs:
            assert abs(int(ours) - int(theirs)) <= 2


@pytest.mark.slow
def test_cmake_runs_it(expected: dict[str, str], core) -> None:
    _, folder = core
    said = run("cmake", "--build", folder, "--target", "run_fixed")
    assert expected["fixed"] in said


def float_code(image: Path, target: Target) -> set[str]:
    """Functions of an image that are float arithmetic."""
    lines = run(f"{target.system.cross}nm", image).splitlines()
    names = {line.split()[-1] for line in lines}
    return {name for name in names if FLOAT_CODE.fullmatch(name)}


@pytest.mark.slow
@pytest.mark.parametrize("core", long_but(SOME_CORES, NO_FPU), indirect=True)
def test_fixed_point_has_no_float_code(core) -> None:
    name, folder = core
    images = folder / "examples" / "firmware"
    assert float_code(images / "firmware_fixed.elf", TARGETS[name]) == set()
    found = float_code(images / "firmware_float.elf", TARGETS[name])
    assert len(found) >= 8, "the test sees what the float variant has"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cortex-m4f", "cortex-m55"])
def test_kernels_in_assembly_compile_without_optimisation_too(name: str, tmp_path: Path) -> None:
    need_core(TARGETS[name])
    sources = sorted((ROOT / "lib" / "network").glob("*.c"))
    assert len(compile_each(compiler(TARGETS[name], "-O0"), tmp_path, sources)) == len(sources) > 8


KERNELS = (
    r"sum_rows|sum_eight|list_part|read_fours|give_eight|give_fours|activate_eight"
    r"|activate_fours|dot8|dot16"
    r"|multiply|subtract_outer|reflect_points|undo_sweep"
)
CORTEX_M4, CORTEX_M55 = ("cortex-m4", "-mfpu=fpv4-sp-d16"), ("cortex-m55", "-mfpu=auto")


def kernels_of(item: Path) -> dict[str, list[str]]:
    """The machine code of the kernels in an object file, by their names, without what fills up."""
    text = run("arm-none-eabi-objdump", "-d", item) + "\n\n"
    functions = re.findall(rf"<({KERNELS})>:\n(.*?)\n\n", text, re.S)
    filled = {name: re.findall(r"(?m)^ +\w+:\t([0-9a-f ]+?) *\t", code) for name, code in functions}
    return {name: code[:-1] if code[-1:] == ["bf00"] else code for name, code in filled.items()}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("core", "source", "count"),
    [
        (CORTEX_M4, "network/equivariant_w16.c", 5),
        (CORTEX_M4, "network/equivariant_w8.c", 5),
        (CORTEX_M4, "network/equivariant_f32.c", 4),
        (CORTEX_M4, "network/fconv_w8.c", 1),
        (CORTEX_M4, "lift/lift_f32.c", 4),
        (CORTEX_M55, "network/equivariant_w16.c", 2),
        (CORTEX_M55, "lift/lift_f32.c", 4),
    ],
)
def test_clang_assembles_the_kernels_as_gcc_does(
    core: tuple[str, str], source: str, count: int, tmp_path: Path
) -> None:
    cpu, fpu = core
    need("clang")
    need_core(TARGETS["cortex-m4f"])
    if not PICOLIBC.exists():
        pytest.skip(f"no {PICOLIBC}")
    flags = [f"-mcpu={cpu}", "-mthumb", "-mfloat-abi=hard", "-std=c99", "-Os", *INCLUDES]
    items = []
    for command in (
        ["arm-none-eabi-gcc", "--specs=picolibc.specs", fpu],
        ["clang", "--target=arm-none-eabi", f"-isystem{PICOLIBC}"],
    ):
        items.append(tmp_path / f"{command[0]}.o")
        run(*command, *flags, "-c", ROOT / "lib" / source, "-o", items[-1])
    by_gcc, by_clang = map(kernels_of, items)
    assert by_gcc == by_clang and len(by_gcc) == count and all(by_gcc.values())


@pytest.mark.long
@pytest.mark.parametrize("name", NO_FPU)
def test_fconv_in_fixed_point_has_no_float_code(name: str, tmp_path: Path) -> None:
    target = TARGETS[name]
    if name == "cortex-m0plus":  # its board is too small
        target = replace(target, flash=TARGETS["cortex-m3"].flash, ram=TARGETS["cortex-m3"].ram)
    need_core(target)
    library = compile_library(target, "-Os", tmp_path)
    for fixed, model in ((True, "w8"), (False, "f32")):
        options = [f"-DMODEL=edml_fconv_{model}", "-DFCONV", *(["-DFIXED"] if fixed else [])]
        image = tmp_path / f"{model}.elf"
        program = ROOT / "tests" / "targets" / "bench" / "smallest.c"
        build(program, target, "-Os", image, *options, library=library)
        assert (float_code(image, target) == set()) == fixed


@pytest.mark.long
def test_vendored_with_its_makefile(tmp_path: Path, expected: dict[str, str]) -> None:
    need("make")
    need_core(TARGETS["cortex-m3"])
    for folder in ("include", "lib"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    (tmp_path / "gen").mkdir()
    for file in [*(ROOT / "gen").glob("*.h"), *EXAMPLE.iterdir()]:
        shutil.copy(file, tmp_path / ("gen" if file.parent.name == "gen" else ""))
    run("make", "-s", "-C", tmp_path)
    assert emulate(tmp_path / "firmware.elf", TARGETS["cortex-m3"]) == expected["fixed"]


def test_the_table_is_the_sample_walk() -> None:
    need("sed")
    made = run("sed", "-f", EXAMPLE / "walk.sed", ROOT / "examples" / "data" / "walk.csv")
    assert made == (EXAMPLE / "walk.inc").read_text("utf-8")
