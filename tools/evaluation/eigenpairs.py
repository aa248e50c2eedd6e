"""How far the points of the scaling are from those of the exact eigenpairs.

    evaluate.py eigenpairs TEST.npz OTHERS.npz [--models distances_f32] [--quick]
                [--update docs/accuracy-log.md]

For what the network predicts, in float and in fixed point, beside NumPy's eigenvalues and vectors
in double.  Each coordinate has the sign that is nearer.  A figure is the distance of a joint, mm.
"""

import argparse

import numpy as np
from tqdm import tqdm

from data.mocap import Motion
from data.views import views
from edmlift.library import Library
from evaluation.command import Evaluation, Tables, by_set, load_sets, set_options
from evaluation.scaling import predictions
from model import reference
from model.manifest import read_manifest
from reports.markdown import Figure, table

MODELS = ("distances_f32",)
COLUMNS = ("gt", "n10", "cpm", "rand2")
NAMES = ("poses", "mean", "99.9 % within", "worst")

Errors = dict[str, list[float]]  # of each arithmetic, NAMES


def distances(points: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Of joints [F,14,3] from where they are with each coordinate's nearer sign, [F,14]."""
    sign = np.where((points * exact).sum(1, keepdims=True) < 0, -1, 1)
    return np.linalg.norm(points * sign - exact, axis=-1)


def evaluate(model: str, motion: Motion) -> Errors:
    """The errors in either arithmetic, in mm."""
    library = Library(model)
    columns, manifest = views(motion.joints), read_manifest(model.rpartition("_")[0])
    found: dict[str, list[np.ndarray]] = {"float": [], "fixed point": []}
    for name in tqdm(COLUMNS, desc="eigenpairs", disable=None):
        predicted = predictions(library, columns[name], manifest)
        exact = np.array([reference.mds(one.astype(float)) for one in predicted])
        for title, solve in (("float", library.mds), ("fixed point", library.mds_q)):
            points = np.array([solve(one) for one in predicted], float)
            found[title].append(1000 * distances(points, exact))
    return {
        title: [
            len(joined := np.concatenate(errors)),
            joined.mean(),
            np.quantile(joined, 0.999),
            joined.max(),
        ]
        for title, errors in found.items()
    }


def report(errors: Errors) -> str:
    """A row for each arithmetic."""
    return table("mm", NAMES, errors, text)


def text(figure: Figure) -> str:
    """A count as it is, and millimetres to a tenth of a micrometre."""
    return f"{figure:,}" if isinstance(figure, int) else f"{figure:.4f}"


def tables(args: argparse.Namespace) -> Tables:
    found = {name: evaluate(args.models[0], motion) for name, motion in load_sets(args).items()}
    return {"eigenpairs": by_set(report, found)}


EVALUATION = Evaluation(__doc__, tables, lambda parser: set_options(parser, MODELS))
