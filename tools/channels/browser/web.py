"""Serves the page that lifts in the browser, or writes it into a folder; `tools/web` calls it.

Everything is made in build/web: the lift, the detectors' packages, and the page.
"""

import argparse
import shutil
import sys
import webbrowser
from collections.abc import Callable, Iterator
from pathlib import Path
from time import monotonic

from channels.browser.detectors import DETECTORS, Detector, packages_of
from channels.browser.npm import package_files
from channels.browser.npm_packages import install, is_there
from channels.browser.page import build_page, loaded_bytes
from channels.browser.static_server import Server, make_server
from data.paths import ROOT
from reports.targets import ToolError

BUILD = ROOT / "build" / "web"
PORT = 8000
SOURCES = ("include", "lib", "gen", "tools/npm", "tools/channels")  # of the lift


def step(text: str, action: Callable[[], object]) -> None:
    """Does something that takes a while; one line of output."""
    print(f"{text:<52}", end="", flush=True)
    start = monotonic()
    try:
        action()
    except BaseException:
        print("failed", flush=True)
        raise
    print(f"{monotonic() - start:4.0f} s", flush=True)


def lift_files() -> list[Path]:
    """The files of the npm package, built if they are older than what they are made of."""
    folder, stamp = BUILD / "lift", BUILD / "lift" / "built"
    newest = max(path.stat().st_mtime for path in _sources())
    if not stamp.exists() or stamp.stat().st_mtime < newest:
        folder.mkdir(parents=True, exist_ok=True)
        files: list[Path] = []
        step("Building the lift", lambda: files.extend(package_files(folder)))
        stamp.write_text("\n".join(map(str, files)), "utf-8")
    return [Path(line) for line in stamp.read_text("utf-8").splitlines()]


def _sources() -> Iterator[Path]:
    for folder in SOURCES:
        yield from (path for path in (ROOT / folder).rglob("*") if path.suffix != ".pyc")


def need_npm() -> None:
    """ToolError where npm is missing."""
    if shutil.which("npm") is None:
        raise ToolError(
            "npm is missing, which downloads the detectors. Install it (Debian: npm; others: "
            "nodejs.org), or say --no-detector: the page then has joints to drag, but neither "
            "camera nor video"
        )


def install_detectors(wanted: dict[str, Detector], folder: Path) -> None:
    """Downloads the packages that are not there yet."""
    packages = packages_of(wanted.values())
    missing = [package for package in packages if not is_there(package, folder)]
    if missing:
        need_npm()
    try:
        for package in missing:
            text = f"Downloading {package.full_name} ({package.megabytes} MB)"
            step(text, lambda package=package: install(package, folder))
    except ToolError as error:
        raise ToolError(f"{error}\nThe page works without: --no-detector") from None


def make_page(wanted: dict[str, Detector], folder: Path) -> Path:
    """The page with these detectors."""
    packages = BUILD / "packages"
    install_detectors(wanted, packages)
    return build_page(folder, lift_files(), wanted, packages)


def sizes_text(page: Path) -> str:
    zipped, plain = (count / 1000 for count in loaded_bytes(page))
    return f"{zipped:.0f} KB to load (gzip), {plain:.0f} KB unpacked, detectors apart"


def open_server(port: int) -> Server:
    """The server of the page; ToolError where the port cannot be used."""
    try:
        return make_server(BUILD / "page", port)
    except OSError as error:
        said = f"port {port} cannot be used ({error.strerror}): say another --port"
        raise ToolError(said) from None


def serve(server: Server, browser: bool) -> None:
    """Serves until it is interrupted."""
    address = f"http://localhost:{server.server_address[1]}"
    print(f"\nThe page is at {address}  (Ctrl-C stops it)", flush=True)
    if browser:
        webbrowser.open(address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        print()


def read_options(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="tools/web", description=__doc__.partition(";")[0] + ".")
    parser.add_argument("--port", type=int, default=PORT, help=f"default {PORT}; 0: any free one")
    parser.add_argument("--open", action="store_true", help="opens it in a browser as well")
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--detectors", metavar="NAME,...", default=",".join(DETECTORS),
        help=f"which are installed; default: all, {', '.join(DETECTORS)}",
    )  # fmt: skip
    which.add_argument(
        "--no-detector", dest="detectors", action="store_const", const="",
        help="joints to drag alone: no camera, no video, no npm",
    )  # fmt: skip
    parser.add_argument(
        "--export", type=Path, metavar="DIR",
        help="writes the page into a folder, which any web server can serve, and ends",
    )  # fmt: skip
    options = parser.parse_args(arguments)
    names = [name for name in options.detectors.split(",") if name]
    if unknown := set(names) - set(DETECTORS):
        known = ", ".join(DETECTORS)
        parser.error(f"no detector {', '.join(sorted(unknown))}; there are {known}")
    if not 0 <= options.port <= 65535:
        parser.error(f"a port is 0 to 65535, not {options.port}")
    options.detectors = {name: DETECTORS[name] for name in names}
    return options


def export(wanted: dict[str, Detector], folder: Path) -> None:
    """Writes the page into a folder of the user's."""
    if folder.exists() and not folder.is_dir():
        raise ToolError(f"{folder} is a file: name a new folder, or an older page")
    if folder.exists() and any(folder.iterdir()) and not (folder / "files.json").exists():
        raise ToolError(f"{folder} has other files: name a new folder, or an older page")
    make_page(wanted, folder)
    print(f"{folder}: the page, {sizes_text(folder)}")


def main(arguments: list[str] | None = None) -> int:
    options = read_options(arguments)
    try:
        if options.export:
            export(options.detectors, options.export)
        else:
            with open_server(options.port) as server:  # before what takes a minute
                page = make_page(options.detectors, BUILD / "page")
                print(f"The page: {sizes_text(page)}")
                serve(server, options.open)
    except ToolError as error:
        print(f"tools/web: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"tools/web: {error.filename}: {error.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
