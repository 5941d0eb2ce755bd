# SPDX-License-Identifier: MIT
"""Reads triangle meshes from PLY files: ASCII and binary of both byte orders, also compressed by xz."""

import lzma
import pathlib

import numpy

from boxes.errors import BadData

TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}


def contents(path):
    """The bytes of a file, decompressed if its name ends in .xz. Raises BadData."""
    try:
        data = pathlib.Path(path).read_bytes()
        return lzma.decompress(data) if str(path).endswith(".xz") else data
    except OSError as error:
        raise BadData(f"{path}: {error.strerror}") from None
    except (lzma.LZMAError, EOFError) as error:
        raise BadData(f"{path}: is no complete .xz file ({error})") from None


def header(path, data):
    """(byte order, elements, the bytes after the header). An element is (name, count, properties), and a
    property is (name, type, type of the number of values or None)."""
    end = data.find(b"end_header")
    if not data.startswith(b"ply") or end < 0:
        raise BadData(f"{path}: is no PLY file")
    order, elements = None, []
    try:
        for words in map(str.split, data[:end].decode("ascii").splitlines()[1:]):
            if words[:1] == ["format"]:
                order = ORDERS[words[1]]
            elif words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                elements[-1][2].append((words[4], TYPES[words[3]], TYPES[words[2]]))
            elif words[:1] == ["property"]:
                elements[-1][2].append((words[2], TYPES[words[1]], None))
        if order is None or any(count < 0 for _, count, _ in elements):
            raise ValueError
    except (KeyError, IndexError, ValueError):
        raise BadData(f"{path}: has no valid PLY header") from None
    return order, elements, data[data.find(b"\n", end) + 1 :]


def fields(properties, order):
    """The numbers of an element whose lists have three values each, as fields of a row; in ASCII files all
    are doubles."""
    number = lambda kind: order + kind if order else "f8"
    row = []
    for i, (_, kind, counted) in enumerate(properties):
        row += [(f"count {i}", number(counted))] if counted else []
        row.append((f"value {i}", number(kind), (3,) if counted else ()))
    return numpy.dtype(row)


def triangles_only(path, rows, element):
    for i, (_, _, counted) in enumerate(element[2]):
        if counted and (wrong := numpy.flatnonzero(rows[f"count {i}"] != 3)).size:
            raise BadData(
                f"{path}: {element[0]} {wrong[0]} has {rows[f'count {i}'][wrong[0]]:.0f} vertices; only triangles are read"
            )


def tables(path):
    """Rows of numbers of each element up to the faces, by its name, with its properties."""
    order, elements, data = header(path, contents(path))
    if not order:
        try:
            data = numpy.array(data.split(), "f8").tobytes()
        except ValueError:
            raise BadData(f"{path}: has a word that is no number") from None
    found, begin = {}, 0
    for element in elements:
        name, count, properties = element
        kind = fields(properties, order)
        whole = min(count, (len(data) - begin) // max(kind.itemsize, 1))
        rows = numpy.frombuffer(data, kind, whole, begin)
        triangles_only(path, rows, element)
        if whole < count:
            raise BadData(f"{path}: has {whole} of {count} rows of element {name}; the file is truncated")
        found[name] = rows, properties
        begin += count * kind.itemsize
        if name == "face":
            break
    return found


def read(path):
    """(vertices, triangles) of a file: doubles of shape (n, 3) and vertex numbers of shape (m, 3). Raises
    BadData."""
    found = tables(path)
    if not {"vertex", "face"} <= set(found):
        raise BadData(f"{path}: has no elements vertex and face")
    rows, properties = found["vertex"]
    place = {name: f"value {i}" for i, (name, _, counted) in enumerate(properties) if not counted}
    if not {"x", "y", "z"} <= set(place):
        raise BadData(f"{path}: vertices have no x, y, z")
    vertices = numpy.stack([rows[place[axis]].astype("f8") for axis in "xyz"], axis=1)
    rows, properties = found["face"]
    lists = [
        f"value {i}"
        for i, (name, _, counted) in enumerate(properties)
        if counted and name in ("vertex_indices", "vertex_index")
    ]
    if not lists:
        raise BadData(f"{path}: faces have no list vertex_indices")
    faces = rows[lists[0]].astype("i8")
    if not len(vertices) or not len(faces):
        raise BadData(f"{path}: has no vertex or no face")
    if not numpy.isfinite(vertices).all():
        raise BadData(f"{path}: has a coordinate that is not finite")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise BadData(f"{path}: a face has a vertex that is not in the file")
    return vertices, faces
