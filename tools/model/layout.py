"""What the equivariant networks read and give, as numbers in a row: the layouts of lifter.py.

The weights of a layer are those of the even inputs, then those of the odd ones.  Joints come as
rows: the two in the middle, then those of the right, each with its mirror joint.
"""

from typing import NamedTuple

import numpy as np

from edmlift.joints import MIRROR, PAIR_MIRROR, SELF_MIRRORED

KINDS = ("distances", "direct")

# Joints in the middle, then those of the right; their mirror joints are themselves, then the left.
MIDDLE = 2
FIRST = np.array([0, 1, 2, 3, 4, 8, 9, 10])
SECOND = MIRROR[FIRST]
ROWS, SIDES = len(FIRST), len(FIRST) - MIDDLE
PAIR_ROWS, PAIR_SIDES = len(PAIR_MIRROR), len(PAIR_MIRROR) - SELF_MIRRORED
EVEN_INPUTS, ODD_INPUTS = SIDES + 2 * ROWS + 3, ROWS + 2 * SIDES + 1  # of `direct`

_JOINT = (np.ones(ROWS, bool), np.arange(ROWS) >= MIDDLE)  # of a number that a mirror leaves alone
_ACROSS = (_JOINT[1], _JOINT[0])  # of one whose sign it changes
_PAIR = (np.ones(PAIR_ROWS, bool), np.arange(PAIR_ROWS) < PAIR_SIDES)


class Layout(NamedTuple):
    """What goes into a network, and what comes out."""

    even: int  # inputs
    odd: int
    has_even: np.ndarray  # bool [rows]: does what is even count in the output row?
    has_odd: np.ndarray  # an output row that is its own mirror image lacks one of the two


def layout(kind: str) -> Layout:
    """What a kind of network reads and gives."""
    even, odd = EVEN_INPUTS, ODD_INPUTS
    parts = (_ACROSS, _JOINT, _JOINT, _JOINT)  # x, y, z, gates
    if kind == "distances":
        even, odd, parts = even + PAIR_ROWS, odd + PAIR_SIDES, (_PAIR, *parts)
    return Layout(even, odd, *map(np.concatenate, zip(*parts, strict=True)))
