"""What the repository says of itself is what its tools measure now."""

import dataclasses
import json
import subprocess
import sys

import pytest
from builds import need_core
from support import ROOT, TEST, TRAIN, need_motion

from data.mocap import load_motion
from evaluation import accuracy, baselines
from evaluation import forms as number_forms
from evaluation.measures import evaluate, rounded
from experiments import rivals
from export import cli
from reports import markdown, operations, size
from reports.targets import TARGETS, compile_library, run

pytestmark = pytest.mark.xdist_group("claims")  # the fixtures are measured once

ACCURACY, LOG = (ROOT / "docs" / name for name in ("accuracy.md", "accuracy-log.md"))


@pytest.mark.parametrize("model", ["fconn_f32", "fconn_w16", "fconn_w8", "fconv_f32", "fconv_w8"])
def test_the_header_is_made_of_the_weights_byte_for_byte(tmp_path, model):
    name, form = model.split("_")
    out = tmp_path / f"{model}.h"
    options = [] if form == "f32" else ["--quantise", form]
    weights = str(ROOT / "gen" / f"{name}.npz")
    assert cli.main([weights, *options, "--out", str(out)]) == 0
    assert out.read_bytes() == (ROOT / "gen" / f"{model}.h").read_bytes()


@pytest.fixture(scope="module")
def people():
    return load_motion(need_motion(TEST))


@pytest.fixture(scope="module")
def figures(people, library):
    return rounded(evaluate(library, people))


@pytest.fixture(scope="module")
def forms(people, library):
    return rounded(number_forms.evaluate_forms("fconn", people))


def test_the_accuracy_is_that_of_the_pages(figures, forms):
    assert markdown.read(ACCURACY, "accuracy") == accuracy.means_table(figures)
    assert markdown.read(LOG, "joints") == accuracy.joints_table(figures)
    assert markdown.read(ACCURACY, "forms") == number_forms.report(figures, forms)
    manifest = json.loads((ROOT / "gen" / "fconn.json").read_text())
    assert manifest["metrics"] == accuracy.column_errors(figures)
    for form in ("w16", "w8"):
        assert manifest[f"metrics_{form}"] == accuracy.column_errors(forms[form])


def test_the_library_beats_the_rivals_of_the_table(people, figures):
    train = load_motion(need_motion(TRAIN))
    others = accuracy.evaluate_rivals(train, people)
    assert markdown.read(LOG, "rivals") == accuracy.rivals_table(figures, others)
    for column in figures:  # those that need no training; the table tells of the others
        best = min(others[name][column]["error"] for name in accuracy.RIVALS)
        assert figures[column]["error"] < best, column


def test_the_trials_are_those_of_the_json():
    trials = json.loads(baselines.TRAINED.read_text())["trials"]
    assert list(trials) == list(rivals.TRIALS)
    assert markdown.read(LOG, "trials") == rivals.trials_table(trials)


def test_the_trained_rivals_are_of_the_recipes():
    for name, entry in json.loads(baselines.TRAINED.read_text()).get("rivals", {}).items():
        recipe = rivals.RIVALS[name]
        assert entry["recipe"] == json.loads(json.dumps(recipe.recorded(0))), name


@pytest.mark.parametrize(
    ("form", "most"), [("w16", 0.2), ("w8", 1.5), ("fixed", 0.2), ("fixed_w8", 1.5)]
)
def test_quantised_networks_lose_little_in_any_column(figures, forms, form, most):
    for name, column in forms[form].items():
        assert column["error"] <= figures[name]["error"] + most, name
        assert column["refused"] == 0, name


def test_fconv_in_8_bits_loses_little_in_any_column():
    """By its manifest: measuring it takes ten minutes."""
    manifest = json.loads((ROOT / "gen" / "fconv.json").read_text())
    for column, error in manifest["metrics"].items():
        assert manifest["metrics_w8"][column] <= error + 1.5, column


def test_fixed_point_is_the_float_lift(forms):
    for name, column in forms["fixed"].items():
        assert column["moved"] <= 0.5 and column["moved_999"] <= 3, name
        assert column["mirrored"] <= 2, name  # of 6,453; measured 0


def test_operations_are_those_of_the_table_and_none_overflows(people):
    counts = operations.count(people)
    assert counts["lifted"] > 80_000 and counts["overflows"] == counts["differences"] == 0
    table = markdown.read(ROOT / "docs" / "no-fpu.md", "operations")
    assert table == operations.report(counts)


@pytest.fixture(scope="module")
def costs() -> list[size.Cost]:
    """Of every core and variant, measured now."""
    for target in TARGETS.values():
        need_core(target)
        version = run(f"{target.system.cross}gcc", "-dumpversion")
        if not version.startswith("12.2"):
            pytest.skip(f"the figures are of gcc 12.2, this is {version}")
    return size.measure()


def test_the_costs_are_those_of_the_tables(costs):
    size.check(costs)
    size.check_fconv(size.measure_fconv())


LIMITS = [  # bytes of code, instructions a lift
    ("Cortex-M4F", "f32", 16384, 150_000),
    ("Cortex-M4F", "w16", 16384, 150_000),
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
    options = size.VARIANTS["fixed"]
    cost = size.measure_variant(target, "fixed", options, library, tmp_path)
    listing = run(f"{target.system.cross}size", tmp_path / "smallest.elf").splitlines()
    flash = int(listing[1].split()[0])
    assert 0 <= flash - cost.code - cost.weights <= 200
    assert 0 < cost.helpers < cost.code


def test_a_wrong_figure_is_found():
    right = size.Cost(
        "Cortex-M3", "f32", code=6000, helpers=40, weights=160000, work=3800, stack=260,
        place_stack=900, edm=100, impute=110, predict=1000, mds=1000, mirror=100, orient=100,
        fuse=100, lift=2400, place=1500,
    )  # fmt: skip
    size.compare([right], [right])
    for wrong in ({"code": 6001}, {"stack": 264}, {"lift": 2500}, {"variant": "w8"}):
        with pytest.raises(size.Disagreement, match="written"):
            size.compare([dataclasses.replace(right, **wrong)], [right])
    size.compare([dataclasses.replace(right, lift=2410)], [right])  # within 3 %
    with pytest.raises(size.Disagreement, match="number of rows"):
        size.compare([], [right])


def test_a_table_is_read_as_it_was_written():
    rows = size.parse(markdown.read(size.COSTS, "costs"))
    assert len(rows) == len(TARGETS) * len(size.VARIANTS)
    assert size.parse(size.full_table(rows)) == rows


def test_a_table_replaces_what_is_between_its_marks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- begin t -->\nold\n<!-- end t -->\nb\n")
    markdown.write(page, "t", "| new |\n")
    assert page.read_text() == "a\n<!-- begin t -->\n| new |\n<!-- end t -->\nb\n"
    assert markdown.read(page, "t") == "| new |\n"
    with pytest.raises(ValueError, match="begin u"):
        markdown.read(page, "u")
    markdown.write_those(page, {"u": "| other |", "t": "| newer |"})
    assert markdown.read(page, "t") == "| newer |\n" and "other" not in page.read_text()
    with pytest.raises(ValueError, match="NAME of u, v"):
        markdown.write_those(page, {"u": "", "v": ""})


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
