# SPDX-License-Identifier: MIT
"""Pools the records that several sessions made of one cell. Rounds of a session share the process, its memory
and the state of the machine, so that they differ less than sessions do: a test over all rounds would find
changes where there are none. The unit is then the session."""

import copy
import statistics


def counting(cells):
    """Those of the Cells of one key, in the order of their lines, that count: the sessions of the
    program that wrote the last one. The last record of a session counts, because it continues the ones
    before. Records without a session count as one session. The record of an interrupted cell counts only if
    it is the last one: a later session has continued the cell, or measured it again."""
    found = {}
    for cell in cells:
        if cell.program == cells[-1].program and (not cell.is_partial or cell is cells[-1]):
            found.pop(cell.session, None)
            found[cell.session] = cell
    return list(found.values())


def is_minority(disturbed, rounds):
    """Whether so many disturbed rounds of all rounds can be left out. Other work that disturbs half of them
    also meets others: the condition of short rounds is known only roughly."""
    return 2 * disturbed < rounds


def _time(cell):
    """The median of a session's undisturbed rounds; of all if half of them are disturbed."""
    left_out = cell.disturbed if is_minority(len(cell.disturbed), len(cell.rounds)) else ()
    return statistics.median(ns for number, ns in cell.rounds.items() if number not in left_out)


def pooled(cells):
    """One Cell whose `rounds` are these sessions. A session is disturbed if at least half of its
    rounds are."""
    bad = [cell for cell in cells if not is_minority(len(cell.disturbed), len(cell.rounds))]
    made = copy.copy(cells[-1])
    made.rounds = {cell.session: _time(cell) for cell in cells}
    made.disturbed = frozenset(cell.session for cell in bad)
    made.reason = next((cell.reason for cell in cells if cell.reason), "")
    made.sessions = len(cells)
    for name in ("samples", "all_rounds", "disturbed_rounds"):
        setattr(made, name, sum(getattr(cell, name) for cell in cells))
    return made
