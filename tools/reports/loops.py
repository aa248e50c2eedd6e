"""How often the loops of a lift go on at most, by what their sources say.

The limits of most follow from their `for`: constants, and counts whose most this file has.  The
others stand here with the reason.  Where loops are nested, or the calls of a function differ, a
product of limits is far too large: facts say how often loops go on together.
"""

import re
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

from data.paths import GEN
from reports.targets import ToolError

JOINTS, ORDER = 14, 13
CONSTANTS = {
    "EDML_JOINTS": JOINTS, "LAST": 13, "ORDER": ORDER, "MIRROR_PAIRS": 49, "MIRROR_JOINTS": 8,
    "SELF_MIRRORED": 7, "SWEEPS": 12, "NEWTON_STEPS": 16, "MOST_STEPS": 24, "EDML_ROWS": 8,
}  # fmt: skip
# What a count is at most, by the file that has it.
COUNTS = {
    "householder.h": {"m": ORDER - 1},
    "symmetric.h": {"m": ORDER - 1},
    "tridiagonal.h": {"n": ORDER},
    "turn_points.h": {"m": ORDER - 1, "n": ORDER - 1},
    "real_q24.h": {"n": 2 * ORDER},  # a band
}
# Whose limit no `for` has: the text of the loop, by file, and how often its body is run.
LIMITS = {
    "mds.h: } while (*sweeps < MOST_SWEEPS && ABS(band[1]) > SPLIT);": 2,
    "mds.h: for (int n = sweeps[k]; n > 0; n--)": 2,
    "edm.h: for (const edml_image_point *at = image->at; at < last; at++) {": JOINTS - 1,
    "ends_dsp.h: for (int k = fours; k < filled; k++)": 8,
    "jacobi.h: for (; best > k; best--)": ORDER - 1,
    "image_box.h: while (j < EDML_JOINTS - 1 && !is_seen(seen, j)) j++;": JOINTS - 1,
    "image_box.h: for (j++; j < EDML_JOINTS; j++) {": JOINTS - 1,
    "seen.h: for (seen = (uint16_t)(seen & ALL_JOINTS); seen != 0;": JOINTS,  # a bit a turn
    # Knuth's algorithm D: too large by two at most.
    "fixed.c: while (rest < taken) {": 2,
    # digit >= n / divisor - 2^16 / divisor - 2 n / 2^31, the reciprocal being too small by two at
    # most, which is so of all 2^15 divisors; n < (divisor + 1) 2^16.
    "fixed.c: for (n -= digit * divisor; n >= divisor; n -= divisor) digit++;": 5,
    # Counted over all n: the root is too small by five at most, and never too large.
    "fixed.c: for (; *n > 2 * root; root++)": 5,
}
# Of the compiler's and C library's: a bit a turn, to divide, to take a root, to normalise what is
# subnormal.
RUNTIME, FLOAT_BITS = re.compile(r"(__aeabi_f(mul|div)|sqrtf): \d"), 25
# A byte a turn, or more.
COPIES = re.compile(r"(__aeabi_memcpy|memcpy|memset): \d")
# Functions of the compiler's that are entered in the middle of their loops: each instruction is run
# so often at most.  A division makes eight bits a turn.
LEAVES = {"__divsi3": 4, "__udivsi3": 4, "__aeabi_idiv": 4, "__aeabi_uidiv": 4}
FOR = re.compile(
    r"for \((?:int )?(?P<i>\w+) = (?P<start>[^;,]+)(?:, [^;]*)?; (?P=i) (?P<is><|>=) "
    r"(?P<end>[^;&]+?)(?: && [^;]*)?; (?:(?P=i)(?:\+\+|--)|(?P=i) \+= (?P<step>\d+))"
)


