"""What the repository says of itself is what its tools measure now."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

import edmlift
import evaluate
import export_weights
import marks
import size_report
from mocap import load_motion

DATA = Path(os.environ.get("EDMLIFT_DATA", ROOT.parent / "shared" / "data"))
README = ROOT / "README.md"


@pytest.mark.parametrize("form", ["f32", "q15", "q7"])
def test_the_header_is_made_of_the_weights_byte_for_byte(tmp_path, form):
    out = tmp_path / f"fconn_{form}.h"
    options = [] if form == "f32" else ["--quantise", form]
    assert export_weights.main([str(ROOT / "gen" / "fconn.npz"), *options, "--out", str(out)]) == 0
    assert out.read_bytes() == (ROOT / "gen" / f"fconn_{form}.h").read_bytes()


@pytest.mark.skipif(not (DATA / "cmu14_test.npz").exists(), reason="needs the test people")
def test_the_accuracy_is_the_readmes():
    figures = evaluate.evaluate(edmlift.Library(), load_motion(DATA / "cmu14_test.npz"))
    table = evaluate.markdown(evaluate.rounded(figures)).partition("\n\n")[0]
    assert marks.read(README, "accuracy").strip() == table
    noted = json.loads((ROOT / "gen" / "fconn.json").read_text())["metrics"]
    assert noted == {name: round(column["error"], 1) for name, column in figures.items()}


def test_the_cost_is_the_readmes():
    for tool in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if not shutil.which(tool):
            pytest.skip(f"needs {tool}")
    version = subprocess.run(
        ["arm-none-eabi-gcc", "-dumpversion"], capture_output=True, text=True, check=True
    ).stdout
    if not version.startswith("12.2"):
        pytest.skip(f"the figures are of gcc 12.2, this is {version}")
    rows = [size_report.measure(core) for core in size_report.CORES]
    size_report.compare(size_report.parse(marks.read(README, "size_report")), rows)
    assert marks.read(README, "summary").strip() == size_report.summary(rows)
    for _, code, _, work, stack, *_ in rows:
        assert work <= 4096 and stack <= 512 and code <= 16 * 1024


def test_a_wrong_figure_is_found():
    right = ["Cortex-M4F", 6000, 160000, 3800, 260, 100, 1000, 1000, 100, 100, 2300]
    size_report.compare([[*right]], [right])
    for n, value in ((1, 6001), (4, 264), (10, 2400)):
        wrong = [*right]
        wrong[n] = value
        with pytest.raises(size_report.Disagreement, match="written"):
            size_report.compare([wrong], [right])
    size_report.compare([[*right[:-1], 2310]], [right])  # instructions within 3 %
    with pytest.raises(size_report.Disagreement, match="number of cores"):
        size_report.compare([], [right])


def test_a_table_replaces_what_is_between_its_marks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- begin t -->\nold\n<!-- end t -->\nb\n")
    marks.write(page, "t", "| new |\n")
    assert page.read_text() == "a\n<!-- begin t -->\n| new |\n<!-- end t -->\nb\n"
    assert marks.read(page, "t") == "| new |\n"
    with pytest.raises(ValueError, match="begin u"):
        marks.read(page, "u")


def test_python_is_tidy():
    done = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "tools", "tests"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout


def test_no_machine_paths_or_dates_in_generated_files():
    for path in (ROOT / "gen").iterdir():
        head = path.read_bytes()[:2000]
        assert str(ROOT).encode() not in head and b"/home/" not in head
