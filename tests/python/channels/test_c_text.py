"""The reader of C finds what is declared, and renames what is private."""

import pytest
from support import ROOT

from channels.amalgamation.c_text import declaration_of, is_prototype, items, text_of, tokens_of
from channels.amalgamation.inlining import Word, renamed

FILES = [*(ROOT / "lib").rglob("*.[ch]"), *(ROOT / "include").rglob("*.h")]


def test_tokens_are_the_whole_text() -> None:
    assert len(FILES) > 100
    for path in FILES:
        text = path.read_text("utf-8")
        assert text_of(tokens_of(text)) == text, path.name


@pytest.mark.parametrize(
    "text, names, constants, is_definition",
    [
        ("static inline int f(int a) { return a; }", ["f"], [], True),
        ("__attribute__((naked, noinline)) static void f(int a UNUSED) { }", ["f"], [], True),
        ("const char *f(int joint); ", ["f"], [], False),
        ("extern const model a, b;", ["a", "b"], [], False),
        ("static const struct { int x, y; } t[2] = {{1, 2}, {3, 4}};", ["t"], [], True),
        ("static const real a = B * (1 + C), d = E;", ["a", "d"], [], True),
        ("typedef float lanes __attribute__((vector_size(16), aligned(4)));", ["lanes"], [], False),
        ("typedef char is_true[2 > 1 ? 1 : -1];", ["is_true"], [], False),
        ("typedef struct { int f; } s;", ["s"], [], False),
        ("struct s { int (*f)(int); };", ["s"], [], False),
        ("enum e { A, B = 2, C = (A + B) };", ["e"], ["A", "B", "C"], False),
        ("typedef enum { A, B, } e;", ["e"], ["A", "B"], False),
    ],
)
def test_declarations(
    text: str, names: list[str], constants: list[str], is_definition: bool
) -> None:
    item, rest = items(tokens_of(text))
    found = declaration_of(item)
    assert (found.names, found.constants, found.is_definition) == (names, constants, is_definition)
    assert found.is_static == ("static" in text) and not text_of(rest).strip()
    assert is_prototype(found) == (text.startswith(("extern", "const char")))


def words(text: str, suffix: str) -> str:
    return text_of(renamed([Word(*token) for token in tokens_of(text)], suffix))


def test_private_names_get_the_suffix_and_others_do_not() -> None:
    """Members keep theirs, and public names, those in comments and in strings."""
    text = """\
#define TWICE(a) (2 * (a)) /* TWICE value */
typedef int value;
static value f(const edml_pose *value_of) { return TWICE(value_of->value) + g("value"); }
void edml_f(void) { f(0); }
"""
    assert (
        words(text, "_q")
        == """\
#define TWICE_q(a) (2 * (a)) /* TWICE value */
typedef int value_q;
static value_q f_q(const edml_pose *value_of) { return TWICE_q(value_of->value) + g("value"); }
void edml_f(void) { f_q(0); }
"""
    )


def test_names_that_a_macro_makes_are_written_out() -> None:
    text = "#define OF(name) name##_w8\n#define REAL(c) c##F\n"
    assert words(f"{text}int OF(edml__f)(void);", "") == f"{text}int edml__f_w8(void);"
    assert words(f"{text}int a = REAL(1.0);", "") == f"{text}int a = REAL(1.0);"


def test_public_names_of_fixed_point_are_written_out() -> None:
    text = "#define edml_f edml_f_q\nvoid edml_f(void) { }"
    assert words(text, "_q") == "\nvoid edml_f_q(void) { }"
