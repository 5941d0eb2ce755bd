# SPDX-License-Identifier: MIT
# test: cost=5
"""Contact surfaces in exports: the polygons of every format are those of --dump-surfaces, with their
pressures."""

import array
import base64
import json
import struct
import xml.etree.ElementTree
import zlib

from tests.program import Case, tandem

SCENE = "pile:bodies=4,refine=1,density=0.5,frames=3 --pressure 1e6"
KINDS = {"Float64": "d", "Int64": "q", "UInt32": "I"}


def vtk_arrays(path):
    """The arrays of a .vtp file by their place and name."""
    arrays = {}
    for part in xml.etree.ElementTree.parse(path).find("PolyData/Piece"):
        for found in part:
            text = found.text.strip()
            (parts,) = struct.unpack("<Q", base64.b64decode(text[:12])[:8])
            head = 4 * ((8 * (3 + parts) + 2) // 3)
            sizes = struct.unpack(f"<{3 + parts}Q", base64.b64decode(text[:head]))[3:]
            packed, data, at = base64.b64decode(text[head:]), b"", 0
            for size in sizes:
                data += zlib.decompress(packed[at : at + size])
                at += size
            arrays[part.tag, found.get("Name")] = array.array(KINDS[found.get("type")], data)
    return arrays


class Glb:
    """A .glb file: its JSON, and the numbers of its accessors."""

    def __init__(self, path):
        data = path.read_bytes()
        (length,) = struct.unpack("<I", data[12:16])
        self.json, self.binary = json.loads(data[20 : 20 + length]), data[28 + length :]

    def numbers(self, accessor):
        accessor = self.json["accessors"][accessor]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind = {5126: "f", 5125: "I"}[accessor["componentType"]]
        return array.array(kind, self.binary[view["byteOffset"] :][: view["byteLength"]])

    def surfaces(self):
        """The primitive of contact surfaces of each frame that has any, with its node."""
        for number, node in enumerate(self.json["nodes"]):
            mesh = self.json["meshes"][node["mesh"]]
            if mesh["name"] == "contact surfaces":
                yield number, node, mesh["primitives"][0]


class SurfaceExports(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        vtp = cls.work / "right.vtp"
        status, text, errors = tandem(
            f"run {SCENE} --device host --algorithm tiled --set contact_rule=pressure --dump-surfaces {vtp}"
        )
        cls.right = vtk_arrays(vtp)
        ends = cls.right["Polys", "offsets"]
        cls.polygons = [[] for _ in range(3)]  # by frame: the pressures at the corners of each
        cls.points = [[] for _ in range(3)]
        for i, frame in enumerate(cls.right["CellData", "frame"]):
            first = ends[i - 1] if i else 0
            cls.polygons[frame].append(cls.right["PointData", "pressure"][first : ends[i]])
            cls.points[frame].extend(cls.right["Points", "Points"][3 * first : 3 * ends[i]])
        cls.most = max(cls.right["PointData", "pressure"])

    def setUp(self):
        self.assertGreater(min(map(len, self.polygons)), 100)

    def test_glb(self):
        """Each frame has a mesh, which is shown in its frame only; the corners have pressures and their colours."""
        path = self.work / "all.glb"
        text = self.output(f"export {SCENE} --surfaces --glb {path}")
        self.assertIn(f"{sum(map(len, self.polygons))} polygons\n", text)
        glb = Glb(path)
        found = list(glb.surfaces())
        self.assertEqual(len(found), 3)
        for polygons, points, (_, _, primitive) in zip(self.polygons, self.points, found):
            attributes = primitive["attributes"]
            self.assertEqual(
                len(glb.numbers(primitive["indices"])), 3 * sum(len(corners) - 2 for corners in polygons)
            )
            right = array.array("f", [pressure for corners in polygons for pressure in corners])
            self.assertEqual(sorted(glb.numbers(attributes["_PRESSURE"])), sorted(right))
            self.assertEqual(sorted(glb.numbers(attributes["POSITION"])), sorted(array.array("f", points)))
            self.assertEqual(glb.json["accessors"][attributes["_PRESSURE"]]["max"], [max(right)])
            colours = glb.numbers(attributes["COLOR_0"])
            pressures = glb.numbers(attributes["_PRESSURE"])
            least, most = (pressures.index(find(pressures)) for find in (min, max))
            self.assertLess(colours[3 * least + 1], colours[3 * most + 1], "the green of viridis rises")
        materials = glb.json["materials"]
        self.assertEqual(materials[found[0][2]["material"]]["extras"]["most_pressure"], self.most)
        self.assertEqual({material.get("alphaMode") for material in materials[:-1]}, {"BLEND"})
        self.check_visibility(glb, [number for number, _, _ in found])

    def check_visibility(self, glb, nodes):
        """Samples with steps, as viewers do, at the time of each frame."""
        (animation,) = glb.json["animations"]
        times = sorted({t for s in animation["samplers"] for t in glb.numbers(s["input"])})
        self.assertEqual(len(times), 3)
        for channel in animation["channels"]:
            if channel["target"]["node"] not in nodes:
                continue
            frame = nodes.index(channel["target"]["node"])
            self.assertEqual(channel["target"]["path"], "scale")
            sampler = animation["samplers"][channel["sampler"]]
            self.assertEqual(sampler["interpolation"], "STEP")
            keys, scales = glb.numbers(sampler["input"]), glb.numbers(sampler["output"])
            shown = [scales[3 * max(i for i, key in enumerate(keys) if key <= time)] for time in times]
            self.assertEqual(shown, [float(frame == other) for other in range(3)])
        self.assertEqual(sum(c["target"]["path"] == "scale" for c in animation["channels"]), 3)

    def test_vtu(self):
        folder = self.work / "vtu"
        text = self.output(f"export {SCENE} --frames 1:2 --surfaces --vtu {folder}")
        self.assertIn(f"surfaces.pvd: {sum(map(len, self.polygons[1:]))} polygons", text)
        for frame in (1, 2):
            made = vtk_arrays(folder / f"surfaces_00000{frame}.vtp")
            self.assertEqual(set(made["CellData", "frame"]), {frame})
            right = sorted(pressure for corners in self.polygons[frame] for pressure in corners)
            self.assertEqual(sorted(made["PointData", "pressure"]), right)
            self.assertEqual(sorted(made["Points", "Points"]), sorted(self.points[frame]))

    def test_geometry(self):
        path = self.work / "page.json"
        self.output(f"export {SCENE} --surfaces --contacts --geometry {path}")
        made = json.loads(path.read_text())
        self.assertEqual(made["most_pressure"], self.most)
        self.assertRegex("; ".join(made["notes"]), "^9000 of [0-9]+ contacts are shown, evenly spaced$")
        self.assertEqual(len(made["contacts"]), 3)
        for polygons, surfaces in zip(self.polygons, made["surfaces"]):
            corners, pressures = (base64.b64decode(surfaces[name]) for name in ("corners", "pressures"))
            self.assertEqual(surfaces["found"], len(polygons))
            self.assertEqual(sorted(corners), sorted(map(len, polygons)))
            right = sorted(round(p / self.most * 65535) for one in polygons for p in one)
            for part, other in zip(sorted(array.array("H", pressures)), right, strict=True):
                self.assertLessEqual(abs(part - other), 1)
            self.assertEqual(len(base64.b64decode(surfaces["points"])), 3 * len(pressures))

    def test_pages(self):
        page = self.work / "page.html"
        self.output(f"view {SCENE} --surfaces --frames 0 -o {page}")
        self.assertIn('"most_pressure":', page.read_text())

    def test_what_is_refused(self):
        glb = self.work / "refused.glb"
        for message, arguments in (
            (
                "needs a pressure field, and no mesh of scene pile has one; give --pressure",
                f"--surfaces --glb {glb}",
            ),
            ("--surfaces requires --vtu FOLDER, --glb FILE or", f"--surfaces --chunks {self.work}/x.csv"),
            ("--device requires --contacts or --surfaces", f"--device host --glb {glb}"),
            ("--device all: contacts need one device", f"--surfaces --device all --pressure 1 --glb {glb}"),
        ):
            self.bad(message, f"export pile:bodies=2,refine=1,frames=1 {arguments}")
        self.bad("needs a pressure field", f"view pile:bodies=2,frames=1 --surfaces -o {self.work}/x.html")
        self.bad("--device requires --contacts or --surfaces", "view plates --device host")
        self.assertFalse(glb.exists())
