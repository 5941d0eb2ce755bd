#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""rank_tests.py PROGRAM SOURCE: p-values against published tables and all arrangements of ranks; ratios computed by
hand and against known properties of synthetic noise."""
import itertools
import math
import statistics
import sys
import unittest

import numpy
import scipy.stats

from program import SOURCE

sys.path.insert(0, str(SOURCE / "python"))
from tandem import lines, rank_tests, resampling  # noqa: E402
from tandem.comparison import matching  # noqa: E402


def with_rank_sum(pairs, total):
    """Differences of sizes 1 to `pairs`; the ranks of the positive ones sum to `total`."""
    differences = []
    for rank in range(pairs, 0, -1):
        differences.append(rank if rank <= total else -rank)
        total -= rank if rank <= total else 0
    return differences


def signed_p(pairs, total):
    return rank_tests.signed_ranks(with_rank_sum(pairs, total))[0]


def sums_p(side, other, u):
    """Ranks from 1, `side` of them on one side: starts with the lowest ranks and moves them up until U is `u`."""
    one = list(range(1, side + 1))
    for i in range(side - 1, -1, -1):
        up = min(u, other)
        one[i] += up
        u -= up
    two = [rank for rank in range(1, side + other + 1) if rank not in one]
    return rank_tests.rank_sums(one, two)[0]


class SignedRanks(unittest.TestCase):
    def test_critical_values_of_tables(self):
        """Two-sided at 5 % (Wilcoxon and Wilcox 1964): the largest smaller sum."""
        for pairs, total in {6: 0, 7: 2, 8: 3, 9: 5, 10: 8, 12: 13, 15: 25, 20: 52, 25: 89, 30: 137}.items():
            self.assertLessEqual(signed_p(pairs, total), 0.05, pairs)
            self.assertGreater(signed_p(pairs, total + 1), 0.05, pairs)
        # 25 of 1,024 sets of ranks have a sum of 8 or less
        self.assertAlmostEqual(signed_p(10, 8), 50 / 1024, places=15)
        for total, p in ((0, 2 / 32), (15, 2 / 32)):
            self.assertAlmostEqual(signed_p(5, total), p, places=15)
        self.assertEqual(signed_p(3, 3), 1)

    def test_ties_and_zeros(self):
        for differences in ([], [0, 0, 0]):
            self.assertEqual(rank_tests.signed_ranks(differences), (1, True))
        # All ranks tie, so this is a sign test: 1 of 6 negative or fewer, 2 * 7 / 64.
        self.assertAlmostEqual(rank_tests.signed_ranks([1, 1, 1, 1, 1, -1, 0])[0], 14 / 64, places=15)

    def test_every_sign(self):
        sizes, ranks = numpy.array([1, 2, 2, 3, 4, 4, 4, 5]), numpy.array([1, 2.5, 2.5, 4, 6, 6, 6, 8])
        signs = numpy.array(list(itertools.product((-1, 1), repeat=8)))
        sums = (ranks * (signs > 0)).sum(axis=1)
        for sign, total in zip(signs, sums):
            expected = min(1, 2 * min((sums <= total).sum(), (sums >= total).sum()) / 256)
            self.assertAlmostEqual(rank_tests.signed_ranks(sizes * sign)[0], expected, places=14)

    def test_approximation_by_hand(self):
        # 60 pairs of ranks 1 to 60; those above 20 are positive: W = 1620, mean 915, variance 18452.5.
        p, exact = rank_tests.signed_ranks([rank if rank > 20 else -rank for rank in range(1, 61)])
        self.assertAlmostEqual(p, math.erfc(704.5 / math.sqrt(2 * 18452.5)), delta=1e-15)
        self.assertFalse(exact)
        # 60 pairs that all tie, 40 of them positive: W = 40 * 30.5 = 1220; the variance is smaller by (60^3 - 60) / 48.
        self.assertAlmostEqual(rank_tests.signed_ranks([-1] * 20 + [1] * 40)[0], math.erfc(304.5 / math.sqrt(2 * 13953.75)), delta=1e-15)


class RankSums(unittest.TestCase):
    def test_critical_values_of_tables(self):
        """Two-sided critical values of U at 5 % (Mann and Whitney 1947)."""
        for side, other, u in ((4, 4, 0), (4, 6, 2), (5, 5, 2), (5, 8, 6), (8, 8, 13), (10, 10, 23), (10, 15, 39), (3, 5, 0), (15, 15, 64), (20, 20, 127)):
            self.assertLessEqual(sums_p(side, other, u), 0.05, (side, other))
            self.assertGreater(sums_p(side, other, u + 1), 0.05, (side, other))
            self.assertAlmostEqual(sums_p(side, other, u), sums_p(side, other, side * other - u), places=14)
        # 5 against 5: 1, 1, 2, 3, 5 of 252 arrangements have U = 0, 1, 2, 3, 4.
        for u, at_most in enumerate((1, 2, 4, 7, 12)):
            self.assertAlmostEqual(sums_p(5, 5, u), 2 * at_most / 252, places=14)
        self.assertAlmostEqual(sums_p(3, 3, 0), 0.1, places=15)

    def test_ties_in_every_arrangement(self):
        values, ranks = numpy.array([1, 1, 2, 3, 3, 3, 5, 6]), numpy.array([1.5, 1.5, 3, 5, 5, 5, 7, 8])
        sets = [list(chosen) for chosen in itertools.combinations(range(8), 3)]
        sums = numpy.array([ranks[chosen].sum() for chosen in sets])
        for chosen, total in zip(sets, sums):
            expected = min(1, 2 * min((sums <= total).sum(), (sums >= total).sum()) / 56)
            rest = numpy.delete(values, chosen)
            for sides in ((values[chosen], rest), (rest, values[chosen])):
                self.assertAlmostEqual(rank_tests.rank_sums(*sides)[0], expected, places=14)
        self.assertEqual(rank_tests.rank_sums([1] * 5, [1] * 5)[0], 1)

    def test_approximation_by_hand(self):
        # 50 values of 1 against 50 values, 25 of them 1: ties of 75 and 25. W = 50 * 38 = 1900, mean 2525.
        variance = 2500 / 12 * (101 - (421800 + 15600) / 9900)
        p, exact = rank_tests.rank_sums([1] * 50, [2] * 25 + [1] * 25)
        self.assertAlmostEqual(p, math.erfc(624.5 / math.sqrt(2 * variance)), delta=1e-15)
        self.assertFalse(exact)
        self.assertEqual(rank_tests.rank_sums([1] * 60, [1] * 60), (1, False))


class BothTests(unittest.TestCase):
    def test_approximations_continue_exact_values(self):
        random = numpy.random.default_rng(1)
        for draw in range(20):
            pairs = random.integers(40, size=50) - 14.4 - draw * 0.25
            before, after = random.integers(40, size=45), random.integers(40, size=45) + draw * 0.5
            exact = rank_tests.signed_ranks(pairs), rank_tests.rank_sums(before, after)
            # One more value in the middle changes little except the method.
            near = rank_tests.signed_ranks([*pairs, 0.001]), rank_tests.rank_sums([*before, 20], [*after, 20])
            for (p, counted), (approximate, also) in zip(exact, near):
                self.assertEqual((counted, also), (True, False))
                self.assertAlmostEqual(approximate, p, delta=0.02 + 0.05 * p)

    def test_least_values_are_those_of_separated_sides(self):
        for n in range(1, 13):
            self.assertAlmostEqual(rank_tests.least_signed_rank_p(n), signed_p(n, 0), places=15)
            for m in range(1, 13):
                self.assertAlmostEqual(rank_tests.least_rank_sum_p(n, m), sums_p(n, m, 0), delta=1e-12)

    def test_holm(self):
        numpy.testing.assert_allclose(rank_tests.holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02], rtol=1e-15)
        self.assertEqual(list(rank_tests.holm([0.6, 0.7])), [1, 1])
        self.assertEqual(list(rank_tests.holm([0.2])), [0.2])
        self.assertEqual(len(rank_tests.holm([])), 0)


class Ratios(unittest.TestCase):
    def test_by_hand(self):
        self.assertAlmostEqual(resampling.paired_ratio([1, 1, 1], [1.1, 1.2, 1.4]).value, 1.2, places=15)
        ratio = resampling.unpaired_ratio([1, 2, 5], [3, 3, 4, 9])
        self.assertAlmostEqual(ratio.value, 3.5 / 2, places=15)
        self.assertTrue(ratio.low <= ratio.value <= ratio.high)

    def test_the_ratio_equals_the_programs(self):
        """tests/unit/sampling_ratio.cpp has the same numbers for the program's table."""
        logs = [0.01 * (i * 7 % 11) - 0.03 for i in range(12)]
        ratio = resampling.paired_ratio([1] * 12, numpy.exp(logs))
        for value, expected in ((ratio.value, 1.015113064615719), (ratio.low, 0.9801986733067553), (ratio.high, 1.0512710963760241)):
            self.assertAlmostEqual(value, expected, delta=1e-14)

    def test_the_generator_is_the_standard_one(self):
        """The 10,000th word of mt19937_64 from its default seed is in the C++ standard, [rand.predef]."""
        words, seed = resampling._words, resampling.SEED
        try:
            resampling._words, resampling.SEED = words[:0], 5489
            self.assertEqual(int(resampling.random_words(10000)[-1]), 9981545732273789042)
        finally:
            resampling._words, resampling.SEED = words, seed

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

    def test_intervals_of_medians_equal_the_programs(self):
        """Bit for bit equal to the intervals that the program wrote to records."""
        found = 0
        for name in ("h200/plan.jsonl", "h200/seeds.jsonl", "h100x2/shares.jsonl"):
            for record, place in lines.each(SOURCE / "results" / name):
                if record["total_ns"]:
                    medians = [statistics.median(own) for own in lines.samples_by_round(record).values()]
                    self.assertEqual(resampling.median_interval(medians), (record["total_ns"]["low"], record["total_ns"]["high"]), place)
                    found += 1
        self.assertGreater(found, 100)
        self.assertEqual(resampling.median_interval([7]), (7, 7))
        for values in (3, 10, 25):
            tail = scipy.stats.norm.sf(math.sqrt(values / (values - 1)) * scipy.stats.t.ppf(0.975, values - 1))
            self.assertAlmostEqual(resampling.interval_tail(values) / tail, 1, delta=1e-7)

    def test_the_error_is_the_deviation_of_the_estimate(self):
        random = numpy.random.default_rng(5)
        ratios = [resampling.unpaired_ratio(*numpy.exp(random.normal(0, 0.03, (2, 15)))) for _ in range(400)]
        deviation = math.sqrt(statistics.fmean(math.log(ratio.value)**2 for ratio in ratios))
        self.assertAlmostEqual(statistics.fmean(ratio.log_error for ratio in ratios) / deviation, 1, delta=0.2)

    def test_least_effect_is_that_of_normal_tests(self):
        self.assertAlmostEqual(matching.least_effect(0.01, 0.05, 0.8), math.expm1(0.02801585218112968), delta=1e-12)
        self.assertEqual(matching.least_effect(0, 0.05, 0.8), 0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
