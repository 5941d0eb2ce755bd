# SPDX-License-Identifier: MIT
"""Measures two builds of the program by turns, for 'tandem compare --run': each turn starts one process of each build, so that drift of the
machine affects both. The process is the unit of the comparison, and the processes of one turn are a pair."""
import dataclasses
import json
import os
import pathlib
import signal
import subprocess
import sys

from .. import lines
from ..errors import BadUse
from ..text_lines import one_line
from .cells import RecordedCells, read_cells
from .pooling import pooled

SIDES = ("old", "new")
OWN_OPTIONS = ("--out", "--resume", "--dry-run", "--dump-pairs", "--dump-contacts", "--trace", "--profile")
ROOT = pathlib.Path(__file__).parents[3]  # of the source tree, if the package is in one


@dataclasses.dataclass
class Ended:
    """How the turns ended. `turns`: number of turns that were started. `failure`: why they stopped early, or empty. `signal`: the number of
    the signal that stopped them, or 0. `wrong`: a program found a wrong answer."""
    turns: int = 0
    failure: str = ""
    signal: int = 0
    wrong: bool = False


class _Signals:
    """While it is entered, signals that ask this process to end are passed on once to the running program, which then ends its round and
    writes its records. A second Ctrl-C ends this process."""

    def __init__(self):
        self.asked, self.process = 0, None

    def __enter__(self):
        self._before = {number: signal.signal(number, self._handle) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
                        if signal.getsignal(number) != signal.SIG_IGN}
        return self

    def __exit__(self, *_):
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number, _):
        if number == signal.SIGINT:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        if not self.asked and self.process:
            self.process.send_signal(signal.SIGTERM)
        self.asked = self.asked or number


def _checked_program(name, side):
    if not os.path.isfile(name) or not os.access(name, os.X_OK):
        raise BadUse(f"{name}: is no program; with --run, {side.upper()} is the path of a build of this program")
    return os.path.abspath(name)


def _check_words(words):
    if not words:
        raise BadUse("--run needs a scene or a plan; name it behind --: tandem compare --run OLD NEW -- SCENE ...")
    for word in words:
        if word.partition("=")[0] in OWN_OPTIONS:
            raise BadUse(f"{word}: 'tandem compare --run' decides this itself; leave it out behind --")


def prepared_folder(path):
    """A new or empty folder. Raises BadUse."""
    folder = pathlib.Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        is_empty = not any(folder.iterdir())
    except OSError as problem:
        raise BadUse(f"{path}: cannot be a folder of records ({problem.strerror}); name a new folder") from None
    if not is_empty:
        raise BadUse(f"{path}: is not empty; name a new folder")
    return folder


class Turns:
    """Turns of the programs `old` and `new`, paths, with the same words of 'tandem run'. Records go to FOLDER/old-N.jsonl and
    FOLDER/new-N.jsonl, N from 1. Raises BadUse for names that are no programs, and words that are not allowed."""

    def __init__(self, old, new, words, folder):
        _check_words(words)
        self._programs = {side: _checked_program(name, side) for side, name in zip(SIDES, (old, new))}
        self._names, self._words, self._folder, self._ended = dict(zip(SIDES, (old, new))), words, pathlib.Path(folder), Ended()

    def measure(self, count):
        """Takes so many turns; fewer after a signal or a failure. Returns Ended. Raises BadUse if a program refuses the words."""
        with _Signals() as signals:
            for turn in range(1, count + 1):
                self._ended.turns = turn
                # The second process of a turn may find a warmer machine, so that the order changes from turn to turn.
                for side in SIDES if turn % 2 else reversed(SIDES):
                    if not self._ended.failure:
                        self._run(signals, side, turn)
                    if signals.asked:
                        self._ended.failure, self._ended.signal = f"interrupted in turn {turn} of {count}", signals.asked
                if self._ended.failure:
                    break
        return self._ended

    def _file(self, side, turn):
        return self._folder / f"{side}-{turn}.jsonl"

    def _run(self, signals, side, turn):
        out = self._file(side, turn)
        line = [self._programs[side], "run", *self._words, "--quiet", "--out", str(out)]
        try:
            signals.process = subprocess.Popen(line, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        except OSError as problem:
            raise BadUse(f"{self._names[side]}: cannot be started ({problem.strerror}); give a build of this program") from None
        messages = signals.process.communicate()[1].decode(errors="replace").strip().splitlines()
        code, signals.process = signals.process.returncode, None
        message = one_line(messages[-1].removeprefix("tandem: "), 1000) if messages else f"exit code {code}"
        if code == 2:
            raise BadUse(f"{self._names[side]}: {message}")
        self._ended.wrong |= code == 1
        if code not in (0, 1):
            self._ended.failure = f"{self._names[side]} failed in turn {turn}: {f'signal {-code}' if code < 0 else message}"
        elif not out.exists():
            self._ended.failure = f"{self._names[side]} wrote no record in turn {turn}; give a build of this program"
        self._convert(out)

    def _convert(self, path):
        """Converts records that an older program wrote."""
        if not path.exists() or all(json.loads(line).get("schema") == lines.NEWEST for line in path.read_bytes().splitlines(True) if line.endswith(b"\n")):
            return
        installed = pathlib.Path(os.environ.get("TANDEM_PROGRAM", "")).parent / "tandem-convert-records"
        converter = next((name for name in (ROOT / "scripts/convert_records", installed) if name.exists()), None)
        if converter is None:
            raise BadUse(f"{path}: has records of an older schema, and {installed} is missing; install it with cmake --install")
        done = subprocess.run([sys.executable, str(converter), str(path)], capture_output=True, text=True)
        if done.returncode:
            raise BadUse(f"{path}: cannot be converted: {done.stderr.strip()}")

    def side(self, side):
        """RecordedCells of one side, whose cells are pooled by turns. A line of a cell that is left out is the number of its turn."""
        by_key, left_out, records = {}, {}, 0
        for turn in range(1, self._ended.turns + 1):
            path = self._file(side, turn)
            if not path.exists() or b"\n" not in path.read_bytes():  # the turn was interrupted
                continue
            read = read_cells(path)
            records += read.records
            for cell in read.cells:
                by_key.setdefault(cell.key, []).append(dataclasses.replace(cell, session=f"turn {turn}"))
            for cell in read.left_out:
                left_out.setdefault(cell.key, dataclasses.replace(cell, line=turn))
        cells = [pooled(found) for found in by_key.values()]
        commits = list(dict.fromkeys(cell.commit for cell in cells))
        return RecordedCells(self._names[side], "", cells, list(left_out.values()), commits, records, 0, False, len(cells), True)
