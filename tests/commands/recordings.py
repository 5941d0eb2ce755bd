# SPDX-License-Identifier: MIT
# test: cost=5
"""Recordings and exports by the program. The test writes the recordings itself,
in the format of scenes/recording/README.md."""

import array
import base64
import csv
import json
import math
import os
import re
import struct
import xml.etree.ElementTree
import zlib

from tests.program import SOURCE, Case, bar, gmsh, tandem

PILE = "pile:bodies=4,frames=30"


def sealed(data, start=0):
    return data + struct.pack("<I", zlib.crc32(data, start))


def recording(key, digest, kinds, frames, version=1, stride=1):
    """The bytes of a recording of rigid (0) and fixed (1) bodies; frames are (time, [pose of each rigid
    body]). stride: steps from frame to frame."""
    text = key.encode()
    header = b"\x89TDMFR\r\n" + struct.pack(
        "<IIQdII", version, 44 + len(text) + 8 * len(kinds), digest, 0.01, len(kinds), len(text)
    )
    header += text + b"".join(struct.pack("<II", kind, 0) for kind in kinds)
    parts = [sealed(header)]
    for number, (time, poses) in enumerate(frames):
        body = struct.pack("<Qd", stride * number, time) + b"".join(
            struct.pack("<7f", *pose) for pose in poses
        )
        parts.append(sealed(body, zlib.crc32(struct.pack("<Q", number))))
    return b"".join(parts)


def turn_about_y(angle):
    return math.cos(angle / 2), 0, math.sin(angle / 2), 0


