"""One version: include/edmlift.h has it, and each manifest that cannot read it there repeats it."""

import json
import re
from collections.abc import Callable

import pytest
from support import ROOT

from channels.version import version


def line(pattern: str) -> Callable[[str], str]:
    """A reader of a manifest: the version is what the group of this pattern finds."""
    return lambda text: re.search(pattern, text, re.MULTILINE)[1]


MANIFESTS = {
    "CITATION.cff": line(r"^version: (\S+)$"),
    "idf_component.yml": line(r'^version: "([^"]+)"$'),
    "library.json": lambda text: json.loads(text)["version"],
    "library.properties": line(r"^version=(\S+)$"),
    "tools/npm/package.json": line(r'^  "version": "([^"]+)",$'),
    "tools/npm/index.js": line(r'^const VERSION = "([^"]+)";$'),
}


@pytest.mark.parametrize("name", MANIFESTS)
def test_the_manifest_has_the_version_of_the_header(name: str):
    assert MANIFESTS[name]((ROOT / name).read_text("utf-8")) == version()


def test_the_header_has_it_as_a_number_as_well():
    header = (ROOT / "include" / "edmlift.h").read_text("utf-8")
    major, minor, patch = map(int, version().split("."))
    number = line(r"define EDML_VERSION (0x\d+)")(header)
    assert int(number, 16) == major << 16 | minor << 8 | patch
