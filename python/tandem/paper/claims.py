# SPDX-License-Identifier: MIT
"""The paper's claims of statements/*.toml, and a verdict on each from the records of a folder."""

import dataclasses
import tomllib

from . import paper_numbers
from .measures import MEASURES, Declared
from .methods import STATEMENTS, names
from .quantities import NotMeasured
from .rules import UNTESTED, VERDICTS, judged, together


@dataclasses.dataclass(frozen=True)
class Line:
    """The verdict of one scene. label: the scene, with k if the claim has several; empty for a claim without
    scenes. paper: the paper's numbers by device. reason: why it is not settled or untested."""

    label: str
    verdict: str
    measured: object = None
    paper: dict = dataclasses.field(default_factory=dict)
    reason: str = ""


@dataclasses.dataclass(frozen=True)
class Claim:
    """fields: as declared. lines: one verdict for each scene. verdict: of the claim."""

    fields: dict
    lines: tuple
    verdict: str

    @property
    def id(self):
        return self.fields["id"]


def declared():
    """The fields of every claim of statements/."""
    fields = []
    for path in sorted(STATEMENTS.glob("*.toml")):
        with open(path, "rb") as file:
            fields += tomllib.load(file).get("claim", [])
    return fields


def _scenes(fields):
    scenes = fields.get("scenes", [""])
    return names()["groups"][scenes] if isinstance(scenes, str) else scenes


def line_of(claim, folder, scene, k):
    """The verdict of one scene and k."""
    fields = claim.fields
    label = f"{scene}, k = {k}" if "k" in fields else scene
    paper = paper_numbers.of_scene(fields.get("paper"), scene)
    if "measure" not in fields:
        return Line(label, UNTESTED, None, paper, fields["why"])
    if folder.size == "small" and not fields.get("small"):
        return Line(label, UNTESTED, None, paper, "small scenes")
    try:
        measured = MEASURES[fields["measure"]](claim, folder, scene, k)
    except NotMeasured as reason:
        return Line(label, UNTESTED, None, paper, str(reason))
    return Line(label, *_with(judged(measured, fields["rule"], list(paper.values())), measured, paper))


def _with(verdict_and_reason, measured, paper):
    verdict, reason = verdict_and_reason
    return verdict, measured, paper, reason


def judge(fields, folder):
    """A Claim with its verdicts from the records of a Folder."""
    claim = Declared(fields)
    lines = tuple(
        line_of(claim, folder, scene, k) for scene in _scenes(fields) for k in fields.get("k", ["8"])
    )
    return Claim(fields, lines, together([line.verdict for line in lines], fields.get("together", "all")))


def all_claims(folder):
    return [judge(fields, folder) for fields in declared()]


def counts(claims):
    """Number of claims by verdict."""
    return {verdict: sum(claim.verdict == verdict for claim in claims) for verdict in VERDICTS}
