"""The module for Zephyr: its manifest, and the sample on emulated cores."""

import re

import pytest
import yaml
from builds import need, need_core
from rtos_support import DIRECT_BITS, check_page, pose_of
from support import ROOT

from channels.firmware import zephyr
from channels.firmware.stand_ins import Chip, Project
from reports.targets import run

pytestmark = pytest.mark.slow
MAIN = zephyr.SAMPLE / "src" / "main.c"


@pytest.fixture(scope="module")
def projects(tmp_path_factory: pytest.TempPathFactory) -> list[Project]:
    """The sample, built for each chip."""
    need("cmake")

    def build(chip: Chip) -> Project:
        need_core(chip.target)
        return zephyr.build_sample(tmp_path_factory.mktemp(chip.core), chip)

    return [build(chip) for chip in zephyr.CHIPS]


def test_the_manifest_names_what_is_there() -> None:
    manifest = yaml.safe_load((ROOT / "zephyr" / "module.yml").read_text("utf-8"))
    assert (ROOT / manifest["build"]["cmake"] / "CMakeLists.txt").is_file()
    assert (ROOT / manifest["build"]["kconfig"]).is_file()
    assert [ROOT / sample for sample in manifest["samples"]] == [zephyr.SAMPLE]
    assert manifest["name"] == "edmlift"


def test_the_sample_prints_the_pose_and_what_its_harness_looks_for(
    projects: list[Project],
) -> None:
    sample = yaml.safe_load((zephyr.SAMPLE / "sample.yaml").read_text("utf-8"))
    harness = sample["common"]["harness_config"]
    assert harness["type"] == "multi_line" and harness["ordered"]
    for project in projects:
        assert project.prints.startswith(pose_of(MAIN))
        assert re.search(".*".join(harness["regex"]), project.prints, re.DOTALL)


def test_a_core_gives_the_same_bits(projects: list[Project]) -> None:
    for project in projects:
        assert project.bits() == DIRECT_BITS


def test_the_fpu_is_used_where_there_is_one(projects: list[Project]) -> None:
    """Soft floats are functions of the compiler's that a core with an FPU does without."""
    with_fpu, without = (
        set(run(f"{p.chip.target.system.cross}nm", p.folder / "app.elf").split()) for p in projects
    )
    soft = {"__aeabi_fmul", "__aeabi_fadd", "__aeabi_fdiv"}
    assert soft <= without and not soft & with_fpu
    assert "CONFIG_FPU=y" in (projects[0].folder / "dotconfig").read_text("utf-8")


@pytest.mark.claims("docs/zephyr.md", "zephyr_prints", "zephyr_costs")
def test_the_page_has_what_it_prints_and_takes(projects: list[Project]) -> None:
    check_page("zephyr", projects)
