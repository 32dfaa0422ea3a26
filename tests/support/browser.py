"""A headless Chromium for tests of pages, driven over a pipe by its DevTools protocol."""

from __future__ import annotations

import base64
import contextlib
import fcntl
import json
import os
import select
import shutil
import signal
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from support.needs import give_up

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_OPTIONS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-background-networking", "--remote-debugging-pipe",
)  # fmt: skip # root has no sandbox, a container little shared memory
_PATIENCE = 60.0  # s: a machine that does much else


class Browser:
    """One page of a Chromium; `said` is what its console said, `asked` are the addresses that it read."""

    def __init__(self, to: int, out: int) -> None:
        self._to, self._out = to, out
        self.said: list[str] = []
        self.asked: list[str] = []
        self._count, self._rest, self._session = 0, b"", ""
        self._loaded = False
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Emulation.setScrollbarsHidden", hidden=True)
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> Any:
        """Return the answer to a call of the protocol. Raises RuntimeError with what Chromium says."""
        self._count += 1
        message: dict[str, Any] = {"id": self._count, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        number = self._count
        while True:
            answer = self._read()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def _read(self) -> dict[str, Any]:
        """Return the next message, after noting what it tells."""
        deadline = time.monotonic() + _PATIENCE
        while b"\0" not in self._rest:
            if not select.select([self._out], [], [], max(0.0, deadline - time.monotonic()))[0]:
                raise RuntimeError("Chromium does not answer")
            more = os.read(self._out, 2**20)
            if not more:
                raise RuntimeError("Chromium has ended")
            self._rest += more
        text, _, self._rest = self._rest.partition(b"\0")
        message: dict[str, Any] = json.loads(text)
        about = message.get("params", {})
        match message.get("method"):
            case "Runtime.consoleAPICalled":
                self.said.append(" ".join(str(a.get("value", a.get("description"))) for a in about["args"]))
            case "Runtime.exceptionThrown":
                details = about["exceptionDetails"]
                self.said.append(details.get("exception", {}).get("description", details["text"]))
            case "Log.entryAdded":
                self.said.append(about["entry"]["text"])
            case "Network.requestWillBeSent":
                self.asked.append(about["request"]["url"])
            case "Page.loadEventFired":
                self._loaded = True
        return message

    def open(self, path: Path, width: int = 1280, height: int = 900) -> None:
        """Load a page of so many pixels, and wait until its curves are drawn."""
        self.said, self.asked, self._loaded = [], [], False
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.call("Page.navigate", url=path.resolve().as_uri())
        while not self._loaded:
            self._read()
        self.wait("[...document.querySelectorAll('section.charts')].every(s => s.dataset.ready)")

    def run(self, script: str) -> Any:
        """Return the value of an expression of the page's language."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def wait(self, script: str) -> None:
        """Wait until an expression is true. Raises RuntimeError where it does not become so."""
        deadline = time.monotonic() + _PATIENCE
        while not self.run(script):
            if time.monotonic() > deadline:
                raise RuntimeError(f"not in {_PATIENCE:g} s: {script}; the console says {self.said}")
            time.sleep(0.02)

    def settle(self) -> None:
        """Wait until what was done is drawn."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")

    def mouse(self, kind: str, x: float, y: float, button: str = "none") -> None:
        """Move the mouse, or press or release a button."""
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, clickCount=1)

    def drag(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag the mouse from one place [px] to another."""
        self.mouse("mouseMoved", *begin)
        self.mouse("mousePressed", *begin, button="left")
        self.mouse("mouseMoved", (begin[0] + end[0]) / 2, end[1], button="left")
        self.mouse("mouseMoved", *end, button="left")
        self.mouse("mouseReleased", *end, button="left")
        self.settle()

    def picture(self, path: Path) -> None:
        """Write the whole page as a PNG."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
        data = self.call("Page.captureScreenshot", captureBeyondViewport=True, clip=clip)["data"]
        path.write_bytes(base64.b64decode(data))


def program() -> str | None:
    """Return the path of a Chromium; None where there is none."""
    return next(filter(None, map(shutil.which, _NAMES)), None)


@contextlib.contextmanager
def browser() -> Iterator[Browser]:
    """Start a Chromium, and end it; give the test up where there is none."""
    found = program()
    if found is None or os.name != "posix":
        give_up("there is no Chromium on this machine")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        process, to, out = _start(found, [*_OPTIONS, f"--user-data-dir={profile}"])
        try:
            yield Browser(to, out)
        finally:
            os.close(to)
            os.close(out)
            os.kill(process, signal.SIGTERM)
            os.waitpid(process, 0)


def _start(found: str, options: list[str]) -> tuple[int, int, int]:
    """Start a Chromium, which reads from 3 and writes to 4; return its id, and our ends of these pipes."""
    to_read, to_write = os.pipe()
    out_read, out_write = os.pipe()
    high = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in (to_read, out_write)]
    actions: list[tuple[Any, ...]] = [
        *((os.POSIX_SPAWN_OPEN, stream, os.devnull, os.O_RDWR, 0) for stream in (0, 1, 2)),
        (os.POSIX_SPAWN_DUP2, high[0], 3),
        (os.POSIX_SPAWN_DUP2, high[1], 4),
    ]
    process = os.posix_spawn(found, [found, *options], os.environ, file_actions=actions)
    for end in (to_read, out_write, *high):
        os.close(end)
    return process, to_write, out_read
