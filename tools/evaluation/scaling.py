"""From distances to points: the library's ways, and the paper's relaxation with gradient descent.

    run.py evaluation.scaling TEST.npz [--model fconn] [--update docs/accuracy.md] [--quick]

Takes what the network predicts for a sample of poses, as many of each person as there are, and
turns it into points: by the library's classical scaling and each of its refinements, and by the
semidefinite relaxation of eq. 2 (tools/points.py; pip install -r tools/requirements-sdp.txt).  All
go through the library's choice of the mirror image.  Error as in tools/evaluate.py; eq. 2 is
the mean of |d^2 - D^2| over the pairs, cm^2; "no worse" is the share of the poses where it is no
higher than after relaxation and gradient descent, "than best" than after relaxation and the
library's refinement of eq. 2.  Time is the median, with some microseconds of Python around each
call.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from tqdm import tqdm

from data.mocap import MocapError, Motion, load_motion
from data.paths import GEN
from edmlift.library import Library
from edmlift.metrics import rigid_errors
from evaluation.accuracy import SEED, Column, by_subject, table, views
from model.sdp import Relaxation, descend
from reports import markdown

COLUMNS = ("gt", "cpm")
SAMPLE = 300  # poses
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
    share = round(count / len(people))
    return np.sort(np.concatenate([rng.permutation(p)[:share] for p in people]))


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


def predictions(library: Library, column: Column, settings: dict) -> np.ndarray:
    """Distances [F,91] in metres that the network predicts."""
    complete = settings["missing"] == "completed"
    limits = (settings["fewest_joints"], settings["widest"], complete)
    edm = (library.edm(k, *limits) for k in column.keypoints)
    return np.array([library.net(distance) for _, distance in edm])


def measure(library: Library, solve: Solver, distance: np.ndarray, truth: np.ndarray) -> dict:
    """Figures [F] of a solver: error in mm, eq. 2 in m^2, time in ms."""
    solve(distance[0])  # the first call compiles the relaxation
    points, spent = [], []
    for one in distance:
        start = time.perf_counter()
        points.append(solve(one))
        spent.append(time.perf_counter() - start)
    chosen = np.array([library.mirror(p)[0] for p in points], float)
    return {
        "error": 1000 * rigid_errors(chosen, truth).mean(1),
        "eq2": np.array(
            [library.stress(p, d, "eq2") for p, d in zip(points, distance, strict=True)]
        ),
        "time": 1000 * np.array(spent),
    }


def evaluate(library: Library, motion: Motion, settings: dict, count: int = SAMPLE) -> dict:
    """Figures of every solver: {column: {title: {figure: [F]}}}, with the poses' "subject"."""
    which = sample(motion.subject, count)
    columns = views(motion.joints)
    ways = solvers(library)
    result = {"subject": motion.subject[which]}
    for name in COLUMNS:
        column = columns[name]
        part = Column(column.keypoints[which], column.seen[which], column.truth[which])
        distance = predictions(library, part, settings)
        bar = tqdm(ways.items(), desc=f"points, {name}", disable=None)
        result[name] = {t: measure(library, solve, distance, part.truth) for t, solve in bar}
    return result


def no_worse(way: dict, than: dict) -> float:
    """Share of the poses, in %, in which eq. 2 is no worse."""
    return 100 * float((way["eq2"] <= than["eq2"] + SLACK).mean())


def report(figures: dict) -> str:
    """A row a solver."""
    subject = figures["subject"]
    heads = []
    rows: dict[str, list] = {title: [] for title in figures[COLUMNS[0]]}
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


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--model", default="fconn", help="its name without _f32 (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown file with marks for the table")
    parser.add_argument("--quick", action="store_true", help="21 poses")
    args = parser.parse_args(arguments)
    try:
        motion, library = load_motion(args.motion), Library(f"{args.model}_f32")
        settings = json.loads((GEN / f"{args.model}.json").read_text())
    except (MocapError, OSError, ValueError) as error:
        print(f"scaling: {error}", file=sys.stderr)
        return 1
    text = report(evaluate(library, motion, settings, 21 if args.quick else SAMPLE))
    print(text, end="")
    if args.update:
        markdown.write(args.update, "points", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
