# SPDX-License-Identifier: MIT
"""Headless Chromium, driven by its own protocol: pages, clicks, keys, pictures, and errors on the pages."""

import base64
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import time
import urllib.request


class Socket:
    """A web socket to one trusted server: text messages, one at a time (RFC 6455)."""

    def __init__(self, port, path):
        self.connection = socket.create_connection(("127.0.0.1", port), timeout=120)
        key = base64.b64encode(os.urandom(16)).decode()
        self.connection.sendall(
            (
                f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
            ).encode()
        )
        self.stream = self.connection.makefile("rb")
        assert b"101" in self.stream.readline()
        while self.stream.readline() != b"\r\n":
            pass

    def send(self, text):
        data, mask = text.encode(), os.urandom(4)
        size = len(data)
        head = (
            struct.pack("!BB", 0x81, 0x80 | size)
            if size < 126
            else struct.pack("!BBH", 0x81, 0xFE, size)
            if size < 65536
            else struct.pack("!BBQ", 0x81, 0xFF, size)
        )
        self.connection.sendall(head + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)))

    def receive(self):
        whole = b""
        while True:
            first, second = self.stream.read(2)
            size = second & 0x7F
            if size > 125:
                size = struct.unpack(
                    "!H" if size == 126 else "!Q", self.stream.read(2 if size == 126 else 8)
                )[0]
            data = self.stream.read(size)
            if first & 0x0F in (0, 1, 2):
                whole += data
                if first & 0x80:
                    return whole.decode()


class Browser:
    """One Chromium with one page. Use as a context."""

    def __init__(self):
        program = next(
            (
                found
                for name in ("chromium", "chromium-browser", "google-chrome")
                if (found := shutil.which(name))
            ),
            None,
        )
        if program is None:
            raise AssertionError("no chromium, which pages are tested in: scripts/setup installs it")
        self.home = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.log = open(pathlib.Path(self.home.name) / "log", "w")
        self.process = subprocess.Popen(
            [
                program,
                "--headless=new",
                "--no-sandbox",
                "--disable-dev-shm-usage",
                "--no-first-run",
                "--disable-extensions",
                "--mute-audio",
                "--disable-background-networking",
                "--disable-component-update",
                "--hide-scrollbars",
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--remote-debugging-port=0",
                "--remote-allow-origins=*",
                f"--user-data-dir={self.home.name}/profile",
                "about:blank",
            ],
            stdout=self.log,
            stderr=self.log,
            start_new_session=True,
        )
        self.number, self.events = 0, []
        self.socket = self.connect()
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.ask(domain + ".enable")

    def connect(self):
        port_file = pathlib.Path(self.home.name) / "profile/DevToolsActivePort"
        for _ in range(300):
            if port_file.exists() and port_file.read_text().strip():
                port = int(port_file.read_text().split()[0])
                pages = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=30))
                page = next((page for page in pages if page["type"] == "page"), None)
                if page:
                    return Socket(port, page["webSocketDebuggerUrl"].split(str(port), 1)[1])
            time.sleep(0.1)
        raise AssertionError(
            "chromium does not start: " + (pathlib.Path(self.home.name) / "log").read_text()[-2000:]
        )

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.connection.close()
        os.killpg(self.process.pid, signal.SIGKILL)  # its own process group, with all children
        self.process.wait()
        self.log.close()
        self.home.cleanup()

    def ask(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.receive())
            if message.get("id") == self.number:
                if "error" in message:
                    raise AssertionError(f"{method}: {message['error']}")
                return message["result"]
            self.events.append(message)

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
        """Opens a file and returns the seconds until every row of its table is present."""
        self.events.clear()
        begin = time.time()
        self.ask("Page.navigate", url=pathlib.Path(path).resolve().as_uri())
        self.until(
            "document.documentElement?.dataset.ready === 'true' && document.querySelector('#cell-table tbody')?.dataset.complete !== 'false'"
        )
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
        return time.time() - begin

    def problems(self):
        """Errors that the page logged, and requests for anything but the file."""
        self.run("1")
        texts = []
        for event in self.events:
            kind, what = event.get("method"), event.get("params", {})
            if kind == "Runtime.exceptionThrown":
                texts.append(
                    what["exceptionDetails"]
                    .get("exception", {})
                    .get("description", what["exceptionDetails"]["text"])
                )
            elif kind == "Runtime.consoleAPICalled" and what["type"] in ("error", "assert"):
                texts.append(
                    str([argument.get("description", argument.get("value")) for argument in what["args"]])
                )
            elif kind == "Log.entryAdded" and what["entry"]["level"] == "error":
                texts.append(what["entry"]["text"])
            elif (
                kind == "Network.requestWillBeSent"
                and what["type"] != "Document"
                and not what["request"]["url"].startswith(("data:", "blob:"))
            ):
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
