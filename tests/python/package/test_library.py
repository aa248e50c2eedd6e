"""What research takes of the package: the C library with one model, and its stages."""

import re
from pathlib import Path

import numpy as np
import pytest
from package_support import ROOT, WALK, need_library

from edmlift import _binding
from edmlift import library as edmlift
from edmlift.joints import mid_hip
from edmlift.networks import find_model
from edmlift.stages import Image


@pytest.fixture(scope="module")
def library() -> edmlift.Library:
    need_library()
    return edmlift.Library()


@pytest.fixture
def mixed() -> np.ndarray:
    """Six keypoint sets, the second, third and fifth of which are refused."""
    keypoints = WALK[:6].copy()
    keypoints[1, 3, 0] = np.nan
    keypoints[2, 2:, 2] = 0
    keypoints[4, :, :2] = 7
    return keypoints


def test_shapes_and_types(library: edmlift.Library):
    poses = library.lift(WALK)
    count = len(WALK)
    assert poses.joints.shape == (count, 14, 3)
    assert poses.misfit.shape == poses.status.shape == (count,)
    assert poses.joints.dtype == poses.misfit.dtype == np.float32
    assert np.isfinite(poses.joints).all() and (poses.misfit >= 0).all()


def test_root_is_mid_hip(library: edmlift.Library):
    joints = library.lift(WALK).joints
    np.testing.assert_allclose(joints[:, 8] + joints[:, 11], 0, atol=1e-6)


def test_statuses_and_nan_where_refused(library: edmlift.Library, mixed: np.ndarray):
    poses = library.lift(mixed)
    assert list(poses.status) == ["ok", "not_finite", "too_few_joints", "ok", "degenerate", "ok"]
    refused = poses.status != "ok"
    for numbers in (poses.joints.reshape(6, -1), poses.misfit[:, None]):
        assert np.isnan(numbers[refused]).all()
        assert np.isfinite(numbers[~refused]).all()


@pytest.mark.filterwarnings("error")
def test_no_warnings(library: edmlift.Library, mixed: np.ndarray):
    library.lift(mixed)


def test_batch_equals_single(library: edmlift.Library, mixed: np.ndarray):
    batch = library.lift(mixed)
    for i, keypoints in enumerate(mixed):
        single = library.lift(keypoints[None])
        assert single.status[0] == batch.status[i]
        for field in ("joints", "misfit"):
            np.testing.assert_array_equal(getattr(single, field)[0], getattr(batch, field)[i])


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int64])
def test_any_kind_and_layout_of_numbers(library: edmlift.Library, kind: type):
    whole = np.round(WALK)
    expected = library.lift(whole).joints
    strided = np.asfortranarray(np.repeat(whole.astype(kind), 2, axis=0))[::2]
    np.testing.assert_array_equal(library.lift(strided).joints, expected)


def test_input_is_left_alone(library: edmlift.Library, mixed: np.ndarray):
    given = np.ascontiguousarray(mixed, np.float32)
    before = given.copy()
    library.lift(given)
    np.testing.assert_array_equal(given, before)


def test_empty_batch(library: edmlift.Library):
    poses = library.lift(np.zeros((0, 14, 3)))
    assert poses.joints.shape == (0, 14, 3)
    assert poses.status.shape == poses.misfit.shape == (0,)


@pytest.mark.parametrize("shape", [(14, 3), (5, 14, 2), (5, 17, 3), (1, 5, 14, 3), (0,), ()])
def test_wrong_shape(library: edmlift.Library, shape: tuple[int, ...]):
    with pytest.raises(ValueError, match=r"must be \[F,14,3\], not \("):
        library.lift(np.zeros(shape))


def test_missing_library_says_how_to_build_it(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match=r"none\.so: .*`pip install \.`.*EDMLIFT_TOOLS=ON"):
        edmlift.Library(path=tmp_path / "none.so")


