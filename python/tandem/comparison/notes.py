# SPDX-License-Identifier: MIT
"""Sentences about a comparison: notes on files and cells, the summary, and the reason if nothing can be
compared."""

import os

from ..text_lines import one_line
from .naming import label

MAX_LEFT_OUT, MAX_ONLY, MAX_TRIED, MAX_DIFFERENCES = 10, 5, 300, 4


def _names(before, after, matched):
    """Distinct labels of all cells of both files by identity, including cells without a counterpart and cells
    left out."""
    cells = [
        *(cell.before for cell in matched.cells),
        *matched.only_old,
        *matched.only_new,
        *before.left_out,
        *after.left_out,
    ]
    return {id(cell): one_line(text, 1000) for cell, text in zip(cells, label(cells)[0])}


def _change(what, before, after):
    if before is None or after is None or before == after:
        return []
    return [
        f"{before.count} {what}, but different ones"
        if before.count == after.count
        else f"{after.count} {what} instead of {before.count}"
    ]


def _answer_notes(matched, names):
    for cell in matched.cells:
        if cell.verdict == "another_answer":
            changes = _change("candidate pairs", cell.before.pairs, cell.after.pairs) + _change(
                "contacts", cell.before.contacts, cell.after.contacts
            )
            yield f"another answer: {names[id(cell.before)]}: {', '.join(changes)}"


def _file_notes(side):
    if side.torn:
        yield f"{side.path}: the last line has no end and is ignored; it is cut off or still being written"
    if side.repeated:
        yield (
            f"{side.path}: {side.repeated} {'cell was' if side.repeated == 1 else 'cells were'} recorded more than once; "
            "the last record that is ok counts, with those of other sessions of its program"
        )


def _reason(cell):
    """Why a record is left out."""
    if cell.status == "failed":
        return f"failed: {one_line(cell.failure, 160)}"
    return "its answer is not the reference's" if cell.status != "ok" else "it has no samples"


def _left_out_notes(side, names):
    for cell in side.left_out[:MAX_LEFT_OUT]:
        yield f"{side.path}:{cell.line} is left out: {names[id(cell)]}: {_reason(cell)}"
    if len(side.left_out) > MAX_LEFT_OUT:
        yield f"{side.path}: {len(side.left_out) - MAX_LEFT_OUT} more records are left out; --format json lists them"


def _only_notes(which, cells, names):
    if cells:
        some = [names[id(cell)] for cell in cells[:MAX_ONLY]]
        if len(cells) > MAX_ONLY:
            some.append(f"and {len(cells) - MAX_ONLY} more")
        yield f"{len(cells)} {'cell is' if len(cells) == 1 else 'cells are'} in {which} only: {'; '.join(some)}"


def _machine_notes(matched):
    """Differences of machines: keys of schema 2 do not contain them."""
    for name in ("model", "driver", "processor"):

        def values(side):
            cells = (getattr(cell, side) for cell in matched.cells)
            return sorted(
                {(cell.processor or "unknown") if name == "processor" else cell.names[name] for cell in cells}
            )

        old, new = values("before"), values("after")
        if old != new:
            yield f"other {name}s: old {' and '.join(old)}, new {' and '.join(new)}"


def _separate_run_notes(matched):
    """Only within a session are both sides measured under the same load of the machine."""
    separate = sum(not cell.paired and not cell.before.sessions for cell in matched.cells)
    if separate:
        yield (
            f"{separate} of {len(matched.cells)} cells were measured in separate runs: load, clocks and preparation of each run count "
            "as changes"
        )


def _range(numbers):
    """ "10", or "8 to 10"."""
    low, high = min(numbers), max(numbers)
    return f"{low}" if low == high else f"{low} to {high}"


def _session_notes(matched):
    """A cell of several sessions is compared by them."""
    pooled = [cell for cell in matched.cells if cell.before.sessions]
    if pooled:
        counts = " and ".join(
            f"{_range([getattr(cell, side).sessions for cell in pooled])} of {name}"
            for side, name in (("before", "old"), ("after", "new"))
        )
        yield f"{len(pooled)} {'cell is' if len(pooled) == 1 else 'cells are'} compared by sessions: {counts}"


def _interval_notes(matched):
    """Why an interval is missing."""
    without = sum(cell.ratio is not None and cell.ratio.low is None for cell in matched.cells)
    if without:
        yield f"{without} of {len(matched.cells)} cells {'has' if without == 1 else 'have'} no interval (-): so few rounds exclude no ratio with 95 % confidence"


def _disturbed_notes(matched):
    """How many rounds other work disturbed, and what follows."""
    for name, side in (("old", "before"), ("new", "after")):
        cells = [getattr(cell, side) for cell in matched.cells]
        count, rounds = sum(cell.disturbed_rounds for cell in cells), sum(cell.all_rounds for cell in cells)
        if count:
            reason = next(cell.reason for cell in cells if cell.disturbed_rounds)
            yield f"{name}: {count} of {rounds} rounds are disturbed ({one_line(reason, 160)}); they are left out where they are fewer than the others"


def _same_file(before, after):
    try:
        return os.path.samefile(before, after)
    except OSError:
        return False


