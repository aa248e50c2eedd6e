"""The lifter's stages in NumPy, double precision: the oracle of the tests.

Written from the paper and the public headers, not from the C or from JAX: another normalisation of
the Gram matrix, LAPACK's eigenvectors, singular values where the C has closed forms, a plain
network of twice the width instead of an equivariant one.  One pose at a time.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edmlift.joints import INDEX, PAIR_MIRROR, PAIRS, SELF_MIRRORED, mid_hip
from model.constants import (
    FARTHEST,
    GATE_SOFTNESS,
    LIGHT_RIDGE,
    LONGEST_2D,
    MIDDLE_SOFT,
    MIN_RIDGE,
    MISSING_INPUT,
    Q12,
    SOFTENING,
    WIDEST,
    imputation,
)

COUNT = 14

Layers = list[tuple[np.ndarray, np.ndarray]]  # (weight [in,out], bias [out])


class Refused(ValueError):
    """A pose that the lifter refuses; the message is the status' name."""


@dataclass(frozen=True)
class Model:
    """Layers and the settings of the manifest."""

    layers: Layers
    fewest_joints: int
    fusion: dict[str, float]  # share, misfit, distance; a network with gates gives the share itself
    objective: str = "none"
    refine_steps: int = 0
    mirror: np.ndarray | None = None  # five weights, of a network that gives distances alone
    mds_share: float = 0.0
    imputation: np.ndarray | None = None  # of body_frame()

    @property
    def kind(self) -> str:
        """By how many rows the last layer has."""
        return {81: "distances", 32: "direct", 91: "fconn"}[len(self.layers[-1][1])]


