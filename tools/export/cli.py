"""Turns trained weights into a C header for gen/: one model, constant data in flash.

    export_weights.py gen/fconn.npz
    export_weights.py gen/fconn.npz --quantise q15
    export_weights.py gen/fconv.npz --quantise q7
    export_weights.py theirs.onnx --manifest theirs.json --name theirs --out gen/theirs_f32.h

Reads every format of tools/weights.py, and an .npz of tools/fconv_weights.py.  What a model needs
beside its layers comes from the manifest, the JSON file beside the weights; without `blend`
in it, poses are not moved to the image.  The same layers and settings give the same header,
whatever file they came from.

`--quantise` needs to know what the hidden layers reach: `--calibrate MOTION` measures it once, on
views of the training people (an .npz or a folder that tools/mocap.py reads), and notes it in the
manifest.  It also notes how far the quantised networks then are from the float one.
"""

import argparse
import contextlib
import dataclasses
import json
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from data.paths import GEN
from export import equivariant, fconv, quantise
from export.weights import (
    NO_BLEND,
    PAIRS,
    READERS,
    ExportError,
    Layer,
    check_layers,
    digest,
    load_npz,
    manifest_text,
    one_line,
    read_file,
    read_layers,
    read_npz,
)

# What lib/model.h fixes; the header refuses to compile with another format.
FORMAT = 5
ROWS = 8  # EDML_ROWS

NAMES = {"twin": "fconn"}  # of models, where they are not their kind's
OBJECTIVES = ("none", "square", "raw", "eq2")  # edml_objective: EDML_STRESS_NONE ...


# ---- Kinds of networks -------------------------------------------------------------------------


def dense_text(layers: Iterable[Layer]) -> str:
    return "-".join(map(str, [PAIRS, *(len(layer.bias) for layer in layers)]))


def fconv_text(layers: Sequence[Layer]) -> str:
    both = zip(fconv.NAMES, layers, strict=True)
    return ", ".join(f"{name} {len(layer.bias)}" for name, layer in both)


@dataclasses.dataclass(frozen=True)
class Kind:
    """What differs between an FConn and an FConv; each has a list of layers."""

    name: str  # lib/NAME.inc
    forms: tuple[str, ...]  # that it has a kernel for
    shape: Callable[[Sequence[Layer]], str]  # as a text
    multiply_adds: Callable[[Sequence[Layer]], int]
    plan: quantise.Plan
    # Its layers in float32, if the kernel can run them; else ExportError.
    checked: Callable[[Iterable[tuple[Any, Any]]], list[Layer]]
    # Weights [in, out] of layer k, their inputs as the kernel has them.
    order: Callable[[int, np.ndarray], np.ndarray] = lambda k, weight: weight
    # The exponent of a unit in which weights are short texts, or None.
    unit: Callable[[np.ndarray], int | None] = lambda weight: None


FCONN = Kind(
    "fconn", ("f32", "q15", "q7"), dense_text, lambda layers: sum(x.weight.size for x in layers),
    quantise.DENSE, check_layers,
)  # fmt: skip
TWIN = Kind(
    "twin", FCONN.forms, equivariant.shape, equivariant.multiply_adds,
    equivariant.PLAN, equivariant.checked,
)  # fmt: skip
FCONV = Kind(
    "fconv", ("f32", "q7"), fconv_text, fconv.multiply_adds, fconv.PLAN, list,
    fconv.as_c_has_it, fconv.unit_of,
)  # fmt: skip


def read_network(path: Path) -> tuple[Kind, list[Layer]]:
    """The layers in a file of weights, and what kind of network they make."""
    if path.suffix.lower() == ".npz":
        arrays = read_file(path, {".npz": load_npz})
        if fconv.is_fconv(arrays):
            return FCONV, fconv.layers_of(arrays)
        if equivariant.is_twin(arrays):
            return TWIN, equivariant.checked(read_npz(path))
    return FCONN, read_layers(path)


