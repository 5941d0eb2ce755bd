# SPDX-License-Identifier: MIT
# test: cost=8
"""scripts/peers with peers that test all pairs one by one, and with those that answer wrongly, fail, or print what they
should not."""

import json

from tests.program import PROGRAM, tandem
from tests.script_case import ScriptCase, script

# Tests all pairs one by one; {change} may change the line that is printed.
PEER = """import json, sys
import numpy

boxes, bodies, device, rounds = sys.argv[1:]
lo, hi = numpy.fromfile(boxes, "<f4").reshape(-1, 2, 3).swapaxes(0, 1)
bodies = numpy.fromfile(bodies, "<u4")
pairs = 0
for i in range(len(lo)):
    rest = slice(i + 1, None)
    meets = (lo[i] <= hi[rest]).all(1) & (lo[rest] <= hi[i]).all(1)
    pairs += int((meets & (bodies[rest] != bodies[i])).sum())
times = [1.0 + i for i in range(int(rounds))]
line = dict(name="one by one", version="1", device=device, pairs=pairs, build_ms=times, query_ms=times)
{change}
print("a first line")
print(json.dumps(line))
"""
# Prints a line without a look at the boxes.
BLIND = """import json, sys

times = [1.0] * int(sys.argv[4])
line = dict(name="blind", version="1", device="none", pairs=1, build_ms=times, query_ms=times)
{change}
print(json.dumps(line))
"""


class Peers(ScriptCase):
    def peer(self, change="", text=PEER, name="peer.py"):
        """The command of a peer."""
        path = self.work / name
        path.write_text(text.format(change=change))
        return f"/usr/bin/python3 {path}"

    def run_script(self, *arguments, code=0, algorithm="tiled,leaf_query"):
        """(output, lines of JSON)."""
        out = self.work / "out.jsonl"
        out.unlink(missing_ok=True)
        options = ("--device", "host", "--rounds", 3, "--program", PROGRAM, "--out", out)
        options += ("--algorithm", algorithm) if algorithm else ()
        status, text, errors = script("peers", *arguments, *options)
        self.assertEqual((status, errors), (code, []), text)
        return text, list(map(json.loads, out.read_text().splitlines()))

    def test_counts_equal_all_pairs_tested_one_by_one(self):
        """Rigid bodies that turn, and deformable ones, which touch in frame 0 and are twisted in frame 200."""
        for scene, number in (("pile:bodies=3,density=0.4", 1), ("plates", 0), ("plates", 200)):
            text, rows = self.run_script(scene, self.peer(), "--frame", number)
            names = [row["name"] for row in rows]
            self.assertEqual((sorted(names[:2]), names[2]), (["leaf queries", "tiled"], "one by one"))
            self.assertEqual({row["is_equal"] for row in rows}, {True})
            self.assertGreater(rows[0]["pairs"], 500)
            self.assertEqual({row["pairs"] for row in rows}, {rows[-1]["pairs"]})
            head = f"{scene}, frame {number}: {rows[0]['boxes']:,} boxes, {rows[0]['pairs']:,} pairs"
            self.assertEqual(text.splitlines()[0], head)

    def test_times(self):
        """A frame is a new tree and a query, with new bounds instead where the peer has them."""
        change = "line['name'], line['refit_ms'] = 'refits', [0.5] * len(times)"
        peers = self.peer(), self.peer(change, name="refits.py")
        text, rows = self.run_script("plates", *peers, algorithm="tiled")
        self.assertEqual(rows[1]["frame_ms"], [2.0, 4.0, 6.0])
        self.assertEqual(rows[2]["frame_ms"], [1.5, 2.5, 3.5])
        lines = {line[: len("one by one")].strip(): line.split() for line in text.splitlines()[2:5]}
        median = sorted(rows[0]["frame_ms"])[1]
        self.assertEqual(lines["one by one"][-6:-2], ["2.000", "-", "2.000", "4.000"])
        self.assertEqual(lines["refits"][-6:-2], ["2.000", "0.500", "2.000", "2.500"])
        fastest = min(median, 2.5)  # a busy machine may take longer than the peers say
        for name, frame in (("tiled", median), ("refits", 2.5)):
            self.assertAlmostEqual(float(lines[name][-2]), frame / fastest, delta=0.006)
        self.assertEqual(lines["tiled"][-1], "equal")

    def test_all_walks_and_the_baselines_that_can_run(self):
        known = json.loads(tandem("algorithms", "--json")[1])
        names = {row["name"] for row in self.run_script("plates", self.peer(), algorithm=None)[1]}
        walks = {one["presets"][0]["title"] for one in known if not one["baseline"]}
        self.assertLessEqual(walks, names)
        self.assertNotIn("cuBQL", names)  # needs a GPU

    def test_wrong_count(self):
        text, rows = self.run_script("plates", self.peer("line['pairs'] += 1"), code=1, algorithm="tiled")
        self.assertEqual([row["is_equal"] for row in rows], [True, False])
        line = next(line for line in text.splitlines() if line.startswith("one by one"))
        self.assertTrue(line.endswith(f" -  DIFFERENT: {rows[0]['pairs'] + 1:,}"), line)

    def test_peers_that_fail(self):
        options = ("--device", "host", "--program", PROGRAM)
        failing = self.peer("sys.exit('no such device')", BLIND)
        self.refused("peers", "peer.py: no such device", "plates", failing, *options, code=3)
        self.refused("peers", "none: No such file", "plates", self.work / "none", *options)
        for change in (
            "line = 'text'",
            "del line['query_ms']",
            "line['pairs'] = 1.5",
            "line['pairs'] = -1",
            "line['name'] = 1",
            "line['build_ms'] = [0.0] * len(times)",
            "line['build_ms'] = times[1:]",
            "line['refit_ms'] = None",
            "line['query_ms'] = [float('inf')] * len(times)",
            "line['query_ms'] = line['build_ms'] = []",
        ):
            with self.subTest(change):
                self.refused(
                    "peers", "is not what a peer prints", "plates", self.peer(change, BLIND), *options
                )

    def test_bad_use(self):
        program = ("--program", PROGRAM)
        self.refused("peers", "tandem: ", "no-scene", self.peer(), *program)
        self.refused("peers", "tandem: ", "plates", self.peer(), "--device", "nothing", *program)
        self.refused("peers", "build it by scripts/build", "plates", "p", "--program", self.work / "none")
        status, _, errors = script("peers", "plates", "p", "--rounds", "0")
        self.assertEqual((status, "--rounds begins with 1" in errors[-1]), (2, True))
