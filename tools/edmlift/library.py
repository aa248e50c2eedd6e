"""ctypes binding of the C library: every figure and pose that a tool reports comes through here.

Build the shared library with `cmake -B build/dev -DEDMLIFT_TOOLS=ON && cmake --build build/dev`,
or point EDMLIFT_LIBRARY at one.
"""

import ctypes
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edmlift.joints import JOINTS

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "build" / "dev" / "libedmlift_tools.so"

POSE = np.dtype(
    [
        ("joint", np.float32, (len(JOINTS), 3)),
        ("mirror_margin", np.float32),
        ("residual", np.float32),
        ("seen", np.uint16),
    ],
    align=True,
)
PLACEMENT = np.dtype(
    [
        ("joint", np.float32, (len(JOINTS), 3)),
        ("rotation", np.float32, (3, 3)),
        ("translation", np.float32, 3),
        ("reprojection", np.float32),
        ("steps", np.uint16),
    ],
    align=True,
)
PERSON = np.dtype([("height", np.float32), ("bone", np.float32, 13)])
# What edml_lift_q24 takes and gives: Q16, confidence Q15.
KEYPOINT_Q16 = np.dtype([("at", np.int32, 2), ("c", np.int16)], align=True)
POSE_Q16 = np.dtype(
    [
        ("joint", np.int32, (len(JOINTS), 3)),
        ("mirror_margin", np.int32),
        ("residual", np.int32),
        ("seen", np.uint16),
    ],
    align=True,
)
# edml_work and edml_fconv_work are at most this; tests hold them to that.
WORK_BYTES, FCONV_WORK_BYTES = 4096, 24576


@dataclass(frozen=True)
class Poses:
    """What `lift` returns for F poses; where status is not "ok" the numbers are NaN."""

    joints: np.ndarray  # [F,14,3] metres, camera axes, origin at mid-hip
    margin: np.ndarray  # [F] log-odds of the mirror choice
    residual: np.ndarray  # [F] metres
    status: np.ndarray  # [F] names