def notes(before, after, matched):
    """Sentences on different answers, records left out, and further facts about the files."""
    names = _names(before, after, matched)
    found = list(_answer_notes(matched, names))
    same_commit = before.commit == after.commit
    if same_commit and _same_file(before.path, after.path):
        found.append(
            "old and new are the same program"
            if before.is_program
            else "old and new are the same records; FILE@COMMIT names those of one commit"
        )
    found += _file_notes(before)
    if before.path != after.path or not same_commit:
        found += _file_notes(after)
    for side in (before, after):
        found += _left_out_notes(side, names)
    found += _only_notes("old", matched.only_old, names)
    found += _only_notes("new", matched.only_new, names)
    return [
        *found,
        *_machine_notes(matched),
        *_session_notes(matched),
        *_separate_run_notes(matched),
        *_interval_notes(matched),
        *_disturbed_notes(matched),
    ]


def _thresholds(matched):
    """ "3 %", or both default thresholds with their kinds of device."""
    found = sorted({cell.threshold for cell in matched.cells})
    texts = [f"{100 * threshold:g} %" for threshold in (found[0], found[-1])]
    return texts[0] if len(found) == 1 else f"{texts[0]} (GPUs) or {texts[1]} (processors)"


def _too_few(matched):
    few = [cell for cell in matched.cells if cell.verdict == "too_few"]
    if not few:
        return ""
    unit = "sessions" if any(cell.before.sessions for cell in few) else "rounds"
    return (
        f"; {len(few)} {'has' if len(few) == 1 else 'have'} too few samples to tell: {max(cell.rounds_needed for cell in few)} {unit} "
        "on each side are enough"
    )


def _detectable(matched):
    """ "; detectable in the others: 0.8 to 2.1 %"."""
    undecided = [cell for cell in matched.cells if cell.verdict in ("not_shown", "within_threshold")]
    effects = [100 * cell.least_effect for cell in undecided if cell.least_effect is not None]
    if not effects:
        return ""
    decided = len(matched.cells) - len(undecided) - matched.count("too_few")
    low, high = f"{min(effects):.1f}", f"{max(effects):.1f}"
    return f"; detectable{' in the others' if decided else ''}: {low}{'' if low == high else f' to {high}'} %"


def summary(matched, level):
    """One line: numbers of slower and faster cells, the threshold, and the changes that are detectable in the
    other cells."""
    answers, within, disturbed = (
        matched.count(verdict) for verdict in ("another_answer", "within_threshold", "disturbed")
    )
    text = (
        f"{matched.count('slower')} of {len(matched.cells)} {'cell' if len(matched.cells) == 1 else 'cells'} slower, "
        f"{matched.count('faster')} faster beyond {_thresholds(matched)} at level {level:g}"
    )
    if answers:
        text += f"; {answers} with another answer"
    if within:
        text += f"; {within} changed within the threshold"
    if disturbed:
        text += f"; {disturbed} changed in disturbed rounds only"
    return text + _too_few(matched) + _detectable(matched)


def _device_differences(before, after):
    """ "X / Y" for the parts in which the devices of two keys differ, such as "host:CPU x1 / host:CPU x2":
    keys have the number of cores, which no name has. Nothing if names show the difference, and for keys of
    old schemas, which have no devices."""
    if (
        any(before.names[name] != after.names[name] for name in ("devices", "model", "driver"))
        or not before.key.count("|") == after.key.count("|") >= 4
    ):
        return []
    pairs = zip(*(cell.key.split("|")[1].split(", ") for cell in (before, after)))
    return [f"{old} / {new}" for old, new in pairs if old != new]


def _differences(before, after):
    """ "X / Y" for each name, each setting and each part of the devices in which two cells differ. Presets are
    left out, because keys do not contain them."""
    found = [
        f"{value} / {after.names[name]}"
        for name, value in before.names.items()
        if name != "preset" and value != after.names[name]
    ]
    found += _device_differences(before, after)

    def text(cell, name):
        return f"{name}={cell.described[name]}" if name in cell.described else f"no {name}"

    for name in sorted(before.described.keys() | after.described.keys()):
        if text(before, name) != text(after, name):
            found.append(f"{text(before, name)} / {text(after, name)}")
    return found


def nothing_common(before, after):
    """The reason why two RecordedCells have no cell in common: the differences of the two most similar cells.
    Tries at most MAX_TRIED cells of each."""
    for side in (before, after):
        if not side.cells:
            name = f"{side.path}@{side.commit}" if side.commit else side.path
            return f"{name}: none of {side.records} records is ok and has samples; record its cells again"
    what = f"{before.path} and {after.path} have no cell in common ({len(before.cells)} and {len(after.cells)} cells"
    schemas = before.cells[0].schema, after.cells[0].schema
    if schemas[0] != schemas[1]:
        return f"{what}), because they have schemas {schemas[0]} and {schemas[1]}; record both with one version of the program"
    least = min(
        (_differences(old, new) for old in before.cells[:MAX_TRIED] for new in after.cells[:MAX_TRIED]),
        key=len,
    )
    if len(least) > MAX_DIFFERENCES:
        least = [*least[:MAX_DIFFERENCES], f"{len(least) - MAX_DIFFERENCES} more"]
    return f"{what}; the nearest differ in {', '.join(least)}); record the same cells"
