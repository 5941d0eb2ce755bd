# SPDX-License-Identifier: MIT
# test: cost=2
"""Simulations and frames of 'tandem paper' that are composed of two
measurements, and the notes of tables that say how near they are to what was measured whole."""

import pathlib
import tempfile
import unittest


from tests.paper import records as made
from tandem.paper import claims, comparison_tables, simulation_tables
from tandem.paper.folder import Folder
from tandem.paper.measures import Declared
from tandem.paper.quantities import weights_of
from tandem.paper.rules import AGREES, DIFFERS, UNTESTED

SCALE = 10**9


class Compositions(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-compositions")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0

    def folder(self, files):
        self.count += 1
        return Folder(made.write_folder(self.work / str(self.count), files))

    def test_a_simulation_is_composed_of_its_recording_and_its_frames(self):
        """Stages and frames are those of the cell, the solver that of the simulation, in the steps that both have."""
        wanted = {"algorithm": "chunked", "preset": "published", "k": "8", "residency": "published"}

        def files(contacts=1, real_ns=6_250_000):
            cell = made.record("funnel", wanted, 1)
            made.set_quantity(cell, "stages:traverse", [made.FULL_STEPS * 7000])
            made.set_quantity(cell, "frame", [10**6 * made.FULL_STEPS])
            cell["frames"] = {"first": 20, "last": 49}
            steps = [
                made.step(
                    i, contacts_found=contacts, stages={"traverse": 1}, host={"solve": 10**6 + i, "move": 0}
                )
                for i in range(60)
            ]
            return {
                "steps-funnel": [cell],
                "solver-funnel": made.simulation("funnel", steps),
                "check-funnel": [cell],
                "serial-funnel": made.simulation(
                    "funnel",
                    [made.step(i, contacts_found=contacts, host={"step": real_ns}) for i in range(30)],
                ),
            }

        folder = self.folder(files())
        [run] = folder.compositions()
        self.assertEqual([step["step"] for step in run.steps], list(range(20, 50)))
        self.assertAlmostEqual(run.host("step"), sum(1e-3 + 3e-3 + 1e-9 * i for i in range(20, 50)))
        self.assertEqual(run.curve("stage:traverse"), [7e-6] * 30)
        table = simulation_tables.table3(folder)
        [row] = [row for row in table.rows if "composed" in row.get("data_path", "")]
        self.assertEqual(
            (row["steps"], row["data_path"]), ("30 of 20:49", "published, conversion serial, composed")
        )
        self.assertAlmostEqual(row["total_min"], 500 / 60 * run.host("step") / 30)
        self.assertIn(
            "In 10 steps of funnel, frames measured apart take 0.800 times as long", table.notes[-1]
        )
        self.assertNotIn(
            "measured apart take",
            simulation_tables.table3(
                self.folder({k: v for k, v in files().items() if k != "serial-funnel"})
            ).notes[-1],
        )
        other = self.folder(files(contacts=2))
        self.assertEqual(other.compositions(), [], "steps with other contacts")
        self.assertNotIn("measured apart take", " ".join(simulation_tables.table3(other).notes))

    def test_a_composition_needs_the_contacts_of_its_recording(self):
        """Up to a hundredth of all contacts, which one frame with exact touches may have."""

        def compositions(found):
            cell = made.record("funnel", {"algorithm": "chunked", "preset": "published", "k": "8"}, 1)
            cell["work"]["contacts"], cell["frames"] = [1000] * 30, {"first": 0, "last": 29}
            steps = [made.step(i, contacts_found=count) for i, count in enumerate(found)]
            return len(
                self.folder(
                    {"steps-funnel": [cell], "solver-funnel": made.simulation("funnel", steps)}
                ).compositions()
            )

        self.assertEqual(
            [compositions(found) for found in ([1040] + [1000] * 29, [1020] * 30, [1400] + [1000] * 29)],
            [1, 0, 0],
        )

    def test_frames_stand_for_the_steps_nearest_to_them(self):
        """Frames 20, 30 and 80 stand for 10, 30 and 50 of 90 steps."""
        self.assertEqual(
            [weights_of(frames) for frames in ([7], [20, 30, 40], [20, 30, 80])],
            [[1], [1, 1, 1], [3 * 20 / 180, 3 * 60 / 180, 3 * 100 / 180]],
        )
        wanted = {"algorithm": "chunked", "preset": "published", "k": "8", "residency": "published"}
        records = []
        for frame, ns in ((20, 10**6), (30, 2 * 10**6), (80, 3 * 10**6)):
            cell = made.record("funnel", wanted, 1)
            cell["key"] += str(frame)
            for name, scale in (("stages:traverse", ns), ("stages:contact", 10**6), ("frame", 10**7)):
                made.set_quantity(cell, name, [scale * made.FULL_STEPS])
            for times in (
                cell["total_ns"],
                *(stage[where] for stage in cell["stages"].values() for where in ("device_ns", "host_ns")),
            ):
                times["samples"] = [value / made.FULL_STEPS for value in times["samples"]]
                times["median"] /= made.FULL_STEPS
            cell["frames"] = {"first": frame, "last": frame}
            records.append(cell)
        steps = [
            made.step(
                i,
                contacts_found=1,
                host={"solve": 10**6 if i < 80 else 10**7, "assemble": 0, "reduce": 0, "move": 0},
            )
            for i in range(100)
        ]
        folder = self.folder({"steps-funnel": records, "solver-funnel": made.simulation("funnel", steps)})
        [run] = folder.compositions()
        self.assertAlmostEqual(run.stage("traverse"), 1e-3 * 3 * (20 * 1 + 60 * 2 + 100 * 3) / 180)
        self.assertAlmostEqual(run.host("solve"), 1e-3 * 3 * (20 + 60 + 10 * 100) / 180)
        fields = {one["id"]: one for one in claims.declared()}
        value = lambda name: (
            claims.line_of(
                Declared(fields[name] | {"covers": [20, 80]}), folder, "funnel", "8"
            ).measured.value
        )
        self.assertAlmostEqual(value("traversal-over-contact"), (20 * 1 + 60 * 2 + 100 * 3) / 180)
        self.assertAlmostEqual(value("collision-share"), 10 * 180 / (10 * 180 + 20 + 60 + 10 * 100))

    def test_frames_measured_whole_check_compositions(self):
        """A composed frame over the same frame that was measured with a whole array."""
        wanted = {"algorithm": "gproximity", "preset": "published-k40c", "k": "8"}

        def cell(scene, frame_ns, write_ns=0, batches=1):
            one = made.record(scene, wanted, 3)
            one["frames"] = {"first": 0, "last": 0}
            made.set_quantity(one, "frame", [frame_ns] * 3)
            made.set_quantity(one, "stages:write", [write_ns] * 3)
            one["work"]["body_pairs"] = [batches]
            return one

        files = {
            "gpus-tower": [cell("tower", SCALE, batches=4)],
            "whole-tower": [cell("tower", 10 * SCALE, batches=4)],
            "array-k40c": [cell("plates", 2 * SCALE, write_ns=2 * SCALE)],
        }
        self.assertIn("measured whole: tower 0.900.", comparison_tables.table4(self.folder(files)).notes[-1])
        del files["array-k40c"]
        self.assertNotIn("measured whole", comparison_tables.table4(self.folder(files)).notes[-1])

    def test_whole_steps_have_the_solver_on_both_sides(self):
        """An upload of 100 ms for each of 500 frames, frames of 1 ms and a solver of 1 ms: (1 + 100 + 1) / (1
        + 1). Steps without the frames, or with other contacts, judge nothing."""
        fields = {one["id"]: one for one in claims.declared()}["total"]

        def line(solve_ns=10**6 - 3, contacts=1, steps=made.FULL_STEPS):
            cell = lambda side, k="8": made.record("funnel", Declared(fields).wanted(fields[side], k), 3)
            other, own, array = cell("above"), cell("below"), cell("array")
            array["scene"] = {**array["scene"], "digest": "other frames"}
            for one in (other, own):
                made.set_quantity(one, "frame", [10**6 * made.FULL_STEPS] * 3)
            made.set_quantity(array, "stages:write", [10**8 * made.FULL_STEPS] * 3)
            run = [
                made.step(
                    i,
                    contacts_found=contacts,
                    host={"solve": solve_ns, "assemble": 1, "move": 1, "reduce": 1},
                )
                for i in range(steps)
            ]
            files = {
                "cells-funnel": [other, own],
                "array": [array],
                "solver-funnel": made.simulation("funnel", run),
            }
            return claims.line_of(Declared(fields), self.folder(files), "funnel", "8")

        self.assertAlmostEqual(line().measured.value, 51)
        self.assertEqual([line().verdict, line(solve_ns=10**9).verdict], [AGREES, AGREES])
        self.assertEqual(line().reason, "provisional: no record says what else ran beside the solver")
        for found, reason in (
            (line(contacts=2), "contacts differ"),
            (line(steps=60), "not all of the measured frames"),
        ):
            self.assertEqual((found.verdict, reason in found.reason), (UNTESTED, True), found.reason)

    def test_back_ends_are_compared_on_one_device(self):
        """gProximity takes 3 times as long with OpenCL and twice as long with CUDA: 1.5."""
        fields = {one["id"]: one for one in claims.declared()}["opencl-and-cuda"]

        def line(opencl=3, cuda=2, device="GPU", backends=("opencl", "cuda")):
            records = []
            for backend in backends:
                for side, scale in (("above", {"opencl": opencl, "cuda": cuda}[backend]), ("below", 1)):
                    one = made.record("plates", Declared(fields).wanted(fields[side], "8"), 3)
                    one["key"] += backend
                    one["devices"] = [
                        {**one["devices"][0], "id": f"{backend}:0"}
                        | ({"name": device} if backend == "opencl" else {})
                    ]
                    made.set_quantity(one, "frame", [scale * SCALE] * 3)
                    records.append(one)
            return claims.line_of(Declared(fields), self.folder({"backends": records}), "plates", "8")

        self.assertEqual((line().verdict, round(line().measured.value, 9)), (AGREES, 1.5))
        self.assertEqual([line(opencl=9).verdict, line(cuda=9).verdict], [DIFFERS, DIFFERS])
        for found in (line(device="processor"), line(backends=("cuda",)), line(backends=("opencl",))):
            self.assertEqual(
                (found.verdict, found.reason), (UNTESTED, "one back end of this device was measured")
            )

    def test_a_table_names_deep_overlaps_and_steps_without_convergence(self):
        steps = [made.step(i, deepest_m=0.1 * i, iterations=150 if i % 2 else 7) for i in range(10)]
        run = made.simulation("funnel", steps)
        run[-1]["dynamics"] = {"iterations": "150"}
        [note] = [
            text
            for text in simulation_tables.table3(self.folder({"solver-funnel": run})).notes
            if "Deepest" in text
        ]
        self.assertEqual(
            note,
            "Deepest overlap, and steps whose solver reached its limit of passes: solver-funnel 0.900 m, 5 of 10.",
        )
        run[-1]["dynamics"] = {"iterations": "200"}
        self.assertIn(
            "0 of 10", " ".join(simulation_tables.table3(self.folder({"solver-funnel": run})).notes)
        )
