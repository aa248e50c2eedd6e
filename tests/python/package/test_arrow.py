"""edmlift.arrow: the poses of lift() in batches of Arrow, whatever types the keypoints have."""

import pickle
import subprocess
import sys
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from package_support import DATA, ROOT, WALK, need_library

pa = pytest.importorskip("pyarrow", reason="no pyarrow: pip install pyarrow")

import edmlift  # noqa: E402
import edmlift.arrow  # noqa: E402
from edmlift.arrow import BAD_ROW, ColumnError, Lifter, lift_batch  # noqa: E402
from edmlift.keypoint_sets import KEYPOINT_NAMES  # noqa: E402

COCO = edmlift.read_keypoints(DATA / "detections" / "beam1_thunder.csv", "coco17")
IMAGE = (1080.0, 1920.0)
COUNT = len(COCO)
ADDED = ["pose", "misfit", "quality", "status"]

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture(autouse=True)
def _library() -> None:
    need_library()


def batch(keypoints: object, type: object = None, **columns: object) -> "pa.RecordBatch":
    """A batch with keypoints, and before them other columns."""
    given = keypoints if isinstance(keypoints, pa.Array) else pa.array(keypoints, type)
    return pa.record_batch({**columns, "keypoints": given})


def rows(keypoints: np.ndarray = COCO) -> "pa.Array":
    return pa.array(keypoints.tolist(), pa.list_(pa.list_(pa.float32())))


def poses_of(lifted: "pa.RecordBatch") -> np.ndarray:
    """[F,14,3], NaN for null."""
    nothing = [np.nan] * 42
    given = [nothing if pose is None else pose for pose in lifted["pose"].to_pylist()]
    return np.array(given, np.float32).reshape(-1, 14, 3)


def same(lifted: "pa.RecordBatch", poses: edmlift.Poses) -> None:
    """To the bit."""
    lifted.validate(full=True)
    assert lifted["status"].to_pylist() == list(poses.status)
    np.testing.assert_array_equal(poses_of(lifted), poses.joints)
    for name, wanted in (("misfit", poses.misfit), ("quality", edmlift.quality(poses))):
        found = lifted[name].to_numpy(zero_copy_only=False)
        np.testing.assert_array_equal(found, wanted, err_msg=name)
        assert lifted[name].null_count == (~poses.ok).sum()


def statuses(lifted: "pa.RecordBatch") -> list[str]:
    return lifted["status"].to_pylist()


# ---- Types of columns --------------------------------------------------------------------------


def fixed(width: int, of: object = None) -> object:
    return pa.list_(of or pa.float32(), width)


def views() -> list[object]:
    """Lists of this version that are neither of the usual kinds."""
    return [pa.list_view(fixed(3)), pa.list_(pa.list_view(pa.float32()))]


TYPES = {
    "lists": pa.list_(pa.list_(pa.float32())),
    "lists of double": pa.list_(pa.list_(pa.float64())),
    "large": pa.large_list(pa.large_list(pa.float32())),
    "fixed": fixed(17, fixed(3)),
    "fixed in variable": pa.list_(fixed(3)),
    "variable in fixed": fixed(17, pa.list_(pa.float32())),
    **{f"view {i}": kind for i, kind in enumerate(views())},
}
FLAT = {"lists": pa.list_(pa.float32()), "fixed": fixed(51), "large": pa.large_list(pa.float64())}


@pytest.mark.parametrize("kind", TYPES.values(), ids=TYPES)
def test_lists_of_lists_of_any_kind(kind: object):
    given = batch(COCO.tolist(), kind, id=range(COUNT))
    lifted = lift_batch(given, format="coco17")
    assert lifted.schema.names == ["id", "keypoints", *ADDED]
    same(lifted, edmlift.lift(COCO, format="coco17"))
    part = given.slice(3, 9)
    same(lift_batch(part, format="coco17"), edmlift.lift(COCO[3:12], format="coco17"))


@pytest.mark.parametrize("kind", FLAT.values(), ids=FLAT)
def test_flat_lists_of_any_kind(kind: object):
    given = batch(COCO.reshape(COUNT, 51).tolist(), kind)
    same(lift_batch(given.slice(5), format="coco17"), edmlift.lift(COCO[5:], format="coco17"))


