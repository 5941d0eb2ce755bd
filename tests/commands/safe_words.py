# SPDX-License-Identifier: MIT
# test: cost=20
"""Words of a file reach terminals, pages and tables without control characters
and formulas."""

import csv
import json

from tests.program import Case, tandem, write_json

ONE = ("--device", "host", "--algorithm", "tiled", "--repeat", "1", "--quiet")
WORDS = "=1+1\x1b[31m\x07\u202e\u2066\x9b\ntail"


class Words(Case):
    def scene(self):
        path = self.work / "words.json"
        write_json(
            path,
            name=WORDS,
            frames=1,
            meshes={"a": {"builtin": "jack"}},
            bodies=[{"mesh": "a"}, {"mesh": "a"}],
        )
        return path

    def recorded(self):
        path = self.work / "words.jsonl"
        if not path.exists():
            self.assertEqual(tandem("run", self.scene(), *ONE, "--out", path)[0], 0)
        return path

    def assertSafe(self, text):
        for character in "\x1b\x07\u202e\u2066\x9b\x00":
            self.assertNotIn(character, text)

    def outputs(self, *arguments):
        _, out, errors = tandem(*arguments)
        text = out + "\n".join(errors)
        self.assertSafe(text)
        return text

    def test_terminals(self):
        shown = r"=1+1\x1b[31m\x07\u202e\u2066\u009b\ntail"
        records = self.recorded()
        self.assertIn(shown, self.outputs("run", self.scene(), *ONE))
        for command in (
            ("check", self.scene(), "--device", "host", "--algorithm", "tiled"),
            ("run", self.scene(), "--dry-run", "--device", "host"),
            ("export", self.scene(), "--glb", self.work / "w.glb"),
            ("view", self.scene(), "-o", self.work / "w.html"),
            ("export", records, "--csv"),
            *(("compare", records, records, "--format", form) for form in ("text", "markdown", "json")),
        ):
            self.assertIn("tail", self.outputs(*command), command)
        self.outputs("run", "pile:mesh=\x1b[31m")
        json.loads(tandem("compare", records, records, "--format", "json")[1])

    def test_pages_have_no_control_characters(self):
        records = self.recorded()
        for arguments, path in (
            (("report", records), self.work / "r.html"),
            (("view", self.scene()), self.work / "v.html"),
        ):
            self.outputs(*arguments, "-o", path)
            page = path.read_text()
            self.assertSafe(page)
            self.assertIn(r"\\x1b[31m", page)  # the escape's letters, in JSON
            self.assertNotIn(r"\u001b", page)

    def test_csv_has_no_formulas(self):
        record = json.loads(self.recorded().read_text().splitlines()[0])
        path = self.work / "formulas.jsonl"
        keys = ("=1+1", "+1", "-1", "@a", "\ta", "\ra", "a=1", "'a")
        record["total_ns"] = {**record["total_ns"], "median": -1e6}
        path.write_text("".join(json.dumps(record | {"key": key}) + "\n" for key in keys))
        _, text, _ = tandem("export", path, "--csv")
        rows = list(csv.DictReader(text.splitlines()))
        self.assertEqual(
            [row["key"] for row in rows], ["'=1+1", "'+1", "'-1", "'@a", r"'\ta", r"'\x0da", "a=1", "'a"]
        )
        self.assertEqual({row["ms"] for row in rows}, {"-1"})
        self.assertEqual({row["scene"][:6] for row in rows}, {"'=1+1\\"})
