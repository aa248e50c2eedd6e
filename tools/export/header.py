"""A C header of one model for gen/: constant data in flash, and a comment that says what it is."""

import contextlib
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from data.archives import one_line
from export import quantise
from export.kinds import FCONN, Kind
from export.layers import ExportError, Layer, digest
from export.packing import Packed, fnv1a, groups_of, pack
from export.settings import MISSING, ModelSettings
from model.constants import CHUNK, GROUP, WEIGHTS_FORMAT
from model.manifest import NO_FUSION

# ---- What is said of a quantised network -------------------------------------------------------


def quantised(
    kind: Kind, layers: Sequence[Layer], settings: ModelSettings, form: str
) -> tuple[list[quantise.Dense], dict[str, str]]:
    """The network in integers, and what the header says of it: title -> text."""
    if form not in kind.forms:
        raise ExportError(f"an {kind.model} is quantised as {', '.join(kind.forms[1:])} only")
    calibration = settings.calibration
    if not calibration:
        raise ExportError("manifest: no calibration; run once with --calibrate TRAIN.npz")
    if calibration.get("weights") != digest(layers):
        raise ExportError("manifest: the calibration is of other weights; run with --calibrate")
    try:
        network = quantise.quantise(layers, calibration, form, kind.plan)
        return network, quantised_lines(network, calibration, form, kind.plan)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise ExportError(f"manifest: damaged calibration: {one_line(error)}") from error


def quantised_lines(
    network: Sequence[quantise.Dense],
    calibration: Mapping[str, Any],
    form: str,
    plan: quantise.Plan,
) -> dict[str, str]:
    """What the comment says of a quantised network: title -> text."""
    rms = calibration["rms"][form]
    bits = ", ".join("{} to {}".format(*quantise.weight_bits(dense)) for dense in network)
    return {
        "quantiser": f"{form}: integers, a scale a row",
        "bits": f"of the rows' weights, layer by layer: {bits}",
        "accumulator": f"proven within 32 bits, {quantise.spare_bits(network, plan):.1f} to spare",
        "RMS error": f"{rms['mm']:g} mm, {rms['percent']:g} %: its outputs against float's, "
        f"{calibration['views']} training views",
    }


def loss_text(settings: ModelSettings, form: str) -> str:
    """What quantising adds to the error in each column."""
    base, errors = settings.errors("f32"), settings.errors(form)
    both = [column for column in errors if column in base]
    return ", ".join(f"{c} {errors[c] - base[c]:+.1f}" for c in both) or "not measured"


# ---- The header --------------------------------------------------------------------------------


def write_header(
    layers: Iterable[tuple[Any, Any]],
    settings: ModelSettings,
    name: str,
    source_name: str,
    path: Path,
    form: str = "f32",
    kind: Kind = FCONN,
) -> str:
    """Writes the header of model edml_NAME_FORM and returns a line that sums it up.

    layers       (weight [in, out], bias [out]), floating point; of an FConv as layers_of() has them
    source_name  the file that the layers came from
    form         "f32", "w16" or "w8"
    Raises ExportError, and then leaves what was at `path` as it was.
    """
    layers = kind.checked(layers)
    if settings.objective != "none" and not kind.alone:
        raise ExportError("manifest: objective must be none where a network gives points as well")
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise ExportError(f"name '{name}' must be lower-case letters, digits, single underscores")
    model = f"{name}_{form}"
    network: Sequence[Layer] | Sequence[quantise.Dense]
    if form == "f32":
        network, lines = layers, {"quantiser": "none (float32)"}
    else:
        network, lines = quantised(kind, layers, settings, form)
    packed = [pack_layer(kind, k, layer) for k, layer in enumerate(network)]
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


def pack_layer(kind: Kind, k: int, layer: Layer | quantise.Dense) -> Packed:
    """Layer k as the kernel of its kind reads it."""
    parts = kind.parts(k, layer.weight) if kind.parts else None
    return pack(layer, kind.order(k, layer.weight), parts)


GUARD = f"""\
#if EDML_WEIGHTS_FORMAT != {WEIGHTS_FORMAT}
#error "regenerate with tools/export_weights.py"
#endif
"""


