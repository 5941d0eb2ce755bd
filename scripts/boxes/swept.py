# SPDX-License-Identifier: MIT
"""Swept boxes of the vertices, edges and faces of a triangle mesh between two frames, and pairs of them that
share a vertex."""

import numpy

from boxes.errors import BadData
from boxes.ply import read
from boxes.sweep import runs


def frames(first, second):
    """(vertices of both frames, faces). Raises BadData."""
    (a, faces), (b, other_faces) = read(first), read(second)
    if len(a) != len(b):
        raise BadData(f"{second}: has {len(b)} vertices, but {first} has {len(a)}")
    if not numpy.array_equal(faces, other_faces):
        raise BadData(f"{second}: has other faces than {first}")
    return (a, b), faces


def edges_of(faces):
    """The edges of triangles, each once: pairs of vertex numbers in ascending order."""
    return numpy.unique(
        numpy.sort(numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0
    )


def boxes_of(vertices):
    """Boxes of the motion of vertices, in double and enlarged by one unit in the last place on each side."""
    a, b = vertices
    return numpy.nextafter(numpy.minimum(a, b), -numpy.inf), numpy.nextafter(numpy.maximum(a, b), numpy.inf)


def boxes_around(boxes, elements):
    """Boxes of elements from the boxes of their vertices."""
    lo, hi = boxes
    return lo[elements].min(1), hi[elements].max(1)


def own_vertices(faces):
    """Keys of pairs of a vertex and a face that has it."""
    return numpy.unique(faces * len(faces) + numpy.arange(len(faces))[:, None])


def sharing(elements):
    """Keys of pairs i < j of elements that share a vertex."""
    vertex, element = elements.ravel(), numpy.repeat(numpy.arange(len(elements)), elements.shape[1])
    order = numpy.argsort(vertex, kind="stable")
    vertex, element = vertex[order], element[order]
    keys = [
        element[i] * len(elements) + element[j]
        for i, j in runs(numpy.arange(1, len(vertex) + 1), numpy.searchsorted(vertex, vertex, "right"))
    ]
    return numpy.unique(numpy.concatenate(keys))
