# SPDX-License-Identifier: MIT
"""Pools the records that several sessions made of one cell. Rounds of a session share the process, its memory and the state of the machine,
so that they differ less than sessions do: a test over all rounds would find changes where there are none. The unit is then the session."""
import dataclasses
import statistics


def _program(cell):
    return cell.commit, cell.dirty, cell.sources


def counting(cells):
    """Those of the RecordedCells of one key, in the order of their lines, that count: the sessions of the program that wrote the last one.
    The last record of a session counts, because it continues the ones before. Records without a session count as one session."""
    found = {}
    for cell in cells:
        if _program(cell) == _program(cells[-1]):
            found.pop(cell.session, None)
            found[cell.session] = cell
    return list(found.values())


def _time(cell):
    """The median of a session's undisturbed rounds; of all if all are disturbed."""
    clean = [ns for number, ns in cell.rounds.items() if number not in cell.disturbed]
    return statistics.median(clean or cell.times())


def pooled(cells):
    """One RecordedCell whose `rounds` are these sessions. A session is disturbed if all its rounds are."""
    whole = [cell for cell in cells if len(cell.disturbed) == len(cell.rounds)]
    return dataclasses.replace(
        cells[-1], rounds={cell.session: _time(cell) for cell in cells}, disturbed=frozenset(cell.session for cell in whole),
        reason=next((cell.reason for cell in cells if cell.reason), ""), sessions=len(cells), samples=sum(cell.samples for cell in cells),
        all_rounds=sum(cell.all_rounds for cell in cells), disturbed_rounds=sum(cell.disturbed_rounds for cell in cells))
