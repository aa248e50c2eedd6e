"""Weights and manifest of a finished run: what the library needs beside the layers is measured."""

import dataclasses
from pathlib import Path
from typing import Any

import jax
import numpy as np

from edmlift.joints import JOINTS
from edmlift.metrics import rigid_errors
from model import jax_stages, reference
from model.constants import OBJECTIVES
from model.manifest import NO_FUSION, write_manifest
from training.loss import predict
from training.mirror import fit_mirror
from training.recipe import MAX_MISSING
from training.run import Run, by_column, origin
from training.views import draw_2d

MAX_ASPECT = 3.5  # what fixed point allows for; of 100,000 views, a handful are wider
REFINE_STEPS = 10  # tried for each objective
REFINE_SAMPLE = 300  # poses
EPOCHS = 3  # of training views, to measure on


def aspect(keypoints: np.ndarray) -> np.ndarray:
    """Width over height of the seen joints' box: [F,14,3] -> [F]."""
    points = np.where(keypoints[..., 2:] > 0, keypoints[..., :2], np.nan)
    width, height = np.moveaxis(np.nanmax(points, 1) - np.nanmin(points, 1), -1, 0)
    return width / height


def refinement_errors(distances: np.ndarray, truths: np.ndarray) -> dict[str, float]:
    """Error after refining by each objective, the better of pose and reflection, mm.

    distances [F,91] as predicted, truths [F,14,3].
    """
    errors = {}
    for objective in OBJECTIVES:
        points = [reference.refine(reference.mds(d), d, objective, REFINE_STEPS) for d in distances]
        both = [rigid_errors(np.array(points) * [1, 1, z], truths).mean(1) for z in (1, -1)]
        errors[objective] = round(float(1000 * np.minimum(*both).mean()), 2)
    return errors


def measure_settings(run: Run) -> dict[str, Any]:
    """What the library needs beside the layers, measured on a few epochs of training views."""
    widest, distances, points, truths = 0.0, [], [], []
    for epoch in range(EPOCHS):
        keypoints, truth = draw_2d(
            run.motion.joints, run.recipe, np.random.default_rng([run.seed, 1 << 31, epoch])
        )
        widest = max(widest, aspect(keypoints).max())
        distance = predict(run.recipe, run.params, keypoints)
        distances.append(distance.astype(float))
        points.append(np.asarray(jax_stages.classical_mds(distance), float))
        truths.append(truth.astype(float))
    truth = np.concatenate(truths)
    weights = fit_mirror(np.concatenate(points), truth)
    some = np.linspace(0, len(truth) - 1, REFINE_SAMPLE).astype(int)
    errors = refinement_errors(np.concatenate(distances)[some], truth[some])
    objective = min(errors, key=errors.get)
    return {
        "fewest_joints": len(JOINTS) - (MAX_MISSING if run.recipe.masks else 0),
        "missing": "imputed" if run.recipe.impute else "zero",
        "max_aspect": min(float(np.ceil(2 * widest) / 2), MAX_ASPECT),
        "objective": objective,
        "refine_steps": 0 if objective == "none" else REFINE_STEPS,
        "refinement_mm": errors,
        "mirror": [round(float(w), 4) for w in weights],
        "fusion": fusion_settings(run.params.get("fusion")),
    }


def fusion_settings(trained: jax.Array | None) -> dict[str, float]:
    """For the manifest; a weight of 0 leaves poses as they are."""
    if trained is None:
        return dict(NO_FUSION)
    weight, misfit, distance = (float(value) for value in jax_stages.fusion_settings(trained))
    return {"weight": round(weight, 4), "misfit": round(misfit, 5), "distance": round(distance, 3)}


def write(run: Run, name: str, held_out: list[int], out: Path) -> None:
    """Weights to `out` and the manifest beside it."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("wb") as file:
        np.savez(file, **run.network.to_arrays(run.params))
    manifest = measure_settings(run) | {
        "recipe": {"name": name, "seed": run.seed, **dataclasses.asdict(run.recipe)},
        "data": origin(run.motion, held_out),
        # Better of pose and reflection, mm; of people who were trained on, if none were held out.
        "validation" if held_out else "training_people": by_column(run.curve),
    }
    write_manifest(out.with_suffix(".json"), manifest)
