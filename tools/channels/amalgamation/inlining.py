"""Texts of the library into one, each where it is first included, and their private names.

What exists in several forms (float and fixed point, weights of 16 and of 8 bits) is there once in
each, and the private names of all but float and of float weights get the form's suffix: plus(),
plus_q().  Conditions of the preprocessor are left to the user's compiler.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path

from channels.amalgamation.c_text import (
    Token,
    declaration_of,
    directive_of,
    is_code,
    items,
    read_tokens,
    text_of,
    tokens_of,
)
from data.paths import LIB, ROOT

INCLUDE = ROOT / "include"
# The words of the arithmetics and of the weights: texts that include them are there in several
# forms, by the ending of the source's name.
WORDS = ("api/api", "number/real_", "network/weights")
FORMS = {"f32": "", "q": "_q", "w16": "_w16", "w8": "_w8"}


@cache
def form_of(source: Path) -> str:
    """The suffix that a source's private names get."""
    return FORMS.get(source.stem.rpartition("_")[2], "")


# ---- Files into one ------------------------------------------------------------------------------


@cache
def included_by(path: Path) -> list[Path]:
    """The repository's files that a file includes by name."""
    lines = (directive_of(t) for t in read_tokens(path) if t.kind == "directive")
    names = [
        line.rest.strip('"') for line in lines if line.keyword == "include" and '"' in line.rest
    ]
    return [find(path, name) for name in names]


def find(path: Path, name: str) -> Path:
    """The file that `path` includes as `name`."""
    for folder in (path.parent, INCLUDE, LIB):
        if (folder / name).exists():
            return (folder / name).resolve()
    raise FileNotFoundError(f"{path} includes {name}")


@cache
def speaks_words(path: Path) -> bool:
    """Does a text depend on the arithmetic or on the weights?"""
    if INCLUDE in path.parents:
        return False
    if path.is_relative_to(LIB) and str(path.relative_to(LIB)).startswith(WORDS):
        return True
    return any(speaks_words(other) for other in included_by(path))


Adapt = Callable[[Path, list[Token]], list[Token]]
Guards = tuple[set[str], set[str]]


class Word(Token):
    """A token of a text that depends on the arithmetic."""


class Inliner:
    """Writes files where they are first included.

    Include guards are resolved, and go.  Where a file is included under a condition that only the
    user's compiler knows, it keeps its guard, because another branch may need it as well.
    """

    def __init__(self, skipped: Iterable[Path] = (), adapt: Adapt = lambda _, text: text) -> None:
        self.skipped = set(skipped)  # public headers that the file does not need, or has already
        self.adapt = adapt  # what becomes of a file's own text
        self.system: set[str] = set()
        self.shared: set[str] = set()  # guards that are known to be defined
        self.own: set[str] = set()
        self.branched: set[str] = set()  # guards of files that were included in a branch
        self.choices: dict[str, list[Path]] = {}  # files that a macro names
        self.chosen: set[str] = set()
        self.depth = 0
        self.files: list[Path] = []

    def start_form(self) -> None:
        """Forgets what the form before has defined."""
        self.own, self.branched, self.choices, self.chosen = set(), set(), {}, set()

    def inline(self, path: Path) -> list[Token]:
        return FileInliner(self, path).inline()

    def known(self) -> Guards:
        return set(self.own), set(self.shared)

    def restore(self, known: Guards) -> None:
        """At the end of a branch: what it defined, another does not have."""
        self.own.clear()
        self.own.update(known[0])
        self.shared.clear()
        self.shared.update(known[1])


@cache
def read_file(path: Path) -> list[Token]:
    """A header without its extern "C": the file has one for all of them."""
    if INCLUDE not in path.parents:
        return read_tokens(path)
    linkage = r'#ifdef __cplusplus\n(?:extern "C" \{|\})\n#endif\n'
    return tokens_of(re.sub(linkage, "", path.read_text("utf-8")))


