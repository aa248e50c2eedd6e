"""What quantising must know of a network's activations, measured on views of training people.

Only this part of the export needs JAX: the views become EDMs by training's own text.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from data.mocap import load_motion
from export.layers import ExportError, Layer, digest
from export.quantise import DENSE, METRE, WEIGHT_TYPES, Plan, equalised, quantise, run
from training.recipe import Recipe
from training.views import draw_2d, imputation_of

try:
    import jax.numpy as jnp

    from model import jax_stages
except ImportError:  # whoever exports weights of their own may have no JAX
    jnp = jax_stages = None


def training_edms(motion: Path, recipe: Mapping[str, Any]) -> np.ndarray:
    """EDMs [F,91] of one view of each training pose, drawn as in training; the same each time."""
    if jax_stages is None:
        raise ExportError("to calibrate takes JAX: pip install -r tools/requirements.txt")
    names = Recipe.__dataclass_fields__.keys() & recipe.keys()
    known = Recipe(**{name: recipe[name] for name in names})
    rng = np.random.default_rng([recipe.get("seed", 0), 1 << 32])
    keypoints, _ = draw_2d(load_motion(motion).joints, known, rng)
    return np.asarray(jax_stages.edm_2d(jnp.asarray(keypoints), imputation_of(known)), float)


def activations(layers: Sequence[Layer], edms: np.ndarray, plan: Plan = DENSE) -> list[np.ndarray]:
    """What goes into each layer, and the distances: the float network on EDMs [F,91]."""

    def activate(k: int, sums: np.ndarray) -> np.ndarray:
        return np.maximum(sums, 0) / (1 if k < len(layers) - 1 else plan.sums)

    return plan.forward(layers, plan.first(edms), activate)


def calibrate(layers: Sequence[Layer], edms: np.ndarray, plan: Plan = DENSE) -> dict[str, Any]:
    """What quantising needs to know, and how well it does, on EDMs [F,91]: for the manifest."""
    if plan.views is not None and len(edms) > plan.views:
        edms = edms[np.linspace(0, len(edms) - 1, plan.views).astype(int)]
    exact = activations(layers, edms, plan)[-1]
    inputs = activations(equalised(layers), edms, plan)[:-1]
    calibration = {
        "weights": digest(layers),
        "views": len(edms),
        "largest": [round(plan.largest(x), 4) for x in inputs[1:]],
        "mean": [x.reshape(-1, x.shape[-1]).mean(0).round(4).tolist() for x in inputs],
    }
    errors = {}
    for form in WEIGHT_TYPES:
        network = quantise(layers, calibration, form, plan)
        distances = run(network, np.rint(edms * METRE), plan) / METRE
        error = np.sqrt(np.mean((distances - exact) ** 2))
        percent = 100 * error / np.sqrt(np.mean(exact**2))
        errors[form] = {"mm": round(float(1000 * error), 3), "percent": round(float(percent), 3)}
    return calibration | {"rms": errors}
