"""Trains FConn or FConv on motion capture: weights to an .npz with a manifest beside it.

    train.py MOTION --out gen/fconn.npz
    train.py MOTION --network fconn --out build/as_in_the_paper.npz
    train.py MOTION --recipe fconv --out gen/fconv.npz
    train.py MOTION --recipe paper --out build/paper.npz

FConn is twin.py's unless --network is `fconn`.  MOTION is an .npz or a folder that tools/mocap.py
reads.  Every epoch sees fresh cameras, noise, missing joints and bodies.  First the plain L2 loss
on the distances (section 3.2), then the error of the joints of the whole lift, through the MDS and
the blend with the image.  `--hold-out` keeps subjects apart to watch the validation error by; a run
goes on where its checkpoint (OUT with suffix .state) left off.
"""

import argparse
import dataclasses
import functools
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType

import jax
import jax.numpy as jnp
import numpy as np
import optax
from tqdm import tqdm

from data import cameras
from data.mocap import MocapError, Motion, load_motion
from edmlift import joints as skeleton
from edmlift.joints import LIMBS, PAIRS
from edmlift.metrics import rigid_errors
from export.weights import NO_BLEND, manifest_text
from fitting.imputation import read_header as read_completion
from model import equivariant, fconn, fconv, jax_stages, reference
from training.mirror import fit_mirror


@dataclasses.dataclass(frozen=True)
class Recipe:
    """Everything that decides the weights, besides the motion and the seed."""

    network: str = "twin"
    l2_epochs: int = 20  # epochs of plain L2 on the distances ...
    mds_epochs: int = 1780  # ... then epochs on the joint error behind the MDS
    batch: int = 64
    rate: float = 1e-3
    drop_rate_at: float = 0.0  # share of the epochs when the rate falls to a tenth; 0: cosine
    clip: float = 0.5  # global norm of the gradient
    distance_share: float = 0.5  # weight of the mean squared distance error, m^2, beside it
    rigid: float = 0.7  # share of the joint error after rigid alignment; the rest in camera axes
    average: float = 0.999  # the saved weights are an exponential moving average; 0: the last ones
    dropout: float = 0.0
    iid: float = 0.5  # share of the poses with iid noise; the others get a detector's
    noise: float = 20.0  # pixels: iid noise is drawn with sigma up to this
    detector: float = 1.5  # detector-like noise is drawn up to this scale
    least: float = 0.0  # share of either that every pose gets
    bodies: bool = True  # vary height and proportions
    masks: bool = True  # hide joints
    complete: bool = True  # hidden joints are where gen/completion.h expects them, not zeros
    flip: bool = True  # mirror half of the motion: left-handed people, too
    mix: float = 0.3  # share of the poses with the arms of another one, and with the legs
    adapted: float = 0.25  # share of the poses whose head and neck are an adapter's
    blend: bool = True  # the joint error is that behind orient.inc and blend.inc, not of the MDS
    balance: float = 0.5  # a subject with n poses is drawn in proportion to n^(1 - balance)


RECIPES = {
    "mds": Recipe(),
    "fconv": Recipe(network="fconv", l2_epochs=5, mds_epochs=25, rigid=1.0),
    "l2": Recipe(l2_epochs=1800, mds_epochs=0, blend=False, rigid=1.0),
    # Section 3.2 of the paper: L2, Adam, batches of 200, dropout 0.5, 500 epochs, the rate
    # divided by ten after 250; no noise or occlusion unless asked for.
    "paper": Recipe(
        network="fconn",
        l2_epochs=500,
        mds_epochs=0,
        batch=200,
        rate=1e-3,
        drop_rate_at=0.5,
        clip=0.0,
        rigid=1.0,
        average=0.0,
        dropout=0.5,
        noise=0.0,
        detector=0.0,
        bodies=False,
        masks=False,
        complete=False,
        flip=False,
        mix=0.0,
        adapted=0.0,
        blend=False,
        balance=0.0,
    ),
}

NETWORKS = {"fconn": fconn, "twin": equivariant, "fconv": fconv}
OBJECTIVES = ("none", "square", "raw", "eq2")  # of the refinement: edml_objective
MAX_MISSING = 4  # most joints hidden in training: the lifter refuses more


