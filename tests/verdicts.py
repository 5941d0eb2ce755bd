#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""verdicts.py GENERATOR SOURCE: verdicts of the program and of the Python package on 100 sessions with
made-up times."""

import json
import statistics
import subprocess
import sys
import types
import unittest

from program import PROGRAM, SOURCE
from validate_records import problems_of_record

sys.path.insert(0, str(SOURCE / "python"))
from tandem.lines import RecordError
from tandem.verdicts import RecordedVerdicts, computed, verdict_of

SESSION = "0123456789abcdef"


def timed(cell, session=SESSION):
    by_round = {}
    for number, ns in zip(cell["rounds"], cell["samples"]):
        by_round.setdefault(number, []).append(ns)
    rounds = {number: statistics.median(own) for number, own in by_round.items()}
    return cell_of(cell["key"], rounds, session, cell["digest"])


def cell_of(key, rounds, session=SESSION, pairs=None):
    """What verdicts need of a Cell."""
    return types.SimpleNamespace(
        key=key, rounds=rounds, session=session, pairs=pairs, devices="host", chosen=False
    )


def comparable(cells):
    """Lists of at least two correct cells with pairs, of equal k."""
    groups = {}
    for cell in cells:
        if cell["ok"] and cell["pairs"] > 0:
            groups.setdefault(cell["k"], []).append(timed(cell))
    return [group for group in groups.values() if len(group) > 1]


class Verdicts(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        made = subprocess.run([PROGRAM, "100"], capture_output=True, text=True, check=True).stdout
        cls.sessions = [json.loads(line) for line in made.splitlines()]

    def pairs(self):
        """Each group of comparable cells with the line of the program."""
        for session in self.sessions:
            groups = comparable(session["cells"])
            self.assertEqual(len(groups), len(session["verdicts"]))
            yield from zip(groups, session["verdicts"])

    def test_equals_the_program(self):
        apart, differ, single, groups = 0, 0, 0, 0
        for cells, line in self.pairs():
            self.assertEqual(problems_of_record(line, "verdict"), [])
            own = computed(cells)
            self.assertEqual(
                [cells[one.cell].key for one in own.cells], [cell["key"] for cell in line["cells"]]
            )
            self.assertEqual(own.answers_differ, line["answers_differ"])
            for one, cell in zip(own.cells, line["cells"]):
                self.assertAlmostEqual(one.ratio.value, cell["ratio"], delta=1e-12 * cell["ratio"])
                self.assertEqual(one.has_interval, cell["low"] is not None)
                self.assertEqual(one.is_told_apart if one.has_interval else None, cell["told_apart"])
                if one.has_interval:
                    self.assertAlmostEqual(one.ratio.low, cell["low"], delta=1e-12 * cell["low"])
                    self.assertAlmostEqual(one.ratio.high, cell["high"], delta=1e-12 * cell["high"])
            groups += 1
            apart += any(cell["told_apart"] for cell in line["cells"])
            single += any(cell["low"] is None for cell in line["cells"])
            differ += line["answers_differ"]
        # The sessions have all cases.
        self.assertGreater(min(apart, groups - apart, single, differ), 5, (groups, apart, single, differ))

    def test_sentences(self):
        sentences = [sentence for session in self.sessions for sentence in session["sentences"]]
        for words in (
            "is the fastest of ",
            "has the lowest median of ",
            "(one round: no interval)",
            "is not told apart from it (",
            "found different sets of candidate pairs",
            "The slowest, ",
        ):
            self.assertTrue(any(words in sentence for sentence in sentences), words)

    def test_recorded_lines_are_read(self):
        for cells, line in self.pairs():
            recorded = RecordedVerdicts()
            recorded.add({**line, "session": SESSION, "devices": ["host"]}, "file:1")
            read = verdict_of(cells, recorded)
            self.assertTrue(read.is_recorded)
            self.assertEqual(
                [(one.cell, one.has_interval, one.is_told_apart) for one in read.cells],
                [(one.cell, one.has_interval, one.is_told_apart) for one in computed(cells).cells],
            )
            self.assertEqual(read.leaders(), computed(cells).leaders())
            # Not of exactly these cells.
            for changed in (cells[1:], [timed_of_another_session(cells[0]), *cells[1:]], [*cells, cells[0]]):
                self.assertFalse(verdict_of(changed, recorded).is_recorded)

    def test_leaders(self):
        quick, slow, doubtful = (
            [1.0, 1.1, 1.0, 1.1, 1.0, 1.1, 1.0],
            [2.0] * 7,
            [1.1, 1.0, 1.1, 1.0, 1.1, 1.0, 1.1],
        )
        cells = [cell_of(str(i), dict(enumerate(times))) for i, times in enumerate((slow, doubtful, quick))]
        self.assertEqual(sorted(computed(cells).leaders()), [1, 2])
        self.assertEqual(
            computed([cell_of("a", {0: 1.0}, pairs=1), cell_of("b", {0: 2.0}, pairs=2)]).leaders(), []
        )
        self.assertEqual(computed([cell_of("a", {0: 1.0}), cell_of("b", {0: 2.0})]).leaders(), [0])
        self.assertEqual(computed([]).leaders(), [])

    def test_bad_lines_are_one_error(self):
        _, line = next(self.pairs())
        first = line["cells"][0]
        without = [
            {name: value for name, value in line.items() if name != left_out}
            for left_out in ("session", "devices", "answers_differ", "cells")
        ]
        cells = [
            {name: value for name, value in first.items() if name != left_out}
            for left_out in ("key", "chosen", "ratio", "low", "high")
        ]
        for broken in (
            *without,
            *({**line, "cells": [cell]} for cell in (*cells, 7)),
            {**line, "cells": 7},
            {**line, "devices": 7},
        ):
            with (
                self.subTest(broken=broken),
                self.assertRaisesRegex(
                    RecordError, r"^file:3: a verdict that does not match results/verdict\.schema\.json"
                ),
            ):
                RecordedVerdicts().add(broken, "file:3")


def timed_of_another_session(cell):
    return cell_of(cell.key, cell.rounds, "another", cell.pairs)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
