"""Kconfig, of ESP-IDF and Zephyr: what it offers is what there is, with a help text each."""

import re
from pathlib import Path

import kconfiglib
import pytest
from support import ROOT

from channels.firmware.stand_ins import MODELS, STAND_INS, write_configuration
from data.paths import DOCS, LIB
from reports import markdown
from reports.size import parse
from reports.targets import SOURCES, ToolError, run

PARTS = {"angles", "body", "camera", "many", "video"}
OPTIONAL = {source.stem for source in (LIB / "optional").glob("*.c")}


@pytest.fixture(scope="module")
def kconfig() -> kconfiglib.Kconfig:
    return kconfiglib.Kconfig(str(ROOT / "Kconfig"), warn_to_stderr=False)


@pytest.fixture(scope="module")
def zephyr(tmp_path_factory: pytest.TempPathFactory) -> kconfiglib.Kconfig:
    top = tmp_path_factory.mktemp("kconfig") / "Kconfig"
    files = [STAND_INS / "zephyr" / "Kconfig", ROOT / "zephyr" / "Kconfig"]
    top.write_text("".join(f'source "{file}"\n' for file in files), "utf-8")
    return kconfiglib.Kconfig(str(top), warn_to_stderr=False)


def names(kconfig: kconfiglib.Kconfig) -> set[str]:
    """The symbols below CONFIG_EDMLIFT, in lower case."""
    symbols = (symbol.name for symbol in kconfig.unique_defined_syms)
    return {name.removeprefix("EDMLIFT_").lower() for name in symbols if "EDMLIFT_" in name}


def test_it_offers_the_models_and_the_parts(kconfig: kconfiglib.Kconfig) -> None:
    assert names(kconfig) == MODELS | PARTS
    assert {header.stem for header in (ROOT / "include" / "edmlift").glob("*.h")} >= PARTS


def test_both_systems_have_the_same_and_no_warning(
    kconfig: kconfiglib.Kconfig, zephyr: kconfiglib.Kconfig
) -> None:
    assert names(zephyr) == names(kconfig)
    assert kconfig.warnings == zephyr.warnings == []


def test_every_symbol_has_a_prompt_and_a_help_text(zephyr: kconfiglib.Kconfig) -> None:
    symbols = [s for s in zephyr.unique_defined_syms if s.name.startswith("EDMLIFT")]
    assert len(symbols) == 1 + len(MODELS | PARTS)
    for symbol in symbols:
        (node,) = symbol.nodes
        assert node.prompt and len(node.help) > 40, symbol.name


def test_all_but_the_largest_models_are_compiled_by_default(kconfig: kconfiglib.Kconfig) -> None:
    off = {s.name for s in kconfig.unique_defined_syms if s.str_value != "y"}
    assert off == {"EDMLIFT_FCONV_F32", "EDMLIFT_FCONV_W8"}


def test_without_the_camera_there_is_no_array_of_people(kconfig: kconfiglib.Kconfig) -> None:
    """Because it calls the camera's lift."""
    kconfig.syms["EDMLIFT_CAMERA"].set_value("n")
    assert kconfig.syms["EDMLIFT_MANY"].str_value == "n"
    kconfig.unset_values()


def test_the_flash_of_a_model_is_that_of_the_costs(kconfig: kconfiglib.Kconfig) -> None:
    costs = parse(markdown.read(DOCS / "costs.md", "costs"))
    weights = {f"{cost.model}_{cost.variant}": cost.weights for cost in costs}
    for model in MODELS - {"fconv_f32", "fconv_w8"}:
        text = re.sub(r"\s+", " ", kconfig.syms[f"EDMLIFT_{model.upper()}"].nodes[0].help)
        assert f"{weights[model] / 1000:.0f} KB of flash" in text, model


def test_zephyr_switches_the_fpu_on_where_there_is_one(zephyr: kconfiglib.Kconfig) -> None:
    symbols = zephyr.syms
    symbols["EDMLIFT"].set_value("y")
    assert symbols["FPU"].str_value == "n" and symbols["REQUIRES_FULL_LIBC"].str_value == "y"
    symbols["CPU_HAS_FPU"].set_value("y")
    assert symbols["FPU"].str_value == "y"
    symbols["FPU"].set_value("n")
    assert symbols["FPU"].str_value == "n"
    zephyr.unset_values()


def test_a_setting_that_is_misspelt_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ToolError, match="EDMLIFT_DIRECT_W4"):
        write_configuration([ROOT / "Kconfig"], "CONFIG_EDMLIFT_DIRECT_W4=y\n", tmp_path / "x")


# ---- Sources -------------------------------------------------------------------------------------


def chosen(folder: Path, *switched_on: str) -> list[Path]:
    """The sources that these settings choose, such as "direct_w16" or "camera"."""
    script, out = folder / "sources.cmake", folder / "sources.txt"
    script.write_text(
        f'include({ROOT}/cmake/EdmliftKconfig.cmake)\nfile(WRITE {out} "${{edmlift_sources}}")\n'
    )
    settings = [f"-DCONFIG_EDMLIFT_{name.upper()}=y" for name in switched_on]
    run("cmake", *settings, "-P", script)
    return sorted(map(Path, out.read_text("utf-8").split(";")))


def test_with_everything_all_of_the_library_is_compiled(tmp_path: Path) -> None:
    assert chosen(tmp_path, *MODELS, *PARTS) == SOURCES


def test_a_model_adds_its_file(tmp_path: Path) -> None:
    least = [source for source in SOURCES if source.parent.name not in ("models", "optional")]
    assert chosen(tmp_path) == least
    model = LIB / "models" / "direct_w16.c"
    assert chosen(tmp_path, "direct_w16") == sorted([*least, model])


def test_each_file_belongs_to_one_part(tmp_path: Path) -> None:
    files = {
        part: {s.stem for s in chosen(tmp_path, part) if s.parent.name == "optional"}
        for part in PARTS
    }
    assert sorted(name for part in files.values() for name in part) == sorted(OPTIONAL)
    assert files["many"] == {"many_f32", "many_q"} and "uncertainty" in files["body"]
