# SPDX-License-Identifier: MIT
"""Files .vtu: writes tetrahedra, and reads what the program exports."""

import base64
import xml.etree.ElementTree
import zlib

import numpy

# A tetrahedron of these corners (0: lo, 1: hi) has exactly the box as its bounds along x, y and z, and a
# volume.
CORNERS = numpy.array([[0, 0, 0], [1, 1, 0], [0, 1, 1], [1, 0, 1]])


def write(path, boxes):
    """One tetrahedron for each box, in the same order."""
    lo, hi = boxes
    points = numpy.where(CORNERS, hi[:, None], lo[:, None]).reshape(-1, 3)
    write_mesh(path, points, numpy.arange(len(points)).reshape(-1, 4))


def write_mesh(path, points, tetrahedra):
    """Coordinates are written as doubles."""
    count = len(tetrahedra)
    arrays = [
        ("Points", 'Float64" NumberOfComponents="3', points.astype("<f8")),
        ("connectivity", "Int64", tetrahedra.astype("<i8")),
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
            f'<UnstructuredGrid><Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n<Points>{tags[0]}</Points>\n'
            f'<Cells>{"".join(tags[1:])}</Cells>\n</Piece></UnstructuredGrid>\n<AppendedData encoding="raw">_'.encode()
        )
        for _, _, values in arrays:
            out.write(numpy.uint64(values.nbytes).astype("<u8").tobytes() + values.tobytes())
        out.write(b"</AppendedData></VTKFile>\n")


def inflated(text):
    """Bytes of an array by base64: a head with the number of blocks, their size, that of the last one and their sizes
    when compressed, then the blocks (https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html)."""
    count = int(numpy.frombuffer(base64.b64decode(text[:12])[:8], "<u8")[0])
    head = 4 * -(-8 * (3 + count) // 3)
    sizes = numpy.frombuffer(base64.b64decode(text[:head]), "<u8")[3 : 3 + count]
    blocks, ends = base64.b64decode(text[head:]), numpy.cumsum(sizes)
    return b"".join(zlib.decompress(blocks[end - size : end]) for size, end in zip(sizes, ends))


def arrays(path):
    """The arrays of a file of the program, flat, by their names."""
    kinds = {"Float32": "<f4", "Float64": "<f8", "Int64": "<i8", "UInt32": "<u4", "UInt8": "u1"}
    return {
        one.get("Name"): numpy.frombuffer(inflated(one.text.strip()), kinds[one.get("type")])
        for one in xml.etree.ElementTree.parse(path).iter("DataArray")
    }
