"""The pages that people read: links lead somewhere, names exist, programs do what is shown."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from builds import long_but
from conftest import ROOT

from reports.targets import INCLUDES, compile_each, library_flags

TOP = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md")]
DOCS = sorted((ROOT / "docs").glob("*.md"))
OTHERS = [*sorted((ROOT / "examples").rglob("*.md")), *sorted((ROOT / "tools").glob("*.md"))]
PAGES = TOP + DOCS + OTHERS
OF_TODAY = [page for page in PAGES if page.name != "CHANGELOG.md"]  # which has the old names, too
PROGRAMS = "lift detector five_detectors fixed place track body room angles".split()
WARNINGS = "-pedantic -Wall -Wextra -Wconversion -Wshadow -Wvla -Werror".split()
README_LINES = 200


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def without_code(text: str) -> str:
    """A page without its blocks and spans of code."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S))


def blocks(page: Path, language: str) -> list[str]:
    """Blocks of code in a language; "" are those without one."""
    every = re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S)
    return [text for name, text in every if name == language]


def anchors(page: Path) -> set[str]:
    """What links of a page may end in, as GitHub makes it of headings."""
    text = re.sub(r"^```.*?^```$", "", page.read_text("utf-8"), flags=re.M | re.S)
    titles = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


# ---- Links and names ---------------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)\s]+)\)", without_code(page.read_text("utf-8"))):
        if re.match(r"\w+:", link):
            continue
        file, _, anchor = link.partition("#")
        target = (page.parent / file).resolve() if file else page
        assert target.exists(), f"{link}: no such file"
        assert target.is_relative_to(ROOT), f"{link}: outside the repository"
        if anchor:
            assert anchor in anchors(target), f"{link}: no such heading"


def test_the_index_lists_every_page() -> None:
    index = (ROOT / "docs" / "README.md").read_text("utf-8")
    for page in DOCS:
        assert page.name == "README.md" or f"({page.name})" in index, page.name


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text("utf-8").splitlines()) <= README_LINES


def names_in(*files: Path) -> set[str]:
    """The library's names, and those of the constants that its model header has."""
    return {
        name for f in files for name in re.findall(r"\b(?:edml|EDML)_\w+", f.read_text("utf-8"))
    }


@pytest.mark.parametrize("page", OF_TODAY, ids=name_of)
def test_names_of_the_library_exist(page: Path) -> None:
    """But for models of one's own; of `edml_fconn_*` the beginning does.

    Mutants are of names that others do not see.
    """
    inside = (ROOT / "lib").rglob("*.[ch]" if page.stem == "mutation" else "model.h")
    known = names_in(*(ROOT / "include").rglob("*.h"), *inside)
    for name in names_in(page):
        own = name.startswith(("edml_mine", "edml_verb", "edml__NAME"))
        assert own or name in known or any(k.startswith(name) for k in known), name


FOLDERS = "include|lib|gen|examples|tests|tools|docs|cmake"


@pytest.mark.parametrize("page", OF_TODAY, ids=name_of)
def test_files_that_are_named_exist(page: Path) -> None:
    """But for those with a name in capitals, which stand for one's own."""
    for path in re.findall(rf"`((?:{FOLDERS})/[\w./-]+)`", page.read_text("utf-8")):
        if re.search(r"[A-Z]{3}", path.replace("README", "")):
            continue
        assert (ROOT / path).exists(), path


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_tables_of_tools_have_both_marks(page: Path) -> None:
    marks = re.findall(r"^<!-- (begin|end) (\w+) -->$", page.read_text("utf-8"), re.M)
    for (word, name), (other, same) in zip(marks[::2], marks[1::2], strict=True):
        assert (word, other) == ("begin", "end") and name == same


# ---- Programs ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What each program prints."""
    if shutil.which("gcc") is None:
        pytest.skip("no gcc")
    folder = tmp_path_factory.mktemp("programs")
    command = ["gcc", *library_flags(), "-O2", *INCLUDES]  # as other tests: of ccache
    library = compile_each(command, folder)
    found = {}
    for name in PROGRAMS:
        source, program = ROOT / "examples" / f"{name}.c", folder / name
        run(*command, *WARNINGS, "-Wl,--gc-sections", source, *library, "-lm", "-o", program)
        found[name] = run(program)
    return found


def run(*command: object) -> str:
    texts = [str(part) for part in command]
    done = subprocess.run(texts, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_block_of_c_is_a_program_of_the_examples(page: Path) -> None:
    programs = {name: (ROOT / "examples" / f"{name}.c").read_text("utf-8") for name in PROGRAMS}
    for block in blocks(page, "c"):
        assert block in programs.values(), block.partition("\n")[0]


@pytest.mark.slow
@pytest.mark.parametrize("name", PROGRAMS)
def test_a_page_shows_the_program_and_what_it_prints(name: str, printed: dict[str, str]) -> None:
    source = (ROOT / "examples" / f"{name}.c").read_text("utf-8")
    pages = [page for page in PAGES if source in blocks(page, "c")]
    assert pages, f"no page shows examples/{name}.c"
    for page in pages:
        assert printed[name] in blocks(page, ""), f"{name_of(page)}: it prints\n{printed[name]}"


@pytest.mark.slow
def test_first_pose_shows_the_beginning_of_what_is_printed(printed: dict[str, str]) -> None:
    shown = blocks(ROOT / "docs" / "first-pose.md", "")
    for name in ("lift", "fixed"):
        begin = "".join(printed[name].splitlines(keepends=True)[:3]) + "...\n"
        assert begin in shown, begin


@pytest.mark.slow
@pytest.mark.parametrize(
    ("compiler", "name"),
    long_but(
        [("cc", "lift"), ("arm-none-eabi-gcc", "fixed")],
        [("cc", "lift"), ("arm-none-eabi-gcc", "fixed"), ("cmake", "")],
    ),
)
def test_the_commands_of_first_pose_work(
    compiler: str, name: str, printed: dict[str, str], tmp_path: Path
) -> None:
    """As they are written, in a folder that looks like a clone; a program has no FConv, which is
    half of what there is to compile."""
    (commands,) = [
        block
        for block in blocks(ROOT / "docs" / "first-pose.md", "sh")
        if block.startswith(f"{compiler} ")
    ]
    programs = set(re.findall(r"^(cc|cmake|[a-z-]+-gcc|qemu[\w-]+)", commands, re.M))
    if missing := [program for program in programs if shutil.which(program) is None]:
        pytest.skip(f"no {missing[0]}")
    for folder in ("cmake", "examples", "gen", "include", "CMakeLists.txt"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    for source in (ROOT / "lib").glob("*/*"):
        if compiler == "cmake" or "fconv" not in source.name:
            link = tmp_path / source.relative_to(ROOT)
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(source)
    done = subprocess.run(
        ["sh", "-e", "-c", commands], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, cwd=tmp_path, timeout=600,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    if name:
        assert done.stdout.endswith(printed[name])  # QEMU prints to stderr
    else:
        lines = (tmp_path / "lifted.csv").read_text().splitlines()
        assert len(lines) == 40 and lines[1].startswith("ok,")
