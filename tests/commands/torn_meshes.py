# SPDX-License-Identifier: MIT
# test: cost=10 full=20
"""Duplicate tetrahedra and torn meshes: merged, welded or refused, the answers are those of the whole mesh."""

import json

from tests.program import LONG, Case, bar, gmsh, tandem


def own_algorithms():
    listed = json.loads(tandem("algorithms", "--json")[1])
    return [one["name"] for one in listed if not one["baseline"]]


def beside_itself(mesh):
    return f"--mesh {mesh} --mesh {mesh} --pose '0 0 0 1 0 0 0' --pose '0.3 0.2 0.1 1 0 0 0' --set self=on"


class TornMeshes(Case):
    def pairs_of(self, mesh, *arguments):
        """Pairs and contacts of the mesh beside itself and with itself, the lines on standard error, and
        scene.reading of the record."""
        pairs, contacts, out = (self.work / name for name in ("pairs.csv", "contacts.csv", "reading.jsonl"))
        out.unlink(missing_ok=True)
        status, text, errors = tandem(
            f"run {beside_itself(mesh)}",
            *arguments,
            f"--device host --repeat 1 --dump-pairs {pairs} --dump-contacts {contacts} --out {out}",
        )
        self.assertEqual(status, 0, errors)
        self.assertIn("right: no pair missing", text)
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
        of_one_body = lambda row: row.split(",")[1] == row.split(",")[3]
        apart_of = lambda answer: sum(not of_one_body(row) for row in answer[0]) - 1
        more, earlier = 4 * len(tets) - len(points), "tetrahedra have the vertices of an earlier one"
        for algorithm in own_algorithms():
            with self.subTest(algorithm):
                found = lambda mesh, *more: self.pairs_of(mesh, f"--algorithm {algorithm}", *more)
                right = found(whole)
                self.assertEqual(right[2], [])
                self.assertTrue(any(of_one_body(row) for row in right[0][1:]), "no pair of one body")
                merged = found(twice)
                message = [f"tandem: mesh twice: {len(tets)} {earlier} and take no part"]
                self.assertEqual(merged[:3], (*right[:2], message))
                read = [merged[3][name] for name in ("handling", "duplicates", "weld")]
                self.assertEqual(read, ["merge", 2 * len(tets), None])
                self.assertEqual(apart_of(found(twice, "--duplicates", "keep")), 4 * apart_of(right))
                welded = found(torn, "--weld", 0)
                message = [f"tandem: mesh torn: {more} vertices are welded to an earlier one"]
                self.assertEqual(welded[:3], (*right[:2], message))
                self.assertEqual((welded[3]["weld"], welded[3]["welded"]), (0, 2 * more))
                apart = found(torn)
                self.assertNotEqual(apart[:2], right[:2])
                message = f"{more} vertices lie where an earlier one lies (--weld 0 joins them)"
                self.assertEqual(apart[2], [f"tandem: mesh torn: {message}"])
        for command in ("run", "check", "accuracy", "export"):
            words = ("--vtu", self.work / "vtu") if command == "export" else ("--device", "host")
            self.bad(
                f"{len(tets)} of {2 * len(tets)} {earlier}, such as 24 those of 0",
                f"{command} --mesh {twice} --duplicates reject",
                *words,
            )
        self.bad("--duplicates some: give merge, keep or reject", "run", "plates", "--duplicates", "some")
        for value in ("-1", "nan", "inf"):
            self.bad(f"--weld {value}: give a finite tolerance of 0 or more", f"run plates --weld={value}")

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
                f"check {beside_itself(mesh)} --device host,opencl:0 --out {out}",
                *(() if LONG else ("--preset", "grouped,resident,fair")),
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
        self.assertLessEqual(set(own_algorithms()), {key[0] for key in right})
        self.assertEqual(welded, right)
        for key, answer in apart.items():
            self.assertNotEqual(answer, right[key], key)
