"""The mutants of a C text: small faults, each at one place.

They are made of the text before the preprocessor, because a text of lib/ is compiled as float and
as fixed point.  Bodies of functions alone have mutants.
"""

import re
from collections.abc import Iterator
from typing import NamedTuple

import tree_sitter_c
from tree_sitter import Language, Node, Parser

_PARSER = Parser(Language(tree_sitter_c.language()))

_SWAPPED = {
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["*"], "<<": [">>"], ">>": ["<<"],
    "&": ["|"], "|": ["&"], "^": ["&"],
    "<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"],
    "==": ["!="], "!=": ["=="], "&&": ["||"], "||": ["&&"],
    "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="], "<<=": [">>="], ">>=": ["<<="],
    "|=": ["&="], "&=": ["|="],
}  # fmt: skip
_KINDS = {
    "arithmetic": "+ - * / % << >> & | ^".split(),
    "comparison": "< <= > >= == !=".split(),
    "logical": ["&&", "||"],
}
_CONSTANT = re.compile(r"[A-Z][A-Z0-9_]+")
_STATUS = re.compile(r"EDML_(OK|ERR_\w+)")
_NOT_MUTATED = {"NULL", "NAN", "HUGE_VALF"}
_OF_A_LITERAL = {"REAL", "PIXELS", "HERTZ"}  # these macros paste something to their argument ...
_OF_AN_INTEGER = re.compile(r"U?INT\d+_C")  # ... and these
# Constants that the compiler must know, and what is no expression.
_SKIPPED = {
    "comment", "sizeof_expression", "array_declarator", "enum_specifier", "struct_specifier",
    "type_descriptor", "case_statement", "preproc_directive", "preproc_def", "string_literal",
    "char_literal", "field_designator", "offsetof_expression", "cast_type",
}  # fmt: skip


class Mutant(NamedTuple):
    """One fault.  A statement is deleted; an expression is replaced."""

    operator: str
    start: int  # bytes of the text
    end: int
    replacement: str | None  # None: the statement goes
    line: int  # from 1
    function: str
    before: str  # in one line, as a reader sees it
    after: str

    @property
    def change(self) -> str:
        return f"{self.before} -> {self.after}"


def _one_line(text: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"/\*.*?\*/", "", text, flags=re.S)).strip()


def _text(node: Node) -> str:
    assert node.text is not None
    return node.text.decode()


def _field(node: Node, name: str) -> Node:
    found = node.child_by_field_name(name)
    assert found is not None
    return found


def enumerators(text: str) -> set[str]:
    """Names of the constants of a text's enumerations."""
    names, stack = set(), [_PARSER.parse(text.encode()).root_node]
    while stack:
        node = stack.pop()
        if node.type == "enumerator":
            names.add(_text(_field(node, "name")))
        stack += node.children
    return names


