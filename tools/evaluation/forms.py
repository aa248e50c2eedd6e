"""What the number formats of a model lose against its float network."""

from typing import Any

import numpy as np
from tqdm import tqdm

from data.mocap import Motion
from data.views import Column, views
from edmlift.library import Library
from evaluation.measures import MIRROR_IMAGE, Figures, by_subject, mean_errors
from reports.markdown import signed, table

# The other forms of a model, where it has them: its suffix, and whether all is in fixed point.
FORMS = {
    "w16": ("w16", False),
    "w8": ("w8", False),
    "fixed": ("w16", True),
    "fixed_w8": ("w8", True),
}
TITLES = {
    "w16": "16-bit network",
    "w8": "8-bit network",
    "fixed": "all fixed point, 16-bit network",
    "fixed_w8": "all fixed point, 8-bit network",
}


def lose(libraries: dict[str, Library], column: Column, subject: np.ndarray) -> dict[str, Figures]:
    """What the forms lose against "f32" in a column: {form: {figure: value}}.

    error: as of measure(); moved: mean distance of the joints of a pose from where the float lift
    has them, mm, and its 99.9th percentile, of poses with the same mirror image; mirrored: poses
    with the other one; refused: poses with another status.
    """
    poses = {form: library.lift(column.keypoints) for form, library in libraries.items()}
    plain = poses.pop("f32")
    result = {}
    for form, lifted in poses.items():
        fine = (lifted.status == "ok") & (plain.status == "ok")
        joints, base = lifted.joints[fine].astype(float), plain.joints[fine].astype(float)
        moved = 1000 * np.linalg.norm(joints - base, axis=-1).mean(1)
        other = mean_errors(joints * MIRROR_IMAGE, base) < mean_errors(joints, base)
        error = mean_errors(joints, column.truth[fine])
        result[form] = {
            "error": by_subject(error, subject[fine]).mean(),
            "moved": moved[~other].mean(),
            "moved_999": np.percentile(moved[~other], 99.9),
            "mirrored": int(other.sum()),
            "refused": int((lifted.status != plain.status).sum()),
        }
    return result


def evaluate_forms(model: str, motion: Motion) -> dict[str, dict[str, Figures]]:
    """What the forms of a model, such as "fconn", lose: {form: {column: {figure: value}}}."""
    libraries = {"f32": (plain := Library(f"{model}_f32"))}
    forms = {f: form for f, form in FORMS.items() if plain.has(f"{model}_{form[0]}")}
    libraries |= {f: Library(f"{model}_{w}", fixed=fixed) for f, (w, fixed) in forms.items()}
    bar = tqdm(views(motion.joints).items(), desc="number formats", disable=None)
    columns = {name: lose(libraries, column, motion.subject) for name, column in bar}
    return {form: {name: columns[name][form] for name in columns} for form in forms}


def report(figures: dict[str, Figures], forms: dict[str, dict[str, Any]]) -> str:
    """Two tables: the error that each form adds in each column; and how far it moves poses."""
    columns = list(figures)
    rows = {
        TITLES[form]: [signed(found[n]["error"] - figures[n]["error"]) for n in columns]
        for form, found in forms.items()
    }
    how = ["mean, mm", "99.9th percentile, mm", "other mirror image, poses", "other status, poses"]
    keys = ("moved", "moved_999", "mirrored", "refused")
    moved = {
        TITLES[form]: [max(c[key] for c in found.values()) for key in keys]
        for form, found in forms.items()
    }
    return table("mm added", columns, rows) + "\n" + table("worst column", how, moved)