@pytest.mark.parametrize("flat", [False, True])
def test_without_a_confidence(flat: bool):
    pairs = COCO[..., :2].copy()
    pairs[4, 9], pairs[5, 8] = np.nan, 0  # not seen
    kind = fixed(34) if flat else fixed(17, fixed(2))
    given = batch(pairs.reshape(COUNT, -1).tolist() if flat else pairs.tolist(), kind)
    same(lift_batch(given, format="coco17"), edmlift.lift(pairs, format="coco17"))


def test_whole_numbers_halves_and_decimals():
    whole = np.round(COCO)
    wanted = edmlift.lift(whole, format="coco17")
    for kind in (pa.int32(), pa.int64(), pa.decimal128(12, 3)):
        same(lift_batch(batch(whole.astype(int).tolist(), pa.list_(pa.list_(kind))),
                        format="coco17"), wanted)  # fmt: skip
    halves = COCO.astype(np.float16)
    kind = pa.list_(pa.list_(pa.float16()))
    given = batch([list(map(list, person)) for person in halves], kind)
    same(lift_batch(given, format="coco17"), edmlift.lift(halves, format="coco17"))


@pytest.mark.parametrize("name", ["score", "visibility", "c"])
def test_objects_as_tensorflow_js_and_mediapipe_have_them(name: str):
    """Members in any order, with others beside."""
    people = [[{"z": 0.5, name: c, "y": y, "x": x} for x, y, c in p] for p in COCO.tolist()]
    same(lift_batch(batch(people), format="coco17"), edmlift.lift(COCO, format="coco17"))
    without = [[{"x": x, "y": y} for x, y, _ in person] for person in COCO.tolist()]
    same(lift_batch(batch(without), format="coco17"), edmlift.lift(COCO[..., :2], format="coco17"))


def test_named_keypoints_are_placed_by_name():
    names = KEYPOINT_NAMES["coco17"]
    people = [
        [{"name": n, "x": x, "y": y, "c": c} for n, (x, y, c) in zip(names, p, strict=True)]
        for p in COCO.tolist()
    ]
    wanted = edmlift.lift(COCO, format="coco17")
    same(lift_batch(batch(people), format="coco17"), wanted)
    people[0].reverse()
    people[1] = [point | {"name": None} for point in people[1]]
    same(lift_batch(batch(people), format="coco17"), wanted)
    people[2][3]["name"], people[3][4]["name"], people[4][5]["name"] = "thumb", "nose", None
    with pytest.warns(UserWarning, match="3 of 20 rows are bad_row; .* or not named"):
        lifted = lift_batch(batch(people), format="coco17")
    assert statuses(lifted)[:6] == ["ok", "ok", BAD_ROW, BAD_ROW, BAD_ROW, "ok"]
    with pytest.warns(UserWarning, match="under 0.2"):
        whatever = lift_batch(batch(people), format="h36m17_right_first")
    assert statuses(whatever)[:6] == ["ok"] * 6  # whose names are not known


def test_lists_in_an_object_as_ultralytics_has_them():
    people = [dict(zip(("x", "y", "visible"), person.T.tolist(), strict=True)) for person in COCO]
    people[2]["x"].pop()
    people[3] = None
    with pytest.warns(UserWarning, match="1 of 20 rows are bad_row"):
        lifted = lift_batch(batch(people), format="coco17")
    wanted = edmlift.lift(COCO, format="coco17").status.tolist()
    assert statuses(lifted) == [*wanted[:2], BAD_ROW, "nobody", *wanted[4:]]


def test_confidences_beside_the_keypoints_as_mmpose_has_them():
    wanted = edmlift.lift(COCO, format="coco17")
    deep = np.concatenate([COCO[..., :2], np.full((COUNT, 17, 1), 7)], -1)  # z, not a confidence
    scores = pa.array(COCO[..., 2].tolist())
    for points in (COCO[..., :2], deep):
        given = batch(points.tolist(), keypoint_scores=scores)
        same(lift_batch(given, format="coco17"), wanted)
    given = batch(COCO[..., :2].tolist(), sure=scores)
    same(lift_batch(given, format="coco17", scores="sure"), wanted)
    short = pa.array([None, [0.5] * 16, *COCO[2:, :, 2].tolist()])
    with pytest.warns(UserWarning, match="not 17 of sure"):
        lifted = lift_batch(batch(COCO[..., :2].tolist(), sure=short), format="coco17",
                            scores="sure")  # fmt: skip
    assert statuses(lifted)[:3] == ["too_few_joints", BAD_ROW, wanted.status[2]]


