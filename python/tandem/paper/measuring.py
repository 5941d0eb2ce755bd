# SPDX-License-Identifier: MIT
"""The steps of 'tandem paper', and its folder of results. Uses only the standard library, so that a machine
with a GPU needs nothing else for measurements."""

import pathlib
import re

from ..errors import BadUse
from ..sequences.journal import Journal
from ..sequences.runner import Runner
from ..sequences.step import duration_text, listed, named, read_steps

PLANS = pathlib.Path(__file__).parent / "plans"
SHOWN = re.compile(r"(Table|Figure)s?((?:(?:,| and| to)? \d+)+)")


def steps_of(size, device):
    """The steps of a size, "small" or "full", in their order."""
    if size not in ("small", "full"):
        raise BadUse(f"--size {size}: give small or full")
    return read_steps(PLANS / f"{size}.json", {"device": device})


def runs_on(step, device):
    """Whether a step needs that device; exports do not."""
    return device in step.command or (step.plan or {}).get("devices") == device


def shown_in(step):
    """The tables and figures that a step's description names: {"table3", "figure9", ...}."""
    found = set()
    for kind, text in SHOWN.findall(step.says):
        for first, last in re.findall(r"(\d+)(?: to (\d+))?", text):
            found |= {f"{kind.lower()}{number}" for number in range(int(first), int(last or first) + 1)}
    return found


def _with_needed(numbers, steps):
    """Adds the steps that make the recordings of these."""
    needed = set.union(*(steps[number].recordings for number in numbers))
    return sorted(set(numbers) | {number for number, step in enumerate(steps) if needed & set(step.written)})


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
            own = named(word, steps) or [i for i, step in enumerate(steps) if word in shown_in(step)]
            own = _with_needed(own, steps) if own else ()
        if not own:
            raise BadUse(
                f"--steps {text}: {word} is no step; give N or FIRST:LAST of 1:{len(steps)}, a name, tableN or figureN"
            )
        found.update(own)
    return sorted(found)


def measured_folder(path, size, device, program):
    """A Runner for a folder of results of one size and one device. The journal is steps.jsonl; records/ has the
    records of most steps."""
    folder = pathlib.Path(path)
    for part in ("records", "plans", "logs"):
        try:
            (folder / part).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadUse(
                f"-o {path}: no folder can be created there ({error.strerror}); name another"
            ) from None
    journal = Journal(folder / "steps.jsonl", "is not a line of 'tandem paper'; name another folder")
    for line in journal.lines():
        if (line.get("size"), line.get("device")) != (size, device):
            raise BadUse(
                f"-o {path}: has results of size {line.get('size', '?')} on {line.get('device', '?')}; name another folder, or "
                "that size and device"
            )
    return Runner(folder, program, journal, {"size": size, "device": device})


def list_steps(runner, steps):
    print(*listed(steps, runner.is_done), sep="\n")
    left = sum(step.seconds for step in steps if not runner.is_done(step))
    print(f"about {duration_text(left)} left, with the durations of the committed results")