def draw_2d(joints: np.ndarray, recipe: Recipe, rng: np.random.Generator):
    """One fresh view of every pose: keypoints [F,14,3] and the truth in camera axes [F,14,3]."""
    if recipe.flip:
        joints = np.where(rng.random((len(joints), 1, 1)) < 0.5, skeleton.mirrored(joints), joints)
    for limbs in (skeleton.ARMS, skeleton.LEGS):
        joints = cameras.mix_limbs(joints, limbs, recipe.mix, rng)
    if recipe.bodies:
        joints = cameras.vary_bodies(joints, rng)
    truth = cameras.look(joints, rng)
    points = cameras.project(truth)
    count = len(points)
    strength = recipe.least + (1 - recipe.least) * rng.random(count)
    iid = rng.random(count) < recipe.iid
    points = cameras.gaussian_noise(points, np.where(iid, strength * recipe.noise, 0.0), rng)
    points = cameras.detector_noise(points, rng, np.where(iid, 0.0, strength * recipe.detector))
    adapted = rng.random(count) < recipe.adapted
    points[adapted] = cameras.adapter_error(points[adapted], truth[adapted], rng)
    seen = draw_masks(count, rng) if recipe.masks else None
    keypoints = cameras.keypoints(points, seen)
    return keypoints.astype(np.float32), truth.astype(np.float32)


def draw_masks(count: int, rng: np.random.Generator) -> np.ndarray:
    """Half of the poses whole, a quarter without 1 to 4 random joints, a quarter without a limb."""
    kind = rng.integers(0, 4, count)
    missing = np.where(kind == 2, rng.integers(1, MAX_MISSING + 1, count), 0)
    seen = cameras.hide_random(count, missing, rng)
    limb = rng.integers(0, len(LIMBS), count)
    for i, name in enumerate(LIMBS):
        chosen = (kind == 3) & (limb == i)
        seen[chosen] = cameras.hide_limb(int(chosen.sum()), name)
    return seen


def pick_poses(subject: np.ndarray, recipe: Recipe, rng: np.random.Generator) -> np.ndarray:
    """Indices of an epoch: as many poses as there are, subjects balanced as the recipe says."""
    if recipe.balance == 0.0:
        return rng.permutation(len(subject))
    _, inverse, counts = np.unique(subject, return_inverse=True, return_counts=True)
    weight = counts[inverse] ** -recipe.balance
    return rng.choice(len(subject), len(subject), p=weight / weight.sum())


def distance_losses(recipe: Recipe):
    """The loss of each phase: (params, keypoints [B,14,3], truth [B,14,3], key) -> a number, and
    what of the parameters is observed instead of trained."""
    net = NETWORKS[recipe.network]
    completion = completion_of(recipe)
    if recipe.mds_epochs > 0 and recipe.rigid < 1 and not recipe.blend:
        raise ValueError("rigid must be 1 without the blend: the points are in axes of their own")

    def forward(params, keypoints, key):
        return net.forward(params, jax_stages.edm_2d(keypoints, completion), key, recipe.dropout)

    def l2_loss(params, keypoints, truth, key):
        predicted, observed = forward(params, keypoints, key)
        return jnp.mean((predicted - jax_stages.edm_3d(truth)) ** 2), observed

    def mds_loss(params, keypoints, truth, key):
        predicted, observed = forward(params, keypoints, key)
        pose = poses(predicted, keypoints, truth, params.get("blend"))
        error = jax_stages.joint_errors(pose, truth).mean()
        if recipe.rigid < 1:
            turned = jax_stages.camera_errors(pose, truth).mean()
            error = recipe.rigid * error + (1 - recipe.rigid) * turned
        share = jnp.mean((predicted - jax_stages.edm_3d(truth)) ** 2)
        return error + recipe.distance_share * share, observed

    return l2_loss, mds_loss


def completion_of(recipe: Recipe) -> np.ndarray | None:
    """For jax_stages.edm_2d(): [14,14], or None."""
    return read_completion().astype(np.float32) if recipe.complete else None


def poses(distances, keypoints, truth, blend):
    """What errors are measured of, [B,14,3]; blend None: the points of the MDS, in their axes."""
    if blend is None:
        return jax_stages.classical_mds(distances)
    return jax_stages.poses(distances, keypoints, truth, blend)


