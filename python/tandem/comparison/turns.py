# SPDX-License-Identifier: MIT
"""Measures two builds of the program by turns, for 'tandem compare --run'. Each turn starts one process of
each build. Both take their rounds alternately, one process at a time, so that drift of the machine affects
both. The process is the unit of the comparison, and the processes of one turn are a pair."""

import contextlib
import dataclasses
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

from .. import lines
from ..errors import BadUse
from ..text_lines import one_line
from .cells import RecordedCells, read_cells
from .pooling import pooled

SIDES = ("old", "new")
OWN_OPTIONS = (
    "--out",
    "--resume",
    "--dry-run",
    "--dump-pairs",
    "--dump-contacts",
    "--dump-distances",
    "--dump-surfaces",
    "--trace",
    "--profile",
)
ROOT = pathlib.Path(__file__).parents[3]  # of the source tree, if the package is in one


@dataclasses.dataclass
class Ended:
    """How the turns ended. `turns`: number of turns that were started. `failure`: why they stopped early, or
    empty. `signal`: the number of the signal that stopped them, or 0. `wrong`: a program found a wrong
    answer."""

    turns: int = 0
    failure: str = ""
    signal: int = 0
    wrong: bool = False


class _Process:
    """A process that runs a program. It asks for its turn before each round (harness/sampling/turns.h); older
    builds never ask."""

    def __init__(self, command, seed):
        goes, self._goes = os.pipe()
        self._asks, asks = os.pipe()
        self._errors = (
            tempfile.TemporaryFile()
        )  # nobody would read a pipe while the process waits for its turn
        try:
            self._process = subprocess.Popen(
                command,
                stdout=subprocess.DEVNULL,
                stderr=self._errors,
                pass_fds=(goes, asks),
                env=os.environ | {"TANDEM_TURNS": f"{goes},{asks},{seed}"},
            )
        except OSError:
            os.close(self._goes)
            os.close(self._asks)
            raise
        finally:
            os.close(goes)
            os.close(asks)

    def asks(self):
        """Whether the process waits for its turn; False when it has ended."""
        return os.read(self._asks, 1) != b""

    def go(self):
        """Lets it take one round."""
        with contextlib.suppress(BrokenPipeError):
            os.write(self._goes, b"g")

    def end(self, number):
        if self._process.poll() is None:
            self._process.send_signal(number)

    def result(self):
        """Waits for its end. Returns the exit code and the last line of messages."""
        code = self._process.wait()
        for pipe in (self._goes, self._asks):
            os.close(pipe)
        with self._errors as errors:
            errors.seek(0)
            messages = errors.read().decode(errors="replace").strip().splitlines()
        return code, one_line(
            messages[-1].removeprefix("tandem: "), 1000
        ) if messages else f"exit code {code}"


class _Signals:
    """While it is entered, signals that ask this process to end are passed on once to the running programs,
    which then end their rounds and write their records. A second Ctrl-C ends this process."""

    def __init__(self):
        self.asked, self.processes = 0, []

    def end_processes(self):
        for process in self.processes:
            process.end(signal.SIGTERM)

    def __enter__(self):
        self._before = {
            number: signal.signal(number, self._handle)
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
            if signal.getsignal(number) != signal.SIG_IGN
        }
        return self

    def __exit__(self, *_):
        self.end_processes()  # those that an error left behind
        for process in self.processes:
            process.result()
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number, _):
        if number == signal.SIGINT:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        if not self.asked:
            self.end_processes()
        self.asked = self.asked or number


def _checked_program(name, side):
    if not os.path.isfile(name) or not os.access(name, os.X_OK):
        raise BadUse(
            f"{name}: is no program; with --run, {side.upper()} is the path of a build of this program"
        )
    return os.path.abspath(name)


def _check_words(words):
    if not words:
        raise BadUse(
            "--run needs a scene or a plan; name it behind --: tandem compare --run OLD NEW -- SCENE ..."
        )
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
        raise BadUse(
            f"{path}: cannot be a folder of records ({problem.strerror}); name a new folder"
        ) from None
    if not is_empty:
        raise BadUse(f"{path}: is not empty; name a new folder")
    return folder


