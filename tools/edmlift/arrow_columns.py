"""Columns of Arrow to arrays: keypoint sets of one person a row, and what is known of each row."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from edmlift.csv_keypoints import find_columns, known_columns
from edmlift.formats import BY_IMAGE, BY_SQUARE, find_format
from edmlift.keypoint_files import PIXELS
from edmlift.keypoint_sets import CONFIDENCES, count_of, names_of, wrong_count
from edmlift.keypoints import look_like_pixels
from edmlift.people import PERSON_NAMES, SCORES_NAME

# Views of lists came with later versions.
_LIST_NAMES = (
    "ListType",
    "LargeListType",
    "FixedSizeListType",
    "ListViewType",
    "LargeListViewType",
)
_LISTS = tuple(getattr(pa, name) for name in _LIST_NAMES if hasattr(pa, name))
_Floats = NDArray[np.float32]
_Flags = NDArray[np.bool_]


class ColumnError(ValueError):
    """A column that is not there, or of a type that no row of it can be read from."""


class _WrongType(Exception):
    """What is in a column is of another type."""


@dataclass(frozen=True)
class People:
    """The keypoint sets of N rows."""

    points: _Floats  # [N,K,3] x, y and confidence; NaN where there is none or it cannot be read
    nobody: _Flags  # [N] no keypoints are there
    bad: _Flags  # [N] there are, but they cannot be read
    problem: str = ""  # what is wrong with the first of these


def read_people(
    batch: pa.RecordBatch, name: str | None, scores: str | None, format: str | None
) -> People:
    """The keypoint sets of a batch.

    name    of their column; by default that of PERSON_NAMES which is there, or columns as in the
            heading of a CSV file, with a number or name of each keypoint
    scores  name of the column of their confidences; by default SCORES_NAME, if it is there
    """
    names = batch.schema.names
    found = [name] if name else [known for known in PERSON_NAMES if known in names]
    if len(found) > 1:
        raise ColumnError(f'there are columns "{found[0]}" and "{found[1]}": say which to lift')
    if found:
        beside = scores or (SCORES_NAME if SCORES_NAME in names else None)
        people = _from_lists(batch, found[0], beside, format)
    else:
        people = _from_columns(batch, format)
    layout = None if format is None else find_format(format)
    if layout is None or layout.normalised not in (BY_IMAGE, BY_SQUARE):
        return people
    return without(people, look_like_pixels(people.points), PIXELS)


def read_values(batch: pa.RecordBatch, option: Any, count: int) -> _Floats:
    """Values [N,count] of an option of `lift` that names columns, one of lists or some of numbers:
    NaN where one is null, and infinite where a list has another length."""
    if isinstance(option, str):
        what = f"list<float> of {count} numbers"
        values, fits = _read(batch, option, what, lambda array: _lists(array, count))
        return np.where(fits[:, None], values, np.float32(np.inf))
    parts = [_read(batch, p, "a number", _floats) if isinstance(p, str) else p for p in option]
    return np.stack([np.broadcast_to(np.float32(part), batch.num_rows) for part in parts], -1)


def has_columns(option: Any) -> bool:
    """Does an option of `lift` name columns?"""
    return isinstance(option, str) or (
        isinstance(option, Sequence) and any(isinstance(part, str) for part in option)
    )


def _read(batch: pa.RecordBatch, name: str, wanted: str, read: Any) -> Any:
    """What `read` makes of a column; ColumnError says what is wanted instead."""
    where = batch.schema.get_all_field_indices(name)
    if len(where) != 1:
        known = ", ".join(f'"{n}"' for n in batch.schema.names) or "none"
        few = "there is no column" if not where else f"there are {len(where)} columns"
        raise ColumnError(f'{few} "{name}"; the columns are {known}')
    column = batch.column(where[0])
    try:
        return read(column)
    except _WrongType:
        raise ColumnError(f'column "{name}" is {column.type}, but must be {wanted}') from None


def _set_of(count: int) -> str:
    return (
        f"the {count} keypoints of one person: list<list<float>> of x, y or x, y, c, "
        f"list<struct> with x, y and perhaps {' or '.join(CONFIDENCES)}, or list<float> of "
        f"{2 * count} or {3 * count} numbers"
    )


# ---- Keypoint sets -----------------------------------------------------------------------------


def _from_lists(batch: pa.RecordBatch, name: str, scores: str | None, format: str | None) -> People:
    """Of one column, perhaps with another of confidences; a third number is z then."""
    count = count_of(format)
    people: People = _read(batch, name, _set_of(count), lambda array: _people(array, format))
    if scores is None:
        return people
    what = f"list<float> of {count} confidences"
    confidences, fits = _read(batch, scores, what, lambda array: _lists(array, count))
    points = np.concatenate([people.points[..., :2], confidences[..., None]], -1)
    return without(replace(people, points=points), ~fits, f"not {count} of {scores}")


def _people(column: pa.Array, format: str | None) -> People:
    """Keypoint sets of any of the types that _set_of() tells."""
    array, count = _plain(column), count_of(format)
    if pa.types.is_null(array.type):
        points = np.full((len(array), count, 3), np.nan, np.float32)
        return People(points, np.ones(len(array), bool), np.zeros(len(array), bool))
    if pa.types.is_struct(array.type):
        return _from_struct_of_lists(array, count)
    inner, lengths = _unnested(array)
    nested = isinstance(inner.type, (*_LISTS, pa.StructType)) or pa.types.is_null(inner.type)
    if nested:
        points, fine = _points(inner)
        points, fits = _rows(points, lengths, count)
        fits[np.repeat(np.arange(len(lengths)), lengths)[~fine]] = False
        points, named = _by_name(points, inner, lengths, format)
        fits &= named
    else:
        points, fits = _triples(_floats(inner), lengths, count)
    bad = ~fits & (lengths > 0)
    problem = _problem(int(lengths[bad][0]), nested, format) if bad.any() else ""
    return without(People(points, lengths == 0, np.zeros(len(bad), bool)), bad, problem)


def _problem(length: int, nested: bool, format: str | None) -> str:
    """What is wrong with a list of this length."""
    count = count_of(format)
    if not nested:
        return wrong_count(f"{length} numbers", f"{2 * count} or {3 * count}", length / 3, format)
    if length == count:
        return "a keypoint is neither x, y nor x, y, c, or not named as one of the format's"
    return wrong_count(f"{length} keypoints", f"{count}", length, format)


def _points(array: pa.Array) -> tuple[_Floats, _Flags]:
    """Keypoints [M,3] of lists or structs, and which are x and y, x, y and c, or null."""
    if pa.types.is_null(array.type):
        return np.full((len(array), 3), np.nan, np.float32), np.ones(len(array), bool)
    if pa.types.is_struct(array.type):
        columns = [_floats(array.field(i)) for i in _fields(array.type)]
        points = _with_ones(np.stack(columns, -1))
        points[_flags(array.is_null())] = np.nan
        return points, np.ones(len(array), bool)
    points, fits = _triples(*_unnested(array, _floats), 1)
    return points[:, 0], fits | _flags(array.is_null())


def _by_name(
    points: _Floats, inner: pa.Array, lengths: NDArray[np.int64], format: str | None
) -> tuple[_Floats, _Flags]:
    """Points [N,K,3] in the format's order, if those `inner` are structs with names, and which have
    each name once, or none at all."""
    names, structs = names_of(format), pa.types.is_struct(inner.type)
    if names is None or not structs or inner.type.get_field_index("name") < 0:
        return points, np.ones(len(points), bool)
    given = _plain(inner.field("name"))
    if not (pa.types.is_string(given.type) or pa.types.is_large_string(given.type)):
        raise _WrongType
    found = pc.index_in(given, pa.array(names, given.type)).to_numpy(zero_copy_only=False)
    places, _ = _rows(found.astype(np.float32), lengths, len(names))
    unnamed, _ = _rows(_flags(given.is_null()).astype(np.float32), lengths, len(names))
    every = np.arange(len(names), dtype=np.float32)
    places[(unnamed == 1).all(1)] = every
    order = places.argsort(1)
    named = (np.take_along_axis(places, order, 1) == every).all(1)
    return np.take_along_axis(points, order[..., None], 1), named


def _from_struct_of_lists(array: pa.Array, count: int) -> People:
    """{"x": [...], "y": [...], "visible": [...]}"""
    lists = [_lists(array.field(i), count) for i in _fields(array.type)]
    points = _with_ones(np.stack([values for values, _ in lists], -1))
    fits = np.all([fine for _, fine in lists], 0)
    people = People(points, _flags(array.is_null()), np.zeros(len(array), bool))
    return without(people, ~fits, f"not {count} of x, y and confidence")


def _fields(kind: pa.StructType) -> list[int]:
    """Which fields of a struct are x, y and, where there is one, the confidence."""
    wanted = ["x", "y", *[n for n in CONFIDENCES if kind.get_field_index(n) >= 0][:1]]
    found = [kind.get_field_index(name) for name in wanted]
    if min(found) < 0:
        raise _WrongType
    return found


def _from_columns(batch: pa.RecordBatch, format: str | None) -> People:
    """From a column for each number."""
    names = batch.schema.names
    where = find_columns([name.lower() for name in names], format)
    if where is None:
        raise ColumnError(
            f"there is no column of {', '.join(PERSON_NAMES)}, nor columns that name all "
            f"{known_columns(format)}; the columns are {', '.join(names) or 'none'}: say which to "
            "lift"
        )
    columns = [[_read(batch, names[i], "a number", _floats) for i in fields] for fields in where]
    numbers = np.array(columns, np.float32).transpose(2, 0, 1)
    nobody = np.asarray(np.isnan(numbers).all((1, 2)))
    return People(_with_ones(numbers), nobody, np.zeros(len(numbers), bool))


def without(people: People, bad: _Flags, problem: str) -> People:
    """Some rows are bad, too, unless nobody is there."""
    worse = bad & ~people.nobody & ~people.bad
    if not worse.any():
        return people
    points = people.points.copy()
    points[worse] = np.nan
    return People(points, people.nobody, people.bad | worse, people.problem or problem)


# ---- Lists and numbers -------------------------------------------------------------------------


def _plain(array: pa.Array) -> pa.Array:
    """What an array encodes: without dictionary, run lengths or a type of somebody's own."""
    while True:
        if isinstance(array.type, pa.BaseExtensionType):
            array = array.storage
        elif pa.types.is_dictionary(array.type):
            array = array.dictionary_decode()
        elif pa.types.is_run_end_encoded(array.type):
            array = pc.run_end_decode(array)
        else:
            return array


