"""The component for ESP-IDF: what `compote component pack` makes of idf_component.yml."""

import shutil
import tempfile
from pathlib import Path

import yaml

from channels.archives import write_tar
from channels.firmware.stand_ins import STAND_INS, Chip, Project, build_project, write_configuration
from channels.version import version
from data.paths import ROOT

CHIPS = (Chip("ESP32-C3", "rv32imc", 160), Chip("ESP32-P4", "rv32imafc", 360))
STACK = 3584  # bytes of the main task, where a project says nothing


def build(folder: Path) -> list[Path]:
    """edmlift-esp-idf-VERSION.tgz, whose files are those of a folder components/edmlift."""
    archive = folder / f"edmlift-esp-idf-{version()}.tgz"
    return [write_tar(archive, {path.relative_to(ROOT).as_posix(): path for path in files()})]


def files() -> list[Path]:
    """What idf_component.yml lists; it leaves out all else."""
    patterns = yaml.safe_load((ROOT / "idf_component.yml").read_text("utf-8"))["files"]["include"]
    found = {pattern: [p for p in ROOT.glob(pattern) if p.is_file()] for pattern in patterns}
    for pattern, paths in found.items():
        if not paths:
            raise ValueError(f"idf_component.yml: there is no {pattern}")
    return sorted(path for paths in found.values() for path in paths)


def unpack(archive: Path, folder: Path) -> Path:
    """The component, in a folder of its name, as a project has it."""
    component = folder / "components" / "edmlift"
    shutil.unpack_archive(archive, component)
    return component


def build_example(component: Path, folder: Path, chip: Chip) -> Project:
    """The component's example, built for a chip with what stands for ESP-IDF."""
    folder.mkdir(parents=True, exist_ok=True)
    sdkconfig = folder / "sdkconfig"
    write_configuration([component / "Kconfig"], "", sdkconfig)
    build_project(
        component / "examples" / "esp_idf", folder, chip, {"IDF_PATH": STAND_INS / "esp_idf"},
        f"-DSDKCONFIG={sdkconfig}", f"-DMAIN_TASK_STACK={STACK}",
    )  # fmt: skip
    return Project(folder, chip, "lib__idf_edmlift", STACK)


def check(archives: list[Path]) -> None:
    """Builds the example of an archive and runs it; ToolError where it prints no pose."""
    with tempfile.TemporaryDirectory() as name:
        component = unpack(archives[0], Path(name))
        build_example(component, Path(name, "build"), CHIPS[0]).last_line()
