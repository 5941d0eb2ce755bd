#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""simulations.py PROGRAM SOURCE: 'tandem simulate': recordings that are equal on every device and after a
kill, its records, motions with known results, and bad use."""

import json
import math
import os
import re
import signal
import struct
import subprocess
import sys
import time
import unittest

import jsonschema

from program import LONG, PROGRAM, SOURCE, Case, tandem
from validate_records import problems_of_record

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


class Simulations(Case):
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

    def test_equal_frames_on_every_device(self):
        files, steps = [], 30 if LONG else 10
        for device, algorithm in (("host", "chunked"), ("opencl:0", "chunked"), ("opencl:0", "gproximity")):
            files.append(self.work / f"{device}-{algorithm}.frames")
            text, _ = self.outputs(
                "simulate",
                ARCH,
                "--steps",
                steps,
                "-o",
                files[-1],
                "--device",
                device,
                "--algorithm",
                algorithm,
            )
            self.assertIn(f"{steps} frames", text)
        self.assertEqual(len({file.read_bytes() for file in files}), 1)
        status, text, errors = tandem(
            "check",
            files[0],
            "--frames",
            f"{steps - 2}:{steps - 1}",
            "--device",
            "host,opencl:0",
            "--preset",
            "all" if LONG else "grouped,resident,fair",
        )
        self.assertEqual((status, errors), (0, []), text)
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
                "simulate",
                "block:bodies=2",
                "--device",
                "host",
                "--steps",
                1,
                "--record",
                record,
                "--dynamics",
                "warm_start=1",
                "--dynamics",
                "paper",
                *more,
            )
            found = self.lines(record)[1][-1]["dynamics"]
            self.assertEqual(
                [
                    found[name]
                    for name in (
                        "iterations",
                        "relative_tolerance",
                        "absolute_tolerance",
                        "warm_start",
                        "post_stabilize",
                    )
                ],
                [iterations, "0.01", "0.01", "0", "0"],
            )

    def test_the_preset_of_the_paper_merges_equal_contacts(self):
        """Tetrahedra with a common edge or vertex make the same contact, as those of stacked blocks do."""
        record = self.work / "simulation-merged.jsonl"
        kept = []
        for more in ((), ("--dynamics", "merge_distance=0")):
            self.outputs(
                "simulate",
                "block:bodies=3,stack=1",
                "--device",
                "host",
                "--steps",
                1,
                "--record",
                record,
                "--dynamics",
                "paper",
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
        self.assertEqual(
            len(
                self.outputs("simulate", scene, "--device", "host", "--steps", 1, "--record", again, *few)[1]
            ),
            1,
        )
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
        cold = {
            name: str(self.work / "cold")
            for name in ("XDG_CACHE_HOME", "POCL_CACHE_DIR", "TANDEM_KERNEL_CACHE")
        }
        whole, first_steps = self.work / "warm-host.frames", []
        self.simulate(scene, "--steps", 4, "-o", whole)
        for name in ("cold", "again"):
            frames, record = self.work / f"warm-{name}.frames", self.work / f"simulation-warm-{name}.jsonl"
            for more in (("--steps", 2), ("--steps", 4, "--resume")):
                status, text, errors = tandem(
                    "simulate",
                    scene,
                    "--device",
                    "opencl:0",
                    "-o",
                    frames,
                    "--record",
                    record,
                    *small,
                    *more,
                    environment={**cold, "POCL_EXTRA_BUILD_FLAGS": "-cl-opt-disable"},
                )
                self.assertEqual((status, errors), (0, []), text)
                self.assertRegex(text, r"2 steps in [0-9.]+ s, after [0-9.]+ s of warm-up")
            steps, runs = self.lines(record)
            self.assertEqual([(run["first_step"], run["steps"]) for run in runs], [(0, 2), (2, 2)])
            self.assertGreater(min(run["warm_up_ns"] for run in runs), 0)
            self.assertEqual(frames.read_bytes(), whole.read_bytes())
            self.assertGreater(steps[0]["contacts_found"], 1)
            self.assertEqual(steps[0]["stages"]["traverse"]["launches"], 1)
            first_steps.append(
                {
                    stage: (own["launches"], own["waits"], own["bytes"])
                    for stage, own in steps[0]["stages"].items()
                }
            )
        self.assertEqual(first_steps[0], first_steps[1])

    def test_killed_at_any_moment(self):
        whole, broken = self.work / "whole.frames", self.work / "broken.frames"
        arguments = ["simulate", ARCH, "--steps", "60", "--device", "host", "--checkpoint", "7", "--quiet"]
        self.outputs(*arguments, "-o", whole)
        kills = 0
        for wait in (0.15, 0.3, 0.5, 0.8):
            resume = ["--resume"] if broken.exists() else []
            process = subprocess.Popen(
                [PROGRAM, *arguments, "-o", broken, *resume],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
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
            self.bad(
                "was simulated with other settings",
                "simulate",
                ARCH,
                "--device",
                "host",
                "-o",
                broken,
                "--resume",
                *other,
            )
        self.bad("broken.frames", "simulate", ARCH, "--device", "host", "-o", broken)
        self.bad("broken.frames", "simulate", "arch", "--device", "host", "-o", broken, "--resume")
        self.assertEqual(broken.read_bytes(), whole.read_bytes())

    def path_of(self, scene, steps, *settings):
        """Position of a block in the middle of its last step; settings are the defaults unless given."""
        file = self.work / "path.frames"
        for left in self.work.glob("path.frames*"):
            left.unlink()
        self.simulate(f"block:{scene}", "--steps", steps, "-o", file, *settings)
        return poses(file, 1)[-1][0]

    def test_a_sliding_block_stops_at_the_known_position(self):
        for friction in (0.2, 0.5):
            expected = 2 * 2 / (2 * friction * 9.82)
            self.assertAlmostEqual(
                self.path_of(f"speed=2,friction={friction}", 150)[0], expected, delta=0.005 * expected
            )

    def test_a_block_slides_down_a_slope_by_the_known_distance(self):
        """Gravity and friction cancel to a hundredth. With the solver tolerance for the paper's scenes, a light
        block slides a tenth too far; without surface normals, a block sticks."""
        expected = (
            0.5 * 9.82 * (math.sin(math.radians(27)) - 0.5 * math.cos(math.radians(27))) * (199.5 * 0.01) ** 2
        )
        for size in (0.05, 0.125, 0.3, 0.5, 1, 20):
            self.assertAlmostEqual(
                self.path_of(f"slope=27,friction=0.5,size={size}", 200)[0],
                expected,
                delta=0.02 * expected,
                msg=size,
            )
        early = self.path_of(
            "slope=27,friction=0.5,size=0.125",
            200,
            "--dynamics",
            "absolute_tolerance=0.01",
            "--dynamics",
            "iterations=150",
        )[0]
        self.assertGreater(early, 1.1 * expected)
        self.assertLess(
            self.path_of("slope=27,friction=0.5", 200, "--dynamics", "surface_normals=0")[0], 0.1 * expected
        )

    def test_a_block_slides_as_far_in_either_body_order(self):
        """On a rotated ground with body number 1, so nothing is aligned with the axes; without surface normals it
        sticks."""
        tilt, scene = math.radians(27), self.work / "tilted.json"
        down, up = (math.cos(tilt), -math.sin(tilt), 0), (math.sin(tilt), math.cos(tilt), 0)
        expected = 0.5 * 9.82 * (math.sin(tilt) - 0.5 * math.cos(tilt)) * (199.5 * 0.01) ** 2

        def along(size, *settings):
            turned = [math.cos(tilt / 2), 0, 0, -math.sin(tilt / 2)]
            block = {"mesh": "cube", "rotation": turned, "position": [0.5 * size * x for x in up]}
            ground = {"mesh": "ground", "fixed": True, "rotation": turned, "position": [-0.5 * x for x in up]}
            scene.write_text(
                json.dumps(
                    {
                        "name": "tilted",
                        "meshes": {
                            "cube": {"box": [size] * 3},
                            "ground": {"box": [100 * size, 1, 100 * size]},
                        },
                        "bodies": [block, ground],
                        "dynamics": {
                            "gravity": [0, -9.82, 0],
                            "materials": {"stone": 1000},
                            "surfaces": [{"a": "stone", "b": "stone", "friction": 0.5, "restitution": 0}],
                        },
                    }
                )
            )
            file = self.work / "tilted.frames"
            for left in self.work.glob("tilted.frames*"):
                left.unlink()
            self.simulate(scene, "--steps", 200, "-o", file, *settings)
            frames = poses(file, 1)
            return sum(d * (b - a) for d, a, b in zip(down, frames[0][0], frames[-1][0]))

        for size in (0.05, 0.3, 1):
            self.assertAlmostEqual(along(size), expected, delta=0.02 * expected, msg=size)
        self.assertLess(
            along(0.05, "--dynamics", "surface_normals=0", "--dynamics", "contact_layer=0"), 0.5 * expected
        )

    def test_a_falling_block_ends_on_the_ground(self):
        sunk = 0.5 - self.path_of("drop=1", 200)[1]
        self.assertTrue(0 <= sunk <= 0.00101, sunk)  # the tolerance is 0.001 of its size
        self.assertGreater(0.5 - self.path_of("drop=1", 200, "--dynamics", "post_stabilize=0")[1], 0.01)

    def test_block_at_rest_stays(self):
        file = self.work / "rest.frames"
        self.simulate("block", "--steps", 500, "-o", file)
        frames = poses(file, 1)
        drift = max(abs(a - b) for frame in frames for a, b in zip(frame[0][:3], frames[0][0][:3]))
        self.assertEqual(len(frames), 500)
        self.assertLess(drift, 1e-3)

    def test_arch_stands_and_falls(self):
        def lost(scene):
            record = self.work / "simulation-arch.jsonl"
            record.unlink(missing_ok=True)
            self.simulate(scene, "--steps", 150, "--record", record)
            steps, _ = self.lines(record)
            return 1 - steps[-1]["energy_j"]["potential"] / steps[0]["energy_j"]["potential"]

        self.assertLess(lost("arch"), 1e-3)
        self.assertGreater(lost("arch:keystone=0"), 0.05)

    def test_touching_stones_stay_in_place(self):
        """With the least translation of certainly intersecting pairs; the paper's rule pushes them a metre
        sideways."""

        def deepest(*settings):
            record = self.work / "simulation-stones.jsonl"
            record.unlink(missing_ok=True)
            self.simulate("colosseum:slices=6,layers=1", "--steps", 20, "--record", record, *settings)
            steps, runs = self.lines(record)
            return max(step["deepest_m"] for step in steps), runs[0]["settings"]

        depth, settings = deepest()
        self.assertEqual((settings["contact_rule"], settings["decision"]), ("sat", "recheck"))
        self.assertLess(depth, 0.005)
        depth, settings = deepest("--set", "contact_rule=opposing", "--set", "decision=fp32")
        self.assertEqual((settings["contact_rule"], settings["decision"]), ("opposing", "fp32"))
        self.assertGreater(depth, 0.5)

    def test_divergence_is_reported(self):
        record, file = self.work / "simulation-bad.jsonl", self.work / "bad.frames"
        self.bad(
            ["step ", "body ", "J"],
            "simulate",
            "tower:segments=1,slices=3",
            "--device",
            "host",
            "--steps",
            200,
            "-o",
            file,
            "--record",
            record,
            "--dynamics",
            "adaptive_tolerance=0",
            "--dynamics",
            "step=0.1",
        )
        steps, runs = self.lines(record)
        self.assertEqual((runs[0]["status"], runs[0]["steps"]), ("failed", len(steps)))
        self.assertIn("step", runs[0]["failure"])
        self.assertGreater(len(steps), 0)
        status, text, errors = tandem("export", file, "--frames", "0", "--glb", self.work / "bad.glb")
        self.assertEqual((status, errors), (0, []), text)

    def test_pictures_show_the_recording(self):
        frames, out = self.work / "pictured.frames", self.work / "new" / "arch"
        text = self.simulate("tower:segments=1,slices=3", "--steps", 40, "-o", frames, "--pictures", out)
        paths = [f"{out}-{i}.png" for i in range(3)]
        self.assertEqual(text.splitlines()[-3:], paths)
        glb = self.work / "pictured.glb"
        self.assertEqual(tandem("export", frames, "--frames", "0:39", "--glb", glb)[0], 0)
        drawn = subprocess.run(
            [SOURCE / "scripts/render", glb, self.work / "drawn"], capture_output=True, text=True
        )
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        pictures = [open(path, "rb").read() for path in paths]
        for which in (0, 2):  # between two keys a viewer may be half a step off
            self.assertEqual(pictures[which], (self.work / f"drawn-{which}.png").read_bytes())
        self.assertEqual(len(set(pictures)), 3, "it moves")
        environment = {**os.environ, "TMPDIR": str(self.work / "absent")}
        done = subprocess.run(
            [
                PROGRAM,
                "simulate",
                "block",
                "--steps",
                "1",
                "--device",
                "host",
                "-o",
                self.work / "p.frames",
                "--pictures",
                out,
            ],
            env=environment,
            capture_output=True,
            text=True,
        )
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertIn("set TMPDIR", done.stderr)
        self.assertTrue((self.work / "p.frames").exists(), "what was simulated stays")

    def test_bad_use(self):
        for expected, *arguments in (
            ("no scene",),
            ("scripted; measure it with 'tandem run'", "plates"),
            ("unknown scene 'arc'; the nearest is 'arch'", "arc"),
            ("unknown setting of dynamics 'stop'; the nearest is 'step'", "arch", "--dynamics", "stop=1"),
            ("dynamics step=0 is impossible; give a number from 1e-09 to 10", "arch", "--dynamics", "step=0"),
            ("dynamics step=-1 is impossible", "arch", "--dynamics", "step=-1"),
            ("dynamics step=nan is impossible", "arch", "--dynamics", "step=nan"),
            (
                "dynamics method=newton is impossible; give gauss_seidel or jacobi",
                "arch",
                "--dynamics",
                "method=newton",
            ),
            ("dynamics bounce=2 is impossible; give 0 or 1", "arch", "--dynamics", "bounce=2"),
            (
                "dynamics surface_normals=yes is impossible; give 0 or 1",
                "arch",
                "--dynamics",
                "surface_normals=yes",
            ),
            (
                "dynamics contact_layer=0.2 is impossible; give a number from 0 to 0.1",
                "arch",
                "--dynamics",
                "contact_layer=0.2",
            ),
            ("dynamics step has no value", "arch", "--dynamics", "step"),
            ("unknown setting of dynamics 'papr'; the nearest is 'paper'", "arch", "--dynamics", "papr"),
            ("asks for 2 cells", "arch", "--set", "k=8,18"),
            ("a simulation needs contacts", "arch", "--set", "output=count"),
            ("--resume requires -o FILE", "arch", "--resume"),
            ("--pictures requires -o FILE", "arch", "--pictures", "x"),
            (
                "--pictures: cannot make /proc/x",
                "arch",
                "-o",
                self.work / "none.frames",
                "--pictures",
                "/proc/x/y",
            ),
            ("absent", "arch", "-o", "/absent/x.frames"),
            ("absent", "arch", "--record", "/absent/x.jsonl"),
            ("--steps", "arch", "--steps", "0"),
        ):
            self.bad(expected, "simulate", *arguments, "--device", "host")
        self.assertEqual(os.path.exists("/absent"), False)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=2)
