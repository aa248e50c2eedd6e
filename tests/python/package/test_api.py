"""The public functions: shapes, formats, thresholds, and errors that say what is wrong."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from package_support import DATA, ROOT, WALK, need_library

import edmlift
from edmlift import networks

HEADERS = "".join(path.read_text("utf-8") for path in sorted(ROOT.glob("include/**/*.h")))
FIELDS = ("joints", "misfit", "seen", "status", "keypoints")
CAMERA = (1150.0, 1150.0, 500.0, 500.0)

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def coco17(joints: np.ndarray = WALK) -> np.ndarray:
    """Keypoints [F,17,3] of a detector that sees the limbs of joints, and a head above them."""
    keypoints = np.zeros((len(joints), 17, 3))
    keypoints[:, :5] = joints[:, :1]
    keypoints[:, [6, 8, 10, 5, 7, 9, 12, 14, 16, 11, 13, 15]] = joints[:, 2:]
    return keypoints


def same(one: edmlift.Poses, other: edmlift.Poses) -> None:
    for field in FIELDS:
        np.testing.assert_array_equal(getattr(one, field), getattr(other, field), err_msg=field)


# ---- Shapes ------------------------------------------------------------------------------------


def test_shapes_types_and_ranges():
    poses = edmlift.lift(WALK)
    count = len(WALK)
    assert poses.joints.shape == poses.keypoints.shape == (count, 14, 3)
    assert poses.seen.shape == (count, 14) and poses.seen.dtype == bool and poses.seen.all()
    assert poses.misfit.shape == poses.status.shape == (count,)
    assert poses.joints.dtype == poses.misfit.dtype == np.float32
    assert (poses.status == "ok").all() and poses.ok.all()
    assert np.isfinite(poses.joints).all()
    assert (poses.misfit > 0).all() and (poses.misfit < 0.2).all()  # metres


def test_printing_poses_takes_a_line():
    keypoints = WALK.copy()
    keypoints[1, 3:, 2] = 0
    poses = edmlift.lift(keypoints)
    count = len(WALK)
    statuses = f"{count - 1} ok, 1 too_few_joints"
    assert repr(poses) == f"Poses(joints [{count}, 14, 3]: {statuses})"
    assert repr(edmlift.place(poses, CAMERA)).startswith(f"Placements(joints [{count}, 14, 3]: ")
    assert repr(edmlift.track(WALK, fps=30)) == f"Tracked(joints [{count}, 14, 3]: {count} ok)"
    assert repr(edmlift.lift(WALK[0])) == "Poses(joints [14, 3]: 1 ok)"
    assert repr(edmlift.lift(WALK[:0])) == "Poses(joints [0, 14, 3]: none)"


def test_one_pose_gives_one_pose():
    batch = edmlift.lift(WALK)
    for keypoints in (WALK[7], WALK[7, :, :2]):
        pose = edmlift.lift(keypoints)
        assert pose.joints.shape == (14, 3) and pose.seen.shape == (14,)
        assert pose.status == "ok" and pose.ok
        np.testing.assert_array_equal(pose.joints, batch.joints[7])
        assert pose.misfit == batch.misfit[7]


def test_without_confidences_all_are_seen():
    same(edmlift.lift(WALK[..., :2]), edmlift.lift(WALK))
    corner = WALK[:1, :, :2] - WALK[:1, 3:4, :2] + [0, 0.5]  # the right elbow at 0, 0.5
    assert edmlift.lift(corner).seen.all()


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("nothing", [0, -1, np.nan])
def test_what_detectors_write_for_nothing_was_not_seen(nothing: float, fixed: bool):
    """Whatever the confidence, of joints and of a detector's keypoints."""
    missing = WALK[:3].copy()
    missing[:, 3, 2] = 0
    zeros = WALK[:3].copy()
    zeros[:, 3, :2] = nothing
    for columns in (2, 3):
        found = edmlift.lift(zeros[..., :columns], fixed=fixed)
        wanted = edmlift.lift(missing, fixed=fixed)
        np.testing.assert_array_equal(found.joints, wanted.joints)
        assert found.ok.all() and not found.seen[:, 3].any()
    detected = coco17(WALK[:3])
    detected[:, 8, :2] = nothing  # the right elbow
    assert not edmlift.lift(detected, format="coco17", fixed=fixed).seen[:, 3].any()


