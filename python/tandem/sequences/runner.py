# SPDX-License-Identifier: MIT
"""Runs steps one after the other. Each is a process of its own, and ends alone if it fails."""

import contextlib
import datetime
import json
import os
import re
import signal
import subprocess
import sys
import time

from .journal import sync_file_system
from .needs import Machine
from .progress import Progress
from .step import expanded

MISSING, LIMIT, NO_START = 3, 124, 127  # exit codes of steps without one, as of tandem, timeout and a shell
GRACE = 20  # seconds from SIGTERM to SIGKILL


def environment_of(program):
    """Commit and state of the program's build, from its --version."""
    text = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    commit = re.search(r"commit (\w+)", text)[1]
    return {"commit": "" if commit == "unknown" else commit, "dirty": ", dirty" in text}


def _to_stderr(text):
    print(text, file=sys.stderr, flush=True)


class Runner:
    """The state of a folder of results. Its journal has the steps that ended, with their exit codes; plans/ and
    logs/ have a file for each step."""

    def __init__(self, folder, program, journal, fields):
        """fields: what every line of the journal has. Lines with other values do not count."""
        self.folder, self.program, self.journal, self.fields = folder, str(program), journal, fields
        self.machine = Machine(self.program, folder)
        self.name = "tandem"  # begins messages
        self.tell = _to_stderr
        self.limit = None  # most seconds of every step
        self.shows = False  # also prints what steps print, when they have ended
        self.result = lambda step, code, reason: {}  # more of its line
        self.running, self.interrupted = None, 0
        self.done = set()
        for line in journal.lines():
            if all(line.get(name) == value for name, value in fields.items()):
                (self.done.add if line.get("exit") == 0 else self.done.discard)(line.get("key"))

    def is_done(self, step):
        return step.key in self.done

    def log(self, step):
        return self.folder / "logs" / f"{step.name}.txt"

    def last_line(self, step):
        text = self.log(step).read_text(errors="replace") if self.log(step).exists() else ""
        return next(filter(None, reversed(text.splitlines())), "")

    def forget(self, step):
        """Deletes the records of a step, so that it runs again."""
        self.done.discard(step.key)
        for word in step.written:
            for name in (word, f"{word}.checkpoint"):
                (self.folder / name).unlink(missing_ok=True)

    def command(self, step):
        """Its words. {NAME} is the device of a driver that it needs."""
        drivers = [need.removeprefix("driver ") for need in step.needs if need.startswith("driver ")]
        names = {name: self.machine.of_driver(name) or name for name in drivers}
        return [expanded(word, names) for word in step.command]

    def words(self, step):
        """The command that runs; a simulation with a checkpoint continues from it."""
        words = [self.program if word == "tandem" else word for word in self.command(step)]
        checkpoints = [self.folder / f"{word}.checkpoint" for word in step.written]
        return words + (["--resume"] if any(path.exists() for path in checkpoints) else [])

    def missing(self, step, steps):
        """Why the step cannot run, in one line; "" if it can."""
        for name in step.recordings:
            makers = [other.name for other in steps if name in other.written]
            if not (self.folder / name).exists():
                return f"{name} is missing" + (f"; step {makers[-1]} makes it" if makers else "")
        return next(filter(None, map(self.machine.missing, step.needs)), "")

    def _signal(self, number):
        """To the step and to all processes that it started."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.running.pid, number)

    def _ended(self, words, log, limit):
        """Runs a process. Returns its exit code, or 128 plus the signal that ended it, and a reason or ""."""
        try:
            self.running = subprocess.Popen(
                words, cwd=self.folder, stdout=log, stderr=log, start_new_session=True
            )
        except OSError as error:
            return NO_START, f"{words[0]}: {error.strerror}"
        if self.interrupted:  # before `running` was known
            self._signal(signal.SIGTERM)
        try:
            code, reason = self.running.wait(limit), ""
        except subprocess.TimeoutExpired:
            self._signal(signal.SIGTERM)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self.running.wait(GRACE)
            self._signal(signal.SIGKILL)
            self.running.wait()
            code, reason = LIMIT, f"it ran longer than its limit of {limit:g} s"
        self.running = None
        return 128 - code if code < 0 else code, reason

    def run_step(self, step, steps, environment):
        """Runs the step, and appends to the journal how it ended. Returns its exit code and a reason or ""."""
        begin = time.monotonic()
        code, reason = MISSING, self.missing(step, steps)
        if not reason:
            for part in ("plans", "logs") if step.plan is not None else ("logs",):
                (self.folder / part).mkdir(exist_ok=True)
            if step.plan is not None:
                text = json.dumps(step.plan, indent=2, ensure_ascii=False) + "\n"
                (self.folder / "plans" / f"{step.name}.json").write_text(text)
            limit = min(filter(None, (step.limit, self.limit)), default=None)
            with open(self.log(step), "wb") as log:
                code, reason = self._ended(self.words(step), log, limit)
            # The step's output must be durable before the line that marks it as done.
            sync_file_system(self.folder)
        now = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        line = {"step": step.name, **self.fields, "exit": code, "seconds": time.monotonic() - begin}
        line |= {"reason": reason} if reason else {}
        line |= {"says": step.says, "command": " ".join(self.command(step)), "key": step.key}
        self.journal.append({**line, **self.result(step, code, reason), **environment, "date": now})
        (self.done.discard if code else self.done.add)(step.key)
        return code, reason

    def interrupt(self, number, _):
        """Signal handler: ends the running step, and starts no further one."""
        self.interrupted = number
        if self.running is not None:
            self._signal(signal.SIGTERM)

    def tell_end(self, step, code, reason):
        """Prints how a step ended, unless it ended well."""
        did_run = not (code == MISSING and reason)
        if self.shows and did_run:
            sys.stdout.write(self.log(step).read_text(errors="replace"))
            sys.stdout.flush()
        if self.interrupted or code == 0:
            return
        if did_run:
            self.tell(
                f"{self.name}: step {step.name} ended with {code}: {reason or self.last_line(step)}; "
                f"its output is in {self.folder}/logs"
            )
        else:
            self.tell(f"{self.name}: step {step.name} did not run: {reason}")

    def run(self, steps, numbers):
        """Runs those of these steps that are not done; numbers: their indices. Later steps run also if one
        fails. Returns the exit codes of those that failed. `interrupted` is the signal that ended them, or 0."""
        environment = environment_of(self.program)
        numbers = list(numbers)
        progress = Progress(steps[i] for i in numbers if not self.is_done(steps[i]))
        failed = []
        for which in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            if which != signal.SIGHUP or signal.getsignal(which) != signal.SIG_IGN:  # as under nohup
                signal.signal(which, self.interrupt)
        for number, step in [(n, steps[i]) for n, i in enumerate(numbers, 1)]:
            if self.interrupted:
                break
            if self.is_done(step):
                continue
            self.tell(f"{number}/{len(numbers)} {step.name}: {step.says} ({progress.text(step)})")
            begin = time.monotonic()
            code, reason = self.run_step(step, steps, environment)
            did_run = not (code == MISSING and reason)
            progress.ended(step, time.monotonic() - begin if did_run else None)
            self.tell_end(step, code, reason)
            is_absence = not did_run and step.optional
            failed += [code] if code and not self.interrupted and not is_absence else []
        if self.interrupted:
            self.tell(f"{self.name}: interrupted; the same command continues")
        return failed
