"""The paper's protocols on Human3.6M and HumanEva-I, for who holds them (docs/h36m.md).

    evaluate.py h36m h36m data_3d_h36m.npz --cameras h36m_dataset.py --protocol 3 [--model fconn]
    evaluate.py h36m humaneva data_3d_humaneva15.npz --cameras humaneva_dataset.py
    evaluate.py h36m ... --train [--recipe paper]    trains on the protocol's training people first

Prints the error in mm of each action, of exact, noisy and incomplete 2D, and the paper's own
figures below.  The error is the mean distance of the 14 joints after the best
rotation and translation, without scale, in every protocol (section 4: "rigidly aligning"); a figure
is the mean over frames of an action, the average that over actions (HumanEva: over people).
"""

import argparse
import re
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from tqdm import tqdm

from data import h36m
from data.h36m import Camera, Layout, Sequences
from data.mocap import Cleaning, MocapError, Motion, Trial, clean, save_motion
from data.paths import ROOT
from data.views import SEED, Column, conditions
from edmlift.library import Library
from edmlift.metrics import rigid_errors
from evaluation.command import Evaluation, Tables, base_model
from evaluation.measures import rounded
from export.build import build_library
from reports.markdown import table

HEAD_LAYOUT = "h36m17_right_first"  # the adapter for the head that both data sets have


@dataclass(frozen=True)
class Protocol:
    """Who is trained on and who tested, by which cameras, on which frames."""

    layout: Layout
    train: tuple[str, ...]  # subjects, as the file names them
    test: tuple[str, ...]
    actions: dict[str, str]  # name of the sequences, without number -> title in the paper
    camera: str | None = None  # the only one tested; None: all
    every: int = 1  # frames: every n-th is tested
    by_person: bool = False  # a column is an action of a person
    paper: tuple[tuple[str, tuple[float, ...]], ...] = ()  # rows of its tables, averages included


H36M_ACTIONS = {
    "Directions": "Direct.",
    "Discussion": "Discuss",
    "Eating": "Eat",
    "Greeting": "Greet",
    "Phoning": "Phone",
    "Posing": "Pose",
    "Purchases": "Purch.",
    "Sitting": "Sit",
    "SittingDown": "SitD",
    "Smoking": "Smoke",
    "Photo": "Photo",
    "Waiting": "Wait",
    "Walking": "Walk",
    "WalkDog": "WalkD",
    "WalkTogether": "WalkT",
}
# The paper does not number the frontal view; SPIN takes this camera for it.
FRONTAL = "60457274"
FIVE = ("S1", "S5", "S6", "S7", "S8")


def numbers(text: str) -> tuple[float, ...]:
    """A row of the paper's tables."""
    return tuple(map(float, text.split()))


FIRST = Protocol(
    h36m.H36M,
    FIVE,
    ("S9", "S11"),
    H36M_ACTIONS,
    every=8,
    paper=(
        (
            "FConv, CPM's 2D",
            numbers(
                "69.54 80.15 78.20 87.01 100.75 76.01 69.65 104.71 113.91 89.68 102.71 98.49 79.18"
                " 82.40 77.17 87.30"
            ),
        ),
    ),
)
SECOND = replace(
    FIRST,
    camera=FRONTAL,
    paper=(
        (
            "FConv, CPM's 2D",
            numbers(
                "66.07 77.94 72.58 84.66 99.71 74.78 65.29 93.40 103.14 85.03 98.52 98.78 78.12"
                " 80.05 74.77 83.52"
            ),
        ),
    ),
)
THIRD = replace(
    SECOND,
    train=(*FIVE, "S9"),
    test=("S11",),
    every=64,
    paper=(
        (
            "FConv, CPM's 2D",
            numbers(
                "67.44 63.76 87.15 73.91 71.48 69.88 65.08 71.69 98.63 81.33 93.25 74.62 76.51"
                " 77.72 74.63 76.47"
            ),
        ),
        (
            "FConv, gt",
            numbers(
                "53.51 50.52 65.76 62.47 56.9 60.63 50.83 55.95 79.62 63.68 80.83 61.80 59.42"
                " 68.53 62.11 62.17"
            ),
        ),
        (
            "FConv, n10",
            numbers(
                "76.46 70.74 77.18 77.25 73.42 81.94 64.65 71.05 97.08 76.91 93.45 77.12 85.14"
                " 80.96 83.47 79.12"
            ),
        ),
        (
            "FConv, n20",
            numbers(
                "109.84 110.21 117.13 115.16 107.08 116.92 107.14 101.82 131.43 114.76 115.07"
                " 112.54 125.50 118.93 129.73 115.55"
            ),
        ),
    ),
)
HUMANEVA = Protocol(
    h36m.HUMANEVA,
    ("Train/S1", "Train/S2", "Train/S3"),
    ("Validate/S1", "Validate/S2", "Validate/S3"),
    {"Walking": "Walking", "Jog": "Jogging", "Box": "Boxing"},
    camera="C1",
    by_person=True,
    paper=(
        (
            "FConv trained on GT+CPM, CPM's 2D",
            numbers("19.72 13.52 26.46 19.90 34.64 17.85 20.05 24.18 45.67 47.52 57.63 50.27"),
        ),
        (
            "FConv trained on GT+CPM, CPM's 2D",
            numbers("19.68 13.02 24.89 19.20 39.69 20.04 21.04 26.92 46.63 47.56 46.45 46.88"),
        ),
    ),
)
H36M_PROTOCOLS = {1: FIRST, 2: SECOND, 3: THIRD}


