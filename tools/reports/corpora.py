"""A corpus lifted by each of the programs that docs/corpora.md shows: the same bits, at what cost.

    python tools/run.py reports.corpora --update

They run by build/venv-corpora, which tools/check --long makes, and Java.
"""

import argparse
import contextlib
import hashlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil
import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet
from numpy.typing import NDArray

import edmlift
import edmlift.arrow
from edmlift._binding import load
from reports import markdown

ROOT = Path(__file__).resolve().parents[2]
PAGE, MARK = ROOT / "docs" / "corpora.md", "corpora"
PROGRAMS = ROOT / "examples" / "corpora"
PYTHON = ROOT / "build" / "venv-corpora" / "bin" / "python"
DETECTIONS = ROOT / "examples" / "data" / "detections"
CLIPS = ("beam1", "beam2", "beam3", "beam4", "street")
ADDED = ["pose", "misfit", "quality", "status"]
ROWS_OF_A_GROUP, GROUPS_OF_A_FILE = 25_000, 4
NOBODY, SHORT = 400, 700  # of so many rows one has no keypoints, or too few
EVERY = 0.1  # seconds between looks at the memory


@dataclass(frozen=True)
class Way:
    """A program that lifts a corpus into a file or folder."""

    title: str
    arguments: tuple[str, ...]  # of Python; CORPUS and POSES stand for the input and the output
    name: str  # of the output
    environment: dict[str, str] = field(default_factory=dict)

    @property
    def lines(self) -> int:
        """Lines of code, without the first, which says what it is."""
        path = Path(self.arguments[0])
        if not path.exists():
            return 1
        lines = path.read_text("utf-8").splitlines()[1:]
        return sum(1 for line in lines if line.strip())


_FILES = ("CORPUS", "POSES")
WAYS = {
    "command": Way("`edmlift lift`", ("-m", "edmlift", "lift", "CORPUS", "-o", "POSES", "--format",
                                      "coco17", "--model", "direct_f32"), "command.parquet"),
    "pyarrow": Way("pyarrow", (str(PROGRAMS / "lift_by_pyarrow.py"), *_FILES), "pyarrow.parquet"),
    "dask": Way("Dask", (str(PROGRAMS / "lift_by_dask.py"), *_FILES), "dask"),
    "spark": Way("PySpark", (str(PROGRAMS / "lift_by_spark.py"), *_FILES), "spark", {
        "PYSPARK_SUBMIT_ARGS": "--master local-cluster[2,1,1024] pyspark-shell"}),
}  # fmt: skip


# ---- The corpus --------------------------------------------------------------------------------


def write_corpus(folder: Path, rows: int) -> None:
    """Files of people: real detections of MoveNet, scaled, moved and shaken; some without, or with
    too few keypoints."""
    folder.mkdir()
    waiting: list[pa.RecordBatch] = []
    files = 0
    for batch in _people(rows):
        waiting.append(batch)
        if len(waiting) == GROUPS_OF_A_FILE or batch["id"][-1].as_py() == rows - 1:
            pa.parquet.write_table(
                pa.Table.from_batches(waiting), folder / f"part-{files:05}.parquet",
                row_group_size=ROWS_OF_A_GROUP, compression="zstd",
            )  # fmt: skip
            waiting, files = [], files + 1


def _people(rows: int) -> Iterator[pa.RecordBatch]:
    clips = [edmlift.read_keypoints(DETECTIONS / f"{clip}_thunder.csv", "coco17") for clip in CLIPS]
    frames, rng = np.concatenate(clips), np.random.default_rng(1)
    for start in range(0, rows, ROWS_OF_A_GROUP):
        number = np.arange(start, min(start + ROWS_OF_A_GROUP, rows))
        count = len(number)
        points = frames[rng.integers(len(frames), size=count)]
        points[..., :2] *= rng.uniform(0.3, 1.2, (count, 1, 1))
        points[..., :2] += rng.uniform(0, 500, (count, 1, 2)) + rng.normal(0, 2, (count, 17, 2))
        lengths = np.where(number % SHORT == SHORT - 1, 16, 17)
        lengths[number % NOBODY == NOBODY - 1] = 0
        there = np.arange(17) < lengths[:, None]
        triples = _lists(pa.array(points[there].ravel()), np.full(lengths.sum(), 3))
        yield pa.record_batch({"id": number, "keypoints": _lists(triples, lengths)})


def _lists(values: pa.Array, lengths: NDArray[np.int64]) -> pa.Array:
    """Lists of these lengths, null where that is 0."""
    ends = np.r_[0, np.cumsum(lengths)].astype(np.int32)
    return pa.ListArray.from_arrays(pa.array(ends), values, mask=pa.array(lengths == 0))


# ---- What a program costs, and what it wrote ---------------------------------------------------