class FileInliner:
    """One file, once."""

    def __init__(self, unit: Inliner, path: Path) -> None:
        self.unit, self.path = unit, path
        self.kind = Word if speaks_words(path) else Token
        self.guards = unit.own if speaks_words(path) else unit.shared
        self.tokens = read_file(path)
        self.at = 0
        self.before: list[Token] = []  # what it includes first
        self.text: list[Token] = []
        self.has_code = False
        self.conditions: list[tuple[bool, Guards | None]] = []  # kept?  What was known before

    def inline(self) -> list[Token]:
        while self.at < len(self.tokens):
            token = self.tokens[self.at]
            self.at += 1
            if token.kind == "directive":
                self.directive(token)
            else:
                self.has_code = self.has_code or is_code(token)
                self.text.append(self.kind(*token))
        if not self.has_code:
            return self.before
        if self.path not in self.unit.files:
            self.unit.files.append(self.path)
        return [*self.before, mark(self.path), *self.unit.adapt(self.path, self.text)]

    def directive(self, token: Token) -> None:
        line = directive_of(token)
        if line.keyword == "ifndef" and line.name in self.unit.own | self.unit.shared:
            self.skip()
        elif line.keyword == "ifndef" and self.is_guard(line.name):
            self.guard(token, line.name)
        elif line.keyword in ("if", "ifdef", "ifndef"):
            self.conditions.append((True, self.unit.known()))
            self.unit.depth += 1
            self.emit(token)
        elif line.keyword in ("else", "elif"):
            self.unit.restore(self.conditions[-1][1])
            self.emit(token)
        elif line.keyword == "endif":
            self.end(token)
        elif line.keyword == "include":
            self.include(token, line.name, line.rest)
        elif line.keyword == "define" and re.fullmatch(r'\s*"[^"]*\.h"', line.rest):
            self.choice(line.name, line.rest.strip(' "'))
        else:
            self.emit(token)

    def emit(self, token: Token) -> None:
        self.has_code = True
        self.text.append(self.kind(*token))

    # -- Conditions

    def is_guard(self, name: str) -> bool:
        following = (t for t in self.tokens[self.at :] if t.kind != "space")
        token = next(following, Token("", ""))
        return token.kind == "directive" and directive_of(token) == ("define", name, "")

    def guard(self, token: Token, name: str) -> None:
        branch = self.unit.depth > 0
        keeps = branch or name in self.unit.branched
        if branch:
            self.unit.branched.add(name)
        self.guards.add(name)
        self.conditions.append((keeps, None))
        define = next(
            n for n in range(self.at, len(self.tokens)) if self.tokens[n].kind == "directive"
        )
        if keeps:
            self.text += [self.kind(*t) for t in (token, Token("space", "\n"), self.tokens[define])]
        self.at = define + 1

    def skip(self) -> None:
        """Past the #endif of a condition that is false."""
        depth = 1
        while depth > 0:
            token = self.tokens[self.at]
            self.at += 1
            if token.kind == "directive":
                keyword = directive_of(token).keyword
                depth += keyword.startswith("if") - (keyword == "endif")

    def end(self, token: Token) -> None:
        keeps, known = self.conditions.pop()
        if known is not None:
            self.unit.restore(known)
            self.unit.depth -= 1
        if keeps:
            self.text.append(self.kind(*token))

    # -- Includes

    def include(self, token: Token, name: str, rest: str) -> None:
        if name:
            self.add(self.chosen_by(name))
        elif rest.startswith("<"):
            if self.unit.depth > 0:
                self.emit(token)
            else:
                self.unit.system.add(rest)
        else:
            path = find(self.path, rest.strip('"'))
            if path not in self.unit.skipped:
                self.add(self.unit.inline(path))

    def add(self, tokens: list[Token]) -> None:
        if not self.has_code:
            self.before += tokens
        elif tokens:
            self.text += [*tokens, mark(self.path, " goes on")]

    def choice(self, name: str, file: str) -> None:
        """A macro that names a file becomes its number."""
        path = find(self.path, file)
        choices = self.unit.choices.setdefault(name, [])
        choices.append(path)
        self.emit(Token("directive", f"#define {name} {len(choices)} /* {name_of(path)} */"))

    def chosen_by(self, name: str) -> list[Token]:
        """The files that a macro may name, each under the condition that it does."""
        if name in self.unit.chosen:
            return []
        text: list[Token] = []
        known = self.unit.known()
        self.unit.depth += 1
        for n, path in enumerate(self.unit.choices[name], 1):
            text.append(Word("directive", f"#{'if' if n == 1 else 'elif'} {name} == {n}"))
            text += [Token("space", "\n"), *self.unit.inline(path), Token("space", "\n")]
            self.unit.restore(known)
        self.unit.depth -= 1
        if self.unit.depth == 0:
            self.unit.chosen.add(name)
        return [*text, Token("directive", "#endif"), Token("space", "\n")]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def mark(path: Path, more: str = "") -> Token:
    return Token("space", f"\n\n/* ---- {name_of(path)}{more} ---- */\n\n")


