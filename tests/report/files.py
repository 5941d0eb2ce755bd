# SPDX-License-Identifier: MIT
# test: cost=7 full=50
"""Content of a page about records, from the package python/tandem/report alone: interrupted cells, damaged
records, missing libraries, and escaping of all text."""

import copy
import json
import lzma
import os
import random
import unittest
import unittest.mock

from tests.program import LONG, PROGRAM, SOURCE, Case, tandem

from tandem import files, lines
from tandem.errors import BadUse, OutputError
from tandem.files import replace_whole
from tandem.report import assembly, libraries
from tandem.report.data import data_of
from tandem.report.other_records import Simulations
from tandem.report.reading import read_records

H200 = SOURCE / "results/h200"


class Reading(Case):
    def setUp(self):
        self.record = json.loads((H200 / "plan.jsonl").read_text().splitlines()[0])

    def changed(self, **changes):
        return {**copy.deepcopy(self.record), **changes}

    def of_rounds(self, count, session, factor=1, **changes):
        record = self.changed(session=session, **changes)
        total = record["total_ns"]
        total["samples"] = [round(factor * ns) for ns in (self.record["total_ns"]["samples"] * count)[:count]]
        total["rounds"] = list(range(count))
        return record

    def file(self, *records, name="some.jsonl", end="\n"):
        path = self.work / name
        text = "\n".join(json.dumps(record) for record in records) + end
        path.write_bytes(lzma.compress(text.encode()) if name.endswith(".xz") else text.encode())
        return str(path)

    def read(self, *records, **how):
        return read_records([self.file(*records)], **how)

    def shown(self, records):
        return [(cell.session, cell.is_older) for cell in records.cells]

    def test_a_record_and_its_continuation(self):
        begun, whole = self.of_rounds(3, "a"), self.of_rounds(9, "b")
        for records in ((begun, whole), (whole, begun)):
            read = self.read(*records)
            self.assertEqual((self.shown(read), read.cell_records, read.notes), ([("b", False)], 1, []))
        files = [self.file(begun, name="begun.jsonl"), self.file(whole, name="whole.jsonl.xz")]
        read = read_records(files)
        self.assertEqual(self.shown(read), [("b", False)])
        self.assertEqual(
            [(file["name"], file["cells"]) for file in read.files],
            [("begun.jsonl", 1), ("whole.jsonl.xz", 1)],
        )
        self.assertEqual(read.paths.index(read.cells[0].path), 1)

    def test_other_times_are_another_record(self):
        read = self.read(self.of_rounds(3, "a", 2), self.of_rounds(9, "b"))
        self.assertEqual((self.shown(read), read.cell_records), ([("a", True), ("b", False)], 2))

    def test_a_copy_is_shown_once(self):
        self.assertEqual(
            self.shown(self.read(self.of_rounds(9, "a"), self.of_rounds(9, "a"))), [("a", False)]
        )

    def test_the_last_ok_record_represents_its_key(self):
        failed = self.changed(session="f", status="failed", failure="lost", total_ns=None)
        good, again = self.of_rounds(5, "a"), self.of_rounds(5, "b", 2)
        for records, older in (
            ((good, again), [True, False]),
            ((good, failed), [False, True]),
            ((failed, good), [True, False]),
            ((failed, {**failed, "session": "g"}), [True, False]),
            ((good, failed, again), [True, True, False]),
        ):
            self.assertEqual([cell.is_older for cell in self.read(*records).cells], older)

    def test_of_too_many_records_one_per_key_is_kept(self):
        keys = [self.of_rounds(5, f"{i}", 1 + i / 100, key=f"key {i % 4}") for i in range(8)]
        read = self.read(*keys, max_cells=6)
        self.assertEqual([cell.session for cell in read.cells], ["6", "7", "4", "5"])
        self.assertEqual(read.notes, ["4 older records of cells that were recorded again are left out"])
        read = self.read(*keys, self.of_rounds(5, "w", status="wrong", key="another"), max_cells=3)
        self.assertEqual(len(read.cells), 3)
        self.assertRegex(
            read.notes[-1],
            "^[0-9]+ of 9 records of cells are left out, 1 of them failed or wrong: a page shows at most 3; ",
        )

    def test_a_torn_line_is_ignored_and_reported(self):
        read = read_records([self.file(self.record, self.record, end="")])
        self.assertEqual(len(read.cells), 1)
        self.assertRegex(
            read.notes[0],
            r"some\.jsonl:2: the last line has no end and is ignored; it is cut off or still being written$",
        )
        with self.assertRaisesRegex(lines.RecordError, "its only line has no end; name a file of records"):
            read_records([self.file(self.record, end="")])

    def test_numbers_that_json_lacks(self):
        for text in (
            '{"key": NaN}',
            '{"key": -Infinity}',
            '{"key": 1e999}',
            '{"key": 1' + "0" * 5000 + "}",
            "[" * 100_000,
            "\\",
        ):
            path = self.work / "numbers.jsonl"
            path.write_text(text + "\n")
            with self.assertRaisesRegex(
                lines.RecordError, "numbers.jsonl:1: is not JSON; give files that 'tandem run --out'"
            ):
                read_records([str(path)])

    def test_damaged_records_are_one_line(self):
        """Each part of records of every kind is removed or replaced: they are shown, or one line names the
        position."""
        chance = random.Random(20180606)
        sources = [
            SOURCE / name
            for name in (
                "results/h200/plan.jsonl",
                "tests/records/accuracy.jsonl",
                "results/h200/profile.jsonl",
                "results/h200/ceilings.jsonl",
                "results/h200/paper/records/sim-funnel.jsonl",
            )
        ]
        shown = refused = 0
        for source in sources:
            record = self.short(json.loads(source.read_text().splitlines()[-1]))
            for damaged in self.damaged(record, chance):
                path = self.file(damaged)
                try:
                    json.loads(
                        data_of(read_records([path]), 1_000_000, "", "").json, parse_constant=self.fail
                    )
                    shown += 1
                except lines.RecordError as error:
                    self.assertTrue(str(error).startswith(f"{path}:1: "), error)
                    refused += 1
        self.assertGreater(shown, 100)
        self.assertGreater(refused, 100)

    def short(self, value):
        """With lists of two elements, which suffice for the test."""
        if isinstance(value, dict):
            return {
                name: self.short(part)
                for name, part in value.items()
                if name not in ("breakdown_ns", "chosen")
            }
        return list(map(self.short, value[:2])) if isinstance(value, list) else value

    def damaged(self, record, chance):
        def places(value, path=()):
            yield path
            if isinstance(value, dict):
                for name, part in value.items():
                    yield from places(part, (*path, name))
            elif isinstance(value, list) and value:
                yield from places(value[0], (*path, 0))

        for path in list(places(record))[1:]:
            for replacement in chance.sample(
                [
                    None,
                    True,
                    "text",
                    "\ud800",
                    -1,
                    1.5,
                    10**400,
                    [],
                    [None],
                    [[1]],
                    {},
                    {"median": "x"},
                    "left out",
                ],
                3 if LONG else 1,
            ):
                damaged = copy.deepcopy(record)
                part = damaged
                for name in path[:-1]:
                    part = part[name]
                if replacement == "left out":
                    del part[path[-1]]
                else:
                    part[path[-1]] = replacement
                yield damaged

    def test_simulations_are_bounded(self):
        line = {
            "kind": "step",
            "session": "s",
            "host_ns": dict.fromkeys(("broad", "narrow", "reduce", "assemble", "solve", "move"), 1e6),
            "contacts_found": 2,
            "contacts_kept": 1,
        }
        simulations = Simulations()
        for step in range(5000):
            simulations.add({**line, "step": step}, "x.jsonl")
        for session in range(50):
            simulations.add({**line, "step": 0, "session": str(session)}, "x.jsonl")
        shown = simulations.shown()
        self.assertEqual(
            (len(shown), simulations.left_out, shown[0]["steps"], shown[0]["status"]),
            (40, 11, 5000, "not ended"),
        )
        steps = [kept[0] for kept in shown[0]["kept"]]
        self.assertEqual(steps, list(range(0, 5000, steps[1])))
        self.assertTrue(250 < len(steps) <= 600, len(steps))
        self.assertEqual(shown[0]["kept"][0], [0, 1, 1, 1, 1, 1, 1, 2, 1])


