#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""flawed.py PROGRAM SOURCE: tetrahedra of zero volume, numbers that are not finite, and a truth too large for
memory."""
import sys
import unittest

from program import LONG, Case, gmsh, tandem


class Flawed(Case):
    def test_flawed_tetrahedra(self):
        flat, _ = self.flawed("flat.msh")
        meshes = ("--mesh", flat, "--mesh", self.good, "--pose", "0 0 0 1 0 0 0", "--pose", "-0.125 0.25 0 1 0 0 0")
        found, inputs, keys = {}, {}, {}
        for handling in ("flat", "skip"):
            pairs, out = self.work / f"{handling}.csv", self.work / f"{handling}.jsonl"
            for device in ("host", "opencl:0"):
                status, text, errors = tandem("run", *meshes, "--degenerate", handling, "--device", device, "--algorithm", "chunked",
                                              "--dump-pairs", pairs, "--out", out, "--repeat", 1)
                self.assertEqual((status, errors), (0, []), text)
                self.assertIn(": right: ", text)
                part = {"flat": "take part as flat sets", "skip": "take no part"}[handling]
                self.assertIn(f"tetrahedra 1 of zero volume in 1 of 2 bodies: body 0 tetrahedron 24 in frame 0; they {part}\n", text)
                found[handling, device] = self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1]
            record = self.records(out)[1]
            inputs[handling], keys[handling] = record["error"]["inputs"], record["key"]
            self.assertEqual(record["error"]["truth"]["missed_touching"] + record["error"]["truth"]["missed_overlapping"], 0)
        self.assertEqual(found["flat", "host"], found["flat", "opencl:0"])
        self.assertTrue(any(pair[2] == 24 for pair in found["flat", "host"]))
        for device in ("host", "opencl:0"):
            self.assertEqual(found["skip", device], [pair for pair in found["flat", "host"] if pair[2] != 24])
        body = {"body": 0, "degenerate": 1, "non_finite": 0, "frame": 0, "first": [24]}
        self.assertEqual(inputs["flat"], {"handling": "flat", "degenerate_elements": 1, "non_finite_elements": 0, "flawed_bodies": 1,
                                          "bodies": [body]})
        self.assertEqual(inputs["skip"], {**inputs["flat"], "handling": "skip"})
        self.assertEqual(keys["skip"], keys["flat"].replace("|0:0|", "|0:0,degenerate=skip|"))
        status, text, errors = tandem("run", "--mesh", self.good, "--mesh", self.good, "--degenerate", "skip", "--device", "host",
                                      "--repeat", 1, "--out", self.work / "unflawed.jsonl")
        self.assertEqual((status, errors), (0, []), text)
        record = self.records(self.work / "unflawed.jsonl")[0]
        self.assertNotIn("degenerate", record["key"])
        self.assertEqual((record["error"]["inputs"]["flawed_bodies"], record["error"]["inputs"]["bodies"]), (0, []))
        out = self.work / "rejected.jsonl"
        for command in ("run", "check", "accuracy"):
            self.bad(["--degenerate reject: tetrahedra 1 of zero volume in 1 of 2 bodies: body 0 tetrahedron 24 in frame 0;", "flat or skip"],
                     command, *meshes, "--degenerate", "reject", "--device", "host", "--out", out)
        self.assertEqual(out.read_text() if out.exists() else "", "")
        self.bad("--degenerate some: give flat, skip or reject", "run", "plates", "--degenerate", "some")
        self.bad("--set degenerate=skip: degenerate is no setting of a cell but of the frames, for all cells; give --degenerate skip", "run", "plates", "--set",
                 "degenerate=skip")

    def test_many_flawed_bodies_are_counted_and_the_first_named(self):
        flat, _ = self.flawed("many.msh")
        out = self.work / "many.jsonl"
        meshes = [part for i in range(20) for part in ("--mesh", flat)]
        status, text, errors = tandem("run", *meshes, "--device", "host", "--algorithm", "chunked", "--repeat", 1, "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        inputs = self.records(out)[0]["error"]["inputs"]
        self.assertEqual((inputs["degenerate_elements"], inputs["flawed_bodies"]), (20, 20))
        self.assertEqual([body["body"] for body in inputs["bodies"]], list(range(16)))
        self.assertIn("body 3 tetrahedron 24 in frame 0; ...; they take part", text)

    def test_numbers_that_are_not_finite(self):
        scene = "hard:not-finite:pairs=4,together=2"
        for command in ("run", "check", "accuracy"):
            for handling in ((), ("--degenerate", "flat"), ("--degenerate", "reject")):
                self.bad("4 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1, ... in frame 0;", command, scene, "--device", "host",
                         *handling)
        for arguments in (("check", scene, *(() if LONG else ("--preset", "grouped,resident,fair"))), ("run", scene, "--repeat", 1)):
            out = self.work / f"{arguments[0]}-finite.jsonl"
            status, text, errors = tandem(*arguments, "--degenerate", "skip", "--out", out, "--truth", "contacts")
            self.assertEqual((status, errors), (0, []), text)
            self.assertIn("tetrahedra 4 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1, ... in frame 0; they take no part", text)
            for record in self.records(out):
                self.assertEqual((record["status"], sum(record["work"]["candidate_pairs"])), ("ok", 0))
                self.assertEqual(record["error"]["inputs"]["non_finite_elements"], 4)

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

        meshes = ("--mesh", slivers(self.work / "slivers.msh", 0), "--mesh", slivers(self.work / "others.msh", 5e-5))
        environment = {"OCL_ICD_VENDORS": str(self.work), "MALLOC_ARENA_MAX": "1"}
        limited = lambda *more: tandem("run", *meshes, "--device", "host", "--algorithm", "chunked", "--repeat", 1, "--no-check", "--check-afresh", *more,
                                       environment=environment, address_space=3 << 30)
        status, _, errors = limited()
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertRegex(errors[0], r"the exact truth of 18000 tetrahedra with at least \d+ pairs near each other may take \d.\d\d GiB, "
                                    r"and \d.\d\d GiB are free; choose --truth none, fewer frames or fewer bodies")
        self.assertEqual(limited("--truth", "none")[::2], (0, []))
        frames = ("run", "hard:ties:pairs=300000,together=1000", "--device", "host", "--algorithm", "chunked", "--repeat", 1,
                  "--no-check", "--check-afresh", "--set", "contact_rule=none")
        status, _, errors = tandem(*frames, environment=environment, address_space=3 << 30)
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn("the exact truth of 300 frames like the first takes", errors[0])
        status, _, errors = tandem(*frames, "--frames", "0:1", environment=environment, address_space=3 << 30)
        self.assertEqual((status, errors), (0, []))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
