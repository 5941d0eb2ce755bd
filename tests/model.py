#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""model.py PROGRAM SOURCE: scripts/model: coefficients that are known, ranks against brute force and against what ranks of the program
recorded, bad input, and the tables of results/scaling."""
import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import json
import lzma
import random
import re
import sys
import unittest

import numpy as np

from program import SOURCE, Case

sys.dont_write_bytecode = True
sys.path.insert(0, str(SOURCE / "scripts"))
import simulated_ranks as ranks

LOADER = importlib.machinery.SourceFileLoader("script_model", str(SOURCE / "scripts/model"))
MODEL = importlib.util.module_from_spec(importlib.util.spec_from_loader(LOADER.name, LOADER))
sys.modules[LOADER.name] = MODEL  # where dataclasses look for it
LOADER.exec_module(MODEL)
# Microseconds: of a frame, and of each count.
KNOWN = {"refit": (15, {"tetrahedra": 2e-5}), "broad": (8, {"tile_pairs": 1e-4}), "walk": (30, {"body_pairs": 5e-3, "pairs": 4e-5}), "contact": (20,
                                                                                                                                                 {"pairs": 1e-4}),
         "host": (40, {"bodies": 0.05, "scene_bodies": 0.03, "sorted": 0.02})}
EXCHANGE = (50, {"messages": 3, "bytes": 2e-4})
STAGE = {"refit": "refit", "broad": "broad", "walk": "traverse", "contact": "contact"}
PLACED, ABSENT, COPIED = 30, 5, 20  # nanoseconds a body
TETRAHEDRA = 1000  # of a body


def known_us(part, counts, chance):
    fixed, per = KNOWN[part]
    return (fixed + sum(value * counts[name] for name, value in per.items())) * chance.uniform(0.999, 1.001)


def stage_ns(us, counts, frames):
    packing = PLACED * counts["bodies"] + ABSENT * (counts["scene_bodies"] - counts["bodies"])
    return {**{STAGE[part]: {"device_ns": us[part] * frames * 1e3, "host_ns": 0} for part in STAGE}, "preprocess": {"device_ns": 0,
                                                                                                                    "host_ns": packing * frames}}


def record(chance, bodies, devices, with_ranks=False, frames=2):
    """Of a scene shared evenly, as the known coefficients have it."""
    own, body_pairs, pairs = bodies // devices, int(bodies * chance.uniform(1, 12)), int(bodies * chance.uniform(500, 5000))
    scene = {"key": "made", "bodies": bodies, "tetrahedra": TETRAHEDRA * bodies}
    line = {"status": "ok", "preset": "resident", "algorithm": "tiled", "settings": {"k": "18", "slabs": "three", "broad": "device"}, "scene": scene,
            "shares": None,
            "devices": [{"name": "made", "clock": "made"}] * devices, "frames": {"first": 0,
                                                                                 "last": frames - 1}, "work": {"body_pairs": [body_pairs] * frames,
                                                                                                               "candidate_pairs": [pairs] * frames},
            "preparation": {"device_bytes": 1e8 + 30 * TETRAHEDRA * bodies * devices + 45 * pairs}, "ranks": devices if with_ranks else None}
    loads = []
    for _ in range(devices):
        present = own if devices == 1 else int(own * chance.uniform(1.1, 1.6))
        counts = MODEL.counts_of(scene, present, own, body_pairs / devices, pairs / devices, devices == 1)
        us = {part: known_us(part, counts, chance) for part in KNOWN}
        exchange = {"messages": chance.randrange(1, 20) * frames, "bytes": chance.randrange(1000, 1000000) * frames} if with_ranks else None
        if exchange:
            exchange["host_ns"] = (EXCHANGE[0] * frames + 3 * exchange["messages"] + 2e-4 * exchange["bytes"]) * 1e3
        loads.append({"ns": {"median": sum(us.values()) * frames * 1e3}, "bodies": [present] * frames, "body_pairs": [body_pairs / devices] * frames,
                      "candidate_pairs": [pairs / devices] * frames, "exchange": exchange, "stages": stage_ns(us, counts, frames)})
    copied = COPIED * bodies * frames if with_ranks else 0
    line["total_ns"] = {"median": max(l["ns"]["median"] + (l["exchange"] or {"host_ns": 0})["host_ns"] for l in loads) + copied}
    line["stages"] = {name: {clock: {"median": ns} for clock, ns in stage.items()} for name, stage in loads[0]["stages"].items()}
    if devices > 1:
        line["shares"] = {"devices": loads}
    return line


def records():
    chance = random.Random(1)
    sizes = (500, 1000, 4000, 10000, 30000)
    return [*(record(chance, n, 1) for n in sizes), *(record(chance, n, 2) for n in sizes), *(record(chance, n, 4, True) for n in sizes)]


def said(*arguments):
    """(exit code, standard output, lines of standard error)."""
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as errors:
        code = MODEL.main([str(argument) for argument in arguments])
    return code, out.getvalue(), errors.getvalue().splitlines()


def boxes_by_hand(pile, body, margin):
    """Ends of one body along each direction."""
    middle = ranks.DIRECTIONS @ pile.centres[body]
    width = pile.widths[body] + margin * pile.mesh.radius * np.linalg.norm(ranks.DIRECTIONS, axis=1)
    return middle - width, middle + width


def overlap(a, b):
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


class ModelCase(Case):
    def refused(self, expected, *arguments):
        code, _, errors = said(*arguments)
        self.assertEqual((code, len(errors)), (2, 1), (arguments, errors))
        self.assertTrue(errors[0].startswith("model: "), errors)
        self.assertIn(expected, errors[0])

    def file(self, name, lines):
        path = self.work / name
        data = "".join(line if isinstance(line, str) else json.dumps(line) + "\n" for line in lines).encode()
        path.write_bytes(lzma.compress(data) if name.endswith(".xz") else data)
        return path


class Fit(ModelCase):
    def test_known_coefficients_are_found(self):
        (model,) = MODEL.fit(MODEL.read([self.file("made.jsonl.xz", records())])).values()
        for part, (fixed, per) in KNOWN.items():
            term = model.parts[part]
            self.assertEqual(set(term.per), set(per), part)
            for name, value in (("fixed", fixed), *per.items()):
                found = term.fixed if name == "fixed" else term.per[name]
                self.assertLess(abs(found / value - 1), 0.05, (part, name, found))
        self.assertLess(max(abs(e) for e, one in zip(model.errors, model.records) if not one.is_ranks), 0.01)
        for name, value in EXCHANGE[1].items():
            self.assertLess(abs(model.exchange.per[name] / value - 1), 0.01, name)
        self.assertLess(abs(model.memory.per["tetrahedra"] / 30 - 1), 0.01)
        self.assertLess(abs(model.memory.per["pairs"] / 45 - 1), 0.05)

    def test_what_every_rank_takes_is_found(self):
        every = MODEL.every_rank(MODEL.read([self.file("made.jsonl", records())]))
        self.assertEqual((every.bodies, every.ranks), (30000, 4))
        for found, known in ((every.placed, PLACED), (every.absent, ABSENT), (every.copied, COPIED)):
            self.assertLess(abs(found / known - 1), 0.01)
        largest = records()[-1]
        self.assertAlmostEqual(every.own, min(one["exchange"]["host_ns"] for one in largest["shares"]["devices"]) / 2 / 7500)

    def test_no_coefficient_is_negative(self):
        counts = [{"tetrahedra": n, "pairs": m} for n, m in ((1e6, 10), (2e6, 20), (4e6, 5), (9e6, 50))]
        term = MODEL.fitted(("tetrahedra", "pairs"), counts, [10 + c["tetrahedra"] * 2e-5 - 0.05 * c["pairs"] for c in counts])
        self.assertEqual(term.per["pairs"], 0)
        self.assertGreater(min(term.fixed, term.per["tetrahedra"]), 0)
        self.assertGreater(max(term.errors), 1e-3)

    def test_what_does_not_differ_has_no_coefficient(self):
        term = MODEL.fitted(("tetrahedra", "pairs"), [{"tetrahedra": n, "pairs": 7} for n in (1e5, 2e5, 3e5)], [12, 14, 16])
        self.assertEqual(list(term.per), ["tetrahedra"])

    def test_bad_input(self):
        good = records()
        few = self.file("few.jsonl", good[:2])
        self.refused("2 records: too few", "--fit", few)
        self.refused("No such file", "--fit", self.work / "none.jsonl")
        for name, lines, said_of in (("empty", [], "empty, no records"), ("text", [good[0], "no JSON\n"], "text.jsonl:2 is no record"), ("list", ["[]\n"],
                                                                                                                                         ":1 is no record"),
                                     ("half", [{**good[0], "work": None}], ":1 is no record"), ("frames", [{**good[0], "frames": {"first": 1, "last": 0}}],
                                                                                                ":1 is no record")):
            self.refused(said_of, "--fit", self.file(f"{name}.jsonl", lines))
        self.refused("no such group; there are: made", "--group", "none", self.file("good.jsonl", good))
        self.refused("no record of a pile", "--group", "made", self.file("good.jsonl", good))
        alone = self.file("alone.jsonl", [{**line, "scene": {**line["scene"],
                                                             "key": "pile:bodies=64,mesh=jack,density=0.2,seed=1,frames=2,far=0"}} for line in good[:10]])
        self.refused("no record of ranks", "--group", "made", alone)
        self.refused("--network", "--network", "fast", few)
        self.refused("--ranks", "--simulate", "--ranks", "0", "--counts", self.work / "no.csv")

    def test_bad_counts(self):
        pile = {"key": "pile:bodies=64,mesh=jack,density=0.2,seed=1,frames=2,far=0", "bodies": 64, "tetrahedra": 64 * 2325}
        good = self.file("good.jsonl", [*records(), {**record(random.Random(2), 64, 1), "scene": pile}])
        self.refused("No such file or directory; scripts/model --simulate makes it", "--group", "made", "--counts", self.work / "none.csv", good)
        for text, expected in (("", "empty, no counts"), ("study,bodies\nweak,1\n", "no counts of"),
                               ("study,bodies,ranks,density,margin,held\nweak,1,x,0,0,1\n", "no counts of")):
            self.refused(expected, "--group", "made", "--counts", self.file("bad.csv", [text]), good)
        page = self.file("page.md", ["<!-- model: nothing -->\n<!-- end -->\n"])
        counts = self.work / "counts.csv"
        self.assertEqual(said("--simulate", "--counts", counts, "--ranks", "1,4", "--bodies", "20")[0], 0)
        self.refused("no table 'nothing'; there are: line, coefficients", "--group", "made", "--counts", counts, good, "--write", page)
        self.assertEqual(said("--group", "made", "--counts", counts, good)[::2], (0, []))


class SimulatedRanks(ModelCase):
    def test_counts_are_those_of_brute_force(self):
        pile, many, margin = ranks.Pile(150, 0.1, 3), 4, 0.5
        found = ranks.count(pile, many, margin)
        starts = np.concatenate([[0], np.cumsum(found["own"])])
        own = [range(a, b) for a, b in zip(starts, starts[1:])]
        ends = [boxes_by_hand(pile, body, margin) for body in range(150)]
        gets = {(rank, body) for rank in range(many) for first in own[rank][::8] for body in range(own[rank].stop, 150)
                if overlap(self.box_over(ends, range(first, min(first + 8, own[rank].stop))), ends[body])}
        owner = lambda body: next(rank for rank in range(many) if body in own[rank])
        links = {(rank, owner(body)) for rank, body in gets}
        of = lambda pairs, place: [sum(pair[place] == rank for pair in pairs) for rank in range(many)]
        self.assertEqual(found["halo"].tolist(), of(gets, 0))
        self.assertEqual(found["sent"].tolist(), of([(0, owner(body)) for _, body in gets], 1))
        self.assertEqual((found["senders"].tolist(), found["receivers"].tolist()), (of(links, 0), of(links, 1)))
        self.assertGreater(len(gets), 50)
        self.expect_pairs(pile, found, owner)

    def box_over(self, ends, bodies):
        return np.min([ends[b][0] for b in bodies], 0), np.max([ends[b][1] for b in bodies], 0)

    def expect_pairs(self, pile, found, owner):
        expected, pairs = np.zeros(len(found["own"])), np.zeros(len(found["own"]), int)
        tight = [boxes_by_hand(pile, body, 0) for body in range(150)]
        for a in range(150):
            for b in range(a + 1, 150):
                distance = np.linalg.norm(pile.centres[a] - pile.centres[b])
                if distance < 2 * pile.mesh.radius:
                    expected[owner(a)] += ranks.expected_pairs(distance, pile.mesh)
                    pairs[owner(a)] += overlap(tight[a], tight[b])
        self.assertEqual(found["body_pairs"].tolist(), pairs.tolist())
        self.assertLessEqual(np.abs(found["expected_pairs"] - expected).max(), 1)
        self.assertGreater(pairs.min(), 5)

    def test_counts_are_what_ranks_of_the_program_recorded(self):
        """tandem run pile:bodies=N,density=D --frames 0:0 on four ranks: `bodies` of shares, and 64 bytes of a pose sent and one of a vote."""
        for bodies, density, held, sent in ((256, 0.2, [252, 198, 145, 61], [1, 3777, 10497, 11329]), (1500, 0.05, [690, 576, 587, 385], [1, 9281, 14209,
                                                                                                                                          23745])):
            found = ranks.count(ranks.Pile(bodies, density), 4, 0.25)
            self.assertEqual((found["own"] + found["halo"]).tolist(), held)
            self.assertEqual((MODEL.POSE * found["sent"] + 1).tolist(), sent)
            self.assertEqual((found["receivers"] + 1).tolist(), [1, 2, 3, 4])  # messages

    def test_margins_double_until_they_hold(self):
        self.assertEqual(ranks.settled_margin(), (0.5, 12))  # a recording of eight frames meets twice: at 0, and at 7

    def test_common_volume_of_balls(self):
        mesh = ranks.Jack(np.ones(3), 1.0, 1.0, 100)
        density = 100 / (4 * np.pi / 3)
        self.assertAlmostEqual(ranks.expected_pairs(1.0, mesh) / (5 * np.pi / 12 * density * 8), 1)  # two unit balls a radius apart
        self.assertEqual(ranks.expected_pairs(2.0, mesh), 0)


class Paper(ModelCase):
    def test_messages_by_hand(self):
        """50 GB/s, 1.5 us, 1,024 ranks: ten rounds."""
        network = MODEL.Network(50, 1.5, 1024)
        self.assertAlmostEqual(network.gather_to_all(1), 2 * 10 * 1.5 + 1023 * 5 / 50e3)
        self.assertAlmostEqual(network.broadcast(24), 2 * 10 * (1.5 + 24 / 50e3))
        self.assertAlmostEqual(network.sizes_to_all(), 10 * (1.5 + 512 * 8 / 50e3))
        self.assertAlmostEqual(network.passed(20, 1e6), 20 * 1.5 + 1e6 / 50e3)
        self.assertEqual(MODEL.Network(50, 1.5, 1).gather_to_all(100), 0)

    def test_a_body_meets_groups_of_lower_ranks(self):
        """Of three ranks with 256, 300 and 512 bodies: 1 group of 32 boxes, 2 and 2; two nanoseconds a test on four cores."""
        options = MODEL.parsed(["--box-ns", "2", "--cores", "4"])
        case = type("Case", (), {"own": np.array([256.0, 300.0, 512.0])})
        self.assertEqual(MODEL.near_us(case, options).tolist(), [0, 300 * 2 / 4e3, 512 * 3 * 2 / 4e3])


class Page(ModelCase):
    def test_counts_can_be_made_again(self):
        """The small ones; the rest takes minutes."""
        made = self.work / "counts.csv"
        self.assertEqual(said("--simulate", "--counts", made, "--ranks", "8", "--bodies", str(MODEL.TEN_BILLION // 1024 + 1))[0], 0)
        rows = lambda path: [row for row in csv.DictReader(path.read_text().splitlines()) if (row["study"], row["ranks"]) == ("weak", "8")]
        self.assertEqual(rows(made), rows(SOURCE / "results/scaling/counts.csv"))
        self.assertEqual(len(rows(made)), 8)

    def test_tables_are_those_of_records_and_counts(self):
        if not (SOURCE / "results/h100x2").exists():
            self.skipTest("results/h100x2 is not there")
        text, copy = (SOURCE / "results/scaling/README.md").read_text(), self.work / "page.md"
        copy.write_text(re.sub(r"(<!-- model: [a-z ]+ -->).*?<!-- end -->", r"\1 <!-- end -->", text, flags=re.DOTALL))
        self.assertNotEqual(copy.read_text(), text)
        self.assertEqual(said("--write", copy), (0, "", []))
        self.assertEqual(copy.read_text(), text)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
