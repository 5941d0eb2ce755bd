# SPDX-License-Identifier: MIT
"""The paper's claims of statements/*.toml, and a verdict on each from the records of a folder."""

import dataclasses
import tomllib

from . import measures, paper_numbers, scene_measures, step_measures
from .measures import Declared
from .methods import STATEMENTS, names
from .quantities import NotMeasured
from .rules import AGREES, BY_CONSTRUCTION, DIFFERS, ERRATUM, UNTESTED, VERDICTS, judged, together

MEASURES = step_measures.MEASURES | {
    made.__name__: made for made in (*measures.MEASURES, *scene_measures.MEASURES)
}
GPUS = {"c2075": "C2075", "k20c": "K20c", "k40c": "K40c", "w8100": "W8100"}  # of the paper, by our presets


@dataclasses.dataclass(frozen=True)
class Line:
    """The verdict of one scene. label: the scene, with GPU and k if the claim has several; empty for a claim
    without scenes. paper: the paper's numbers by device. reason: why it is neither that it agrees nor that it
    differs, or why that is provisional."""

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


def _with_gpu(part, gpu):
    """Fields of a claim with the name of one of the paper's GPUs in place of {gpu}."""
    if isinstance(part, dict):
        return {name: _with_gpu(value, gpu) for name, value in part.items()}
    return part.replace("{gpu}", gpu).replace("{GPU}", GPUS[gpu]) if isinstance(part, str) else part


def variants(fields):
    """(fields, scene, k, label) of every verdict of a claim."""
    for gpu in fields.get("gpus", [None]):
        own = _with_gpu(fields, gpu) if gpu else fields
        for scene in _scenes(fields):
            for k in fields.get("k", ["8"]):
                parts = (scene, gpu and GPUS[gpu], f"k = {k}" if "k" in fields else None)
                yield own, scene, k, ", ".join(filter(None, parts))


def _without_measure(fields, size):
    """Why the claim is not tested at all; None if it is."""
    if "measure" not in fields:
        return fields["why"]
    return "small scenes" if size == "small" and not fields.get("small") else None


def line_of(claim, folder, scene, k, label=""):
    """The verdict of one scene and k."""
    fields = claim.fields
    paper = paper_numbers.of_scene(fields.get("paper"), scene)
    why = _without_measure(fields, folder.size)
    if why:
        return Line(label, UNTESTED, None, paper, why)
    try:
        measured = MEASURES[fields["measure"]](claim, folder, scene, k)
    except NotMeasured as reason:
        return Line(label, UNTESTED, None, paper, str(reason))
    if folder.size == "small" and not measured.is_exact:
        return Line(label, UNTESTED, None, paper, "small scenes judge counts only")
    verdict, reason = judged(measured, fields["rule"], list(paper.values()))
    verdict, reason = _as_declared(fields, verdict, reason)
    return Line(label, verdict, measured, paper, reason)


def _as_declared(fields, verdict, reason):
    """(verdict, reason) of a claim that our inputs or code decide, of the paper's own numbers, and of one
    that rests on something provisional."""
    if verdict == AGREES and "by_construction" in fields:
        return BY_CONSTRUCTION, fields["by_construction"]
    if verdict == DIFFERS and "erratum" in fields:
        return ERRATUM, fields["erratum"]
    if verdict in (AGREES, DIFFERS) and "provisional" in fields:
        return verdict, f"provisional: {fields['provisional']}"
    return verdict, reason


def judge(fields, folder):
    """A Claim with its verdicts from the records of a Folder."""
    lines = tuple(
        line_of(Declared(own), folder, scene, k, label) for own, scene, k, label in variants(fields)
    )
    return Claim(fields, lines, together([line.verdict for line in lines], fields.get("together", "all")))


def all_claims(folder):
    return [judge(fields, folder) for fields in declared()]


def counts(claims):
    """Number of claims by verdict, without errata of the paper."""
    return {verdict: sum(claim.verdict == verdict for claim in claims) for verdict in VERDICTS}


def errata(claims):
    return [claim for claim in claims if claim.verdict == ERRATUM]
