# SPDX-License-Identifier: MIT
# test: cost=3 full=20 needs=TANDEM_BUILDS_PYTHON
"""Mistakes in calls of tandem.Collider each give one clear line, which equals the program's where the program has
the same; meshes of other libraries; pickling; warnings where nothing can meet."""

import copy
import pickle
import types
import warnings

import meshio
import numpy

from tests.collider.case import POSES, ColliderCase, OnDevice, run_tandem, tandem
from tests.program import gmsh

# For ColliderCase.expect_mistakes; names in the calls are those of Mistakes.names().
MESHES = """
ValueError | meshes[0]: vertices: shape (20, 2); expected (n, 3)      | first(points[:, :2], tets)
ValueError | meshes[0]: tetrahedra: shape (24, 3); expected (n, 4)    | first(points, tets[:, :3])
TypeError  | meshes[0]: tetrahedra: type float64; expected integers   | first(points, tets.astype(float))
TypeError  | meshes[0]: vertices: type complex128; expected real numbers | first(points.astype(complex), tets)
ValueError | meshes[0]: vertices: is not an array; give rows of equal lengths | first([[0, 0, 0], [1, 2]], tets)
ValueError | meshes[1]: vertices: is a masked array                   | make([mesh, (masked_array(points), tets)])
ValueError | numbers from -1 to                                       | first(points, tets - 1)
ValueError | meshes[0]: tetrahedron 0 names vertex                    | first(points, tets + 1000)
ValueError | meshes[0]: vertex 2 is not finite                        | first(changed(points, (2, 1), nan), tets)
ValueError | meshes[0]: no tetrahedra                                 | first(points, tets[:0])
ValueError | nowhere.msh: No such file or directory                   | make(["nowhere.msh", file])
ValueError | is in CUDA's memory; copy it to the host's memory (.cpu() or .get()) | first(OnDevice(), tets)
TypeError  | meshes[0]: type int; expected a tandem.Mesh, a path, (vertices, tetrahedra), or an object with points and cells_dict | make([7, file])
ValueError | meshes[0]: has cells of type hexahedron; give linear tetrahedra only | make([of_cells(hexahedron=tets, tetra=tets)])
ValueError | meshes[0]: has no tetrahedra among its cells (triangle); fill the surface | make([of_cells(triangle=tets[:, :3])])
TypeError  | type Trimesh has faces, not tetrahedra                   | make([Trimesh()])
TypeError  | meshes: type str; expected a list                        | Collider("a.msh")
TypeError  | meshes: type dict; expected a list                       | make({"a": mesh, "b": mesh})
TypeError  | meshes: type dict; expected a list                       | written({"a": mesh})
ValueError | has no bodies                                            | Collider([])
TypeError  | bodies: type dict; expected a list                       | make(bodies={0: 1})
ValueError | bodies: body 1 is of mesh 2 of 2; meshes are numbered from 0 | make(bodies=[0, 2])
ValueError | bodies[0]: -1 is not the number of a mesh                | make(bodies=[-1])
TypeError  | bodies[0]: type float                                    | make(bodies=[0.5])
ValueError | deformable[0]: 2 is not the number of a body; there are 2 | make(deformable=[2])
ValueError | broken.msh                                               | tandem.read_mesh(broken)
"""
SETTINGS = """
ValueError | unknown setting of tiled 'kk'                            | make(kk=8)
ValueError | unknown algorithm 'tild'                                 | Collider(meshes, "tild")
ValueError | unknown device 'hst'                                     | make(device="hst")
ValueError | k=7                                                      | make(k=7)
ValueError | rounding=directed is impossible on host                  | make(rounding="directed")
ValueError | unknown preset of tiled 'fairest'                        | make(preset="fairest")
ValueError | named twice                                              | make(device="host+host")
ValueError | device=all                                               | make(device="all")
ValueError | choose decision=exact or contact_rule=none               | make(motion="linear", decision="recheck")
TypeError  | setting k: type list; expected a word or a number | make(k=[8])
ValueError | setting k=8.0 is impossible; choose one of 6, 8, 12, 14, 16, 18, 20, 24, 26 | make(k=8.0)
ValueError | setting margin=-0.5 is impossible; give a length from 0 to 1e+30, such as 0.01 | make(margin=-0.5)
ValueError | setting margin=nan is impossible; give a length from 0 to 1e+30, such as 0.01 | make(margin=float("nan"))
ValueError | setting margin=yes is impossible; give a length from 0 to 1e+30, such as 0.01 | make(margin=True)
TypeError  | device: type int; expected a name                        | make(device=0)
TypeError  | a collider owns memory of devices and cannot be pickled  | pickle.dumps(collider)
"""
FRAMES = """
ValueError | poses: shape (2, 6); expected (n, 7)                     | collider.pairs(poses[:, :6])
ValueError | poses: shape (7,); expected (n, 7) or (n, 4, 4)          | collider.run(poses[0])
ValueError | poses: 1 rows for 2 bodies                               | collider.run(poses[:1])
TypeError  | poses: type bool                                         | collider.pairs(poses > 0)
TypeError  | poses: type <U                                           | collider.pairs([["identity"] * 7] * 2)
TypeError  | poses: type object                                       | collider.pairs([[None] * 7] * 2)
ValueError | poses: row 1 has no rotation                             | collider.pairs(poses * [[1], [0]])
ValueError | poses: row 0 has no rotation                             | collider.run(changed(poses, (0, 3), 0))
ValueError | poses: row 0 has no rotation                             | collider.pairs(changed(poses, (0, 3), nan))
ValueError | poses: row 0 is not finite                               | collider.pairs(changed(poses, (0, 0), inf))
ValueError | poses: row 1 is not finite                               | collider.run(changed(poses, (1, 0), nan))
ValueError | body 0 has a coordinate of 1e+37                         | collider.run(changed(poses, (0, 1), 1e37))
ValueError | precision=float takes at most 1e+36                      | collider.pairs(changed(poses, (0, 0), 1e37))
ValueError | is in CUDA's memory                                      | collider.pairs(OnDevice())
ValueError | poses: matrix 1 scales or shears                         | collider.run(changed(turned * [[[1]], [[2]]], (1, 3, 3), 1))
ValueError | poses: matrix 0 mirrors                                  | collider.run(changed(turned, (0, 2, 2), -1))
ValueError | poses: matrix 1 has another last row than 0 0 0 1        | collider.run(changed(turned, (1, 3, 0), 5))
ValueError | poses: is a masked array, whose mask would be lost       | collider.run(masked_array(poses, mask=poses > 0.5))
ValueError | poses: is a masked array                                 | collider.run(masked_array(POSES))
ValueError | masked                                                   | collider.run([masked_array(POSES[0]), POSES[1]])
ValueError | no body is deformable; make the collider with deformable=True | collider.run(vertices=[points])
ValueError | no body is deformable; make the collider with deformable=True | collider.pairs(vertices=[points])
ValueError | vertices: 1 arrays for 2 deformable bodies               | both.run(vertices=[points])
ValueError | vertices: 19 rows for body 0, whose mesh has 20 vertices | both.run(vertices={0: points[1:]})
ValueError | body 1: vertex 3 is not finite                           | both.run(vertices=[points, bad])
ValueError | vertices: 2 arrays for 1 deformable bodies               | soft.pairs(vertices=[second, second])
ValueError | vertices: 0 is not a deformable body (those are: 1)      | soft.pairs(vertices={0: second})
ValueError | vertices of body 1: shape (16, 2)                        | soft.pairs(vertices=[second[:, :2]])
ValueError | vertices: 15 rows for body 1, whose mesh has 16 vertices | soft.pairs(vertices=[second[1:]])
ValueError | body 1: vertex 3 is not finite                           | soft.pairs(vertices=[bad])
ValueError | vertices of body 1: is a masked array                    | soft.run(vertices=[masked_array(second)])
TypeError  | vertices of body 1: type complex128                      | soft.pairs(vertices=[second.astype(complex)])
TypeError  | vertices: type int; expected a list                      | soft.pairs(vertices=5)
"""
SUCCESSORS = """
ValueError | setting motion=linear needs the frame's successor; give next_poses or next_vertices | swept.run(POSES)
ValueError | setting motion=linear needs the frame's successor; give next_poses or next_vertices | auto(**linear).run(POSES)
ValueError | next_poses and next_vertices are for setting motion=linear | collider.run(POSES, next_poses=POSES)
ValueError | next_poses and next_vertices are for setting motion=linear | collider.count(POSES, next_poses=POSES)
ValueError | next_poses and next_vertices are for setting motion=linear | auto().tune(POSES, next_poses=POSES)
ValueError | next_poses: shape (2, 6); expected (n, 7)                | swept.run(POSES, next_poses=poses[:, :6])
ValueError | next_poses: 1 rows for 2 bodies                          | swept.run(POSES, next_poses=poses[:1])
TypeError  | next_poses: type bool                                    | swept.run(POSES, next_poses=poses > 0)
ValueError | successor: poses: row 0 is not finite                    | swept.run(POSES, next_poses=changed(poses, (0, 0), inf))
ValueError | successor: body 0 has a coordinate of 1e+37, and precision=float | swept.run(POSES, next_poses=changed(poses, (0, 0), 1e37))
ValueError | next_vertices: 2 arrays for 1 deformable bodies          | swept.run(POSES, next_vertices=[second, second])
ValueError | next_vertices: 0 is not a deformable body                | swept.run(POSES, next_vertices={0: second})
ValueError | next_vertices of body 1: shape (16, 2)                   | swept.run(POSES, next_vertices=[second[:, :2]])
ValueError | next_vertices: 15 rows for body 1                        | swept.run(POSES, next_vertices=[second[1:]])
ValueError | successor: body 1: vertex 3 is not finite                | swept.run(POSES, next_vertices=[bad])
TypeError  | next_vertices: type int; expected a list                 | swept.run(POSES, next_vertices=5)
ValueError | next_vertices: no body is deformable                     | make(**linear).run(next_vertices=[second])
"""
ANSWERS = """
ValueError | output=count keeps no pairs                              | counted.pairs()
ValueError | output=count keeps no pairs                              | counted.contacts()
ValueError | output=count keeps no pairs                              | counted.pairs(on_device=True)
ValueError | contact_rule=none makes no contacts                      | make(contact_rule="none").run(POSES).contacts()
ValueError | no array library takes OpenCL's memory by DLPack         | make(device="opencl:0").run(POSES).pairs(on_device=True)
DeviceError | host: the pairs are in 2 parts                          | make(device="host+opencl:0").run(POSES).pairs(on_device=True)
OutOfMemory | bytes                                                   | make(algorithm="gproximity", queue_bytes=1 << 39)
"""
# A list of bools is a mask, which no argument takes; True alone is a flag. `truth` is True of Python or of NumPy.
BOOLS = """
TypeError | worlds: {0}the number of worlds          | make(worlds=truth)
TypeError | bodies[0]: {0}the number of a mesh       | make(bodies=[truth, False])
TypeError | deformable[0]: {0}the number of a body   | make(deformable=[truth, False])
TypeError | deformable[0]: {0}the number of a body   | make(deformable=[truth] * 2)
TypeError | body_groups[0]: {0}the number of a group | make(body_groups=[[truth], [1]])
TypeError | meets[1]: {0}the number of a group       | make(meets=[None, [truth]])
TypeError | never_meet[0]: {0}the number of a body   | make(never_meet=[(0, truth)])
TypeError | stream: {0}a CUDA stream or its address  | make(stream=truth)
TypeError | body_pairs[0]: {0}the number of a body   | collider.run(poses, body_pairs=[(0, truth)])
TypeError | body_pairs[0]: {0}the number of a world  | many.run(numpy.array([poses, poses]), body_pairs=[(truth, 0, 1)])
TypeError | vertices: {0}the number of a body        | soft.run(vertices={{truth: second}})
TypeError | poses: {0}the number of a body           | collider.update({{truth: poses[0]}})
TypeError | bodies[0]: {0}the number of a mesh       | written(bodies=[truth], poses=[poses[:1]])
TypeError | deformable[0]: {0}the number of a body   | written(deformable=[truth], poses=[poses], vertices=[[second]])
TypeError | vertices[0]: {0}the number of a body     | written(deformable=[1], poses=[poses], vertices=[{{truth: second}}])
TypeError | frame: type bool; expected the number of a frame | tandem.make_scene("plates").poses(True)
TypeError | frame: type bool; expected the number of a frame | tandem.make_scene("plates").vertices(True)
"""


