# SPDX-License-Identifier: MIT
"""Writes index.html with the verdicts, figures and tables of a folder."""
from html import escape

from .tables import short

STYLE = """
:root { color-scheme: light dark; --ink: #222; --pale: #667; --line: #ccd; --paper: #fff; --good: #0b6e3a; --bad: #a3200d; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --pale: #aab; --line: #445; --paper: #15171a; --good: #6fd39b; --bad: #ff9b87; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 66rem; margin: 0 auto; padding: 1rem; }
h1, h2, h3 { line-height: 1.2; } .pale { color: var(--pale); } .wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid var(--line); padding: .25rem .5rem; text-align: left; vertical-align: top; }
td.number { text-align: right; } tr.ours { font-weight: 600; } img { max-width: 100%; height: auto; background: #fff; border-radius: 4px; }
.agrees { color: var(--good); font-weight: 700; } .differs { color: var(--bad); font-weight: 700; }
nav a { margin-right: .8rem; } figure { margin: 1.5rem 0; } figcaption { font-size: .85rem; color: var(--pale); }
@media print { nav { display: none; } body { max-width: none; } table, figure { break-inside: avoid; } }
"""


def table_html(table):
    head = "".join(f"<th scope=col>{escape(name.replace('_', ' '))}</th>" for name in table.columns)
    rows = []
    for row in table.rows:
        cells = "".join(f'<td class="{"number" if isinstance(row.get(name), (int, float)) else "text"}">{escape(short(row.get(name)))}</td>' for name in table.columns)
        rows.append(f'<tr class="{"ours" if row.get("source") == "ours" else "theirs"}">{cells}</tr>')
    notes = "".join(f"<p class=pale>{escape(note)}</p>" for note in table.notes)
    return (f'<section id="table{table.number}"><h3>Table {table.number}: {escape(table.title)}</h3>{notes}<div class=wide tabindex=0><table><thead><tr>{head}</tr></thead>'
            f'<tbody>{"".join(rows)}</tbody></table></div><p><a href="table{table.number}.csv">table{table.number}.csv</a></p></section>')


def figure_html(figure):
    return (f'<figure id="figure{figure.number}"><h3>Figure {figure.number}</h3><img src="figure{figure.number}.svg" alt="{escape(figure.title, quote=True)}">'
            f'<figcaption>{escape(figure.title)} <a href="figure{figure.number}.csv">figure{figure.number}.csv</a></figcaption></figure>')


def claim_row(claim):
    kind = claim.verdict if claim.verdict in ("agrees", "differs") else "pale"
    return (f"<tr><td>{escape(claim.where)}</td><td>{escape(claim.says)}</td><td class={kind}>{escape(claim.verdict)}</td><td>{escape(claim.ours)}</td></tr>")


def gaps(folder):
    """List items for failed steps and for records that failed or are wrong."""
    texts = [f"Step {name} ended with {folder.steps[name]['exit']}: {folder.steps[name]['says']}." for name in folder.failed]
    texts += [f"{location}: {message}." for location, message in folder.wrong()]
    return "".join(f"<li>{escape(text)}</li>" for text in texts)


def steps_html(folder):
    rows = "".join(f"<tr><td>{escape(name)}</td><td class=number>{step['seconds']:.0f} s</td><td>{escape(step['commit'])}{' with changes' if step['dirty'] else ''}</td>"
                   f"<td>{escape(step['date'][:10])}</td><td><code>{escape(step['command'])}</code></td></tr>" for name, step in folder.steps.items())
    return ('<section id=steps><h2>What was run</h2><div class=wide tabindex=0><table><thead><tr><th>step</th><th>took</th><th>commit</th><th>day</th><th>command, in this folder</th></tr>'
            f"</thead><tbody>{rows}</tbody></table></div></section>")


def write(folder, tables, figures, claims):
    first = next(iter(folder.steps.values()))
    ceilings = folder.ceilings()
    device = ceilings["device"]["name"] if ceilings else first["device"]
    count = {kind: sum(claim.verdict == kind for claim in claims) for kind in ("agrees", "differs", "cannot be tested here")}
    nav = "".join(f'<a href="#{name}{item.number}">{name.capitalize()} {item.number}</a>' for name, items in (("table", tables), ("figure", figures)) for item in items)
    missing = gaps(folder)
    page = f"""<!DOCTYPE html>
<html lang=en><head><meta charset=utf-8><meta name=viewport content="width=device-width, initial-scale=1"><title>The paper beside ours: {escape(device)}</title>
<style>{STYLE}</style></head><body>
<h1>Chunked bounding volume hierarchies: the paper beside ours</h1>
<p><b>The verdicts on this page are under revision.</b> Some of them compare the paper with our grouped schedule instead of its own, mix settings
of two GPUs, or are judged by fewer scenes than the claim names.</p>
<p>Tables 1 to 7 and Figures 1 to 13 of Schmidtke and Erleben, IEEE TVCG 2018, measured by <b>tandem</b> on {escape(device)}, size {escape(first['size'])}.
Of {len(claims)} claims {count['agrees']} agree, {count['differs']} differ and {count['cannot be tested here']} cannot be tested here.</p>
<nav aria-label=contents><a href="#claims">Claims</a>{nav}<a href="#steps">What was run</a></nav>
{f'<h2>Gaps</h2><ul>{missing}</ul>' if missing else ''}
<section id=claims><h2>Claims</h2><div class=wide tabindex=0><table><thead><tr><th>where</th><th>the paper says</th><th>verdict</th><th>ours</th></tr></thead><tbody>
{"".join(map(claim_row, claims))}</tbody></table></div><p><a href="claims.csv">claims.csv</a></p></section>
<h2>Tables</h2>{"".join(map(table_html, tables))}
<h2>Figures</h2>{"".join(map(figure_html, figures))}
{steps_html(folder)}
</body></html>
"""
    (folder.path / "index.html").write_text(page)