class _Texts:
    """Mutants of one text."""

    def __init__(self, text: str, enumerated: set[str]) -> None:
        self.root = _PARSER.parse(text.encode()).root_node
        self.enumerated = enumerated
        self.function = ""

    def all(self) -> Iterator[Mutant]:
        stack = [self.root]
        while stack:
            node = stack.pop()
            if node.type == "function_definition":
                declarator = _text(_field(node, "declarator"))
                named = re.search(r"(\w+)\s*\(", declarator)
                self.function = named[1] if named else declarator
                yield from self._inside(_field(node, "body"))
            else:
                stack += reversed(node.children)

    def _inside(self, node: Node) -> Iterator[Mutant]:
        if node.type in _SKIPPED or node.is_missing:
            return
        if node.type == "declaration" and any(_text(c) == "static" for c in node.children):
            return
        if node.type == "call_expression" and "ASSERT" in _text(_field(node, "function")):
            return
        make = getattr(self, f"_of_{node.type}", None)
        if make is not None and not node.has_error:
            yield from make(node)
        if self._is_literal(node):
            return
        left_out = []
        if node.type == "for_statement":
            left_out.append(node.child_by_field_name("update"))
        if node.type == "call_expression":
            left_out.append(node.child_by_field_name("function"))
        for child in node.children:
            if child not in left_out:
                yield from self._inside(child)

    def _is_literal(self, node: Node) -> bool:
        if node.type != "call_expression":
            return node.type == "number_literal"
        name = _text(_field(node, "function"))
        return name in _OF_A_LITERAL or _OF_AN_INTEGER.fullmatch(name) is not None

    def _mutant(
        self, operator: str, node: Node, replacement: str | None, after: str = ""
    ) -> Mutant:
        shown = after or (_one_line(replacement) if replacement else "(deleted)")
        line, before = node.start_point.row + 1, _one_line(_text(node))
        return Mutant(operator, node.start_byte, node.end_byte, replacement,
                      line, self.function, before, shown)  # fmt: skip

    # ---- Expressions -------------------------------------------------------------------------

    def _swapped(self, node: Node) -> Iterator[Mutant]:
        sign = _text(_field(node, "operator"))
        left, right = _text(_field(node, "left")), _text(_field(node, "right"))
        kind = next((name for name, signs in _KINDS.items() if sign in signs), "assignment")
        for other in _SWAPPED.get(sign, []):
            name = (
                "boundary" if kind == "comparison" and other.strip("=") == sign.strip("=") else kind
            )
            yield self._mutant(name, node, f"{left} {other} ({right})", f"{left} {other} {right}")

    def _of_binary_expression(self, node: Node) -> Iterator[Mutant]:
        yield from self._swapped(node)

    def _of_assignment_expression(self, node: Node) -> Iterator[Mutant]:
        yield from self._swapped(node)

    def _of_unary_expression(self, node: Node) -> Iterator[Mutant]:
        argument = _text(_field(node, "argument"))
        sign = _text(_field(node, "operator"))
        if sign == "-" and _field(node, "argument").type != "number_literal":
            yield self._mutant("sign", node, argument)
        if sign == "!":
            yield self._mutant("logical", node, f"!!({argument})", argument)

    def _of_number_literal(self, node: Node) -> Iterator[Mutant]:
        number = _text(node)
        if re.search(r"[.pP]", number) or number.endswith("F"):
            yield from self._smaller(node)
            return
        if number != "1" or node.parent is None or node.parent.type != "return_statement":
            yield self._mutant("constant", node, f"{number} + 1")  # 2 is as true as 1
        if number.strip("uUlL") != "0":
            yield self._mutant("constant", node, f"{number} - 1")

    def _smaller(self, node: Node) -> Iterator[Mutant]:
        yield self._mutant("constant", node, f"{_text(node)} / 2")
        yield self._mutant("constant", node, "0")

    def _of_identifier(self, node: Node) -> Iterator[Mutant]:
        name, parent = _text(node), node.parent
        if _STATUS.fullmatch(name):
            if parent is None or parent.type != "binary_expression":
                other = "EDML_ERR_ARGUMENT" if name == "EDML_OK" else "EDML_OK"
                yield self._mutant("status", node, other)
        elif name in self.enumerated:
            yield self._mutant("constant", node, f"({name} > 0 ? {name} - 1 : {name} + 1)",
                               f"{name} one off")  # fmt: skip
        elif _CONSTANT.fullmatch(name) and name not in _NOT_MUTATED:
            yield from self._smaller(node)

    def _of_call_expression(self, node: Node) -> Iterator[Mutant]:
        if not self._is_literal(node):
            return
        if _text(_field(node, "function")) in _OF_A_LITERAL:
            yield from self._smaller(node)
        else:
            yield self._mutant("constant", node, f"{_text(node)} + 1")

    # ---- Statements --------------------------------------------------------------------------

    def _negated(self, condition: Node | None) -> Iterator[Mutant]:
        """Comparisons, `!x` and `a && b` have a mutant of their own that is nearly this one."""
        if condition is None or condition.type in ("binary_expression", "unary_expression"):
            return
        text = _text(condition)
        yield self._mutant("negated condition", condition, f"!({text})", f"!{text}")

    def _condition(self, node: Node) -> Node | None:
        found = node.child_by_field_name("condition")
        if found is not None and found.type == "parenthesized_expression":
            return found.named_children[0]
        return found

    def _of_if_statement(self, node: Node) -> Iterator[Mutant]:
        condition = self._condition(node)
        yield from self._negated(condition)
        if condition is not None and node.child_by_field_name("alternative") is None:
            yield self._mutant("deleted if", condition, "0", "0, the statement never runs")

    def _of_while_statement(self, node: Node) -> Iterator[Mutant]:
        yield from self._negated(self._condition(node))

    def _of_conditional_expression(self, node: Node) -> Iterator[Mutant]:
        yield from self._negated(self._condition(node))

    def _of_expression_statement(self, node: Node) -> Iterator[Mutant]:
        if not _text(node).startswith("(void)"):
            yield self._mutant("deleted statement", node, None)

    def _of_continue_statement(self, node: Node) -> Iterator[Mutant]:
        yield self._mutant("deleted statement", node, None)

    def _of_break_statement(self, node: Node) -> Iterator[Mutant]:
        yield self._mutant("deleted statement", node, None)


def mutants_of(text: str, enumerated: set[str]) -> list[Mutant]:
    """All mutants of a text, in its order.

    enumerated  names of enumeration constants of all the headers that it includes
    """
    return sorted(_Texts(text, enumerated).all(), key=lambda m: (m.start, -m.end, m.operator))


def apply(text: str, mutant: Mutant) -> str:
    """The text with that fault alone."""
    raw = text.encode()
    new = ";" if mutant.replacement is None else f"({mutant.replacement})"
    return (raw[: mutant.start] + new.encode() + raw[mutant.end :]).decode()


def schema(text: str, numbered: dict[int, Mutant]) -> str:
    """The text with all these faults, of which EDML_MUTANT(number) chooses one at run time."""
    places: dict[tuple[int, int], list[int]] = {}
    for number, mutant in numbered.items():
        places.setdefault((mutant.start, mutant.end), []).append(number)
    raw = text.encode()
    order = sorted(places, key=lambda place: (place[0], -place[1]))

    def write(start: int, end: int, inner: list[tuple[int, int]]) -> str:
        """The bytes start to end with the places that lie in them."""
        out, at = [], start
        while inner:
            place = inner.pop(0)
            out.append(raw[at : place[0]].decode())
            within = []
            while inner and inner[0][1] <= place[1]:
                within.append(inner.pop(0))
            out.append(choice(places[place], write(*place, within)))
            at = place[1]
        return "".join(out) + raw[at:end].decode()

    def choice(numbers: list[int], original: str) -> str:
        for number in reversed(numbers):
            replacement = numbered[number].replacement
            if replacement is None:
                original = f"{{ if (!EDML_MUTANT({number})) {original} }}"
            else:  # one line, because the lines keep their numbers
                original = f"(EDML_MUTANT({number}) ? ({_one_line(replacement)}) : ({original}))"
        return original

    return write(0, len(raw), order)