def comment_text(
    kind: Kind,
    layers: Sequence[Layer],
    settings: ModelSettings,
    model: str,
    source_name: str,
    form: str,
    quantiser: Mapping[str, str],
) -> str:
    """What opens the header.  No date, no path: the same weights give the same text."""
    recipe = settings.recipe
    errors = ", ".join(f"{column} {error:g}" for column, error in settings.errors(form).items())
    lines = {
        "layers": f"{kind.shape(layers)}, relu after each{' but the last' * kind.plan.signed}",
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
    """Weights and biases."""
    return sum(array.size for layer in layers for array in layer)


def layer_text(
    layer: Packed, model: str, number: int, unit_of: Callable[[np.ndarray], int | None]
) -> str:
    """The arrays of a layer, weights first."""
    groups = groups_of(layer.outputs)
    sizes = {"weight": f"{groups} * {layer.inputs} * {GROUP}"}
    text = ""
    for name, array in layer.arrays.items():
        size = sizes.get(name, f"{groups} * {GROUP}")
        unit = unit_of(array) if name == "weight" and array.dtype.kind == "f" else None
        block = GROUP * CHUNK if name == "weight" and layer.in_blocks else None
        text += array_text(f"{model}_{name}{number}", size, array, unit, block)
    return text


def array_text(
    name: str, size: str, values: np.ndarray, unit: int | None = None, block: int | None = None
) -> str:
    """GROUP values a line: of weights, those of one input.  With a unit, floats are integers times
    2^unit, and a macro takes the place of the comma: half the text of hexadecimal floats.  A macro
    puts each `block` of values in the order of the processor."""
    kind, text = ("float", hex_float) if values.dtype.kind == "f" else (f"{values.dtype}_t", str)
    if values.dtype.itemsize < 4:
        kind += " EDML_ALIGN4"
    before, after, comma = "", "", ", "
    if unit is not None:
        values, text, comma = np.rint(values / 2.0**unit).astype(int), str, " U "
        before, after = f"#define U * 0x1p{unit}F,\n", "#undef U\n"
    rows = [comma.join(map(text, row)) + comma[:-1] for row in values.reshape(-1, GROUP).tolist()]
    if block is not None:
        count = block // GROUP
        macro = "EDML_BYTES_BLOCK" if values.dtype.itemsize == 1 else "EDML_BLOCK"
        for at in range(0, len(rows), count):
            rows[at] = f"{macro}({rows[at]}"
            rows[at + count - 1] = f"{rows[at + count - 1][:-1]}),"
    body = "".join(f"    {row}\n" for row in rows)
    return f"{before}static const {kind} {name}[{size}] = {{\n{body}}};\n{after}"


def hex_float(value: float) -> str:
    """A float32 as the shortest exact C99 constant: 0x1.8p-3F; zero as 0."""
    if value == 0:
        # The checksum tells negative zero from zero.
        return "-0x0p0F" if np.signbit(value) else "0"
    mantissa, exponent = float(value).hex().split("p")
    return f"{mantissa.rstrip('0').rstrip('.')}p{int(exponent)}F"


def table_text(packed: Sequence[Packed], model: str, form: str) -> str:
    """The table of the layers."""
    rows = ""
    for k, layer in enumerate(packed):
        names = [f"{model}_{name}{k}" for name in layer.arrays]
        members = [layer.inputs, layer.outputs, *names, *layer.numbers]
        rows += f"    {{{', '.join(map(str, members))}}},\n"
    return f"static const edml_dense_{form} {model}_layers[] = {{\n{rows}}};\n"


def model_text(
    kind: Kind, settings: ModelSettings, model: str, form: str, checksum: int, count: int
) -> str:
    """The model itself.  By position, because C++ has no designated initialisers before 2020; and
    declared first, because C++ would keep a constant to its file."""
    kernel = f"edml__{kind.name}_{form}"
    of_float, scale = form == "f32", kind.scale
    mirror = ", ".join(map(number_text, settings.mirror))
    share, misfit, distance = (settings.fusion[name] for name in NO_FUSION)
    fusion = ", ".join(map(number_text, (share, misfit**2, 1 / distance)))
    return f"""\
EDML_KERNEL({kind.name}, {form});
extern const edml_model edml_{model};
const edml_model edml_{model} = {{
    "{model}",
    0x{checksum:08x}u, /* checksum */
    {kernel if of_float else "NULL"},
    {"NULL" if of_float else kernel},
    edml__{kind.name}_checksum_{form},
    {model}_layers,
    {count}, /* layers */
    {flags_text("EDML_READS_", kind.reads)},
    {flags_text("EDML_GIVES_", kind.gives)},
    {kind.inputs}, /* inputs */
    {kind.even_inputs}, /* even ones */
    {kind.outputs}, /* outputs */
    {settings.fewest_joints}, /* fewest joints */
    sizeof({kind.work}),
    {"0" if of_float else f"sizeof({kind.work}_q)"},
    {MISSING[settings.missing]},
    {scale or "NULL"},
    {f"{scale}_q" if scale and not of_float else "NULL"},
    EDML_STRESS_{settings.objective.upper()},
    {settings.refine_steps}, /* refinement steps */
    {{{mirror}}}, /* mirror */
    {{{fusion}}}, /* fusion: share {share:g}, misfit {misfit:g} m, distance {distance:g} m */
    {number_text(settings.mds_share)}, /* MDS share: {settings.mds_share:g} */
}};
"""


def flags_text(prefix: str, names: Sequence[str]) -> str:
    """Flags of C, combined."""
    return " | ".join(prefix + name for name in names)


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
