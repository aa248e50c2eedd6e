"""Every promise of examples/lift_stdin: a line of input to a line of output, whatever the line.

EDMLIFT_LIFT_STDIN names the program; without it, the one in build/dev, or skipped if not built.
"""

import os
import random
import re
import select
import subprocess
from pathlib import Path

import numpy as np
import pytest

import edmlift

ROOT = Path(__file__).resolve().parents[2]
HEADER = (ROOT / "include" / "edmlift.h").read_text()
STATUSES = set(re.findall(r'X\(EDML_\w+, +-?\d+, "(\w+)"\)', HEADER)) | {"bad_line"}
VERSION = re.search(r'EDML_VERSION_STRING "(.+)"', HEADER).group(1)
COLUMNS = 45
LINE_MAX = 4096
PROGRAM = Path(
    os.environ.get("EDMLIFT_LIFT_STDIN", ROOT / "build" / "dev" / "examples" / "lift_stdin")
)
if "EDMLIFT_LIFT_STDIN" not in os.environ and not PROGRAM.exists():
    pytest.skip("lift_stdin is not built", allow_module_level=True)

WALK = np.loadtxt(ROOT / "examples" / "data" / "walk.csv", delimiter=",").reshape(-1, 14, 3)
RIGHT_ARM, LEGS = [3, 4], [8, 9, 10, 11, 12, 13]


def text(pose: np.ndarray, separator: str = ",") -> str:
    """A line without its end; pose [14,2] or [14,3]."""
    return separator.join(f"{number:g}" for number in np.ravel(pose))


def unseen(joints: list[int], pose: np.ndarray = WALK[0]) -> np.ndarray:
    pose = pose.copy()
    pose[joints, 2] = 0
    return pose


GOOD = text(WALK[0])
OTHER = text(WALK[20])


def run(data: str | bytes, *options: str) -> subprocess.CompletedProcess:
    data = data.encode() if isinstance(data, str) else data
    return subprocess.run([PROGRAM, *options], input=data, capture_output=True, timeout=60)


def rows(result: subprocess.CompletedProcess) -> list[list[str]]:
    """Fields of the output lines; each line is whole."""
    output = result.stdout.decode("ascii")
    assert output == "" or output.endswith("\n")
    table = [line.split(",") for line in output.split("\n")[:-1]]
    assert all(len(row) == COLUMNS for row in table)
    return table


def lift(data: str | bytes, *options: str) -> list[list[str]]:
    """Output of input without a bad line."""
    result = run(data, *options)
    assert result.returncode == 0
    return rows(result)


def statuses(table: list[list[str]]) -> list[str]:
    return [row[0] for row in table]


def numbers(row: list[str]) -> np.ndarray:
    return np.array([float(field) for field in row[1:]])


ANSWER, OTHER_ANSWER = lift(f"{GOOD}\n{OTHER}\n")


# ---- Formats that are read -------------------------------------------------------------------


@pytest.mark.parametrize("separator", [",", " ", "\t", "   ", ", ", " , ", "\t,\t"])
@pytest.mark.parametrize("columns", [2, 3])
def test_28_and_42_numbers_with_any_separator(separator: str, columns: int):
    assert lift(text(WALK[0, :, :columns], separator) + "\n") == [ANSWER]


def test_mixed_separators_and_blanks_around():
    fields = GOOD.split(",")
    mixed = "".join(a + b for a, b in zip(fields, [",", " ", "\t", " ,", ", "] * 9, strict=False))
    assert lift(f" \t{mixed.rstrip(' ,')} \t\n") == [ANSWER]


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(f"# names\n\n{GOOD}\n \t\n  # more, 1, 2\n{OTHER}\n\n", id="comments"),
        pytest.param(f"{GOOD}\r\n\r\n# x\r\n{OTHER}\r\n", id="crlf"),
        pytest.param(f"{GOOD}\n{OTHER}", id="no final newline"),
        pytest.param(f"\ufeff{GOOD}\n{OTHER}\n", id="byte order mark"),
        pytest.param(f"\ufeff# names\r\n{GOOD}\r\n{OTHER}", id="byte order mark and comment"),
        pytest.param(f"#\0\n{GOOD}\n{OTHER}\n", id="zero byte in a comment"),
    ],
)
def test_what_is_between_the_poses_does_not_matter(data: str):
    assert lift(data) == [ANSWER, OTHER_ANSWER]


@pytest.mark.parametrize("data", ["", "\n", "# only a comment", "\ufeff", "\r\n\r\n"])
def test_no_poses_no_output(data: str):
    result = run(data)
    assert (result.returncode, result.stdout, result.stderr) == (0, b"", b"")


