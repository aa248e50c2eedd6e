"""The version, which include/edmlift.h has; each manifest repeats it or reads it there."""

import re

from data.paths import ROOT


def version() -> str:
    """Such as "1.0.0"."""
    header = (ROOT / "include" / "edmlift.h").read_text("utf-8")
    found = re.search(r'define EDML_VERSION_STRING "([^"]+)"', header)
    if found is None:
        raise ValueError("include/edmlift.h has no EDML_VERSION_STRING")
    return found[1]
