# SPDX-License-Identifier: MIT
"""Gets the geometry of a scene by the program's export."""

import contextlib
import dataclasses
import json
import os
import pathlib
import signal
import subprocess

from ..commands import within
from ..errors import BadUse, OutputError
from ..files import temporary_folder

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OPTIONS = ("mesh", "pose", "frames", "every", "device", "duplicates", "weld", "pressure")
FLAGS = ("contacts", "surfaces", "corners", "only_tetrahedra")


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
    add("--pressure", metavar="MODULUS", help="of mesh files, as in 'tandem export'")
    for name in ("corners", "only-tetrahedra"):
        add(f"--{name}", action="store_true", help="of mesh files, as in 'tandem export'")
    add("--contacts", action="store_true", help="show contacts and normals in every frame")
    surfaces = (
        "show contact surfaces in every frame, coloured by pressure; bodies need pressure fields (--pressure)"
    )
    add("--surfaces", action="store_true", help=surfaces)
    add(
        "--device",
        metavar="DEVICE",
        help="the device that finds contacts and surfaces (default: the first GPU, else host)",
    )


def check_device(options):
    """Raises BadUse for --device without anything to find."""
    if options.device is not None and not (options.contacts or options.surfaces):
        raise BadUse("--device requires --contacts or --surfaces; see --help")


class ExportEnded(SystemExit):
    """Ends this process, too: the export ended with this exit code, and has printed the reason."""


@dataclasses.dataclass
class ShownScene:
    """json: the output of 'tandem export --geometry' (scenes/export/geometry.h). name, key: those of the
    scene. frames: number of frames."""

    json: str
    name: str
    key: str
    frames: int


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


class _Running:
    """The program that this process runs, and the number of the first signal that asked this process to end."""

    process, signalled = None, 0

    def end(self, number, _):
        self.signalled = self.signalled or number
        if self.process is not None:
            self.process.terminate()


def _run(running, words, page):
    """The exit code of a program, which gets the page's file in its environment, or 128 plus its signal."""
    environment = os.environ | ({"TANDEM_PAGE": page} if page else {})
    running.process = subprocess.Popen(words, stdout=subprocess.DEVNULL, env=environment)
    if running.signalled:
        running.process.terminate()
    code = running.process.wait()
    return 128 - code if code < 0 else code


def shown_scene(program, words, page=None):
    """ShownScene of an export with the arguments `words`. `page`: the file of the page, which the program
    refuses if it is an input. Raises ExportEnded, BadUse and OutputError."""
    running = _Running()
    with (
        contextlib.ExitStack() as handlers
    ):  # for as long as the folder exists: a signal never leaves it behind
        for which in SIGNALS:
            if signal.getsignal(which) != signal.SIG_IGN:
                handlers.callback(signal.signal, which, signal.signal(which, running.end))
        with temporary_folder() as folder:
            path = pathlib.Path(folder) / "scene.json"
            code = _run(running, [program, "export", f"--geometry={path}", *words], page)
            text = path.read_text(encoding="utf-8").rstrip("\n") if code == 0 else ""
    if running.signalled:
        raise ExportEnded(128 + running.signalled)
    if code > 128:
        raise OutputError(f"tandem export was ended by signal {code - 128}")
    if code != 0:
        raise ExportEnded(code)
    scene = json.loads(text)
    return ShownScene(text, scene["name"], scene["key"], scene["of_frames"])
