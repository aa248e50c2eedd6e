"""A corpus by PySpark, on a cluster: spark-submit lift_by_spark.py CORPUS POSES"""

import sys

from pyspark.sql import SparkSession
from pyspark.sql.pandas.types import from_arrow_schema, to_arrow_schema

import edmlift.arrow

source, out = sys.argv[1:]
lifter = edmlift.arrow.Lifter(format="coco17", model="direct_f32")
spark = SparkSession.builder.config("spark.ui.showConsoleProgress", True).getOrCreate()
people = spark.read.parquet(source)
schema = from_arrow_schema(lifter.schema(to_arrow_schema(people.schema)))
people.mapInArrow(lifter.map, schema).write.parquet(out, compression="zstd")
