# SPDX-License-Identifier: MIT
"""Ratios of medians, and statistics of several parts, with 95 % bootstrap intervals: expanded percentiles
(Hesterberg 2015, 4.3), because plain ones of few values are too narrow. The seed is fixed, so that equal
records have equal intervals."""

import dataclasses
import functools
import math

import numpy
import scipy.stats

from .ratio import Ratio

SEED, RESAMPLES = 20180606, 1000


@functools.cache
def _tail(values):
    """The fraction of resamples on each side of an interval of this number of values."""
    width = math.sqrt(values / (values - 1)) * scipy.stats.t.ppf(0.975, values - 1)
    return scipy.stats.norm.sf(width)


def _resampled(statistic, samples):
    """The ends of the interval of a statistic, as scipy.stats.bootstrap takes it, and its standard error.
    Infinite values of resamples are left out."""
    size = min(map(len, samples))
    if size < 2:
        value = float(statistic(*samples, axis=-1))
        return value, value, 0.0
    with numpy.errstate(divide="ignore", invalid="ignore"):
        made = scipy.stats.bootstrap(
            samples,
            statistic,
            vectorized=True,
            n_resamples=RESAMPLES,
            method="percentile",
            random_state=numpy.random.default_rng(SEED),
        ).bootstrap_distribution
    made, tail = made[numpy.isfinite(made)], _tail(size)
    return *map(float, numpy.quantile(made, [tail, 1 - tail])), float(numpy.std(made, ddof=1)) if numpy.ptp(
        made
    ) else 0.0


def _ratio(statistic, samples):
    """The Ratio of a statistic of logarithms."""
    low, high, error = _resampled(statistic, samples)
    return Ratio(math.exp(statistic(*samples, axis=-1)), math.exp(low), math.exp(high), error)


def paired_ratio(before, after):
    """The median of the ratios of paired values."""
    return _ratio(numpy.median, [numpy.log(numpy.asarray(after, float) / numpy.asarray(before, float))])


def unpaired_ratio(before, after):
    """The ratio of the medians of unpaired values."""
    of = lambda old, new, axis: numpy.log(numpy.median(new, axis=axis) / numpy.median(old, axis=axis))
    return _ratio(of, [numpy.asarray(before, float), numpy.asarray(after, float)])


def block_length(values):
    """The length of blocks of neighbouring samples, for moving blocks. values: one row or several of one
    length.

    Samples one block apart shall hardly depend on each other: the length is the first lag at which no row has
    an autocorrelation beyond its 95 % limit for white noise. It is at least the cube root of the number of
    samples, the order that is best for the variance (Hall, Horowitz and Jing 1995, Biometrika 82), and at
    most a quarter of it, so that four blocks are left."""
    rows = numpy.atleast_2d(numpy.asarray(values, float))
    count, length = rows.shape[-1], 1
    rows = rows - rows.mean(axis=-1, keepdims=True)
    variance = (rows**2).sum(axis=-1)
    rows = rows[variance > 0] / numpy.sqrt(variance[variance > 0])[:, None]
    while len(rows) and length < count // 4:
        if (rows[:, length:] * rows[:, :-length]).sum(axis=-1).max() < 1.96 / math.sqrt(count):
            break
        length += 1
    return max(1, min(max(length, math.ceil(count ** (1 / 3))), count // 4))


@dataclasses.dataclass(frozen=True)
class Part:
    """Samples that are drawn together. values: an array whose last axis are the samples, in their order.
    block: how many neighbouring ones are drawn at once; 1 for independent samples."""

    values: numpy.ndarray
    block: int = 1

    @property
    def independent(self):
        """The number of independent samples that it stands for."""
        return self.values.shape[-1] // self.block

    def drawn(self, generator):
        """Resamples by moving blocks (Künsch 1989, Annals of Statistics 17): an axis of resamples before the
        last."""
        count = self.values.shape[-1]
        starts = generator.integers(0, count - self.block + 1, (RESAMPLES, -(-count // self.block), 1))
        places = (starts + numpy.arange(self.block)).reshape(RESAMPLES, -1)[:, :count]
        return self.values[..., places]


def part(*rows, in_order=False):
    """A Part of rows of one length. in_order: neighbouring samples, such as steps of a simulation, depend on
    each other."""
    values = numpy.asarray(rows, float)
    return Part(values, block_length(values) if in_order else 1)


def of_parts(statistic, parts):
    """A statistic of independent parts, its 95 % interval, in which every part is drawn anew, and the least
    number of independent samples of a part. statistic: takes the values of each part, whose last axis are
    samples."""
    value = float(statistic(*(own.values for own in parts)))
    size = min(own.independent for own in parts)
    if size < 2:
        return value, value, value, size
    generator = numpy.random.default_rng(SEED)
    with numpy.errstate(divide="ignore", invalid="ignore"):
        made = statistic(*(own.drawn(generator) for own in parts))
    made, tail = made[numpy.isfinite(made)], _tail(size)
    return value, *map(float, numpy.quantile(made, [tail, 1 - tail])), size


def ratio_of_sums(before, after):
    """The sum of `after` over that of `before`, which is not 0, its 95 % interval, and the number of
    independent samples. The values are pairs, of which neighbouring ones may depend on each other."""
    return of_parts(
        lambda rows: numpy.sum(rows[1], axis=-1) / numpy.sum(rows[0], axis=-1),
        [part(before, after, in_order=True)],
    )


def median_interval(values):
    """The 95 % interval of the median of values."""
    return _resampled(numpy.median, [numpy.asarray(values, float)])[:2]