class Format(ctypes.Structure):
    """edml_format: indices of a detector's keypoints; NO_KEYPOINT where it has none."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("keypoints", ctypes.c_uint8),
        ("shares", ctypes.c_uint8),
        ("limb", ctypes.c_uint8 * 12),
        ("ears", ctypes.c_uint8 * 2),
        ("face", ctypes.c_uint8 * 3),
        ("crown", ctypes.c_uint8),
        ("centre", ctypes.c_uint8),
    ]


NO_KEYPOINT = 255


class Point(ctypes.Structure):
    """edml_point, for what is passed by value."""

    _fields_ = [(axis, ctypes.c_float) for axis in "xyz"]


@dataclass(frozen=True)
class Placements:
    """What `place` returns for F poses; where status is not "ok" the numbers are NaN, steps 0."""

    joints: np.ndarray  # [F,14,3] metres, camera axes, origin at the camera's centre
    rotation: np.ndarray  # [F,3,3]: joints = rotation @ pose + translation
    translation: np.ndarray  # [F,3] metres
    reprojection: np.ndarray  # [F] RMS, pixels
    focal: np.ndarray  # [F] pixels: given, or chosen by the sweep
    steps: np.ndarray  # [F]
    status: np.ndarray  # [F] names


# edml_track.
SMOOTHING = np.dtype([("cutoff", np.float32), ("slope", np.float32)])
MOVING = np.dtype([("at", np.float32, 3), ("rate", np.float32, 3)])
TRACKED_JOINT = np.dtype(
    [
        ("image", MOVING),
        ("space", MOVING),
        ("off", np.float32, 2),
        ("age", np.uint16),
    ],
    align=True,
)
TRACK = np.dtype(
    [
        ("smooth_image", SMOOTHING),
        ("smooth_space", SMOOTHING),
        ("noise", np.float32),
        ("unsteady", np.float32),
        ("elapsed", np.uint32),
        ("held", np.uint16),
        ("exchanged", np.uint8),
        ("mirrored", np.uint8),
        ("started", np.uint8),
        ("time", np.uint32),
        ("arms", np.float32),
        ("legs", np.float32),
        ("mirror", np.float32),
        ("joint", TRACKED_JOINT, len(JOINTS)),
    ],
    align=True,
)


@dataclass(frozen=True)
class Tracked(Poses):
    """What `Track.lift` returns for F frames; reports are 0 where status is not "ok"."""

    seen: np.ndarray  # [F] bit j: joint j was seen
    held: np.ndarray  # [F] bit j: joint j was held
    exchanged: np.ndarray  # [F] 1: right and left arm were exchanged, 2: legs, 3: all
    mirrored: np.ndarray  # [F] the other mirror image than the lift's was taken
    elapsed: np.ndarray  # [F] ms since the last frame, 0 at a start


class Library:
    """The C library; `model` names one of its models, such as "fconn_f32".

    With `fixed`, `lift` is edml_lift_q24, which takes quantised models.  Models named "fconv_..."
    go through edml_lift_fconv and edml_lift_fconv_q24.
    """

    def __init__(self, model: str = "fconn_f32", path: Path | None = None, fixed: bool = False):
        path = path or Path(os.environ.get("EDMLIFT_LIBRARY", LIBRARY))
        if not path.exists():
            raise FileNotFoundError(f"{path}: not built; see the head of tools/edmlift/library.py")
        self._c = ctypes.CDLL(str(path))
        self._c.edml_status_name.restype = ctypes.c_char_p
        for name, result in (
            ("edml_refine_f32", ctypes.c_int),
            ("edml_stress_f32", ctypes.c_float),
            ("edml_mirror_f32", ctypes.c_float),
            ("edml_quality", ctypes.c_float),
        ):
            getattr(self._c, name).restype = result
        self.fixed = fixed
        self.model = ctypes.addressof(ctypes.c_char.in_dll(self._c, f"edml_{model}"))
        self._fconv = "fconv_" if model.startswith("fconv") else ""
        self._work = ctypes.create_string_buffer(FCONV_WORK_BYTES if self._fconv else WORK_BYTES)

    def has(self, model: str) -> bool:
        """Is this one of the library's models?"""
        return hasattr(self._c, f"edml_{model}")

    def status_name(self, status: int) -> str:
        return self._c.edml_status_name(status).decode()

    def lift(self, keypoints: np.ndarray) -> Poses:
        """Lifts keypoints [F,14,3]: x, y in pixels and confidence."""
        keypoints = checked_keypoints(keypoints)
        if self.fixed:
            lift = getattr(self._c, f"edml_lift_{self._fconv}q24")
            poses, status = self._call(lift, to_q16(keypoints), POSE_Q16)
            unit = np.float32(1 / 65536)
        else:
            lift = self._c.edml_lift_fconv if self._fconv else self._c.edml_lift
            poses, status = self._call(lift, keypoints, POSE)
            unit = np.float32(1)
        return self._poses(poses, status, unit)

    def _poses(self, poses: np.ndarray, status: np.ndarray, unit: np.float32) -> Poses:
        """Numbers in metres, NaN where a pose has a status."""
        names = ("joint", "mirror_margin", "residual")
        numbers = [(poses[name] * unit).astype(np.float32) for name in names]
        for array in numbers:
            array[status != 0] = np.nan
        statuses = np.array([self.status_name(s) for s in range(0, status.min(initial=0) - 1, -1)])
        return Poses(*numbers, statuses[-status])

    def _call(self, lift, keypoints: np.ndarray, pose: np.dtype) -> tuple[np.ndarray, np.ndarray]:
        """Poses [F] and status [F] of a C function that lifts one."""
        poses = np.zeros(len(keypoints), pose)
        status = np.zeros(len(keypoints), np.int32)
        model = ctypes.c_void_p(self.model)
        source, target = keypoints.ctypes.data, poses.ctypes.data

        def run(first: int) -> None:
            work = ctypes.create_string_buffer(len(self._work))
            for i in range(first, len(keypoints), threads):
                status[i] = lift(
                    ctypes.c_void_p(target + i * pose.itemsize),
                    ctypes.c_void_p(source + i * keypoints.strides[0]),
                    model,
                    work,
                )

        # FConv is so slow that it is worth while to share the work: while C runs, so may another.
        threads = (os.cpu_count() or 1) if self._fconv else 1
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(run, range(threads)))
        return poses, status

    def format(self, name: str) -> Format:
        """One of the formats of keypoints, such as "coco17"."""
        return Format.in_dll(self._c, f"edml_{name}")

    def adapt(self, keypoints: np.ndarray, name: str) -> np.ndarray:
        """Keypoints [F,N,3] of a format to those of the joints, [F,14,3]."""
        layout = self.format(name)
        if keypoints.ndim != 3 or keypoints.shape[1:] != (layout.keypoints, 3):
            raise ValueError(f"keypoints must be [F,{layout.keypoints},3], not {keypoints.shape}")
        keypoints = _f32(keypoints)
        joints = np.zeros((len(keypoints), len(JOINTS), 3), np.float32)
        for one, out in zip(keypoints, joints, strict=True):
            self._c.edml_adapt(_pointer(out), _pointer(one), ctypes.byref(layout))
        return joints

    def fit_person(
        self, poses: np.ndarray, height: np.ndarray | float = 0, bones: np.ndarray | float = 0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Poses [F,14,3] of the size of people whose height, number or [F], and bones, [13] or
        [F,13], are known where they are not 0, in metres; and the names of the status [F]."""
        fitted = np.zeros(len(poses), POSE)
        fitted["joint"] = poses
        people = np.zeros(len(poses), PERSON)
        people["height"], people["bone"] = height, bones
        status = [
            self._c.edml_fit_person(_pointer(fitted[i : i + 1]), _pointer(people[i : i + 1]))
            for i in range(len(poses))
        ]
        names = np.array([self.status_name(s) for s in status])
        return np.where((names == "ok")[:, None, None], fitted["joint"], np.nan), names

    def quality(self, poses: Poses, keypoints: np.ndarray) -> np.ndarray:
        """Quality [F] of what `lift` returned for keypoints [F,14,3]; NaN where it refused."""
        given = np.zeros(len(poses.joints), POSE)
        given["joint"], given["residual"] = poses.joints, poses.residual
        given["mirror_margin"] = poses.margin
        keypoints = _f32(keypoints)
        found = [self._c.edml_quality(*map(_pointer, pair))
                 for pair in zip(np.split(given, len(given)), keypoints, strict=True)]  # fmt: skip
        return np.where(poses.status == "ok", found, np.nan)

    def uncertainty(self, seen: np.ndarray) -> np.ndarray:
        """Mean errors in mm [F,14] of joints given which were seen, [F,14]; NaN: too few."""
        found = np.zeros(seen.shape, np.uint8)
        bits = map(ctypes.c_uint16, seen @ (1 << np.arange(14)))
        pairs = zip(map(_pointer, found), bits, strict=True)
        status = [self._c.edml_uncertainty(*pair) for pair in pairs]
        return np.where(np.array(status)[:, None] == 0, found, np.nan)

    def limits(self, poses: np.ndarray) -> np.ndarray:
        """How many bones [F] of poses [F,14,3] are beyond human limits."""
        given, limits, _ = self._given(poses)
        return np.array([limits(_pointer(given[i : i + 1])) for i in range(len(given))], int)

    def mirror_by_limits(self, poses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The mirror images [F,14,3] of poses with fewer such bones, and how many fewer [F]."""
        given, _, mirror = self._given(poses)
        fewer = np.array([mirror(_pointer(given[i : i + 1])) for i in range(len(given))], int)
        return given["joint"] / (65536 if self.fixed else 1), fewer

    def _given(self, poses: np.ndarray) -> tuple[np.ndarray, Callable, Callable]:
        """Poses as the library takes them, and its functions for joint limits."""
        given = np.zeros(len(poses), POSE_Q16 if self.fixed else POSE)
        given["joint"] = np.round(poses * 65536) if self.fixed else poses
        if self.fixed:
            return given, self._c.edml_limits_q24, self._c.edml_mirror_by_limits_q24
        return given, self._c.edml_limits, self._c.edml_mirror_by_limits

    def floor(self, pose: np.ndarray, up: tuple[float, float, float]) -> tuple[str, np.ndarray]:
        """Status name, and the joints [14,3] of a pose, y up from the floor."""
        out, given = np.full((14, 3), np.nan, np.float32), np.zeros(1, POSE)
        given["joint"] = pose
        status = self._c.edml_floor(_pointer(out), _pointer(given), Point(*up))
        return self.status_name(status), out

    def place(
        self, poses: np.ndarray, keypoints: np.ndarray, camera: tuple[float, float, float, float]
    ) -> Placements:
        """Places poses [F,14,3] before a camera (fx, fy, cx, cy) that sees keypoints [F,14,3]."""
        intrinsics = np.array(camera, np.float32)

        def run(_i: int, placement: int, camera: int, pose: int, seen: int) -> int:
            pointers = map(ctypes.c_void_p, (placement, pose, seen, camera))
            return self._c.edml_place(*pointers, self._work)

        return self._placed(poses, keypoints, intrinsics, run)

    def place_sweep(
        self, poses: np.ndarray, keypoints: np.ndarray, size: np.ndarray | tuple[float, float]
    ) -> Placements:
        """The same by cameras of unknown focal length, of whose images `size` is the width and
        height, [2] or [F,2]; the principal point is in the middle."""
        sizes = np.broadcast_to(np.asarray(size, np.float32), (len(poses), 2))

        def run(i: int, placement: int, camera: int, pose: int, seen: int) -> int:
            pointers = map(ctypes.c_void_p, (placement, camera, pose, seen))
            width, height = map(ctypes.c_float, sizes[i])
            return self._c.edml_place_sweep(*pointers, width, height, self._work)

        return self._placed(poses, keypoints, np.full(4, np.nan, np.float32), run)

    def _placed(
        self,
        poses: np.ndarray,
        keypoints: np.ndarray,
        camera: np.ndarray,
        run: Callable[[int, int, int, int, int], int],
    ) -> Placements:
        """Calls `run`, for each pose, with its number and pointers to placement, camera, pose and
        keypoints."""
        if poses.shape != keypoints.shape or poses.shape[1:] != (len(JOINTS), 3):
            raise ValueError(
                f"poses and keypoints must be [F,{len(JOINTS)},3], "
                f"not {poses.shape} and {keypoints.shape}"
            )
        given = np.zeros(len(poses), POSE)
        given["joint"] = poses
        keypoints = _f32(keypoints)
        placed = np.zeros(len(poses), PLACEMENT)
        for field in ("joint", "rotation", "translation", "reprojection"):
            placed[field] = np.nan
        cameras = np.tile(camera, (len(poses), 1))
        status = [
            run(i, *(a[i : i + 1].ctypes.data for a in (placed, cameras, given, keypoints)))
            for i in range(len(poses))
        ]
        return Placements(
            *(placed[f] for f in ("joint", "rotation", "translation", "reprojection")),
            np.where(np.array(status) == 0, cameras[:, 0], np.nan),
            placed["steps"],
            np.array([self.status_name(s) for s in status]),
        )

    def track(self) -> "Track":
        """A new track of one person in a video."""
        return Track(self)

    # The stages, one pose at a time.

    def edm(
        self, keypoints: np.ndarray, fewest: int, widest: float, complete: bool
    ) -> tuple[str, np.ndarray]:
        """Status name and normalised 2D distances [91] of keypoints [14,3].

        Joints that are not seen are guessed if `complete`, otherwise their distances are zero.
        """
        out = np.zeros(91, np.float32)
        usual = ctypes.addressof(ctypes.c_int16.in_dll(self._c, "edml_usual_completion"))
        status = self._c.edml_edm_f32(
            _pointer(out), _pointer(_f32(keypoints)), fewest, ctypes.c_float(widest),
            ctypes.c_void_p(usual if complete else None),
        )  # fmt: skip
        return self.status_name(status), out

    def net(self, edm: np.ndarray) -> np.ndarray:
        """Distances [91] in metres that the model predicts."""
        out = np.zeros(91, np.float32)
        getattr(self._c, f"edml_net_{self._fconv}f32")(
            _pointer(out), _pointer(_f32(edm)), ctypes.c_void_p(self.model), self._work
        )
        return out

    def jacobi(self, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues [14], descending, and eigenvectors as rows [14,14]."""
        eigen = np.zeros(14 + 14 * 14 + 2 * 640, np.float32)
        self._c.edml_jacobi_f32(_pointer(eigen), _pointer(_f32(matrix)))
        return eigen[:14].copy(), eigen[14:210].reshape(14, 14).copy()

    def mds(self, distance: np.ndarray) -> np.ndarray:
        """Classical MDS: [91] metres -> [14,3]."""
        out = np.zeros((14, 3), np.float32)
        self._c.edml_mds_f32(_pointer(out), _pointer(_f32(distance)), self._work)
        return out

    def refine(self, points: np.ndarray, distance: np.ndarray, objective: str, steps: int):
        """Refined points [14,3] and the number of steps taken."""
        out = _f32(points).copy()
        taken = self._c.edml_refine_f32(
            _pointer(out), _pointer(_f32(distance)), OBJECTIVES.index(objective), steps, self._work
        )
        return out, taken

    def stress(self, points: np.ndarray, distance: np.ndarray, objective: str) -> float:
        """Value of an objective."""
        return self._c.edml_stress_f32(
            _pointer(_f32(points)), _pointer(_f32(distance)), OBJECTIVES.index(objective)
        )

    def mirror(self, points: np.ndarray) -> tuple[np.ndarray, float]:
        """The chosen mirror image of points [14,3] and the margin."""
        out = _f32(points).copy()
        return out, self._c.edml_mirror_f32(_pointer(out), ctypes.c_void_p(self.model))

    def orient(self, points: np.ndarray, keypoints: np.ndarray) -> np.ndarray:
        """Points [14,3] turned to the camera; ValueError where nothing says how."""
        out = _f32(points).copy()
        seen = sum(1 << j for j in range(14) if keypoints[j, 2] > 0)
        code = self._c.edml_orient_f32(
            _pointer(out), _pointer(_f32(keypoints)), ctypes.c_uint16(seen)
        )
        if code != 0:
            raise ValueError(self.status_name(code))
        return out

    def blend(self, points: np.ndarray, keypoints: np.ndarray) -> np.ndarray:
        """The mean of points [14,3] of orient() and their image, weighted as the model says."""
        out = _f32(points).copy()
        seen = sum(1 << j for j in range(14) if keypoints[j, 2] > 0)
        self._c.edml_blend_f32(
            _pointer(out),
            _pointer(_f32(keypoints)),
            ctypes.c_uint16(seen),
            ctypes.c_void_p(self.model),
        )
        return out


class Track:
    """edml_track: lifts the frames of a video.  `state`, a TRACK, holds its settings, too."""

    def __init__(self, library: Library):
        self._library = library
        self.state = np.zeros((), TRACK)
        library._c.edml_track_start(_pointer(self.state))

    def lift(self, keypoints: np.ndarray, time: np.ndarray) -> Tracked:
        """Lifts keypoints [F,14,3] that were seen at `time` [F], ms, ascending."""
        keypoints = checked_keypoints(keypoints)
        time = np.asarray(time)
        if time.shape != keypoints.shape[:1]:
            raise ValueError(f"time must be [{len(keypoints)}], not {list(time.shape)}")
        poses = np.zeros(len(keypoints), POSE)
        reports = np.zeros(len(keypoints), TRACK)
        status = np.zeros(len(keypoints), np.int32)
        for i in range(len(keypoints)):
            status[i] = self._library._c.edml_track_lift(
                _pointer(poses[i : i + 1]), _pointer(self.state), _pointer(keypoints[i]),
                ctypes.c_uint32(int(time[i]) & 0xFFFFFFFF),
                ctypes.c_void_p(self._library.model), self._library._work,
            )  # fmt: skip
            if status[i] == 0:
                reports[i] = self.state
        lifted = self._library._poses(poses, status, np.float32(1))
        return Tracked(
            **vars(lifted), seen=poses["seen"],
            **{name: reports[name] for name in ("held", "exchanged", "mirrored", "elapsed")},
        )  # fmt: skip


def checked_keypoints(keypoints: np.ndarray) -> np.ndarray:
    """Keypoints [F,14,3] as the library takes them."""
    keypoints = np.ascontiguousarray(keypoints, np.float32)
    if keypoints.ndim != 3 or keypoints.shape[1:] != (len(JOINTS), 3):
        raise ValueError(f"keypoints must be [F,{len(JOINTS)},3], not {keypoints.shape}")
    return keypoints


OBJECTIVES = ("none", "square", "raw", "eq2")  # edml_objective


def to_q16(keypoints: np.ndarray) -> np.ndarray:
    """Keypoints [F,14,3] as KEYPOINT_Q16 [F,14]; what is out of range, or NaN, its nearest end."""
    keypoints = np.asarray(keypoints, np.float64)
    keypoints = np.where(np.isnan(keypoints), -np.inf, keypoints)
    out = np.zeros(keypoints.shape[:2], KEYPOINT_Q16)
    out["at"] = np.round(np.clip(keypoints[..., :2] * 65536, -(2.0**31), 2.0**31 - 1))
    out["c"] = np.ceil(np.clip(keypoints[..., 2] * 32768, -(2.0**15), 2.0**15 - 1))
    return out


def _f32(a: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(a, np.float32)


def _pointer(a: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(a.ctypes.data)
