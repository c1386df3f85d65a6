"""Chromium without a window, spoken to through pipes in its DevTools protocol: one page, what it says, asks for and looks like."""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

NAMES = ("chromium", "chromium-browser", "google-chrome", "chromium-headless-shell")
# Seconds that the browser may take for anything.
PATIENCE = 120


def find_browser():
    """Path of a browser, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Browser:
    """A browser with one blank page; use it in a `with`."""

    def __enter__(self):
        self.place = tempfile.mkdtemp(prefix="browser-")
        there, self.sending = os.pipe()
        self.hearing, back = os.pipe()
        # The browser reads commands from descriptor 3 and answers on 4.
        words = ["--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--remote-debugging-pipe",
                 "--disable-background-networking", "--no-first-run", "--hide-scrollbars", f"--user-data-dir={self.place}",
                 "about:blank"]  # fmt: skip
        start = f'exec 62<&{there} 63>&{back}; exec 3<&62 4>&63 62<&- 63>&-; exec "$@"'
        self.process = subprocess.Popen(["/bin/bash", "-c", start, "browser", find_browser(), *words], pass_fds=(there, back),
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # fmt: skip
        os.close(there)
        os.close(back)
        self.number, self.rest, self.events, self.session = 0, b"", [], None
        targets = self.ask("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.sending)
        os.close(self.hearing)
        shutil.rmtree(self.place, ignore_errors=True)

    def ask(self, method, **parameters):
        """Send a command and wait for its answer; events that come meanwhile are kept."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.sending, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.hear()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def hear(self):
        """The next message."""
        end = time.monotonic() + PATIENCE
        while b"\0" not in self.rest:
            ready, _, _ = select.select([self.hearing], [], [], max(0.0, end - time.monotonic()))
            piece = os.read(self.hearing, 1 << 20) if ready else b""
            if not piece:
                raise RuntimeError("the browser does not answer")
            self.rest += piece
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def open(self, path, width, height=900):
        """Show a file in a window of this width, whole; returns the events until it is loaded."""
        self.events.clear()
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.ask("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=-1, uploadThroughput=-1)
        self.ask("Page.navigate", url=path.resolve().as_uri())
        while not any(event.get("method") == "Page.loadEventFired" for event in self.events):
            self.events.append(self.hear())
        # Messages to the console come after what they are about: once this is answered they are here.
        self.value("new Promise(done => requestAnimationFrame(() => setTimeout(() => done(1), 50)))")
        return self.events

    def value(self, expression):
        """The value of an expression on the page."""
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"]["text"])
        return answer["result"].get("value")

    def drag(self, x, y, to_x, to_y):
        """Press the left button of the mouse at a place, move to another, and let go."""
        for kind, place, held in (("mousePressed", (x, y), 1), ("mouseMoved", (to_x, to_y), 1), ("mouseReleased", (to_x, to_y), 0)):
            self.ask("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], button="left", buttons=held, clickCount=1)

    def wheel(self, x, y, turn):
        """Turn the wheel of the mouse at a place."""
        self.ask("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=turn)

    def picture(self, path):
        """Write the whole page as PNG."""
        data = self.ask("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        path.write_bytes(base64.b64decode(data))
