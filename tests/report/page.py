# SPDX-License-Identifier: MIT
# test: cost=30 full=50
"""Pages of `tandem report` and `tandem view` in Chromium. They load without
errors or requests, show every cell, filter, sort, rotate the scene, fit a phone, and handle bad or very large
input."""

import json
import lzma
import sys
import time

from tests.program import LONG, SOURCE, tandem
from tests.report.case import RECORDS, ReportCase

MANY = 3000 if LONG else 600  # cells of a long table
MAX_CELLS = 6000  # of a page
MARKUP = "<img src=x onerror=document.title='run'></script><script>document.title='run'</script>"
ROWS = "[...document.querySelectorAll('#cell-table tbody tr')]"
# The distinct pixels of the scene, as the beginning of a script.
PIXELS = (
    "(() => { const c = document.getElementById('scene-canvas'), g = c.getContext('webgl2') || c.getContext('webgl'), p = new Uint8Array(4 * c.width * c.height); "
    "tandem.sceneView.draw(); g.readPixels(0, 0, c.width, c.height, g.RGBA, g.UNSIGNED_BYTE, p); const pixels = [...new Set(new Uint32Array(p.buffer))]; return "
)
# The number of distinct hues, of 36, among these pixels.
HUES = (
    PIXELS
    + "new Set(pixels.map(p => new THREE.Color(`rgb(${p & 255},${p >> 8 & 255},${p >> 16 & 255})`).getHSL({})).filter(c => c.s > 0.5)"
    ".map(c => Math.floor(c.h * 36))).size; })()"
)
CAMERA = "tandem.sceneView.camera.position.toArray().map(x => x.toFixed(4)).join()"


