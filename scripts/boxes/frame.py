# SPDX-License-Identifier: MIT
"""A frame of a scene as boxes: those of its tetrahedra, as the program has them at k = 6 in float."""

import collections
import json

import numpy

from boxes import vtu
from boxes.errors import BadData
from boxes.program import output


class Frame(collections.namedtuple("Frame", "points tetrahedra bodies")):
    """points: in the world, in float; tetrahedra: numbers of points, those of a body in sequence; bodies: of the
    tetrahedra, 0, ..., 0, 1, ... without a gap."""

    def boxes(self):
        corners = self.points[self.tetrahedra]
        return corners.min(1), corners.max(1)

    def write_boxes(self, boxes, bodies):
        """Writes the files that a peer gets: six little-endian floats for each box, and its body as uint32."""
        numpy.concatenate(self.boxes(), axis=1).astype("<f4").tofile(boxes)
        self.bodies.astype("<u4").tofile(bodies)

    def write_scene(self, folder):
        """A scene with the same boxes, bit for bit: each body is a mesh of its own, whose coordinates are those of the
        world, and stands still at the identity. Returns its file."""
        names = []
        for body, first in zip(*numpy.unique(self.bodies, return_index=True)):
            mine = self.tetrahedra[first : numpy.searchsorted(self.bodies, body, "right")]
            begin = mine.min()
            names.append(f"{body}.vtu")
            vtu.write_mesh(folder / names[-1], self.points[begin : mine.max() + 1], mine - begin)
        scene = {
            "meshes": {name: {"file": name} for name in names},
            "bodies": [{"mesh": name} for name in names],
        }
        path = folder / "frame.json"
        path.write_text(json.dumps(scene), encoding="ascii")
        return path


def exported(program, scene, number, folder):
    """The frame of this number of a scene. Raises BadData."""
    output(program, "export", scene, "--frames", f"{number}:{number}", "--vtu", folder)
    arrays = vtu.arrays(folder / f"bodies_{number:06}.vtu")
    if not len(arrays["body"]):
        raise BadData(f"{scene}: has no tetrahedron")
    bodies = numpy.unique(arrays["body"], return_inverse=True)[1]
    return Frame(arrays["Points"].reshape(-1, 3), arrays["connectivity"].reshape(-1, 4), bodies)