def test_one_coordinate_of_0_is_a_place():
    moved = WALK[:1] - [*WALK[0, 3, :2], 0]
    assert edmlift.lift(moved + [0, 1, 0]).seen.all() and edmlift.lift(moved + [1, 0, 0]).seen.all()
    assert edmlift.lift(moved - [1, 0, 0]).seen.all()


def test_lists_and_integers_will_do():
    whole = np.round(WALK[:2]).astype(int)
    same(edmlift.lift(whole.tolist()), edmlift.lift(whole.astype(np.float32)))


def test_no_frames_give_no_poses():
    poses = edmlift.lift(np.zeros((0, 14, 2)))
    assert poses.joints.shape == (0, 14, 3) and poses.status.shape == (0,)


def test_the_input_is_left_alone():
    given = WALK[:3].astype(np.float32)
    given[1, 2, 0] = np.nan
    before = given.copy()
    edmlift.lift(given, threshold=0.5)
    np.testing.assert_array_equal(given, before)


def test_results_cannot_be_reassigned():
    with pytest.raises(dataclasses.FrozenInstanceError):
        edmlift.lift(WALK).joints = None


# ---- What was not seen, and what is not a pose -------------------------------------------------


def test_nan_coordinates_are_not_seen():
    zero, x, both = (WALK[:1].copy() for _ in range(3))
    zero[0, 4], x[0, 4, 0], both[0, 4, :2] = 0, np.nan, np.nan
    poses = [edmlift.lift(k) for k in (zero, x, both)]
    for pose in poses:
        assert pose.status[0] == "ok" and list(np.flatnonzero(~pose.seen[0])) == [4]
        np.testing.assert_array_equal(pose.joints, poses[0].joints)


def test_confidences_up_to_the_threshold_are_not_seen():
    keypoints = WALK[:1].copy()
    keypoints[0, 4, 2], keypoints[0, 7, 2] = 0.3, 0.31
    assert edmlift.lift(keypoints).seen.all()
    assert list(np.flatnonzero(~edmlift.lift(keypoints, threshold=0.3).seen[0])) == [4]


@pytest.mark.parametrize("threshold", [-0.1, np.nan, np.inf])
def test_a_threshold_that_is_none(threshold: float):
    with pytest.raises(ValueError, match="threshold must be a finite number >= 0"):
        edmlift.lift(WALK, threshold=threshold)


BAD = {
    "too_few_joints": lambda k: k.__setitem__((slice(0, 6), 2), 0),
    "not_finite": lambda k: k.__setitem__((3, 0), np.inf),
    "degenerate": lambda k: k.__setitem__((slice(None), slice(0, 2)), 7),
}


@pytest.mark.parametrize("status", BAD)
@pytest.mark.parametrize("fixed", [False, True])
def test_bad_input_is_never_a_plausible_pose(status: str, fixed: bool):
    keypoints = WALK[:3].copy()
    BAD[status](keypoints[1])
    poses = edmlift.lift(keypoints, fixed=fixed)
    assert list(poses.status) == ["ok", status, "ok"]
    for numbers in (poses.joints[1], poses.misfit[1]):
        assert np.isnan(numbers).all()
    assert np.isfinite(poses.joints[[0, 2]]).all()


def test_numbers_beyond_float_are_not_finite():
    keypoints = WALK[:1].copy()
    keypoints[0, 3, 0] = 1e300
    assert edmlift.lift(keypoints).status[0] == "not_finite"