def test_byte_order_mark_counts_only_at_the_start():
    result = run(f"{GOOD}\n\ufeff{OTHER}\n")
    assert statuses(rows(result)) == ["ok", "bad_line"]


# ---- Poses that are refused ------------------------------------------------------------------


def with_number(value: str, place: int) -> str:
    fields = GOOD.split(",")
    fields[place] = value
    return ",".join(fields)


@pytest.mark.parametrize("value", ["nan", "NaN", "-nan", "inf", "Infinity", "1e999"])
@pytest.mark.parametrize("place", [0, 40, 41])  # x of the first joint, y and c of the last
def test_not_finite(value: str, place: int):
    assert lift(with_number(value, place)) == [["not_finite"] + [""] * 44]


def test_not_finite_is_ignored_in_a_joint_that_was_not_seen():
    pose = unseen([4])
    pose[4, :2] = np.nan
    assert lift(text(pose)) == lift(text(unseen([4])))


@pytest.mark.parametrize("value", ["0", "512"])
def test_equal_points_are_degenerate(value: str):
    assert lift(",".join([value] * 28)) == [["degenerate"] + [""] * 44]


def test_all_zeros_of_42_were_not_seen():
    assert statuses(lift(",".join(["0"] * 42))) == ["too_few_joints"]


def test_missing_arm_is_lifted_and_its_place_does_not_matter():
    here, there = unseen(RIGHT_ARM), unseen(RIGHT_ARM)
    there[RIGHT_ARM, :2] = 1e6
    table = lift(f"{text(here)}\n{text(there)}\n")
    assert statuses(table) == ["ok", "ok"]
    assert table[0] == table[1]
    assert np.isfinite(numbers(table[0])).all()


def test_too_few_joints():
    assert lift(text(unseen(LEGS + RIGHT_ARM))) == [["too_few_joints"] + [""] * 44]


def test_refused_poses_are_counted():
    nan = with_number("nan", 0)
    result = run(f"{nan}\n{GOOD}\n{text(unseen(LEGS + RIGHT_ARM))}\n{nan}\n")
    assert statuses(rows(result)) == ["not_finite", "ok", "too_few_joints", "not_finite"]
    assert result.stderr.decode() == "lift_stdin: refused poses: 3\n"
    assert result.returncode == 0


# ---- Bad lines -------------------------------------------------------------------------------

FIELDS = GOOD.split(",")
BAD = {
    "27": ",".join(FIELDS[:27]),
    "29": ",".join(FIELDS[:29]),
    "41": ",".join(FIELDS[:41]),
    "43": ",".join([*FIELDS, "1"]),
    "one": "1",
    "text": "head_top,neck",
    "text last": ",".join([*FIELDS[:41], "one"]),
    "text glued": with_number("1x", 5),
    "semicolons": ";".join(FIELDS),
    "empty field": with_number("", 5),
    "blank field": with_number(" ", 5),
    "trailing comma": GOOD + ",",
    "trailing comma, blank": GOOD + ", ",
    "trailing comma, cr": GOOD + ",\r",
    "leading comma": "," + GOOD,
    "comma": ",",
    "zero byte": GOOD.replace(",", "\0", 1),
    "zero byte first": "\0" + GOOD,
    "zero byte last": GOOD + "\0",
    "zero byte alone": "\0",
    "comment behind": GOOD + " # walk",
    "4097 bytes": GOOD.ljust(LINE_MAX + 1),
    "4097 bytes with cr": GOOD.ljust(LINE_MAX) + "\r",
    "a megabyte": "1," * 500_000,
    "a megabyte of blanks behind": GOOD.ljust(1 << 20),
}


@pytest.mark.parametrize("bad", BAD.values(), ids=BAD.keys())
def test_bad_line_is_named_and_shifts_nothing(bad: str):
    result = run(f"# names\n{GOOD}\n\n{bad}\n{OTHER}\n")
    assert rows(result) == [ANSWER, ["bad_line"] + [""] * 44, OTHER_ANSWER]
    assert result.returncode == 1
    message, count = result.stderr.decode().splitlines()
    assert message.startswith("lift_stdin: line 4: ")
    assert count == "lift_stdin: bad lines: 1"


@pytest.mark.parametrize("bad", BAD.values(), ids=BAD.keys())
def test_bad_last_line_without_newline(bad: str):
    result = run(f"{GOOD}\n{bad}")
    assert statuses(rows(result)) == ["ok", "bad_line"]
    assert result.returncode == 1


def test_line_of_4096_bytes_is_read():
    assert lift(f"{GOOD.ljust(LINE_MAX)}\n{OTHER}\n") == [ANSWER, OTHER_ANSWER]
    assert lift(f"{GOOD.rjust(LINE_MAX)}") == [ANSWER]


