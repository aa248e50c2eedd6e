"""Columns of Arrow in, the same and poses out: for corpora, by PySpark, Dask, Ray or pyarrow alone.

    import edmlift.arrow
    lifter = edmlift.arrow.Lifter(format="coco17")
    lifted = lifter(batch)          # a RecordBatch or Table with a column "keypoints"
    lifted["pose"], lifted["status"]

A row is a person.  docs/corpora.md has the types of columns that are known, and programs.  What is
wrong with a row is a status in that row; ColumnError: nothing can be read from the column, whatever
its rows hold.  Needs pyarrow: pip install "edmlift[arrow]".
"""

import re
import warnings
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import JOINT_COUNT, load
from edmlift.formats import find_format
from edmlift.joints import JOINTS
from edmlift.keypoint_files import NOBODY
from edmlift.keypoint_sets import count_of
from edmlift.lifting import Poses, lift, quality_of
from edmlift.packages import need

need("pyarrow", "edmlift.arrow", extra="arrow")

import pyarrow as pa  # noqa: E402

from edmlift.arrow_columns import (  # noqa: E402
    ColumnError,
    People,
    has_columns,
    read_people,
    read_values,
    without,
)

__all__ = ["BAD_ROW", "ColumnError", "Lifter", "lift_batch", "schema"]

_Floats = NDArray[np.float32]
BAD_ROW = "bad_row"  # the status of a row that cannot be read
_ABOUT = {
    "unit": "m",
    "axes": "x right, y down, z away from the camera",
    "origin": "midway between the hips",
    "order": " ".join(f"{joint}_{axis}" for joint in JOINTS for axis in "xyz"),
}
# Lists of variable length and plain strings, because Spark takes no others.
_FIELDS = (
    pa.field("pose", pa.list_(pa.float32()), metadata=_ABOUT),
    pa.field("misfit", pa.float32()),
    pa.field("quality", pa.float32()),
    pa.field("status", pa.string()),
)
# What may be known of each row, with values that could be, and which could.
_KNOWN = {"up": (0.0, -1.0, 0.0), "image": (1.0, 1.0), "camera": (1.0, 1.0, 0.0, 0.0)}
_COULD_BE: dict[str, Callable[[_Floats], Any]] = {
    "up": lambda up: up.any(1),
    "image": lambda size: (size > 0).all(1),
    "camera": lambda camera: (camera[:, :2] > 0).all(1),
}
_Batch = TypeVar("_Batch", pa.RecordBatch, pa.Table)


