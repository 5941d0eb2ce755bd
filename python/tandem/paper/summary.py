# SPDX-License-Identifier: MIT
"""Writes verdicts.md, the answer and one row for each claim, for readers of a folder of results without a
browser."""

from .. import markdown
from ..text_lines import visible
from . import headline
from .rules import AGREES, DIFFERS, ERRATUM, UNTESTED
from .tables import written

MOST_SCENES = 5


def _value(line, unit):
    scale = 100 if unit == "%" else 1
    text = written(scale * line.measured.value) + (" %" if unit == "%" else "")
    return f"{line.label}: {text}" if line.label else text


def _ours(claim):
    """Values of the tested scenes, or the reason why the claim is untested."""
    tested = [line for line in claim.lines if line.measured and line.verdict != UNTESTED]
    if not tested:
        return claim.lines[0].reason
    unit = claim.fields.get("unit", "")
    values = "; ".join(_value(line, unit) for line in tested[:MOST_SCENES]) + (
        "; and more" if len(tested) > MOST_SCENES else ""
    )
    said = f": {claim.lines[0].reason}" if claim.verdict == ERRATUM else ""
    return (values if unit == "%" else f"{values} {unit}") + said


def _verdict(claim):
    is_provisional = "provisional" in claim.fields and claim.verdict in (AGREES, DIFFERS)
    return f"**{claim.verdict}**" + (" (provisional)" if is_provisional else "")


def write(folder, claims):
    rows = [[claim.fields["says"], claim.fields["where"], _verdict(claim), _ours(claim)] for claim in claims]
    text = [
        "# The paper's claims and our records",
        "",
        "For those who look for one claim. `tandem paper` writes this page. [index.html](index.html) has intervals and records.",
        "",
    ]
    text += [sentence + "\n" for sentence in headline.sentences(folder, claims)]
    text += [markdown.table(["the paper states", "where", "verdict", "ours"], rows)]
    (folder.path / "verdicts.md").write_text(visible("\n".join(text).rstrip() + "\n", "\n"))
