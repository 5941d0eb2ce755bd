#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""command_line.py PROGRAM SOURCE: the program as a user meets it: listings, records, dumps, and every bad input."""
import csv
import itertools
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import jsonschema

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()


def tandem(*arguments, environment=None):
    """(exit code, standard output, lines of standard error less PoCL's own)."""
    done = subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, timeout=300,
                          env={**os.environ, **(environment or {})})
    lines = [line for line in done.stderr.splitlines() if line.strip() and not line.rstrip().endswith("generated.")]
    return done.returncode, done.stdout, lines


def bar(cells, offset):
    """Vertices and tetrahedra of a row of cubes, six tetrahedra each; coordinates are exact in single precision."""
    points = [(i, j, k) for i in range(cells + 1) for j in range(2) for k in range(2)]
    number = {p: n for n, p in enumerate(points)}
    tets = []
    for cube in range(cells):
        for order in itertools.permutations(range(3)):
            corner, tet = [cube, 0, 0], [number[(cube, 0, 0)]]
            for axis in order:
                corner[axis] += 1
                tet.append(number[tuple(corner)])
            tets.append(tet)
    shifted = [tuple(x * 0.75 + o for x, o in zip(p, offset)) for p in points]
    return shifted, tets


def gmsh(path, points, tets, kind=4):
    with open(path, "w") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % len(points))
        out.writelines("%d %r %r %r\n" % (n, *p) for n, p in enumerate(points, 1))
        out.write("$EndNodes\n$Elements\n%d\n" % len(tets))
        out.writelines("%d %d 2 0 0 %s\n" % (n, kind, " ".join(str(v + 1) for v in t)) for n, t in enumerate(tets, 1))
        out.write("$EndElements\n")
    return path


def boxes(points, tets):
    return [[(min(points[v][axis] for v in t), max(points[v][axis] for v in t)) for axis in range(3)] for t in tets]


