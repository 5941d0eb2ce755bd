# SPDX-License-Identifier: MIT
"""The claims of a folder for index.html: in groups by verdict that fold, with intervals, samples and records."""

from ..pages.groups import Group, groups
from ..pages.markup import element, items, link
from ..pages.tables import Column, Row, table
from .rules import AGREES, BY_CONSTRUCTION, DIFFERS, ERRATUM, NOT_SETTLED, UNTESTED
from .tables import written

MARKS = {AGREES: "good", DIFFERS: "bad", NOT_SETTLED: "open"}
MEANINGS = {
    AGREES: "The whole 95 % interval of our value keeps the rule of the claim.",
    DIFFERS: "The whole 95 % interval of our value breaks the rule of the claim.",
    NOT_SETTLED: "The interval contains a limit of the rule, or there is only one sample, or other work disturbed every sample.",
    BY_CONSTRUCTION: "The claim follows from the inputs or from the code, so that no measurement could contradict it.",
    UNTESTED: "Our records do not measure the same thing.",
}
CONTRADICTED = "The paper contradicts itself. No count of verdicts has these."
WORDS = "Words in parentheses are ours. An interval has 95 %."


def records_links(locations):
    """Links to files of records: "records/cells-plates.jsonl:4" has the text cells-plates:4."""
    links = []
    for place in locations:
        file, colon, line = place.partition(":")
        links += [
            link(
                file, file.removeprefix("records/").removesuffix(".xz").removesuffix(".jsonl") + colon + line
            ),
            " ",
        ]
    return links


def _scaled(values, unit):
    """Texts of values; shares are percents."""
    return [written((100 if unit == "%" else 1) * value) for value in values]


def _value(line, unit):
    """The measured value of a line with its unit."""
    measured = line.measured
    text, low, high = _scaled((measured.value, measured.low, measured.high), unit)
    return f"{text if measured.low == measured.high else f'{text} [{low}, {high}]'} {unit}"


def _paper(line, unit):
    values = sorted(line.paper.values())
    if not values:
        return ""
    low, high = _scaled((values[0], values[-1]), unit)
    return f"; the paper {low if low == high else f'{low} to {high}'}{' %' if unit == '%' else ''}"


def basis_text(measured):
    """What a value was measured on: frames and samples, and how many samples were left out."""
    several = f"{measured.samples} {measured.basis}" if measured.samples > 1 else "one sample"
    disturbed = f"{measured.disturbed} disturbed samples left out" if measured.disturbed else ""
    return ", ".join(filter(None, (measured.frames, "" if measured.is_exact else several, disturbed)))


def mark(verdict):
    return element("span", verdict, class_=MARKS.get(verdict, "quiet"))


def _named(lines, claim):
    """The scenes of lines before their text; empty if they are all of several."""
    names = ", ".join(line.label for line in lines)
    return f"{names}: " if names and not len(lines) == len(claim.lines) > 1 else ""


def _measured_line(line, claim):
    unit = claim.fields.get("unit", "")
    reason = f" ({line.reason})" if line.reason else ""
    return [_named([line], claim), _value(line, unit), _paper(line, unit), " – ", mark(line.verdict), reason]


def _lines(claim):
    """Lines with a value, then the others, of which those with the same reason become one."""
    yield from (_measured_line(line, claim) for line in claim.lines if line.measured)
    merged = {}
    for line in claim.lines:
        if not line.measured:
            merged.setdefault((line.verdict, line.reason), []).append(line)
    for (verdict, reason), lines in merged.items():
        yield [_named(lines, claim), mark(verdict), f" ({reason})" if reason else ""]


def _basis(claim):
    """Samples and records of each value, folded."""
    measured = [line for line in claim.lines if line.measured]
    texts = [
        [_named([line], claim), basis_text(line.measured), " ", records_links(line.measured.records)]
        for line in measured
    ]
    return element("details", element("summary", "samples and records"), items(texts)) if texts else None


def _places(claim):
    """Where the paper says it, and where our page has the same numbers."""
    shown = [element("span", claim.fields["where"])]
    for name in claim.fields.get("shown", []):
        word = name.rstrip("0123456789")
        shown += [" · ", link(f"#{name}", f"{word.capitalize()} {name.removeprefix(word)}")]
    return element("div", shown, class_="quiet")


def _row(claim):
    fields = claim.fields
    note = element("div", fields["note"], class_="quiet") if "note" in fields else None
    erratum = None
    if "erratum" in fields and claim.verdict != ERRATUM:
        erratum = element("div", f"Erratum: {fields['erratum']}")
    return Row(
        [[fields["says"], erratum, note, _places(claim)], [items(_lines(claim)), _basis(claim)]],
        anchor=claim.id,
    )


def anchor_of(verdict):
    return verdict.replace(" ", "-")


def _claims_table(verdict, claims, note):
    columns = [Column("the paper states", style="text"), Column("our records", style="text")]
    return table(f"Claims: {verdict}", columns, map(_row, claims), heading=False, notes=[note])


def counted(claims):
    """The claims without those that the paper contradicts itself."""
    return [claim for claim in claims if claim.verdict != ERRATUM]


def claim_groups(claims, anchor):
    """The counted claims in groups by verdict, in the section of that id."""
    by_verdict = {verdict: [] for verdict in MEANINGS}
    for claim in counted(claims):
        by_verdict[claim.verdict].append(claim)
    parts = [
        Group(
            anchor_of(verdict),
            verdict,
            len(own),
            _claims_table(verdict, own, MEANINGS[verdict]),
            MARKS.get(verdict, ""),
        )
        for verdict, own in by_verdict.items()
        if own
    ]
    return [*groups("Verdicts", anchor, parts), element("p", WORDS, " ", link("claims.csv"), class_="quiet")]


def errata(claims):
    """The claims that the paper contradicts, and the errors of the paper that other claims name, with links to these;
    empty without any."""
    own = [claim for claim in claims if claim.verdict == ERRATUM]
    named = [
        [claim.fields["erratum"], " (", link(f"#{claim.id}", claim.fields["where"]), ")"]
        for claim in counted(claims)
        if "erratum" in claim.fields
    ]
    return [*([_claims_table(ERRATUM, own, CONTRADICTED)] if own else []), *([items(named)] if named else [])]
