"""A corpus by Dask, on a cluster or the processors of this machine: lift_by_dask.py CORPUS POSES"""

import sys

import dask.dataframe
import pandas
import pyarrow
from dask.distributed import Client, progress

import edmlift.arrow

lifter = edmlift.arrow.Lifter(format="coco17", model="direct_f32")


def lift(people: pandas.DataFrame) -> pandas.DataFrame:
    lifted = lifter(pyarrow.Table.from_pandas(people, preserve_index=False))
    return lifted.to_pandas(types_mapper=pandas.ArrowDtype)


if __name__ == "__main__":
    source, out = sys.argv[1:]
    people = dask.dataframe.read_parquet(source, dtype_backend="pyarrow")
    poses = people.map_partitions(lift, meta=lift(people.head(0)))
    with Client(threads_per_worker=1) as client:  # or the address of a scheduler
        writing = client.compute(poses.to_parquet(out, compression="zstd", compute=False))
        progress(writing)
        writing.result()
