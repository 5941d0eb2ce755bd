# SPDX-License-Identifier: MIT
# test: cost=10
"""The kit of pages (python/tandem/pages): no text becomes markup, each page has the frame, the policy and the labels
that it needs, groups work with and without a script, and pages that need no scripts are whole in Chromium."""

import re

from tests.paper.drawn import FIGURES, page_of_committed
from tests.report.case import ReportCase, Shown
from tests.script_case import called, loaded

from tandem.pages import frame, markup
from tandem.pages.groups import Group, groups, groups_script
from tandem.pages.tables import Column, Row, number_text, table

TEXT = "<img src=x onerror='run()'> & \"</script>\"\x1b[2J"
SEEN = "&lt;img src=x onerror=&#x27;run()&#x27;&gt; &amp; &quot;&lt;/script&gt;&quot;\\x1b[2J"


class Kit(ReportCase):
    def test_no_text_becomes_markup(self):
        section = frame.Section("a", TEXT, [markup.element("p", TEXT, title=TEXT), markup.items([TEXT])])
        shown = table(
            TEXT,
            [TEXT],
            [[TEXT], Row([markup.link(TEXT)], anchor=TEXT, more=markup.markup(TEXT))],
            notes=[TEXT],
            csv=TEXT,
        )
        figure = frame.figure("b", TEXT, TEXT, TEXT, TEXT)
        page = frame.html_of(
            frame.Page(TEXT, [section, frame.Section("c", "c", [shown, figure])], TEXT, TEXT)
        )
        without = page.replace("<wbr>", "").replace(SEEN, "")
        self.assertEqual([part for part in ("onerror", "\x1b", "run()", "</script>") if part in without], [])
        self.assertGreater(page.replace("<wbr>", "").count(SEEN), 20)
        page = frame.Page(
            "t",
            scripts=["let a = '</script>' + '<!--';"],
            data={"records": '{"a":"</script><!--\x1b\\u001b"}'},
        )
        html = frame.html_of(page)
        self.assertIn("let a = '<\\/script>' + '<\\!--';", html)
        self.assertIn('{"a":"\\u003c/script>\\u003c!--\\\\x1b\\\\x1b"}', html)

    def test_policies(self):
        policy = lambda **how: re.search('Policy" content="(.*?)"', frame.html_of(frame.Page("t", **how)))[1]
        least = "default-src 'none'; style-src 'unsafe-inline'"
        self.assertEqual(policy(), least)
        self.assertEqual(policy(has_images=True), f"{least}; img-src 'self'")
        self.assertEqual(policy(scripts=["1"]), f"{least}; script-src 'unsafe-inline'; img-src data: blob:")
        self.assertEqual(
            policy(scripts=["1"], has_images=True), f"{least}; script-src 'unsafe-inline'; img-src 'self'"
        )

    def test_only_pages_that_need_scripts_say_so(self):
        without = lambda **how: "<noscript>" in frame.html_of(frame.Page("t", **how))
        self.assertEqual(
            [without(), without(scripts=["1"]), without(scripts=["1"], without="")], [False, True, False]
        )

    def test_numbers_are_those_of_scripts(self):
        values = [
            0,
            1,
            -2,
            0.1,
            0.00012345,
            0.0000999,
            1e-16,
            999.96,
            1234.6,
            9999999,
            1e7,
            4.8e12,
            2 / 3,
            100,
            1230000000,
        ]
        self.opened(self.report(self.write("one.jsonl", self.plan[:1])))
        self.assertEqual(
            [number_text(value) for value in values], self.browser.run(f"{values}.map(tandem.number)")
        )

    def test_tables_have_labels(self):
        text = table(
            "t", ["a", Column("b", True)], [["x:y,1,z_w", 1234], [None, 0.5]], csv="t.csv", anchor="t1"
        )
        self.assertEqual(Shown(text).rows, [[], ["x:y,1,z_w", "1,234"], ["", "0.5"]])
        self.assertIn("x:<wbr>y,1,<wbr>z_<wbr>w", text)
        for part in (
            '<section id="t1"><h3>t</h3>',
            '<th scope="col">a</th><th scope="col" class="number">b</th>',
            '<div class="scrolls" tabindex="0" role="group" aria-label="t">',
            '<td class="number" data-label="b">0.5</td>',
            '<p><a href="t.csv">t.csv</a></p>',
        ):
            self.assertIn(part, text)

    def test_wide_tables_stay_tables(self):
        """On a phone, too, where the other tables become cards. Their first column stays in sight."""
        columns = ["first", *(f"column {i}" for i in range(20))]
        shown = table("t", columns, [["here", *range(20)]], is_wide=True)
        self.assertNotIn("data-label", shown)
        page = self.work / "wide.html"
        page.write_text(
            frame.html_of(frame.Page("t", [frame.Section("a", "a", [shown, table("u", columns, [["a"]])])]))
        )
        self.browser.size(390, 844, mobile=True)
        self.opened(page)
        display = "[...document.querySelectorAll('td:first-child')].map(one => getComputedStyle(one).display)"
        self.assertEqual(self.browser.run(display), ["table-cell", "block"])
        self.browser.run("document.querySelector('.scrolls').scrollLeft = 500")
        self.assertEqual(self.browser.run("document.querySelector('.scrolls').scrollLeft"), 500)
        place = "document.querySelector('td').getBoundingClientRect().left"
        self.assertGreaterEqual(self.browser.run(place), 0)
        self.assertEqual(self.browser.run("document.documentElement.scrollWidth"), 390)

    def grouped(self, scripts):
        parts = [Group(name, name, 1, markup.element("p", name, id=f"in-{name}")) for name in ("one", "two")]
        content = [groups("Choice", "part", parts), markup.link("#in-two", "to two")]
        page = self.work / "groups.html"
        made = frame.Page("t", [frame.Section("part", "part", content)], scripts=scripts, without="")
        page.write_text(frame.html_of(made))
        self.opened(page)

    def test_groups_are_links_without_scripts(self):
        """A link opens the group that it leads into."""
        self.grouped([])
        opened = "[...document.querySelectorAll('details')].map(one => one.open)"
        self.assertEqual(self.browser.run(opened), [False, False])
        self.assertEqual(self.texts(".groups a"), ["all 2", "one 1", "two 1"])
        self.browser.run("document.querySelector('[href=\"#two\"]').click()")
        self.browser.until(f"{opened}[1]")
        self.assertEqual(self.browser.run(opened), [False, True])

    def test_groups_are_chosen_by_keys(self):
        """With the script, a choice shows one group and opens it; a link into another one shows all again."""
        self.grouped([groups_script()])
        state = "[...document.querySelectorAll('details')].map(one => [one.hidden, one.open])"
        pressed = "[...document.querySelectorAll('.groups button')].map(one => one.ariaPressed)"
        self.assertEqual(self.texts(".groups button"), ["all 2", "one 1", "two 1"])
        self.assertEqual(self.browser.run(pressed), ["true", "false", "false"])
        self.browser.run("document.querySelectorAll('.groups button')[1].focus()")
        self.browser.key(" ")
        self.assertEqual(self.browser.run(state), [[False, True], [True, False]])
        self.assertEqual(self.browser.run(pressed), ["false", "true", "false"])
        self.browser.run("document.querySelector('[href=\"#in-two\"]').click()")
        self.browser.until(f"{state}[1][0] === false")
        self.assertEqual(self.browser.run(state), [[False, True], [False, True]])
        self.assertEqual(self.browser.run(pressed), ["true", "false", "false"])

    def test_pages_that_need_no_scripts(self):
        """They have all their images, fit a phone, and their navigation leads to what there is."""
        results = self.work / "results.html"
        self.assertEqual(called(loaded("results-page"), "-o", results)[0], 0)
        paper = page_of_committed(self.work / "paper")
        self.assertLess(paper.stat().st_size, 300e3)
        for path, images, scripts in ((results, 0, 0), (paper, FIGURES, 1)):
            self.browser.size(390, 844, mobile=True)
            self.browser.open(path)
            self.assertEqual(self.browser.problems([f"{paper.parent.as_uri()}/figure"]), [])
            widths = self.browser.run("[...document.images].map(one => [one.naturalWidth, one.width])")
            self.assertEqual([width > 500 and width == shown for width, shown in widths], [True] * images)
            self.assertEqual(self.browser.run("document.documentElement.scrollWidth"), 390)
            lost = "[...document.querySelectorAll('[href^=\"#\"]')].filter(one => !document.querySelector(one.hash)).length"
            self.assertEqual(
                (self.browser.run(lost), self.browser.run("document.scripts.length")), (0, scripts)
            )
            self.assertEqual(self.text(".skip"), "Skip to the content")
        self.assertLess(self.browser.run("document.documentElement.scrollHeight"), 20000)