# What a protocol takes of a data set


def number_of(subject: str) -> int:
    """ "Validate/S2" -> 2."""
    return int(subject.rpartition("S")[2])


def action_of(sequence: str) -> str:
    """Name without number of take and piece: "Walking 1 chunk0" -> "Walking"."""
    return re.sub(r"( \d+)?( chunk\d+)?$", "", sequence)


@dataclass(frozen=True)
class Taken:
    """A sequence that a protocol uses."""

    subject: str
    action: str
    trial: int  # number of the sequence among the subject's
    joints: np.ndarray  # [F,14,3] metres, y up, all frames


def take(data: Sequences, subjects: tuple[str, ...], protocol: Protocol) -> list[Taken]:
    """The sequences of some subjects; an error names what is missing."""
    result = []
    name = protocol.layout.name
    for subject in subjects:
        if subject not in data:
            raise MocapError(f"{name}: no subject {subject}; there are {', '.join(map(str, data))}")
        sequences = sorted(data[subject].items())
        for action in protocol.actions:
            chosen = [(i, s) for i, (n, s) in enumerate(sequences) if action_of(n) == action]
            if not chosen:
                raise MocapError(f"{name}: {subject} has no sequence '{action}'")
            result += [Taken(subject, action, i, joints) for i, joints in chosen]
    return result


def to_motion(taken: list[Taken], frames: list[np.ndarray], source: str) -> Motion:
    """Some frames of sequences, as the other tools read them."""
    counts = [len(f) for f in frames]
    actions = tuple(dict.fromkeys(t.action for t in taken))
    person = [number_of(t.subject) for t in taken]
    return Motion(
        np.concatenate([t.joints[f] for t, f in zip(taken, frames, strict=True)]).astype(
            np.float32
        ),
        np.repeat(person, counts),
        np.repeat([t.trial for t in taken], counts),
        np.concatenate(frames),
        np.repeat([actions.index(t.action) for t in taken], counts),
        actions,
        source,
    )


def training_motion(data: Sequences, protocol: Protocol, cleaning: Cleaning) -> Motion:
    """The training people, thinned as all motion capture is."""
    taken = take(data, protocol.train, protocol)
    trials = [
        Trial(t.joints, np.zeros(len(t.joints), bool), protocol.layout.fps)
        for t in tqdm(taken, desc="thin", disable=None)
    ]
    return to_motion(taken, [clean(t, cleaning) for t in trials], protocol.layout.name)


def test_motion(data: Sequences, protocol: Protocol) -> Motion:
    """The frames tested, once each."""
    taken = take(data, protocol.test, protocol)
    frames = [np.arange(0, len(t.joints), protocol.every) for t in taken]
    return to_motion(taken, frames, protocol.layout.name)


@dataclass(frozen=True)
class Views:
    """The poses tested, as the data set's cameras see them; V is poses times cameras."""

    truth: np.ndarray  # [V,14,3] camera axes, metres
    exact: np.ndarray  # [V,14,2] pixels
    column: np.ndarray  # [V] index into `columns`
    columns: list[str]


