#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""rank_tests.py PROGRAM SOURCE: p-values against published tables and all arrangements of ranks; ratios
computed by hand and against known properties of synthetic noise."""

import itertools
import math
import statistics
import sys
import unittest

import numpy
import scipy.stats

from program import SOURCE

sys.path.insert(0, str(SOURCE / "python"))
from tandem import rank_ratios, rank_tests, resampling  # noqa: E402
from tandem.cell import each  # noqa: E402
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
        # 60 pairs that all tie, 40 of them positive: W = 40 * 30.5 = 1220; the variance is smaller by (60^3 -
        # 60) / 48.
        self.assertAlmostEqual(
            rank_tests.signed_ranks([-1] * 20 + [1] * 40)[0],
            math.erfc(304.5 / math.sqrt(2 * 13953.75)),
            delta=1e-15,
        )


class RankSums(unittest.TestCase):
    def test_critical_values_of_tables(self):
        """Two-sided critical values of U at 5 % (Mann and Whitney 1947)."""
        for side, other, u in (
            (4, 4, 0),
            (4, 6, 2),
            (5, 5, 2),
            (5, 8, 6),
            (8, 8, 13),
            (10, 10, 23),
            (10, 15, 39),
            (3, 5, 0),
            (15, 15, 64),
            (20, 20, 127),
        ):
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
        numpy.testing.assert_allclose(
            rank_tests.holm([0.01, 0.04, 0.03, 0.005]), [0.03, 0.06, 0.06, 0.02], rtol=1e-15
        )
        self.assertEqual(list(rank_tests.holm([0.6, 0.7])), [1, 1])
        self.assertEqual(list(rank_tests.holm([0.2])), [0.2])
        self.assertEqual(len(rank_tests.holm([])), 0)


class Tails(unittest.TestCase):
    def test_tails_are_those_of_p(self):
        """The tail's number is the largest whose p is at most twice the probability."""
        for pairs in (1, 5, 6, 10, 25, 50, 60):
            at, below = rank_tests.signed_rank_tail(pairs, 0.025)
            self.assertAlmostEqual(
                2 * below, signed_p(pairs, at), delta=1e-12 if pairs <= 50 else 2e-3, msg=pairs
            )
            self.assertEqual(2 * below <= 0.05, pairs >= 6)
            self.assertGreater(signed_p(pairs, at + 1), 0.05)
        for side, other in ((1, 1), (3, 3), (4, 4), (10, 10), (30, 10), (45, 60)):
            at, below = rank_tests.rank_sum_tail(side, other, 0.025)
            exact = side * (side + other) <= rank_tests.MAX_SUMS
            self.assertAlmostEqual(
                2 * below, sums_p(side, other, at), delta=1e-12 if exact else 2e-3, msg=(side, other)
            )
            self.assertGreater(sums_p(side, other, at + 1), 0.05)


def all_means(logs):
    return sorted((logs[i] + logs[j]) / 2 for i in range(len(logs)) for j in range(i + 1))


def all_differences(before, after):
    return sorted(b - a for a in before for b in after)


class RankRatios(unittest.TestCase):
    def check(self, ratio, estimates, outside):
        """outside: how many estimates are outside of the interval on each side, and the probability of that."""
        at, probability = outside
        self.assertAlmostEqual(math.log(ratio.value), statistics.median(estimates), delta=1e-13)
        if probability > 0.025:
            self.assertEqual(
                (ratio.low, ratio.high, ratio.log_error), (None, None, None), "no ratio is rejected"
            )
            return
        for value, expected in ((ratio.low, estimates[at]), (ratio.high, estimates[-1 - at])):
            self.assertAlmostEqual(math.log(value), expected, delta=1e-13)

    def test_they_are_those_of_all_pairs(self):
        random = numpy.random.default_rng(6)
        for size in (1, 2, 5, 6, 10, 25, 60):
            logs = random.normal(0.05, 0.03, size)
            outside = rank_tests.signed_rank_tail(size, 0.025)
            self.check(
                rank_ratios.paired_ratio(numpy.full(size, 1e6), 1e6 * numpy.exp(logs)),
                all_means(list(logs)),
                outside,
            )
        for size, other in ((1, 1), (12, 1), (1, 4), (3, 3), (4, 4), (5, 9), (12, 10), (40, 70)):
            before, after = random.normal(10, 0.03, size), random.normal(10.1, 0.03, other)
            outside = rank_tests.rank_sum_tail(size, other, 0.025)
            self.check(
                rank_ratios.unpaired_ratio(numpy.exp(before), numpy.exp(after)),
                all_differences(before, after),
                outside,
            )

    def test_intervals_have_the_ratios_that_are_not_rejected(self):
        random = numpy.random.default_rng(7)
        before, after = numpy.exp(random.normal(0, 0.03, (2, 12)))
        for ratio, p in (
            (
                rank_ratios.paired_ratio(before, after),
                lambda by: rank_tests.signed_ranks(numpy.log(after / before / by))[0],
            ),
            (
                rank_ratios.unpaired_ratio(before, after),
                lambda by: rank_tests.rank_sums(before * by, after)[0],
            ),
        ):
            for inside in (ratio.low * (1 + 1e-9), ratio.value, ratio.high * (1 - 1e-9)):
                self.assertGreater(p(inside), 0.05)
            for outside in (ratio.low * (1 - 1e-9), ratio.high * (1 + 1e-9)):
                self.assertLessEqual(p(outside), 0.05)

    def test_equal_records_have_ratio_one(self):
        times = 1e6 * numpy.exp(numpy.random.default_rng(8).normal(0, 0.03, 9))
        self.assertEqual(rank_ratios.unpaired_ratio(times, times).value, 1)
        self.assertEqual(rank_ratios.paired_ratio(times, times), resampling.Ratio(1, 1, 1, 0))

    def test_they_have_less_error_than_medians_and_state_it(self):
        """Theory: 0.0307 / sqrt(12) against 0.0376 / sqrt(12) for normal noise of 0.03."""
        random = numpy.random.default_rng(9)
        before, after = numpy.ones(12), numpy.exp(random.normal(0, 0.03, (1500, 12)))
        found = [rank_ratios.paired_ratio(before, row) for row in after]
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

    def test_the_ratio_equals_the_programs(self):
        """tests/unit/sampling_ratio.cpp has the same numbers for the program's table."""
        logs = [0.01 * (i * 7 % 11) - 0.03 for i in range(12)]
        ratio = resampling.paired_ratio([1] * 12, numpy.exp(logs))
        for value, expected in (
            (ratio.value, 1.015113064615719),
            (ratio.low, 0.9801986733067553),
            (ratio.high, 1.0512710963760241),
        ):
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
            for cell in each(SOURCE / "results" / name):
                if cell.rounds:
                    total = cell.record["total_ns"]
                    self.assertEqual(
                        resampling.median_interval(cell.times()), (total["low"], total["high"]), cell.location
                    )
                    found += 1
        self.assertGreater(found, 100)
        self.assertEqual(resampling.median_interval([7]), (7, 7))
        for values in (3, 10, 25):
            tail = scipy.stats.norm.sf(
                math.sqrt(values / (values - 1)) * scipy.stats.t.ppf(0.975, values - 1)
            )
            self.assertAlmostEqual(resampling.interval_tail(values) / tail, 1, delta=1e-7)

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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