def test_a_library_of_another_machine_says_so(tmp_path: Path):
    other = tmp_path / "libedmlift.so"
    other.write_bytes(b"MZ")
    with pytest.raises(ImportError, match=r"libedmlift\.so is no library for this .*pip install"):
        edmlift.Library(path=other)


def test_the_environment_names_the_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("EDMLIFT_LIBRARY", str(tmp_path / "theirs.so"))
    with pytest.raises(FileNotFoundError, match="theirs"):
        edmlift.Library()


def test_unknown_model(library: edmlift.Library):
    with pytest.raises(ValueError, match="'none' is not known; there are distances_f32, "):
        edmlift.Library("none")


def test_status_names(library: edmlift.Library):
    assert library.status_name(0) == "ok"
    assert library.status_name(-3) == "too_few_joints"
    assert library.status_name(-99) == "?"


UP = (0.1, -1.9, -0.3)


def rooted(points: np.ndarray, image: Image) -> np.ndarray:
    """Points in the body's frame, turned back to the camera's axes, about mid-hip."""
    sine, cosine = -image.down[0], image.down[1]
    x, y = points[:, 0].copy(), points[:, 1].copy()
    turned = np.stack([cosine * x - sine * y, sine * x + cosine * y, points[:, 2]], 1)
    return turned - mid_hip(turned)


@pytest.mark.parametrize("up", [None, UP])
def test_the_stages_strung_together_are_the_lift(library: edmlift.Library, up):
    """Of distances."""
    status, image = library.body_frame(WALK[0], fewest_joints=10, impute=True)
    assert status == "ok" and image.seen.all() and np.hypot(*image.down) == pytest.approx(1)
    edm = library.edm(image)
    assert edm.shape == (91,) and (edm >= 0).all()
    found = library.predict(image, up)
    assert ((found.share > 0) & (found.share < 1)).all()
    scaled = library.mds(found.distance)
    points = library.align(scaled, found.points)
    fused, misfit = library.fuse(points, image, found.share)
    lifted = library.lift(WALK[:1], up)
    np.testing.assert_allclose(rooted(fused, image), lifted.joints[0], atol=1e-5)
    assert misfit == pytest.approx(lifted.misfit[0], abs=1e-6)
    image_of_mirror = library.align(scaled * np.float32([1, 1, -1]), found.points)
    np.testing.assert_allclose(image_of_mirror, points, atol=1e-5)


@pytest.mark.parametrize("up", [None, UP])
def test_the_stages_of_direct_are_fewer(library: edmlift.Library, up):
    direct = edmlift.Library("direct_f32")
    _, image = direct.body_frame(WALK[0], fewest_joints=10, impute=True)
    found = direct.predict(image, up)
    assert not found.distance.any()
    fused, misfit = direct.fuse(found.points, image, found.share)
    lifted = direct.lift(WALK[:1], up)
    np.testing.assert_allclose(rooted(fused, image), lifted.joints[0], atol=1e-5)
    assert misfit == pytest.approx(lifted.misfit[0], abs=1e-5)


def test_the_five_weights_of_fconn_choose_a_mirror_image(library: edmlift.Library):
    fconn = edmlift.Library("fconn_f32")
    pose = fconn.lift(WALK[:1]).joints[0]
    for handed in (1, -1):
        chosen = fconn.mirror(pose * np.float32([1, 1, handed]))
        np.testing.assert_allclose(chosen, pose, atol=1e-6)


def test_a_frame_without_a_person_has_a_status(library: edmlift.Library):
    keypoints = WALK[0].copy()
    keypoints[:5, 2] = 0
    assert library.body_frame(keypoints, 10, impute=True)[0] == "too_few_joints"
    status, image = library.body_frame(keypoints, 9, impute=False)
    assert status == "ok" and list(np.flatnonzero(~image.seen)) == [0, 1, 2, 3, 4]
    assert (image.at[:5] == 0).all() and image.down.tolist() == [0, 1]


@pytest.fixture(scope="module")
def fixed(library: edmlift.Library) -> edmlift.Library:
    return edmlift.Library("distances_w16", fixed=True)


