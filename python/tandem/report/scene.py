# SPDX-License-Identifier: MIT
"""Gets the geometry of a scene by the program's export."""

import dataclasses
import json
import os
import pathlib
import signal
import subprocess

from ..commands import within
from ..errors import OutputError
from ..files import temporary_folder

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OPTIONS = ("mesh", "pose", "frames", "every", "device", "duplicates", "weld")
FLAGS = ("contacts", "corners", "only_tetrahedra")


def add_options(parser):
    """Declares the options that words_of() passes to 'tandem export', which checks their values."""
    add = parser.add_argument
    add("--frames", metavar="FIRST:LAST", help="both inclusive (default: all)")
    add(
        "--every",
        type=within(1, 1000000, int),
        metavar="N",
        help="show every Nth of these frames only (default: 1)",
    )
    add("--duplicates", metavar="merge|keep|reject", help="of mesh files, as in 'tandem export'")
    add("--weld", metavar="TOLERANCE", help="of mesh files, as in 'tandem export'")
    for name in ("corners", "only-tetrahedra"):
        add(f"--{name}", action="store_true", help="of mesh files, as in 'tandem export'")
    add("--contacts", action="store_true", help="show contacts and normals in every frame")
    add("--device", metavar="DEVICE", help="the device that finds contacts (default: host)")


class ExportEnded(Exception):
    """The export ended with an exit code other than 0, and has printed the reason."""

    def __init__(self, code):
        super().__init__(code)
        self.code = code


@dataclasses.dataclass
class ShownScene:
    """json: the output of 'tandem export --geometry' (scenes/export/README.md). name, key: those of the
    scene. frames: number of frames."""

    json: str
    name: str
    key: str
    frames: int


class _SignalForwarder:
    """Context manager that forwards signals which end this process to the program that it runs."""

    def __init__(self):
        self.signalled, self.process = 0, None

    def __enter__(self):
        self.before = {which: signal.getsignal(which) for which in SIGNALS}
        for which, handler in self.before.items():
            if handler != signal.SIG_IGN:
                signal.signal(which, self._end)
        return self

    def __exit__(self, *_):
        for which, handler in self.before.items():
            signal.signal(which, handler)

    def _end(self, number, _):
        self.signalled = self.signalled or number
        if self.process is not None:
            self.process.terminate()

    def run(self, words, page):
        """Runs a program, with the page's file in its environment. Returns its exit code, or 128 plus its
        signal. Discards its standard output."""
        self.process = subprocess.Popen(
            words, stdout=subprocess.DEVNULL, env=os.environ | ({"TANDEM_PAGE": page} if page else {})
        )
        if self.signalled:
            self.process.terminate()
        code = self.process.wait()
        return 128 - code if code < 0 else code


def words_of(scene, options):
    """Arguments of tandem export for those options of a command line. Absent options are None."""
    words = []
    for name in OPTIONS:
        values = getattr(options, name, None)
        for value in values if isinstance(values, list) else [values]:
            words += [] if value is None else [f"--{name}={value}"]
    return [
        *words,
        *(f"--{name.replace('_', '-')}" for name in FLAGS if getattr(options, name, False)),
        *(["--", scene] if scene else []),
    ]


def _exported(forwarder, program, words, path, page):
    code = forwarder.run([program, "export", f"--geometry={path}", *words], page)
    if code > 128 and not forwarder.signalled:
        raise OutputError(f"tandem export was ended by signal {code - 128}")
    if code != 0:
        raise ExportEnded(128 + forwarder.signalled if forwarder.signalled else code)
    return path.read_text(encoding="utf-8").rstrip("\n")


def shown_scene(program, words, page=None):
    """ShownScene of an export with the arguments `words`. `page`: the file of the page, which the program
    refuses if it is an input. Raises ExportEnded, BadUse and OutputError."""
    with _SignalForwarder() as forwarder:  # for as long as the folder exists: a signal never leaves it behind
        with temporary_folder() as folder:
            text = _exported(forwarder, program, words, pathlib.Path(folder) / "scene.json", page)
        if forwarder.signalled:
            raise ExportEnded(128 + forwarder.signalled)
    scene = json.loads(text)
    return ShownScene(text, scene["name"], scene["key"], scene["of_frames"])
