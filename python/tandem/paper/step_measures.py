# SPDX-License-Identifier: MIT
"""The measures of simulations that claims declare: counts and times over steps. Neighbouring steps depend on
each other, so that intervals draw blocks of them (resampling.Part)."""

import numpy
import scipy.stats

from .. import resampling
from .measures import MIN_RANGE
from .quantities import NotMeasured
from .rules import Measured, exact

LEAST_STEPS = 10  # steps with contacts and times that give a rank correlation


def _on_device(claim, folder, scene):
    """The simulation of a claim about times of the device."""
    run = claim.simulation(folder, scene)
    if run.run["devices"][0]["id"] == "host":
        raise NotMeasured("simulated on a processor, and its steps were not measured on a device")
    return run


def _curve(run, name):
    """A number for each step: of a field, or the seconds of "stage:A+B"."""
    kind, _, stages = name.partition(":")
    return (
        numpy.sum([run.curve(f"stage:{stage}") for stage in stages.split("+")], axis=0)
        if stages
        else numpy.array(run.curve(kind), float)
    )


def _of_steps(run, statistic, *curves):
    part = resampling.part(*curves, in_order=True)
    *found, samples = resampling.of_parts(statistic, [part])
    basis = f"blocks of {part.block} neighbouring steps"
    known = 0 if run.is_disturbed else samples
    return Measured(*found, known, run.left_out, basis, f"{len(run.steps)} steps", (run.location,))


def _rank_correlation(rows):
    """Spearman's, of two rows whose last axis are steps."""
    ranks = scipy.stats.rankdata(rows, axis=-1)
    x, y = ranks - ranks.mean(axis=-1, keepdims=True)
    return (x * y).sum(axis=-1) / numpy.sqrt((x**2).sum(axis=-1) * (y**2).sum(axis=-1))


def correlation(claim, folder, scene, k):
    """Spearman's rank correlation over steps."""
    run = _on_device(claim, folder, scene)
    x, y = (_curve(run, name) for name in claim.fields["quantity"])
    good = (x > 0) & (y > 0)
    if good.sum() < LEAST_STEPS:
        raise NotMeasured(
            f"{good.sum()} steps with contacts were measured, of the {LEAST_STEPS} that a rank correlation needs"
        )
    if numpy.quantile(x[good], 0.95) < MIN_RANGE * numpy.quantile(x[good], 0.05):
        raise NotMeasured("contacts change less than fourfold")
    return _of_steps(run, _rank_correlation, x, y)


def deciles(claim, folder, scene, k):
    """Ninth over first decile of a time over steps."""
    run = _on_device(claim, folder, scene)
    of = lambda rows: numpy.quantile(rows[0], 0.9, axis=-1) / numpy.quantile(rows[0], 0.1, axis=-1)
    return _of_steps(run, of, _curve(run, claim.fields["quantity"]))


def _of_counts(of):
    def measure(claim, folder, scene, k):
        run = claim.simulation(folder, scene)
        counts = _curve(run, claim.fields["quantity"])
        return exact(float(of(counts)), (run.location,), f"{len(run.steps)} steps")

    return measure


def ratio_of_simulations(claim, folder, scene, k):
    """A sum over steps of one simulation, over the same sum of another, whose scene is `over`."""
    first, last = claim.fields["steps"]
    runs, sums = [claim.simulation(folder, own) for own in (scene, claim.fields["over"])], []
    for run in runs:
        counts = [step[claim.fields["quantity"]] for step in run.steps if first <= step["step"] <= last]
        if len(counts) != last - first + 1:
            raise NotMeasured(f"not all of the steps {first} to {last} were simulated")
        sums.append(sum(counts))
    if not sums[1]:
        raise NotMeasured("a count to divide by is 0")
    return exact(sums[0] / sums[1], [run.location for run in runs], f"steps {first}:{last}")


def scene_of_simulation(claim, folder, scene, k):
    """A number of the scene that was simulated: bodies, vertices or tetrahedra."""
    run = claim.simulation(folder, scene)
    return exact(run.run["scene"][claim.fields["quantity"]], (run.location,))


MEASURES = {
    "correlation": correlation,
    "deciles": deciles,
    "mean_of_steps": _of_counts(numpy.mean),
    "median_of_steps": _of_counts(numpy.median),
    "sum_of_steps": _of_counts(numpy.sum),
    "ratio_of_simulations": ratio_of_simulations,
    "scene_of_simulation": scene_of_simulation,
}
