# SPDX-License-Identifier: MIT
"""The verdict of a measured value by a declared rule."""

import dataclasses
import math

AGREES, DIFFERS, NOT_SETTLED, UNTESTED = "agrees", "differs", "not settled", "untested"
BY_CONSTRUCTION = "by construction"  # our inputs or code keep the rule, whatever is measured
ERRATUM = "erratum"  # the paper contradicts itself; counted with no other verdict
VERDICTS = (AGREES, DIFFERS, NOT_SETTLED, UNTESTED, BY_CONSTRUCTION)


@dataclasses.dataclass(frozen=True)
class Measured:
    """A value of the records with its 95 % interval. samples: independent samples that the interval comes
    from; 0 for a count, which is exact. disturbed: samples left out because the machine was disturbed. basis:
    what the samples are. frames: how many frames it covers."""

    value: float
    low: float
    high: float
    samples: int = 0
    disturbed: int = 0
    basis: str = "count"
    frames: str = ""
    records: tuple = ()

    @property
    def is_exact(self):
        return self.samples == 0 and self.basis == "count"


def exact(value, records=(), frames=""):
    return Measured(value, value, value, records=tuple(records), frames=frames)


def _limit(value, paper, least):
    """A limit of a rule as a number; "paper" is the least or the largest of the paper's numbers."""
    if value != "paper":
        return float(value)
    if not paper:
        return None
    return min(paper) if least else max(paper)


def limits(rule, paper=()):
    """(least, most) that a rule allows; None if it needs the paper's numbers and there are none."""
    if "between" in rule:
        ends = rule["between"] if rule["between"] != "paper" else ["paper", "paper"]
        least, most = _limit(ends[0], paper, True), _limit(ends[1], paper, False)
        if least is None:
            return None
        widened = rule.get("widened", 1)
        return least / widened, most * widened
    if "at_least" in rule:
        least = _limit(rule["at_least"], paper, True)
        return None if least is None else (least, math.inf)
    most = _limit(rule["at_most"], paper, False)
    return None if most is None else (-math.inf, most)


def judged(measured, rule, paper=()):
    """(verdict, reason) of a value. `proves` of a rule: why a value that keeps it proves nothing, such as a
    mean within limits of each single value."""
    allowed = limits(rule, paper)
    if allowed is None:
        return UNTESTED, "the paper has no number for this scene"
    if not measured.is_exact and measured.samples < 2:
        return NOT_SETTLED, "disturbed samples only" if measured.disturbed else "one sample"
    least, most = allowed
    factor, varies = rule.get("borderline", 1), rule.get("varies", 1)
    low, high = measured.low / varies, measured.high * varies
    if least <= low and high <= most:
        return (NOT_SETTLED, rule["proves"]) if "proves" in rule else (AGREES, "")
    if high < least / factor or low > most * factor:
        return DIFFERS, ""
    if high < least or low > most:
        return NOT_SETTLED, "borderline"
    if least <= measured.low and measured.high <= most or measured.high < least or measured.low > most:
        return NOT_SETTLED, f"sessions differ by up to {varies} times"
    return NOT_SETTLED, "the interval contains a limit of the rule"


def together(verdicts, how):
    """The verdict of a claim from those of its scenes. how: "all" scenes have to agree, as far as they are
    tested, or "any" of them."""
    counted = [verdict for verdict in verdicts if verdict != UNTESTED]
    if not counted or (how == "any" and AGREES not in counted and len(counted) < len(verdicts)):
        return UNTESTED
    first, last = (AGREES, DIFFERS) if how == "any" else (DIFFERS, AGREES)
    for verdict in (first, ERRATUM, NOT_SETTLED, BY_CONSTRUCTION):
        if verdict in counted:
            return verdict
    return last
