"""The library as one file: edmlift.h and edmlift.c, with the models and parts that are wanted.

Texts are those of include/, lib/ and gen/.  What a choice needs is found from the texts as well: a
source is there if something that is there asks for what it defines.
"""

import argparse
import difflib
import errno
import re
import shlex
import sys
import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from channels.amalgamation.c_text import (
    Token,
    declaration_of,
    directive_of,
    is_prototype,
    items,
    names_in,
    read_tokens,
    text_of,
)
from channels.amalgamation.inlining import (
    FORMS,
    INCLUDE,
    Inliner,
    form_of,
    name_of,
    read_file,
    renamed,
    speaks_words,
)
from channels.amalgamation.prototypes import kept_declarations, without_prototypes
from channels.version import version
from data.paths import GEN, LIB, ROOT

PUBLIC = INCLUDE / "edmlift.h"
KERNELS = LIB / "network" / "kernels.h"
ARITHMETICS = {"float": "f32", "fixed": "q"}
DEFAULT_PARTS = ["float"]
HEADINGS = {
    "": "Float32, and what all share",
    "_q": "Fixed point: private names end in _q",
    "_w16": "Networks with weights of 16 bits: private names end in _w16",
    "_w8": "Networks with weights of 8 bits: private names end in _w8",
}
KINDS = {"f32": "in float32", "w16": "of 16 bits", "w8": "of 8 bits"}
UNUSED = """\
#ifdef __clang__ /* which would tell of inline functions that no part in here uses */
#pragma clang diagnostic ignored "-Wunused-function"
#endif
"""


class AmalgamationError(Exception):
    """What was asked for is not there, or cannot be written."""


# ---- What there is -------------------------------------------------------------------------------


def known_models() -> dict[str, str]:
    """Each model, and what its generated header says of it."""
    found = {}
    for source in sorted((LIB / "models").glob("*.c")):
        with (GEN / f"{source.stem}.h").open(encoding="utf-8") as lines:
            head = "".join(next(lines) for _ in range(15))
        about = dict(re.findall(r"^ \* (\w[\w ,]*?) {2,}(.*)$", head, re.M))
        measured = re.match(r"gt ([\d.]+)", about["error, mm"])
        error = f"{measured[1]} mm of error on exact 2D" if measured else "error not measured"
        weights = int(about["parameters"].partition(",")[0])
        found[source.stem] = f"{weights:,} weights {KINDS[source.stem.rpartition('_')[2]]}; {error}"
    return found


def known_parts() -> dict[str, str]:
    """Each part, and what its header says of it."""
    found = {"float": "edmlift.h in float32: the lift, and detectors' keypoints"}
    for header in sorted((INCLUDE / "edmlift").glob("*.h")):
        if header.stem != "work":
            sentence = re.match(r"/\* (.*?)\.\s", header.read_text("utf-8"), re.S)
            found[header.stem] = " ".join(sentence[1].replace("\n *", "").split())
    return found


def check_names(kind: str, names: Sequence[str], known: Iterable[str]) -> None:
    """Raises AmalgamationError for the first name that is not known, with those that are near."""
    known = list(known)
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, 3, 0.5)
            there = f"near it: {', '.join(near)}" if near else f"known: {', '.join(known)}"
            raise AmalgamationError(f"There is no {kind} {name!r}; {there}.")


# ---- What a choice needs -------------------------------------------------------------------------


def with_macros(used: set[str], tokens: Sequence[Token]) -> set[str]:
    """And the names in the macros that are used."""
    bodies: dict[str, set[str]] = {}
    for token in tokens:
        if token.kind == "directive":
            line = directive_of(token)
            if line.keyword == "define":
                bodies.setdefault(line.name, set()).update(re.findall(r"[A-Za-z_]\w*", line.rest))
    found, new = set(used), set(used)
    while new:
        new = {name for macro in new for name in bodies.get(macro, ())} - found
        found |= new
    return found


@dataclass(frozen=True)
class Source:
    """A file of lib/ that is compiled, what it defines and what it asks for."""

    path: Path
    defines: frozenset[str]
    uses: frozenset[str]

    @property
    def is_model(self) -> bool:
        return self.path.parent.name == "models"

    def place(self) -> tuple[object, ...]:
        """Where in the file: float first, so that its pragmas hold for all of it; models last."""
        form = -1 if self.is_model else list(FORMS.values()).index(form_of(self.path))
        return self.is_model, form, not speaks_words(self.path), self.path


@cache
def read_source(path: Path) -> Source:
    inliner = Inliner(skipped=INCLUDE.rglob("*.h"))
    tokens = renamed(inliner.inline(path), form_of(path))
    defines: set[str] = set()
    used: set[str] = set()
    for item in items(tokens):
        declared = declaration_of(item)
        if declared.is_definition and not declared.is_static:
            defines |= set(declared.names)
        if not is_prototype(declared):
            used |= names_in(item)
    return Source(path, frozenset(defines), frozenset(with_macros(used, tokens)))