@pytest.mark.parametrize("style", ["{axis}{k}", "{name}_{word}"])
def test_a_column_for_each_number(style: str):
    words = {"x": "x", "y": "y", "c": "score"}
    columns = {
        style.format(axis=axis, k=k, name=name, word=words[axis]): WALK[:, k, i]
        for k, name in enumerate(edmlift.JOINTS)
        for i, axis in enumerate("xyc")
    }
    given = pa.record_batch({"frame": range(len(WALK)), **columns})
    same(lift_batch(given), edmlift.lift(WALK))
    del columns[style.format(axis="c", k=13, name="left_ankle", word="score")]
    with pytest.raises(ColumnError, match="nor columns that name all keypoints of a pose: known"):
        lift_batch(pa.record_batch(columns))


def test_columns_of_other_names():
    given = pa.record_batch({"keypoints": [1], "people": rows(COCO[:1])})
    wanted = edmlift.lift(COCO[:1], format="coco17")
    same(lift_batch(given, format="coco17", keypoints="people"), wanted)
    given = pa.record_batch({"pose_keypoints_2d": rows(COCO[:1])})
    same(lift_batch(given, format="coco17"), wanted)
    given = pa.record_batch({"pose_keypoints_2d": [1], "keypoints": [1]})
    with pytest.raises(ColumnError, match='columns "keypoints" and "pose_keypoints_2d": say which'):
        lift_batch(given, format="coco17")


def test_tensors_dictionaries_and_run_lengths():
    wanted = edmlift.lift(COCO, format="coco17")
    tensors = pa.FixedShapeTensorArray.from_numpy_ndarray(np.ascontiguousarray(COCO))
    same(lift_batch(batch(tensors), format="coco17"), wanted)
    number = np.arange(COUNT) // 10  # ten rows each
    firsts = pa.array(COCO[::10].reshape(-1, 51).tolist(), pa.list_(pa.float32()))
    dictionary = pa.DictionaryArray.from_arrays(pa.array(number), firsts)
    wanted = edmlift.lift(COCO[::10][number], format="coco17")
    same(lift_batch(batch(dictionary), format="coco17"), wanted)
    runs = pa.RunEndEncodedArray.from_arrays(pa.array([10, 20], pa.int32()), pa.array([9.0, 8.0]))
    given = pa.record_batch({"keypoints": rows(), "focal": runs})
    lifted = lift_batch(given, format="coco17", camera=("focal", "focal", 0, 0))
    assert statuses(lifted) == ["camera"] * COUNT  # of so short a one


def test_tables_of_many_chunks():
    parts = [batch(rows(COCO[i : i + 3]), id=range(len(COCO[i : i + 3]))) for i in range(0, 20, 3)]
    table = pa.Table.from_batches([*parts, parts[0].slice(0, 0)])
    lifted = lift_batch(table, format="coco17")
    assert isinstance(lifted, pa.Table) and lifted["pose"].num_chunks >= 7
    (whole,) = lifted.combine_chunks().to_batches()
    same(whole, edmlift.lift(COCO, format="coco17"))
    assert lift_batch(table.slice(0, 0), format="coco17").schema == lifted.schema


def test_an_empty_batch():
    for kind in (pa.list_(pa.list_(pa.float32())), fixed(51), pa.null()):
        lifted = lift_batch(batch([], kind), format="coco17", up=(0, -1, 0))
        assert lifted.num_rows == 0 and lifted.schema.names == ["keypoints", *ADDED]
    wide = pa.record_batch({f"{a}{k}": pa.array([], pa.float32()) for k in range(14) for a in "xy"})
    assert lift_batch(wide).num_rows == 0
    ups = batch([], fixed(51), up=pa.array([], pa.list_(pa.float32())))
    assert lift_batch(ups, format="coco17", up="up").num_rows == 0


# ---- What is added -----------------------------------------------------------------------------


