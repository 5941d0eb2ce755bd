# SPDX-License-Identifier: MIT
# test: cost=30
"""`tandem profile`, `--trace` and scripts/gpu/profile."""

import collections
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import sys

from tests.program import PROGRAM, SOURCE, Case, cells_of, ran, sets, tandem
from tests.validate_records import problems_in

SCRIPT = SOURCE / "scripts/gpu/profile"
loader = importlib.machinery.SourceFileLoader("profile_script", str(SCRIPT))
sys.dont_write_bytecode = True
script = importlib.util.module_from_spec(importlib.util.spec_from_loader("profile_script", loader))
loader.exec_module(script)

# Output of ncu with --page raw: names, units, a row per launch.
RAW = """==PROF== Connected to process 4711 (/x/tandem)
"ID","Process ID","Process Name","Host Name","Kernel Name","Context","Stream","Block Size","Grid Size","Device","CC","gpu__time_duration.sum","dram__bytes.sum","lts__t_bytes.sum","smsp__inst_executed.sum","sm__throughput.avg.pct_of_peak_sustained_elapsed","dram__throughput.avg.pct_of_peak_sustained_elapsed","lts__throughput.avg.pct_of_peak_sustained_elapsed","sm__warps_active.avg.pct_of_peak_sustained_active","launch__registers_per_thread","smsp__average_warps_issue_stalled_long_scoreboard_per_issue_active.ratio","smsp__average_warps_issue_stalled_wait_per_issue_active.ratio"
"","","","","","","","","","","","ns","byte","byte","inst","%","%","%","%","register/thread","inst","inst"
"0","4711","tandem","127.0.0.1","ENTRY","1","7","(128, 1, 1)","(64, 1, 1)","0","9.0","1,000","2,000,000","4,000,000","500","10.5","80","20","50","40","6.5","1.5"
==PROF== Disconnected
"1","4711","tandem","127.0.0.1","ENTRY","1","7","(128, 1, 1)","(64, 1, 1)","0","9.0","3000","4000000","4000000","700","30.5","60","20","70","40","2.5","1.5"
"2","4711","tandem","127.0.0.1","unheard_of(int *)","1","7","(128, 1, 1)","(64, 1, 1)","0","9.0","100","n/a","0","1","1","1","1","1","16","","0"
"""
LONG_FORM = """"ID","Process ID","Process Name","Host Name","Kernel Name","Context","Stream","Block Size","Grid Size","Device","CC","Section Name","Metric Name","Metric Unit","Metric Value"
"0","1","tandem","h","void kernel(float *)","1","7","(1, 1, 1)","(1, 1, 1)","0","9.0","Command line profiler metrics","gpu__time_duration.sum","usecond","1.5"
"0","1","tandem","h","void kernel(float *)","1","7","(1, 1, 1)","(1, 1, 1)","0","9.0","Command line profiler metrics","dram__bytes.sum","Mbyte","2,000.00"
"""


