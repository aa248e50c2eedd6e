"""Packages that only some files need: they are imported when one of these is written."""

import importlib
from typing import Any


def need(package: str, suffix: str) -> Any:
    """A package, or an ImportError that says how to get it."""
    try:
        return importlib.import_module(package)
    except ImportError:
        name = package.partition(".")[0]
        raise ImportError(
            f'a {suffix} file needs the package {name}: pip install "edmlift[files]"'
        ) from None