# ---- Names of a form -----------------------------------------------------------------------------


def private_names(tokens: Sequence[Token]) -> set[str]:
    """What the texts of a form define at file scope and do not share: macros, and all but public
    names."""
    own = [token for token in tokens if isinstance(token, Word)]
    names = set()
    for token in own:
        if token.kind == "directive":
            line = directive_of(token)
            if line.keyword == "define":
                names.add(line.name)
    for item in items(own):
        declared = declaration_of(item)
        found = [*declared.names, *declared.constants]
        names |= {name for name in found if not name.lower().startswith("edml_")}
    return names


def renamed(tokens: Sequence[Token], suffix: str) -> list[Token]:
    """With the suffix at each private name of the form, but not at members of a struct."""
    names = private_names(tokens) if suffix else set()
    result: list[Token] = []
    before = ""
    for token in expand_pastes(tokens, pastes(tokens)):
        if isinstance(token, Word):
            token = rename(token, names, suffix, before)
        if not is_alias(token):
            result.append(token)
        if is_code(token):
            before = token.text
    return result


def rename(token: Token, names: set[str], suffix: str, before: str) -> Token:
    """A name, or those in a line of the preprocessor, with the suffix; `before` is what is in front
    of it."""
    if token.kind == "name" and token.text in names and before not in (".", "->"):
        return Word("name", token.text + suffix)
    if token.kind == "directive" and directive_of(token).keyword not in ("pragma", "error"):
        keyword, *others = tokens_of(token.text.lstrip(" \t#"))
        inner, before = [keyword], ""
        for part in others:
            inner.append(rename(part, names, suffix, before))
            before = part.text if is_code(part) else before
        return Word("directive", f"#{text_of(inner)}")
    return token


def pastes(tokens: Sequence[Token]) -> dict[str, str]:
    """Macros that append something, and what."""
    found = {}
    for token in tokens:
        if token.kind == "directive" and isinstance(token, Word):
            match = re.fullmatch(r"#define (\w+)\((\w+)\) \2##(\w+)", token.text)
            if match:
                found[match[1]] = match[3]
    return found


def expand_pastes(tokens: Sequence[Token], pasting: dict[str, str]) -> Iterator[Token]:
    """edml__fconn_w8 for WEIGHTS(edml__fconn), but REAL(1.0) as it is."""
    skipped = 0
    for n, token in enumerate(tokens):
        if skipped > 0:
            skipped -= 1
        elif token.text in pasting and tokens[n + 2].kind == "name":
            yield Word("name", tokens[n + 2].text + pasting[token.text])
            skipped = 3
        else:
            yield token


def is_alias(token: Token) -> bool:
    """A name of fixed point as api_q.h lists it; texts have them in full."""
    return token.kind == "directive" and re.fullmatch(r"#define (\w+) \1", token.text) is not None
