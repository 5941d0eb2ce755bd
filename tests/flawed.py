#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""flawed.py PROGRAM SOURCE: tetrahedra of zero volume, numbers that are not finite, and a truth too large for
memory."""

import json
import math
import sys
import unittest

from program import LONG, SOURCE, Case, bar, gmsh, tandem


class Flawed(Case):
    def test_flawed_tetrahedra(self):
        flat, _ = self.flawed("flat.msh")
        meshes = (
            "--mesh",
            flat,
            "--mesh",
            self.good,
            "--pose",
            "0 0 0 1 0 0 0",
            "--pose",
            "-0.125 0.25 0 1 0 0 0",
        )
        found, inputs, keys = {}, {}, {}
        for handling in ("flat", "skip"):
            pairs, out = self.work / f"{handling}.csv", self.work / f"{handling}.jsonl"
            for device in ("host", "opencl:0"):
                status, text, errors = tandem(
                    "run",
                    *meshes,
                    "--degenerate",
                    handling,
                    "--device",
                    device,
                    "--algorithm",
                    "chunked",
                    "--dump-pairs",
                    pairs,
                    "--out",
                    out,
                    "--repeat",
                    1,
                )
                self.assertEqual((status, errors), (0, []), text)
                self.assertIn(": right: ", text)
                part = {"flat": "take part as flat sets", "skip": "take no part"}[handling]
                self.assertIn(
                    f"tetrahedra 1 of zero volume in 1 of 2 bodies: body 0 tetrahedron 24 in frame 0; they {part}\n",
                    text,
                )
                found[handling, device] = self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1]
            record = self.records(out)[1]
            inputs[handling], keys[handling] = record["error"]["inputs"], record["key"]
            self.assertEqual(
                record["error"]["truth"]["missed_touching"] + record["error"]["truth"]["missed_overlapping"],
                0,
            )
        self.assertEqual(found["flat", "host"], found["flat", "opencl:0"])
        self.assertTrue(any(pair[2] == 24 for pair in found["flat", "host"]))
        for device in ("host", "opencl:0"):
            self.assertEqual(found["skip", device], [pair for pair in found["flat", "host"] if pair[2] != 24])
        body = {"body": 0, "degenerate": 1, "non_finite": 0, "frame": 0, "first": [24]}
        self.assertEqual(
            inputs["flat"],
            {
                "handling": "flat",
                "degenerate_elements": 1,
                "non_finite_elements": 0,
                "flawed_bodies": 1,
                "bodies": [body],
            },
        )
        self.assertEqual(inputs["skip"], {**inputs["flat"], "handling": "skip"})
        self.assertEqual(keys["skip"], keys["flat"].replace("|0:0|", "|0:0,degenerate=skip|"))
        status, text, errors = tandem(
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--degenerate",
            "skip",
            "--device",
            "host",
            "--repeat",
            1,
            "--out",
            self.work / "unflawed.jsonl",
        )
        self.assertEqual((status, errors), (0, []), text)
        record = self.records(self.work / "unflawed.jsonl")[0]
        self.assertNotIn("degenerate", record["key"])
        self.assertEqual(
            (record["error"]["inputs"]["flawed_bodies"], record["error"]["inputs"]["bodies"]), (0, [])
        )
        out = self.work / "rejected.jsonl"
        for command in ("run", "check", "accuracy"):
            self.bad(
                [
                    "--degenerate reject: tetrahedra 1 of zero volume in 1 of 2 bodies: body 0 tetrahedron 24 in frame 0;",
                    "flat or skip",
                ],
                command,
                *meshes,
                "--degenerate",
                "reject",
                "--device",
                "host",
                "--out",
                out,
            )
        self.assertEqual(out.read_text() if out.exists() else "", "")
        self.bad("--degenerate some: give flat, skip or reject", "run", "plates", "--degenerate", "some")
        self.bad(
            "--set degenerate=skip: degenerate is no setting of a cell but of the frames, for all cells; give --degenerate skip",
            "run",
            "plates",
            "--set",
            "degenerate=skip",
        )

    def pairs_of(self, *arguments):
        """Pairs and contacts, the lines on standard error, and scene.reading of the record."""
        pairs, contacts, out = (self.work / name for name in ("pairs.csv", "contacts.csv", "reading.jsonl"))
        out.unlink(missing_ok=True)
        status, text, errors = tandem(
            "run",
            *arguments,
            "--device",
            "host",
            "--repeat",
            1,
            "--dump-pairs",
            pairs,
            "--dump-contacts",
            contacts,
            "--out",
            out,
        )
        self.assertEqual(status, 0, errors)
        self.assertIn(": right: ", text)
        return (
            sorted(pairs.read_text().splitlines()),
            sorted(contacts.read_text().splitlines()),
            errors,
            self.records(out)[0]["scene"]["reading"],
        )

    def test_duplicates_and_torn_meshes(self):
        """A folded bar once, with each tetrahedron twice, and torn into tetrahedra of their own, on all
        algorithms, beside itself and with itself."""
        points, tets = bar(4, (0, 0, 0))
        points = [(abs(x - 1.5), y + x / 16, z) for x, y, z in points]  # folded, so that it meets itself
        whole = gmsh(self.work / "whole.msh", points, tets)
        twice = gmsh(self.work / "twice.msh", points, [*tets, *([d, b, a, c] for a, b, c, d in tets)])
        torn = gmsh(
            self.work / "torn.msh",
            [points[v] for tet in tets for v in tet],
            [list(range(4 * t, 4 * t + 4)) for t in range(len(tets))],
        )
        poses = ("--pose", "0 0 0 1 0 0 0", "--pose", "0.3 0.2 0.1 1 0 0 0")
        more = 4 * len(tets) - len(points)
        for algorithm in (
            one["name"] for one in json.loads(tandem("algorithms", "--json")[1]) if not one["baseline"]
        ):
            with self.subTest(algorithm):
                cell = (*poses, "--algorithm", algorithm, "--set", "self=on")
                right = self.pairs_of("--mesh", whole, "--mesh", whole, *cell)
                self.assertEqual(right[2], [])
                self.assertTrue(
                    any(row.split(",")[1] == row.split(",")[3] for row in right[0][1:]), "no pair of one body"
                )
                merged = self.pairs_of("--mesh", twice, "--mesh", twice, *cell)
                self.assertEqual(
                    merged[:3],
                    (
                        *right[:2],
                        [
                            f"tandem: mesh twice: {len(tets)} tetrahedra have the vertices of an earlier one and take no part"
                        ],
                    ),
                )
                self.assertEqual(
                    (merged[3]["handling"], merged[3]["duplicates"], merged[3]["weld"]),
                    ("merge", 2 * len(tets), None),
                )
                kept = self.pairs_of("--mesh", twice, "--mesh", twice, *cell, "--duplicates", "keep")
                self.assertEqual(
                    len([row for row in kept[0] if row.split(",")[1] != row.split(",")[3]]) - 1,
                    4 * (len([row for row in right[0] if row.split(",")[1] != row.split(",")[3]]) - 1),
                )
                welded = self.pairs_of("--mesh", torn, "--mesh", torn, *cell, "--weld", 0)
                self.assertEqual(
                    welded[:3],
                    (*right[:2], [f"tandem: mesh torn: {more} vertices are welded to an earlier one"]),
                )
                self.assertEqual((welded[3]["weld"], welded[3]["welded"]), (0, 2 * more))
                apart = self.pairs_of("--mesh", torn, "--mesh", torn, *cell)
                self.assertNotEqual(apart[:2], right[:2])
                self.assertEqual(
                    apart[2],
                    [
                        f"tandem: mesh torn: {more} vertices lie where an earlier one lies (--weld 0 joins them)"
                    ],
                )
        for command in ("run", "check", "accuracy", "export"):
            words = ("--vtu", self.work / "vtu") if command == "export" else ("--device", "host")
            self.bad(
                [
                    f"{len(tets)} of {2 * len(tets)} tetrahedra have the vertices of an earlier one, such as 24 those of 0"
                ],
                command,
                "--mesh",
                twice,
                "--duplicates",
                "reject",
                *words,
            )
        self.bad("--duplicates some: give merge, keep or reject", "run", "plates", "--duplicates", "some")
        for tolerance in ("-1", "nan", "inf"):
            self.bad(
                f"--weld {tolerance}: give a finite tolerance of 0 or more",
                "run",
                "plates",
                f"--weld={tolerance}",
            )

    def test_welded_halves_on_every_device(self):
        """A folded bar of two halves that have vertices of their own where they meet: welded, every algorithm
        on host and OpenCL leaves out pairs of a common welded vertex, and answers as for the bar in one
        piece."""
        points, tets = bar(4, (0, 0, 0))
        points = [(abs(x - 1.5), y + x / 16, z) for x, y, z in points]
        half = tets[len(tets) // 2 :]
        cut = sorted({v for tet in half for v in tet} & {v for tet in tets[: len(tets) // 2] for v in tet})
        own = {v: len(points) + i for i, v in enumerate(cut)}
        self.assertEqual(len(cut), 4)
        whole = gmsh(self.work / "joined.msh", points, tets)
        halves = gmsh(
            self.work / "halves.msh",
            points + [points[v] for v in cut],
            [*tets[: len(tets) // 2], *([own.get(v, v) for v in tet] for tet in half)],
        )

        def answers(mesh, *more):
            out = self.work / "halves.jsonl"
            out.unlink(missing_ok=True)
            status, text, _ = tandem(
                "check",
                "--mesh",
                mesh,
                "--mesh",
                mesh,
                "--pose",
                "0 0 0 1 0 0 0",
                "--pose",
                "0.3 0.2 0.1 1 0 0 0",
                "--set",
                "self=on",
                "--device",
                "host,opencl:0",
                *(() if LONG else ("--preset", "grouped,resident,fair")),
                "--out",
                out,
                *more,
            )
            self.assertEqual(status, 0, text)
            return {
                (record["algorithm"], *(device["id"] for device in record["devices"]), record["preset"]): (
                    record["agreement"]["digest"],
                    record["agreement"]["contact_digest"],
                )
                for record in self.records(out)
            }

        right, welded, apart = answers(whole), answers(halves, "--weld", 0), answers(halves)
        self.assertEqual({key[1] for key in right}, {"host", "opencl:0"})
        self.assertLessEqual(
            {one["name"] for one in json.loads(tandem("algorithms", "--json")[1]) if not one["baseline"]},
            {key[0] for key in right},
        )
        self.assertEqual(welded, right)
        for key, answer in apart.items():
            self.assertNotEqual(answer, right[key], key)

    def test_many_flawed_bodies_are_counted_and_the_first_named(self):
        flat, _ = self.flawed("many.msh")
        out = self.work / "many.jsonl"
        meshes = [part for i in range(20) for part in ("--mesh", flat)]
        status, text, errors = tandem(
            "run", *meshes, "--device", "host", "--algorithm", "chunked", "--repeat", 1, "--out", out
        )
        self.assertEqual((status, errors), (0, []), text)
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
                    command,
                    scene,
                    "--device",
                    "host",
                    *handling,
                )
        for arguments in (
            ("check", scene, *(() if LONG else ("--preset", "grouped,resident,fair"))),
            ("run", scene, "--repeat", 1),
        ):
            out = self.work / f"{arguments[0]}-finite.jsonl"
            status, text, errors = tandem(
                *arguments, "--degenerate", "skip", "--out", out, "--truth", "contacts"
            )
            self.assertEqual((status, errors), (0, []), text)
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
        status, text, errors = tandem(
            "run", *words, "--device", "host", "--algorithm", "tiled", "--repeat", 1, "--out", out
        )
        self.assertEqual((status, errors), (0, []), text)
        self.assertIn(": right: ", text)
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
            "--mesh",
            ground,
            "--mesh",
            rod,
            "--pose",
            "0 0 0 1 0 0 0",
            "--pose",
            "28.87991333 260.53430176 0.00036136055 0.77515626 -0.16498479 0.36682746 -0.48718625",
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
                    f"  contact_rule=opposing: a contact of frame 0, of body 0 tetrahedron 0 and body 1 tetrahedron {deep['tet_b']}, is 29.1 m deep, "
                    "but the smaller body is 0.151 m long; contact_rule=sat gives the least depth"
                ],
            )
        for words in (("--set", "contact_rule=sat"), ("--no-check",), ("--set", "output=digest")):
            status, text, errors = tandem(
                "run",
                *cell,
                *words,
                "--device",
                "host",
                "--algorithm",
                "tiled",
                "--repeat",
                1,
                "--out",
                self.work / "none.jsonl",
                "--truth",
                "none",
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
                f"  single precision cannot resolve mesh near of body 0: {len(tets)} of {len(tets)} tetrahedra become flat; use precision=double or origin=auto"
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
        scene.write_text(
            json.dumps(
                {
                    "frames": 2,
                    "meshes": {"a": {"file": "near.msh"}},
                    "bodies": [
                        {"mesh": "a", "position": [far, 0, 0], "fixed": True},
                        {"mesh": "a", "series": ["moved0.msh", "moved1.msh"]},
                    ],
                }
            )
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
        scene.write_text(
            json.dumps(
                {
                    "frames": 2,
                    "meshes": {"a": {"file": "whole.msh"}},
                    "bodies": [{"mesh": "a", "series": ["whole.msh", "broken.msh"]}],
                }
            )
        )
        for handling in ("flat", "skip", "reject"):
            for words in (("--mesh", whole, "--mesh", broken), (scene,)):
                self.bad(
                    "broken.msh:11: coordinate y 'nan' is not finite; repair the mesh",
                    "run",
                    *words,
                    "--device",
                    "host",
                    "--degenerate",
                    handling,
                )
        self.assertIn(
            "files with coordinates that are not finite are always refused",
            " ".join(tandem("run", "--help")[1].split()),
        )
        self.assertIn(
            "A file with a coordinate that is not finite is refused with every value",
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

        meshes = (
            "--mesh",
            slivers(self.work / "slivers.msh", 0),
            "--mesh",
            slivers(self.work / "others.msh", 5e-5),
        )
        environment = {"OCL_ICD_VENDORS": str(self.work), "MALLOC_ARENA_MAX": "1"}
        limited = lambda *more: tandem(
            "run",
            *meshes,
            "--device",
            "host",
            "--algorithm",
            "chunked",
            "--repeat",
            1,
            "--no-check",
            "--check-afresh",
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
            "run",
            "hard:ties:pairs=300000,together=1000",
            "--device",
            "host",
            "--algorithm",
            "chunked",
            "--repeat",
            1,
            "--no-check",
            "--check-afresh",
            "--set",
            "contact_rule=none",
        )
        status, _, errors = tandem(*frames, environment=environment, address_space=3 << 30)
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn("the exact truth of 300 frames like the first takes", errors[0])
        status, _, errors = tandem(*frames, "--frames", "0:1", environment=environment, address_space=3 << 30)
        self.assertEqual((status, errors), (0, []))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
