# SPDX-License-Identifier: MIT
"""The measures of cells that claims declare, and how a claim names its cells. A measure takes the fields of a
claim and a scene, and returns a Measured, or raises NotMeasured. step_measures.py has those of simulations,
scene_measures.py those of meshes, profiles and the paper's own numbers."""

import json
import math

from ..cell import BOUNDS
from ..fields import at
from . import composed
from .folder import SCENES
from .methods import found, names
from .quantities import OF_SCENES, NotMeasured, check_queues, count_of, frame_range
from .ratios import ratio_of
from .rules import Measured, exact

SELECTS_NOT = ("quantity", "cell", "step", "scene", "parts")
MIN_RANGE = 4  # smallest ratio of the most to the fewest contacts for which times are compared with them


class Declared:
    """A claim's fields, and what they stand for."""

    def __init__(self, fields):
        self.fields = fields

    def steps(self, side, scene):
        steps = side.get("step") or self.fields.get("step") or ["cells-{scene}"]
        place = scene.replace(" ", "-")
        return [step.replace("{scene}", place) for step in ([steps] if isinstance(steps, str) else steps)]

    def wanted(self, side, k, usual=None):
        """What a cell has to have: algorithm, preset and settings. usual: the name of a cell for sides
        without one."""
        name = side.get("cell", usual)
        return {
            "k": k,
            **(names()["cells"][name] if name else {}),
            **{key: value for key, value in side.items() if key not in SELECTS_NOT},
        }

    def _first(self, folder, sides, scene, k, usual):
        """The cells of all sides, from the first step that has them all; None if there is none."""
        choices = [self.steps(side, scene) for side in sides]
        for number in range(max(map(len, choices))):
            cells = [
                found(
                    folder,
                    steps[min(number, len(steps) - 1)],
                    side.get("scene", scene),
                    self.wanted(side, k, usual),
                )
                for side, steps in zip(sides, choices)
            ]
            if all(cells):
                return cells
        return None

    def cells(self, folder, sides, scene, k):
        """The cells of all sides. Raises NotMeasured."""
        for usual in self.fields.get("either", [None]):
            cells = self._first(folder, sides, scene, k, usual)
            if cells:
                self._check(cells)
                return cells
        raise NotMeasured(self.fields.get("without", "no records of the cells that this claim compares"))

    def _check(self, cells):
        first, last = self.fields.get("covers", (math.inf, -math.inf))
        for cell in cells:
            if cell.first > first or cell.last < last:
                raise NotMeasured(
                    f"measured in frames {cell.first} to {cell.last}; the paper's 500 steps need {first} to {last}"
                )
            if self.fields.get("queues") == "whole":
                check_queues(cell.cells[0])

    def simulation(self, folder, scene):
        names = (
            self.fields["simulation"]
            if isinstance(self.fields["simulation"], list)
            else [self.fields["simulation"]]
        )
        run = next(filter(None, (folder.simulation(name.replace("{scene}", scene)) for name in names)), None)
        if run is None:
            raise NotMeasured("no such simulation has completed")
        first, last = self.fields.get("covers", (math.inf, -math.inf))
        if self.fields["measure"] != "composed_step" and (
            run.steps[0]["step"] > first or run.steps[-1]["step"] < last
        ):
            raise NotMeasured(f"simulated in {len(run.steps)} steps; the paper's are {last + 1}")
        return run


def ratio(claim, folder, scene, k):
    above, below = claim.fields["above"], claim.fields["below"]
    first, second = claim.cells(folder, (above, below), scene, k)
    return ratio_of(first, above["quantity"], second, below["quantity"])


def backends(claim, folder, scene, k):
    """A ratio of two methods with OpenCL over the same ratio with CUDA, on one device. The ends of the
    interval are those of the two ratios, which holds however they depend on each other."""
    sides = (claim.fields["above"], claim.fields["below"])

    def ratio_with(backend, **more):
        other, own = claim.cells(folder, [{**side, "backend": backend, **more} for side in sides], scene, k)
        return ratio_of(other, sides[0]["quantity"], own, sides[1]["quantity"]), own.device["name"]

    cuda, name = ratio_with("cuda")
    opencl, _ = ratio_with("opencl", device=name)
    return Measured(
        opencl.value / cuda.value,
        opencl.low / cuda.high,
        opencl.high / cuda.low,
        min(opencl.samples, cuda.samples),
        opencl.disturbed + cuda.disturbed,
        opencl.basis,
        opencl.frames,
        (*opencl.records, *cuda.records),
    )


