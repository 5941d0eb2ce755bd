# SPDX-License-Identifier: MIT
"""Groups of cells with comparable times, ranked by speed."""
import dataclasses
import statistics

from .. import resampling
from ..comparison.naming import label

# Settings that determine the candidate pairs, and their default values, which titles leave out.
BOUNDS = {"k": "", "axes": "standard", "precision": "float", "rounding": "safe", "placement": "rounded", "origin": "world", "output": "pairs"}
ONE = resampling.Ratio(1.0, 1.0, 1.0, 0.0)


@dataclasses.dataclass
class Ranked:
    """A cell, compared with the fastest of its group. cell: its number. ratio: its time over that of the fastest. has_interval: both cells
    have enough rounds for an interval. is_distinguished: the interval does not contain 1."""
    cell: int
    ratio: resampling.Ratio = ONE
    has_interval: bool = False

    @property
    def is_distinguished(self):
        return self.has_interval and (self.ratio.low > 1 or self.ratio.high < 1)


@dataclasses.dataclass
class Group:
    """Cells of one scene, frame range, devices, bounds and output. cells: their numbers, in order. labels: the values in which they differ.
    ranked: correct cells without older records, the fastest first. answers_differ: ranked cells have different answers, so that none is the
    fastest."""
    title: str
    cells: list = dataclasses.field(default_factory=list)
    labels: list = dataclasses.field(default_factory=list)
    ranked: list = dataclasses.field(default_factory=list)
    answers_differ: bool = False


def _bounds(recorded):
    return {name: recorded.settings.get(name, usual) for name, usual in BOUNDS.items()}


def _key(cell):
    recorded = cell.recorded
    return (cell.scene_digest, cell.scene, *(recorded.names[name] for name in ("devices", "model", "driver", "frames", "handling")),
            *_bounds(recorded).values())


def _title(cell, scene):
    names = cell.recorded.names
    parts = [scene, names["frames"], *(f"{name} = {value}" for name, value in _bounds(cell.recorded).items() if value != BOUNDS[name])]
    parts += [names["handling"]] if names["handling"] else []
    return f"{', '.join(parts)}, on {names['devices']} ({names['model']})"


def _is_rankable(cell):
    recorded = cell.recorded
    has_pairs = recorded.pairs is None or recorded.pairs.count > 0
    return recorded.status == "ok" and bool(recorded.rounds) and not cell.is_older and has_pairs


def _ranked(number, base, cell):
    """Compares a cell with the fastest one. Within one session, rounds of equal number are pairs, because they were measured side by side."""
    old, new = base.recorded, cell.recorded
    common = [at for at in new.rounds if at in old.rounds] if old.session and old.session == new.session else []
    if common:
        ratio = resampling.paired_ratio([old.rounds[at] for at in common], [new.rounds[at] for at in common])
        return Ranked(number, ratio, len(common) > 1)
    return Ranked(number, resampling.unpaired_ratio(old.times(), new.times()), min(len(old.rounds), len(new.rounds)) > 1)


def _rank(group, cells):
    rankable = [number for number in group.cells if _is_rankable(cells[number])]
    answers = {cells[number].recorded.pairs for number in rankable} - {None}
    group.answers_differ = len(answers) > 1
    fastest, *rest = sorted(rankable, key=lambda number: (statistics.median(cells[number].recorded.times()), number)) or [None]
    if fastest is not None:
        group.ranked = [Ranked(fastest), *(_ranked(number, cells[fastest], cells[number]) for number in rest)]


def groups_of(cells):
    """Groups of all cells. A title has the name of the scene if it is unique, otherwise the key."""
    groups, digests = {}, {}
    for cell in cells:
        digests.setdefault(cell.scene_name, set()).add(cell.scene_digest)
    for number, cell in enumerate(cells):
        scene = cell.scene_name if len(digests[cell.scene_name]) == 1 else cell.scene
        groups.setdefault(_key(cell), Group(_title(cell, scene))).cells.append(number)
    for group in groups.values():
        _rank(group, cells)
        group.labels = label([cells[number].recorded for number in group.cells])[0]
    return list(groups.values())