def test_the_schema_is_known_before():
    given = batch(rows(), id=range(COUNT))
    lifted = lift_batch(given, format="coco17")
    assert edmlift.arrow.schema(given.schema) == Lifter().schema(given.schema) == lifted.schema
    kinds = [lifted.schema.field(name).type for name in ADDED]
    assert kinds == [pa.list_(pa.float32()), pa.float32(), pa.float32(), pa.string()]
    about = lifted.schema.field("pose").metadata
    names = [f"{joint}_{axis}" for joint in edmlift.JOINTS for axis in "xyz"]
    assert about[b"unit"] == b"m" and about[b"order"].decode().split() == names


@pytest.mark.parametrize("kind", [pa.string(), pa.list_(pa.list_(pa.string())), pa.int8()])
def test_the_schema_of_what_cannot_be_lifted(kind: object):
    """Is refused as a batch would be, before any comes."""
    with pytest.raises(ColumnError, match='column "keypoints" is'):
        edmlift.arrow.schema(pa.schema({"keypoints": kind}), format="coco17")
    with pytest.raises(ColumnError, match='there is no column "g"'):
        edmlift.arrow.schema(batch(rows()).schema, format="coco17", up="g")
    tensors = pa.schema({"keypoints": pa.fixed_shape_tensor(pa.float32(), (17, 3)),
                         "name": pa.dictionary(pa.int8(), pa.string())})  # fmt: skip
    assert edmlift.arrow.schema(tensors, format="coco17").names == [*tensors.names, *ADDED]


def test_what_was_there_stays_as_it_is():
    schema = pa.schema(
        [pa.field("name", pa.dictionary(pa.int8(), pa.string()), metadata={"a": "b"}),
         pa.field("keypoints", pa.list_(pa.list_(pa.float32())))], metadata={"made": "here"},
    )  # fmt: skip
    names = pa.array(["a", None] * 10).dictionary_encode().cast(schema.field(0).type)
    given = pa.RecordBatch.from_arrays([names, rows()], schema=schema)
    lifted = lift_batch(given, format="coco17")
    assert lifted.select(["name", "keypoints"]).equals(given, check_metadata=True)
    for column in range(2):  # the same memory
        assert (
            lifted.column(column).buffers()[1].address == given.column(column).buffers()[1].address
        )


def test_names_that_are_taken():
    given = batch(rows(), status=["there"] * COUNT)
    with pytest.raises(ColumnError, match='a column "status", which the lift adds: rename it, or'):
        lift_batch(given, format="coco17")
    lifted = lift_batch(given, format="coco17", prefix="lifted_")
    assert lifted.schema.names[2:] == [f"lifted_{name}" for name in ADDED]
    assert lifted["status"].to_pylist() == ["there"] * COUNT


def test_a_lifter_goes_to_workers_and_takes_batches_as_they_come():
    lifter = pickle.loads(pickle.dumps(Lifter(format="coco17", model="direct_w16", fixed=True)))
    given = [batch(rows(COCO[:7])), batch(rows(COCO[7:]))]
    lifted = list(lifter.map(iter(given)))
    wanted = edmlift.lift(COCO, "direct_w16", format="coco17", fixed=True)
    assert [b.num_rows for b in lifted] == [7, 13]
    found = np.concatenate([poses_of(b) for b in lifted])
    np.testing.assert_array_equal(found, wanted.joints)


@pytest.mark.parametrize("threads", [1, 2, None])
def test_threads_do_not_change_bits(threads: int | None):
    many = np.tile(COCO, (40, 1, 1))
    lifted = lift_batch(batch(rows(many)), format="coco17", threads=threads)
    same(lifted, edmlift.lift(many, format="coco17"))


OPTIONS = [
    {"threshold": 0.4}, {"mirrored": True, "image": IMAGE}, {"fixed": True, "image": IMAGE},
    {"up": (0.1, -1, 0.2)}, {"camera": (1500, 1500, 540, 960)}, {"model": "fconn_w8"},
]  # fmt: skip


@pytest.mark.parametrize("options", OPTIONS, ids=lambda options: "-".join(options))
def test_the_options_of_lift(options: dict):
    same(lift_batch(batch(rows()), format="coco17", **options),
         edmlift.lift(COCO, format="coco17", **options))  # fmt: skip


# ---- What is known of each row -----------------------------------------------------------------


