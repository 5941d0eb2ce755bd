# SPDX-License-Identifier: MIT
"""Runs the steps of 'tandem paper' and keeps track of them. Uses only the standard library, so that a machine
with a GPU needs nothing else for measurements."""

import ctypes
import dataclasses
import datetime
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

from ..errors import BadUse

PLANS = pathlib.Path(__file__).parent / "plans"


@dataclasses.dataclass(frozen=True)
class Step:
    """A command of the program, or a plan of cells for `tandem run`. Paths are relative to the folder of
    results."""

    name: str
    says: str  # description
    seconds: float  # duration on the machine of the committed results
    command: tuple  # arguments of "tandem"
    plan: object  # None, or the plan that is written to plans/NAME.json before the command runs

    @property
    def key(self):
        """Identifies the step. It contains the plan, so that a changed plan is measured again."""
        plan = "" if self.plan is None else json.dumps(self.plan, separators=(",", ":"), ensure_ascii=False)
        return f"{' '.join(self.command)} {plan}"


def _expanded(value, names):
    """A JSON value with {NAME} replaced in all its texts."""
    if isinstance(value, str):
        for name, text in names.items():
            value = value.replace("{" + name + "}", text)
        return value
    if isinstance(value, list):
        return [_expanded(one, names) for one in value]
    if isinstance(value, dict):
        return {key: _expanded(one, names) for key, one in value.items()}
    return value


def steps_of(size, device):
    """The steps of a size, "small" or "full", in their order."""
    path = PLANS / f"{size}.json"
    if size not in ("small", "full"):
        raise BadUse(f"--size {size}: give small or full")
    names = {"device": device}
    steps = []
    for one in json.loads(path.read_text())["steps"]:
        plan = _expanded(one["plan"], names) if "plan" in one else None
        name = one["name"]
        command = one.get("command") or [
            "run",
            f"plans/{name}.json",
            "--resume",
            "--out",
            f"records/{name}.jsonl",
        ]
        steps.append(
            Step(name, one["says"], one["seconds"], tuple(_expanded(word, names) for word in command), plan)
        )
    return steps


SHOWN = re.compile(r"(Table|Figure)s?((?:(?:,| and| to)? \d+)+)")


def shown_in(step):
    """The tables and figures that a step's description names: {"table3", "figure9", ...}."""
    found = set()
    for kind, text in SHOWN.findall(step.says):
        for first, last in re.findall(r"(\d+)(?: to (\d+))?", text):
            found |= {f"{kind.lower()}{number}" for number in range(int(first), int(last or first) + 1)}
    return found


def _recordings(step):
    """(recordings that a step reads, the recording that it writes or "")."""
    words = list(step.command)
    written = words[words.index("-o") + 1] if "-o" in words else ""
    scenes = (step.plan or {}).get("scenes", [])
    read = words + (scenes if isinstance(scenes, list) else [scenes])
    return {
        pathlib.PurePath(word).name for word in read if word.endswith(".frames") and word != written
    }, written


def _with_needed(numbers, steps):
    """Adds the steps that make the recordings of these."""
    needed = set.union(*(_recordings(steps[number])[0] for number in numbers))
    return sorted(
        set(numbers) | {number for number, step in enumerate(steps) if _recordings(step)[1] in needed}
    )


def chosen(text, steps):
    """Indices of the steps that --steps names, in their order; all for an empty text. Steps chosen by a
    table, a figure or a name come with those that make their recordings."""
    if not text:
        return list(range(len(steps)))
    found = set()
    for word in text.split(","):
        range_of = re.fullmatch(r"(\d+)(?::(\d+))?", word)
        if range_of:
            first, last = int(range_of[1]), int(range_of[2] or range_of[1])
            own = range(first - 1, last) if 1 <= first <= last <= len(steps) else ()
        else:
            own = [number for number, step in enumerate(steps) if word == step.name or word in shown_in(step)]
            own = _with_needed(own, steps) if own else ()
        if not own:
            raise BadUse(
                f"--steps {text}: {word} is no step; give N or FIRST:LAST of 1:{len(steps)}, a name, tableN or figureN"
            )
        found.update(own)
    return sorted(found)


def duration_text(seconds):
    """ "40 s", "7 min"."""
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def _sync_folder(path):
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _sync_file_system(path):
    """Syncs the file system of a folder, so that the output of all processes there survives a loss of power."""
    descriptor = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        ctypes.CDLL(None).syncfs(descriptor)
    finally:
        os.close(descriptor)


class Journal:
    """An append-only file of JSON lines. A line survives a loss of power once append() has returned. An
    incomplete last line, which a kill leaves, is moved to FILE.torn."""

    def __init__(self, path):
        self.path = path
        self._keep_whole_lines()
        is_new = not path.exists()
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
        if is_new:
            _sync_folder(path.parent)

    def _keep_whole_lines(self):
        try:
            data = self.path.read_bytes()
        except FileNotFoundError:
            return
        end = data.rfind(b"\n") + 1
        if end == len(data):
            return
        with open(f"{self.path}.torn", "ab") as torn:
            torn.write(data[end:] + b"\n")
            torn.flush()
            os.fsync(torn.fileno())
        _sync_folder(self.path.parent)
        with open(self.path, "r+b") as file:
            file.truncate(end)
            os.fsync(file.fileno())

    def lines(self):
        for number, text in enumerate(self.path.read_text().splitlines(), 1):
            try:
                line = json.loads(text)
            except ValueError:
                line = None
            if not isinstance(line, dict):
                raise BadUse(f"{self.path}:{number}: is not a line of 'tandem paper'; name another folder")
            yield line

    def append(self, line):
        data = (json.dumps(line, separators=(",", ":"), ensure_ascii=False) + "\n").encode()
        if os.write(self._file, data) != len(data):
            raise OSError(28, os.strerror(28), str(self.path))
        os.fsync(self._file)


