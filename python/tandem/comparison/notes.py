# SPDX-License-Identifier: MIT
"""Sentences about a comparison: what a reader has to know of files and cells, the summary, and why nothing can be compared."""
import os

from ..text_lines import one_line
from .naming import label

MOST_LEFT_OUT, MOST_ONLY, MOST_TRIED, MOST_DIFFERENCES = 10, 5, 300, 4


def _names(before, after, matched):
    """Labels that tell all cells of both files apart, those without a counterpart and those left out included, by identity."""
    cells = [*(cell.before for cell in matched.cells), *matched.only_old, *matched.only_new, *before.left_out, *after.left_out]
    return {id(cell): one_line(text, 1000) for cell, text in zip(cells, label(cells)[0])}


def _change(what, before, after):
    if before is None or after is None or before == after:
        return []
    return [f"{before.count} {what} others" if before.count == after.count else f"{after.count} {what} for {before.count}"]


def _of_answers(matched, names):
    for cell in matched.cells:
        if cell.verdict == "another_answer":
            changes = _change("candidate pairs", cell.before.pairs, cell.after.pairs) + _change("contacts", cell.before.contacts, cell.after.contacts)
            yield f"another answer: {names[id(cell.before)]}: {', '.join(changes)}"


def _of_file(side):
    if side.torn:
        yield f"{side.path}: the last line has no end, being cut off or still written: it is ignored"
    if side.repeated:
        yield (f"{side.path}: {side.repeated} {'cell was' if side.repeated == 1 else 'cells were'} recorded more than once; "
               "the last record that is ok counts")


def _reason(cell):
    """Why a record takes no part."""
    if cell.status == "failed":
        return f"failed: {one_line(cell.failure, 160)}"
    return "its answer is not the reference's" if cell.status != "ok" else "it has no samples"


def _of_left_out(side, names):
    for cell in side.left_out[:MOST_LEFT_OUT]:
        yield f"{side.path}:{cell.line} takes no part: {names[id(cell)]}: {_reason(cell)}"
    if len(side.left_out) > MOST_LEFT_OUT:
        yield f"{side.path}: {len(side.left_out) - MOST_LEFT_OUT} more records take no part; --format json lists them"


def _of_only(which, cells, names):
    if cells:
        some = [names[id(cell)] for cell in cells[:MOST_ONLY]]
        if len(cells) > MOST_ONLY:
            some.append(f"and {len(cells) - MOST_ONLY} more")
        yield f"{len(cells)} {'cell is' if len(cells) == 1 else 'cells are'} in {which} only: {'; '.join(some)}"


def _of_machines(matched):
    """Keys of schema 2 do not say where a cell ran."""
    for name in ("model", "driver", "processor"):
        def values(side):
            cells = (getattr(cell, side) for cell in matched.cells)
            return sorted({(cell.processor or "unknown") if name == "processor" else cell.names[name] for cell in cells})
        old, new = values("before"), values("after")
        if old != new:
            yield f"other {name}s: old {' and '.join(old)}, new {' and '.join(new)}"


def _of_separate_runs(matched):
    """Only within a session do both sides share what the machine does."""
    apart = sum(not cell.paired for cell in matched.cells)
    if apart:
        yield (f"{apart} of {len(matched.cells)} cells were measured in separate runs: load, clocks and preparation of each run count "
               "as changes")


def _same_file(before, after):
    try:
        return os.path.samefile(before, after)
    except OSError:
        return False


def notes(before, after, matched):
    """Sentences: each other answer, each record that takes no part, and what else a reader has to know of the files."""
    names = _names(before, after, matched)
    found = list(_of_answers(matched, names))
    same_commit = before.commit == after.commit
    if same_commit and _same_file(before.path, after.path):
        found.append("old and new are the same records; FILE@COMMIT names those of one commit")
    found += _of_file(before)
    if before.path != after.path or not same_commit:
        found += _of_file(after)
    for side in (before, after):
        found += _of_left_out(side, names)
    found += _of_only("old", matched.only_old, names)
    found += _of_only("new", matched.only_new, names)
    return [*found, *_of_machines(matched), *_of_separate_runs(matched)]


def _thresholds(matched):
    """"3 %", or each with its kind of device where they are the defaults and both occur."""
    found = sorted({cell.threshold for cell in matched.cells})
    texts = [f"{100 * threshold:g} %" for threshold in (found[0], found[-1])]
    return texts[0] if len(found) == 1 else f"{texts[0]} (GPUs) or {texts[1]} (processors)"


def _too_few(matched):
    few = [cell for cell in matched.cells if cell.verdict == "too_few"]
    if not few:
        return ""
    return f"; {len(few)} {'has' if len(few) == 1 else 'have'} too few samples to tell: {max(cell.rounds_needed for cell in few)} rounds of each would do"


def _others(matched):
    """"; the others could have shown 0.8 to 2.1 %"."""
    others = [cell for cell in matched.cells if cell.verdict in ("not_shown", "within_threshold")]
    effects = [100 * cell.least_effect for cell in others if cell.least_effect is not None]
    if not effects:
        return ""
    decided = len(matched.cells) - len(others) - matched.count("too_few")
    low, high = f"{min(effects):.1f}", f"{max(effects):.1f}"
    return f"; {'the others' if decided else 'they'} could have shown {low}{'' if low == high else f' to {high}'} %"


def summary(matched, level):
    """One line: how many cells are slower and faster, beyond what, and what the others could have shown."""
    answers, within = matched.count("another_answer"), matched.count("within_threshold")
    text = (f"{matched.count('slower')} of {len(matched.cells)} {'cell' if len(matched.cells) == 1 else 'cells'} slower, "
            f"{matched.count('faster')} faster beyond {_thresholds(matched)} at level {level:g}")
    if answers:
        text += f"; {answers} with another answer"
    if within:
        text += f"; {within} changed within the threshold"
    return text + _too_few(matched) + _others(matched)


def _differences(before, after):
    """"X / Y" for each name, or else each setting, in which two cells differ; presets are no part of a key."""
    found = [f"{value} / {after.names[name]}" for name, value in before.names.items() if name != "preset" and value != after.names[name]]

    def text(cell, name):
        return f"{name}={cell.settings[name]}" if name in cell.settings else f"no {name}"
    for name in sorted(before.settings.keys() | after.settings.keys()):
        if text(before, name) != text(after, name):
            found.append(f"{text(before, name)} / {text(after, name)}")
    return found


def nothing_common(before, after):
    """Why no cell is in both of two RecordedCells: the nearest two cells, and in what they differ; of many only some are tried."""
    for side in (before, after):
        if not side.cells:
            name = f"{side.path}@{side.commit}" if side.commit else side.path
            return f"{name}: none of {side.records} records is ok and has samples; record its cells again"
    what = f"{before.path} and {after.path} have no cell in common ({len(before.cells)} and {len(after.cells)} cells"
    schemas = before.cells[0].schema, after.cells[0].schema
    if schemas[0] != schemas[1]:
        return f"{what}), being of schemas {schemas[0]} and {schemas[1]}; record both with one program's schema"
    least = min((_differences(old, new) for old in before.cells[:MOST_TRIED] for new in after.cells[:MOST_TRIED]), key=len)
    if len(least) > MOST_DIFFERENCES:
        least = [*least[:MOST_DIFFERENCES], f"{len(least) - MOST_DIFFERENCES} more"]
    return f"{what}; the nearest differ in {', '.join(least)}); record the same cells"
