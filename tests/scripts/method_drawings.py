# SPDX-License-Identifier: MIT
# test: cost=5
"""scripts/method_drawings: committed drawings are what it draws, every walk in them finds all pairs of boxes, and their
texts neither overlap nor end outside, light and dark, in Chromium."""

import itertools
import re
import tempfile
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

from tests.program import SOURCE
from tests.report.browser import Browser
from tests.script_case import loaded

DRAWN = loaded("method_drawings")
from drawings import walks
from drawings.bodies import LEAVES, common, overlap, two_bodies

MOST_BYTES = 40_000
SIZE = "(({width, height}) => [width, height])(document.documentElement.viewBox.baseVal)"
BOXES = """[...document.querySelectorAll('text')].map(one => { const box = one.getBBox();
    return [one.textContent, box.x, box.y, box.x + box.width, box.y + box.height]; })"""


def all_walks(pair):
    yield from (walk(*pair) for walk in (walks.walk_queues, walks.walk_leaves, walks.walk_tiles))
    yield from (walk(*pair, chunks) for walk in (walks.walk_items, walks.walk_groups) for chunks in (8, 16))


class Walks(unittest.TestCase):
    def test_every_walk_finds_the_pairs_of_brute_force(self):
        a, b = pair = two_bodies()
        leaves = range(LEAVES)
        boxes = [[body.nodes[LEAVES + leaf] for leaf in leaves] for body in pair]
        found = {(i, j) for i in leaves for j in leaves if overlap(boxes[0][i], boxes[1][j])}
        self.assertGreater(len(found), 100)
        for timeline in all_walks(pair):
            self.assertEqual(timeline.found, found)
        meeting = {(i, j) for i in leaves for j in leaves if common(a.triangles[i], b.triangles[j])}
        self.assertTrue(meeting < found)

    def test_the_walks_are_as_the_page_compares_them(self):
        pair = two_bodies()
        queues, tiles = walks.walk_queues(*pair), walks.walk_tiles(*pair)
        paper, grouped = (walk(*pair, 16) for walk in (walks.walk_items, walks.walk_groups))
        self.assertGreater(tiles.tests, max(queues.tests, paper.tests, grouped.tests))
        waits = lambda timeline: sum(
            end - start for group, _, start, end, kind in timeline.bars if kind == "read"
        )
        self.assertLess(waits(tiles), min(map(waits, (queues, paper, grouped))))
        self.assertGreater(grouped.work, 2 * paper.work)

    def test_no_lane_does_two_things_at_once(self):
        for timeline in all_walks(two_bodies()):
            spans = {}
            for group, lanes, start, end, _ in timeline.bars:
                for lane in lanes:
                    spans.setdefault((group, lane), []).append((start, end))
            for (group, lane), times in spans.items():
                self.assertLess(lane, walks.LANES)
                for (_, end), (start, _) in itertools.pairwise(sorted(times)):
                    self.assertLessEqual(end, start, (group, lane))
            self.assertTrue(0 < timeline.work < 1)
            tests = sum(
                len(lanes) * (end - start) for _, lanes, start, end, kind in timeline.bars if kind == "test"
            )
            self.assertEqual(timeline.tests, tests)

    def test_common_part_of_triangles(self):
        corner = ((0, 0), (4, 0), (0, 4))
        self.assertEqual(len(common(corner, ((1, 1), (5, 1), (1, 5)))), 3)
        self.assertEqual(common(corner, ((5, 5), (6, 5), (5, 6))), [])


class Files(unittest.TestCase):
    def test_committed_drawings_are_up_to_date(self):
        with tempfile.TemporaryDirectory() as folder:
            DRAWN.main([folder])
            for name in DRAWN.DRAWINGS:
                self.assertEqual((SOURCE / name).read_bytes(), Path(folder, name).read_bytes(), name)
        others = {path.name for path in (SOURCE / "python/tandem/report/methods").glob("*.svg")}
        self.assertEqual(others - {Path(name).name for name in DRAWN.DRAWINGS}, set())

    def test_small_with_a_title_and_colours_for_light_and_dark(self):
        every = []
        for name in DRAWN.DRAWINGS:
            text = (SOURCE / name).read_text()
            self.assertLessEqual(len(text.encode()), MOST_BYTES, name)
            root = xml.fromstring(text)
            self.assertTrue(all(len(root.findtext(f"{{*}}{tag}")) > 4 for tag in ("title", "desc")), name)
            light, dark = root.findtext("{*}style").split("@media (prefers-color-scheme:dark)")
            used = {word for one in root.iter() for word in one.get("class", "").split()} - {"drawing"}
            colours = {word for word in used if not word.startswith("drawing-size-")}
            self.assertGreater(len(colours), 5, name)
            for rules, words in ((light, used), (dark, colours)):
                self.assertEqual(set(re.findall(r"\.(drawing-[\w-]+)\{", rules)), words, name)
            ids = [one.get("id") for one in root.iter() if one.get("id")]
            self.assertEqual(root.get("aria-labelledby").split(), ids[:2])
            every += ids
        self.assertEqual(len(every), len(set(every)), "one page may have all drawings")

    def test_texts_are_inside_and_apart(self):
        with Browser() as browser:
            for name in DRAWN.DRAWINGS:
                browser.open(SOURCE / name)
                width, height = browser.run(SIZE)
                texts = browser.run(BOXES)
                self.assertGreater(len(texts), 5, name)
                for text, *box in texts:
                    self.assertTrue(
                        0 <= box[0] and 0 <= box[1] and box[2] <= width and box[3] <= height,
                        (name, text, box),
                    )
                for (one, *box), (two, *other) in itertools.combinations(texts, 2):
                    # Lines of texts may share the space of letters' lowest parts.
                    other = [other[0], other[1] + 3, other[2], other[3] - 3]
                    self.assertFalse(overlap(box, other), (name, one, two))
