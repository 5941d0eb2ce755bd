# SPDX-License-Identifier: MIT
# test: cost=20 full=50
"""Records of the program: one line per cell, appended."""

import itertools
import json
import os
import statistics
import subprocess
import sys

from tests.program import LONG, PROGRAM, SOURCE, Case, cells_of, right_cells, tandem


class Records(Case):
    def test_ceilings_are_measured_and_recorded(self):
        out = self.work / "ceilings.jsonl"
        device = "opencl:0" if LONG else "host"  # PoCL takes four times as long
        text = self.output("devices", "--measure", "--device", device, "--out", out)
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
            "run plates --frames 20:21 --algorithm chunked,gproximity --device host,opencl:0 --repeat 2 "
            f"--out {out}",
        )
        text = self.output(*arguments)
        self.assertEqual(right_cells(text), 4, text)
        for word in ("ms/frame", "walk", "launches", "95 %", "times as long", "2 frames"):
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
        # Folder names would identify the machine's user.
        self.assertNotIn(str(self.work), records[0]["command"])
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
            sampling = record["sampling"]
            self.assertEqual((sampling["rounds"], sampling["cells"], sampling["repeat"]), (rounds, 4, 2))
            for times in (record["breakdown_ns"], record["stages"]["traverse"]["host_ns"]):
                self.assertEqual((len(times["samples"]), len(times["frames"])), (rounds, 2))
            device = record["devices"][0]
            self.assertIn(
                device["compiler"] if device["id"] == "host" else device["name"], record["key"].split("|")[1]
            )
            times = record["kernel_times"]
            walks = [own["device_ns"]["median"] for name, own in times.items() if name.startswith("traverse")]
            self.assertGreater(sum(walks), 0, times.keys())
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
        self.output(
            f"run {self.twice} --device host --preset published --set k=8 "
            f"--repeat 2 --set queue_capacity=4096 --truth none --out {out}"
        )
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
            phases = {name: own["host_ns"]["samples"] for name, own in record["phases"].items()}
            self.assertEqual(set(phases), {"initialization", "narrow phase"})
            for i, (first, then) in enumerate(zip(phases["initialization"], phases["narrow phase"])):
                self.assertGreater(first, work["convert bodies"]["host_ns"]["samples"][i])
                self.assertGreater(then, work["copy sub trees"]["host_ns"]["samples"][i])
                self.assertLess(first + then, record["breakdown_ns"]["samples"][i])

    def test_samples_until_the_stopping_criterion(self):
        out = self.work / "suffice.jsonl"
        arguments = (
            f"run {self.twice} --device host --algorithm chunked,tiled --set k=6 --truth none --out {out}",
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
        self.output(
            "run plates --frames 0 --algorithm chunked --set k=6,8 --set precision=float,double "
            f"--repeat 1 --out {out}",
            *(() if LONG else ("--device", "host")),
        )
        self.assertEqual(
            [(r["settings"]["k"], r["settings"]["precision"]) for r in self.records(out)],
            list(itertools.product(["6", "8"], ["float", "double"])),
        )

    def test_keys_leave_out_defaults_of_later_settings(self):
        """So that records from before a setting remain comparable; sort is a stage of the ordered cells alone."""
        out = self.work / "later.jsonl"
        status, text, errors = tandem(
            "run rod:length=60,width=1 --frames 100:100 --device host --algorithm tiled --repeat 1 "
            f"--set self=off,on --set order=any,canonical --out {out}"
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
            ("near-exact", *exact),
            ("published", *far, "--preset", "published"),
        ):
            out = self.work / f"origin-{name}.jsonl"
            status, text, errors = tandem(
                f"run {self.twice} --device host --algorithm chunked --repeat 1 --quiet",
                *words,
                f"--out {out}",
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
            f"run {self.twice} --algorithm chunked --device opencl:0 "
            f"--set pair_capacity=64,4294967295,128 --repeat 1 --out {out}",
            code=3,
        )
        first, rest = out.read_text().split("\n", 1)
        self.assertEqual(first, '{"what": "was there before"}')
        out.write_text(rest)
        records = self.records(out)
        self.assertEqual([r["status"] for r in records], ["ok", "failed", "ok"])
        self.assertIn("34359738360", records[1]["failure"])

    def test_any_file_name_can_be_recorded(self):
        path = os.path.join(os.fsencode(self.work), b"na\xffme.msh")
        with open(path, "wb") as file:
            file.write(self.good.read_bytes())
        words = [b"--mesh", path, *b"--device host --repeat 1 --out".split(), self.work / "name.jsonl"]
        done = subprocess.run([PROGRAM, "run", *words], capture_output=True)
        self.assertIn(done.returncode, (0, 2), done.stderr)
