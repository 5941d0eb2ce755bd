# SPDX-License-Identifier: MIT
# test: cost=8 full=25
"""Rates of false and missed changes in synthetic records."""

import math
import unittest
from unittest import mock

import numpy

from tandem.comparison import cells, matching
from tandem.ratio import Ratio
from tests.compare.cells import record
from tests.program import LONG

TRIALS = 2000 if LONG else 600


class Rates(unittest.TestCase):
    """Rates over many pairs of synthetic records: noise of rounds, drift of the machine that interleaved cells
    share, and a change of the first cell alone."""

    def setUp(self):
        # Results depend on ranks and on the ratio's value; computing its interval would take most of the time.
        def unpaired(before, after):
            return Ratio(
                float(numpy.exp(numpy.median(numpy.subtract.outer(numpy.log(after), numpy.log(before))))),
                1,
                1,
                0.01,
            )

        def paired(before, after):
            return Ratio(float(numpy.exp(numpy.median(numpy.log(numpy.divide(after, before))))), 1, 1, 0.01)

        for name, cheap in (("unpaired_ratio", unpaired), ("paired_ratio", paired)):
            patch = mock.patch.object(matching.rank_tests, name, cheap)
            patch.start()
            self.addCleanup(patch.stop)

    @staticmethod
    def side(times, session):
        made = [cells.Cell(record(str(number), row, session=session)) for number, row in enumerate(times)]
        return cells.RecordedCells("", "", made, [], [], len(made), 0, False)

    def found(
        self, start, times=TRIALS, *, paired=False, cells_each=1, rounds=10, noise=0.02, drift=0.0, change=0.0
    ):
        """The fraction of trials in which any change is reported, however small."""
        random, count = numpy.random.default_rng(start), 0
        for _ in range(times):
            shared = random.normal(0, drift, (cells_each, rounds))
            before, after = (
                1e7 * numpy.exp(random.normal(0, noise, (cells_each, rounds)) + shared) for _ in range(2)
            )
            after[0] *= math.exp(change)
            matched = matching.match(
                self.side(before, "one"), self.side(after, "one" if paired else "two"), threshold=0
            )
            count += matched.changed
        return count / times

    @staticmethod
    def error(fraction, times):
        """Four standard errors of a fraction of so many trials."""
        return 4 * math.sqrt(fraction * (1 - fraction) / times)

    def test_false_alarms_have_the_rate_of_the_tests(self):
        for start, fraction, how in (
            (11, 50 / 1024, {"paired": True}),  # 10 pairs: 50 of 1,024 sets of signs
            (12, 50 / 1024, {"paired": True, "drift": 0.2}),  # shared by both of a pair
            (13, 0.0433, {}),
        ):  # 10 against 10, U of 23 or less
            self.assertAlmostEqual(self.found(start, **how), fraction, delta=self.error(fraction, TRIALS))

    def test_many_cells_together_raise_no_more_false_alarms(self):
        for paired in (False, True):
            self.assertLessEqual(
                self.found(14, 150, paired=paired, cells_each=20, rounds=12), 0.05 + self.error(0.05, 150)
            )
        # A change of one cell is found among 19 others.
        self.assertEqual(self.found(15, 20, paired=True, cells_each=20, rounds=12, change=0.2), 1)

    def test_the_least_effect_is_found_four_times_of_five(self):
        """Rank tests use more of normal noise than medians do, so they detect the change more often."""
        for rounds in (8, 20):
            # For normal noise, the variance of a median over that of a mean is pi / 2; two medians are
            # subtracted.
            error = 0.02 * math.sqrt(math.pi / rounds)
            change = math.log1p(matching.least_effect(error, 0.05))
            for start, paired in ((16, True), (17, False)):
                fraction = self.found(start, TRIALS // 2, paired=paired, rounds=rounds, change=change)
                self.assertTrue(
                    0.8 - self.error(0.8, TRIALS // 2) < fraction < 0.99, (rounds, paired, fraction)
                )

    def test_pairs_are_insensitive_to_drift(self):
        drifting = {"noise": 0.005, "drift": 0.1, "change": 0.02}
        self.assertLess(self.found(18, 200, **drifting), 0.2)
        self.assertGreater(self.found(18, 200, paired=True, **drifting), 0.99)
