# SPDX-License-Identifier: MIT
"""Quantities of a record of a cell, by the names that claims use: times in seconds for each round, and
counts.

Names of statements/timers.toml are what the paper's release times by that name, such as "narrow". Other
times: "frame" (whole frames), "breakdown" (whole frames of replays that time every command, of which all
stages and phases are parts), "stages:A+B" (sums of stages: device time, or host time of stages without it),
"largest:A+B" and "sum:A+B" (the largest and the sum of these timers), "host work:A+B" and "phases:A+B" (what
the host did, and regions of a frame, with these names). Counts: "launches", "launches:A+B" of stages,
"release launches" (as the paper's release counts), "bytes:A+B", "bytes for each launch:A+B" (launches of all
stages), "counter:NAME", "contacts", "pairs", "body pairs", "batches" (of one frame because memory is short),
"bodies", "vertices", "tetrahedra"."""

import statistics

from ..fields import at
from .methods import timers

TIMES = ("frame", "breakdown", "stages", "largest", "sum", "host work", "phases")
LISTS = {
    "contacts": "contacts",
    "pairs": "candidate_pairs",
    "body pairs": "body_pairs",
}  # fields of `work` with a count for each frame
OF_SCENES = ("bodies", "vertices", "tetrahedra")
ITEM_BYTES = 12  # of a pair of nodes in a queue
OLDER = "records of an older program, without "
REGIONS = {"phases": "the phases that the release times", "host_work": "the names of host work"}


class NotMeasured(Exception):
    """The records lack what a claim needs. The message is the reason for the verdict "untested"."""


def resolved(name):
    """The quantity that a name of timers.toml stands for; other names are quantities."""
    timer = timers().get(name)
    if timer is None:
        return name
    if "ours" not in timer:
        raise NotMeasured(f"no record of a cell has {name}")
    return timer["ours"]


def is_time(name):
    return resolved(name).partition(":")[0] in TIMES


def frame_range(cell):
    return cell.first_frame, cell.last_frame


def weights_of(frames):
    """How many steps each of these ascending frames stands for, as a share of their mean: those nearest to
    it. All 1 for evenly spaced frames."""
    gaps = [later - earlier for earlier, later in zip(frames, frames[1:])] or [1]
    widths = [before + after for before, after in zip([gaps[0], *gaps], [*gaps, gaps[-1]])]
    return [width * len(frames) / sum(widths[: len(frames)]) for width in widths[: len(frames)]]


def _places(cell, frames):
    """Indices of frames FIRST to LAST in per-frame lists of a record; None for all of its frames."""
    first, last = frame_range(cell)
    return None if (first, last) == frames else range(frames[0] - first, frames[1] - first + 1)


def _whole_frames(cell, frames):
    places = _places(cell, frames)
    if places is None:
        return {number: ns / 1e9 for number, ns in cell.rounds.items()}
    total, by_round = cell.record["total_ns"], {}
    for number, sample in zip(total["rounds"], total["frames"]):
        by_round.setdefault(number, []).append(sum(sample[i] for i in places))
    return {number: statistics.median(own) / 1e9 for number, own in by_round.items()}


def _each_round(cell, times, frames):
    """Seconds for each round: replays that time every command are one for each round, in their order."""
    places = _places(cell, frames)
    samples = times["samples"] if places is None else [sum(times["frames"][i] for i in places)]
    return {number: ns / 1e9 for number, ns in zip(cell.rounds, samples)}


def _stage(cell, name, frames):
    stage = cell.record["stages"].get(name)
    if stage is None:
        return {}
    return _each_round(cell, stage["device_ns"] if stage["device_ns"]["median"] else stage["host_ns"], frames)


def _region(cell, field, name, frames):
    """Times of host work or of a phase with that name."""
    regions = cell.record.get(field)
    if not regions:
        raise NotMeasured(OLDER + REGIONS[field])
    times = regions.get(name, {}).get("host_ns")
    if times is None:
        return {}
    if _places(cell, frames) is not None and not times.get("frames"):
        raise NotMeasured("host work and phases are not recorded for each frame")
    return _each_round(cell, times, frames)


