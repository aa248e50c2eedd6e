"""tools/amalgamate: the library as one file gives the library's bits, in C and in C++."""

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from builds import need, need_cross_compiler, run_firmware

from channels.amalgamation import one_file, one_file_sizes
from channels.amalgamation.amalgamate import AmalgamationError, amalgamate, choose, known_parts
from channels.version import version
from data.paths import LIB
from reports import markdown
from reports.targets import INCLUDES, ROOT, TARGETS, ToolError, compiler, library_flags, run

PROGRAM = ROOT / "tests" / "targets" / "bits.c"
TOOL = ROOT / "tools" / "amalgamate"
BITS = (ROOT / "tests" / "bits.txt").read_text().splitlines(keepends=True)
DIRECT = ["direct_f32", "direct_w16", "direct_w8"]
DISTANCES = ["distances_f32", "distances_w16", "distances_w8"]
OTHERS = ["distances_f32", "distances_w16", "fconn_f32"]  # which the rest of bits.c names
WARNINGS = ["-Wall", "-Wextra", "-Werror"]


DIRECT_BITS = "".join(line for line in BITS if "direct" in line)  # -DPARTS=2
DISTANCES_BITS = "".join(line for line in BITS if "distances" in line)  # -DPARTS=1
MOST_BITS = "".join(line for line in BITS if not re.search("distances|fconn", line))  # 26