# ---- Settings ----------------------------------------------------------------------------------


# What a model holds of joints that are not seen: how to guess them, or nothing: their pairs are 0.
MISSING = {"zero": "NULL", "completed": "&edml_usual_completion"}
MOST_GUESSED = 9  # of lib/complete.inc


BLEND_RANGES = "share 0 to 1, misfit 0.01 to 1 and distance 3 to 1000"


def is_blend(value: object) -> bool:
    """Are these numbers of lib/blend.inc?  Beyond the ranges fixed point might overflow."""
    if not (isinstance(value, Mapping) and set(value) == set(NO_BLEND)):
        return False
    if not all(map(is_real, value.values())):
        return False
    share, misfit, distance = (value[name] for name in NO_BLEND)
    return 0 <= share <= 1 and 0.01 <= misfit <= 1 and 3 <= distance <= 1000


@dataclasses.dataclass(frozen=True)
class Settings:
    """What belongs to a model beside its layers.  Raises ExportError where a value cannot be."""

    fewest_joints: int  # seen joints below which edml_lift refuses
    widest: float  # largest width over height in training
    objective: str  # of the refinement, one of OBJECTIVES
    refine_steps: int
    mirror: Sequence[float]  # weights of arms, forearms, head, thighs, shins
    missing: str = "zero"  # what joints that are not seen are, one of MISSING
    blend: Mapping[str, float] = dataclasses.field(default_factory=lambda: dict(NO_BLEND))
    recipe: Mapping[str, Any] = dataclasses.field(default_factory=dict)  # at least name and seed
    data: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    metrics: Mapping[str, float] = dataclasses.field(default_factory=dict)  # column -> mm
    metrics_q15: Mapping[str, float] = dataclasses.field(default_factory=dict)
    metrics_q7: Mapping[str, float] = dataclasses.field(default_factory=dict)
    calibration: Mapping[str, Any] = dataclasses.field(default_factory=dict)  # quantise.calibrate()

    def __post_init__(self) -> None:
        # Four joints are what turning a pose to the camera takes; the others are uint8_t.
        check_setting("fewest_joints", is_whole(self.fewest_joints, 4, 14), "4 to 14")
        widest = is_number(self.widest) and np.float32(self.widest) > 0
        check_setting("widest", widest, "over 0 and below 128")
        check_setting("objective", self.objective in OBJECTIVES, f"one of {', '.join(OBJECTIVES)}")
        check_setting("refine_steps", is_whole(self.refine_steps, 0, 255), "0 to 255")
        mirror = isinstance(self.mirror, list | tuple) and len(self.mirror) == 5
        mirror = mirror and all(map(is_number, self.mirror))
        check_setting("mirror", mirror, "five numbers between -128 and 128")
        check_setting("missing", self.missing in MISSING, f"one of {', '.join(MISSING)}")
        fewest = 4 if self.missing == "zero" else 14 - MOST_GUESSED
        check_setting("fewest_joints", self.fewest_joints >= fewest, f"{fewest} or more")
        check_setting("blend", is_blend(self.blend), BLEND_RANGES)
        for name in ("recipe", "data", "calibration", *METRICS.values()):
            check_setting(name, isinstance(getattr(self, name), Mapping), "an object")
        for name in METRICS.values():
            numbers = all(map(is_real, getattr(self, name).values()))
            check_setting(name, numbers, "numbers by column")

    def errors(self, form: str) -> Mapping[str, float]:
        """Error of the whole lift on the test people, column -> mm; empty if not measured."""
        return getattr(self, METRICS[form])


# Formats of numbers, and where the manifest has their errors.
METRICS = {"f32": "metrics", "q15": "metrics_q15", "q7": "metrics_q7"}


REQUIRED = tuple(
    field.name
    for field in dataclasses.fields(Settings)
    if field.default is field.default_factory is dataclasses.MISSING
)


