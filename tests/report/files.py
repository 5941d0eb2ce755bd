# SPDX-License-Identifier: MIT
# test: cost=7 full=50
"""Content of a page about records, from the package python/tandem/report alone: interrupted cells, damaged
records, missing libraries, and escaping of all text."""

import copy
import functools
import html
import json
import lzma
import os
import random
import re
import unittest
import unittest.mock

from tests.program import LONG, PROGRAM, SOURCE, Case
from tests.report.case import short
from tests.script_case import committed

from tandem import lines
from tandem.errors import BadUse, OutputError
from tandem.files import replace_whole
from tandem.pages.markup import markup
from tandem.report import assembly
from tandem.report.data import data_of
from tandem.report.other_records import Simulations
from tandem.report.reading import read_records

H200 = SOURCE / "results/h200"
REPLACEMENTS = (
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
)


class Reading(Case):
    def setUp(self):
        self.record = json.loads((H200 / "plan.jsonl").read_text().splitlines()[0])

    def made(self, session, count=5, factor=1, **changes):
        """A record with so many rounds of its own, or with some of the committed one's."""
        record = {**copy.deepcopy(self.record), "session": session, **changes}
        total = record["total_ns"]
        total["samples"] = [round(factor * ns) for ns in (self.record["total_ns"]["samples"] * count)[:count]]
        total["rounds"] = list(range(count))
        return record

    def file(self, *records, name="some.jsonl", end="\n"):
        path = self.work / name
        text = "\n".join(json.dumps(record) for record in records) + end
        path.write_bytes(lzma.compress(text.encode()) if name.endswith(".xz") else text.encode())
        return str(path)

    def shown(self, read):
        """Sessions of the cells, with older ones in parentheses."""
        return " ".join(f"({cell.session})" if cell.is_older else cell.session for cell in read.cells)

    def test_which_records_are_shown(self):
        """Interrupted records that go on in another are left out, as for tandem.read(); the last that is ok counts."""
        begun, whole = self.made("b", 3), self.made("w", 9)
        good, again = self.made("g"), self.made("a", factor=2)
        failed = self.made("f", status="failed", failure="lost")
        for records, shown in (
            ((begun, whole), "w"),
            ((self.made("b", 3, 2), whole), "(b) w"),
            ((good, again), "(g) a"),
            ((good, failed), "g (f)"),
            ((failed, good), "(f) g"),
            ((failed, {**failed, "session": "h"}), "(f) h"),
            ((good, failed, again), "(g) (f) a"),
        ):
            read = read_records([self.file(*records)])
            self.assertEqual((self.shown(read), read.notes), (shown, []))
        read = read_records([self.file(begun, name="begun.jsonl"), self.file(whole, name="whole.jsonl.xz")])
        self.assertEqual((self.shown(read), read.files), ("w", ["begun.jsonl", "whole.jsonl.xz"]))
        self.assertTrue(read.cells[0].location.endswith("whole.jsonl.xz:1"))

    def test_of_too_many_records_one_per_key_is_kept(self):
        keys = [self.made(f"{i}", 5, 1 + i / 100, key=f"key {i % 4}") for i in range(8)]
        older = "4 older records of cells that were recorded again are left out"
        left_out = (
            "2 of 9 records of cells are left out, 1 of them failed or wrong: a page shows at most 3; "
            "give fewer files or fewer lines"
        )
        wrong = self.made("w", status="wrong", key="another")
        for records, most, shown, notes in (
            (keys, 8, "(0) (1) (2) (3) 4 5 6 7", []),
            (keys, 6, "4 5 6 7", [older]),
            ([*keys, wrong], 3, "4 5 6", [older, left_out]),
        ):
            read = read_records([self.file(*records)], most)
            self.assertEqual((self.shown(read), read.notes), (shown, notes))

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
        names = ("h200/plan", "h200/profile", "../tests/records/ceilings", "../tests/records/accuracy")
        shown = refused = 0
        for source in [*(f"{name}.jsonl" for name in names), "simulations/solver-funnel.jsonl.xz"]:
            record = short(committed(source)[-1], 2, ("breakdown_ns", "chosen"))
            for damaged in self.damaged(record, chance):
                path = self.file(damaged)
                try:
                    json.loads(data_of(read_records([path]), 1_000_000).json, parse_constant=self.fail)
                    shown += 1
                except lines.RecordError as error:
                    self.assertTrue(str(error).startswith(f"{path}:1: "), error)
                    refused += 1
        self.assertGreater(shown, 100)
        self.assertGreater(refused, 100)

    def damaged(self, record, chance):
        def places(value, path=()):
            yield path
            if isinstance(value, dict):
                for name, part in value.items():
                    yield from places(part, (*path, name))
            elif isinstance(value, list) and value:
                yield from places(value[0], (*path, 0))

        for *path, name in list(places(record))[1:]:
            for replacement in chance.sample(REPLACEMENTS, 3 if LONG else 1):
                damaged = copy.deepcopy(record)
                part = functools.reduce(lambda value, key: value[key], path, damaged)
                part[name] = replacement
                if replacement == "left out":
                    del part[name]
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
    def test_libraries(self):
        names = {**assembly.CHARTS, **assembly.SCENES}
        with unittest.mock.patch.dict(os.environ, TANDEM_JAVASCRIPT=str(self.work / "javascript")):
            for name, package in names.items():
                missing = f"{os.path.basename(name)}, and there is no .*javascript/{name}; install {package} "
                with self.assertRaisesRegex(BadUse, missing):
                    assembly.open_page("", True, True, PROGRAM, "tandem view")
                path = self.work / "javascript" / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(name)
            page = assembly.open_page("", True, True, PROGRAM, "tandem view")
            self.assertEqual(page.scripts[:3], list(names))
        beside = self.work / "bin/tandem", self.work / "libexec/tandem/javascript/chart.js/chart.min.js"
        for path in beside:
            path.parent.mkdir(parents=True)
            path.write_text("beside")
        with unittest.mock.patch.dict(os.environ):
            os.environ.pop("TANDEM_JAVASCRIPT", None)
            self.assertEqual(assembly.open_page("", True, False, beside[0], "").scripts[0], "beside")

    def test_drawings_are_those_of_the_cells(self):
        """A name in a record is no path."""
        record = json.loads((H200 / "plan.jsonl").read_text().splitlines()[0])
        for names, drawn in (
            (
                ("tiled resident", "chunked paper", "tiled resident", "chunked grouped"),
                ["grouped schedule and paper's schedule", "tiled"],
            ),
            (("embree resident", "../methods/tiled resident", "<b> resident"), []),
        ):
            path = self.work / "some.jsonl"
            records = [
                {**record, **dict(zip(("algorithm", "preset"), name.split())), "key": f"{i}"}
                for i, name in enumerate(names)
            ]
            path.write_text("".join(json.dumps(one) + "\n" for one in records))
            text = "".join(
                map(markup, (part.content for part in data_of(read_records([str(path)]), 1_000_000).sections))
            )
            self.assertEqual(
                re.findall("<summary><span>How it works: (.*?)</span></summary>", html.unescape(text)), drawn
            )
            self.assertEqual(
                text.count('<svg xmlns="http://www.w3.org/2000/svg" class="drawing"'), len(drawn)
            )

    def test_missing_libraries_end_both_commands(self):
        for command, what, named in (
            ("report", H200 / "plan.jsonl", ["tandem report needs chart.min.js", "libjs-chart.js"]),
            ("view", "plates", ["tandem view needs three.min.js", "libjs-three"]),
        ):
            page, nowhere = self.work / "x.html", {"TANDEM_JAVASCRIPT": str(self.work / "nowhere")}
            self.bad(named, command, what, "-o", page, environment=nowhere)
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
