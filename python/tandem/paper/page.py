# SPDX-License-Identifier: MIT
"""Writes index.html with the answer, the verdicts, figures and tables of a folder."""

from html import escape

from ..text_lines import visible
from . import headline
from .methods import FOUR
from .rules import AGREES, DIFFERS, NOT_SETTLED
from .tables import written

STYLE = """
:root { color-scheme: light dark; --ink: #222; --pale: #667; --line: #ccd; --paper: #fff; --good: #0b6e3a; --bad: #a3200d; --open: #8a5a00; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --pale: #aab; --line: #445; --paper: #15171a; --good: #6fd39b; --bad: #ff9b87; --open: #f0c060; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 66rem; margin: 0 auto; padding: 1rem; }
h1, h2, h3 { line-height: 1.2; } .pale { color: var(--pale); } .wide { overflow-x: auto; } .answer { font-size: 1.15rem; } .answer p { margin: .4rem 0; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; } a { color: inherit; }
th, td { border-bottom: 1px solid var(--line); padding: .25rem .5rem; text-align: left; vertical-align: top; }
td.number { text-align: right; } tr.ours { font-weight: 600; } img { max-width: 100%; height: auto; background: #fff; border-radius: 4px; }
td ul { list-style: none; margin: 0; padding: 0; } .small { font-size: .8rem; color: var(--pale); }
.agrees { color: var(--good); font-weight: 700; } .differs { color: var(--bad); font-weight: 700; } .open { color: var(--open); font-weight: 700; }
nav a { margin-right: .8rem; white-space: nowrap; } figure { margin: 1.5rem 0; } figcaption { font-size: .85rem; color: var(--pale); }
@media (max-width: 44rem) { .claims thead { display: none; } .claims tr, .claims td { display: block; border: 0; padding: .1rem 0; } .claims tr { border-bottom: 1px solid var(--line);
 padding: .6rem 0; } }
@media print { nav { display: none; } body { max-width: none; font-size: 11pt; } tr, figure { break-inside: avoid; } .wide { overflow: visible; } table { font-size: 7pt; } }
"""
CLASSES = {AGREES: "agrees", DIFFERS: "differs", NOT_SETTLED: "open"}


def records_html(locations):
    """Links to files of records: "records/cells-plates.jsonl:4" has the text cells-plates:4."""

    def link(place):
        file, _, line = place.partition(":")
        name = file.removeprefix("records/").removesuffix(".jsonl")
        return f'<a href="{escape(file, quote=True)}">{escape(name + (":" + line if line else ""))}</a>'

    return " ".join(map(link, locations))


def _cell(name, value):
    if name == "records" and value:
        return f"<td>{records_html(value.split())}</td>"
    return f'<td class="{"number" if isinstance(value, (int, float)) else "text"}">{escape(written(value, 4))}</td>'


def table_html(table):
    head = "".join(f"<th scope=col>{escape(name.replace('_', ' '))}</th>" for name in table.columns)
    rows = [
        f'<tr class="{"ours" if row.get("source") == "ours" else "theirs"}">{"".join(_cell(name, row.get(name)) for name in table.columns)}</tr>'
        for row in table.rows
    ]
    notes = "".join(f"<p class=pale>{escape(note)}</p>" for note in table.notes)
    return (
        f'<section id="table{table.number}"><h3>Table {table.number}: {escape(table.title)}</h3>{notes}<div class=wide tabindex=0><table><thead><tr>{head}</tr></thead>'
        f'<tbody>{"".join(rows)}</tbody></table></div><p><a href="table{table.number}.csv">table{table.number}.csv</a></p></section>'
    )


def figure_html(figure):
    return (
        f'<figure id="figure{figure.number}"><h3>Figure {figure.number}</h3><img src="figure{figure.number}.svg" alt="{escape(figure.title, quote=True)}">'
        f'<figcaption>{escape(figure.title)} <a href="figure{figure.number}.csv">figure{figure.number}.csv</a></figcaption></figure>'
    )


