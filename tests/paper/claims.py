# SPDX-License-Identifier: MIT
# test: cost=15
"""Verdicts of 'tandem paper': every declared rule gives all of its verdicts with made-up records, a disturbed
machine and one sample settle nothing, small scenes judge no claim about size, and digests count where they
compare something."""

import json
import math
import pathlib
import shutil
import tempfile
import unittest

from tests.program import SOURCE


from tests.paper import records as made
from tandem.paper import claims, paper_numbers
from tandem.paper.folder import Folder
from tandem.paper.measures import Declared
from tandem.cell import Cell
from tandem.paper.quantities import batches_of, is_time
from tandem.paper.rules import (
    AGREES,
    BY_CONSTRUCTION,
    DIFFERS,
    NOT_SETTLED,
    UNTESTED,
    Measured,
    exact,
    judged,
    limits,
    together,
)

COMMITTED = SOURCE / "results/h200/paper"
OF_CELLS = ("ratio", "count", "composed_ratio", "composed_share", "over_fastest")
SCALE = 10**9


def targets(fields, scene):
    """(verdict, values of the claim's quantity, one for each of three rounds) from the limits of its rule."""
    rule = fields["rule"]
    least, most = limits(rule, list(paper_numbers.of_scene(fields.get("paper"), scene).values())) or (
        None,
        None,
    )
    if least is None:
        return
    factor = 1.5 * rule.get("borderline", 1) * rule.get("varies", 1)
    ends = [end for end in (least, most) if math.isfinite(end)]
    inside = math.sqrt(least * most) if len(ends) == 2 and least > 0 else ends[0] * factor
    if ends == [most]:
        inside = most / factor
    kept = BY_CONSTRUCTION if "by_construction" in fields else NOT_SETTLED if "proves" in rule else AGREES
    yield kept, [inside] * 3
    for end in ends:
        if end > 0:
            yield DIFFERS, [end / factor if end == least else end * factor] * 3
    if not is_counted(fields):
        yield NOT_SETTLED, [ends[0] * part for part in (0.5, 1.0, 1.5)]


def is_counted(fields):
    return fields["measure"] == "count" or not is_time(fields["above"]["quantity"])


def sides_of(fields, values):
    """(side, its factor in each round) of a claim of cells."""
    ones = [1.0] * len(values)
    if "among" in fields:
        [(name, (first, *_))] = fields["among"].items()
        return [(fields["above"], values), ({**fields["above"], name: first}, ones)]
    sides = ((fields["above"], values), (fields.get("below"), ones))
    return [(side, factors) for side, factors in sides if side and "quantity" in side]


def cells_for(fields, scene, k, values):
    """{step: records} in which the claim's quantity has these values in its rounds."""
    claim, files, made_cells = Declared(fields), {}, {}
    usual = fields.get("either", [None])[0]
    for side, factors in sides_of(fields, values):
        own, where = claim.wanted(side, k, usual), claim.steps(side, scene)[-1]
        at = (where, side.get("scene", scene), json.dumps(own, sort_keys=True))
        if at not in made_cells:
            made_cells[at] = made.record(side.get("scene", scene), own, len(values))
            files.setdefault(where, []).append(made_cells[at])
        scale = SCALE if is_time(side["quantity"]) else 1000 if fields["measure"] == "ratio" else 1
        made.set_quantity(made_cells[at], side["quantity"], [scale * value for value in factors])
    return files


def arrays_for(fields, scene, k, values):
    """{step: records} for a measure that is composed with the upload of an array, which makes up nearly all
    of the value."""
    files = cells_for(fields, scene, k, [1e-6] * 3)
    cell = made.record("plates", Declared(fields).wanted(fields["array"], k), 3)
    cell["scene"]["digest"] = "other frames"
    # A share of x of frames that take 1 without the upload needs an upload of x / (1 - x).
    uploads = [value / (1 - value) for value in values] if fields["measure"] == "composed_share" else values
    made.set_quantity(cell, "stages:write", [SCALE * upload for upload in uploads])
    return {**files, fields["array"]["step"][0]: [cell]}


