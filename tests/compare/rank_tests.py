# SPDX-License-Identifier: MIT
# test: cost=6
"""Rank tests against published tables, their ratios and intervals against the tests,
and properties of intervals of synthetic noise."""

import math
import statistics
import unittest

import numpy


from tandem import rank_tests, resampling
from tandem.comparison import matching
from tandem.ratio import Ratio


class Tests(unittest.TestCase):
    def test_critical_values_of_tables(self):
        """Two-sided at 5 %: the largest sum of ranks (Wilcoxon and Wilcox 1964), and the largest U (Mann and
        Whitney 1947)."""
        for pairs, total in {6: 0, 7: 2, 8: 3, 9: 5, 10: 8, 12: 13, 15: 25, 20: 52, 25: 89, 30: 137}.items():
            self.assertEqual(rank_tests.signed_rank_tail(pairs)[0], total, pairs)
        for sizes, u in {(4, 4): 0, (4, 6): 2, (5, 8): 6, (8, 8): 13, (10, 15): 39, (20, 20): 127}.items():
            for both in (sizes, sizes[::-1]):
                self.assertEqual(rank_tests.rank_sum_tail(*both)[0], u, both)

    def test_tails_have_their_probability(self):
        self.assertEqual(rank_tests.signed_rank_tail(6), (0, 1 / 64))
        self.assertEqual(rank_tests.signed_rank_tail(5), (0, 1 / 32))
        number, probability = rank_tests.rank_sum_tail(5, 5)
        self.assertEqual(number, 2)
        self.assertAlmostEqual(probability, 4 / 252, places=14)

    def test_few_values_with_ties_are_exact(self):
        """All ranks tie, so this is a sign test: 1 of 6 negative or fewer, 2 * 7 / 64. 3 of 8 values on one side
        have the lowest ranks, of which two tie: 3 of 56 arrangements have a sum of ranks as low."""
        p, is_exact = rank_tests.signed_ranks([1, 1, 1, 1, 1, -1, 0])
        self.assertAlmostEqual(p, 14 / 64, places=14)
        self.assertTrue(is_exact)
        for sides in (([1, 1, 2], [2, 2, 3, 4, 5]), ([2, 2, 3, 4, 5], [1, 1, 2])):
            p, is_exact = rank_tests.rank_sums(*sides)
            self.assertAlmostEqual(p, 6 / 56, places=14)
            self.assertTrue(is_exact)

    def test_ties_and_large_samples_are_approximated(self):
        small, large = numpy.arange(1, 21.0), numpy.arange(1, 101.0)
        for differences, is_exact in ((small, True), (numpy.ones(20), False), (large, False), ([0, 0], True)):
            p, exact = rank_tests.signed_ranks(differences)
            self.assertEqual((exact, p < 0.001), (is_exact, len(differences) > 2))
        for sides, is_exact in (((small, small + 20), True), ((small, small + 19), False)):
            p, exact = rank_tests.rank_sums(*sides)
            self.assertEqual((exact, p < 0.001), (is_exact, True))
        self.assertEqual(rank_tests.rank_sums(large, large + 100)[1], False)
        self.assertEqual(rank_tests.rank_sums([1] * 60, [1] * 60), (1, False))

    def test_least_values_are_those_of_separated_sides(self):
        for n in range(1, 13):
            self.assertAlmostEqual(
                rank_tests.least_signed_rank_p(n), rank_tests.signed_ranks(range(1, n + 1))[0], places=15
            )
            for m in range(1, 13):
                p, _ = rank_tests.rank_sums(numpy.arange(n), 100.0 + numpy.arange(m))
                self.assertAlmostEqual(rank_tests.least_rank_sum_p(n, m), p, delta=1e-12)

    def test_holm(self):
        numpy.testing.assert_allclose(
            rank_tests.holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02], rtol=1e-15
        )
        self.assertEqual(list(rank_tests.holm([0.6, 0.7])), [1, 1])
        self.assertEqual(list(rank_tests.holm([0.2])), [0.2])
        self.assertEqual(len(rank_tests.holm([])), 0)


