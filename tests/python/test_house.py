"""The house rules of the C library: names, headers, exports; by compilers and text search."""

import re
import subprocess
from collections import defaultdict
from pathlib import Path

import pytest
from builds import need
from support import need_library

from edmlift._binding import default_path
from reports import targets

ROOT = Path(__file__).resolve().parents[2]
LIB, INCLUDE, GEN = ROOT / "lib", ROOT / "include", ROOT / "gen"
SOURCES = sorted(LIB.rglob("*.c"))
PUBLIC_HEADERS = sorted(INCLUDE.rglob("*.h"))
HEADERS = PUBLIC_HEADERS + sorted(LIB.rglob("*.h"))
PATHS = [f"-I{INCLUDE}", f"-I{LIB}"]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def compile_text(text: str, folder: Path, *options: str, compiler: str = "gcc") -> str:
    """What the compiler says of a C file with this text; empty if nothing."""
    need(compiler)
    source = folder / "text.c"
    source.write_text(text, "utf-8")
    command = [compiler, *PATHS, *options, str(source)]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder).stderr


def code_of(path: Path) -> str:
    """A C file without its comments."""
    return re.sub(r"/\*.*?\*/", "", path.read_text("utf-8"), flags=re.S)


# ---- Tables --------------------------------------------------------------------------------------


def table_of(path: Path, name: str) -> list[int]:
    """The numbers of a C array."""
    match = re.search(rf"\b{name}\[\d+\] = \{{(.*?)\}};", code_of(path), re.S)
    assert match, f"{name_of(path)} has no {name}"
    return [int(number) for number in match[1].split(",")]


def test_the_tables_of_division_and_root_are_as_defined():
    fixed = LIB / "number" / "fixed.c"
    wanted = [round(2**15 / (k + 0.5)) for k in range(128, 256)]
    assert table_of(fixed, "reciprocals") == wanted
    wanted = [round(2**11 / (k + 0.5) ** 0.5) for k in range(64, 256)]
    assert table_of(fixed, "inverse_roots") == wanted


# ---- Public functions ----------------------------------------------------------------------------


def public_functions() -> dict[str, str]:
    """What the public headers declare: each function and the type that it returns."""
    declared = {}
    for header in PUBLIC_HEADERS:
        pattern = r"^((?:const )?\w+(?: \*| ))(edml_\w+)\("
        for result, name in re.findall(pattern, code_of(header), re.M):
            declared[name] = result.strip()
    return declared


def public_objects() -> set[str]:
    """Constant data that the public headers declare."""
    text = "\n".join(code_of(header) for header in PUBLIC_HEADERS)
    lines = re.findall(r"^extern const [^;]*;", text, re.M)
    return {name for line in lines for name in re.findall(r"\b(edml_\w+)(?=[\[,;])", line)}


def definitions(name: str) -> list[str]:
    """Where a text search for the function's name at the left margin finds it in lib/."""
    pattern = re.compile(rf"^\w[\w *]*\b{name}\([^;{{]*\)\s*{{", re.M)
    return [name_of(path) for path in sorted(LIB.rglob("*.[ch]")) if pattern.search(code_of(path))]


def fixed_point_aliases() -> dict[str, str]:
    """What each name stands for in the texts of fixed point."""
    return dict(re.findall(r"^#define (edml_\w+) (edml_\w+)$", code_of(LIB / "api/api_q.h"), re.M))


def test_the_headers_declare_functions_and_data() -> None:
    assert {"edml_lift", "edml_lift_q", "edml_joint_name", "edml_adapt"} < set(public_functions())
    assert {"edml_coco17", "edml_formats", "edml_bones", "edml_fconv_w8"} < public_objects()


@pytest.mark.parametrize("name", sorted(public_functions()))
def test_a_public_function_is_defined_once_under_its_name(name: str) -> None:
    """A fixed-point one under its own, or as the float one under the alias that api_q.h has."""
    if definitions(name) == []:
        plain = name.removesuffix("_q")
        assert fixed_point_aliases()[plain] == name
        name = plain
    assert len(definitions(name)) == 1


