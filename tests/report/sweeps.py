# SPDX-License-Identifier: MIT
# test: cost=1
"""Sweeps of a page about records (python/tandem/report/sweeps.py): their lines, and the findings in their titles."""

import unittest

from tests.report.sentences import ONE_MS, THREE_MS, TWO_MS, cell_of

from tandem.cell import Answer
from tandem.report.sweeps import sweeps_of


def swept(setting, values, times, k="18", pairs=None, **changes):
    """Cells with these values of a setting, each with its rounds."""
    return [
        cell_of(
            "a",
            rounds,
            pairs=pairs and Answer(pairs + i, "1", "2"),
            **{"settings": {"k": k, setting: value}, "key": f"a|k={k}|{setting}={value}"} | changes,
        )
        for i, (value, rounds) in enumerate(zip(values, times))
    ]


class Sweeps(unittest.TestCase):
    def test_a_line_and_its_verdict(self):
        [sweep] = sweeps_of(swept("seed_threshold", ["1000", "0", "10"], [TWO_MS, THREE_MS, ONE_MS]))
        self.assertEqual(
            (sweep["setting"], sweep["of"], sweep["all"]),
            ("seed_threshold", "3 jacks, density 0.2, frames 0:0, k = 18, on cuda:0 (GPU)", 1),
        )
        self.assertEqual(sweep["lines"], [{"name": "a", "points": [[0, 1], [10, 2], [1000, 0]]}])
        self.assertIn(
            "seed_threshold = 10 is fastest: 1.00 ms per frame, 2.00 times as fast as seed_threshold = 1000 [",
            sweep["title"],
        )

    def test_each_value_of_a_scene_s_parameter_is_a_scene(self):
        cells = [
            cell_of(
                "a",
                [ms * count for ms in ONE_MS],
                key=f"{count}",
                scene={
                    "key": f"pile:bodies={count}",
                    "name": "pile",
                    "digest": f"{count}",
                    "bodies": count,
                    "tetrahedra": 36,
                },
            )
            for count in (10, 2, 5)
        ]
        [sweep] = sweeps_of(cells)
        self.assertEqual(sweep["title"], "a: 2.00 ms per frame with bodies = 2, 10.0 with 10")

    def test_titles(self):
        times = [ONE_MS, TWO_MS, THREE_MS]
        for setting, rounds, pairs, title in (
            (
                "seed_threshold",
                times,
                0,
                "= 1 is fastest: 1.00 ms per frame, 2.00 times as fast as seed_threshold = 10 [",
            ),
            (
                "seed_threshold",
                [[1.0], [2.0], [3.0]],
                0,
                "= 1 took the least time, in fewer than 5 rounds: 1.00 ms per frame, 2.00 times as fast",
            ),
            ("seed_threshold", times, 3, "Answers differ: these times are of different work"),
            ("k", times, 3, "k = 1 is fastest: "),
        ):
            [sweep] = sweeps_of(swept(setting, ["1", "10", "100"], rounds, pairs=pairs))
            self.assertIn(title, sweep["title"])
        cells = [cell for k in ("18", "8") for cell in swept("seed_threshold", ["0", "1", "2"], times, k)]
        found = [(sweep["of"].split(", ")[3], sweep["all"]) for sweep in sweeps_of(cells)]
        self.assertEqual(found, [("k = 18", 1), ("k = 8", 1)])

    def test_what_is_no_sweep(self):
        times = [ONE_MS, TWO_MS, TWO_MS]
        self.assertEqual(sweeps_of(swept("rounding", ["safe", "1", "2"], times)), [])
        self.assertEqual(sweeps_of(swept("seed_threshold", ["0", "1"], times[:2])), [])
        self.assertEqual(sweeps_of(swept("seed_threshold", ["0", "1", "2"], times, status="wrong")), [])