class Verdicts(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-claims")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0

    def folder(self, files, size="full"):
        self.count += 1
        return Folder(made.write_folder(self.work / str(self.count), files, size))

    def verdict(self, fields, scene, k, files, size="full"):
        return claims.line_of(Declared(fields), self.folder(files, size), scene, k).verdict

    def test_a_rule_has_four_verdicts(self):
        close = lambda value: Measured(value, 0.99 * value, 1.01 * value, 3, basis="rounds")
        for rule, paper, inside, outside, on in (
            ({"at_least": 2}, (), 3, 1, 2),
            ({"at_most": 2}, (), 1, 3, 2),
            ({"between": [1, 2]}, (), 1.5, 3, 2),
            ({"at_least": "paper"}, (6, 9), 7, 5, 6),
            ({"at_most": "paper"}, (6, 9), 8, 10, 9),
            ({"between": "paper", "widened": 2}, (6, 9), 17, 19, 18),
        ):
            for value, verdict in ((inside, AGREES), (outside, DIFFERS), (on, NOT_SETTLED)):
                self.assertEqual(judged(close(value), rule, paper)[0], verdict, (rule, value))
        self.assertEqual(judged(close(1), {"at_least": "paper"}, ())[0], UNTESTED)
        self.assertEqual(judged(close(1.8), {"at_least": 2, "borderline": 1.25}), (NOT_SETTLED, "borderline"))
        self.assertEqual(judged(close(1.5), {"at_least": 2, "borderline": 1.25})[0], DIFFERS)
        varied = {"at_least": 2, "varies": 1.5}
        for value, verdict in ((3.2, AGREES), (2.5, NOT_SETTLED), (1.5, NOT_SETTLED), (1.2, DIFFERS)):
            self.assertEqual(judged(close(value), varied)[0], verdict)
        self.assertEqual(
            judged(Measured(9, 9, 9, 1, basis="one sample"), {"at_least": 2}), (NOT_SETTLED, "one sample")
        )
        self.assertEqual(
            judged(Measured(9, 9, 9, 0, 3, "rounds"), {"at_least": 2}),
            (NOT_SETTLED, "disturbed samples only"),
        )
        self.assertEqual(judged(exact(9), {"at_least": 2})[0], AGREES)

    def test_verdicts_of_scenes_become_one(self):
        for verdicts, every, some in (
            ((AGREES, UNTESTED), AGREES, AGREES),
            ((AGREES, DIFFERS, NOT_SETTLED), DIFFERS, AGREES),
            ((DIFFERS, NOT_SETTLED), DIFFERS, NOT_SETTLED),
            ((AGREES, NOT_SETTLED), NOT_SETTLED, AGREES),
            ((UNTESTED, UNTESTED), UNTESTED, UNTESTED),
            ((DIFFERS, UNTESTED), DIFFERS, UNTESTED),
            ((DIFFERS, DIFFERS), DIFFERS, DIFFERS),
        ):
            self.assertEqual((together(verdicts, "all"), together(verdicts, "any")), (every, some), verdicts)

    def test_every_rule_of_cells_flips(self):
        """Made-up records take each declared claim of cells through its verdicts, in each scene for which the
        paper has a limit."""
        flipped = set()
        for fields in claims.declared():
            if fields.get("measure") not in OF_CELLS:
                continue
            for own, scene, k, _ in claims.variants(fields):
                for verdict, values in targets(own, scene):
                    files = (arrays_for if "array" in own else cells_for)(own, scene, k, values)
                    self.assertEqual(self.verdict(own, scene, k, files), verdict, (own["id"], scene, values))
                self.assertEqual(self.verdict(own, scene, k, {}), UNTESTED, own["id"])
                flipped.add(own["id"])
        self.assertGreater(len(flipped), 40)

    def test_rules_of_simulations_flip(self):
        fields = {one["id"]: one for one in claims.declared()}
        growing = lambda slope: [
            made.step(i, stages={"traverse": 1000 + slope * i}, contacts_found=10 * (i + 1))
            for i in range(60)
        ]
        noisy = [
            made.step(i, stages={"traverse": 10**6 + (i if i % 7 else 60 - i)}, contacts_found=10 * (i + 1))
            for i in range(60)
        ]
        constant = [made.step(i, contacts_found=1000) for i in range(60)]
        refit = lambda last: [
            made.step(i, stages={"refit": 10**6 if i % 4 else last, "transform": 1}) for i in range(60)
        ]
        contacts = lambda count, steps=made.FULL_STEPS: [
            made.step(i, contacts_kept=count) for i in range(steps)
        ]
        for claim, steps, verdict in (
            ("grows-with-contacts", growing(50), AGREES),
            ("grows-with-contacts", growing(-10), DIFFERS),
            ("grows-with-contacts", constant, UNTESTED),
            ("grows-with-contacts", noisy, NOT_SETTLED),
            ("refit-constant", refit(10**6), AGREES),
            ("refit-constant", refit(10**7), DIFFERS),
            ("median-contacts", contacts(1_276_800), AGREES),
            ("median-contacts", contacts(10), DIFFERS),
            ("median-contacts", contacts(10, 300), UNTESTED),
            ("figure-1", contacts(550_000), AGREES),
            ("figure-1", contacts(10), DIFFERS),
            ("figure-2-contacts", contacts(351_000), AGREES),
            ("figure-2-contacts", contacts(10), DIFFERS),
            ("figure-2-bodies", contacts(1), DIFFERS),
            ("meteor-contacts", contacts(80_000), AGREES),
            ("meteor-contacts", contacts(10**6), DIFFERS),
            ("total-contacts", contacts(666_800), AGREES),
            ("total-contacts", contacts(10), DIFFERS),
            ("total-contacts", contacts(666_800, 300), UNTESTED),
        ):
            scene = fields[claim]["scenes"][0]
            self.assertEqual(
                self.verdict(fields[claim], scene, "8", {f"solver-{scene}": made.simulation(scene, steps)}),
                verdict,
                (claim, verdict),
            )
        for files in ({}, {"solver-funnel": made.simulation("funnel", growing(50), "host")}):
            self.assertEqual(
                [
                    self.verdict(fields[claim], "funnel", "8", files)
                    for claim in ("refit-constant", "grows-with-contacts")
                ],
                [UNTESTED] * 2,
            )

    def test_composed_steps_flip(self):
        """Frames of the published path beside the solver of a simulation of the same steps. Fewer steps than
        the paper's, and steps with other contacts, judge nothing."""
        fields = {one["id"]: one for one in claims.declared()}["collision-share"]
        wanted = Declared(fields).wanted(fields["above"], "8")

        def files(solve_ns, last=made.FULL_STEPS - 1, contacts=1):
            cell = made.record("funnel", wanted, 3)
            made.set_quantity(cell, "frame", [10**6 * made.FULL_STEPS] * 3)
            cell["frames"]["last"] = last
            steps = [
                made.step(
                    i,
                    contacts_found=contacts,
                    host={"solve": solve_ns, "assemble": 1, "move": 1, "reduce": 1},
                )
                for i in range(made.FULL_STEPS)
            ]
            return {"cells-funnel": [cell], "solver-funnel": made.simulation("funnel", steps)}

        found = [
            claims.line_of(Declared(fields), self.folder(files(*arguments)), "funnel", "8")
            for arguments in ((1,), (10**7,), (1, 121), (1, made.FULL_STEPS - 1, 2))
        ]
        self.assertEqual([line.verdict for line in found], [AGREES, DIFFERS, UNTESTED, UNTESTED])
        self.assertIn("contacts differ", found[3].reason)

    def test_digests_count_where_they_compare(self):
        """One algorithm compares nothing, and neither do answers without pairs."""
        fields = {one["id"]: one for one in claims.declared()}["same-pairs"]

        def cell(algorithm, count, a, broad="device"):
            record = made.record(
                "plates", {"algorithm": algorithm, "preset": "fair", "k": "8", "broad": broad}, 1
            )
            return {**record, "agreement": {"digest": {"count": count, "a": a, "b": ""}}}

        for cells, verdict in (
            ([cell("chunked", 1, "x"), cell("gproximity", 1, "x")], AGREES),
            ([cell("chunked", 1, "x"), cell("gproximity", 1, "y")], DIFFERS),
            ([cell("chunked", 1, "x")], UNTESTED),
            ([cell("chunked", 1, "x"), cell("gproximity", 1, "y", "sphere_boxes")], UNTESTED),
            ([cell("chunked", 0, "x"), cell("gproximity", 0, "x")], UNTESTED),
        ):
            self.assertEqual(self.verdict(fields, "", "8", {"cells-plates": cells}), verdict)

    def test_one_round_and_disturbed_rounds_settle_nothing(self):
        fields = {one["id"]: one for one in claims.declared()}["schedule-resident"]
        three, one = cells_for(fields, "plates", "8", [2.0] * 3), cells_for(fields, "plates", "8", [2.0])
        self.assertEqual(self.verdict(fields, "plates", "8", three), AGREES)
        self.assertEqual(self.verdict(fields, "plates", "8", one), NOT_SETTLED)
        for record in [record for records in three.values() for record in records]:
            record["conditions"]["disturbed"] = [{"round": number, "why": "load"} for number in range(3)]
        line = claims.line_of(Declared(fields), self.folder(three), "plates", "8")
        self.assertEqual(
            (line.verdict, line.reason, line.measured.disturbed), (NOT_SETTLED, "disturbed samples only", 6)
        )

    def test_batches_by_the_rule_of_the_release(self):
        """132 compute units take 2048 work-items each, in groups of 992: 272 body pairs a batch (an H200)."""
        record = made.record(
            "plates",
            {
                "algorithm": "gproximity",
                "preset": "published",
                "batch": "0",
                "sizes": "release",
                "group_size": "992",
            },
            1,
        )
        record["devices"][0]["compute_units"] = 132
        record["work"]["body_pairs"] = [272, 273, 600] + [0] * (made.FULL_STEPS - 3)
        frames = [(0, 0), (1, 1), (2, 2), (0, made.FULL_STEPS - 1)]
        self.assertEqual([batches_of(Cell(record), own) for own in frames], [1, 2, 3, 6])
        record["settings"] |= {"sizes": "own", "batch": "30"}
        self.assertEqual(batches_of(Cell(record), (0, 0)), 10)

    def test_only_common_frames_of_one_recording_are_compared(self):
        fields = {one["id"]: one for one in claims.declared()}["fewer-launches"]
        files = cells_for(fields, "plates", "8", [2.0])
        [other, own] = files["cells-plates"]
        own["scene"] = {**own["scene"], "digest": "another recording"}
        self.assertEqual(self.verdict(fields, "plates", "8", files), UNTESTED)
        own["scene"]["digest"] = "plates"
        own["frames"] = {"first": 600, "last": 700}
        self.assertEqual(self.verdict(fields, "plates", "8", files), UNTESTED)
        self.assertEqual(other["frames"]["first"], 0)


class Committed(unittest.TestCase):
    """Verdicts of the committed records, and of copies with other conditions."""

    @classmethod
    def setUpClass(cls):
        cls.claims = claims.all_claims(Folder(COMMITTED))

    def lines(self, found):
        return {(claim.id, line.label): line.verdict for claim in found for line in claim.lines}

    def copy(self, change_record, change_step=lambda line: line):
        work = tempfile.TemporaryDirectory(prefix="tandem-claims")
        self.addCleanup(work.cleanup)
        folder = pathlib.Path(work.name) / "paper"
        shutil.copytree(COMMITTED, folder, ignore=shutil.ignore_patterns("*.svg", "*.png", "*.html"))
        for path in (folder / "records").glob("*.jsonl"):
            lines = [json.loads(text) for text in path.read_text().splitlines()]
            path.write_text("".join(json.dumps(change_record(line)) + "\n" for line in lines))
        steps = [change_step(json.loads(text)) for text in (folder / "steps.jsonl").read_text().splitlines()]
        (folder / "steps.jsonl").write_text("".join(json.dumps(step) + "\n" for step in steps))
        return claims.all_claims(Folder(folder))

    def test_a_disturbed_machine_changes_verdicts_to_not_settled_only(self):
        def disturb(line):
            if line.get("total_ns"):
                rounds = sorted(set(line["total_ns"]["rounds"]))
                line["conditions"] = {"disturbed": [{"round": number, "why": "load"} for number in rounds]}
            return line

        found = self.copy(disturb)
        decided = [
            (claim.id, line.measured.basis)
            for claim in found
            for line in claim.lines
            if line.verdict in (AGREES, DIFFERS) and not line.measured.is_exact
        ]
        self.assertEqual(decided, [])
        before, after = self.lines(self.claims), self.lines(found)
        changed = {
            line: (before[line], verdict) for line, verdict in after.items() if verdict != before[line]
        }
        self.assertGreater(len(changed), 20)
        self.assertEqual({verdict for _, verdict in changed.values()}, {NOT_SETTLED}, changed)

    def test_small_scenes_judge_no_claim_about_size(self):
        small = lambda step: {**step, "size": "small"}
        found = self.copy(lambda line: line, small)
        decided = [claim.id for claim in found if claim.verdict in (AGREES, DIFFERS)]
        self.assertGreaterEqual(len(decided), 6)
        flagged = {fields["id"] for fields in claims.declared() if fields.get("small")}
        self.assertLessEqual(set(decided), flagged)
        self.assertIn("small scenes", {line.reason for claim in found for line in claim.lines})

        def slower(line):
            """Every second record takes three times as long."""
            self.count += 1
            for times in (line.get(name) for name in ("total_ns", "breakdown_ns") if self.count % 2):
                if times:
                    times["samples"] = [3 * value for value in times["samples"]]
            return line

        self.count = 0
        self.assertEqual(self.lines(self.copy(slower, small)), self.lines(found), "times do not matter")
        self.count = 0
        self.assertNotEqual(self.lines(self.copy(slower)), self.lines(self.claims))

    def test_every_claim_names_its_place_and_reason(self):
        self.assertEqual(len({claim.id for claim in self.claims}), len(self.claims))
        for claim in self.claims:
            self.assertRegex(claim.fields["where"], r"Abstract|[Ss]ection|Table|Figure")
            self.assertTrue(
                ("rule" in claim.fields) == ("measure" in claim.fields) != ("why" in claim.fields), claim.id
            )
            for line in claim.lines:
                is_plain = line.verdict in (AGREES, DIFFERS) and "provisional" not in claim.fields
                self.assertEqual(bool(line.reason), not is_plain, (claim.id, line))
