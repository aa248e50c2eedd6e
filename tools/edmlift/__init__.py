"""edmlift: 2D joints of a person in, a 3D pose in metres out.

    import edmlift
    poses = edmlift.lift(keypoints, format="coco17")   # [F,17,2] or [F,17,3] pixels
    poses.joints                                       # [F,14,3] metres, NaN where refused
    poses.status                                       # [F] "ok", or why not

The method is that of F. Moreno-Noguer, "3D Human Pose Estimation from a Single Image via Distance
Matrix Regression" (CVPR 2017); "section" in this package refers to it.  The C library computes, so
that results are the bits that a microcontroller gets.  Axes are the camera's: x right, y down, z
away; the origin is midway between the hips; left and right are the subject's.
"""

from edmlift._version import __version__
from edmlift.body import fit_body
from edmlift.detections import Detections, read_detections
from edmlift.drawing import draw
from edmlift.files import read_keypoints, read_poses, read_truth, write_poses
from edmlift.formats import FORMATS
from edmlift.joint_angles import ANGLES, angles, flexion, heading, lean
from edmlift.joints import BONES, JOINTS, MIRROR
from edmlift.keypoint_files import FileError
from edmlift.keypoints import adapt
from edmlift.lifting import Poses, lift
from edmlift.metrics import joint_errors, mpjpe, pa_mpjpe, pck, procrustes
from edmlift.motion import MOTION_SUFFIXES, write_motion
from edmlift.networks import models
from edmlift.people_tracks import TrackedPeople, track_people
from edmlift.placing import PlacedTrack, Placements, focal_length, place, stand
from edmlift.plausibility import joint_limits, quality, reflect_by_joint_limits, uncertainty
from edmlift.tracking import Track, Tracked, track
from edmlift.viewing import view

__all__ = [
    "ANGLES",
    "BONES",
    "Detections",
    "FORMATS",
    "JOINTS",
    "MIRROR",
    "MOTION_SUFFIXES",
    "FileError",
    "PlacedTrack",
    "Placements",
    "Poses",
    "Track",
    "Tracked",
    "TrackedPeople",
    "__version__",
    "adapt",
    "angles",
    "draw",
    "fit_body",
    "flexion",
    "focal_length",
    "heading",
    "joint_errors",
    "joint_limits",
    "lean",
    "lift",
    "models",
    "mpjpe",
    "pa_mpjpe",
    "pck",
    "place",
    "procrustes",
    "quality",
    "read_detections",
    "read_keypoints",
    "read_poses",
    "read_truth",
    "reflect_by_joint_limits",
    "stand",
    "track",
    "track_people",
    "uncertainty",
    "view",
    "write_motion",
    "write_poses",
]