def read_model(weights: Path) -> Model:
    """The model of an .npz of fully connected layers and the manifest beside it."""
    manifest = json.loads(weights.with_suffix(".json").read_text("utf-8"))
    with np.load(weights) as arrays:
        layers = [(arrays[f"weight{n}"], arrays[f"bias{n}"]) for n in range(len(arrays) // 2)]
    names = ("fewest_joints", "objective", "refine_steps", "fusion", "mds_share")
    picked = {name: manifest[name] for name in names if name in manifest}
    mirror = np.array(manifest["mirror"]) if "mirror" in manifest else None
    imputed = imputation() if manifest["missing"] == "imputed" else None
    return Model(layers, mirror=mirror, imputation=imputed, **picked)


# ---- The image ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Image:
    """Joints in the body's frame."""

    at: np.ndarray  # [14,2]
    seen: np.ndarray  # bool [14]
    down: np.ndarray  # [2]: the body's axis in the image, a unit vector


def body_frame(
    keypoints: np.ndarray, fewest_joints: int, imputation: np.ndarray | None = None
) -> Image:
    """Keypoints [14,3] (x, y, confidence) turned to the body's axis and scaled to the body.

    imputation [14,14]: weights by which a joint follows the others; where it is None, joints that
    were not seen are at 0 and the image is not turned, as in section 3.1.
    """
    xy, confidence = keypoints[:, :2], keypoints[:, 2]
    seen = confidence > 0
    if not np.isfinite(confidence).all() or not np.isfinite(xy[seen]).all():
        raise Refused("not_finite")
    if seen.sum() < fewest_joints:
        raise Refused("too_few_joints")
    half = np.ptp(xy[seen], axis=0).max() / 2
    if half <= np.abs(xy[seen]).max() / 4096:
        raise Refused("degenerate")
    spread = np.linalg.svd(xy[seen] - xy[seen].mean(0), compute_uv=False)
    if spread[1] <= spread[0] / 128:
        raise Refused("degenerate")
    at = (xy - (xy[seen].max(0) + xy[seen].min(0)) / 2) / half
    down, counted = np.array([0.0, 1.0]), seen
    if imputation is not None:
        at = np.clip(impute(at, seen, imputation), -FARTHEST, FARTHEST)
        down, counted = body_axis(at), np.ones(COUNT, bool)
    at = turned(at, down)
    across = at[:, 0] - at[counted, 0].mean()
    along = at[:, 1] - (at[seen, 1].max() + at[seen, 1].min()) / 2
    half = max(np.abs(along[seen]).max(), np.abs(across[seen]).max() / WIDEST)
    at = np.clip(np.stack([across, along], 1) / half, -FARTHEST, FARTHEST)
    at[~counted] = 0
    return Image(at, seen, down)


def body_axis(at: np.ndarray) -> np.ndarray:
    """The direction from the middle of head, neck and shoulders to that of the hips; where the two
    are in one place, the image's own."""
    upper = ("head", "neck_base", "right_shoulder", "left_shoulder")
    axis = mid_hip(at) - np.mean([at[INDEX[name]] for name in upper], 0)
    length = np.hypot(*axis)
    return axis / length if length > 1e-3 else np.array([0.0, 1.0])


def turned(points: np.ndarray, down: np.ndarray) -> np.ndarray:
    """Points [...,2 or 3] in axes of which the second is the direction `down` in the image."""
    axes = np.eye(points.shape[-1])
    axes[:2, :2] = [[down[1], -down[0]], down]
    return points @ axes.T


def impute(xy: np.ndarray, seen: np.ndarray, imputation: np.ndarray) -> np.ndarray:
    """Points [14,2]; those that were not seen [14] are at their conditional mean given the
    others."""
    system = np.eye(COUNT) - imputation
    right = -system[np.ix_(~seen, seen)] @ xy[seen]
    out = xy.copy()
    out[~seen] = np.linalg.solve(system[np.ix_(~seen, ~seen)], right)
    return out


def edm(image: Image) -> np.ndarray:
    """Distances [91] between the joints in the body's frame (eq. 1)."""
    return distances(image.at)


# ---- Networks ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Prediction:
    """What a network says, metres; None: not this kind."""

    share: np.ndarray  # [14], of the image
    distance: np.ndarray | None = None  # [91]
    points: np.ndarray | None = None  # [14,3], their mean is 0


def predict(model: Model, image: Image, up: np.ndarray | None = None) -> Prediction:
    """The network; up [3]: in the camera's axes, of any length."""
    if model.kind == "fconn":
        both = image.seen[PAIRS[0]] & image.seen[PAIRS[1]] | (model.imputation is not None)
        share = np.full(COUNT, model.fusion["share"])
        return Prediction(share, net(model.layers, edm(image) * both))
    of_distances = model.kind == "distances"
    rows = equivariant(model.layers, *inputs(image, up, of_distances))
    gates = joints_of(rows[:, -8:])
    share = (1 + gates / (np.abs(gates) + GATE_SOFTNESS)) / 2
    distance = None
    if of_distances:
        distance = np.zeros(len(PAIRS[0]))
        distance[PAIR_MIRROR.T] = np.maximum(rows[:, :49], 0)
    across = joints_of(rows[:, -32:-24] * [[1], [-1]])
    points = np.stack([across, joints_of(rows[:, -24:-16]), joints_of(rows[:, -16:-8])], 1)
    return Prediction(share, distance, points - points.mean(0))


def net(layers: Layers, x: np.ndarray) -> np.ndarray:
    """FConn: [91] -> [91] metres; section 3.2."""
    for weight, bias in layers:
        x = np.maximum(x @ weight.astype(float) + bias, 0)
    return x


MIDDLE = ("head", "neck_base")
SIDES = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")


def sums(values: np.ndarray) -> list[float]:
    """Of the right and the left joint, twice a joint in the middle: [14] -> 8."""
    middle = [2 * values[INDEX[name]] for name in MIDDLE]
    return middle + [values[INDEX[f"right_{n}"]] + values[INDEX[f"left_{n}"]] for n in SIDES]


def differences(values: np.ndarray) -> list[float]:
    """Of the right and the left joint: [14] -> 6."""
    return [values[INDEX[f"right_{name}"]] - values[INDEX[f"left_{name}"]] for name in SIDES]


def joints_of(rows: np.ndarray) -> np.ndarray:
    """Numbers of joints [14] of rows and mirror rows [2,8]."""
    values = np.zeros(COUNT)
    for row, name in enumerate(MIDDLE):
        values[INDEX[name]] = rows[0, row]
    for row, name in enumerate(SIDES, len(MIDDLE)):
        values[INDEX[f"right_{name}"]], values[INDEX[f"left_{name}"]] = rows[:, row]
    return values


def inputs(
    image: Image, up: np.ndarray | None, of_distances: bool
) -> tuple[np.ndarray, np.ndarray]:
    """What an equivariant network reads: numbers that a mirror leaves alone (even), and those whose
    sign it changes (odd)."""
    (x, y), missing = image.at.T, MISSING_INPUT * ~image.seen
    even, odd = [], []
    if of_distances:
        near = np.minimum(edm(image), LONGEST_2D)
        soft = near**2 / (near + SOFTENING / Q12)
        first, second = soft[PAIR_MIRROR.T]
        even, odd = [*(first + second - 2 * MIDDLE_SOFT)], [*(first - second)[:-SELF_MIRRORED]]
    known = up is not None
    upward = turned(unit(up), image.down) if known else np.zeros(3)
    even += differences(x) + sums(y) + sums(missing)
    even += [2 * (upward[1] + known), 4 * upward[2], known]
    odd += sums(x) + differences(y) + differences(missing) + [2 * upward[0]]
    return np.array(even, float), np.array(odd, float)


def equivariant(layers: Layers, even: np.ndarray, odd: np.ndarray) -> np.ndarray:
    """Rows and mirror rows [2,rows], by a plain network of twice the width.

    A unit reads the first of each mirror pair by the sum of its even and its odd weights and the
    second by their difference; its mirror unit, the other way round.
    """
    x = np.concatenate([even, odd])
    for n, (weight, bias) in enumerate(layers):
        e, o = np.split(weight.astype(float), [len(even) if n == 0 else len(weight) // 2])
        dense = np.block([[e, e], [o, -o]] if n == 0 else [[e + o, e - o], [e - o, e + o]])
        x = x @ dense + np.tile(bias, 2)
        if n < len(layers) - 1:
            x = np.maximum(x, 0)
    return x.reshape(2, -1)


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


def align(points: np.ndarray, onto: np.ndarray, share: float) -> np.ndarray:
    """Weighted mean of two sets of centred points [14,3]: `share` of the first, which are rotated,
    and if need be reflected, onto the others."""
    u, _, vt = np.linalg.svd(points.T @ onto)
    return share * points @ u @ vt + (1 - share) * onto


def orient(points: np.ndarray, image: Image) -> np.ndarray:
    """Scaled-orthographic alignment to the image, ridged by its misfit; the seen joints' mean is
    the origin."""
    points = points - points[image.seen].mean(0)
    seen = points[image.seen]
    flat = image.at[image.seen] - image.at[image.seen].mean(0)
    spread = np.sum(seen**2)

    def rows(ridge: float) -> np.ndarray:
        squares = seen.T @ seen + ridge * spread * np.eye(3)
        u, _, vt = np.linalg.svd(np.linalg.solve(squares, seen.T @ flat).T, full_matrices=False)
        return u @ vt

    across = seen @ rows(LIGHT_RIDGE).T
    scale = np.sum(across * flat) / np.sum(across**2)
    misfit = np.sum((flat / scale - across) ** 2) / spread if scale > 0 else 1.0
    axes = rows(MIN_RIDGE + min(misfit, 1.0))
    return points @ np.vstack([axes, np.cross(axes[0], axes[1])]).T


def fuse(
    points: np.ndarray, image: Image, share: np.ndarray, misfit: float, distance: float
) -> tuple[np.ndarray, float]:
    """Weighted means of the x and y of points of orient() and those of their image; and the root of
    the mean square of the disagreement, metres.

    The image is taken from `distance` metres, and brought to the depth of the joints' middle.  Its
    weight is share / (1 + square / misfit^2), share [14], square being the mean square of the
    disagreement.  The seen joints' mean is the origin.
    """
    seen = image.seen
    points = points - points[seen].mean(0)
    near = image.at[seen] * (1 + points[seen, 2:] / distance)
    near = near - near.mean(0)
    scale = np.sum(points[seen, :2] * near) / np.sum(near**2)
    if scale <= 0:
        return points, float(np.sqrt(np.sum(points[seen, :2] ** 2) / seen.sum()))
    off = scale * near - points[seen, :2]
    square = np.sum(off**2) / seen.sum()
    points[seen, :2] += share[seen, None] / (1 + square / misfit**2) * off
    return points, float(np.sqrt(square))


def lift(
    model: Model, keypoints: np.ndarray, up: np.ndarray | None = None
) -> tuple[np.ndarray, float]:
    """Pose [14,3] and misfit of keypoints [14,3]; raises Refused."""
    image = body_frame(keypoints, model.fewest_joints, model.imputation)
    said = predict(model, image, up)
    points = said.points
    if said.distance is not None:
        points = refine(mds(said.distance), said.distance, model.objective, model.refine_steps)
        if said.points is None:
            points, _ = mirror(orient(points, image), model.mirror)
        else:
            points = align(points, said.points, model.mds_share)
    settings = {name: model.fusion[name] for name in ("misfit", "distance")}
    points, misfit = fuse(points, image, said.share, **settings)
    pose = turned(points, image.down * [-1, 1])
    return pose - mid_hip(pose), misfit
