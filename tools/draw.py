"""Draws 2D skeletons beside the 3D poses lifted from them, seen from the camera and from the side.

    lift_stdin < walk.csv > lifted.csv
    draw.py walk.csv lifted.csv --out walk.png --truth walk_truth.csv
    draw.py walk.csv lifted.csv --out walk.gif

A .png, .svg or .pdf is a contact sheet, a column a pose; a .gif shows the whole sequence.  With
--truth, the mean errors are printed as well.
"""

import argparse
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from tqdm import tqdm

from edmlift.joints import BONES, INDEX, JOINTS, indices, mid_hip
from edmlift.metrics import rigid_errors

SHEETS = (".png", ".svg", ".pdf")
COLUMNS, MOST_COLUMNS = 6, 24
FPS = 20  # of the animation: a whole number of a GIF's hundredths of a second

# Okabe and Ito's colours: told apart with any colour vision, and in grey.
COLOURS = {"right": "#D55E00", "left": "#0072B2", "trunk": "#3B3F46"}
SIDES = [
    next((side for side in ("right", "left") if name.startswith(side)), "trunk") for name in JOINTS
]
# Drawn bones, each with its colour: the skeleton's, but a spine and a pelvis for the two long
# bones from neck to hips.  The 15th point is the middle of the hips.
HIPS = indices(("right_hip", "left_hip"))
MIDDLE = len(JOINTS)
SHOULDERS = indices(("right_shoulder", "left_shoulder"))
DRAWN = [(a, b, "trunk" if b in SHOULDERS else SIDES[b]) for a, b in BONES if b not in HIPS]
DRAWN += [(INDEX["neck"], MIDDLE, "trunk"), *((MIDDLE, hip, "trunk") for hip in HIPS)]
TORSO = SHOULDERS + HIPS[::-1]
TRUTH = {"color": "#6E747C", "lw": 1.1, "ls": (0, (3.2, 1.8))}
TEXT, FAINT = "#24292F", "#6E747C"
PAPER, SHADOW, SKIN = "#F1F3F5", "#DADEE3", "#DDE1E6"

RAISE = 16.0  # degrees that the viewer of a 3D pose looks down ...
VIEWER = 5.0  # ... from this many metres
VIEWS = {"3D from the camera": 0.0, "3D from the side": 90.0}  # degrees that the viewer walks round
GRID = 0.25  # metres
WIDEST = 1.5  # width by height of the 2D panel where it shows a whole path

# Layout, in inches.
SHEET_WIDE, STRIP_HIGH, GAP = 12.0, 3.6, 0.12
TITLE, LEGEND, CAPTION, COLUMN_NAMES = 0.42, 0.36, 0.38, 0.26  # heights of the lines of text
DPI = 150  # of a picture; an animation has 100


class DrawError(Exception):
    """What is wrong with a file or an option, in one line."""


# ---- Reading ---------------------------------------------------------------------------------


def _lines(path: Path) -> list[str]:
    """The lines that lift_stdin does not skip."""
    try:
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as error:
        raise DrawError(f"{path}: {error.strerror}") from None
    lines = (line.strip(" \t\r") for line in text.split("\n"))
    return [line for line in lines if line and not line.startswith("#")]


def _numbers(text: str) -> np.ndarray:
    """Numbers separated by commas or blanks; an empty array where the text is something else."""
    try:
        return np.array([float(field) for field in re.split(r"\s*,\s*|\s+", text)])
    except ValueError:
        return np.zeros(0)


def read_keypoints(path: Path, threshold: float = 0.0) -> np.ndarray:
    """Input of lift_stdin -> [F,14,3] x, y in pixels and confidence.

    Confidences up to the threshold become 0; a line that is not a pose is all NaN.
    """
    keypoints = np.full((len(lines := _lines(path)), len(JOINTS), 3), np.nan)
    for pose, line in zip(keypoints, lines, strict=True):
        numbers = _numbers(line)
        if len(numbers) == 2 * len(JOINTS):
            pose[:] = np.insert(numbers.reshape(-1, 2), 2, 1, axis=1)
        elif len(numbers) == 3 * len(JOINTS):
            pose[:] = numbers.reshape(-1, 3)
            pose[pose[:, 2] <= threshold, 2] = 0
    if np.isnan(keypoints).all():
        raise DrawError(f"{path}: holds no pose of 28 or 42 numbers")
    return keypoints


