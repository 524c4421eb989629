"""A headless Chromium that is driven through its own pipes: real keys, real screens, no network."""

import json
import os
import subprocess
import time
from pathlib import Path

from tests.conftest import required

FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update", "--disable-quic"),
    *("--hide-scrollbars", "--remote-debugging-pipe"),
)
PATIENCE = 60.0
"""Seconds to wait for an answer."""


class Browser:
    """One page; `errors` collects those of the console and of the scripts."""

    def __init__(self, profile):
        chromium = required("chromium")
        ours, self._commands = os.pipe()
        self._answers, theirs = os.pipe()
        # Chromium reads commands from 3 and answers on 4.
        script = f'exec 3<&{ours} 4>&{theirs}; exec "$0" "$@"'
        self._process = subprocess.Popen(
            ["bash", "-c", script, chromium, *FLAGS, f"--user-data-dir={profile}", "about:blank"],
            pass_fds=(ours, theirs), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(ours)
        os.close(theirs)
        os.set_blocking(self._answers, False)
        self._buffer, self._count, self._session = b"", 0, None
        self.errors, self.requests, self._loaded = [], [], False
        # A page of our own: which targets there are at the start is a matter of luck.
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        attached = self.send("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def close(self):
        self._process.terminate()
        self._process.wait(timeout=10)
        os.close(self._commands)
        os.close(self._answers)

    def send(self, method, **params):
        """Send a command and return its result."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._commands, data) :]
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            for answer in self._read():
                if answer.get("id") == self._count:
                    assert "error" not in answer, answer
                    return answer["result"]
        raise TimeoutError(method)

    def _read(self):
        try:
            self._buffer += os.read(self._answers, 1 << 20)
        except BlockingIOError:
            time.sleep(0.002)
        while b"\0" in self._buffer:
            text, _, self._buffer = self._buffer.partition(b"\0")
            answer = json.loads(text)
            self._note(answer)
            yield answer

    def _note(self, answer):
        params = answer.get("params", {})
        match answer.get("method"):
            case "Runtime.exceptionThrown":
                self.errors.append(params["exceptionDetails"])
            case "Log.entryAdded" if params["entry"]["level"] in ("warning", "error"):
                self.errors.append(params["entry"])
            case "Runtime.consoleAPICalled" if params["type"] in ("warning", "error", "assert"):
                self.errors.append(params)
            case "Network.requestWillBeSent":
                self.requests.append(params["request"]["url"])
            case "Page.loadEventFired":
                self._loaded = True

    def open(self, path: Path, state=""):
        """Open a file and wait until it is loaded."""
        for url in ("about:blank", path.as_uri() + state):  # the same page again is loaded anew
            self._loaded = False
            self.send("Page.navigate", url=url)
            until = time.monotonic() + PATIENCE
            while not self._loaded and time.monotonic() < until:
                list(self._read())
        self.settle()

    def run(self, expression):
        """Return the value of an expression of JavaScript."""
        found = self.send(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def settle(self):
        """Wait for two pictures."""
        self.run("new Promise(f => requestAnimationFrame(() => requestAnimationFrame(f)))")

    def screen(self, width, height, *, dark=False, phone=False):
        """Show the page on a screen of so many points."""
        self.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, mobile=phone,
            deviceScaleFactor=1,
        )  # fmt: skip
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.send("Emulation.setEmulatedMedia", features=[scheme])
        self.settle()

    def press(self, key, code, *, settle=True):
        """Press a key and let go of it."""
        text = {"text": "\r"} if key == "Enter" else {}
        for kind in ("keyDown", "keyUp"):
            self.send(
                "Input.dispatchKeyEvent", type=kind, key=key, code=key,
                windowsVirtualKeyCode=code, **(text if kind == "keyDown" else {}),
            )  # fmt: skip
        if settle:
            self.settle()
