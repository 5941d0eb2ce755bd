# SPDX-License-Identifier: MIT
# test: cost=18 full=40
"""'tandem simulate': recordings that are equal on every device and after a
kill, its records, and bad use."""

import json
import os
import re
import signal
import struct
import subprocess
import time


from tests.program import LONG, PROGRAM, SOURCE, Case, ran, tandem
from tests.validate_records import problems_of_record

ARCH = "arch:segments=2"
NOT_CONVERGED = "the contact solver has not converged"
STACKS = ("arch", "colosseum")  # with the iteration counts of their measurements


def poses(path, bodies):
    """[frame][moving body] of the seven floats of a recording of rigid bodies, `bodies` of which move."""
    data = path.read_bytes()
    header, size = struct.unpack_from("<I", data, 12)[0], 16 + 28 * bodies + 4
    frames = (len(data) - header) // size
    return [
        [struct.unpack_from("<7f", data, header + f * size + 16 + 28 * b) for b in range(bodies)]
        for f in range(frames)
    ]


def frame_times(path):
    """Times in s of the frames of a recording with frames of equal size: the second field of each."""
    data = path.read_bytes()
    header = struct.unpack_from("<I", data, 12)[0]
    bodies, text = struct.unpack_from("<II", data, 32)
    floats = 0
    for body in range(bodies):
        kind, vertices = struct.unpack_from("<II", data, 40 + text + 8 * body)
        floats += {0: 7, 1: 0, 2: 3 * vertices}[kind]
    size = 20 + 4 * floats
    return [
        struct.unpack_from("<d", data, header + size * i + 8)[0] for i in range((len(data) - header) // size)
    ]


# For Case.all_bad.
BAD_USE = """
no scene                                                     | simulate --device host
scripted; measure it with 'tandem run'                       | simulate plates --device host
unknown scene 'arc'; the nearest is 'arch'                   | simulate arc --device host
unknown setting of dynamics 'stop'; the nearest is 'step'    | simulate arch --device host --dynamics stop=1
dynamics step=0 is impossible; give a number from 1e-09 to 10 | simulate arch --device host --dynamics step=0
dynamics step=-1 is impossible                               | simulate arch --device host --dynamics step=-1
dynamics step=nan is impossible                              | simulate arch --device host --dynamics step=nan
method=newton is impossible; give gauss_seidel or jacobi     | simulate arch --device host --dynamics method=newton
dynamics bounce=2 is impossible; give 0 or 1                 | simulate arch --device host --dynamics bounce=2
surface_normals=yes is impossible; give 0 or 1               | simulate arch --device host --dynamics surface_normals=yes
contact_layer=0.2 is impossible; give a number from 0 to 0.1 | simulate arch --device host --dynamics contact_layer=0.2
dynamics step has no value                                   | simulate arch --device host --dynamics step
unknown setting of dynamics 'papr'; the nearest is 'paper'   | simulate arch --device host --dynamics papr
asks for 2 cells                                             | simulate arch --device host --set k=8,18
a simulation needs contacts                                  | simulate arch --device host --set output=count
--resume requires -o FILE                                    | simulate arch --device host --resume
--pictures requires -o FILE                                  | simulate arch --device host --pictures x
--pictures: cannot make /proc/x                              | simulate arch --device host -o {none} --pictures /proc/x/y
absent                                                       | simulate arch --device host -o /absent/x.frames
absent                                                       | simulate arch --device host --record /absent/x.jsonl
--steps                                                      | simulate arch --device host --steps 0
"""


class SimulationCase(Case):
    def simulate(self, scene, *arguments):
        """Standard output of a run without other messages; scenes in STACKS may report that they do not converge."""
        text, errors = self.outputs("simulate", scene, "--device", "host", *arguments)
        self.assertTrue(not errors or str(scene).split(":")[0] in STACKS, errors)
        return text

    def outputs(self, *arguments, environment=None):
        """Standard output, and the lines of standard error, which may only report missing convergence."""
        status, text, errors = tandem(*arguments, environment=environment)
        self.assertEqual((status, [line for line in errors if NOT_CONVERGED not in line]), (0, []), text)
        return text, errors

    def lines(self, path):
        lines = [json.loads(line) for line in path.read_text().splitlines()]
        for line in lines:
            self.assertEqual(problems_of_record(line, "simulation"), [])
        return [line for line in lines if line["kind"] == "step"], [
            line for line in lines if line["kind"] == "run"
        ]


class Simulations(SimulationCase):
    def test_equal_frames_on_every_device(self):
        files, steps = [], 30 if LONG else 10
        for device, algorithm in (("host", "chunked"), ("opencl:0", "chunked"), ("opencl:0", "gproximity")):
            files.append(self.work / f"{device}-{algorithm}.frames")
            text, _ = self.outputs(
                f"simulate {ARCH} --steps {steps} -o", files[-1], f"--device {device} --algorithm {algorithm}"
            )
            self.assertIn(f"{steps} frames", text)
        self.assertEqual(len({file.read_bytes() for file in files}), 1)
        text = self.output(
            "check",
            files[0],
            "--frames",
            f"{steps - 2}:{steps - 1}",
            "--device host,opencl:0 --preset",
            "all" if LONG else "grouped,resident,fair",
        )
        self.assertIn("all agree with the reference", text)

    def test_frames_have_their_own_time(self):
        """The time is the middle of the step, also for adaptive steps: a body that flies at 2 m/s is at the matching
        position."""
        file, record = self.work / "flying.frames", self.work / "simulation-flying.jsonl"
        for scene in ("block:speed=2,drop=9", "tower:segments=1,slices=3"):
            self.simulate(scene, "--steps", 20, "-o", file, "--record", record)
            steps, _ = self.lines(record)
            times = frame_times(file)
            self.assertEqual(len(times), 20)
            for line, time_of in zip(steps, times):
                self.assertAlmostEqual(time_of, line["time_s"] - 0.5 * line["length_s"], delta=1e-12)
            if scene.startswith("block"):
                for frame, time_of in zip(poses(file, 1), times):
                    self.assertAlmostEqual(frame[0][0], 2 * time_of, delta=1e-6)
            for left in (file, record, self.work / "flying.frames.checkpoint"):
                left.unlink()

    def test_lines_of_a_run(self):
        record = self.work / "simulation.jsonl"
        text = self.simulate(ARCH, "--steps", 12, "--record", record)
        steps, runs = self.lines(record)
        self.assertEqual([line["step"] for line in steps], list(range(12)))
        self.assertEqual(len(runs), 1)
        self.assertEqual((runs[0]["status"], runs[0]["steps"], runs[0]["first_step"]), ("ok", 12, 0))
        self.assertGreater(min(line["contacts_found"] for line in steps), 100)
        self.assertTrue(all(line["contacts_kept"] <= line["contacts_found"] for line in steps))
        for part in ("broad", "narrow", "reduce", "assemble", "solve", "move"):
            self.assertEqual(runs[0]["host_ns"][part], sum(line["host_ns"][part] for line in steps))
        self.assertEqual(runs[0]["host_ns"]["total"], sum(line["host_ns"]["step"] for line in steps))
        self.assertGreater(steps[3]["stages"]["contact"]["launches"], 0)
        self.assertIn("12 steps in", text)
        self.assertEqual(runs[0]["dynamics"]["warm_start"], "1")

    def test_the_solver_of_the_paper_is_a_preset(self):
        """Later settings replace its values, and earlier ones are replaced by them."""
        record = self.work / "simulation-paper.jsonl"
        for more, iterations in (("--dynamics", "iterations=20"), "20"), ((), "150"):
            self.outputs(
                f"simulate block:bodies=2 --device host --steps 1 --record {record} "
                "--dynamics warm_start=1 --dynamics paper",
                *more,
            )
            found = self.lines(record)[1][-1]["dynamics"]
            names = "iterations relative_tolerance absolute_tolerance warm_start post_stabilize".split()
            self.assertEqual([found[name] for name in names], [iterations, "0.01", "0.01", "0", "0"])

    def test_the_preset_of_the_paper_merges_equal_contacts(self):
        """Tetrahedra with a common edge or vertex make the same contact, as those of stacked blocks do."""
        record = self.work / "simulation-merged.jsonl"
        kept = []
        for more in ((), ("--dynamics", "merge_distance=0")):
            self.outputs(
                f"simulate block:bodies=3,stack=1 --device host --steps 1 --record {record} --dynamics paper",
                *more,
            )
            step = self.lines(record)[0][-1]
            kept.append(step["contacts_kept"] / step["contacts_found"])
        self.assertLess(kept[0], 0.5)
        self.assertEqual(kept[1], 1)

    def test_steps_that_do_not_converge_are_reported(self):
        """One line at the first such step and one with the total; the record has the same counts. A resumed run
        counts each step once and gives the same result."""
        few, scene = ("--dynamics", "iterations=3"), "block:bodies=3,stack=1,restitution=0"
        record = self.work / "simulation-few.jsonl"
        _, errors = self.outputs(
            "simulate", scene, "--device", "host", "--steps", 30, "--record", record, *few
        )
        steps, runs = self.lines(record)
        missed = [line for line in steps if not line["converged"]]
        self.assertTrue(1 < len(missed) <= 30)
        self.assertTrue(all(line["iterations"] == 3 for line in missed))
        worst = max(missed, key=lambda line: line["residual"])
        self.assertEqual(
            (runs[0]["steps_not_converged"], runs[0]["worst_residual"]), (len(missed), worst["residual"])
        )
        self.assertEqual(len(errors), 2)
        self.assertRegex(
            errors[0],
            rf"^tandem: step {missed[0]['step']}: .* after 3 iterations: residual {missed[0]['residual']:.3g} N s above {missed[0]['tolerance']:.3g}, energy changed "
            rf"by {re.escape(format(missed[0]['energy_change_j'], '+.3g'))} J; raise iterations, ",
        )
        self.assertRegex(
            errors[1],
            rf"not converged in {len(missed)} of 30 steps; the worst is step {worst['step']}: residual {worst['residual']:.3g} N s",
        )
        for before, line in zip(steps, steps[1:]):
            self.assertAlmostEqual(
                line["energy_change_j"],
                sum(line["energy_j"].values()) - sum(before["energy_j"].values()),
                delta=1e-6,
            )
        parts, again = self.work / "few.frames", self.work / "simulation-parts.jsonl"
        for more in (("--steps", 12), ("--steps", 30, "--resume")):
            self.outputs("simulate", scene, "--device", "host", "-o", parts, "--record", again, *more, *few)
        resumed, processes = self.lines(again)
        self.assertEqual(sum(run["steps_not_converged"] for run in processes), len(missed))
        self.assertEqual(max(run["worst_residual"] for run in processes), worst["residual"])
        for name in ("converged", "residual", "energy_change_j"):
            self.assertEqual([line[name] for line in resumed], [line[name] for line in steps], name)
        # A single step is reported once; a converging run prints nothing.
        once = self.outputs("simulate", scene, "--device host --steps 1", "--record", again, *few)
        self.assertEqual(len(once[1]), 1)
        record.unlink()
        self.simulate("block", "--steps", 5, "--record", record)
        steps, runs = self.lines(record)
        self.assertEqual({line["converged"] for line in steps}, {True})
        self.assertEqual((runs[0]["steps_not_converged"], runs[0]["worst_residual"]), (0, None))

    def test_warm_up_comes_before_step_0(self):
        """Step 0 compiles nothing and grows no buffer: with capacities of 1 it traverses once, with the same
        commands with or without cached kernels. Frames are equal, also in a resumed run, which warms up
        again."""
        scene, small = "block:bodies=3", ("--set", "pair_capacity=1", "--set", "contact_capacity=1")
        caches = ("XDG_CACHE_HOME", "POCL_CACHE_DIR", "TANDEM_KERNEL_CACHE")
        cold = {name: str(self.work / "cold") for name in caches}
        whole, first_steps = self.work / "warm-host.frames", []
        self.simulate(scene, "--steps", 4, "-o", whole)
        for name in ("cold", "again"):
            frames, record = self.work / f"warm-{name}.frames", self.work / f"simulation-warm-{name}.jsonl"
            for more in (("--steps", 2), ("--steps", 4, "--resume")):
                text = self.output(
                    f"simulate {scene} --device opencl:0 -o {frames} --record {record}",
                    *small,
                    *more,
                    environment={**cold, "POCL_EXTRA_BUILD_FLAGS": "-cl-opt-disable"},
                )
                self.assertRegex(text, r"2 steps in [0-9.]+ s, after [0-9.]+ s of warm-up")
            steps, runs = self.lines(record)
            self.assertEqual([(run["first_step"], run["steps"]) for run in runs], [(0, 2), (2, 2)])
            self.assertGreater(min(run["warm_up_ns"] for run in runs), 0)
            self.assertEqual(frames.read_bytes(), whole.read_bytes())
            self.assertGreater(steps[0]["contacts_found"], 1)
            self.assertEqual(steps[0]["stages"]["traverse"]["launches"], 1)
            of_stages = steps[0]["stages"].items()
            first_steps.append({name: (s["launches"], s["waits"], s["bytes"]) for name, s in of_stages})
        self.assertEqual(first_steps[0], first_steps[1])

    def test_killed_at_any_moment(self):
        whole, broken = self.work / "whole.frames", self.work / "broken.frames"
        arguments = ["simulate", ARCH, "--steps", "60", "--device", "host", "--checkpoint", "7", "--quiet"]
        self.outputs(*arguments, "-o", whole)
        kills = 0
        for wait in (0.15, 0.3, 0.5, 0.8):
            resume = ["--resume"] if broken.exists() else []
            silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
            process = subprocess.Popen([PROGRAM, *arguments, "-o", broken, *resume], **silent)
            time.sleep(wait)
            process.send_signal(signal.SIGKILL)
            kills += process.wait() == -signal.SIGKILL
            if process.returncode == 0:
                break
        self.assertGreater(kills, 0)
        self.outputs(*arguments, "-o", broken, *(["--resume"] if broken.exists() else []))
        self.assertEqual(broken.read_bytes(), whole.read_bytes())
        text, _ = self.outputs(*arguments, "-o", broken, "--resume")
        self.assertIn("continues after step 60", text)
        self.assertEqual(broken.read_bytes(), whole.read_bytes())
        for other in (("--dynamics", "iterations=10"), ("--set", "contact_rule=clip")):
            words = f"simulate {ARCH} --device host -o {broken} --resume"
            self.bad("was simulated with other settings", words, *other)
        self.bad("broken.frames", "simulate", ARCH, "--device", "host", "-o", broken)
        self.bad("broken.frames", "simulate", "arch", "--device", "host", "-o", broken, "--resume")
        self.assertEqual(broken.read_bytes(), whole.read_bytes())

    def test_rows_that_are_no_contacts_are_refused(self):
        for rule in ("distance", "pressure"):
            self.bad(
                f"contact_rule={rule} makes no contacts",
                f"simulate {ARCH} --device host -o {self.work / rule}.frames --set contact_rule={rule}",
            )

    def test_divergence_is_reported(self):
        record, file = self.work / "simulation-bad.jsonl", self.work / "bad.frames"
        self.bad(
            ["step ", "body ", "J"],
            f"simulate tower:segments=1,slices=3 --device host --steps 200 -o {file} --record {record} "
            "--dynamics adaptive_tolerance=0 --dynamics step=0.1",
        )
        steps, runs = self.lines(record)
        self.assertEqual((runs[0]["status"], runs[0]["steps"]), ("failed", len(steps)))
        self.assertIn("step", runs[0]["failure"])
        self.assertGreater(len(steps), 0)
        self.output("export", file, "--frames", "0", "--glb", self.work / "bad.glb")

    def test_pictures_show_the_recording(self):
        frames, out = self.work / "pictured.frames", self.work / "new" / "arch"
        text = self.simulate("tower:segments=1,slices=3", "--steps", 40, "-o", frames, "--pictures", out)
        paths = [f"{out}-{i}.png" for i in range(3)]
        self.assertEqual(text.splitlines()[-3:], paths)
        glb = self.work / "pictured.glb"
        self.assertEqual(tandem("export", frames, "--frames", "0:39", "--glb", glb)[0], 0)
        drawn = ran([SOURCE / "scripts/render", glb, self.work / "drawn"])
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        pictures = [open(path, "rb").read() for path in paths]
        for which in (0, 2):  # between two keys a viewer may be half a step off
            self.assertEqual(pictures[which], (self.work / f"drawn-{which}.png").read_bytes())
        self.assertEqual(len(set(pictures)), 3, "it moves")
        words = f"simulate block --steps 1 --device host -o {self.work}/p.frames --pictures {out}"
        status, _, errors = tandem(words, environment={"TMPDIR": str(self.work / "absent")})
        self.assertEqual((status, len(errors)), (2, 1), errors)
        self.assertIn("set TMPDIR", errors[0])
        self.assertTrue((self.work / "p.frames").exists(), "what was simulated stays")

    def test_bad_use(self):
        self.all_bad(BAD_USE, none=self.work / "none.frames")
        self.assertEqual(os.path.exists("/absent"), False)