class Pages(Case):
    def test_data_cannot_end_its_element(self):
        page = assembly.Page("<b> & c", data={"records": '{"a":"</script><!--<img>"}'})
        html = assembly.html_of(page)
        self.assertIn('{"a":"\\u003c/script>\\u003c!--\\u003cimg>"}', html)
        self.assertNotIn("<img>", html)
        self.assertIn("<title>&lt;b> &amp; c</title>", html)
        self.assertIn("default-src 'none'", html)
        self.assertIn("THE SOFTWARE IS PROVIDED", html)

    def test_scripts_cannot_end_their_element(self):
        html = assembly.html_of(assembly.Page("t", libraries=["let a = '</script>' + '<!--';"]))
        self.assertIn("let a = '<\\/script>' + '<\\!--';", html)

    def test_libraries(self):
        names = {**libraries.CHARTS, **libraries.SCENES}
        with unittest.mock.patch.dict(os.environ, TANDEM_JAVASCRIPT=str(self.work / "javascript")):
            for name, package in names.items():
                with self.assertRaisesRegex(
                    BadUse,
                    f"{os.path.basename(name)}, and there is no .*javascript/{name}; install {package} ",
                ):
                    libraries.scripts(names, PROGRAM, "tandem view")
                path = self.work / "javascript" / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(name)
            self.assertEqual(libraries.scripts(names, PROGRAM, "tandem view"), list(names))
        beside = self.work / "bin/tandem", self.work / "libexec/tandem/javascript/chart.js/chart.min.js"
        for path in beside:
            path.parent.mkdir(parents=True)
            path.write_text("beside")
        with unittest.mock.patch.dict(os.environ):
            os.environ.pop("TANDEM_JAVASCRIPT", None)
            self.assertEqual(libraries.scripts(libraries.CHARTS, beside[0], ""), ["beside"])

    def test_missing_libraries_end_both_commands(self):
        nowhere = {"TANDEM_JAVASCRIPT": str(self.work / "nowhere")}
        page = self.work / "x.html"
        self.bad(
            ["tandem report needs chart.min.js", "libjs-chart.js"],
            "report",
            H200 / "plan.jsonl",
            "-o",
            page,
            environment=nowhere,
        )
        self.bad(
            ["tandem view needs three.min.js", "libjs-three"],
            "view",
            "plates",
            "-o",
            page,
            environment=nowhere,
        )
        self.assertFalse(page.exists())

    def test_files_are_complete_or_unchanged(self):
        path = self.work / "whole.txt"
        replace_whole(str(path), b"one")
        (self.work / "whole.txt.partial").write_text("what a kill has left")
        replace_whole(str(path), b"two" * 1_000_000)
        self.assertEqual(path.read_bytes(), b"two" * 1_000_000)
        self.assertFalse((self.work / "whole.txt.partial").exists())
        os.symlink(path, self.work / "linked.txt.partial")
        with self.assertRaisesRegex(OutputError, "linked.txt.partial: is a link"):
            replace_whole(str(self.work / "linked.txt"), b"three")
        self.assertEqual(path.read_bytes(), b"two" * 1_000_000)
        with self.assertRaisesRegex(OutputError, "nowhere/x.partial: cannot be written"):
            replace_whole(str(self.work / "nowhere/x"), b"")
