"""Virtual cameras and an imitated 2D detector: from motion capture to keypoints.

Everything is vectorised over F poses and draws from a `numpy.random.Generator`, so one seed
gives one data set.  World frame: metres, y up, floor near y = 0.  Camera axes: x right, y down,
z away from the camera.  Image: pixels, y down.
"""

from dataclasses import dataclass

import numpy as np

from edmlift import joints as skeleton
from edmlift.joints import BONE_TYPE, HINGES, LIMBS, PARENT, indices, mid_hip

FOCAL = 1145.0  # pixels
CENTRE = 500.0  # principal point of the 1000x1000 image, both axes

# Error of a detector joint by joint, as a share of its overall sigma (notes of the paper's
# detector, CPM: wrists and ankles are the hardest).
DETECTOR_SIGMA = 8.7  # pixels
DETECTOR_SHARE = np.array(
    [0.74, 0.56, 0.66, 1.10, 1.52, 0.66, 1.10, 1.52, 0.90, 0.88, 1.19, 0.90, 0.88, 1.19]
)
DETECTOR_SCALES = (0.7, 2.1)  # good and bad detections ...
DETECTOR_BAD = 0.1  # ... and the share of bad ones

STRAIGHT = np.radians(15)  # limbs that are made straight are bent by less than this
NO_PLANE = 1e-6  # metres: a limb whose end is nearer to its first bone's line is bent in no plane

ADAPTED_HEAD = (0.012, 0.012, 0.040)  # metres an axis: both ears or the crown; ears; an ear, a face


@dataclass(frozen=True)
class Rig:
    """Ranges from which cameras are drawn (uniform unless said otherwise)."""

    distance: tuple[float, float] = (3.0, 6.0)  # metres, camera to pelvis
    height: tuple[float, float] = (0.5, 2.5)  # metres above the floor
    aim_sigma: float = 0.05  # metres; the camera looks at the pelvis give or take this
    roll_sigma: float = 3.0  # degrees, normal
    roll_range: float = 0.0  # degrees, uniform in +-, added


PROTOCOL = Rig()
ROLLED = Rig(roll_sigma=0.0, roll_range=30.0)
CLOSE = Rig(distance=(1.5, 3.0))


def look(joints: np.ndarray, rng: np.random.Generator, rig: Rig = PROTOCOL) -> np.ndarray:
    """Joints in the axes of one random camera each.

    joints [F,14,3] world, metres -> [F,14,3] camera axes, metres, camera at the origin.
    """
    return look_and_up(joints, rng, rig)[0]


def look_and_up(
    joints: np.ndarray, rng: np.random.Generator, rig: Rig = PROTOCOL
) -> tuple[np.ndarray, np.ndarray]:
    """look(), and the upward direction [F,3] in the axes of each camera, unit vectors."""
    count = len(joints)
    pelvis = mid_hip(joints).astype(float)
    distance = rng.uniform(*rig.distance, count)
    height = rng.uniform(*rig.height, count)
    yaw = rng.uniform(0, 2 * np.pi, count)
    roll = np.radians(
        rng.normal(0, rig.roll_sigma, count) + rng.uniform(-rig.roll_range, rig.roll_range, count)
    )
    # The slant distance holds unless the camera would have to stand straight above the pelvis.
    rise = np.clip(height - pelvis[:, 1], -0.95 * distance, 0.95 * distance)
    ground = np.sqrt(distance**2 - rise**2)
    camera = pelvis + np.stack([ground * np.cos(yaw), rise, ground * np.sin(yaw)], 1)
    aim = pelvis + rng.normal(0, rig.aim_sigma, (count, 3))

    axes = camera_axes(camera, aim, roll)
    return _to_camera(joints, camera, axes), axes[..., 1]


def look_from(
    joints: np.ndarray, camera: np.ndarray, aim: np.ndarray, roll: float | np.ndarray = 0.0
) -> np.ndarray:
    """Joints in the axes of given cameras: one for all poses, or one each.

    joints [F,14,3] world, metres; camera and aim [3] or [F,3], the points where the camera stands
    and at which it looks; roll in radians, clockwise -> [F,14,3] camera axes, camera at the origin.
    """
    return _to_camera(joints, camera, camera_axes(camera, aim, roll))


