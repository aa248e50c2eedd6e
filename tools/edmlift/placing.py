"""Where a pose stands: before a camera, or on the floor."""

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from edmlift._binding import FOCAL, OK, PATH, PLACEMENT, Point, load, pointer, pointers
from edmlift.keypoints import image_size, read_camera, read_up
from edmlift.lifting import Poses, batched, c_poses, first, picked, status_names, summary
from edmlift.networks import Model, find_model
from edmlift.people_tracks import TrackedPeople
from edmlift.tracking import Tracked

_FIELDS = ("joint", "rotation", "translation", "reprojection")


@dataclass(frozen=True, repr=False)
class Placements:
    """F placements, or one without the leading axis; NaN where status is not "ok"."""

    joints: NDArray[np.float32]  # [F,14,3] metres, camera axes, origin at the camera's centre
    rotation: NDArray[np.float32]  # [F,3,3]: joints = rotation @ pose + translation
    translation: NDArray[np.float32]  # [F,3] metres: where mid-hip is
    reprojection: NDArray[np.float32]  # [F] pixels: RMS distance from the keypoints
    focal: NDArray[np.float32]  # [F] pixels, along x: given, or found by the sweep
    steps: NDArray[np.uint16]  # [F] iterations
    status: NDArray[np.str_]  # [F] "ok", or why there is no placement

    def __repr__(self) -> str:
        return summary(self)


def place(
    poses: Poses,
    camera: ArrayLike | None = None,
    *,
    image: tuple[float, float] | None = None,
) -> Placements:
    """Places lifted poses before the camera that saw them (docs/where-in-the-room.md).

    poses   as from `lift` or `track`; the keypoints that they come from are in them
    camera  fx, fy, cx, cy in pixels, or the 3x3 matrix, of a camera without distortion
    image   (width, height) in pixels, instead of camera, whose focal length is then a guess, and
            distances with it: for each pose the one that fits best, of 12 (section 4 of the paper)

    One pose gives one placement.  Poses of `track` are a video of one camera: it has one focal
    length, to which all poses contribute, and each person's path is filtered.  `PlacedTrack` places
    the frames of one person as they come.

    Statuses: "too_few_joints" (fewer than 7 seen), "degenerate", "camera" (that camera cannot have
    seen it), and that of a pose which was not lifted.
    """
    _check_cameras(camera, image)
    given, single = batched(poses)
    model = find_model()
    if isinstance(given, Tracked) and not single:
        return PlacedTrack(camera, image=image)._place_all(given)
    if image is None:
        placed = place_joints(model, given, read_camera(camera))
    else:
        sizes = np.tile(np.array(image_size(image), np.float32), (len(given.joints), 1))
        placed = place_joints_by_sweep(model, given, sizes)
    return first(placed) if single else placed


class PlacedTrack:
    """Places the frames of a video of one person, as they come from a `Track`.

        track, placed = edmlift.Track(), edmlift.PlacedTrack((1145, 1145, 500, 500))
        for keypoints, time_ms in frames:
            placement = placed.place(track.lift(keypoints, time_ms))

    camera and image are as in `place`.  With `image` the first pose that can be placed decides on
    the focal length of the video.  The person's path is filtered from frame to frame.
    """

    def __init__(
        self, camera: ArrayLike | None = None, *, image: tuple[float, float] | None = None
    ):
        _check_cameras(camera, image)
        self._model = find_model()
        self._camera = None if camera is None else read_camera(camera)
        self._image = None if image is None else image_size(image)
        self._path, self._time = np.zeros(1, PATH), 0

    def place(self, tracked: Tracked) -> Placements:
        """The placements of the next frame, or of the next F frames."""
        given, single = batched(tracked)
        if not isinstance(given, Tracked):
            raise TypeError(f"frames must be Tracked, not {type(given).__name__}")
        for i in np.flatnonzero(given.ok):
            if self._camera is not None:
                break
            self._look(picked(given, slice(i, i + 1)))
        placed = self._follow(given)
        return first(placed) if single else placed

    def _place_all(self, given: Tracked) -> Placements:
        """Placements of a whole video: all of it says what the focal length is."""
        if self._camera is None:
            self._look(given)
        if not isinstance(given, TrackedPeople):
            return self._follow(given)
        rows = [np.flatnonzero(given.person == number) for number in np.unique(given.person)]
        placed = self._follow(given)  # of everybody, for its statuses
        for which in rows:
            self._path, self._time = np.zeros(1, PATH), 0
            one = self._follow(picked(given, which))
            placed.joints[which], placed.translation[which] = one.joints, one.translation
        return placed

    def _look(self, poses: Poses) -> None:
        """Finds the camera that some poses were seen by, if they say so."""
        assert self._image is not None  # without a camera
        camera = camera_of(self._model, poses, self._image)
        self._camera = None if np.isnan(camera[0]) else camera

    def _follow(self, given: Tracked) -> Placements:
        """Placements on the path."""
        camera = np.full(4, np.nan, np.float32) if self._camera is None else self._camera
        placed = place_joints(self._model, given, camera)
        return self._filter(placed, given.ok & ~given.aside, given.elapsed)

    def _filter(
        self, placed: Placements, own: NDArray[np.bool_], elapsed: NDArray[np.uint32]
    ) -> Placements:
        """Placements [F] with their path filtered; the person's own frames have a time."""
        c, path = self._model.c, pointer(self._path)
        records = np.zeros(len(placed.joints), PLACEMENT)
        records["joint"], records["translation"] = placed.joints, placed.translation
        for i, (record,) in enumerate(pointers(records)):
            if not own[i]:
                continue
            self._time += int(elapsed[i])
            if elapsed[i] == 0:
                c.edml_path_start(path)
            if placed.status[i] == "ok":
                c.edml_path_follow(path, record, self._time & 0xFFFFFFFF)
        return replace(placed, joints=records["joint"], translation=records["translation"])


