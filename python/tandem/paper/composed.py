# SPDX-License-Identifier: MIT
"""Values that are composed of several measurements, because the whole takes too long: gProximity's batches
with its release's whole queue array, and steps of a simulation whose frames were measured apart. Their
intervals draw every part anew: rounds or frames of both sides, uploads, and steps of a simulation by blocks
of neighbouring steps, because these depend on each other (resampling.Part)."""

import dataclasses

import numpy

from .. import resampling
from .quantities import NotMeasured, batches_of, frame_range, weights_of
from .ratios import LEAST_FRAMES, Sampled, common_frames, frames_text
from .rules import Measured
from .simulation import check_contacts, frames_of


def _uploads_of(case):
    """(seconds of the upload of one batch in each undisturbed round, number of disturbed rounds) of a case
    with the whole queue array."""
    if not case.batches:
        raise NotMeasured("the cell with the whole queue array has no number of batches")
    found = Sampled([(cell, frame_range(cell)) for cell in case.cells], "write")
    return [seconds / case.batches for seconds in found.sums(found.common())], found.left_out


def _apart(arrays, pairs):
    """Those cases with the whole array that were not measured in a frame of these (cell, frames), because a
    value cannot be composed of itself."""
    frames_of_cell = lambda cell, frames: {
        (cell.scene_digest, frame) for frame in range(frames[0], frames[1] + 1)
    }
    used = set().union(*(frames_of_cell(cell, frames) for cell, frames in pairs))
    kept = [
        case
        for case in arrays
        if not any(used & frames_of_cell(cell, frame_range(cell)) for cell in case.cells)
    ]
    if not kept:
        raise NotMeasured(
            "the upload of the whole queue array was measured in a frame that it would be added to"
        )
    return kept


def _beyond(case, array):
    """The share of the whole array that a case with a bounded one does not upload already."""
    size, whole = case.settings.get("queue_bytes"), array.sum("bytes") / array.batches
    return 1 if size == "device" or not whole else max(1 - int(size) / whole, 0)


class Uploads:
    """The upload of the whole queue array that each batch of a case lacks, over cases `arrays` of runs of
    their own."""

    def __init__(self, arrays, case, pairs):
        found = []
        self.left_out = 0
        self.cases = _apart(arrays, pairs)
        for array in self.cases:
            seconds, left_out = _uploads_of(array)
            found += [_beyond(case, array) * one for one in seconds]
            self.left_out += left_out
        self.part = resampling.part(found)


@dataclasses.dataclass(frozen=True)
class Sides:
    """The times of both sides as parts to draw from. totals: from values of the parts, (above, below, number
    of batches)."""

    parts: list
    totals: object
    basis: str
    left_out: int


def _sides(pairs, above, below):
    """Sides of (cell, cell, frames): over the rounds of all cells, or over frames with one round each."""
    top = Sampled([(a, frames) for a, _, frames in pairs], above)
    bottom = Sampled([(b, frames) for _, b, frames in pairs], below)
    batches = [batches_of(a, frames) for a, _, frames in pairs]
    if None in batches:
        raise NotMeasured("the number of batches was not recorded")
    if not (bottom.is_present() or bottom.left_out):
        raise NotMeasured("a stage of this claim took no time")
    together = all(a.session and a.session == b.session for a, b, _ in pairs)
    numbers = [top.common(), bottom.common()]
    if together:
        numbers = [sorted(set.intersection(*map(set, numbers)))] * 2
    left_out = top.left_out + bottom.left_out
    if min(map(len, numbers)) != 1 or len(pairs) < LEAST_FRAMES:
        rows = [top.sums(numbers[0]), bottom.sums(numbers[1])]
        parts = [resampling.part(*rows)] if together else [resampling.part(row) for row in rows]
        middle = lambda *values: (
            *(numpy.median(row, axis=-1) for part in values for row in part),
            sum(batches),
        )
        return Sides(parts, middle, "rounds", left_out)
    rows = resampling.part(top.by_frame(), bottom.by_frame(), batches, in_order=True)
    return Sides([rows], lambda values: tuple(row.sum(axis=-1) for row in values), "frames", left_out)


