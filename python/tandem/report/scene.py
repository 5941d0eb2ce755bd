# SPDX-License-Identifier: MIT
"""The geometry of a scene, which the program exports."""
import dataclasses
import json
import pathlib
import signal
import subprocess
import tempfile

from ..errors import BadUse, OutputError

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OPTIONS = ("mesh", "pose", "frames", "every", "device")


class ExportEnded(Exception):
    """The export has ended with an exit code other than 0, and has said why."""

    def __init__(self, code):
        super().__init__(code)
        self.code = code


@dataclasses.dataclass
class ShownScene:
    """json: the text that 'tandem export --geometry' writes (scenes/export/README.md); name and key of the scene; frames: how many there
    are to show."""
    json: str
    name: str
    key: str
    frames: int


class _HandsSignalsOn:
    """While it lasts, a signal that asks this process to end is handed to the program that it waits for."""

    def __init__(self):
        self.asked, self.process = False, None

    def __enter__(self):
        self.before = {which: signal.getsignal(which) for which in SIGNALS}
        for which, handler in self.before.items():
            if handler != signal.SIG_IGN:
                signal.signal(which, self._end)
        return self

    def __exit__(self, *_):
        for which, handler in self.before.items():
            signal.signal(which, handler)

    def _end(self, *_):
        self.asked = True
        if self.process is not None:
            self.process.terminate()

    def run(self, words):
        """The exit code of a program, or 128 and its signal. What it says is this program's."""
        self.process = subprocess.Popen(words, stdout=subprocess.DEVNULL)
        if self.asked:
            self.process.terminate()
        code = self.process.wait()
        return 128 - code if code < 0 else code


def words_of(scene, options):
    """The words of tandem export for options of a command line: mesh, pose, frames, every, device and contacts; None where one is not
    given."""
    words = []
    for name in OPTIONS:
        values = getattr(options, name, None)
        for value in values if isinstance(values, list) else [values]:
            words += [] if value is None else [f"--{name}={value}"]
    return [*words, *(["--contacts"] if options.contacts else []), *(["--", scene] if scene else [])]


def _exported(program, words, path):
    with _HandsSignalsOn() as guard:
        code = guard.run([program, "export", f"--geometry={path}", *words])
    if code > 128 and not guard.asked:
        raise OutputError(f"tandem export was ended by signal {code - 128}")
    if code != 0 or guard.asked:
        raise ExportEnded(code or 128 + signal.SIGTERM)
    return path.read_text(encoding="utf-8").rstrip("\n")


def shown_scene(program, words):
    """ShownScene of the program's export with these words. Raises ExportEnded, BadUse and OutputError."""
    try:
        folder = tempfile.TemporaryDirectory(prefix="tandem-")
    except OSError as problem:
        raise BadUse(f"there is no folder for temporary files ({problem.strerror}); set TMPDIR to one") from None
    with folder:
        text = _exported(program, words, pathlib.Path(folder.name) / "scene.json")
    scene = json.loads(text)
    return ShownScene(text, scene["name"], scene["key"], scene["of_frames"])