def _combined(parts, combine):
    """One value for each round that all parts with values have."""
    known = [part for part in parts if part]
    if not known:
        return {}
    common = set.intersection(*(set(part) for part in known))
    return {number: combine([part[number] for part in known]) for number in sorted(common)}


def seconds_by_round(cell, name, frames):
    """A time by the number of its round, disturbed rounds included; empty if the record has no such stage."""
    kind, _, rest = resolved(name).partition(":")
    names = rest.split("+")
    if kind == "frame":
        return _whole_frames(cell, frames)
    if kind == "breakdown":
        return _each_round(cell, cell.record["breakdown_ns"], frames)
    if kind in ("largest", "sum"):
        parts = [seconds_by_round(cell, one, frames) for one in names]
        return _combined(parts, max if kind == "largest" else sum)
    if kind == "stages":
        return _combined([_stage(cell, stage, frames) for stage in names], sum)
    field = kind.replace(" ", "_")
    return _combined([_region(cell, field, one, frames) for one in names], sum)


def _in_frames(values, cell, frames):
    if values is None:
        raise NotMeasured("counts of work were not recorded")
    places = _places(cell, frames)
    return sum(values if places is None else (values[i] for i in places))


def _whole_only(cell, frames):
    if _places(cell, frames) is not None:
        raise NotMeasured("launches and bytes are not recorded for each frame")


def _of_stages(cell, stages, what):
    return sum(stage[what] for name, stage in cell.record["stages"].items() if not stages or name in stages)


def count_of(cell, name, frames):
    """A count of a record in these frames. Raises NotMeasured."""
    kind, _, rest = resolved(name).partition(":")
    if kind in OF_SCENES:
        return cell.record["scene"][kind]
    if kind in LISTS:
        return _in_frames(cell.work(LISTS[kind]), cell, frames)
    if kind == "batches":
        return at(cell.record, "work", "batches") / cell.frames
    if kind == "bytes for each launch":
        return _of_stages(cell, rest.split("+"), "bytes") / _of_stages(cell, (), "launches")
    _whole_only(cell, frames)
    if kind in ("launches", "bytes"):
        return _of_stages(cell, rest.split("+") if rest else (), kind)
    found = cell.release_launches if kind == "release launches" else at(cell.record, "work", "counters", rest)
    if found is None:
        raise NotMeasured("the records have no such count")
    return found


def _groups_of(cell):
    """Work-groups of gProximity, each with a queue. With sizes=release they are as many as 2048 work-items
    for each compute unit make, the release's rule for its global size."""
    groups = int(cell.settings.get("groups") or 0)
    if groups == 0 and cell.settings.get("sizes") == "release":
        local = int(cell.settings["group_size"])
        groups = max(2048 * cell.record["devices"][0]["compute_units"], local) // local
    return groups


def batch_size(cell):
    """Body pairs of a batch of gProximity; 0 if a batch has all. With sizes=release each group has one."""
    size = int(cell.settings.get("batch") or 0)
    return size or (_groups_of(cell) if cell.settings.get("sizes") == "release" else 0)


def batches_of(cell, frames):
    """Number of batches of gProximity in these frames, which takes a limited number of body pairs at a time;
    None if unknown."""
    size, pairs = batch_size(cell), cell.work("body_pairs")
    if not size or not pairs:
        return None
    places = _places(cell, frames)
    return sum(-(-count // size) for count in (pairs if places is None else (pairs[i] for i in places)))


def check_queues(cell):
    """Raises NotMeasured if a bounded queue array makes every launch of gProximity end after one round, as
    the release's does not. The release ends a launch when two rounds and a full local queue might not fit
    into a queue any more; a local queue holds at least a round."""
    groups, size = _groups_of(cell), cell.settings.get("queue_bytes", "device")
    if cell.algorithm != "gproximity" or not groups or size == "device":
        return
    round_ = int(cell.settings["group_size"])
    if int(size) // (ITEM_BYTES * groups) <= 2 * round_ + max(round_, int(cell.settings["local_queue"])):
        raise NotMeasured(f"with queue_bytes={size}, every launch of gProximity ends after one round")