def check_setting(name: str, good: bool, want: str) -> None:
    if not good:
        raise ExportError(f"manifest: {name} must be {want}")


def is_whole(value: object, low: int, high: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def is_real(value: object) -> bool:
    """A number that a float can hold."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and abs(value) <= float(np.finfo(np.float32).max)


def is_number(value: object) -> bool:
    """A number that an edml_number can hold, in Q24 too."""
    return is_real(value) and abs(value) < 128


def read_settings(path: Path) -> Settings:
    """The settings in a manifest; keys that Settings does not know are left to others."""
    try:
        manifest = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        keys = ", ".join(REQUIRED)
        raise ExportError(
            f"no manifest {path.name}: write one with {keys}, or name another by --manifest"
        ) from None
    except (OSError, ValueError) as error:
        raise ExportError(f"manifest {path.name}: {one_line(error)}") from error
    if not isinstance(manifest, dict):
        raise ExportError(f"manifest {path.name} is not a JSON object")
    if missing := [name for name in REQUIRED if name not in manifest]:
        raise ExportError(f"manifest {path.name} lacks {', '.join(missing)}")
    known = {field.name for field in dataclasses.fields(Settings)}
    return Settings(**{name: value for name, value in manifest.items() if name in known})


# ---- What flash holds --------------------------------------------------------------------------


class Packed(NamedTuple):
    """A layer as lib/model.h lays it out; outputs are filled up to whole groups."""

    inputs: int
    outputs: int
    arrays: dict[str, np.ndarray]  # weight [groups, inputs, ROWS]; bias, factor [groups * ROWS]
    numbers: tuple[int, ...] = ()  # what follows the arrays


def groups_of(outputs: int) -> int:
    return -(-outputs // ROWS)


def pack(layer: Layer | quantise.Dense, weight: np.ndarray) -> Packed:
    """The layer with its weights [in, out] in the kernel's order."""
    inputs, outputs = weight.shape
    padding = groups_of(outputs) * ROWS - outputs
    weight = np.pad(weight, ((0, 0), (0, padding)))
    weight = np.ascontiguousarray(weight.reshape(inputs, -1, ROWS).transpose(1, 0, 2))
    arrays = {"weight": weight, "bias": np.pad(layer.bias, (0, padding))}
    if isinstance(layer, Layer):
        return Packed(inputs, outputs, arrays)
    arrays["factor"] = np.pad(layer.factor, (0, padding), constant_values=1)
    return Packed(inputs, outputs, arrays, (layer.shift, layer.most))


def fnv1a(packed: Iterable[Packed]) -> int:
    """FNV-1a over the bytes of each layer's arrays, little-endian."""
    value = 2166136261
    for layer in packed:
        for array in layer.arrays.values():
            for byte in array.astype(array.dtype.newbyteorder("<")).tobytes():
                value = (value ^ byte) * 16777619 & 0xFFFFFFFF
    return value


# ---- What is said of a quantised network -------------------------------------------------------


def quantised(
    kind: Kind, layers: Sequence[Layer], settings: Settings, form: str
) -> tuple[list[quantise.Dense], dict[str, str]]:
    """The network in whole numbers, and what the header says of it: title -> text."""
    if form not in kind.forms:
        raise ExportError(f"an {kind.name} is quantised as {', '.join(kind.forms[1:])} only")
    calibration = settings.calibration
    if not calibration:
        raise ExportError("manifest: no calibration; run once with --calibrate TRAIN.npz")
    if calibration.get("weights") != digest(layers):
        raise ExportError("manifest: the calibration is of other weights; run with --calibrate")
    if settings.widest > quantise.WIDEST:
        raise ExportError(f"manifest: widest must be up to {quantise.WIDEST} to quantise")
    try:
        network = quantise.quantise(layers, calibration, form, kind.plan)
        return network, quantised_lines(network, calibration, form, kind.plan)
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        raise ExportError(f"manifest: damaged calibration: {one_line(error)}") from error


def quantised_lines(
    network: Sequence[quantise.Dense],
    calibration: Mapping[str, Any],
    form: str,
    plan: quantise.Plan,
) -> dict[str, str]:
    rms = calibration["rms"][form]
    bits = ", ".join("{} to {}".format(*quantise.weight_bits(dense)) for dense in network)
    return {
        "quantiser": f"{form}: whole numbers, a scale a row",
        "bits": f"of the rows' weights, layer by layer: {bits}",
        "accumulator": f"proven within 32 bits, {quantise.spare_bits(network, plan):.1f} to spare",
        "RMS error": f"{rms['mm']:g} mm, {rms['percent']:g} %: its distances against float's, "
        f"{calibration['views']} training views",
    }


def loss_text(settings: Settings, form: str) -> str:
    """What quantising adds to the error in each column."""
    base, errors = settings.errors("f32"), settings.errors(form)
    both = [column for column in errors if column in base]
    return ", ".join(f"{c} {errors[c] - base[c]:+.1f}" for c in both) or "not measured"


# ---- The header --------------------------------------------------------------------------------


def write_header(
    layers: Iterable[tuple[Any, Any]],
    settings: Settings,
    name: str,
    source_name: str,
    path: Path,
    form: str = "f32",
    kind: Kind = FCONN,
) -> str:
    """Writes the header of model edml_NAME_FORM and returns a line that sums it up.

    layers       (weight [in, out], bias [out]), floating point; of an FConv as layers_of() has them
    source_name  the file that the layers came from
    form         "f32", "q15" or "q7"
    Raises ExportError, and then leaves what was at `path` as it was.
    """
    layers = kind.checked(layers)
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise ExportError(f"name '{name}' must be lower-case letters, digits, single underscores")
    model = f"{name}_{form}"
    if form == "f32":
        network, lines = layers, {"quantiser": "none (float32)"}
    else:
        network, lines = quantised(kind, layers, settings, form)
    packed = [pack(layer, kind.order(k, layer.weight)) for k, layer in enumerate(network)]
    checksum = fnv1a(packed)
    parts = [
        comment_text(kind, layers, settings, model, source_name, form, lines),
        GUARD,
        *(layer_text(layer, model, k, kind.unit) for k, layer in enumerate(packed)),
        table_text(packed, model, form),
        model_text(kind, settings, model, form, checksum, len(packed)),
    ]
    replace_file(path, "\n".join(parts))
    flash = sum(array.nbytes for layer in packed for array in layer.arrays.values())
    said = "".join(f"\n  {title}: {text}" for title, text in lines.items() if form != "f32")
    return (
        f"edml_{model}: {kind.shape(layers)}, {parameter_count(layers)} parameters, "
        f"{flash} bytes of flash, checksum 0x{checksum:08x}: {path}{said}"
    )


GUARD = f"""\
#if EDML_WEIGHTS_FORMAT != {FORMAT}
#error "regenerate with tools/export_weights.py"
#endif
"""


def comment_text(
    kind: Kind,
    layers: Sequence[Layer],
    settings: Settings,
    model: str,
    source_name: str,
    form: str,
    quantiser: Mapping[str, str],
) -> str:
    """What opens the header.  No date, no path: the same weights give the same text."""
    recipe = settings.recipe
    errors = ", ".join(f"{column} {error:g}" for column, error in settings.errors(form).items())
    lines = {
        "layers": f"{kind.shape(layers)}, relu after each",
        "weights": f"sha256 {digest(layers)}",
        "parameters": f"{parameter_count(layers)}, {kind.multiply_adds(layers)} multiply-adds",
        **quantiser,
        "error, mm": errors or "not measured",
        **({} if form == "f32" else {"loss, mm": loss_text(settings, form)}),
        "training": f"recipe {recipe.get('name', '?')}, seed {recipe.get('seed', '?')}",
    }
    table = "".join(f" * {title:<12}{in_comment(text)}\n" for title, text in lines.items())
    return (
        f"/* edml_{model}: a trained network.  Do not edit.\n"
        f" * Generated by tools/export_weights.py from {in_comment(source_name)}\n"
        f" *\n{table} */\n"
    )


def in_comment(text: str) -> str:
    """Text from outside as one line that can neither end nor open a comment."""
    text = text.encode("ascii", "replace").decode()
    text = "".join(c if c.isprintable() else "?" for c in text)
    return text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")


def parameter_count(layers: Iterable[Layer]) -> int:
    return sum(array.size for layer in layers for array in layer)


def layer_text(
    layer: Packed, model: str, number: int, unit_of: Callable[[np.ndarray], int | None]
) -> str:
    """The arrays of a layer, weights first."""
    groups = groups_of(layer.outputs)
    sizes = {"weight": f"{groups} * {layer.inputs} * {ROWS}"}
    text = ""
    for name, array in layer.arrays.items():
        size = sizes.get(name, f"{groups} * {ROWS}")
        unit = unit_of(array) if name == "weight" and array.dtype.kind == "f" else None
        text += array_text(f"{model}_{name}{number}", size, array, unit)
    return text


def array_text(name: str, size: str, values: np.ndarray, unit: int | None = None) -> str:
    """ROWS values a line: of weights, those of one input.  With a unit, floats are whole multiples
    of 2^unit, and a macro takes the place of the comma: half the text of hexadecimal floats."""
    kind, text = ("float", hex_float) if values.dtype.kind == "f" else (f"{values.dtype}_t", str)
    if values.dtype.itemsize < 4:
        kind += " EDML_IN_WORDS"
    before, after, comma = "", "", ", "
    if unit is not None:
        values, text, comma = np.rint(values / 2.0**unit).astype(int), str, " U "
        before, after = f"#define U * 0x1p{unit}F,\n", "#undef U\n"
    lines = (comma.join(map(text, row)) + comma[:-1] for row in values.reshape(-1, ROWS).tolist())
    body = "".join(f"    {line}\n" for line in lines)
    return f"{before}static const {kind} {name}[{size}] = {{\n{body}}};\n{after}"


def hex_float(value: float) -> str:
    """A float32 as the shortest exact C99 constant: 0x1.8p-3F; zero as 0."""
    if value == 0:
        # The checksum tells negative zero from zero.
        return "-0x0p0F" if np.signbit(value) else "0"
    mantissa, exponent = float(value).hex().split("p")
    return f"{mantissa.rstrip('0').rstrip('.')}p{int(exponent)}F"


def table_text(packed: Sequence[Packed], model: str, form: str) -> str:
    rows = ""
    for k, layer in enumerate(packed):
        names = [f"{model}_{name}{k}" for name in layer.arrays]
        members = [layer.inputs, layer.outputs, *names, *layer.numbers]
        rows += f"    {{{', '.join(map(str, members))}}},\n"
    return f"static const edml_dense_{form} {model}_layers[] = {{\n{rows}}};\n"


def network_text(kind: Kind, model: str, form: str, count: int) -> tuple[str, list[str]]:
    """What stands before the model, and its members predict_f32 to layer_count."""
    kernel, hash_name = f"edml__{kind.name}_{form}", f"edml__{kind.name}_hash_{form}"
    kernels = [kernel, "NULL"] if form == "f32" else ["NULL", kernel]
    if kind is not FCONV:
        return "", [*kernels, hash_name, f"{model}_layers", f"{count}, /* layers */"]
    net = f"static const edml_fconv {model}_net = {{{', '.join(kernels)}, {model}_layers}};\n"
    refused = ["edml__fconv_refuse", "NULL"]
    return net, [*refused, hash_name, f"&{model}_net", "0, /* layers of edml_lift() */"]


def model_text(
    kind: Kind, settings: Settings, model: str, form: str, checksum: int, count: int
) -> str:
    """The model itself.  By position, for C++ has no designated initialisers before 2020; and
    declared first, for C++ would keep a constant to its file."""
    mirror = ", ".join(map(number_text, settings.mirror))
    share, misfit, distance = (settings.blend[name] for name in NO_BLEND)
    blend = ", ".join(map(number_text, (share * misfit**2, misfit**2, 1 / distance)))
    before, members = network_text(kind, model, form, count)
    network = ",\n    ".join(members)
    return f"""\
{before}extern const edml_model edml_{model};
const edml_model edml_{model} = {{
    "{model}",
    0x{checksum:08x}u, /* checksum */
    {network}
    {settings.fewest_joints}, /* fewest joints */
    {number_text(settings.widest)}, /* widest: {settings.widest:g} */
    {MISSING[settings.missing]}, /* joints that are not seen */
    EDML_STRESS_{settings.objective.upper()},
    {settings.refine_steps}, /* refinement steps */
    {{{mirror}}}, /* mirror */
    {{{blend}}}, /* blend: {share:g} of {misfit:g} m, at {distance:g} m */
}};
"""


def number_text(value: float) -> str:
    """An edml_number: in float32 and in Q24, in whose range the value must be."""
    return f"{{{hex_float(float(np.float32(value)))}, {round(value * (1 << 24))}}}"


def replace_file(path: Path, text: str) -> None:
    """Writes the file whole or not at all."""
    scratch = path.with_name(path.name + ".tmp")
    try:
        scratch.write_text(text, "ascii", newline="\n")
        os.replace(scratch, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            scratch.unlink()
        raise ExportError(f"cannot write {path}: {error.strerror}") from error


# ---- Command line ------------------------------------------------------------------------------


def calibrate(kind: Kind, layers: Sequence[Layer], manifest: Path, motion: Path) -> str:
    """Notes in the manifest what quantising needs, and returns a line that says it."""
    from data.mocap import MocapError

    settings = read_settings(manifest)
    try:
        edms = quantise.training_edms(motion, settings.recipe)
    except (MocapError, OSError, TypeError, ValueError) as error:
        raise ExportError(f"{motion}: {one_line(error)}") from error
    noted = quantise.calibrate(layers, edms, kind.plan)
    known = json.loads(manifest.read_text("utf-8"))
    replace_file(manifest, manifest_text(known | {"calibration": noted}))
    return f"{manifest}: hidden layers reach {noted['largest']} on {noted['views']} training views"


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit status 0, or 1 with one line on stderr."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("weights", type=Path, help=" ".join(READERS))
    parser.add_argument("--name", help="the model is edml_NAME_f32 (fconn or fconv)")
    parser.add_argument("--out", type=Path, help="header to write (gen/NAME_f32.h)")
    parser.add_argument("--manifest", type=Path, help="settings (WEIGHTS with suffix .json)")
    parser.add_argument(
        "--quantise", choices=quantise.WEIGHT_TYPES, help="edml_NAME_q15 or _q7, whole numbers"
    )
    parser.add_argument("--calibrate", type=Path, metavar="MOTION", help="before that")
    options = parser.parse_args(arguments)
    weights, form = options.weights, options.quantise or "f32"
    manifest = options.manifest or weights.with_suffix(".json")
    try:
        kind, layers = read_network(weights)
        name = options.name or NAMES.get(kind.name, kind.name)
        if options.calibrate:
            print(calibrate(kind, layers, manifest, options.calibrate))
        settings = read_settings(manifest)
        out = options.out or GEN / f"{name}_{form}.h"
        print(write_header(layers, settings, name, weights.name, out, form, kind))
    except ExportError as error:
        print(f"export_weights: {weights}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
