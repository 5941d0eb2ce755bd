# SPDX-License-Identifier: MIT
# test: cost=8
"""Reading records for comparison, labels of cells, and verdicts."""

import json
import pathlib
import tempfile
import unittest


from tandem import comparison, lines
from tandem.comparison import cells, matching, naming, notes, texts


def record(key="8", samples=(1,), rounds=None, session=None):
    """A record of schema 2 with only the fields that a comparison reads; with rounds and a session of schema
    3."""
    digest = {"count": 3, "a": "0a", "b": "0b"}
    made = {
        "schema": 2,
        "key": key,
        "status": "ok",
        "failure": None,
        "algorithm": "chunked",
        "preset": "grouped",
        "settings": {"k": key, "rounding": "safe"},
        "scene": {"key": "pile:bodies=2,density=0.4", "digest": "00ff"},
        "frames": {"first": 0, "last": 9},
        "devices": [{"id": "cuda:0", "name": "GPU", "driver": "1", "kind": "gpu"}],
        "total_ns": {"samples": list(samples)},
        "work": {"digest": dict(digest), "contact_digest": dict(digest)},
        "agreement": None,
        "error": None,
        "environment": {"commit": "abc1", "dirty": False, "processor": None},
    }
    if session:
        made |= {"schema": 3, "session": session, "sampling": {"seed": 7}}
        made["total_ns"]["rounds"] = list(range(len(samples)) if rounds is None else rounds)
    return made


