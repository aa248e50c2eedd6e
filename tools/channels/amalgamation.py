"""One file: the library as edmlift.h and edmlift.c, with the models and parts that are wanted.

Texts are those of include/, lib/ and gen/.  What a choice needs is found from the texts as well: a
source is there if something that is there asks for what it defines.
"""

import argparse
import difflib
import re
import shlex
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from channels.c_text import (
    Declaration,
    Token,
    declaration_of,
    directive_of,
    is_code,
    items,
    read_tokens,
    text_of,
)
from channels.inlining import (
    FORMS,
    INCLUDE,
    Inliner,
    form_of,
    name_of,
    read_file,
    renamed,
    speaks_words,
)
from data.paths import GEN, LIB, ROOT

PUBLIC = INCLUDE / "edmlift.h"
ARITHMETICS = {"float": "f32", "fixed": "q"}
HEADINGS = {
    "": "Float32, and what all share",
    "_q": "Fixed point: private names end in _q",
    "_w16": "Networks with weights of 16 bits: private names end in _w16",
    "_w8": "Networks with weights of 8 bits: private names end in _w8",
}
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
        error = about["error, mm"].split()[1].strip(",")
        weights = about["parameters"].partition(",")[0]
        kind = about["quantiser"].partition(",")[0]
        found[source.stem] = f"{weights} weights, {kind}; error {error} mm on exact 2D"
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
    known = list(known)
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name, known, 3, 0.4) or known
            raise AmalgamationError(f"There is no {kind} {name}; there is {', '.join(near)}.")


# ---- What a choice needs -------------------------------------------------------------------------


def is_prototype(item: Sequence[Token], declared: Declaration) -> bool:
    """Does an item only say that something is defined elsewhere?"""
    return bool(declared.names) and not (declared.is_definition or declared.is_type)


def names_in(tokens: Iterable[Token]) -> set[str]:
    return {token.text for token in tokens if token.kind == "name"}


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
        if not is_prototype(item, declared):
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
    kernels = read_tokens(LIB / "network" / "kernels.h")
    prototypes = [item for item in items(kernels) if "EDML_WEAK" in names_in(item)]
    return {name for item in prototypes for name in declaration_of(item).names}


@dataclass(frozen=True)
class Choice:
    """Models and parts, and what they come to."""

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
        return sorted(found, key=lambda source: place_of(source.path))


def place_of(source: Path) -> tuple[object, ...]:
    """Float first, so that its pragmas hold for all of the file; weights last."""
    form = list(FORMS.values()).index(form_of(source))
    is_model = source.parent.name == "models"
    return is_model, 0 if is_model else form, not speaks_words(source), source


def choose(models: Sequence[str], parts: Sequence[str]) -> Choice:
    if not models:
        raise AmalgamationError(f"Name a model: {', '.join(known_models())}.")
    check_names("model", models, known_models())
    check_names("part", parts, ["all", *known_parts()])
    wanted = set(known_parts()) if "all" in parts else set(parts)
    if not wanted & ARITHMETICS.keys():
        wanted.add("float")
    floats = [model for model in models if model.endswith("_f32")]
    if floats and "float" not in wanted:
        raise AmalgamationError(f"Fixed point cannot run {floats[0]}: add the part float.")
    return Choice(
        [model for model in known_models() if model in models],
        [part for part in known_parts() if part in wanted],
    )


# ---- Declarations of what is there ---------------------------------------------------------------


def kept_declarations(tokens: Sequence[Token], defined: set[str], prefix: str = "") -> list[Token]:
    """A header's tokens without the prototypes of what is not defined here; the others with the
    prefix."""
    result: list[Token] = []
    dropped = False
    for item in items(tokens):
        if dropped:
            item = item[end_of_line(item) :]
        declared = declaration_of(item)
        dropped = is_prototype(item, declared) and not defined & set(declared.names)
        if dropped:
            result += without_comment(item[: first_code(item)])
        elif is_prototype(item, declared):
            first = first_code(item)
            rest = kept_names(item[first:], set(declared.names) - defined)
            result += [*item[:first], Token("name", prefix), *rest]
        else:
            result += item
    return result


