"""C as text: tokens, and what is declared at file scope.

It reads what this repository's sources are written in, and no more: no // comments, no types of
K&R functions.  What it takes for wrong does not compile afterwards.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

NUMBER = r"\.?\d(?:[eEpP][+-]|[\w.])*"
KINDS = re.compile(
    rf"""
    (?P<comment> /\*.*?\*/ )
  | (?P<directive> ^[ \t]*\# (?: /\*.*?\*/ | \\\n | [^\n] )* )
  | (?P<string> "(?: \\. | [^"\\\n] )*" | '(?: \\. | [^'\\\n] )*' )
  | (?P<number> {NUMBER} (?: (?:,|[ ]U)\s*-?{NUMBER} )* )  # a table: it is long
  | (?P<name> [A-Za-z_]\w* )
  | (?P<space> \n | [ \t]+ )
  | (?P<mark> -> | . )
    """,
    re.X | re.S | re.M,
)
OPEN, CLOSE = "({[", ")}]"


class Token(NamedTuple):
    kind: str
    text: str


def tokens_of(text: str) -> list[Token]:
    return [Token(match.lastgroup or "", match[0]) for match in KINDS.finditer(text)]


@cache
def read_tokens(path: Path) -> list[Token]:
    return tokens_of(path.read_text("utf-8"))


def text_of(tokens: Iterable[Token]) -> str:
    return "".join(token.text for token in tokens)


class Directive(NamedTuple):
    """A line of the preprocessor: #define NAME REST; of the others, NAME is the first word."""

    keyword: str
    name: str
    rest: str


def directive_of(token: Token) -> Directive:
    line = re.sub(r"/\*.*?\*/|\\\n", " ", token.text, flags=re.S)
    match = re.fullmatch(r"\s*#\s*(\w+)\s*(\w*)(.*?)\s*", line, re.S)
    if match is None:
        raise ValueError(f"not a line of the preprocessor: {token.text}")
    return Directive(*match.groups())


def is_code(token: Token) -> bool:
    return token.kind not in ("comment", "space", "directive")


def items(tokens: Sequence[Token]) -> Iterator[list[Token]]:
    """Declarations and definitions of file scope, each with the space, the comments and the lines
    of the preprocessor before it; at last what follows the last one."""
    item: list[Token] = []
    depth, before, is_body = 0, "", False
    for token in tokens:
        item.append(token)
        if not is_code(token):
            continue
        if token.text in OPEN:
            is_body = is_body or (depth == 0 and token.text == "{" and before == ")")
            depth += 1
        elif token.text in CLOSE:
            depth -= 1
        before = token.text
        if depth == 0 and (token.text == ";" or (is_body and token.text == "}")):
            yield item
            item, is_body = [], False
    yield item


class Declaration(NamedTuple):
    """What an item of file scope declares."""

    names: list[str]  # of functions, objects and types
    constants: list[str]  # enumerators
    is_definition: bool  # of a function or of an object with a value
    is_static: bool
    is_type: bool


def enumerators(code: Sequence[str]) -> list[str]:
    """Of all enumerations in these tokens."""
    found, inside = [], 0
    for n, word in enumerate(code):
        if word == "{" and "enum" in code[max(0, n - 2) : n]:
            inside = 1
        elif inside and word in OPEN:
            inside += 1
        elif inside and word in CLOSE:
            inside -= 1
        elif inside == 1 and code[n - 1] in "{,":
            found.append(word)
    return [word for word in found if re.match(r"[A-Za-z_]", word)]


def outermost(code: Sequence[str]) -> list[str]:
    """Without attributes, initial values and what is in brackets; those that open are left."""
    flat, depth, skips = [], 0, False
    for word in code:
        if depth == 0 and word in (",", ";"):
            skips = False
        if depth == 0 and not skips:
            flat.append(word)
        if word in OPEN:
            depth += 1
        elif word in CLOSE:
            depth -= 1
        elif word == "=" and depth == 0:
            skips = True
    while "__attribute__" in flat:
        at = flat.index("__attribute__")
        del flat[at : at + 2]
    return flat


def declaration_of(item: Sequence[Token]) -> Declaration:
    code = [token.text for token in item if is_code(token)]
    flat = outermost(code)
    is_typedef = "typedef" in flat
    is_function = "(" in flat and not is_typedef
    names = [a for a, b in zip(flat, flat[1:], strict=False) if b in ("(", "[", "=", ",", ";")]
    tags = [b for a, b in zip(flat, flat[1:], strict=False) if a in ("struct", "enum", "union")]
    return Declaration(
        [name for name in [*names, *tags] if re.fullmatch(r"[A-Za-z_]\w*", name)],
        enumerators(code),
        not is_typedef and (code[-1:] == ["}"] or "=" in flat),
        "static" in flat,
        not is_function and (is_typedef or bool(tags)),
    )


def is_prototype(declared: Declaration) -> bool:
    """Does it only say that something is defined elsewhere?"""
    return bool(declared.names) and not (declared.is_definition or declared.is_type)


def names_in(tokens: Iterable[Token]) -> set[str]:
    return {token.text for token in tokens if token.kind == "name"}