def test_every_alias_is_of_a_public_name() -> None:
    """Or of one that models name."""
    headers = [*PUBLIC_HEADERS, LIB / "network" / "kernels.h"]
    text = "\n".join(code_of(header) for header in headers)
    for plain, alias in fixed_point_aliases().items():
        assert alias == f"{plain}_q" and re.search(rf"\b{alias}\b", text)


def test_the_error_contract_is_tested_for_every_status() -> None:
    """Functions that return a status are in test_contract.c, which both arithmetics compile."""
    contract = (ROOT / "tests" / "unit" / "test_contract.c").read_text("utf-8")
    functions = public_functions()
    for name, result in functions.items():
        if result == "edml_status":
            assert re.search(rf"\b{name.removesuffix('_q')}\(", contract), name


# ---- Headers -------------------------------------------------------------------------------------


@pytest.mark.parametrize("header", HEADERS, ids=name_of)
def test_a_header_compiles_alone_as_c99(header: Path, tmp_path: Path) -> None:
    warnings = ["-Wall", "-Wextra", "-Wno-unused-function"]
    text = f'#include "{header}"\n#include "{header}"\ntypedef int not_empty;\n'
    options = ["-std=c99", "-pedantic", *warnings, "-fsyntax-only"]
    compiler = "gcc"
    if "<arm_mve.h>" in header.read_text("utf-8"):  # of one processor alone
        compiler, *more = targets.compiler(targets.TARGETS["cortex-m55"], "-Os")
        options += more
    assert compile_text(text, tmp_path, *options, compiler=compiler) == ""


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize("header", PUBLIC_HEADERS, ids=name_of)
def test_a_public_header_compiles_alone_as_cpp(compiler: str, header: Path, tmp_path: Path) -> None:
    options = "-x c++ -std=c++11 -pedantic -Wall -Wextra -Wconversion -fsyntax-only".split()
    assert compile_text(f'#include "{header}"\n', tmp_path, *options, compiler=compiler) == ""


def test_the_header_for_everybody_is_short() -> None:
    assert len((INCLUDE / "edmlift.h").read_text("utf-8").splitlines()) <= 200


def test_functions_are_short() -> None:
    """At most 40 lines, from the first brace to the last."""
    for path in sorted(LIB.rglob("*.[ch]")):
        text = path.read_text("utf-8")
        for body in re.finditer(r"^{\n.*?^}$", text, re.M | re.S):
            line = text.count("\n", 0, body.start())
            assert body[0].count("\n") < 40, f"{name_of(path)}, line {line}"


def test_the_library_has_few_conditions_of_the_preprocessor() -> None:
    """Under 5 in 1000 lines; include guards do not count."""
    conditions = lines = 0
    for path in sorted(LIB.rglob("*.[ch]")):
        text = path.read_text("utf-8")
        lines += text.count("\n")
        guards = re.findall(r"^#ifndef (\w+)\n#define \1$", text, re.M)
        conditions += len(re.findall(r"^#\s*if", text, re.M)) - len(guards)
    assert 1000 * conditions < 5 * lines


# ---- Names ---------------------------------------------------------------------------------------

# Files that define the same words, of which a translation unit includes one.
FAMILIES = [
    ("number/real_",),
    ("api/api_",),
    ("network/weights_",),
    ("network/dot8", "network/rows_"),
    ("network/units_",),
    ("network/ends_",),
    ("network/q24_",),
    ("lift/symmetric",),
    ("lift/turn_points",),
]


def family(path: Path) -> str:
    for prefixes in FAMILIES:
        if str(path.relative_to(LIB)).startswith(prefixes):
            return prefixes[0]
    return name_of(path)


def static_names(path: Path) -> set[str]:
    """Static functions and data, types, enumerators and macros that a file defines."""
    code = code_of(path)
    names = set(re.findall(r"^(?:__attribute__\(.*?\)\) )?static [^;={]*?\b(\w+)\(", code, re.M))
    names |= set(re.findall(r"^static const [^;(]*?\b(\w+)(?:\[[^=]*)? = ", code, re.M))
    names |= set(re.findall(r"^#define (\w+)", code, re.M))
    names |= set(re.findall(r"^}? ?(?:typedef [^;{(]*?)?\b(\w+);$", code, re.M))
    for body in re.findall(r"^enum {(.*?)};", code, re.M | re.S):
        names |= set(re.findall(r"(\w+)(?: = [^,]*)?(?:,|\s*$)", body))
    return names


