"""Manifests: the JSON file beside the weights of a model, gen/fconn.json beside gen/fconn.npz."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from data.paths import GEN

# What a manifest says of lib's fuse stage where it is to leave poses alone: share of
# the image, metres.
NO_FUSION = {"share": 0.0, "misfit": 1.0, "distance": 1000.0}
NEAREST = 3.0  # m: the least distance for which lib/lift/fuse.h cannot overflow


def read_manifest(model: str) -> dict[str, Any]:
    """The manifest of a model of gen/, such as "fconn"; OSError or ValueError if there is none."""
    return json.loads((GEN / f"{model}.json").read_text("utf-8"))


def manifest_text(manifest: Mapping[str, Any]) -> str:
    """JSON with each list of numbers on one line, because some are as long as a layer is wide."""
    numbers = re.compile(r"\[([-+.\deE,\s]+)\]")
    text = json.dumps(manifest, indent=2)
    return numbers.sub(lambda match: f"[{' '.join(match[1].split())}]", text) + "\n"


def write_manifest(path: Path, manifest: Mapping[str, Any]) -> None:
    """Writes a manifest, or another file of figures, in that form; makes its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(manifest_text(manifest), "utf-8")
