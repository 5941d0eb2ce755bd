# SPDX-License-Identifier: MIT
# test: cost=20 full=60
"""Axe-core finds nothing serious or moderate on pages of `tandem report`, of `tandem paper` and of results by many: at
1,400 pixels light and 390 pixels dark, in the long form light and dark at both, with all parts open. The page of
`tandem paper` is checked in the long form only. Skipped if scripts/setup could not fetch axe-core (tests/page-requirements.txt)."""

import json
import unittest

from tests.paper.drawn import page_of_committed
from tests.program import LONG, SOURCE
from tests.report.case import ReportCase
from tests.script_case import called, committed, loaded

AXE = SOURCE / ".cache/pages/axe_playwright_python/axe.min.js"
OPEN = "document.querySelectorAll('details').forEach(one => one.open = true); "
FINDINGS = (
    "axe.run(document, {resultTypes: ['violations']}).then(result => ({passes: result.passes.length, found: result.violations"
    ".filter(one => one.impact !== 'minor').map(one => `${one.impact} ${one.id}: ${one.nodes[0].html.slice(0, 200)}`)}))"
)


@unittest.skipUnless(AXE.is_file(), "no .cache/pages; scripts/setup fetches axe-core, with a network")
class Access(ReportCase):
    def check(self, page, beside=(), sizes=((1400, 900), (390, 844))):
        for width, height in sizes:
            for dark in (False, True) if LONG else (width == 390,):
                self.browser.size(width, height, mobile=width < 500)
                self.browser.dark(dark)
                self.browser.open(page)
                self.assertEqual(self.browser.problems(beside), [])
                self.browser.run(OPEN + AXE.read_text() + "; 1")
                result = self.browser.run(FINDINGS)
                self.assertEqual(result["found"], [], (width, dark))
                self.assertGreater(result["passes"], 10)

    def test_a_page_with_all_parts(self):
        other = self.plan[0] | {
            "session": "0" * 16,
            "environment": self.plan[0]["environment"] | {"commit": "0" * 40},
        }
        files = [self.write("plan.jsonl", [*self.plan[:12], other])]
        for name, count in (
            ("tests/records/accuracy", 8),
            ("results/h200/profile", 1),
            ("tests/records/ceilings", 9),
            ("results/simulations/solver-funnel", 40),
            ("results/h200/paper/records/thresholds", 9),
        ):
            path = next(SOURCE.glob(f"{name}.jsonl*"))
            files.append(
                self.write(
                    f"{path.name.partition('.')[0]}.jsonl",
                    committed(f"../{path.relative_to(SOURCE)}")[:count],
                )
            )
        self.check(self.report(*files, "--scene", "plates", "--frames", "20:22", "--contacts"))

    def test_pages_that_need_no_scripts(self):
        page = self.work / "results.html"
        self.assertEqual(called(loaded("results-page"), "-o", page)[0], 0)
        self.check(page)

    @unittest.skipUnless(LONG, "axe-core takes long for so large a page")
    def test_the_page_of_the_paper(self):
        self.check(page_of_committed(self.work / "paper"), ["file:"])

    def test_a_page_with_a_comparison(self):
        old = self.write("old.jsonl", self.plan[:12])
        failed = json.loads(json.dumps(self.plan[12]))
        failed.update(
            status="failed", failure="no memory", total_ns={"samples": [], "rounds": [], "frames": []}
        )
        self.check(
            self.report(
                self.write(
                    "new.jsonl", [*({**record, "session": "0" * 16} for record in self.plan[:12]), failed]
                ),
                "--against",
                old,
            )
        )
