# SPDX-License-Identifier: MIT
"""Writes boxes as tetrahedra of a .vtu file."""

import numpy

# A tetrahedron of these corners (0: lo, 1: hi) has exactly the box as its bounds along x, y and z, and a
# volume.
CORNERS = numpy.array([[0, 0, 0], [1, 1, 0], [0, 1, 1], [1, 0, 1]])


def write(path, boxes):
    """One tetrahedron for each box, in the same order; coordinates are doubles."""
    lo, hi = boxes
    count = len(lo)
    points = numpy.where(CORNERS, hi[:, None], lo[:, None]).astype("<f8")
    arrays = [
        ("Points", 'Float64" NumberOfComponents="3', points),
        ("connectivity", "Int64", numpy.arange(4 * count, dtype="<i8")),
        ("offsets", "Int64", numpy.arange(4, 4 * count + 1, 4, dtype="<i8")),
        ("types", "UInt8", numpy.full(count, 10, "u1")),
    ]
    tags, offset = [], 0
    for name, kind, values in arrays:
        tags.append(f'<DataArray Name="{name}" type="{kind}" format="appended" offset="{offset}"/>')
        offset += 8 + values.nbytes
    with open(path, "wb") as out:
        out.write(
            f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
            f'<UnstructuredGrid><Piece NumberOfPoints="{4 * count}" NumberOfCells="{count}">\n<Points>{tags[0]}</Points>\n'
            f'<Cells>{"".join(tags[1:])}</Cells>\n</Piece></UnstructuredGrid>\n<AppendedData encoding="raw">_'.encode()
        )
        for _, _, values in arrays:
            out.write(numpy.uint64(values.nbytes).astype("<u8").tobytes() + values.tobytes())
        out.write(b"</AppendedData></VTKFile>\n")