@pytest.mark.parametrize("fixed", [False, True])
def test_an_infinite_confidence_is_refused(fixed: bool):
    keypoints = WALK[:1].copy()
    keypoints[0, 3, 2] = np.inf
    assert edmlift.lift(keypoints, fixed=fixed).status[0] == "not_finite"
    detected = coco17(WALK[:1])
    detected[0, 7, 2] = np.inf
    assert edmlift.lift(detected, format="coco17", fixed=fixed).status[0] == "not_finite"


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("confidence", [np.nan, -np.inf, -0.5, 0])
def test_no_confidence_was_not_seen(confidence: float, fixed: bool):
    keypoints = WALK[:1].copy()
    keypoints[0, 3, 2] = confidence
    found = edmlift.lift(keypoints, fixed=fixed)
    assert found.ok.all() and list(np.flatnonzero(~found.seen[0])) == [3]
    detected = coco17(WALK[:1])
    detected[0, 7, 2] = confidence
    found = edmlift.lift(detected, format="coco17", fixed=fixed)
    assert found.ok.all() and list(np.flatnonzero(~found.seen[0])) == [6]


# ---- Formats -----------------------------------------------------------------------------------


def test_formats_are_those_of_the_header():
    names = set(re.findall(r"\bedml_(\w+)(?=[,;])", "".join(
        re.findall(r"extern const edml_format (edml_[^*]*?;)", HEADERS)
    )))  # fmt: skip
    assert set(edmlift.FORMATS) == names
    assert edmlift.FORMATS["coco17"] == 17 and edmlift.FORMATS["blazepose33"] == 33
    assert "none" not in edmlift.FORMATS and len(edmlift.FORMATS) == len(names)
    with pytest.raises(KeyError):
        edmlift.FORMATS["none"]


def test_models_are_those_of_the_header():
    names = re.findall(r"extern const edml_model (edml_[^;]*);", HEADERS)
    named = {n.removeprefix("edml_") for line in names for n in re.split(r",\s*", line)}
    assert set(networks.NAMES) == named == set(edmlift.models())
    assert edmlift.models(fixed=True) == (
        "distances_w16", "distances_w8", "direct_w16", "direct_w8", "fconn_w16", "fconn_w8",
        "fconv_w8",
    )  # fmt: skip


def test_a_detectors_keypoints_are_adapted():
    keypoints = coco17()
    adapted = edmlift.adapt(keypoints, "coco17")
    assert adapted.shape == (len(WALK), 14, 3)
    np.testing.assert_array_equal(adapted[:, 2:], np.float32(WALK[:, 2:]))
    same(edmlift.lift(keypoints, format="coco17"), edmlift.lift(adapted))
    assert edmlift.adapt(keypoints[0], "coco17").shape == (14, 3)
    assert edmlift.lift(keypoints[0], format="coco17").joints.shape == (14, 3)


def test_the_threshold_is_applied_before_the_adapter_halves_confidences():
    keypoints = coco17()
    keypoints[..., 2] = 0.4  # head and neck get 0.2
    assert edmlift.lift(keypoints, format="coco17", threshold=0.3).seen.all()


def test_proportions_become_pixels():
    pixels = np.zeros((len(WALK), 33, 3))
    pixels[:] = WALK[:, :1]
    pixels[:, [12, 14, 16, 11, 13, 15, 24, 26, 28, 23, 25, 27]] = WALK[:, 2:]
    proportions = pixels / [1000, 800, 1]
    poses = edmlift.lift(proportions, format="blazepose33", image=(1000, 800))
    np.testing.assert_allclose(poses.keypoints[:, 2:], WALK[:, 2:], rtol=1e-5)
    with pytest.raises(ValueError, match=r"image=\(width, height\)"):
        edmlift.lift(proportions, format="blazepose33")
    with pytest.raises(ValueError, match="not in pixels"):
        edmlift.lift(pixels, format="blazepose33", image=(1000, 500))
    for image in ((0, 5), (1,), (np.nan, 4)):
        with pytest.raises(ValueError, match="image must be"):
            edmlift.lift(proportions, format="blazepose33", image=image)


def test_keypoints_outside_the_image_are_not_seen():
    """However sure of them the detector is; those on its edge are."""
    whole = edmlift.lift(WALK, image=(1000, 1000))
    same(whole, edmlift.lift(WALK))
    cut = WALK.copy()
    cut[0, 13, :2], cut[0, 10, :2], cut[1, 4, :2] = (500, 1000.5), (500, 1000), (-0.25, 300)
    poses = edmlift.lift(cut, image=(1000, 1000))
    assert [list(np.flatnonzero(~seen)) for seen in poses.seen[:2]] == [[13], [4]]
    assert poses.seen[2:].all()
    cut[0, 13, 2], cut[1, 4, 2] = 0, 0
    np.testing.assert_array_equal(poses.joints, edmlift.lift(cut).joints)
    cut[0, 3, 0] = np.inf
    assert edmlift.lift(cut, image=(1000, 1000)).status[0] == "not_finite"