def _percent(unit, text):
    return f"{text} %" if unit == "%" else text


def _value(line, unit):
    """The measured value of a line with its unit; shares are percents."""
    measured, scale = line.measured, 100 if unit == "%" else 1
    texts = [written(scale * value) for value in (measured.value, measured.low, measured.high)]
    text = texts[0] if measured.low == measured.high else f"{texts[0]} [{texts[1]}, {texts[2]}]"
    return _percent(unit, text) if unit == "%" else f"{text} {unit}"


def _paper(line, unit):
    scale = 100 if unit == "%" else 1
    values = [scale * value for value in line.paper.values()]
    if not values:
        return ""
    low, high = written(min(values)), written(max(values))
    return _percent(unit, low if low == high else f"{low} to {high}")


def basis_text(measured):
    """What a value was measured on: frames and samples, and how many samples were left out."""
    samples = (
        ""
        if measured.is_exact
        else f"{measured.samples} {measured.basis}"
        if measured.samples > 1
        else "one sample"
    )
    disturbed = f"{measured.disturbed} disturbed samples left out" if measured.disturbed else ""
    return ", ".join(text for text in (measured.frames, samples, disturbed) if text)


def _line_html(line, unit):
    verdict = f'<span class="{CLASSES.get(line.verdict, "pale")}">{line.verdict}</span>'
    reason = f" ({escape(line.reason)})" if line.reason else ""
    label = f"{escape(line.label)}: " if line.label else ""
    if line.measured is None:
        return f"<li>{label}{verdict}{reason}</li>"
    paper = _paper(line, unit)
    theirs = f"; the paper {escape(paper)}" if paper else ""
    return (
        f"<li>{label}{escape(_value(line, unit))}{theirs} – {verdict}{reason}<br><span class=small>{escape(basis_text(line.measured))} "
        f"{records_html(line.measured.records)}</span></li>"
    )


def _together(lines):
    """Lines with a value, then the others, of which those with the same reason become one."""
    merged = {}
    for line in sorted(lines, key=lambda line: line.measured is None):
        merged.setdefault((line.verdict, line.reason) if line.measured is None else id(line), []).append(line)
    return merged.values()


def _lines_html(claim):
    unit, items = claim.fields.get("unit", ""), []
    for group in _together(claim.lines):
        if len(group) == 1 or group[0].measured is not None:
            items.append(_line_html(group[0], unit))
        else:
            labels = "" if len(group) == len(claim.lines) else ", ".join(line.label for line in group) + ": "
            items.append(
                f"<li>{escape(labels)}<span class=pale>{group[0].verdict}</span> ({escape(group[0].reason)})</li>"
            )
    return f"<ul>{''.join(items)}</ul>"


def claim_row(claim):
    fields = claim.fields
    shown = " ".join(
        f'<a href="#{name}">{name[: -len(digits)].capitalize()} {digits}</a>'
        for name in fields.get("shown", [])
        for digits in [name.lstrip("abcdefghijklmnopqrstuvwxyz")]
    )
    note = f"<br><span class=small>{escape(fields['note'])}</span>" if "note" in fields else ""
    return (
        f'<tr id="{escape(claim.id, quote=True)}"><td class="{CLASSES.get(claim.verdict, "pale")}">{claim.verdict}</td><td>{escape(fields["says"])}{note}<br>'
        f"<span class=small>{escape(fields['where'])}{' · ' + shown if shown else ''}</span></td><td>{_lines_html(claim)}</td></tr>"
    )


def claims_html(claims):
    return (
        f"<section id=claims><h2>Claims</h2><p class=pale>A value <b>agrees</b> or <b>differs</b> if its whole 95 % interval keeps or breaks the rule of its claim. It is "
        f"<b>not settled</b> if the interval contains a limit, or if there is one sample or only disturbed ones. It is <b>untested</b> if the same thing was not measured. "
        f"Words in parentheses are ours.</p><table class=claims><thead><tr><th>verdict</th><th>the paper states</th><th>our records</th></tr></thead>"
        f'<tbody>{"".join(map(claim_row, claims))}</tbody></table><p><a href="claims.csv">claims.csv</a></p></section>'
    )


