# SPDX-License-Identifier: MIT
"""Markdown tables of coefficients, of ranks and of the microbenchmarks of partitions, without a final end of
line."""

import json
import re
import statistics

from .. import markdown
from ..errors import BadUse

WHAT = {
    "fixed": "a frame",
    "tetrahedra": "a tetrahedron placed",
    "tile_pairs": "a pair of tiles of 32 bodies",
    "body_pairs": "a pair of bodies",
    "pairs": "a candidate pair",
    "bodies": "a body placed",
    "scene_bodies": "a body of the scene that the process has",
    "sorted": "a body that the host sorts",
    "messages": "a message",
    "bytes": "a byte sent",
}


def _table(heads, rows):
    return markdown.table(heads, rows, numeric=True).rstrip("\n")


def _three_digits(value):
    return "0" if value == 0 else f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def _in_unit(us):
    """Microseconds as text, in the unit that gives a value of at least 1."""
    for unit, scale in (("ms", 1e-3), ("us", 1.0), ("ns", 1e3), ("ps", 1e6)):
        if us * scale >= 1 or unit == "ps":
            return f"{_three_digits(us * scale)} {unit}"


def _percent(value):
    if value < 1e-9:
        return "0"
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.0f} %"


def _errors(errors):
    """Texts of their number, their median and their maximum."""
    return [str(len(errors)), _percent(statistics.median(errors)), _percent(max(errors))]


def _rows(model):
    terms = {**model.parts, **({"exchange": model.exchange} if model.exchange else {})}
    for part, term in terms.items():
        values = [
            f"{_in_unit(value)} {WHAT[name]}"
            for name, value in (("fixed", term.fixed), *term.per.items())
            if value > 0
        ]
        yield [part, ", ".join(values), *_errors(term.errors)]
    yield ["**whole frames**", "the slowest device", *_errors([abs(e) for e in model.errors])]
    if model.memory:
        own = model.memory
        values = [f"{_three_digits(value)} bytes {WHAT[name]}" for name, value in own.per.items()]
        yield [
            "memory",
            ", ".join([*([f"{own.fixed / 1e6:,.0f} MB"] if own.fixed else []), *values]),
            *_errors(own.errors),
        ]


def coefficients(models):
    """One table per group."""
    texts = [
        f"{name}: {len(model.records)} records.\n\n"
        + _table(["part", "takes", "measured", "median error", "worst"], list(_rows(model)))
        for name, model in models.items()
    ]
    return "\n\n".join(texts)


def every_rank(every):
    rows = [
        ["checking whether an own body is still near, waits included", every.own],
        ["a frame beyond the time of its slowest rank, per body of the scene", every.beyond],
    ]
    return f"{every.ranks} ranks, {every.bodies:,} bodies:\n\n" + _table(
        ["what", "ns a body"], [[what, f"{value:.3g}"] for what, value in rows]
    )


def _iterations(found, name):
    """Pairs (numbers in the name, benchmark) of all runs of that name, sorted by the numbers."""
    own = [
        ([int(number) for number in re.findall(r"/(\d+)", one["name"])], one)
        for one in found
        if one["run_type"] == "iteration" and one["name"].startswith(f"{name},")
    ]
    return sorted(own, key=lambda pair: pair[0])


def _partition_row(numbers, one):
    parts, each = numbers[:2]
    return [
        f"{parts:,}",
        f"{each:,}",
        f"{one['real_time'] / 1e3:.2f}",
        f"{one['real_time'] * 1e3 / parts / each:.1f}",
        f"{one['own_most'] / each:.2f}",
        f"{one['ghosts_mean']:,.0f}",
        f"{one['ghosts_most']:,.0f}",
        f"{one['ghosts_mean'] / each ** (2 / 3):.1f}",
    ]


def _ghost_row(numbers, one):
    ranks, each = numbers[:2]
    return [
        f"{ranks:,}",
        f"{each:,}",
        f"{one['ghosts_mean']:,.0f}",
        f"{one['ghosts_most']:,.0f}",
        f"{one['ghosts_mean'] / each ** (2 / 3):.1f}",
        f"{one['neighbours_mean']:.1f}",
        f"{one['setup_bytes_most'] / 1e3:,.0f}",
        f"{one['frame_bytes_most'] / 1e3:,.1f}",
    ]


def partitions(path):
    """Tables of the microbenchmarks of many ranks in one process (tests/bench/partition.cpp), from a file of
    Google Benchmark. Raises BadUse."""
    try:
        found = json.loads(path.read_text())["benchmarks"]
        partition_rows = [_partition_row(*own) for own in _iterations(found, "partition")]
        ghost_rows = [_ghost_row(*own) for own in _iterations(found, "ghosts")]
    except OSError as problem:
        raise BadUse(f"{path}: {problem.strerror}; scripts/bench makes it") from None
    except (ValueError, KeyError, TypeError):
        raise BadUse(f"{path}: is not a result of scripts/bench with the benchmarks of partitions") from None
    return {
        "partition": _table(
            [
                "parts",
                "bodies a part",
                "seconds",
                "us a body",
                "most bodies over mean",
                "ghost bodies, mean",
                "most",
                "mean, of own^(2/3)",
            ],
            partition_rows,
        ),
        "ghosts": _table(
            [
                "ranks",
                "bodies a rank",
                "ghost bodies, mean",
                "most",
                "mean, of own^(2/3)",
                "ranks that own them",
                "KB sent at the set-up, most",
                "KB a frame, most",
            ],
            ghost_rows,
        ),
    }
