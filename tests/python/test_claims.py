"""What the repository says of itself is what its tools measure now."""

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from builds import need_core
from conftest import ROOT

import count_operations
import evaluate
import export_weights
import marks
import rivals
import size_report
import train_rivals
from edmlift import library as edmlift
from firmware import TARGETS, compile_library, run
from mocap import load_motion

DATA = Path(os.environ.get("EDMLIFT_DATA", ROOT.parent / "shared" / "data"))
ACCURACY, LOG = (ROOT / "docs" / name for name in ("accuracy.md", "accuracy-log.md"))


@pytest.mark.parametrize("model", ["fconn_f32", "fconn_q15", "fconn_q7", "fconv_f32", "fconv_q7"])
def test_the_header_is_made_of_the_weights_byte_for_byte(tmp_path, model):
    name, form = model.split("_")
    out = tmp_path / f"{model}.h"
    options = [] if form == "f32" else ["--quantise", form]
    weights = str(ROOT / "gen" / f"{name}.npz")
    assert export_weights.main([weights, *options, "--out", str(out)]) == 0
    assert out.read_bytes() == (ROOT / "gen" / f"{model}.h").read_bytes()


@pytest.fixture(scope="module")
def people():
    if not (DATA / "cmu14_test.npz").exists():
        pytest.skip("needs the test people")
    return load_motion(DATA / "cmu14_test.npz")


@pytest.fixture(scope="module")
def figures(people):
    return evaluate.rounded(evaluate.evaluate(edmlift.Library(), people))


@pytest.fixture(scope="module")
def forms(people):
    return evaluate.rounded(evaluate.evaluate_forms("fconn", people))


def test_the_accuracy_is_that_of_the_pages(figures, forms):
    table, joints = evaluate.markdown(figures).split("\n\n")
    assert marks.read(ACCURACY, "accuracy").strip() == table
    assert marks.read(LOG, "joints") == joints
    assert marks.read(ACCURACY, "forms") == evaluate.forms_markdown(figures, forms)
    manifest = json.loads((ROOT / "gen" / "fconn.json").read_text())
    assert manifest["metrics"] == evaluate.noted(figures)
    for form in ("q15", "q7"):
        assert manifest[f"metrics_{form}"] == evaluate.noted(forms[form])


def test_the_library_beats_the_rivals_of_the_table(people, figures):
    if not (DATA / "cmu14_train.npz").exists():
        pytest.skip("needs the training people")
    train = load_motion(DATA / "cmu14_train.npz")
    others = evaluate.evaluate_rivals(train, people)
    assert marks.read(LOG, "rivals") == evaluate.rivals_markdown(figures, others)
    for column in figures:  # those that need no training: of the others the table tells
        best = min(others[name][column]["error"] for name in evaluate.RIVALS)
        assert figures[column]["error"] < best, column


def test_the_trials_are_those_of_the_json():
    trials = json.loads(rivals.TRAINED.read_text())["trials"]
    assert list(trials) == list(train_rivals.TRIALS)
    assert marks.read(LOG, "trials") == train_rivals.tried_markdown(trials)


def test_the_trained_rivals_are_of_the_recipes():
    for name, entry in json.loads(rivals.TRAINED.read_text()).get("rivals", {}).items():
        recipe = train_rivals.RIVALS[name]
        assert entry["recipe"] == json.loads(json.dumps(recipe.noted(0))), name


@pytest.mark.parametrize(
    ("form", "most"), [("q15", 0.2), ("q7", 1.5), ("fixed", 0.2), ("fixed_q7", 1.5)]
)
def test_quantised_networks_lose_little_in_any_column(figures, forms, form, most):
    for name, column in forms[form].items():
        assert column["error"] <= figures[name]["error"] + most, name
        assert column["refused"] == 0, name


def test_fconv_in_8_bits_loses_little_in_any_column():
    """By its manifest: measuring it takes ten minutes."""
    manifest = json.loads((ROOT / "gen" / "fconv.json").read_text())
    for column, error in manifest["metrics"].items():
        assert manifest["metrics_q7"][column] <= error + 1.5, column


def test_fixed_point_is_the_float_lift(forms):
    for name, column in forms["fixed"].items():
        assert column["moved"] <= 0.5 and column["moved_999"] <= 3, name
        assert column["mirrored"] <= 2, name  # of 6,453; measured 0


