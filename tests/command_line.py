#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""command_line.py PROGRAM SOURCE: the program as a user meets it: listings, records, dumps, and every bad input."""
import csv
import itertools
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import unittest

import jsonschema

if len(sys.argv) != 3:
    sys.exit(__doc__)
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(sys.argv[2]).resolve()


def tandem(*arguments, environment=None, timeout=300, address_space=None):
    """(exit code, standard output, lines of standard error less PoCL's own); with so many bytes of address space."""
    limit = (lambda: resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))) if address_space else None
    done = subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True, timeout=timeout,
                          env={**os.environ, **(environment or {})}, preexec_fn=limit)
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


def overlapping(a, b):
    """Pairs of tetrahedra whose boxes overlap or touch. Coordinates are multiples of 1/8, so this is exact."""
    return [(i, j) for i, x in enumerate(boxes(*a)) for j, y in enumerate(boxes(*b))
            if all(p[0] <= q[1] and q[0] <= p[1] for p, q in zip(x, y))]


def places(value, path=()):
    """Every path to a value inside a JSON document, parents first."""
    for name, child in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield (*path, name)
        yield from places(child, (*path, name))


def changed(record, path, change):
    """A copy of `record` after change(parent of path, last name of path)."""
    copy = json.loads(json.dumps(record))
    parent = copy
    for name in path[:-1]:
        parent = parent[name]
    change(parent, path[-1])
    return copy


class Case(unittest.TestCase):
    """What every case needs: a folder, a good mesh in it, and readers of what the program writes."""

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
        print(f"\n  {status}: {errors[0]}", end="", file=sys.stderr)
        return out

    def dump(self, path, header):
        """Rows of a dump below its header, which must be sorted by their first five numbers."""
        rows = list(csv.reader(path.read_text().splitlines()))
        self.assertEqual(",".join(rows[0]), header)
        ids = [tuple(map(int, row[:5])) for row in rows[1:]]
        self.assertEqual(ids, sorted(ids))
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        return rows[1:], ids


