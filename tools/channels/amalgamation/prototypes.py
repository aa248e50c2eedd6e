"""Headers without what is not there: prototypes of functions, and objects, that nothing defines."""

import re
from collections.abc import Sequence

from channels.amalgamation.c_text import (
    Token,
    declaration_of,
    is_code,
    is_prototype,
    items,
    names_in,
    text_of,
)


def kept_declarations(tokens: Sequence[Token], defined: set[str], prefix: str = "") -> list[Token]:
    """A header's tokens without the prototypes of what is not defined here; the others with the
    prefix."""
    result: list[Token] = []
    dropped = False
    for item in items(tokens):
        if dropped:
            item = item[end_of_line(item) :]
        declared = declaration_of(item)
        dropped = is_prototype(declared) and not defined & set(declared.names)
        if dropped:
            result += without_comment(item[: first_code(item)])
        elif is_prototype(declared):
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
