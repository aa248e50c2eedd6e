"""What a model ships with beside its layers: the settings of its manifest, checked."""

import dataclasses
import json
from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from data.archives import one_line
from edmlift.joints import JOINTS
from export.layers import ExportError
from export.limits import LARGEST_MANIFEST, check_size
from model.constants import MAX_IMPUTED, OBJECTIVES
from model.manifest import NEAREST, NO_FUSION

# What a model holds of joints that are not seen: how to impute them, or nothing: their pairs are 0.
MISSING = {"zero": "NULL", "imputed": "&edml_default_imputation"}
FEWEST_TO_ORIENT = 4  # seen joints that it takes to rotate a pose to the camera

# Formats of weights, and where the manifest has their errors.
METRICS = {"f32": "metrics", "w16": "metrics_w16", "w8": "metrics_w8"}

FUSION_RANGES = f"share 0 to 1, misfit 0.01 to 1 and distance {NEAREST:g} to 1000"


def is_fusion(value: object) -> bool:
    """Are these numbers of the fuse stage?  Beyond the ranges fixed point might overflow."""
    if not (isinstance(value, Mapping) and set(value) == set(NO_FUSION)):
        return False
    if not all(map(is_real, value.values())):
        return False
    share, misfit, distance = (value[name] for name in NO_FUSION)
    return 0 <= share <= 1 and 0.01 <= misfit <= 1 and NEAREST <= distance <= 1000


@dataclasses.dataclass(frozen=True)
class ModelSettings:
    """What belongs to a model beside its layers.  Raises ExportError where a value cannot be."""

    fewest_joints: int  # seen joints below which edml_lift refuses
    objective: str = "none"  # of the refinement, one of OBJECTIVES
    refine_steps: int = 0
    # Weights of arms, forearms, head, thighs, shins; of networks that give distances alone.
    mirror: Sequence[float] = (0, 0, 0, 0, 0)
    missing: str = "zero"  # what joints that are not seen are, one of MISSING
    fusion: Mapping[str, float] = dataclasses.field(default_factory=lambda: dict(NO_FUSION))
    mds_share: float = 0.0  # of the points of the MDS in the mean with the network's
    recipe: Mapping[str, Any] = dataclasses.field(default_factory=dict)  # at least name and seed
    data: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    metrics: Mapping[str, float] = dataclasses.field(default_factory=dict)  # column -> mm
    metrics_w16: Mapping[str, float] = dataclasses.field(default_factory=dict)
    metrics_w8: Mapping[str, float] = dataclasses.field(default_factory=dict)
    calibration: Mapping[str, Any] = dataclasses.field(default_factory=dict)  # calibrate()

    def __post_init__(self) -> None:
        joints = is_integer(self.fewest_joints, FEWEST_TO_ORIENT, len(JOINTS))
        check_setting("fewest_joints", joints, f"{FEWEST_TO_ORIENT} to {len(JOINTS)}")
        check_setting(
            "objective", is_one_of(self.objective, OBJECTIVES), f"one of {', '.join(OBJECTIVES)}"
        )
        check_setting("refine_steps", is_integer(self.refine_steps, 0, 255), "0 to 255")
        mirror = isinstance(self.mirror, list | tuple) and len(self.mirror) == 5
        mirror = mirror and all(map(is_number, self.mirror))
        check_setting("mirror", mirror, "five numbers between -128 and 128")
        check_setting("missing", is_one_of(self.missing, MISSING), f"one of {', '.join(MISSING)}")
        fewest = FEWEST_TO_ORIENT if self.missing == "zero" else len(JOINTS) - MAX_IMPUTED
        check_setting("fewest_joints", self.fewest_joints >= fewest, f"{fewest} or more")
        check_setting("fusion", is_fusion(self.fusion), FUSION_RANGES)
        share = is_real(self.mds_share) and 0 <= self.mds_share <= 1
        check_setting("mds_share", share, "0 to 1")
        for name in ("recipe", "data", "calibration", *METRICS.values()):
            check_setting(name, isinstance(getattr(self, name), Mapping), "an object")
        for name in METRICS.values():
            numbers = all(map(is_real, getattr(self, name).values()))
            check_setting(name, numbers, "numbers by column")

    def errors(self, form: str) -> Mapping[str, float]:
        """Error of the whole lift on the test people, column -> mm; empty if not measured."""
        return getattr(self, METRICS[form])


def check_setting(name: str, good: bool, want: str) -> None:
    """Raises ExportError unless the setting is good."""
    if not good:
        raise ExportError(f"manifest: {name} must be {want}")


def is_one_of(value: object, names: Container[str]) -> bool:
    """A text, and one of the names."""
    return isinstance(value, str) and value in names


def is_integer(value: object, low: int, high: int) -> bool:
    """An integer within these bounds, and no bool."""
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def is_real(value: object) -> bool:
    """A number that a float can hold."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    return abs(value) <= float(np.finfo(np.float32).max)


def is_number(value: object) -> bool:
    """A number that an edml_number can hold, in Q24 too."""
    return isinstance(value, int | float) and is_real(value) and abs(value) < 128


def read_settings(path: Path, needs: Sequence[str]) -> ModelSettings:
    """The settings in a manifest, which must have those that the kind of network needs; keys that
    ModelSettings does not know are left to others."""
    try:
        if path.is_file():
            check_size(path.stat().st_size, f"manifest {path.name}", LARGEST_MANIFEST)
        manifest = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        raise ExportError(
            f"no manifest {path.name}: write one with {', '.join(needs)}, "
            "or name another by --manifest"
        ) from None
    except RecursionError:
        raise ExportError(f"manifest {path.name} is nested too deeply") from None
    except (OSError, ValueError) as error:
        raise ExportError(f"manifest {path.name}: {one_line(error)}") from error
    if not isinstance(manifest, dict):
        raise ExportError(f"manifest {path.name} is not a JSON object")
    if missing := [name for name in needs if name not in manifest]:
        raise ExportError(f"manifest {path.name} lacks {', '.join(missing)}")
    known = {field.name for field in dataclasses.fields(ModelSettings)}
    return ModelSettings(**{name: value for name, value in manifest.items() if name in known})