class RankRatios(unittest.TestCase):
    def test_by_hand(self):
        """Means of pairs of 0, 0.1 and 0.4; differences of 0, 1 and of 2, 4."""
        self.assertAlmostEqual(
            math.log(rank_tests.paired_ratio([1] * 3, numpy.exp([0, 0.1, 0.4])).value), 0.15
        )
        ratio = rank_tests.unpaired_ratio(numpy.exp([0, 1]), numpy.exp([2, 4]))
        self.assertAlmostEqual(math.log(ratio.value), 2.5)
        self.assertEqual((ratio.low, ratio.high, ratio.log_error), (None, None, None), "no ratio is rejected")

    def test_intervals_have_the_ratios_that_are_not_rejected(self):
        random = numpy.random.default_rng(7)
        before, after = numpy.exp(random.normal(0, 0.03, (2, 12)))
        for ratio, p in (
            (
                rank_tests.paired_ratio(before, after),
                lambda by: rank_tests.signed_ranks(numpy.log(after / before / by))[0],
            ),
            (
                rank_tests.unpaired_ratio(before, after),
                lambda by: rank_tests.rank_sums(before * by, after)[0],
            ),
        ):
            for inside in (ratio.low * (1 + 1e-9), ratio.value, ratio.high * (1 - 1e-9)):
                self.assertGreater(p(inside), 0.05)
            for outside in (ratio.low * (1 - 1e-9), ratio.high * (1 + 1e-9)):
                self.assertLessEqual(p(outside), 0.05)

    def test_equal_records_have_ratio_one(self):
        times = 1e6 * numpy.exp(numpy.random.default_rng(8).normal(0, 0.03, 9))
        self.assertEqual(rank_tests.unpaired_ratio(times, times).value, 1)
        self.assertEqual(rank_tests.paired_ratio(times, times), Ratio(1, 1, 1, 0))

    def test_they_have_less_error_than_medians_and_state_it(self):
        """Theory: 0.0307 / sqrt(12) against 0.0376 / sqrt(12) for normal noise of 0.03."""
        random = numpy.random.default_rng(9)
        before, after = numpy.ones(12), numpy.exp(random.normal(0, 0.03, (1500, 12)))
        found = [rank_tests.paired_ratio(before, row) for row in after]
        medians = numpy.median(numpy.log(after), axis=1)
        error = statistics.pstdev(math.log(ratio.value) for ratio in found)
        self.assertAlmostEqual(error / (0.0307 / math.sqrt(12)), 1, delta=0.06)
        self.assertLess(error, 0.88 * medians.std())
        self.assertAlmostEqual(statistics.fmean(ratio.log_error for ratio in found) / error, 1, delta=0.1)
        # The exact level of twelve pairs is 4.25 %; three standard errors are 1.6 %.
        self.assertAlmostEqual(
            sum(ratio.low <= 1 <= ratio.high for ratio in found) / len(found), 0.9575, delta=0.016
        )


class Ratios(unittest.TestCase):
    def test_by_hand(self):
        self.assertAlmostEqual(resampling.paired_ratio([1, 1, 1], [1.1, 1.2, 1.4]).value, 1.2, places=15)
        ratio = resampling.unpaired_ratio([1, 2, 5], [3, 3, 4, 9])
        self.assertAlmostEqual(ratio.value, 3.5 / 2, places=15)
        self.assertTrue(ratio.low <= ratio.value <= ratio.high)

    def test_equal_values_have_no_error(self):
        ratio = resampling.unpaired_ratio([200] * 7, [300] * 5)
        for value in (ratio.value, ratio.low, ratio.high):
            self.assertAlmostEqual(value, 1.5, places=14)
        self.assertEqual(ratio.log_error, 0)
        self.assertEqual(resampling.paired_ratio([1], [1.6]).log_error, 0)

    def test_intervals_contain_the_truth(self):
        """Three standard errors of 1,000 draws are 2 %; unpaired intervals of so few values contain the median more
        often."""
        random = numpy.random.default_rng(4)

        def coverage(ratio, rounds):
            held = 0
            for _ in range(1000):
                before, after = 1e7 * numpy.exp(random.normal(0, 0.03, (2, rounds)))
                found = ratio(before, 1.1 * after)
                held += found.low <= 1.1 <= found.high
            return held / 1000

        for rounds in (10, 25):
            self.assertTrue(0.94 < coverage(resampling.unpaired_ratio, rounds) < 0.995, rounds)
            self.assertTrue(0.94 < coverage(resampling.paired_ratio, rounds) < 0.99, rounds)

    def test_intervals_of_medians(self):
        self.assertEqual(resampling.median_interval([7]), (7, 7))
        values = numpy.random.default_rng(3).normal(5, 1, 25)
        low, high = resampling.median_interval(values)
        self.assertTrue(low < statistics.median(values) < high)
        self.assertEqual(resampling.median_interval(values), (low, high), "reproducible")

    def test_the_error_is_the_deviation_of_the_estimate(self):
        random = numpy.random.default_rng(5)
        ratios = [resampling.unpaired_ratio(*numpy.exp(random.normal(0, 0.03, (2, 15)))) for _ in range(400)]
        deviation = math.sqrt(statistics.fmean(math.log(ratio.value) ** 2 for ratio in ratios))
        self.assertAlmostEqual(
            statistics.fmean(ratio.log_error for ratio in ratios) / deviation, 1, delta=0.2
        )

    def test_least_effect_is_that_of_normal_tests(self):
        self.assertAlmostEqual(
            matching.least_effect(0.01, 0.05, 0.8), math.expm1(0.02801585218112968), delta=1e-12
        )
        self.assertEqual(matching.least_effect(0, 0.05, 0.8), 0)
