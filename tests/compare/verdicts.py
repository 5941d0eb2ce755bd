# SPDX-License-Identifier: MIT
# test: cost=1
"""Which cells are the fastest: lines that the program recorded, and verdicts of the
Python package on cells of several runs."""

import types
import unittest


from tandem.lines import RecordError
from tandem.verdicts import RecordedVerdicts, computed, verdict_of

SESSION = "0123456789abcdef"
LINE = {
    "schema": 4,
    "kind": "verdict",
    "session": SESSION,
    "devices": ["host"],
    "answers_differ": False,
    "cells": [
        {"key": "b", "chosen": False, "ratio": 1.0, "low": 1.0, "high": 1.0},
        {"key": "a", "chosen": False, "ratio": 1.01, "low": 0.9, "high": 1.1},
        {"key": "c", "chosen": False, "ratio": 2.0, "low": 1.9, "high": 2.1},
        {"key": "d", "chosen": False, "ratio": 3.0, "low": None, "high": None},
    ],
}


def cell_of(key, times, session=SESSION, pairs=None):
    """What verdicts need of a Cell."""
    return types.SimpleNamespace(
        key=key, rounds=dict(enumerate(times)), session=session, pairs=pairs, devices="host", chosen=False
    )


class Verdicts(unittest.TestCase):
    def setUp(self):
        self.cells = [cell_of(key, [1.0]) for key in "abcd"]
        self.recorded = RecordedVerdicts()
        self.recorded.add(LINE, "file:1")

    def test_recorded_lines_are_read(self):
        read = verdict_of(self.cells, self.recorded)
        self.assertTrue(read.is_recorded)
        self.assertEqual(
            [(one.cell, one.has_interval, one.is_told_apart) for one in read.cells],
            [(1, True, False), (0, True, False), (2, True, True), (3, False, False)],
        )
        self.assertEqual(read.leaders(), [1, 0])

    def test_a_line_is_of_exactly_its_cells(self):
        other = cell_of("a", [1.0], "another")
        for changed in (self.cells[1:], [other, *self.cells[1:]], [*self.cells, self.cells[0]]):
            self.assertFalse(verdict_of(changed, self.recorded).is_recorded)

    def test_computed(self):
        quick = [1.0, 1.1, 1.0, 1.1, 1.0, 1.1, 1.0]
        cells = [cell_of("slow", [2.0] * 7), cell_of("near", [1.1, *quick[:-1]]), cell_of("quick", quick)]
        for session in (SESSION, "", None):
            for number, cell in enumerate(cells):
                cell.session = f"{number}" if session is None else session
            found = computed(cells)
            self.assertEqual([one.cell for one in found.cells], [2, 1, 0])
            self.assertEqual(sorted(found.leaders()), [1, 2])
            self.assertTrue(
                found.cells[2].ratio.low < found.cells[2].ratio.value <= found.cells[2].ratio.high
            )

    def test_computed_from_few_rounds(self):
        one, two = cell_of("a", [1.0]), cell_of("b", [2.0])
        self.assertEqual([each.has_interval for each in computed([two, one]).cells], [False, False])
        self.assertEqual(computed([one, two]).leaders(), [0])
        self.assertEqual(computed([]).leaders(), [])

    def test_the_fastest_is_so_by_its_ratios(self):
        cells = [cell_of("a", [10, 20, 30]), cell_of("b", [9, 21, 28])]
        found = computed(cells)
        self.assertEqual([one.cell for one in found.cells], [1, 0])
        self.assertGreater(found.cells[1].ratio.value, 1)

    def test_other_answers_have_no_fastest(self):
        cells = [cell_of("a", [1.0], pairs=1), cell_of("b", [2.0], pairs=2)]
        self.assertEqual(computed(cells).leaders(), [])
        self.assertEqual(computed(cells, same_work=False).leaders(), [0])

    def test_bad_lines_are_one_error(self):
        first = LINE["cells"][0]
        less = lambda fields, name: {key: value for key, value in fields.items() if key != name}
        cells = [less(first, name) for name in ("key", "chosen", "ratio", "low", "high")]
        for broken in (
            *(less(LINE, name) for name in ("session", "devices", "answers_differ", "cells")),
            *({**LINE, "cells": [cell]} for cell in (*cells, 7)),
            {**LINE, "cells": 7},
            {**LINE, "devices": 7},
        ):
            with (
                self.subTest(broken=broken),
                self.assertRaisesRegex(
                    RecordError, r"^file:3: a verdict that does not match results/verdict\.schema\.json"
                ),
            ):
                RecordedVerdicts().add(broken, "file:3")