def test_long_line_is_not_split_into_poses():
    result = run(" ".join([GOOD] * 40) + "\n" + OTHER)
    assert statuses(rows(result)) == ["bad_line", "ok"]


@pytest.mark.parametrize("skipped", ["# " + "names " * 1000, " " * 5000], ids=["comment", "blanks"])
def test_long_lines_are_skipped_like_short_ones(skipped: str):
    assert lift(f"{skipped}\n{GOOD}\n") == [ANSWER]


# ---- Output ----------------------------------------------------------------------------------


def test_numbers_are_the_librarys_to_six_digits():
    if not Path(os.environ.get("EDMLIFT_LIBRARY", edmlift.LIBRARY)).exists():
        pytest.skip("the tools' library is not built")
    table = lift("\n".join(map(text, WALK)))
    poses = edmlift.Library().lift(WALK)
    assert statuses(table) == list(poses.status) == ["ok"] * len(WALK)
    expected = np.column_stack([poses.joints.reshape(-1, 42), poses.margin, poses.residual])
    np.testing.assert_allclose([numbers(row) for row in table], expected, rtol=5.01e-6, atol=1e-12)


def test_origin_is_mid_hip_and_the_size_is_human():
    joints = numbers(ANSWER)[:42].reshape(14, 3)
    np.testing.assert_allclose(joints[8] + joints[11], 0, atol=2e-6)
    assert 1.2 < np.ptp(joints[:, 1]) < 2.2  # metres; head top to ankle of somebody who walks


def test_the_decimal_point_is_no_matter_of_the_locale():
    environment = os.environ | {"LC_ALL": "de_DE.UTF-8"}
    result = subprocess.run([PROGRAM], input=GOOD.encode(), capture_output=True, env=environment)
    assert rows(result) == [ANSWER]


def test_header():
    header, answer = lift(GOOD, "--header")
    assert header[:4] == ["status", "x0", "y0", "z0"]
    assert header[-3:] == ["z13", "mirror_margin", "residual"]
    assert answer == ANSWER
    assert lift("", "--header") == [header]


def read_line(pipe, seconds: float) -> bytes:
    """A line, or what has come of it when the time is up."""
    line = b""
    while not line.endswith(b"\n") and select.select([pipe], [], [], seconds)[0]:
        line += os.read(pipe.fileno(), 4096)
    return line


def test_answers_come_line_by_line():
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "bufsize": 0}
    with subprocess.Popen([PROGRAM, "--header"], **pipes) as process:
        assert read_line(process.stdout, 10).startswith(b"status,")
        for pose, status in ((GOOD, b"ok,"), ("x", b"bad_line,"), (OTHER, b"ok,")):
            process.stdin.write(pose.encode() + b"\n")
            assert read_line(process.stdout, 10).startswith(status)
        process.stdin.close()
        assert process.wait(10) == 1


needs_dev_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")


@needs_dev_full
@pytest.mark.parametrize("options", [[], ["--header"]], ids=["poses", "header"])
def test_write_error(options: list[str]):
    with open("/dev/full", "wb") as full:
        result = subprocess.run(
            [PROGRAM, *options], input=GOOD.encode(), stdout=full, stderr=subprocess.PIPE
        )
    assert result.returncode == 2
    assert b"lift_stdin: cannot write output" in result.stderr


@needs_dev_full
@pytest.mark.parametrize("option", ["--help", "--version", "--list-models"])
def test_write_error_of_an_option_that_prints(option: str):
    with open("/dev/full", "wb") as full:
        result = subprocess.run([PROGRAM, option], stdout=full, stderr=subprocess.PIPE)
    assert result.returncode == 2


def test_read_error(tmp_path: Path):
    folder = os.open(tmp_path, os.O_RDONLY)
    result = subprocess.run([PROGRAM], stdin=folder, capture_output=True)
    os.close(folder)
    assert (result.returncode, result.stdout) == (2, b"")
    assert result.stderr.decode() == "lift_stdin: cannot read input\n"


# ---- Options ---------------------------------------------------------------------------------


def test_threshold():
    pose = WALK[0].copy()
    pose[RIGHT_ARM, 2] = 0.3
    pose[5, 2] = 0.31
    weak, without = f"{text(pose)}\n", lift(text(unseen(RIGHT_ARM)))
    assert lift(weak) == [ANSWER]
    assert lift(weak, "--threshold", "0.29") == [ANSWER]
    assert lift(weak, "--threshold", "0.3") == without
    assert lift(weak, "--threshold=0.3") == without
    assert statuses(lift(weak, "--threshold", "1")) == ["too_few_joints"]