class CommandLine(Case):
    def test_listings(self):
        keys = {"devices": {"backend", "reason", "devices"}, "scenes": {"name", "models", "parameters", "bodies", "vertices", "tetrahedra"},
                "algorithms": {"name", "summary", "parameters", "presets"}}
        for name, words in (("devices", ["host", "opencl:0"]), ("scenes", ["plates", "pile", "density", "glasses", "1729", "14793", "16140"]),
                            ("algorithms", ["chunked", "gproximity", "unc2010", "seed_threshold"])):
            status, out, errors = tandem(name)
            self.assertEqual((status, errors), (0, []))
            for word in words:
                self.assertIn(word, out)
            status, out, errors = tandem(name, "--json")
            self.assertEqual((status, errors), (0, []))
            entries = json.loads(out)
            self.assertGreater(len(entries), 1)
            for entry in entries:
                self.assertLessEqual(keys[name], set(entry))
            self.assertTrue(all(word in out for word in words))

    def test_ceilings_are_measured_and_recorded(self):
        out = self.work / "ceilings.jsonl"
        status, text, errors = tandem("devices", "--measure", "--device", "opencl:0", "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        self.assertIn("read of device memory", text)
        records = [json.loads(line) for line in out.read_text().splitlines()]
        self.assertEqual([r["device"]["id"] for r in records], ["opencl:0"])
        for name in ("copy_bytes_per_s", "launch_s", "overlap_tests_k8_per_s"):
            self.assertGreater(records[0][name]["median"], 0)
        # Eighteen planes take more comparisons than eight.
        self.assertGreater(records[0]["overlap_tests_k8_per_s"]["median"], records[0]["overlap_tests_k18_per_s"]["median"])
        script = [sys.executable, str(SOURCE / "tests/validate_records.py"), str(out)]
        self.assertEqual(subprocess.run(script, capture_output=True).returncode, 0)
        out.write_text(out.read_text().replace('"launch_s":{"median":', '"launch_s":{"median":-', 1))
        self.assertEqual(subprocess.run(script, capture_output=True).returncode, 1)
        self.bad("--measure", "devices", "--device", "opencl:0")
        self.bad("the nearest is", "devices", "--measure", "--device", "opencl:77")

    def test_run_records_and_appends(self):
        out = self.work / "run.jsonl"
        arguments = ("run", "plates", "--frames", "20:21", "--algorithm", "chunked,gproximity", "--device", "host,opencl:0",
                     "--repeat", 2, "--out", out)
        status, text, errors = tandem(*arguments)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(text.count(": right: "), 4, text)
        for word in ("method", "traverse", "launches", "total ms", "how many times chunked is faster", "narrow"):
            self.assertIn(word, text)
        first = out.read_bytes()
        records = self.records(out)
        self.assertEqual([(r["devices"][0]["id"], r["algorithm"]) for r in records],
                         list(itertools.product(["host", "opencl:0"], ["chunked", "gproximity"])))
        self.assertEqual({r["status"] for r in records}, {"ok"})
        self.assertEqual(len({json.dumps(r["agreement"]["digest"]) for r in records}), 1)
        self.assertEqual(len({json.dumps(r["agreement"]["contact_digest"]) for r in records}), 1)
        for record in records:
            self.assertGreater(record["agreement"]["digest"]["count"], 1000)
            self.assertEqual(sum(record["work"]["candidate_pairs"]), record["agreement"]["digest"]["count"])
            self.assertEqual([sum(frames) for frames in record["total_ns"]["frames"]], record["total_ns"]["samples"])
            self.assertEqual(len(record["total_ns"]["samples"]), 2)
            self.assertGreater(record["stages"]["traverse"]["device_ns"]["median"], 0)
        self.assertEqual(tandem(*arguments)[0], 0)
        self.assertTrue(out.read_bytes().startswith(first))
        self.assertEqual([r["key"] for r in self.records(out)], [r["key"] for r in records] * 2)

    def test_several_values_make_several_cells(self):
        out = self.work / "cells.jsonl"
        status, text, errors = tandem("run", "plates", "--frames", "0", "--algorithm", "chunked", "--set", "k=6,8",
                                      "--set", "precision=float,double", "--repeat", 1, "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual([(r["settings"]["k"], r["settings"]["precision"]) for r in self.records(out)],
                         list(itertools.product(["6", "8"], ["float", "double"])))

    def test_schema_can_fail(self):
        """Every field of a real record: taken away, of another type, null, or with another one beside it."""
        out = self.work / "schema.jsonl"
        flat, _ = self.flawed("schema.msh")
        tandem("run", "--mesh", flat, "--mesh", self.good, "--device", "opencl:0", "--algorithm", "gproximity", "--truth", "contacts",
               "--out", out)
        record = self.records(out)[0]
        maps, nullable = {"settings", "defines"}, {"failure", "agreement", "commit", "processor", "clocks_mhz", "hardware", "device_span_ns",
                                                   "registers", "local_bytes", "spill_bytes", "missed_upper95", "candidate_ratio", "decisions",
                                                   "depth_relative", "depth_ulps", "normal_degrees", "point", "hausdorff", "volume_relative"}
        nullable_paths = {("error", "truth"), ("error", "truth", "contacts"), ("error", "truth", "drift")}
        since = {"unsure", "uncertain", "truth", "inputs", "volume_relative", "no_volume"}  # records from before each lack it
        seen = set()
        for path in places(record):
            shape = tuple(0 if isinstance(name, int) else name for name in path)
            if shape in seen:
                continue
            seen.add(shape)
            parent, name = path[-2] if len(path) > 1 else None, path[-1]
            optional = parent in maps or parent == "stages" or isinstance(name, int) or name in since
            with self.subTest(path=path):
                gone = changed(record, path, lambda p, n: p.pop(n))
                self.assertTrue(optional or not self.validator.is_valid(gone), "taken away")
                self.assertFalse(self.validator.is_valid(changed(record, path, lambda p, n: p.update({n: {"x": []}})
                                                                 if isinstance(p, dict) else p.append({"x": []}))), "type")
                null = changed(record, path, lambda p, n: p.__setitem__(n, None))
                self.assertEqual(self.validator.is_valid(null), name in nullable or path in nullable_paths, "null")
                if not isinstance(name, int) and parent not in maps:
                    more = changed(record, path, lambda p, n: p.update(surprise=1))
                    self.assertFalse(self.validator.is_valid(more), "one more")
        self.assertGreater(len(seen), 150)
        for change in ({"status": "fine"}, {"status": "failed"}, {"failure": "device lost"}, {"failure": ""}, {"schema": 2},
                       {"stages": {"travers": record["stages"]["traverse"]}}, {"breakdown_ns": {"samples": []}},
                       {"total_ns": {**record["total_ns"], "samples": []}}, {"devices": []}, {"settings": {"k": 18}},
                       {"scene": {**record["scene"], "digest": "0123456789ABCDEF"}},
                       {"agreement": {**record["agreement"], "missing": 1}}):
            self.assertFalse(self.validator.is_valid({**record, **change}), change)

    def test_validate_records(self):
        script = SOURCE / "tests/validate_records.py"

        def validate(*files):
            done = subprocess.run([sys.executable, str(script), *map(str, files)], capture_output=True, text=True)
            return done.returncode, done.stdout + done.stderr

        good, bad, empty = (self.work / name for name in ("good.jsonl", "bad.jsonl", "empty.jsonl"))
        tandem("run", "--mesh", self.good, "--device", "host", "--out", good)
        line = good.read_text().splitlines()[0]
        bad.write_text(line + "\n" + line.replace('"count":0,', '"count":-1,', 1) + "\n" + line[:100] + "\n")
        empty.write_text("")
        self.assertEqual(validate(good), (0, "2 records valid\n"))
        status, text = validate(good, bad)
        self.assertEqual(status, 1, text)
        self.assertRegex(text, r"bad\.jsonl:2: /agreement/\w*digest/count: ")
        self.assertIn("bad.jsonl:3: not JSON", text)
        for files in ([empty], [self.work / "none.jsonl"], [good, self.work / "none.jsonl"]):
            self.assertEqual(validate(*files)[0], 1, files)
        self.assertEqual(validate()[0], 0)

    def test_check_prints_the_matrix(self):
        presets = sum(len(entry["presets"]) for entry in json.loads(tandem("algorithms", "--json")[1]))
        devices = [d["id"] for entry in json.loads(tandem("devices", "--json")[1]) for d in entry["devices"]]
        for arguments in (("plates", "--frames", "20:21"), ("pile:bodies=8,frames=2",)):
            status, out, errors = tandem("check", *arguments)
            self.assertEqual((status, errors), (0, []), out)
            rows = [line.split() for line in out.splitlines() if line.split()[:1] and line.split()[0] in devices]
            self.assertEqual(len(rows), presets * len(devices), out)
            for row in rows:
                self.assertGreater(int(row[3]), 0)
                self.assertEqual((row[4:6], row[8]), (["0", "0"], "yes"), out)
            self.assertIn("\nall agree with the reference\n", out)

    def test_dumps_agree_with_brute_force(self):
        parts = [bar(4, (0, 0, 0)), bar(3, (0.5, 0.25, 0.375))]
        files = [gmsh(self.work / f"part{i}.msh", *part) for i, part in enumerate(parts)]
        header = ("frame,body_a,tet_a,body_b,tet_b", "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth")
        # Poses without any rounding: a shift, and half a turn about z.
        for pose, sign, shift in (("0.125 0 0 1 0 0 0", 1, (0.125, 0, 0)), ("3.5 1 -0.375 0 0 0 1", -1, (3.5, 1, -0.375))):
            moved = ([(sign * x + shift[0], sign * y + shift[1], z + shift[2]) for x, y, z in parts[1][0]], parts[1][1])
            expected = [(0, 0, a, 1, b) for a, b in overlapping(parts[0], moved)]
            self.assertGreater(len(expected), 50)
            self.assertLess(len(expected), len(parts[0][1]) * len(parts[1][1]))
            for algorithm, rounding in itertools.product(("chunked", "gproximity"), ("nearest", "safe")):
                pairs, contacts, out = (self.work / f"d{len(list(self.work.iterdir()))}.{end}" for end in ("p", "c", "jsonl"))
                status, text, errors = tandem("run", "--mesh", files[0], "--mesh", files[1], "--pose", "0 0 0 1 0 0 0", "--pose",
                                              pose, "--set", "k=6", "--set", f"rounding={rounding}", "--algorithm", algorithm,
                                              "--repeat", 1, "--dump-pairs", pairs, "--dump-contacts", contacts, "--out", out)
                self.assertEqual((status, errors), (0, []), text)
                self.assertEqual(self.dump(pairs, header[0])[1], expected)
                work = self.records(out)[0]["work"]
                self.assertEqual(work["candidate_pairs"], [len(expected)])
                rows, ids = self.dump(contacts, header[1])
                self.assertEqual(len(rows), work["contacts"][0])
                self.assertGreater(len(rows), 10)
                self.assertLessEqual(set(ids), set(expected))
                for row in rows:
                    self.assertAlmostEqual(sum(float(x) ** 2 for x in row[8:11]), 1, places=5)

    def test_dumps_of_several_frames(self):
        pairs, contacts, out = (self.work / name for name in ("p.csv", "c.csv", "frames.jsonl"))
        status, text, errors = tandem("run", "plates", "--frames", "20:21", "--repeat", 1, "--algorithm", "gproximity",
                                      "--dump-pairs", pairs, "--dump-contacts", contacts, "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        work = self.records(out)[0]["work"]
        for path, columns, counts in ((pairs, 5, work["candidate_pairs"]), (contacts, 12, work["contacts"])):
            header = "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth".split(",")[:columns]
            ids = self.dump(path, ",".join(header))[1]
            self.assertEqual([sum(row[0] == frame for row in ids) for frame in (20, 21)], counts)
            self.assertEqual(len(ids), sum(counts))
        self.assertTrue(all(a < b for _, a, _, b, _ in self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1]))

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
        far = [[5000, *tets[0][1:]], *tets[1:]]
        texts = {
            "short.msh": whole[: len(whole) // 2],
            "nan.msh": whole.replace("\n1 0.0 0.0 0.0\n", "\n1 nan 0 0\n", 1),
            "count.msh": whole.replace("$Elements\n24", "$Elements\n999999999999"),
            "range.msh": gmsh(self.work / "range.msh", points, far).read_text(),
            "hexa.msh": gmsh(self.work / "hexa.msh", points, [(0, 1, 3, 2, 4, 5, 7, 6)], 5).read_text(),
        }
        reasons = {"short.msh": "", "nan.msh": "nan", "count.msh": "999999999999", "range.msh": "5001", "hexa.msh": "hexahedr"}
        for name, text in texts.items():
            self.assertNotEqual(text, whole)
            path = self.work / name
            path.write_text(text)
            for arguments in (("--mesh", path, "--mesh", self.good), ("--mesh", self.good, "--mesh", path)):
                self.bad(reasons[name], "run", *arguments)
            errors = tandem("run", "--mesh", path)[2]
            self.assertRegex(errors[0], re.escape(str(path)) + r":\d+: ")
        noise = self.work / "noise.msh"
        noise.write_text("this is no mesh\n")
        surface = gmsh(self.work / "surface.msh", points, [])
        for path, reason in ((noise, ""), (surface, "no tetrahedra"), (self.work / "missing.msh", ""), (self.work, "folder")):
            self.bad([str(path), reason], "run", "--mesh", path)

    def test_hard_cases(self):
        fast = ("--device", "host", "--quiet", "--preset", "resident,fair")
        status, out, errors = tandem("check", "hard:corner-cancellation", "--set", "k=8", "--set", "rounding=nearest,safe", *fast)
        self.assertEqual((status, errors), (0, []), out)
        missed = [int(line.split()[-2]) for line in out.splitlines() if line.startswith("host ")]
        nearest, safe = missed[::2], missed[1::2]
        self.assertEqual((len(missed), set(safe)), (4, {0}), out)
        self.assertGreater(min(nearest), 0, out)
        status, out, errors = tandem("check", "hard:all:pairs=2,together=2", *fast)
        self.assertEqual((status, errors), (0, []), out)
        rows = [line for line in out.splitlines() if line.startswith("hard:")]
        self.assertEqual(len(rows), 44)
        refusal = "tetrahedra 2 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1 in frame 0; "
        self.assertIn("refused: " + refusal, rows[9])
        self.assertEqual(rows[10].split(), ["hard:not-finite", "1", "0", "0", "0", "0", "2", "0", "skipped:", "2"])
        self.assertIn("with rounding=safe nothing that meets is missed", out)
        self.bad("unknown family of hard cases 'tuch'; the nearest is 'touch'", "check", "hard:tuch")
        self.bad("difficulty=10 is impossible; give a number from 1 to 9", "run", "hard:touch:difficulty=10")
        self.bad("hard:all takes seed, pairs and together", "check", "hard:all:difficulty=1")

    def flawed(self, name):
        """The bar with a flat tetrahedron across its first cube, the 25th, and its tetrahedra."""
        points, tets = bar(4, (0, 0, 0))
        tets = [*tets, [0, 1, 3, 2]]
        return gmsh(self.work / name, points, tets), tets

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
                                      "--repeat", 1, "--out", self.work / "none.jsonl")
        self.assertEqual((status, errors), (0, []), text)
        record = self.records(self.work / "none.jsonl")[0]
        self.assertNotIn("degenerate", record["key"])
        self.assertEqual((record["error"]["inputs"]["flawed_bodies"], record["error"]["inputs"]["bodies"]), (0, []))
        out = self.work / "rejected.jsonl"
        for command in ("run", "check", "accuracy"):
            self.bad(["--degenerate reject: tetrahedra 1 of zero volume in 1 of 2 bodies: body 0 tetrahedron 24 in frame 0;", "flat or skip"],
                     command, *meshes, "--degenerate", "reject", "--device", "host", "--out", out)
        self.assertEqual(out.read_text() if out.exists() else "", "")
        self.bad("--degenerate some: give flat, skip or reject", "run", "plates", "--degenerate", "some")
        self.bad("--set degenerate=skip: it is said of frames, for all cells; give --degenerate skip", "run", "plates", "--set",
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
        for arguments in (("check", scene), ("run", scene, "--repeat", 1)):
            out = self.work / f"{arguments[0]}-finite.jsonl"
            status, text, errors = tandem(*arguments, "--degenerate", "skip", "--out", out, "--truth", "contacts")
            self.assertEqual((status, errors), (0, []), text)
            self.assertIn("tetrahedra 4 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1, ... in frame 0; they take no part", text)
            for record in self.records(out):
                self.assertEqual((record["status"], sum(record["work"]["candidate_pairs"])), ("ok", 0))
                self.assertEqual(record["error"]["inputs"]["non_finite_elements"], 4)

    def test_a_truth_too_large_for_memory(self):
        """Slivers along a diagonal: their boxes meet, all with all, and take more than there is; their 18-DOPs do not. Then
        many frames of which each has room, but not all have."""
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
        limited = lambda *more: tandem("run", *meshes, "--device", "host", "--algorithm", "chunked", "--repeat", 1, "--no-check", *more,
                                       environment=environment, address_space=3 << 30)
        status, _, errors = limited()
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertRegex(errors[0], r"the exact truth of 18000 tetrahedra with at least \d+ pairs near each other may take \d.\d\d GiB, "
                                    r"and [12].\d\d GiB are free; choose --truth none, fewer frames or fewer bodies")
        self.assertEqual(limited("--truth", "none")[::2], (0, []))
        frames = ("run", "hard:ties:pairs=300000,together=1000", "--device", "host", "--algorithm", "chunked", "--repeat", 1,
                  "--no-check", "--set", "contact_rule=none")
        status, _, errors = tandem(*frames, environment=environment, address_space=3 << 30)
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn("the exact truth of 300 frames like the first takes", errors[0])
        status, _, errors = tandem(*frames, "--frames", "0:1", environment=environment, address_space=3 << 30)
        self.assertEqual((status, errors), (0, []))

    def test_bad_scenes(self):
        empty = self.work / "empty.json"
        empty.write_text('{"meshes": {"j": {"builtin": "jack"}}, "bodies": []}')
        self.bad(["empty.json", "bodies"], "run", empty)
        empty.write_text('{"meshes": {"j": {"builtin": "jack"}}}')
        self.bad(["empty.json", "bodies"], "run", empty)
        empty.write_text('{"meshes": \n')
        self.bad("empty.json", "run", empty)
        self.bad("the nearest is 'plates'", "run", "plate")
        self.bad("the nearest is 'density'", "run", "pile:densty=1")
        for value in ("pile:density=-1", "pile:density=nan", "pile:bodies=0", "pile:bodies=2.5", "plates:count=99999999999999999"):
            self.bad("impossible", "run", value)
        self.bad("no value", "run", "pile:density")
        self.bad("the nearest is 'jack'", "run", "pile:mesh=jak")
        self.bad("absent.json", "run", self.work / "absent.json")

    def test_bad_use(self):
        self.bad("the nearest is 'chunked'", "run", "plates", "--algorithm", "chunkd")
        self.bad("the nearest is 'seed_threshold'", "run", "plates", "--set", "seed_treshold=1")
        self.bad("the nearest is 'opencl:0'", "run", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'fair'", "run", "plates", "--preset", "fairr")
        self.bad("the nearest is 'opencl:0'", "check", "plates", "--device", "opencl:7")
        self.bad("the nearest is 'chunked'", "check", "plates", "--algorithm", "chunkd")
        for setting in ("k=10", "group_size=0", "leaves=3", "precision=half", "pair_capacity=-1", "pair_capacity=4294967296",
                        "k=6,,8", "axes=coordinate", "rounding=directed"):
            expected = "goes with k=8 only" if setting == "axes=coordinate" else "impossible"
            self.bad(expected, "run", "plates", "--algorithm", "chunked", "--set", setting, "--frames", "0")
        self.bad("goes with rounding=safe", "run", "plates", "--set", "truth=t2", "--set", "rounding=nearest")
        for frames in ("5:2", "0:500", "500", "x", "1:", "-1:2", "0:99999999999999999999"):
            self.bad("frames", "run", "plates", "--frames", frames)
        for pose in ("0 0 0 1 0 0", "0 0 0 1 0 0 0 0", "0 0 0 0 0 0 0", "nan 0 0 1 0 0 0", "a b c d e f g", ""):
            self.bad("--pose", "run", "--mesh", self.good, "--pose", pose)
        self.bad("--pose", "run", "--mesh", self.good, "--pose", "0 0 0 1 0 0 0", "--pose", "0 0 0 1 0 0 0")
        self.bad("exclude", "run", "plates", "--mesh", self.good)
        self.bad("scene", "run")
        self.bad("--set", "run", "plates", "--set", "k")
        self.bad("--help", "run", "plates", "--nonsense")
        self.bad("--help")
        for repeat in ("0", "-1", "x"):
            self.bad("--repeat", "run", "plates", "--repeat", repeat)
        self.bad("--help", "fly")

    def test_required_devices(self):
        present = {e["backend"] for e in json.loads(tandem("devices", "--json")[1]) if e["devices"]}
        absent = "cuda:99" if "cuda" in present else "cuda"
        for arguments in (("run", "plates"), ("check", "plates"), ("devices",)):
            self.bad(f"--require {absent}: ", *arguments, "--require", absent)
        self.assertEqual(tandem("devices", "--require", "host,opencl,opencl:0")[0], 0)

    def test_unwritable_output_is_found_first(self):
        for option in ("--out", "--dump-pairs", "--dump-contacts"):
            out = self.bad("cannot be written", "run", "plates", "--frames", "0", option, self.work / "no/such/file")
            self.assertNotIn("traverse", out)

    def test_too_little_memory(self):
        """1 TiB is more than any device has: both numbers are told, the record says failed, what was recorded stays."""
        for device in ("host", "opencl:0"):
            out = self.work / f"memory{device}.jsonl"
            arguments = ("run", "--mesh", self.good, "--mesh", self.good, "--algorithm", "gproximity", "--device", device,
                         "--repeat", 1, "--out", out)
            self.assertEqual(tandem(*arguments)[0], 0)
            before = out.read_bytes()
            self.bad("queues", *arguments, "--set", "queue_bytes=67108864,1099511627776", code=3)
            self.assertTrue(out.read_bytes().startswith(before))
            records = self.records(out)
            self.assertEqual([r["status"] for r in records], ["ok", "ok", "failed"])
            needed, there_is = map(int, re.search(r"needs (\d+) bytes.* (\d+)$", records[2]["failure"]).groups())
            self.assertGreater(needed, 10**12)
            self.assertLess(there_is, needed)
            self.assertGreater(there_is, 0)

    def test_a_failing_cell_keeps_what_is_recorded(self):
        out = self.work / "fail.jsonl"
        out.write_text("what was there before\n")
        memory = min(d["memory_bytes"] for e in json.loads(tandem("devices", "--json")[1]) for d in e["devices"]
                     if d["id"] == "opencl:0")
        if memory >= 68719476720:
            self.skipTest("the device has room for 4,294,967,295 pairs")
        self.bad("68719476720", "run", "--mesh", self.good, "--mesh", self.good, "--algorithm", "chunked", "--device", "opencl:0",
                 "--set", "pair_capacity=64,4294967295,128", "--repeat", 1, "--out", out, code=3)
        first, rest = out.read_text().split("\n", 1)
        self.assertEqual(first, "what was there before")
        out.write_text(rest)
        records = self.records(out)
        self.assertEqual([r["status"] for r in records], ["ok", "failed", "ok"])
        self.assertIn("68719476720", records[1]["failure"])

    def test_without_any_driver(self):
        nothing = {"OCL_ICD_VENDORS": "/nonexistent/"}
        status, out, errors = tandem("devices", environment=nothing)
        self.assertEqual((status, errors), (0, []))
        self.assertIn("opencl: no platform", out)
        reasons = {e["backend"]: e["reason"] for e in json.loads(tandem("devices", "--json", environment=nothing)[1])}
        self.assertIn("no platform", reasons["opencl"])
        self.bad("opencl: no platform", "run", "plates", "--device", "opencl:0", environment=nothing)
        self.bad("opencl: no platform", "run", "plates", environment=nothing)
        self.bad("opencl: no platform", "devices", "--require", "opencl", environment=nothing)
        status, out, _ = tandem("run", "--mesh", self.good, "--device", "host", environment=nothing)
        self.assertEqual(status, 0, out)


class Repaired(Case):
    """What was wrong once."""

    def cell(self, *arguments, **options):
        return tandem("run", "--mesh", self.good, "--mesh", self.good, "--device", "host", "--algorithm", "chunked",
                      "--repeat", 1, *arguments, **options)

    def test_check_takes_one_algorithm(self):
        for name in ("chunked", "gproximity"):
            status, out, errors = tandem("check", "plates", "--frames", "0", "--algorithm", name, "--device", "host")
            self.assertEqual((status, errors), (0, []), out)

    def test_coordinates_beyond_single_precision(self):
        """A bar stretched through another: 108 pairs in double; float must find them too or refuse (exit 2)."""
        points, tets = bar(2, (0, 0, 0))
        long = gmsh(self.work / "long.msh", [(x * 1e39, y, z) for x, y, z in points], tets)
        other = gmsh(self.work / "other.msh", *bar(3, (0.5, 0.25, 0.375)))
        counts = []
        for precision in ("double", "float"):
            out = self.work / f"{precision}.jsonl"
            status = tandem("run", "--mesh", long, "--mesh", other, "--device", "host", "--algorithm", "chunked", "--repeat", 1,
                            "--set", "k=6", "--set", f"precision={precision}", "--out", out)[0]
            counts.append(self.records(out)[0]["work"]["candidate_pairs"] if status == 0 else status)
        self.assertIn(counts[1], (counts[0], 2))

    def test_impossible_cells_are_found_before_any_is_measured(self):
        out = self.work / "late.jsonl"
        self.cell("--set", "leaves=4,3", "--out", out)
        self.assertFalse(out.exists() and out.read_text())

    def test_dumps_without_pairs_are_found_first(self):
        out = self.work / "digest.jsonl"
        self.cell("--set", "output=digest", "--dump-pairs", self.work / "digest.csv", "--out", out)
        self.assertFalse(out.exists() and out.read_text())

    def test_dump_after_a_failed_cell_keeps_the_table(self):
        status, text, errors = tandem("run", "--mesh", self.good, "--mesh", self.good, "--algorithm", "gproximity", "--device",
                                      "host", "--repeat", 1, "--set", "queue_bytes=1099511627776,67108864", "--dump-pairs",
                                      self.work / "failed.csv")
        self.assertEqual((status, len(errors), text.count(": right: ")), (3, 1, 1))

    def test_a_failure_is_one_line_without_an_empty_one(self):
        done = subprocess.run([str(PROGRAM), "run", "--mesh", self.good, "--algorithm", "gproximity", "--device", "host", "--set",
                               "queue_bytes=1099511627776"], capture_output=True, text=True, timeout=60)
        self.assertTrue(done.stderr.startswith("tandem: "), done.stderr)

    def test_any_file_name_can_be_recorded(self):
        path = os.path.join(os.fsencode(self.work), b"na\xffme.msh")
        with open(path, "wb") as file:
            file.write(self.good.read_bytes())
        done = subprocess.run([os.fsencode(PROGRAM), b"run", b"--mesh", path, b"--device", b"host", b"--repeat", b"1", b"--out",
                               os.fsencode(self.work / "name.jsonl")], capture_output=True, timeout=60)
        self.assertIn(done.returncode, (0, 2), done.stderr)

    def test_records_go_into_a_pipe(self):
        self.assertEqual(self.cell("--out", "/dev/stdout")[0], 0)

    def test_a_profile_says_that_nothing_was_measured(self):
        status, out, errors = self.cell("--profile", "3")
        self.assertEqual((status, errors), (0, []))
        self.assertIn("on host: replayed frames 0:0 3 times; nothing measured or recorded", out)

    def test_a_profile_writes_nothing(self):
        for option in ("--out", "--dump-pairs", "--dump-contacts"):
            status, _, errors = self.cell("--profile", "1", option, self.work / "profile.x")
            self.assertEqual((status, len(errors)), (2, 1))
            self.assertIn("--profile only replays frames", errors[0])
        self.assertFalse((self.work / "profile.x").exists())

    def test_a_negative_profile_is_refused(self):
        self.assertEqual(self.cell("--profile", "-1", timeout=3)[0], 2)

    def test_poses_without_meshes_are_refused(self):
        pose = ("--pose", "1 0 0 1 0 0 0")
        self.assertEqual(tandem("run", "pile:bodies=2,frames=1", "--device", "host", "--repeat", 1, *pose)[0], 2)

    def test_unknown_devices_beside_all_are_refused(self):
        self.assertEqual(tandem("run", "pile:bodies=2,frames=1", "--repeat", 1, "--device", "all,nosuch")[0], 2)

    def test_a_folder_is_no_scene_description(self):
        folder = self.work / "folder.json"
        folder.mkdir()
        self.bad("folder.json", "run", folder)

    def test_the_place_in_a_scene_description_reads_well(self):
        path = self.work / "place.json"
        path.write_text('{"meshes": {"j": {"builtin": "jack"}}}')
        self.assertNotIn(": :", tandem("run", path)[2][0])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
