"""The module for Zephyr, of which a release has no file: west takes it from the repository."""

import re
from pathlib import Path

from channels.firmware.stand_ins import STAND_INS, Chip, Project, build_project, write_configuration
from data.paths import ROOT

CHIPS = (Chip("nRF52840", "cortex-m4f", 64), Chip("STM32F103", "cortex-m3", 72))
SAMPLE = ROOT / "examples" / "zephyr"
STAND_IN = STAND_INS / "zephyr"


def build_sample(folder: Path, chip: Chip) -> Project:
    """The sample, built for a Cortex-M with what stands for Zephyr."""
    folder.mkdir(parents=True, exist_ok=True)
    has_fpu = any(flag.startswith("-mfpu=") for flag in chip.target.flags)
    settings = (SAMPLE / "prj.conf").read_text("utf-8")
    settings += f"CONFIG_CPU_HAS_FPU={'y' if has_fpu else 'n'}\n"
    dotconfig = folder / "dotconfig"
    write_configuration([STAND_IN / "Kconfig", ROOT / "zephyr" / "Kconfig"], settings, dotconfig)
    build_project(SAMPLE, folder, chip, {"ZEPHYR_BASE": STAND_IN}, f"-DDOTCONFIG={dotconfig}")
    stack = re.search(r"CONFIG_MAIN_STACK_SIZE=(\d+)", dotconfig.read_text("utf-8"))[1]
    return Project(folder, chip, "libedmlift", int(stack))
