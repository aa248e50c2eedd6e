"""Files of rows, a person each, to files with their poses: as much in memory as a batch."""

import contextlib
import os
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from edmlift.arrow import Lifter
from edmlift.keypoint_files import FileError
from edmlift.packages import need
from edmlift.tables import TABLE_SUFFIXES, table_files

need("tqdm", "the progress of a table", extra="arrow")

import pyarrow as pa  # noqa: E402
import pyarrow.compute as pc  # noqa: E402
import pyarrow.dataset as ds  # noqa: E402
import pyarrow.parquet as pq  # noqa: E402
from pyarrow import ArrowException  # noqa: E402
from tqdm import tqdm  # noqa: E402

__all__ = ["ArrowException", "Lifter", "lift_files", "say"]

ROWS = 65_536  # of a batch, and of a row group that is written


def lift_files(source: Path, out: Path, lifter: Lifter) -> Counter[str]:
    """Lifts a Parquet or Arrow file, or a folder of these, into one; how many rows have which
    status.  On a terminal it shows its progress.

    The file has its name only when it is whole; until then `.part` is added.
    """
    dataset = _open(source)
    schema = lifter.schema(dataset.schema)
    counts: Counter[str] = Counter()
    bar = tqdm(total=dataset.count_rows(), unit=" poses", unit_scale=True, disable=None)
    with bar, _whole(out) as part, _writer(part, out.suffix.lower(), schema) as writer:
        for table in _gathered(lifter.map(_batches(dataset)), schema):
            writer.write_table(table)
            for count in pc.value_counts(table[f"{lifter.prefix}status"]).to_pylist():
                counts[count["values"]] += count["counts"]
            bar.update(table.num_rows)
    return counts


def say(text: str) -> None:
    """A line on stderr, above the progress."""
    tqdm.write(text, file=sys.stderr)


def _open(source: Path) -> Any:
    """The rows of a file, or of the files of a folder and its folders in the order of their names;
    folders called NAME=VALUE are a column."""
    files = table_files(source)
    if not files:
        raise FileError(f"{source}: a folder without files that end in {', '.join(TABLE_SUFFIXES)}")
    kinds = {path.suffix.lower() for path in files}
    if len({kind == ".parquet" for kind in kinds}) > 1:
        raise FileError(f"{source}: has files of several kinds: {', '.join(sorted(kinds))}")
    return ds.dataset(
        [str(path) for path in files], format="parquet" if ".parquet" in kinds else "ipc",
        partitioning="hive", partition_base_dir=str(source),
    )  # fmt: skip


def _batches(dataset: Any) -> Iterator[Any]:
    """Of ROWS or fewer.  A scan of the dataset would read up to a gigabyte ahead of the lift."""
    for file in dataset.get_fragments():
        keys = ds.get_partition_keys(file.partition_expression)
        for batch in _read(file.path):
            yield _completed(batch, keys, dataset.schema)


def _read(path: str) -> Iterator[Any]:
    if path.lower().endswith(".parquet"):
        with pq.ParquetFile(path, memory_map=True) as file:
            yield from file.iter_batches(ROWS)
        return
    with pa.memory_map(path) as memory:
        file = pa.ipc.open_file(memory)
        for batch in map(file.get_batch, range(file.num_record_batches)):
            yield from (batch.slice(start, ROWS) for start in range(0, batch.num_rows, ROWS))


def _completed(batch: Any, keys: dict[str, Any], schema: Any) -> Any:
    """A batch of a file with all columns of the dataset: those that folders name, or null."""

    def column(field: Any) -> Any:
        if field.name in batch.schema.names:
            return batch.column(field.name).cast(field.type)
        return pa.repeat(pa.scalar(keys.get(field.name), field.type), batch.num_rows)

    return pa.RecordBatch.from_arrays([column(field) for field in schema], schema=schema)


def _gathered(batches: Iterable[Any], schema: Any) -> Iterator[Any]:
    """Batches as tables of ROWS or more, because small row groups are slow to read."""
    waiting: list[Any] = []
    rows = 0
    for batch in batches:
        waiting.append(batch)
        rows += batch.num_rows
        if rows >= ROWS:
            yield pa.Table.from_batches(waiting, schema)
            waiting, rows = [], 0
    if waiting:
        yield pa.Table.from_batches(waiting, schema)


def _writer(path: Path, suffix: str, schema: Any) -> Any:
    if suffix == ".parquet":
        return pq.ParquetWriter(path, schema, compression="zstd")
    return pa.ipc.new_file(str(path), schema)


@contextlib.contextmanager
def _whole(path: Path) -> Iterator[Path]:
    """A file to write, which gets its name when all is well, and goes away when it is not."""
    if path.is_dir():
        raise FileError(f"{path}: is a folder, but one file is written")
    part = path.with_name(f"{path.name}.part")
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
