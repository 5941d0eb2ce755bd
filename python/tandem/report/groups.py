# SPDX-License-Identifier: MIT
"""Groups of cells with comparable times, ranked by speed."""

import dataclasses

from ..cell import BOUNDS
from ..comparison.naming import label
from ..verdicts import verdict_of


@dataclasses.dataclass
class Group:
    """Cells of one scene, frame range, devices, bounds and output. title: all of these; row: the scene, and what
    else distinguishes the groups; key: the scene's. cells: their numbers, in order. labels: the values in which they
    differ. ranked: verdicts.Ranked of correct cells without older records, the fastest first. answers_differ: ranked
    cells have different answers, so that none is the fastest. has_bad_cells: a cell failed or is wrong."""

    title: str
    key: str = ""
    row: str = ""
    cells: list = dataclasses.field(default_factory=list)
    labels: list = dataclasses.field(default_factory=list)
    ranked: list = dataclasses.field(default_factory=list)
    answers_differ: bool = False
    has_bad_cells: bool = False

    @property
    def is_informative(self):
        """Whether it has a comparison or an error."""
        return len(self.ranked) > 1 or self.has_bad_cells

    def label(self, number):
        return self.labels[self.cells.index(number)]


def _bounds(cell):
    return {name: cell.described.get(name, usual) for name, usual in BOUNDS.items()}


def _key(cell):
    return (
        cell.scene_digest,
        cell.scene,
        *(cell.names[name] for name in ("devices", "model", "driver", "frames", "handling")),
        *_bounds(cell).values(),
    )


def _parts(cell, scene):
    """What a cell's group is of: the scene first."""
    names = cell.names
    bounds = (f"{name} = {value}" if value != BOUNDS[name] else "" for name, value in _bounds(cell).items())
    return [scene, names["frames"], *bounds, names["handling"], f"on {names['devices']} ({names['model']})"]


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


def _rows(parts):
    """A text for each group, of its _parts and then of driver and digest: the scene, and those parts that distinguish it
    from groups whose text so far is the same."""
    scenes, *others = zip(*parts)
    rows = list(scenes)
    for texts in others:
        known = {}
        for row, text in zip(rows, texts):
            known.setdefault(row, set()).add(text)
        rows = [f"{row}, {text}" if text and len(known[row]) > 1 else row for row, text in zip(rows, texts)]
    return rows


def groups_of(cells, verdicts=None):
    """Groups of all cells, ranked by `verdicts`, the RecordedVerdicts of their files, where there are some. A
    scene has its name if that is unique, otherwise its key."""
    groups, digests, parts = {}, {}, {}
    for cell in cells:
        digests.setdefault(cell.names["scene"], set()).add(cell.scene_digest)
    for number, cell in enumerate(cells):
        name, key = cell.names["scene"], _key(cell)
        own = _parts(cell, name if len(digests[name]) == 1 else cell.scene)
        group = groups.setdefault(key, Group(", ".join(filter(None, own)), cell.scene))
        group.cells.append(number)
        parts.setdefault(key, [*own, cell.names["driver"], cell.names["digest"]])
    for group, row in zip(groups.values(), _rows([*parts.values()]) if parts else []):
        group.row = row
        _rank(group, cells, verdicts)
        group.labels = label([cells[number] for number in group.cells])[0]
    return list(groups.values())