class Turns:
    """Turns of the programs `old` and `new`, paths, with the same words of 'tandem run'. Records go to
    FOLDER/old-N.jsonl and FOLDER/new-N.jsonl, N from 1. Raises BadUse for names that are no programs, and
    words that are not allowed."""

    def __init__(self, old, new, words, folder):
        _check_words(words)
        self._programs = {side: _checked_program(name, side) for side, name in zip(SIDES, (old, new))}
        self._names, self._words, self._folder, self._ended = (
            dict(zip(SIDES, (old, new))),
            words,
            pathlib.Path(folder),
            Ended(),
        )

    def measure(self, count):
        """Takes so many turns; fewer after a signal or a failure. Returns Ended. Raises BadUse if a program
        refuses the words."""
        with _Signals() as signals:
            for turn in range(1, count + 1):
                self._ended.turns = turn
                self._take(signals, turn)
                if signals.asked:
                    self._ended.failure, self._ended.signal = (
                        f"interrupted in turn {turn} of {count}",
                        signals.asked,
                    )
                if self._ended.failure:
                    break
        return self._ended

    def _take(self, signals, turn):
        """One turn. The second process of a pair may find a warmer machine, so that the order changes from
        turn to turn."""
        waiting = []
        for side in SIDES if turn % 2 else reversed(SIDES):
            if signals.asked or self._ended.failure:
                break
            process = self._started(side, turn)
            signals.processes.append(process)
            if signals.asked:  # while it was started
                process.end(signal.SIGTERM)
            if process.asks():
                waiting.append((side, process))
            else:
                self._finish(signals, side, turn, process)
        while waiting:
            for side, process in tuple(waiting):
                process.go()
                if not process.asks():
                    waiting.remove((side, process))
                    self._finish(signals, side, turn, process)

    def _file(self, side, turn):
        return self._folder / f"{side}-{turn}.jsonl"

    def _started(self, side, turn):
        line = [self._programs[side], "run", *self._words, "--quiet", "--out", str(self._file(side, turn))]
        try:
            return _Process(line, turn)
        except OSError as problem:
            raise BadUse(
                f"{self._names[side]}: cannot be started ({problem.strerror}); give a build of this program"
            ) from None

    def _finish(self, signals, side, turn, process):
        """Takes the results of a process that has ended. After a failure the other process of the turn ends early."""
        code, message = process.result()
        signals.processes.remove(process)
        out = self._file(side, turn)
        if code == 2:
            raise BadUse(f"{self._names[side]}: {message}")
        self._ended.wrong |= code == 1
        if self._ended.failure or signals.asked:
            pass  # it was asked to end
        elif code not in (0, 1):
            self._ended.failure = (
                f"{self._names[side]} failed in turn {turn}: {f'signal {-code}' if code < 0 else message}"
            )
            signals.end_processes()
        elif not out.exists():
            self._ended.failure = (
                f"{self._names[side]} wrote no record in turn {turn}; give a build of this program"
            )
            signals.end_processes()
        self._convert(out)

    def _convert(self, path):
        """Converts records that an older program wrote."""
        if not path.exists() or all(
            json.loads(line).get("schema") == lines.NEWEST
            for line in path.read_bytes().splitlines(True)
            if line.endswith(b"\n")
        ):
            return
        installed = pathlib.Path(os.environ.get("TANDEM_PROGRAM", "")).parent / "tandem-convert-records"
        converter = next(
            (name for name in (ROOT / "scripts/convert_records", installed) if name.exists()), None
        )
        if converter is None:
            raise BadUse(
                f"{path}: has records of an older schema, and {installed} is missing; install it with cmake --install"
            )
        done = subprocess.run([sys.executable, str(converter), str(path)], capture_output=True, text=True)
        if done.returncode:
            raise BadUse(f"{path}: cannot be converted: {done.stderr.strip()}")

    def side(self, side):
        """RecordedCells of one side, whose cells are pooled by turns. A line of a cell that is left out is
        the number of its turn."""
        by_key, left_out, records = {}, {}, 0
        for turn in range(1, self._ended.turns + 1):
            path = self._file(side, turn)
            if not path.exists() or b"\n" not in path.read_bytes():  # the turn was interrupted
                continue
            read = read_cells(path)
            records += read.records
            for cell in read.cells:
                cell.session = f"turn {turn}"
                by_key.setdefault(cell.key, []).append(cell)
            for cell in read.left_out:
                cell.line = turn
                left_out.setdefault(cell.key, cell)
        cells = [pooled(found) for found in by_key.values()]
        commits = list(dict.fromkeys(cell.commit for cell in cells))
        return RecordedCells(
            self._names[side],
            "",
            cells,
            list(left_out.values()),
            commits,
            records,
            0,
            False,
            len(cells),
            True,
        )
