#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""metadata.py PROGRAM SOURCE: what archives and search engines read: .zenodo.json and codemeta.json agree
with CITATION.cff (command_line.py compares it with CITATION.bib), results/croissant.json is as
scripts/croissant makes it, and lists of packages and the recipe of Spack name CMake's libraries."""

import ast
import json
import re
import unittest

from program import SOURCE
from script_case import loaded


def citation():
    """Values of CITATION.cff of the project itself: those before its references."""
    text, _, references = (SOURCE / "CITATION.cff").read_text().partition("references:\n")
    values = dict(re.findall(r'^([a-z-]+): "?([^"\n]+)"?$', text, re.M))
    values["abstract"] = " ".join(re.search(r"^abstract: >-\n((?:  .*\n)+)", text, re.M)[1].split())
    values["keywords"] = re.findall(r"^  - (\S.*)$", text.partition("keywords:\n")[2], re.M)
    values["authors"] = re.findall(r"^  - name: (.+)$", text, re.M)
    values["dois"] = re.findall(r"^    doi: (\S+)$", references, re.M)
    return values


class Metadata(unittest.TestCase):
    def test_archives_read_what_the_citation_states(self):
        cited = citation()
        self.assertEqual((len(cited["dois"]), len(cited["keywords"]), len(cited["authors"])), (2, 4, 1))
        zenodo, codemeta = (
            json.loads((SOURCE / name).read_text()) for name in (".zenodo.json", "codemeta.json")
        )
        for cff, name in (
            ("title", "title"),
            ("abstract", "description"),
            ("version", "version"),
            ("date-released", "publication_date"),
            ("license", "license"),
            ("keywords", "keywords"),
            ("type", "upload_type"),
        ):
            self.assertEqual(zenodo[name], cited[cff], name)
        for cff, name in (
            ("title", "name"),
            ("abstract", "description"),
            ("version", "version"),
            ("date-released", "dateModified"),
            ("keywords", "keywords"),
        ):
            self.assertEqual(codemeta[name], cited[cff], name)
        self.assertEqual(codemeta["license"], f"https://spdx.org/licenses/{cited['license']}")
        self.assertEqual([one["name"] for one in zenodo["creators"]], cited["authors"])
        self.assertEqual([one["name"] for one in codemeta["author"]], cited["authors"])
        self.assertEqual([one["identifier"] for one in zenodo["related_identifiers"]], cited["dois"])
        self.assertEqual(
            [one["@id"].removeprefix("https://doi.org/") for one in codemeta["referencePublication"]],
            cited["dois"],
        )

    def test_metadata_of_results_is_as_made(self):
        made = loaded("croissant").made()
        self.assertTrue(
            (SOURCE / "results/croissant.json").read_text() == made, "results/ changed; run scripts/croissant"
        )
        dataset = json.loads(made)
        committed = {
            str(path.relative_to(SOURCE / "results"))
            for path in (SOURCE / "results").rglob("*.jsonl")
            if path.parent != SOURCE / "results"
        }
        self.assertLessEqual(committed, {one["@id"] for one in dataset["distribution"]})
        plan = next(one for one in dataset["recordSet"] if one["@id"] == "cells/h100/after.jsonl")
        self.assertIn("scene_digest", [field["name"] for field in plan["field"]])
        self.assertTrue(all(field["description"] for one in dataset["recordSet"] for field in one["field"]))

    def test_lists_of_packages_have_every_library(self):
        """scripts/gpu/fetch is for machines without a network, where a missing library shows too late."""
        setup, fetch = ((SOURCE / "scripts" / name).read_text() for name in ("setup", "gpu/fetch"))
        needed = {
            "libboost1.74-dev" if name == "libboost-dev" else name
            for name in re.findall(r"\b[a-z0-9.-]+-dev\b", setup.partition("packages=(")[2].partition(")")[0])
        }
        self.assertGreater(len(needed), 9)
        fetched = set(re.findall(r"[a-z0-9.-]+", fetch.partition("packages=(")[2].partition(")")[0]))
        self.assertEqual(needed - fetched, set())

    def test_the_recipe_of_spack_agrees_with_cmake(self):
        recipe = (SOURCE / "scripts/spack/package.py").read_text()
        (tandem,) = [node for node in ast.parse(recipe).body if isinstance(node, ast.ClassDef)]
        self.assertEqual((tandem.name, [base.id for base in tandem.bases]), ("Tandem", ["CMakePackage"]))
        cmake = "".join((SOURCE / name).read_text() for name in ("CMakeLists.txt", "cmake/python.cmake"))
        options = re.findall(r'self\.define\w*\("(\w+)"', recipe)
        self.assertEqual(len(options), 3)
        for option in options:
            self.assertRegex(cmake, rf"(option\(|set\(){option} ")
        self.assertIn(f"cmake@{re.search(r'cmake_minimum_required.VERSION ([0-9.]+)', cmake)[1]}:", recipe)
        # What Spack calls the packages of CMake; compilers and threads come with the machine.
        names = {
            "Boost": "boost",
            "Eigen3": "eigen",
            "fmt": "fmt",
            "nlohmann_json": "nlohmann-json",
            "CLI11": "cli11",
            "OpenCL": "ocl-icd",
            "ZLIB": "zlib-api",
            "LibLZMA": "xz",
            "TBB": "tbb",
            "GMP": "gmp+cxx",
            "LZ4": "lz4",
            "Python3": "python@3.11:",
            "Threads": None,
        }
        required = re.findall(
            r"^find_package\((\w+).*REQUIRED", (SOURCE / "CMakeLists.txt").read_text(), re.M
        )
        self.assertLessEqual(set(required), set(names))
        for name in required:
            if names[name]:
                self.assertIn(f'"{names[name]}"', recipe, name)


if __name__ == "__main__":
    unittest.main(argv=["metadata.py"])
