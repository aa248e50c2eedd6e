"""Numbers that C and Python must agree on, read from the C: none is copied by hand.

A constant is found by its name, wherever in include/ and lib/ it is defined, as

    #define NAME 91                  or, with its unit in a macro,
    #define NAME REAL(0.001)         or as an enumerator,
    enum { NAME = 2458 };
"""

import functools
import re

import numpy as np

from data.paths import GEN, LIB, ROOT
from edmlift.joints import JOINTS


class ConstantError(LookupError):
    """A constant that the C does not define, or defines twice."""


@functools.cache
def _sources() -> dict[str, str]:
    """The texts of the library's headers and sources, by their path, without comments."""
    paths = sorted(p for root in (ROOT / "include", LIB) for p in root.rglob("*.*"))
    texts = {str(p.relative_to(ROOT)): p.read_text("utf-8").replace("\\\n", " ") for p in paths}
    return {path: re.sub(r"/\*.*?\*/", "", text, flags=re.S) for path, text in texts.items()}


@functools.cache
def _value(name: str) -> str:
    """What stands behind the name in its definition."""
    macro = rf"^[ \t]*#define[ \t]+{name}[ \t]+(\S.*?)[ \t]*$"
    defined = rf"{macro}|\b{name}[ \t]*=(?!=)[ \t]*([^,}}\n]+)"
    found = {
        path: (match[1] or match[2]).strip()
        for path, text in _sources().items()
        for match in re.finditer(defined, text, re.M)
    }
    if len(set(found.values())) != 1:
        where = f"is defined in {', '.join(found)}" if found else "is not defined"
        raise ConstantError(f"model/constants.py: {name} {where} under include/ and lib/")
    return next(iter(found.values()))


def number(name: str) -> float:
    """A number of the C, bare or as REAL(...)."""
    text = re.sub(r"^\(?(?:REAL\()?(-?[\d.]+(?:e-?\d+)?)F?\)*$", r"\1", _value(name))
    try:
        return float(text)
    except ValueError:
        message = f"model/constants.py: {name} is {_value(name)}, not a number"
        raise ConstantError(message) from None


def integer(name: str) -> int:
    """An integer of the C, decimal or hexadecimal."""
    try:
        return int(_value(name).rstrip("uU"), 0)
    except ValueError:
        message = f"model/constants.py: {name} is {_value(name)}, not an integer"
        raise ConstantError(message) from None


def enumerators(prefix: str) -> tuple[str, ...]:
    """The names of an enumeration in its order, without their prefix, in lower case."""
    for text in _sources().values():
        for body in re.findall(r"\benum\b[^{;]*\{([^}]*)\}", text):
            names = re.findall(rf"\b{prefix}(\w+)", body)
            if names:
                return tuple(name.lower() for name in names)
    raise ConstantError(f"model/constants.py: no enumerators {prefix}... under include/ and lib/")


# ---- The format of weights (lib/network) -----------------------------------------------------

PAIR_COUNT = integer("EDML_PAIRS")
WEIGHTS_FORMAT = integer("EDML_WEIGHTS_FORMAT")  # a header of another one does not compile
MAX_UNITS = integer("EDML_MAX_UNITS")  # of a layer
GROUP = integer("EDML_ROWS")  # outputs that a kernel computes together
CHUNK = integer("EDML_CHUNK")  # inputs that a quantised one reads together
ACTIVATION = integer("EDML_ACTIVATION")  # the largest activation of a quantised network
INPUT_SHIFT = integer("EDML_INPUT_SHIFT")  # from Q24 to what a quantised network reads
OUTPUT_SHIFT = integer("EDML_OUTPUT_SHIFT")  # from Q24 to what its last layer gives
CHANNELS = integer("FCONV_CHANNELS")  # of FConv, at most
Q12 = 1 << 12
SOFTENING = integer("EDML_SOFTENING")  # Q12, of the person's half height

# ---- Stages of the lift (lib/lift, lib/joints) -----------------------------------------------

WIDEST = number("WIDEST")  # the body's frame: of the seen joints, across and ...
FARTHEST = number("FARTHEST")  # ... of any, in half extents along the body's axis
LONGEST_2D = number("LONGEST_2D")  # what a network reads of a distance at most
MIDDLE_SOFT = number("MIDDLE_SOFT")  # about the middle of softened distances
MISSING_INPUT = number("MISSING_INPUT")  # what it reads of a joint that is not seen
GATE_SOFTNESS = number("GATE_SOFTNESS")  # a gate of this size moves a share by a quarter
OBJECTIVES = enumerators("EDML_STRESS_")  # of the refinement: "none", "square" ...
MAX_IMPUTED = integer("MAX_IMPUTED")  # joints that the impute stage can guess
LIGHT_RIDGE, MIN_RIDGE = number("ORIENT_LIGHT_RIDGE"), number("ORIENT_MIN_RIDGE")  # of the spread
NECK_ON_TRUNK = number("TRUNK")  # the neck's place between shoulders (0) and hips (1), adapted
IMPUTATION_ONE = integer("EDML_IMPUTATION_ONE")  # the unit of its table
JOINT_LIMITS_FORMAT = integer("EDML_JOINT_LIMITS_FORMAT")

IMPUTATION = GEN / "imputation.h"


def imputation() -> np.ndarray:
    """The imputation's weights [14,14] of gen/, as fractions."""
    return read_imputation(IMPUTATION.read_text("utf-8"))


def read_imputation(text: str) -> np.ndarray:
    """The weights [14,14] of a generated header; ConstantError if it is none."""
    _, _, table = text.partition("{{")
    numbers = np.array([int(word) for word in re.findall(r"-?\d+", table)])
    if numbers.size != len(JOINTS) ** 2:
        raise ConstantError(f"imputation: {numbers.size} weights, must be {len(JOINTS) ** 2}")
    return numbers.reshape(len(JOINTS), -1) / IMPUTATION_ONE
