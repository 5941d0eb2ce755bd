# SPDX-License-Identifier: MIT
# test: cost=5 full=20
"""`tandem export --csv`: tables of records, also of records of a removed algorithm."""

import csv
import json

from tests.program import SOURCE, Case, cells_of, tandem


class Exported(Case):
    def check_row(self, row, record):
        """The columns of a record with three samples, measured on the host."""
        for name in ("status", "algorithm", "preset", "session", "key"):
            self.assertEqual(row[name], record[name])
        self.assertEqual(
            (row["failure"], row["device"], row["commit"]), ("", "host", record["environment"]["commit"])
        )
        frames = record["frames"]["last"] - record["frames"]["first"] + 1
        for name, value in (("ms", "median"), ("ms_low", "low"), ("ms_high", "high")):
            self.assertAlmostEqual(
                float(row[name]), record["total_ns"][value] / frames / 1e6, delta=1e-8 * float(row[name])
            )
        self.assertEqual(int(row["samples"]), 3)
        self.assertEqual(int(row["candidate_pairs"]), sum(record["work"]["candidate_pairs"]))
        self.assertEqual(int(row["contacts"]), sum(record["work"]["contacts"]))
        self.assertEqual(int(row["launches"]), sum(stage["launches"] for stage in record["stages"].values()))
        truth = record["error"]["truth"]
        self.assertEqual(int(row["pairs_missed"]), truth["missed_touching"] + truth["missed_overlapping"])
        for name, value in record["settings"].items():
            self.assertEqual(row[f"set_{name}"], str(value))
        for name, value in record["work"]["counters"].items():
            self.assertEqual(row[f"count_{name}"], "" if value is None else str(value))
        for name, stage in record["stages"].items():
            on_device = stage["device_ns"]["median"] if stage["device_ns"] else 0
            median = on_device or stage["host_ns"]["median"]
            self.assertAlmostEqual(float(row[f"stage_{name}_ms"]), median / frames / 1e6, delta=1e-8)

    def test_records_become_a_table(self):
        out, table = self.work / "table.jsonl", self.work / "table.csv"
        status, text, errors = tandem(
            f"run {self.twice} --algorithm tiled,chunked --device host --set k=8,18 --repeat 3 --out {out}"
        )
        self.assertEqual(status, 0, (text, errors))
        records = cells_of(out.read_text())
        failed = json.loads(json.dumps(records[0]))
        failed.update(status="failed", failure='out of "memory",\nby 3 bytes')
        failed.update(dict.fromkeys(("work", "total_ns", "preparation", "error")))
        with open(out, "a") as file:
            file.write(json.dumps(failed) + "\n")
        text = self.output("export", out, "--csv", table)
        self.assertIn(f"{table}: 5 records of {out}", text)
        printed = tandem("export", out, "--csv")
        self.assertEqual((printed[0], printed[1], printed[2]), (0, table.read_text(), []))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 5)
        for row, record in zip(rows, records):
            self.check_row(row, record)
        # Settings of the other algorithm are empty.
        self.assertEqual({row["set_most_seeds"] for row in rows if row["algorithm"] == "chunked"}, {""})
        self.assertEqual(
            (rows[4]["status"], rows[4]["failure"], rows[4]["ms"]),
            ("failed", failed["failure"].replace("\n", "\\n"), ""),
        )
        with open(out, "a") as file:
            file.write(json.dumps(records[0])[:100])
        status, text, errors = tandem("export", out, "--csv")
        self.assertEqual((status, text), (0, table.read_text()))
        self.assertEqual(len(errors), 1)
        self.assertIn(f"{out}:{len(out.read_text().splitlines())}: the last line has no end", errors[0])

    def test_records_of_a_removed_algorithm_are_read(self):
        """Its name, settings, counters and kernels are words that the program no longer has."""
        out, former = self.work / "tiled.jsonl", self.work / "former.jsonl"
        run = (f"run {self.twice} --algorithm tiled --device host --repeat 2 --out",)
        self.assertEqual(tandem(*run, out)[0], 0)
        (record,) = cells_of(out.read_text())
        record["key"] = record["key"].replace("tiled", "former") + ",pad=60"
        record.update(algorithm="former", settings={**record["settings"], "pad": "60"})
        record["work"]["counters"]["open_pairs"] = 3
        record["kernels"][0].update(entry="emit_former", defines={"PAD": "60"})
        former.write_text(json.dumps(record) + "\n")
        self.assertEqual(self.records(former), [record])
        table = self.output("export", former, "--csv")
        (row,) = csv.DictReader(table.splitlines())
        self.assertEqual((row["algorithm"], row["set_pad"]), ("former", "60"))
        self.output("compare", former, former)
        self.assertEqual(tandem("report", former, "-o", self.work / "former.html")[0], 0)
        self.output(*run, former, "--resume")
        self.assertEqual([line["algorithm"] for line in self.records(former)], ["former", "tiled"])

    def test_files_that_are_not_records_give_no_table(self):
        other, empty = self.work / "other.jsonl", self.work / "empty.jsonl"
        other.write_text('{"schema":4}\n')
        empty.write_text("")
        self.bad(f"{other}:1: is no record of a cell", "export", other, "--csv")
        self.bad(f"{empty}: is empty", "export", empty, "--csv")
        self.bad("cannot be read", "export", self.work / "none.jsonl", "--csv")
        self.bad("is a folder", "export", self.work, "--csv")
        self.bad("no file of records", "export", "--csv")
        self.bad(
            "--csv makes a table of a file of records", "export", other, "--csv", "--glb", self.work / "x.glb"
        )
        torn = self.work / "torn.jsonl"
        torn.write_text('{"schema"')
        status, out, errors = tandem("export", torn, "--csv")
        self.assertEqual(
            (status, out, errors[1:]), (2, "", [f"tandem: {torn}: has no record; name a file of records"])
        )
        old = SOURCE / "results/h200/paper/records/convert.jsonl"
        self.bad("cannot be written", "export", old, "--csv", self.work / "none" / "x.csv")
        self.bad("writing failed (No space left on device)", "export", old, "--csv", "/dev/full", code=3)
        record = json.loads(old.read_text().split("\n", 1)[0])
        for change, expected in (
            ({"frames": None}, "is no record of a cell"),
            ({"schema": 1}, "scripts/convert_records"),
            ({"schema": 5}, "schema 5"),
            ({"settings": {"k": 8}}, "is no record of a cell"),
            ({"work": {"counters": 3}}, "lacks fields of its schema"),
            ({"frames": {"first": 1, "last": 0}}, "lacks fields of its schema"),
        ):
            other.write_text(json.dumps(record | change) + "\n")
            self.bad([f"{other}:1: ", expected], "export", other, "--csv")