def methods_html(folder):
    rows = "".join(
        f"<tr>{''.join(f'<td>{escape(text)}</td>' for text in row)}</tr>"
        for row in headline.method_rows(folder)
    )
    head = "".join(f"<th scope=col>{escape(name)}</th>" for name in ("scene", "k", *FOUR))
    return (
        f"<section id=methods><h2>Four methods, everything on the device</h2><p class=pale>Milliseconds a frame. In parentheses gProximity's time over that of the method, "
        f"with its 95 % interval: above 1 the method is faster.</p><div class=wide tabindex=0><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div></section>"
    )


def gaps(folder):
    """List items for failed steps, for records that failed or are wrong, and for disturbed records."""
    failed = [(name, folder.steps[name]) for name in folder.failed]
    texts = [
        f"Step {name} ended with {step['exit']}: {step['says']}. {step.get('reason', '')}".strip()
        for name, step in failed
    ]
    texts += [f"{location}: {message}." for location, message in folder.wrong()]
    texts += [
        f"records/{step}.jsonl: {count} of {all_rounds} rounds are disturbed by other work."
        for step, count, all_rounds in folder.disturbed()
    ]
    return "".join(f"<li>{escape(text)}</li>" for text in texts)


def steps_html(folder):
    rows = "".join(
        f"<tr><td>{escape(name)}</td><td class=number>{step['seconds']:.0f} s</td><td>{escape(step['commit'])}{' with changes' if step['dirty'] else ''}</td>"
        f"<td>{escape(step['date'][:10])}</td><td><code>{escape(step['command'])}</code></td></tr>"
        for name, step in folder.steps.items()
    )
    return (
        "<section id=steps><h2>What was run</h2><div class=wide tabindex=0><table><thead><tr><th>step</th><th>took</th><th>commit</th><th>day</th><th>command, in this folder</th></tr>"
        f"</thead><tbody>{rows}</tbody></table></div></section>"
    )


def write(folder, tables, figures, claims):
    first = next(iter(folder.steps.values()))
    ceilings = folder.ceilings()
    device = ceilings["device"]["name"] if ceilings else first["device"]
    nav = "".join(
        f'<a href="#{name}{item.number}">{name.capitalize()} {item.number}</a>'
        for name, items in (("table", tables), ("figure", figures))
        for item in items
    )
    missing = gaps(folder)
    page = f"""<!DOCTYPE html>
<html lang=en><head><meta charset=utf-8><meta name=viewport content="width=device-width, initial-scale=1"><title>The paper beside ours: {escape(device)}</title>
<style>{STYLE}</style></head><body>
<h1>Chunked bounding volume hierarchies: the paper beside ours</h1>
<div class=answer>{"".join(f"<p>{escape(sentence)}</p>" for sentence in headline.sentences(folder, claims))}</div>
<p class=pale>Tables 1 to 7 and Figures 1 to 13 of Schmidtke and Erleben, IEEE TVCG 2018, measured by <b>tandem</b> on {escape(device)}, size {escape(first["size"])}.
<i>The paper's schedule</i> lets each work-item walk its own seeds; <i>ours, grouped</i>, has the same chunks, and a work-group shares its walks.</p>
<nav aria-label=contents><a href="#methods">Methods</a><a href="#claims">Claims</a>{nav}<a href="#steps">What was run</a></nav>
{methods_html(folder)}
{claims_html(claims)}
{f"<h2>Gaps</h2><ul>{missing}</ul>" if missing else ""}
<h2>Figures</h2>{"".join(map(figure_html, figures))}
<h2>Tables</h2>{"".join(map(table_html, tables))}
{steps_html(folder)}
</body></html>
"""
    (folder.path / "index.html").write_text(visible(page, "\n"))
