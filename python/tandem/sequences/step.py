# SPDX-License-Identifier: MIT
"""Steps, and the lists of them in JSON: {"steps": [...]}, each of them with
- name, unique, and says, a description; group (optional): the name of several entries together;
- commands: texts that are split into words as by a shell, without its variables and operators. The word
  `tandem` is the program, and {NAME} a name that the caller gives;
- or plan, which becomes plans/NAME.json. Its default command is `tandem run` with it;
- each (optional): values by name, such as {"k": ["8", "18"]}. Every combination of them is put into the commands
  in place of {k}, and its results are a part of their own: NAME-1, NAME-2, ...;
- seconds (optional): the expected duration of all parts; limit (optional): the most seconds of one part;
- needs (optional): a list of `device cuda:0`, `double cuda:0`, `driver PoCL` ({PoCL} is then its device),
  `algorithm cubql cuda:0`, `program mpirun`, `module torch`, `file PATTERN`. With optional, what is missing is no
  failure."""

import dataclasses
import itertools
import json
import pathlib
import re
import shlex

WRITES = ("-o", "--out", "--record")  # options whose values are files that a step makes


@dataclasses.dataclass(frozen=True)
class Step:
    """A command. Its paths are relative to the folder of results, and its word `tandem` is the program."""

    name: str  # unique in its list
    says: str  # description
    command: tuple  # words
    seconds: float = None  # expected duration; None: unknown
    needs: tuple = ()  # what the machine must have (needs.py)
    optional: bool = False  # what it needs may be missing, which is no failure
    limit: float = None  # most seconds
    plan: object = None  # written to plans/NAME.json before the command runs
    group: str = ""  # of what several steps are parts

    @property
    def key(self):
        """Identifies the step. It contains the plan, so that a changed plan is measured again. Parts have group and
        name in it, because two of them may have the same command."""
        plan = "" if self.plan is None else json.dumps(self.plan, separators=(",", ":"), ensure_ascii=False)
        part = f"{self.group}, {self.name}: " if self.group else ""
        return f"{part}{' '.join(self.command).removeprefix('tandem ')} {plan}"

    @property
    def written(self):
        return [word for option, word in itertools.pairwise(self.command) if option in WRITES]

    @property
    def recordings(self):
        """Names of the recordings that the step reads."""
        scenes = (self.plan or {}).get("scenes", [])
        words = [*self.command, *(scenes if isinstance(scenes, list) else [scenes])]
        return {
            pathlib.PurePath(word).name
            for word in words
            if word.endswith(".frames") and word not in self.written
        }


def expanded(value, names):
    """A JSON value with {NAME} replaced in all its texts."""
    if isinstance(value, str):
        return re.sub(r"\{(\w+)\}", lambda found: names.get(found[1], found[0]), value)
    if isinstance(value, (list, tuple)):
        return [expanded(one, names) for one in value]
    if isinstance(value, dict):
        return {key: expanded(one, names) for key, one in value.items()}
    return value


def _steps_of(entry, names):
    """The steps of an entry: one for each command and each combination of the values of `each`."""
    entry = dict(entry)
    name, each, commands = entry["name"], entry.pop("each", {}), entry.pop("commands", None)
    if "plan" in entry:
        entry["plan"] = expanded(entry["plan"], names)
        commands = commands or [f"tandem run plans/{name}.json --resume --out records/{name}.jsonl"]
    combinations = [dict(zip(each, values)) for values in itertools.product(*each.values())]
    parts = [(command, values) for values in combinations for command in commands]
    for number, (command, values) in enumerate(parts, 1):
        # Values may be several words, and names, such as folders, are a part of one word.
        words = [expanded(word, names) for word in shlex.split(expanded(command, values))]
        own = {"command": tuple(words), "needs": expanded(expanded(entry.get("needs", ()), values), names)}
        if len(parts) > 1:
            own |= {"name": f"{name}-{number}", "group": entry.get("group", name)}
            own |= {"seconds": entry["seconds"] / len(parts)} if "seconds" in entry else {}
        yield Step(**entry | own)


def read_steps(path, names):
    """The steps of a list, in their order. {NAME} in its texts becomes names[NAME]."""
    return [step for entry in json.loads(path.read_text())["steps"] for step in _steps_of(entry, names)]


def named(word, steps):
    """Indices of the steps of that name or group."""
    return [number for number, step in enumerate(steps) if word in (step.name, step.group)]


def duration_text(seconds):
    """ "40 s", "7 min"."""
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


def listed(steps, is_done=lambda step: False, apart=False):
    """A line for each step; the parts of an entry, and the entries of a group, share one unless `apart`."""
    lines = []
    for name, group in itertools.groupby(steps, lambda step: not apart and step.group or step.name):
        parts = list(group)
        durations = [step.seconds for step in parts]
        state = "unknown" if None in durations else f"{sum(durations):g} s"
        state = "done" if all(map(is_done, parts)) else state
        lines.append(f"{len(lines) + 1:>3}  {name:<18} {state:>6}  {parts[0].says}")
    return lines
