# SPDX-License-Identifier: MIT
# test: cost=2
"""scripts/external on generated meshes, against all pairs tested one by one, on a
program that answers wrongly, and on invalid input; the counts of its page."""

import lzma
import math
import re
import struct

import numpy

from tests.program import PROGRAM, SOURCE
from tests.script_case import ScriptCase, loaded, rows_of, script

PAGE = SOURCE / "docs/user/external_counts.md"
CLOTH, RINGS, SECTORS = 10, 5, 8
# Runs the program with the same arguments, then replaces the rows of its dump by those of an expression.
WRONG = """#!/usr/bin/python3
import subprocess, sys
code = subprocess.run([{program!r}, *sys.argv[1:]]).returncode
if "--dump-pairs" in sys.argv:
    path = sys.argv[sys.argv.index("--dump-pairs") + 1]
    head, *rows = open(path).read().splitlines()
    open(path, "w").write("\\n".join([head, *{rows}]) + "\\n")
sys.exit(code)
"""


def cloth():
    """Vertices and triangles of a square of cloth, with heights that differ."""
    n = CLOTH + 1
    points = [
        (0.2 * i - 1, 0.9 + 0.05 * math.sin(3 * i + 5 * j), 0.2 * j - 1) for i in range(n) for j in range(n)
    ]
    corners = [i * n + j for i in range(CLOTH) for j in range(CLOTH)]
    return points, [face for c in corners for face in ((c, c + 1, c + n), (c + 1, c + n + 1, c + n))]


def ball():
    """Vertices and triangles of the side of a ball, some of whose coordinates are zero."""
    points, faces = [], []
    for r in range(RINGS):
        a = 1.4 * (2 * r / (RINGS - 1) - 1)
        height, turns = (
            math.sin(a) if r != RINGS // 2 else 0.0,
            [2 * math.pi * s / SECTORS for s in range(SECTORS)],
        )
        points += [(math.cos(t) * math.cos(a), height, math.sin(t) * math.cos(a)) for t in turns]
    for r in range(RINGS - 1):
        for s in range(SECTORS):
            a, b = r * SECTORS + s, r * SECTORS + (s + 1) % SECTORS
            faces += [(a, b, a + SECTORS), (b, b + SECTORS, a + SECTORS)]
    return points, faces


def frames():
    """Vertices of two frames in float, in which the cloth falls onto the resting ball, and the faces."""
    (above, threads), (below, sides) = cloth(), ball()
    first = numpy.array([*above, *below], "f4")
    second = first.copy()
    second[: len(above), 1] -= numpy.float32(0.3) + numpy.abs(first[: len(above), 0]) * numpy.float32(0.1)
    return first, second, [*threads, *[tuple(v + len(above) for v in face) for face in sides]]


def ply(path, vertices, faces, form="binary_little_endian", kind="double"):
    """A PLY file with a further property of vertices, compressed if its name ends in .xz."""
    head = (
        f"ply\nformat {form} 1.0\ncomment made up\nelement vertex {len(vertices)}\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n"
        f"property uchar red\nelement face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if form == "ascii":
        body = "".join("%r %r %r 7\n" % tuple(map(float, v)) for v in vertices) + "".join(
            f"{len(f)} {' '.join(map(str, f))}\n" for f in faces
        )
        body = body.encode()
    else:
        order = ">" if "big" in form else "<"
        row = struct.Struct(order + ("3d" if kind == "double" else "3f") + "B")
        body = b"".join(row.pack(*map(float, v), 7) for v in vertices) + b"".join(
            struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces
        )
    path.write_bytes(lzma.compress(head + body) if path.suffix == ".xz" else head + body)
    return path


def swept(first, second, elements):
    """Boxes (lo, hi) of elements, vertex by vertex."""
    lo, hi = [], []
    for element in elements:
        values = [
            (float(frame[v][axis]), axis) for v in element for frame in (first, second) for axis in range(3)
        ]
        lo.append([math.nextafter(min(x for x, a in values if a == axis), -math.inf) for axis in range(3)])
        hi.append([math.nextafter(max(x for x, a in values if a == axis), math.inf) for axis in range(3)])
    return numpy.array(lo), numpy.array(hi)


def overlaps(a, b):
    """Matrix of overlaps, touching included."""
    return ((a[0][:, None] <= b[1][None]) & (b[0][None] <= a[1][:, None])).all(2)


def counted(first, second, faces):
    """(all pairs, pairs without a common vertex) of vertices and faces, edges, faces."""
    edges = sorted(
        {tuple(sorted(pair)) for f in faces for pair in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))}
    )
    vertices = [(v,) for v in range(len(first))]
    found = {}
    for kind, a, b in (
        ("vertex-face", vertices, faces),
        ("edge-edge", edges, edges),
        ("face-face", faces, faces),
    ):
        pairs = [
            (i, j)
            for i, j in numpy.argwhere(overlaps(swept(first, second, a), swept(first, second, b)))
            if a is not b or i < j
        ]
        found[kind] = len(pairs), sum(not set(a[i]) & set(b[j]) for i, j in pairs)
    return found


