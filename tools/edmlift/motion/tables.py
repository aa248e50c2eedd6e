"""Tables with a row a frame and a column a joint and axis: CSV, Parquet and Arrow."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from edmlift.joints import JOINTS
from edmlift.motion.clip import Clip
from edmlift.packages import need

_COORDINATES = tuple(f"{joint}_{axis}" for joint in JOINTS for axis in "xyz")


def write_csv(path: Path, clip: Clip) -> None:
    """Six digits; numbers are empty where there is no pose."""
    rows, misfit = clip.joints.reshape(len(clip.joints), -1), clip.misfit
    timed = clip.fps is not None
    names = ("frame", *(("time",) if timed else ()), "status", "misfit", *_COORDINATES)
    times = [f"{time:.6f}," for time in clip.times] if timed else [""] * len(rows)
    numbers = "%.6g" + ",%.6g" * rows.shape[1]
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(names) + "\n")
        for i, (time, status) in enumerate(zip(times, clip.status.tolist(), strict=True)):
            values = numbers % (misfit[i], *rows[i].tolist()) if status == "ok" else "," * 42
            file.write(f"{i},{time}{status},{values.replace('nan', '')}\n")


def write_parquet(path: Path, clip: Clip) -> None:
    """float32; null where there is no pose."""
    need("pyarrow.parquet", "a .parquet file").write_table(_table(path, clip), path)


def write_arrow(path: Path, clip: Clip) -> None:
    """An Arrow IPC file, which is a Feather file of version 2; null where there is no pose.

    Without compression, because not every reader of Arrow has it."""
    need("pyarrow.feather", f"a {path.suffix} file").write_feather(
        _table(path, clip), str(path), compression="uncompressed"
    )


def _table(path: Path, clip: Clip) -> Any:
    """A pyarrow.Table."""
    arrow = need("pyarrow", f"a {path.suffix} file")

    def numbers(values: NDArray[np.float64]) -> Any:
        return arrow.array(values.astype(np.float32), from_pandas=True)  # NaN is null

    columns = {"frame": arrow.array(np.arange(len(clip.joints), dtype=np.int32))}
    if clip.fps is not None:
        columns["time"] = arrow.array(clip.times)
    columns["status"] = arrow.array(clip.status.tolist(), arrow.string())
    columns["misfit"] = numbers(clip.misfit)
    rows = clip.joints.reshape(len(clip.joints), -1)
    columns |= {name: numbers(column) for name, column in zip(_COORDINATES, rows.T, strict=True)}
    about = {
        "unit": "m",
        "axes": "x right, y up, z towards the camera",
        "floor": "y = 0" if clip.on_floor else "not known",
    }
    return arrow.table(columns).replace_schema_metadata(about)
