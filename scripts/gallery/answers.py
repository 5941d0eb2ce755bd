# SPDX-License-Identifier: MIT
"""Which answers of records are right: digests of equal work are equal on every machine."""

from tandem.cell import BOUNDS

# Settings that determine the pairs with output=contacts, besides BOUNDS.
NARROW_PHASE = ("contact_rule", "decision")


def work_of(source):
    """A value that is equal for records whose candidate pairs have to be equal."""
    cell = source.cell
    settings = cell.described
    narrow = [settings.get(name) for name in NARROW_PHASE] if settings.get("output") == "contacts" else []
    return (
        cell.scene_digest,
        cell.first_frame,
        cell.last_frame,
        cell.names["handling"],
        *(settings.get(name, usual) for name, usual in BOUNDS.items()),
        settings.get("broad") == "sphere_boxes",
        *narrow,
    )  # such boxes leave out candidates that do not meet


def _known(sources):
    """The digest by work, of committed records that were compared with the reference, otherwise of submitted
    ones that all agree."""
    found = {}
    for is_submitted in (False, True):
        digests = {}
        for source in sources:
            cell = source.cell
            if (
                source.is_submitted == is_submitted
                and cell.status == "ok"
                and cell.record["agreement"]
                and cell.pairs
                and cell.pairs.count
            ):
                digests.setdefault(work_of(source), set()).add(cell.pairs)
        for work, own in digests.items():
            found.setdefault(work, own)
    return found


def judge(sources):
    """Sets the status of records with another digest than the known one to wrong. Returns places of records
    that nothing checks: neither their own comparison with the reference nor another record of the same
    work."""
    known, unchecked = _known(sources), set()
    for source in sources:
        cell = source.cell
        if cell.status != "ok" or cell.pairs is None or cell.pairs.count == 0:
            if cell.status == "ok" and not cell.record["agreement"]:
                unchecked.add(source.place)
            continue
        digests = known.get(work_of(source))
        if digests is None:
            unchecked.add(source.place)
        elif len(digests) > 1 or cell.pairs not in digests or _contradicts_itself(cell.record):
            cell.status = "wrong"
    return unchecked


def _contradicts_itself(record):
    """Whether the timed answer differs from the one that was compared with the reference."""
    compared, timed = ((record[part] or {}).get("digest") for part in ("agreement", "work"))
    return bool(compared and timed and compared != timed)