def camera_axes(camera: np.ndarray, aim: np.ndarray, roll: float | np.ndarray = 0.0) -> np.ndarray:
    """Rows [...,3,3]: right, down and forward in the world, of cameras as look_from() has them."""
    forward = _unit(aim - camera)
    right = _unit(np.cross(forward, [0.0, 1.0, 0.0]))
    down = np.cross(forward, right)
    c, s = np.cos(roll)[..., None], np.sin(roll)[..., None]
    return np.stack([c * right + s * down, c * down - s * right, forward], -2)


def _to_camera(joints: np.ndarray, camera: np.ndarray, axes: np.ndarray) -> np.ndarray:
    return np.einsum("...ij,...kj->...ki", axes, joints - camera[..., None, :])


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def project(camera_joints: np.ndarray) -> np.ndarray:
    """Pinhole projection: [F,14,3] metres, camera axes -> [F,14,2] pixels."""
    return FOCAL * camera_joints[..., :2] / camera_joints[..., 2:] + CENTRE


def keypoints(points: np.ndarray, seen: np.ndarray | None = None) -> np.ndarray:
    """Detector output [F,14,3]: x, y and confidence 1, or three zeros where `seen` is false."""
    out = np.concatenate([points, np.ones_like(points[..., :1])], -1)
    return out if seen is None else np.where(seen[..., None], out, 0.0)


