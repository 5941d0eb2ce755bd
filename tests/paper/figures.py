# SPDX-License-Identifier: MIT
# test: cost=8
"""Figures of 'tandem paper' say and draw what the records have: composed uploads, seconds of the largest costs, all
thresholds, means of the same scene, and only the pictures that there are."""

import os
import pathlib
import tempfile
import unittest

os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
import matplotlib.image
import numpy

from tests.paper import records as made
from tandem.paper import figures, pictures, simulation_figures, sweep_figures
from tandem.paper.folder import Folder
from tandem.paper.tables import simulations

PUBLISHED = {"algorithm": "gproximity", "preset": "published", "k": "8"}
SIMULATIONS = ("sim-funnel", "solver-funnel")
MS = made.FULL_STEPS * 10**6  # nanoseconds of all frames, if each takes a millisecond


class Figures(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-figures")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0

    def folder(self, files):
        self.count += 1
        return Folder(made.write_folder(self.work / str(self.count), files))

    def gproximity(self, scene, batches=1):
        """Frames that write for 1 ms and traverse for 2 ms, beside a whole array that takes 97 ms for each batch."""
        cell, array = made.record(scene, PUBLISHED, 3), made.record("plates", PUBLISHED, 3)
        array["settings"]["queue_bytes"] = "device"
        cell["settings"]["queue_bytes"] = str(4 * 2**20)
        cell["kernel_times"]["traverse"] = {"launches": 10 * made.FULL_STEPS}
        cell["work"]["body_pairs"] = [batches] * made.FULL_STEPS
        made.set_quantity(cell, "stages:write", [MS] * 3)
        made.set_quantity(cell, "stages:traverse", [2 * MS] * 3)
        made.set_quantity(array, "stages:write", [97 * MS] * 3)
        return {f"cells-{scene}": [cell], "array": [array]}

    def test_write_has_the_upload_of_the_whole_array(self):
        """98 of 100 ms a batch, as the verdict has it; without a whole array, or without batches, 1 of 3 ms."""
        files = self.gproximity("funnel")
        for make in (figures.figure7, figures.figure8):
            figure = make(self.folder(files))
            self.assertIn("with its whole queue array, composed: write takes 98", figure.title)
            bounded = make(self.folder({"cells-funnel": files["cells-funnel"]}))
            self.assertIn("with a bounded queue array", bounded.title)
        write = lambda figure: [row for row in figure.rows if row["stage"] == "write"]
        ours = lambda files: write(figures.figure7(self.folder(files)))[0]
        self.assertAlmostEqual(ours(files)["ms_per_frame"], 98)
        self.assertIn("records/array.jsonl:1", ours(files)["records"])
        self.assertAlmostEqual(ours(self.gproximity("funnel", batches=3))["ms_per_frame"], 1 + 3 * 97)
        files["cells-funnel"][0]["work"]["body_pairs"] = None
        self.assertAlmostEqual(ours(files)["percent"], 100 / 3)
        self.assertIn("with a bounded queue array", figures.figure7(self.folder(files)).title)
        frames = write(figures.figure8(self.folder(self.gproximity("funnel", batches=2))))
        self.assertEqual({round(row["ms"], 6) for row in frames}, {1 + 2 * 97})

    def test_the_means_of_the_paper_are_marks_with_names(self):
        folder = self.folder(self.gproximity("funnel"))
        figures.figure8(folder)
        text = (folder.path / "figure8.svg").read_text()
        self.assertEqual(text.count(">write</text>"), 2, "a name in the legend and one beside the mean")
        self.assertEqual(len(set(figures.MARKERS.values())), len(figures.MARKERS))

    def test_costs_are_seconds_of_all_steps(self):
        """60 steps with 1 ms of each stage and more of reading; K40c: 15.64 minutes of traversal."""
        steps = [made.step(i, stages={"read": 10**8}) for i in range(60)]
        figure = simulation_figures.figure10(self.folder({"sim-funnel": made.simulation("funnel", steps)}))
        value = {(row["run"], row["cost"]): row["seconds"] for row in figure.rows}
        self.assertAlmostEqual(value["ours, GPU", "traverse"], 0.06)
        self.assertAlmostEqual(value["ours, GPU", "read"], 6)
        self.assertAlmostEqual(value["paper's K40c", "traverse"], 60 * 15.64)
        self.assertAlmostEqual(value["paper's K40c", "write"], 60 * 10.97)
        self.assertEqual(len({run for run, _ in value}), 5)

    def test_composed_costs_stand_for_all_steps_of_the_paper(self):
        cell = made.record("funnel", {"algorithm": "chunked", "preset": "published", "k": "8"}, 1)
        made.set_quantity(cell, "stages:traverse", [MS])
        cell["frames"] = {"first": 0, "last": 29}
        steps = [made.step(i, contacts_found=1) for i in range(60)]
        files = {"steps-funnel": [cell], **dict.fromkeys(SIMULATIONS, made.simulation("funnel", steps))}
        [row] = [
            row
            for row in simulation_figures.figure10(self.folder(files)).rows
            if row["run"].startswith("ours") and row["cost"] == "traverse"
        ]
        self.assertAlmostEqual(row["seconds"], 0.5)

    def test_costs_of_a_small_scene_are_drawn(self):
        """The six largest are those by share: half a second of the tower beside the paper's minutes of the funnel."""
        cell = made.record("tower", {"algorithm": "chunked", "preset": "published", "k": "8"}, 1)
        made.set_quantity(cell, "stages:preprocess", [MS])
        steps = [made.step(i, contacts_found=1) for i in range(made.FULL_STEPS)]
        runs = {
            f"{kind}-{scene}": made.simulation(scene, steps)
            for scene in ("funnel", "tower")
            for kind in ("sim", "solver")
        }
        folder = self.folder({"steps-tower": [cell], **runs})
        simulation_figures.figure10(folder)
        text = (folder.path / "figure10.svg").read_text()
        self.assertEqual(
            [name in text for name in (">preprocess<", ">others<", ">transform<")], [True, True, False]
        )

    def test_the_longest_simulation_is_shown(self):
        """Of equal ones that with the paper's solver, and each scene once."""
        steps = lambda count: made.simulation("funnel", [made.step(i) for i in range(count)])
        shown = lambda ours, theirs: [
            run.name for run in simulations(self.folder(dict(zip(SIMULATIONS, (steps(ours), steps(theirs))))))
        ]
        self.assertEqual(
            [shown(9, 9), shown(10, 9), shown(9, 10)], [["solver-funnel"], ["sim-funnel"], ["solver-funnel"]]
        )

    def test_contacts_over_steps_assert_nothing(self):
        steps = [made.step(i, contacts_found=10 * (i + 1)) for i in range(60)]
        title = simulation_figures.figure9(
            self.folder({"sim-funnel": made.simulation("funnel", steps)})
        ).title
        self.assertIn("fitted exponents: funnel", title)
        self.assertNotIn("grow", title)

    def test_thresholds_are_those_of_the_records(self):
        """0 leaves the choice to another setting, and is none."""
        cells = []
        for threshold in (0, 1, 1000, 10**9):
            wanted = {
                "algorithm": "chunked",
                "preset": "published",
                "k": "8",
                "seed_threshold": str(threshold),
            }
            cell = made.record("glasses", wanted, 3)
            made.set_quantity(cell, "frame", [MS * (threshold % 999 + 1)] * 3)
            cell["asked"] = {"seed_threshold": str(threshold)}
            cells.append(cell)
        figure = sweep_figures.figure13(self.folder({"thresholds": cells}))
        self.assertEqual([row["seed_threshold"] for row in figure.rows], [1, 1000, 10**9])
        self.assertIn(
            "of 1 to 1,000,000,000 on glasses; the least median: chunked published at 1", figure.title
        )
        self.assertIn("missing", sweep_figures.figure13(self.folder({"thresholds": cells[:1]})).rows[0])

    def picture(self, folder, name):
        (folder.path / "pictures").mkdir(exist_ok=True)
        matplotlib.image.imsave(folder.path / "pictures" / name, numpy.zeros((4, 4)))

    def test_contacts_of_jacks_are_beside_the_paper_s(self):
        """The mean over all steps of jacks, and never a number of another scene."""
        jacks = made.simulation("jacks", [made.step(i, contacts_kept=n) for i, n in enumerate((1000, 2000))])
        funnel = made.simulation("funnel", [made.step(0, contacts_kept=77777)])
        folder = self.folder({"sim-funnel": funnel, "solver-jacks": jacks})
        self.picture(folder, "funnel-100.png")
        self.assertIn(
            "1,500 contacts on average in 2 steps of our scene jacks; the paper: 550,000",
            pictures.figure1(folder).title,
        )
        other = self.folder({"sim-funnel": funnel})
        self.picture(other, "funnel-100.png")
        self.assertEqual(pictures.figure1(other).title, "Jacks that jam: funnel")

    def test_titles_name_the_pictures_that_there_are(self):
        folder = self.folder({})
        self.picture(folder, "funnel-50.png")
        self.picture(folder, "funnel-100.png")
        title = pictures.figure2(folder).title
        self.assertEqual(title, "Simulations of rigid bodies: funnel (no picture of colosseum)")
        self.picture(folder, "colosseum-0.png")
        self.assertEqual(pictures.figure2(folder).title, "Simulations of rigid bodies: funnel, colosseum")
