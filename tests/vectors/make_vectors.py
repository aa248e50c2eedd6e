"""Writes vectors.h: hard cases and what tools/model/reference.py, in double, makes of them.

    make_vectors.py [--gen gen] [--out tests/vectors/vectors.h]

Run it after every change of the networks.  Inputs are short decimals that C and NumPy round to the
same float32.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from edmlift.joints import BONES, PAIRS  # noqa: E402
from model import reference  # noqa: E402

SEED = 14
STEPS = 10
OBJECTIVES = ("square", "raw", "eq2")
MODELS = ("distances", "direct", "fconn")
LIFTS, EIGENS, SHAPES = 8, 8, 12  # lifts: of each model

# Stands, faces the camera; metres, y down, z away from the camera.
STANDING = np.array(
    [
        [0.01, -0.80, -0.05], [0.00, -0.56, 0.00],
        [-0.18, -0.50, 0.01], [-0.25, -0.23, -0.02], [-0.22, -0.08, -0.24],
        [0.18, -0.50, 0.00], [0.27, -0.24, -0.05], [0.24, -0.12, -0.29],
        [-0.13, 0.00, 0.00], [-0.15, 0.42, -0.12], [-0.16, 0.84, 0.02],
        [0.13, 0.00, 0.00], [0.15, 0.43, -0.05], [0.17, 0.85, 0.11],
    ]
)  # fmt: skip


def as_float32(values: np.ndarray, decimals: int) -> np.ndarray:
    """Rounded to so many decimals, then to float32: what C makes of the printed text."""
    return np.round(values, decimals).astype(np.float32).astype(float)


def printed(distance: np.ndarray) -> np.ndarray:
    """Distances as the header of shapes has them."""
    return as_float32(np.maximum(distance, 0), 4)


def person(rng: np.random.RandomState) -> np.ndarray:
    """[14,3]: the standing person, every bone rotated by up to a radian or so."""
    points = STANDING.copy()
    for start, end in BONES:
        bone = STANDING[end] - STANDING[start]
        length = np.linalg.norm(bone)
        bone = bone + rng.normal(0, 0.5 * length, 3)
        points[end] = points[start] + bone * length / np.linalg.norm(bone)
    return points


def keypoints(rng: np.random.RandomState) -> np.ndarray:
    """[14,3]: a person seen from anywhere around by a camera that is rolled, with noise, up to four
    joints missing."""
    angle = rng.uniform(0, 2 * np.pi)
    points = person(rng)
    image = np.stack([points[:, 0] * np.cos(angle) + points[:, 2] * np.sin(angle), points[:, 1]], 1)
    roll = rng.choice([0.0, rng.normal(0, 0.3), rng.uniform(0, 2 * np.pi)])
    image = reference.turned(image, np.array([np.sin(roll), np.cos(roll)]))
    image = 500 + 200 * image + rng.normal(0, 4, image.shape)
    confidence = np.ones(14)
    confidence[rng.permutation(14)[: rng.randint(5)]] = 0
    return np.column_stack([as_float32(image, 1), confidence])


def well_posed(distance: np.ndarray) -> bool:
    """The third eigenvalue stands clear of the fourth: rounding does not choose the axes."""
    values = np.linalg.eigvalsh(reference.gram(distance))
    return values[-3] - values[-4] > 0.02 * values[-1]


def steady(distance: np.ndarray) -> bool:
    """Refinement ends at the same place for distances some micrometres off: no flat valley."""
    distance = printed(distance)
    nudges = np.random.RandomState(SEED).normal(0, 4e-6, (8, len(distance)))  # as those of Q24
    for objective in OBJECTIVES:
        ends = [
            reference.distances(reference.refine(reference.mds(d), d, objective, STEPS))
            for d in (distance, *(distance + nudges))
        ]
        if np.ptp(ends, axis=0).max() > 1e-4:
            return False
    return True


def steady_lift(said: reference.Prediction, image: reference.Image, model: reference.Model) -> bool:
    """Rounding decides nothing: no axes, no mirror image."""
    if said.distance is None:
        return True
    if not (well_posed(said.distance) and steady(said.distance)):
        return False
    points = reference.mds(said.distance)
    if said.points is None:
        return reference.mirror(reference.orient(points, image), model.mirror)[1] > 0.5
    values = np.linalg.svd(points.T @ said.points, compute_uv=False)
    return values[2] > 0.01 * values[0]


def lift_case(rng: np.random.RandomState, model: reference.Model) -> dict[str, np.ndarray]:
    """Input and the result of every stage; drawn anew until rounding cannot decide anything."""
    while True:
        pose = keypoints(rng)
        up = rng.choice([0, 1]) * as_float32(rng.normal([0, -1, 0], 0.4), 2)  # 0: not known
        try:
            image = reference.body_frame(pose, model.fewest_joints, model.imputation)
            points, misfit = reference.lift(model, pose, up if up.any() else None)
        except reference.Refused:
            continue
        said = reference.predict(model, image, up if up.any() else None)
        if not steady_lift(said, image, model):
            continue
        distance = np.zeros(91) if said.distance is None else said.distance
        own_points = np.zeros((14, 3)) if said.points is None else said.points
        frame = {"in": pose, "up": up, "at": image.at, "down": image.down}
        given = {"distance": distance, "points": own_points, "share": said.share}
        return frame | given | {"pose": points, "misfit": misfit}


def matrix(rng: np.random.RandomState, kind: int) -> np.ndarray:
    """Symmetric [14,14]: sign-mixed, graded, of repeated eigenvalues, or -D^2/2 not centred."""
    if kind == 1:
        scale = 10.0 ** -np.linspace(0, 3, 14)
        return rng.normal(0, 10, (14, 14)) * np.outer(scale, scale)
    if kind == 2:
        basis = np.linalg.qr(rng.normal(size=(14, 14)))[0]
        return basis @ np.diag([3.0] * 5 + [-2.0] * 5 + [0.0] * 4) @ basis.T
    if kind == 3:
        distance = reference.distances(person(rng)) + rng.normal(0, 0.1, 91)
        return -0.5 * reference.square(distance) ** 2
    return rng.normal(0, 1, (14, 14))


def eigen_case(rng: np.random.RandomState, kind: int) -> dict[str, np.ndarray]:
    upper = np.triu(as_float32(matrix(rng, kind), 5))
    full = upper + np.triu(upper, 1).T
    return {"matrix": full[np.triu_indices(14)], "value": np.linalg.eigvalsh(full)[::-1]}


def shape_case(rng: np.random.RandomState, distance: np.ndarray) -> dict[str, np.ndarray]:
    distance = printed(distance)
    start = reference.mds(distance)
    refined = [reference.refine(start, distance, objective, STEPS) for objective in OBJECTIVES]
    return {
        "distance": distance,
        "mds": reference.distances(start),
        "refined": np.stack([reference.distances(points) for points in refined]),
    }


def shape_cases(rng: np.random.RandomState, lifts: list[dict]) -> list[dict[str, np.ndarray]]:
    """Distances as the network gives them, then a person's with more and more noise."""
    cases = [shape_case(rng, lift["distance"]) for lift in lifts[: SHAPES // 2]]
    noise = [0.0, 0.01, 0.03, 0.05, 0.1, 0.3]
    while len(cases) < SHAPES:
        spread = noise[len(cases) - SHAPES // 2]
        distance = reference.distances(person(rng)) + rng.normal(0, spread, len(PAIRS[0]))
        if well_posed(distance) and steady(distance):
            cases.append(shape_case(rng, distance))
    return cases


# ---- C -----------------------------------------------------------------------------------------


def number(value: float) -> str:
    """Seven digits; a trace of rounding in place of zero is zero."""
    return "0" if abs(value) < 1e-12 else f"{value:.7g}"


def initialiser(values: np.ndarray) -> str:
    """The numbers of one member in braces, ten a line."""
    if np.ndim(values) == 0:
        return number(float(values))
    if not np.any(values):
        return "{" * np.ndim(values) + "0" + "}" * np.ndim(values)
    if np.ndim(values) == 2:
        return "{" + ",\n".join(initialiser(row) for row in values) + "}"
    texts = [number(value) for value in values]
    lines = [", ".join(texts[n : n + 10]) for n in range(0, len(texts), 10)]
    return "{" + ",\n".join(lines) + "}"


def table(kind: str, name: str, cases: list[dict[str, np.ndarray]]) -> str:
    rows = [",\n".join(initialiser(value) for value in case.values()) for case in cases]
    body = "".join(f"{{{row}}},\n" for row in rows)
    return f"static const {kind} {name}[] = {{\n{body}}};\n"


HEAD = f"""\
/* Hard cases and their results in double.  Do not edit.
 * Generated by tests/vectors/make_vectors.py from tools/model/reference.py and from distances.npz,
 * direct.npz and fconn.npz in gen/
 */

typedef struct {{
    double in[14][3], up[3];                  /* up: 0 if it is not known */
    double at[14][2], down[2];                /* in the body's frame */
    double distance[91], x[14][3], share[14]; /* what the network gives; 0: nothing */
    double pose[14][3], misfit;
}} lift_vector;

typedef struct {{
    double matrix[105], value[14]; /* upper triangle, row by row */
}} eigen_vector;

typedef struct {{
    double distance[91], mds[91], refined[3][91]; /* distances; square, raw, eq2 */
}} shape_vector;

enum {{ LIFTS = {LIFTS}, EIGENS = {EIGENS}, SHAPES = {SHAPES}, VECTOR_STEPS = {STEPS} }};
"""


def vectors(gen: Path) -> str:
    """The text of vectors.h."""
    rng = np.random.RandomState(SEED)  # its stream is frozen
    lifts = {}
    for name in MODELS:
        model = reference.read_model(gen / f"{name}.npz")
        lifts[name] = [lift_case(rng, model) for _ in range(LIFTS)]
    eigens = [eigen_case(rng, n % 4) for n in range(EIGENS)]
    tables = [("lift_vector", f"{name}_lifts", cases) for name, cases in lifts.items()]
    tables.append(("eigen_vector", "eigen_vectors", eigens))
    tables.append(("shape_vector", "shape_vectors", shape_cases(rng, lifts["distances"])))
    return "\n".join([HEAD, *(table(*parts) for parts in tables)])


def main() -> None:
    parser = argparse.ArgumentParser(description="Writes the golden vectors of the C tests.")
    parser.add_argument("--gen", type=Path, default=ROOT / "gen", help="folder of the weights")
    parser.add_argument("--out", type=Path, default=ROOT / "tests" / "vectors" / "vectors.h")
    arguments = parser.parse_args()
    arguments.out.write_text(vectors(arguments.gen), "utf-8")


if __name__ == "__main__":
    main()