def count(claim, folder, scene, k):
    side = claim.fields["above"]
    [cell] = claim.cells(folder, (side,), scene, k)
    counts = [count_of(own, side["quantity"], frame_range(own)) for own in cell.cells]
    return exact(
        counts[0] if side["quantity"] in OF_SCENES else sum(counts),
        cell.locations[:1],
        f"{cell.frames} of {cell.first}:{cell.last}",
    )


def _arrays(claim, folder):
    """The cells with a whole queue array, one of each step that has it: those with the largest array."""
    side = claim.fields["array"]
    preset = claim.wanted(side, "8")["preset"]
    cells = [
        case
        for step in side["step"]
        for case in folder.cases(step)
        if case.algorithm == "gproximity" and case.preset == preset
    ]
    if not cells:
        raise NotMeasured(claim.fields.get("without", "no record with the release's whole queue array"))
    size = lambda case: (
        math.inf if case.settings["queue_bytes"] == "device" else int(case.settings["queue_bytes"])
    )
    return [case for case in cells if size(case) == max(map(size, cells))]


def composed_ratio(claim, folder, scene, k):
    above, below = claim.fields["above"], claim.fields["below"]
    other, own = claim.cells(folder, (above, below), scene, k)
    return composed.ratio_with_array(other, above["quantity"], own, below["quantity"], _arrays(claim, folder))


def composed_total(claim, folder, scene, k):
    """Whole steps: the same with the other parts of the simulation that found these contacts."""
    above, below = claim.fields["above"], claim.fields["below"]
    other, own = claim.cells(folder, (above, below), scene, k)
    rest = composed.Rest(claim.simulation(folder, scene), own, below["parts"])
    return composed.ratio_with_array(
        other, above["quantity"], own, below["quantity"], _arrays(claim, folder), rest
    )


def composed_share(claim, folder, scene, k):
    above, below = claim.fields["above"], claim.fields["below"]
    [other] = claim.cells(folder, (above,), scene, k)
    return composed.share_with_array(other, above["quantity"], below["quantity"], _arrays(claim, folder))


def composed_step(claim, folder, scene, k):
    above, below = claim.fields["above"], claim.fields["below"]
    [cell] = claim.cells(folder, (above,), scene, k)
    return composed.step_share(
        cell, above["quantity"], claim.simulation(folder, scene), above["parts"], below["parts"]
    )


def digests(claim, folder, scene, k):
    """Groups of cells with equal frames and bounds, of at least two algorithms and with pairs: the share with
    equal digests."""
    groups = {}
    for step in [f"{kind}-{name}" for name in SCENES for kind in ("cells", "resident")]:
        for cell in [cell for case in folder.cases(step) for cell in case.cells]:
            digest = at(cell.record, "agreement", "digest")
            if digest and digest["count"]:
                own = cell.settings
                # Boxes of spheres may leave out pairs of bodies that other broad phases keep.
                bounds = [
                    *(
                        str(own.get(name, usual))
                        for name, usual in BOUNDS.items()
                        if name not in ("origin", "output")
                    ),
                    own.get("broad") == "sphere_boxes",
                ]
                group = groups.setdefault((cell.scene_digest, frame_range(cell), *bounds), {})
                group.setdefault(cell.algorithm, set()).add(json.dumps(digest))
    compared = [group for group in groups.values() if len(group) > 1]
    if not compared:
        raise NotMeasured("no two algorithms have digests of the same frames and bounds, with pairs")
    equal = sum(len(set.union(*group.values())) == 1 for group in compared)
    return exact(equal / len(compared), frames=f"{len(compared)} groups")


def over_fastest(claim, folder, scene, k):
    """A quantity of a cell over that of the fastest of others, which differ in one setting (`among`)."""
    own, quantity = claim.fields["above"], claim.fields["above"]["quantity"]
    [(name, values)] = claim.fields["among"].items()
    found_ratios = []
    for value in values:
        try:
            first, second = claim.cells(folder, (own, {**own, name: value}), scene, k)
        except NotMeasured:
            continue
        found_ratios.append(ratio_of(first, quantity, second, quantity))
    if not found_ratios:
        raise NotMeasured(claim.fields.get("without", f"no records with other values of {name}"))
    return max(found_ratios, key=lambda measured: measured.value)


MEASURES = (
    ratio,
    backends,
    count,
    composed_ratio,
    composed_total,
    composed_share,
    composed_step,
    digests,
    over_fastest,
)
