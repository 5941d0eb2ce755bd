# SPDX-License-Identifier: MIT
"""Ratios of medians with 95 % bootstrap intervals by scipy: expanded percentiles (Hesterberg 2015, 4.3), because
plain ones of few values are too narrow. The seed is fixed, so that equal records have equal intervals."""

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


def _resampled(statistic, samples, paired=False):
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
            paired=paired,
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


def bootstrap_interval(statistic, *samples):
    """The 95 % interval of a statistic of samples, which takes an axis. The values of several samples are
    pairs."""
    return _resampled(statistic, [numpy.asarray(one, float) for one in samples], len(samples) > 1)[:2]


def ratio_of_sums(before, after):
    """The sum of `after` over that of `before`, which is not 0, and its 95 % interval. The values are pairs."""
    of = lambda old, new, axis: numpy.sum(new, axis=axis) / numpy.sum(old, axis=axis)
    return sum(after) / sum(before), *bootstrap_interval(of, before, after)


def median_interval(values):
    """The 95 % interval of the median of values."""
    return bootstrap_interval(numpy.median, values)
