"""Weights and manifest of a finished run: what the library needs beside the layers is measured."""

import dataclasses
from pathlib import Path
from typing import Any

import jax
import numpy as np

from edmlift.joints import JOINTS
from edmlift.metrics import rigid_errors
from model import equivariant, jax_stages, lifter, reference
from model.constants import OBJECTIVES
from model.layout import layout
from model.manifest import NO_FUSION, write_manifest
from training.loss import NETWORKS, Params, predict
from training.mirror import fit_mirror
from training.recipe import MAX_MISSING
from training.run import Run, by_column, origin
from training.views import Views, imputation_of

REFINE_STEPS = 10  # tried for each objective
REFINE_SAMPLE = 300  # poses
EPOCHS = 3  # of training views, to measure on
UNSEEN = 1 << 31  # the first of those epochs: training ends before


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
    views = [flat(run.draw(UNSEEN + epoch)) for epoch in range(EPOCHS)]
    of_kind = distance_settings if run.recipe.network in NETWORKS else lifter_settings
    return {
        "fewest_joints": len(JOINTS) - (MAX_MISSING if run.recipe.masks else 0),
        "missing": "imputed" if run.recipe.impute else "zero",
        **of_kind(run, views),
    }


def flat(batches: Views) -> Views:
    """Batches [steps,B,...] as views [F,...]."""
    return Views(*(array.reshape(-1, *array.shape[2:]) for array in batches))


def distance_settings(run: Run, views: list[Views]) -> dict[str, Any]:
    """Of a network from distances to distances."""
    distances = [predict(run.recipe, run.params, view.keypoints) for view in views]
    points = [np.asarray(jax_stages.classical_mds(d), float) for d in distances]
    truth = np.concatenate([view.truth for view in views]).astype(float)
    weights = fit_mirror(np.concatenate(points), truth)
    some = np.linspace(0, len(truth) - 1, REFINE_SAMPLE).astype(int)
    errors = refinement_errors(np.concatenate(distances)[some].astype(float), truth[some])
    objective = min(errors, key=errors.get)
    return {
        "objective": objective,
        "refine_steps": 0 if objective == "none" else REFINE_STEPS,
        "refinement_mm": errors,
        "mirror": [round(float(w), 4) for w in weights],
        "fusion": fusion_settings(run.params),
    }


def lifter_settings(run: Run, views: list[Views]) -> dict[str, Any]:
    """Of an equivariant network, which chooses the mirror image itself."""
    settings: dict[str, Any] = {"fusion": fusion_settings(run.params)}
    if "mds_share" in run.params:
        settings["mds_share"] = round(float(jax.nn.sigmoid(run.params["mds_share"])), 4)
    return settings | {"silent_units": silent_units(run, views)}


def silent_units(run: Run, views: list[Views]) -> list[int]:
    """How many pairs of a hidden layer's units never fire, layer by layer."""

    known = layout(run.recipe.network)

    @jax.jit
    def rates(params: Params, view: Views) -> list[jax.Array]:
        image = jax_stages.body_frame(view.keypoints, imputation_of(run.recipe))
        return equivariant.fires(params, known, *lifter.inputs(run.recipe.network, image, view.up))

    layers = zip(*(rates(run.params, view) for view in views), strict=True)
    return [int((np.sum(layer, 0) == 0).sum()) for layer in layers]


def fusion_settings(params: Params) -> dict[str, float]:
    """For the manifest; a share of 0 leaves poses as they are.  Where joints have gates, the share
    is theirs, and this one 1."""
    if "fusion" not in params:
        return dict(NO_FUSION)
    share = jax_stages.gate_shares(params["share"]) if "share" in params else 1.0
    misfit, distance = (float(value) for value in jax_stages.fusion_settings(params["fusion"]))
    return {
        "share": round(float(share), 4),
        "misfit": round(misfit, 5),
        "distance": round(distance, 3),
    }


def arrays_of(run: Run) -> dict[str, np.ndarray]:
    """The weights as an .npz holds them."""
    kind = run.recipe.network
    if kind in NETWORKS:
        return NETWORKS[kind].to_arrays(run.params)
    return equivariant.to_arrays(run.params, layout(kind))


def write(run: Run, name: str, held_out: list[int], out: Path) -> dict[str, Any]:
    """Weights to `out` and the manifest beside it; returns the manifest."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("wb") as file:
        np.savez(file, **arrays_of(run))
    manifest = measure_settings(run) | {
        "recipe": {"name": name, "seed": run.seed, **dataclasses.asdict(run.recipe)},
        "data": origin(run.motions, held_out),
        # mm, of networks that do not choose the mirror image the better one; of people who were
        # trained on, if none were held out.
        "validation" if held_out else "training_people": by_column(run.curve),
    }
    write_manifest(out.with_suffix(".json"), manifest)
    return manifest
