# SPDX-License-Identifier: MIT
"""Ratios of medians with bootstrap intervals. They are reproducible to the bit: the seed is fixed, and the
generator is specified to the bit (mt19937_64: Nishimura 2000, ACM TOMACS 10(4); the C++ standard has its
constants)."""

import dataclasses
import functools
import math

import numpy

SEED, RESAMPLES = 20180606, 1000
_WORDS, _MIDDLE = 312, 156
_UPPER, _LOWER = numpy.uint64(0xFFFFFFFF80000000), numpy.uint64(0x7FFFFFFF)
_TWIST = numpy.uint64(0xB5026F5AA96619E9)


_words = numpy.empty(0, dtype=numpy.uint64)  # first words of the generator with SEED; extended on demand


def random_words(count):
    """The first `count` words of the generator."""
    global _words
    if len(_words) < count:
        _words = _generated(max(count, 2 * len(_words)))
    return _words[:count]


def _generated(count):
    state = [SEED]
    for i in range(1, _WORDS):
        state.append((6364136223846793005 * (state[-1] ^ (state[-1] >> 62)) + i) % 2**64)
    state = numpy.array(state, dtype=numpy.uint64)
    one, words = numpy.uint64(1), []
    for _ in range(-(-count // _WORDS)):
        # In two halves: each word uses the word half a block later, which belongs to the new block for the
        # second half.
        for first, last in ((0, _MIDDLE), (_MIDDLE, _WORDS)):
            at = numpy.arange(first, last)
            both = (state[at] & _UPPER) | (state[(at + 1) % _WORDS] & _LOWER)
            state[at] = (
                state[(at + _MIDDLE) % _WORDS]
                ^ (both >> one)
                ^ numpy.where(both & one, _TWIST, numpy.uint64(0))
            )
        word = state ^ ((state >> numpy.uint64(29)) & numpy.uint64(0x5555555555555555))
        word ^= (word << numpy.uint64(17)) & numpy.uint64(0x71D67FFFEDA60000)
        word ^= (word << numpy.uint64(37)) & numpy.uint64(0xFFF7EEE000000000)
        words.append(word ^ (word >> numpy.uint64(43)))
    return numpy.concatenate(words)


@functools.lru_cache(maxsize=64)
def _drawn(*sizes):
    """For each of several lists of values with these sizes: the indices of the values that each resample
    draws."""
    words = random_words(RESAMPLES * sum(sizes)).reshape(RESAMPLES, -1)
    ends = numpy.cumsum(sizes)
    return [(words[:, end - size : end] % numpy.uint64(size)).astype(int) for size, end in zip(sizes, ends)]


def _medians(values, drawn):
    """The median of each resample. Partitions ranks, which are small integers: numpy.median of the values
    takes three times as long."""
    order = numpy.argsort(values)
    ranks = numpy.empty(len(values), dtype=numpy.uint16 if len(values) < 2**16 else numpy.uint32)
    ranks[order] = numpy.arange(len(values))
    middle = (len(values) - 1) // 2, len(values) // 2
    rows = numpy.partition(ranks[drawn], middle, axis=1)
    ascending = values[order]
    return (ascending[rows[:, middle[0]]] + ascending[rows[:, middle[1]]]) / 2


def _within(angle, freedom):
    """The probability that a variable of Student's distribution lies within tan(angle) sqrt(freedom) of 0
    (Abramowitz and Stegun 1964, 26.7.3 and 26.7.4)."""
    cosine, odd = math.cos(angle), freedom % 2 == 1
    term = cosine if odd else 1.0
    total = 0.0 if freedom == 1 else term
    for n in range(3 if odd else 2, freedom, 2):
        term *= cosine * cosine * (n - 1) / n
        total += term
    return 2 * (1 / math.pi) * (angle + math.sin(angle) * total) if odd else math.sin(angle) * total


def student_quantile(freedom, probability=0.95):
    """t so that a variable of Student's distribution lies between -t and t with this probability."""
    low, high = 0.0, math.pi / 2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if _within(middle, freedom) < probability else (low, middle)
    return math.tan(low) * math.sqrt(freedom)


@functools.cache
def interval_tail(values):
    """The fraction of resamples on each side of a 95 % interval of this number of values: expanded
    percentiles (Hesterberg 2015, 4.3)."""
    if values < 2:
        return 0.0
    width = math.sqrt(values / (values - 1)) * student_quantile(values - 1)
    return math.erfc(width / math.sqrt(2)) / 2


def _quantile(ordered, fraction):
    """A quantile, linear between order statistics (Hyndman and Fan 1996, definition 7). numpy.quantile rounds
    differently."""
    at = fraction * (len(ordered) - 1)
    below = math.floor(at)
    above = min(below + 1, len(ordered) - 1)
    return float(ordered[below] + (at - below) * (ordered[above] - ordered[below]))


@dataclasses.dataclass(frozen=True)
class Ratio:
    """A ratio new / old, its 95 % interval, and the standard error of its logarithm. The last three are None
    where no such interval exists."""

    value: float
    low: float | None
    high: float | None
    log_error: float | None


def _ratio(log_ratio, values, logs):
    tail = interval_tail(values)
    logs = numpy.sort(logs)
    low, high = _quantile(logs, tail), _quantile(logs, 1 - tail)
    error = 0.0 if logs.min() == logs.max() else float(numpy.std(logs, ddof=1))
    return Ratio(math.exp(log_ratio), math.exp(low), math.exp(high), error)


def paired_ratio(before, after):
    """The median of the ratios of paired values."""
    logs = numpy.log(numpy.asarray(after, float) / numpy.asarray(before, float))
    return _ratio(float(numpy.median(logs)), len(logs), _medians(logs, *_drawn(len(logs))))


def unpaired_ratio(before, after):
    """The ratio of the medians of unpaired values."""
    before, after = numpy.asarray(before, float), numpy.asarray(after, float)
    old, new = _drawn(len(before), len(after))
    logs = numpy.log(_medians(after, new)) - numpy.log(_medians(before, old))
    return _ratio(
        math.log(numpy.median(after)) - math.log(numpy.median(before)), min(len(before), len(after)), logs
    )


def bootstrap_interval(count, statistic):
    """The 95 % interval of a statistic of `count` independent values. statistic: from RESAMPLES rows of drawn
    indices to one value for each row, of which infinite ones are left out."""
    with numpy.errstate(divide="ignore", invalid="ignore"):
        found = statistic(_drawn(count)[0])
    found, tail = numpy.sort(found[numpy.isfinite(found)]), interval_tail(count)
    return _quantile(found, tail), _quantile(found, 1 - tail)


def ratio_of_sums(before, after):
    """The sum of `after` over that of `before`, which is not 0, and its 95 % interval. The values are pairs."""
    before, after = numpy.asarray(before, float), numpy.asarray(after, float)
    return float(after.sum() / before.sum()), *bootstrap_interval(
        len(before), lambda rows: after[rows].sum(1) / before[rows].sum(1)
    )


def median_interval(values):
    """The 95 % interval of the median of values, computed as the program computes the intervals of its
    records."""
    values = numpy.sort(numpy.asarray(values, float))
    if values[0] == values[-1]:  # every resample has the same median
        return float(values[0]), float(values[-1])
    medians = numpy.sort(_medians(values, *_drawn(len(values))))
    tail = interval_tail(len(values))
    return _quantile(medians, tail), _quantile(medians, 1 - tail)
