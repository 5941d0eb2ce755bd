# SPDX-License-Identifier: MIT
"""Writes index.html with the answer, the verdicts, figures and tables of a folder."""

from ..pages.frame import Page, Section, figure, html_of
from ..pages.markup import element, items, link, paragraphs
from ..pages.tables import Column, Row, table
from . import headline
from .methods import FOUR
from .rules import AGREES, DIFFERS, NOT_SETTLED
from .tables import written

STYLE = "tr.ours { font-weight: 600; }\nfigure img { width: 60rem; }\n"
MARKS = {AGREES: "good", DIFFERS: "bad", NOT_SETTLED: "open"}
CLAIMS = (
    "A value agrees or differs if its whole 95 % interval keeps or breaks the rule of its claim. It is not settled if the interval contains a "
    "limit, or if there is one sample or only disturbed ones. It is untested if the same thing was not measured. Words in parentheses are ours."
)
METHODS = (
    "Milliseconds a frame. In parentheses gProximity's time over that of the method, with its 95 % interval: "
    "above 1 the method is faster."
)
METHODS_TITLE = "Four methods, everything on the device"


def records_links(locations):
    """Links to files of records: "records/cells-plates.jsonl:4" has the text cells-plates:4."""
    links = []
    for place in locations:
        file, colon, line = place.partition(":")
        links += [link(file, file.removeprefix("records/").removesuffix(".jsonl") + colon + line), " "]
    return links


def _table(made):
    """A table of the paper beside ours."""

    def value(row, name):
        found = row.get(name)
        return records_links((found or "").split()) if name == "records" else written(found, 4)

    columns = [
        Column(name.replace("_", " "), any(isinstance(row.get(name), (int, float)) for row in made.rows))
        for name in made.columns
    ]
    rows = [
        Row([value(row, name) for name in made.columns], style="ours" if row.get("source") == "ours" else "")
        for row in made.rows
    ]
    name, title = f"table{made.number}", f"Table {made.number}: {made.title}"
    return table(title, columns, rows, notes=made.notes, csv=f"{name}.csv", anchor=name)


def _figure(made):
    name = f"figure{made.number}"
    return figure(name, f"Figure {made.number}", f"{name}.svg", made.title, made.title, f"{name}.csv")


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


def _mark(verdict):
    return element("span", verdict, class_=MARKS.get(verdict, "quiet"))


def _line(lines, label, unit):
    """A verdict: of one line with a value, or of several without one that have the same reason."""
    first = lines[0]
    verdict = [_mark(first.verdict), f" ({first.reason})" if first.reason else ""]
    label = f"{label}: " if label else ""
    if first.measured is None:
        return [label, *verdict]
    value = f"{label}{_value(first, unit)}{_paper(first, unit)} – "
    basis = [basis_text(first.measured), " ", records_links(first.measured.records)]
    return [value, *verdict, element("br"), element("span", basis, class_="quiet")]


def _lines(claim):
    """Lines with a value, then the others, of which those with the same reason become one."""
    merged = {}
    for line in sorted(claim.lines, key=lambda line: line.measured is None):
        merged.setdefault((line.verdict, line.reason) if line.measured is None else id(line), []).append(line)
    for group in merged.values():
        is_whole = len(group) == len(claim.lines) > 1
        yield _line(
            group, "" if is_whole else ", ".join(line.label for line in group), claim.fields.get("unit", "")
        )


def _claim(claim):
    fields, shown = claim.fields, []
    for name in fields.get("shown", []):
        word = name.rstrip("0123456789")
        shown += [
            " · " if not shown else " ",
            link(f"#{name}", f"{word.capitalize()} {name.removeprefix(word)}"),
        ]
    note = [element("br"), element("span", fields["note"], class_="quiet")] if "note" in fields else None
    place = element("span", fields["where"], shown, class_="quiet")
    says = [fields["says"], note, element("br"), place]
    return Row([[_mark(claim.verdict)], says, [items(_lines(claim))]], anchor=claim.id)


def gaps(folder):
    """Texts on failed steps, on records that failed or are wrong, and on disturbed records."""
    failed = [(name, folder.steps[name]) for name in folder.failed]
    steps = [
        f"Step {name} ended with {step['exit']}: {step['says']}. {step.get('reason', '')}".strip()
        for name, step in failed
    ]
    wrong = [f"{location}: {message}." for location, message in folder.wrong()]
    return [
        *steps,
        *wrong,
        *(
            f"records/{step}.jsonl: {count} of {all_rounds} rounds are disturbed by other work."
            for step, count, all_rounds in folder.disturbed()
        ),
    ]


def _steps(folder):
    columns = ["step", Column("took", True), "commit", "day", "command, in this folder"]
    rows = [
        [
            name,
            f"{step['seconds']:.0f} s",
            step["commit"] + (" with changes" if step["dirty"] else ""),
            step["date"][:10],
            element("code", step["command"]),
        ]
        for name, step in folder.steps.items()
    ]
    return table("What was run", columns, rows, heading=False)


def _links(name, made):
    return [(f"{name}{one.number}", f"{name.capitalize()} {one.number}") for one in made]


def write(folder, tables, figures, claims):
    first, ceilings = next(iter(folder.steps.values())), folder.ceilings()
    device = ceilings["device"]["name"] if ceilings else first["device"]
    about = [
        f"Tables 1 to 7 and Figures 1 to 13 of Schmidtke and Erleben, IEEE TVCG 2018, measured by tandem on {device}, size {first['size']}. ",
        "The paper's schedule lets each work-item walk its own seeds; ours, grouped, has the same chunks, and a work-group shares its walks.",
    ]
    methods = table(
        METHODS_TITLE, ["scene", "k", *FOUR], headline.method_rows(folder), heading=False, notes=[METHODS]
    )
    columns, rows = ("verdict", "the paper states", "our records"), map(_claim, claims)
    verdicts = table("Claims", columns, rows, heading=False, notes=[CLAIMS], csv="claims.csv")
    missing = gaps(folder)
    sections = [
        Section("methods", METHODS_TITLE, methods, [("methods", "Methods")]),
        Section("claims", "Claims", verdicts),
        *([Section("gaps", "Gaps", items(missing))] if missing else []),
        Section("figures", "Figures", [*map(_figure, figures)], _links("figure", figures)),
        Section("tables", "Tables", [*map(_table, tables)], _links("table", tables)),
        Section("steps", "What was run", _steps(folder)),
    ]
    lead = [paragraphs(headline.sentences(folder, claims), "lead"), element("p", about, class_="quiet")]
    title = f"Chunked bounding volume hierarchies: the paper beside ours, on {device}"
    page = Page(title, sections, lead, has_images=True, style=STYLE)
    (folder.path / "index.html").write_text(html_of(page))
