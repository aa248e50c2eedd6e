"""Where a detector would see head and neck of people in motion capture: a head model.

Motion capture has two points there, and neither is one that detectors report: `head` is the end of
CMU's head bone, about as high as the ears, and `neck_base` the end of the thorax bone, below the
line of the shoulders.  This module adds the points that detectors report.  They are modelled, not
measured:

- Sizes are means of 6,068 men and women (ANSUR II: Gordon et al., 2012 Anthropometric Survey of
  U.S. Army Personnel, NATICK/TR-15/007) and, for the eyes' distance in front of the ears, of
  ANSUR 1988.  What is assumed rather than published says so.  A subject's size is that of his legs.
- The head moves with the line from `neck_base` to `head`.  How far it is rotated to a side is not
  in the data: that angle is drawn.
"""

from dataclasses import dataclass

import numpy as np

from edmlift.joints import INDEX, mid_hip, mid_shoulder

# Millimetres, ANSUR II.
STATURE, ACROMION, SUPRASTERNALE = 1714.4, 1406.2, 1403.0  # heights above the floor
TRAGION_TO_CROWN = 129.6
EYE_TO_CROWN = 898.1 - 785.9  # sitting height less eye height, sitting
CHIN_TO_CROWN = EYE_TO_CROWN + 119.5  # menton to sellion; the upper neck is where the chin is
HEAD_BREADTH = 152.2
PUPILS = 63.3
EYE_BEFORE_EAR = 80.5  # ANSUR 1988
# Assumed.
JOINT_BELOW_ACROMION = 40.0  # centre of the shoulder joint, which is what has the joint's name
NOSE_BEFORE_EAR, NOSE_BELOW_EAR = 120.0, 28.0
SIDEWAYS = 30.0  # degrees, standard deviation of the head's rotation to a side

SHOULDER = ACROMION - JOINT_BELOW_ACROMION
EAR = STATURE - TRAGION_TO_CROWN - SHOULDER  # heights above the line of the shoulders
NECK_BASE = SUPRASTERNALE - SHOULDER
EYE_ABOVE_EAR = TRAGION_TO_CROWN - EYE_TO_CROWN

# In the head's axes, origin between the ears: to the left, up, forward.
HEAD = {
    "crown": (0, TRAGION_TO_CROWN, 0),
    "left_ear": (HEAD_BREADTH / 2, 0, 0),
    "right_ear": (-HEAD_BREADTH / 2, 0, 0),
    "left_eye": (PUPILS / 2, EYE_ABOVE_EAR, EYE_BEFORE_EAR),
    "right_eye": (-PUPILS / 2, EYE_ABOVE_EAR, EYE_BEFORE_EAR),
    "nose": (0, -NOSE_BELOW_EAR, NOSE_BEFORE_EAR),
    "upper_neck": (0, TRAGION_TO_CROWN - CHIN_TO_CROWN, 0),
}


@dataclass(frozen=True)
class Frame:
    """Axes of head or torso, [F,3] each, and its size as a factor, [F]."""

    left: np.ndarray
    up: np.ndarray
    forward: np.ndarray
    size: np.ndarray

    def at(self, origin: np.ndarray, millimetres: tuple[float, float, float]) -> np.ndarray:
        """The point [F,3] so many millimetres to the left, up and forward of an origin [F,3]."""
        left, up, forward = millimetres
        step = left * self.left + up * self.up + forward * self.forward
        return origin + step * self.size[:, None] / 1000


def low_necks(joints: np.ndarray, subject: np.ndarray) -> np.ndarray:
    """Mask [F] of the subjects whose neck is below the line of their shoulders, as in CMU's own
    skeletons; those that were retargeted from others have it above."""
    rise = joints[:, INDEX["neck_base"]] - mid_shoulder(joints)
    height = np.einsum("fi,fi->f", rise, _up(joints))
    return _mean_of_each(height, subject) < 0


def landmarks(
    joints: np.ndarray, subject: np.ndarray, rng: np.random.Generator, raised: float = 0
) -> dict[str, np.ndarray]:
    """Points [F,3] by name, for poses [F,14,3] of the world or of a camera, metres.

    `raised` puts every head that many millimetres higher above the shoulders than published.
    """
    joints = joints.astype(float)
    size = _sizes(joints, subject)
    torso, head = _torso(joints, size), _head(joints, size, rng)
    shoulder = mid_shoulder(joints)
    # Between the ears: on the head's axis, for every subject as high on the mean as ears are.
    top = joints[:, INDEX["head"]]
    lack = (EAR + raised) * size / 1000 - np.einsum("fi,fi->f", top - shoulder, torso.up)
    share = np.einsum("fi,fi->f", head.up, torso.up)
    step = _mean_of_each(lack, subject) / _mean_of_each(share, subject)
    ears = top + step[:, None] * head.up
    points = {name: head.at(ears, place) for name, place in HEAD.items()}
    neck = torso.at(shoulder, (0, NECK_BASE, 0))
    # The fractions of mmpose (inference_3d.py) between base of the neck and crown.
    head = neck + 7 / 12 * (points["crown"] - neck)
    return points | {"collar": neck, "mid_shoulder": shoulder, "h36m_head": head}


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def _up(joints: np.ndarray) -> np.ndarray:
    return _unit(mid_shoulder(joints) - mid_hip(joints))


def _mean_of_each(values: np.ndarray, subject: np.ndarray) -> np.ndarray:
    """The mean over its subject at every pose."""
    _, which = np.unique(subject, return_inverse=True)
    return (np.bincount(which, values) / np.bincount(which))[which]


def _sizes(joints: np.ndarray, subject: np.ndarray) -> np.ndarray:
    """Length of the legs over that of all subjects on the mean, [F]."""
    legs = sum(
        np.linalg.norm(joints[:, INDEX[f"{side}_{a}"]] - joints[:, INDEX[f"{side}_{b}"]], axis=1)
        for side in ("right", "left")
        for a, b in (("hip", "knee"), ("knee", "ankle"))
    )
    length = _mean_of_each(legs, subject)
    _, first = np.unique(subject, return_index=True)
    return length / length[first].mean()


def _torso(joints: np.ndarray, size: np.ndarray) -> Frame:
    up = _up(joints)
    across = joints[:, INDEX["left_shoulder"]] - joints[:, INDEX["right_shoulder"]]
    left = _unit(across - np.einsum("fi,fi->f", across, up)[:, None] * up)
    return Frame(left, up, np.cross(left, up), size)


def _head(joints: np.ndarray, size: np.ndarray, rng: np.random.Generator) -> Frame:
    """The torso's axes, tilted to the line from neck to head and rotated at random."""
    up = _unit(joints[:, INDEX["head"]] - joints[:, INDEX["neck_base"]]).astype(float)
    across = joints[:, INDEX["left_shoulder"]] - joints[:, INDEX["right_shoulder"]]
    left = _unit(across - np.einsum("fi,fi->f", across, up)[:, None] * up)
    forward = np.cross(left, up)
    angle = np.radians(rng.normal(0, SIDEWAYS, len(joints)))[:, None]
    left, forward = (
        np.cos(angle) * left + np.sin(angle) * forward,
        np.cos(angle) * forward - np.sin(angle) * left,
    )
    return Frame(left, up, forward, size)