@dataclass
class Model:
    """The sizes of a network, by its weight header."""

    layers: list[tuple[int, int]]  # inputs, with those that fill up, and outputs
    even: int  # inputs of the first layer
    fewest: int  # joints that must be seen
    is_float: bool

    @cached_property
    def groups(self) -> list[int]:
        return [ceil(outputs / 8) for _, outputs in self.layers]

    @cached_property
    def reads(self) -> int:
        """A group of rows reads its layer's inputs: how many in all."""
        return sum(g * inputs for g, (inputs, _) in zip(self.groups, self.layers, strict=True))


def read_model(name: str, form: str) -> Model:
    text = (GEN / f"{name}_{form}.h").read_text("utf-8")
    layers = re.findall(r"^    \{(\d+), (\d+), \w+_weight\d", text, re.M)
    even = int(re.search(r"^    (\d+), /\* even ones \*/", text, re.M)[1])
    fewest = int(re.search(r"^    (\d+), /\* fewest joints \*/", text, re.M)[1])
    filled = even if form == "f32" else ceil(even / 8) * 8
    return Model([(int(i), int(o)) for i, o in layers], filled, fewest, form == "f32")


@dataclass
class Facts:
    """What is known of a model's lift."""

    model: Model
    never: tuple[str, ...]  # functions that it does not call
    # In a whole lift: how the loops' turns add up, with a factor each, and to how many at most.
    totals: list[tuple[dict[str, int], int]]
    order: int = ORDER  # of the matrix that Jacobi's rotations diagonalise, at most

    def limit(self, name: str) -> int | None:
        """How often a loop's body is run each time that it is entered; None where only a total
        says so.  ToolError for an unknown one."""
        for begins, limit in LIMITS.items():
            if name.startswith(begins):
                return limit
        if RUNTIME.fullmatch(name):
            return FLOAT_BITS
        if COPIES.fullmatch(name):
            return None  # by what each call copies
        if (match := for_statement(name)) and (n := self.turns(name, match)) is not None:
            return n
        if any(name.startswith(begins) for weights, _ in self.totals for begins in weights):
            return None
        raise ToolError(f"how often does this loop go on: {name}?")

    def turns(self, name: str, match: re.Match[str], **fixed: int) -> int | None:
        """Of a `for`.  An index that is not given is where the loop is longest."""
        known = CONSTANTS | COUNTS.get(name.partition(":")[0], {})
        known |= {"count": JOINTS - self.model.fewest, "order": self.order}
        if name.startswith("jacobi.h"):
            known |= {"p": self.order - 1, "q": self.order - 1}
        known |= fixed
        least = CONSTANTS | fixed
        down = match["is"] == ">="
        start = value_of(match["start"], known if down else least)
        end = value_of(match["end"], least if down else known)
        if start is None or end is None:
            return None
        return max(0, start - end + 1 if down else ceil((end - start) / int(match["step"] or 1)))

    def together(self, outer: str, inner: str) -> int | None:
        """How often the inner one's body is run each time that the outer one is entered; None
        where that does not follow."""
        over, under = for_statement(outer), for_statement(inner)
        if over is None or under is None or self.turns(inner, under) is None:
            return None
        first, turns = value_of(over["start"], CONSTANTS), self.turns(outer, over)
        if first is None or turns is None or over["is"] != "<" or over["step"]:
            return None
        indices = range(first, first + turns)
        return sum(self.turns(inner, under, **{over["i"]: index}) for index in indices)


def for_statement(name: str) -> re.Match[str] | None:
    return FOR.match(name.partition(": ")[2])


def value_of(text: str, known: dict[str, int]) -> int | None:
    """The value of sums and products; None where a word is not known.  A letter is an index, from
    0 on."""
    if text.startswith("sizeof"):
        return None

    def number(word: re.Match[str]) -> str:
        return str(known.get(word[0], "0" if len(word[0]) == 1 else "?"))

    words = re.sub(r"[A-Za-z_]\w*", number, text)
    return eval(words) if re.fullmatch(r"[\d +*()-]+", words) else None


