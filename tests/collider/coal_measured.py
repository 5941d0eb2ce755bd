# SPDX-License-Identifier: MIT
"""coal_measured.py IN.npz OUT.npz: the signed distances of pairs of tetrahedra `a` and `b`, (n, 4, 3), and the closest points of
both, by Coal."""

import sys

import coal
import numpy

FACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))


def solid(corners):
    points, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for corner in corners:
        points.append(corner)
    for face in FACES:
        faces.append(coal.Triangle(*face))
    return coal.Convex(points, faces)


def main(source, target):
    pairs = numpy.load(source)
    request, place = coal.DistanceRequest(), coal.Transform3s()
    request.enable_signed_distance = True
    request.gjk_tolerance = 1e-12
    rows = []
    for a, b in zip(pairs["a"], pairs["b"]):
        result = coal.DistanceResult()
        distance = coal.distance(solid(a), place, solid(b), place, request, result)
        rows.append([distance, *result.getNearestPoint1(), *result.getNearestPoint2()])
    rows = numpy.array(rows)
    numpy.savez(target, distances=rows[:, 0], points_a=rows[:, 1:4], points_b=rows[:, 4:])


main(*sys.argv[1:])
