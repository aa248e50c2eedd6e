"""Plots of accuracy: small PNG files whose bytes depend on nothing but the figures."""

import io
from itertools import cycle
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

import edmlift
from edmlift.drawing.palette import FAINT, SIDES, TEXT
from edmlift.joints import JOINTS, mid_hip

DPI = 110
NAMES = ("errors", "joints", "noise", "examples")
LIBRARY, OTHER = SIDES["left"], SIDES["right"]
COLOURS = 64  # of a plot
# Of rivals; with more of them, from the start again.
MARKERS = "ovDs^*X"
LINES = ("--", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)), ":", "-.", (0, (1, 3)), (0, (12, 3)))
# Example poses: the best, the worst, and what share of the poses has a smaller error.
SHARES = {"best": 0.0, "25 %": 0.25, "median": 0.5, "75 %": 0.75, "95 %": 0.95, "worst": 1.0}


def write_all(
    folder: Path, figures: dict, rivals: dict, paper: dict[str, float], examples: dict
) -> None:
    """Writes the four plots: errors.png, joints.png, noise.png and examples.png.

    figures: {column: {figure: mm}}; rivals: {title: the same}; paper: {column: mm}; examples: what
    draw_examples() takes.
    """
    save(errors(figures, rivals), folder / "errors.png")
    save(by_joint(figures), folder / "joints.png")
    save(noise(figures, rivals, paper), folder / "noise.png")
    draw_examples(folder / "examples.png", **examples)


def save(figure: Figure, path: Path) -> None:
    """Writes a PNG with a palette, without the version of the plotting library."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=DPI, metadata={"Software": None})
    with Image.open(data) as picture:
        flat = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    flat.save(path, optimize=True)


def _axes(title: str, wide: float = 8.0) -> tuple[Figure, Axes]:
    figure = Figure(figsize=(wide, 3.6), layout="constrained")
    ax = figure.add_subplot()
    ax.set_title(title, loc="left", color=TEXT, fontsize=11)
    ax.set_ylabel("error, mm", color=TEXT)
    ax.grid(axis="y", color="#E3E6EA")
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    return figure, ax


def errors(figures: dict, rivals: dict) -> Figure:
    """Error by condition, with the 95 % intervals."""
    figure, ax = _axes("Error by condition, and its 95 % interval over people")
    at = np.arange(len(figures))
    error = np.array([column["error"] for column in figures.values()])
    low, high = np.array([column["interval"] for column in figures.values()]).T
    ax.bar(at, error, color=LIBRARY, width=0.6, label="edmlift")
    ax.errorbar(at, error, [error - low, high - error], fmt="none", ecolor=TEXT, capsize=3)
    top = high.max()
    for marker, (title, rival) in zip(cycle(MARKERS), rivals.items(), strict=False):
        values = [rival[name]["error"] for name in figures]
        ax.plot(at + 0.41, values, marker, color=FAINT, ms=4, label=title)  # between the bars
        top = max(top, *values)
    ax.set_xticks(at, list(figures), rotation=30, ha="right")
    ax.set_ylim(0, (1.15 + 0.1 * np.ceil((len(rivals) + 1) / 3)) * top)  # room for the legend
    ax.legend(frameon=False, ncols=3, loc="upper left", fontsize=9)
    return figure


def by_joint(figures: dict) -> Figure:
    """Error by joint, exact and as a detector sees."""
    figure, ax = _axes("Error by joint")
    at = np.arange(len(JOINTS))
    for shift, name, colour in ((-0.2, "gt", LIBRARY), (0.2, "cpm", OTHER)):
        joints = figures[name]["by_joint"]
        ax.bar(at + shift, [joints[j] for j in JOINTS], 0.38, color=colour, label=name)
    ax.set_xticks(at, [j.replace("_", " ") for j in JOINTS], rotation=40, ha="right")
    ax.legend(frameon=False, ncols=2, loc="upper left", fontsize=9)
    ax.margins(y=0.2)
    return figure


def people(errors: dict[str, dict[str, dict[str, float]]], column: str) -> Figure:
    """Error of each person in a column, by networks that never saw them: errors is
    {network: {column: {person: mm}}}, the library's first."""
    figure, ax = _axes("Error by person, of networks that never saw them")
    library, *others = (row[column] for row in errors.values())
    order = sorted(library, key=library.get)
    at = np.arange(len(order))
    ax.bar(at, [library[p] for p in order], color=LIBRARY, width=0.6, label=next(iter(errors)))
    for marker, title, other in zip(MARKERS, [*errors][1:], others, strict=False):
        ax.plot(at, [other[p] for p in order], marker, color=TEXT, mfc="none", ms=6, label=title)
    ax.set_xticks(at, order, fontsize=7)
    ax.set_xlabel("person, by the number in the database", color=TEXT)
    ax.margins(x=0.01, y=0.2)
    ax.legend(frameon=False, loc="upper left", fontsize=9)
    return figure


def noise(figures: dict, rivals: dict, paper: dict[str, float]) -> Figure:
    """Error against noise on each coordinate, beside the paper's."""
    figure, ax = _axes("Error against noise")
    columns = {"gt": 0, "n5": 5, "n10": 10, "n15": 15, "n20": 20}
    sigma = list(columns.values())
    error = np.array([figures[name]["error"] for name in columns])
    low, high = np.array([figures[name]["interval"] for name in columns]).T
    ax.fill_between(sigma, low, high, color=LIBRARY, alpha=0.15, lw=0)
    ax.plot(sigma, error, "o-", color=LIBRARY, label="edmlift")
    for line, (title, rival) in zip(cycle(LINES), rivals.items(), strict=False):
        ax.plot(sigma, [rival[n]["error"] for n in columns], ls=line, color=FAINT, label=title)
    label = "the paper's FConv, on other data"
    ax.plot(sigma, [paper[name] for name in columns], "s--", color=OTHER, label=label)
    ax.set_xticks(sigma)
    ax.set_xlabel("noise on each coordinate, pixels", color=TEXT)
    ax.set_ylim(bottom=0)
    ax.legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


def draw_examples(
    path: Path, keypoints: np.ndarray, poses: np.ndarray, truth: np.ndarray, error: np.ndarray
) -> None:
    """Poses at the SHARES of the errors [F] in mm, the truth dashed.

    keypoints [F,14,3], poses [F,14,3] metres about mid-hip, truth [F,14,3] metres in camera axes.
    """
    order = error.argsort(kind="stable")
    frames = [int(order[round(share * (len(order) - 1))]) for share in SHARES.values()]
    names = [f"{n}: {error[f]:.0f} mm" for n, f in zip(SHARES, frames, strict=True)]
    rooted = truth - mid_hip(truth)[:, None]
    edmlift.draw(
        edmlift.Poses.of(poses, keypoints), path, truth=rooted, frames=frames, names=names
    )
