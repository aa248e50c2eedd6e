"""What detectors see in the videos of examples/data/detections, and where the man is in truth.

Four cameras see him at once.  The reference of a detector is triangulated from its own keypoints in
all four.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from data.paths import EXAMPLES
from data.triangulate import Camera, read_cameras, triangulate
from edmlift.joints import MIRROR
from edmlift.library import Library

DATA = EXAMPLES / "detections"
CAMERAS = DATA / "beam_cameras.json"
BEAM = ("beam1", "beam2", "beam3", "beam4")
SIZES = {"street": (1768, 994)}  # those of the beam's cameras are in their file
RATE = 12.0  # frames of the beam, a second
FIRST = 1  # in frame 0 MoveNet does not know yet where the man is, and is shown all of it


@dataclass(frozen=True)
class Detector:
    """A detector, its keypoints and its files."""

    name: str
    ending: str  # of the names of its files
    format: str
    counterpart: np.ndarray  # [K] each keypoint's on the other side
    limbs: tuple[int, ...]  # keypoints: shoulders to wrists, hips to ankles
    sure: float  # confidence over which its users call a keypoint seen
    normalised: bool = False  # by the image's width and height; else pixels
    world: bool = False  # it gives points in space, too


def swap(count: int, pairs: Iterable[tuple[int, int]]) -> np.ndarray:
    """Each keypoint's counterpart [K]: itself, unless it is of a pair."""
    found = np.arange(count)
    for left, right in pairs:
        found[[left, right]] = right, left
    return found


# Of BlazePose's face, then of its body.
FACE = ((1, 4), (2, 5), (3, 6), (7, 8), (9, 10))
BLAZEPOSE = Detector(
    "BlazePose", "", "blazepose33", swap(33, (*FACE, *((i, i + 1) for i in range(11, 33, 2)))),
    (*range(11, 17), *range(23, 29)), 0.5, normalised=True, world=True,
)  # fmt: skip
COCO = swap(17, ((i, i + 1) for i in range(1, 17, 2)))
THUNDER, LIGHTNING = (
    Detector(f"MoveNet {name}", f"_{name}", "coco17", COCO, tuple(range(5, 17)), 0.3)
    for name in ("thunder", "lightning")
)
DETECTORS = (BLAZEPOSE, THUNDER, LIGHTNING)


@dataclass(frozen=True)
class Clip:
    """Detections of F frames, as the library takes them, and what else is known of them."""

    keypoints: np.ndarray  # [F,14,3] pixels and confidence
    sure: np.ndarray  # [F,14,3] of those of the detector's keypoints alone that it is sure of
    world: np.ndarray  # [F,14,3] BlazePose's 3D, metres, camera axes; else NaN
    truth: np.ndarray  # [F,14,3] triangulated, metres, camera axes, from the camera; else NaN
    swapped: np.ndarray  # [F] the detector took left for right, as the other views show
    camera: tuple[float, ...] = ()  # focal length and centre, x and y, pixels, where known

    def frames(self, some: slice) -> "Clip":
        """Some of the frames."""
        names = ("keypoints", "sure", "world", "truth", "swapped")
        return replace(self, **{name: getattr(self, name)[some] for name in names})

    def right(self) -> np.ndarray:
        """The keypoints, left and right put right."""
        return put_right(self.keypoints, self.swapped)


def read(name: str, size: tuple[int, int], detector: Detector = BLAZEPOSE) -> np.ndarray:
    """Keypoints [F,K,3] of a clip in pixels, with confidence."""
    keypoints = _rows(name + detector.ending, detector)
    return keypoints * [*size, 1] if detector.normalised else keypoints


def _rows(file: str, detector: Detector) -> np.ndarray:
    path = DATA / f"{file}.csv"
    return np.loadtxt(path, delimiter=",").reshape(-1, len(detector.counterpart), 3)


def _read_world(library: Library, name: str, detector: Detector, count: int) -> np.ndarray:
    """The detector's own joints in space [F,14,3], or NaN."""
    if not detector.world:
        return np.full((count, 14, 3), np.nan)
    return joints_3d(library, _rows(f"{name}_world", detector), detector)


def joints_3d(library: Library, points: np.ndarray, detector: Detector = BLAZEPOSE) -> np.ndarray:
    """A detector's points in space [F,K,3] to joints [F,14,3], by the adapter of images.

    It treats every coordinate alike, so x and y go through it, and then z.
    """
    seen = np.ones((*points.shape[:2], 1))
    flat = [np.concatenate([points[..., axes], seen], -1) for axes in ([0, 1], [2, 2])]
    xy, z = (library.adapt(part, detector.format)[..., :2] for part in flat)
    return np.concatenate([xy, z[..., :1]], -1).astype(float)


def adapt(
    library: Library, keypoints: np.ndarray, detector: Detector = BLAZEPOSE
) -> tuple[np.ndarray, np.ndarray]:
    """Keypoints [F,K,3] to joints [F,14,3]: of all, and of those that the detector is sure of."""
    confidence = keypoints[..., 2:]
    seen = np.where(confidence > detector.sure, confidence, 0)
    sure = np.concatenate([keypoints[..., :2], seen], -1)
    return library.adapt(keypoints, detector.format), library.adapt(sure, detector.format)


def read_street(library: Library, detector: Detector = BLAZEPOSE) -> Clip:
    """The clip of the street, which has no reference."""
    keypoints = read("street", SIZES["street"], detector)
    world = _read_world(library, "street", detector, len(keypoints))
    unknown = np.full(world.shape, np.nan)
    swapped = np.zeros(len(world), bool)
    return Clip(*adapt(library, keypoints, detector), world, unknown, swapped)


def read_beam(
    library: Library, detector: Detector = BLAZEPOSE
) -> tuple[dict[str, Clip], np.ndarray]:
    """The four views, and the distances [4,F,12] of limb joints in the image from the reference,
    in pixels."""
    views = read_cameras(CAMERAS)
    seen = np.stack(
        [read(name, view.size, detector) for name, view in zip(BEAM, views, strict=True)]
    )
    points, swapped, errors = triangulate(views, seen[..., :2], seen[..., 2], detector.counterpart)
    truth = joints_3d(library, points, detector)
    clips = {
        name: Clip(
            *adapt(library, keypoints, detector),
            _read_world(library, name, detector, len(keypoints)),
            view.look(truth),
            mistaken,
            (*view.focal, *view.centre),
        )
        for name, view, keypoints, mistaken in zip(BEAM, views, seen, swapped, strict=True)
    }
    return clips, errors[:, :, list(detector.limbs)]


def put_right(joints: np.ndarray, swapped: np.ndarray) -> np.ndarray:
    """Swaps left and right of joints [F,14,D] where the detector had swapped them."""
    return np.where(swapped[:, None, None], joints[:, MIRROR], joints)


def beside(view: Camera, pixels: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """How far pixels [...,2] are beside true points [...,3], camera axes: [...,2], metres at the
    distance of each point."""
    return view.rays(pixels) * truth[..., 2:] - truth[..., :2]
