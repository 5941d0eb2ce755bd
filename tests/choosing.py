#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""choosing.py PROGRAM SOURCE: --algorithm auto: its candidates, messages, records and cache."""

import json
import sys
import tempfile
import unittest

from program import SMALL, Case, sets, tandem


class Choosing(Case):
    """Two bars on the host."""

    def setUp(self):
        self.kept = tempfile.TemporaryDirectory(dir=self.work)
        self.addCleanup(self.kept.cleanup)
        self.environment = {"TANDEM_KERNEL_CACHE": self.kept.name}

    def files(self):
        return sorted(self.work.joinpath(self.kept.name).glob("choice-*.json"))

    def choose(self, *arguments, environment=None, given=None):
        """(record of the first cell, lines of standard error) of a run that has to succeed."""
        out = self.work / f"{self.id()}{len(list(self.work.iterdir()))}.jsonl"
        status, text, errors = tandem(
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--device",
            "host",
            "--algorithm",
            "auto",
            "--threads",
            1,
            "--repeat",
            1,
            "--truth",
            "none",
            "--choose-seconds",
            0.3,
            "--out",
            out,
            *sets({**SMALL, **(given or {})}),
            *arguments,
            environment=environment or self.environment,
        )
        self.assertEqual(status, 0, (text, errors))
        return self.records(out)[0], errors

    def test_the_record_has_the_choice_and_its_reasons(self):
        record, errors = self.choose()
        chosen = record["chosen"]
        self.assertEqual(len(errors), 1, errors)
        for word in (
            f"auto: {record['algorithm']} {record['preset']}",
            f"best of {chosen['of']} candidates",
            "% ahead of",
            "frames 0:0",
            "s of replays (at most 0.3)",
        ):
            self.assertIn(word, errors[0])
        self.assertTrue(record["key"].startswith(record["algorithm"] + "|host:"))
        candidates = chosen["candidates"]
        self.assertEqual(len(candidates), chosen["of"])
        self.assertEqual(
            (candidates[0]["algorithm"], candidates[0]["preset"]), (record["algorithm"], record["preset"])
        )
        self.assertLessEqual(candidates[0]["settings"].items(), record["settings"].items())
        self.assertEqual(
            {c["algorithm"] for c in candidates},
            {a["name"] for a in json.loads(tandem("algorithms", "--json")[1]) if not a.get("baseline")},
        )
        self.assertEqual(chosen["runner_up"], candidates[1])
        self.assertAlmostEqual(chosen["margin"], candidates[1]["median_ns"] / candidates[0]["median_ns"] - 1)
        self.assertFalse(chosen["from_cache"])
        self.assertGreater(chosen["seconds"], 0)
        self.assertLess(chosen["seconds"], 1)

    def test_k_is_compared_where_it_changes_no_contact(self):
        exact = {"output": "contacts", "decision": "exact", "contact_rule": "sat"}
        found = {}
        for given in (exact, exact | {"k": 6}, exact | {"k": 18}, exact | {"decision": "fp64"}):
            record = self.choose(given=given)[0]
            candidates = record["chosen"]["candidates"]
            self.assertEqual({c["failure"] for c in candidates}, {None})
            k = {c["settings"].get("k", "default") for c in candidates}
            found[json.dumps(given)] = (k, record["work"]["contact_digest"])
            self.assertIn(f"k={record['settings']['k']}", record["key"])
        (tried, digest), (_, digest_6), (_, digest_18), (fixed, _) = found.values()
        self.assertEqual(tried, {"default", "6"})
        self.assertEqual(fixed, {"default"})
        self.assertGreater(digest["count"], 0)
        self.assertEqual(digest, digest_6)
        self.assertEqual(digest, digest_18)

    def test_every_field_of_a_choice_is_needed(self):
        record = self.choose()[0]
        for name in record["chosen"]:
            less = {n: v for n, v in record["chosen"].items() if n != name}
            self.assertFalse(self.validator.is_valid({**record, "chosen": less}), name)
            self.assertFalse(
                self.validator.is_valid({**record, "chosen": {**record["chosen"], name: {"x": []}}}), name
            )
        for candidates in (
            [],
            [{**record["chosen"]["candidates"][0], "median_ns": -1}],
            [{"algorithm": "tiled"}],
        ):
            self.assertFalse(
                self.validator.is_valid({**record, "chosen": {**record["chosen"], "candidates": candidates}})
            )
        self.assertTrue(self.validator.is_valid({**record, "chosen": None}))

    def test_the_second_run_uses_the_cached_choice(self):
        first = self.choose()[0]
        self.assertEqual(len(self.files()), 1)
        second, errors = self.choose()
        self.assertEqual(second["chosen"], {**first["chosen"], "from_cache": True})
        self.assertEqual(second["key"], first["key"])
        self.assertEqual(len(errors), 1)
        self.assertIn(f"stored in {self.files()[0]}: best of", errors[0])
        self.assertFalse(self.choose("--choose-afresh")[0]["chosen"]["from_cache"])
        self.assertFalse(self.choose(given={"k": 6})[0]["chosen"]["from_cache"])
        self.assertEqual(len(self.files()), 2)

    def test_a_choice_of_another_program_is_made_again(self):
        self.choose()
        file = self.files()[0]
        kept = json.loads(file.read_text())
        file.write_text(json.dumps({**kept, "program": "another"}))
        record, errors = self.choose()
        self.assertEqual((record["chosen"]["from_cache"], len(errors)), (False, 1))
        self.assertEqual(json.loads(file.read_text())["program"], kept["program"])

    def test_damaged_and_unwritable_files_do_no_harm(self):
        self.choose()
        for damage in ("", "{", '{"program": 1}', "\0" * 100):
            self.files()[0].write_text(damage)
            record, errors = self.choose()
            self.assertFalse(record["chosen"]["from_cache"])
            self.assertEqual(len(errors), 2, errors)
            self.assertIn(f"tandem: {self.files()[0]}: contains no valid choice", errors[0])
            self.assertTrue(self.choose()[0]["chosen"]["from_cache"])
        record, errors = self.choose(environment={"TANDEM_KERNEL_CACHE": "/dev/null/choices"})
        self.assertIn("tandem: TANDEM_KERNEL_CACHE: /dev/null/choices cannot be written", errors[0])
        self.assertEqual((record["chosen"]["from_cache"], len(errors)), (False, 2))

    def test_choices_of_other_users_are_ignored(self):
        self.work.joinpath(self.kept.name).chmod(0o777)
        self.bad(
            f"TANDEM_KERNEL_CACHE: other users can write to {self.kept.name}",
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--device",
            "host",
            "--algorithm",
            "auto",
            environment=self.environment,
        )
        home = self.work / "home"
        (home / ".cache/tandem").mkdir(parents=True)
        (home / ".cache/tandem").chmod(0o777)
        environment = {"TANDEM_KERNEL_CACHE": "", "XDG_CACHE_HOME": "", "HOME": str(home)}
        for _ in range(2):
            self.assertFalse(self.choose(environment=environment)[0]["chosen"]["from_cache"])
        self.assertEqual(list((home / ".cache/tandem").iterdir()), [])

    def test_folders_of_the_environment(self):
        for name, folder in (("XDG_CACHE_HOME", "tandem"), ("HOME", ".cache/tandem")):
            nothing = {"TANDEM_KERNEL_CACHE": "", "XDG_CACHE_HOME": "", "HOME": ""}
            self.choose(environment={**nothing, name: self.kept.name})
            self.assertEqual(len(list(self.work.joinpath(self.kept.name, folder).glob("choice-*.json"))), 1)

    def test_explicit_settings_are_kept(self):
        given = {"k": "6", "builder": "morton", "leaves": "32", "slabs": "all", "contact_rule": "none"}
        record = self.choose(given=given)[0]
        for candidate in [*record["chosen"]["candidates"], record]:
            for name, value in given.items():
                if name in candidate["settings"]:
                    self.assertEqual(candidate["settings"][name], value)
        self.assertEqual(len(record["chosen"]["candidates"]), 5)  # leaf_query with both of its trees
        self.assertEqual((record["settings"]["k"], record["settings"]["contact_rule"]), ("6", "none"))

    def test_failing_candidates_are_not_chosen(self):
        """A TiB of queues exceeds the memory; running frames in batches, with one session at a time, is not a
        failure."""
        record, errors = self.choose(given={"queue_bytes": 2**40})
        self.assertEqual(len(errors), 1, errors)
        failures = {c["algorithm"]: c["failure"] for c in record["chosen"]["candidates"]}
        self.assertEqual([name for name, failure in failures.items() if failure], ["gproximity"])
        self.assertIn("'queues' needs", failures["gproximity"])
        self.assertLess(
            len([c for c in record["chosen"]["candidates"] if c["median_ns"]]), record["chosen"]["of"]
        )
        record = self.choose("--memory", "1MB")[0]
        self.assertEqual({c["failure"] for c in record["chosen"]["candidates"]}, {None})

    def test_auto_works_beside_others_and_is_not_part_of_all(self):
        out = self.work / "beside.jsonl"
        arguments = (
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--device",
            "host",
            "--repeat",
            1,
            "--out",
            out,
            *sets(SMALL),
        )
        self.assertEqual(
            tandem(
                *arguments,
                "--algorithm",
                "auto,chunked",
                "--choose-seconds",
                0.1,
                environment=self.environment,
            )[0],
            0,
        )
        self.assertEqual([r["chosen"] is None for r in self.records(out)], [False, True])
        self.assertEqual(tandem(*arguments)[2], [])
        self.assertTrue(all(r["chosen"] is None for r in self.records(out)[2:]))
        self.assertNotIn("auto", [a["name"] for a in json.loads(tandem("algorithms", "--json")[1])])

    def test_other_commands_do_not_choose(self):
        for arguments in (
            ("check", "plates"),
            ("accuracy", "plates"),
            ("simulate", "tower", "-o", self.work / "x.frames"),
        ):
            self.bad("auto is for 'tandem run' only", *arguments, "--algorithm", "auto", "--device", "host")
        self.bad("--help", "check", "plates", "--choose-afresh")
        self.bad("impossible", "run", "plates", "--algorithm", "auto", "--device", "host", "--set", "k=10")
        self.bad(
            "goes with k=8 only",
            "run",
            "plates",
            "--algorithm",
            "auto",
            "--device",
            "host",
            "--set",
            "axes=coordinate",
        )
        self.bad(
            "the nearest is 'seed_threshold'",
            "run",
            "plates",
            "--algorithm",
            "auto",
            "--device",
            "host",
            "--set",
            "seed_treshold=1",
        )
        self.bad("--choose-seconds", "run", "plates", "--algorithm", "auto", "--choose-seconds", "0")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