class Pages(ReportCase):
    def made_up(self, count):
        """`count` cells: several sizes of the committed scenes with the settings of the committed cells."""
        for i in range(count):
            record = dict(self.plan[i % len(self.plan)])
            copy = i // len(self.plan)
            record["scene"] = {
                **record["scene"],
                "key": f"{record['scene']['key']},copy={copy}",
                "digest": f"{copy:08x}{record['scene']['digest'][:8]}",
            }
            record["key"] += f"|copy={copy}"
            yield record

    def column(self, name):
        place = self.browser.run("tandem.cellColumns.map(column => column.name)").index(name)
        return self.browser.run(f"{ROWS}.map(row => row.children[{place}].textContent)")

    def sort_by(self, name):
        self.browser.run(
            f"[...document.querySelectorAll('#cell-table th button')].find(b => b.textContent === {json.dumps(name)}).click()"
        )
        self.browser.until("document.querySelector('#cell-table tbody').dataset.complete === 'true'")
        return self.browser.run(
            "[...document.querySelectorAll('#cell-table th')].map(th => th.getAttribute('aria-sort')).filter(s => s !== 'none').join()"
        )

    def type(self, text):
        self.browser.run(
            f"(() => {{ const box = document.getElementById('cell-filter'); box.value = {json.dumps(text)}; box.dispatchEvent(new Event('input')); }})()"
        )
        self.browser.until("document.querySelector('#cell-table tbody').dataset.complete === 'true'")
        return self.browser.run("document.getElementById('cell-count').textContent")

    def test_all_committed_records(self):
        simulations = (RECORDS / f"paper/records/sim-{name}.jsonl" for name in ("colosseum", "funnel"))
        cells = RECORDS / "plan.jsonl", RECORDS / "slabs.jsonl", SOURCE / "tests/records/accuracy.jsonl"
        page = self.report(
            *(*cells, RECORDS / "profile.jsonl", RECORDS / "ceilings.jsonl", *simulations),
            "--scene",
            "plates",
            "--frames",
            "20:23",
            "--contacts",
        )
        self.opened(page)
        count = sum(len(path.read_text().splitlines()) for path in cells)
        self.assertEqual(self.browser.run(f"{ROWS}.length"), count)
        self.check_charts()
        self.check_scene()
        self.check_sizes_and_colours()
        self.assertEqual(self.browser.problems(), [])

    def check_charts(self):
        figures = self.browser.run("[...document.querySelectorAll('figure')].map(figure => figure.id)")
        self.assertEqual(
            set(figures), {"medians", "sweeps", "stages", "curves", "error", "roofline", "simulations"}
        )
        for figure in figures:
            self.browser.run(f"document.getElementById('{figure}').scrollIntoView()")
            self.browser.until(f"document.getElementById('{figure}').dataset.drawn === 'true'")
        empty = (
            "[...document.querySelectorAll('figure')].filter(f => !f.querySelector('h3').textContent || !f.querySelector('tbody tr') || "
            "f.querySelector('canvas').getAttribute('aria-label').length < 40).map(f => f.id)"
        )
        self.assertEqual(self.browser.run(empty), [])
        blank = "[...document.querySelectorAll('figure canvas')].filter(c => !c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some(b => b)).length"
        self.assertEqual(self.browser.run(blank), 0)
        # Another choice gives another chart.
        title = "document.querySelector('#medians h3').textContent"
        before = self.browser.run(title)
        self.browser.run(
            "(() => { const s = document.querySelector('#medians select'); s.selectedIndex = 1; s.dispatchEvent(new Event('change')); })()"
        )
        self.assertNotEqual(self.browser.run(title), before)

    def check_scene(self):
        run = self.browser.run
        run("document.getElementById('view').scrollIntoView()")
        self.browser.until("Boolean(tandem.sceneView)")
        colours = PIXELS + "new Set(pixels).size; })()"
        self.assertGreater(run(colours), 20)
        before = run(CAMERA)
        run("document.getElementById('scene-canvas').focus()")
        self.browser.key("ArrowRight")
        turned = run(CAMERA)
        self.assertNotEqual(turned, before)
        box = run(
            "(() => { const r = document.getElementById('scene-canvas').getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        )
        self.browser.drag(box, [box[0] + 90, box[1] + 30])
        self.assertNotEqual(run(CAMERA), turned)
        words = run("document.getElementById('scene-words').textContent")
        self.assertRegex(words, r"^Frame 20: 3 bodies of 5,130 tetrahedra, \d+,\d{3} contacts\.$")
        run(
            "(() => { const s = document.getElementById('frame-slider'); s.value = 3; s.dispatchEvent(new Event('input')); })()"
        )
        self.assertIn("Frame 23:", run("document.getElementById('scene-words').textContent"))
        self.assertEqual(run("tandem.sceneView.frame"), 3)
        self.browser.key("PageUp")
        self.assertIn("Frame 22:", run("document.getElementById('scene-words').textContent"))
        run("[...document.querySelectorAll('#view button')].find(b => b.textContent === 'Contacts').click()")
        bodies = run(HUES)
        run(
            "(() => { const s = [...document.querySelectorAll('#view select')][0]; s.value = 'chunk'; s.dispatchEvent(new Event('change')); })()"
        )
        self.assertGreater(run(HUES), 3 * bodies)

    def check_sizes_and_colours(self):
        ground = "getComputedStyle(document.body).backgroundColor"
        light = self.browser.run(ground)
        self.browser.dark(True)
        self.assertNotEqual(self.browser.run(ground), light)
        self.browser.dark(False)
        self.browser.size(390, 844, mobile=True)
        wide = "[...document.querySelectorAll('body *')].filter(e => e.getBoundingClientRect().right > 391 && !e.closest('.tall, .scrolls')).map(e => e.outerHTML.slice(0, 90))"
        self.browser.run("new Promise(done => setTimeout(done, 500))")
        self.assertEqual(
            self.browser.run("document.documentElement.scrollWidth"), 390, self.browser.run(wide)
        )
        self.browser.size(1280, 900)
        self.browser.ask("Emulation.setEmulatedMedia", media="print")
        self.assertEqual(
            self.browser.run(
                "[...document.querySelectorAll('.controls')].some(c => c.getClientRects().length)"
            ),
            False,
        )
        self.assertEqual(
            self.browser.run(
                "[...document.querySelectorAll('figure canvas')].every(c => c.getClientRects().length)"
            ),
            True,
        )
        self.browser.ask("Emulation.setEmulatedMedia", media="")

    def too_wide(self):
        """Tables that are wider than their boxes, with all numbers of charts shown."""
        self.browser.run("document.querySelectorAll('details').forEach(one => one.open = true)")
        self.browser.run("new Promise(done => setTimeout(done, 300))")
        return self.browser.run(
            "[...document.querySelectorAll('.tall, .scrolls')].filter(box => box.scrollWidth > box.clientWidth)"
            ".map(box => [box.closest('figure, section').id, box.scrollWidth, box.clientWidth])"
        )

    def test_tables_fit_1400_pixels_and_are_cards_on_a_phone(self):
        files = (RECORDS / f"{name}.jsonl" for name in ("plan", "profile", "ceilings"))
        page = self.report(*files, SOURCE / "tests/records/accuracy.jsonl")
        self.browser.size(1400, 900)
        self.opened(page)
        self.assertEqual(self.too_wide(), [])
        self.assertEqual(self.browser.run(f"getComputedStyle({ROWS}[0].children[1]).display"), "table-cell")
        self.browser.size(390, 844, mobile=True)
        self.opened(page)
        self.assertEqual(self.too_wide(), [])
        self.assertEqual(self.browser.run("document.documentElement.scrollWidth"), 390)
        labels = self.browser.run(
            f"[...{ROWS}[0].children].filter(field => field.getClientRects().length)"
            ".map(field => getComputedStyle(field, '::before').content)"
        )
        self.assertEqual(labels[:4], ['"cell"', '"ms a frame"', '"95 %"', '"status"'])
        tops = self.browser.run(
            f"[...{ROWS}[0].children].filter(field => field.getClientRects().length).map(field => field.getBoundingClientRect().top)"
        )
        self.assertEqual(tops, sorted(set(tops)))
        self.assertEqual(self.sort_by("ms a frame"), "ascending")

    def test_many_cells(self):
        path = self.write("many.jsonl", self.made_up(MANY))
        page = self.report(path, "--scene", "plates", "--frames", "0:99" if LONG else "0:9")
        seconds = self.opened(page)
        print(
            f"\n  {MANY} cells and a scene: {page.stat().st_size / 1e6:.1f} MB, whole after {seconds:.2f} s",
            end="",
            file=sys.stderr,
        )
        self.assertEqual(self.browser.run(f"{ROWS}.length"), MANY)
        self.check_sorting()
        self.check_filters()

    def check_sorting(self):
        self.assertEqual(self.sort_by("ms a frame"), "ascending")
        times = [float(text.replace(",", "")) for text in self.column("ms a frame") if text]
        # sorting by duration is correct; differences of long lists take minutes to print
        self.assertTrue(times == sorted(times), times[:20])
        self.assertEqual(self.sort_by("ms a frame"), "descending")
        falling = [float(text.replace(",", "")) for text in self.column("ms a frame") if text]
        self.assertTrue(falling == times[::-1], falling[:20])
        self.assertEqual(self.sort_by("algorithm"), "ascending")
        names = self.column("algorithm")
        self.assertTrue(names == sorted(names), names[:20])

    def check_filters(self):
        tiled = sum(record["algorithm"] == "tiled" for record in self.made_up(MANY))
        self.assertEqual(self.type("tiled"), f"{tiled} of {MANY} cells")
        self.assertEqual(set(self.column("algorithm")), {"tiled"})
        both = sum(
            record["algorithm"] == "tiled" and record["settings"]["k"] == "8" for record in self.made_up(MANY)
        )
        self.assertEqual(self.type("tiled k=8"), f"{both} of {MANY} cells")
        self.assertEqual(self.type("nothing has this"), f"0 of {MANY} cells")
        self.type("")
        self.browser.run(
            "(() => { const s = [...document.querySelectorAll('#cells select')].find(s => s.parentNode.textContent.startsWith('algorithm')); "
            "s.value = 'gproximity'; s.dispatchEvent(new Event('change')); })()"
        )
        self.browser.until("document.querySelector('#cell-table tbody').dataset.complete === 'true'")
        self.assertEqual(set(self.column("algorithm")), {"gproximity"})
        self.browser.run(f"{ROWS}[0].querySelector('button').click()")
        self.assertIn("--quiet --resume", self.browser.run("document.querySelector('.details').textContent"))

    def test_failed_wrong_and_markup(self):
        failed, wrong, older, named = (json.loads(json.dumps(self.plan[i])) for i in (0, 1, 2, 3))
        times = {"samples": [], "rounds": [], "frames": []}
        failed.update(status="failed", failure=f"no memory {MARKUP}", total_ns=times)
        wrong["status"] = "wrong"
        wrong["total_ns"]["samples"] = [1] * len(wrong["total_ns"]["samples"])  # faster than all others
        named["scene"]["key"], named["key"] = MARKUP, MARKUP
        older["session"] = "an earlier one"  # in the same session it would be a copy, which is omitted
        page = self.report(self.write("bad.jsonl", [failed, wrong, older, self.plan[2], named]))
        self.opened(page)
        self.assertEqual(self.column("status"), ["failed", "wrong", "ok, recorded again", "ok", "ok"])
        words = self.browser.run("document.getElementById('summary').textContent")
        self.assertIn("1 failed and 1 gave a wrong answer", words)
        self.assertIn("no memory <img", words)
        ranked = self.browser.run(
            "JSON.parse(document.getElementById('data-records').textContent).groups.flatMap(g => g.ranked.map(r => r[0])).sort()"
        )
        self.assertEqual(ranked, [3, 4])
        self.assertEqual(self.browser.run("document.title"), "Report of tandem")
        self.assertEqual(self.browser.run("document.images.length"), 0)
        self.assertIn(MARKUP, self.column("scene"))

    def test_interrupted_and_compressed(self):
        """A resumed cell is shown once, across files, compressed or not."""
        interrupted = json.loads(json.dumps(self.plan[0]))
        interrupted["session"], interrupted["sampling"]["interrupted"] = "another", True
        for name in ("samples", "rounds", "frames"):
            interrupted["total_ns"][name] = interrupted["total_ns"][name][:4]
        whole = self.write("whole.jsonl", self.plan[:2])
        packed = self.work / "packed.jsonl.xz"
        packed.write_bytes(lzma.compress((json.dumps(interrupted) + "\n").encode()))
        self.opened(self.report(packed, whole))
        self.assertEqual(self.column("status"), ["ok", "ok"])
        self.assertEqual(
            self.browser.run("document.getElementById('made').textContent.split('.')[0]"), "Files: packed"
        )
        self.assertNotIn("recorded again", self.browser.run("document.getElementById('summary').textContent"))

    def test_against_equals_compare(self):
        old, new = RECORDS / "paper/records/thresholds.jsonl", self.work / "new.jsonl"
        records = [record for record in map(json.loads, old.read_text().splitlines()) if "key" in record]
        for i, record in enumerate(records):
            record["session"] = "0" * 16
            if i % 3 == 0 and record["status"] == "ok":
                total = record["total_ns"]
                total["samples"] = [round(1.1 * ns) for ns in total["samples"]]
                total.update({name: 1.1 * total[name] for name in ("median", "low", "high")})
        self.write("new.jsonl", records)
        self.opened(self.report(new, "--against", old))
        compared = json.loads(tandem("compare", old, new, "--format", "json")[1])
        shown = self.browser.run("JSON.parse(document.getElementById('data-differences').textContent)")
        self.assertEqual(shown["summary"], compared["summary"])
        self.assertIn(
            compared["summary"], self.browser.run("document.querySelector('#differences-title').textContent")
        )
        self.assertEqual(len(shown["cells"]), len(compared["cells"]))
        for a, b in zip(shown["cells"], compared["cells"]):
            self.assertEqual(a["label"], b["label"])
            for value, name in zip(a["ratio"], ("ratio", "low", "high")):
                if value is None:
                    self.assertIsNone(b["times"][name])
                else:
                    self.assertAlmostEqual(value, b["times"][name], delta=1e-5 * value)
        self.check_parts_agree(shown)
        self.bad("two sets of records", "report", old, new, "--against", old)

    def check_parts_agree(self, shown):
        """The summary, the chart, its table, and each cell give the same result of a comparison, in ms a frame."""
        text = self.browser.run
        self.assertEqual(self.text("#summary .lead"), self.text("#differences-title"))
        self.assertIn("new, against thresholds. ", self.text("#made").replace(".jsonl", ""))
        cells = text("JSON.parse(document.getElementById('data-records').textContent).cells")
        place = text("JSON.parse(document.getElementById('data-records').textContent).fields").index("ms")
        for row in shown["cells"]:
            self.assertAlmostEqual(row["new"], cells[row["cell"]][place][0], delta=0.02 * row["new"])
        slowest = max(shown["cells"], key=lambda row: row["ratio"][0])
        text(f"document.querySelector('#cell-table tr[data-cell=\"{slowest['cell']}\"] button').click()")
        details = self.text(".details")
        self.assertRegex(
            details,
            r"comparison1\.1\d* times the time in thresholds\.jsonl: ",
            "three rounds have no interval",
        )
        self.assertIn(f"thresholds.jsonl: {slowest['verdict']}conditions", details)

    def test_bad_files(self):
        empty, other, text, cut = (
            self.work / name for name in ("empty.jsonl", "other.jsonl", "text.jsonl", "cut.jsonl.xz")
        )
        empty.write_text("")
        self.write("other.jsonl", [{**self.plan[0], "schema": 5}])
        text.write_text("no record\n")
        cut.write_bytes(lzma.compress((RECORDS / "plan.jsonl").read_bytes()[:99_000])[:1000])
        page = self.work / "none.html"
        self.bad("empty.jsonl: is empty", "report", empty, "-o", page)
        self.bad(["other.jsonl:1:", "schema 5"], "report", other, "-o", page)
        self.bad("text.jsonl:1: is not JSON", "report", text, "-o", page)
        self.bad("cut.jsonl.xz: cannot be read", "report", cut, "-o", page)
        self.bad("cannot be read", "report", self.work / "nowhere.jsonl", "-o", page)
        self.write(
            "profile.jsonl",
            [{**json.loads((RECORDS / "profile.jsonl").read_text().splitlines()[0]), "schema": 7}],
        )
        self.bad("schema 7", "report", self.work / "profile.jsonl", "-o", page)
        self.assertFalse(page.exists())
        good = self.write("good.jsonl", self.plan[:1])
        self.bad("nowhere", "report", good, "-o", self.work / "nowhere/page.html")
        self.bad("is a folder", "report", good, "-o", self.work)
        self.bad("unknown scene", "view", "plate", "-o", page)

    def test_more_cells_than_a_page_shows(self):
        count = 100_000 if LONG else MAX_CELLS + 100
        record = {
            name: value
            for name, value in self.plan[0].items()
            if name not in ("conditions", "breakdown_ns", "device_span_ns", "stages")
        }
        record["total_ns"] = {
            "samples": [9, 8],
            "rounds": [0, 1],
            "median": 8.5,
            "low": 8,
            "high": 9,
            "frames": [],
        }
        line = json.dumps(
            {**record, "key": "@", "scene": {**record["scene"], "key": "pile:number=@"}}
        ).replace('"@"', '"key @"')
        path = self.work / "long.jsonl"
        with open(path, "w") as out:
            out.writelines(line.replace("@", str(i)) + "\n" for i in range(count))
        begin = time.time()
        page = self.report(path, notes=1)
        print(
            f"\n  {count} lines: {time.time() - begin:.1f} s, {page.stat().st_size / 1e6:.1f} MB",
            end="",
            file=sys.stderr,
        )
        self.opened(page)
        self.assertRegex(
            self.browser.run("document.querySelector('.bad').textContent"),
            f"{count - MAX_CELLS} of {count} records of cells are left out",
        )
        self.assertEqual(
            self.browser.run(f"{ROWS}.length"),
            self.browser.run("JSON.parse(document.getElementById('data-records').textContent).cells.length"),
        )
