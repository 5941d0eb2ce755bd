# SPDX-License-Identifier: MIT
# test: cost=5
"""Pressure fields of meshes: from files and by --pressure, in every command that reads meshes, in plans, child
processes, recordings and exports; what is told about them, and what is refused."""

from tests.program import Case, cubes, gmsh, node_data, tandem, write_json

RULE = "--device host --algorithm tiled --set contact_rule=pressure"
PILE = "pile:bodies=2,refine=1"
POSES = "--pose '0 0 0 1 0 0 0' --pose '0.3 0.2 0.1 1 0 0 0'"


FIELD = [float(vertex == 13) * 1e7 for vertex in range(27)]  # that of --pressure 1e7


class Pressures(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.plain = gmsh(cls.work / "plain.msh", *cubes())
        cls.own = cls.file("own.msh", node_data(FIELD))

    @classmethod
    def file(cls, name, data):
        """The cubes with more at the end of their file."""
        path = cls.work / name
        path.write_text(cls.plain.read_text() + data)
        return path

    def run_of(self, *arguments):
        """The record of a run whose polygons are right, and its messages."""
        out = self.work / "run.jsonl"
        out.unlink(missing_ok=True)
        status, text, errors = tandem(*arguments, RULE, f"--out {out}")
        self.assertEqual(status, 0, (text, errors))
        (record,) = self.records(out)
        self.assertEqual(record["agreement"]["extra"], 0)
        return record, errors

    def polygons(self, *arguments):
        """Number and digest of the contacts of a run without messages."""
        record, errors = self.run_of(*arguments)
        self.assertEqual(errors, [])
        return record["work"]["contacts"], record["agreement"]["contact_digest"]

    def beside(self, first, second):
        return f"run --mesh {first} --mesh {second} {POSES}"

    def test_files_and_the_option_give_the_same_field(self):
        right = self.polygons(self.beside(self.own, self.own))
        self.assertGreater(right[0][0], 10)
        for first, second in ((self.plain, self.plain), (self.plain, self.own)):
            self.assertEqual(self.polygons(self.beside(first, second), "--pressure 1e7"), right)
        kept = self.run_of(self.beside(self.own, self.own), "--pressure 3")[0]
        self.assertEqual(kept["agreement"]["contact_digest"], right[1], "a field of a file is kept")
        self.assertEqual(kept["scene"]["reading"]["pressure"], 3)
        self.assertIsNone(self.run_of(self.beside(self.own, self.own))[0]["scene"]["reading"]["pressure"])
        self.assertNotEqual(self.polygons(self.beside(self.plain, self.own), "--pressure 3"), right)

    def test_kinds_plans_and_child_processes(self):
        right = self.polygons(f"run {PILE}", "--pressure 1e7")
        self.assertGreater(right[0][0], 0)
        self.assertEqual(self.polygons(f"run {PILE}", "--pressure 1e7 --isolate"), right)
        plan = self.work / "plan.json"
        settings = {"contact_rule": "pressure"}
        measure = {"pressure": 1e7, "repeat": 1}
        write_json(plan, plan="fields", scenes=PILE, settings=settings, measure=measure)
        self.assertEqual(self.polygons(f"run {plan}"), right)
        other = self.run_of(f"run {PILE} --pressure 2e7")[0]
        self.assertNotEqual(other["key"], self.run_of(f"run {PILE} --pressure 1e7")[0]["key"])

    def test_scenes_with_fields_of_their_own(self):
        spheres = "run spheres:hint=2 --frames 0 --repeat 1"
        right = self.polygons(spheres)
        self.assertGreater(right[0][0], 100)
        self.assertEqual(self.polygons(spheres, "--pressure 3"), right, "the scene's field is kept")
        sums, errors = self.run_of(
            "run grippers:worlds=3 --frames 10 --repeat 1 --set output=wrenches --truth none"
        )
        self.assertEqual((sums["work"]["contacts"], errors), ([6], []))

    def test_slabs_of_pressures(self):
        """Pairs without a common pressure are left out, by the truth, too: none counts as missed."""
        found = {}
        for slab in ("off", "on"):
            options = f"--frames 0 --repeat 1 --truth pairs --set pressure_slab={slab}"
            record, errors = self.run_of(f"run spheres:hint=1 {options}")
            self.assertEqual((record["status"], errors), ("ok", []))
            errors = record["error"]["truth"]
            self.assertEqual((errors["missed_touching"], errors["missed_overlapping"]), (0, 0))
            found[slab] = record["work"]["candidate_pairs"][0], record["work"]["contacts"][0]
        self.assertLess(found["on"][0], 0.6 * found["off"][0])
        self.assertEqual(found["on"][1], found["off"][1])

    def test_what_is_told(self):
        message = "tandem: scene meshes: 1 of 2 bodies have no pressure field and make no polygons (--pressure MODULUS gives them one)"
        told = self.run_of(self.beside(self.own, self.plain))
        self.assertEqual(told[1], [message])
        self.assertEqual(told[0]["work"]["contacts"], [0])
        status, _, errors = tandem(
            self.beside(self.own, self.plain), RULE.replace("tiled", "tiled,leaf_query")
        )
        self.assertEqual((status, errors), (0, [message]), "once for all cells")
        self.assertEqual(tandem(self.beside(self.own, self.plain), "--device host --algorithm tiled")[2], [])
        loaded = self.file("loaded.msh", node_data([0.5, *FIELD[1:]]))
        self.assertEqual(
            self.run_of(self.beside(loaded, self.own))[1],
            ["tandem: mesh loaded: the pressure is not 0 on the whole boundary, but up to 0.5"],
        )
        self.assertEqual(
            self.run_of(self.beside(self.good, self.own), "--pressure 1e7")[1],
            [
                "tandem: mesh good: no vertex lies inside, so that the pressure is 0 everywhere; refine the mesh"
            ],
        )
        self.bad(
            "no mesh of scene meshes has one; give --pressure", self.beside(self.plain, self.plain), RULE
        )

    def test_bad_moduli(self):
        for value in ("0", "-1", "nan", "inf", "1e39"):
            for command in (
                "run plates",
                "check plates",
                "accuracy plates",
                "export plates --vtu x",
                "simulate jacks",
            ):
                self.bad(
                    f"--pressure {value}: give a modulus above 0, at most 3.4e+38"
                    if value != "1e39"
                    else "give a modulus",
                    f"{command} --pressure={value}",
                )
        self.bad("--pressure", "run plates --pressure=high")
        write_json(self.work / "bad.plan.json", plan="bad", scenes="plates", measure={"pressure": 0})
        self.bad("pressure 0: give a modulus", "run", self.work / "bad.plan.json")

    def test_bad_files(self):
        for name, values, words in (
            (
                "few",
                FIELD[:-1],
                "few.msh:119: $NodeData pressure leaves out 1 of 27 nodes, such as node 27; give",
            ),
            ("negative", [-1.0, *FIELD[1:]], "negative.msh: the pressure of vertex 0 is -1; pressures are"),
            ("nan", [float("nan"), *FIELD[1:]], "a pressure 'nan' is not finite; repair"),
        ):
            with self.subTest(name):
                self.bad(words, self.beside(self.file(f"{name}.msh", node_data(values)), self.own), RULE)

    def test_recordings(self):
        plain, fields = self.work / "plain.frames", self.work / "fields.frames"
        motion = "simulate jacks:bodies=2,refine=1 --steps 2 --device host --quiet"
        tandem(motion, f"-o {plain}")
        tandem(motion, f"--pressure 1e7 -o {fields}")
        self.assertEqual(len(plain.read_bytes()), len(fields.read_bytes()))
        for recording in (plain, fields):
            record, _ = self.run_of(f"run {recording} --pressure 1e7")
            self.assertEqual(record["scene"]["reading"]["pressure"], 1e7)
        self.bad("give --duplicates, --weld and --pressure as its simulation had them", f"run {fields}", RULE)

    def test_exports(self):
        folder = self.work / "vtu"
        self.output(f"export --mesh {self.plain} --pressure 1e7 --vtu {folder}")
        exported = folder / "bodies_000000.vtu"
        self.assertIn('Name="pressure"', exported.read_text())
        self.assertEqual(
            self.polygons(self.beside(exported, exported)), self.polygons(self.beside(self.own, self.own))
        )
        status, _, errors = tandem(f"export --mesh {self.own} --mesh {self.plain} --vtu {self.work / 'some'}")
        self.assertEqual(
            (status, errors),
            (0, ["tandem: scene meshes: 1 of 2 bodies have no pressure field, so that --vtu writes none"]),
        )
