# SPDX-License-Identifier: MIT
# test: cost=20
"""A program with an additional algorithm, lbvh: listing, running, recording and
checking it."""

import json

from tests import program
from tests.program import BUILT, Case, right_cells

program.PROGRAM = BUILT / "tandem-lbvh"

SCENE = "pile:bodies=4,frames=1"
OWN = "leaf_hits"


class Extension(Case):
    def test_it_is_listed(self):
        out = self.output("algorithms")
        own = out[out.index("\nlbvh: ") :]
        for word in ("stored children", "resident", "rounding", OWN, "[candidate pairs]"):
            self.assertIn(word, own)
        out = self.output("algorithms", "--json")
        entries = {entry["name"]: entry for entry in json.loads(out)}
        self.assertEqual([name for name, entry in entries.items() if not entry["baseline"]][-1], "lbvh")
        self.assertLess({"chunked", "gproximity", "tiled"}, set(entries))
        self.assertEqual(
            [counter["name"] for counter in entries["lbvh"]["counters"]], ["bvtt_nodes", "seeds", OWN]
        )
        self.assertNotIn("residency", [parameter["name"] for parameter in entries["lbvh"]["parameters"]])
        self.assertNotIn(OWN, json.dumps(entries["chunked"]))

    def test_it_is_run_and_recorded(self):
        out = self.work / "run.jsonl"
        text = self.output(
            "run", SCENE, "--algorithm", "chunked,lbvh", "--device", "host", "--repeat", 1, "--out", out
        )
        self.assertEqual(right_cells(text), 2, text)
        self.assertRegex(text, r"(?m)^lbvh resident +\d")
        chunked, lbvh = self.records(out)
        self.assertEqual([record["algorithm"] for record in (chunked, lbvh)], ["chunked", "lbvh"])
        for name in ("digest", "contact_digest"):
            self.assertEqual(lbvh["agreement"][name], chunked["agreement"][name])
        counters = lbvh["work"]["counters"]
        self.assertEqual(set(counters), {"bvtt_nodes", "seeds", OWN})
        self.assertNotIn(OWN, chunked["work"]["counters"])
        # A leaf is reached when two leaves overlap: once per candidate pair.
        self.assertGreater(counters[OWN], 0)
        self.assertEqual(counters[OWN], lbvh["agreement"]["digest"]["count"])
        self.assertGreater(counters["bvtt_nodes"], counters["seeds"])

    def test_it_is_checked(self):
        devices = ("host", "opencl:0")
        out = self.output("check", SCENE, "--device", ",".join(devices), "--preset", "grouped,fair,resident")
        rows = [line.split() for line in out.splitlines() if line.split()[:1] and line.split()[0] in devices]
        own = [row for row in rows if row[1] == "lbvh"]
        self.assertEqual([row[:3] for row in own], [[device, "lbvh", "resident"] for device in devices], out)
        self.assertEqual({tuple(row[4:6]) for row in rows}, {("0", "0")}, out)
        self.assertIn("\nall agree with the reference\n", out)
