"""From distances to points: the library's ways, and the paper's relaxation with gradient descent.

    evaluate.py scaling TEST.npz [--model distances] [--update docs/accuracy-log.md] [--quick]

Takes what the network predicts for a sample of poses, as many of each person, and makes points of
it: by the library's classical scaling and each of its refinements, and by the semidefinite
relaxation of eq. 2 (tools/model/sdp.py; pip install -r tools/requirements-sdp.txt).  The errors are
those of the better mirror image.  Eq. 2 is the mean of |d^2 - D^2| over the pairs, cm^2;
"no worse" is the share of the poses where it is no higher than after relaxation and gradient
descent, "than best" than after relaxation and the library's refinement of eq. 2.  Time is the
median, with some microseconds of Python around each call.  --quick takes 21 poses.
"""

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from tqdm import tqdm

from data.mocap import Motion
from data.views import SEED, Column, views
from edmlift.library import Library
from evaluation.command import Evaluation, Tables, base_model, load
from evaluation.measures import by_subject, mean_errors
from model.manifest import read_manifest
from model.sdp import Relaxation, descend
from reports.markdown import Figure, table

COLUMNS = ("gt", "cpm")
SAMPLE, QUICK = 300, 21  # poses
REFINEMENTS = {  # title: objective, steps
    "s-stress": ("square", 20),
    "raw stress": ("raw", 20),
    "eq. 2": ("eq2", 20),
    "eq. 2, 200 steps": ("eq2", 200),
}
PAPER, BEST = "SDP + gradient descent", "SDP + eq. 2, 200 steps"  # what others are compared with
SLACK = 1e-6  # m^2: an eq. 2 value is no worse up to this, the rounding of float

Solver = Callable[[np.ndarray], np.ndarray]  # distances [91] -> points [14,3], metres


def sample(subject: np.ndarray, count: int) -> np.ndarray:
    """Indices of about `count` poses, as many of each subject as it has and all have alike."""
    rng = np.random.default_rng(SEED)
    people = [np.flatnonzero(subject == s) for s in np.unique(subject)]
    each = round(count / len(people))
    return np.sort(np.concatenate([rng.permutation(p)[:each] for p in people]))


def solvers(library: Library) -> dict[str, Solver]:
    """Every way from distances to points, by the title of its row."""
    relaxation = Relaxation()

    def refined(start: Solver, objective: str, steps: int) -> Solver:
        return lambda d: library.refine(start(d), d, objective, steps)[0]

    ways: dict[str, Solver] = {"classical MDS": library.mds}
    for title, (objective, steps) in REFINEMENTS.items():
        ways[f"+ {title}"] = refined(library.mds, objective, steps)
    ways["SDP"] = relaxation.solve
    ways[PAPER] = lambda d: descend(relaxation.solve(d), d)
    ways[BEST] = refined(relaxation.solve, *REFINEMENTS["eq. 2, 200 steps"])
    return ways


def predictions(library: Library, column: Column, manifest: dict[str, Any]) -> np.ndarray:
    """Distances [F,91] in metres that the network predicts."""
    settings = (manifest["fewest_joints"], manifest["missing"] == "imputed")
    images = (library.body_frame(k, *settings) for k in column.keypoints)
    return np.array([library.predict(image).distance for _, image in images])


def measure(
    library: Library, solve: Solver, distance: np.ndarray, truth: np.ndarray
) -> dict[str, np.ndarray]:
    """Figures [F] of a solver: error in mm, eq. 2 in m^2, time in ms."""
    solve(distance[0])  # the first call compiles the relaxation
    points, spent = [], []
    for one in distance:
        start = time.perf_counter()
        points.append(solve(one))
        spent.append(time.perf_counter() - start)
    found = np.array(points, float)
    handed = [mean_errors(found * [1, 1, sign], truth) for sign in (1, -1)]
    return {
        "error": np.minimum(*handed),
        "eq2": np.array(
            [library.stress(p, d, "eq2") for p, d in zip(points, distance, strict=True)]
        ),
        "time": 1000 * np.array(spent),
    }


def evaluate(
    library: Library, motion: Motion, manifest: dict[str, Any], count: int = SAMPLE
) -> dict[str, Any]:
    """Figures of every solver: {column: {title: {figure: [F]}}}, with the poses' "subject"."""
    which = sample(motion.subject, count)
    columns = views(motion.joints)
    ways = solvers(library)
    result = {"subject": motion.subject[which]}
    for name in COLUMNS:
        part = columns[name].take(which)
        distance = predictions(library, part, manifest)
        bar = tqdm(ways.items(), desc=f"points, {name}", disable=None)
        result[name] = {t: measure(library, solve, distance, part.truth) for t, solve in bar}
    return result


def no_worse(way: dict[str, np.ndarray], than: dict[str, np.ndarray]) -> float:
    """Share of the poses, in %, in which eq. 2 is no worse."""
    return 100 * float((way["eq2"] <= than["eq2"] + SLACK).mean())


def report(figures: dict[str, Any]) -> str:
    """A row a solver."""
    subject = figures["subject"]
    heads = []
    rows: dict[str, list[Figure]] = {title: [] for title in figures[COLUMNS[0]]}
    for name in COLUMNS:
        heads += [f"{name}: error, mm", "eq. 2, cm²", "no worse, %", "than best, %"]
        for title, way in figures[name].items():
            eq2 = 10_000 * by_subject(way["eq2"], subject).mean()
            beats = [no_worse(way, figures[name][than]) for than in (PAPER, BEST)]
            rows[title] += [by_subject(way["error"], subject).mean(), eq2, *beats]
    for title, row in rows.items():
        spent = np.median([figures[name][title]["time"] for name in COLUMNS])
        row.append(f"{spent:.2g}")
    return table("points by", [*heads, "time, ms"], rows)


def tables(args: argparse.Namespace) -> Tables:
    count, args.quick = QUICK if args.quick else SAMPLE, False
    model = base_model(args)
    args.model = f"{model}_f32"
    return {"points": report(evaluate(*load(args), read_manifest(model), count))}


EVALUATION = Evaluation(__doc__, tables)
