# SPDX-License-Identifier: MIT
# test: cost=10 full=20
"""'tandem simulate': motions with known results."""

import math

from tests.commands.simulations import SimulationCase, poses
from tests.program import write_json


class SimulatedMotion(SimulationCase):
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
            slid = self.path_of(f"speed=2,friction={friction}", 150)[0]
            self.assertAlmostEqual(slid, expected, delta=0.005 * expected)

    def test_a_block_slides_down_a_slope_by_the_known_distance(self):
        """Gravity and friction cancel to a hundredth. With the solver tolerance for the paper's scenes, a light
        block slides a tenth too far; without surface normals, a block sticks."""
        expected = (
            0.5 * 9.82 * (math.sin(math.radians(27)) - 0.5 * math.cos(math.radians(27))) * (199.5 * 0.01) ** 2
        )
        for size in (0.05, 0.125, 0.3, 0.5, 1, 20):
            slid = self.path_of(f"slope=27,friction=0.5,size={size}", 200)[0]
            self.assertAlmostEqual(slid, expected, delta=0.02 * expected, msg=size)
        paper = "--dynamics absolute_tolerance=0.01 --dynamics iterations=150"
        early = self.path_of("slope=27,friction=0.5,size=0.125", 200, paper)[0]
        self.assertGreater(early, 1.1 * expected)
        stuck = self.path_of("slope=27,friction=0.5", 200, "--dynamics surface_normals=0")[0]
        self.assertLess(stuck, 0.1 * expected)

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
            write_json(
                scene,
                name="tilted",
                meshes={"cube": {"box": [size] * 3}, "ground": {"box": [100 * size, 1, 100 * size]}},
                bodies=[block, ground],
                dynamics={
                    "gravity": [0, -9.82, 0],
                    "materials": {"stone": 1000},
                    "surfaces": [{"a": "stone", "b": "stone", "friction": 0.5, "restitution": 0}],
                },
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
