#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""distances.py [BODIES [MARGIN [DEVICE]]]: the least distance of each pair of bodies of a pile that are within the
margin, with the points of both, and how many pairs of tetrahedra that takes."""

import sys

import numpy

import tandem


def main(bodies=64, margin=0.02, device="host"):
    scene = tandem.make_scene(f"pile:bodies={bodies}")
    collider = tandem.Collider(
        scene.meshes, bodies=scene.bodies, device=device, margin=margin, output="distances"
    )
    answer = collider.run(scene.poses(0))
    found = answer.distances()
    print(
        f"{len(found.pairs)} pairs of bodies within {margin}, of {answer.count} candidate pairs on {device}"
    )
    apart = numpy.flatnonzero(found.distances > 0)
    print(f"{len(apart)} of them are apart; the closest:")
    for row in apart[numpy.argsort(found.distances[apart])][:5]:
        a, tet_a, b, tet_b = found.pairs[row]
        point, other = (numpy.round(points[row], 4) for points in (found.points_a, found.points_b))
        print(f"  bodies {a} and {b}: {found.distances[row]:.6f} from {point} to {other}")


if __name__ == "__main__":
    try:
        main(*(kind(text) for kind, text in zip((int, float, str), sys.argv[1:])))
    except ValueError as error:
        sys.exit(f"distances.py: {error}")
