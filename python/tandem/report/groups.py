# SPDX-License-Identifier: MIT
"""Groups of cells with comparable times, ranked by speed."""

import dataclasses

from ..cell import BOUNDS
from ..comparison.naming import label
from ..verdicts import verdict_of


@dataclasses.dataclass
class Group:
    """Cells of one scene, frame range, devices, bounds and output. cells: their numbers, in order. labels:
    the values in which they differ. ranked: verdicts.Ranked of correct cells without older records, the
    fastest first. answers_differ: ranked cells have different answers, so that none is the fastest.
    has_bad_cells: a cell failed or is wrong."""

    title: str
    cells: list = dataclasses.field(default_factory=list)
    labels: list = dataclasses.field(default_factory=list)
    ranked: list = dataclasses.field(default_factory=list)
    answers_differ: bool = False
    has_bad_cells: bool = False

    @property
    def is_informative(self):
        """Whether it has a comparison or an error."""
        return len(self.ranked) > 1 or self.has_bad_cells


def _bounds(cell):
    return {name: cell.described.get(name, usual) for name, usual in BOUNDS.items()}


def _key(cell):
    return (
        cell.scene_digest,
        cell.scene,
        *(cell.names[name] for name in ("devices", "model", "driver", "frames", "handling")),
        *_bounds(cell).values(),
    )


def _title(cell, scene):
    names = cell.names
    parts = [
        scene,
        names["frames"],
        *(f"{name} = {value}" for name, value in _bounds(cell).items() if value != BOUNDS[name]),
    ]
    parts += [names["handling"]] if names["handling"] else []
    return f"{', '.join(parts)}, on {names['devices']} ({names['model']})"


def is_rankable(cell):
    """Whether a cell has times of correct work."""
    has_pairs = cell.pairs is None or cell.pairs.count > 0
    return cell.status == "ok" and bool(cell.rounds) and not cell.is_older and has_pairs


def _rank(group, cells, recorded):
    rankable = [number for number in group.cells if is_rankable(cells[number])]
    verdict = verdict_of([cells[number] for number in rankable], recorded)
    group.has_bad_cells = any(cells[number].status != "ok" for number in group.cells)
    group.answers_differ = verdict.answers_differ
    group.ranked = [dataclasses.replace(one, cell=rankable[one.cell]) for one in verdict.cells]


def groups_of(cells, verdicts=None):
    """Groups of all cells, ranked by `verdicts`, the RecordedVerdicts of their files, where there are some. A
    title has the name of the scene if it is unique, otherwise the key."""
    groups, digests = {}, {}
    for cell in cells:
        digests.setdefault(cell.scene_name, set()).add(cell.scene_digest)
    for number, cell in enumerate(cells):
        scene = cell.scene_name if len(digests[cell.scene_name]) == 1 else cell.scene
        groups.setdefault(_key(cell), Group(_title(cell, scene))).cells.append(number)
    for group in groups.values():
        _rank(group, cells, verdicts)
        group.labels = label([cells[number] for number in group.cells])[0]
    return list(groups.values())