def declared_in(header: Path) -> set[str]:
    """All names that a public header declares, macros as well."""
    tokens = read_file(header)
    lines = [directive_of(token) for token in tokens if token.kind == "directive"]
    names = {line.name for line in lines if line.keyword == "define"}
    for item in items(tokens):
        declared = declaration_of(item)
        names |= {*declared.names, *declared.constants}
    return names


def weak_names() -> set[str]:
    """Functions that models name, and that are NULL where their lift is not."""
    prototypes = [item for item in items(read_tokens(KERNELS)) if "EDML_WEAK" in names_in(item)]
    return {name for item in prototypes for name in declaration_of(item).names}


@dataclass(frozen=True)
class Choice:
    """Models and parts, in the order in which they are listed."""

    models: list[str]
    parts: list[str]

    @property
    def headers(self) -> list[Path]:
        """The public headers of the parts."""
        named = [INCLUDE / "edmlift" / f"{part}.h" for part in self.parts if part != "float"]
        return [PUBLIC, *named]

    def sources(self) -> list[Source]:
        """What the parts' functions and the models need, in the order of the file."""
        paths = [path for path in LIB.rglob("*.c") if path.parent.name != "models"]
        paths += [LIB / "models" / f"{model}.c" for model in self.models]
        by_name = {name: source for source in map(read_source, paths) for name in source.defines}
        left_out = {form for part, form in ARITHMETICS.items() if part not in self.parts}
        wanted = [f"edml_{model}" for model in self.models]
        for name in set().union(*map(declared_in, self.headers)) & by_name.keys():
            if by_name[name].path.stem.rpartition("_")[2] not in left_out:
                wanted.append(name)
        weak, found = weak_names(), set()
        while wanted:
            source = by_name[wanted.pop()]
            if source not in found:
                found.add(source)
                wanted += (source.uses & by_name.keys()) - weak
        return sorted(found, key=Source.place)


def choose(models: Sequence[str], parts: Sequence[str]) -> Choice:
    """Raises AmalgamationError if there is no such model or part, or if they do not go together."""
    if not models:
        raise AmalgamationError(f"Name a model: {', '.join(known_models())}.")
    check_names("model", models, known_models())
    check_names("part", parts, ["all", *known_parts()])
    wanted = set(known_parts()) if "all" in parts else set(parts)
    if not wanted & ARITHMETICS.keys():
        wanted |= set(DEFAULT_PARTS)
    floats = [model for model in models if model.endswith("_f32")]
    if floats and "float" not in wanted:
        raise AmalgamationError(f"Fixed point cannot run {floats[0]}: add the part float.")
    return Choice(
        [model for model in known_models() if model in models],
        [part for part in known_parts() if part in wanted],
    )


# ---- The two files -------------------------------------------------------------------------------


def banner(choice: Choice, about: str, contents: Sequence[Path]) -> str:
    """The comment on top of a file: what it is, how it was made, what is in it, the licence."""
    command = ["tools/amalgamate", *choice.models, "--parts", *choice.parts, "-o", "DIR"]
    licence = (ROOT / "LICENSE").read_text("utf-8").strip()
    listed = "\n".join(f"  {name_of(path)}" for path in contents)
    text = (
        f"edmlift {version()} in one file: {about}.  Do not edit.\n"
        f"Generated by {shlex.join(command)}\n\n"
        f"models  {', '.join(choice.models)}\nparts   {', '.join(choice.parts)}\n\n"
        f"Contents:\n{listed}\n\n"
        f"SPDX-License-Identifier: MIT\n\n{licence}"
    )
    lines = "\n".join(f" * {line}".rstrip() for line in text.splitlines())
    return f"/*{lines[2:]}\n */\n"


def plain_floats(text: str) -> str:
    """Hexadecimal floats in decimal, to the same bits: C++ has none before C++17."""

    def decimal(match: re.Match[str]) -> str:
        number = f"{float.fromhex(match[1]):.9g}"
        return f"{number}F" if re.search(r"[.e]", number) else f"{number}.0F"

    return re.sub(r"\b(0x[\da-f.]+p[+-]?\d+)F\b", decimal, text)


def tidy(text: str) -> str:
    """At most one empty line; none before the first."""
    return re.sub(r"\n(?:[ \t]*\n){2,}", "\n\n", plain_floats(text)).strip() + "\n"


def includes(inliner: Inliner) -> str:
    return "".join(f"#include {name}\n" for name in sorted(inliner.system))