def around(factor, count):
    """About 10 ms, slightly different in each of `count` samples, times `factor`."""
    return [factor * (1e7 + 1000 * (i * 7 % 11)) for i in range(count)]


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="tandem-comparison")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, *records, end="\n"):
        return self.write_text("\n".join(json.dumps(one) for one in records) + end)

    def write_text(self, text):
        path = self.folder / f"{len(list(self.folder.iterdir()))}.jsonl"
        path.write_text(text)
        return str(path)

    def read(self, *records):
        return cells.read_cells(self.write(*records))

    def refused(self, words, file, commit=""):
        with self.assertRaises(lines.RecordError) as caught:
            cells.read_cells(file, commit)
        self.assertIn(words, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def compared(self, old, new, **how):
        """The first cell, and the whole result."""
        found = comparison.matched_files(self.write(*old), self.write(*new), **how)
        return found[2].cells[0], found

    def verdict(self, factor, **how):
        return self.compared([record("8", around(1, 9))], [record("8", around(factor, 9))], **how)[0].verdict


class Reading(Files):
    def test_rounds_are_medians_of_their_samples(self):
        (cell,) = self.read(record("8", [5, 1, 9, 4, 2, 30], [2, 1, 2, 1, 1, 2], "s")).cells
        self.assertEqual(list(cell.rounds.items()), [(1, 2), (2, 9)])
        self.assertEqual((cell.samples, cell.session, cell.seed, cell.on_gpus), (6, "s", 7, True))

    def test_without_rounds_every_sample_is_one(self):
        (cell,) = self.read(record("8", [5, 1, 9])).cells
        self.assertEqual(cell.times(), [5, 1, 9])
        self.assertEqual((cell.session, cell.seed), ("", None))

    def test_the_last_record_that_is_ok_counts(self):
        failed = record("8") | {"status": "failed", "failure": "device lost", "total_ns": None, "work": None}
        read = self.read(record("8"), record("18", [2]), record("8", [3]), failed, record("26", []))
        self.assertEqual(
            [(cell.key, cell.line, cell.times()) for cell in read.cells], [("8", 3, [3]), ("18", 2, [2])]
        )
        self.assertEqual((read.repeated, read.records), (1, 5))
        self.assertEqual(
            [(cell.key, cell.failure) for cell in read.left_out], [("8", "device lost"), ("26", "")]
        )

    def test_commits_are_found_by_their_beginnings(self):
        records = [record("8", [ns]) for ns in (1, 2, 3)]
        records[1]["environment"]["commit"], records[2]["environment"]["commit"] = "abd2", None
        path = self.write(*records)
        for file, commit, ns in ((path, "abd", 2), (f"{path}@abc1", "", 1)):
            self.assertEqual(cells.read_cells(file, commit).cells[0].times(), [ns])
        self.assertEqual(cells.read_cells(path).commits, [""])
        self.refused("commit ab may be abc1 or abd2", path, "ab")
        self.refused("no record of commit f; there are abc1, abd2", path, "f")
        self.refused("name one commit", f"{path}@abc1", "abd2")
        self.refused("no commit behind the @", f"{path}@")

    def test_a_line_without_an_end_is_ignored(self):
        whole = pathlib.Path(self.write(record("8"), record("18"))).read_text()
        for cut in (1, 40):
            read = cells.read_cells(self.write_text(whole[:-cut]))
            self.assertEqual((read.torn, len(read.cells)), (True, 1))
        self.assertFalse(cells.read_cells(self.write_text(whole)).torn)

    def test_refuses_invalid_records(self):
        empty = self.write_text("")
        self.refused(f"{empty}: is empty; name a file of records", empty)
        self.refused("its only line has no end", self.write_text('{"schema": 2'))
        noise = self.write_text(json.dumps(record()) + "\nnoise\n")
        self.refused(f"{noise}:2: is not JSON; give", noise)
        self.refused("cannot be read", "/nowhere/at/all")
        self.refused("is a folder", "/tmp")
        for text in ("[1, 2]\n", '{"schema": 2}\n'):
            self.refused(":1: is no record of a cell", self.write_text(text))

    def test_refuses_other_schemas_and_fields(self):
        def refused(words, **change):
            self.refused(words, self.write(record("8", [1, 2], session="s") | change))

        refused("scripts/convert_records", schema=1)
        refused("a record of schema 5", schema=5)
        for change in (
            {"schema": "2"},
            {"devices": 3},
            {"environment": None},
            {"settings": {"k": 8}},
            {"scene": {}},
            {"frames": []},
            {"work": {"digest": 3}},
            {"error": {"inputs": 7}},
            {"sampling": 3},
            {"session": 5},
            {"algorithm": 5},
            {"preset": None},
            {"frames": {"first": "0", "last": 9}},
            {"frames": {"first": True, "last": 9}},
            {"scene": {"key": 3, "digest": ""}},
            {"scene": {"key": "pile", "digest": 3}},
            {"work": {"digest": {"count": "3", "a": "", "b": ""}}},
            {"work": {"digest": {"count": 3, "a": [], "b": ""}}},
            {"environment": {"dirty": 0}},
            {"devices": [{"id": 0, "name": "", "driver": "", "kind": "gpu"}]},
            {"total_ns": 4},
            {"total_ns": {"samples": ["a"], "rounds": [0]}},
        ):
            refused(":1: is no record of a cell (", **change)
        refused("a sample of 0 ns is not a valid time", total_ns={"samples": [0], "rounds": [0]})
        refused("2 samples and 1 rounds", total_ns={"samples": [1, 2], "rounds": [0]})
        refused("no rounds", total_ns={"samples": [1]})


class Naming(Files):
    def labels(self, *records):
        return naming.label(self.read(*records).cells)

    def test_labels_name_the_differences(self):
        records = [record(key) for key in ("8", "18", "9", "10")]
        records[2].update(algorithm="tiled", preset="resident")
        records[3]["scene"]["key"], records[3]["settings"]["k"] = "pile:bodies=9,density=0.4", "8"
        self.assertEqual(
            self.labels(*records),
            (
                [
                    "grouped schedule, 2 jacks, density 0.4, k=8",
                    "grouped schedule, 2 jacks, density 0.4, k=18",
                    "tiled, 2 jacks, density 0.4, k=9",
                    "grouped schedule, 9 jacks, density 0.4, k=8",
                ],
                "cuda:0, GPU, 1, frames 0:9",
            ),
        )

    def test_one_cell_and_cells_that_differ_only_in_keys(self):
        self.assertEqual(self.labels(record())[0], ["grouped schedule"])
        records = [record("8"), record("18")]
        records[1]["settings"]["k"] = "8"
        self.assertEqual(self.labels(*records)[0], ["grouped schedule", "grouped schedule #2"])
        # Text that only resembles parameters, or has names of settings, stays in the scene's name.
        records[0]["scene"]["key"], records[1]["scene"]["key"] = "mesh:a.msh", "pile:k=3"
        self.assertEqual(self.labels(*records)[0], ["mesh:a.msh", "64 jacks, density 0.2, k 3"])


class Verdicts(Files):
    def test_thresholds_are_the_same_both_ways(self):
        for factor, verdict in (
            (1, "not_shown"),
            (1.009, "within_threshold"),
            (1 / 1.009, "within_threshold"),
            (1.011, "slower"),
            (1 / 1.011, "faster"),
        ):
            self.assertEqual(self.verdict(factor), verdict, factor)
        for factor, verdict in (
            (1.19, "within_threshold"),
            (1.21, "slower"),
            (1 / 1.19, "within_threshold"),
            (1 / 1.21, "faster"),
        ):
            self.assertEqual(self.verdict(factor, threshold=0.2), verdict, factor)
        # 2 / 48620 is the smallest p-value of 9 against 9.
        self.assertEqual(self.verdict(1.21, level=1e-5), "too_few")

    def test_processors_have_a_wider_threshold(self):
        before, after = record("8", around(1, 9)), record("8", around(1.02, 9))
        self.assertEqual(self.compared([before], [after])[0].verdict, "slower")
        before["devices"][0]["kind"] = after["devices"][0]["kind"] = "cpu"
        cell, found = self.compared([before], [after])
        self.assertEqual((cell.verdict, cell.threshold, found[2].changed), ("within_threshold", 0.03, False))

    def test_one_session_is_compared_in_pairs(self):
        """Each round is 3 % slower in the new record; rounds differ by far more."""
        times = [ns * (1 + 0.3 * i) for i, ns in enumerate(around(1, 10))]
        slower = [1.03 * ns for ns in times]
        cell, _ = self.compared([record("8", times, session="s")], [record("8", slower, session="s")])
        self.assertEqual((cell.paired, cell.verdict), (True, "slower"))
        self.assertAlmostEqual(cell.ratio.value, 1.03, places=12)
        self.assertAlmostEqual(cell.p_holm, 2 / 1024, places=15)
        cell, _ = self.compared([record("8", times, session="s")], [record("8", slower, session="t")])
        self.assertEqual((cell.paired, cell.verdict), (False, "not_shown"))
        self.assertGreater(cell.least_effect, 0.1)

    def test_only_common_rounds_are_pairs(self):
        cell, _ = self.compared(
            [record("8", [10, 20, 30, 1000], [1, 2, 3, 9], "s")],
            [record("8", [5, 22, 33, 40], [0, 2, 3, 4], "s")],
        )
        self.assertEqual((cell.common, cell.before_ns), (2, 25))
        self.assertAlmostEqual(cell.ratio.value, 1.1, places=12)
        self.assertFalse(
            self.compared([record("8", [10, 20], [1, 2], "s")], [record("8", [5, 22], [3, 4], "s")])[0].paired
        )

    def test_a_round_counts_once_however_many_samples_it_has(self):
        rounds = [number for number in range(3) for _ in range(50)]
        samples = [1e6 + i % 50 for i in range(150)]
        cell, found = self.compared(
            [record("8", samples, rounds, "s")], [record("8", [2 * ns for ns in samples], rounds, "t")]
        )
        self.assertEqual(
            (cell.verdict, cell.rounds_needed, cell.p_holm, found[2].changed), ("too_few", 4, None, False)
        )
        self.assertAlmostEqual(cell.least_p, 0.1, places=15)

    def test_too_few_follows_from_the_corrected_level(self):
        """4 against 4 can reach p = 2 / 70, which is significant for one cell but not for two."""
        before, after = ([record(key, around(factor, 4)) for key in ("8", "18")] for factor in (1, 1.5))
        self.assertEqual(self.compared(before[:1], after[:1])[0].verdict, "slower")
        cell, found = self.compared(before, after)
        self.assertEqual((found[2].count("too_few"), cell.rounds_needed, cell.least_effect), (2, 5, None))
        # A cell that cannot reach the level by itself is excluded from the correction.
        before[1], after[1] = record("18", around(1, 3)), record("18", around(1.5, 3))
        cell, found = self.compared(before, after)
        self.assertEqual((found[2].tested, cell.verdict), (1, "slower"))

    def test_the_least_effect_is_that_of_a_single_changed_cell(self):
        records = [record(key, around(1, 9)) for key in ("8", "18", "26")]
        cell, _ = self.compared(records, records)
        self.assertGreater(cell.ratio.log_error, 0)
        self.assertAlmostEqual(
            cell.least_effect, matching.least_effect(cell.ratio.log_error, 0.05 / 3), places=15
        )

    def test_another_answer_is_not_timed(self):
        for digest, what in (("digest", "candidate pairs"), ("contact_digest", "contacts")):
            after = record("8", around(2, 9))
            after["work"][digest]["b"] = "0c"
            cell, found = self.compared([record("8", around(1, 9))], [after])
            self.assertEqual((cell.verdict, found[2].changed, found[2].tested), ("another_answer", True, 0))
            self.assertIn(f"3 {what}, but different ones", texts.text(*found, 0.05))
        # Old records have digests of the comparison with the reference.
        old = record("8", around(1, 9)) | {
            "agreement": {"digest": {"count": 4, "a": "0a", "b": "0b"}},
            "work": {},
        }
        new = [record("8", around(1, 9))]
        self.assertEqual(self.compared([old], new)[0].verdict, "another_answer")
        self.assertEqual(self.compared([old | {"agreement": None}], new)[0].verdict, "not_shown")

    def test_without_a_common_cell_the_nearest_are_named(self):
        def expect(words, old, new):
            with self.assertRaises(lines.RecordError) as caught:
                self.compared([old], [new])
            self.assertIn(words, str(caught.exception))

        expect("(1 and 1 cells; the nearest differ in k=8 / k=18)", record("8"), record("18"))

        def on(devices, k="8"):
            return record(k) | {"key": f"tiled|{devices}|pile@0a|0:9|k={k}"}

        expect(
            "(1 and 1 cells; the nearest differ in host:CPU x1 / host:CPU x2)",
            on("host:CPU x1, g++ 12"),
            on("host:CPU x2, g++ 12"),
        )
        expect(
            "differ in g++ 12 / g++ 13, k=8 / k=18)",
            on("host:CPU x1, g++ 12"),
            on("host:CPU x1, g++ 13", "18"),
        )
        expect("none of 1 records is ok", record("8"), record("18") | {"status": "wrong"})
        expect("schemas 2 and 3", record("8"), record("18", [1], [0], "s"))

    def test_lists_of_excluded_records_are_limited(self):
        """At most ten excluded records are named, and five cells without a counterpart."""
        failed = [record(str(key)) | {"status": "failed", "failure": "lost"} for key in range(100, 115)]
        more = [record(str(key), around(1, 9)) for key in range(20, 28)]
        _, found = self.compared([record("8", around(1, 9)), *more], [record("8", around(1, 9)), *failed])
        made = notes.notes(*found)
        self.assertEqual(sum("is left out" in note for note in made), 10)
        self.assertTrue(any("5 more records are left out" in note for note in made))
        self.assertTrue(
            any(
                note.startswith("8 cells are in old only: ") and note.endswith("; and 3 more")
                for note in made
            )
        )
