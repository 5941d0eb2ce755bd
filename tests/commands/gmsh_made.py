# SPDX-License-Identifier: MIT
"""made.py FOLDER: writes meshes of Gmsh in its formats, and FOLDER/expected.json: for each file what Gmsh
says is in it. Runs under a Python that has the package gmsh."""

import json
import pathlib
import sys

import gmsh

TETRAHEDRA = {4: 1, 11: 2, 29: 3}  # Gmsh's element types, with their orders
OTHER_CELLS = (5, 6, 7, 12, 13, 14, 17, 18, 19)  # hexahedra, prisms and pyramids of orders 1 and 2
FORMATS = [  # suffix, options
    *(
        (".msh", {"Mesh.MshFileVersion": version, "Mesh.Binary": binary})
        for version, binary in ((1, 0), (2.2, 0), (2.2, 1), (4, 0), (4.1, 0), (4.1, 1))
    ),
    *((".vtk", {"Mesh.Binary": binary}) for binary in (0, 1)),
    *(
        (suffix, {"Mesh.Binary": 0})
        for suffix in (".mesh", ".unv", ".inp", ".su2", ".cgns", ".med", ".bdf", ".key")
    ),
]


def sphere(size=0.35):
    gmsh.model.occ.addSphere(0, 0, 0, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(3)


def of_order(order):
    sphere(0.6)
    gmsh.model.mesh.setOrder(order)


def in_two_groups():
    """Two boxes with a common face; one box is in both groups."""
    first, second = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1), gmsh.model.occ.addBox(1, 0, 0, 1, 1, 1)
    gmsh.model.occ.fragment([(3, first)], [(3, second)])
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.6)
    gmsh.model.addPhysicalGroup(3, [1, 2], 7, "both boxes")
    gmsh.model.addPhysicalGroup(3, [2], 9, 'the second "box"')
    gmsh.model.mesh.generate(3)


def in_parts():
    sphere(0.5)
    gmsh.option.setNumber("Mesh.PartitionCreateGhostCells", 1)
    gmsh.model.mesh.partition(3)


def mixed():
    """Tetrahedra in a box on layers of prisms."""
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    top = next(
        tag for dim, tag in gmsh.model.getEntities(2) if gmsh.model.occ.getCenterOfMass(dim, tag)[2] > 0.99
    )
    gmsh.model.occ.extrude([(2, top)], 0, 0, 0.5, [2], recombine=True)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)


def with_large_tags():
    """Numbers of nodes and elements with gaps, up to two billion."""
    sphere(0.6)
    nodes, elements = (
        gmsh.model.mesh.getNodes()[0],
        [tag for tags in gmsh.model.mesh.getElements()[1] for tag in tags],
    )
    gmsh.model.mesh.renumberNodes(list(nodes), [2_000_000_000 - 7 * int(tag) for tag in nodes])
    gmsh.model.mesh.renumberElements(elements, [1_900_000_000 - 3 * int(tag) for tag in elements])


CONTENTS = {
    "sphere": sphere,
    "order2": lambda: of_order(2),
    "order3": lambda: of_order(3),
    "two_groups": in_two_groups,
    "parts": in_parts,
    "mixed": mixed,
    "large_tags": with_large_tags,
}


def expected(suffix, options):
    """Elements of a file of the current model. Old versions of MSH repeat an element for each of its groups.
    Some formats also have ghost elements, which other parts have too. Gmsh writes no prisms to .mesh."""
    counts = {"tetrahedra": 0, "duplicates": 0, "reduced": 0, "other_cells": 0}
    repeats = suffix == ".msh" and options["Mesh.MshFileVersion"] < 4
    for dim, tag in gmsh.model.getEntities(3):
        is_ghost = gmsh.model.getType(dim, tag) == "Ghost volume"
        if is_ghost and suffix not in (".vtk", ".mesh", ".inp"):
            continue
        groups = len(gmsh.model.getPhysicalGroupsForEntity(dim, tag)) if repeats else 1
        for kind, elements in zip(*gmsh.model.mesh.getElements(dim, tag)[:2]):
            times = len(elements) * max(1, groups)
            if kind in TETRAHEDRA:
                counts["tetrahedra"] += times
                counts["duplicates"] += times - (0 if is_ghost else len(elements))
                counts["reduced"] += times if TETRAHEDRA[kind] > 1 else 0
            elif kind in OTHER_CELLS and suffix != ".mesh":
                counts["other_cells"] += times
    return counts


def main(folder):
    found = {}
    for content, make in CONTENTS.items():
        gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        make()
        for number, (suffix, options) in enumerate(FORMATS):
            for name, value in options.items():
                gmsh.option.setNumber(name, value)
            path = folder / f"{content}{number}{suffix}"
            gmsh.write(str(path))
            if path.exists():
                found[path.name] = expected(suffix, options) | {"content": content}
        gmsh.finalize()
    (folder / "expected.json").write_text(json.dumps({"gmsh": gmsh.__version__, "files": found}))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