def test_up_image_and_camera_from_columns():
    rng = np.random.default_rng(1)
    up = rng.normal(0, 0.1, (COUNT, 3)) - [0, 1, 0]
    widths, heights = rng.integers(700, 1080, COUNT), rng.integers(1500, 1920, COUNT)
    cx = rng.normal(540, 10, COUNT)
    given = batch(rows(), gravity=up.tolist(), width=widths, height=heights, cx=cx)
    lifted = lift_batch(
        given, format="coco17", up="gravity", image=("width", "height"),
        camera=(1500, 1500.0, "cx", 960),
    )  # fmt: skip
    cameras = np.stack([np.full(COUNT, 1500), np.full(COUNT, 1500), cx, np.full(COUNT, 960)], -1)
    images = np.stack([widths, heights], -1)
    same(lifted, edmlift.lift(COCO, up=up, image=images, camera=cameras, format="coco17"))
    given = batch(rows(), at=cameras.tolist(), size=images.tolist(), x=up[:, 0], y=up[:, 1])
    lifted = lift_batch(given, format="coco17", up=("x", "y", 0), image="size", camera="at")
    flat = up * [1, 1, 0]
    same(lifted, edmlift.lift(COCO, up=flat, image=images, camera=cameras, format="coco17"))


def test_what_is_null_is_not_known():
    up = [[0, -1, 0.1 * i] if i % 2 else None for i in range(COUNT)]
    focal = [1500 if i % 3 else None for i in range(COUNT)]
    width = [900 if i % 5 else None for i in range(COUNT)]
    given = batch(rows(), up=up, f=focal, w=width)
    lifter = Lifter(format="coco17", up="up", camera=("f", "f", 540, 960), image=("w", 1700))
    lifted = lifter(given)
    for i in range(COUNT):
        camera = None if focal[i] is None else (1500, 1500, 540, 960)
        image = None if width[i] is None else (900, 1700)
        wanted = edmlift.lift(COCO[i : i + 1], None, up[i], camera=camera, image=image,
                              format="coco17")  # fmt: skip
        same(lifted.slice(i, 1), wanted)


def test_what_cannot_be_is_a_bad_row():
    up = [[0, -1, 0], [0, 0, 0], [0, -1], [0, np.inf, 1], None, [0, np.nan, 1], [0, -1e300, 0]]
    width = [1080, 1080, 0, 1080, -3, 1080, 1080]
    wanted = ["ok", BAD_ROW, BAD_ROW, BAD_ROW, BAD_ROW, "ok", BAD_ROW]
    given = batch(rows(COCO[4:11]), up=up, width=width)
    with pytest.warns(UserWarning, match="5 of 7 rows are bad_row; the first of them: its up"):
        lifted = lift_batch(given, format="coco17", up="up", image=("width", 1920))
    assert statuses(lifted) == wanted
    assert [pose is None for pose in lifted["pose"].to_pylist()] == [w != "ok" for w in wanted]
    given = batch(rows(COCO[4:7]), f=[1500, -1500, None])
    with pytest.warns(UserWarning, match="its camera cannot be"):
        lifted = lift_batch(given, format="coco17", camera=("f", 1500, 540, 960))
    assert statuses(lifted) == ["ok", BAD_ROW, "ok"]


@pytest.mark.parametrize("width", [[1080, None, 1080], [None, None, None]])
def test_normalised_keypoints_need_the_size_of_their_image(width: list):
    shares = COCO[4:7] / [*IMAGE, 1]
    squares = shares.copy()
    squares[..., 1::-1] = (COCO[4:7, :, :2] + [(IMAGE[1] - IMAGE[0]) / 2, 0]) / IMAGE[1]
    given = batch(rows(squares), width=pa.array(width, pa.int32()))
    with pytest.warns(UserWarning, match="its image has no size"):
        lifted = lift_batch(given, format="movenet17", image=("width", 1920))
    assert statuses(lifted) == ["ok" if w else BAD_ROW for w in width]


def test_pixels_where_shares_are_wanted():
    shares = COCO[4:8].copy()
    shares[..., :2] = shares[..., 1::-1] / 1920
    shares[1] = COCO[5]
    given = batch(rows(shares))
    with pytest.warns(UserWarning, match="normalised, 0 to 1; these look like pixels"):
        lifted = lift_batch(given, format="movenet17", image=(1920, 1920))
    assert statuses(lifted) == ["ok", BAD_ROW, "ok", "ok"]


