# SPDX-License-Identifier: MIT
"""Fits coefficients of the time of a frame: non-negative least squares of relative errors, part by part."""

import dataclasses
import itertools

import numpy as np

from ..errors import BadUse

# Counts on which the time of each part of a frame depends. Each part also has a constant, for launches and
# waits.
PARTS = {
    "refit": ("tetrahedra",),
    "broad": ("tile_pairs",),
    "walk": ("body_pairs", "pairs"),
    "contact": ("pairs",),
    "host": ("bodies", "scene_bodies", "sorted"),
}
EXCHANGE = ("messages", "bytes")


def non_negative(columns, measured):
    """Non-negative least squares of relative errors: tries all sets of columns, and takes the best without a
    negative coefficient."""
    weighted = columns / measured[:, None]
    best, least = np.zeros(columns.shape[1]), np.inf
    for size in range(1, columns.shape[1] + 1):
        for chosen in itertools.combinations(range(columns.shape[1]), size):
            part = weighted[:, chosen]
            scale = np.abs(part).max(0)
            if np.linalg.matrix_rank(part / scale) < size:
                continue
            found = np.linalg.lstsq(part / scale, np.ones(len(measured)), rcond=None)[0] / scale
            rest = ((part @ found - 1) ** 2).sum()
            if (found >= 0).all() and rest < least * (1 - 1e-9):
                least, best = rest, np.zeros(columns.shape[1])
                best[list(chosen)] = found
    return best


@dataclasses.dataclass
class Term:
    """A fitted time in microseconds: a constant, and one coefficient per count in `per`. `errors`: relative
    error of each load."""

    fixed: float
    per: dict
    errors: list

    def us(self, counts):
        return self.fixed + sum(value * counts[name] for name, value in self.per.items())


def fitted(names, counts, measured):
    """The Term of those counts that differ between loads. Leaves out constant counts, whose coefficients
    cannot be determined."""
    varying = [name for name in names if len({round(c[name], 6) for c in counts}) > 1]
    columns = np.array([[1.0, *(c[name] for name in varying)] for c in counts])
    measured = np.array(measured)
    found = non_negative(columns, measured)
    return Term(found[0], dict(zip(varying, found[1:])), list(np.abs(columns @ found / measured - 1)))


class Model:
    """The model of a group: one Term per part, one for messages between ranks, one for device memory in
    bytes. `errors`: relative error of each record's frame."""

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
        return (
            fitted(
                EXCHANGE, [dict(zip(EXCHANGE, one.exchange)) for one in own], [one.exchange[2] for one in own]
            )
            if own
            else None
        )

    def _fit_memory(self):
        """Device bytes per placed tetrahedron and per candidate pair. Each device of a process has all
        bodies. Records of ranks have no bytes."""
        own = [r for r in self.records if r.device_bytes and not r.is_ranks]
        counts = [{"tetrahedra": len(r.loads) * r.scene["tetrahedra"], "pairs": r.pairs} for r in own]
        return fitted(("tetrahedra", "pairs"), counts, [r.device_bytes for r in own]) if own else None

    def device_us(self, counts):
        return sum(term.us(counts) for term in self.parts.values())

    def frame_us(self, record):
        """Time of the slowest device by the model, with the measured time of messages."""
        return max(
            self.device_us(one.counts) + (one.exchange[2] if one.exchange else 0) for one in record.loads
        )


class EveryRank:
    """Nanoseconds per body in the largest scene that ranks ran. `own`: the check whether an own body is still
    near, with waits, per own body. `beyond`: the time of a frame beyond that of its slowest rank, per body of
    the scene."""

    def __init__(self, records):
        largest = max((r for r in records if r.is_ranks), key=lambda r: r.scene["bodies"])
        self.bodies, self.ranks = largest.scene["bodies"], len(largest.loads)
        self.own = 1e3 * min(one.exchange[2] / one.counts["own"] for one in largest.loads)
        self.beyond = (
            1e3
            * max(largest.frame_us - max(one.total + one.exchange[2] for one in largest.loads), 0)
            / self.bodies
        )


def every_rank(groups):
    """EveryRank of the group whose ranks had the most bodies, the best basis for many bodies. Raises BadUse."""
    largest = lambda records: max((r.scene["bodies"] for r in records if r.is_ranks), default=0)
    records = max(groups.values(), key=largest, default=[])
    if largest(records) == 0:
        raise BadUse(
            "no record of ranks, which the time of checking own bodies needs; make one with mpirun -n N tandem run ..."
        )
    return EveryRank(records)


def _are_sufficient(records):
    return (
        len(
            {
                (round(load.counts["tetrahedra"]), round(load.counts["pairs"]))
                for r in records
                for load in r.loads
            }
        )
        >= 3
    )


def fit(groups, text=""):
    """Models of the groups whose names contain the text and that have enough records. Raises BadUse."""
    if not any(text in name for name in groups):
        raise BadUse(f"--group {text}: no such group; there are: {'; '.join(groups)}")
    models = {
        name: Model(records) for name, records in groups.items() if text in name and _are_sufficient(records)
    }
    if not models:
        raise BadUse(
            f"{sum(map(len, groups.values()))} records: too few to separate the terms of a frame; "
            "give cells of one device and algorithm with at least three different loads"
        )
    return models
