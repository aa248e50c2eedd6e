"""Serves a page on this machine: small transfers, nothing stale, and a policy for all files."""

import gzip
import hashlib
import http.server
import mimetypes
import sys
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

HOST = "localhost"
TYPES = {
    ".js": "text/javascript",
    ".wasm": "application/wasm",
    ".webmanifest": "application/manifest+json",
}
PACKED = (".html", ".js", ".css", ".json", ".svg", ".wasm", ".webmanifest")
# Of the page itself, index.html says this as well; workers have only what comes with their file.
POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "connect-src 'self'; worker-src 'self'; img-src 'self' data: blob:; media-src 'self' blob:; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


@cache
def _packed(path: Path, changed: float) -> tuple[bytes, bytes, str]:
    """A file's bytes, the same as gzip (empty if that is no use), and its tag."""
    data = path.read_bytes()
    zipped = gzip.compress(data, 6, mtime=0) if path.suffix in PACKED else b""
    return data, zipped, f'"{hashlib.sha256(data).hexdigest()[:20]}"'


class Handler(http.server.BaseHTTPRequestHandler):
    """Gives the files of a folder."""

    protocol_version = "HTTP/1.1"
    folder: Path  # of a subclass

    def do_GET(self) -> None:
        self._answer(with_body=True)

    def do_HEAD(self) -> None:
        self._answer(with_body=False)

    def log_message(self, *_: object) -> None:
        """Says nothing: the terminal is the user's."""

    def _file(self) -> Path | None:
        name = unquote(urlsplit(self.path).path).lstrip("/")
        path = (self.folder / (name or "index.html")).resolve()
        inside = path.is_relative_to(self.folder.resolve())
        return path if inside and path.is_file() else None

    def _answer(self, with_body: bool) -> None:
        path = self._file()
        if path is None:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        data, zipped, tag = _packed(path, path.stat().st_mtime)
        if self.headers.get("If-None-Match") == tag:
            self.send_response(HTTPStatus.NOT_MODIFIED)
            self.send_header("ETag", tag)
            self.end_headers()
            return
        takes_gzip = bool(zipped) and "gzip" in self.headers.get("Accept-Encoding", "")
        body = zipped if takes_gzip else data
        kind = TYPES.get(path.suffix) or mimetypes.guess_type(path.name)[0]
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind or "application/octet-stream")
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("Cache-Control", "no-cache")
        self.send_header("ETag", tag)
        self.send_header("Vary", "Accept-Encoding")
        if takes_gzip:
            self.send_header("Content-Encoding", "gzip")
        self.end_headers()
        if with_body:
            self.wfile.write(body)


class Server(http.server.ThreadingHTTPServer):
    """A server that does not mind readers who leave."""

    def handle_error(self, request: Any, client_address: Any) -> None:
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def make_server(folder: Path, port: int) -> Server:
    """A server of a folder at http://localhost:port, 0: any that is free."""
    handler = type("FolderHandler", (Handler,), {"folder": folder})
    return Server((HOST, port), handler)