def first_code(item: Sequence[Token]) -> int:
    return next((n for n, token in enumerate(item) if is_code(token)), len(item))


def end_of_line(item: Sequence[Token]) -> int:
    """Past the comment behind the item before."""
    return next((n for n, token in enumerate(item) if is_code(token) or token.text == "\n"), 0)


def without_comment(space: Sequence[Token]) -> list[Token]:
    """Without the comment on what comes next, if it is there without an empty line between."""
    comments = [n for n, token in enumerate(space) if token.kind == "comment"]
    if comments and text_of(space[comments[-1] + 1 :]) == "\n":
        return list(space[: comments[-1]])
    return list(space)


def kept_names(item: Sequence[Token], undefined: set[str]) -> list[Token]:
    """extern const edml_model a, b; without some of the names."""
    if not undefined:
        return list(item)
    text = text_of(item)
    for name in undefined:
        text = re.sub(rf"\b{name}\b,\s*|,\s*{name}\b", "", text)
    return [Token("name", text)]


def without_prototypes(tokens: Sequence[Token], defined: set[str]) -> list[Token]:
    """What models declare, and this file has defined before them.  A weak function that it does not
    define is NULL, also where there are no weak symbols."""
    result: list[Token] = []
    for item in items(tokens):
        first, names, declared = first_code(item), names_in(item), declaration_of(item).names
        if "EDML_WEAK" in names and not defined & set(declared):
            text = f"#define {declared[0]} NULL /* that lift is not in this file */"
            item = [*item[:first], Token("directive", text)]
        elif names & {"EDML_WEAK", "EDML_KERNEL"}:
            item = without_comment(item[:first])
        result += item
    return result


# ---- The two files -------------------------------------------------------------------------------


def banner(choice: Choice, about: str, contents: Sequence[str]) -> str:
    command = ["tools/amalgamate", *choice.models, "--parts", *choice.parts, "-o", "DIR"]
    version = re.search(r'EDML_VERSION_STRING "(.*?)"', PUBLIC.read_text("utf-8"))[1]
    licence = (ROOT / "LICENSE").read_text("utf-8").strip()
    listed = "\n".join(f"  {line}" for line in contents)
    text = (
        f"edmlift {version} in one file: {about}.  Do not edit.\n"
        f"Generated by {shlex.join(command)}\n\n"
        f"models  {', '.join(choice.models)}\nparts   {', '.join(choice.parts)}\n\n"
        f"Contents:\n{listed}\n\n"
        f"SPDX-License-Identifier: MIT\n\n{licence}"
    )
    lines = [f" * {line}".rstrip() for line in text.splitlines()]
    return "/*" + "\n".join(lines)[2:] + "\n */\n"


def plain_floats(text: str) -> str:
    """Hexadecimal floats in decimal, to the same bits: C++ has none before C++17."""

    def decimal(match: re.Match[str]) -> str:
        number = f"{float.fromhex(match[1]):.9g}"
        return f"{number}F" if re.search(r"[.e]", number) else f"{number}.0F"

    return re.sub(r"\b(0x[\da-f.]+p[+-]?\d+)F\b", decimal, text)


def tidy(text: str) -> str:
    """At most one empty line; none before the first."""
    return re.sub(r"\n(?:[ \t]*\n){2,}", "\n\n", plain_floats(text)).strip() + "\n"