def _floats(column: pa.Array) -> _Floats:
    """float32 of numbers, not copied where these are; NaN is null, what is too large infinite."""
    array = _plain(column)
    if pa.types.is_null(array.type):
        return np.full(len(array), np.nan, np.float32)
    if pa.types.is_decimal(array.type):
        array = array.cast(pa.float64())
    if not (pa.types.is_floating(array.type) or pa.types.is_integer(array.type)):
        raise _WrongType
    with np.errstate(over="ignore"):
        floats: _Floats = array.to_numpy(zero_copy_only=False).astype(np.float32, copy=False)
    return floats


def _flags(array: pa.Array) -> _Flags:
    flags: _Flags = array.to_numpy(zero_copy_only=False)
    return flags


def _unnested(column: pa.Array, read: Any = _plain) -> tuple[Any, NDArray[np.int64]]:
    """What N lists hold, one behind another, as `read` has it; and their lengths [N], 0 of null."""
    array = _plain(column)
    if not isinstance(array.type, _LISTS):
        raise _WrongType
    lengths = pc.fill_null(pc.list_value_length(array), 0)
    return read(array.flatten()), lengths.to_numpy(zero_copy_only=False).astype(np.int64)


def _lists(column: pa.Array, width: int) -> tuple[_Floats, _Flags]:
    """Numbers [N,width] of lists; NaN where one is null or has another length, and where it is
    null or has this one."""
    array = _plain(column)
    if pa.types.is_null(array.type):
        return np.full((len(array), width), np.nan, np.float32), np.ones(len(array), bool)
    values, fits = _rows(*_unnested(array, _floats), width)
    return values, fits | _flags(array.is_null())


