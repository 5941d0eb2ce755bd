# SPDX-License-Identifier: MIT
# test: cost=15 full=50
"""Tetrahedra of zero volume, numbers that are not finite, and a truth too large for
memory."""

import math

from tests.program import LONG, SOURCE, Case, bar, gmsh, tandem, write_json


class Flawed(Case):
    def test_flawed_tetrahedra(self):
        flat, _ = self.flawed("flat.msh")
        meshes = (f"--mesh {flat} --mesh {self.good} --pose '0 0 0 1 0 0 0' --pose '-0.125 0.25 0 1 0 0 0'",)
        named = "1 of zero volume in 1 of 2 bodies: body 0 tetrahedron 24 in frame 0"
        found, inputs, keys = {}, {}, {}
        for handling in ("flat", "skip"):
            pairs, out = self.work / f"{handling}.csv", self.work / f"{handling}.jsonl"
            for device in ("host", "opencl:0"):
                text = self.output(
                    "run",
                    *meshes,
                    f"--degenerate {handling} --device {device} --algorithm chunked --dump-pairs {pairs} "
                    f"--out {out} --repeat 1",
                )
                self.assertIn("right: no pair missing", text)
                part = {"flat": "take part as flat sets", "skip": "take no part"}[handling]
                self.assertIn(f"tetrahedra {named}; they {part}\n", text)
                found[handling, device] = self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1]
            record = self.records(out)[1]
            inputs[handling], keys[handling] = record["error"]["inputs"], record["key"]
            truth = record["error"]["truth"]
            self.assertEqual(truth["missed_touching"] + truth["missed_overlapping"], 0)
        self.assertEqual(found["flat", "host"], found["flat", "opencl:0"])
        self.assertTrue(any(pair[2] == 24 for pair in found["flat", "host"]))
        for device in ("host", "opencl:0"):
            self.assertEqual(found["skip", device], [pair for pair in found["flat", "host"] if pair[2] != 24])
        body = {"body": 0, "degenerate": 1, "non_finite": 0, "frame": 0, "first": [24]}
        numbers = {"degenerate_elements": 1, "non_finite_elements": 0, "flawed_bodies": 1}
        self.assertEqual(inputs["flat"], {"handling": "flat", **numbers, "bodies": [body]})
        self.assertEqual(inputs["skip"], {**inputs["flat"], "handling": "skip"})
        self.assertEqual(keys["skip"], keys["flat"].replace("|0:0|", "|0:0,degenerate=skip|"))
        self.output(
            f"run {self.twice} --degenerate skip --device host --repeat 1 --out {self.work}/unflawed.jsonl"
        )
        record = self.records(self.work / "unflawed.jsonl")[0]
        self.assertNotIn("degenerate", record["key"])
        inputs = record["error"]["inputs"]
        self.assertEqual((inputs["flawed_bodies"], inputs["bodies"]), (0, []))
        out = self.work / "rejected.jsonl"
        for command in ("run", "check", "accuracy"):
            words = [f"--degenerate reject: tetrahedra {named};", "flat or skip"]
            self.bad(words, command, *meshes, f"--degenerate reject --device host --out {out}")
        self.assertEqual(out.read_text() if out.exists() else "", "")
        self.bad("--degenerate some: give flat, skip or reject", "run", "plates", "--degenerate", "some")
        words = "degenerate is no setting of a cell but of the frames, for all cells; give --degenerate skip"
        self.bad(f"--set degenerate=skip: {words}", "run plates --set degenerate=skip")

    def test_many_flawed_bodies_are_counted_and_the_first_named(self):
        flat, _ = self.flawed("many.msh")
        out = self.work / "many.jsonl"
        meshes = [part for i in range(20) for part in ("--mesh", flat)]
        text = self.output(
            "run", *meshes, "--device", "host", "--algorithm", "chunked", "--repeat", 1, "--out", out
        )
        inputs = self.records(out)[0]["error"]["inputs"]
        self.assertEqual((inputs["degenerate_elements"], inputs["flawed_bodies"]), (20, 20))
        self.assertEqual([body["body"] for body in inputs["bodies"]], list(range(16)))
        self.assertIn("body 3 tetrahedron 24 in frame 0; ...; they take part", text)

    def test_numbers_that_are_not_finite(self):
        scene = "hard:not-finite:pairs=4,together=2"
        for command in ("run", "check", "accuracy"):
            for handling in ((), ("--degenerate", "flat"), ("--degenerate", "reject")):
                self.bad(
                    "4 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1, ... in frame 0;",
                    f"{command} {scene} --device host",
                    *handling,
                )
        for arguments in (
            ("check", scene, *(() if LONG else ("--preset", "grouped,resident,fair"))),
            ("run", scene, "--repeat", 1),
        ):
            out = self.work / f"{arguments[0]}-finite.jsonl"
            text = self.output(*arguments, "--degenerate", "skip", "--out", out, "--truth", "contacts")
            self.assertIn(
                "tetrahedra 4 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1, ... in frame 0; they take no part",
                text,
            )
            for record in self.records(out):
                self.assertEqual((record["status"], sum(record["work"]["candidate_pairs"])), ("ok", 0))
                self.assertEqual(record["error"]["inputs"]["non_finite_elements"], 4)

    def run_cell(self, *words):
        """The record of a cell, and the lines below its answer."""
        out = self.work / f"cell{len(list(self.work.iterdir()))}.jsonl"
        text = self.output(
            "run", *words, "--device", "host", "--algorithm", "tiled", "--repeat", 1, "--out", out
        )
        self.assertIn("right: no pair missing", text)
        return self.records(out)[0], [
            line for line in text.splitlines() if "contact_rule=sat gives" in line or "cannot resolve" in line
        ]

    def test_contacts_deeper_than_a_body(self):
        """A rod of radius 0.02 on a coarse ground, a tetrahedron of 100 by 320 by 60: the right depth is 0.0617."""
        count = 32
        ring = [
            (0.02 * math.cos(2 * math.pi * i / count), 0.02 * math.sin(2 * math.pi * i / count))
            for i in range(count)
        ]
        points = [(*at, z) for z in (-0.07, 0.07) for at in ring] + [(0, 0, -0.07), (0, 0, 0.07)]
        tets = [
            tet
            for i, j in ((i, (i + 1) % count) for i in range(count))
            for tet in ([64, i, j, count + i], [64, j, count + j, count + i], [64, count + i, count + j, 65])
        ]
        rod = gmsh(self.work / "rod.msh", points, tets)
        ground = gmsh(
            self.work / "ground.msh", [(0, 0, 0), (100, 320, 0), (0, 320, 0), (33, 213, -60)], [[0, 2, 1, 3]]
        )
        cell = (
            f"--mesh {ground} --mesh {rod} --pose '0 0 0 1 0 0 0' "
            "--pose '28.87991333 260.53430176 0.00036136055 0.77515626 -0.16498479 0.36682746 -0.48718625'",
        )
        for isolate in ((), ("--isolate",)):
            record, lines = self.run_cell(*cell, *isolate)
            deep = record["error"]["deep_contact"]
            self.assertEqual((deep["frame"], deep["body_a"], deep["tet_a"], deep["body_b"]), (0, 0, 0, 1))
            self.assertAlmostEqual(deep["depth"], -29.09, delta=0.01)
            self.assertAlmostEqual(deep["size"], math.hypot(0.04, 0.04, 0.14), delta=1e-6)
            self.assertEqual(
                lines,
                [
                    f"contact_rule=opposing: a contact of frame 0, of body 0 tetrahedron 0 and body 1 tetrahedron {deep['tet_b']}, is 29.1 m deep, "
                    "but the smaller body is 0.151 m long; contact_rule=sat gives the least depth"
                ],
            )
        for words in (("--set", "contact_rule=sat"), ("--no-check",), ("--set", "output=digest")):
            status, text, errors = tandem(
                "run",
                *cell,
                *words,
                f"--device host --algorithm tiled --repeat 1 --out {self.work}/none.jsonl --truth none",
            )
            self.assertEqual((status, errors, "the smaller body is" in text), (0, [], False), text)
        self.assertEqual(
            [record["error"]["deep_contact"] for record in self.records(self.work / "none.jsonl")], [None] * 3
        )

    def test_single_precision_that_cannot_resolve_a_mesh(self):
        points, tets = bar(2, (0, 0, 0))
        near, far = gmsh(self.work / "near.msh", points, tets), 2.0**33
        pose = f"{far} 0 0 1 0 0 0"
        cell = ("--mesh", near, "--mesh", near, "--pose", pose, "--pose", pose)
        record, lines = self.run_cell(*cell, "--set", "origin=world")
        self.assertEqual(record["error"]["flattened"], 2 * len(tets))
        self.assertEqual(
            lines,
            [
                f"single precision cannot resolve mesh near of body 0: {len(tets)} of {len(tets)} tetrahedra become flat; use precision=double or origin=auto"
            ],
        )
        for words in (("--set", "precision=double"), ("--set", "origin=auto")):
            record, lines = self.run_cell(*cell, *words)
            self.assertEqual((record["error"]["flattened"], lines), (0, []))
        flat, _ = self.flawed("still.msh")  # a tetrahedron that is flat in double, too
        self.assertEqual(self.run_cell("--mesh", flat, "--mesh", near)[0]["error"]["flattened"], 0)
        for frame in (0, 1):
            gmsh(self.work / f"moved{frame}.msh", [(x + far, y, z) for x, y, z in points], tets)
        scene = self.work / "deforming.json"
        write_json(
            scene,
            frames=2,
            meshes={"a": {"file": "near.msh"}},
            bodies=[
                {"mesh": "a", "position": [far, 0, 0], "fixed": True},
                {"mesh": "a", "series": ["moved0.msh", "moved1.msh"]},
            ],
        )
        self.assertEqual(
            self.run_cell(scene, "--set", "origin=world")[0]["error"]["flattened"], 2 * len(tets)
        )

    def test_files_with_numbers_that_are_not_finite(self):
        """Refused by their readers, whatever --degenerate is, and its help and page say so."""
        points, tets = bar(2, (0, 0, 0))
        points[5] = (points[5][0], float("nan"), points[5][2])
        broken, scene = gmsh(self.work / "broken.msh", points, tets), self.work / "moving.json"
        whole = gmsh(self.work / "whole.msh", *bar(2, (0, 0, 0)))
        write_json(
            scene,
            frames=2,
            meshes={"a": {"file": "whole.msh"}},
            bodies=[{"mesh": "a", "series": ["whole.msh", "broken.msh"]}],
        )
        for handling in ("flat", "skip", "reject"):
            for words in (("--mesh", whole, "--mesh", broken), (scene,)):
                self.bad(
                    "broken.msh:11: coordinate y 'nan' is not finite; repair the mesh",
                    "run",
                    *words,
                    f"--device host --degenerate {handling}",
                )
        self.assertIn(
            "files with coordinates that are not finite are always refused",
            " ".join(tandem("run", "--help")[1].split()),
        )
        self.assertIn(
            "A file with a coordinate that is not finite is refused, whatever `--degenerate` says",
            (SOURCE / "docs/user/own_data.md").read_text(),
        )

    def test_a_truth_too_large_for_memory(self):
        """Slivers along a diagonal: all their boxes overlap and would need more memory than there is; their 18-DOPs
        do not overlap. Then many frames, each of which fits into memory, but not all together."""
        count = 9000

        def slivers(path, shift):
            points, tets = [], []
            for i in range(count):
                x, y = 1e-4 * i + shift, -1e-4 * i - shift
                tets.append(list(range(len(points), len(points) + 4)))
                points += [(x, y, 0), (x + 1e-6, y, 0), (x, y + 1e-6, 0), (x + 10, y + 10, 10)]
            return gmsh(path, points, tets)

        meshes = slivers(self.work / "slivers.msh", 0), slivers(self.work / "others.msh", 5e-5)
        environment = {"OCL_ICD_VENDORS": str(self.work), "MALLOC_ARENA_MAX": "1"}
        limited = lambda *more: tandem(
            f"run --mesh {meshes[0]} --mesh {meshes[1]} --device host --algorithm chunked --repeat 1",
            "--no-check --check-afresh",
            *more,
            environment=environment,
            address_space=3 << 30,
        )
        status, _, errors = limited()
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertRegex(
            errors[0],
            r"the exact truth of 18000 tetrahedra with at least \d+ pairs near each other may take \d.\d\d GiB, "
            r"and \d.\d\d GiB are free; choose --truth none, fewer frames or fewer bodies",
        )
        self.assertEqual(limited("--truth", "none")[::2], (0, []))
        frames = (
            "run hard:ties:pairs=300000,together=1000 --device host --algorithm chunked --repeat 1 "
            "--no-check --check-afresh --set contact_rule=none",
        )
        status, _, errors = tandem(*frames, environment=environment, address_space=3 << 30)
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn("the exact truth of 300 frames like the first takes", errors[0])
        self.output(*frames, "--frames", "0:1", environment=environment, address_space=3 << 30)
