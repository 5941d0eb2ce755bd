# SPDX-License-Identifier: MIT
# test: cost=30 full=50
"""What run and check find: the matrix of check, dumps against brute force, hard
cases, a baseline."""

import itertools
import json
import xml.etree.ElementTree

from tests.program import LONG, SMALL, Case, bar, gmsh, right_cells, sets, tandem


def boxes(points, tets):
    return [
        [(min(points[v][axis] for v in t), max(points[v][axis] for v in t)) for axis in range(3)]
        for t in tets
    ]


def overlapping(a, b):
    """Pairs of tetrahedra whose boxes overlap or touch. Coordinates are multiples of 1/8, so this is exact."""
    return [
        (i, j)
        for i, x in enumerate(boxes(*a))
        for j, y in enumerate(boxes(*b))
        if all(p[0] <= q[1] and q[0] <= p[1] for p, q in zip(x, y))
    ]


def own_algorithms():
    """The algorithms that run by default."""
    return [entry for entry in json.loads(tandem("algorithms", "--json")[1]) if not entry["baseline"]]


class Answers(Case):
    def test_check_prints_the_matrix(self):
        """The short form has all presets on the host, and those that come first on all devices, because PoCL
        compiles slowly."""
        presets = sum(len(entry["presets"]) for entry in own_algorithms())
        devices = [d["id"] for entry in json.loads(tandem("devices", "--json")[1]) for d in entry["devices"]]
        first = ",".join({entry["presets"][0]["name"] for entry in own_algorithms()})
        chosen = sum(
            preset["name"] in first.split(",") for entry in own_algorithms() for preset in entry["presets"]
        )
        pile = "pile:bodies=8,frames=2"
        short = (
            ((pile, "--device", "host"), presets),
            ((pile, "--preset", first, *sets(SMALL)), chosen * len(devices)),
        )
        full = (("plates", "--frames", "20:21"), presets * len(devices)), ((pile,), presets * len(devices))
        for arguments, cells in full if LONG else short:
            out = self.output("check", *arguments)
            rows = [
                line.split() for line in out.splitlines() if line.split()[:1] and line.split()[0] in devices
            ]
            self.assertEqual(len(rows), cells, out)
            for row in rows:
                self.assertGreater(int(row[3]), 0)
                self.assertEqual((row[4:6], row[8]), (["0", "0"], "yes"), out)
            self.assertIn("\nall agree with the reference\n", out)

    def test_check_leaves_out_what_the_settings_do_not_suit(self):
        asked = ("check", "pile:bodies=4,frames=2", "--device", "host", "--set", "order=canonical")
        status, out, errors = tandem(*asked)
        self.assertEqual((status, len(errors)), (0, 1), out)
        rows = [line for line in out.splitlines() if line.startswith("host ")]
        presets = [preset["name"] for entry in own_algorithms() for preset in entry["presets"]]
        left_out = presets.count("published") + presets.count("fair-published")
        self.assertGreater(left_out, 0)
        self.assertIn(
            f"{len(presets) - len(rows)} of {len(presets)} cells left out: setting order=canonical does not go with residency=published",
            errors[0],
        )
        self.assertFalse(any("published" in row for row in rows), out)
        self.bad("does not go with residency=published", *asked, "--preset", "published")
        self.bad("is impossible; choose one of any, canonical", *asked[:-1], "order=sorted")

    def test_cells_of_other_body_pairs_are_not_compared(self):
        """No verdict tells the fastest of cells that walk other body pairs; of others it does."""
        cell = ("run pile:bodies=8,frames=1 --device host --algorithm chunked --set k=8 --repeat 1",)
        for values, verdicts in (
            (("broad=sphere,sphere_boxes",), 0),
            (("broad=sphere_boxes", "most_body_pairs=0,3"), 0),
            (("broad=sphere_boxes", "leaves=8,32"), 1),
        ):
            out = self.work / f"compared-{'-'.join(values)}.jsonl"
            self.output(*cell, *(word for value in values for word in ("--set", value)), "--out", out)
            self.assertEqual(len(self.records(out)), 2)
            self.assertEqual(
                sum(json.loads(line).get("kind") == "verdict" for line in out.read_text().splitlines()),
                verdicts,
                values,
            )

    def test_dumps_agree_with_brute_force(self):
        parts = [bar(4, (0, 0, 0)), bar(3, (0.5, 0.25, 0.375))]
        files = [gmsh(self.work / f"part{i}.msh", *part) for i, part in enumerate(parts)]
        header = (
            "frame,body_a,tet_a,body_b,tet_b",
            "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth",
        )
        # Poses without rounding: a translation, and half a turn about z.
        for pose, sign, shift in (
            ("0.125 0 0 1 0 0 0", 1, (0.125, 0, 0)),
            ("3.5 1 -0.375 0 0 0 1", -1, (3.5, 1, -0.375)),
        ):
            moved = (
                [(sign * x + shift[0], sign * y + shift[1], z + shift[2]) for x, y, z in parts[1][0]],
                parts[1][1],
            )
            expected = [(0, 0, a, 1, b) for a, b in overlapping(parts[0], moved)]
            self.assertGreater(len(expected), 50)
            self.assertLess(len(expected), len(parts[0][1]) * len(parts[1][1]))
            for algorithm, rounding in itertools.product(("chunked", "gproximity"), ("nearest", "safe")):
                pairs, contacts, out = (
                    self.work / f"d{len(list(self.work.iterdir()))}.{end}" for end in ("p", "c", "jsonl")
                )
                self.output(
                    "run --mesh",
                    files[0],
                    "--mesh",
                    files[1],
                    f"--pose '0 0 0 1 0 0 0' --pose '{pose}' --set k=6 --set rounding={rounding} "
                    f"--algorithm {algorithm} --repeat 1",
                    *(() if LONG or rounding == "safe" else ("--device", "host")),
                    f"--dump-pairs {pairs} --dump-contacts {contacts} --out {out}",
                )
                self.assertEqual(self.dump(pairs, header[0])[1], expected)
                work = self.records(out)[0]["work"]
                self.assertEqual(work["candidate_pairs"], [len(expected)])
                rows, ids = self.dump(contacts, header[1])
                self.assertEqual(len(rows), work["contacts"][0])
                self.assertGreater(len(rows), 10)
                self.assertLessEqual(set(ids), set(expected))
                for row in rows:
                    self.assertAlmostEqual(sum(float(x) ** 2 for x in row[8:11]), 1, places=5)

    def test_dumps_of_meshes_with_map_coordinates(self):
        """Single precision cannot represent their vertices. With origin=auto it represents the centred meshes."""
        parts = [bar(4, (0, 0, 0)), bar(3, (0.5, 0.25, 0.375))]
        expected = [(0, 0, a, 1, b) for a, b in overlapping(*parts)]
        far = (6452399.0, 1872182.375, 0)
        files = [
            gmsh(self.work / f"far{i}.msh", [tuple(map(sum, zip(point, far))) for point in points], tets)
            for i, (points, tets) in enumerate(parts)
        ]
        found = {}
        for origin in ("auto", "world"):
            pairs, out = self.work / f"{origin}.p", self.work / f"{origin}.jsonl"
            text = self.output(
                "run --mesh",
                files[0],
                "--mesh",
                files[1],
                f"--set k=6 --set origin={origin} --algorithm tiled --repeat 1 --dump-pairs {pairs} "
                f"--out {out}",
            )
            found[origin] = self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1]
            self.assertIn("right: no pair missing or extra, contacts equal bit for bit", text)
        self.assertEqual(found["auto"], expected)
        self.assertNotEqual(found["world"], expected)

    def test_dumps_of_several_frames(self):
        pairs, contacts, out = (self.work / name for name in ("p.csv", "c.csv", "frames.jsonl"))
        self.output(
            f"run plates --frames 20:21 --repeat 1 --algorithm gproximity --dump-pairs {pairs} "
            f"--dump-contacts {contacts} --out {out}"
        )
        work = self.records(out)[0]["work"]
        for path, columns, counts in ((pairs, 5, work["candidate_pairs"]), (contacts, 12, work["contacts"])):
            header = "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth".split(",")[:columns]
            ids = self.dump(path, ",".join(header))[1]
            self.assertEqual([sum(row[0] == frame for row in ids) for frame in (20, 21)], counts)
            self.assertEqual(len(ids), sum(counts))
        self.assertTrue(
            all(a < b for _, a, _, b, _ in self.dump(pairs, "frame,body_a,tet_a,body_b,tet_b")[1])
        )

    def test_dumps_of_distances(self):
        header = "frame,body_a,tet_a,body_b,tet_b,ax,ay,az,bx,by,bz,nx,ny,nz,distance"
        found = {}
        for output in ("pairs", "distances"):
            path, out = self.work / f"{output}.d", self.work / f"{output}.jsonl"
            self.output(
                f"run plates --frames 20 --repeat 1 --algorithm tiled --set margin=0.01 --set output={output} "
                f"--set contact_rule=distance --dump-distances {path} --out {out}"
            )
            rows, ids = self.dump(path, header)
            self.assertEqual(len(rows), self.records(out)[0]["work"]["contacts"][0])
            self.assertEqual(len(set(ids)), len(ids), "one a pair")
            for row in rows:
                a, b, n = ([float(x) for x in row[first : first + 3]] for first in (5, 8, 11))
                self.assertLess(float(row[14]), 0.01001)
                for at, other, along in zip(a, b, n):
                    self.assertAlmostEqual(at + along * float(row[14]), other, 12)
            found[output] = {
                (row[1], row[3]): min(float(r[14]) for r in rows if (r[1], r[3]) == (row[1], row[3]))
                for row in rows
            }
        self.assertEqual(found["pairs"], found["distances"], "the least of each pair of bodies")

    def test_dumps_of_surfaces(self):
        """The polygons of a table, of a VTK file and of sums are the same."""
        path, vtp, out, sums = (self.work / name for name in ("s.csv", "s.vtp", "s.jsonl", "w.csv"))
        given = (
            "run pile:bodies=4,refine=1,density=0.5 --pressure 1e6 --frames 0:1 --repeat 1 --algorithm tiled"
        )
        self.output(
            f"{given} --set contact_rule=pressure --dump-contacts {path} --dump-surfaces {vtp} --out {out}"
        )
        rows, ids = self.dump(path, "frame,body_a,tet_a,body_b,tet_b,cx,cy,cz,nx,ny,nz,area,pressure")
        self.assertEqual(len(rows), sum(self.records(out)[0]["work"]["contacts"]))
        self.assertEqual(len(set(ids)), len(ids), "one a pair")
        piece = xml.etree.ElementTree.parse(vtp).find("PolyData/Piece")
        self.assertEqual(int(piece.get("NumberOfPolys")), len(rows))
        self.assertGreaterEqual(int(piece.get("NumberOfPoints")), 3 * len(rows))
        self.output(f"{given} --set output=wrenches --dump-contacts {sums}")
        header = "frame,body_a,tet_a,body_b,tet_b,fx,fy,fz,mx,my,mz,area,polygons"
        for row in self.dump(sums, header)[0]:
            own = [r for r in rows if (r[0], r[1], r[3]) == (row[0], row[1], row[3])]
            self.assertEqual(len(own), int(row[12]))
            area = sum(float(r[11]) for r in own)
            self.assertAlmostEqual(float(row[11]) / area, 1, 5)
            for axis in range(3):
                force = sum(float(r[8 + axis]) * float(r[11]) * float(r[12]) for r in own)
                self.assertLess(abs(float(row[5 + axis]) - force), 1e-5 * 1e6 * area)

    def test_tiny_capacities_retry(self):
        out = self.work / "tiny.jsonl"
        status, text, _ = tandem(
            "run pile:bodies=6,frames=1 --algorithm chunked,gproximity --set pair_capacity=1 "
            f"--set contact_capacity=1 --out {out}"
        )
        self.assertEqual(status, 0, text)
        for record in self.records(out):
            self.assertGreater(record["work"]["retries"], 0)

    def test_hard_cases(self):
        fast = ("--device host --quiet --preset grouped,resident,fair", *(() if LONG else sets(SMALL)))
        out = self.output(
            "check", "hard:corner-cancellation", "--set", "k=8", "--set", "rounding=nearest,safe", *fast
        )
        missed = [int(line.split()[-3]) for line in out.splitlines() if line.startswith("host ")]
        nearest, safe = missed[::2], missed[1::2]
        algorithms = own_algorithms()
        self.assertEqual((len(missed), set(safe)), (2 * len(algorithms), {0}), out)
        self.assertGreater(min(nearest), 0, out)
        out = self.output("check", "hard:all:pairs=2,together=2", *fast)
        rows = [line for line in out.splitlines() if line.startswith("hard:")]
        self.assertEqual(len(rows), 60)
        refusal = "tetrahedra 2 not finite in 1 of 2 bodies: body 0 tetrahedron 0, 1 in frame 0; "
        self.assertIn("refused: " + refusal, rows[9])
        self.assertEqual(
            rows[10].split(),
            ["hard:not-finite", "1", "0", "0", "0", "0", "0", str(len(algorithms)), "0", "skipped:", "2"],
        )
        self.assertIn("rounding=safe misses no pair that touches or overlaps", out)
        self.bad("unknown family of hard cases 'tuch'; the nearest is 'touch'", "check", "hard:tuch")
        self.bad("difficulty=10 is impossible; give a number from 1 to 9", "run", "hard:touch:difficulty=10")
        self.bad("hard:all accepts seed, field, pairs and together", "check", "hard:all:difficulty=1")

    def test_a_baseline_finds_the_same_pairs(self):
        """Same pairs in the same record, when the program has it. It refuses what it does not support, and
        its absence is an error."""
        summary = next(
            e["summary"] for e in json.loads(tandem("algorithms", "--json")[1]) if e["name"] == "embree"
        )
        arguments = ("run", "pile:bodies=4,frames=1", "--device", "host", "--repeat", 1, "--set", "k=6")
        if "built without Embree" in summary:
            self.bad("libembree-dev", *arguments, "--algorithm", "embree")
            return
        out = self.work / "baseline.jsonl"
        text = self.output(*arguments, "--algorithm", "chunked,embree", "--out", out)
        self.assertEqual(right_cells(text), 2, text)
        chunked, embree = self.records(out)
        self.assertGreater(embree["work"]["candidate_pairs"][0], 0)
        for name in ("digest", "contact_digest"):
            self.assertEqual(embree["agreement"][name], chunked["agreement"][name])
        for stage in ("refit", "traverse"):
            self.assertGreater(embree["stages"][stage]["device_ns"]["median"], 0)
        self.assertNotIn("embree", tandem(*arguments)[1])
        self.bad("choose k=6", *arguments[:-1], "k=18", "--algorithm", "embree")
        self.bad("choose float", *arguments, "--set", "precision=double", "--algorithm", "embree")
        for device in ("opencl:0", "host+opencl:0"):
            self.bad("device host only, not on opencl:0", f"run plates --device {device} --algorithm embree")
