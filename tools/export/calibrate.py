"""What quantising must know of a network's activations, measured on views of training people.

Only this part of the export needs JAX: what the network reads of the views is made by training's
own text.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from data.mocap import load_motion
from export.kinds import Kind
from export.layers import ExportError, Layer, digest
from export.quantise import (
    DENSE,
    METRE,
    WEIGHT_TYPES,
    Plan,
    equalised,
    largest_scales,
    quantise,
    rows_of,
    run,
)
from export.rounding import compensated, to_text
from export.settings import ModelSettings
from export.unit_order import orders_of
from model import constants
from training.recipe import Recipe
from training.views import Views, draw_2d, pick_poses

try:
    import jax

    from model import jax_stages, lifter
except ImportError:  # whoever exports weights of their own may have no JAX
    jax = jax_stages = lifter = None


# How many inputs of layer k, weights [in, out], are of each kind.
Parts = Callable[[int, np.ndarray], Sequence[int]]


def training_views(motions: Sequence[Path], settings: ModelSettings) -> Views:
    """As many views as there are poses, drawn as in training; the same each time."""
    names = Recipe.__dataclass_fields__.keys() & settings.recipe.keys()
    known = Recipe(**{name: settings.recipe[name] for name in names})
    rng = np.random.default_rng([settings.recipe.get("seed", 0), 1 << 32])
    joints = pick_poses([load_motion(motion) for motion in motions], known, rng)
    return draw_2d(joints, known, rng)


def training_inputs(kind: Kind, motions: Sequence[Path], settings: ModelSettings) -> np.ndarray:
    """What a network reads [F,in] of training views."""
    if jax is None:
        raise ExportError("to calibrate takes JAX: pip install -r tools/requirements.txt")
    views = training_views(motions, settings)
    imputed = settings.missing == "imputed"
    imputation = constants.imputation().astype(np.float32) if imputed else None

    @jax.jit
    def inputs(views: Views) -> Any:
        image = jax_stages.body_frame(views.keypoints, imputation)
        if not kind.of_body:
            return jax_stages.edm_2d(image, imputed)
        return jax.numpy.concatenate(lifter.inputs(kind.model, image, views.up), 1)

    return np.asarray(inputs(views), float)


def activations(
    layers: Sequence[Layer], inputs: np.ndarray, plan: Plan = DENSE
) -> list[np.ndarray]:
    """What goes into each layer, and the outputs: the float network on what it reads [F,in]."""

    def activate(k: int, sums: np.ndarray) -> np.ndarray:
        if k < len(layers) - 1:
            return np.maximum(sums, 0)
        return (sums if plan.signed else np.maximum(sums, 0)) / plan.sums

    return plan.forward(layers, inputs, activate)


def rounding_steps(
    layers: Sequence[Layer],
    calibration: Mapping[str, Any],
    values: Sequence[np.ndarray],
    plan: Plan,
    parts: Parts,
) -> str:
    """How the weights of 8 bits are rounded, as text, for what goes into each layer [F,in]."""
    steps = []
    most = np.iinfo(WEIGHT_TYPES["w8"]).max
    for k, rows in enumerate(rows_of(layers, calibration, plan)):
        weight = rows.weight * largest_scales(rows, most)
        ends = np.cumsum(parts(k, rows.weight))[:-1]
        pieces = zip(
            np.split(weight, ends), np.split(values[k] - rows.mean, ends, axis=1), strict=True
        )
        rounded = np.concatenate([compensated(piece, x, most) for piece, x in pieces])
        steps.append(rounded - np.rint(weight))
    return to_text(steps)


def calibrate(
    layers: Sequence[Layer], inputs: np.ndarray, plan: Plan = DENSE, parts: Parts | None = None
) -> dict[str, Any]:
    """What quantising needs to know, and how well it does, on inputs [F,in]: for the manifest.

    parts  Kind.parts: inputs of one kind do not vary along with those of another
    """
    if plan.views is not None and len(inputs) > plan.views:
        inputs = inputs[np.linspace(0, len(inputs) - 1, plan.views).astype(int)]
    exact = activations(layers, inputs, plan)[-1][:, plan.measured]
    values = activations(equalised(layers), inputs, plan)[:-1]
    calibration = {
        "weights": digest(layers),
        "views": len(inputs),
        "largest": [round(plan.largest(x), 4) for x in values[1:]],
        "mean": [plan.mean(k, x).round(4).tolist() for k, x in enumerate(values)],
        "order": orders_of(layers, values),
    }
    if parts is not None and all(x.ndim == 2 for x in values):  # of maps: to the nearest
        calibration["steps"] = {"w8": rounding_steps(layers, calibration, values, plan, parts)}
    errors = {}
    for form in WEIGHT_TYPES:
        network = quantise(layers, calibration, form, plan)
        outputs = run(network, np.rint(inputs * METRE), plan)[:, plan.measured] / METRE
        error = np.sqrt(np.mean((outputs - exact) ** 2))
        percent = 100 * error / np.sqrt(np.mean(exact**2))
        errors[form] = {"mm": round(float(1000 * error), 3), "percent": round(float(percent), 3)}
    return calibration | {"rms": errors}
