# SPDX-License-Identifier: MIT
"""The measures of exported meshes, of profiles, and of the paper's own numbers that claims declare."""

import math

import numpy

from ..cell import disturbed_rounds
from . import paper_numbers
from .folder import number, paper_table
from .methods import fits
from .pictures import chunks_of
from .quantities import NotMeasured
from .rules import Measured, exact

LEAST_CHUNKS = 8  # chunks whose median tells one order from another
FACES = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))  # vertices of the faces of a tetrahedron


def _exported(folder, order):
    found = chunks_of(folder, order)
    if found is None:
        raise NotMeasured("chunks have not been exported")
    return found


def chunks(claim, folder, scene, k):
    """A quantity of exported chunks of one order, over that of another."""

    def of(order):
        exported, quantity = _exported(folder, order), claim.fields["quantity"]
        count = int(exported.chunk.max()) + 1
        if quantity == "fatness" and count < LEAST_CHUNKS:
            raise NotMeasured(f"the mesh has {count} chunks, too few for a median")
        return getattr(exported, quantity)()

    below = claim.fields.get("below")
    value = of(claim.fields["above"]) / (of(below) if below else 1)
    return exact(value, [f"chunks-{order}.csv" for order in (claim.fields["above"], below) if order])


def boundary(claim, folder, scene, k):
    """Tetrahedra of the exported mesh over the faces of its surface, those of one tetrahedron only."""
    order = claim.fields["above"]
    corners = _exported(folder, order).corners
    vertices = numpy.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 4)
    faces = numpy.sort(numpy.concatenate([vertices[:, face] for face in FACES]), axis=1)
    times = numpy.unique(faces, axis=0, return_counts=True)[1]
    return exact(len(vertices) / int((times == 1).sum()), [f"chunks-{order}.csv"])


def chunks_by_equations(claim, folder, scene, k):
    """Chunks of a mesh by the paper's equations 1 to 4 as printed. `bytes` for chunks and `node_bytes`; the
    mesh has the mean number of tetrahedra of the scene's bodies in Table 1."""
    most = claim.fields["bytes"] // claim.fields["node_bytes"]
    perfect = 2 ** math.ceil(math.log2(most / 2)) - 1
    [row] = [row for row in paper_table(1) if row["scene"] == scene]
    tetrahedra = 1000 * number(row["tetrahedra_thousand"]) / number(row["bodies"])
    return exact(math.ceil(tetrahedra / ((perfect + 1) / 2)))


def paper_itself(claim, folder, scene, k):
    """The largest of the paper's own numbers."""
    return exact(max(paper_numbers.of_scene(claim.fields["paper"], scene).values()))


def at_the_ceiling(claim, folder, scene, k):
    """The least time of a kernel by the ceilings of the device, over its time in a profile."""
    wanted = claim.wanted(claim.fields["above"], k)
    step, entries = claim.fields["step"][0], claim.fields["kernels"]
    for line, record in folder.profiles(step):
        kernels = [kernel for kernel in record["kernels"] or [] if kernel["entry"] in entries]
        if fits(record, scene, wanted) and kernels:
            least = kernels[0]["floor"]["ns"]
            if least is None:
                raise NotMeasured("the profile has no ceilings for this kernel")
            times = kernels[0]["device_ns"]
            values = (least / times[end] for end in ("median", "high", "low"))
            frames, rounds = record["frames"], record["sampling"]["rounds"]
            left_out = len(disturbed_rounds(record))  # times of a profile are medians of all rounds
            place = f"records/{step}.jsonl:{line}"
            return Measured(
                *values,
                0 if left_out else rounds,
                left_out,
                "rounds",
                f"frames {frames['first']}:{frames['last']}",
                (place,),
            )
    raise NotMeasured("no profile of this kernel")


MEASURES = (chunks, boundary, chunks_by_equations, paper_itself, at_the_ceiling)