class Recordings(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        line = tandem(
            "run", PILE, "--profile", 1, "--device", "host", "--algorithm", "chunked", "--frames", "0"
        )[1].splitlines()[0]
        cls.key, digest = re.match(r"scene (\S+): .* digest ([0-9a-f]{16})$", line).groups()
        cls.digest = int(digest, 16)
        cls.frames = [
            (0.01 * i, [(0.1 * b + 0.01 * i, 0, 0, *turn_about_y(0.1 * i)) for b in range(4)])
            for i in range(10)
        ]
        cls.whole = recording(cls.key, cls.digest, [0] * 4, cls.frames)
        cls.size = 16 + 4 * 28 + 4

    def file(self, name, data):
        path = self.work / name
        path.write_bytes(data)
        return path

    def pairs_of_poses(self, poses):
        """Candidate pairs of the pile's bodies with the poses given on the command line in single precision."""
        for end in ("node", "ele"):
            (self.work / f"jack.{end}").write_bytes((SOURCE / f"scenes/meshes/jack.{end}").read_bytes())
        arguments = []
        for pose in poses:
            numbers = struct.unpack("<7f", struct.pack("<7f", *pose))
            arguments += ["--mesh", self.work / "jack.ele", "--pose", " ".join(map(repr, numbers))]
        out = self.work / "poses.jsonl"
        self.output(
            "run", *arguments, "--device", "host", "--repeat", 1, "--algorithm", "chunked", "--out", out
        )
        return self.records(out)[0]["work"]["candidate_pairs"][0]

    def test_a_recording_is_a_scene(self):
        file, out = self.file("four.frames", self.whole), self.work / "four.jsonl"
        self.output(f"run {file} --frames 2:5 --device host --repeat 1 --algorithm chunked --out {out}")
        record = self.records(out)[0]
        self.assertEqual(record["scene"]["name"], "four")
        self.assertRegex(
            record["scene"]["key"],
            r"^recording:four,frames=10,digest=[0-9a-f]{16},of=" + re.escape(self.key) + "$",
        )
        self.assertNotEqual(int(record["scene"]["digest"], 16), self.digest)
        self.assertTrue(all(count > 1000 for count in record["work"]["candidate_pairs"]))
        self.assertEqual(len(record["work"]["candidate_pairs"]), 4)
        self.assertEqual(record["work"]["candidate_pairs"][1], self.pairs_of_poses(self.frames[3][1]))
        self.output("check", file, "--frames", "3", "--device", "host", "--algorithm", "chunked")

    def test_records_have_the_steps_of_some_frames_of_a_simulation(self):
        """Null where frames have the numbers of their steps."""
        out = self.work / "steps.jsonl"
        some = recording(self.key, self.digest, [0] * 4, self.frames, stride=10)
        for name, data in (("whole.frames", self.whole), ("some.frames", some)):
            file = self.file(name, data)
            self.output(f"run {file} --frames 2:4 --device host --repeat 1 --algorithm tiled --out {out}")
        self.assertEqual([record["steps"] for record in self.records(out)], [None, [20, 30, 40]])

    def test_damage_is_reported(self):
        cut = self.file("cut.frames", self.whole[:-1])
        cell = "--profile 1 --device host --algorithm chunked"
        self.assertEqual(tandem(f"run {cut} {cell}")[0], 0)
        message = ["frames 3:9", f"{cut}: frame 9 is cut off; frames 0:8 are whole"]
        self.bad(message, f"run {cut} --frames 3:9")
        file = self.file("whole.frames", self.whole)
        message = ["frames 3:12", f"{file}: there is no frame 10; frames 0:9 are whole"]
        self.bad(message, f"check {file} --frames 3:12")
        flipped = bytearray(self.whole)
        flipped[-7 * self.size - 9] ^= 4
        file = self.file("flipped.frames", flipped)
        self.bad(f"{file}: frame 2 does not match its checksum", "run", file)
        self.bad(f"{file}: frame 2 does not match its checksum", "export", file, "--glb", self.work / "f.glb")
        self.assertEqual(tandem(f"run {file} --frames 3:9 {cell}")[0], 0)
        of = lambda text, digest=self.digest, kinds=(0,) * 4: recording(text, digest, kinds, self.frames)
        for name, data, message in (
            (
                "version",
                recording(self.key, self.digest, [0] * 4, [], 2),
                "version 2 of the format, this program reads version 1",
            ),
            ("digest", of(self.key, self.digest ^ 1), "was recorded from a scene with digest"),
            ("kinds", of(self.key, kinds=(0, 0, 1, 0)), "was recorded from a scene with digest"),
            ("text", of("pyle"), "cannot be made again: unknown scene 'pyle'"),
            ("gone", of("gone.json"), "gone.json: cannot be read"),
            ("itself", of("x.frames"), "is a recording itself"),
            ("elsewhere", of("/dev/zero.json"), "opens only files in its own folder"),
            ("above", of("../x.json"), "opens only files in its own folder"),
            ("mesh", of("pile:bodies=4,mesh=/dev/zero"), "its scene needs the file /dev/zero"),
            ("large", of("pile:bodies=10000000"), "has 4 bodies, but its scene has 10000000"),
            ("none", recording(self.key, self.digest, [0] * 4, []), "no frame is whole"),
            ("header", self.whole[:50], "is cut off in its header"),
            ("noise", b"frame,body_a\n0,1\n", "is not a recording of frames"),
        ):
            file = self.file(f"{name}.frames", data)
            self.bad([f"tandem: {file}: ", message], "run", file)
        self.bad("absent.frames: cannot be read (No such file", "run", self.work / "absent.frames")

    def test_export(self):
        file, folder, glb = self.file("out.frames", self.whole), self.work / "out", self.work / "out.glb"
        self.output("export", file, "--frames", "2:4", "--vtu", folder, "--glb", glb, "--contacts")
        names = sorted(os.listdir(folder))
        self.assertEqual(
            names,
            [
                "bodies.pvd",
                *(f"bodies_00000{i}.vtu" for i in (2, 3, 4)),
                "contacts.pvd",
                *(f"contacts_00000{i}.vtp" for i in (2, 3, 4)),
            ],
        )
        for name in names:
            xml.etree.ElementTree.parse(folder / name)
        sets = xml.etree.ElementTree.parse(folder / "bodies.pvd").getroot().findall("Collection/DataSet")
        self.assertEqual(
            [(float(s.get("timestep")), s.get("file")) for s in sets],
            [(0.01 * i, f"bodies_00000{i}.vtu") for i in (2, 3, 4)],
        )
        arrays = {
            a.get("Name") for a in xml.etree.ElementTree.parse(folder / "bodies_000002.vtu").iter("DataArray")
        }
        self.assertLessEqual({"body", "tetrahedron", "chunk"}, arrays)
        counted = sum(
            int(
                xml.etree.ElementTree.parse(folder / f"contacts_00000{i}.vtp")
                .find(".//Piece")
                .get("NumberOfPoints")
            )
            for i in (2, 3, 4)
        )
        dump = self.work / "out.csv"
        tandem(f"run {file} --frames 2:4 --device host --algorithm chunked --repeat 1 --dump-contacts {dump}")
        self.assertEqual(counted, len(dump.read_text().splitlines()) - 1)
        self.assertGreater(counted, 100)
        # An exported mesh can be read again.
        self.output(
            "run",
            *["--mesh", folder / "bodies_000002.vtu"] * 2,
            "--profile 1 --device host --algorithm chunked",
        )
        self.assertEqual(glb.read_bytes()[:8], b"glTF\x02\0\0\0")
        self.assertEqual(struct.unpack("<I", glb.read_bytes()[8:12])[0], glb.stat().st_size)

    def test_export_of_geometry(self):
        """The content of the recording in the format of scenes/export/geometry.h."""
        file, out = self.file("drawn.frames", self.whole), self.work / "drawn.json"
        text = self.output(
            "export", file, "--frames", "2:8", "--every", 3, "--geometry", out, "--contacts --device host"
        )
        made = json.loads(out.read_text())
        self.assertEqual(text, f"{out}: 3 of frames 2:8 of {made['key']}\n")
        self.assertTrue(made["key"].startswith("recording:drawn,frames=10"), made["key"])
        self.assertEqual(
            (made["frames"], made["of_frames"], made["times"]), ([2, 5, 8], 3, [0.02, 0.05, 0.08])
        )
        self.assertEqual((made["bodies"], made["of_bodies"], made["deformed"]), (4, 4, [[], [], []]))

        def numbers(text, kind="H"):
            return array.array(kind, base64.b64decode(text))

        for number, poses in zip(made["frames"], made["poses"]):
            values = numbers(poses)
            for body, expected in enumerate(self.frames[number][1]):
                seven = values[7 * body : 7 * body + 7]
                place = [
                    low + size * value / 65535 for low, size, value in zip(made["lower"], made["size"], seven)
                ]
                x, y, z, w = ((value - 32768) / 32767 for value in seven[3:])
                for value, exact in zip((*place, w, x, y, z), expected):
                    self.assertAlmostEqual(value, exact, delta=1e-4)
        mesh = made["meshes"][0]
        triangles, points = numbers(mesh["triangles"]), numbers(mesh["points"])
        self.assertEqual(set(triangles), set(range(len(points) // 3)))
        self.assertEqual(len(numbers(mesh["chunks"], "B")), len(triangles) // 3)
        self.assertEqual([*numbers(made["body_meshes"], "I")], [0] * 4)
        found = 0
        for contacts in made["contacts"]:
            found += contacts["found"]
            normals = numbers(contacts["normals"], "b")
            # the maximum drawn per frame
            self.assertEqual((len(numbers(contacts["points"])), len(normals)), (9000, 9000))
            for i in range(0, 9000, 300):
                self.assertAlmostEqual(math.hypot(*normals[i : i + 3]) / 127, 1, delta=0.02)
        self.assertEqual(made["notes"], [f"9000 of {found} contacts are shown, evenly spaced"])

    def test_bad_geometry(self):
        file = self.work / "bad.json"
        for message, *arguments in (
            ("--csv makes a table", "--csv", self.work / "x.csv"),
            ("name the same file", "--glb", file),
            ("name the same file", "--chunks", file),
            ("frames 3:900", "--frames", "3:900"),
            ("--device requires --contacts", "--device", "host"),
        ):
            self.bad(message, "export", "plates", "--geometry", file, *arguments)
        self.bad(
            "cannot be written", "export", "plates", "--frames", 0, "--geometry", self.work / "no/x.json"
        )
        self.assertFalse(file.exists())

    def test_export_of_meshes(self):
        folder = self.work / "meshes"
        self.output("export", self.twice, "--pose", "1 0 0 1 0 0 0", "--vtu", folder)
        self.assertEqual(sorted(os.listdir(folder)), ["bodies.pvd", "bodies_000000.vtu"])

    def test_export_of_every_third(self):
        folder = self.work / "third"
        text = self.output("export", "plates", "--frames", "1:8", "--every", 3, "--vtu", folder)
        self.assertEqual(
            sorted(os.listdir(folder)), ["bodies.pvd", *(f"bodies_00000{i}.vtu" for i in (1, 4, 7))]
        )
        self.assertIn("3 of frames 1:8 of plates", text)

    def chunks(self, *arguments):
        """The program's output and the rows of the file."""
        table = self.work / "chunks.csv"
        text = self.output("export", *arguments, "--chunks", table)
        self.assertEqual(text.splitlines()[0].partition(": ")[0], str(table))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(
            ",".join(rows[0]),
            "mesh,tetrahedron,position,chunk,super_chunk,"
            + ",".join(f"{x}{i}" for i in range(4) for x in "xyz"),
        )
        return text, [
            {name: (float if name[0] in "xyz" else int)(value) for name, value in row.items()} for row in rows
        ]

    def test_export_of_chunks(self):
        points, tets = bar(40, (0.1, 1e-9, -1e7))
        other = gmsh(self.work / "bar.msh", points, tets)
        names, orders = [f"{x}{i}" for i in range(4) for x in "xyz"], set()
        for builder in ("morton", "sah", "breadth", "hilbert", "median", "balanced"):
            text, rows = self.chunks("--mesh", self.good, "--mesh", other, "--builder", builder)
            self.assertIn(
                f": 2 meshes, {24 + len(tets)} tetrahedra in {1 + 8} chunks of up to 32, builder={builder}, of meshes:",
                text,
            )
            self.assertEqual([row["mesh"] for row in rows], [0] * 24 + [1] * len(tets))
            rows = rows[24:]
            self.assertEqual([row["position"] for row in rows], list(range(240)))
            self.assertEqual(
                [(row["chunk"], row["super_chunk"]) for row in rows], [(i // 32, 0) for i in range(240)]
            )
            self.assertEqual(sorted(row["tetrahedron"] for row in rows), list(range(240)))
            for row in rows:
                self.assertEqual(
                    [row[name] for name in names], [x for v in tets[row["tetrahedron"]] for x in points[v]]
                )
            orders.add(tuple(row["tetrahedron"] for row in rows))
        self.assertEqual(len(orders), 5)
        # L of the paper's equations 1 to 3: 500 / 96, / 2 is too few, and at least 2; 1000 / 48, / 2 = 10, 8,
        # L = 4.
        for arguments, leaves in (
            (("--k", 18, "--chunk-bytes", 500), 2),
            (("--k", 6, "--chunk-bytes", 1000), 4),
            (("--k", 18), 16),
        ):
            text, rows = self.chunks("--mesh", other, *arguments)
            self.assertIn(
                f": 1 mesh, 240 tetrahedra in {240 // leaves} chunks of up to {leaves}, builder=morton, of meshes:bar",
                text,
            )
            self.assertEqual(
                [(row["chunk"], row["super_chunk"]) for row in rows],
                [(i // leaves, i // leaves**2) for i in range(240)],
            )

    def test_export_of_chunks_beside_frames(self):
        glb, folder = self.work / "beside.glb", self.work / "beside"
        text, rows = self.chunks(self.file("beside.frames", self.whole), "--frames", 3, "--glb", glb)
        self.assertTrue(glb.stat().st_size > 1000 and f"{glb}: 1 of frames 3:3" in text, text)
        jack = self.chunks("--mesh", SOURCE / "scenes/meshes/jack.ele", "--vtu", folder)[1]
        self.assertEqual(sorted(os.listdir(folder)), ["bodies.pvd", "bodies_000000.vtu"])
        # Bodies with the same mesh share its rows, without poses.
        self.assertEqual(
            [row["tetrahedron"] for row in rows if row["mesh"] == 0], [row["tetrahedron"] for row in jack]
        )

    def test_bad_chunks(self):
        table = self.work / "bad.csv"
        for message, *arguments in (
            ("setting builder=zebra is impossible", "--builder", "zebra"),
            ("setting k=7 is impossible", "--k", 7),
            ("--chunk-bytes", "--chunk-bytes", 0),
            ("--chunk-bytes", "--chunk-bytes", "much"),
            ("--frames and --every require --vtu", "--frames", 0),
            ("--frames and --every require --vtu", "--every", 2),
            ("name the same file", "--glb", table),
            ("--chunks cannot be combined with --csv", "--csv", self.work / "x.csv"),
            ("frames 3:900", "--frames", "3:900", "--glb", self.work / "x.glb"),
        ):
            self.bad(message, "export", "plates", "--chunks", table, *arguments)
        for option, value in (("--builder", "sah"), ("--chunk-bytes", 100), ("--k", 18)):
            self.bad(
                f"{option} requires --chunks FILE", f"export plates --glb {self.work}/x.glb {option} {value}"
            )
        self.bad("cannot be written", "export", "plates", "--chunks", self.work / "no/x.csv")
        self.assertFalse(table.exists() or (self.work / "x.glb").exists())

    def test_bad_exports(self):
        self.bad("--every", "export", "plates", "--every", 0, "--glb", self.work / "x.glb")
        self.bad("--vtu FOLDER, --glb FILE", "export", "plates")
        self.bad("--contacts requires --vtu", "export", "plates", "--glb", self.work / "x.glb", "--contacts")
        self.bad("--device", "export", "plates", "--vtu", self.work / "x", "--device", "host")
        self.bad(
            "the nearest is 'opencl:0'", f"export plates --vtu {self.work}/x --contacts --device opencl:7"
        )
        self.bad("the nearest is 'plates'", "export", "plats", "--vtu", self.work / "x")
        self.bad("no scene", "export", "--vtu", self.work / "x")
        self.bad("frames 3:900", "export", "plates", "--frames", "3:900", "--glb", self.work / "x.glb")
        self.bad("--frames x", "export", "plates", "--frames", "x", "--glb", self.work / "x.glb")
        self.bad("cannot be written", "export", "plates", "--frames", "0", "--glb", self.work / "no/x.glb")
        self.bad("cannot make this folder", "export", "plates", "--frames", "0", "--vtu", self.good)
        self.assertFalse((self.work / "x").exists() or (self.work / "x.glb").exists())
