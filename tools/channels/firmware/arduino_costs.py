"""What the Arduino example costs on makers' boards: flash, RAM and milliseconds, as Markdown.

    run.py channels.firmware.arduino_costs             prints both tables
    run.py channels.firmware.arduino_costs --check     compares those of docs/arduino.md
    run.py channels.firmware.arduino_costs --update    writes them

Flash and RAM are those of the image that arduino-builder makes.  The milliseconds are about: the
instructions of docs/costs.md at 1 to 1.6 cycles each (reports/cycles.py says why).
"""

import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from channels.firmware.arduino import EXAMPLE
from channels.firmware.boards import build_by_arduino
from data.paths import DOCS, ROOT
from reports import markdown
from reports.command import Table, run_report
from reports.cycles import about
from reports.size import COSTS, parse
from reports.targets import TARGETS, run

PAGE = DOCS / "arduino.md"
CORES = ("cortex-m4f", "cortex-m0plus")
BOARDS = {  # core, MHz
    "Teensy 4.0, 4.1": ("Cortex-M7", 600),
    "Portenta H7, Giga R1": ("Cortex-M7", 480),
    "Pico 2 (RP2350)": ("Cortex-M33", 150),
    "Nano 33 BLE (nRF52840)": ("Cortex-M4F", 64),
    "Uno R4 (RA4M1)": ("Cortex-M4F", 48),
    "ESP32-C3": ("RV32IMC", 160),
    "Pico (RP2040)": ("Cortex-M0+", 133),
    "Zero, MKR, Nano 33 IoT (SAMD21)": ("Cortex-M0+", 48),
}
SECTION = r"^ \.(?:text|rodata|data\.rel\.ro)\S*\s+0x[0-9a-f]+\s+0x([0-9a-f]+) (\S+)$"
ARITHMETIC = re.compile(r"/lib(gcc|m)\.a\(")


def flash(image: Path) -> dict[str, int]:
    """Bytes of the library's code, of weights and of the compiler's arithmetic, by the linker's
    map beside the image."""
    text = image.with_suffix(".map").read_text("utf-8")
    found = {"code": 0, "weights": 0, "arithmetic": 0}
    for size, file in re.findall(SECTION, text.partition("Linker script and memory map")[2], re.M):
        if "/edmlift.a(models_" in file:
            found["weights"] += int(size, 16)
        elif "/edmlift.a(" in file:
            found["code"] += int(size, 16)
        elif ARITHMETIC.search(file):
            found["arithmetic"] += int(size, 16)
    return found


def memory(image: Path) -> int:
    """Bytes of the example's work memory and pose."""
    symbols = run("arm-none-eabi-nm", "--print-size", "--radix=d", image)
    return sum(int(size) for size in re.findall(r"^\d+ (\d+) b _ZL4(?:work|pose)$", symbols, re.M))


def frame(image: Path) -> int:
    """Bytes of stack that loop() takes itself."""
    (said,) = image.parent.glob("sketch/*.su")
    return int(re.search(r":void loop\(\)\t(\d+)\t", said.read_text("utf-8"))[1])


def memory_table(images: dict[str, Path]) -> str:
    """A row a core, by the image of the example for it."""
    heads = ["code", "weights", "float arithmetic", "RAM", "stack of `loop()`"]
    rows = {
        TARGETS[core].name: [*flash(image).values(), memory(image), frame(image)]
        for core, image in images.items()
    }
    return markdown.table("bytes", heads, rows, markdown.counted)


def milliseconds_table() -> str:
    """A row a board: of edml_lift() as in the example, and of edml_lift_q()."""
    costs = parse(markdown.read(COSTS, "costs"))
    lifts = {(c.core, c.variant): c.lift for c in costs if c.model == "direct"}
    rows = {}
    for board, (core, mhz) in BOARDS.items():
        spans = [about(lifts[core, variant], mhz) for variant in ("w16", "fixed")]
        rows[board] = [f"{core}, {mhz} MHz", *spans]
    return markdown.table("ms, about", ["core", "`edml_lift`", "`edml_lift_q`"], rows, left=2)


def tables() -> Iterator[Table]:
    """Both tables."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "libraries").mkdir()
        (folder / "libraries" / "edmlift").symlink_to(ROOT)
        images = {
            core: build_by_arduino(ROOT / EXAMPLE, folder / "libraries", core, folder / core)
            for core in CORES
        }
        yield Table(PAGE, "arduino_memory", memory_table(images))
    yield Table(PAGE, "arduino_milliseconds", milliseconds_table())


def main() -> int:
    return run_report("arduino_costs", __doc__, tables)


if __name__ == "__main__":
    sys.exit(main())