def read_lifted(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Output of lift_stdin -> poses [F,14,3] metres, NaN where refused, and status names [F]."""
    rows = [line.split(",") for line in _lines(path)]
    if rows and rows[0][0] == "status":
        del rows[0]
    poses = np.full((len(rows), len(JOINTS), 3), np.nan)
    for number, (pose, row) in enumerate(zip(poses, rows, strict=True), 1):
        numbers = _numbers(",".join(row[1:])) if row[0] == "ok" else np.full(44, np.nan)
        if len(row) != 45 or len(numbers) != 44:
            raise DrawError(f"{path}: pose {number} is not a line of lift_stdin's output")
        pose[:] = numbers[:42].reshape(-1, 3)
    return poses, np.array([row[0] for row in rows])


def read_truth(path: Path) -> np.ndarray:
    """Poses [F,14,3] in metres, 42 numbers a line."""
    rows = [_numbers(line) for line in _lines(path)]
    for number, row in enumerate(rows, 1):
        if len(row) != 3 * len(JOINTS):
            raise DrawError(f"{path}: pose {number} is not 42 numbers")
    return np.array(rows).reshape(-1, len(JOINTS), 3)


def mean_errors(poses: np.ndarray, truth: np.ndarray) -> tuple[float, float]:
    """Mean joint error in mm with mid-hips laid together, and after rigid alignment.

    poses, truth [F,14,3] metres; poses that are NaN do not count.
    """
    lifted = np.isfinite(poses).all((1, 2))
    poses, truth = poses[lifted], truth[lifted]
    offset = (poses - mid_hip(poses)[:, None]) - (truth - mid_hip(truth)[:, None])
    aligned = rigid_errors(poses, truth)
    return 1e3 * np.linalg.norm(offset, axis=-1).mean(), 1e3 * aligned.mean()


# ---- Geometry --------------------------------------------------------------------------------


def turn(points: np.ndarray, degrees: float) -> np.ndarray:
    """Camera axes [...,3] -> right, up and towards the viewer, in metres, in mild perspective.

    The viewer is raised a little and has walked round the person, to the camera's right.
    """
    a, e = np.radians(degrees), np.radians(RAISE)
    x, up, near = points[..., 0], -points[..., 1], -points[..., 2]
    right, near = np.cos(a) * x - np.sin(a) * near, np.sin(a) * x + np.cos(a) * near
    up, near = np.cos(e) * up - np.sin(e) * near, np.sin(e) * up + np.cos(e) * near
    scale = VIEWER / (VIEWER - near)
    return np.stack([right * scale, up * scale, near], -1)


def upright(points: np.ndarray, pitch: float) -> np.ndarray:
    """Axes of a camera that looks down by so many degrees -> those of a level one, [...,3]."""
    c, s = np.cos(np.radians(pitch)), np.sin(np.radians(pitch))
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([x, c * y + s * z, c * z - s * y], -1)


def with_middle(points: np.ndarray) -> np.ndarray:
    """[14,D] -> [15,D]: adds the middle of the hips, of those that are not NaN."""
    hips = points[HIPS]
    hips = hips[np.isfinite(hips).all(1)]
    middle = hips.mean(0) if len(hips) else np.full(points.shape[1], np.nan)
    return np.vstack([points, middle])


@dataclass(frozen=True)
class Scene:
    """What is drawn: F poses and the windows that hold all of them at one scale."""

    keypoints: np.ndarray  # [F,14,3] pixels and confidence
    poses: np.ndarray  # [F,14,3] metres; y = 0 is the floor
    status: Sequence[str]
    truth: np.ndarray | None  # [F,14,3], moved with the poses
    image_centre: np.ndarray  # [F,2] pixels
    image_size: np.ndarray  # [2] pixels
    window: np.ndarray  # metres: left, right, bottom, top


def _scene(keypoints, poses, status, truth, steady: bool) -> Scene:
    """Stands the poses on the floor and finds the windows; `steady`: the image's does not move."""
    floor = np.nan_to_num(poses[..., 1].max(1), nan=0)[:, None] * [0.0, 1.0, 0.0]
    poses = poses - floor[:, None]
    truth = None if truth is None else truth - floor[:, None]
    window = _window(poses if truth is None else np.concatenate([poses, truth]))
    low, high = _boxes(keypoints)
    if steady:
        low, high = (np.broadcast_to(f(b, 0), b.shape) for f, b in ((np.min, low), (np.max, high)))
    size = 1.14 * (high - low).max(0).clip(1)
    aspect = _aspect(window)
    if steady:
        aspect = np.clip(size[0] / size[1], aspect, max(aspect, WIDEST))
    size = np.maximum(size, [size[1] * aspect, size[0] / aspect])
    return Scene(keypoints, poses, status, truth, (low + high) / 2, size, window)


def _window(poses: np.ndarray) -> np.ndarray:
    """Left, right, bottom and top of the poses in every view, in metres, with a margin."""
    corners = np.concatenate([turn(poses, degrees) for degrees in VIEWS.values()]).reshape(-1, 3)
    corners = corners[np.isfinite(corners).all(1)]
    half = 1.06 * max(0.55, np.abs(corners[:, 0]).max(initial=0))
    ground = -turn(np.array([0, 0, -_grid_half(half)]), 0)[1]
    top = max(1.2, corners[:, 1].max(initial=0)) + 0.10
    return np.array([-half, half, min(-ground, corners[:, 1].min(initial=0)) - 0.03, top])


def _aspect(window: np.ndarray) -> float:
    """Width by height of a panel that shows the window."""
    return float((window[1] - window[0]) / (window[3] - window[2]))


def _grid_half(half: float) -> float:
    """Half the side of the floor grid: whole squares."""
    return max(1, np.floor(half / GRID)) * GRID


def _seen(keypoints: np.ndarray) -> np.ndarray:
    """[...,14,3] -> [...,14]: joints that can be drawn in the image."""
    return (keypoints[..., 2] > 0) & np.isfinite(keypoints).all(-1)


def _boxes(keypoints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners [F,2] of the seen joints; a pose that has none gets an average place."""
    points = np.where(_seen(keypoints)[..., None], keypoints[..., :2], np.nan)
    some = np.isfinite(points).any((1, 2))
    low, high = np.zeros((2, len(points), 2))
    if some.any():
        low[some], high[some] = np.nanmin(points[some], 1), np.nanmax(points[some], 1)
        low[~some] = high[~some] = (low[some] + high[some]).mean(0) / 2
    return low, high


# ---- One panel -------------------------------------------------------------------------------


def _panel(ax: Axes, left: float, right: float, bottom: float, top: float) -> None:
    ax.set(xlim=(left, right), ylim=(bottom, top), xticks=[], yticks=[], aspect="equal")
    ax.spines[:].set_visible(False)


def _bones(ax: Axes, at: np.ndarray, seen: np.ndarray, width: float) -> None:
    """Bones and joints of points [14,3], the farthest first, each with a white rim."""
    at = with_middle(at)
    known = np.isfinite(at).all(1)
    bones = [bone for bone in DRAWN if known[list(bone[:2])].all()]
    bones.sort(key=lambda bone: at[list(bone[:2]), 2].mean())
    lines = np.array([at[[a, b], :2] for a, b, _ in bones]).reshape(-1, 2, 2)
    rims = np.array([[0.75, 0.25], [0.25, 0.75]]) @ lines  # shorter: not into the neighbours
    ax.add_collection(
        LineCollection(
            np.stack([rims, lines], 1).reshape(-1, 2, 2),
            colors=[colour for *_, side in bones for colour in ("white", COLOURS[side])],
            linewidths=(width + 2.2, width),
            capstyle="round",
            zorder=3,
        )
    )
    known = known[:MIDDLE]
    seen, colours = seen[known], np.array([COLOURS[side] for side in SIDES])[known]
    ax.scatter(
        *at[:MIDDLE][known, :2].T,
        s=np.where(seen, 1.75 * width, 1.5 * width) ** 2,
        facecolors=np.where(seen, colours, "white"),
        edgecolors=np.where(seen, "white", colours),
        linewidths=np.where(seen, 0.7, 1.3),
        zorder=4,
    )


def _body(ax: Axes, at: np.ndarray) -> None:
    """Torso and head of points [14,3], as far as they are not NaN: flat shapes behind the bones."""
    look = {"fc": SKIN, "ec": SKIN, "lw": 2, "joinstyle": "round", "zorder": 2.5}
    if np.isfinite(at[TORSO]).all():
        ax.add_patch(Polygon(at[TORSO, :2], **look))
    crown, neck = at[INDEX["head_top"], :2], at[INDEX["neck"], :2]
    if np.isfinite(crown + neck).all():
        ax.add_patch(Circle(0.55 * crown + 0.45 * neck, 0.4 * np.hypot(*(crown - neck)), **look))


def draw_image(ax: Axes, scene: Scene, i: int, width: float = 3.4) -> None:
    """The 2D input of pose i; joints that were not seen are left out."""
    (x, y), (w, h) = scene.image_centre[i], scene.image_size
    _panel(ax, x - w / 2, x + w / 2, y + h / 2, y - h / 2)
    ax.set_facecolor(PAPER)
    seen = _seen(scene.keypoints[i])
    at = np.where(seen[:, None], scene.keypoints[i], np.nan)
    at[:, 2] = np.where(seen, 0, np.nan)
    _body(ax, at)
    _bones(ax, at, seen, width)


def draw_pose(ax: Axes, scene: Scene, i: int, degrees: float, width: float = 3.4) -> None:
    """The 3D pose i from one side, or its status if there is none."""
    _panel(ax, *scene.window)
    if scene.status[i] != "ok":
        ax.text(
            0.5,
            0.5,
            scene.status[i],
            transform=ax.transAxes,
            ha="center",
            va="center",
            color=FAINT,
            fontsize=10,
            style="italic",
        )
        return
    _floor(ax, scene, i, degrees)
    at = turn(scene.poses[i], degrees)
    _body(ax, at)
    _bones(ax, at, _seen(scene.keypoints[i]), width)
    if scene.truth is not None:
        truth = with_middle(turn(scene.truth[i], degrees))
        lines = [truth[[a, b], :2] for a, b, _ in DRAWN]
        ax.add_collection(LineCollection(lines, zorder=2.7, **TRUTH))


def _floor(ax: Axes, scene: Scene, i: int, degrees: float) -> None:
    """A grid below the hips, and on it the shadow of the pose."""
    half = _grid_half(scene.window[1])
    corners = np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]])
    ax.add_patch(Polygon(turn(corners, degrees)[:, :2], fc=PAPER, ec="none", zorder=1))
    offsets = np.arange(GRID - half, half - GRID / 2, GRID)
    away = np.array([[[offset, 0, -half], [offset, 0, half]] for offset in offsets])
    grid = turn(np.concatenate([away, away[..., ::-1]]), degrees)[..., :2]
    ax.add_collection(LineCollection(grid, color="white", lw=1, zorder=1.1))
    shadow = turn(with_middle(scene.poses[i]) * [1, 0, 1], degrees)[:, :2]
    lines = [shadow[[a, b]] for a, b, _ in DRAWN]
    ax.add_collection(LineCollection(lines, color=SHADOW, lw=3, capstyle="round", zorder=2))


# ---- The whole picture -----------------------------------------------------------------------


def _figure(wide: float, high: float, title: str | None, scene: Scene) -> tuple[Figure, float]:
    """A figure with room for panels of these inches, and the height of what is above them."""
    above = GAP + (TITLE if title else 0) + LEGEND + COLUMN_NAMES
    wide, high = max(wide, 6.0), above + high + CAPTION
    figure = Figure(figsize=(wide, high), facecolor="white")
    left, size = GAP / wide, {"va": "center", "color": TEXT}
    figure.text(left, 1 - (GAP + TITLE / 2) / high, title or "", fontsize=14, weight="bold", **size)
    figure.text(
        left,
        CAPTION / 2 / high,
        f"Floor squares {100 * GRID:.0f} cm. From the side, the camera is on the left.",
        fontsize=9,
        **size | {"color": FAINT},
    )
    figure.legend(
        handles=_legend(scene),
        loc="center left",
        ncols=5,
        frameon=False,
        fontsize=10,
        bbox_to_anchor=(left, 1 - (above - COLUMN_NAMES - LEGEND / 2) / high),
        labelcolor=TEXT,
        handlelength=1.4,
        columnspacing=1.6,
        borderpad=0,
        borderaxespad=0,
    )
    return figure, above


def _legend(scene: Scene) -> list[Line2D]:
    names = {"right": "subject's right", "left": "subject's left", "trunk": "trunk"}
    handles = [Line2D([], [], color=COLOURS[side], lw=3.4, label=names[side]) for side in names]
    if scene.truth is not None:
        handles.append(Line2D([], [], label="truth", **TRUTH))
    if not _seen(scene.keypoints).all():
        look = {"ls": "", "marker": "o", "ms": 5, "mfc": "white", "mec": FAINT}
        handles.append(Line2D([], [], label="not seen in 2D", **look))
    return handles


def _add_axes(figure: Figure, left: float, top: float, wide: float, high: float) -> Axes:
    """Axes at a place given in inches from the top left corner."""
    w, h = figure.get_size_inches()
    return figure.add_axes((left / w, 1 - (top + high) / h, wide / w, high / h))


def spread(count: int, columns: int) -> list[int]:
    """Indices of at most `columns` of `count` frames, evenly spread, half a step from both ends."""
    columns = min(columns, count)
    return [int((column + 0.5) * count / columns) for column in range(columns)]


def _pick(values: np.ndarray | None, frames: Sequence[int]) -> np.ndarray | None:
    return None if values is None else np.asarray(values)[list(frames)]


def draw_sheet(
    keypoints: np.ndarray,
    poses: np.ndarray,
    status: Sequence[str],
    path: Path,
    truth: np.ndarray | None = None,
    title: str | None = None,
    frames: Sequence[int] | None = None,
    names: Sequence[str] | None = None,
) -> None:
    """Writes a contact sheet, a column a frame; without `frames`, six evenly spread.

    `names` stand above the columns, else "frame" and its number.

    keypoints [F,14,3] pixels and confidence; poses, truth [F,14,3] metres, camera axes; status [F]
    names.  The extension of path (.png, .svg, .pdf) is the format.
    """
    frames = spread(len(poses), COLUMNS) if frames is None else frames
    names = [f"frame {frame}" for frame in frames] if names is None else names
    scene = _scene(*(_pick(v, frames) for v in (keypoints, poses, status, truth)), steady=False)
    if len(frames) == 1:
        figure, panels = _strip(scene, title)
        _draw_strip(panels, scene, 0)
    else:
        figure = _columns(scene, names, title)
    figure.savefig(path, dpi=DPI)


def _columns(scene: Scene, names: Sequence[str], title: str | None) -> Figure:
    """The contact sheet: 2D input above the pose from the camera and from the side."""
    left = 0.5  # room for the names of the rows
    wide = min(2.4, (SHEET_WIDE - left) / len(names) - GAP)
    high = wide / _aspect(scene.window)
    figure, top = _figure(left + len(names) * (wide + GAP), 3 * high + 2 * GAP, title, scene)
    inches = figure.get_size_inches()
    for row, view in enumerate(("2D input", *VIEWS)):
        y = top + row * (high + GAP)
        figure.text(
            0.3 / inches[0],
            1 - (y + high / 2) / inches[1],
            view,
            rotation=90,
            ha="center",
            va="center",
            fontsize=11,
            color=TEXT,
        )
        for column, name in enumerate(names):
            ax = _add_axes(figure, left + column * (wide + GAP), y, wide, high)
            if row == 0:
                draw_image(ax, scene, column)
                ax.set_title(name, fontsize=10, color=FAINT, pad=5)
            else:
                draw_pose(ax, scene, column, VIEWS[view])
    return figure


def _strip(scene: Scene, title: str | None) -> tuple[Figure, list[Axes]]:
    """A figure for one pose at a time: 2D input, the pose from the camera and from the side."""
    aspects = [scene.image_size[0] / scene.image_size[1]] + [_aspect(scene.window)] * len(VIEWS)
    wide = STRIP_HIGH * np.array(aspects)
    left = GAP + np.concatenate([[0], np.cumsum(wide + GAP)])
    figure, top = _figure(left[-1], STRIP_HIGH, title, scene)
    pairs = zip(left, wide, strict=False)
    return figure, [_add_axes(figure, x, top, w, STRIP_HIGH) for x, w in pairs]


def _draw_strip(panels: list[Axes], scene: Scene, i: int) -> None:
    for ax, name in zip(panels, ("2D input", *VIEWS), strict=True):
        ax.clear()
        if name in VIEWS:
            draw_pose(ax, scene, i, VIEWS[name], width=4.2)
        else:
            draw_image(ax, scene, i, width=4.2)
        ax.set_title(name, fontsize=11, color=TEXT, pad=6)


def draw_animation(
    keypoints: np.ndarray,
    poses: np.ndarray,
    status: Sequence[str],
    path: Path,
    truth: np.ndarray | None = None,
    title: str | None = None,
) -> None:
    """Writes a GIF of all frames: 2D input, the pose from the camera and from the side.

    Arguments as for draw_sheet.  Shows a progress bar where stderr is a terminal.
    """
    scene = _scene(keypoints, poses, status, truth, steady=True)
    figure, panels = _strip(scene, title)
    writer = PillowWriter(fps=FPS)
    with writer.saving(figure, str(path), dpi=100):
        for i in tqdm(range(len(poses)), desc=path.name, unit="frame", disable=None):
            _draw_strip(panels, scene, i)
            writer.grab_frame()


# ---- Command line ----------------------------------------------------------------------------


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    summary, _, rest = __doc__.partition("\n\n")
    parser = argparse.ArgumentParser(
        prog="draw", description=summary, epilog=rest, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("keypoints", type=Path, help="input of lift_stdin")
    parser.add_argument("lifted", type=Path, help="its output, with or without --header")
    parser.add_argument("--out", type=Path, required=True, help="picture: .png, .svg, .pdf or .gif")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--frames", type=int, metavar="N", help=f"columns (default: {COLUMNS})")
    which.add_argument("--frame", type=int, metavar="I", help="this frame alone, counted from 0")
    parser.add_argument("--truth", type=Path, help="true 3D poses, 42 numbers a line, metres")
    parser.add_argument("--title", help="heading of the picture")
    parser.add_argument(
        "--pitch",
        type=float,
        default=0.0,
        metavar="DEGREES",
        help="by which the camera looked down: the floor is level then (default: 0)",
    )
    parser.add_argument(
        "--threshold",
        type=float,
        default=0.0,
        metavar="C",
        help="as given to lift_stdin (default: 0)",
    )
    return parser.parse_args(arguments)


def _frames(options: argparse.Namespace, count: int) -> list[int]:
    """The frames of a sheet."""
    if options.frame is not None:
        if not 0 <= options.frame < count:
            raise DrawError(f"--frame {options.frame}: there are frames 0 to {count - 1}")
        return [options.frame]
    if options.frames is not None and not 1 <= options.frames <= MOST_COLUMNS:
        raise DrawError(f"--frames {options.frames}: must be 1 to {MOST_COLUMNS}")
    return spread(count, options.frames or COLUMNS)


def _same_length(**files: tuple[Path, np.ndarray]) -> None:
    if len({len(rows) for _, rows in files.values()}) > 1:
        counts = ", ".join(f"{path} has {len(rows)}" for path, rows in files.values())
        raise DrawError(f"the files must hold equally many poses: {counts}")


def draw(options: argparse.Namespace) -> None:
    """Reads the files, writes the picture, prints the errors; raises DrawError."""
    kind = options.out.suffix.lower()
    if kind not in (*SHEETS, ".gif"):
        raise DrawError(f"{options.out}: must end in {', '.join(SHEETS)} or .gif")
    if kind == ".gif" and (options.frame, options.frames) != (None, None):
        raise DrawError("--frame and --frames are for pictures; a .gif shows the whole sequence")
    keypoints = read_keypoints(options.keypoints, options.threshold)
    poses, status = read_lifted(options.lifted)
    truth = read_truth(options.truth) if options.truth else None
    files = {"keypoints": (options.keypoints, keypoints), "lifted": (options.lifted, poses)}
    if truth is not None:
        files["truth"] = (options.truth, truth)
    _same_length(**files)
    if not abs(options.pitch) <= 90:
        raise DrawError(f"--pitch {options.pitch:g}: must be within 90 degrees")
    poses = upright(poses, options.pitch)
    truth = None if truth is None else upright(truth, options.pitch)
    try:
        if kind == ".gif":
            draw_animation(keypoints, poses, status, options.out, truth, options.title)
        else:
            frames = _frames(options, len(poses))
            draw_sheet(keypoints, poses, status, options.out, truth, options.title, frames)
    except OSError as error:
        raise DrawError(f"{options.out}: {error.strerror}") from None
    if truth is not None:
        _print_errors(poses, truth)


def _print_errors(poses: np.ndarray, truth: np.ndarray) -> None:
    lifted = int(np.isfinite(poses).all((1, 2)).sum())
    print(f"{lifted} of {len(poses)} poses lifted", end="")
    if lifted:
        relative, aligned = mean_errors(poses, truth)
        print(
            f"; mean error {relative:.1f} mm root-relative, {aligned:.1f} mm after rigid alignment",
            end="",
        )
    print()


def main(arguments: Sequence[str] | None = None) -> int:
    try:
        draw(_options(arguments))
    except DrawError as error:
        print(f"draw: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