def other_mesh(points, **cells):
    """An object as of meshio or PyVista."""
    return types.SimpleNamespace(
        points=points, cells_dict={10 if name == "VTK" else name: rows for name, rows in cells.items()}
    )


class Mistakes(ColliderCase):
    def names(self):
        """The names of the calls in the tables."""
        points, tets = self.meshes[0]
        second, linear = self.meshes[1][0], {"motion": "linear", "contact_rule": "none"}

        def changed(array, place, value):
            array = array.astype(float)
            array[place] = value
            return array

        return {
            **{
                "make": self.collider,
                "Collider": tandem.Collider,
                "written": self.written,
                "meshes": self.meshes,
            },
            **{
                "points": points,
                "tets": tets,
                "mesh": self.meshes[0],
                "file": self.files[1],
                "second": second,
            },
            **{"poses": numpy.array(POSES), "POSES": POSES, "turned": numpy.tile(numpy.eye(4), (2, 1, 1))},
            **{"nan": numpy.nan, "inf": numpy.inf, "changed": changed, "masked_array": numpy.ma.masked_array},
            **{"bad": changed(second, (3, 2), numpy.nan), "linear": linear, "OnDevice": OnDevice},
            **{"tandem": tandem, "numpy": numpy, "pickle": pickle, "many": self.collider(worlds=2)},
            "broken": gmsh(self.work / "broken.msh", [(0, 0, 0)] * 3, [[0, 1, 2, 9]]),
            "first": lambda *mesh: tandem.Collider([mesh, self.files[1]]),
            "of_cells": lambda **cells: other_mesh(points, **cells),
            "Trimesh": type("Trimesh", (), {"faces": [], "vertices": []}),
            "auto": lambda **options: tandem.Collider(self.meshes, "auto", **options),
            "counted": self.collider(output="count").run(POSES),
            **{"collider": self.collider(), "soft": self.collider(deformable=[1])},
            **{"both": self.collider(deformable=True), "swept": self.collider(deformable=[1], **linear)},
        }

    def written(self, meshes=None, **options):
        return tandem.write_frames(
            self.work / "refused", self.meshes if meshes is None else meshes, **options
        )

    def test_each_gives_one_line(self):
        names = self.names()
        self.expect_mistakes(MESHES + SETTINGS + FRAMES + SUCCESSORS + ANSWERS, names)
        # Colliders go on after bad input.
        right = self.collider().run(POSES)
        self.assertTrue((names["collider"].pairs(POSES) == right.pairs()).all())
        self.assertEqual(names["swept"].digest(POSES, next_poses=POSES).count, names["soft"].count(POSES))
        self.assertEqual(names["counted"].count, right.count)
        self.assertTrue(issubclass(tandem.DeviceError, RuntimeError))
        self.assertTrue(issubclass(tandem.OutOfMemory, tandem.DeviceError))

    def test_errors_equal_the_programs(self):
        for options, words in (
            ({"k": 7}, ("--set", "k=7")),
            ({"device": "cuda:9"}, ("--device", "cuda:9")),
            ({"rounding": "directed"}, ("--set", "rounding=directed")),
        ):
            with self.assertRaises(ValueError) as caught:
                tandem.Collider(self.meshes, **options)
            defaults = {"--algorithm": "tiled", "--device": "host", words[0]: words[1]}
            errors = run_tandem("run", "plates", *(word for pair in defaults.items() for word in pair))[2]
            self.assertEqual([f"tandem: {caught.exception}"], errors)

    def test_no_integer_is_a_bool(self):
        for truth in (True, numpy.True_):
            names, kind = {**self.names(), "truth": truth}, f"type {type(truth).__name__}; expected "
            self.expect_mistakes(BOOLS.format(kind), names)
        self.assertEqual(
            self.collider(bodies=[numpy.int64(0), numpy.array(1)]).run(POSES).digest(),
            self.collider().run(POSES).digest(),
        )
        self.assertEqual(self.collider(deformable=numpy.True_).arguments["deformable"], [0, 1])

    def test_what_is_no_mistake(self):
        self.assertEqual(self.collider(motion="linear").settings["decision"], "exact")
        self.assertEqual(
            self.collider().run(numpy.array(POSES).view(numpy.recarray)).digest(),
            self.collider().run(POSES).digest(),
            "other subclasses of arrays are taken",
        )

    def test_matrices_may_differ_from_rotations_by_rounding(self):
        """By 1e-4 of a length: a scale of all axes or of one, or an angle between two axes, also after a rotation."""
        collider, turn = self.collider(), numpy.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
        expected = collider.count(numpy.tile(numpy.eye(4), (2, 1, 1)))
        stretched = lambda by: numpy.eye(3) * (1 + by)
        one_axis = lambda by: numpy.diag([1, 1 + by, 1])
        sheared = lambda by: numpy.eye(3) + by * numpy.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]])
        for deformed in (stretched, one_axis, sheared):
            for sign in (-1, 1):
                for rotation in (numpy.eye(3), turn):
                    matrices = numpy.tile(numpy.eye(4), (2, 1, 1))
                    matrices[:, :3, :3] = rotation @ deformed(sign * 0.99e-4)
                    self.assertGreater(collider.count(matrices), expected // 2)
                    matrices[1, :3, :3] = rotation @ deformed(sign * 1.01e-4)
                    with self.assertRaisesRegex(ValueError, "^poses: matrix 1 scales or shears"):
                        collider.count(matrices)


class Meshes(ColliderCase):
    def test_of_other_libraries(self):
        points, tets = self.meshes[0]
        expected = self.collider().pairs(POSES)
        for first in (
            other_mesh(points, tetra=tets),
            other_mesh(points, VTK=tets, triangle=tets[:, :3], vertex=tets[:, :1]),
            [points, tets],
            self.files[0].read_bytes(),
        ):
            with self.subTest(type(first).__name__):
                self.assertTrue((self.collider([first, self.files[1]]).pairs(POSES) == expected).all())

    def test_meshio(self):
        mesh = meshio.Mesh(
            self.meshes[0][0], [("triangle", self.meshes[0][1][:, :3]), ("tetra", self.meshes[0][1])]
        )
        self.assertTrue(
            (self.collider([mesh, self.files[1]]).pairs(POSES) == self.collider().pairs(POSES)).all()
        )

    def test_names_and_pickles(self):
        mesh = tandem.make_mesh(*self.meshes[0], "part")
        self.assertEqual(
            repr(mesh),
            f"<tandem.Mesh part: {len(mesh.vertices)} vertices, {len(mesh.tetrahedra)} tetrahedra>",
        )
        for twin in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
            self.assertEqual(twin.name, "part")
            self.assertTrue(
                (twin.vertices == mesh.vertices).all() and (twin.tetrahedra == mesh.tetrahedra).all()
            )
        collider = self.collider(
            deformable=[1],
            body_groups=[[0], [1]],
            meets=[None, {0}],
            never_meet=[(0, 0)],
            k=12,
            device="opencl:0",
        )
        self.assertEqual(repr(collider), "<tandem.Collider: 2 bodies, tiled on opencl:0>")
        arguments = pickle.loads(pickle.dumps(collider.arguments))
        twin = tandem.Collider(self.meshes, **arguments)
        self.assertEqual(
            (twin.settings, twin.devices, twin.arguments),
            (collider.settings, collider.devices, collider.arguments),
        )
        self.assertEqual(twin.run(POSES).digest(), collider.run(POSES).digest())
        self.assertEqual(pickle.loads(pickle.dumps(collider.settings)), collider.settings)
        for function in (copy.copy, copy.deepcopy):
            with self.assertRaisesRegex(TypeError, "cannot be pickled or copied"):
                function(collider)
        self.assertRegex(
            repr(tandem.make_scene("pile:bodies=3")), "<tandem.Scene pile:.*: 3 bodies, [0-9]+ frames>"
        )


ONE_BODY = "there is one body, which setting self="
ALL_APART = "groups, meets and never_meet keep all bodies apart"


class NothingMeets(ColliderCase):
    def warned_of(self, *arguments, **options):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tandem.Collider(*arguments or [self.meshes], **options)
        for one in caught:
            self.assertEqual((one.category, one.filename), (UserWarning, __file__))
        return [str(one.message) for one in caught]

    def test_gives_one_warning(self):
        one = [self.meshes[0]]
        apart = {"body_groups": [[0], [1]], "meets": [[0], [1]], "worlds": 2}
        for words, arguments, options in (
            (ONE_BODY + "off does not pair with itself; choose self=on, or add a body", [one], {}),
            (ONE_BODY + "deformable does not pair with itself", [one], {"self_collision": "deformable"}),
            (ONE_BODY + "off", [one], {"worlds": 3, "deformable": True}),
            (ONE_BODY + "off", [one], {"algorithm": "auto"}),
            (ALL_APART, [], {"never_meet": [(0, 1), (1, 0)]}),
            (ALL_APART, [], apart),
            ("", [one], {"self_collision": True}),
            ("", [one], {"self_collision": "deformable", "deformable": True}),
            ("", [], {}),
            ("", [one], {"bodies": [0, 0]}),
            ("", [], {"never_meet": [(0, 0)]}),
            ("", [], {"worlds": 2}),
        ):
            with self.subTest(words, **options):
                texts = self.warned_of(*arguments, **options)
                self.assertEqual(len(texts), 1 if words else 0)
                self.assertTrue(all(text.startswith(f"nothing can meet: {words}") for text in texts), texts)