@pytest.mark.parametrize("fixed", [False, True])
def test_up_changes_a_pose_and_its_length_does_not_matter(fixed: bool):
    alone = edmlift.lift(WALK, fixed=fixed)
    told = edmlift.lift(WALK, up=(0.0, -1.0, -0.2), fixed=fixed)
    longer = edmlift.lift(WALK, up=[(0.0, -50.0, -10.0)] * len(WALK), fixed=fixed)
    assert told.ok.all() and np.abs(told.joints - alone.joints).max() > 1e-3
    np.testing.assert_allclose(longer.joints, told.joints, atol=1e-4)
    ups = np.tile([0.0, -1, 0], (len(WALK), 1))
    ups[3] = (0.0, -1.0, -0.2)
    each = edmlift.lift(WALK, up=ups, fixed=fixed)
    np.testing.assert_allclose(each.joints[3], told.joints[3], atol=1e-4)
    assert np.abs(each.joints[4] - told.joints[4]).max() > 1e-4
    one = edmlift.lift(WALK[3], up=(0.0, -1.0, -0.2), fixed=fixed)
    np.testing.assert_array_equal(one.joints, told.joints[3])
    tracked = edmlift.track(WALK[:1], fps=30, up=ups[3])
    assert np.abs(tracked.joints[0] - edmlift.track(WALK[:1], fps=30).joints[0]).max() > 1e-3


