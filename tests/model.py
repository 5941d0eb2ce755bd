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
BESIDE = 20  # nanoseconds a body
TETRAHEDRA = 1000  # of a body


def known_us(part, counts, chance):
    fixed, per = KNOWN[part]
    return (fixed + sum(value * counts[name] for name, value in per.items())) * chance.uniform(0.999, 1.001)


def stage_ns(us, frames):
    return {STAGE[part]: {"device_ns": us[part] * frames * 1e3, "host_ns": 0} for part in STAGE}


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
        counts = MODEL.counts_of(scene, present, own, body_pairs / devices, pairs / devices, devices == 1, present if with_ranks else None)
        us = {part: known_us(part, counts, chance) for part in KNOWN}
        exchange = {"messages": chance.randrange(1, 20) * frames, "bytes": chance.randrange(1000, 1000000) * frames} if with_ranks else None
        if exchange:
            exchange["host_ns"] = (EXCHANGE[0] * frames + 3 * exchange["messages"] + 2e-4 * exchange["bytes"]) * 1e3
        loads.append({"ns": {"median": sum(us.values()) * frames * 1e3}, "bodies": [present] * frames, "body_pairs": [body_pairs / devices] * frames,
                      "candidate_pairs": [pairs / devices] * frames, "exchange": exchange, "stages": stage_ns(us, frames)})
    beside = BESIDE * bodies * frames if with_ranks else 0
    line["total_ns"] = {"median": max(l["ns"]["median"] + (l["exchange"] or {"host_ns": 0})["host_ns"] for l in loads) + beside}
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
        self.assertLess(abs(every.beside / BESIDE - 1), 0.01)
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
        pile, many, margin = ranks.Pile(150, 0.1, 3), 10, 0.1
        found = ranks.count(pile, many, margin)
        starts = np.concatenate([[0], np.cumsum(found["own"])])
        own = [range(a, b) for a, b in zip(starts, starts[1:])]
        ends = [boxes_by_hand(pile, body, margin) for body in range(150)]
        wide = [boxes_by_hand(pile, body, (1 + ranks.ROOM) * margin) for body in range(150)]
        hears = {(rank, body) for rank in range(many) for first in own[rank][::8] for body in range(own[rank].stop, 150)
                 if overlap(self.box_over(wide, range(first, min(first + 8, own[rank].stop))), ends[body])}
        near = lambda boxes: {(rank, body) for rank, body in hears if any(overlap(boxes[one], ends[body]) for one in own[rank])}
        gets, room = near(ends), near(wide)
        whole = [self.box_over(wide, bodies) for bodies in own]
        boxes = {(a, b) for a in range(many) for b in range(a + 1, many) if overlap(whole[a], whole[b])}
        owner = lambda body: next(rank for rank in range(many) if body in own[rank])
        links = {(rank, owner(body)) for rank, body in gets}
        of = lambda pairs, place: [sum(pair[place] == rank for pair in pairs) for rank in range(many)]
        owners = lambda pairs: [(rank, owner(body)) for rank, body in pairs]
        for name, expected in {"halo": of(gets, 0), "sent": of(owners(gets), 1), "senders": of(links, 0), "receivers": of(links, 1), "room": of(room, 0),
                               "offered": of(hears, 0), "offers": of(owners(hears), 1), "boxes_to": of(boxes, 0), "boxes_from": of(boxes, 1)}.items():
            self.assertEqual(found[name].tolist(), expected, name)
        self.assertLess(len(boxes), many * (many - 1) // 2)
        self.assertGreater(len(hears), len(room) + 5)
        self.assertGreater(len(room), len(gets) + 5)
        self.assertGreater(len(gets), 50)
        self.expect_pairs(pile, found, owner)
        self.expect_the_deal(pile, found, owner)

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

    def expect_the_deal(self, pile, found, owner):
        """Pairs of balls' slabs and the bodies of others that they bring, and no cut of four that ends sooner."""
        slabs = lambda body: (ranks.DIRECTIONS @ pile.centres[body], pile.mesh.radius * np.linalg.norm(ranks.DIRECTIONS, axis=1))
        balls = [(middle - width, middle + width) for middle, width in map(slabs, range(150))]
        near = [(a, b) for a in range(150) for b in range(a + 1, 150) if overlap(balls[a], balls[b])]
        brought = {(owner(a), b) for a, b in near if owner(b) > owner(a)}
        count = lambda numbers: np.bincount(list(numbers), minlength=len(found["own"])).tolist()
        self.assertEqual(found["near_pairs"].tolist(), count(owner(a) for a, _ in near))
        self.assertEqual(found["brought"].tolist(), count(rank for rank, _ in brought))
        longest = lambda own, others, pairs: (pile.mesh.tetrahedra * (own + others) + ranks.WORK_OF_A_PAIR * pairs).max()
        pairs = ranks.pairs_of_bodies(pile)
        work = pile.mesh.tetrahedra + ranks.WORK_OF_A_PAIR * pairs.expected
        starts = ranks.cut_once(work, np.zeros(len(found["own"])))
        self.assertLessEqual(longest(found["own"], found["brought"], found["expected_pairs"]),
                             1 + longest(np.diff(starts), ranks.brought_by(starts, pairs), ranks.sums(pairs.expected, starts)))

    def test_counts_are_what_ranks_of_the_program_recorded(self):
        """tandem run pile:bodies=N,density=D --frames 0:0 on four ranks: `bodies` of shares, and 64 bytes of a pose sent and one of a vote."""
        for bodies, density, held, sent in ((256, 0.2, [250, 197, 145, 62], [1, 3777, 10369, 11329]), (1500, 0.05, [670, 569, 576, 386], [1, 9025, 13505,
                                                                                                                                          22337])):
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

    def made(self, options=()):
        """Three ranks with 256, 300 and 512 bodies; the second and the third hear of the first, and the third of the second."""
        one = {"study": "weak", "bodies": 1068, "ranks": 3, "density": 0.2, "margin": 0.5, "held": 12}
        columns = {"own": (256, 300, 512), "halo": (90, 40, 0), "sent": (0, 60, 70), "senders": (2, 1, 0), "receivers": (0, 1, 2), "room": (95, 50, 0), "offered": (100, 64, 0),
                   "offers": (0, 60, 104), "boxes_from": (0, 1, 2), "boxes_to": (2, 1, 0), "brought": (50, 20, 0), "near_pairs": (10, 20, 30),
                   "body_pairs": (1, 2, 3), "expected_pairs": (4, 5, 6)}
        rows = [{**one, **{name: values[rank] for name, values in columns.items()}} for rank in range(3)]
        return MODEL.Case(tuple(one.values()), rows, {(1068, 0.2): (1, 1)}), MODEL.parsed([*options])

    def test_a_body_meets_groups_of_boxes_that_came(self):
        """356 bodies, 45 boxes a rank on average, are 2 groups of 32; 256 and 300 own bodies are 8 and 10. Two nanoseconds a test on four cores."""
        case, options = self.made(["--box-ns", "2", "--cores", "4"])
        self.assertEqual(MODEL.near_us(case, options).tolist(), [100 * 8 * 2 / 4e3, (300 * 1 * 2 + 64 * 10) * 2 / 4e3, 512 * 2 * 2 * 2 / 4e3])

    def test_a_meeting_by_hand(self):
        """Without latencies, of 1 byte a microsecond: a box a rank to all, sizes of four messages, boxes of eight, 68 bytes of who met one, 4 of who is kept."""
        case, _ = self.made()
        sizes = 2 * 1.5 * 8
        self.assertTrue(np.allclose(MODEL.meeting_us(case, MODEL.Network(1e-3, 0, 3)), 2 * 148 + 4 * sizes + np.array(
            [2 * 32 * 144 + 68 * 100 + 4 * 90, 38 * 144 + 68 * 64 + 4 * 60, 2 * 64 * 144 + 68 * 104 + 4 * 70])))

    def test_what_a_deal_gathers(self):
        case, _ = self.made()
        self.assertEqual(MODEL.gathered(case), 32 * 1068 + 16 * (1068 + 70))


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
