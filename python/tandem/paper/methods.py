# SPDX-License-Identifier: MIT
"""The names of methods and scenes of statements/names.toml, the cells that they stand for, and the timers of
the paper's release (statements/timers.toml)."""

import fnmatch
import functools
import pathlib
import tomllib

from .. import names as known_names

STATEMENTS = pathlib.Path(__file__).parent / "statements"
FOUR = ("paper's schedule", "grouped schedule", "gProximity", "tiled")  # everything resident
PUBLISHED = ("chunked published", "gProximity published")


@functools.cache
def names():
    with open(STATEMENTS / "names.toml", "rb") as file:
        return tomllib.load(file)


@functools.cache
def timers():
    """{quantity: its timers in the release, columns of the paper, and the same thing in our records}."""
    with open(STATEMENTS / "timers.toml", "rb") as file:
        return tomllib.load(file)


def columns_of(table):
    """{quantity: its column} of a table of the paper."""
    found = {name: timer["columns"].get(str(table)) for name, timer in timers().items()}
    return {name: column for name, column in found.items() if column}


def name_of(case):
    """The name of a case's method, such as "paper's schedule"."""
    return known_names.method(case.algorithm, case.preset)


def _is_of(key, scene):
    """Whether the key of a scene, or of a recording of it, is that of a scene of names.toml."""
    return fnmatch.fnmatch(key.rpartition(",of=")[2], names()["scenes"][scene])


def _settings(case):
    """Settings as asked for. Records from before setting copies name the rule of descent `unlike`
    `larger`."""
    settings = case.cells[0].asked
    is_older = "copies" not in case.settings and settings.get("descent") == "larger"
    return settings | {"descent": "unlike"} if is_older else settings


def _has(own, wanted):
    return all(str(own.get(name)) == value for name, value in wanted.items())


def found(folder, step, scene, wanted):
    """The first case of a step with that scene, algorithm, preset, back end, device and settings; None if
    there is none."""
    for case in folder.cases(step):
        own = {
            **_settings(case),
            "algorithm": case.algorithm,
            "preset": case.preset,
            "backend": case.device["id"].partition(":")[0],
            "device": case.device["name"],
        }
        if _is_of(case.cells[0].scene, scene) and _has(own, wanted):
            return case
    return None


def fits(profile, scene, wanted):
    """Whether a record of 'tandem profile' is of that scene, algorithm, preset and settings."""
    own = {**profile["settings"], "algorithm": profile["algorithm"], "preset": profile["preset"]}
    return _is_of(profile["scene"]["key"], scene) and _has(own, wanted)


def four(folder, scene, k, steps):
    """{name: case or None} of the four methods on a scene, from the one of these steps that has the most of
    them."""
    cells = names()["cells"]
    choices = [{name: found(folder, step, scene, {"k": k, **cells[name]}) for name in FOUR} for step in steps]
    return max(choices, key=lambda choice: sum(case is not None for case in choice.values()))


def four_of_scenes(folder, values_of_k):
    """(scene, k, cases of four()) of every scene: of the frames of the paper's tables, and of later ones
    where bodies are in contact."""
    for scene in names()["groups"]["seven"]:
        for steps in (("schedules", f"resident-{scene}", f"cells-{scene}"), (f"jammed-{scene}",)):
            for k in values_of_k:
                yield scene, k, four(folder, scene, k, steps)
