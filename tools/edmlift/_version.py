"""The version: of the installed package, or of a working copy's include/edmlift.h."""

import re
from importlib import metadata
from pathlib import Path

_HEADER = Path(__file__).resolve().parents[2] / "include" / "edmlift.h"


def _version() -> str:
    if _HEADER.exists():  # a working copy, whatever else may be installed
        found = re.search(r'EDML_VERSION_STRING "(.+?)"', _HEADER.read_text("utf-8"))
        if found:
            return found[1]
    return metadata.version("edmlift")


__version__ = _version()