def test_threshold_does_not_touch_28_numbers():
    assert lift(text(WALK[0, :, :2]), "--threshold", "2") == [ANSWER]


def test_negative_confidence_was_not_seen():
    pose = unseen(RIGHT_ARM)
    pose[RIGHT_ARM, 2] = -1
    assert lift(text(pose)) == lift(text(unseen(RIGHT_ARM)))


@pytest.mark.parametrize("value", ["", "x", "0.5x", "-1", "nan"])
def test_bad_threshold(value: str):
    result = run(GOOD, f"--threshold={value}")
    assert (result.returncode, result.stdout) == (2, b"")
    assert b"--threshold" in result.stderr


def models() -> list[str]:
    result = run("", "--list-models")
    assert (result.returncode, result.stderr) == (0, b"")
    return result.stdout.decode().split()


def test_every_listed_model_lifts():
    assert models()
    assert lift(GOOD, "--model", models()[0]) == [ANSWER]
    for model in models():
        assert statuses(lift(GOOD, "--model", model)) == ["ok"]
        assert lift(GOOD, f"--model={model}") == lift(GOOD, "--model", model)


@pytest.mark.parametrize("model", ["", "none", "fconn"])
def test_unknown_model_lists_the_known(model: str):
    result = run(GOOD, "--model", model)
    assert (result.returncode, result.stdout) == (2, b"")
    first, *rest = result.stderr.decode().splitlines()
    assert f"'{model}'" in first
    assert rest == models()


def test_help_names_every_option():
    result = run("", "--help")
    assert (result.returncode, result.stderr) == (0, b"")
    for word in ("--model", "--threshold", "--header", "--list-models", "--version", "bad_line"):
        assert word in result.stdout.decode()
    assert max(map(len, result.stdout.decode().splitlines())) <= 100


def test_version_is_the_headers():
    result = run("", "--version")
    assert result.returncode == 0
    assert VERSION in result.stdout.decode().split()


@pytest.mark.parametrize("option", ["--wrong", "--headers", "--header=1", "-x", "poses.csv", ""])
def test_unknown_option(option: str):
    result = run(GOOD, option)
    assert (result.returncode, result.stdout) == (2, b"")
    assert f"'{option}'" in result.stderr.decode()


@pytest.mark.parametrize("option", ["--model", "--threshold"])
def test_option_without_its_value(option: str):
    result = run(GOOD, option)
    assert (result.returncode, result.stdout) == (2, b"")
    assert f"{option} needs a value" in result.stderr.decode()


# ---- Anything at all -------------------------------------------------------------------------


def garbage(rng: random.Random) -> bytes:
    """A line of one of many kinds, without a newline."""
    kind = rng.randrange(6)
    if kind == 0:
        return rng.randbytes(rng.randrange(200)).replace(b"\n", b" ")
    if kind == 1:
        words = ["1", "-2.5", "nan", "inf", "1e38", "-1e-40", "0x1p3", "", "#", "\t", "ok", "\0"]
        return rng.choice([",", " "]).join(rng.choices(words, k=rng.randrange(50))).encode()
    if kind == 2:
        size = rng.choice([LINE_MAX - 1, LINE_MAX, LINE_MAX + 1, 3 * LINE_MAX])
        return rng.choice([GOOD.encode(), b"1,", b"x", b"\0"]).ljust(size)
    if kind == 3:
        scale = 10 ** rng.uniform(-40, 40)
        return ",".join(f"{rng.gauss(0, scale):g}" for _ in range(rng.choice([28, 42]))).encode()
    line = bytearray(GOOD.encode())
    for _ in range(rng.randrange(1, 6)):
        line[rng.randrange(len(line))] = rng.choice(b",.- e0123456789\t\r\0#x\xff")
    return bytes(line)


def test_5000_lines_of_garbage():
    rng = random.Random(1)
    lines = [garbage(rng) for _ in range(5000)]
    poses = [line for line in lines if not re.match(rb"[ \t\r]*(#|$)", line)]
    result = run(b"\n".join(lines) + b"\n")
    table = rows(result)
    assert result.returncode == 1
    assert len(table) == len(poses)
    assert set(statuses(table)) <= STATUSES
    for row in table:
        if row[0] == "ok":
            assert np.isfinite(numbers(row)).all()
        else:
            assert row[1:] == [""] * 44
    bad = statuses(table).count("bad_line")
    assert result.stderr.decode().endswith(f"lift_stdin: bad lines: {bad}\n")
    assert result.stderr.decode().count("lift_stdin: line ") == bad