class CommandLine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.good = gmsh(cls.work / "good.msh", *bar(4, (0, 0, 0)))
        schema = json.loads((SOURCE / "results/record.schema.json").read_text())
        cls.validator = jsonschema.Draft7Validator(schema)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def records(self, path):
        records = [json.loads(line) for line in path.read_text().splitlines()]
        for record in records:
            problems = ["/".join(map(str, e.absolute_path)) + ": " + e.message for e in self.validator.iter_errors(record)]
            self.assertEqual(problems, [])
        return records

    def bad(self, expected, *arguments, code=2, environment=None):
        status, out, errors = tandem(*arguments, environment=environment)
        self.assertEqual(status, code, (arguments, out, errors))
        self.assertEqual(len(errors), 1, (arguments, errors))
        self.assertTrue(errors[0].startswith("tandem: "), errors)
        for part in [expected] if isinstance(expected, str) else expected:
            self.assertIn(part, errors[0])
        return out

    def test_listings(self):
        for name, words in (("devices", ["host", "opencl:0"]), ("scenes", ["plates", "pile", "density"]),
                            ("algorithms", ["chunked", "gproximity", "unc2010", "seed_threshold"])):
            status, out, errors = tandem(name)
            self.assertEqual((status, errors), (0, []))
            for word in words:
                self.assertIn(word, out)
            status, out, _ = tandem(name, "--json")
            self.assertEqual(status, 0)
            self.assertTrue(json.loads(out))

    def test_run_records_and_appends(self):
        out = self.work / "run.jsonl"
        arguments = ("run", "plates", "--frames", "20:21", "--device", "host,opencl:0", "--repeat", 2, "--out", out)
        status, text, errors = tandem(*arguments)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(text.count(": right: "), 4, text)
        for word in ("method", "traverse", "launches", "how many times chunked is faster"):
            self.assertIn(word, text)
        first = out.read_text()
        records = self.records(out)
        self.assertEqual(len(records), 4)
        self.assertEqual({r["status"] for r in records}, {"ok"})
        self.assertEqual(len({json.dumps(r["agreement"]["digest"]) for r in records}), 1)
        self.assertGreater(records[0]["agreement"]["digest"]["count"], 1000)
        self.assertEqual(len(records[0]["total_ns"]["samples"]), 2)
        self.assertGreater(records[0]["stages"]["traverse"]["device_ns"]["median"], 0)
        self.assertEqual(tandem(*arguments[:2], "--frames", "0", "--algorithm", "chunked", "--set", "k=6,8", "--out", out)[0], 0)
        self.assertTrue(out.read_text().startswith(first))
        self.assertEqual([r["settings"]["k"] for r in self.records(out)[4:]], ["6", "8"])

    def test_schema_can_fail(self):
        out = self.work / "schema.jsonl"
        tandem("run", "--mesh", self.good, "--device", "host", "--algorithm", "chunked", "--out", out)
        record = self.records(out)[0]
        for change in ({"status": "fine"}, {"surprise": 1}, {"frames": {"first": 0}}, {"key": None}):
            self.assertFalse(self.validator.is_valid({**record, **change}), change)

    def test_check_prints_the_matrix(self):
        for scene in ("plates", "pile:bodies=8,frames=2"):
            status, out, errors = tandem("check", scene, "--frames", "0:1")
            self.assertEqual((status, errors), (0, []), out)
            rows = [line.split() for line in out.splitlines() if line.startswith(("host ", "opencl:0 "))]
            self.assertEqual(len(rows), 18, out)
            for row in rows:
                self.assertGreater(int(row[3]), 0)
                self.assertEqual(row[4:6], ["0", "0"], out)

    def test_dumps_agree_with_brute_force(self):
        parts = [bar(4, (0, 0, 0)), bar(3, (0.5, 0.25, 0.375))]
        files = [gmsh(self.work / f"part{i}.msh", *part) for i, part in enumerate(parts)]
        pairs, contacts, out = (self.work / name for name in ("p.csv", "c.csv", "d.jsonl"))
        status, text, errors = tandem("run", "--mesh", files[0], "--mesh", files[1], "--pose", "0 0 0 1 0 0 0", "--pose",
                                      "0.125 0 0 1 0 0 0", "--set", "k=6", "--algorithm", "chunked", "--dump-pairs", pairs,
                                      "--dump-contacts", contacts, "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        rows = list(csv.reader(pairs.read_text().splitlines()))
        self.assertEqual(rows[0], "frame,body_a,tet_a,body_b,tet_b".split(","))
        moved = ([tuple(x + (0.125 if axis == 0 else 0) for axis, x in enumerate(p)) for p in parts[1][0]], parts[1][1])
        expected = [["0", "0", str(a), "1", str(b)] for a, box_a in enumerate(boxes(*parts[0]))
                    for b, box_b in enumerate(boxes(*moved))
                    if all(x[0] <= y[1] and y[0] <= x[1] for x, y in zip(box_a, box_b))]
        self.assertGreater(len(expected), 50)
        self.assertEqual(rows[1:], expected)
        record = self.records(out)[0]
        self.assertEqual(record["work"]["candidate_pairs"], [len(expected)])
        lines = list(csv.reader(contacts.read_text().splitlines()))
        self.assertEqual(lines[0], "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth".split(","))
        self.assertEqual(len(lines) - 1, record["work"]["contacts"][0])
        self.assertGreater(len(lines), 10)
        for line in lines[1:]:
            self.assertAlmostEqual(sum(float(x) ** 2 for x in line[8:11]), 1, places=5)

    def test_tiny_capacities_retry(self):
        out = self.work / "tiny.jsonl"
        status, text, _ = tandem("run", "pile:bodies=6,frames=1", "--algorithm", "chunked,gproximity", "--set", "pair_capacity=1",
                                 "--set", "contact_capacity=1", "--out", out)
        self.assertEqual(status, 0, text)
        for record in self.records(out):
            self.assertGreater(record["work"]["retries"], 0)

    def test_bad_meshes(self):
        points, tets = bar(2, (0, 0, 0))
        whole = self.good.read_text()
        cases = {
            "missing.msh": (None, "missing.msh"),
            "short.msh": (whole[: len(whole) // 2], "short.msh:"),
            "nan.msh": (whole.replace("1 0 0 0\n" if "\n1 0 0 0\n" in whole else "1 0.0 0.0 0.0\n", "1 nan 0 0\n", 1), "nan.msh:"),
            "count.msh": (whole.replace("$Elements\n24", "$Elements\n999999999999"), "count.msh:"),
            "noise.msh": ("this is no mesh\n", "noise.msh"),
        }
        for name, (text, expected) in cases.items():
            path = self.work / name
            if text is not None:
                path.write_text(text)
            self.bad(expected, "run", "--mesh", path, "--mesh", self.good)
        far = [list(t) for t in tets]
        far[0][0] = 5000
        self.bad("range.msh:", "run", "--mesh", gmsh(self.work / "range.msh", points, far))
        hexa = [(0, 1, 3, 2, 4, 5, 7, 6)]
        self.bad(["hexa.msh:", "hexahedr"], "run", "--mesh", gmsh(self.work / "hexa.msh", points, hexa, 5))

    def test_bad_scenes(self):
        empty = self.work / "empty.json"
        empty.write_text('{"meshes": {"j": {"builtin": "jack"}}, "bodies": []}')
        self.bad("bodies", "run", empty)
        self.bad("the nearest is 'plates'", "run", "plate")
        self.bad("the nearest is 'density'", "run", "pile:densty=1")
        self.bad("impossible", "run", "pile:density=-1")
        self.bad("the nearest is 'jack'", "run", "pile:mesh=jak")
        self.bad("absent.json", "run", self.work / "absent.json")

    def test_bad_use(self):
        self.bad("the nearest is 'chunked'", "run", "plates", "--algorithm", "chunkd")
        self.bad("the nearest is 'seed_threshold'", "run", "plates", "--set", "seed_treshold=1")
        self.bad("the nearest is 'opencl:0'", "run", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'fair'", "run", "plates", "--preset", "fairr")
        for setting in ("k=10", "group_size=0", "leaves=3", "precision=half", "pair_capacity=-1"):
            self.bad("impossible", "run", "plates", "--algorithm", "chunked", "--set", setting, "--frames", "0")
        for frames in ("5:2", "0:500", "x", "1:"):
            self.bad("frames", "run", "plates", "--frames", frames)
        self.bad("--pose", "run", "--mesh", self.good, "--pose", "0 0 0 1 0 0")
        self.bad("scene", "run")
        self.bad("--set", "run", "plates", "--set", "k")
        self.bad("--help", "run", "plates", "--nonsense")
        self.bad("--help")
        self.bad("--require cuda", "run", "plates", "--require", "cuda")

    def test_unwritable_output_is_found_first(self):
        for option in ("--out", "--dump-pairs", "--dump-contacts"):
            out = self.bad("cannot be written", "run", "plates", "--frames", "0", option, self.work / "no/such/file")
            self.assertNotIn("traverse", out)

    def test_a_failing_cell_keeps_what_is_recorded(self):
        out = self.work / "fail.jsonl"
        status, text, errors = tandem("run", "--mesh", self.good, "--mesh", self.good, "--algorithm", "chunked", "--device", "host",
                                      "--set", "pair_capacity=64,4294967295", "--set", "precision=double", "--out", out)
        self.assertEqual(status, 3, text)
        self.assertEqual(len(errors), 1, errors)
        self.assertIn("68719476720", errors[0])
        records = self.records(out)
        self.assertEqual([r["status"] for r in records], ["ok", "failed"])
        self.assertIn("68719476720", records[1]["failure"])

    def test_without_any_driver(self):
        nothing = {"OCL_ICD_VENDORS": "/nonexistent/"}
        status, out, _ = tandem("devices", environment=nothing)
        self.assertEqual(status, 0)
        self.assertIn("opencl: no platform", out)
        self.bad("opencl: no platform", "run", "plates", "--device", "opencl:0", environment=nothing)
        status, out, _ = tandem("run", "--mesh", self.good, "--device", "host", environment=nothing)
        self.assertEqual(status, 0, out)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
