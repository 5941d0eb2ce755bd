# SPDX-License-Identifier: MIT
# test: cost=30 full=50
"""Pages of `tandem report` in Chromium. They load without errors or requests, show every cell, filter, sort,
fit a phone, and handle bad or very large input."""

import json
import lzma
import sys

from tests.program import LONG, SOURCE, cells_of, tandem
from tests.report.case import RECORDS, SIMULATIONS, ReportCase, Shown

from tandem.report.cells import COLUMNS
from tandem.report.reading import MAX_CELLS

MANY = 3000 if LONG else 600  # cells of a long table
MARKUP = "<img src=x onerror=\"document.title='run'\"> & </script>"
NAMES = [column.name for column in COLUMNS]
WIDE = """document.querySelectorAll('details').forEach(one => one.open = true);
[...document.querySelectorAll('.scrolls')].filter(box => box.scrollWidth > box.clientWidth)
  .map(box => [box.closest('figure, section[id]').id, box.scrollWidth, box.clientWidth])"""
FIGURES = {"overview", "sweeps", "stages", "curves", "error", "roofline", "simulations"}
EMPTY = """[...document.querySelectorAll('figure')].filter(f => !f.querySelector('h3').textContent || !f.querySelector('tbody tr')
  || f.querySelector('canvas').getAttribute('aria-label').length < 40
  || !f.querySelector('canvas').getContext('2d').getImageData(0, 0, 500, 300).data.some(b => b)).map(f => f.id)"""


def of_column(rows, name):
    """Values of a column of the table of cells."""
    return [row[NAMES.index(name)] for row in rows if len(row) == len(NAMES)]


