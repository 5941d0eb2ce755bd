# SPDX-License-Identifier: MIT
# test: cost=10
"""--algorithm auto: its candidates, messages, records and files."""

import json
import math
import tempfile

from tests.program import SMALL, Case, sets, tandem

from tandem.names import method

EXACT = {"output": "contacts", "decision": "exact", "contact_rule": "sat"}
GIVEN = {"k": "6", "builder": "morton", "leaves": "32", "slabs": "all", "contact_rule": "none"}


class Choosing(Case):
    """Two bars on the host."""

    def setUp(self):
        folder = self.enterContext(tempfile.TemporaryDirectory(dir=self.work))
        self.environment = {"TANDEM_KERNEL_CACHE": folder}
        self.folder = self.work / folder
        self.bars = ("run", "--mesh", self.good, "--mesh", self.good, "--device", "host", "--repeat", 1)

    def choose(self, *arguments, algorithm="auto", environment=None, **given):
        """(records, lines of standard error) of a run that has to succeed."""
        out = self.work / f"{self.id()}{len(list(self.work.iterdir()))}.jsonl"
        words = ("--threads", 1, "--truth", "none", "--choose-seconds", 0.3, "--out", out)
        settings = sets({**SMALL, **given})
        environment = self.environment | (environment or {})
        code, text, errors = tandem(
            *self.bars, *words, "--algorithm", algorithm, *settings, *arguments, environment=environment
        )
        self.assertEqual(code, 0, (text, errors))
        return self.records(out), errors

    def chosen(self, *arguments, **given):
        return self.choose(*arguments, **given)[0][0]["chosen"]

    def test_the_record_has_the_choice_and_its_reasons(self):
        (record, fixed), errors = self.choose(algorithm="auto,chunked")
        chosen, candidates = record["chosen"], record["chosen"]["candidates"]
        self.assertIsNone(fixed["chosen"])
        self.assertEqual(len(errors), 1, errors)
        name = f"auto: {method(record['algorithm'], record['preset'])}"
        for words in (
            name,
            f"best of {chosen['of']} candidates",
            "% ahead of",
            "frames 0:0",
            "(at most 0.3)",
        ):
            self.assertIn(words, errors[0])
        self.assertTrue(record["key"].startswith(record["algorithm"] + "|host:"))
        self.assertEqual((len(candidates), candidates[1]), (chosen["of"], chosen["runner_up"]))
        first, second = candidates[:2]
        self.assertEqual([first["algorithm"], first["preset"]], [record["algorithm"], record["preset"]])
        self.assertLessEqual(first["settings"].items(), record["settings"].items())
        algorithms = json.loads(tandem("algorithms", "--json")[1])
        self.assertNotIn("auto", [each["name"] for each in algorithms])
        own = {each["name"] for each in algorithms if not each["baseline"]}
        self.assertEqual({candidate["algorithm"] for candidate in candidates}, own)
        self.assertAlmostEqual(chosen["margin"], second["median_ns"] / first["median_ns"] - 1)
        self.assertTrue(0 < chosen["seconds"] < 1 and not chosen["from_cache"], chosen)
        for field in chosen:
            for change in ({}, {field: {"x": []}}):
                less = {key: value for key, value in chosen.items() if key != field} | change
                self.assertFalse(self.validator.is_valid({**record, "chosen": less}), field)
        for candidates in ([], [{**first, "median_ns": -1}], [{"algorithm": "tiled"}]):
            wrong = {**chosen, "candidates": candidates}
            self.assertFalse(self.validator.is_valid({**record, "chosen": wrong}), candidates)

    def test_k_is_compared_where_it_changes_no_contact(self):
        digests = set()
        for more, tried in (
            ({}, {None, "6"}),
            ({"k": 6}, {"6"}),
            ({"k": 18}, {None}),
            ({"decision": "fp64"}, {None}),
        ):
            (record,), _ = self.choose(**{**EXACT, **more})
            candidates = record["chosen"]["candidates"]
            self.assertEqual({candidate["failure"] for candidate in candidates}, {None})
            self.assertEqual({candidate["settings"].get("k") for candidate in candidates}, tried)
            self.assertIn(f"k={record['settings']['k']}", record["key"])
            if "decision" not in more:
                digests.add(json.dumps(record["work"]["contact_digest"]))
                self.assertGreater(record["work"]["contact_digest"]["count"], 0)
        self.assertEqual(len(digests), 1)

    def test_choices_are_stored(self):
        (first,), _ = self.choose()
        (file,) = self.folder.glob("choice-*.json")
        (second,), errors = self.choose()
        self.assertEqual(second["chosen"], {**first["chosen"], "from_cache": True})
        self.assertEqual((second["key"], len(errors)), (first["key"], 1))
        self.assertIn(f"stored in {file}: best of", errors[0])
        self.assertFalse(self.chosen("--choose-afresh")["from_cache"])
        self.assertFalse(self.chosen(k=6)["from_cache"])
        self.assertEqual(len(list(self.folder.glob("choice-*.json"))), 2)
        whole = file.read_text()
        other = whole.replace('"program": "', '"program": "another ')
        damaged = whole.replace('"from_cache": false', '"from_cache": true')
        for text, warnings in (
            (other, 0),
            ("", 1),
            ("{", 1),
            ('{"choice": 1}', 1),
            ("\0" * 100, 1),
            (damaged, 1),
        ):
            self.assertNotEqual(text, whole)
            file.write_text(text)
            (record,), errors = self.choose()
            self.assertEqual((record["chosen"]["from_cache"], len(errors)), (False, 1 + warnings), errors)
            self.assertTrue(not warnings or f"tandem: {file}: contains no valid choice" in errors[0], errors)
            self.assertTrue(self.chosen()["from_cache"])
        (record,), errors = self.choose(environment={"TANDEM_KERNEL_CACHE": "/dev/null/choices"})
        self.assertIn("tandem: TANDEM_KERNEL_CACHE: /dev/null/choices cannot be written", errors[0])
        self.assertEqual((record["chosen"]["from_cache"], len(errors)), (False, 2))

    def test_explicit_settings_are_kept(self):
        (record,), _ = self.choose(**GIVEN)
        for candidate in (*record["chosen"]["candidates"], record):
            kept = {name: candidate["settings"].get(name, value) for name, value in GIVEN.items()}
            self.assertEqual(kept, GIVEN)
        tried = [
            math.prod(
                len(one.get("alternatives", [])) or 1
                for one in each["parameters"]
                if one["name"] not in GIVEN
            )
            for each in json.loads(tandem("algorithms", "--json")[1])
            if not each["baseline"]
        ]
        self.assertEqual(tried.count(2), 1, "leaf_query with both of its trees")
        self.assertEqual(record["chosen"]["of"], sum(tried))
        self.assertEqual((record["settings"]["k"], record["settings"]["contact_rule"]), ("6", "none"))

    def test_failing_candidates_are_not_chosen(self):
        """A TiB of queues exceeds the memory; running frames in batches, with one session at a time, is no
        failure."""
        candidates = self.chosen(queue_bytes=2**40)["candidates"]
        failed = {c["algorithm"]: c["failure"] for c in candidates if c["failure"]}
        self.assertEqual(list(failed), ["gproximity"])
        self.assertIn("'queues' needs", failed["gproximity"])
        self.assertLess(sum(c["median_ns"] is not None for c in candidates), len(candidates))
        self.assertEqual({c["failure"] for c in self.chosen("--memory", "1MB")["candidates"]}, {None})

    def test_what_auto_refuses(self):
        for command in (
            ("check", "plates"),
            ("accuracy", "plates"),
            ("simulate", "tower", "-o", self.work / "x"),
        ):
            self.bad("auto is for 'tandem run' only", *command, "--algorithm", "auto", "--device", "host")
        self.bad("--help", "check", "plates", "--choose-afresh")
        for words, expected in (
            (("--set", "k=10"), "impossible"),
            (("--set", "axes=coordinate"), "goes with k=8 only"),
            (("--set", "seed_treshold=1"), "the nearest is 'seed_threshold'"),
            (("--choose-seconds", "0"), "--choose-seconds"),
        ):
            self.bad(expected, *self.bars, "--algorithm", "auto", *words)
