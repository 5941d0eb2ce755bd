# SPDX-License-Identifier: MIT
# test: cost=4 full=10 needs=TANDEM_BUILDS_PYTHON
"""Pressure fields in Python: of arrays, files and objects of other libraries, and by pressure=MODULUS; copies, pickles,
written frames and converted files keep them, and mistakes are one line."""

import pickle
import warnings

import meshio
import numpy

from tests.collider.case import DEVICES, ColliderCase, run_tandem, tandem
from tests.program import cubes, gmsh, node_data

POSES = [[0, 0, 0, 1, 0, 0, 0], [0.3, 0.2, 0.1, 1, 0, 0, 0]]
FIELD = [float(vertex == 13) * 1e7 for vertex in range(27)]  # that of pressure=1e7
INSIDE = "no vertex lies inside, so that the pressure is 0 everywhere; refine the mesh"


class Pressures(ColliderCase):
    """Eight cubes about a vertex that alone has a pressure."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.arrays = tuple(map(numpy.array, cubes()))
        cls.own = gmsh(cls.work / "own.msh", *cubes())
        with open(cls.own, "a", encoding="ascii") as file:
            file.write(node_data(FIELD))

    def polygons(self, first, second, device="host", **options):
        """Number and digest of the polygons of two meshes, without warnings."""
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            collider = self.collider([first, second], device=device, contact_rule="pressure", **options)
        answer = collider.run(POSES)
        return answer.contact_count, answer.contact_digest()

    def told(self, function, *arguments, **named):
        """Result and the texts of warnings, each at a line of this file."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = function(*arguments, **named)
        self.assertEqual({warning.filename for warning in caught} - {__file__}, set())
        return result, [str(warning.message) for warning in caught]

    def test_surfaces_and_wrenches(self):
        mesh = tandem.make_mesh(*self.arrays, pressures=FIELD)
        turned = [POSES[0], [0.3, 0.2, 0.1, 0.8, 0.6, 0, 0]]
        for device in DEVICES:
            given = {"device": device, "precision": "double"}
            found = (
                self.collider([mesh, mesh], contact_rule="pressure", **given)
                .run(turned)
                .surfaces(corners=True)
            )
            self.assertGreater(len(found.pairs), 10)
            self.assertEqual(found.ends[-1], len(found.corners))
            self.assertEqual(len(found.corner_pressures), len(found.corners))
            first = 0
            for end, area, normal, pressure in zip(found.ends, found.areas, found.normals, found.pressures):
                corners, at_corners = found.corners[first:end], found.corner_pressures[first:end]
                first = end
                sides = corners[1:] - corners[0]
                twice = numpy.cross(sides[:-1], sides[1:]).sum(axis=0)
                self.assertAlmostEqual(numpy.linalg.norm(twice) / 2, area, 12)
                self.assertAlmostEqual(abs(twice @ normal) / 2, area, 12)
                self.assertTrue(at_corners.min() - 1e-6 <= pressure <= at_corners.max() + 1e-6)
            sums = self.collider([mesh, mesh], output="wrenches", **given).run(turned).wrenches()
            forces = found.normals * (found.areas * found.pressures)[:, None]
            self.assertEqual(sums.bodies.tolist(), [[0, 1]])
            self.assertEqual(sums.polygons.tolist(), [len(found.pairs)])
            self.assertLess(abs(sums.forces[0] - forces.sum(axis=0)).max(), 1e-5)
            torque = numpy.cross(found.centroids - turned[0][:3], forces).sum(axis=0)
            self.assertLess(abs(sums.torques[0] - torque).max(), 1e-5)
            self.assertAlmostEqual(sums.areas[0], found.areas.sum(), 12)

    def test_torques_of_deformable_bodies_are_about_the_origin_of_the_answer(self):
        mesh = tandem.make_mesh(*self.arrays, pressures=FIELD)
        vertices = [self.arrays[0] + shift for shift in ([100, 0, 0], [100.3, 0.2, 0.1])]
        given = {"precision": "double", "deformable": True}
        found = (
            self.collider([mesh, mesh], contact_rule="pressure", **given).run(vertices=vertices).surfaces()
        )
        answer = self.collider([mesh, mesh], output="wrenches", **given).run(vertices=vertices)
        self.assertGreater(answer.origin[0], 50)
        forces = found.normals * (found.areas * found.pressures)[:, None]
        torque = numpy.cross(found.centroids - answer.origin, forces).sum(axis=0)
        self.assertLess(abs(answer.wrenches().torques[0] - torque).max(), 1e-4)
        self.assertGreater(abs(torque).max(), 1e-2)

    def test_each_rule_has_its_function(self):
        mesh = tandem.make_mesh(*self.arrays, pressures=FIELD)
        polygons = self.collider([mesh, mesh], contact_rule="pressure").run(POSES)
        with self.assertRaisesRegex(
            ValueError, r"makes polygons, not contacts; call surfaces\(\) or wrenches"
        ):
            polygons.contacts()
        with self.assertRaisesRegex(ValueError, "output=pairs adds no wrenches up"):
            polygons.wrenches()
        with self.assertRaisesRegex(ValueError, "contact_rule=sat and output=pairs make no polygons"):
            self.collider([mesh, mesh]).run(POSES).surfaces()
        with self.assertRaisesRegex(ValueError, "output=wrenches make no polygons"):
            self.collider([mesh, mesh], output="wrenches").run(POSES).surfaces()

    def test_every_kind_of_mesh_has_one(self):
        points, tets = self.arrays
        cells = [("tetra", tets)]
        own = tandem.make_mesh(points, tets, pressures=FIELD)
        right = self.polygons(own, own)
        self.assertGreater(right[0], 10)
        with_field = {
            "path": self.own,
            "bytes": self.own.read_bytes(),
            "meshio": meshio.Mesh(points, cells, point_data={"pressure": FIELD}),
            "a column": meshio.Mesh(points, cells, point_data={"pressure": numpy.array(FIELD)[:, None]}),
            "read_mesh": tandem.read_mesh(self.own),
        }
        without = {
            "arrays": self.arrays,
            "Mesh": tandem.make_mesh(*self.arrays),
            "other data": meshio.Mesh(points, cells, point_data={"p": FIELD}),
        }
        for form, mesh in with_field.items():
            with self.subTest(form):
                self.assertEqual(self.polygons(mesh, own), right)
                self.assertEqual(self.polygons(mesh, own, pressure=3), right, "its own field is kept")
        for form, mesh in without.items():
            with self.subTest(form):
                self.assertEqual(self.polygons(mesh, own, pressure=1e7), right)
        for device in DEVICES:
            self.assertEqual(self.polygons(own, own, device), right)

    def test_meshes_tell_and_keep_it(self):
        plain = tandem.make_mesh(*self.arrays)
        self.assertEqual((plain.pressures, plain.pressure), (None, None))
        own = tandem.make_mesh(*self.arrays, pressures=FIELD, pressure=5)
        self.assertEqual((own.pressures.tolist(), own.pressure), (FIELD, None))
        self.assertFalse(own.pressures.flags.writeable)
        made = tandem.make_mesh(*self.arrays, pressure=1e7)
        self.assertEqual((made.pressures.tolist(), made.pressure), (FIELD, 1e7))
        for mesh in (plain, own, made):
            again = pickle.loads(pickle.dumps(mesh))
            self.assertEqual(again.pressure, mesh.pressure)
            self.assertIs(again.pressures is None, mesh.pressures is None)
            if mesh.pressures is not None:
                self.assertEqual(again.pressures.tolist(), FIELD)
        collider = self.collider([made, made], contact_rule="pressure", weld=0)
        self.assertEqual(collider.run(POSES).contact_count, self.polygons(own, own)[0])
        self.assertEqual(self.collider([made, made], pressure=7).arguments["pressure"], 7)

    def test_warnings(self):
        flat = self.meshes[0]
        mesh, texts = self.told(tandem.make_mesh, *flat, "flat", pressure=1)
        self.assertEqual((texts, mesh.findings), ([f"mesh flat: {INSIDE}"], INSIDE))
        loaded = [0.5, *FIELD[1:]]
        _, texts = self.told(tandem.make_mesh, *self.arrays, "loaded", pressures=loaded)
        self.assertEqual(texts, ["mesh loaded: the pressure is not 0 on the whole boundary, but up to 0.5"])
        meshes = [tandem.read_mesh(self.own), self.arrays]
        collider, texts = self.told(tandem.Collider, meshes, contact_rule="pressure", bodies=[0, 1, 1])
        self.assertEqual(
            texts,
            ["2 of 3 bodies have no pressure field and make no polygons (pressure=MODULUS gives them one)"],
        )
        self.assertEqual(collider.run([*POSES, POSES[1]]).contact_count, 0)
        self.assertEqual(self.told(tandem.Collider, meshes)[1], [], "contacts of another rule need no field")

    def test_scenes_and_files(self):
        scene = tandem.make_scene("pile:bodies=2,refine=1", pressure=1e7)
        self.assertEqual((scene.meshes[0].pressures.max(), scene.meshes[0].pressure), (1e7, 1e7))
        written = tandem.write_frames(self.work / "frames", [self.own, self.arrays], poses=[POSES])
        meshes = tandem.make_scene(str(written)).meshes
        self.assertEqual(meshes[0].pressures.tolist(), FIELD)
        self.assertIsNone(meshes[1].pressures)
        source, converted = self.work / "field.xdmf", self.work / "field.vtu"
        points, tets = self.arrays
        data = {"pressure": numpy.array(FIELD), "other": numpy.full(len(points), -1.0)}
        meshio.Mesh(points, [("tetra", tets)], point_data=data).write(source)
        self.assertEqual(run_tandem("convert", source, "-o", converted)[0], 0)
        self.assertEqual(tandem.read_mesh(converted).pressures.tolist(), FIELD)
        self.assertNotIn("other", converted.read_text(errors="replace"))

    def test_mistakes(self):
        points, tets = self.arrays
        nan = [*FIELD[:-1], float("nan")]
        masked = numpy.ma.array(FIELD)
        table = """
ValueError | mesh: 26 pressures for 27 vertices; give one a vertex         | tandem.make_mesh(points, tets, pressures=FIELD[:-1])
ValueError | mesh: the pressure of vertex 0 is -1; pressures are finite    | tandem.make_mesh(points, tets, pressures=[-1.0, *FIELD[1:]])
ValueError | mesh: the pressure of vertex 26 is nan; pressures are finite  | tandem.make_mesh(points, tets, pressures=nan)
ValueError | mesh: pressures: shape (27, 1); expected (n,)                 | tandem.make_mesh(points, tets, pressures=numpy.array(FIELD)[:, None])
ValueError | mesh: pressures: is a masked array                            | tandem.make_mesh(points, tets, pressures=masked)
TypeError  | mesh: pressures: type <U1; expected real numbers              | tandem.make_mesh(points, tets, pressures=["a"] * 27)
TypeError  | mesh: pressures: type bool; expected real numbers             | tandem.make_mesh(points, tets, pressures=[True] * 27)
TypeError  | mesh: pressures: is a mapping                                 | tandem.make_mesh(points, tets, pressures={0: 1.0})
ValueError | pressure 0: give a modulus above 0, at most 3.4e+38           | tandem.make_mesh(points, tets, pressure=0)
ValueError | pressure -1: give a modulus                                   | tandem.read_mesh(own, pressure=-1)
ValueError | pressure nan: give a modulus                                  | tandem.make_scene("pile", pressure=float("nan"))
ValueError | pressure inf: give a modulus                                  | tandem.Collider([own], pressure=float("inf"))
TypeError  | pressure: type bool; expected a modulus above 0, or None      | tandem.Collider([own], pressure=True)
TypeError  | pressure: type str; expected a modulus above 0, or None       | tandem.make_mesh(points, tets, pressure="high")
ValueError | give --pressure MODULUS (pressure= in Python)                | tandem.Collider([(points, tets)] * 2, contact_rule="pressure")
"""
        names = {"points": points, "tets": tets, "nan": nan, "masked": masked, "own": self.own}
        self.expect_mistakes(table, {**names, "tandem": tandem, "numpy": numpy, "FIELD": FIELD})