def focal_length(poses: Poses, image: tuple[float, float]) -> float:
    """The focal length in pixels, to be expected from poses that one camera saw, in images of this
    (width, height): NaN if none can be placed.  People some metres away say little of it, many as
    little as one: docs/where-in-the-room.md has how little."""
    given, _ = batched(poses)
    return float(camera_of(find_model(), given, image_size(image))[0])


def _check_cameras(camera: ArrayLike | None, image: tuple[float, float] | None) -> None:
    if (camera is None) == (image is None):
        raise ValueError("give either camera=(fx, fy, cx, cy) or image=(width, height)")


def stand(poses: Poses, up: ArrayLike = (0.0, -1.0, 0.0)) -> NDArray[np.float32]:
    """Stands poses on the floor: joints [F,14,3] in metres, y up from the floor under the lower
    ankle's foot, x right and z towards the camera, from mid-hip; NaN where there is no pose.

    up  where upwards is in the camera's axes, of any length, [3] or one a pose [F,3], as an
        accelerometer at rest measures it; the default is a level camera
    """
    given, single = batched(poses)
    directions = read_up(up, len(given.joints))
    assert directions is not None  # up was given
    out, _ = stand_joints(load(), given, directions)
    return out[0] if single else out


# ---- For the library, unchecked ----------------------------------------------------------------


def place_joints(model: Model, poses: Poses, camera: NDArray[np.float32]) -> Placements:
    """edml_place() before a camera [4]."""

    def run(_i: int, at: tuple[int, ...]) -> int:
        placement, camera, pose, seen = at
        code: int = model.c.edml_place(placement, pose, seen, camera, work, model.work_bytes)
        return code

    work = model.work()
    return _placed(model, poses, camera, run)


def camera_of(model: Model, poses: Poses, size: tuple[float, float]) -> NDArray[np.float32]:
    """The camera [4] of edml_focal_camera() after all poses; NaN where they do not say."""
    c, work, camera = model.c, model.work(), np.full(4, np.nan, np.float32)
    given, keypoints = c_poses(poses), np.ascontiguousarray(poses.keypoints, np.float32)
    search, fine = np.zeros(1, FOCAL), poses.ok
    c.edml_focal_start(pointer(search), *map(float, size))
    for i, (pose, seen) in enumerate(pointers(given, keypoints)):
        if fine[i]:
            c.edml_focal_add(pointer(search), pose, seen, work, model.work_bytes)
    c.edml_focal_camera(pointer(camera), pointer(search))
    return camera


def place_joints_by_sweep(model: Model, poses: Poses, sizes: NDArray[np.float32]) -> Placements:
    """edml_place_sweep() in images of these sizes [F,2]."""

    def run(i: int, at: tuple[int, ...]) -> int:
        placement, camera, pose, seen = at
        size = [float(side) for side in sizes[i]]
        code: int = model.c.edml_place_sweep(
            placement, camera, pose, seen, *size, work, model.work_bytes
        )
        return code

    work = model.work()
    return _placed(model, poses, np.full(4, np.nan, np.float32), run)


def _placed(
    model: Model,
    poses: Poses,
    camera: NDArray[np.float32],
    run: Callable[[int, tuple[int, ...]], int],
) -> Placements:
    """Calls `run`, for each pose, with its number and where placement, camera, pose and keypoints
    are."""
    given, keypoints = c_poses(poses), np.ascontiguousarray(poses.keypoints, np.float32)
    placed = np.zeros(len(given), PLACEMENT)
    for field in _FIELDS:
        placed[field] = np.nan
    cameras = np.tile(camera, (len(given), 1))
    rows = pointers(placed, cameras, given, keypoints)
    status = np.array([run(i, row) for i, row in enumerate(rows)], np.int32)
    focal = np.where(status == OK, cameras[:, 0], np.float32(np.nan))
    names = np.where(poses.ok, status_names(model.c, status), poses.status)
    joints, rotation, translation, reprojection = (placed[field] for field in _FIELDS)
    return Placements(joints, rotation, translation, reprojection, focal, placed["steps"], names)


def stand_joints(
    c: ctypes.CDLL, poses: Poses, up: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.str_]]:
    """edml_stand() of poses, up [F,3]: joints [F,14,3] and the names of the status [F]."""
    given, out = c_poses(poses), np.full(poses.joints.shape, np.nan, np.float32)
    status = [
        c.edml_stand(target, pose, Point(*direction))
        for (target, pose), direction in zip(pointers(out, given), up.tolist(), strict=True)
    ]
    return out, status_names(c, np.array(status, np.int32))
