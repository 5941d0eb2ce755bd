# SPDX-License-Identifier: MIT
# test: cost=1
"""Names of methods and scenes (python/tandem/names.py), which are the program's."""

import json

from tests.program import SOURCE, Case, tandem

from tandem import names

FUNNEL = "recording:{},frames=500,digest=1,of=funnel:bodies=2000,size=16"


class Names(Case):
    def test_names_are_those_of_the_program(self):
        listed = [json.loads(tandem(command, "--json")[1]) for command in ("algorithms", "scenes")]
        committed = json.loads((SOURCE / "python/tandem/names.json").read_text())
        self.assertEqual(committed, names.written(*listed), "scripts/schema writes names.json")
        titles = [title for methods in committed["methods"].values() for title in methods.values()]
        self.assertEqual(len(titles), len(set(titles)))

    def test_scenes(self):
        for key, name in (
            ("pile:bodies=2000,mesh=jack,density=0.2,seed=1,frames=2,far=0", "2,000 jacks, density 0.2"),
            ("pile:bodies=1,mesh=glass,density=2,seed=3,frames=2,far=0", "1 glass, density 2, seed 3"),
            (
                "pile:bodies=16,worlds=4096,mesh=jack,density=0.2,seed=1",
                "4,096 worlds of 16 jacks, density 0.2",
            ),
            ("pile:bodies=3,mesh=a/b-c.msh", "3 bodies of b-c.msh, density 0.2"),
            ("plates:count=3,angle=0.3,frames=500", "plates"),
            ("plates:count=5,angle=0.3,frames=500,refine=2", "plates, count 5, refine 2"),
            ("grippers:worlds=1024,seed=1,frames=11", "grippers, 1,024 worlds"),
            (FUNNEL.format("funnel"), "funnel"),
            (FUNNEL.format("jam"), "jam, a recording of funnel"),
            ("hard:sliver:difficulty=0.5,seed=1,pairs=64,together=16", "hard:sliver, difficulty 0.5"),
            ("a made-up scene", "a made-up scene"),
            ("meshes:a=b,c", "meshes:a=b,c"),
            ("<b a=b>", "<b a=b>"),
            ("new:size=²", "new, size ²"),
        ):
            self.assertEqual(names.scene(key), name)

    def test_methods(self):
        for cell, name in (
            (("chunked", "paper"), "paper's schedule"),
            (("chunked", "grouped"), "grouped schedule"),
            (("chunked", "published"), "chunked published"),
            (("gproximity", "fair"), "gProximity"),
            (("gproximity", "published"), "gProximity published"),
            (("leaf_query", "resident"), "leaf queries"),
            (("tiled", "resident"), "tiled"),
            (("embree", "resident"), "Embree"),
            (("made_up", ""), "made_up"),
        ):
            self.assertEqual(names.method(*cell), name)