@pytest.fixture(scope="module")
def direct(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """edmlift.c with the direct models and both lifts."""
    folder = tmp_path_factory.mktemp("direct")
    amalgamate(DIRECT, ["float", "fixed"], folder)
    return folder / "edmlift.c"


@pytest.fixture(scope="module")
def everything(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """edmlift.c with all parts."""
    folder = tmp_path_factory.mktemp("everything")
    amalgamate(DIRECT + OTHERS, ["all"], folder)
    return folder / "edmlift.c"


# ---- Bits ----------------------------------------------------------------------------------------


def compile_file(source: Path, command: str, item: Path) -> Path:
    """An object file, by a compiler that must not warn."""
    program, *options = command.split()
    need(program)
    run(program, *options, *WARNINGS, "-c", source, "-o", item)
    return item


def bits(part: int, folder: Path, *objects: Path) -> str:
    """What parts of bits.c, compiled with the library's headers, print with these objects."""
    flags = [*library_flags(), "-O1", *INCLUDES, f"-DPARTS={part}"]
    run("gcc", *flags, PROGRAM, *objects, "-lm", "-o", folder / "bits")
    return run(folder / "bits")


@pytest.mark.slow
def test_all_parts_as_c99_give_the_same_bits(everything: Path, tmp_path: Path) -> None:
    """FConv's kernels, which bits.c runs as well, come from the library."""
    one = compile_file(everything, "gcc -std=c99 -pedantic -O1", tmp_path / "one.o")
    assert bits(26, tmp_path, one, *(LIB / "network").glob("fconv_*.c")) == MOST_BITS


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", ["g++ -x c++ -std=c++11 -O1", "clang -std=gnu11 -O1 -march=native"]
)
def test_cpp_and_clang_give_the_same_bits(command: str, direct: Path, tmp_path: Path) -> None:
    assert bits(2, tmp_path, compile_file(direct, command, tmp_path / "one.o")) == DIRECT_BITS


@pytest.mark.slow
@pytest.mark.parametrize("core", ["cortex-m4f", "rv32imc"])
def test_a_core_gives_the_same_bits(core: str, direct: Path, tmp_path: Path) -> None:
    assert run_firmware(PROGRAM, TARGETS[core], tmp_path, [direct], "-DPARTS=2") == DIRECT_BITS


@pytest.mark.slow
@pytest.mark.parametrize("core", ["cortex-m4f", "cortex-m55"])
def test_the_fixed_scaling_is_not_in_the_words_of_an_fpu(core: str, tmp_path: Path) -> None:
    """The float one beside it is."""
    amalgamate(DISTANCES, ["float", "fixed"], tmp_path)
    files = [tmp_path / "edmlift.c"]
    assert run_firmware(PROGRAM, TARGETS[core], tmp_path, files, "-DPARTS=1") == DISTANCES_BITS


# ---- As what it compiles, and what is in it ------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("command", ["clang++ -x c++ -std=c++20 -pedantic", "gcc -std=c11"])
def test_all_parts_compile_without_a_warning(command: str, everything: Path) -> None:
    program, *options = command.split()
    need(program)
    run(program, *options, *WARNINGS, "-Wundef", "-fsyntax-only", everything)


def declared(header: Path) -> set[str]:
    """Functions and objects that a header declares; none of them is in a comment."""
    code = re.sub(r"/\*.*?\*/", "", header.read_text("utf-8"), flags=re.S)
    functions = re.findall(r"^(?:const )?\w+(?: \*| )(edml_\w+)\(", code, re.M)
    objects = " ".join(re.findall(r"^extern const (?:\w+ )[^;]*;", code, re.M))
    return {*functions, *re.findall(r"\b(edml_\w+)(?=[\[,;])", objects)}


@pytest.mark.slow
def test_only_what_was_asked_for_is_there(tmp_path: Path) -> None:
    """Functions of the stages are internal; fixed point asks for nothing, not even for a root."""
    need("gcc", "nm")
    amalgamate(["direct_w8"], ["fixed", "camera"], tmp_path)
    shared = tmp_path / "library.so"
    run("gcc", "-O1", "-fPIC", "-shared", "-Wl,-z,defs", tmp_path / "edmlift.c", "-o", shared)
    names = run("nm", "-D", "--defined-only", shared).splitlines()
    exported = {line.split()[-1] for line in names}
    assert exported == declared(tmp_path / "edmlift.h")
    assert {"edml_lift_q", "edml_place_q", "edml_direct_w8", "edml_coco17"} < exported
    others = {"edml_lift", "edml_place", "edml_mds_q", "edml_angles_q", "edml_direct_w16"}
    assert not exported & others


@pytest.mark.slow
@pytest.mark.parametrize("part", [part for part in known_parts() if part not in ("float", "fixed")])
def test_a_part_alone_declares_its_header_and_compiles(part: str, tmp_path: Path) -> None:
    """In one of the arithmetics; what it calls is defined."""
    arithmetic = "fixed" if part in ("angles", "many", "stages") else "float"
    amalgamate(["direct_w8"], [arithmetic, part], tmp_path)
    of_part = declared(ROOT / "include" / "edmlift" / f"{part}.h")
    floats = {name for name in of_part if f"{name}_q" in of_part}
    fixed = {f"{name}_q" for name in floats}
    there = declared(tmp_path / "edmlift.h")
    assert of_part & there == of_part - (floats if arithmetic == "fixed" else fixed)
    source = (tmp_path / "edmlift.c").read_text("utf-8")
    (tmp_path / "edmlift.c").write_text(source[: source.index("/* ======== Models")])
    run("gcc", "-std=c99", *WARNINGS, "-fsyntax-only", tmp_path / "edmlift.c")


@pytest.mark.slow
def test_fixed_point_has_no_float(tmp_path: Path) -> None:
    """On a core without an FPU, where floats are functions of the compiler."""
    target = TARGETS["cortex-m0plus"]
    need_cross_compiler(target)
    amalgamate(["direct_w8"], ["fixed"], tmp_path)
    item = tmp_path / "one.o"
    run(*compiler(target, "-O1"), *WARNINGS, "-c", tmp_path / "edmlift.c", "-o", item)
    asked = run(f"{target.system.cross}nm", "-u", item).split()[1::2]
    assert not [name for name in asked if re.match(r"__aeabi_[fd]|sqrtf", name)]


@pytest.mark.slow
def test_a_network_of_distances_lifts_in_one_arithmetic(tmp_path: Path) -> None:
    """Its model names what the other lift has: nothing, in this file."""
    amalgamate(["fconn_w8"], ["float"], tmp_path)
    program = tmp_path / "consumer"
    named = "-Dedml_distances_f32=edml_fconn_w8"
    files = [f"-I{tmp_path}", one_file.CONSUMER, tmp_path / "edmlift.c"]
    run("gcc", "-O1", named, *files, "-lm", "-o", program)
    assert run(program) == one_file.SAYS


@pytest.mark.slow
@pytest.mark.claims("docs/one-file.md", "one_file")
def test_flash_is_that_of_many_files_and_of_the_page() -> None:
    need_cross_compiler(TARGETS[one_file_sizes.CORE])
    size = one_file_sizes.measure("direct_w8", ["float"])
    assert size.more < 1
    page = markdown.read(ROOT / "docs" / "one-file.md", "one_file")
    row = next(line for line in page.splitlines() if size.choice in line)
    text, flash, many = (int(cell.replace(",", "")) for cell in row.split("|")[2:5])
    written = pytest.approx([text, flash, many], rel=0.03)
    assert [size.text, size.flash, size.many] == written


# ---- The files -----------------------------------------------------------------------------------


@pytest.mark.slow
def test_what_stands_on_top(direct: Path) -> None:
    text = direct.read_text("utf-8")
    assert text.startswith(f"/* edmlift {version()} in one file: ")
    comment = text[: text.index("*/")]
    assert "tools/amalgamate direct_f32 direct_w16 direct_w8 --parts float fixed -o DIR" in comment
    licence = (ROOT / "LICENSE").read_text("utf-8")
    assert licence.splitlines()[-1] in comment and "SPDX-License-Identifier: MIT" in comment
    contents = re.findall(r"^ \*   ((?:lib|gen|include)/\S+)$", comment, re.M)
    assert len(contents) > 40
    for name in contents:
        assert f"/* ---- {name} ---- */" in text and (ROOT / name).exists()


@pytest.mark.slow
def test_nothing_includes_the_repository_s_files(everything: Path) -> None:
    for file in (everything, everything.with_suffix(".h")):
        included = set(re.findall(r'^\s*#\s*include "(.*)"', file.read_text("utf-8"), re.M))
        assert included <= {"edmlift.h"}


@pytest.mark.slow
def test_all_sources_are_there_with_all_parts(everything: Path) -> None:
    """But for the networks that were not asked for."""
    there = {source.path for source in choose(DIRECT + OTHERS, ["all"]).sources()}
    others = r"fconv_|fconn_w|distances_w8"
    assert there == {path for path in LIB.rglob("*.c") if not re.match(others, path.name)}


def run_tool(*arguments: object, **environment: str) -> subprocess.CompletedProcess:
    command = [sys.executable, str(TOOL), *map(str, arguments)]
    variables = os.environ | environment
    return subprocess.run(command, capture_output=True, text=True, check=False, env=variables)


@pytest.mark.slow
def test_the_command_writes_the_same_bytes_each_time(tmp_path: Path) -> None:
    one, two = tmp_path / "new" / "one", tmp_path / "two"
    said = run_tool("direct_w8", "--parts", "all", "-o", one, PYTHONHASHSEED="1")
    assert said.returncode == 0 and re.search(r"edmlift\.c  \d+,\d+ bytes\n", said.stdout)
    amalgamate(["direct_w8"], ["all"], two)
    assert sorted(file.name for file in one.iterdir()) == ["edmlift.c", "edmlift.h"]
    for file in one.iterdir():
        assert file.read_bytes() == (two / file.name).read_bytes()


def test_the_help_lists_models_and_parts() -> None:
    said = run_tool("--help").stdout
    assert re.search(r"^  direct_w8 .* 44 mm", said, re.M)
    for part in known_parts():
        assert re.search(rf"^  {part} +\w", said, re.M), part


@pytest.mark.parametrize(
    "models, parts, message",
    [
        (["direct_w4"], [], "There is no model 'direct_w4'; near it: direct_w8"),
        (["mine"], [], "There is no model 'mine'; known: direct_f32, "),
        (["direct_w8"], ["angels"], "There is no part 'angels'; near it: angles"),
        (["direct_f32"], ["fixed"], "Fixed point cannot run direct_f32: add the part float."),
        ([], [], "Name a model: direct_f32, "),
    ],
)
def test_what_is_not_there_is_said(
    models: list[str], parts: list[str], message: str, tmp_path: Path
) -> None:
    with pytest.raises(AmalgamationError) as error:
        amalgamate(models, parts, tmp_path / "out")
    assert str(error.value).startswith(message)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    said = run_tool("direct_w8", "-o", file)
    assert said.returncode == 1 and said.stdout == ""
    assert said.stderr == f"tools/amalgamate: Cannot write into {file}: File exists.\n"


@pytest.mark.slow
def test_nothing_is_written_where_one_file_cannot_be(tmp_path: Path) -> None:
    (tmp_path / "edmlift.c").mkdir()
    with pytest.raises(AmalgamationError, match=r"Cannot write .*: edmlift.c is a directory\.$"):
        amalgamate(["direct_w8"], ["float"], tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["edmlift.c"]


# ---- The release ---------------------------------------------------------------------------------


@pytest.fixture
def archive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """With one of its folders."""
    monkeypatch.setattr(one_file, "choices", lambda: {"direct_w8": ["direct_w8"]})
    return one_file.build(tmp_path)[0]


@pytest.mark.slow
def test_the_archive_has_a_file_that_lifts(archive: Path, tmp_path: Path) -> None:
    assert archive.name == f"edmlift-{version()}-one-file.zip"
    with zipfile.ZipFile(archive) as files:
        names = [name.partition("/")[2] for name in files.namelist()]
        page = files.read(f"{archive.stem}/README.md").decode()
    assert names == ["README.md", "direct_w8/edmlift.c", "direct_w8/edmlift.h", "lift.c"]
    assert page.startswith("# ") and "](" not in page
    one_file.check([archive])


@pytest.mark.slow
def test_a_file_that_does_not_lift_is_found(archive: Path, tmp_path: Path) -> None:
    source = f"{archive.stem}/direct_w8/edmlift.c"
    with zipfile.ZipFile(archive) as files:
        kept = {name: files.read(name) for name in files.namelist()}
    kept[source] = kept[source].replace(b"0x14221ce5u", b"0x14221ce6u") + b"int broken = ;\n"
    with pytest.raises(ToolError, match="broken"):
        one_file.check([one_file.write_zip(tmp_path / "broken.zip", kept)])


def test_the_release_has_the_models_to_take() -> None:
    assert set(DIRECT + OTHERS[:2]) < set(one_file.choices()[one_file.SEVERAL])
    assert one_file.choices()["direct_w8"] == ["direct_w8"]
