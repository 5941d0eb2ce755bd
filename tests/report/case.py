# SPDX-License-Identifier: MIT
"""A test case whose pages of `tandem report` are opened in Chromium."""

import json

from tests.report.browser import Browser
from tests.program import SOURCE, Case, tandem

RECORDS = SOURCE / "results/h200"


def short(record):
    """The record with few samples, as most have."""
    if isinstance(record, dict):
        return {
            name: short(value)
            for name, value in record.items()
            if name not in ("kernels", "chosen", "kernel_times")
        }
    return [short(value) for value in record[:10]] if isinstance(record, list) else record


class ReportCase(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.__exit__)
        cls.lines = (RECORDS / "plan.jsonl").read_text().splitlines()
        cls.plan = [short(json.loads(line)) for line in cls.lines]

    def setUp(self):
        self.browser.size(1280, 900)
        self.browser.dark(False)

    def report(self, *arguments, name="page.html", notes=0):
        page = self.work / name
        status, out, errors = tandem("report", *arguments, "-o", page)
        self.assertEqual((status, len(errors)), (0, notes), (arguments, out, errors))
        self.assertTrue(out.startswith(f"{page}: "), out)
        self.assertLess(page.stat().st_size, 8e6)
        return page

    def write(self, name, records):
        path = self.work / name
        path.write_text("".join(json.dumps(record) + "\n" for record in records))
        return path

    def opened(self, page):
        seconds = self.browser.open(page)
        self.assertEqual(self.browser.problems(), [])
        return seconds

    def draw(self, figure):
        """Scrolls to a chart, which draws it."""
        self.browser.run(f"document.getElementById('{figure}').scrollIntoView()")
        self.browser.until(f"document.getElementById('{figure}').dataset.drawn === 'true'")

    def text(self, selector):
        return self.browser.run(f"document.querySelector({json.dumps(selector)}).textContent")
