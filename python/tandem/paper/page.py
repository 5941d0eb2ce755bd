# SPDX-License-Identifier: MIT
"""Writes index.html with the answer, the verdicts, figures and tables of a folder."""

from ..pages.frame import Page, Section, figure, html_of
from ..pages.groups import folded, groups_script
from ..pages.markup import element, items, link, paragraphs
from ..pages.tables import Column, Row, table
from . import headline
from .claim_groups import claim_groups, counted, errata, records_links
from .methods import FOUR
from .provenance import apart, builds_of, cards_of, is_uniform, origins
from .tables import written

STYLE = """tr.ours { font-weight: 600; }
@media (min-width: 40rem) { figure img { width: 48rem; } }
@media (min-width: 80rem) {
  #figures { display: grid; grid-template-columns: 1fr 1fr; gap: 0 2rem; }
  #figures > :not(figure) { grid-column: 1 / -1; }
}
"""
METHODS = (
    "Milliseconds per frame; the fastest of a row is bold. In parentheses, with its 95 % interval, gProximity's time over that of the method: "
    "above 1, the method is faster. The paper's schedule lets each work-item walk its own seeds; the grouped schedule has the same chunks, and "
    "a work-group shares its walks."
)
METHODS_TITLE = "Four methods, everything on the device"
MIXED = "A ratio between records of two steps may also compare two builds or two cards, and a composed value may mix them."
RECORDED = "Contacts of a step are the same on every device and with every build; claims about times of whole simulations are provisional."


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
    shown = table(title, columns, rows, heading=False, notes=made.notes, csv=f"{name}.csv", is_wide=True)
    return folded(name, title, shown)


def _figure(made):
    name = f"figure{made.number}"
    return figure(name, f"Figure {made.number}", made.title, f"{name}.svg", f"{name}.csv")


def _methods(folder):
    """The table of the four methods. The one that is fastest most often is the first, in sight on a phone."""
    rows, fastest = headline.method_rows(folder), []
    for row in headline.four_methods(folder):
        times = {name: case.total() / case.frames for name, case in row["cases"].items() if case}
        fastest.append(min(times, key=times.get))
    order = sorted(FOUR, key=fastest.count, reverse=True)
    shown = []
    for (scene, k, *texts), best in zip(rows, fastest):
        own = dict(zip(FOUR, texts)) | {best: [element("strong", texts[FOUR.index(best)])]}
        shown.append([scene, k, *(own[name] for name in order)])
    return table(METHODS_TITLE, ["scene", "k", *order], shown, heading=False, notes=[METHODS])


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
    title = f"The commands of {len(rows)} steps"
    return folded("commands", title, table(title, columns, rows, heading=False, is_wide=True))


def _commits(commits):
    return f"commit{'s' if len(commits) > 1 else ''} {' and '.join(commits)}"


def _recorded(found):
    """A line about simulations that were recorded before."""
    if not found:
        return ""
    commits = dict.fromkeys(origin.commit for origin in found)
    return element(
        "p",
        f"Simulations were recorded on a processor by {_commits(list(commits))}. {RECORDED}",
        class_="quiet",
    )


def _provenance(folder):
    """One line if all measurements are of one build and one card, and a warning with a table if not."""
    found, recorded = apart(origins(folder))
    builds, cards = builds_of(found), cards_of(found)
    if is_uniform(found):
        [commits] = builds.values()
        where = f"one card, {cards[0]}" if cards else "one processor"
        same = ", which have the same sources," if len(commits) > 1 else ""
        which = "measurements" if recorded else "records"
        line = f"All {which} are of {_commits(commits)}{same} and of {where}."
        return [element("p", line, class_="quiet"), _recorded(recorded)]
    counts = [f"{len(builds)} builds of tandem"] if len(builds) > 1 else []
    counts += [f"{len(cards)} cards"] if len(cards) > 1 else []
    rows = {}
    for origin in found:
        where = ", ".join(origin.cards) or "processor"
        rows.setdefault((_commits(builds[origin.build]), where), {})[origin.step] = None
    listed = [[commits, where, ", ".join(steps)] for (commits, where), steps in sorted(rows.items())]
    title = "Which step is of which build and card"
    said = element("p", element("strong", "Warning: "), f"the records are of {' and '.join(counts)}. {MIXED}")
    shown = table(title, ["build", "card", "steps"], listed, heading=False)
    warning = element("div", said, folded("provenance", title, shown), class_="warning", role="note")
    return [warning, _recorded(recorded)]


def _section_of(name, made, draw):
    """A section of all figures or tables, which begins with links to them."""
    links = [[link(f"#{name}{one.number}", f"{name.capitalize()} {one.number}"), " "] for one in made]
    return Section(f"{name}s", f"{name.capitalize()}s", [element("p", links), *map(draw, made)])


def _about(folder):
    first, ceilings = next(iter(folder.steps.values())), folder.ceilings()
    device = ceilings["device"]["name"] if ceilings else first["device"]
    return device, (
        f"Tables 1 to 7 and Figures 1 to 13 of Schmidtke and Erleben, IEEE TVCG 2018, measured by tandem on {device}, size {first['size']}. "
        "Figure 14 is ours."
    )


def write(folder, tables, figures, claims):
    device, about = _about(folder)
    missing, wrong = gaps(folder), errata(claims)
    sections = [
        Section("claims", f"{len(counted(claims))} claims of the paper", claim_groups(claims, "claims")),
        Section("methods", METHODS_TITLE, _methods(folder)),
        _section_of("figure", figures, _figure),
        _section_of("table", tables, _table),
        Section("steps", "What was run", _steps(folder)),
        *([Section("gaps", "Gaps", items(missing))] if missing else []),
        *([Section("errata", "Errata of the paper", wrong)] if wrong else []),
    ]
    lead = [
        paragraphs(headline.sentences(folder, claims), "lead"),
        _provenance(folder),
        element("p", about, class_="quiet"),
    ]
    title = f"Chunked bounding volume hierarchies: the paper beside ours, on {device}"
    page = Page(title, sections, lead, scripts=[groups_script()], without="", has_images=True, style=STYLE)
    (folder.path / "index.html").write_text(html_of(page))
