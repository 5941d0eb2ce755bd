# SPDX-License-Identifier: MIT
# test: cost=12 full=50
"""The Python package, from its wheel alone: it reads the values of tandem export --csv from the committed
records, its comparisons equal tandem compare, and bad files give one line."""

import csv
import io
import json
import lzma
import math
import os
import pathlib
import subprocess
import tempfile
import unittest
import zipfile

import matplotlib
import pandas

from tests.program import LONG, PROGRAM, SOURCE, cells_of
from tests.report.wheel import FOLDER, package

matplotlib.use("agg")
H200 = SOURCE / "results/h200"
PLATES = H200 / "paper/records/resident-plates.jsonl"
TWO_COMMITS = SOURCE / "tests/records/two_commits.jsonl.xz"


def setUpModule():
    global tandem
    tandem = package()


class Metadata(unittest.TestCase):
    def test_the_distribution_has_a_name_of_its_own(self):
        """PyPI has another distribution tandem."""
        (wheel,) = pathlib.Path(FOLDER.name).glob("*.whl")
        self.assertTrue(wheel.name.startswith("tandem_bvh-"), wheel.name)
        names = zipfile.ZipFile(wheel).namelist()
        self.assertIn("tandem/__init__.py", names)
        self.assertIn("tandem/report/methods/tiled.svg", names)
        (metadata,) = (name for name in names if name.endswith("/METADATA"))
        self.assertIn("\nName: tandem-bvh\n", zipfile.ZipFile(wheel).read(metadata).decode())


def text_of(value):
    """In the format of export --csv."""
    if pandas.isna(value):
        return ""
    return str(value).lower() if str(value) in ("True", "False") else str(value)