@pytest.mark.parametrize("fixed", [False, True])
def test_a_known_camera_sees_people_off_its_axis_as_if_it_looked_at_them(fixed: bool):
    """A camera that is turned about its centre: the pose turns with it, and stays the same."""
    focal, angle = CAMERA[0], np.radians(25)
    rays = np.concatenate([(WALK[..., :2] - CAMERA[2:]) / focal, np.ones_like(WALK[..., :1])], -1)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    rays = rays @ turn.T
    aside = np.concatenate([rays[..., :2] / rays[..., 2:] * focal + CAMERA[2:], WALK[..., 2:]], -1)
    middle = edmlift.lift(WALK, camera=CAMERA, fixed=fixed)
    poses = edmlift.lift(aside, camera=CAMERA, fixed=fixed)
    assert poses.ok.all()
    np.testing.assert_allclose(poses.joints, middle.joints @ turn.T, atol=2e-3)
    assert np.abs(edmlift.lift(aside, fixed=fixed).joints - middle.joints @ turn.T).max() > 0.05
    matrix = np.array([[focal, 0, CAMERA[2]], [0, focal, CAMERA[3]], [0, 0, 1]])
    same(edmlift.lift(aside, camera=matrix, fixed=fixed), poses)
    behind = edmlift.lift(aside + [1e5, 0, 0], camera=CAMERA)
    assert (behind.status == "camera").all()


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("threads", [None, 1, 3])
def test_each_pose_may_have_a_camera_an_image_and_up_of_its_own(fixed: bool, threads: int | None):
    """As if each was lifted alone; enough of them for threads, of which some share a camera."""
    keypoints = np.tile(WALK, (20, 1, 1))
    number = np.arange(len(keypoints))
    cameras = np.array([CAMERA, (900, 900, 400, 600), (1500, 1400, 500, 500)])[number // 7 % 3]
    images = np.array([(1000.0, 1000.0), (500, 1000)])[number % 2]
    ups = np.array([(0, -1.0, 0), (0.2, -1, 0), (0, -1, 0.3)])[number % 3]
    together = edmlift.lift(
        keypoints, up=ups, image=images, camera=cameras, fixed=fixed, threads=threads
    )
    for i in (0, 1, 6, 7, 38, 200, 401, len(number) - 1):
        alone = edmlift.lift(
            keypoints[i], up=ups[i], image=images[i], camera=cameras[i], fixed=fixed
        )
        for field in FIELDS:
            np.testing.assert_array_equal(getattr(together, field)[i], getattr(alone, field))
    assert len(np.unique(together.status)) == 2  # half of the body is outside of some images


def test_each_image_turns_its_own_shares_into_pixels():
    """Of a mirrored image, too, and of the square that MoveNet sees."""
    pixels = np.concatenate([coco17(WALK[:3])[..., :2], np.ones((3, 17, 1))], -1)
    sizes = np.array([(1000, 1000), (1000, 1600), (1200, 1000)])
    sides = sizes.max(1)[:, None, None]
    squares = pixels.copy()
    squares[..., 1::-1] = (pixels[..., :2] + (sides - sizes[:, None]) / 2) / sides
    for options in ({}, {"mirrored": True}):
        found = edmlift.lift(squares, format="movenet17", image=sizes, **options)
        wanted = edmlift.lift(pixels, format="coco17", image=sizes, **options)
        np.testing.assert_allclose(found.joints, wanted.joints, atol=1e-4)
        for i in range(3):
            one = edmlift.lift(squares[i], format="movenet17", image=sizes[i], **options)
            np.testing.assert_array_equal(one.joints, found.joints[i])


def test_what_is_wrong_with_one_of_many():
    cameras, images = np.tile(CAMERA, (len(WALK), 1)), np.full((len(WALK), 2), 1000.0)
    cameras[3, 0], images[4, 1] = 0, np.nan
    for message, options in [
        ("each camera must be fx, fy, cx, cy", {"camera": cameras}),
        ("camera must be fx, fy, cx, cy", {"camera": cameras[:2]}),
        ("both over 0, or so many a pose", {"image": images}),
        ("both over 0, or so many a pose", {"image": images[:2]}),
        ("threads must be 1 or more, not 0", {"threads": 0}),
    ]:
        with pytest.raises(ValueError, match=message):
            edmlift.lift(WALK, **options)


@pytest.mark.parametrize("up", [(0, 0, 0), (0, np.nan, 1), (0, 1), [(0, 1, 0)] * 2, [(0, 0, 0)]])
def test_what_is_no_direction(up):
    with pytest.raises(ValueError, match="up must be"):
        edmlift.lift(WALK, up=up)


# ---- Errors ------------------------------------------------------------------------------------


def test_unknown_names_list_the_known_ones():
    with pytest.raises(ValueError, match="'coco'.*coco17, movenet17, body25"):
        edmlift.lift(WALK, format="coco")
    with pytest.raises(ValueError, match="'fconn'.*distances_f32, .*, fconn_w8, fconv_f32"):
        edmlift.lift(WALK, "fconn")
    with pytest.raises(ValueError, match="'coco17' is not known.*; a detector's format is format="):
        edmlift.lift(WALK, "coco17")
    with pytest.raises(ValueError, match="'direct_f32' does not lift in fixed point; .*fconn_w16"):
        edmlift.lift(WALK, "direct_f32", fixed=True)


@pytest.mark.parametrize("shape", [(14, 4), (5, 13, 3), (1, 5, 14, 3), (14,), (), (5, 14, 1)])
def test_a_wrong_shape_is_told(shape: tuple[int, ...]):
    with pytest.raises(ValueError, match=re.escape(f"[F,14,2] or [F,14,3], or one pose without F, "
                                                   f"not {list(shape)}")):  # fmt: skip
        edmlift.lift(np.zeros(shape))


def test_a_detectors_keypoints_without_a_format():
    with pytest.raises(ValueError, match="format=, one of coco17, movenet17, h36m17_right_first"):
        edmlift.lift(coco17())


@pytest.mark.parametrize("given", [[["a"] * 3] * 14, np.zeros((14, 3), complex), None, [{}]])
def test_what_are_no_numbers(given):
    with pytest.raises(ValueError, match="must be real numbers"):
        edmlift.lift(given)


# ---- Fixed point and models --------------------------------------------------------------------


def test_fixed_point_is_near_float():
    plain, fixed = edmlift.lift(WALK, "distances_w16"), edmlift.lift(WALK, fixed=True)
    assert fixed.ok.all() and fixed.joints.dtype == np.float32
    assert np.abs(fixed.joints - plain.joints).max() < 2e-3  # metres
    np.testing.assert_allclose(fixed.keypoints, plain.keypoints, atol=1e-4)
    keypoints = coco17()
    adapted = edmlift.lift(keypoints, format="coco17", fixed=True)
    assert np.abs(adapted.joints - edmlift.lift(keypoints, format="coco17").joints).max() < 1e-2


@pytest.mark.parametrize("model", ["direct_f32", "direct_w8", "fconn_w16", "fconv_f32", "fconv_w8"])
def test_all_models_are_lifted_with_alike(model: str):
    poses = edmlift.lift(WALK[:6], model)
    assert poses.ok.all()
    same(edmlift.lift(WALK[3], model), edmlift.lifting.first(edmlift.lift(WALK[3:4], model)))
    assert np.abs(poses.joints - edmlift.lift(WALK[:6]).joints).mean() < 0.1


# ---- Placing, standing -------------------------------------------------------------------------


def test_placing_by_a_camera():
    poses = edmlift.lift(WALK)
    placed = edmlift.place(poses, CAMERA)
    assert (placed.status == "ok").all() and placed.joints.shape == poses.joints.shape
    turned = np.einsum("fij,fnj->fni", placed.rotation, poses.joints)
    np.testing.assert_allclose(placed.joints, turned + placed.translation[:, None], atol=1e-4)
    image = placed.joints[..., :2] / placed.joints[..., 2:] * CAMERA[:2] + CAMERA[2:]
    assert np.abs(image - WALK[..., :2]).max() < 40  # pixels
    matrix = np.array([[CAMERA[0], 0, CAMERA[2]], [0, CAMERA[1], CAMERA[3]], [0, 0, 1]])
    np.testing.assert_array_equal(edmlift.place(poses, matrix).joints, placed.joints)
    one = edmlift.place(edmlift.lift(WALK[3]), CAMERA)
    assert one.joints.shape == (14, 3) and one.status == "ok"
    np.testing.assert_array_equal(one.joints, placed.joints[3])


def test_placing_by_the_size_of_the_image():
    placed = edmlift.place(edmlift.lift(WALK), image=(1000, 1000))
    assert (placed.status == "ok").all()
    assert ((placed.focal >= 499) & (placed.focal <= 4001)).all()


def test_a_pose_that_was_refused_is_not_placed():
    keypoints = WALK[:3].copy()
    keypoints[1, :, 2] = 0
    placed = edmlift.place(edmlift.lift(keypoints), CAMERA)
    assert list(placed.status) == ["ok", "too_few_joints", "ok"]
    assert np.isnan(placed.joints[1]).all() and np.isnan(placed.focal[1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "either camera"),
        ({"camera": CAMERA, "image": (9, 9)}, "either camera"),
        ({"camera": (1, 2, 3)}, "fx, fy, cx, cy"),
        ({"camera": (0, 1, 2, 3)}, "fx, fy > 0"),
        ({"camera": np.ones((3, 3))}, r"\[\[fx, 0, cx\]"),
        ({"image": (0, 9)}, "over 0"),
    ],
)
def test_what_is_no_camera(options: dict, message: str):
    with pytest.raises(ValueError, match=message):
        edmlift.place(edmlift.lift(WALK[:1]), **options)


