#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""records.py PROGRAM SOURCE: records of the program: one line per cell, appended, and schemas that reject
invalid records."""

import csv
import itertools
import json
import os
import statistics
import subprocess
import sys
import unittest

from program import LONG, PROGRAM, SOURCE, Case, cells_of, tandem


def paths(value, path=()):
    """Every path to a value inside a JSON document, parents first."""
    for name, child in (
        value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    ):
        yield (*path, name)
        yield from paths(child, (*path, name))


def changed(record, path, change):
    """A copy of `record` after change(parent of path, last name of path)."""
    copy = json.loads(json.dumps(record))
    parent = copy
    for name in path[:-1]:
        parent = parent[name]
    change(parent, path[-1])
    return copy


MAPS = {"settings", "asked", "defines", "counters", "kernel_times", "host_work"}
NULLABLE = {
    "chosen",
    "failure",
    "agreement",
    "commit",
    "hardware",
    "device_span_ns",
    "session",
    "command",
    "registers",
    "local_bytes",
    "spill_bytes",
    "stack_bytes",
    "missed_upper95",
    "candidate_ratio",
    "decisions",
    "depth_relative",
    "depth_ulps",
    "normal_degrees",
    "point",
    "hausdorff",
    "volume_relative",
    "depth_change",
    "deep_contact",
}
OF_CONDITION = (
    "cores",
    "quota_cores",
    "own_cores",
    "other_cores",
    "governor",
    "mhz",
    "throttled_periods",
    "pressure_percent",
)
OF_SAMPLING = ("cells", "seed", "repeat", "noise", "seconds", "spent_seconds", "converged", "drift")
NULLABLE_PATHS = {
    ("scene", "reading", "weld"),
    ("environment", "processor"),
    ("environment", "sources"),
    ("conditions",),
    ("ranks",),
    ("partition",),
    *(("conditions", when, "processor", name) for when in ("before", "after") for name in OF_CONDITION),
    *(("conditions", when, "gpus", 0) for when in ("before", "after")),
    *(("sampling", name) for name in OF_SAMPLING),
    ("error", "truth"),
    ("error", "rounding"),
    ("error", "truth", "contacts"),
    ("error", "truth", "drift"),
    *(("work", name) for name in ("undecided_by_filter", "undecided_by_double", "batches")),
}
# Fields that records of earlier versions lack.
SINCE = {
    "stack_bytes",
    "chosen",
    "truth",
    "inputs",
    "volume_relative",
    "no_volume",
    "deep_contact",
    "flattened",
}
SINCE_PATHS = {
    ("devices", 0, "clock"),
    ("work", "digest"),
    ("work", "contact_digest"),
    ("work", "submissions"),
    ("work", "rebuilds"),
    ("work", "dropped_body_pairs"),
    ("work", "dropped_candidate_pairs"),
    ("work", "walked_tetrahedra"),
    ("work", "without_boundary"),
    ("sampling", "continued"),
    ("host_work",),
    ("ranks",),
    ("partition",),
    ("scene", "reading"),
    ("error", "rounding"),
}


class Records(Case):
    def test_ceilings_are_measured_and_recorded(self):
        out = self.work / "ceilings.jsonl"
        device = "opencl:0" if LONG else "host"  # PoCL takes four times as long
        status, text, errors = tandem("devices", "--measure", "--device", device, "--out", out)
        self.assertEqual((status, errors), (0, []), text)
        self.assertIn("read of device memory", text)
        records = cells_of(out.read_text())
        self.assertEqual([r["device"]["id"] for r in records], [device])
        for name in ("copy_bytes_per_s", "launch_s", "overlap_tests_k8_per_s"):
            self.assertGreater(records[0][name]["median"], 0)
        # Eighteen planes need more comparisons than eight.
        self.assertGreater(
            records[0]["overlap_tests_k8_per_s"]["median"], records[0]["overlap_tests_k18_per_s"]["median"]
        )
        script = [sys.executable, str(SOURCE / "tests/validate_records.py"), str(out)]
        self.assertEqual(subprocess.run(script, capture_output=True).returncode, 0)
        out.write_text(out.read_text().replace('"launch_s":{"median":', '"launch_s":{"median":-', 1))
        self.assertEqual(subprocess.run(script, capture_output=True).returncode, 1)
        self.bad("--measure", "devices", "--device", "opencl:0")
        self.bad("the nearest is", "devices", "--measure", "--device", "opencl:77")

    def test_run_records_and_appends(self):
        out = self.work / "run.jsonl"
        arguments = (
            "run",
            "plates",
            "--frames",
            "20:21",
            "--algorithm",
            "chunked,gproximity",
            "--device",
            "host,opencl:0",
            "--repeat",
            2,
            "--out",
            out,
        )
        status, text, errors = tandem(*arguments)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(text.count(": right: "), 4, text)
        for word in (
            "ms/frame",
            "traverse",
            "launches",
            "95 %",
            "times as long as chunked grouped on host",
            "narrow",
        ):
            self.assertIn(word, text)
        first = out.read_bytes()
        records = self.records(out)
        # Cells end in the random order of their last turns.
        self.assertEqual(
            sorted((r["devices"][0]["id"], r["algorithm"]) for r in records),
            list(itertools.product(["host", "opencl:0"], ["chunked", "gproximity"])),
        )
        self.assertEqual(len({r["session"] for r in records}), 1)
        self.assertTrue(
            records[0]["command"].startswith("tandem run plates --frames 20:21 "), records[0]["command"]
        )
        self.assertNotIn(
            str(self.work), records[0]["command"]
        )  # folder names would identify the machine's user
        self.assertEqual({r["status"] for r in records}, {"ok"})
        self.assertEqual(len({json.dumps(r["agreement"]["digest"]) for r in records}), 1)
        self.assertEqual(len({json.dumps(r["agreement"]["contact_digest"]) for r in records}), 1)
        for record in records:
            self.assertGreater(record["agreement"]["digest"]["count"], 1000)
            self.assertEqual(sum(record["work"]["candidate_pairs"]), record["agreement"]["digest"]["count"])
            self.assertEqual(
                [sum(frames) for frames in record["total_ns"]["frames"]], record["total_ns"]["samples"]
            )
            rounds = self.rounds_of_two_samples(record)
            self.assertEqual(
                (record["sampling"]["rounds"], record["sampling"]["cells"], record["sampling"]["repeat"]),
                (rounds, 4, 2),
            )
            for times in (record["breakdown_ns"], record["stages"]["traverse"]["host_ns"]):
                self.assertEqual((len(times["samples"]), len(times["frames"])), (rounds, 2))
            device = record["devices"][0]
            self.assertIn(
                device["compiler"] if device["id"] == "host" else device["name"], record["key"].split("|")[1]
            )
            walks = [name for name in record["kernel_times"] if name.startswith("traverse")]
            self.assertGreater(
                sum(record["kernel_times"][name]["device_ns"]["median"] for name in walks),
                0,
                record["kernel_times"].keys(),
            )
            self.assertGreater(record["stages"]["traverse"]["device_ns"]["median"], 0)
        self.assertEqual(tandem(*arguments)[0], 0)
        self.assertTrue(out.read_bytes().startswith(first))
        again = self.records(out)[4:]
        self.assertEqual(sorted(r["key"] for r in again), sorted(r["key"] for r in records))
        self.assertNotEqual(again[0]["session"], records[0]["session"])

    def test_host_work_has_names(self):
        """The record lists host work that the paper's release does not time (making of seeds, allocation of the
        queue array) separately, within its stage."""
        out = self.work / "host-work.jsonl"
        status, text, errors = tandem(
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--device",
            "host",
            "--preset",
            "published",
            "--set",
            "k=8",
            "--repeat",
            2,
            "--set",
            "queue_bytes=4096",
            "--truth",
            "none",
            "--out",
            out,
        )
        self.assertEqual((status, errors), (0, []), text)
        for record, name, times in zip(
            sorted(self.records(out), key=lambda r: r["algorithm"]), ("make seeds", "queue array"), (1, 1)
        ):
            work = record["host_work"]
            self.assertLessEqual({name, "convert bodies"}, set(work))
            self.assertEqual((work[name]["stage"], len(work[name]["host_ns"]["samples"])), ("preprocess", 2))
            self.assertGreaterEqual(work[name]["times"], times)
            self.assertGreater(work[name]["host_ns"]["median"], 0)
            within = [
                sum(w["host_ns"]["samples"][i] for w in work.values() if w["stage"] == "preprocess")
                for i in range(2)
            ]
            self.assertEqual(within, record["stages"]["preprocess"]["host_ns"]["samples"])

    def test_samples_until_the_stopping_criterion(self):
        out = self.work / "suffice.jsonl"
        arguments = (
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--device",
            "host",
            "--algorithm",
            "chunked,tiled",
            "--set",
            "k=6",
            "--truth",
            "none",
            "--out",
            out,
        )
        self.assertEqual(tandem(*arguments, "--seconds", 0.01, "--noise", "0.01%", "--seed", 7)[0], 0)
        self.assertEqual(tandem(*arguments, "--seconds", 60, "--noise", 0.9, "--seed", 7)[0], 0)
        records = self.records(out)
        self.assertEqual(
            [(r["sampling"]["converged"], r["sampling"]["seed"], r["sampling"]["noise"]) for r in records],
            [(False, 7, 0.0001)] * 2 + [(True, 7, 0.9)] * 2,
        )
        for record in records:
            self.assertGreaterEqual(record["sampling"]["rounds"], 10)
            rounds, samples = record["total_ns"]["rounds"], record["total_ns"]["samples"]
            self.assertEqual((rounds, len(rounds)), (sorted(rounds), len(samples)))
            self.assertEqual(len(record["breakdown_ns"]["samples"]), record["sampling"]["rounds"])
            medians = [
                statistics.median(s for s, r in zip(samples, rounds) if r == n) for n in range(rounds[-1] + 1)
            ]
            self.assertAlmostEqual(record["total_ns"]["median"], statistics.median(medians), delta=1)
        for wrong in (
            ("--noise", "0"),
            ("--noise", "101%"),
            ("--noise", "x"),
            ("--seconds", "0"),
            ("--seed", "x"),
        ):
            self.assertEqual(tandem(*arguments, *wrong)[0], 2, wrong)

    def test_several_values_make_several_cells(self):
        out = self.work / "cells.jsonl"
        status, text, errors = tandem(
            "run",
            "plates",
            "--frames",
            "0",
            "--algorithm",
            "chunked",
            "--set",
            "k=6,8",
            "--set",
            "precision=float,double",
            "--repeat",
            1,
            "--out",
            out,
            *(() if LONG else ("--device", "host")),
        )
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(
            [(r["settings"]["k"], r["settings"]["precision"]) for r in self.records(out)],
            list(itertools.product(["6", "8"], ["float", "double"])),
        )

    def test_keys_leave_out_defaults_of_later_settings(self):
        """So that records from before a setting remain comparable; sort is a stage of the ordered cells alone."""
        out = self.work / "later.jsonl"
        status, text, errors = tandem(
            "run",
            "rod:length=60,width=1",
            "--frames",
            "100:100",
            "--device",
            "host",
            "--algorithm",
            "tiled",
            "--repeat",
            "1",
            "--set",
            "self=off,on",
            "--set",
            "order=any,canonical",
            "--out",
            out,
        )
        self.assertEqual(status, 0, text)
        self.assertEqual(
            errors,
            [
                "tandem: scene rod: nothing can meet: there is one body, which setting self=off does not pair with itself; choose self=on, or add a body"
            ],
        )
        found = {
            (record["settings"]["self"], record["settings"]["order"]): record
            for record in cells_of(out.read_text())
        }
        self.assertEqual(len(found), 4)
        for (own, order), record in found.items():
            words = record["key"].split("|")[-1].split(",")
            self.assertEqual(
                ("self=on" in words, "order=canonical" in words), (own == "on", order == "canonical")
            )
            names = {word.split("=")[0] for word in words}
            self.assertEqual(("self" in names, "order" in names), (own == "on", order == "canonical"))
            self.assertEqual("sort" in record["stages"], order == "canonical")
            self.assertEqual(record["work"]["candidate_pairs"][0] > 0, own == "on")
            self.assertEqual((record["agreement"]["missing"], record["agreement"]["extra"]), (0, 0))

    def test_scenes_near_the_worlds_origin_have_the_keys_of_origin_world(self):
        """So that records from before origin=auto was the default remain comparable. Where no other origin is
        possible, a line says so."""
        exact = ("--set", "placement=exact", "--set", "precision=double")
        far = [word for x in (0, 0.7) for word in ("--pose", f"{6.4e6 + x} 0 0 1 0 0 0")]
        found = {}
        for name, *words in (
            ("near",),
            ("world", "--set", "origin=world"),
            ("far", *far),
            ("exact", *far, *exact),
            ("near and exact", *exact),
            ("published", *far, "--preset", "published"),
        ):
            out = self.work / f"origin-{name}.jsonl"
            status, text, errors = tandem(
                "run",
                "--mesh",
                self.good,
                "--mesh",
                self.good,
                "--device",
                "host",
                "--algorithm",
                "chunked",
                "--repeat",
                1,
                "--quiet",
                *words,
                "--out",
                out,
            )
            self.assertEqual(status, 0, text)
            self.assertEqual(
                errors,
                [
                    "tandem: 1 cell with placement=exact and precision=double: coordinates count from the world's origin, which is far from the "
                    "scene; choose precision=float, or move the scene"
                ]
                if name == "exact"
                else [],
            )
            (record,) = self.records(out)
            self.assertEqual(record["settings"]["origin"], "auto" if name == "far" else "world")
            self.assertEqual(
                record["asked"].get("origin"), None if name in ("world", "far", "published") else "auto"
            )
            self.assertIn(f"origin={record['settings']['origin']},", record["key"])
            found[name] = record
        self.assertEqual(found["near"]["key"], found["world"]["key"])
        self.assertEqual(found["near"]["work"]["digest"], found["world"]["work"]["digest"])

    def full_record(self):
        """A record with every optional part, but few entries of maps and lists whose entries all have the
        same fields."""
        out = self.work / "schema.jsonl"
        flat, _ = self.flawed("schema.msh")
        tandem(
            "run",
            "--mesh",
            flat,
            "--mesh",
            self.good,
            "--device",
            "opencl:0",
            "--algorithm",
            "gproximity",
            "--truth",
            "contacts",
            "--out",
            out,
        )
        record = self.records(out)[0]
        for name in ("stages", "kernel_times", "host_work"):
            record[name] = {key: record[name][key] for key in sorted(record[name])[-2:]}
        record["kernels"] = record["kernels"][:1]
        return record

    def check_field(self, record, path):
        """The field removed, of another type, null, or with an additional field beside it."""
        parent, name = path[-2] if len(path) > 1 else None, path[-1]
        nullable_paths = NULLABLE_PATHS | {
            ("work", "counters", counter) for counter in record["work"]["counters"]
        }
        optional = (
            parent in MAPS
            or parent == "stages"
            or isinstance(name, int)
            or name in SINCE
            or path in SINCE_PATHS
        )
        gone = changed(record, path, lambda p, n: p.pop(n))
        self.assertTrue(optional or not self.validator.is_valid(gone), "taken away")
        self.assertFalse(
            self.validator.is_valid(
                changed(
                    record,
                    path,
                    lambda p, n: p.update({n: {"x": []}}) if isinstance(p, dict) else p.append({"x": []}),
                )
            ),
            "type",
        )
        null = changed(record, path, lambda p, n: p.__setitem__(n, None))
        self.assertEqual(self.validator.is_valid(null), name in NULLABLE or path in nullable_paths, "null")
        if not isinstance(name, int) and parent not in MAPS:
            more = changed(record, path, lambda p, n: p.update(surprise=1))
            self.assertFalse(self.validator.is_valid(more), "one more")

    def test_schema_can_fail(self):
        """Every field of a real record."""
        record = self.full_record()
        seen = set()
        for path in paths(record):
            shape = tuple(0 if isinstance(name, int) else name for name in path)
            if shape in seen:
                continue
            seen.add(shape)
            with self.subTest(path=path):
                self.check_field(record, path)
        self.assertGreater(len(seen), 150)
        for change in (
            {"status": "fine"},
            {"status": "failed"},
            {"failure": "device lost"},
            {"failure": ""},
            {"schema": 2},
            {"stages": {"travers": record["stages"]["traverse"]}},
            {"breakdown_ns": {"samples": []}},
            {"total_ns": {**record["total_ns"], "samples": []}},
            {"devices": []},
            {"settings": {"k": 18}},
            {"scene": {**record["scene"], "digest": "0123456789ABCDEF"}},
            {"agreement": {**record["agreement"], "missing": 1}},
        ):
            self.assertFalse(self.validator.is_valid({**record, **change}), change)

    def test_validate_records(self):
        script = SOURCE / "tests/validate_records.py"

        def validate(*files):
            done = subprocess.run(
                [sys.executable, str(script), *map(str, files)], capture_output=True, text=True
            )
            return done.returncode, done.stdout + done.stderr

        good, bad, empty = (self.work / name for name in ("good.jsonl", "bad.jsonl", "empty.jsonl"))
        tandem(
            "run", "--mesh", self.good, "--device", "host", "--algorithm", "chunked,gproximity", "--out", good
        )
        line = good.read_text().splitlines()[0]
        bad.write_text(line + "\n" + line.replace('"count":0,', '"count":-1,', 1) + "\n" + line[:100] + "\n")
        empty.write_text("")
        self.assertEqual(validate(good), (0, "2 records valid\n"))
        status, text = validate(good, bad)
        self.assertEqual(status, 1, text)
        self.assertIn(": ".join(("bad.jsonl:2", "/".join(("", "work", "digest", "count")), "")), text)
        self.assertIn("bad.jsonl:3: not JSON", text)
        for files in ([empty], [self.work / "none.jsonl"], [good, self.work / "none.jsonl"]):
            self.assertEqual(validate(*files)[0], 1, files)

    def test_a_failing_cell_keeps_earlier_records(self):
        out = self.work / "fail.jsonl"
        out.write_text('{"what": "was there before"}\n')
        memory = min(
            d["memory_bytes"]
            for e in json.loads(tandem("devices", "--json")[1])
            for d in e["devices"]
            if d["id"] == "opencl:0"
        )
        if memory >= 34359738360:
            self.skipTest("the device has room for 4,294,967,295 pairs")
        self.bad(
            "34359738360",
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--algorithm",
            "chunked",
            "--device",
            "opencl:0",
            "--set",
            "pair_capacity=64,4294967295,128",
            "--repeat",
            1,
            "--out",
            out,
            code=3,
        )
        first, rest = out.read_text().split("\n", 1)
        self.assertEqual(first, '{"what": "was there before"}')
        out.write_text(rest)
        records = self.records(out)
        self.assertEqual([r["status"] for r in records], ["ok", "failed", "ok"])
        self.assertIn("34359738360", records[1]["failure"])

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
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--algorithm",
            "tiled,chunked",
            "--device",
            "host",
            "--set",
            "k=8,18",
            "--repeat",
            3,
            "--out",
            out,
        )
        self.assertEqual(status, 0, (text, errors))
        records = cells_of(out.read_text())
        failed = json.loads(json.dumps(records[0]))
        failed.update(
            status="failed",
            failure='out of "memory",\nby 3 bytes',
            work=None,
            total_ns=None,
            preparation=None,
            error=None,
        )
        with open(out, "a") as file:
            file.write(json.dumps(failed) + "\n")
        status, text, errors = tandem("export", out, "--csv", table)
        self.assertEqual((status, errors), (0, []), text)
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
        run = (
            "run",
            "--mesh",
            self.good,
            "--mesh",
            self.good,
            "--algorithm",
            "tiled",
            "--device",
            "host",
            "--repeat",
            2,
            "--out",
        )
        self.assertEqual(tandem(*run, out)[0], 0)
        (record,) = cells_of(out.read_text())
        record["key"] = record["key"].replace("tiled", "former") + ",pad=60"
        record.update(algorithm="former", settings={**record["settings"], "pad": "60"})
        record["work"]["counters"]["open_pairs"] = 3
        record["kernels"][0].update(entry="emit_former", defines={"PAD": "60"})
        former.write_text(json.dumps(record) + "\n")
        self.assertEqual(self.records(former), [record])
        status, table, errors = tandem("export", former, "--csv")
        self.assertEqual((status, errors), (0, []), table)
        (row,) = csv.DictReader(table.splitlines())
        self.assertEqual((row["algorithm"], row["set_pad"]), ("former", "60"))
        status, text, errors = tandem("compare", former, former)
        self.assertEqual((status, errors), (0, []), text)
        self.assertEqual(tandem("report", former, "-o", self.work / "former.html")[0], 0)
        status, text, errors = tandem(*run, former, "--resume")
        self.assertEqual((status, errors), (0, []), text)
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
        old = SOURCE / "results/h200/convert.jsonl"
        self.bad("cannot be written", "export", old, "--csv", self.work / "none" / "x.csv")
        self.bad("writing failed (No space left on device)", "export", old, "--csv", "/dev/full")
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

    def test_any_file_name_can_be_recorded(self):
        path = os.path.join(os.fsencode(self.work), b"na\xffme.msh")
        with open(path, "wb") as file:
            file.write(self.good.read_bytes())
        done = subprocess.run(
            [
                os.fsencode(PROGRAM),
                b"run",
                b"--mesh",
                path,
                b"--device",
                b"host",
                b"--repeat",
                b"1",
                b"--out",
                os.fsencode(self.work / "name.jsonl"),
            ],
            capture_output=True,
        )
        self.assertIn(done.returncode, (0, 2), done.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