def gaussian_noise(
    points: np.ndarray, sigma: float | np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Adds N(0, sigma) pixels to each coordinate; sigma a number or one a pose, [F]."""
    return points + rng.normal(size=points.shape) * np.reshape(sigma, (-1, 1, 1))


def detector_noise(
    points: np.ndarray,
    rng: np.random.Generator,
    scale: float | np.ndarray = 1.0,
    share: np.ndarray = DETECTOR_SHARE,
) -> np.ndarray:
    """Adds the error of a detector: its own share a joint, some draws good, some bad."""
    count, joints = points.shape[:2]
    bad = rng.random((count, joints)) < DETECTOR_BAD
    sigma = DETECTOR_SIGMA * share * np.where(bad, DETECTOR_SCALES[1], DETECTOR_SCALES[0])
    sigma = sigma * np.reshape(scale, (-1, 1))
    return points + rng.normal(size=points.shape) * sigma[..., None]


def adapter_error(
    points: np.ndarray, camera_joints: np.ndarray, neck: float, rng: np.random.Generator
) -> np.ndarray:
    """Head and neck as edml_adapt() puts them for detectors that have neither of the models'.

    The neck is on the line from between the shoulders to between the hips, at the share `neck` of
    it; the head is off by ADAPTED_HEAD, as docs/detectors.md says for what detectors show of heads.
    points [F,14,2], pixels; camera_joints [F,14,3] -> [F,14,2].
    """
    out = points.copy()
    shoulders, hips = skeleton.mid_shoulder(points), mid_hip(points)
    out[:, skeleton.INDEX["neck_base"]] = shoulders + neck * (hips - shoulders)
    pixels = FOCAL / mid_hip(camera_joints)[:, 2:]  # per metre
    sigma = rng.choice(ADAPTED_HEAD, (len(points), 1))
    head = skeleton.INDEX["head"]
    out[:, head] += rng.normal(size=(len(points), 2)) * sigma * pixels
    return out


# Where detectors put joints that motion capture has elsewhere: metres, the standard deviation of an
# offset that a detector has for everyone alike, along the bone that ends there, and across.
DEFINITION = {
    "shoulder": (0.015, 0.015), "elbow": (0.010, 0.005), "wrist": (0.020, 0.005),
    "hip": (0.030, 0.025), "knee": (0.015, 0.005), "ankle": (0.020, 0.008),
}  # fmt: skip


def redefine(
    joints: np.ndarray, rng: np.random.Generator, scale: float | np.ndarray = 1.0
) -> np.ndarray:
    """Poses whose joints are defined a little differently, left and right alike.

    joints [F,14,3]; scale: of DEFINITION, a number or one a pose [F].  The offsets are along the
    bone (of hips and shoulders: along the trunk), and across it away from the body's middle.
    """
    out = joints.astype(float)
    up = _unit(joints[:, skeleton.INDEX["neck_base"]] - mid_hip(joints))
    for name, sigma in DEFINITION.items():
        along, across = rng.normal(size=(2, len(joints), 1)) * np.reshape(scale, (1, -1, 1))
        right, left = indices((f"right_{name}", f"left_{name}"))
        outward = _unit(joints[:, right] - joints[:, left])
        for joint, sign in ((right, 1), (left, -1)):
            bone = up
            if name not in ("hip", "shoulder"):
                bone = _unit(joints[:, joint] - joints[:, PARENT[joint]])
            out[:, joint] += sigma[0] * along * bone + sign * sigma[1] * across * outward
    return out


def hide_random(count: int, missing: int | np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Mask [F,14] with `missing` random joints (a number, or one a pose) not seen."""
    order = rng.random((count, len(skeleton.JOINTS))).argsort(1).argsort(1)
    return order >= np.reshape(missing, (-1, 1))


def hide_limb(count: int, limb: str) -> np.ndarray:
    """Mask [F,14] with the two outer joints of a limb not seen."""
    seen = np.ones((count, len(skeleton.JOINTS)), bool)
    seen[:, indices(LIMBS[limb])] = False
    return seen


def vary_bodies(
    joints: np.ndarray, rng: np.random.Generator, height: float = 0.06, bone: float = 0.10
) -> np.ndarray:
    """Poses of other people: scaled by 1 +- height, each bone type by 1 +- bone (uniform).

    Bone directions and the mid-hip stay; left and right change alike.  [F,14,3] -> [F,14,3].
    """
    count = len(joints)
    scale = np.ones((count, len(skeleton.JOINTS), 1))
    stature = rng.uniform(1 - height, 1 + height, (count, 1, 1))
    for children in BONE_TYPE.values():
        scale[:, indices(children)] = stature * rng.uniform(1 - bone, 1 + bone, (count, 1, 1))
    offsets = (joints - joints[:, PARENT]) * scale
    varied = np.zeros_like(offsets)
    for joint, parent in enumerate(PARENT):  # the neck, its own parent, stays at the origin
        varied[:, joint] = varied[:, parent] + offsets[:, joint]
    return varied + (mid_hip(joints) - mid_hip(varied))[:, None]


def mix_limbs(
    joints: np.ndarray, limbs: tuple[str, ...], share: float, rng: np.random.Generator
) -> np.ndarray:
    """Poses of which a share has the limbs of another one, as that one holds them to its trunk.

    limbs: both arms or both legs, names of skeleton.LIMBS.  Bone lengths stay.
    [F,14,3] -> [F,14,3].
    """
    chosen = np.flatnonzero(rng.random(len(joints)) < share)
    other = joints[rng.integers(0, len(joints), len(chosen))]
    out = joints.astype(float)
    mine = out[chosen]
    roots = [PARENT[indices(LIMBS[limb])[0]] for limb in limbs]
    rotation = np.einsum("fki,fkj->fij", _trunk(mine, *roots), _trunk(other, *roots))
    for child in (joint for limb in limbs for joint in indices(LIMBS[limb])):
        parent = PARENT[child]
        length = np.linalg.norm(mine[:, child] - mine[:, parent], axis=-1, keepdims=True)
        direction = _unit(np.einsum("fij,fj->fi", rotation, other[:, child] - other[:, parent]))
        out[chosen, child] = out[chosen, parent] + length * direction
    return out


def straighten_limbs(joints: np.ndarray, share: float, rng: np.random.Generator) -> np.ndarray:
    """Poses of which a share of the arms and legs is straight: bent by 0 to STRAIGHT.

    What is behind elbow or knee turns about it, in the plane in which the limb is bent.  A limb
    that is straighter stays as it is.  [F,14,3] -> [F,14,3].
    """
    out = joints.astype(float)
    for start, middle, end in HINGES:
        along = _unit(out[:, middle] - out[:, start])
        lower = out[:, end] - out[:, middle]
        ahead = np.sum(lower * along, 1)
        beside = lower - ahead[:, None] * along
        aside = np.linalg.norm(beside, axis=1)
        angle = rng.random(len(joints)) * STRAIGHT
        chosen = (rng.random(len(joints)) < share) & (aside > ahead * np.tan(angle))
        chosen &= aside > NO_PLANE
        a, across = angle[chosen, None], beside[chosen] / aside[chosen, None]
        direction = np.cos(a) * along[chosen] + np.sin(a) * across
        length = np.linalg.norm(lower[chosen], axis=1, keepdims=True)
        out[chosen, end] = out[chosen, middle] + length * direction
    return out


def _trunk(joints: np.ndarray, right: int, left: int) -> np.ndarray:
    """Axes [F,3,3], a row each: to the left (from joint to joint), up, forward."""
    across = _unit(joints[:, left] - joints[:, right])
    up = joints[:, skeleton.INDEX["neck_base"]] - mid_hip(joints)
    forward = _unit(np.cross(across, up))
    return np.stack([across, np.cross(forward, across), forward], 1)