def _rows(values: _Floats, lengths: NDArray[np.int64], width: int) -> tuple[_Floats, _Flags]:
    """Values [M,...] of N lists as [N,width,...], NaN where one has another length; and which have
    this one [N]."""
    shape, fits = (len(lengths), width, *values.shape[1:]), lengths == width
    if fits.all():
        return values.reshape(shape), fits
    rows = np.full(shape, np.nan, np.float32)
    rows[fits] = values[np.repeat(fits, lengths)].reshape(-1, *shape[1:])
    return rows, fits


def _triples(numbers: _Floats, lengths: NDArray[np.int64], count: int) -> tuple[_Floats, _Flags]:
    """[N,count,3] of N lists of x, y, c, x, y, c ... or x, y, x, y ..., whose c is 1."""
    rows, three = _rows(numbers, lengths, 3 * count)
    points = rows.reshape(-1, count, 3)
    two = lengths == 2 * count
    if two.any():
        pairs, _ = _rows(numbers, lengths, 2 * count)
        points[two] = _with_ones(pairs[two].reshape(-1, count, 2))
    return points, three | two


def _with_ones(points: _Floats) -> _Floats:
    """Keypoints [...,3] of these [...,2 or 3]: those without a confidence have 1."""
    return points if points.shape[-1] == 3 else np.insert(points, 2, 1, axis=-1)