class MeasuredFolder:
    """A folder of results of one size and one device. steps.jsonl has the steps that ended, with their exit
    codes. records/, plans/ and logs/ have one file per step."""

    def __init__(self, path, size, device, program):
        self.path, self.size, self.device, self.program = pathlib.Path(path), size, device, program
        self.running, self.interrupted = None, 0
        for part in ("records", "plans", "logs"):
            try:
                (self.path / part).mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise BadUse(
                    f"-o {path}: no folder can be created there ({error.strerror}); name another"
                ) from None
        self.journal = Journal(self.path / "steps.jsonl")
        self.done = set()
        for line in self.journal.lines():
            if (line.get("size"), line.get("device")) != (size, device):
                raise BadUse(
                    f"-o {path}: has results of size {line.get('size', '?')} on {line.get('device', '?')}; name another folder, or "
                    "that size and device"
                )
            (self.done.add if line.get("exit") == 0 else self.done.discard)(line.get("key"))

    def is_done(self, step):
        return step.key in self.done

    def log(self, step):
        return self.path / "logs" / f"{step.name}.txt"

    def last_line(self, step):
        try:
            lines = [line for line in self.log(step).read_text(errors="replace").splitlines() if line]
        except OSError:
            lines = []
        return lines[-1] if lines else ""

    def forget(self, step):
        """Deletes the records of a step, so that it runs again."""
        self.done.discard(step.key)
        for word in step.command:
            if word.endswith((".jsonl", ".frames")):
                for name in (word, f"{word}.checkpoint"):
                    (self.path / name).unlink(missing_ok=True)

    def words(self, step):
        """The command of a step; a simulation with a checkpoint continues from it."""
        words = [self.program, *step.command]
        if step.command[0] == "simulate" and "-o" in step.command:
            recording = step.command[step.command.index("-o") + 1]
            if (self.path / f"{recording}.checkpoint").exists():
                words.append("--resume")
        return words

    def run(self, step, environment):
        """Runs the step in its own process and appends the result to steps.jsonl. Returns its exit code, or
        128 plus the signal."""
        if step.plan is not None:
            (self.path / "plans" / f"{step.name}.json").write_text(
                json.dumps(step.plan, indent=2, ensure_ascii=False) + "\n"
            )
        self.log(step).unlink(missing_ok=True)
        begin = time.monotonic()
        with open(self.log(step), "ab") as log:
            self.running = subprocess.Popen(self.words(step), cwd=self.path, stdout=log, stderr=log)
            code = self.running.wait()
        self.running = None
        code = 128 - code if code < 0 else code
        _sync_file_system(
            self.path
        )  # the step's output must be durable before the line that marks it as done
        now = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        self.journal.append(
            {
                "step": step.name,
                "size": self.size,
                "device": self.device,
                "exit": code,
                "seconds": time.monotonic() - begin,
                "says": step.says,
                "command": f"tandem {' '.join(step.command)}",
                "key": step.key,
                **environment,
                "date": now,
            }
        )
        if code == 0:
            self.done.add(step.key)
        return code

    def interrupt(self, number, _):
        """Signal handler: ends the running step, and starts no further one."""
        self.interrupted = number
        if self.running is not None:
            self.running.send_signal(signal.SIGTERM)


def environment_of(program):
    """Commit and state of the program's build, from its --version."""
    text = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    commit = re.search(r"commit (\w+)", text)[1]
    return {"commit": "" if commit == "unknown" else commit, "dirty": ", dirty" in text}


def list_steps(folder, steps):
    for number, step in enumerate(steps, 1):
        print(
            f"{number:>3}  {step.name:<18} {'done' if folder.is_done(step) else f'{step.seconds} s':>6}  {step.says}"
        )
    left = sum(step.seconds for step in steps if not folder.is_done(step))
    print(f"about {duration_text(left)} left, with the durations of the committed results")


def run_steps(folder, steps, numbers):
    """Runs those of these steps that are not done; numbers: their indices. Later steps run also if one fails.
    Returns the worst exit code, or 128 plus the signal that ended them."""
    print_message = lambda text: print(text, file=sys.stderr, flush=True)
    environment = environment_of(folder.program)
    left = sum(steps[i].seconds for i in numbers if not folder.is_done(steps[i]))
    expected = real = 0.0
    worst = 0
    for which in (signal.SIGINT, signal.SIGTERM):
        signal.signal(which, folder.interrupt)
    for number, step in [(i + 1, steps[i]) for i in numbers]:
        if folder.interrupted:
            break
        if folder.is_done(step):
            continue
        pace = (
            real / expected if expected > 0 else 1.0
        )  # time on this machine over that of the committed results
        print_message(
            f"{number}/{len(steps)} {step.name}: {step.says} (about {duration_text(step.seconds * pace)}; "
            f"all about {duration_text(left * pace)})"
        )
        begin = time.monotonic()
        code = folder.run(step, environment)
        real, expected, left = real + time.monotonic() - begin, expected + step.seconds, left - step.seconds
        if code != 0 and not folder.interrupted:
            print_message(
                f"tandem: step {step.name} ended with {code}: {folder.last_line(step)}; its output is in {folder.path}/logs"
            )
            worst = max(worst, 1 if code == 1 else 3)
    if folder.interrupted:
        print_message("tandem: interrupted; the same command continues")
        return 128 + folder.interrupted
    return worst
