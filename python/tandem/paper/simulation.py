# SPDX-License-Identifier: MIT
"""Simulations: those that ran, and those that are composed of a simulation and of its frames, which were
measured with the published data path."""

import copy
import math
import statistics

from .quantities import NotMeasured, frame_range, seconds_by_round, weights_of

SOLVER = ("reduce", "assemble", "solve", "move")  # parts of a step after its contacts are found


class Simulation:
    """The steps of the last session of a file of 'tandem simulate --record'."""

    is_composed = False
    left_out = 0  # frames of a composition of which all rounds are disturbed
    is_disturbed = False  # whether these are all of its frames

    def __init__(self, lines_of_file, name, location):
        self.name, self.location = name, location
        # Steps of several sessions, of which each continues the one before. A repeated step replaces the
        # earlier one.
        steps = {line["step"]: line for line in lines_of_file if line["kind"] == "step"}
        self.steps = [steps[i] for i in sorted(steps)]
        self.run = [line for line in lines_of_file if line["kind"] == "run"][-1]

    @property
    def scene(self):
        return self.run["scene"]["name"]

    @property
    def label(self):
        """The scene's name in its step, which tells several runs of one scene apart: jacks, jacks1000."""
        return self.name.partition("-")[2]

    @property
    def method(self):
        return f"{self.run['algorithm']} {self.run['preset']}, k = {self.run['settings']['k']}"

    def first(self, count):
        """The same run, of which only the first `count` steps are used."""
        shorter = copy.copy(self)
        shorter.steps = self.steps[:count]
        return shorter

    def host(self, name):
        """Seconds of a part on the host, the steps by their weights; "step" is the total."""
        return sum(step.get("weight", 1) * step["host_ns"][name] for step in self.steps) / 1e9

    def stage(self, name, where=None):
        of = lambda stage: (
            (stage["device_ns"] or stage["host_ns"]) / 1e9
            if where is None
            else stage[where] / (1e9 if where.endswith("_ns") else 1)
        )
        return sum(
            step.get("weight", 1) * of(step["stages"][name]) for step in self.steps if name in step["stages"]
        )

    def curve(self, what):
        """One number per step. what: a field of a step, or "host:NAME" or "stage:NAME" for seconds."""
        if ":" not in what:
            return [step[what] for step in self.steps]
        kind, name = what.split(":")
        if kind == "host":
            return [step["host_ns"][name] / 1e9 for step in self.steps]
        stages = [step["stages"].get(name, {"device_ns": 0, "host_ns": 0}) for step in self.steps]
        return [(stage["device_ns"] or stage["host_ns"]) / 1e9 for stage in stages]


def frames_of(cell, name):
    """Seconds of a time by frame: the median of the rounds."""
    found = {}
    for own in cell.cells:
        first, last = frame_range(own)
        for frame in range(first, last + 1):
            values = seconds_by_round(own, name, (frame, frame)).values()
            found[frame] = statistics.median(values) if values else 0.0
    return found


def check_contacts(cell, steps):
    """Raises NotMeasured unless the steps found the contacts of the cell's frames, but for a hundredth of
    all: with other bounds, other pairs that touch exactly are candidates."""
    pairs = []
    for own in cell.cells:
        pairs += [
            (contacts, steps[frame]["contacts_found"])
            for frame, contacts in enumerate(own.work("contacts") or [], own.first_frame)
            if frame in steps
        ]
    unlike = [abs(contacts - found) for contacts, found in pairs if contacts != found]
    if sum(unlike) > 0.01 * sum(contacts for contacts, _ in pairs):
        raise NotMeasured(
            f"the simulation is another one: its contacts differ in {len(unlike)} of {len(pairs)} frames"
        )


def _stages(cell):
    """{frame: {stage: {"device_ns", "host_ns"}}} of a cell."""
    found = {}
    for own in cell.cells:
        first, last = frame_range(own)
        for frame in range(first, last + 1):
            at = lambda times: (times["frames"] or [0] * (frame + 1 - first))[frame - first]
            found[frame] = {
                name: {where: at(stage[where]) for where in ("device_ns", "host_ns")}
                for name, stage in own.record["stages"].items()
            }
    return found


def _with_frame(step, phases, stages):
    """A step whose contacts are found in these stages. phases: seconds of the whole frame, and of
    initialization and narrow phase as the release times them, unless the records lack these."""
    broad = stages.get("broad") or {"device_ns": 0, "host_ns": 0}
    host = {part: step["host_ns"][part] for part in SOLVER}
    found = {name: 1e9 * seconds for name, seconds in phases.items()}
    whole = found.pop("frame")
    times = {"step": whole + sum(host.values()), "broad": broad["device_ns"] or broad["host_ns"], **host}
    times["narrow"] = max(whole - times["broad"], 0)
    return {**step, "stages": stages, "host_ns": {**step["host_ns"], **times, **found}}


def _phases(cell):
    """{time: {frame: seconds}} of a cell's whole frames and phases."""
    found = {"frame": frames_of(cell, "frame")}
    try:
        return found | {name: frames_of(cell, name) for name in ("initialization", "narrow")}
    except NotMeasured:
        return found


def _undisturbed(cell):
    """The frames of a cell with a round that other work did not disturb."""
    clean = [own for own in cell.cells if own.rounds.keys() - own.disturbed]
    return {frame for own in clean for frame in range(own.first_frame, frame_range(own)[1] + 1)}


def composed(run, cell):
    """The steps of `run` that are frames of `cell`: the cell finds the contacts, and the other parts are
    those of the run. Disturbed frames are left out unless all are. Raises NotMeasured if the cell has other
    contacts. The weight of a step says how many it stands for, over their mean."""
    steps = {step["step"]: step for step in run.steps}
    check_contacts(cell, steps)
    seconds, stages = _phases(cell), _stages(cell)
    made = copy.copy(run)
    made.is_composed, made.name, made.location = (
        True,
        f"composed-{run.label}",
        f"{run.location} {cell.locations[0]}",
    )
    frames = sorted(set(stages) & set(steps))
    clean = sorted(_undisturbed(cell) & set(frames))
    made.left_out, made.is_disturbed = len(frames) - len(clean), not clean
    frames = clean or frames
    made.steps = [
        {
            **_with_frame(steps[i], {name: own[i] for name, own in seconds.items()}, stages[i]),
            "weight": weight,
        }
        for i, weight in zip(frames, weights_of(frames))
    ]
    made.run = {
        **run.run,
        "algorithm": cell.algorithm,
        "preset": cell.preset,
        "settings": cell.settings,
        "devices": [cell.device],
    }
    return made


def composed_share_of(run, composition):
    """Seconds of composed steps over those of a simulation with the same data path, in the steps that both
    have: (value, number of steps)."""
    real = {step["step"]: step["host_ns"]["step"] for step in run.steps}
    common = [step for step in composition.steps if step["step"] in real]
    if not common:
        return math.nan, 0
    return sum(step["host_ns"]["step"] for step in common) / sum(real[step["step"]] for step in common), len(
        common
    )
