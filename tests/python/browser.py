"""A real browser without a window, driven over a pipe, for the tests of pages.

Chromium speaks its DevTools protocol on the file descriptors 3 and 4: JSON, each message ended by
a zero byte.
"""

import base64
import json
import os
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from select import select
from typing import Any, Self

PATIENCE_S = 60.0
OPTIONS = ("--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe")
TWO_FRAMES = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
Json = Any


def chromium() -> Path | None:
    """Find a browser that sees temporary files, which one in a snap does not."""
    found = shutil.which("chromium")
    if found is None or Path(found).resolve().name == "snap":
        return None
    return Path(found)


class Browser:
    """One page of a browser, and all that it reported."""

    def __init__(self, to_browser: int, from_browser: int) -> None:
        self._to, self._from = to_browser, from_browser
        self._rest = b""
        self._last = 0
        self._session: Mapping[str, str] = {}
        self.events: list[Json] = []

    def attach(self) -> Self:
        """Open an empty page and listen to it."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        for domain in ("Page", "Runtime", "Log", "Network", "Accessibility"):
            self.call(f"{domain}.enable")
        return self

    def call(self, method: str, **parameters: Json) -> Json:
        """Ask for something and wait for the answer."""
        self._last += 1
        message = {"id": self._last, "method": method, "params": parameters, **self._session}
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while (answer := self._next()).get("id") != self._last:
            self.events.append(answer)
        assert "error" not in answer, answer
        return answer["result"]

    def open(self, path: Path, scheme: str, width_px: int) -> None:
        """Show a file in a light or dark scheme, and wait until all of it is there."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.call("Emulation.setEmulatedMedia", features=features)
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width_px,
            height=1000,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.events.clear()
        self.call("Page.navigate", url=path.as_uri())
        while not any(e.get("method") == "Page.loadEventFired" for e in self.events):
            self.events.append(self._next())
        # What lies below the screen has no roles before a frame was drawn.
        self.call("Runtime.evaluate", expression=TWO_FRAMES, awaitPromise=True)

    def evaluate(self, expression: str) -> Json:
        """Give the value of an expression in the page."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"]["value"]

    def picture(self) -> bytes:
        """Give the whole page as PNG."""
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=True)
        return base64.b64decode(shot["data"])

    def events_of(self, method: str) -> list[Json]:
        """Give what was reported since the page was opened."""
        return [event["params"] for event in self.events if event.get("method") == method]

    def _next(self) -> Json:
        while b"\0" not in self._rest:
            ready, _, _ = select([self._from], [], [], PATIENCE_S)
            assert ready, "the browser does not answer"
            more = os.read(self._from, 1 << 16)
            assert more, "the browser has ended"
            self._rest += more
        message, self._rest = self._rest.split(b"\0", 1)
        return json.loads(message)


@contextmanager
def browser(program: Path, profile: Path) -> Iterator[Browser]:
    """Start a browser with a profile of its own, and end it."""
    its_input, to_browser = os.pipe()
    from_browser, its_output = os.pipe()
    # Only a shell can give a program the descriptors 3 and 4.
    redirected = f'exec "$0" "$@" 3<&{its_input} 4>&{its_output}'
    process = subprocess.Popen(
        ["/bin/bash", "-c", redirected, program, *OPTIONS, f"--user-data-dir={profile}"],
        pass_fds=(its_input, its_output),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(its_input)
    os.close(its_output)
    try:
        yield Browser(to_browser, from_browser).attach()
    finally:
        os.close(to_browser)  # at the end of its input the browser ends
        try:
            process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        os.close(from_browser)
