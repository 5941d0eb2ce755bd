# SPDX-License-Identifier: MIT
"""p-values of two-sided rank tests, exact also with ties where that is little work: as tandem compare has them. (scipy's exact
tests have none with ties.)"""
import functools
import math

import numpy

MOST_PAIRS = 50
MOST_SUMS = 4096  # of the smaller side's values times all values


def _doubled_ranks(values):
    """Ranks from 1, doubled: ties share their mean, which is then whole; and the sum of t^3 - t over groups of t equal values."""
    _, places, counts = numpy.unique(values, return_inverse=True, return_counts=True)
    ends = numpy.cumsum(counts)
    tied = counts.astype(float)
    return (2 * ends - counts + 1)[places], float((tied**3 - tied).sum())


def _two_sided(counts, at):
    below, here, above = counts[:at].sum(), counts[at], counts[at + 1:].sum()
    return float(min(1.0, 2 * (min(below, above) + here) / (below + here + above))), True


def _approximate(total, mean, variance):
    p = math.erfc(max(0.0, abs(total - mean) - 0.5) / math.sqrt(2 * variance)) if variance > 0 else 1.0
    return p, False


@functools.lru_cache(maxsize=64)
def _sets(ranks):
    """How many sets of ranks there are, by their sum. Without ties, cells with equally many rounds have the same ranks."""
    counts = numpy.zeros(sum(ranks) + 1)
    counts[0] = 1
    for rank in ranks:
        counts[rank:] = counts[rank:] + counts[:-rank]
    return counts


@functools.lru_cache(maxsize=64)
def _sets_of(size, ranks):
    """Likewise sets of `size` ranks, which ascend."""
    counts = numpy.zeros((size + 1, sum(ranks[-size:]) + 1))
    counts[0, 0] = 1
    for rank in ranks:
        if rank < counts.shape[1]:
            counts[1:, rank:] = counts[1:, rank:] + counts[:-1, :-rank]
    return counts[size]


def signed_ranks(differences):
    """p of Wilcoxon's signed ranks, and whether it is exact; differences of nothing take no part."""
    differences = numpy.asarray(differences, float)
    differences = differences[differences != 0]
    n = len(differences)
    if n == 0:
        return 1.0, True
    ranks, ties = _doubled_ranks(numpy.abs(differences))
    total = int(ranks[differences > 0].sum())
    if n > MOST_PAIRS:
        return _approximate(total / 2, n * (n + 1) / 4, n * (n + 1) * (2 * n + 1) / 24 - ties / 48)
    return _two_sided(_sets(tuple(sorted(ranks))), total)


def rank_sums(before, after):
    """p of Wilcoxon's rank sums (Mann and Whitney's U), and whether it is exact."""
    if len(before) > len(after):
        before, after = after, before
    n, m = len(before), len(after)
    ranks, ties = _doubled_ranks(numpy.concatenate([before, after]))
    total = int(ranks[:n].sum())
    if n * (n + m) > MOST_SUMS:
        return _approximate(total / 2, n * (n + m + 1) / 2, n * m / 12 * (n + m + 1 - ties / ((n + m) * (n + m - 1))))
    return _two_sided(_sets_of(n, tuple(sorted(ranks))), total)


def least_signed_rank_p(pairs):
    """What so many pairs can give at least."""
    return min(1.0, math.ldexp(2.0, -min(pairs, 1000)))


def least_rank_sum_p(before, after):
    small, large, p = min(before, after), max(before, after), 2.0
    for i in range(1, small + 1):
        p *= i / (large + i)
    return min(1.0, p)


def holm(p):
    """p-values corrected over all of them (Holm 1979)."""
    p = numpy.asarray(p, float)
    order = numpy.argsort(p, kind="stable")
    corrected = numpy.empty(len(p))
    corrected[order] = numpy.maximum.accumulate(numpy.minimum(1.0, p[order] * (len(p) - numpy.arange(len(p)))))
    return corrected
