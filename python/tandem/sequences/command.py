# SPDX-License-Identifier: MIT
"""LIST.json -o FOLDER --program FILE [--set NAME=VALUE ...] [--limit SECONDS] [--again] STEP ...: runs steps of
a list, with a journal in FOLDER/steps.jsonl. A step that ended well with the same build runs again only with
--again, which deletes its records first. Without steps, lists them. Several steps are listed before they run,
with the seconds that they take; without --program they are only listed. Exits with the code of the first step
that failed, 3 if it needs what is missing, such as the program, and 124 if it ran longer than its limit."""

import pathlib
import sys

from ..commands import Answered, Parser
from ..errors import BadUse
from .journal import Journal
from .runner import MISSING, Runner, environment_of
from .step import duration_text, listed, named, read_steps


def _parsed(arguments):
    parser = Parser("run", __doc__)
    parser.add_argument("list")
    parser.add_argument("steps", nargs="*")
    parser.add_argument("-o", "--output")
    parser.add_argument("--program")
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--limit", type=float)
    parser.add_argument("--again", action="store_true")
    return parser.read(arguments)


def _run(options, steps):
    unknown = [word for word in options.steps if not named(word, steps)]
    if unknown:
        raise BadUse(f"no step {unknown[0]}; without arguments they are listed")
    numbers = list(dict.fromkeys(number for word in options.steps for number in named(word, steps)))
    chosen = [steps[number] for number in numbers]
    if len(chosen) > 1 or not options.program:
        known = [step.seconds for step in chosen if step.seconds]
        print(*listed(chosen, apart=True), sep="\n")
        more = " and more" if len(known) < len(chosen) else ""
        print(f"about {duration_text(sum(known))}{more}", flush=True)
    if not options.program:
        return MISSING
    folder, program = pathlib.Path(options.output).resolve(), pathlib.Path(options.program).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    journal = Journal(folder / "steps.jsonl", "is not a line of a journal of steps; name another folder")
    runner = Runner(folder, program, journal, environment_of(program))
    runner.name, runner.limit, runner.shows = "run", options.limit, True
    for step in chosen:
        if options.again:
            runner.forget(step)
        elif runner.is_done(step):
            runner.tell(f"run: step {step.name} is done with this build; --again runs it again")
    failed = runner.run(steps, numbers)
    return 128 + runner.interrupted if runner.interrupted else next(iter(failed), 0)


def main(arguments):
    try:
        options = _parsed(arguments)
        steps = read_steps(pathlib.Path(options.list), dict(one.split("=", 1) for one in options.set))
        if options.steps:
            return _run(options, steps)
        print(*listed(steps), sep="\n")
        return 0
    except Answered as answer:
        print(answer)
        return 0
    except (BadUse, OSError) as problem:
        print(f"run: {problem}", file=sys.stderr)
        return 2 if isinstance(problem, BadUse) else 3
