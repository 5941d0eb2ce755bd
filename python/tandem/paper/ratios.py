# SPDX-License-Identifier: MIT
"""Ratios of quantities of cells over their common frames, with 95 % intervals. Cells that were measured side
by side in several rounds are compared round by round. With one round for each of several frames, the frames
are the samples."""

import math
import statistics

from .. import resampling
from .quantities import NotMeasured, count_of, frame_range, is_time, seconds_by_round, weights_of
from .rules import Measured, exact

LEAST_FRAMES = 5  # frames that are measured once each and still give an interval


def common_frames(above, below):
    """[(cell, cell, (first, last))] of the frames that both cells have, of one recording if they are of
    one scene. Raises NotMeasured."""
    pairs, alike = [], above.scene == below.scene
    for a in above.cells:
        for b in below.cells:
            first, last = (pick(ends) for pick, ends in zip((max, min), zip(frame_range(a), frame_range(b))))
            if first <= last and (not alike or a.scene_digest == b.scene_digest):
                pairs.append((a, b, (first, last)))
    if not pairs:
        raise NotMeasured("the cells have no frames of one recording in common")
    return pairs


def frames_text(pairs):
    """ "frames 20:121", "11 frames of 20:120"."""
    count = sum(last - first + 1 for *_, (first, last) in pairs)
    first, last = min(frames[0] for *_, frames in pairs), max(frames[1] for *_, frames in pairs)
    return f"frames {first}:{last}" if count == last - first + 1 else f"{count} frames of {first}:{last}"


class Sampled:
    """A time of one side, for each pair of cells: its value in every undisturbed round."""

    def __init__(self, cells, name):
        self.rounds, self.left_out = [], 0
        for cell, frames in cells:
            found = seconds_by_round(cell, name, frames) or dict.fromkeys(cell.rounds, 0.0)
            clean = {number: value for number, value in found.items() if number not in cell.disturbed}
            self.left_out += len(found) - len(clean)
            self.rounds.append(clean)

    def is_present(self):
        return any(any(own.values()) for own in self.rounds)

    def common(self):
        """Numbers of the rounds that all cells have."""
        return sorted(set.intersection(*map(set, self.rounds)))

    def sums(self, numbers):
        return [sum(own[number] for own in self.rounds) for number in numbers]

    def by_frame(self):
        """The median over the rounds of each cell."""
        return [statistics.median(own.values()) if own else None for own in self.rounds]


def _of_times(pairs, above, below, locations):
    top = Sampled([(a, frames) for a, _, frames in pairs], above)
    bottom = Sampled([(b, frames) for _, b, frames in pairs], below)
    left_out, text = top.left_out + bottom.left_out, frames_text(pairs)
    if not (top.is_present() and bottom.is_present()) and not left_out:
        raise NotMeasured("a stage of this claim took no time")
    make = lambda found, samples, basis: Measured(*found, samples, left_out, basis, text, locations)
    side_by_side = all(a.session and a.session == b.session for a, b, _ in pairs)
    common = sorted(set(top.common()) & set(bottom.common()))
    if side_by_side and len(common) > 1:
        found = resampling.paired_ratio(bottom.sums(common), top.sums(common))
        return make((found.value, found.low, found.high), len(common), "rounds side by side")
    if not side_by_side and min(len(top.common()), len(bottom.common())) > 1:
        found = resampling.unpaired_ratio(bottom.sums(bottom.common()), top.sums(top.common()))
        return make(
            (found.value, found.low, found.high), min(len(top.common()), len(bottom.common())), "rounds"
        )
    weights = _weights(pairs)
    weighted = lambda values: [
        None if value is None else value * weight for value, weight in zip(values, weights)
    ]
    return _of_frames(weighted(top.by_frame()), weighted(bottom.by_frame()), make)


def _weights(pairs):
    """How many steps each frame stands for; 1 for ranges of frames."""
    if any(first != last for *_, (first, last) in pairs):
        return [1] * len(pairs)
    numbers = sorted({first for *_, (first, _) in pairs})
    weight_of = dict(zip(numbers, weights_of(numbers)))
    return [weight_of[first] for *_, (first, _) in pairs]


def _of_frames(top, bottom, make):
    """From one round for each frame. Frames with disturbed rounds only leave the ratio without samples."""
    known = [(a, b) for a, b in zip(top, bottom) if a is not None and b is not None]
    above, below = ([pair[side] for pair in known if any(pair)] for side in (0, 1))
    if not sum(below):
        return make((math.nan,) * 3, 0, "disturbed samples only")
    if len(known) == len(top) and len(above) >= LEAST_FRAMES:
        *found, independent = resampling.ratio_of_sums(below, above)
        return make(found, independent, f"blocks of neighbouring frames, one round of each of {len(above)}")
    value = sum(above) / sum(below)
    return make((value, value, value), 1, "one sample")


def ratio_of(above, above_name, below, below_name):
    """The quantity of one cell over that of another, or of the same, as a Measured. Raises NotMeasured."""
    pairs = common_frames(above, below)
    locations = tuple(dict.fromkeys((above.locations[0], below.locations[0])))
    if is_time(above_name) != is_time(below_name):
        raise NotMeasured(f"{above_name} is no quantity to compare with {below_name}")
    if is_time(above_name):
        return _of_times(pairs, above_name, below_name, locations)
    top = sum(count_of(a, above_name, frames) for a, _, frames in pairs)
    bottom = sum(count_of(b, below_name, frames) for _, b, frames in pairs)
    if not bottom:
        raise NotMeasured("a count to divide by is 0")
    return exact(top / bottom, locations, frames_text(pairs))