# ---- What is wrong with a row is in that row ---------------------------------------------------


def with_row(row: object) -> "pa.RecordBatch":
    people = COCO[4:7].tolist()
    people[1] = row
    return batch(people, pa.list_(pa.list_(pa.float32())))


GOOD = COCO[5].tolist()
ROWS: dict[str, tuple[object, str]] = {
    "null": (None, "nobody"),
    "empty": ([], "nobody"),
    "nulls": ([None] * 17, "too_few_joints"),
    "null numbers": ([[None, None, None]] * 17, "too_few_joints"),
    "NaN": ([[np.nan] * 3] * 17, "too_few_joints"),
    "infinity": ([[np.inf, 1, 1]] * 17, "not_finite"),
    "one point": ([[5, 5, 1]] * 17, "degenerate"),
    "one too few": (GOOD[:16], BAD_ROW),
    "one too many": ([*GOOD, GOOD[0]], BAD_ROW),
    "a keypoint of one number": ([*GOOD[:16], [1]], BAD_ROW),
    "a keypoint of four": ([*GOOD[:16], [1, 2, 3, 4]], BAD_ROW),
    "an empty keypoint": ([*GOOD[:16], []], BAD_ROW),
}


@pytest.mark.parametrize("row, status", ROWS.values(), ids=ROWS)
def test_a_row_that_is_wrong_is_a_status(row: object, status: str):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore" if status == BAD_ROW else "error")
        lifted = lift_batch(with_row(row), format="coco17")
    assert statuses(lifted) == ["ok", status, "ok"]
    wanted = edmlift.lift(COCO[[4, 6]], format="coco17")
    np.testing.assert_array_equal(poses_of(lifted)[[0, 2]], wanted.joints)
    assert [lifted[name][1].as_py() for name in ADDED] == [None, None, None, status]


def test_keypoints_that_were_not_seen_and_pairs_among_triples():
    person = COCO[5].tolist()
    person[9], person[10] = None, person[10][:2]
    wanted = COCO[5].copy()
    wanted[9, 2], wanted[10, 2] = 0, 1
    lifted = lift_batch(with_row(person), format="coco17")
    np.testing.assert_array_equal(poses_of(lifted)[1], edmlift.lift(wanted, format="coco17").joints)


def test_flat_rows_of_any_length():
    people = [COCO[4].ravel().tolist(), COCO[5, :, :2].ravel().tolist(), [1.0] * 50, None, []]
    with pytest.warns(UserWarning, match="50 numbers, but coco17 has 34 or 51"):
        lifted = lift_batch(batch(people), format="coco17")
    assert statuses(lifted) == ["ok", "ok", BAD_ROW, "nobody", "nobody"]
    wanted = edmlift.lift(COCO[5, :, :2], format="coco17").joints
    np.testing.assert_array_equal(poses_of(lifted)[1], wanted)


@pytest.mark.parametrize("kind", [fixed(17, fixed(3)), fixed(51), pa.list_(fixed(3)), pa.null()])
def test_null_rows_of_any_type(kind: object):
    flat = kind == fixed(51)
    person = COCO[4].ravel().tolist() if flat else COCO[4].tolist()
    people = [None] * 4 if kind == pa.null() else [None, person, None, person]
    lifted = lift_batch(batch(people, kind).slice(1), format="coco17")
    assert statuses(lifted) == ["nobody" if person is None else "ok" for person in people[1:]]


def test_numbers_beyond_float32():
    person = COCO[4].astype(float)
    person[5, 0] = 1e300
    lifted = lift_batch(batch([person.tolist()]), format="coco17")
    assert statuses(lifted) == ["not_finite"]


def test_keypoints_whose_type_is_not_known_are_not_seen():
    lifted = lift_batch(batch([[None] * 17, []]), format="coco17")  # list<null>
    assert statuses(lifted) == ["too_few_joints", "nobody"]


# ---- What is wrong with a column -----------------------------------------------------------------


def strings() -> "pa.Array":
    return pa.array([[["1", "2", "3"]] * 17])


WRONG: dict[str, Callable[[], "pa.Array"]] = {
    "string": lambda: pa.array(["[[1, 2, 3]]"]),
    "int64": lambda: pa.array([1]),
    "struct<x: double, c: double>": lambda: pa.array([{"x": 1.0, "c": 1.0}]),
    "bool": lambda: pa.array([True]),
}


