"""Which trials of CMU's motion capture database the networks are trained and measured on.

docs/motion-data.md says where the database is and what it asks for.
"""

Trials = frozenset[tuple[int, int]]  # subject, trial: 02_04.amc is (2, 4)

_TRAIN = {
    1: "1-14",
    3: "1-4",
    5: "1-20",
    6: "1-15",
    7: "1-2 4-12",
    10: "1 3",
    13: "29-31",
    14: "2 4-15 17-37",
    16: "1-58",
    35: "1 12 16-17",
    60: "1-7 9-15",
    61: "1-7 9-15",
    91: "1-2 4 13 17 47",
    94: "4 6-8 13-15",
    127: "1-38",
    135: "2-11",
}
_TEST = {
    2: "1-10",
    9: "1-12",
    11: "1",
    12: "1",
    29: "1-5 7-9 11 14-17 19-25",
    55: "2",
    131: "4",
}


def _numbers(text: str) -> list[int]:
    """ "1-3 5" -> 1, 2, 3, 5."""
    ends = (part.partition("-") for part in text.split())
    return [n for first, _, last in ends for n in range(int(first), int(last or first) + 1)]


def _trials(subjects: dict[int, str]) -> Trials:
    return frozenset((s, t) for s, text in subjects.items() for t in _numbers(text))


SETS = {"train": _trials(_TRAIN), "test": _trials(_TEST)}
