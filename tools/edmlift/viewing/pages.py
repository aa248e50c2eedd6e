"""The page's text: the files of the folder `page`, joined, and what they show.

The scripts are ES modules, of which tools/page serves some as they are.

What comes from data can be no markup: the title is escaped, and the data are JSON without `<`, `>`
and `&`.  The page's own policy lets no other script or style run, and nothing be fetched.
"""

import base64
import hashlib
import html
import json
import re
from importlib import resources
from string import Template
from typing import Any

from edmlift._version import __version__

# In the order in which they depend on each other.
SCRIPTS = (
    "joints", "recording", "paint", "skeleton", "image", "figure", "turning", "curves", "clock",
    "main",
)  # fmt: skip
STYLES = ("look", "page")


def page_of(title: str, recording: dict[str, Any], photographs: list[dict[str, Any]]) -> str:
    """The HTML of a page."""
    title = title.encode("utf-8", "replace").decode()  # names of files may have half characters
    style = "\n".join(_read(f"{name}.css") for name in STYLES)
    scripts = "\n".join(_joined(_read(f"{name}.js")) for name in SCRIPTS)
    script = f'\n"use strict";\n(() => {{\n{scripts}}})();\n'
    data = {"title": title, "pictures": photographs, **recording}
    return Template(_read("page.html")).substitute(
        title=html.escape(title),
        version=html.escape(__version__),
        policy=_policy(script, style),
        style=style,
        script=script,
        data=_json(data),
    )


def _read(name: str) -> str:
    return (resources.files("edmlift.viewing") / "page" / name).read_text("utf-8")


def _joined(module: str) -> str:
    """A module's text for one script that has all of them: nothing is imported there."""
    return re.sub(r"^export ", "", re.sub(r"^import [^;]*;\n", "", module, flags=re.M), flags=re.M)


def _policy(script: str, style: str) -> str:
    """A content security policy: this script, this style, and pictures within the page."""
    return (
        f"default-src 'none'; script-src {_hash(script)}; style-src {_hash(style)}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
    return f"'sha256-{digest}'"


def _json(data: dict[str, Any]) -> str:
    """JSON that no parser of HTML takes for markup."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)  # ASCII alone
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text
