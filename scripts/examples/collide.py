#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""collide.py [MESH MESH] [--shift X,Y,Z] [--device D] [-o PICTURE]: collides two meshes and draws their
contacts.

Reads meshes with tetrahedra in the formats of tandem.read_mesh; `tandem convert` brings others to one.
Without meshes it uses two jacks of tandem's pile. Writes collide.png unless -o names another picture. Exit
code 2: bad use or bad input."""

import argparse
import sys


def fail(text):
    print(f"collide.py: {' '.join(str(text).split())}", file=sys.stderr)
    sys.exit(2)


try:
    import matplotlib
    import numpy
    import tandem

    tandem.Collider
except ImportError as error:
    fail(f"{error}; run `pip install .` in tandem's checkout")
matplotlib.use("agg")
from matplotlib import pyplot  # noqa: E402 (after the choice of the backend)


def draw(contacts, picture):
    """Draws contact points coloured by depth, and their normals."""
    axes = pyplot.figure(figsize=(7, 6)).add_subplot(projection="3d")
    points = axes.scatter(*contacts.points.T, c=contacts.depths, s=6, cmap="viridis")
    span = numpy.ptp(contacts.points, axis=0).max() or 1.0
    axes.quiver(*contacts.points.T, *contacts.normals.T, length=0.08 * span, linewidth=0.4, color="grey")
    axes.set(xlabel="x", ylabel="y", zlabel="z", title=f"{len(contacts.points)} contacts")
    axes.figure.colorbar(points, label="depth (< 0: inside)")
    axes.figure.savefig(picture, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[2].partition("\n")[0])
    parser.add_argument("mesh", nargs="*", help="two mesh files")
    parser.add_argument(
        "--shift",
        help="translation of the second mesh, x,y,z in the meshes' unit; default: a fifth of the first mesh's length along x",
    )
    parser.add_argument("--device", default="host", help="as tandem.devices() lists them")
    parser.add_argument("-o", "--output", default="collide.png", help="the picture")
    given = parser.parse_args()
    if len(given.mesh) not in (0, 2):
        fail("give two meshes, or none")
    try:
        meshes = [tandem.read_mesh(path) for path in given.mesh] or tandem.make_scene("pile:bodies=2").meshes[
            :1
        ] * 2
        meshes = [tandem.make_mesh(*mesh) if isinstance(mesh, tuple) else mesh for mesh in meshes]
        shift = (
            [float(text) for text in given.shift.split(",")]
            if given.shift
            else [0.2 * numpy.ptp(meshes[0].vertices[:, 0]), 0, 0]
        )
        collider = tandem.Collider(meshes, algorithm="tiled", device=given.device)
        answer = collider.run([[0, 0, 0, 1, 0, 0, 0], [*shift, 1, 0, 0, 0]])
    except (Exception, SystemExit) as error:  # meshio ends the program if it cannot read a file
        fail(error)
    contacts = answer.contacts()
    print(
        f"{answer.count} candidate pairs, {len(contacts.points)} contacts, {1e3 * answer.seconds:.2f} ms on {given.device}"
    )
    if len(contacts.points) == 0:
        print("no contacts to draw")
        return
    print(
        f"deepest: {contacts.depths.min():.4g} at {contacts.points[contacts.depths.argmin()].round(4).tolist()}"
    )
    draw(contacts, given.output)
    print(f"drawn: {given.output}")


if __name__ == "__main__":
    main()
