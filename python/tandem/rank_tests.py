# SPDX-License-Identifier: MIT
"""p-values of two-sided rank tests for tandem compare. Small tests are exact, also with ties, which scipy's
exact tests do not support."""

import functools
import math
import statistics

import numpy

MAX_PAIRS = 50
MAX_SUMS = 4096  # number of values of the smaller side times number of all values


def _doubled_ranks(values):
    """Doubled ranks from 1, and the sum of t^3 - t over groups of t equal values. Ties have the mean of their
    ranks, which is a whole number when doubled."""
    _, groups, counts = numpy.unique(values, return_inverse=True, return_counts=True)
    ends = numpy.cumsum(counts)
    tied = counts.astype(float)
    return (2 * ends - counts + 1)[groups], float((tied**3 - tied).sum())


def _two_sided(counts, at):
    below, equal, above = counts[:at].sum(), counts[at], counts[at + 1 :].sum()
    return float(min(1.0, 2 * (min(below, above) + equal) / (below + equal + above))), True


def _approximate(total, mean, variance):
    p = math.erfc(max(0.0, abs(total - mean) - 0.5) / math.sqrt(2 * variance)) if variance > 0 else 1.0
    return p, False


@functools.lru_cache(maxsize=64)
def _sets(ranks):
    """Number of sets of ranks by their sum. The cache helps because, without ties, cells with equally many
    rounds have equal ranks."""
    counts = numpy.zeros(sum(ranks) + 1)
    counts[0] = 1
    for rank in ranks:
        counts[rank:] = counts[rank:] + counts[:-rank]
    return counts


@functools.lru_cache(maxsize=64)
def _sets_of(size, ranks):
    """Number of sets of `size` ranks by their sum. `ranks` ascend."""
    counts = numpy.zeros((size + 1, sum(ranks[-size:]) + 1))
    counts[0, 0] = 1
    for rank in ranks:
        if rank < counts.shape[1]:
            counts[1:, rank:] = counts[1:, rank:] + counts[:-1, :-rank]
    return counts[size]


def signed_ranks(differences):
    """p of Wilcoxon's signed-rank test, and whether it is exact. Ignores zero differences."""
    differences = numpy.asarray(differences, float)
    differences = differences[differences != 0]
    n = len(differences)
    if n == 0:
        return 1.0, True
    ranks, ties = _doubled_ranks(numpy.abs(differences))
    total = int(ranks[differences > 0].sum())
    if n > MAX_PAIRS:
        return _approximate(total / 2, n * (n + 1) / 4, n * (n + 1) * (2 * n + 1) / 24 - ties / 48)
    return _two_sided(_sets(tuple(sorted(ranks))), total)


def rank_sums(before, after):
    """p of Wilcoxon's rank-sum test (Mann and Whitney's U), and whether it is exact."""
    if len(before) > len(after):
        before, after = after, before
    n, m = len(before), len(after)
    ranks, ties = _doubled_ranks(numpy.concatenate([before, after]))
    total = int(ranks[:n].sum())
    if n * (n + m) > MAX_SUMS:
        return _approximate(
            total / 2, n * (n + m + 1) / 2, n * m / 12 * (n + m + 1 - ties / ((n + m) * (n + m - 1)))
        )
    return _two_sided(_sets_of(n, tuple(sorted(ranks))), total)


def least_signed_rank_p(pairs):
    """The smallest p of the signed-rank test with this number of pairs."""
    return min(1.0, math.ldexp(2.0, -min(pairs, 1000)))


def least_rank_sum_p(before, after):
    small, large, p = min(before, after), max(before, after), 2.0
    for i in range(1, small + 1):
        p *= i / (large + i)
    return min(1.0, p)


def _tail(counts, most):
    """The largest number whose lower tail in `counts` has at most the probability `most`, and this
    probability. If 0 has more: 0."""
    below = numpy.cumsum(counts) / counts.sum()
    at = max(0, int(numpy.searchsorted(below, most, "right")) - 1)
    return at, float(below[at])


def _approximate_tail(mean, variance, most):
    at = max(0, math.floor(mean - 0.5 + statistics.NormalDist().inv_cdf(most) * math.sqrt(variance)))
    return at, 0.5 * math.erfc((mean - 0.5 - at) / math.sqrt(2 * variance))


def signed_rank_tail(pairs, most):
    """The largest sum of signed ranks, without ties, whose lower tail has at most the probability `most`, and
    this probability. If sum 0 has more: 0 and its probability."""
    if pairs > MAX_PAIRS:
        return _approximate_tail(pairs * (pairs + 1) / 4, pairs * (pairs + 1) * (2 * pairs + 1) / 24, most)
    return _tail(_sets(tuple(range(1, pairs + 1))), most)


def rank_sum_tail(before, after, most):
    """As signed_rank_tail, of Mann and Whitney's U."""
    small = min(before, after)
    if small * (before + after) > MAX_SUMS:
        return _approximate_tail(before * after / 2, before * after * (before + after + 1) / 12, most)
    return _tail(_sets_of(small, tuple(range(1, before + after + 1)))[small * (small + 1) // 2 :], most)


def holm(p):
    """p-values corrected for multiple tests (Holm 1979)."""
    p = numpy.asarray(p, float)
    order = numpy.argsort(p, kind="stable")
    corrected = numpy.empty(len(p))
    corrected[order] = numpy.maximum.accumulate(
        numpy.minimum(1.0, p[order] * (len(p) - numpy.arange(len(p))))
    )
    return corrected