def test_standing_on_the_floor():
    poses = edmlift.lift(WALK)
    standing = edmlift.stand(poses)
    assert standing.shape == poses.joints.shape
    assert (standing[:, 0, 1] > 1.3).all() and (standing[..., 1].min(1) > 0).all()
    assert edmlift.stand(edmlift.lift(WALK[0]), (0, -2, 0.3)).shape == (14, 3)
    for up in ((0, 0, 0), (0, np.nan, 1), (0, 1)):
        with pytest.raises(ValueError, match="up must be"):
            edmlift.stand(poses, up)


# ---- Body, quality, limits ---------------------------------------------------------------------


def test_fitting_a_height_and_bones():
    poses = edmlift.lift(WALK)
    tall, small = edmlift.fit_body(poses, height=1.95), edmlift.fit_body(poses, height=1.5)
    assert (tall.status == "ok").all()
    np.testing.assert_allclose(tall.joints / small.joints, 1.95 / 1.5, rtol=2e-3)
    known = edmlift.fit_body(poses, bones={"left_elbow": 0.25})
    np.testing.assert_allclose(
        np.linalg.norm(known.joints[:, 6] - known.joints[:, 5], axis=-1), 0.25, atol=1e-5
    )
    array = np.zeros(13)
    array[[end for _, end in edmlift.BONES].index(6)] = 0.25
    np.testing.assert_array_equal(edmlift.fit_body(poses, bones=array).joints, known.joints)
    one = edmlift.fit_body(edmlift.lift(WALK[2]), height=1.95)
    np.testing.assert_array_equal(one.joints, tall.joints[2])
    assert one.status == "ok"


