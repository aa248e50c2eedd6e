"""What each part of the networks and of their training gives, on people held out.

    run.py experiments.ablations --train MOTION ... [--recipes NAMES] [--epochs 60]
                     [--out build/recipes] [--json docs/accuracy/recipes.json]
                     [--update docs/accuracy-log.md]

First the paper's FConn, from the paper's training (L2 with dropout, section 3.2) to ours; then the
networks of the library without one part, or trained without one thing.  All are equally long, and
measured where training watches them, in its own arithmetic.  Motion is .npz files or folders of
motion capture, CMU's first.  A run goes on where its checkpoint (in OUT) left off.
"""

import argparse
import dataclasses
import functools
import json
import sys
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from data.mocap import MocapError, load_motion
from data.paths import DOCS
from experiments.runs import HELD_OUT, finish
from model import jax_stages, lifter
from model.manifest import write_manifest
from reports import markdown
from training.loss import NETWORKS, Loss, Params, lifter_losses, mean_errors, validate
from training.recipe import EVEN_NOISE, RECIPES, Recipe, scale_epochs
from training.run import Run, origin, split
from training.views import Views, imputation_of

RESULTS = DOCS / "accuracy" / "recipes.json"
SHOWN = ("gt", "gt_camera", "n10", "cpm", "cpm_camera", "left_leg", "gt_up_camera")  # in the table
NOTHING = -1e6  # a gate that leaves the image alone


@dataclasses.dataclass(frozen=True)
class Part(Recipe):
    """A recipe of an equivariant network; "frame", "mask", "gates", "image" or "mds" is what
    it goes without.  `alone` is the column whose views it sees, if it sees no others."""

    without: str = ""
    alone: str = ""


def part(kind: str, **changes: Any) -> Part:
    """The recipe of a kind of network, but for the changes."""
    return Part(**dataclasses.asdict(RECIPES[kind]) | EVEN_NOISE | changes)


paper = functools.partial(dataclasses.replace, RECIPES["paper"])
detector = {"detector": 1.0, "least": 1.0}  # as noisy as the column cpm, always
unshaped = {"direction_weight": 0.0, "flexion_weight": 0.0, "straight_weight": 0.0}


def alone(column: str, **noise: float) -> Part:
    """The recipe of `direct` with the views of a column and no others."""
    others = {"near": 0.0, "up": 0.0, "adapted": 0.0, "redefined": 0.0, "least": 1.0}
    return part("direct", alone=column, masks=False, **others, **noise)


# Each row of FConn changes the one above it; those of ours, the first of them.
ABLATIONS: dict[str, Recipe] = {
    "FConn: the paper's, exact 2D": paper(),
    "FConn: the paper's, both exact and detector's": paper(**detector),
    "FConn: joints hidden": paper(masks=True, **detector),
    "FConn: without dropout": paper(masks=True, dropout=0.0, **detector),
    "FConn: our views, bodies and motion": RECIPES["l2"],
    "FConn: through the MDS and the image": RECIPES["fconn"],
    "distances": part("distances"),
    "distances: in the image's own axes": part("distances", without="frame"),
    "distances: one gate for all joints": part("distances", without="gates"),
    "distances: read and learned, without the MDS": part("distances", without="mds"),
    "direct": part("direct"),
    "direct: in the image's own axes": part("direct", without="frame"),
    "direct: one gate for all joints": part("direct", without="gates"),
    "direct: not moved to the image": part("direct", without="image"),
    "direct: not told what is missing": part("direct", without="mask"),
    "direct: never told of up": part("direct", up=0.0),
    "direct: CMU's people alone": part("direct", others=0.0),
    "direct: half of other laboratories": part("direct", others=0.5),
    "direct: no camera near": part("direct", near=0.0),
    "direct: no other joint definitions": part("direct", redefined=0.0, adapted=0.0),
    "direct: limbs not mixed": part("direct", mix=0.0),
    "direct: error aligned alone": part("direct", rigid=1.0),
    "direct: error in camera axes alone": part("direct", rigid=0.0),
    "direct: no directions, no flexions": part("direct", **unshaped),
    "direct: for the column gt alone": alone("gt", iid=1.0, noise=0.0),
    "direct: for the column n10 alone": alone("n10", iid=1.0, noise=10.0),
    "direct: for the column cpm alone": alone("cpm", iid=0.0, detector=1.0),
}


