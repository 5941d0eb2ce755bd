# SPDX-License-Identifier: MIT
"""The names of methods and scenes of statements/names.toml, and the cells that they stand for."""

import fnmatch
import functools
import pathlib
import tomllib

STATEMENTS = pathlib.Path(__file__).parent / "statements"
FOUR = ("paper's schedule", "ours, grouped", "gProximity", "tiled")  # everything resident
PUBLISHED = ("chunked published", "gProximity published")


@functools.cache
def names():
    with open(STATEMENTS / "names.toml", "rb") as file:
        return tomllib.load(file)


def name_of(case):
    """The name of a case's method, such as "paper's schedule", or its algorithm and preset."""
    for name, wanted in names()["cells"].items():
        if (wanted["algorithm"], wanted["preset"]) == (case.algorithm, case.preset):
            return name
    return f"{case.algorithm} {case.preset}".replace("gproximity", "gProximity")


def _origin(case):
    """The key of a case's scene, or of the scene that its recording comes from."""
    return case.cells[0].scene.rpartition(",of=")[2]


def found(folder, step, scene, wanted):
    """The first case of a step with that scene, algorithm, preset, back end, device and settings; None if
    there is none."""
    pattern = names()["scenes"][scene]
    for case in folder.cases(step):
        own = {
            **case.cells[0].asked,
            "algorithm": case.algorithm,
            "preset": case.preset,
            "backend": case.device["id"].partition(":")[0],
            "device": case.device["name"],
        }
        if fnmatch.fnmatch(_origin(case), pattern) and all(
            str(own.get(name)) == value for name, value in wanted.items()
        ):
            return case
    return None


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
