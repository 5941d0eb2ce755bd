# SPDX-License-Identifier: MIT
# test: cost=1
"""Files that are made of the declarations of fields, and what readers take
from them."""

import csv
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from tests.program import PROGRAM, SOURCE, ran
from tests.script_case import loaded

MAKER = PROGRAM.parent / "harness/record_schema"
MADE = ("results/record.schema.json", "results/verdict.schema.json", "python/tandem/fields.json")
RECORDS = SOURCE / "results/cpu/walks.jsonl"


def made(folder):
    subprocess.run([MAKER, folder], check=True)


def differing(root, folder):
    """The files of the tree that are not as the program makes them."""
    return [
        name
        for name in MADE
        if not (root / name).is_file() or (root / name).read_bytes() != (folder / name).read_bytes()
    ]


def table_of(package, records):
    """The header and the first row of `tandem export --csv` by the package in a folder, with the standard
    library only."""
    code = f"import sys; sys.path.insert(0, {str(package)!r}); from tandem.commands.export_csv import main; sys.exit(main(['--records', {str(records)!r}]))"
    text = ran([sys.executable, "-S", "-I", "-c", code], check=True).stdout
    return list(csv.reader(text.splitlines()[:2]))


class Schemas(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_committed_files_are_as_declared(self):
        made(self.folder)
        self.assertEqual(differing(SOURCE, self.folder), [], "run scripts/schema")

    def test_the_comparison_can_fail(self):
        made(self.folder)
        tree = self.folder / "tree"
        for name in MADE:
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, tree / name)
        text = (tree / MADE[0]).read_text()
        (tree / MADE[0]).write_text(text.replace("number of bodies", "number of body"))
        (tree / MADE[2]).unlink()
        self.assertEqual(differing(tree, self.folder), [MADE[0], MADE[2]])

    def test_bad_use(self):
        for arguments in ((), ("/dev/null/folder",)):
            done = ran([MAKER, *arguments])
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)

    def test_every_column_has_a_field_and_a_place(self):
        """Columns with a fixed place are fields of records, or computed."""
        schema = json.loads((SOURCE / MADE[0]).read_text())
        for field in json.loads((SOURCE / MADE[2]).read_text())["columns"]:
            place = schema
            for name in field["path"]:
                place = place["properties"][name]
        header, row = table_of(SOURCE / "python", RECORDS)
        self.assertEqual(
            header[:10],
            [
                "status",
                "failure",
                "algorithm",
                "preset",
                "device",
                "device_name",
                "driver",
                "scene",
                "scene_digest",
                "bodies",
            ],
        )
        sys.path.insert(0, str(SOURCE / "python"))
        from tandem import cell, cell_rows

        record = json.loads(RECORDS.read_text().splitlines()[0])
        self.assertLessEqual(set(cell_rows.FIRST_COLUMNS), set(cell_rows.row(cell.Cell(record))))
        self.assertEqual(row[header.index("bodies")], str(record["scene"]["bodies"]))

    def test_a_declared_column_is_in_the_tables(self):
        package = self.folder / "python"
        shutil.copytree(
            SOURCE / "python/tandem", package / "tandem", ignore=shutil.ignore_patterns("__pycache__")
        )
        path = package / "tandem/fields.json"
        fields = json.loads(path.read_text())
        fields["columns"].append({"column": "cores", "path": ["environment", "cores"], "type": "integer"})
        path.write_text(json.dumps(fields))
        header, row = table_of(package, RECORDS)
        self.assertEqual(header[header.index("key") + 1], "cores")
        record = json.loads(RECORDS.read_text().splitlines()[0])
        self.assertEqual(row[header.index("cores")], str(record["environment"]["cores"]))
        code = (
            f"import sys; sys.path.insert(0, {str(package)!r}); from tandem.records import read; cells = read({str(RECORDS)!r}).cells; "
            "print(cells['cores'].dtype, cells['cores'].iloc[0])"
        )
        text = ran([sys.executable, "-c", code], check=True).stdout
        self.assertEqual(text.split(), ["Int64", str(record["environment"]["cores"])])

    def test_the_page_of_fields_has_every_field(self):
        docs = loaded("docs")
        schema = json.loads((SOURCE / MADE[0]).read_text())
        lines = docs.fields_page().splitlines()
        names = {line.split(" | ")[0].removeprefix("| ") for line in lines if line.startswith("| ")}
        self.assertLessEqual(set(schema["properties"]), names)
        self.assertLessEqual(
            {"scene.bodies", "devices[].clock", "kernel_times.NAME.launches", "error.truth.contacts.point"},
            names,
        )
        self.assertIn("| environment.memory_bytes | integer | byte |  | host memory in bytes |", lines)
        self.assertIn("| scene.bodies | integer |  | bodies | number of bodies |", lines)
        self.assertIn(
            "| total_ns.frames | array of array of integer |  |  | [replay][frame] the parts of each sample in nanoseconds |",
            lines,
        )
        self.assertIn("## condition", lines)
        schema["properties"]["scene"]["properties"]["colour"] = {
            "enum": ["red", "blue"],
            "description": "a|b",
        }
        page = docs.FieldsPage(schema, [{"column": "hue", "path": ["scene", "colour"]}]).text
        self.assertIn("| scene.colour | red, blue |  | hue | a\\|b |", page.splitlines())