class External(ScriptCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.first, cls.second, cls.faces = frames()
        cls.files = [
            ply(cls.work / f"{name}.ply", vertices, cls.faces)
            for name, vertices in (("a", cls.first), ("b", cls.second))
        ]
        cls.counts = counted(cls.first, cls.second, cls.faces)

    def run_script(self, *arguments, code=0, program=PROGRAM):
        """Output; the script must end with the code and without an error line."""
        status, text, errors = script("external", *arguments, "--program", program)
        self.assertEqual((status, errors), (code, []), text)
        return text

    def lines(self, text):
        """(who, all pairs, pairs without incident ones, verdict) of each line of counts, by kind of pairs."""
        found, kind = {}, None
        for line in text.splitlines():
            if not line.startswith("  "):
                kind = line.split()[1].rstrip(":")
            else:
                match = re.fullmatch(
                    r"  (.*?)(?:, [\d.]+ s with files)?: ([\d,]+) pairs, ([\d,]+) without incident ones: (.*)",
                    line,
                )
                found.setdefault(kind, []).append(
                    (match[1], *(int(n.replace(",", "")) for n in match.groups()[1:3]), match[4])
                )
        return found

    def wrong_program(self, rows):
        path = self.work / "wrong"
        path.write_text(WRONG.format(program=str(PROGRAM), rows=rows))
        path.chmod(0o755)
        return path

    def test_counts_equal_all_pairs_tested_one_by_one(self):
        kinds = ["vertex-face", "edge-edge", "face-face"]
        expect = ",".join(str(self.counts[kind][1]) for kind in kinds)
        options = f"--pairs {','.join(kinds)} --algorithm tiled,leaf_query --expect {expect}"
        text = self.run_script("-", *self.files, *options.split())
        found = self.lines(text)
        self.assertEqual(list(found), kinds)
        for kind in kinds:
            self.assertGreater(self.counts[kind][1], 100)
            self.assertEqual({line[1:] for line in found[kind]}, {(*self.counts[kind], "equal")}, text)
            by = [line[0] for line in found[kind]]
            self.assertEqual(by, ["sweep", "tiled on host", "leaf_query on host"])

    def test_every_kind_of_file(self):
        vertex_face = [
            ("sweep", *self.counts["vertex-face"], "equal"),
            ("tiled on host", *self.counts["vertex-face"], "equal"),
        ]
        for number, (form, kind, ending) in enumerate(
            (
                ("ascii", "double", ".ply"),
                ("binary_big_endian", "float", ".ply.xz"),
                ("binary_little_endian", "float", ".ply"),
            )
        ):
            files = [
                ply(self.work / f"{number}{name}{ending}", vertices, self.faces, form, kind)
                for name, vertices in (("a", self.first), ("b", self.second))
            ]
            text = self.run_script("none", *files, "--pairs", "vertex-face")
            self.assertEqual(self.lines(text), {"vertex-face": vertex_face}, form)
            self.assertIn(f"{len(self.first)} boxes of vertices and {len(self.faces)} boxes of faces", text)
            self.assertIn("no count is known", text)

    def test_scenes_are_kept(self):
        folder = self.work / "new/scenes"
        self.run_script("-", *self.files, "--scenes", folder, "--pairs", "vertex-face")
        self.assertEqual(sorted(path.name for path in folder.iterdir()), ["faces.vtu", "vertices.vtu"])

    def test_wrong_counts_and_pairs(self):
        rest = self.counts["vertex-face"][1]
        text = self.run_script("-", *self.files, "--pairs", "vertex-face", "--expect", rest + 1, code=1)
        self.assertEqual(
            {line[3] for line in self.lines(text)["vertex-face"]}, {f"DIFFERENT: expected: {rest + 1:,}"}
        )
        text = self.run_script("cloth-ball", *self.files, "--pairs", "vertex-face", code=1)
        self.assertIn("DIFFERENT: published: 1,655,541", text)
        for rows, expected in (
            ("rows[1:]", "1 pairs of the sweep are missing, 0 are additional"),
            ("[*rows, rows[0]]", "0 are additional, 1 are repeated"),
            ("['0,0,0,1,0', *rows]", "are additional"),
            ("[]", "incident pairs are missing"),
        ):
            text = self.run_script(
                "-", *self.files, "--pairs", "vertex-face", code=1, program=self.wrong_program(rows)
            )
            self.assertIn("equal", text.splitlines()[1])
            self.assertIn("DIFFERENT: ", text.splitlines()[2])
            self.assertIn(expected, text.splitlines()[2])

    def test_boxes_are_one_unit_larger(self):
        """Two triangles along x, so far apart that their boxes touch, and one unit in the last place more."""
        unit = math.ulp(1.0)
        for units, count in ((2, 3), (3, 0)):
            points = [(0, 0, 0), (1, 0, 0), (1, 1, 1), (1 + units * unit, 0, 0), (2, 1, 1), (2, 0, 1)]
            file = ply(self.work / "apart.ply", points, [(0, 1, 2), (3, 4, 5)])
            text = self.run_script("-", file, file, "--pairs", "vertex-face", "--expect", count)
            self.assertEqual(
                {line[1:] for line in self.lines(text)["vertex-face"]}, {(6 + count, count, "equal")}
            )

    def test_boxes(self):
        random = numpy.random.default_rng(1)
        sets = []
        for count in (300, 400):
            lo = random.random((count, 3)).astype("f4")
            sets.append((lo, lo + (random.random((count, 3)) * 0.2).astype("f4")))
        sets[0][0][0], sets[0][1][0] = sets[1][1][3], sets[1][1][3] + 1  # touches a corner
        sets[0][0][1], sets[0][1][1] = sets[1][0][4] - 1, sets[1][0][4]  # touches the opposite one
        sets[0][0][2] = (
            sets[1][0][5, 0] - 1,
            sets[1][1][5, 1],
            sets[1][0][5, 2],
        )  # touches above, and begins before
        sets[0][1][2] = sets[0][0][2] + 2
        sets[1][0][1], sets[1][1][1] = -5, 5  # contains all
        sets[1][1][2] = sets[1][0][2]  # is a point
        files = [self.work / f"{name}.bin" for name in "ab"]
        for file, (lo, hi) in zip(files, sets):
            file.write_bytes(numpy.concatenate([lo, hi], 1).astype("<f4").tobytes())
        between, within = overlaps(*sets).sum(), (overlaps(sets[1], sets[1]).sum() - 400) // 2
        found = self.lines(self.run_script("-", *files, "--boxes", "--expect", f"{between},{within}"))
        self.assertEqual(
            found["between"],
            [("sweep", between, between, "equal"), ("tiled on host", between, between, "equal")],
        )
        self.assertEqual(
            found["within"], [("sweep", within, within, "equal"), ("tiled on host", within, within, "equal")]
        )
        self.refused(
            "external", "has 10 bytes; expected 24", "-", self.bytes(b"0123456789"), files[1], "--boxes"
        )
        self.refused(
            "external",
            "box 1 is not finite, or has lo above hi",
            "-",
            self.bytes(struct.pack("<12f", *range(6), 1, 0, 0, 0, 0, 0)),
            files[1],
            "--boxes",
        )

    def bytes(self, data):
        path = self.work / "bad.ply"
        path.write_bytes(data)
        return path

    def test_invalid_input(self):
        good, (a, b) = self.files[0].read_bytes(), self.files
        quad = ply(self.work / "quad.ply", self.first, [*self.faces[:3], (0, 1, 2, 3), *self.faces[3:]])
        few = ply(self.work / "few.ply", self.first[:-1], self.faces[:10])
        other = ply(self.work / "other.ply", self.first, [*self.faces[:-1], (0, 1, 2)])
        packed = self.work / "cut.ply.xz"
        packed.write_bytes(lzma.compress(good)[:-50])
        infinite = self.first.copy()
        infinite[3, 1] = numpy.inf
        for expected, *files in (
            ("none.ply: No such file", self.work / "none.ply", b),
            ("quad.ply: face 3 has 4 vertices; only triangles are read", quad, b),
            (f"few.ply: has {len(self.first) - 1} vertices, but ", a, few),
            ("other.ply: has other faces than ", a, other),
            ("cut.ply.xz: is no complete .xz file", packed, b),
            ("not finite", ply(self.work / "infinite.ply", infinite, self.faces), b),
            (
                "has a vertex that is not in the file",
                ply(self.work / "beyond.ply", self.first, [(0, 1, 9999)]),
                b,
            ),
            ("has no vertex or no face", ply(self.work / "empty.ply", self.first, []), b),
        ):
            self.refused("external", expected, "-", *files)
        for data, expected in (
            (b"", "is no PLY file"),
            (good[:-7], "the file is truncated"),
            (good.replace(b"double", b"triple"), "has no valid PLY header"),
            (good.replace(b"vertex_indices", b"corners_______"), "faces have no list vertex_indices"),
            (good.replace(b" z\n", b" w\n"), "vertices have no x, y, z"),
            (good.replace(b"element face", b"element edge"), "has no elements vertex and face"),
            (
                b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\none\n",
                "has a word that is no number",
            ),
        ):
            self.refused("external", expected, "-", self.bytes(data), b)

    def test_bad_use(self):
        program = ("--program", PROGRAM)
        for expected, *arguments in (
            ("the following arguments are required: NAME, FILE",),
            ("unknown pairs 'within'", "-", *self.files, "--pairs", "within"),
            ("needs a count for each of --pairs", "-", *self.files, "--expect", "5"),
            ("needs a count for each", "-", *self.files, "--expect", "5,x"),
            ("build it by scripts/build", "-", *self.files, "--program", self.work / "none"),
            ("good.msh/a: Not a directory", "-", *self.files, "--scenes", self.good / "a"),
            ("tandem: ", "-", *self.files, "--pairs", "vertex-face", "--device", "nothing", *program),
        ):
            self.refused("external", expected, *arguments)
        failing = self.work / "failing"
        failing.write_text("#!/bin/sh\necho 'tandem: the device is gone' >&2\nexit 3\n")
        failing.chmod(0o755)
        self.refused("external", "the device is gone", "-", *self.files, "--program", failing, code=3)

    def test_counts_of_the_page(self):
        """The table of the page has the counts of the script."""
        external = loaded("external")
        known = {**external.PUBLISHED, **external.OURS}
        found, head = {"published": {}, "our": {}}, []
        for name, *cells in rows_of(PAGE.read_text()):
            if name in ("name", "data"):
                head = [cell.split() for cell in cells] if name == "name" else []
            for (origin, kind), cell in zip(head, cells):
                if re.fullmatch(r"[\d,]+", cell):
                    found[origin][name, kind] = int(cell.replace(",", ""))
        self.assertEqual(found, {"published": external.PUBLISHED, "our": known})
