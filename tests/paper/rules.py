# SPDX-License-Identifier: MIT
# test: cost=2
"""Verdicts that no measurement gives: by construction, errata of the paper, provisional ones and means that
prove nothing; and records that must not be judged: of small scenes, of older rules of descent, of queues that
are too small."""

import json
import pathlib
import re
import tempfile
import unittest

from tests.paper import records as made
from tandem.pages.markup import markup
from tandem.paper import claims, headline
from tandem.paper.claim_groups import claim_groups, errata
from tandem.paper.folder import Folder
from tandem.paper.measures import Declared
from tandem.paper.rules import (
    AGREES,
    BY_CONSTRUCTION,
    DIFFERS,
    ERRATUM,
    NOT_SETTLED,
    UNTESTED,
    VERDICTS,
    exact,
    judged,
    limits,
    together,
)

SCALE = 10**9
COUNTS = ("count", "chunks", "boundary", "digests", "chunks_by_equations", "paper_itself")


class Rules(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-rules")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0
        self.fields = {one["id"]: one for one in claims.declared()}

    def folder(self, files, size="full"):
        self.count += 1
        return Folder(made.write_folder(self.work / str(self.count), files, size))

    def pair(self, claim, scene, value, quantity=None, **settings):
        """Records of both sides of a claim, whose ratio is the value."""
        fields, cells = self.fields[claim], []
        for side, part in (("above", value), ("below", 1)):
            one = made.record(scene, Declared(fields).wanted(fields[side], "8") | settings, 3)
            made.set_quantity(one, quantity or fields[side]["quantity"], [SCALE * part] * 3)
            cells.append(one)
        return cells

    def test_inputs_and_code_are_counted_apart(self):
        cell = made.record("plates", {"algorithm": "chunked", "preset": "published", "k": "8"}, 1)
        cell["scene"]["bodies"] = 3
        found = claims.judge(self.fields["bodies"], self.folder({"cells-plates": [cell]}))
        self.assertEqual(found.verdict, BY_CONSTRUCTION)
        self.assertEqual([line.verdict for line in found.lines if line.label == "plates"], [BY_CONSTRUCTION])
        cell["scene"]["bodies"] = 4
        other = claims.judge(self.fields["bodies"], self.folder({"cells-plates": [cell]}))
        self.assertEqual(other.verdict, DIFFERS, "inputs can be wrong")
        self.assertEqual(
            claims.counts([found, other]),
            {verdict: int(verdict in (BY_CONSTRUCTION, DIFFERS)) for verdict in VERDICTS},
        )
        text = headline._verdicts([found, other])
        self.assertIn("Among 2 claims of the paper, 0 agree with measurements, 1 differ", text)
        self.assertIn("1 hold by construction", text)
        self.assertEqual(
            [
                together([BY_CONSTRUCTION, one], "all")
                for one in (BY_CONSTRUCTION, DIFFERS, UNTESTED, NOT_SETTLED)
            ],
            [BY_CONSTRUCTION, DIFFERS, BY_CONSTRUCTION, NOT_SETTLED],
        )

    def test_errata_come_from_the_papers_numbers(self):
        """The paper's 53 chunks of a glass are not those of its equations, and 500 steps not those of its
        totals."""
        folder = self.folder({})
        found = {name: claims.judge(self.fields[name], folder) for name in ("equation-2", "steps-of-totals")}
        self.assertEqual({claim.verdict for claim in found.values()}, {ERRATUM})
        values = [round(line.measured.value) for claim in found.values() for line in claim.lines]
        self.assertEqual(values, [27, 830, 18012])
        self.assertEqual(sum(claims.counts(found.values()).values()), 0)
        self.assertIn("2 more are errata", headline._verdicts(list(found.values())))
        kept = {**self.fields["equation-2"], "rule": {"between": [27, 27]}}
        self.assertEqual(claims.judge(kept, folder).verdict, AGREES)
        release = {**self.fields["equation-2"], "bytes": 4000}
        self.assertEqual(claims.judge(release, folder).verdict, AGREES, "L = 32, as the release has it")
        text = re.sub("<[^>]*>", "", markup(errata(claims.all_claims(folder))))
        self.assertIn("glasses: 27 chunks of a glass – erratum (equation 2 as printed", text)

    def test_provisional_verdicts_say_so(self):
        fields = self.fields["collision-share"]
        cell = made.record("funnel", Declared(fields).wanted(fields["above"], "8"), 3)
        made.set_quantity(cell, "frame", [10**6 * made.FULL_STEPS] * 3)
        steps = [
            made.step(i, contacts_found=1, host={name: 1 for name in ("solve", "assemble", "move", "reduce")})
            for i in range(made.FULL_STEPS)
        ]
        folder = self.folder({"cells-funnel": [cell], "solver-funnel": made.simulation("funnel", steps)})
        found = claims.judge(fields, folder)
        self.assertEqual(found.verdict, AGREES)
        self.assertTrue(found.lines[0].reason.startswith("provisional: "), found.lines[0].reason)
        text = re.sub("<[^>]*>", "", markup(claim_groups([found], "claims")))
        self.assertRegex(text, r"funnel: [0-9.]+ %.* – agrees \(provisional: ")
        self.assertEqual(
            {
                name
                for name, one in self.fields.items()
                if one.get("measure") in ("composed_step", "composed_total")
            },
            {name for name, one in self.fields.items() if "provisional" in one},
        )

    def test_a_mean_within_limits_proves_nothing(self):
        rule = self.fields["seeds-of-a-pair"]["rule"]
        self.assertEqual(limits(rule), (10**7 / 32, 10**7))
        self.assertEqual(
            [judged(exact(value), rule)[0] for value in (3138, 10**6, 10**8)], [DIFFERS, NOT_SETTLED, DIFFERS]
        )

    def test_sizes_have_both_ends(self):
        """A rule with the paper's numbers is a size, and bounded above and below unless its words are about
        one end."""
        one_ended = {
            name
            for name, one in self.fields.items()
            if "paper" in one.get("rule", {}).values() and "between" not in one["rule"]
        }
        self.assertEqual(one_ended, {"refit-small"})
        for name, value, verdict in (
            ("narrow-small-array", 40, AGREES),
            ("narrow-small-array", 400, DIFFERS),
            ("narrow-small-array", 4, DIFFERS),
        ):
            folder = self.folder({"cells-plates": self.pair(name, "plates", value)})
            found = claims.line_of(Declared(self.fields[name]), folder, "plates", "8")
            self.assertEqual(found.verdict, verdict, (name, value))

    def test_small_scenes_judge_counts_only(self):
        for name, one in self.fields.items():
            if one.get("small") and one.get("measure", "count") not in COUNTS:
                quantities = {one[side]["quantity"] for side in ("above", "below")}
                self.assertTrue(
                    quantities
                    <= {
                        "counter:seeds",
                        "body pairs",
                        "release launches",
                        "launches:contact",
                        "launches:traverse",
                    },
                    name,
                )
        timed = {**self.fields["read"], "small": True}
        cells = self.pair("read", "plates", 2)
        for size, verdict in (("full", AGREES), ("small", UNTESTED)):
            found = claims.line_of(Declared(timed), self.folder({"cells-plates": cells}, size), "plates", "8")
            self.assertEqual(found.verdict, verdict, size)
        self.assertEqual(found.reason, "small scenes judge counts only")

    def test_older_records_have_another_rule_of_descent(self):
        cells = self.pair("descend-both", "plates", 2)
        line = lambda: claims.line_of(
            Declared(self.fields["descend-both"]), self.folder({"descents": cells}), "plates", "8"
        )
        self.assertEqual(line().verdict, AGREES)
        for cell in cells:
            del cell["settings"]["copies"]
        self.assertEqual(line().verdict, UNTESTED)
        self.assertIn("older program", line().reason)

    def test_queues_that_end_every_launch_judge_nothing(self):
        """28 queues of a C2075's 14 compute units: 64 MiB hold 199,728 pairs each; 1 MiB hold 3,120, of which
        3,007 end a launch."""
        line = lambda size: claims.line_of(
            Declared(self.fields["kernels-on-par"]),
            self.folder({"cells-plates": self.pair("kernels-on-par", "plates", 1, queue_bytes=str(size))}),
            "plates",
            "8",
        )
        limit = 12 * 28 * 3007
        self.assertEqual([line(size).verdict for size in (2**26, limit + 12 * 28)], [AGREES, AGREES])
        self.assertEqual(line(limit).verdict, UNTESTED)
        self.assertEqual(
            line(limit).reason, f"with queue_bytes={limit}, every launch of gProximity ends after one round"
        )

    def test_a_claim_has_a_verdict_for_each_gpu(self):
        variants = list(claims.variants(self.fields["launches"]))
        self.assertEqual(len(variants), 16)
        for fields, scene, _, label in variants:
            gpu = fields["paper"]["gpu"]
            self.assertEqual(label, f"{scene}, {gpu}")
            self.assertEqual(fields["above"]["preset"], f"published-{gpu.lower()}")
        self.assertNotIn("{", json.dumps([fields["above"]["preset"] for fields, *_ in variants]))


class Profiles(unittest.TestCase):
    def test_a_traversal_is_held_against_the_ceilings(self):
        fields = {one["id"]: one for one in claims.declared()}["utilisation"]

        def line(floor_ns, entry="traverse", preset="published", status="ok"):
            times = {"median": 1000, "low": 900, "high": 1100}
            record = {
                "profile_of": "key",
                "status": status,
                "algorithm": "chunked",
                "preset": preset,
                "settings": {"k": "8"},
                "scene": {"key": made.SCENE_KEYS["funnel"]},
                "frames": {"first": 120, "last": 120},
                "sampling": {"rounds": 3},
                "kernels": [{"entry": entry, "device_ns": times, "floor": {"ns": floor_ns}}],
            }
            with tempfile.TemporaryDirectory(prefix="tandem-profile") as work:
                folder = Folder(made.write_folder(pathlib.Path(work), {"profile": [record]}))
                return claims.line_of(Declared(fields), folder, "funnel", "8")

        self.assertEqual([line(ns).verdict for ns in (900, 500, 50)], [AGREES, NOT_SETTLED, DIFFERS])
        self.assertEqual((line(550).measured.low, line(450).measured.high), (0.5, 0.5))
        for found in (line(None), line(900, "refit"), line(900, preset="paper"), line(900, status="failed")):
            self.assertEqual(found.verdict, UNTESTED)
