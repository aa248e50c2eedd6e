"""The picture of the page that lifts in the browser, for the docs, taken by Chromium."""

import argparse
import sys
import tempfile
import threading
from pathlib import Path

from channels.browser.npm import package_files
from channels.browser.page import build_page
from channels.browser.static_server import make_server
from reports.browser import Page, find_browser
from reports.page_picture import SIZE, save

SAMPLE = "a stance"


def take(folder: Path, out: Path, program: str) -> None:
    """Writes a PNG of the page in a folder, with a skeleton to drag."""
    server = make_server(folder, 0)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with Page(program, *SIZE) as page:
        page.scheme("light")
        page.visit(f"http://localhost:{server.server_address[1]}/")
        page.until("window.edmliftPage?.state().status === 'ok'")
        page.evaluate(
            f"(e => {{ e.value = '{SAMPLE}'; e.dispatchEvent(new Event('change')); }})"
            "(document.querySelector('#sample'))"
        )
        page.until("!document.querySelector('#offline').hidden")
        page.evaluate("new Promise(done => setTimeout(done, 1000))")  # the numbers follow
        save(page, out)
    server.shutdown()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="picture: .png")
    out = parser.parse_args().out
    program = find_browser()
    if program is None:
        print("no Chromium (Debian: chromium)", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "lift").mkdir()
        take(build_page(folder / "page", package_files(folder / "lift")), out, program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
