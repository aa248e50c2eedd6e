"""A page in Chromium, without a window: keys, pointer, fingers, pictures, and what goes wrong.

It talks to the browser through two pipes, in the DevTools protocol, so that nothing has to be
installed besides the browser.
"""

import base64
import fcntl
import json
import os
import select
import shutil
import signal
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

PROGRAMS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_FLAGS = (
    "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu", "--no-first-run",
    "--disable-dev-shm-usage", "--disable-background-networking", "--disable-component-update",
    "--disable-sync", "--mute-audio", "--hide-scrollbars", "--force-color-profile=srgb",
)  # fmt: skip
_FINGERS = 10  # file descriptors from here on are out of the way of 3 and 4
KEY_CODES = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Home": 36,
             "End": 35, " ": 32, "Tab": 9, "Enter": 13, "Escape": 27, "Delete": 46}  # fmt: skip


class BrowserError(RuntimeError):
    """The browser did not do what it was asked to."""


def find_browser() -> str | None:
    """Where Chromium is; None: nowhere on the path."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


class Page:
    """One page; errors of its console, addresses that it and its workers fetched, and how many
    bytes came over the network, are kept."""

    def __init__(
        self, program: str, width: int = 1280, height: int = 800, timeout: float = 60.0,
        flags: Sequence[str] = (),
    ):  # fmt: skip
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.loaded = 0
        self._timeout = timeout
        self._number = 0
        self._buffer = b""
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        from_us, self._out = os.pipe()
        self._in, to_us = os.pipe()

        # Not by subprocess: what it would run between fork and exec is not safe beside threads.
        reads, writes = (
            fcntl.fcntl(fd, fcntl.F_DUPFD_CLOEXEC, _FINGERS) for fd in (from_us, to_us)
        )
        nothing = os.open(os.devnull, os.O_RDWR)
        places = [(nothing, 0), (nothing, 1), (nothing, 2), (reads, 3), (writes, 4)]
        self._process = os.posix_spawn(
            program,
            [program, *_FLAGS, *flags, f"--user-data-dir={self._folder.name}", "about:blank"],
            os.environ,
            file_actions=[(os.POSIX_SPAWN_DUP2, here, there) for here, there in places],
        )
        for descriptor in (reads, writes, nothing):
            os.close(descriptor)
        os.close(from_us)
        os.close(to_us)
        targets = self._send("Target.getTargets", session=None)["targetInfos"]
        target = next(t["targetId"] for t in targets if t["type"] == "page")
        attached = self._send("Target.attachToTarget", session=None, targetId=target, flatten=True)
        self._session: str = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")
        watch = {"autoAttach": True, "waitForDebuggerOnStart": True, "flatten": True}
        self.send("Target.setAutoAttach", **watch)
        self.resize(width, height)

    def __enter__(self) -> "Page":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
        try:
            self._send("Browser.close", session=None)
        except (BrowserError, OSError):
            os.kill(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)
        os.close(self._out)
        os.close(self._in)
        self._folder.cleanup()

    # ---- What a reader does --------------------------------------------------------------------

    def resize(self, width: int, height: int, density: float = 1.0, mobile: bool = False) -> None:
        """The window's size in pixels, and device pixels a pixel."""
        self.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height,
            deviceScaleFactor=density, mobile=mobile,
        )  # fmt: skip
        self.send("Emulation.setTouchEmulationEnabled", enabled=mobile)

    def scheme(self, name: str) -> None:
        """Prefers "light" or "dark"."""
        self.prefer(color_scheme=name)

    def prefer(self, **features: str) -> None:
        """What the reader prefers, such as reduced_motion="reduce"; nothing else."""
        named = [
            {"name": f"prefers-{name.replace('_', '-')}", "value": value}
            for name, value in features.items()
        ]
        self.send("Emulation.setEmulatedMedia", features=named)

    def open(self, path: Path, anchor: str = "") -> None:
        """Opens a file, until it is loaded."""
        self.visit(path.resolve().as_uri() + anchor)

    def visit(self, address: str) -> None:
        """Opens an address, until it is loaded."""
        self.send("Page.navigate", url="about:blank")
        self.requests.clear()
        self.loaded = 0
        self.send("Page.navigate", url=address)
        self.until("document.readyState === 'complete' && location.href !== 'about:blank'")

    def evaluate(self, expression: str) -> Any:
        """The value of an expression of JavaScript, in the page; a promise is waited for."""
        answer = self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in answer:
            raise BrowserError(f"{expression}: {json.dumps(answer['exceptionDetails'])}")
        return answer["result"].get("value")

    def until(self, expression: str) -> None:
        """Waits until an expression is true."""
        end = time.monotonic() + self._timeout
        while not self.evaluate(expression):
            if time.monotonic() > end:
                raise BrowserError(f"still not: {expression}")
            time.sleep(0.02)

    def settle(self) -> None:
        """Waits until what was asked for is drawn."""
        self.evaluate("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")

    def key(self, key: str, shift: bool = False) -> None:
        """Presses and releases a key."""
        code = KEY_CODES.get(key, ord(key[0].upper()))
        known: dict[str, Any] = {"key": key, "windowsVirtualKeyCode": code, "modifiers": 8 * shift}
        text = {"text": "\r" if key == "Enter" else key} if len(key) == 1 or key == "Enter" else {}
        self.send("Input.dispatchKeyEvent", type="keyDown", **known, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **known)
        self.settle()

    def click(self, selector: str) -> None:
        """Clicks the middle of an element."""
        self.drag(self.middle(selector), (0, 0))

    def drag(self, start: tuple[float, float], by: tuple[float, float]) -> None:
        """Presses the pointer at a place, moves it by so many pixels, and releases it."""
        (x, y), (dx, dy) = start, by
        self._pointer("mouseMoved", x, y)
        self._pointer("mousePressed", x, y, 1)
        for part in (0.5, 1.0) if by != (0, 0) else ():
            self._pointer("mouseMoved", x + part * dx, y + part * dy, 1)
        self._pointer("mouseReleased", x + dx, y + dy)
        self.settle()

    def touch(self, start: tuple[float, float], by: tuple[float, float]) -> None:
        """Puts a finger down, moves it by so many pixels, and lifts it."""
        (x, y), (dx, dy) = start, by
        for kind, part in (("touchStart", 0.0), ("touchMove", 0.5), ("touchMove", 1.0)):
            points = [{"x": x + part * dx, "y": y + part * dy}]
            self.send("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        self.settle()

    def give_file(self, selector: str, path: Path) -> None:
        """Chooses a file in an input."""
        root = self.send("DOM.getDocument")["root"]["nodeId"]
        node = self.send("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.send("DOM.setFileInputFiles", nodeId=node, files=[str(path)])

    def before_scripts(self, script: str) -> str:
        """Runs a script in each page to come, before its own; gives its number for undo()."""
        answer = self.send("Page.addScriptToEvaluateOnNewDocument", source=script)
        return str(answer["identifier"])

    def undo(self, number: str) -> None:
        self.send("Page.removeScriptToEvaluateOnNewDocument", identifier=number)

    def allow_camera(self, allowed: bool) -> None:
        """Answers for the reader, for all pages."""
        setting = "granted" if allowed else "denied"
        self._send(
            "Browser.setPermission", session=None, permission={"name": "camera"}, setting=setting
        )

    def hover(self, x: float, y: float) -> None:
        self._pointer("mouseMoved", x, y)
        self.settle()

    def wheel(self, x: float, y: float, down: float, shift: bool = False) -> None:
        self.send(
            "Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=down,
            modifiers=8 * shift,
        )  # fmt: skip
        self.settle()

    def middle(self, selector: str) -> tuple[float, float]:
        """The middle of an element, which is scrolled into sight."""
        x, y = self.evaluate(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            "e.scrollIntoView({block: 'nearest'}); const b = e.getBoundingClientRect();"
            "return [b.x + b.width / 2, b.y + b.height / 2]; })()"
        )
        return x, y

    def screenshot(self, path: Path) -> None:
        """What the window shows, as PNG."""
        self.settle()
        picture = self.send("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(picture["data"]))

    # ---- The protocol --------------------------------------------------------------------------

    def _pointer(self, kind: str, x: float, y: float, buttons: int = 0) -> None:
        button = "none" if kind == "mouseMoved" and not buttons else "left"
        self.send(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons,
            clickCount=int(kind != "mouseMoved"),
        )  # fmt: skip

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Asks the page for something; its answer."""
        return self._send(method, self._session, **parameters)

    def _post(self, method: str, session: str | None, **parameters: Any) -> None:
        """Asks for something, and does not wait for the answer."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        os.write(self._out, json.dumps(message).encode() + b"\0")

    def _send(self, method: str, session: str | None, **parameters: Any) -> dict[str, Any]:
        self._post(method, session, **parameters)
        number = self._number
        for answer in self._messages():
            self._note(answer)
            if answer.get("id") == number:
                if "error" in answer:
                    raise BrowserError(f"{method}: {answer['error']['message']}")
                result: dict[str, Any] = answer["result"]
                return result
        raise BrowserError(f"{method}: the browser is gone")

    def _messages(self) -> Iterator[dict[str, Any]]:
        end = time.monotonic() + self._timeout
        while True:
            message, found, rest = self._buffer.partition(b"\0")
            if found:
                self._buffer = rest
                yield json.loads(message)
                continue
            if not select.select([self._in], [], [], max(0.0, end - time.monotonic()))[0]:
                raise BrowserError("the browser does not answer")
            data = os.read(self._in, 1 << 20)
            if not data:
                return
            self._buffer += data

    def _note(self, message: dict[str, Any]) -> None:
        """Keeps what a test asks about later."""
        method, given = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(given["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and given["type"] in ("error", "warning"):
            self.errors.append(json.dumps(given["args"]))
        elif method == "Log.entryAdded" and given["entry"]["level"] in ("error", "warning"):
            self.errors.append(given["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            url: str = given["request"]["url"]
            if not url.startswith("data:"):
                self.requests.append(url)
        elif method == "Target.attachedToTarget":  # a worker, which waits until it is watched
            for what in ("Network.enable", "Runtime.runIfWaitingForDebugger"):
                self._post(what, given["sessionId"])
        elif method == "Network.loadingFinished":
            self.loaded += int(given["encodedDataLength"])


@contextmanager
def opened(path: Path, program: str, width: int = 1280, height: int = 800) -> Iterator[Page]:
    """A page of a file."""
    with Page(program, width, height) as page:
        page.open(path)
        yield page