@pytest.mark.parametrize("kind", WRONG)
def test_a_column_of_another_type(kind: str):
    with pytest.raises(ColumnError) as caught:
        lift_batch(batch(WRONG[kind]()), format="coco17")
    assert str(caught.value) == (
        f'column "keypoints" is {kind}, but must be the 17 keypoints of one person: '
        "list<list<float>> of x, y or x, y, c, list<struct> with x, y and perhaps score or "
        "confidence or visibility or visible or c, or list<float> of 34 or 51 numbers"
    )


@pytest.mark.parametrize("given", [strings(), pa.array([[["a"]]]), pa.array([[[[1.0]]]]),
                                   pa.array([[{"x": "1", "y": "2"}]]), pa.array([[True]]),
                                   pa.array([{"x": 1, "y": 2}])])  # fmt: skip
def test_lists_of_other_types(given: "pa.Array"):
    with pytest.raises(ColumnError, match='column "keypoints" is .* but must be the 17 keypoints'):
        lift_batch(batch(given), format="coco17")


def test_other_columns_of_another_type_or_not_there():
    given = batch(rows(), up=["x"] * COUNT, width=["1"] * COUNT, keypoint_scores=[1.0] * COUNT)
    for message, options in [
        ('column "up" is string, but must be list<float> of 3 numbers', {"up": "up"}),
        ('column "width" is string, but must be a number', {"image": ("width", 1)}),
        ('column "keypoint_scores" is double, but must be list<float> of 17 confidences', {}),
        ('there is no column "g"; the columns are "up", "width"', {"up": "g"}),
        ('there is no column "g"; the columns are', {"keypoints": "g"}),
    ]:
        with pytest.raises(ColumnError, match=message):
            lift_batch(given if not options else given.drop_columns(["keypoint_scores"]),
                       format="coco17", **options)  # fmt: skip
    twice = pa.RecordBatch.from_arrays([rows(), rows()], ["keypoints", "keypoints"])
    with pytest.raises(ColumnError, match='there are 2 columns "keypoints"'):
        lift_batch(twice, format="coco17")
    with pytest.raises(ColumnError, match="there is no column of keypoints, pose_keypoints_2d"):
        lift_batch(pa.record_batch({"id": [1]}), format="coco17")


def test_options_are_checked_before_a_batch_comes():
    for message, options in [
        ("there are coco17", {"format": "coco"}),
        ("there are distances_f32", {"model": "fconn"}),
        ("threshold must be", {"threshold": -1}),
        ("up must be three", {"up": (0, 0, 0)}),
        ("threads must be 1 or more", {"threads": 0}),
        ("are normalised: give the image's size", {"format": "movenet17"}),
        ("needs image=", {"mirrored": True, "camera": ("f", "f", 1, 1)}),
        ("image must be 2 numbers or names of columns", {"image": ("w", "h", "d")}),
    ]:
        with pytest.raises(ValueError, match=message):
            Lifter(**options)


# ---- What is said --------------------------------------------------------------------------------


def test_likely_mistakes_are_said_once():
    lifter = Lifter(format="h36m17_right_first")
    given = batch(rows())
    with pytest.warns(UserWarning, match="poses have a quality under 0.2: are the") as caught:
        lifter(given)
        lifter(given.slice(5))
    assert len(caught) == 1 and caught[0].filename == __file__


def test_the_number_of_keypoints_is_explained():
    with pytest.warns(UserWarning) as caught:
        lifted = lift_batch(batch(rows()))
    assert statuses(lifted) == [BAD_ROW] * COUNT
    assert str(caught[0].message) == (
        "20 of 20 rows are bad_row; the first of them: 17 keypoints, but a pose has 14; formats "
        "with 17 keypoints: coco17, movenet17, h36m17_right_first, h36m17_left_first: name one"
    )


def test_without_pyarrow_it_says_what_to_install():
    code = "import sys; sys.modules['pyarrow'] = None; import edmlift; import edmlift.arrow"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT / "tools"
    )
    assert done.stderr.splitlines()[-1] == (
        'ImportError: edmlift.arrow needs the package pyarrow: pip install "edmlift[arrow]"'
    )
