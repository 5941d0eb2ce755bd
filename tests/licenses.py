#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# test: cost=1
"""Every file has a license, by a line of its own or by REUSE.toml, as `reuse
lint` demands; packages and pages have the notices of the libraries that they contain."""

import pathlib
import re
import subprocess
import tempfile
import tomllib
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[1]

LINE = re.compile(rb"SPDX-License-" rb"Identifier: ([\w.+-]+)")
BEGIN = 1000  # bytes of a file in which its line stands
JAVASCRIPT = pathlib.Path("/usr/share/javascript")
NOTICES = re.compile(r"\(c\) \d{4}(?:-\d{4})? ([^\n*]+)", re.I)


def pattern_of(glob):
    """A path of REUSE.toml as a regular expression: ** also matches slashes."""
    parts = re.split(r"(\*\*|\*)", glob)
    return re.compile(
        "".join({"**": ".*", "*": "[^/]*"}.get(part, re.escape(part)) for part in parts) + r"\Z"
    )


def table_license(tables, path):
    """The license of a file by the last table that matches it; None without one."""
    found = None
    for table in tables:
        globs = table["path"] if isinstance(table["path"], list) else [table["path"]]
        if any(pattern_of(glob).match(path) for glob in globs):
            found = table
    return found and found.get("SPDX-License-Identifier")


def problems(root, paths):
    """What is wrong with the licenses of files, relative to a folder with REUSE.toml and LICENSES."""
    tables = tomllib.loads((root / "REUSE.toml").read_text())["annotations"]
    known = {path.stem for path in (root / "LICENSES").iterdir()}
    for path in paths:
        file = root / path
        if path.startswith("LICENSES/") or not file.is_file():
            continue
        with open(file, "rb") as opened:
            own = LINE.search(opened.read(BEGIN))
        name = own[1].decode() if own else table_license(tables, path)
        if name is None:
            yield f"{path}: has no line SPDX-License-Identifier, and REUSE.toml does not cover it"
        elif name not in known:
            yield f"{path}: LICENSES has no text of {name}"


class Licenses(unittest.TestCase):
    def test_every_file_has_a_license(self):
        listed = subprocess.run(
            ["git", "-C", SOURCE, "ls-files", "-z"], capture_output=True, text=True, check=False
        )
        paths = [path for path in listed.stdout.split("\0") if path]
        if listed.returncode != 0:  # an archive of the sources, without git
            paths = [
                str(path.relative_to(SOURCE))
                for folder in ("base", "harness", "python", "scripts")
                for path in (SOURCE / folder).rglob("*")
                if "__pycache__" not in path.parts
            ]
        self.assertGreater(len(paths), 300)
        self.assertEqual(list(problems(SOURCE, paths)), [])

    def test_files_without_a_license_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "LICENSES").mkdir()
            (root / "LICENSES/MIT.txt").write_text("text")
            (root / "REUSE.toml").write_text(
                '[[annotations]]\npath = "**"\n\n[[annotations]]\npath = ["**.md", "data/*.csv"]\nSPDX-License-'
                'Identifier = "MIT"\n'
            )
            files = {
                "a.md": "",
                "deep/b.md": "",
                "data/c.csv": "1",
                "data/deep/d.csv": "1",
                "e.cpp": "int e;",
                "f.cpp": "// SPDX-License-Identifier: MIT\n",
                "g.cpp": "// SPDX-License-Identifier: GPL-3.0-only\n",
                "h.cpp": " " * BEGIN + "// SPDX-License-Identifier: MIT\n",
                "i.markdown": "",
            }
            for name, text in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            found = [problem.split(":")[0] for problem in problems(root, [*files, "LICENSES/MIT.txt"])]
            self.assertEqual(found, ["data/deep/d.csv", "e.cpp", "g.cpp", "h.cpp", "i.markdown"])

    def test_pages_and_packages_have_the_notices_of_libraries(self):
        """Chart.js and three.js keep notices of their parts in their texts: each stands in pages and in NOTICE.md."""
        copied = re.search(r"foreach\(library (.+?)\)", (SOURCE / "cmake/external.cmake").read_text())[
            1
        ].split()
        self.assertEqual({name.split("/")[0] for name in copied}, {"chart.js", "three"})
        texts = [
            " ".join((SOURCE / name).read_text().split())
            for name in ("NOTICE.md", "python/tandem/report/page/licences.html")
        ]
        for owner in ("Chart.js Contributors", "three.js authors", "Jukka Kurkela"):
            self.assertTrue(all(owner in text for text in texts), owner)
        for path in (JAVASCRIPT / name for name in copied):
            for owner in NOTICES.findall(path.read_text(errors="replace")):
                self.assertTrue(all(owner.strip() in text for text in texts), f"{path}: {owner}")

    def test_packages_have_the_texts(self):
        install, project = (
            (SOURCE / "cmake/install.cmake").read_text(),
            tomllib.loads((SOURCE / "pyproject.toml").read_text()),
        )
        self.assertIn("install(FILES LICENSE NOTICE.md ", install)
        self.assertEqual(project["project"]["license-files"], ["LICENSE", "NOTICE.md"])
        notice = (SOURCE / "NOTICE.md").read_text()
        compiled_in = {
            "Boost": "Boost",
            "Eigen3": "Eigen",
            "fmt": "{fmt}",
            "nlohmann_json": "JSON for Modern C++",
            "CLI11": "CLI11",
        }
        shared = {
            "OpenCL": "OpenCL",
            "ZLIB": "zlib",
            "LZ4": "LZ4",
            "LibLZMA": "liblzma",
            "TBB": "oneTBB",
            "GMP": "GMP",
            "embree": "Embree",
            "MPI": "MPI",
        }
        tools = {"Threads", "Python3"}
        found = set(re.findall(r"find_package\((\w+)", (SOURCE / "CMakeLists.txt").read_text()))
        self.assertEqual(
            found - tools - compiled_in.keys() - shared.keys(), set(), "NOTICE.md has to name them"
        )
        for name in (found & compiled_in.keys()) | (found & shared.keys()):
            self.assertIn((compiled_in | shared)[name], notice)


if __name__ == "__main__":
    unittest.main(argv=["licenses.py"], verbosity=2)
