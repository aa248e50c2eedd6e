"""A corpus by pyarrow alone, on one machine: lift_by_pyarrow.py CORPUS POSES.parquet"""

import sys

import pyarrow.dataset
import pyarrow.parquet
from tqdm import tqdm

import edmlift.arrow

source, out = sys.argv[1:]
lifter = edmlift.arrow.Lifter(format="coco17", model="direct_f32", threads=None)
people = pyarrow.dataset.dataset(source)
schema = lifter.schema(people.schema)
progress = tqdm(total=people.count_rows(), unit=" poses", unit_scale=True)
with pyarrow.parquet.ParquetWriter(out, schema, compression="zstd") as poses:
    for batch in people.to_batches(batch_size=65536):
        poses.write_batch(lifter(batch))
        progress.update(batch.num_rows)