@dataclass
class Cost:
    """Of a program and all that it started."""

    seconds: float = 0.0
    memory: int = 0  # bytes at most; what is shared counts once
    processor: dict[psutil.Process, float] = field(default_factory=dict)  # seconds of each

    def look(self, program: psutil.Process) -> None:
        """At what is running now."""
        memory = 0
        for process in [program, *program.children(recursive=True)]:
            with contextlib.suppress(psutil.Error):
                times = process.cpu_times()
                self.processor[process] = times.user + times.system
                memory += process.memory_full_info().pss
        self.memory = max(self.memory, memory)


def run(way: Way, source: Path, out: Path) -> Cost:
    """Runs a program on a corpus; SystemExit with what it printed, if it fails."""
    files = {"CORPUS": str(source), "POSES": str(out)}
    command = [str(PYTHON), *(files.get(word, word) for word in way.arguments)]
    environment = os.environ | way.environment | {
        "PATH": f"{PYTHON.parent}{os.pathsep}{os.environ['PATH']}",  # of Spark's workers
        "PYTHONPATH": str(ROOT / "tools"),
    }  # fmt: skip
    cost, start, log = Cost(), time.monotonic(), out.with_suffix(".log")
    with log.open("wb") as printed:
        running = psutil.Popen(command, env=environment, stdout=printed, stderr=printed)
        while running.poll() is None:
            with contextlib.suppress(psutil.NoSuchProcess):
                cost.look(running)
            time.sleep(EVERY)
    cost.seconds = time.monotonic() - start
    if running.returncode != 0:
        sys.exit(f"{way.title} failed:\n{log.read_text('utf-8', errors='replace')[-3000:]}")
    return cost


def read(path: Path) -> pa.Table:
    """The rows that a program wrote, in their order, with the types of edmlift.arrow."""
    table = pa.dataset.dataset(path).to_table().sort_by("id").combine_chunks()
    wanted = edmlift.arrow.schema(pa.schema({"keypoints": pa.null()})).remove(0)
    return pa.table([table[name].cast(wanted.field(name).type) for name in ADDED], schema=wanted)


def bits(table: pa.Table) -> str:
    """A hash of poses, qualities and statuses: the same only if all bits are."""
    found = hashlib.sha256(",".join(table["status"].to_pylist()).encode())
    for name in ADDED[:3]:
        column = table[name].combine_chunks()
        found.update(column.is_null().to_numpy(zero_copy_only=False).tobytes())
        numbers = column.flatten() if name == "pose" else column.drop_null()
        found.update(numbers.to_numpy(zero_copy_only=False).tobytes())
    return found.hexdigest()


def lacks() -> str | None:
    """What the programs need that is not there."""
    if not PYTHON.exists():
        folder = PYTHON.parents[1].relative_to(ROOT)
        return f"no {folder}: tools/check --long makes it, by tools/requirements-corpora.txt"
    if shutil.which("java") is None:
        return "no java, which Spark needs (Debian: default-jre-headless)"
    try:
        load()
    except (OSError, ImportError) as error:
        return str(error)
    return None


def measure(rows: int, folder: Path, ways: list[str]) -> dict[str, Cost]:
    """The costs of the ways, by their names; SystemExit if they do not write the same bits."""
    corpus = folder / "corpus"
    write_corpus(corpus, rows)
    costs, hashes = {}, {}
    for name in ways:
        way = WAYS[name]
        costs[name] = run(way, corpus, folder / way.name)
        hashes[name] = bits(read(folder / way.name))
        print(f"{way.title}: {costs[name].seconds:.1f} s, {hashes[name][:12]}", file=sys.stderr)
    if len(set(hashes.values())) > 1:
        sys.exit(f"not the same bits: {hashes}")
    return costs


def report(rows: int, costs: dict[str, Cost]) -> str:
    """The table of the page."""
    columns = ["lines", "seconds", "poses a second", "processor seconds", "memory, MB"]
    table = {
        WAYS[name].title: [
            WAYS[name].lines, round(cost.seconds), round(rows / cost.seconds),
            round(sum(cost.processor.values())), round(cost.memory / 1e6),
        ]
        for name, cost in costs.items()
    }  # fmt: skip
    text = f"{rows:,} rows, {os.cpu_count()} processors:\n\n"
    return text + markdown.table("", columns, table, markdown.counted)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=list(WAYS))
    parser.add_argument("--folder", type=Path, help="an empty one, to keep corpus and poses in")
    parser.add_argument("--update", action="store_true", help=f"write the table into {PAGE.name}")
    args = parser.parse_args()
    if problem := lacks():
        sys.exit(f"corpora: {problem}")
    with tempfile.TemporaryDirectory(dir=ROOT / "build") as temporary:
        costs = measure(args.rows, args.folder or Path(temporary), args.ways)
    text = report(args.rows, costs)
    print(text)
    if args.update:
        markdown.write(PAGE, MARK, text)


if __name__ == "__main__":
    main()
