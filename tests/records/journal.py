# SPDX-License-Identifier: MIT
# test: cost=15
"""Files of records when the writing program fails or is killed, and its standard
output."""

import json
import os
import resource
import signal
import subprocess
import time

from tests.program import PROGRAM, SOURCE, Case, messages, right_cells, words_of

LINE = b'{"what":"was there before"}\n'


def run(*arguments, before=None, **streams):
    """(exit code, standard output, messages); `before` runs in the child process before the
    program."""
    process = subprocess.run(
        [str(PROGRAM), *words_of(arguments)],
        preexec_fn=before,
        text=True,
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams},
    )
    return process.returncode, process.stdout, messages(process.stderr or "")


class Journal(Case):
    def meshes(self):
        return f"{self.twice} --device host --algorithm chunked"

    def cell(self, *more):
        return (f"{self.meshes()} --truth none --quiet", *more)

    def whole(self, path, before=LINE):
        """The records after the earlier content."""
        data = path.read_bytes()
        self.assertTrue(data.startswith(before) and data.endswith(b"\n"), data[:100])
        rest = self.work / "rest.jsonl"
        rest.write_bytes(data[len(before) :])
        return self.records(rest)

    def test_a_torn_line_is_set_aside(self):
        out, torn = self.work / "torn.jsonl", self.work / "torn.jsonl.torn"
        out.write_bytes(LINE + LINE[:-5])
        status, text, errors = run("run", *self.cell("--repeat", 1, "--out", out))
        self.assertEqual(
            (status, errors),
            (0, [f"tandem: {out}: the last line was torn; its {len(LINE) - 5} bytes were moved to {torn}"]),
            text,
        )
        self.assertEqual(len(self.whole(out)), 1)
        self.assertEqual(torn.read_bytes(), LINE[:-5] + b"\n")
        out.write_bytes(LINE + LINE[:-1])
        self.assertEqual(run("run", *self.cell("--repeat", 1, "--out", out))[::2], (0, []))
        self.assertEqual(len(self.whole(out, LINE + LINE)), 1)

    def test_files_that_are_not_records_are_refused(self):
        commands = (
            ("run", *self.cell("--out")),
            ("check", *self.cell("--out")),
            (f"accuracy {self.meshes()}", "--out"),
            ("devices", "--measure", "--device", "host", "--out"),
            ("simulate", "block", "--steps", 1, "--device", "host", "--record"),
        )
        out = self.work / "other"
        for data in (b"frame,body_a\n1,2\n", b"\x00\x01" * 3000, self.good.read_bytes()):
            for command in commands:
                out.write_bytes(data)
                self.bad(
                    [str(out), "its first line is not a JSON object", "choose another --out"], *command, out
                )
                self.assertEqual(out.read_bytes(), data)
        self.bad([str(self.work), "Is a directory", "choose another --out"], *commands[0], self.work)
        self.assertFalse((self.work / "other.torn").exists())

    def test_a_full_disk_keeps_the_table(self):
        status, text, errors = run("run", *self.cell("--repeat", 1, "--set", "k=6,8", "--out", "/dev/full"))
        self.assertEqual(
            (status, errors),
            (
                3,
                ["tandem: /dev/full: writing failed (No space left on device); earlier records are complete"],
            ),
        )
        self.assertIn("walk", text)
        self.assertEqual(right_cells(text), 1, text)
        for command in (
            ("check", *self.cell("--set", "k=6,8")),
            ("accuracy", f"{self.meshes()} --set k=6,8"),
        ):
            status, text, errors = run(*command, "--out", "/dev/full")
            self.assertEqual((status, len(errors)), (3, 1), (text, errors))
            self.assertEqual(text.count("k=6") if command[0] == "accuracy" else text.count("host "), 1, text)
        status, text, errors = run(
            "simulate", "block", "--steps", 2, "--device", "host", "--record", "/dev/full"
        )
        self.assertEqual((status, len(errors)), (3, 1), (text, errors))
        self.assertIn("1 step in", text)
        status, text, errors = run("run", *self.cell("--repeat", 1, "--dump-pairs", "/dev/full"))
        self.assertEqual(
            (status, errors), (3, ["tandem: /dev/full: writing failed (No space left on device)"]), text
        )

    def test_a_file_at_its_limit(self):
        """The first record fits, the second does not; its partial line is removed."""
        out = self.work / "limit.jsonl"
        self.assertEqual(run("run", *self.cell("--repeat", 1, "--set", "k=6", "--out", out))[0], 0)
        size = out.stat().st_size
        out.write_bytes(LINE)
        limit = len(LINE) + size + size // 2
        status, text, errors = run(
            "run",
            *self.cell("--repeat", 1, "--set", "k=6,8,18", "--out", out),
            before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
        )
        self.assertEqual((status, len(errors)), (3, 1), (text, errors))
        self.assertIn("writing failed (File too large)", errors[0])
        self.assertEqual(right_cells(text), 2, text)
        self.assertIn(f"1 record appended to {out}", text)
        self.assertEqual([r["settings"]["k"] for r in self.whole(out)], ["6"])

    def test_a_checkpoint_at_its_limit(self):
        frames = self.work / "full.frames"
        status, text, errors = run(
            f"simulate block:bodies=4 --steps 2 --device host --quiet -o {frames}",
            before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)),
        )
        self.assertEqual(status, 3, text)
        self.assertIn("writing failed (File too large)", errors[0])
        self.assertEqual(list(self.work.glob("full.frames*.partial")), [], "it takes room on a full disk")

    def test_a_dump_at_its_limit_keeps_the_table(self):
        dump = self.work / "pairs.csv"
        status, text, errors = run(
            "run",
            *self.cell("--repeat", 1, "--dump-pairs", dump),
            before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100)),
        )
        self.assertEqual((status, errors), (3, [f"tandem: {dump}: writing failed (File too large)"]), text)
        self.assertIn("right: no pair missing", text)
        self.assertEqual(list(dump.parent.glob("pairs.csv*")), [], "a part would read as the answer")

    def test_exports_pages_and_pictures_at_a_limit(self):
        """Each error names the file without space, in one line, and all have the same exit code."""
        scene = "pile:bodies=2,frames=2"
        for number, words in enumerate(
            (
                ("export", scene, "--frames", "0:1", "--vtu"),
                ("export", scene, "--frames", 0, "--glb"),
                ("export", scene, "--chunks"),
                ("export", scene, "--geometry"),
                ("report", SOURCE / "results/cpu/walks.jsonl", "-o"),
                ("simulate", "block", "--steps", 1, "--device", "host", "--quiet", "-o"),
            )
        ):
            out = self.work / f"limit{number}"
            status, _, errors = run(
                *words, out, before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))
            )
            self.assertEqual((status, len(errors)), (3, 1), (words, errors))
            self.assertRegex(errors[0], f"^tandem: {out}[^ ]*: writing failed \\(File too large\\)$")
        # The geometry of a page is written first, in the temporary directory.
        status, _, errors = run(
            f"view {scene} -o {self.work}/page",
            before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300)),
        )
        self.assertEqual((status, len(errors)), (3, 1), errors)
        self.assertRegex(errors[0], "^tandem: .*/tandem-[^ ]*: writing failed \\(File too large\\)$")

    def test_links_with_derived_names_are_not_followed(self):
        """Files whose names derive from a given one: the target of a link with such a name stays unchanged."""
        victim, out, frames, page = (
            self.work / name for name in ("victim", "linked.jsonl", "linked.frames", "linked.html")
        )
        victim.write_text("of another")
        for beside, words in (
            (f"{out}.torn", ("run", *self.cell("--repeat", 1, "--out", out))),
            (
                f"{frames}.checkpoint.partial",
                ("simulate", "block", "--steps", 1, "--device", "host", "-o", frames),
            ),
            (f"{page}.partial", ("view", "block", "-o", page)),
        ):
            out.write_bytes(LINE + b'{"')
            os.symlink(victim, beside)
            status, _, errors = run(*words)
            self.assertIn(status, (2, 3), words)
            self.assertEqual(len(errors), 1, errors)
            self.assertIn(beside, errors[0])
            self.assertEqual(victim.read_text(), "of another")
            os.remove(beside)
        out.unlink()
        os.symlink(victim, f"{out}.unfinished")
        status, _, errors = run("run", *self.cell("--repeat", 2, "--out", out))
        self.assertEqual((status, len(errors)), (0, 1), errors)
        self.assertIn("rounds are no longer saved", errors[0])
        self.assertEqual((victim.read_text(), len(self.records(out))), ("of another", 1))

    def test_programs_that_append_concurrently(self):
        out, capacities = self.work / "two.jsonl", range(1000, 1012)
        out.write_bytes(LINE)
        values = "pair_capacity=" + ",".join(map(str, capacities))
        arguments = [PROGRAM, *words_of(("run", *self.cell(f"--repeat 1 --set {values} --out {out}")))]
        processes = [subprocess.Popen(arguments, stdout=subprocess.DEVNULL) for _ in range(2)]
        self.assertEqual([p.wait(120) for p in processes], [0, 0])
        self.assertEqual(
            sorted(r["settings"]["pair_capacity"] for r in self.whole(out)),
            sorted([*map(str, capacities)] * 2),
        )

    def test_standard_output_that_cannot_be_written(self):
        """Exit code 3 and one line, from every command; records and files are still written."""
        meshes = self.meshes()
        commands = [
            *("--help", "run --help", "devices", "devices --json", "scenes", "scenes --json", "algorithms"),
            "algorithms --json",
            f"run {meshes} --truth none --quiet --repeat 1 --out",
            f"check {meshes} --truth none --quiet --preset grouped --out",
            f"accuracy {meshes} --set k=6 --out",
            "simulate block --steps 2 --device host --quiet --record",
            "export block --frames 0 --glb",
            "export block --chunks",
        ]
        reader, broken = os.pipe()
        os.close(reader)
        with open("/dev/full", "w") as full:
            for name, streams in (
                ("closed", {"stdout": None, "before": lambda: os.close(1)}),
                ("full", {"stdout": full}),
                ("broken", {"stdout": broken}),
            ):
                for number, command in enumerate(commands):
                    out = self.work / f"{name}{number}"
                    last = command.split()[-1]
                    writes = last in ("--out", "--record", "--glb", "--chunks")
                    status, _, errors = run(command, *([out] if writes else []), **streams)
                    if name == "broken":  # its reader has all that it wanted
                        self.assertEqual((status, errors), (0, []), command)
                    else:
                        self.assertEqual((status, len(errors)), (3, 1), (name, command, errors))
                        self.assertIn("tandem: standard output could not be written (", errors[0])
                    if last == "--out":
                        self.assertEqual(len(self.records(out)), 1)
                    elif last == "--record":
                        self.assertEqual(
                            [json.loads(line)["kind"] for line in out.read_text().splitlines()],
                            ["step", "step", "run"],
                        )
        os.close(broken)

    def test_commands_without_output_need_no_standard_output(self):
        for streams in (
            {"stdout": None, "before": lambda: os.close(1)},
            {"before": lambda: (os.close(0), os.close(1)), "stdout": None},
        ):
            status, _, errors = run("fly", **streams)
            self.assertEqual((status, len(errors)), (2, 1), errors)

    def test_standard_error_that_cannot_be_written(self):
        with open("/dev/full", "w") as full:
            for streams in (
                {"stderr": None, "before": lambda: os.close(2)},
                {"stderr": full},
                {"stderr": None, "before": lambda: (os.close(0), os.close(2))},
            ):
                self.assertEqual(run("fly", **streams)[0], 2)
                out = self.work / "silent.jsonl"
                out.write_bytes(LINE + b"{")
                status, text, _ = run("run", *self.cell("--repeat", 1, "--out", out), **streams)
                self.assertEqual(status, 0, text)
                self.assertEqual(len(self.whole(out)), 1)

    def test_records_and_table_in_one_file(self):
        """--out /dev/stdout into a file: records between other output, and nothing is overwritten."""
        both = self.work / "both"
        with open(both, "w") as stream:
            self.assertEqual(
                run("run", *self.cell("--repeat", 1, "--out", "/dev/stdout"), stdout=stream)[::2], (0, [])
            )
        lines = both.read_text().splitlines()
        self.assertTrue(lines[0].startswith("scene "), lines[0])
        self.assertEqual([json.loads(line)["status"] for line in lines if line.startswith("{")], ["ok"])
        self.assertEqual(lines[-1], "1 record appended to /dev/stdout")

    def test_a_resumed_simulation_records_no_step_twice(self):
        record, frames = self.work / "simulation.jsonl", self.work / "resumed.frames"
        arguments = [f"simulate block --device host --checkpoint 7 --quiet --record {record} -o", frames]

        def steps():
            return [
                line
                for line in map(json.loads, record.read_text().splitlines())
                if line.get("kind") == "step"
            ]

        # Another run of the same scene in the same file.
        self.assertEqual(run(*arguments[:-1], self.work / "other.frames", "--steps", 25)[0], 0)
        earlier = len(steps())
        process = subprocess.Popen(
            [PROGRAM, *words_of(arguments), "--steps", "100000"], stdout=subprocess.DEVNULL
        )
        while len(record.read_bytes().splitlines()) < earlier + 1 + 20 and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        self.assertEqual(process.wait(), -signal.SIGKILL)
        data = record.read_bytes()
        record.write_bytes(
            data[: data.rfind(b"\n") + 1] + b'{"schema":2,"kind":"st'
        )  # possible remains of a kill
        steps_of = [s for s in map(json.loads, record.read_bytes().splitlines()[:-1]) if s["kind"] == "step"]
        done = len(steps_of) - earlier
        self.assertGreater(done, 10)
        status, text, errors = run(*arguments, "--resume", "--steps", done + 5)
        self.assertEqual((status, len(errors)), (0, 1), (text, errors))
        self.assertIn("continues after step", text)
        lines = steps()
        self.assertEqual(lines[: earlier + done], steps_of)
        self.assertEqual([s["step"] for s in lines[earlier:]], list(range(done + 5)))
        self.assertEqual(len({s["session"] for s in lines[earlier:]}), 1)
        self.assertNotEqual(lines[0]["session"], lines[-1]["session"])
        before = record.read_bytes()
        status, text, errors = run(*arguments, "--resume", "--steps", done + 5)
        self.assertEqual((status, errors, record.read_bytes()), (0, [], before), text)
        self.assertTrue(text.endswith("all steps are done, none is simulated\n"), text)