def test_operations_are_those_of_the_table_and_none_overflows(people):
    counts = count_operations.count(people)
    assert counts["lifted"] > 80_000 and counts["overflows"] == counts["differences"] == 0
    table = marks.read(ROOT / "docs" / "no-fpu.md", "operations")
    assert table == count_operations.markdown(counts)


@pytest.fixture(scope="module")
def costs() -> list[size_report.Cost]:
    """Of every core and variant, measured now."""
    for target in TARGETS.values():
        need_core(target)
        version = run(f"{target.system.cross}gcc", "-dumpversion")
        if not version.startswith("12.2"):
            pytest.skip(f"the figures are of gcc 12.2, this is {version}")
    return size_report.measure()


def test_the_costs_are_those_of_the_tables(costs):
    size_report.check(costs)
    size_report.check_fconv(size_report.measure_fconv())


LIMITS = [  # bytes of code, instructions a lift
    ("Cortex-M4F", "f32", 16384, 150_000),
    ("Cortex-M4F", "q15", 16384, 150_000),
    ("Cortex-M3", "fixed", 16384, 700_000),
    ("Cortex-M0+", "fixed", 20480, 1_500_000),
]


@pytest.mark.parametrize("core, variant, code, lift", LIMITS)
def test_a_lift_is_cheap(costs, core, variant, code, lift):
    (cost,) = [cost for cost in costs if (cost.core, cost.variant) == (core, variant)]
    assert cost.code <= code and cost.lift <= lift


def test_a_lift_needs_little_memory(costs):
    assert max(cost.work for cost in costs) <= 4096
    assert max(cost.stack for cost in costs) <= 512


def test_all_of_the_flash_is_told(tmp_path):
    """What the linker keeps is code or weights, but for main() and alignment."""
    target = TARGETS["cortex-m0plus"]
    need_core(target)
    library = compile_library(target, "-Os", tmp_path)
    options = size_report.VARIANTS["fixed"]
    cost = size_report.measure_variant(target, "fixed", options, library, tmp_path)
    listing = run(f"{target.system.cross}size", tmp_path / "smallest.elf").splitlines()
    flash = int(listing[1].split()[0])
    assert 0 <= flash - cost.code - cost.weights <= 200
    assert 0 < cost.helpers < cost.code


def test_a_wrong_figure_is_found():
    right = size_report.Cost(
        "Cortex-M3", "f32", code=6000, helpers=40, weights=160000, work=3800, stack=260,
        place_stack=900, edm=100, guess=110, net=1000, mds=1000, mirror=100, orient=100, blend=100,
        lift=2400, place=1500,
    )  # fmt: skip
    size_report.compare([right], [right])
    for wrong in ({"code": 6001}, {"stack": 264}, {"lift": 2500}, {"variant": "q7"}):
        with pytest.raises(size_report.Disagreement, match="written"):
            size_report.compare([dataclasses.replace(right, **wrong)], [right])
    size_report.compare([dataclasses.replace(right, lift=2410)], [right])  # within 3 %
    with pytest.raises(size_report.Disagreement, match="number of rows"):
        size_report.compare([], [right])


def test_a_table_is_read_as_it_was_written():
    rows = size_report.parse(marks.read(size_report.COSTS, "costs"))
    assert len(rows) == len(TARGETS) * len(size_report.VARIANTS)
    assert size_report.parse(size_report.full_table(rows)) == rows


def test_a_table_replaces_what_is_between_its_marks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- begin t -->\nold\n<!-- end t -->\nb\n")
    marks.write(page, "t", "| new |\n")
    assert page.read_text() == "a\n<!-- begin t -->\n| new |\n<!-- end t -->\nb\n"
    assert marks.read(page, "t") == "| new |\n"
    with pytest.raises(ValueError, match="begin u"):
        marks.read(page, "u")
    marks.write_those(page, {"u": "| other |", "t": "| newer |"})
    assert marks.read(page, "t") == "| newer |\n" and "other" not in page.read_text()
    with pytest.raises(ValueError, match="NAME of u, v"):
        marks.write_those(page, {"u": "", "v": ""})


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