def lift(recipe: Part, params: Params, views: Views) -> tuple[jax.Array, lifter.Output]:
    """loss.lift() without the part."""
    image = jax_stages.body_frame(
        views.keypoints, imputation_of(recipe), upright=recipe.without == "frame"
    )
    told = image._replace(seen=jnp.ones_like(image.seen)) if recipe.without == "mask" else image
    output = lifter.run(recipe.network, params, told, views.up)
    if recipe.without == "gates":
        output = output._replace(gates=params["share"] * jnp.ones_like(output.gates))
    elif recipe.without == "image":
        output = output._replace(gates=jnp.full_like(output.gates, NOTHING))
    kept = output._replace(distances=None) if recipe.without == "mds" else output
    return lifter.poses(params, image, kept), output


@functools.partial(jax.jit, static_argnums=0)
def errors(recipe: Part, params: Params, views: Views) -> tuple[jax.Array, jax.Array]:
    """As loss.block_errors() has them."""
    pose, _ = lift(recipe, params, views)
    return mean_errors(pose, views.truth, mirror=False)


class PartRun(Run):
    """The training of a network without a part."""

    recipe: Part

    def losses(self) -> tuple[Loss, Loss]:
        return lifter_losses(self.recipe, lift)

    def start(self) -> Params:
        share = {"share": jnp.array(0.1, jnp.float32)} if self.recipe.without == "gates" else {}
        return super().start() | share

    def validate(self, columns: dict[str, Views], subject: np.ndarray) -> dict[str, float]:
        return validate(functools.partial(errors, self.recipe, self.params), columns, subject)


def entry(run: Run) -> dict[str, Any]:
    """A recipe's entry in the JSON: what it is, and its errors."""
    row = run.curve[run.epochs]
    if run.recipe.network in NETWORKS and not run.recipe.fuse:  # not in the camera's axes
        row = {name: value for name, value in row.items() if not name.endswith("_camera")}
    if not run.recipe.up:  # it cannot be told
        row = {name: value for name, value in row.items() if " gt_up" not in name}
    if isinstance(run.recipe, Part) and run.recipe.alone:
        row = {n: value for n, value in row.items() if f" {run.recipe.alone}" in n}
    return {
        "recipe": {"seed": run.seed} | dataclasses.asdict(run.recipe),
        "data": origin(run.motions, HELD_OUT),
        "validation": row,
    }


def report(results: dict[str, dict]) -> str:
    """A table for each motion of the people held out, a row a recipe."""
    names = next(iter(results.values()))["validation"]
    stems = dict.fromkeys(name.rpartition(" ")[0] for name in names if " " in name)
    heads = [name.replace("_camera", ", camera axes").replace("gt_up", "up") for name in SHOWN]
    tables = []
    for stem in stems:
        rows = {
            title: [entry["validation"].get(f"{stem} {name}") for name in SHOWN]
            for title, entry in results.items()
        }
        tables.append(markdown.table(f"{stem}, people held out, mm", heads, rows))
    return "\n".join(tables)


def record(path: Path, entries: dict[str, dict]) -> dict[str, dict]:
    """Puts entries into the JSON; returns all that it then has, in the order of ABLATIONS."""
    both = (json.loads(path.read_text()) if path.exists() else {}) | entries
    results = {name: both[name] for name in ABLATIONS if name in both}
    write_manifest(path, results)
    return results


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--train", type=Path, nargs="+", metavar="MOTION", required=True, help="CMU's first"
    )
    parser.add_argument(
        "--recipes", nargs="+", choices=ABLATIONS, metavar="NAME", default=list(ABLATIONS)
    )
    parser.add_argument("--epochs", type=int, default=60, help="of each run (%(default)s)")
    parser.add_argument("--out", type=Path, default=Path("build/recipes"), help="for checkpoints")
    parser.add_argument("--json", type=Path, default=RESULTS, help="for results (%(default)s)")
    parser.add_argument("--update", type=Path, help="Markdown with marks for the tables")
    parser.add_argument("--seed", type=int, default=0)
    return parser.parse_args()


def main() -> int:
    args = arguments()
    try:
        motions, held = split([load_motion(path) for path in args.train], HELD_OUT)
        args.out.mkdir(parents=True, exist_ok=True)
        for name in args.recipes:
            print(name, file=sys.stderr)
            recipe = scale_epochs(ABLATIONS[name], args.epochs)
            run = (PartRun if isinstance(recipe, Part) else Run)(motions, recipe, args.seed)
            state = args.out / f"{list(ABLATIONS).index(name)}.state"
            results = record(args.json, {name: entry(finish(run, held, state))})
    except (MocapError, ValueError, FloatingPointError, OSError) as error:
        print(f"ablations: {error}", file=sys.stderr)
        return 1
    text = report(results)
    print(text, end="")
    if args.update:
        markdown.write(args.update, "recipes", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
