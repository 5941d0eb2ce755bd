# SPDX-License-Identifier: MIT
# test: cost=5
"""Results/scaling/model.py: known coefficients, tables of microbenchmarks, and the
tables of the page."""

import random
import unittest

from tests.program import SOURCE
from tests.script_case import emptied, loaded

model = loaded("../results/scaling/model.py")
from tandem import markdown

# Microseconds: per frame, and per unit of each count.
KNOWN = {
    "refit": (15, {"tetrahedra": 2e-5}),
    "broad": (8, {"tile_pairs": 1e-4}),
    "walk": (30, {"body_pairs": 5e-3, "pairs": 4e-5}),
    "contact": (20, {"pairs": 1e-4}),
    "host": (40, {"bodies": 0.05, "scene_bodies": 0.03, "sorted": 0.02}),
}
EXCHANGE = (50, {"messages": 3, "bytes": 2e-4})
STAGE = {"refit": "refit", "broad": "broad", "walk": "traverse", "contact": "contact"}
BESIDE = 20  # nanoseconds per body
TETRAHEDRA = 1000  # per body


def known_us(part, counts, chance):
    fixed, per = KNOWN[part]
    return (fixed + sum(value * counts[name] for name, value in per.items())) * chance.uniform(0.999, 1.001)


def stage_ns(us, frames):
    return {STAGE[part]: {"device_ns": us[part] * frames * 1e3, "host_ns": 0} for part in STAGE}


def exchange_of(chance, frames):
    """Messages and bytes of a rank, with the time that they take."""
    messages, sent = chance.randrange(1, 20) * frames, chance.randrange(1000, 1000000) * frames
    host_ns = (EXCHANGE[0] * frames + 3 * messages + 2e-4 * sent) * 1e3
    return {"messages": messages, "bytes": sent, "host_ns": host_ns}


def record(chance, bodies, devices, with_ranks=False, frames=2):
    """A synthetic record of an evenly partitioned scene, computed from the known coefficients."""
    own, body_pairs, pairs = (
        bodies // devices,
        int(bodies * chance.uniform(1, 12)),
        int(bodies * chance.uniform(500, 5000)),
    )
    scene = {"key": "made", "bodies": bodies, "tetrahedra": TETRAHEDRA * bodies}
    line = {
        "status": "ok",
        "preset": "resident",
        "algorithm": "tiled",
        "settings": {"k": "18", "slabs": "three", "broad": "device"},
        "scene": scene,
        "partition": None,
        "devices": [{"name": "GPU", "clock": "made"}] * devices,
        "frames": {"first": 0, "last": frames - 1},
        "work": {"body_pairs": [body_pairs] * frames, "candidate_pairs": [pairs] * frames},
        "preparation": {"device_bytes": 1e8 + 30 * TETRAHEDRA * bodies * devices + 45 * pairs},
        "ranks": devices if with_ranks else None,
    }
    parts = []
    for _ in range(devices):
        local_bodies = own if devices == 1 else int(own * chance.uniform(1.1, 1.6))
        counts = model.counts_of(
            scene,
            local_bodies,
            own,
            body_pairs / devices,
            pairs / devices,
            is_sorted=devices == 1,
            known=local_bodies if with_ranks else None,
        )
        us = {part: known_us(part, counts, chance) for part in KNOWN}
        exchange = exchange_of(chance, frames) if with_ranks else None
        parts.append(
            {
                "ns": {"median": sum(us.values()) * frames * 1e3},
                "bodies": [local_bodies] * frames,
                "body_pairs": [body_pairs / devices] * frames,
                "candidate_pairs": [pairs / devices] * frames,
                "exchange": exchange,
                "stages": stage_ns(us, frames),
            }
        )
    beside = BESIDE * bodies * frames if with_ranks else 0
    line["total_ns"] = {
        "median": max(l["ns"]["median"] + (l["exchange"] or {"host_ns": 0})["host_ns"] for l in parts)
        + beside
    }
    line["stages"] = {
        name: {clock: {"median": ns} for clock, ns in stage.items()}
        for name, stage in parts[0]["stages"].items()
    }
    if devices > 1:
        line["partition"] = {"devices": parts}
    return line