def test_a_body_that_is_none():
    poses = edmlift.lift(WALK[:2])
    fitted = edmlift.fit_body(poses, height=[1.8, 9])
    assert list(fitted.status) == ["ok", "body"]
    assert np.isnan(fitted.joints[1]).all()
    with pytest.raises(ValueError, match="'elbow'.*left_elbow"):
        edmlift.fit_body(poses, bones={"elbow": 0.3})
    with pytest.raises(ValueError, match="needs height= or bones="):
        edmlift.fit_body(poses)
    with pytest.raises(ValueError, match=r"height must be \[2\]"):
        edmlift.fit_body(poses, height=[1, 2, 3])


def test_quality_uncertainty_and_limits():
    keypoints = WALK[:4].copy()
    keypoints[1, :, 2] = 0
    keypoints[2, 4, 2] = 0
    poses = edmlift.lift(keypoints)
    for found in (edmlift.quality(poses), edmlift.joint_limits(poses)):
        assert np.isnan(found[1]) and np.isfinite(found[[0, 2, 3]]).all()
    assert ((edmlift.quality(poses)[[0, 2, 3]] > 0) & (edmlift.quality(poses)[0] <= 1)).all()
    metres = edmlift.uncertainty(poses)
    assert metres.shape == (4, 14) and np.isnan(metres[1]).all()
    assert 0.02 < metres[0, 4] < metres[2, 4] < 0.3
    one = edmlift.lift(WALK[0])
    assert edmlift.quality(one).shape == edmlift.joint_limits(one).shape == ()
    assert edmlift.quality(one) == edmlift.quality(poses)[0]
    assert edmlift.uncertainty(one).shape == (14,)


def test_reflecting_by_joint_limits():
    poses = edmlift.lift(WALK)
    false = dataclasses.replace(poses, joints=poses.joints * np.float32([1, 1, -1]))
    back, fewer = edmlift.reflect_by_joint_limits(false)
    told = fewer > 0
    assert told.mean() > 0.5
    np.testing.assert_array_equal(back.joints[told], poses.joints[told])
    alone, none = edmlift.reflect_by_joint_limits(edmlift.lift(WALK[0]))
    assert alone.joints.shape == (14, 3) and none.shape == ()


def test_poses_from_elsewhere():
    lifted = edmlift.lift(WALK)
    poses = edmlift.Poses.of(lifted.joints)
    np.testing.assert_array_equal(edmlift.joint_limits(poses), edmlift.joint_limits(lifted))
    np.testing.assert_array_equal(edmlift.stand(poses), edmlift.stand(lifted))
    assert not (edmlift.place(poses, CAMERA).status == "ok").any()  # nothing says where it was seen
    placed = edmlift.place(edmlift.Poses.of(lifted.joints, WALK), CAMERA)
    np.testing.assert_array_equal(placed.joints, edmlift.place(lifted, CAMERA).joints)
    with pytest.raises(ValueError, match=r"\[F,14,3\] or \[14,3\]"):
        edmlift.Poses.of(np.zeros((3, 14, 2)))
    with pytest.raises(ValueError, match="keypoints must be"):
        edmlift.Poses.of(lifted.joints, WALK[..., :2])


def test_arrays_are_not_poses():
    for function in (edmlift.quality, edmlift.stand, edmlift.joint_limits, edmlift.uncertainty):
        with pytest.raises(TypeError, match=r"Poses\.of\(\), not ndarray"):
            function(WALK)


# ---- Video -------------------------------------------------------------------------------------