class Rest:
    """The other parts of the steps of a simulation whose frames were measured apart. Raises NotMeasured if a
    cell of them has other contacts."""

    def __init__(self, run, cell, parts):
        self.location = run.location
        steps = {step["step"]: step for step in run.steps}
        check_contacts(cell, steps)
        self._seconds = {
            number: sum(step["host_ns"][part] for part in parts) / 1e9 for number, step in steps.items()
        }

    def part(self, frames):
        """The steps of (first, last) of frames, in their order."""
        numbers = sorted(number for first, last in frames for number in range(first, last + 1))
        if not set(numbers) <= set(self._seconds):
            raise NotMeasured("the simulation has not all of the measured frames")
        return resampling.part([self._seconds[number] for number in numbers], in_order=True)


def _measured(statistic, parts, names, left_out, frames, locations):
    """A composed value. names: what the samples of each part are."""
    if not all(part.values.shape[-1] for part in parts):
        value, samples = (float("nan"),) * 3, 0
    else:
        *value, samples = resampling.of_parts(statistic, parts)
    basis = f"samples or more of each part: {', '.join(dict.fromkeys(names))} (composed)"
    return Measured(*value, samples, left_out, basis, frames, tuple(dict.fromkeys(locations)))


def ratio_with_array(other, other_name, own, own_name, arrays, rest=None):
    """A time of `other`, with an upload of the whole array for each of its batches, over a time of `own` in
    their common frames. Both with the `rest` of their steps, if there is one."""
    pairs = common_frames(other, own)
    sides = _sides(pairs, other_name, own_name)
    uploads = Uploads(arrays, other, [(a, frames) for a, _, frames in pairs])
    steps = [rest.part([frames for *_, frames in pairs])] if rest else []

    def of(*values):
        above, below, batches = sides.totals(*values[: len(sides.parts)])
        upload, *more = values[len(sides.parts) :]
        more = more[0][0].sum(axis=-1) if more else 0
        return (above + batches * numpy.median(upload[0], axis=-1) + more) / (below + more)

    names = [sides.basis, "uploads", *(f"blocks of {part.block} steps" for part in steps)]
    cases = (own, other, *uploads.cases)
    locations = [*(case.locations[0] for case in cases), *([rest.location] if rest else [])]
    parts = [*sides.parts, uploads.part, *steps]
    return _measured(of, parts, names, sides.left_out + uploads.left_out, frames_text(pairs), locations)


def share_with_array(other, above_name, below_name, arrays):
    """A time of a cell over another time of it, both with an upload of the whole array for each batch."""
    pairs = [(cell, cell, frame_range(cell)) for cell in other.cells]
    sides = _sides(pairs, above_name, below_name)
    uploads = Uploads(arrays, other, [(cell, frames) for cell, _, frames in pairs])

    def of(*values):
        above, below, batches = sides.totals(*values[:-1])
        more = batches * numpy.median(values[-1][0], axis=-1)
        return (above + more) / (below + more)

    locations = [case.locations[0] for case in (other, *uploads.cases)]
    left_out, names = sides.left_out + uploads.left_out, [sides.basis, "uploads"]
    frames = f"{other.frames} of {other.first}:{other.last}"
    return _measured(of, [*sides.parts, uploads.part], names, left_out, frames, locations)


def step_share(cell, above_name, run, parts_above, parts_below):
    """The share of a part of a simulated step whose contacts are found as the cell does. The other parts are
    those of the simulation `run`, which found the same contacts. Each frame stands for the steps nearest to
    it. parts_above, parts_below: parts of a step on the host, beside the cell's time and its whole frame."""
    above, whole = frames_of(cell, above_name), frames_of(cell, "frame")
    steps = {step["step"]: step for step in run.steps}
    common = sorted(set(whole) & set(steps))
    if not common:
        raise NotMeasured("the simulation has none of the measured frames")
    check_contacts(cell, steps)
    parts = lambda frame, names: sum(steps[frame]["host_ns"][name] for name in names) / 1e9
    rows = [
        [weight * (seconds[f] + parts(f, names)) for f, weight in zip(common, weights_of(common))]
        for seconds, names in ((whole, parts_below), (above, parts_above))
    ]
    part = resampling.part(*rows, in_order=True)
    disturbed = sum(len(own.disturbed) for own in cell.cells)
    found = _measured(
        lambda values: values[1].sum(axis=-1) / values[0].sum(axis=-1),
        [part],
        [f"blocks of {part.block} frames with their steps"],
        disturbed,
        f"{len(common)} steps of {common[0]}:{common[-1]}",
        (cell.locations[0], run.location),
    )
    return dataclasses.replace(found, samples=0) if disturbed else found
