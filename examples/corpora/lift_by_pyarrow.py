"""A corpus by pyarrow alone, on one machine: lift_by_pyarrow.py CORPUS POSES.parquet"""

import sys
from pathlib import Path

from pyarrow.parquet import ParquetFile, ParquetWriter
from tqdm import tqdm

import edmlift.arrow

source, out = sys.argv[1:]
lifter = edmlift.arrow.Lifter(format="coco17", model="direct_f32", threads=None)
files = [ParquetFile(path) for path in sorted(Path(source).glob("*.parquet"))]
schema = lifter.schema(files[0].schema_arrow)
progress = tqdm(total=sum(file.metadata.num_rows for file in files), unit=" poses", unit_scale=True)
with ParquetWriter(out, schema, compression="zstd") as poses:
    for file in files:
        for batch in file.iter_batches(65536):
            poses.write_batch(lifter(batch))
            progress.update(batch.num_rows)
