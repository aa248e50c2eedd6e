"""Turns trained weights into a C header for gen/: one model, constant data in flash.

    export_weights.py gen/distances.npz
    export_weights.py gen/direct.npz --quantise w16
    export_weights.py gen/fconv.npz --quantise w8
    export_weights.py theirs.onnx --manifest theirs.json --name theirs --out gen/theirs_f32.h

Reads FConn in every format of tools/export/readers.py, batch normalisation folded into its layers,
and .npz of the other networks.  What a reader takes for granted it says on stderr.  What a model
needs beside its layers comes from the manifest, the JSON file beside the weights; without
`fusion` in it, poses are not moved to the image.  The same layers and settings give the
same header, whatever file they came from.

`--quantise` needs to know what the hidden layers reach: `--calibrate MOTION` measures it once, on
views of the training people (.npz or folders of motion capture, as train.py got them), and notes it
in the manifest.  It also notes how far the quantised networks then are from the float one.
"""

import argparse
import json
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

from data.archives import one_line
from data.paths import GEN
from export.calibrate import calibrate, training_inputs
from export.chain import ExportWarning
from export.header import replace_file, write_header
from export.kinds import Kind, read_network
from export.layers import ExportError, Layer
from export.quantise import WEIGHT_TYPES
from export.readers import READERS
from export.settings import read_settings
from model.manifest import manifest_text


def record_calibration(
    kind: Kind, layers: Sequence[Layer], manifest: Path, motions: Sequence[Path]
) -> str:
    """Notes in the manifest what quantising needs, and returns a line that says it."""
    settings = read_settings(manifest, kind.needs)
    try:
        inputs = training_inputs(kind, motions, settings)
    except (OSError, TypeError, ValueError) as error:
        raise ExportError(f"{', '.join(map(str, motions))}: {one_line(error)}") from error
    noted = calibrate(layers, inputs, kind.plan, kind.parts)
    known = json.loads(manifest.read_text("utf-8"))
    replace_file(manifest, manifest_text(known | {"calibration": noted}))
    return f"{manifest}: hidden layers reach {noted['largest']} on {noted['views']} training views"


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit status 0, or 1 with one line on stderr."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("weights", type=Path, help=" ".join(READERS))
    parser.add_argument("--name", help="the model is edml_NAME_f32 (its kind)")
    parser.add_argument("--out", type=Path, help="header to write (gen/NAME_f32.h)")
    parser.add_argument("--manifest", type=Path, help="settings (WEIGHTS with suffix .json)")
    parser.add_argument(
        "--quantise", choices=WEIGHT_TYPES, help="edml_NAME_w16 or _w8: integers of 16 or 8 bits"
    )
    parser.add_argument("--calibrate", type=Path, nargs="+", metavar="MOTION", help="before that")
    options = parser.parse_args(arguments)
    weights, form = options.weights, options.quantise or "f32"
    manifest = options.manifest or weights.with_suffix(".json")
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", ExportWarning)
            kind, layers = read_network(weights)
        name = options.name or kind.model
        if options.calibrate:
            print(record_calibration(kind, layers, manifest, options.calibrate))
        settings = read_settings(manifest, kind.needs)
        out = options.out or GEN / f"{name}_{form}.h"
        print(write_header(layers, settings, name, weights.name, out, form, kind))
        for warning in caught:
            if issubclass(warning.category, ExportWarning):
                print(f"export_weights: {weights}: {warning.message}", file=sys.stderr)
    except ExportError as error:
        print(f"export_weights: {weights}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