# ---- What is known of a lift ------------------------------------------------------------------


def facts_of(name: str, variant: str, preset: str) -> Facts:
    """Of a lift by a model, "distances" or "direct", in a variant, "f32" or "fixed", on a core."""
    model = read_model(name, "f32" if variant == "f32" else "w16")
    never = () if name == "distances" else ("edml_mds", "edml_align", "edml_mds_q", "edml_align_q")
    totals = [*network_totals(model), *kernel_totals(model, preset), *mds_totals(model, preset)]
    return Facts(model, never, totals)


def usual_facts(facts: Facts) -> Facts:
    """Without the fallback of the scaling, the rotations of the whole matrix."""
    return replace(facts, never=(*facts.never, "three_largest_by_jacobi"), order=3)


def kernel_totals(model: Model, preset: str) -> list[tuple[dict[str, int], int]]:
    """Of what sums the rows of the network, some of it in assembly: its loops have no text."""
    rows = {"equivariant.h: for (int row = 0; row < count": 1}
    groups = sum(model.groups)
    if model.is_float and preset in ("cortex-m4f", "cortex-m55"):
        return vfp_totals(model)
    if not model.is_float and preset == "cortex-m4f":
        return [(rows, groups), *dsp_totals(model)]
    if not model.is_float and preset == "cortex-m55":  # rows_mve.h: parts, and blocks of eight rows
        return [
            (rows, groups),
            ({"sum_rows: 0": 1}, 2 * groups),
            ({"sum_rows: 1": 1}, model.reads // 8),
        ]
    if not model.is_float and preset in ("cortex-m0plus", "cortex-m3"):  # rows_listed_v6m.h, v7m
        return [(rows, groups), ({"add_listed: 0": 1}, model.reads)]
    return [
        (rows, groups),
        ({"dot8.h: for (const activation *const end = x + inputs;": 1}, model.reads),
        ({"rows_listed.h: } while (i != LAST_OF_LIST);": 1}, model.reads),
    ]


def dsp_totals(model: Model) -> list[tuple[dict[str, int], int]]:
    """Of rows_dsp.h, two pairs at a time and the ends of two parts, and of ends_dsp.h."""
    inputs = [inputs for inputs, _ in model.layers]
    return [
        ({"sum_eight: 0": 1}, model.reads // 4 + 2 * sum(model.groups)),
        ({"list_part: 0": 1}, sum(inputs) // 8),
        ({"read_fours: 0": 1}, inputs[0] // 4 + 2),
        ({"give_eight: 0": 1}, 4 * model.groups[-1]),
    ]


def vfp_totals(model: Model) -> list[tuple[dict[str, int], int]]:
    """Of rows_vfp.h: two groups of rows and two inputs a turn; what is left goes to dot8_vfp.h."""
    inputs = [inputs for inputs, _ in model.layers]
    pairs = sum(g // 2 * n for g, n in zip(model.groups, inputs, strict=True))
    alone = sum(g % 2 * n for g, n in zip(model.groups, inputs, strict=True))
    turns = sum(ceil(groups / 2) for groups in model.groups)
    return [
        ({"equivariant.h: for (int row = 0; row < count": 1}, turns),
        ({"dot16: 0": 1}, pairs // 2),
        ({"dot8: 0": 1}, alone // 2),
        ({"activate_fours: 0": 1}, 2 * sum(model.groups)),
        ({"give_fours: 0": 1}, 2 * model.groups[-1]),
    ]


def network_totals(model: Model) -> list[tuple[dict[str, int], int]]:
    """A lift runs the network once: the sums over all its layers."""
    layers, groups = len(model.layers), sum(model.groups)
    inputs = [inputs for inputs, _ in model.layers]
    return [
        ({"equivariant.h: for (int n = 1; n < model->layer_count": 1}, layers),
        ({"units_by_row.h: for (int k = 0; k < rows; k++)": 1}, 8 * groups),
        ({"ends_by_value.h: for (int k = 0; k < rows; k++)": 1}, 8 * groups),
        ({"ends_by_value.h: for (; k ": 1}, inputs[0]),
        ({"ends_mve.h: for (int k = 0; k < rows; k += 4)": 1}, 2 * groups),
        ({"ends_mve.h: for (int k = 0; k < inputs; k += 4)": 1}, inputs[0] // 4),
        ({"rows_some_inputs.h: for (int i = from; i < to; i++)": 1}, sum(inputs)),
        # A float network in a float lift, or integers in integers: nothing is converted.
        ({"q24_by_value.h: ": 1, "q24_mve.h: ": 1, "to_q24: ": 1, "from_q24: ": 1}, 0),
        ({"predict.h: for (int": 1}, 0),  # both models read coordinates
        ({"edm.h: } while (q < last);": 1}, JOINTS * (JOINTS - 1) // 2),
    ]


def mds_totals(model: Model, preset: str) -> list[tuple[dict[str, int], int]]:
    """A lift scales once: the reflections' orders are 12, 11 to 2."""
    orders = range(2, ORDER)
    square, minors = sum(m * m for m in orders), 3 * CONSTANTS["MOST_STEPS"] * (ORDER - 1)
    normalised = sum(orders) + 2 * (13 + 12 + 11) + 2 * 3 * minors + 2 * 3 * 12 + 3 * 3 * 24
    kernels = {"cortex-m4f": symmetric_vfp_totals, "cortex-m55": symmetric_mve_totals}
    return [
        *(kernels[preset]() + turn_totals() if model.is_float and preset in kernels else ()),
        ({"symmetric.h: for (; j < i;": 1, "symmetric.h: for (; j < m;": 1}, square),
        ({"symmetric.h: } while (++j < m);": 1}, (square + sum(orders)) // 2),
        # bands, vectors, minors and their derivatives
        ({"real_q24.h: for (int i = 0; i < n; i++) bits": 1}, normalised),
        ({"real_q24.h: for (int i = 0; i < n; i++) x[i]": 1}, normalised),
    ]


def turn_totals() -> list[tuple[dict[str, int], int]]:
    """Of turn_points_vfp.h: two passes of a reflection, and up to two sweeps an eigenvalue."""
    points = sum(range(2, ORDER))
    return [
        ({"reflect_points: 0": 1}, points),
        ({"reflect_points: 1": 1}, points),
        ({"undo_sweep: 0": 1}, 2 * sum(ORDER - 1 - k for k in range(3))),
    ]


def symmetric_vfp_totals() -> list[tuple[dict[str, int], int]]:
    """Of symmetric_vfp.h: rows, and four entries at a time."""
    rows = [n for m in range(2, ORDER) for n in range(1, m + 1)]  # entries of each
    return [
        ({"multiply: 0": 1}, len(rows)),
        ({"multiply: 1": 1}, len(rows)),
        ({"multiply: 2": 1}, sum((n - 1) // 4 for n in rows)),  # without the diagonal
        ({"subtract_outer: 0": 1}, len(rows)),
        ({"subtract_outer: 1": 1}, sum(n // 4 for n in rows)),
    ]


def symmetric_mve_totals() -> list[tuple[dict[str, int], int]]:
    """Of symmetric_mve.h: four rows at a time, and four entries."""
    groups = [(m, i) for m in range(2, ORDER) for i in range(0, m, 4)]
    rows = [n for m in range(2, ORDER) for n in range(1, m + 1)]
    return [
        ({"multiply: 0": 1}, len(groups)),
        ({"multiply: 1": 1}, sum(i + 1 for _, i in groups)),
        ({"multiply: 2": 1}, sum(max(0, m - 3 - i) for m, i in groups)),
        ({"subtract_outer: 0": 1}, len(rows)),
        ({"subtract_outer: 1": 1}, sum(ceil(n / 4) for n in rows)),
    ]