def test_fixed_point_is_near_float(library: edmlift.Library, fixed: edmlift.Library):
    plain, whole = edmlift.Library("distances_w16").lift(WALK), fixed.lift(WALK)
    assert (whole.status == "ok").all()
    assert np.abs(whole.joints - plain.joints).max() < 2e-3  # metres
    assert np.abs(whole.misfit - plain.misfit).max() < 1e-4
    assert whole.joints.dtype == np.float32


def test_fixed_point_has_the_same_statuses(fixed: edmlift.Library, mixed: np.ndarray):
    poses = fixed.lift(mixed)
    assert list(poses.status) == ["ok", "not_finite", "too_few_joints", "ok", "degenerate", "ok"]
    assert np.isnan(poses.joints[1]).all() and np.isfinite(poses.joints[0]).all()


def test_fixed_point_takes_quantised_models_alone(library: edmlift.Library):
    for model in ("distances_f32", "direct_f32", "fconn_f32", "fconv_f32"):
        with pytest.raises(ValueError, match="does not lift in fixed point"):
            edmlift.Library(model, fixed=True)


def test_fconv_goes_through_the_same_lift(library: edmlift.Library, mixed: np.ndarray):
    lifts = [
        edmlift.Library("fconv_f32"),
        edmlift.Library("fconv_w8"),
        edmlift.Library("fconv_w8", fixed=True),
    ]
    plain, *others = (library.lift(mixed) for library in lifts)
    assert list(plain.status) == ["ok", "not_finite", "too_few_joints", "ok", "degenerate", "ok"]
    for poses in others:
        assert (poses.status == plain.status).all()
        assert np.nanmean(np.abs(poses.joints - plain.joints)) < 0.05  # metres
    _, image = library.body_frame(WALK[0], 10, impute=True)
    plain, small = (lifts[n].predict(image).distance for n in (0, 1))
    assert plain.any() and np.abs(plain - small).max() < 0.05
    assert lifts[0].has("fconv_w8") and not lifts[0].has("fconv_w16")


def test_keypoints_become_integers():
    given = np.zeros((1, 14, 3))
    given[0, :6, 0] = [1.5, -2, np.inf, -np.inf, np.nan, 1e9]
    given[0, :6, 2] = [1, 0, -1, 1e-9, 5, np.nan]
    out = edmlift.to_q16(given)[0]
    low, high = -(2**31), 2**31 - 1
    assert out["at"][:6, 0].tolist() == [98304, -131072, high, low, low, high]
    assert out["c"][:6].tolist() == [32767, 0, -32768, 1, 32767, -32768]


def test_constants_are_those_of_the_header():
    header = (ROOT / "include" / "edmlift.h").read_text("utf-8")
    for name, value in {
        "EDML_NO_KEYPOINT": _binding.NO_KEYPOINT,
        "EDML_BONES": _binding.BONE_COUNT,
        "EDML_PAIRS": _binding.PAIR_COUNT,
    }.items():
        assert f"{name} = {value}" in header or f"{name} {value}" in header, name


def test_another_version_of_the_library_is_refused(tmp_path: Path, monkeypatch):
    need_library()
    monkeypatch.setitem(_binding._SIGNATURES, "edml_of_tomorrow", (None,))
    copy = tmp_path / "library.so"
    copy.write_bytes(_binding.default_path().read_bytes())
    with pytest.raises(
        ImportError, match=r"library\.so has no edml_of_tomorrow\(\): build it again"
    ):
        _binding.load(copy)


def test_the_page_of_fconv_has_the_sizes_of_its_work_memory():
    need_library()
    page = (ROOT / "docs" / "fconv.md").read_text("utf-8")
    sizes = {
        "edml_fconv_work": find_model("fconv_w8").work_bytes,
        "edml_fconv_work_q": find_model("fconv_w8", fixed=True).work_bytes,
    }
    for name, size in sizes.items():
        assert re.search(rf"{name}` of {size:,} bytes", page), f"{name} has {size:,} bytes"
