# SPDX-License-Identifier: MIT
# test: cost=8
"""Comparisons of cells with disturbed rounds, and of cells that several sessions
recorded; rates of false and missed changes in synthetic records of both kinds."""

import math
import unittest

import numpy

from tests.compare.cells import Files, around, record

from tandem.comparison import cells, matching, notes, pooling, texts


def disturbed(made, numbers, why="busy: other processes use 1.5 of 2 cores"):
    return made | {"conditions": {"disturbed": [{"round": number, "why": why} for number in numbers]}}


class Disturbed(Files):
    def one(self, old, new, **how):
        return self.compared([old], [new], **how)

    def test_rounds_and_reason_are_read(self):
        (cell,) = self.read(
            disturbed(record("8", [5, 1, 9], [1, 1, 2], "s"), [2, 7], "quota: throttled once")
        ).cells
        self.assertEqual(
            (cell.disturbed, cell.reason, cell.all_rounds, cell.disturbed_rounds),
            ({2}, "quota: throttled once", 2, 1),
        )
        for wrong in ([{"round": "2", "why": ""}], [{"round": 2}], [3]):
            self.refused(
                ":1: is no record of a cell",
                self.write(record("8", [1], session="s") | {"conditions": {"disturbed": wrong}}),
            )

    def test_disturbed_rounds_are_left_out(self):
        """Four of ten rounds of the new record take twice as long and are disturbed."""
        old, clean = record("8", around(1, 10), session="s"), around(1, 10)
        new = record("8", [2 * ns if number < 4 else ns for number, ns in enumerate(clean)], session="t")
        cell, found = self.one(old, disturbed(new, range(4)))
        self.assertEqual(
            (cell.verdict, cell.undisturbed, cell.after_ns), ("not_shown", True, numpy.median(clean[4:]))
        )
        self.assertEqual(cell.least_p, 2 / math.comb(16, 6))
        self.assertIn(
            "new: 4 of 10 rounds are disturbed (busy: other processes use 1.5 of 2 cores); they are left out where they are fewer than the others",
            notes.notes(*found),
        )

    def test_a_change_of_undisturbed_rounds_is_found(self):
        """The disturbed rounds hide it."""
        old = disturbed(record("8", [20e6] * 6 + around(1, 10), session="s"), range(6))
        new = record("8", [1.1 * ns for ns in around(1, 16)], session="t")
        cell, _ = self.one(old, new)
        self.assertEqual((cell.verdict, cell.undisturbed), ("slower", True))
        self.assertAlmostEqual(cell.ratio.value, 1.1, places=3)

    def test_a_change_with_disturbed_rounds_only(self):
        old, slow = record("8", around(1, 10), session="s"), record("8", around(1.5, 10), session="t")
        for numbers in (range(10), range(5)):  # none, or only half, are undisturbed
            cell, found = self.one(old, disturbed(slow, numbers))
            self.assertEqual((cell.verdict, found[2].changed, cell.undisturbed), ("disturbed", False, False))
            self.assertAlmostEqual(cell.ratio.value, 1.5, places=12)
            self.assertIn("; 1 changed in disturbed rounds only", notes.summary(found[2], 0.05))
            self.assertIn(" disturbed ", texts.text(*found, 0.05))
        few = [record("8", around(factor, 5), session=session) for factor, session in ((1, "s"), (1.5, "t"))]
        self.assertEqual(self.one(few[0], disturbed(few[1], range(4)))[0].verdict, "disturbed")
        self.assertEqual(self.one(old, disturbed(slow, range(4)))[0].verdict, "slower")

    def test_disturbed_rounds_that_are_fewer(self):
        """Those of the new record are slow, the other six are 2 % slower in the median, but not all of them."""
        old = record("8", around(1, 6), session="s")
        times = [2e7] * 5 + [
            ns * factor for ns, factor in zip(around(1, 6), (0.97, 1.04, 0.98, 1.04, 1.03, 1.03))
        ]
        self.assertEqual(self.one(old, record("8", times, session="t"))[0].verdict, "slower")
        cell, _ = self.one(old, disturbed(record("8", times, session="t"), range(5)))
        self.assertEqual(cell.verdict, "disturbed")
        self.assertFalse(cell.undisturbed)

    def test_a_pair_is_disturbed_if_one_of_its_rounds_is(self):
        old, new = (
            disturbed(record("8", around(1, 12), session="s"), range(3)),
            disturbed(record("8", around(1, 12), session="s"), range(2, 5)),
        )
        self.assertEqual(self.one(old, new)[0].least_p, 2 / 2**7)

    def test_answers_count_before_disturbance(self):
        new = disturbed(record("8", around(1.5, 10), session="t"), range(10))
        new["work"]["digest"]["b"] = "0c"
        self.assertEqual(self.one(record("8", around(1, 10), session="s"), new)[0].verdict, "another_answer")