def project(motion: Motion, rig: dict[str, list[Camera]], protocol: Protocol) -> Views:
    """The poses before the protocol's cameras."""
    truth, exact, column = [], [], []
    people = {number_of(s): s.rpartition("/")[2] for s in protocol.test}
    columns = column_titles(protocol)
    for person, name in people.items():
        watching = [c for c in rig.get(name, []) if protocol.camera in (None, c.name)]
        if not watching:
            raise MocapError(
                f"{protocol.layout.name}: no camera {protocol.camera or 'at all'} of {name}"
            )
        some = motion.take(motion.subject == person)
        titles = [protocol.actions[motion.action_names[a]] for a in some.action]
        if protocol.by_person:
            titles = [f"{title} {name}" for title in titles]
        for camera in watching:
            truth.append(camera.look(some.joints.astype(float)))
            exact.append(camera.project(truth[-1]))
            column += [columns.index(title) for title in titles]
    return Views(np.concatenate(truth), np.concatenate(exact), np.array(column), columns)


def column_titles(protocol: Protocol) -> list[str]:
    """Columns of the table, averages apart."""
    if not protocol.by_person:
        return list(protocol.actions.values())
    people = [s.rpartition("/")[2] for s in protocol.test]
    return [f"{title} {person}" for title in protocol.actions.values() for person in people]


# Figures


def adapt(library: Library, keypoints: np.ndarray) -> np.ndarray:
    """Head and neck to where the shipped models have them; a hidden joint stays hidden."""
    layout = library.format(HEAD_LAYOUT)
    seventeen = np.zeros((len(keypoints), layout.keypoints, 3))
    seventeen[:, list(layout.limb)] = keypoints[:, 2:]
    seventeen[:, layout.centre] = keypoints[:, 0]
    return library.adapt(seventeen, HEAD_LAYOUT)


def measure(library: Library, condition: Column, views: Views, adapted: bool) -> dict[str, list]:
    """Figures of each column of the table: mm, and the number of poses refused.

    With `adapted`, head and neck of the input go through the adapter; the truth is the data set's.
    """
    keypoints = adapt(library, condition.keypoints) if adapted else condition.keypoints
    poses = library.lift(keypoints)
    fine = poses.status == "ok"
    joints, truth = poses.joints[fine].astype(float), condition.truth[fine]
    error, mirrored = (1000 * rigid_errors(joints * [1, 1, z], truth) for z in (1, -1))
    hidden = ~condition.seen[fine]
    column = views.column[fine]
    figures: dict[str, list] = {"error": [], "limbs": [], "mirror": [], "refused": []}
    if hidden.any():
        figures["hidden"] = []
    for i in range(len(views.columns)):
        own = column == i
        if not own.any():
            raise MocapError(f"every pose of '{views.columns[i]}' was refused")
        figures["error"].append(error[own].mean())
        figures["limbs"].append(error[own, 2:].mean())
        figures["mirror"].append(np.minimum(error.mean(1), mirrored.mean(1))[own].mean())
        figures["refused"].append(int((~fine & (views.column == i)).sum()))
        if hidden.any():
            figures["hidden"].append(error[own][hidden[own]].mean())
    return figures


def evaluate(library: Library, views: Views, adapted: bool) -> dict[str, dict[str, list]]:
    """Figures of every condition: {condition: {figure: [a number a column]}}."""
    columns = conditions(views.truth, views.exact, np.random.default_rng(SEED))
    bar = tqdm(columns.items(), desc="evaluate", disable=None)
    return {name: measure(library, c, views, adapted) for name, c in bar}


def with_averages(values: list[float], protocol: Protocol) -> list[float]:
    """The columns, an average after all of them, or after the people of each action."""
    size = len(protocol.test) if protocol.by_person else len(values)
    blocks = np.reshape(values, (-1, size))
    return np.column_stack([blocks, blocks.mean(1)]).ravel().tolist()


