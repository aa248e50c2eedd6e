"""The widest network that work memory holds is as defined, by the kernels of each processor."""

from pathlib import Path

import pytest
from builds import run_firmware

from reports.targets import LIB, ROOT, TARGETS

PROGRAM = ROOT / "tests" / "targets" / "widest.c"
LINKED = [
    *(LIB / "network").glob("equivariant_w*.c"),
    LIB / "network" / "model.c",
    *(LIB / "number").glob("*.c"),
]


@pytest.mark.slow
@pytest.mark.parametrize("core", ["cortex-m3", "cortex-m4f", "cortex-m55", "rv32imc"])
def test_the_widest_network_is_as_defined(core: str, tmp_path: Path) -> None:
    printed = run_firmware(PROGRAM, TARGETS[core], tmp_path, LINKED)
    assert printed == "w16 768 of 768, w8 768 of 768\n"
