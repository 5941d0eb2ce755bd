# SPDX-License-Identifier: MIT
# test: cost=6
"""index.html of 'tandem paper' has every claim once, in the group of its verdict, the errors of the paper, the fastest
method first, and says which builds and cards its records come from."""

import json
import lzma
import os
import pathlib
import re
import tempfile
import unittest

os.environ.setdefault("MPLCONFIGDIR", tempfile.gettempdir())
from tests.paper import records as made
from tandem.paper import claims, page, provenance
from tandem.paper.folder import Folder
from tandem.paper.rules import DIFFERS, UNTESTED, exact

ONE_CARD = {"name": "GPU", "hardware": "abcdef0123", "kind": "gpu", "id": "cuda:0", "driver": "1"}


def text_of(html):
    return " ".join(re.sub("<[^>]*>", " ", html).split())


class PaperPage(unittest.TestCase):
    def setUp(self):
        work = tempfile.TemporaryDirectory(prefix="tandem-page")
        self.addCleanup(work.cleanup)
        self.work, self.count = pathlib.Path(work.name), 0

    def written(self, files, more=(), journal=()):
        """The page of made-up records, with more claims. journal: fields of the lines of steps.jsonl."""
        self.count += 1
        path = made.write_folder(self.work / str(self.count), files)
        lines = [json.loads(line) for line in (path / "steps.jsonl").read_text().splitlines()]
        for line, fields in zip(lines, journal):
            line.update(fields)
        (path / "steps.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
        folder = Folder(path)
        page.write(folder, [], [], [*claims.all_claims(folder), *more])
        return (path / "index.html").read_text()

    def cell(self, commit="c" * 40, sources="s", card=None, algorithm="tiled", **more):
        record = made.record("plates", {"algorithm": algorithm, "preset": "resident", "k": "8", **more}, 3)
        record["environment"] = {"commit": commit, "dirty": False, "sources": sources}
        record["devices"] = [ONE_CARD | ({"hardware": card} if card else {})]
        return record

    def test_one_build_and_one_card_are_a_line(self):
        html = self.written({"cells-plates": [self.cell()], "array": [self.cell()]})
        self.assertIn(f"All records are of commit {'c' * 12} and of one card, GPU abcdef.", text_of(html))
        self.assertNotIn("Warning:", html)
        html = self.written({"cells-plates": [self.cell()], "array": [self.cell(commit="d" * 40)]})
        self.assertIn(f"{'c' * 12}, which have the same sources, and of one card", text_of(html))

    def test_simulations_that_were_recorded_before_are_no_second_build(self):
        recorded, old = made.simulation("funnel", [made.step(0)]), {"commit": "d" * 40, "dirty": False}
        files = {"cells-plates": [self.cell()], "solver-funnel": recorded}
        text = text_of(self.written(files, journal=[{}, old]))
        self.assertIn(f"All measurements are of commit {'c' * 12} and of one card, GPU abcdef.", text)
        self.assertIn(f"Simulations were recorded on a processor by commit {'d' * 12}.", text)
        self.assertNotIn("Warning:", text)
        other = {"cells-plates": [self.cell()], "sim-funnel": recorded}
        self.assertIn("Warning: the records are of 2 builds", text_of(self.written(other, journal=[{}, old])))

    def test_several_builds_or_cards_are_a_warning(self):
        cells = {"cells-plates": [self.cell()], "sim-funnel": made.simulation("funnel", [made.step(0)])}
        for files, says in (
            ({"array": [self.cell(sources="t", commit="d" * 40)]}, "of 2 builds of tandem."),
            ({"array": [self.cell(card="123456")]}, "of 2 cards."),
            ({"array": [self.cell(sources="t", card="123456")]}, "of 2 builds of tandem and 2 cards."),
            ({"array": [self.cell(sources=None, commit="d" * 40)]}, "of 2 builds of tandem."),
        ):
            text = text_of(self.written({**cells, **files}, journal=[{}, {"commit": "c" * 12}]))
            self.assertIn(f"Warning: the records are {says}", text)
        self.assertIn(f"commit {'c' * 12} processor sim-funnel", text)
        self.assertIn(f"commit {'c' * 12} GPU abcdef cells-plates", text)
        dirty = text_of(self.written(cells, journal=[{}, {"commit": "c" * 12, "dirty": True}]))
        self.assertIn(f"commit {'c' * 12} with changes processor sim-funnel", dirty)

    def test_compressed_records_have_origins_too(self):
        folder = made.write_folder(self.work / "compressed", {"cells-plates": [self.cell()]})
        with lzma.open(folder / "records" / "solver-funnel.jsonl.xz", "wt") as file:
            file.write(json.dumps(self.cell(commit="d" * 40, sources="t")) + "\n")
        found = provenance.origins(Folder(folder))
        self.assertEqual(
            [(origin.step, origin.commit) for origin in found],
            [("cells-plates", "c" * 12), ("solver-funnel", "d" * 12)],
        )
        self.assertFalse(provenance.is_uniform(found))

    def test_every_claim_is_in_the_group_of_its_verdict(self):
        """By construction is a group too, and errors of the paper stand at the claim and in a list."""
        fields = {"says": "A true sentence.", "where": "Section 9", "shown": ["figure7"]}
        value = claims.Line("", DIFFERS, exact(2.0, ["records/a-b.jsonl:3"], "frame 7"))
        more = [
            claims.Claim(
                {**fields, "id": "x-built"}, (claims.Line("", "by construction"),), "by construction"
            ),
            claims.Claim({**fields, "id": "x-wrong", "erratum": "It is <b>2</b>."}, (value,), DIFFERS),
            claims.Claim(
                {**fields, "id": "x-contradicted", "erratum": "Unlike Table 9."}, (value,), "erratum"
            ),
        ]
        html = self.written({"cells-plates": [self.cell()]}, more)
        declared = [fields["id"] for fields in claims.declared()]
        self.assertEqual(
            sorted(re.findall('<tr id="([^"]*)"', html)),
            sorted([*declared, "x-built", "x-wrong", "x-contradicted"]),
        )
        groups = {part.split('"')[0]: part for part in html.split('<div id="')[1:]}
        for claim, group in (("x-built", "by-construction"), ("x-wrong", "differs"), (declared[0], UNTESTED)):
            self.assertIn(f'id="{claim}"', groups[group])
        names = re.findall('<a href="#[a-z-]*">([a-z ]+ \\d+)</a>', html)
        before, errata = html.split('<section id="errata"')
        counted = before.count('<tr id="')
        self.assertEqual(names[0], f"all {counted}")
        self.assertIn(f"{counted} claims of the paper</h2>", html)
        self.assertIn("by construction 1", names)
        row = re.search('<tr id="x-wrong">.*?</tr>', html)[0]
        for part in (
            "Erratum: It is &lt;b&gt;2&lt;/b&gt;.",
            '<a href="#figure7">Figure 7</a>',
            '<a href="records/a-b.jsonl">a-b:3</a>',
        ):
            self.assertIn(part, row)
        self.assertIn("The paper contradicts itself. No count of verdicts has these.", errata)
        self.assertIn('<tr id="x-contradicted">', errata)
        self.assertIn('It is &lt;b&gt;2&lt;/b&gt;. (<a href="#x-wrong">Section 9</a>)', html)

    def test_the_fastest_method_is_the_first(self):
        """And bold."""
        cells = [self.cell(slabs="usual"), self.cell(algorithm="gproximity", preset="fair")]
        for fast, slow in (cells, cells[::-1]):
            made.set_quantity(fast, "frame", [10**9] * 3)
            made.set_quantity(slow, "frame", [10**10] * 3)
            html = self.written({"resident-plates": cells})
            table = html.split('id="methods"')[1].split("</table>")[0]
            heads = re.findall('<th scope="col">(.*?)</th>', table)
            name = {"tiled": "tiled", "gproximity": "gProximity"}[fast["algorithm"]]
            self.assertEqual(heads[2], name)
            self.assertEqual(len(heads), 6)
            self.assertRegex(table, f'data-label="{name}"><strong>2[ <]')