class Reading(unittest.TestCase):
    def test_cells_equal_the_table_of_export(self):
        files = [H200 / f"paper/records/{name}.jsonl" for name in ("backends", "convert", "precision")]
        for committed in [*H200.glob("*.jsonl"), *(SOURCE / "results/cpu").glob("*.jsonl"), *files]:
            path = pathlib.Path(FOLDER.name) / committed.name
            lines = committed.read_text().splitlines(keepends=True)
            path.write_text("".join(lines if LONG else lines[:: -(-len(lines) // 20)]))
            done = subprocess.run([PROGRAM, "export", path, "--csv"], capture_output=True, text=True)
            if done.returncode != 0:  # not records of cells
                with self.assertRaises(tandem.RecordError, msg=path.name):
                    tandem.read(path)
                continue
            with self.subTest(path.name):
                cells = tandem.read(path).cells
                rows = list(csv.reader(io.StringIO(done.stdout)))
                self.assertEqual([*rows[0], "file", "partial"], list(cells.columns))
                self.assertEqual(len(rows) - 1, len(cells))
                for name, *texts in zip(*rows):
                    for value, text in zip(cells[name], texts):
                        if name in ("ms", "ms_low", "ms_high") or name.endswith("_ms"):
                            self.assertEqual(text, "" if math.isnan(value) else f"{value:.9g}", name)
                        elif name == "date":
                            self.assertEqual(text, value.strftime("%Y-%m-%dT%H:%M:%SZ"))
                        elif text != text_of(value):  # 1e+06 is 1000000.0
                            self.assertEqual(float(text), float(value), name)

    def test_other_frames_are_of_the_same_records(self):
        path = H200 / "plan.jsonl"
        records = tandem.read(str(path))
        raw = cells_of(path.read_text())
        cell = next(
            i
            for i, record in enumerate(raw)
            if record["algorithm"] == "gproximity" and record["preset"] == "fair"
        )
        record, frames = raw[cell], raw[cell]["frames"]["last"] - raw[cell]["frames"]["first"] + 1
        mine = records.of([cell])
        self.assertEqual(list(mine.cells.index), [cell])
        self.assertEqual(
            [round(ms * frames * 1e6) for ms in mine.samples["ms"]], record["total_ns"]["samples"]
        )
        self.assertEqual(list(mine.samples["round"]), record["total_ns"]["rounds"])
        self.assertEqual(set(mine.stages["stage"]), set(record["stages"]))
        balance = mine.stages[mine.stages["stage"] == "balance"].iloc[0]
        self.assertAlmostEqual(
            balance["device_ms"], record["stages"]["balance"]["device_ns"]["median"] / frames / 1e6
        )
        self.assertEqual(balance["launches"], record["stages"]["balance"]["launches"])
        self.assertEqual(
            set(mine.kernels["kernel"]),
            {kernel["entry"] for kernel in record["kernels"]} | set(record["kernel_times"]),
        )
        self.assertEqual(list(mine.frames["candidate_pairs"]), record["work"]["candidate_pairs"])
        self.assertEqual(len(records.cells), len(raw))
        self.assertGreater(records.frames["ms"].min(), 0)

    def test_errors_equal_those_of_the_truth(self):
        records = tandem.read(SOURCE / "tests/records/accuracy.jsonl")
        written = [
            json.loads(line) for line in (SOURCE / "tests/records/accuracy.jsonl").read_text().splitlines()
        ]
        self.assertEqual(
            set(records.errors["cell"]), {i for i, r in enumerate(written) if r["error"]["truth"]}
        )
        for row in records.errors.itertuples():
            truth = written[row.cell]["error"]["truth"]
            if row.error == "false_share":
                self.assertAlmostEqual(row.median, truth["false"] / truth["candidates"])
            elif row.error == "missed_share":
                missed = truth["missed_touching"] + truth["missed_overlapping"]
                self.assertAlmostEqual(
                    row.median, missed / (missed + truth["touching"] + truth["overlapping"])
                )
            else:
                self.assertEqual(
                    {"median": row.median, "p99": row.p99, "max": row.max}, truth["contacts"][row.error]
                )

    def test_several_files_and_packed_ones(self):
        cells = tandem.read([PLATES, TWO_COMMITS]).cells
        self.assertEqual(list(cells["file"].unique()), [str(PLATES), str(TWO_COMMITS)])
        with lzma.open(TWO_COMMITS, "rt") as packed:
            texts = PLATES.read_text(), packed.read()
        self.assertEqual(len(cells), sum(len(cells_of(text)) for text in texts))

    def test_every_result_occurs_once(self):
        """An interrupted cell, its continuation in another session, copies, and two contradicting records."""
        line = json.loads((H200 / "plan.jsonl").read_text().splitlines()[0])
        rounds = sorted(set(line["total_ns"]["rounds"]))

        def with_rounds(count, session, factor=1, **fields):
            record = json.loads(json.dumps(line | fields))
            total = record["total_ns"]
            kept = [i for i, of in enumerate(total["rounds"]) if of in rounds[:count]]
            total["samples"], total["rounds"] = (
                [total["samples"][i] * factor for i in kept],
                [total["rounds"][i] for i in kept],
            )
            record["session"], record["sampling"] = (
                session,
                record["sampling"] | {"interrupted": count < len(rounds)},
            )
            return json.dumps(record) + "\n"

        begun, whole, other = (
            with_rounds(3, "a"),
            with_rounds(len(rounds), "b"),
            with_rounds(len(rounds), "c", 2),
        )
        with tempfile.TemporaryDirectory() as folder:

            def read(*texts):
                files = []
                for number, text in enumerate(texts):
                    files.append(pathlib.Path(folder) / f"{number}.jsonl")
                    files[-1].write_text(text)
                cells = tandem.read(files).cells
                return list(zip(cells["session"], cells["partial"]))

            self.assertEqual(read(begun), [("a", True)])
            self.assertEqual(read(begun, whole), [("b", False)])
            self.assertEqual(read(whole + begun + whole, whole, other), [("b", False), ("c", False)])
            # measured again without the rounds of the interrupted cell; not by another program, nor if it
            # failed
            self.assertEqual(read(with_rounds(5, "a", 2), whole), [("b", False)])
            self.assertEqual(read(whole, with_rounds(5, "a", 2)), [("b", False), ("a", True)])
            environment = line["environment"] | {"sources": "77"}
            self.assertEqual(
                read(with_rounds(5, "a", 2), with_rounds(len(rounds), "b", environment=environment)),
                [("a", True), ("b", False)],
            )
            gpus = [{**line["devices"][0], "id": f"cuda:{i}"} for i in range(2)]
            self.assertEqual(
                len(read(with_rounds(9, "s", devices=gpus[:1]), with_rounds(9, "s", 2, devices=gpus[1:]))), 2
            )
            with self.assertRaises(tandem.RecordError) as caught:
                read(whole, begun + with_rounds(len(rounds), "b", 2))
            self.assertIn("0.jsonl:1 and ", str(caught.exception))
            self.assertIn("1.jsonl:2: different records of one cell in one run", str(caught.exception))

    def test_bad_files_are_one_line(self):
        good = PLATES.read_text().splitlines()[0]
        without = json.dumps({name: value for name, value in json.loads(good).items() if name != "frames"})
        for text, words in (
            (f"{good}\nnot json\n", ":2: is not JSON"),
            ("[1]\n", ":1: is no record of a cell"),
            ("[" * 100000 + "\n", ":1: is not JSON"),
            (good.replace('"schema":4', '"schema":1', 1) + "\n", "scripts/convert_records"),
            (good.replace('"schema":4', '"schema":9', 1) + "\n", "schema 9"),
            (f"{without}\n", "record"),
            ("", "is empty"),
        ):
            with tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
                file.write(text)
                file.flush()
                for function in (tandem.read, lambda name: tandem.compare(name, name)):
                    with self.assertRaises(tandem.RecordError) as caught:
                        function(file.name)
                    self.assertIn(words, str(caught.exception))
                    self.assertTrue(str(caught.exception).startswith(file.name))
                    self.assertNotIn("\n", str(caught.exception))
        for name in ("/nowhere/run.jsonl", "/"):
            with self.assertRaisesRegex(tandem.RecordError, "cannot be read"):
                tandem.read(name)
        with self.assertRaises(tandem.RecordError):
            tandem.read([])

    def test_a_torn_line_gives_a_warning(self):
        good = PLATES.read_text().splitlines()[0]
        with tempfile.NamedTemporaryFile("w", suffix=".jsonl") as file:
            file.write(good + "\n" + good[:100])
            file.flush()
            with self.assertWarnsRegex(UserWarning, ":2: the last line has no end"):
                self.assertEqual(len(tandem.read(file.name).cells), 1)


class Comparing(unittest.TestCase):
    def expect_same(self, old, new):
        done = subprocess.run(
            [PROGRAM, "compare", old, new, "--format", "json"], capture_output=True, text=True
        )
        expected = json.loads(done.stdout)
        mine = tandem.compare(old, new)
        self.assertEqual(mine.changed, expected["changed"])
        self.assertEqual(len(mine.cells), len(expected["cells"]))
        for cell in expected["cells"]:
            row = mine.cells.loc[cell["key"]]
            self.assertEqual(row["verdict"], cell["verdict"])
            self.assertEqual(row["paired"], cell["paired"])
            for name in ("ratio", "low", "high", "p", "p_holm", "least_effect"):
                ratio = (cell["times"] or {}).get(name)
                if ratio is None:
                    self.assertTrue(math.isnan(row[name]), name)
                else:
                    self.assertAlmostEqual(
                        row[name] / ratio if ratio else row[name] + 1, 1, delta=1e-9, msg=name
                    )
        return mine

    def changed(self, lines, change):
        file = tempfile.NamedTemporaryFile("w", suffix=".jsonl", delete=False)
        self.addCleanup(os.unlink, file.name)
        with file:
            for i, line in enumerate(lines):
                record = json.loads(line)
                change(i, record)
                file.write(json.dumps(record) + "\n")
        return file.name

    def test_equals_the_program(self):
        self.expect_same(f"{TWO_COMMITS}@d09dc85", f"{TWO_COMMITS}@21143d3")
        lines = PLATES.read_text().splitlines()[:8]
        old = self.changed(lines, lambda i, record: None)

        def slower(i, record):  # the same session: rounds are pairs
            total = record["total_ns"]
            total["samples"] = [
                int(ns * (1 + 0.002 * (i + 1) * (j % 7))) for j, ns in enumerate(total["samples"])
            ]
            if i == 3:
                record["work"]["digest"]["a"] = "0" * 16
            if i == 4:  # too few
                total["samples"], total["rounds"] = total["samples"][:3], total["rounds"][:3]
            if i == 5:
                record["session"] = "another"
            if i == 6:
                record["status"] = "failed"

        mine = self.expect_same(old, self.changed(lines, slower))
        self.assertLessEqual(
            {"another_answer", "too_few", "within_threshold", "slower"}, set(mine.cells["verdict"])
        )
        self.assertEqual(len(mine.only_old), 1)
        self.assertEqual(len(mine.left_out), 1)

    def test_ties_and_large_numbers(self):
        """Rounded times tie; more pairs than the exact count supports are approximated."""
        lines = PLATES.read_text().splitlines()[:3]

        def of(count, step, session):
            def change(i, record):
                total = record["total_ns"]
                total["samples"] = [100000 + step * ((j * (i + 3)) % 11) for j in range(count)]
                total["rounds"] = list(range(count))
                record["session"] = session

            return self.changed(lines, change)

        for count in (8, 30, 120):
            for session in ("one", "other"):
                self.expect_same(of(count, 100, "one"), of(count, 130, session))

    def test_nothing_in_common(self):
        with self.assertRaisesRegex(tandem.RecordError, "have no cell in common"):
            tandem.compare(PLATES, H200 / "paper/records/thresholds.jsonl")
        with self.assertRaisesRegex(tandem.RecordError, "no record of commit abc"):
            tandem.compare(f"{PLATES}@abc", PLATES)
        with self.assertRaisesRegex(tandem.RecordError, "no commit behind the @"):
            tandem.compare(f"{PLATES}@", PLATES)
