# SPDX-License-Identifier: MIT
"""Headless Chromium, driven by its own protocol: pages, clicks, keys, pictures, and errors on the pages."""

import base64
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time


PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = """
    --headless=new --no-sandbox --disable-dev-shm-usage --no-first-run --disable-extensions --mute-audio
    --disable-background-networking --disable-component-update --hide-scrollbars --use-gl=angle
    --use-angle=swiftshader --enable-unsafe-swiftshader --remote-debugging-pipe
""".split()
READY = "document.readyState === 'complete' && (!document.scripts.length || document.documentElement.dataset.ready)"


class Browser:
    """One Chromium with one page. Use as a context. Messages are JSON texts that end with a zero byte, in two
    pipes, which Chromium has as files 3 and 4."""

    def __init__(self):
        program = next(filter(None, map(shutil.which, PROGRAMS)), None)
        if program is None:
            raise AssertionError("no chromium, which pages are tested in: scripts/setup installs it")
        self.home = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        (read, write), (answers, answered) = os.pipe(), os.pipe()
        words = [program, *OPTIONS, f"--user-data-dir={self.home.name}", "about:blank"]
        with open(pathlib.Path(self.home.name) / "log", "w") as log:
            self.process = subprocess.Popen(
                ["bash", "-c", f'exec "$@" 3<&{read} 4>&{answered}', "bash", *words],
                stdout=log,
                stderr=log,
                pass_fds=(read, answered),
                start_new_session=True,
            )
        os.close(read)
        os.close(answered)
        self.questions, self.answers, self.received = open(write, "wb", 0), answers, b""
        self.number, self.events, self.session = 0, [], {}
        page = next(one for one in self.ask("Target.getTargets")["targetInfos"] if one["type"] == "page")
        attached = self.ask("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self.session = {"sessionId": attached["sessionId"]}
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.ask(domain + ".enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self.process.pid, signal.SIGKILL)  # its own process group, with all children
        self.process.wait()
        self.questions.close()
        os.close(self.answers)
        self.home.cleanup()

    def ask(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters} | self.session
        self.questions.write(json.dumps(message).encode() + b"\0")
        while True:
            message = json.loads(self.receive())
            if message.get("id") == self.number:
                if "error" in message:
                    raise AssertionError(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)

    def receive(self):
        while b"\0" not in self.received:
            part = os.read(self.answers, 1 << 20)
            if not part:
                raise AssertionError("chromium ended")
            self.received += part
        message, _, self.received = self.received.partition(b"\0")
        return message

    def run(self, script):
        """The value of an expression in the page, awaited."""
        result = self.ask(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True, userGesture=True
        )
        if "exceptionDetails" in result:
            raise AssertionError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def until(self, condition, seconds=60):
        """Waits until an expression is true."""
        end = time.time() + seconds
        while time.time() < end:
            if self.run(condition):
                return
            time.sleep(0.05)
        raise AssertionError(f"never became true: {condition}")

    def open(self, path):
        """Opens a page and returns the seconds until its images are loaded and its scripts have ended."""
        self.events.clear()
        begin = time.time()
        self.ask("Page.navigate", url=pathlib.Path(path).resolve().as_uri())
        self.until(READY)
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
        return time.time() - begin

    def problems(self, beside=()):
        """Errors that the page logged, and requests for anything but the file and addresses that begin so."""
        self.run("1")
        texts = []
        for event in self.events:
            kind, what = event.get("method"), event.get("params", {})
            if kind == "Runtime.exceptionThrown" or (
                kind == "Runtime.consoleAPICalled" and what["type"] in ("error", "assert")
            ):
                texts.append(json.dumps(what)[:2000])
            elif kind == "Log.entryAdded" and what["entry"]["level"] == "error":
                texts.append(what["entry"]["text"])
            elif kind == "Network.requestWillBeSent" and what["type"] != "Document":
                if not what["request"]["url"].startswith(("data:", "blob:", *beside)):
                    texts.append("a request of " + what["request"]["url"][:200])
        return texts

    def size(self, width, height, mobile=False):
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=mobile,
        )

    def dark(self, dark):
        self.ask(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}],
        )

    def key(self, name):
        for kind in ("keyDown", "keyUp"):
            self.ask("Input.dispatchKeyEvent", type=kind, key=name, code=name)

    def drag(self, start, end):
        for kind, (x, y), buttons in (
            ("mousePressed", start, 1),
            ("mouseMoved", end, 1),
            ("mouseReleased", end, 0),
        ):
            self.ask(
                "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons, clickCount=1
            )

    def wheel(self, at, down, control=False):
        self.ask(
            "Input.dispatchMouseEvent",
            type="mouseWheel",
            x=at[0],
            y=at[1],
            deltaX=0,
            deltaY=down,
            modifiers=2 if control else 0,
        )

    def fingers(self, *paths):
        """Touches with a finger for each path [start, end], in ten steps."""
        at = lambda part: [
            {"x": a[0] + part * (b[0] - a[0]), "y": a[1] + part * (b[1] - a[1]), "id": i}
            for i, (a, b) in enumerate(paths)
        ]
        self.ask("Input.dispatchTouchEvent", type="touchStart", touchPoints=at(0))
        for step in range(1, 11):
            self.ask("Input.dispatchTouchEvent", type="touchMove", touchPoints=at(step / 10))
        self.ask("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self, path):
        pathlib.Path(path).write_bytes(
            base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])
        )
