# SPDX-License-Identifier: MIT
"""Sweeps: cells that differ only in one numeric setting, as lines of a chart, with the verdict on their
times."""

import dataclasses
import itertools
import math

from ..cell import BOUNDS
from ..verdicts import verdict_of
from .groups import is_rankable
from .leads import Named, title
from .numbers import digits
from .sentences import method_of

MAX_LINES = 8  # of a chart, the first ones
MAX_SWEEPS = 100
MIN_POINTS = 3


@dataclasses.dataclass
class _Line:
    """method, rest: what all its cells share; rest: settings without the swept one. points: number of a cell by
    value."""

    method: str
    rest: dict
    points: dict = dataclasses.field(default_factory=dict)


def _value(text):
    """The number of a text; None for other texts."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _swept(cells, numbers):
    """Names of settings that are numbers in all these cells and have at least MIN_POINTS values."""
    values = {}
    for number in numbers:
        for name, value in cells[number].described.items():
            values.setdefault(name, set()).add(value)
    return [
        name for name, found in values.items() if len(found) >= MIN_POINTS and None not in map(_value, found)
    ]


def _is_of_scene(setting, cell):
    return f"{setting}=" in cell.scene


def _of(setting, cell):
    """What a chart is of: cells of one scene with equal pairs, as far as the setting does not change them."""
    names, bounds = cell.names, {} if setting in BOUNDS else cell.described
    parts = [cell.scene_name if _is_of_scene(setting, cell) else names["scene"], names["frames"]]
    parts += [
        f"{name} = {bounds[name]}" for name, usual in BOUNDS.items() if bounds.get(name, usual) != usual
    ]
    return ", ".join([*parts, f"on {names['devices']} ({names['model']})"])


def _lines(setting, cells, numbers):
    """{what a chart is of: its lines of at least MIN_POINTS points}. Parameters of scenes are settings here,
    too."""
    lines, charts = {}, {}
    for number in numbers:
        cell = cells[number]
        if setting in cell.described:
            rest = {name: value for name, value in cell.described.items() if name != setting}
            names = [method_of(cell), cell.names["driver"], cell.names["handling"]]
            line = lines.setdefault(
                (_of(setting, cell), *names, *sorted(rest.items())), _Line(names[0], rest)
            )
            line.points[_value(cell.described[setting])] = number
    for (of, *_), line in lines.items():
        if len(line.points) >= MIN_POINTS:
            charts.setdefault(of, []).append(line)
    return charts


def _line_names(lines):
    """The method, and those settings in which lines of the same method differ."""
    for line in lines:
        alike = [other for other in lines if other.method == line.method]
        differing = [
            f"{name}={value}"
            for name, value in sorted(line.rest.items())
            if any(other.rest.get(name) != value for other in alike)
        ]
        yield " ".join([line.method, *differing])


def _growth(setting, points, cells):
    """The times of the first and the last value of a line, whose values may be scenes of their own."""
    (name, first, fewer), *_, (_, last, more) = points
    ms = [digits(cells[number].median_ms) for number in (fewer, more)]
    return f"{name}: {ms[0]} ms per frame with {setting} = {first:.10g}, {ms[1]} with {last:.10g}"


def _title(setting, points, cells, recorded, has_lines):
    """The title of a chart of [name, value, number of a cell] rows. Settings of BOUNDS change the
    pairs: other answers are expected then."""
    own = [cells[number] for *_, number in points]
    if _is_of_scene(setting, own[0]):
        return _growth(setting, [point for point in points if point[0] == points[0][0]], cells)
    try:
        verdict = verdict_of(own, recorded, setting not in BOUNDS)
    except ModuleNotFoundError:  # scipy, which only the verdict needs
        return _growth(setting, points, cells)
    texts = [f"{setting} = {value:.10g}{f' of {name}' if has_lines else ''}" for name, value, _ in points]
    named = [Named(one, texts[one.cell], own[one.cell].median_ms) for one in verdict.cells]
    return title(named, verdict.answers_differ)


def _sweep(setting, of, lines, cells, recorded):
    shown = lines[:MAX_LINES]
    own = [
        {"name": name, "points": [[value, line.points[value]] for value in sorted(line.points)]}
        for name, line in zip(_line_names(shown), shown)
    ]
    points = [(line["name"], *point) for line in own for point in line["points"]]
    heading = _title(setting, points, cells, recorded, len(own) > 1)
    return {"setting": setting, "of": of, "all": len(lines), "title": heading, "lines": own}


def sweeps_of(cells, recorded=None):
    """Sweeps of Cells for the page, by setting. `recorded`: the RecordedVerdicts of their files."""
    numbers = [number for number, cell in enumerate(cells) if is_rankable(cell)]
    charts = (
        (setting, *chart)
        for setting in _swept(cells, numbers)
        for chart in _lines(setting, cells, numbers).items()
    )
    return [_sweep(*chart, cells, recorded) for chart in itertools.islice(charts, MAX_SWEEPS)]
