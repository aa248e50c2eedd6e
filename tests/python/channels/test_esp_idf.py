"""The component for ESP-IDF: its archive, and its example on an emulated core."""

import sys
from pathlib import Path

import pytest
from builds import need, need_core
from idf_component_tools.file_tools import filtered_paths
from idf_component_tools.manager import ManifestManager, UploadMode
from rtos_support import DIRECT_BITS, check_page, pose_of
from support import ROOT

from channels.firmware import esp_idf
from channels.firmware.stand_ins import Chip, Project
from channels.version import version
from reports.targets import ToolError, run

pytestmark = pytest.mark.slow
COMPOTE = Path(sys.executable).with_name("compote")


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    (archive,) = esp_idf.build(tmp_path_factory.mktemp("archive"))
    return archive


@pytest.fixture(scope="module")
def component(archive: Path) -> Path:
    return esp_idf.unpack(archive, archive.parent)


@pytest.fixture(scope="module")
def projects(component: Path) -> list[Project]:
    """The example, built for each chip."""
    need("cmake")
    return [build(component, chip) for chip in esp_idf.CHIPS]


def build(component: Path, chip: Chip) -> Project:
    need_core(chip.target)
    return esp_idf.build_example(component, component.parent / chip.core, chip)


def test_the_archive_is_what_the_component_manager_would_upload(component: Path) -> None:
    manager = ManifestManager(component, "edmlift", upload_mode=UploadMode.component)
    manifest = manager.load()  # which validates it
    assert str(manifest.version) == version()
    run(COMPOTE, "manifest", "lint", component)  # which reads the example's as well
    packed = filtered_paths(component, include=manifest.include_set, exclude=manifest.exclude_set)
    inside = {path.relative_to(component) for path in component.rglob("*") if path.is_file()}
    assert {path.relative_to(component) for path in packed if path.is_file()} == inside


def test_the_archive_has_the_library_and_no_tests(component: Path) -> None:
    for folder in ("include", "lib"):
        ours = {path.relative_to(ROOT) for path in (ROOT / folder).rglob("*.[ch]")}
        theirs = {path.relative_to(component) for path in (component / folder).rglob("*.*")}
        assert theirs == ours
    names = {path.name for path in component.iterdir()}
    assert not names & {"tests", "tools", "pyproject.toml"}
    assert list(component.rglob("*.npz")) == []


def test_a_pattern_that_finds_nothing_is_told(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "idf_component.yml").write_text("files: {include: [LICENCE]}\n")
    monkeypatch.setattr(esp_idf, "ROOT", tmp_path)
    with pytest.raises(ValueError, match="idf_component.yml: there is no LICENCE"):
        esp_idf.build(tmp_path)


def test_the_example_prints_the_pose(projects: list[Project]) -> None:
    pose = pose_of(ROOT / "examples" / "esp_idf" / "main" / "app_main.c")
    for project in projects:
        assert project.prints.startswith(pose)


def test_the_example_leaves_half_of_the_main_task_its_stack(projects: list[Project]) -> None:
    """For what ESP-IDF's own printf takes more than picolibc's."""
    for project in projects:
        assert project.last_line()[1] < esp_idf.STACK / 2


def test_a_chip_gives_the_same_bits(projects: list[Project]) -> None:
    for project in projects:
        assert project.bits() == DIRECT_BITS


@pytest.mark.claims("docs/esp-idf.md", "esp_idf_prints", "esp_idf_costs")
def test_the_page_has_what_it_prints_and_takes(projects: list[Project]) -> None:
    check_page("esp_idf", projects)


def test_a_component_in_a_folder_of_another_name_is_told(component: Path, tmp_path: Path) -> None:
    """As ESP-IDF tells: a component is called as its folder is."""
    renamed = tmp_path / "edmlift-main"
    renamed.symlink_to(component)
    with pytest.raises(ToolError, match="edmlift"):
        esp_idf.build_example(renamed, tmp_path / "build", esp_idf.CHIPS[0])
