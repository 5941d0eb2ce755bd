#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""surfaces.py [BODIES [MODULUS [DEVICE]]]: contact surfaces of the compliant bodies of a pile, and the force and torque
of each pair of bodies. The two are made of the same polygons: forces must agree."""

import sys

import numpy

import tandem


def main(bodies=8, modulus=1e7, device="host"):
    scene = tandem.make_scene(f"pile:bodies={bodies},refine=1", pressure=modulus)
    given = {"bodies": scene.bodies, "device": device, "precision": "double"}
    surfaces = tandem.Collider(scene.meshes, contact_rule="pressure", **given)
    sums = tandem.Collider(scene.meshes, output="wrenches", **given)
    poses = scene.poses(0)
    found = surfaces.run(poses).surfaces(corners=True)
    wrenches = sums.run(poses).wrenches()
    print(f"{len(found.pairs)} polygons with {len(found.corners)} corners on {device}")
    forces = found.normals * (found.areas * found.pressures)[:, None]
    for (a, b), force, torque, area in zip(*wrenches[:4]):
        own = (found.pairs[:, 0] == a) & (found.pairs[:, 2] == b)
        if numpy.abs(forces[own].sum(axis=0) - force).max() > 1e-9 * modulus * area:
            raise ValueError(f"bodies {a} and {b}: the sum is not that of the polygons")
        print(
            f"  bodies {a} and {b}: area {area:.4f}, force on {a} {force.round(1)}, torque {torque.round(1)}"
        )


if __name__ == "__main__":
    try:
        main(*(kind(text) for kind, text in zip((int, float, str), sys.argv[1:])))
    except ValueError as error:
        sys.exit(f"surfaces.py: {error}")