class Profile(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # The ceilings of another machine with this one's devices, because measuring takes long.
        cls.known, recorded = cls.work / "known-ceilings.jsonl", cls.work / "devices.jsonl"
        status, text, errors = tandem(
            f"run {cls.twice} --algorithm tiled --device host,opencl:0 --repeat 1 "
            f"--truth none --no-check --out {recorded}"
        )
        assert (status, errors) == (0, []), (text, errors)
        other = json.loads((SOURCE / "tests/records/ceilings.jsonl").read_text().splitlines()[0])
        devices = [record["devices"][0] for record in cells_of(recorded.read_text())]
        known = ({**other, "device": one, "launch_timed_s": other["launch_queued_s"]} for one in devices)
        cls.known.write_text("".join(json.dumps(line) + "\n" for line in known))

    def cell(self, *more):
        """Words of a cell with few capacities; without --profile it is repeated twice."""
        capacities = {name: 4096 for name in ("pair_capacity", "contact_capacity", "tile_pair_capacity")}
        meshes = ["--mesh", self.good] * 2
        repeat = [] if "--profile" in more else ["--repeat", 2]
        return [*meshes, "--algorithm", "tiled", "--set", "k=6", *repeat, *sets(capacities), *more]

    def valid(self, path):
        """Whether every line of a file is valid: 0, or 1 with its errors."""
        problems, count = problems_in(path, "profile")
        self.assertGreater(count, 0)
        return int(bool(problems)), "".join(f"{path}:{number}: {text}\n" for number, text in problems)

    def test_table_and_record(self):
        out = self.work / "profile.jsonl"
        texts = []
        for more in ("--device", "host"), ("--device", "opencl:0", "--ceilings", self.known):
            text = self.output("profile", *self.cell(*more, "--out", out))
            texts.append(text)
        for line in "".join(texts).splitlines():
            if " resident " not in line:  # the header line of the cell, with all its settings
                self.assertLessEqual(len(line), 100, line)
        self.assertIn("ceilings, measured", texts[0])
        for word in (
            "us/frame",
            "floor us",
            "x floor",
            "bound",
            "of ceiling",
            "answer: right",
            "generate_contacts",
        ):
            self.assertIn(word, "".join(texts))
        self.assertEqual(self.valid(out), (0, ""))
        records = [json.loads(line) for line in out.read_text().splitlines()]
        self.assertEqual(sorted(r["devices"][0]["id"] for r in records), ["host", "opencl:0"])
        for record in records:
            kernels = {k["entry"]: k for k in record["kernels"]}
            self.assertEqual(
                [k["entry"] for k in sorted(kernels.values(), key=lambda k: -k["device_ns"]["median"])],
                list(kernels),
            )
            self.assertAlmostEqual(sum(k["share"] for k in kernels.values()), 1)
            walk = kernels["walk_leaf_tiles"]
            frame = record["frame"]
            self.assertEqual((walk["stage"], walk["launches"], frame["body_pairs"]), ("traverse", 1, 1))
            self.assertEqual(
                walk["operations"], 6 * (frame["counters"]["bvtt_nodes"] - frame["counters"]["upper_tests"])
            )
            self.assertAlmostEqual(
                walk["of_operations"], walk["operations_per_s"] / record["ceilings"]["operations_per_s"]
            )
            self.assertAlmostEqual(walk["over_floor"], walk["device_ns"]["median"] / walk["floor"]["ns"])
            self.assertEqual(
                walk["floor"]["ns"],
                max(walk["floor"][f"{term}_ns"] for term in ("bytes", "operations", "launches")),
            )
            # 24 tetrahedra per body, each body with its own mesh: touched tetrahedra are a subset, each
            # counted once.
            self.assertTrue(
                0 < frame["touched_tetrahedra"] <= 48
                and frame["touched_rows"] == frame["touched_tetrahedra"],
                frame,
            )
            self.assertLessEqual(frame["touched_vertices"], 40)
            self.assertIsNone(record["counters"])
            self.assertEqual(walk["counters"], None)
        # For other commands it is not a record of a cell.
        self.assertIn("is no record of a cell", tandem("compare", out, out)[2][0])
        self.assertEqual(tandem("run", *self.cell("--device", "host", "--out", out, "--resume"))[0], 0)
        self.assertEqual(len(out.read_text().splitlines()), 3)
        self.assertEqual(self.valid(out)[0], 0)

    def test_schema_can_fail(self):
        out = self.work / "profile-bad.jsonl"
        self.assertEqual(
            tandem("profile", *self.cell("--device", "host", "--ceilings", self.known, "--out", out))[0], 0
        )
        record = json.loads(out.read_text())
        for change in (
            lambda r: r["kernels"][0].pop("bound"),
            lambda r: r["kernels"][0].update(bound="luck"),
            lambda r: r.pop("profile_of"),
            lambda r: r["ceilings"].update(bytes_per_s=0),
            lambda r: r["kernels"][0]["floor"].update(more=1),
            lambda r: r["frame"].update(contacts=None),
            lambda r: r.update(counters={}),
        ):
            changed = json.loads(out.read_text())
            change(changed)
            bad = self.work / "profile-changed.jsonl"
            bad.write_text(json.dumps(changed) + "\n")
            self.assertEqual(self.valid(bad)[0], 1)
        self.assertEqual(record["schema"], 2)

    def test_ceilings_of_a_file(self):
        ceilings, out = self.work / "ceilings.jsonl", self.work / "profile-ceilings.jsonl"
        ceilings.write_text(
            next(
                line
                for line in self.known.read_text().splitlines(keepends=True)
                if json.loads(line)["device"]["id"] == "host"
            )
        )
        arguments = (
            "profile",
            *self.cell("--device", "host", "--ceilings", ceilings, "--out", out, "--no-check"),
        )
        text = self.output(*arguments)
        self.assertIn("answer: not checked", text)
        record = json.loads(out.read_text())
        measured = json.loads(ceilings.read_text())
        self.assertEqual(record["ceilings"]["launch_s"], min(measured["launch_timed_s"]["samples"]))
        self.assertEqual(
            (record["ceilings"]["from"], record["ceilings"]["date"]),
            (str(ceilings), measured["environment"]["date"]),
        )
        self.bad(
            "no ceilings of opencl:0", "profile", *self.cell("--device", "opencl:0", "--ceilings", ceilings)
        )
        measured["device"]["clock"] = "CUPTI 13.0 activity records"
        ceilings.write_text(json.dumps(measured) + "\n")
        self.bad(
            "were timed by CUPTI 13.0 activity records, but kernels are timed by steady clock",
            "profile",
            *self.cell("--device", "host", "--ceilings", ceilings),
        )
        measured["launch_timed_s"] = None  # without a measured launch time
        ceilings.write_text(json.dumps(measured) + "\n")
        self.assertEqual(
            tandem("profile", *self.cell("--device", "host", "--ceilings", ceilings, "--no-check"))[0], 0
        )
        for name in (
            "copy_bytes_per_s",
            "read_bytes_per_s",
            "cache_read_bytes_per_s",
            "overlap_tests_k8_per_s",
            "overlap_tests_k18_per_s",
        ):
            measured[name]["median"] = 1.234567e7  # of a machine with other ceilings
        ceilings.write_text(json.dumps(measured) + "\n")
        status, text, _ = tandem(
            "profile", *self.cell("--device", "host", "--ceilings", ceilings, "--no-check")
        )
        ceilings = text[text.index("ceilings, ") :]
        self.assertLessEqual(max(map(len, ceilings.splitlines())), 100, ceilings)
        self.assertIn("0.0123 GB/s, cache 0.0123", " ".join(ceilings.split()))
        self.bad(
            "is no record of ceilings", "profile", *self.cell("--device", "host", "--ceilings", self.good)
        )

    def test_a_memory_limit_applies_to_cells_only(self):
        text = self.output(
            "profile", *self.cell("--device", "host", "--ceilings", self.known, "--memory", "4MB")
        )
        self.assertIn("answer: right", text)

    def test_bad_use(self):
        out = self.work / "same.json"
        self.bad(
            "named for two outputs", "profile", *self.cell("--device", "host", "--out", out, "--trace", out)
        )
        self.bad("a profile needs one device", "profile", *self.cell("--device", "host+opencl:0"))
        self.bad("--truth", "profile", *self.cell("--truth", "none"))
        self.bad("no scene", "profile")
        self.bad("--trace", "run", *self.cell("--device", "host", "--profile", 1, "--trace", out))
        self.bad(
            "cannot be written",
            "run",
            *self.cell("--device", "host", "--trace", self.work / "none" / "trace.json"),
        )
        self.bad("one scene", "run", "plates", "pile", "--device", "host", "--trace", out)
        self.assertFalse(out.exists())

    def check_trace(self, path, kernels):
        trace = json.loads(path.read_text())
        lanes, names = collections.defaultdict(list), {}
        for event in trace["traceEvents"]:
            if event["ph"] == "X":
                lanes[event["pid"], event["tid"]].append(event)
            elif event["name"] == "thread_name":
                names[event["pid"], event["tid"]] = event["args"]["name"]
        for lane, events in lanes.items():
            end = 0
            for event in events:
                self.assertGreaterEqual(event["ts"] + 1e-6, end, (names[lane], event))
                end = event["ts"] + event["dur"]
        of = {
            text: [e for lane, events in lanes.items() if names[lane] == text for e in events]
            for text in set(names.values())
        }
        self.assertEqual({e["name"] for e in of["device: kernels"]}, kernels)
        # A command begins on the device no earlier than the call that submitted it; calls are in order.
        calls = [e for e in of["host: calls"] if e["name"].startswith("launch ")]
        self.assertEqual([e["name"].split()[-1] for e in calls], [e["name"] for e in of["device: kernels"]])
        for call, kernel in zip(calls, of["device: kernels"]):
            self.assertGreaterEqual(kernel["ts"] + 1e-3, call["ts"])
            self.assertGreater(kernel["args"]["groups"], 0)
        self.assertTrue(of["host: waits"] and of["device: stages"] and of["device: transfers"])
        self.assertTrue(all(e["args"]["bytes"] > 0 for e in of["device: transfers"]))
        for clock in trace["otherData"]["devices"].values():
            self.assertFalse(clock["contradiction"])
        return trace["otherData"]

    def test_timeline(self):
        trace, out = self.work / "trace.json", self.work / "traced.jsonl"
        for device in ("host", "opencl:0"):
            self.output("run", *self.cell("--device", device, "--trace", trace, "--out", out))
            kernels = set(json.loads(out.read_text().splitlines()[-1])["kernel_times"])
            self.assertEqual(self.check_trace(trace, kernels)["frame"], 0)
        before = trace.read_bytes()
        self.output("profile", *self.cell("--device", "opencl:0", "--ceilings", self.known, "--trace", trace))
        self.assertNotEqual(trace.read_bytes(), before)
        self.check_trace(trace, kernels)
        self.assertEqual(
            [p.name for p in self.work.iterdir() if p.name.startswith("trace.json")], ["trace.json"]
        )

    def test_a_replay_for_profilers(self):
        text = self.output("run", *self.cell("--device", "host", "--profile", 3))
        self.assertIn("replayed frames 0:0 3 times; nothing measured or recorded", text)

    def test_counters_are_read(self):
        launches = script.launches_of(RAW)
        self.assertEqual([name for name, _ in launches], ["ENTRY", "ENTRY", "unheard_of"])
        self.assertNotIn("dram__bytes.sum", launches[2][1])
        counters = script.counters_of([m for name, m in launches if name == "ENTRY"], 2)
        self.assertEqual(
            {
                name: counters[name]
                for name in ("launches", "duration_ns", "dram_bytes", "l2_bytes", "instructions", "registers")
            },
            {
                "launches": 1,
                "duration_ns": 2000,
                "dram_bytes": 3e6,
                "l2_bytes": 4e6,
                "instructions": 600,
                "registers": 40,
            },
        )
        # Weighted by duration: a quarter of the first, three quarters of the second.
        self.assertAlmostEqual(counters["sm_percent"], 25.5)
        self.assertAlmostEqual(counters["dram_percent"], 65)
        self.assertEqual(
            (counters["top_stall"], counters["top_stall_warps"], counters["bound"]),
            ("long_scoreboard", 3.5, "bandwidth"),
        )
        self.assertEqual(script.counters_of([launches[2][1]], 1)["bound"], "latency")
        self.assertEqual(
            script.launches_of(LONG_FORM),
            [("kernel", {"gpu__time_duration.sum": 1500.0, "dram__bytes.sum": 2e9})],
        )
        # Kernels of 5 % or more have a row each, except those that the profiler did not see.
        same = {"device_ns": {"median": 2000}, "over_floor": None}
        rows = (("long", 0.9, counters), ("short", 0.04, counters), ("unseen", 0.06, None))
        kernels = [{"entry": name, "share": part, "counters": c, **same} for name, part, c in rows]
        table = script.table({"kernels": kernels}).splitlines()
        self.assertEqual(len(table), 2, table)
        self.assertRegex(table[1], r"^long +2 +90% +- +3 +4 +65 .*long_scoreboard +bandwidth$")
        with self.assertRaises(ValueError):
            script.launches_of("==ERROR== ERR_NVGPUCTRPERM\n")
        self.assertEqual(
            script.without(
                ["plates", "--all", "--repeat", "3", "--noise=1%", "--set", "k=8"], script.PROFILE_OPTIONS
            ),
            ["plates", "--set", "k=8"],
        )

    def script_on_host(self, out, *options, more=(), env=None):
        cell = self.cell("--device", "host", "--ceilings", self.known, "--out", out, *more)
        words = [SCRIPT, "--program", PROGRAM, *options, *cell]
        return ran(words, env=env)

    def counted(self, ncu, *more):
        """Runs scripts/gpu/profile with this replacement of ncu: exit code, output, record."""
        fake, out = self.work / "ncu", self.work / "counted.jsonl"
        out.unlink(missing_ok=True)
        fake.write_text("#!/bin/sh\n" + ncu)
        fake.chmod(0o755)
        done = self.script_on_host(out, "--ncu", fake, more=more)
        return done, [json.loads(line) for line in out.read_text().splitlines()], out

    def test_counters_of_a_cell(self):
        (self.work / "raw.csv").write_text(RAW.replace("ENTRY", "certify_pairs"))
        ncu = f"""if [ "$1" = --version ]; then echo "Version 2025.3.0.0 (build 1)"; exit; fi
echo "$@" > {self.work}/arguments
while [ "$1" != --log-file ]; do shift; done
cp {self.work}/raw.csv "$2"
"""
        done, records, out = self.counted(ncu, "--all")
        self.assertEqual((done.returncode, done.stderr.strip()), (0, ""), done.stdout)
        self.assertRegex(done.stdout, r"kernel +us/frame .*stall +bound")
        self.assertEqual(self.valid(out.rename(self.work / "profile-counted.jsonl")), (0, ""))
        counters = {k["entry"]: k["counters"] for k in records[0]["kernels"]}
        self.assertEqual(counters["certify_pairs"]["dram_bytes"], 6e6)
        self.assertEqual([entry for entry, c in counters.items() if c], ["certify_pairs"])
        self.assertEqual(
            (records[0]["counters"]["by"], records[0]["counters"]["kernels"]),
            ("Nsight Compute 2025.3.0.0", 3),
        )
        words = (self.work / "arguments").read_text().split()
        self.assertEqual(words[-4:], ["--set", "submission=each", "--profile", "1"])
        self.assertTrue(records[0]["counters"]["command"].startswith("ncu --csv "), records[0]["counters"])
        self.assertIn("tandem run --mesh", records[0]["counters"]["command"])
        self.assertFalse({"--repeat", "--all", "--ceilings", "--out"} & set(words))
        self.assertTrue({"--clock-control", "--profile-from-start", "run"} < set(words))

    def test_unavailable_counters(self):
        done, records, _ = self.counted("echo '==ERROR== ERR_NVGPUCTRPERM: no permission' >&2; exit 1\n")
        self.assertEqual(done.returncode, 3)
        self.assertIn("ERR_NVGPUCTRPERM", done.stderr)
        self.assertIsNone(records[0]["counters"])
        out = self.work / "none.jsonl"
        done = self.script_on_host(out, env={**os.environ, "PATH": "/usr/bin:/bin"})
        if pathlib.Path("/usr/local/cuda/bin/ncu").exists():
            self.skipTest("this machine has one")
        message = "ncu is missing, so that the record has no counters; install Nsight Compute, or name it with --ncu"
        self.assertEqual((done.returncode, done.stderr.strip()), (0, f"profile: {message}"))
        self.assertIsNone(json.loads(out.read_text())["counters"])
