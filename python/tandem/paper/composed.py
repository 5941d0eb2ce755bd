# SPDX-License-Identifier: MIT
"""Values that are composed of two measurements, because the whole takes too long: gProximity's batches with
its release's whole queue array, and steps of a simulation whose frames were measured apart."""

import math
import statistics

from .. import resampling
from .quantities import NotMeasured, batches_of, frame_range, seconds_by_round, weights_of
from .ratios import common_frames, frames_text
from .rules import Measured
from .simulation import check_contacts, frames_of


def _uploads_of(case):
    """(seconds of the upload of one batch in each undisturbed round, number of disturbed rounds) of a case
    with the whole queue array."""
    if not case.batches:
        raise NotMeasured("the cell with the whole queue array has no number of batches")
    found = [seconds_by_round(cell, "stages:write", frame_range(cell)) for cell in case.cells]
    clean = [
        {number: value for number, value in own.items() if number not in cell.disturbed}
        for own, cell in zip(found, case.cells)
    ]
    common = sorted(set.intersection(*map(set, clean)))
    return [sum(own[number] for own in clean) / case.batches for number in common], sum(
        map(len, found)
    ) - sum(map(len, clean))


def uploads_of(arrays):
    """The same for several cells, of runs of their own."""
    found = [_uploads_of(cell) for cell in arrays]
    return [seconds for uploads, _ in found for seconds in uploads], sum(left_out for _, left_out in found)


def _middle_sum(cells, name):
    """Sum over (cell, frames) of the median of a time over all rounds."""
    return sum(
        statistics.median(list(seconds_by_round(cell, name, frames).values()) or [0.0])
        for cell, frames in cells
    )


def _all_frames(case):
    return [(cell, frame_range(cell)) for cell in case.cells]


def _batches(cells):
    found = [batches_of(cell, frames) for cell, frames in cells]
    if not all(found):
        raise NotMeasured("the number of batches was not recorded")
    return sum(found)


def _with_interval(values, left_out, locations, frames):
    basis = "uploads of one array, times the number of batches (composed)"
    if not values:
        return Measured(math.nan, math.nan, math.nan, 0, left_out, basis, frames, locations)
    low, high = resampling.median_interval(values) if len(values) > 1 else (values[0], values[0])
    return Measured(statistics.median(values), low, high, len(values), left_out, basis, frames, locations)


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

    def seconds(self, frames):
        """The sum over (first, last) of frames."""
        numbers = [number for first, last in frames for number in range(first, last + 1)]
        if not set(numbers) <= set(self._seconds):
            raise NotMeasured("the simulation has not all of the measured frames")
        return sum(self._seconds[number] for number in numbers)


def ratio_with_array(other, other_name, own, own_name, arrays, rest=None):
    """A time of `other`, with an upload of the whole array for each of its batches, over a time of `own` in
    their common frames. Both with the `rest` of their steps, if there is one."""
    pairs = common_frames(other, own)
    above, below = [(a, frames) for a, _, frames in pairs], [(b, frames) for _, b, frames in pairs]
    uploads, left_out = uploads_of(arrays)
    base, divisor, batches = _middle_sum(above, other_name), _middle_sum(below, own_name), _batches(above)
    more = rest.seconds([frames for *_, frames in pairs]) if rest else 0
    values = [(base + batches * upload + more) / (divisor + more) for upload in uploads]
    locations = (
        own.locations[0],
        other.locations[0],
        *(cell.locations[0] for cell in arrays),
        *([rest.location] if rest else []),
    )
    return _with_interval(values, left_out, locations, frames_text(pairs))


def share_with_array(other, above_name, below_name, arrays):
    """A time of a cell over another time of it, both with an upload of the whole array for each batch."""
    uploads, left_out = uploads_of(arrays)
    cells = _all_frames(other)
    above, below, batches = (_middle_sum(cells, above_name), _middle_sum(cells, below_name), _batches(cells))
    values = [(above + batches * upload) / (below + batches * upload) for upload in uploads]
    return _with_interval(
        values,
        left_out,
        (other.locations[0], *(cell.locations[0] for cell in arrays)),
        f"{other.frames} of {other.first}:{other.last}",
    )


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
    sides = [
        [weight * (seconds[f] + parts(f, names)) for f, weight in zip(common, weights_of(common))]
        for seconds, names in ((whole, parts_below), (above, parts_above))
    ]
    found = resampling.ratio_of_sums(*sides)
    disturbed = sum(len(own.disturbed) for own in cell.cells)
    return Measured(
        *found,
        0 if disturbed else len(common),
        disturbed,
        "frames and steps, one sample each (composed)",
        f"{len(common)} steps of {common[0]}:{common[-1]}",
        (cell.locations[0], run.location),
    )
