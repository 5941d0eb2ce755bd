# SPDX-License-Identifier: MIT
# test: cost=6
"""tandem convert brings files of other formats to .vtu, which gives the answer of
the same mesh in a format of tandem's own; bad files and outputs are refused in one line."""

import os

import meshio

from tests.program import Case, bar, gmsh

POSES = ("--pose", "0 0 0 1 0 0 0", "--pose", "1 0.25 0.125 1 0 0 0")


class Convert(Case):
    def setUp(self):
        self.points, self.tets = bar(3, (0, 0, 0))

    def answer(self, path):
        """Digests of pairs and contacts of two bodies of a mesh."""
        out = self.work / "answer.jsonl"
        out.unlink(missing_ok=True)
        self.output(
            f"run --mesh {path} --mesh {path}", *POSES, f"--device host --algorithm tiled --out {out} --quiet"
        )
        [record] = self.records(out)
        self.assertGreater(record["work"]["candidate_pairs"][0], 0)
        return {name: record["agreement"][name] for name in ("digest", "contact_digest")}

    def converted(self, source):
        output = self.work / "converted.vtu"
        output.unlink(missing_ok=True)
        out = self.output("convert", source, "-o", output)
        self.assertEqual(
            out, f"{output}: {len(self.points)} vertices and {len(self.tets)} tetrahedra of {source}\n"
        )
        return output

    def test_formats_of_meshio_give_the_same_answer(self):
        expected = self.answer(gmsh(self.work / "own.msh", self.points, self.tets))
        self.assertTrue(expected)
        for suffix in (".inp", ".bdf", ".xdmf", ".med", ".e", ".su2"):
            with self.subTest(suffix):
                source = self.work / f"mesh{suffix}"
                meshio.Mesh(self.points, [("tetra", self.tets)]).write(source)
                self.assertEqual(self.answer(self.converted(source)), expected)

    def test_both_forms_of_tet(self):
        expected = self.answer(gmsh(self.work / "own.msh", self.points, self.tets))
        vertices = "".join("%r %r %r\n" % tuple(point) for point in self.points)
        first, second = self.work / "a.tet", self.work / "b.tet"
        first.write_text(
            f"tet {len(self.points)} {len(self.tets)}\n"
            + vertices
            + "".join("%d %d %d %d\n" % tuple(tet) for tet in self.tets)
        )
        second.write_text(
            f"{len(self.points)} vertices\n{len(self.tets)} tets\n"
            + vertices
            + "".join("4 %d %d %d %d\n" % tuple(tet) for tet in self.tets)
        )
        for path in (first, second):
            with self.subTest(path.name):
                self.assertEqual(self.answer(self.converted(path)), expected)
        second.write_text(second.read_text() + "4 0 1 2\n")
        self.bad(["b.tet", "words for"], "convert", second, "-o", self.work / "x.vtu")
        second.write_text("vertices\n")
        self.bad("is no .tet file", "convert", second, "-o", self.work / "x.vtu")

    def test_t_has_numbered_vertices(self):
        """With properties and edges, as MeshLib writes them; numbers have gaps."""
        expected = self.answer(gmsh(self.work / "own.msh", self.points, self.tets))
        numbers = [7 + 3 * i for i in range(len(self.points))]
        vertices = "".join(
            f"Vertex {n} %r %r %r {{rgb=(1 0 0)}}\r\n" % tuple(point)
            for n, point in zip(numbers, self.points)
        )
        tets = "".join(
            f"Tet {i} %d %d %d %d{{group=1}}\n" % tuple(numbers[v] for v in tet)
            for i, tet in enumerate(self.tets)
        )
        source = self.work / "mesh.t"
        source.write_text(vertices + tets + "\nEdge 7 10 {sharp}\n")
        self.bad("tandem convert", "run", "--mesh", source)
        self.assertEqual(self.answer(self.converted(source)), expected)
        last = len(vertices.splitlines()) + 1
        for wrong, message in (
            ("Tet 0 7 10 13 14\n", f":{last}: there is no vertex 14 above"),
            ("Tet 0 7 10 13\n", f":{last}: is no line"),
            ("Tet 0 7 10 13 16 19\n", f":{last}: is no line"),
            ("Vertex 7 0 0 0\n", f":{last}: is no line"),
            ("Vertex 8 0 0\n", f":{last}: is no line"),
            ("Vertex 8 0 0 x\n", f":{last}: is no line"),
            ("Edge 7 10\n", "no tetrahedra"),
        ):
            with self.subTest(wrong):
                source.write_text(vertices + wrong)
                self.bad(message, "convert", source, "-o", self.work / "x.vtu")

    def test_bad_files_and_outputs(self):
        out, source = self.work / "out.vtu", self.work / "mesh.inp"
        meshio.Mesh(self.points, [("tetra", self.tets)]).write(source)
        surface, broken = self.work / "surface.inp", self.work / "broken.inp"
        meshio.Mesh(self.points, [("triangle", [tet[:3] for tet in self.tets])]).write(surface)
        broken.write_text("*NODE\n1, 0, x, 0\n")
        self.bad("there is no such file", "convert", self.work / "none.inp", "-o", out)
        self.bad("no tetrahedra; export the volume", "convert", surface, "-o", out)
        self.bad("broken.inp: meshio cannot read it", "convert", broken, "-o", out)
        self.bad("name a file FILE.vtu", "convert", source, "-o", self.work / "out.vtk")
        self.bad("cannot be written", "convert", source, "-o", self.work / "none/out.vtu")
        self.assertFalse(out.exists())
        before, linked = source.read_bytes(), self.work / "linked.vtu"
        os.link(source, linked)
        self.bad("linked.vtu", "convert", source, "-o", linked)
        self.assertEqual(source.read_bytes(), before)