def header_text(choice: Choice, defined: set[str]) -> tuple[str, list[Path]]:
    """edmlift.h without its banner, and the files in it."""
    inliner = Inliner(adapt=lambda path, tokens: kept_declarations(tokens, defined))
    tokens = [token for header in choice.headers for token in inliner.inline(header)]
    system = "".join(f"#include {name}\n" for name in sorted(inliner.system))
    begin, end = (f"#ifdef __cplusplus\n{line}\n#endif\n" for line in ('extern "C" {', "}"))
    body = tidy(text_of(tokens))
    text = f"#ifndef EDMLIFT_H\n#define EDMLIFT_H\n\n{system}\n{begin}\n{body}\n{end}\n#endif\n"
    return text, inliner.files


def adapted(defined: set[str]) -> Callable[[Path, list[Token]], list[Token]]:
    """How edmlift.c has a header: what edmlift.h does not declare is internal."""

    def adapt(path: Path, tokens: list[Token]) -> list[Token]:
        if INCLUDE in path.parents:
            return kept_declarations(tokens, defined, "EDML_INTERNAL ")
        if path == LIB / "network" / "kernels.h" or path.parent == GEN:
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
    paths = [source.path for source in sources]
    groups = [
        (form, [p for p in paths if form_of(p) == form and p.parent.name != "models"])
        for form in FORMS.values()
    ]
    for form, group in groups:
        if group:
            inliner.start_form()
            tokens = [token for path in group for token in inliner.inline(path)]
            text += f"\n\n/* ======== {HEADINGS[form]} ======== */\n" + text_of(
                renamed(tokens, form)
            )
    text += "\n\n/* ======== Models ======== */\n"
    for path in paths:
        if path.parent.name == "models":
            text += text_of(inliner.inline(path))
    system = "".join(f"#include {name}\n" for name in sorted(inliner.system))
    return f'#include "edmlift.h"\n\n{system}\n{UNUSED}\n{tidy(text)}', inliner.files


def texts(models: Sequence[str], parts: Sequence[str]) -> dict[str, str]:
    """The two files by their names."""
    choice = choose(models, parts)
    sources = choice.sources()
    defined = set().union(*(source.defines for source in sources))
    header, headers = header_text(choice, defined)
    source, files = source_text(sources, headers, defined)
    return {
        "edmlift.h": banner(choice, "what to include", [name_of(p) for p in headers]) + header,
        "edmlift.c": banner(choice, "what to compile, as C or C++", [name_of(p) for p in files])
        + source,
    }


def amalgamate(models: Sequence[str], parts: Sequence[str], folder: Path) -> None:
    """Writes edmlift.h and edmlift.c into a folder, which is made if it is not there.

    models  as lib/models has them: "direct_w8"; at least one
    parts   those of known_parts(), or "all"; where there is neither "float" nor "fixed", float

    Raises AmalgamationError for what is not there, and for a folder that cannot be written.
    """
    files = texts(models, parts)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (folder / f"{name}.new").write_text(text, "utf-8")
        for name in files:
            (folder / f"{name}.new").replace(folder / name)
    except OSError as error:
        raise AmalgamationError(f"Cannot write into {folder}: {error.strerror}.") from None


# ---- The command ---------------------------------------------------------------------------------


def listing(title: str, known: dict[str, str]) -> str:
    width = max(map(len, known))
    return "\n".join(
        [f"{title}:", *(f"  {name:<{width}}  {about}" for name, about in known.items())]
    )


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="tools/amalgamate",
        description="Writes the library as two files, edmlift.h and edmlift.c, for C and C++.",
        epilog="\n\n".join([listing("models", known_models()), listing("parts", known_parts())]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("models", nargs="+", metavar="MODEL", help="a model, such as direct_w8")
    parser.add_argument(
        "-o", dest="folder", metavar="DIR", type=Path, required=True, help="where to write"
    )
    parser.add_argument(
        "--parts", nargs="+", metavar="PART", default=["float"],
        help="what else to have, or all; default: float.  Without float and fixed: in float",
    )  # fmt: skip
    options = parser.parse_args(arguments)
    try:
        amalgamate(options.models, options.parts, options.folder)
    except AmalgamationError as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    return 0