def test_static_names_are_unique_in_the_library() -> None:
    """So that all of it can be one file; files of a family share their words."""
    places: defaultdict[str, set[str]] = defaultdict(set)
    for path in sorted(LIB.rglob("*.[ch]")):
        for name in static_names(path):
            places[name].add(family(path))
    assert {"rotate", "REAL", "move_origin_to_mid_hip", "TAPS", "joint_error"} < set(places)
    several = {name: found for name, found in places.items() if len(found) > 1}
    assert several == {}


# ---- Translation units ---------------------------------------------------------------------------


def float_sources() -> list[Path]:
    """The float pipeline, and what both need; no networks."""
    others = r"lib/models/|network/(fcon|equivariant)|number/fixed|_q\.c$"
    return [path for path in SOURCES if not re.search(others, str(path))]


def fixed_sources() -> list[Path]:
    return [path for path in SOURCES if path.stem.endswith("_q") or path.stem == "fixed"]


def models_with_kernels() -> dict[str, list[Path]]:
    """Each model's file with that of the network that it names."""
    units = {}
    for model in sorted((LIB / "models").glob("*.c")):
        header = (GEN / f"{model.stem}.h").read_text("utf-8")
        kernel = re.search(r"\bedml__(\w+)_checksum_(\w+)\b", header)
        units[model.stem] = [LIB / "network" / f"{kernel[1]}_{kernel[2]}.c", model]
    return units


def compile_unit(name: str, sources: list[Path], folder: Path, *options: str) -> Path:
    """Several sources as one translation unit."""
    text = "".join(f'#include "{source}"\n' for source in sources)
    item = folder / f"{name}.o"
    warnings = ["-Wall", "-Wextra", "-Werror"]
    said = compile_text(text, folder, "-std=c99", "-O0", *warnings, *options, "-c", "-o", str(item))
    assert said == ""
    return item


@pytest.mark.slow
def test_each_half_of_the_library_can_be_one_file(tmp_path: Path) -> None:
    """The float pipeline, the fixed-point one, and each network with its models; and they link."""
    units = {"float": float_sources(), "fixed": fixed_sources()}
    assert len(units["float"]) > 10 and len(units["fixed"]) > 5
    for kernel, model in models_with_kernels().values():
        units.setdefault(kernel.stem, [kernel]).append(model)
    objects = [compile_unit(name, sources, tmp_path) for name, sources in units.items()]
    names = sorted(public_functions())
    declarations = "".join(f'#include "{header}"\n' for header in PUBLIC_HEADERS)
    uses = "".join(f"    (void (*)(void)){name},\n" for name in names)
    program = tmp_path / "main.c"
    table = f"{declarations}void (*const all[])(void) = {{\n{uses}}};\n"
    program.write_text(table + "int main(void) { return all[0] == 0; }\n", "utf-8")
    command = ["gcc", "-std=c99", *PATHS, program, *objects, "-lm", "-o", tmp_path / "all"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


# ---- Symbols -------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_shared_library_exports_the_public_names_and_no_others() -> None:
    need("nm")
    need_library()
    listing = ["nm", "-D", "--defined-only", str(default_path())]
    said = subprocess.run(listing, capture_output=True, text=True, check=True)
    exported = {line.split()[-1] for line in said.stdout.splitlines()}
    assert exported == set(public_functions()) | public_objects()


# ---- Generated headers ---------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("model", sorted(models_with_kernels()))
def test_a_header_of_another_format_does_not_compile(model: str, tmp_path: Path) -> None:
    text = (GEN / f"{model}.h").read_text("utf-8")
    older = re.sub(r"(?m)^#if EDML_WEIGHTS_FORMAT != \d+$", "#if EDML_WEIGHTS_FORMAT != 1", text)
    assert older != text
    older = f'#include "network/kernels.h"\n{older}'
    said = compile_text(older, tmp_path, "-std=c99", "-fsyntax-only", "-Wfatal-errors")
    assert "regenerate with tools/export_weights.py" in said
