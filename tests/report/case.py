# SPDX-License-Identifier: MIT
"""A test case whose pages of `tandem report` are opened in Chromium, and a reader of pages without one."""

import html.parser
import json

from tests.program import SOURCE, Case, tandem
from tests.report.browser import Browser

RECORDS = SOURCE / "results/h200"
SIMULATIONS = SOURCE / "results/simulations"
CHOOSE = """(() => {{ const choice = [...document.querySelectorAll('#{} label')].find(one => one.textContent.startsWith({}))
  .querySelector('select, input'); choice.value = {}; choice.dispatchEvent(new Event({})); }})()"""


class Shown(html.parser.HTMLParser):
    """rows: texts of the cells of each row of a page. words: all its texts but of scripts and styles. tags:
    names of its elements. ids: texts of elements by id."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.tags, self.data = [], set(), {}
        self._words, self._open, self._is_in_cell = [], "", False
        self.feed(text)
        self.words = "".join(self._words)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self._open = dict(attrs).get("id", "") if tag in ("script", "style") else None
        self._is_in_cell |= tag == "td"
        if tag == "tr":
            self.rows.append([])
        elif tag == "td":
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        self._open = None
        self._is_in_cell &= tag != "td"

    def handle_data(self, data):
        if self._open is not None:
            self.data[self._open] = data
            return
        self._words.append(data)
        if self._is_in_cell:
            self.rows[-1][-1] += data

    def json(self, name="records"):
        return json.loads(self.data[f"data-{name}"])


def short(value, count=10, left_out=("kernels", "chosen", "kernel_times")):
    """A record with few samples, as most have, and without those fields."""
    if isinstance(value, dict):
        return {name: short(one, count, left_out) for name, one in value.items() if name not in left_out}
    return [short(one, count, left_out) for one in value[:count]] if isinstance(value, list) else value


class ReportCase(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.__exit__)
        lines = (RECORDS / "plan.jsonl").read_text().splitlines()
        # By their keys, because a plan measures its cells in another order each time.
        cls.plan = sorted(map(short, map(json.loads, lines)), key=lambda record: record["key"])

    def setUp(self):
        self.browser.size(1280, 900)
        self.browser.dark(False)

    def report(self, *arguments, name="page.html", notes=0):
        page = self.work / name
        status, out, errors = tandem("report", *arguments, "-o", page)
        self.assertEqual((status, len(errors)), (0, notes), (arguments, out, errors))
        self.assertTrue(out.startswith(f"{page}: "), out)
        self.assertLess(page.stat().st_size, 16e6)
        return page

    def write(self, name, records):
        path = self.work / name
        path.write_text("".join(json.dumps(record) + "\n" for record in records))
        return path

    def opened(self, page):
        seconds = self.browser.open(page)
        self.assertEqual(self.browser.problems(), [])
        return seconds

    def shown(self, *arguments, **how):
        """What a page shows, which is also opened."""
        page = self.report(*arguments, **how)
        self.opened(page)
        return Shown(page.read_text())

    def choose(self, part, label, value, event="change"):
        """Gives a field of a part of the page, found by its label, a value."""
        self.browser.run(CHOOSE.format(part, *map(json.dumps, (label, value, event))))

    def text(self, selector):
        return self.browser.run(f"document.querySelector({json.dumps(selector)}).textContent")

    def texts(self, selector):
        return self.browser.run(
            f"[...document.querySelectorAll({json.dumps(selector)})].map(one => one.textContent)"
        )
