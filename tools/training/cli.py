"""Trains a network on motion capture: weights to an .npz with a manifest beside it.

    train.py MOTION [MOTION...] --out gen/distances.npz
    train.py MOTION [MOTION...] --recipe direct --out gen/direct.npz
    train.py MOTION --recipe fconn --out gen/fconn.npz
    train.py MOTION --recipe paper --out build/paper.npz

MOTION is an .npz or a folder of motion capture (docs/motion-data.md); poses of those behind the
first are drawn as often as the recipe says.  Every epoch sees fresh cameras, noise, missing joints
and bodies.  First comes the plain L2 loss on the distances (section 3.2), then the error of the
joints of the whole lift, through the MDS and the fusion with the image.  `--hold-out` keeps
subjects out of training to watch the validation error by; a run goes on where its checkpoint (OUT
with suffix .state) left off.
"""

import argparse
import sys
from pathlib import Path

from data.mocap import MocapError, load_motion
from training.manifest import write
from training.recipe import RECIPES, scale_epochs
from training.run import Run, split, train


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("motion", type=Path, nargs="+", help=".npz or folder of motion capture")
    parser.add_argument("--out", type=Path, required=True, help="weights, .npz")
    parser.add_argument("--recipe", choices=RECIPES, default="distances")
    parser.add_argument("--epochs", type=int, help="epochs in all, instead of the recipe's")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--hold-out", type=int, nargs="*", default=[], metavar="SUBJECT", help="validation people"
    )
    return parser.parse_args()


def main() -> int:
    args = arguments()
    state = args.out.with_suffix(".state")
    try:
        motions, held = split([load_motion(path) for path in args.motion], args.hold_out)
        run = Run(motions, scale_epochs(RECIPES[args.recipe], args.epochs), args.seed)
        if state.exists():
            run.load_state(state)
        args.out.parent.mkdir(parents=True, exist_ok=True)
        train(run, held, state)
    except (MocapError, ValueError, FloatingPointError, OSError) as error:
        print(f"train: {error}", file=sys.stderr)
        return 1
    manifest = write(run, args.recipe, args.hold_out, args.out)
    state.unlink()
    if silent := manifest.get("silent_units"):
        print(f"{args.out}: pairs of units that never fire, layer by layer: {silent}")
    people = "people held out" if args.hold_out else "training people"
    print(f"{args.out}: error of {people}, mm: {run.curve[run.epochs]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