class Sessions(Files):
    def sessions(self, factors, name, **change):
        """A record of ten rounds for each factor, each of a session of its own."""
        return [
            record("8", around(factor, 10), session=f"{name}{number}") | change
            for number, factor in enumerate(factors)
        ]

    def test_the_session_is_the_unit(self):
        """Rounds of a session are alike, sessions are not: twenty rounds against twenty would tell the sides
        apart."""
        spread = [1, 1.1, 1.02, 1.08, 1.04]
        old, new = self.sessions(spread, "a"), self.sessions([1.01 * factor for factor in spread], "b")
        cell, found = self.compared(old, new)
        self.assertEqual(
            (cell.verdict, cell.paired, cell.before.sessions, len(cell.after.rounds)),
            ("not_shown", False, 5, 5),
        )
        self.assertEqual(cell.least_p, 2 / math.comb(10, 5))
        self.assertEqual(
            (cell.before.all_rounds, cell.before.samples, found[0].pooled, found[0].repeated), (50, 50, 1, 0)
        )
        made = notes.notes(*found)
        self.assertIn("1 cell is compared by sessions: 5 of old and 5 of new", made)
        self.assertFalse(any("separate runs" in note for note in made))
        self.assertEqual(
            self.compared(old, self.sessions([1.2 * factor for factor in spread], "b"))[0].verdict, "slower"
        )

    def test_one_session_against_several(self):
        cell, found = self.compared(self.sessions([1], "a"), self.sessions([1.5] * 5, "b"))
        self.assertEqual((cell.verdict, cell.before.sessions, cell.rounds_needed), ("too_few", 1, 4))
        self.assertIn("4 sessions on each side are enough", notes.summary(found[2], 0.05))

    def test_only_sessions_of_the_last_program_count(self):
        old, other = self.sessions([1, 1], "a"), {"commit": "ffff", "dirty": False, "processor": None}
        read = self.read(*self.sessions([3], "z", environment=other), *old)
        self.assertEqual((read.cells[0].sessions, read.repeated, read.pooled), (2, 1, 1))
        sources = {"commit": "abc1", "dirty": False, "processor": None, "sources": "77"}
        self.assertEqual(self.read(*old, *self.sessions([1], "b", environment=sources)).cells[0].sessions, 0)
        # A later record of a session continues the one before.
        again = record("8", around(2, 12), session="a0")
        self.assertEqual(
            [round(ns) for ns in self.read(*old, again).cells[0].times()],
            [round(numpy.median(around(1, 10))), round(numpy.median(around(2, 12)))],
        )

    def test_an_interrupted_cell_counts_only_if_it_is_the_last(self):
        partial = record("8", around(1, 3), session="a0") | {"sampling": {"interrupted": True}}
        whole = record("8", around(1, 3) + around(2, 9), session="a1")
        (cell,) = self.read(partial, whole).cells
        self.assertEqual((cell.sessions, len(cell.rounds)), (0, 12))
        self.assertEqual(self.read(whole, partial).cells[0].sessions, 2)
        self.assertEqual(len(self.read(partial).cells[0].rounds), 3)

    def test_a_session_is_disturbed_if_half_of_its_rounds_are(self):
        half, less = (
            disturbed(record("8", [3e7] * 4 + around(1, 6), session=name), range(count))
            for name, count in (("a", 5), ("b", 4))
        )
        (cell,) = self.read(half, less).cells
        self.assertEqual((cell.disturbed, cell.disturbed_rounds, cell.all_rounds), ({"a"}, 9, 20))
        self.assertEqual(
            (cell.rounds["a"], cell.rounds["b"]),
            (numpy.median([3e7] * 4 + around(1, 6)), numpy.median(around(1, 6))),
        )

    def test_a_change_of_disturbed_sessions_only(self):
        new = [disturbed(one, range(10)) for one in self.sessions([1.5] * 5, "b")]
        self.assertEqual(self.compared(self.sessions([1] * 5, "a"), new)[0].verdict, "disturbed")


class Rates(unittest.TestCase):
    """A/A comparisons of ten turns of four cells. Noise of sessions exceeds that of rounds; half of the turns
    meet other work, which slows one of the two processes down by up to a half."""

    @staticmethod
    def side(random, shared, slow, change):
        made = []
        for key in range(4):
            own = []
            for turn, drift in enumerate(shared):
                times = 1e7 * numpy.exp(
                    drift + change + random.normal(0, 0.01) + random.normal(0, 0.005, 10) + slow[turn]
                )
                one = disturbed(record(str(key), times, session=f"turn {turn}"), range(10 * (slow[turn] > 0)))
                own.append(cells.Cell(one))
            made.append(pooling.pooled(own))
        return cells.RecordedCells("", "", made, [], [], 4, 0, False)

    def verdicts(self, start, busy, change=0.0):
        random, found = numpy.random.default_rng(start), []
        for _ in range(25):
            shared = random.normal(0, 0.05, 10)
            slow = [numpy.where(random.random(10) < busy, random.uniform(0.05, 0.5, 10), 0) for _ in range(2)]
            matched = matching.match(
                self.side(random, shared, slow[0], 0), self.side(random, shared, slow[1], change)
            )
            found += [cell.verdict for cell in matched.cells]
        return found

    def test_one_program_against_itself(self):
        for start, busy in ((1, 0), (2, 0.25), (3, 1)):
            found = self.verdicts(start, busy)
            self.assertLessEqual(set(found), {"not_shown", "within_threshold", "disturbed", "too_few"}, busy)
            self.assertEqual(found.count("too_few"), 0)

    def test_five_percent_are_found_on_an_idle_machine(self):
        found = self.verdicts(4, 0, math.log(1.05))
        self.assertGreaterEqual(found.count("slower"), 90)
        self.assertEqual(found.count("disturbed"), 0)