class Pages(ReportCase):
    def made_up(self, count):
        """`count` cells: several sizes of the committed scenes with the settings of the committed cells."""
        for i in range(count):
            copy, record = i // len(self.plan), dict(self.plan[i % len(self.plan)])
            scene = record["scene"]
            own = {"key": f"{scene['key']},copy={copy}", "digest": f"{copy:08x}{scene['digest'][:8]}"}
            yield record | {"scene": scene | own, "key": f"{record['key']}|copy={copy}"}

    def column(self, name):
        return self.texts(f".sorts tbody:not([hidden]) tr:first-child td:nth-child({NAMES.index(name) + 1})")

    def sort_by(self, name):
        place = NAMES.index(name)
        self.browser.run(f"document.querySelectorAll('.sorts th button')[{place}].click()")
        states = self.browser.run("[...document.querySelectorAll('.sorts th')].map(th => th.ariaSort)")
        self.assertEqual({state for i, state in enumerate(states) if i != place}, {"none"})
        return states[place]

    def type(self, text):
        self.choose("cells", "words", text, "input")
        return self.text("#cells [role=status]")

    def test_all_committed_records(self):
        simulations = (SIMULATIONS / f"solver-{name}.jsonl.xz" for name in ("colosseum", "funnel"))
        cells = (
            RECORDS / "plan.jsonl",
            RECORDS / "paper/records/thresholds.jsonl",
            SOURCE / "tests/records/accuracy.jsonl",
        )
        others = RECORDS / "profile.jsonl", SOURCE / "tests/records/ceilings.jsonl"
        shown = self.shown(*cells, *others, *simulations, "--scene", "plates", "--frames", "20:23")
        keys = {record["key"] for path in cells for record in cells_of(path.read_text())}
        self.assertEqual(len(of_column(shown.rows, "cell")), len(keys))  # one of each continued cell
        figures = self.browser.run("[...document.querySelectorAll('figure')].map(figure => figure.id)")
        self.assertEqual(set(figures), FIGURES)
        self.assertEqual(self.browser.run(EMPTY), [])
        before = self.text("#stages h3")
        self.choose("stages", "comparison", "1")
        self.assertNotEqual(self.text("#stages h3"), before)
        self.browser.run("document.getElementById('view').scrollIntoView()")
        self.browser.until("Boolean(tandem.sceneView)")
        self.check_colours_and_print()
        self.assertEqual(self.browser.problems(), [])

    def check_colours_and_print(self):
        ground = "getComputedStyle(document.body).backgroundColor"
        light = self.browser.run(ground)
        self.browser.dark(True)
        self.assertNotEqual(self.browser.run(ground), light)
        self.browser.ask("Emulation.setEmulatedMedia", media="print")
        shown = "[...document.querySelectorAll('{}')].map(one => one.getClientRects().length > 0)"
        self.assertEqual(set(self.browser.run(shown.format(".controls"))), {False})
        self.assertEqual(set(self.browser.run(shown.format("figure canvas"))), {True})
        self.browser.ask("Emulation.setEmulatedMedia", media="")

    def test_tables_fit_1400_pixels_and_are_cards_on_a_phone(self):
        own = [SOURCE / f"tests/records/{name}.jsonl" for name in ("accuracy", "ceilings")]
        page = self.report(
            RECORDS / "plan.jsonl", RECORDS / "profile.jsonl", *own, "--scene", "plates", "--frames", 20
        )
        field = "getComputedStyle(document.querySelector('.sorts td:nth-child(2)'), '{}').{}"
        for width, display, content in ((1400, "table-cell", "none"), (390, "block", '"ms per frame"')):
            self.browser.size(width, 844, mobile=width < 500)
            self.opened(page)
            self.browser.run("new Promise(done => setTimeout(done, 500))")
            self.assertEqual(self.browser.run(WIDE), [])
            self.assertEqual(self.browser.run("document.documentElement.scrollWidth"), width)
            self.assertEqual(self.browser.run(field.format("", "display")), display)
            self.assertEqual(self.browser.run(field.format("::before", "content")), content)
        self.assertEqual(self.sort_by("ms per frame"), "ascending")

    def test_many_cells_are_sorted_and_filtered(self):
        records = list(self.made_up(MANY))
        page = self.report(
            self.write("many.jsonl", records), "--scene", "plates", "--frames", "0:99" if LONG else "0:9"
        )
        seconds = self.opened(page)
        print(
            f"\n  {MANY} cells and a scene: {page.stat().st_size / 1e6:.1f} MB, {seconds:.2f} s",
            file=sys.stderr,
        )
        self.assertEqual(len(self.column("cell")), MANY)
        for name, value in (("ms per frame", lambda text: float(text.replace(",", ""))), ("method", str)):
            self.assertEqual(self.sort_by(name), "ascending")
            rising = [value(text) for text in self.column(name)]
            self.assertTrue(rising == sorted(rising), rising[:20])  # differences of long lists take minutes
            self.assertEqual(self.sort_by(name), "descending")
            self.assertTrue([value(text) for text in self.column(name)] == sorted(rising, reverse=True))
        tiled = [record["settings"]["k"] for record in records if record["algorithm"] == "tiled"]
        self.assertEqual(self.type("tiled"), f"{len(tiled)} of {MANY} rows")
        self.assertEqual(set(self.column("method")), {"tiled"})
        self.assertEqual(self.type("TILED k=8"), f"{tiled.count('8')} of {MANY} rows")
        self.assertEqual(self.type("nothing has this"), f"0 of {MANY} rows")
        self.type("")
        self.choose("cells", "method", "gProximity")
        self.assertEqual(set(self.column("method")), {"gProximity"})
        more = "[...document.querySelectorAll('.more')].filter(row => row.getClientRects().length).map(row => row.textContent)"
        self.assertEqual(self.browser.run(more), [])
        self.browser.run("document.querySelector('.sorts tbody:not([hidden]) summary').click()")
        [details] = self.browser.run(more)
        self.assertIn("--resume --out plan.jsonl", details)

    def test_failed_wrong_and_markup(self):
        find = lambda algorithm: next(one for one in self.plan if one["algorithm"] == algorithm)
        last = find("tiled")
        failed, wrong, older, named = (
            json.loads(json.dumps(one))
            for one in (find("leaf_query"), find("chunked"), last, find("gproximity"))
        )
        times = {"samples": [], "rounds": [], "frames": []}
        failed.update(status="failed", failure=f"no memory {MARKUP}", total_ns=times)
        wrong["status"] = "wrong"
        wrong["total_ns"]["samples"] = [1] * len(wrong["total_ns"]["samples"])  # faster than all others
        named["scene"]["key"], named["key"] = MARKUP, MARKUP
        older["session"] = "an earlier one"  # in the same session it would be a copy, which is omitted
        shown = self.shown(self.write("bad.jsonl", [failed, wrong, older, last, named]))
        self.assertEqual(
            sorted(of_column(shown.rows, "status")),
            sorted(["failed", "wrong", "ok, recorded again", "ok", "ok"]),
        )
        self.assertIn("Not all right3 cells of 5 are right: ", shown.words)
        self.assertIn("paper's schedule is wrong: its answer is not the reference's.", shown.words)
        self.assertIn("leaf queries failed: no memory <img", shown.words)
        ranked = [one[0] for group in shown.json()["groups"] for one in group["ranked"]]
        self.assertEqual(sorted(ranked), [3, 4])
        self.assertEqual(
            (self.browser.run("document.title"), "img" in shown.tags), ("Report of tandem", False)
        )
        self.assertIn(MARKUP, shown.words)

    def test_against_equals_compare(self):
        """The summary, the chart and each cell give the result of tandem compare, in ms per frame."""
        old, new = RECORDS / "paper/records/thresholds.jsonl", self.work / "new.jsonl"
        records = [record for record in map(json.loads, old.read_text().splitlines()) if "key" in record]
        for i, record in enumerate(records):
            record["session"] = "0" * 16
            if i % 3 == 0 and record["status"] == "ok":
                total = record["total_ns"]
                total["samples"] = [round(1.1 * ns) for ns in total["samples"]]
                total.update({name: 1.1 * total[name] for name in ("median", "low", "high")})
        shown = self.shown(self.write("new.jsonl", records), "--against", old)
        compared, data = json.loads(tandem("compare", old, new, "--format", "json")[1]), shown.json()
        cells = data["differences"]["cells"]
        self.assertIn(compared["summary"], self.text("#differences-title"))
        self.assertEqual(self.text("#results .lead"), self.text("#differences-title"))
        self.assertIn("new.jsonl, against thresholds.jsonl. ", self.text("#made"))
        self.assertEqual([cell["label"] for cell in cells], [cell["label"] for cell in compared["cells"]])
        for own, other in zip(cells, compared["cells"]):
            for value, name in zip(own["ratio"], ("ratio", "low", "high")):
                expected = other["times"][name]
                self.assertAlmostEqual(value or 0, expected or 0, delta=1e-5 * (expected or 0))
            self.assertAlmostEqual(own["new"], data["cells"][own["cell"]]["ms"][0], delta=0.02 * own["new"])
        slowest = max(cells, key=lambda cell: cell["ratio"][0])
        own = f"comparison{slowest['against']}"
        details = next(row[0] for row in shown.rows if len(row) == 1 and own in row[0])
        expected = rf"comparison1\.1\d* times the time in thresholds\.jsonl: {slowest['verdict']}conditions"
        self.assertRegex(details, expected, "three rounds have no interval")
        self.bad("two sets of records", "report", old, new, "--against", old)

    def test_bad_files(self):
        page, good = self.work / "none.html", self.write("good.jsonl", self.plan[:1])
        profile = json.loads((RECORDS / "profile.jsonl").read_text().splitlines()[0])
        (self.work / "empty.jsonl").write_text("")
        (self.work / "text.jsonl").write_text("no record\n")
        (self.work / "cut.jsonl.xz").write_bytes(lzma.compress((RECORDS / "plan.jsonl").read_bytes())[:1000])
        self.write("other.jsonl", [self.plan[0] | {"schema": 5}])
        self.write("profile.jsonl", [profile | {"schema": 7}])
        for name, error in (
            ("empty.jsonl", "empty.jsonl: is empty"),
            ("other.jsonl", ["other.jsonl:1:", "schema 5"]),
            ("text.jsonl", "text.jsonl:1: is not JSON"),
            ("cut.jsonl.xz", "cut.jsonl.xz: cannot be read"),
            ("nowhere.jsonl", "cannot be read"),
            ("profile.jsonl", "schema 7"),
        ):
            self.bad(error, "report", self.work / name, "-o", page)
        self.assertFalse(page.exists())
        self.bad("nowhere", "report", good, "-o", self.work / "nowhere/page.html")
        self.bad("is a folder", "report", good, "-o", self.work)
        self.bad("unknown scene", "view", "plate", "-o", page)

    def test_more_cells_than_a_page_shows(self):
        count = 20_000 if LONG else MAX_CELLS + 100
        left_out = ("conditions", "breakdown_ns", "device_span_ns", "stages")
        record = {name: value for name, value in self.plan[0].items() if name not in left_out}
        record["total_ns"] = {
            "samples": [9, 8],
            "rounds": [0, 1],
            "median": 8.5,
            "low": 8,
            "high": 9,
            "frames": [],
        }
        keys = [f"pile:number={i}" for i in range(count)]
        path = self.write(
            "long.jsonl", (record | {"key": key, "scene": record["scene"] | {"key": key}} for key in keys)
        )
        shown = Shown(self.report(path, notes=1).read_text())
        self.assertIn(f"{count - MAX_CELLS} of {count} records of cells are left out", shown.words)
        self.assertEqual(len(of_column(shown.rows, "cell")), MAX_CELLS)
        self.assertEqual(len(shown.json()["cells"]), MAX_CELLS)