def report(figures: dict, views: Views, protocol: Protocol) -> str:
    """A row a condition, a column an action; then what the paper has."""
    size = len(protocol.test) if protocol.by_person else len(views.columns)
    titles = []
    for start in range(0, len(views.columns), size):
        titles += [*views.columns[start : start + size], "average"]
    rows = {name: with_averages(f["error"], protocol) for name, f in figures.items()}
    rows |= {
        f"{name}, hidden joints": with_averages(f["hidden"], protocol)
        for name, f in figures.items()
        if "hidden" in f
    }
    exact = figures["gt"]
    rows["gt, without head and neck"] = with_averages(exact["limbs"], protocol)
    rows["gt, better mirror image"] = with_averages(exact["mirror"], protocol)
    refused = [
        sum(counts) for counts in zip(*(f["refused"] for f in figures.values()), strict=True)
    ]
    counts = [int(n) for n in np.bincount(views.column, minlength=len(views.columns))]
    places = iter(range(len(views.columns)))
    every = [None if title == "average" else next(places) for title in titles]
    rows["poses"] = [None if i is None else counts[i] for i in every]
    rows["refused, all rows"] = [None if i is None else refused[i] for i in every]
    if len(protocol.paper[0][1]) == len(titles):
        rows |= {f"the paper's {title}": list(row) for title, row in protocol.paper}
    return table("mm", titles, rows)


# A model of one's own


def train(motion: Path, recipe: str, epochs: int | None, out: Path) -> Library:
    """Trains on a motion file, and builds the library with the weights as its only model."""
    weights = out / "trained.npz"
    options = [] if epochs is None else ["--epochs", str(epochs)]
    program = [sys.executable, str(ROOT / "tools" / "train.py"), str(motion), "--recipe", recipe]
    if subprocess.run([*program, "--out", str(weights), *options]).returncode:
        raise MocapError("training failed")
    return build_library(weights, out / "library")


# The command


def options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("data_set", choices=("h36m", "humaneva"))
    parser.add_argument("positions", type=Path, help="VideoPose3D's data_3d_*.npz")
    parser.add_argument("--cameras", type=Path, required=True, help="its *_dataset.py, or JSON")
    parser.add_argument("--protocol", type=int, choices=H36M_PROTOCOLS, help="of h36m")
    parser.add_argument("--action", help="this one alone, as the data set names it")
    parser.add_argument("--model", default="distances_f32", help="(%(default)s)")
    parser.add_argument("--train", action="store_true", help="a model on the training people")
    parser.add_argument("--recipe", default="distances", help="of train.py (%(default)s)")
    parser.add_argument("--epochs", type=int, help="in all, instead of the recipe's")
    parser.add_argument(
        "--out", type=Path, help="folder for table.md, train.npz, test.npz (build/licensed/...)"
    )


def chosen_protocol(args: argparse.Namespace) -> Protocol:
    """The protocol of the options, with one action if they name one."""
    if (args.data_set == "h36m") != (args.protocol is not None):
        raise ValueError("--protocol 1, 2 or 3 goes with h36m, and only with it")
    protocol = HUMANEVA if args.data_set == "humaneva" else H36M_PROTOCOLS[args.protocol]
    if args.action is None:
        return protocol
    if args.action not in protocol.actions:
        raise MocapError(f"no action '{args.action}'; there are {', '.join(protocol.actions)}")
    return replace(protocol, actions={args.action: protocol.actions[args.action]})


def tables(args: argparse.Namespace) -> Tables:
    """The table; leaves it, and the motion of both sides, in the folder."""
    protocol = chosen_protocol(args)
    rig = h36m.read_cameras(args.cameras, protocol.layout)
    data = h36m.read_positions(args.positions, protocol.layout)
    tested, cleaning = test_motion(data, protocol), Cleaning()
    views = project(tested, rig, protocol)
    name = [args.data_set, *([str(args.protocol)] if args.protocol else []), args.action or "all"]
    out = args.out or ROOT / "build" / "licensed" / "_".join(name)
    out.mkdir(parents=True, exist_ok=True)
    save_motion(tested, out / "test.npz", protocol.layout.fps / protocol.every)
    save_motion(training_motion(data, protocol, cleaning), out / "train.npz", cleaning.fps)
    if args.train:
        library = train(out / "train.npz", args.recipe, args.epochs, out)
    else:
        library = Library(f"{base_model(args)}_f32")
    figures = rounded(evaluate(library, views, adapted=not args.train))
    text = report(figures, views, protocol)
    (out / "table.md").write_text(text)
    return {"h36m": text}


EVALUATION = Evaluation(__doc__, tables, options)