@dataclass(frozen=True, kw_only=True)
class Lifter:
    """Lifts batches by the same options; it can be pickled, so that workers may have it.

    keypoints  name of the column of keypoints.  Default: "keypoints" or another of the names that
               files have (docs/detectors.md); or a column for each number, such as x0, y0, c0 or
               nose_x, nose_y, nose_score
    scores     name of the column of confidences.  Default: "keypoint_scores", if it is there
    prefix     of the names of the columns that are added
    threads    how many processors a batch may use.  Default: 1, because Spark, Dask and Ray run a
               task for each processor.  None: all of them

    model, format, threshold, mirrored and fixed are as in `edmlift.lift`; so are up, image and
    camera, which may also name columns: "gravity" one of lists, ("width", "height") one for each
    number, and (1145, 1145, "cx", "cy") one for some.  Where one is null it is not known.

    ValueError: the options are wrong.
    """

    keypoints: str | None = None
    scores: str | None = None
    model: str | None = None
    up: ArrayLike | str | None = None
    format: str | None = None
    threshold: float | None = None
    image: ArrayLike | str | None = None
    camera: ArrayLike | str | None = None
    mirrored: bool = False
    fixed: bool = False
    prefix: str = ""
    threads: int | None = 1
    _said: set[str] = field(default_factory=set, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Lifts nobody by these options."""
        known = {name: getattr(self, name) for name in _KNOWN}
        for name in self._columns():
            option, like = known[name], _KNOWN[name]
            if not isinstance(option, str) and len(option) != len(like):
                what = f"{len(like)} numbers or names of columns"
                raise ValueError(f"{name} must be {what}, not {option!r}")
            known[name] = like
        self._lift(np.zeros((0, count_of(self.format), 3), np.float32), known)

    def __call__(self, batch: _Batch) -> _Batch:
        """A batch, or table, with the columns of `schema`.

        ColumnError: the keypoints, or what options name, are not there, or of another type; or a
        column has the name of one that is added.  What looks like a mistake is a UserWarning, once.
        """
        full = self._with_added(batch.schema)
        if not isinstance(batch, pa.Table):
            return self._lift_batch(batch, full)
        return pa.Table.from_batches([self._lift_batch(b, full) for b in batch.to_batches()], full)

    def map(self, batches: Iterable[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """Batch by batch, as `mapInArrow` of PySpark wants it."""
        for batch in batches:
            yield self(batch)

    def schema(self, schema: pa.Schema) -> pa.Schema:
        """The schema of batches that are lifted, given theirs.

        pose       list<float> of 42: x, y and z of each joint, as in edmlift.JOINTS; metres, x
                   right, y down, z away, origin at mid-hip.  Null where it is refused, as are
        misfit     float: as in Poses; metres
        quality    float, 0 to 1: as `edmlift.quality` has it
        status     string: "ok", or why there is no pose: those of `edmlift.lift`; "nobody", because
                   the keypoints are null or empty; "bad_row", because they are not as many as the
                   format has, or up, image or camera could not be

        ColumnError: as for a batch, so that a job can fail before it starts.
        """
        full = self._with_added(schema)
        nobody = [column.chunk(0) for column in schema.empty_table().columns]
        self._lift_batch(pa.RecordBatch.from_arrays(nobody, schema=schema), full)
        return full

    def _with_added(self, schema: pa.Schema) -> pa.Schema:
        for one in _FIELDS:
            name = self.prefix + one.name
            if name in schema.names:
                raise ColumnError(
                    f'there is a column "{name}", which the lift adds: rename it, or set prefix='
                )
            schema = schema.append(one.with_name(name))
        return schema

    def _lift_batch(self, batch: pa.RecordBatch, full: pa.Schema) -> pa.RecordBatch:
        people = read_people(batch, self.keypoints, self.scores, self.format)
        columns = {
            name: read_values(batch, getattr(self, name), len(_KNOWN[name]))
            for name in self._columns()
        }
        arrays = [*batch.columns, *self._lift_rows(people, columns)]
        return pa.RecordBatch.from_arrays(arrays, schema=full)

    def _columns(self) -> list[str]:
        """Which of what may be known of each row is in columns."""
        return [name for name in _KNOWN if has_columns(getattr(self, name))]

    def _lift_rows(self, people: People, columns: dict[str, _Floats]) -> list[pa.Array]:
        """What is added to the rows."""
        count = len(people.points)
        joints = np.full((count, 3 * JOINT_COUNT), np.nan, np.float32)
        misfit, quality = np.full((2, count), np.nan, np.float32)
        status = np.full(count, BAD_ROW, object)
        people = _without_impossible(people, columns)
        same = {name: getattr(self, name) for name in _KNOWN if name not in columns}
        for rows, known in _alike(columns, count):
            if self._lacks_image(same | known):
                lacking = np.zeros(count, bool)
                lacking[rows] = True
                people = without(people, lacking, "its image has no size")
                continue
            poses = self._lift(people.points[rows], same | known)
            self._say(*poses.warnings)
            joints[rows] = poses.joints.reshape(-1, 3 * JOINT_COUNT)
            misfit[rows], quality[rows] = poses.misfit, quality_of(load(), poses)
            status[rows] = poses.status
        status[people.bad], status[people.nobody] = BAD_ROW, NOBODY
        if people.problem:
            bad = f"{people.bad.sum():,} of {count:,} rows are {BAD_ROW}"
            self._say(f"{bad}; the first of them: {people.problem}")
        return _arrays(joints, misfit, quality, status)

    def _lacks_image(self, known: dict[str, Any]) -> bool:
        """Can rows of which this is known not be lifted, because the size of their image is not?"""
        normalised = self.format is not None and find_format(self.format).normalised
        needed = normalised or (self.mirrored and known["camera"] is not None)
        return bool(needed) and known["image"] is None

    def _lift(self, points: _Floats, known: dict[str, Any]) -> Poses:
        return lift(
            points, self.model, format=self.format, threshold=self.threshold,
            mirrored=self.mirrored, fixed=self.fixed, threads=self.threads, **known,
        )  # fmt: skip

    def _say(self, *texts: str) -> None:
        """Warnings; each once, whatever its numbers are."""
        for text in texts:
            words = re.sub(r"\d+", "", text)
            if words not in self._said:
                self._said.add(words)
                warnings.warn(text, stacklevel=5)


def lift_batch(batch: _Batch, **options: Any) -> _Batch:
    """A batch, or table, with the poses of its rows: Lifter(**options)(batch)."""
    return Lifter(**options)(batch)


def schema(schema: pa.Schema, **options: Any) -> pa.Schema:
    """The schema of batches that are lifted, given theirs: Lifter(**options).schema(schema)."""
    return Lifter(**options).schema(schema)


def _without_impossible(people: People, columns: dict[str, _Floats]) -> People:
    """Rows are bad that have values which cannot be; these become NaN, which is not known."""
    for name, values in columns.items():
        could_be = np.isfinite(values).all(1) & _COULD_BE[name](values)
        wrong = ~np.isnan(values).any(1) & ~could_be
        columns[name] = np.where(wrong[:, None], np.float32(np.nan), values)
        people = without(people, wrong, f"its {name} cannot be")
    return people


def _alike(columns: dict[str, _Floats], count: int) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Rows of which the same is known, and what: values, or None."""
    if not columns:
        yield slice(None), {}
        return
    there = np.stack([~np.isnan(values).any(1) for values in columns.values()], 1)
    kinds = np.unique(there, axis=0)
    for kind in kinds:
        rows = np.flatnonzero((there == kind).all(1)) if len(kinds) > 1 else slice(None)
        parts = zip(columns.items(), kind.tolist(), strict=True)
        yield rows, {name: values[rows] if known else None for (name, values), known in parts}


def _arrays(
    joints: _Floats, misfit: _Floats, quality: _Floats, status: NDArray[np.object_]
) -> list[pa.Array]:
    """The columns of _FIELDS."""
    refused = status != "ok"
    ends = np.cumsum(np.r_[0, 3 * JOINT_COUNT * ~refused], dtype=np.int32)
    values = pa.array(joints[~refused].ravel() if refused.any() else joints.ravel())
    poses = pa.ListArray.from_arrays(pa.array(ends), values, mask=pa.array(refused))
    numbers = [pa.array(n, pa.float32(), mask=refused) for n in (misfit, quality)]
    return [poses, *numbers, pa.array(status, pa.string())]