def make_epoch(loss, recipe: Recipe, optimizer: optax.GradientTransformation):
    """The jitted epoch of a loss: (carry, keypoints, truth, key) -> (carry, mean loss).

    carry is (params, their average, the optimizer's state); keypoints and truth are the epoch's
    batches [steps,B,14,3].
    """

    def step(carry, batch):
        params, average, state = carry
        (value, observed), gradient = jax.value_and_grad(loss, has_aux=True)(params, *batch)
        updates, state = optimizer.update(gradient, state, params)
        params = optax.apply_updates(params, updates) | observed
        average = optax.incremental_update(params, average, 1 - recipe.average)
        return (params, average, state), value

    def run(carry, keypoints, truth, key):
        keys = jax.random.split(key, len(keypoints))
        carry, values = jax.lax.scan(step, carry, (keypoints, truth, keys))
        return carry, values.mean()

    return jax.jit(run)


def make_optimizer(recipe: Recipe, steps_per_epoch: int) -> optax.GradientTransformation:
    total = (recipe.l2_epochs + recipe.mds_epochs) * steps_per_epoch
    if recipe.drop_rate_at > 0:
        schedule = optax.piecewise_constant_schedule(
            recipe.rate, {int(total * recipe.drop_rate_at): 0.1}
        )
    else:
        schedule = optax.warmup_cosine_decay_schedule(
            0.0, recipe.rate, min(2 * steps_per_epoch, total // 2), total, recipe.rate * 1e-3
        )
    clip = optax.clip_by_global_norm(recipe.clip) if recipe.clip > 0 else optax.identity()
    return optax.chain(clip, optax.adam(schedule))


def validation_set(joints: np.ndarray, seed: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Fixed views of the people held out: exact, noisy, detector-like, two joints missing."""
    rng = np.random.default_rng([seed, 1 << 30])
    truth = cameras.look(joints, rng)
    points = cameras.project(truth)
    hidden = cameras.hide_random(len(points), 2, rng)
    columns = {
        "gt": cameras.keypoints(points),
        "n10": cameras.keypoints(cameras.gaussian_noise(points, 10.0, rng)),
        "cpm": cameras.keypoints(cameras.detector_noise(points, rng)),
        "rand2": cameras.keypoints(points, hidden),
    }
    return {name: (k.astype(np.float32), truth.astype(np.float32)) for name, k in columns.items()}


BLOCK = 500  # views that a network takes at once


@functools.partial(jax.jit, static_argnums=0)
def predict_block(net: ModuleType, params, keypoints: jax.Array, completion) -> jax.Array:
    return net.predict(params, jax_stages.edm_2d(keypoints, completion))


def predict(recipe: Recipe, params, keypoints: np.ndarray) -> np.ndarray:
    """Distances [F,91] of keypoints [F,14,3], a block at a time."""
    net, completion = NETWORKS[recipe.network], completion_of(recipe)
    blocks = [keypoints[i : i + BLOCK] for i in range(0, len(keypoints), BLOCK)]
    return np.concatenate([predict_block(net, params, block, completion) for block in blocks])


@jax.jit
def mean_errors(distances, keypoints, truth, blend):
    """The mean of each pose's, [B]."""
    return jax_stages.joint_errors(poses(distances, keypoints, truth, blend), truth).mean(1)


def validate(recipe: Recipe, params, columns, subject: np.ndarray) -> dict[str, float]:
    """Oracle-mirror error of each column in mm: the mean over subjects of their means."""
    result = {}
    for name, (keypoints, truth) in columns.items():
        distances = predict(recipe, params, keypoints)
        error = np.asarray(mean_errors(distances, keypoints, truth, params.get("blend")))
        means = [error[subject == s].mean() for s in np.unique(subject)]
        result[name] = round(float(1000 * np.mean(means)), 2)
    return result


class Run:
    """A training run: parameters, their average, and the optimizer, epoch by epoch."""

    def __init__(self, motion: Motion, recipe: Recipe, seed: int):
        self.motion, self.recipe, self.seed = motion, recipe, seed
        self.steps = len(motion.joints) // recipe.batch
        if self.steps == 0:
            raise MocapError(f"{len(motion.joints)} poses do not fill a batch of {recipe.batch}")
        optimizer = make_optimizer(recipe, self.steps)
        self.l2_epoch, self.mds_epoch = (
            make_epoch(loss, recipe, optimizer) for loss in self.losses()
        )
        params = self.start()
        if recipe.blend:
            params = params | {"blend": jax_stages.BLEND}
        self.carry = (params, params, optimizer.init(params))
        self.epoch = 0
        self.curve: dict[int, dict[str, float]] = {}  # epoch -> validation error by column, mm

    def losses(self):
        """Of the first phase and of the second."""
        return distance_losses(self.recipe)

    def start(self) -> dict[str, jax.Array]:
        """The network's parameters before the first epoch."""
        joints = self.motion.joints
        mean = np.linalg.norm(joints[:, PAIRS[0]] - joints[:, PAIRS[1]], axis=-1).mean(0)
        return self.network.init(mean, self.seed)

    @property
    def network(self) -> ModuleType:
        return NETWORKS[self.recipe.network]

    @property
    def epochs(self) -> int:
        return self.recipe.l2_epochs + self.recipe.mds_epochs

    @property
    def params(self) -> dict[str, jax.Array]:
        """The averaged weights: what is validated and saved."""
        return self.carry[1]

    def draw(self, epoch: int) -> tuple[np.ndarray, np.ndarray]:
        """The batches of an epoch, from the seed and its number alone."""
        rng = np.random.default_rng([self.seed, epoch])
        chosen = pick_poses(self.motion.subject, self.recipe, rng)[: self.steps * self.recipe.batch]
        keypoints, truth = draw_2d(self.motion.joints[chosen], self.recipe, rng)
        shape = (self.steps, self.recipe.batch, *truth.shape[1:])
        return keypoints.reshape(shape), truth.reshape(shape)

    def advance(self, batches: tuple[np.ndarray, np.ndarray]) -> float:
        """One epoch; returns the mean loss."""
        step = self.l2_epoch if self.epoch < self.recipe.l2_epochs else self.mds_epoch
        self.carry, loss = step(self.carry, *batches, jax.random.key(self.epoch))
        self.epoch += 1
        return float(loss)

    def save_state(self, path: Path) -> None:
        leaves = jax.tree.leaves(self.carry)
        temporary = path.with_suffix(".tmp")
        about = {"epoch": self.epoch, "curve": json.dumps(self.curve), "recipe": self.describe()}
        with temporary.open("wb") as file:
            np.savez(file, *map(np.asarray, leaves), **about)
        temporary.replace(path)

    def load_state(self, path: Path) -> None:
        with np.load(path) as state:
            if str(state["recipe"]) != self.describe():
                raise ValueError(f"{path}: of another recipe or seed; remove it to start anew")
            leaves = [jnp.asarray(state[f"arr_{i}"]) for i in range(len(state.files) - 3)]
            self.carry = jax.tree.unflatten(jax.tree.structure(self.carry), leaves)
            self.epoch = int(state["epoch"])
            self.curve = {int(epoch): row for epoch, row in json.loads(str(state["curve"])).items()}

    def describe(self) -> str:
        return json.dumps({"seed": self.seed, **dataclasses.asdict(self.recipe)})


def split(motion: Motion, held_out: list[int]) -> tuple[Motion, Motion]:
    """Training and validation people; without any held out, both are everyone."""
    apart = np.isin(motion.subject, held_out)
    missing = set(held_out) - set(motion.subject.tolist())
    if missing:
        raise MocapError(f"no subject {sorted(missing)} in {motion.source}")
    return motion.take(~apart), motion.take(apart if held_out else ~apart)


STOPS = 30  # of a run, for validation and a checkpoint


def train(run: Run, held: Motion, state: Path) -> None:
    """Runs to the last epoch with a progress bar."""
    sample = held.take(np.arange(0, len(held.joints), max(1, len(held.joints) // 3000)))
    columns = validation_set(sample.joints, run.seed)
    with (
        ThreadPoolExecutor(1) as pool,  # draws the next epoch while this one trains
        tqdm(total=run.epochs, initial=run.epoch, unit="epoch") as bar,
    ):
        following = pool.submit(run.draw, run.epoch)
        while run.epoch < run.epochs:
            batches = following.result()
            following = pool.submit(run.draw, run.epoch + 1)
            loss = run.advance(batches)
            if not np.isfinite(loss):
                raise FloatingPointError(f"loss is {loss} in epoch {run.epoch}: lower the rate")
            if run.epoch % max(1, run.epochs // STOPS) == 0 or run.epoch == run.epochs:
                error = validate(run.recipe, run.params, columns, sample.subject)
                run.curve[run.epoch] = {"loss": round(loss, 4), **error}
                run.save_state(state)
            bar.update()
            bar.set_postfix(next(reversed(run.curve.values()), {"loss": loss}))


def aspect(keypoints: np.ndarray) -> np.ndarray:
    """Width over height of the seen joints' box: [F,14,3] -> [F]."""
    points = np.where(keypoints[..., 2:] > 0, keypoints[..., :2], np.nan)
    width, height = np.moveaxis(np.nanmax(points, 1) - np.nanmin(points, 1), -1, 0)
    return width / height


WIDEST = 3.5  # what the ranges of fixed point allow for; of 100,000 views, a handful are wider
REFINE_STEPS = 10  # tried for each objective
REFINE_SAMPLE = 300  # poses


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


def settings(run: Run) -> dict:
    """What the library needs beside the layers, measured on a few epochs of training views."""
    widest, distances, points, truths = 0.0, [], [], []
    for epoch in range(3):
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
        "fewest_joints": 14 - MAX_MISSING if run.recipe.masks else 14,
        "missing": "completed" if run.recipe.complete else "zero",
        "widest": min(float(np.ceil(2 * widest) / 2), WIDEST),
        "objective": objective,
        "refine_steps": 0 if objective == "none" else REFINE_STEPS,
        "refinement_mm": errors,
        "mirror": [round(float(w), 4) for w in weights],
        "blend": blend_settings(run.params.get("blend")),
    }


def blend_settings(trained: jax.Array | None) -> dict[str, float]:
    """For the manifest; a share of 0 leaves poses as they are."""
    if trained is None:
        return dict(NO_BLEND)
    share, misfit, distance = (float(value) for value in jax_stages.blend_settings(trained))
    return {"share": round(share, 4), "misfit": round(misfit, 5), "distance": round(distance, 3)}


def origin(motion: Motion, held_out: list[int]) -> dict:
    """What was trained on, for manifests."""
    return {
        "source": motion.source,
        "poses": len(motion.joints),
        "subjects": np.unique(motion.subject).tolist(),
        "held_out": held_out,
        "sha256": motion.sha256,
    }


def by_column(curve: dict[int, dict[str, float]]) -> dict[str, list[float]]:
    """A curve as a list a column, the epochs first."""
    columns = next(iter(curve.values()))
    return {"epoch": [*curve], **{name: [row[name] for row in curve.values()] for name in columns}}


def write(run: Run, name: str, held_out: list[int], out: Path):
    """Weights to `out` and the manifest beside it."""
    arrays = run.network.shipped(run.params)
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("wb") as file:
        np.savez(file, **arrays)
    manifest = settings(run) | {
        "recipe": {"name": name, "seed": run.seed, **dataclasses.asdict(run.recipe)},
        "data": origin(run.motion, held_out),
        # Better of pose and reflection, mm; of people who were trained on, if none were held out.
        "validation" if held_out else "training_people": by_column(run.curve),
    }
    out.with_suffix(".json").write_text(manifest_text(manifest))


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, help=".npz or folder of motion capture")
    parser.add_argument("--out", type=Path, required=True, help="weights, .npz")
    parser.add_argument("--recipe", choices=RECIPES, default="mds")
    parser.add_argument("--network", choices=NETWORKS, help="instead of the recipe's")
    parser.add_argument("--epochs", type=int, help="epochs in all, instead of the recipe's")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--hold-out", type=int, nargs="*", default=[], metavar="SUBJECT", help="validation people"
    )
    return parser.parse_args()


def shorten(recipe: Recipe, epochs: int | None) -> Recipe:
    """The recipe with its epochs scaled to a total."""
    if epochs is None:
        return recipe
    total = recipe.l2_epochs + recipe.mds_epochs
    l2 = round(epochs * recipe.l2_epochs / total)
    if recipe.mds_epochs > 0:
        l2 = max(l2, epochs // 6)  # few as they are, they must get the MDS near enough
    return dataclasses.replace(recipe, l2_epochs=l2, mds_epochs=epochs - l2)


def main() -> int:
    args = arguments()
    state = args.out.with_suffix(".state")
    try:
        motion, held = split(load_motion(args.motion), args.hold_out)
        recipe = RECIPES[args.recipe]
        if args.network is not None:
            recipe = dataclasses.replace(recipe, network=args.network)
        run = Run(motion, shorten(recipe, args.epochs), args.seed)
        if state.exists():
            run.load_state(state)
        args.out.parent.mkdir(parents=True, exist_ok=True)
        train(run, held, state)
    except (MocapError, ValueError, FloatingPointError, OSError) as error:
        print(f"train: {error}", file=sys.stderr)
        return 1
    write(run, args.recipe, args.hold_out, args.out)
    state.unlink()
    people = "people held out" if args.hold_out else "training people"
    error = run.curve[run.epochs]
    print(f"{args.out}: error of {people}, mm, better of pose and reflection: {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
