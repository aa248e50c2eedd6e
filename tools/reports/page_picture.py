"""The picture of a page of `edmlift view` in the docs, taken by Chromium."""

import argparse
import sys
import tempfile
from pathlib import Path

from PIL import Image

from reports.browser import Page, find_browser

COLOURS = 128
SIZE = (1280, 800)


def take(page_path: Path, frame: int, out: Path, program: str) -> None:
    """Writes a PNG of a page of `edmlift view` at a frame."""
    with Page(program, *SIZE) as page:
        page.scheme("light")
        page.open(page_path, f"#frame={frame}")
        page.until("Boolean(window.edmliftView)")
        save(page, out)


def save(page: Page, out: Path) -> None:
    """Writes what a page shows as PNG, with a palette."""
    with tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "page.png"
        page.screenshot(raw)
        with Image.open(raw) as picture:
            few = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
        few.save(out, optimize=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path, help="what `edmlift view` wrote")
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True, help="picture: .png")
    options = parser.parse_args()
    program = find_browser()
    if program is None:
        print("no Chromium (Debian: chromium)", file=sys.stderr)
        return 1
    take(options.page, options.frame, options.out, program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
