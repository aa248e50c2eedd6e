"""Packages that only some uses need: they are imported then."""

import importlib
from typing import Any


def need(package: str, what: str, extra: str = "files") -> Any:
    """A package, or an ImportError that says what needs it, and how to get it."""
    try:
        return importlib.import_module(package)
    except ImportError:
        name = package.partition(".")[0]
        raise ImportError(
            f'{what} needs the package {name}: pip install "edmlift[{extra}]"'
        ) from None
