"""What an adapter costs in accuracy.

    evaluate.py adapters TEST.npz [--model distances_f32] [--update docs/detectors.md] [--quick]

The test people are seen as detectors of several kinds see them, with the heads of
tools/data/head_model.py, exactly and with the noise of an imitated detector on every keypoint;
edml_adapt makes joints of that and edml_lift lifts them.
"""

import argparse
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from data import cameras
from data.head_model import landmarks
from data.mocap import Motion
from data.views import SEED
from edmlift.joints import INDEX, JOINTS
from edmlift.library import NO_KEYPOINT, Library
from edmlift.metrics import rigid_errors
from evaluation.command import Evaluation, Tables, load
from evaluation.measures import by_subject
from reports.markdown import Figure, table

HEAD, NECK = INDEX["head"], INDEX["neck_base"]
EARS, EYES_NOSE = ("left_ear", "right_ear"), ("left_eye", "right_eye", "nose")
RAISED = {"lower": -40, "higher": 40}  # mm by which the heads may be than modelled
HEAD_NOISE = cameras.DETECTOR_SHARE[HEAD]


@dataclass(frozen=True)
class Detections:
    """Keypoints [F,3] by name, joints of the models' and landmarks of detectors' alike, and the
    truth [F,14,3] in camera axes."""

    keypoints: dict[str, np.ndarray]
    truth: np.ndarray

    def joints(self, head: str | None, neck: str | None) -> np.ndarray:
        """The 14 joints [F,14,3] with these points as head and neck; None: not seen."""
        out = np.stack([self.keypoints[name] for name in JOINTS], 1)
        for joint, name in ((HEAD, head), (NECK, neck)):
            out[:, joint] = 0 if name is None else self.keypoints[name]
        return out

    def of_format(self, library: Library, name: str, hidden: tuple[str, ...] = ()) -> np.ndarray:
        """The keypoints [F,N,3] that the adapter of a format reads; the others are not seen."""
        layout = library.format(name)
        where = dict(zip(JOINTS[2:], layout.limb, strict=True))
        where |= dict(zip(EARS, layout.ears, strict=True))
        where |= dict(zip(EYES_NOSE, layout.face, strict=True))
        where |= {"crown": layout.crown, "h36m_head": layout.centre}
        out = np.zeros((len(self.truth), layout.keypoints, 3))
        for keypoint, index in where.items():
            if index != NO_KEYPOINT and keypoint not in hidden:
                out[:, index] = self.keypoints[keypoint]
        return out


def detect(motion: Motion, noise: bool, raised: float = 0) -> Detections:
    """One view of every pose, the heads `raised` by mm beyond what is published."""
    rng = np.random.default_rng(SEED)
    points = landmarks(motion.joints, motion.subject, rng, raised)
    space = cameras.look(np.concatenate([motion.joints, np.stack([*points.values()], 1)], 1), rng)
    image = cameras.project(space)
    if noise:
        share = np.concatenate([cameras.DETECTOR_SHARE, np.full(len(points), HEAD_NOISE)])
        image = cameras.detector_noise(image, rng, share=share)
    found = cameras.keypoints(image)
    names = (*JOINTS, *points)
    return Detections({name: found[:, n] for n, name in enumerate(names)}, space[:, :14])


def ways(library: Library, seen: Detections) -> dict[str, np.ndarray]:
    """Joints [F,14,3] that are lifted, by what they are."""
    adapt = {
        "coco17, both ears": ("coco17", ()),
        "coco17, right ear": ("coco17", ("left_ear",)),
        "coco17, eyes and nose": ("coco17", EARS),
        "coco17, no face": ("coco17", (*EARS, *EYES_NOSE)),
        "body25, both ears": ("body25", ()),
        "mpii16, crown": ("mpii16", ()),
        "aic14, crown": ("aic14", ()),
        "h36m17, head": ("h36m17_right_first", ()),
    }
    joints = {
        "the models' own head and neck": seen.joints("head", "neck_base"),
        "head and neck missing": seen.joints(None, None),
    }
    for title, (name, hidden) in adapt.items():
        joints[title] = library.adapt(seen.of_format(library, name, hidden), name)
    joints["*not adapted:* crown and upper neck (MPII)"] = seen.joints("crown", "upper_neck")
    joints["*not adapted:* crown and base of the neck (AIC)"] = seen.joints("crown", "collar")
    joints["*not adapted:* eyes and mid-shoulder"] = between(seen)
    return joints


def between(seen: Detections) -> np.ndarray:
    """Head between the eyes, neck between the shoulders: what mmpose makes of COCO's keypoints."""
    out = seen.joints(None, None)
    out[:, HEAD] = (seen.keypoints["left_eye"] + seen.keypoints["right_eye"]) / 2
    out[:, NECK] = (seen.keypoints["left_shoulder"] + seen.keypoints["right_shoulder"]) / 2
    return out


def measure(library: Library, joints: np.ndarray, truth: np.ndarray, subject: np.ndarray) -> dict:
    """Errors in mm of all joints, of head, neck and the others, and how many were refused."""
    poses = library.lift(joints)
    fine = poses.status == "ok"
    error = 1000 * rigid_errors(poses.joints[fine].astype(float), truth[fine])
    parts = {"all": slice(None), "limbs": slice(2, None), "head": [HEAD], "neck": [NECK]}
    means = {p: by_subject(error[:, j].mean(1), subject[fine]).mean() for p, j in parts.items()}
    return means | {"refused": int((~fine).sum())}


def evaluate(library: Library, motion: Motion) -> dict[str, dict]:
    """Figures by way and, in each, by "exact" and "noisy"."""
    figures: dict[str, dict] = {}
    for name, noise in (("exact", False), ("noisy", True)):
        seen = detect(motion, noise)
        lifted = ways(library, seen)
        for word, raised in RAISED.items():
            other = detect(motion, noise, raised).of_format(library, "coco17")
            title = f"coco17, both ears, heads {abs(raised)} mm {word} than modelled"
            lifted[title] = library.adapt(other, "coco17")
        for title, joints in tqdm(lifted.items(), desc=name, disable=None):
            result = measure(library, joints, seen.truth, motion.subject)
            figures.setdefault(title, {})[name] = result
    return figures


def report(figures: dict[str, dict]) -> str:
    """A row a way to get head and neck."""
    rows: dict[str, list[Figure]] = {}
    for title, columns in figures.items():
        exact, noisy = columns["exact"], columns["noisy"]
        rows[title] = [exact[p] for p in ("all", "limbs", "head", "neck")] + [noisy["all"]]
    heads = ["all 14", "12 limb joints", "head", "neck", "all, detector's noise"]
    return table("head and neck of", heads, rows)


def tables(args: argparse.Namespace) -> Tables:
    return {"adapters": report(evaluate(*load(args)))}


EVALUATION = Evaluation(__doc__, tables)