def header_text(choice: Choice, defined: set[str]) -> tuple[str, list[Path]]:
    """edmlift.h without its banner, and the files in it."""
    inliner = Inliner(adapt=lambda path, tokens: kept_declarations(tokens, defined))
    body = tidy(text_of(token for header in choice.headers for token in inliner.inline(header)))
    for model in choice.models:
        if not re.search(rf"\bedml_{model}\b", body):  # one of the user's own
            body += f"\nextern const edml_model edml_{model};\n"
    begin, end = (f"#ifdef __cplusplus\n{line}\n#endif\n" for line in ('extern "C" {', "}"))
    head = f"#ifndef EDMLIFT_H\n#define EDMLIFT_H\n\n{includes(inliner)}\n{begin}"
    return f"{head}\n{body}\n{end}\n#endif\n", inliner.files


def adapted(defined: set[str]) -> Callable[[Path, list[Token]], list[Token]]:
    """How edmlift.c has a header: what edmlift.h does not declare is internal."""

    def adapt(path: Path, tokens: list[Token]) -> list[Token]:
        if INCLUDE in path.parents:
            return kept_declarations(tokens, defined, "EDML_INTERNAL ")
        if path == KERNELS or path.parent == GEN:
            return without_prototypes(tokens, defined)
        return tokens

    return adapt


def source_text(
    sources: Sequence[Source], headers: Iterable[Path], defined: set[str]
) -> tuple[str, list[Path]]:
    """edmlift.c without its banner, and the files in it; headers: those in edmlift.h."""
    uses = set().union(*(source.uses for source in sources))
    needless = [path for path in INCLUDE.rglob("*.h") if not declared_in(path) & uses]
    inliner = Inliner(skipped=[*headers, *needless], adapt=adapted(defined))
    text = text_of(inliner.inline(LIB / "number" / "compiler.h"))
    for form in FORMS.values():
        group = [s.path for s in sources if form_of(s.path) == form and not s.is_model]
        if group:
            inliner.start_form()
            tokens = [token for path in group for token in inliner.inline(path)]
            text += heading(HEADINGS[form]) + text_of(renamed(tokens, form))
    text += heading("Models")
    for source in sources:
        if source.is_model:
            text += text_of(inliner.inline(source.path))
    return f'#include "edmlift.h"\n\n{includes(inliner)}\n{UNUSED}\n{tidy(text)}', inliner.files


def heading(text: str) -> str:
    return f"\n\n/* ======== {text} ======== */\n"


def write(files: dict[str, str], folder: Path) -> None:
    """Writes all of the files, or none of them."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".edmlift") as name:
        for file, text in files.items():
            (Path(name) / file).write_text(text, "utf-8", newline="\n")
        for file in files:
            if (folder / file).is_dir():  # which no file replaces
                raise IsADirectoryError(errno.EISDIR, f"{file} is a directory")
        for file in files:
            (Path(name) / file).replace(folder / file)


def amalgamate(models: Sequence[str], parts: Sequence[str], folder: Path) -> None:
    """Writes edmlift.h and edmlift.c into a folder, which is made if it is not there.

    models  as lib/models has them: "direct_w8"; at least one
    parts   those of known_parts(), or "all"; where there is neither "float" nor "fixed", float

    Raises AmalgamationError for what is not there, and for a folder that cannot be written.
    """
    choice = choose(models, parts)
    sources = choice.sources()
    defined = set().union(*(source.defines for source in sources))
    header, headers = header_text(choice, defined)
    source, contents = source_text(sources, headers, defined)
    files = {
        "edmlift.h": banner(choice, "what to include", headers) + header,
        "edmlift.c": banner(choice, "what to compile, as C or C++", contents) + source,
    }
    try:
        write(files, folder)
    except OSError as error:
        raise AmalgamationError(f"Cannot write into {folder}: {error.strerror}.") from None


# ---- The command ---------------------------------------------------------------------------------


def listing(title: str, known: dict[str, str]) -> str:
    """A line each."""
    width = max(map(len, known))
    lines = [f"  {name:<{width}}  {about}" for name, about in known.items()]
    return "\n".join([f"{title}:", *lines])


def command_line() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="tools/amalgamate",
        description="Writes the library as two files, edmlift.h and edmlift.c, for C and C++.\n"
        "docs/one-file.md says how to use them.",
        epilog="\n\n".join([listing("models", known_models()), listing("parts", known_parts())]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("models", nargs="+", metavar="MODEL", help="a model, such as direct_w8")
    parser.add_argument(
        "-o", dest="folder", metavar="DIR", type=Path, required=True,
        help="where to write; it is made if it is not there",
    )  # fmt: skip
    parser.add_argument(
        "--parts", nargs="+", metavar="PART", default=DEFAULT_PARTS,
        help="what is in it, or all; default: float.  Parts named without float and fixed are in"
        " float",
    )  # fmt: skip
    return parser


def command(arguments: Sequence[str] | None = None) -> int:
    parser = command_line()
    options = parser.parse_args(arguments)
    try:
        amalgamate(options.models, options.parts, options.folder)
    except AmalgamationError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    for name in ("edmlift.h", "edmlift.c"):
        print(f"{options.folder / name}  {(options.folder / name).stat().st_size:,} bytes")
    return 0
