"""Which files are tables of rows, a person each."""

from pathlib import Path

TABLE_SUFFIXES = (".parquet", ".arrow", ".feather")


def is_table(path: str | Path) -> bool:
    """Is this a table, or a folder of them?"""
    return Path(path).suffix.lower() in TABLE_SUFFIXES or bool(table_files(path))


def table_files(path: str | Path) -> list[Path]:
    """A table, or those of a folder and its folders in the order of their names; without what Spark
    and others hide by a dot or an underline."""
    path = Path(path)
    if not path.is_dir():
        return [path] if path.suffix.lower() in TABLE_SUFFIXES else []
    below = (file.relative_to(path) for file in path.rglob("*") if file.is_file())
    return sorted(
        path / file
        for file in below
        if file.suffix.lower() in TABLE_SUFFIXES and not any(p[0] in "._" for p in file.parts)
    )