def test_a_video_frame_by_frame_and_at_once():
    at_once = edmlift.track(WALK, fps=30)
    assert at_once.ok.all() and list(at_once.elapsed[:4]) == [0, 33, 33, 34]
    track = edmlift.Track()
    for i, keypoints in enumerate(WALK):
        pose = track.lift(keypoints, 1000 * i / 30)
        np.testing.assert_array_equal(pose.joints, at_once.joints[i])
    assert pose.joints.shape == (14, 3) and pose.held.shape == (14,) and pose.swapped.shape == (2,)
    times = np.floor(np.arange(len(WALK)) * 1000 / 30).astype(int)
    np.testing.assert_array_equal(edmlift.track(WALK, time_ms=times).joints, at_once.joints)


def test_what_a_track_reports():
    keypoints = np.repeat(WALK[:1], 12, 0)
    keypoints[6, 3] = np.nan
    keypoints[9] = keypoints[9, edmlift.MIRROR]
    tracked = edmlift.track(keypoints, fps=30)
    assert tracked.ok.all()
    assert list(np.argwhere(tracked.held)[0]) == [6, 3] and tracked.held.sum() == 1
    assert list(np.flatnonzero(tracked.swapped.all(1))) == [9]
    np.testing.assert_array_equal(tracked.keypoints[9], tracked.keypoints[8])  # put right
    assert not tracked.mirrored.any()


def test_settings_and_formats_of_a_track():
    full = edmlift.Track(noise_full=0)
    assert np.abs(full.lift(WALK, np.arange(39) * 33).joints - edmlift.lift(WALK).joints).max() > 0
    track = edmlift.Track(format="coco17", threshold=0.1)
    assert track.lift(coco17()[0], 0).status == "ok"
    with pytest.raises(ValueError, match="smooth_image must be"):
        edmlift.Track(smooth_image=(-1, 0))


def test_a_video_without_times():
    for options in ({}, {"fps": 30, "time_ms": [1]}):
        with pytest.raises(ValueError, match="either fps= or time_ms="):
            edmlift.track(WALK, **options)
    with pytest.raises(ValueError, match="fps must be"):
        edmlift.track(WALK, fps=0)
    with pytest.raises(ValueError, match=r"times must be \[39\]"):
        edmlift.track(WALK, time_ms=[1, 2])
    with pytest.raises(ValueError, match="finite"):
        edmlift.track(WALK[:1], time_ms=[np.nan])
    with pytest.raises(ValueError, match="not one"):
        edmlift.track(WALK[0], fps=30)
    assert list(edmlift.track(WALK[:2], time_ms=[5, 5]).status) == ["ok", "time"]


# ---- The package -------------------------------------------------------------------------------


def test_every_public_name_is_documented():
    for name in edmlift.__all__:
        thing = getattr(edmlift, name)
        assert callable(thing) is False or thing.__doc__, name
    assert (Path(edmlift.__file__).parent / "py.typed").exists()
    version = re.search(r'EDML_VERSION_STRING "(.+)"', HEADERS)[1]
    assert edmlift.__version__ == version


def test_the_first_screen_lifts_a_pose():
    keypoints = edmlift.read_keypoints(DATA / "walk.csv")
    assert edmlift.lift(keypoints).ok.all()


def test_a_masked_joint_is_missing():
    keypoints = np.ma.masked_array(WALK.copy())
    keypoints[0, [9, 12], :2] = np.ma.masked
    missing = WALK.copy()
    missing[0, [9, 12], :2] = np.nan
    same(edmlift.lift(keypoints), edmlift.lift(missing))


@pytest.mark.parametrize("threshold", ["0.3", [0.3], np.nan, -1])
def test_a_threshold_is_a_number(threshold: object):
    with pytest.raises(ValueError, match="threshold must be a finite number"):
        edmlift.lift(WALK, threshold=threshold)


@pytest.mark.parametrize("length", [1e300, 1e-300])
def test_a_direction_that_c_cannot_hold_is_refused(length: float):
    with pytest.raises(ValueError, match="up must be three finite numbers, not all 0"):
        edmlift.stand(edmlift.lift(WALK), (0, -length, 0))
