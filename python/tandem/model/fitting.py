# SPDX-License-Identifier: MIT
"""Coefficients of what a frame costs: non-negative, with the least squares of relative errors, a part at a time."""
import dataclasses
import itertools

import numpy as np

from ..errors import BadUse

# What each part of a frame is made of. The first column of each is 1: launches, and whoever waits for them.
PARTS = {"refit": ("tetrahedra",), "broad": ("tile_pairs",), "walk": ("body_pairs", "pairs"), "contact": ("pairs",),
         "host": ("bodies", "scene_bodies", "sorted")}
EXCHANGE = ("messages", "bytes")


def non_negative(columns, measured):
    """Coefficients >= 0 with the least squares of relative errors: of all sets of columns the best whose solution has no negative one."""
    weighted = columns / measured[:, None]
    best, least = np.zeros(columns.shape[1]), np.inf
    for size in range(1, columns.shape[1] + 1):
        for kept in itertools.combinations(range(columns.shape[1]), size):
            part = weighted[:, kept]
            scale = np.abs(part).max(0)
            if np.linalg.matrix_rank(part / scale) < size:
                continue
            found = np.linalg.lstsq(part / scale, np.ones(len(measured)), rcond=None)[0] / scale
            rest = ((part @ found - 1) ** 2).sum()
            if (found >= 0).all() and rest < least * (1 - 1e-9):
                least, best = rest, np.zeros(columns.shape[1])
                best[list(kept)] = found
    return best


@dataclasses.dataclass
class Term:
    """Microseconds: fixed, and for each count of `per`; how far off it is, relative, load by load."""
    fixed: float
    per: dict
    errors: list

    def us(self, counts):
        return self.fixed + sum(value * counts[name] for name, value in self.per.items())


def fitted(names, counts, measured):
    """A term of those counts that differ between loads; nothing can be known of the rest, which are left out."""
    kept = [name for name in names if len({round(c[name], 6) for c in counts}) > 1]
    columns = np.array([[1.0, *(c[name] for name in kept)] for c in counts])
    measured = np.array(measured)
    found = non_negative(columns, measured)
    return Term(found[0], dict(zip(kept, found[1:])), list(np.abs(columns @ found / measured - 1)))


class Model:
    """The model of a group: a term a part, one of messages where ranks send them, one of bytes of a device; and how far each frame is from
    it."""

    def __init__(self, records):
        self.records = records
        loads = [one for record in records for one in record.loads]
        self.parts = {}
        for part, names in PARTS.items():
            own = [one for one in loads if one.us[part] > 0]
            if own:
                self.parts[part] = fitted(names, [one.counts for one in own], [one.us[part] for one in own])
        self.exchange = self._fit_exchange(loads)
        self.memory = self._fit_memory()
        self.errors = [self.frame_us(record) / record.frame_us - 1 for record in records]

    @staticmethod
    def _fit_exchange(loads):
        own = [one for one in loads if one.exchange and one.exchange[2] > 0]
        return fitted(EXCHANGE, [dict(zip(EXCHANGE, one.exchange)) for one in own], [one.exchange[2] for one in own]) if own else None

    def _fit_memory(self):
        """Bytes a tetrahedron placed and a candidate pair. Each device of a process has all bodies; records of ranks do not have its bytes."""
        own = [r for r in self.records if r.device_bytes and not r.is_ranks]
        counts = [{"tetrahedra": len(r.loads) * r.scene["tetrahedra"], "pairs": r.pairs} for r in own]
        return fitted(("tetrahedra", "pairs"), counts, [r.device_bytes for r in own]) if own else None

    def device_us(self, counts):
        return sum(term.us(counts) for term in self.parts.values())

    def frame_us(self, record):
        """The slowest device's; messages as they were measured."""
        return max(self.device_us(one.counts) + (one.exchange[2] if one.exchange else 0) for one in record.loads)


class EveryRank:
    """Nanoseconds by the largest scene that ranks have run: `own` of finding whether an own body is still near, waits included, `beside` of what
    a frame takes beside its slowest rank, a body of the scene."""

    def __init__(self, records):
        largest = max((r for r in records if r.is_ranks), key=lambda r: r.scene["bodies"])
        self.bodies, self.ranks = largest.scene["bodies"], len(largest.loads)
        self.own = 1e3 * min(one.exchange[2] / one.counts["own"] for one in largest.loads)
        self.beside = 1e3 * max(largest.frame_us - max(one.total + one.exchange[2] for one in largest.loads), 0) / self.bodies


def every_rank(groups):
    """Takes the group whose ranks had the most bodies, because the tables go to many. Raises BadUse."""
    most = lambda records: max((r.scene["bodies"] for r in records if r.is_ranks), default=0)
    records = max(groups.values(), key=most, default=[])
    if most(records) == 0:
        raise BadUse("no record of ranks (mpirun -n N tandem run ...), which say what looking at own bodies takes")
    return EveryRank(records)


def _is_enough(records):
    return len({(round(load.counts["tetrahedra"]), round(load.counts["pairs"])) for r in records for load in r.loads}) >= 3


def fit(groups, text=""):
    """Models by group, of those that have the text in their names and enough records. Raises BadUse."""
    if not any(text in name for name in groups):
        raise BadUse(f"--group {text}: no such group; there are: {'; '.join(groups)}")
    models = {name: Model(records) for name, records in groups.items() if text in name and _is_enough(records)}
    if not models:
        raise BadUse(f"{sum(map(len, groups.values()))} records: too few to tell the terms of a frame apart; "
                     "give cells of one device and algorithm with three different loads at least")
    return models
