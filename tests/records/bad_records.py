# SPDX-License-Identifier: MIT
# test: cost=8
"""tandem.read and tandem.compare of Python refuse records with invalid samples
and fields by one line, as the program does."""

import json
import re
import subprocess
import tempfile
import unittest

from tests.program import PROGRAM, SOURCE

import tandem

RECORDS = SOURCE / "results/h200/paper/records/resident-plates.jsonl"


class BadRecords(unittest.TestCase):
    def test_samples_that_are_no_times_are_refused(self):
        """As the program does: NaN and infinite ones are not JSON."""
        record = json.loads((RECORDS).read_text().splitlines()[0])
        for sample, words in (
            (0, "a sample of 0 ns is not a valid time"),
            (-5, "a sample of -5 ns"),
            (1e300, "a sample of 1e+300 ns"),
            (10**400, "a sample of 1000000"),
            (float("nan"), ":1: is not JSON"),
            (float("inf"), ":1: is not JSON"),
        ):
            record["total_ns"]["samples"][2] = sample
            with (
                self.subTest(sample=str(sample)[:9]),
                tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file,
            ):
                file.write(json.dumps(record) + "\n")
                file.flush()
                for function in (tandem.read, lambda name: tandem.compare(name, name)):
                    with self.assertRaisesRegex(tandem.RecordError, re.escape(words)) as caught:
                        function(file.name)
                    self.assertNotIn("\n", str(caught.exception))
                done = subprocess.run(
                    [PROGRAM, "compare", file.name, file.name], capture_output=True, text=True
                )
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertIn(words, done.stderr)

    def test_fields_of_another_type_are_one_line(self):
        """The message names the line, also where pandas finds the field."""
        text = (RECORDS).read_text().splitlines()[0]
        good = json.loads(text)
        for place, value in (
            (("stages", "read", "waits"), 0.5),
            (("work", "body_pairs", 0), "x"),
            (("total_ns", "rounds", 1), 0.5),
            (("environment", "dirty"), {}),
            (("kernels", 0, "registers"), {}),
            (("stages", "write", "bytes"), [1]),
            (("environment",), 3),
            (("sampling",), [1]),
            (("devices",), 5),
        ):
            # With the key of the first line, records are also compared with it.
            record = json.loads(text) | ({} if len(place) == 1 else {"key": "another"})
            part = record
            for name in place[:-1]:
                part = part[name]
            part[place[-1]] = value
            with self.subTest(place), tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
                file.write(json.dumps(good) + "\n" + json.dumps(record) + "\n")
                file.flush()
                with self.assertRaises(tandem.RecordError) as caught:
                    tandem.read(file.name)
                self.assertTrue(str(caught.exception).startswith(f"{file.name}:2: "), str(caught.exception))
                self.assertNotIn("\n", str(caught.exception))
