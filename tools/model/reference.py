"""The lifter's stages in NumPy, double precision: the oracle of the tests.

Written from the paper and the public header, not from the C: another normalisation of the Gram
matrix, LAPACK's eigenvectors, singular values where the C has closed forms.  One pose at a time.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edmlift.joints import INDEX, PAIR_MIRROR, PAIRS, SELF_MIRRORED, mid_hip
from model.constants import LIGHT_RIDGE, MIN_RIDGE, Q12, SOFTENING, imputation

COUNT = 14


class Refused(ValueError):
    """A pose that the lifter refuses; the message is the status' name."""


@dataclass(frozen=True)
class Model:
    """Layers [(weight [in,out], bias [out])] and the settings of the manifest."""

    layers: list[tuple[np.ndarray, np.ndarray]]
    fewest_joints: int
    max_aspect: float
    objective: str
    refine_steps: int
    mirror: np.ndarray
    fusion: dict[str, float]  # the last three arguments of fuse()
    imputation: np.ndarray | None = None  # of edm()


def read_model(weights: Path) -> Model:
    """The model of an .npz of FConn's and the manifest beside it."""
    manifest = json.loads(weights.with_suffix(".json").read_text("utf-8"))
    with np.load(weights) as arrays:
        layers = [(arrays[f"weight{n}"], arrays[f"bias{n}"]) for n in range(len(arrays) // 2)]
    names = ("fewest_joints", "max_aspect", "objective", "refine_steps", "fusion")
    picked = {name: manifest[name] for name in names}
    imputed = imputation() if manifest["missing"] == "imputed" else None
    return Model(layers, mirror=np.array(manifest["mirror"]), imputation=imputed, **picked)


def edm(
    keypoints: np.ndarray,
    fewest_joints: int,
    max_aspect: float,
    imputation: np.ndarray | None = None,
) -> np.ndarray:
    """Normalised 2D distances [91] of keypoints [14,3] (x, y, confidence); section 3.1.

    imputation [14,14]: weights by which a joint follows the others; where it is None, distances
    from joints that were not seen are zero.
    """
    xy, confidence = keypoints[:, :2], keypoints[:, 2]
    seen = confidence > 0
    if not np.isfinite(confidence).all() or not np.isfinite(xy[seen]).all():
        raise Refused("not_finite")
    if seen.sum() < fewest_joints:
        raise Refused("too_few_joints")
    half = np.ptp(xy[seen, 1]) / 2
    if half <= np.abs(xy[seen]).max() / 4096:
        raise Refused("degenerate")
    if np.ptp(xy[seen, 0]) / 2 > max_aspect * half:
        raise Refused("aspect")
    spread = np.linalg.svd(xy[seen] - xy[seen].mean(0), compute_uv=False)
    if spread[1] <= spread[0] / 128:
        raise Refused("degenerate")
    if imputation is not None:
        xy, seen = impute(xy, seen, imputation), np.ones(COUNT, bool)
    distance = np.linalg.norm(xy[:, None] / half - xy[None] / half, axis=-1)
    distance[~seen] = distance[:, ~seen] = 0
    return distance[PAIRS]


def impute(xy: np.ndarray, seen: np.ndarray, imputation: np.ndarray) -> np.ndarray:
    """Points [14,2]; those that were not seen [14] are at their conditional mean given the others.

    The origin is the seen ones' mean, so that a small error of a weight does not move points far
    from the image's own origin.
    """
    middle = xy[seen].mean(0)
    system = np.eye(COUNT) - imputation
    right = -system[np.ix_(~seen, seen)] @ (xy[seen] - middle)
    out = xy.copy()
    out[~seen] = np.linalg.solve(system[np.ix_(~seen, ~seen)], right) + middle
    return out


def net(layers: list[tuple[np.ndarray, np.ndarray]], x: np.ndarray) -> np.ndarray:
    """FConn: [91] -> [91] metres; section 3.2.  With 49 outputs, equivariant()."""
    if len(layers[-1][1]) == len(PAIR_MIRROR):
        return equivariant(layers, x)
    for weight, bias in layers:
        x = np.maximum(x @ weight.astype(float) + bias, 0)
    return x


def equivariant(layers: list[tuple[np.ndarray, np.ndarray]], x: np.ndarray) -> np.ndarray:
    """FConn with left and right alike, as a plain one of twice the width: [91] -> [91] metres.

    It reads d^2 / (d + 0.6) of a distance d.  A unit reads the first of each mirror pair by the sum
    of its even and its odd weights and the second by their difference; its mirror unit, the other
    way round.
    """
    first, second = PAIR_MIRROR.T
    x = x * x / (x + SOFTENING / Q12)
    x = np.concatenate([x[first], x[second]])
    for weight, bias in layers:
        even = weight[: len(x) // 2].astype(float)
        odd = np.zeros_like(even)
        odd[: len(weight) - len(even)] = weight[len(even) :]
        dense = np.block([[even + odd, even - odd], [even - odd, even + odd]])
        x = np.maximum(x @ dense + np.tile(bias, 2), 0)
    out = np.zeros(len(first) + len(second) - SELF_MIRRORED)
    out[first], out[second] = np.split(x, 2)
    return out


def fconv(params: dict[str, np.ndarray], x: np.ndarray) -> np.ndarray:
    """FConv: [91] -> [91] metres; section 3.2.

    params  arrays as model/fconv_weights.py names them, with or without batch normalisation
    """
    params = {name: np.asarray(array, float) for name, array in params.items()}
    maps = square(x)[:, :, None]
    for name in ("conv1", "conv2"):
        maps = convolve(maps, params[f"{name}_weight"]) + params[f"{name}_bias"]
        bn = f"bn{name[-1]}"
        if f"{bn}_scale" in params:
            maps = (maps - params[f"{bn}_mean"]) / np.sqrt(params[f"{bn}_variance"] + 1e-5)
            maps = maps * params[f"{bn}_scale"] + params[f"{bn}_shift"]
        maps = pool(np.maximum(maps, 0))
    for name, side in (("deconv1", 7), ("deconv2", 14)):
        maps = convolve_transposed(maps, params[f"{name}_weight"], side) + params[f"{name}_bias"]
        maps = np.maximum(maps, 0)
    z = maps @ params["conv3_weight"] + params["conv3_bias"]
    return np.maximum(z + z.T, 0)[PAIRS] / 2


def convolve(maps: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """[n,n,in] and [7,7,in,out] -> [n,n,out]: cross-correlation, padded by 3."""
    padded = np.pad(maps, ((3, 3), (3, 3), (0, 0)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, (7, 7), (0, 1))
    return np.einsum("yxiuv,uvio->yxo", windows, weight)


def pool(maps: np.ndarray) -> np.ndarray:
    """The largest of each 2x2 pixels; at the end of an odd side, of what is there."""
    return np.array(
        [
            [maps[y : y + 2, x : x + 2].max((0, 1)) for x in range(0, len(maps), 2)]
            for y in range(0, len(maps), 2)
        ]
    )


def convolve_transposed(maps: np.ndarray, weight: np.ndarray, side: int) -> np.ndarray:
    """[n,n,in] and [7,7,in,out] -> [side,side,out]: each input adds its kernel, at twice its
    place less 3."""
    n, out = len(maps), weight.shape[-1]
    whole = np.zeros((2 * n + 5, 2 * n + 5, out))
    for y, x in np.ndindex(n, n):
        whole[2 * y : 2 * y + 7, 2 * x : 2 * x + 7] += np.einsum("i,uvio->uvo", maps[y, x], weight)
    return whole[3 : 3 + side, 3 : 3 + side]


def square(values: np.ndarray) -> np.ndarray:
    """The symmetric [14,14] matrix of [91] values above the diagonal."""
    matrix = np.zeros((COUNT, COUNT))
    matrix[PAIRS] = values
    return matrix + matrix.T


def gram(distance: np.ndarray) -> np.ndarray:
    """Doubly centred -D^2/2 [14,14]."""
    centring = np.eye(COUNT) - 1 / COUNT
    return centring @ (-0.5 * square(distance) ** 2) @ centring


def mds(distance: np.ndarray) -> np.ndarray:
    """Classical MDS: [91] -> [14,3]; section 3.3."""
    values, vectors = np.linalg.eigh(gram(distance))
    return vectors[:, :-4:-1] * np.sqrt(np.maximum(values[:-4:-1], 0))


def distances(points: np.ndarray) -> np.ndarray:
    """[14,3] -> [91] (eq. 1)."""
    return np.linalg.norm(points[PAIRS[0]] - points[PAIRS[1]], axis=1)


def stress(points: np.ndarray, distance: np.ndarray, objective: str) -> float:
    """Mean over the pairs of what the refinement minimises."""
    d = distances(points)
    terms = {
        "none": np.zeros(1),
        "square": (d**2 - distance**2) ** 2,
        "raw": (d - distance) ** 2,
        "eq2": np.abs(d**2 - distance**2),
    }
    return float(terms[objective].mean())


FLOOR = 1 / 256  # m^2: smallest divisor of a weight
LONGEST = 4.0  # m: the line search moves no joint further, along an axis
FORGET = 64.0  # steps that would keep so much of the last one start anew


def weights(points: np.ndarray, distance: np.ndarray, objective: str) -> np.ndarray:
    """Weights [91] that give sum w (d^2 - D^2)^2 the gradient of the objective."""
    d = distances(points)
    if objective == "raw":
        return 1 / np.maximum(d * (d + distance), FLOOR) / 8
    if objective == "eq2":
        return 1 / np.maximum(np.abs(d**2 - distance**2), FLOOR) / 16
    return np.ones(len(d))


def refine(points: np.ndarray, distance: np.ndarray, objective: str, steps: int) -> np.ndarray:
    """Polak-Ribiere+ conjugate gradient, exact line search, until the objective stops falling."""
    if objective == "none":
        return points
    before = step = None
    for _ in range(steps):
        w = weights(points, distance, objective)
        downhill = -laplacian(w * (distances(points) ** 2 - distance**2)) @ points
        if before is None:
            step = downhill
        else:
            gain = np.sum(downhill * (downhill - before)) / np.sum(before**2)
            step = downhill + (gain if 0 < gain < FORGET else 0) * step
        before = downhill
        tried = points + line_minimum(points, step, w, distance) * step
        if stress(tried, distance, objective) >= stress(points, distance, objective):
            break
        points = tried
    return points


def laplacian(pair_values: np.ndarray) -> np.ndarray:
    """Graph Laplacian of the pair values, so that (L x)_i = sum_j v_ij (x_i - x_j)."""
    matrix = square(pair_values)
    return np.diag(matrix.sum(1)) - matrix


def line_minimum(
    points: np.ndarray, step: np.ndarray, w: np.ndarray, distance: np.ndarray
) -> float:
    """Smallest positive minimiser of the weighted s-stress along a line: roots of a cubic."""
    start, along = points[PAIRS[0]] - points[PAIRS[1]], step[PAIRS[0]] - step[PAIRS[1]]
    r = (start**2).sum(1) - distance**2  # d^2 - D^2 = r + b t + a t^2
    b, a = 2 * (start * along).sum(1), (along**2).sum(1)
    quartic = np.poly1d(
        [
            (w * a**2).sum(),
            (2 * w * a * b).sum(),
            (w * (b**2 + 2 * a * r)).sum(),
            (2 * w * b * r).sum(),
            0.0,
        ]
    )
    if quartic.deriv()(0) >= 0:
        return 0.0
    roots = [LONGEST / np.abs(step).max(), *quartic.deriv().roots]
    return float(min(r.real for r in roots if abs(r.imag) < 1e-9 * abs(r) and r.real > 0))


UPPER_ARMS = (("right_shoulder", "right_elbow"), ("left_shoulder", "left_elbow"))
FOREARMS = (("right_elbow", "right_wrist"), ("left_elbow", "left_wrist"))
HEAD = (("neck_base", "head"),)
THIGHS = (("right_hip", "right_knee"), ("left_hip", "left_knee"))
SHINS = (("right_knee", "right_ankle"), ("left_knee", "left_ankle"))


def mirror_features(points: np.ndarray) -> np.ndarray:
    """How far arms, forearms, head, thighs and shins point forward of the torso.

    [...,14,3] -> [...,5].  Sums of cosines over right and left; the mirror image has them negated.
    """

    def bone(start: str, end: str) -> np.ndarray:
        return points[..., INDEX[end], :] - points[..., INDEX[start], :]

    up = points[..., INDEX["neck_base"], :] - mid_hip(points)
    chest = unit(np.cross(bone("right_shoulder", "left_shoulder"), up))
    pelvis = unit(np.cross(bone("right_hip", "left_hip"), up))
    return np.stack(
        [
            sum((unit(bone(*pair)) * front).sum(-1) for pair in group)
            for group, front in (
                (UPPER_ARMS, chest),
                (FOREARMS, chest),
                (HEAD, chest),
                (THIGHS, pelvis),
                (SHINS, pelvis),
            )
        ],
        -1,
    )


def unit(v: np.ndarray) -> np.ndarray:
    """Unit vectors along the last axis; zero stays zero."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(length > 0, length, 1)


def mirror(points: np.ndarray, weights5: np.ndarray) -> tuple[np.ndarray, float]:
    """The better mirror image and its margin (section 3.3)."""
    score = float(mirror_features(points) @ weights5)
    return (points if score >= 0 else points * [1, 1, -1]), abs(score)


# Joint limits.  Kinds of bones, each with those of its right and left; what hangs on which.
BONE_KINDS = {
    "arms": UPPER_ARMS, "forearms": FOREARMS, "head": HEAD, "thighs": THIGHS, "shins": SHINS
}  # fmt: skip
HANGS_ON = {"forearms": "arms", "shins": "thighs"}
CELLS, PARENT_CELLS = 16, 8  # of the octahedral maps, along a side
STRAIGHT = np.array([1.0, -1.0, 1.0]) / np.sqrt(3)  # outward, down, forward


def torso_axes(points: np.ndarray, right: str, left: str) -> np.ndarray:
    """Axes of the torso as rows: toward the subject's left, up, forward; zero if it has no front.

    points [...,14,3]; right and left: the joints through which the first one goes -> [...,3,3].
    """
    side = unit(points[..., INDEX[left], :] - points[..., INDEX[right], :])
    front = unit(np.cross(side, unit(points[..., INDEX["neck_base"], :] - mid_hip(points))))
    side = side * front.any(-1, keepdims=True)
    return np.stack([side, np.cross(front, side), front], -2)


def limb_directions(points: np.ndarray) -> dict[str, np.ndarray]:
    """Unit vectors [...,2,3] (head: [...,1,3]) along the bones of each kind; zero: no direction.

    In the torso's axes, the first of which points outward: left bones are as right ones in a
    mirror, and a head that leans to the right as one that leans to the left.
    """
    chest = torso_axes(points, "right_shoulder", "left_shoulder")
    pelvis = torso_axes(points, "right_hip", "left_hip")
    found = {}
    for kind, bones in BONE_KINDS.items():
        axes = pelvis if kind in ("thighs", "shins") else chest
        ends = [points[..., INDEX[end], :] - points[..., INDEX[start], :] for start, end in bones]
        local = np.einsum("...ij,...nj->...ni", axes, unit(np.stack(ends, -2)))
        local[..., 0] *= [-1, 1] if len(bones) == 2 else np.sign(local[..., 0])
        found[kind] = local
    return found


def unbent(bone: np.ndarray, parent: np.ndarray) -> np.ndarray:
    """Directions [...,3] after the half turn that brings their parents' to STRAIGHT."""
    axis = unit(STRAIGHT + parent)
    return 2 * (axis * bone).sum(-1, keepdims=True) * axis - bone


def octahedral(direction: np.ndarray, cells: int = CELLS) -> tuple[np.ndarray, np.ndarray]:
    """Row and column [...] of unit vectors [...,3] on the octahedral map of cells x cells."""
    x, y, z = np.moveaxis(direction, -1, 0) / np.maximum(np.abs(direction).sum(-1), 1e-9)
    across = np.where(z < 0, (1 - np.abs(y)) * np.where(x < 0, -1, 1), x)
    along = np.where(z < 0, (1 - np.abs(x)) * np.where(y < 0, -1, 1), y)
    row, column = (
        np.clip(np.floor((a + 1) * cells / 2), 0, cells - 1).astype(int) for a in (along, across)
    )
    return row, column


def violations(points: np.ndarray, maps: dict[str, np.ndarray]) -> np.ndarray:
    """How many of the nine bones point where people's do not: [...,14,3] -> [...].

    maps: where they do, by kind: bool [16,16], or [8,8,16,16] by the cell of what they hang on.
    """
    directions = limb_directions(points)
    count = np.zeros(points.shape[:-2], int)
    for kind, bone in directions.items():
        known, where = bone.any(-1), ()
        if kind in HANGS_ON:
            parent = directions[HANGS_ON[kind]]
            known, where = known & parent.any(-1), octahedral(parent, PARENT_CELLS)
            bone = unbent(bone, parent)
        count += (~(known & maps[kind][(*where, *octahedral(bone))])).sum(-1)
    return count


def orient(points: np.ndarray, keypoints: np.ndarray) -> np.ndarray:
    """Scaled-orthographic alignment to the image, ridged by its misfit; root at mid-hip."""
    seen = keypoints[:, 2] > 0
    centred = points[seen] - points[seen].mean(0)
    image = keypoints[seen, :2] - keypoints[seen, :2].mean(0)
    spread = np.sum(centred**2)

    def rows(ridge: float) -> np.ndarray:
        squares = centred.T @ centred + ridge * spread * np.eye(3)
        u, _, vt = np.linalg.svd(np.linalg.solve(squares, centred.T @ image).T, full_matrices=False)
        return u @ vt

    across = centred @ rows(LIGHT_RIDGE).T
    scale = np.sum(across * image) / np.sum(across**2)
    misfit = np.sum((image / scale - across) ** 2) / spread if scale > 0 else 1.0
    axes = rows(MIN_RIDGE + min(misfit, 1.0))
    points = points @ np.vstack([axes, np.cross(axes[0], axes[1])]).T
    return points - mid_hip(points)


def fuse(
    points: np.ndarray, keypoints: np.ndarray, weight: float, misfit: float, distance: float
) -> np.ndarray:
    """Weighted mean of the x and y of a pose of orient() and those of its image; root at mid-hip.

    The image is taken from `distance` metres, and brought to the depth of the joints' middle.  Its
    weight is weight / (1 + square / misfit^2), square being the mean square of the disagreement.
    """
    seen = keypoints[:, 2] > 0
    points = points - points[seen].mean(0)
    image = keypoints[seen, :2] - (keypoints[seen, :2].max(0) + keypoints[seen, :2].min(0)) / 2
    image = image * (1 + points[seen, 2:] / distance)
    image = image - image.mean(0)
    scale = np.sum(points[seen, :2] * image) / np.sum(image**2)
    if scale > 0:
        off = scale * image - points[seen, :2]
        square = np.sum(off**2) / seen.sum()
        points[seen, :2] += weight / (1 + square / misfit**2) * off
    return points - mid_hip(points)


def lift(model: Model, keypoints: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Pose [14,3], mirror margin and residual of keypoints [14,3]; raises Refused."""
    distance = net(
        model.layers, edm(keypoints, model.fewest_joints, model.max_aspect, model.imputation)
    )
    points = refine(mds(distance), distance, model.objective, model.refine_steps)
    points, margin = mirror(points, model.mirror)
    pose = fuse(orient(points, keypoints), keypoints, **model.fusion)
    return pose, margin, np.sqrt(stress(points, distance, "raw"))