def records():
    chance = random.Random(1)
    sizes = (500, 1000, 4000, 10000, 30000)
    return [
        *(record(chance, n, 1) for n in sizes),
        *(record(chance, n, 2) for n in sizes),
        *(record(chance, n, 4, True) for n in sizes),
    ]


class Fit(unittest.TestCase):
    def test_known_coefficients_are_found(self):
        (fit,) = model.fit(model.groups_of(records())).values()
        for part, (fixed, per) in KNOWN.items():
            term = fit.parts[part]
            self.assertEqual(set(term.per), set(per), part)
            for name, value in (("fixed", fixed), *per.items()):
                found = term.fixed if name == "fixed" else term.per[name]
                self.assertLess(abs(found / value - 1), 0.05, (part, name, found))
        self.assertLess(max(abs(e) for e, one in zip(fit.errors, fit.records) if not one.is_ranks), 0.01)
        for name, value in EXCHANGE[1].items():
            self.assertLess(abs(fit.exchange.per[name] / value - 1), 0.01, name)
        self.assertLess(abs(fit.memory.per["tetrahedra"] / 30 - 1), 0.01)
        self.assertLess(abs(fit.memory.per["pairs"] / 45 - 1), 0.05)

    def test_the_costs_of_every_rank_are_found(self):
        every = model.every_rank(model.groups_of(records()))
        self.assertEqual((every.bodies, every.ranks), (30000, 4))
        self.assertLess(abs(every.beyond / BESIDE - 1), 0.01)
        largest = records()[-1]
        self.assertAlmostEqual(
            every.own, min(one["exchange"]["host_ns"] for one in largest["partition"]["devices"]) / 2 / 7500
        )

    def test_no_coefficient_is_negative(self):
        counts = [{"tetrahedra": n, "pairs": m} for n, m in ((1e6, 10), (2e6, 20), (4e6, 5), (9e6, 50))]
        term = model.fitted(
            ("tetrahedra", "pairs"), counts, [10 + c["tetrahedra"] * 2e-5 - 0.05 * c["pairs"] for c in counts]
        )
        self.assertEqual(term.per["pairs"], 0)
        self.assertGreater(min(term.fixed, term.per["tetrahedra"]), 0)
        self.assertGreater(max(term.errors), 1e-3)

    def test_constant_counts_have_no_coefficient(self):
        term = model.fitted(
            ("tetrahedra", "pairs"), [{"tetrahedra": n, "pairs": 7} for n in (1e5, 2e5, 3e5)], [12, 14, 16]
        )
        self.assertEqual(list(term.per), ["tetrahedra"])

    def test_few_loads_have_no_model(self):
        self.assertEqual(model.fit(model.groups_of(records()[:2])), {})

    def test_tables_of_partitions(self):
        one = {
            "run_type": "iteration",
            "real_time": 2000.0,
            "own_most": 110,
            "ghosts_mean": 50,
            "ghosts_most": 90,
        }
        met = {
            "run_type": "iteration",
            "real_time": 9.0,
            "setup_bytes_most": 5000.0,
            "frame_bytes_most": 2500.0,
            **{name: 4 for name in ("ghosts_mean", "ghosts_most", "neighbours_mean")},
        }
        other = {"run_type": "iteration", "name": "refit/host/8", "real_time": 1}
        named = [
            {**one, "name": "partition, parts/4/125/iterations:1"},
            {**met, "name": "ghosts, ranks/8/27"},
        ]
        made = model.partitions([*named, other])
        self.assertEqual(
            made["partition"].splitlines()[2:], ["| 4 | 125 | 2.00 | 4000.0 | 0.88 | 50 | 90 | 2.0 |"]
        )
        self.assertEqual(made["ghosts"].splitlines()[2:], ["| 8 | 27 | 4 | 4 | 0.4 | 4.0 | 5 | 2.5 |"])


class Page(unittest.TestCase):
    def test_tables_equal_records_and_counts(self):
        page = SOURCE / "results/scaling/README.md"
        with emptied(page, "model") as copy:
            markdown.rewrite(copy, "model", model.tables())
            self.assertEqual(copy.read_text(), page.read_text())
