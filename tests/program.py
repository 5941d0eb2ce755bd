# SPDX-License-Identifier: MIT
"""Helpers shared by tests of the program: PROGRAM (build/tandem unless TANDEM_TESTED names another), SOURCE,
running the program, meshes, a test case."""

import csv
import itertools
import json
import os
import pathlib
import re
import resource
import shlex
import subprocess
import sys
import tempfile
import unittest

import jsonschema

from tests.validate_records import problems_of_record

SOURCE = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = pathlib.Path(os.environ.get("TANDEM_TESTED", SOURCE / "build/tandem")).resolve()
BUILT = PROGRAM.parent / "tests"  # test programs, shims and stubs
STUBS = BUILT / "stubs"  # of CUDA
# Tests of label full use every scene, preset and device; otherwise a few, to compile and traverse less.
LONG = "TANDEM_LONG_FORM" in os.environ
os.environ.pop("COLUMNS", None)  # tables have their default width
# Capacities for a million pairs, and queues to match, would take the host most of the time for so few pairs.
SMALL = {
    name: 65536
    for name in ("pair_capacity", "contact_capacity", "queue_bytes", "seed_capacity", "tile_pair_capacity")
}


def ran(words, **options):
    """The ended process, with its output as text."""
    return subprocess.run([*map(str, words)], capture_output=True, text=True, **options)


def cells_of(text):
    """The records of cells among lines of JSON, without verdicts."""
    return [record for record in map(json.loads, text.splitlines()) if record.get("kind") != "verdict"]


def sets(settings):
    return [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]


def write_json(path, **fields):
    """Writes an object, such as a scene or a plan."""
    path.write_text(json.dumps(fields))


def words_of(arguments):
    """The words of a command line: the first argument and those that begin with an option may be several words,
    as a shell splits them."""
    words = []
    for i, argument in enumerate(map(str, arguments)):
        is_text = " " in argument and (i == 0 or re.match("--?[a-z]", argument))
        words += shlex.split(argument) if is_text else [argument]
    return words


def right_cells(text):
    """How many cells the output of 'tandem run' calls right: "all 3 right: ...", "A, B: right: ..." or "right: ..."."""
    found = 0
    for names in re.findall(r"(?m)^(.*)\bright: no pair missing or extra", text):
        count = re.fullmatch(r"all (\d+) ", names)
        found += int(count[1]) if count else names.count(",") + 1
    return found


def briefly(arguments):
    """The words of a command line. Unless they choose a device, a run is on OpenCL's first one; in short form it
    is on the host, because PoCL compiles slowly."""
    words = words_of(arguments)
    if words[0] != "run" or "--device" in words or any(word.endswith("plan.json") for word in words):
        return words
    return [*words, "--device", "opencl:0" if LONG else "host"]


def messages(text):
    """The lines of standard error, without those of PoCL's compiler and of progress; a slow machine has more of
    these."""
    others = r".*generated\.\s*$|\s*$|\[(\d+ %, )?[\d:]+(, [\d:]+ left)?\] "
    return [line for line in text.splitlines() if not re.match(others, line)]


def tandem(*arguments, environment=None, address_space=None):
    """Returns (exit code, standard output, messages of standard error). `address_space` limits the bytes of
    address space. A run takes one sample per cell unless the arguments choose otherwise: the default of ten
    rounds is for measurements."""
    arguments = words_of(arguments)
    # a plan has its own stopping criterion
    is_plan = any(argument.endswith("plan.json") for argument in arguments)
    if (
        arguments[:1] == ["run"]
        and not is_plan
        and not {"--repeat", "--noise", "--seconds", "--profile"} & set(arguments)
    ):
        arguments = ["run", "--repeat", "1", *arguments[1:]]
    limit = (
        (lambda: resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space)))
        if address_space
        else None
    )
    done = subprocess.run(
        [str(PROGRAM), *arguments],
        capture_output=True,
        text=True,
        env={**os.environ, **(environment or {})},
        preexec_fn=limit,
    )
    return done.returncode, done.stdout, messages(done.stderr)


def tried(what, count, unit, where="host", *, lost=0, crashes=0, hangs=0, rest=0):
    """Appends a line to the file that TANDEM_TRIED names, if it is set, for scripts/tried
    (tests/support/tried.h has the same function). `count` units were tried; `lost` counts answers or records,
    `crashes` and `hangs` the program, and `rest` ended in other people's libraries."""
    if "TANDEM_TRIED" not in os.environ:
        return
    commit = re.search(
        r"commit (\w+)",
        subprocess.run([str(PROGRAM), "--version"], capture_output=True, text=True, check=True).stdout,
    )[1]
    line = {"what": what, "count": count, "unit": unit, "where": where, "lost": lost, "crashes": crashes}
    line |= {"hangs": hangs, "others": rest, "commit": commit}
    with open(os.environ["TANDEM_TRIED"], "a", encoding="utf-8") as out:
        out.write(json.dumps(line) + "\n")


def bar(cells, offset):
    """Vertices and tetrahedra of a row of cubes, six tetrahedra each; coordinates are exact in single
    precision."""
    points = [(i, j, k) for i in range(cells + 1) for j in range(2) for k in range(2)]
    number = {p: n for n, p in enumerate(points)}
    tets = []
    for cube in range(cells):
        for order in itertools.permutations(range(3)):
            corner, tet = [cube, 0, 0], [number[(cube, 0, 0)]]
            for axis in order:
                corner[axis] += 1
                tet.append(number[tuple(corner)])
            tets.append(tet)
    shifted = [tuple(x * 0.75 + o for x, o in zip(p, offset)) for p in points]
    return shifted, tets


def gmsh(path, points, tets, kind=4):
    with open(path, "w") as out:
        out.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % len(points))
        out.writelines("%d %r %r %r\n" % (n, *p) for n, p in enumerate(points, 1))
        out.write("$EndNodes\n$Elements\n%d\n" % len(tets))
        out.writelines(
            "%d %d 2 0 0 %s\n" % (n, kind, " ".join(str(v + 1) for v in t)) for n, t in enumerate(tets, 1)
        )
        out.write("$EndElements\n")
    return path


def cubes():
    """Points and tetrahedra of 2 x 2 x 2 cubes. The only inner vertex is number 13, the middle."""
    points = [(i, j, k) for i in range(3) for j in range(3) for k in range(3)]
    paths = list(itertools.permutations(((1, 0, 0), (0, 1, 0), (0, 0, 1))))
    tets = []
    for cube in (point for point in points if max(point) < 2):
        for path in paths:
            corners = list(itertools.accumulate((cube, *path), lambda p, q: tuple(map(sum, zip(p, q)))))
            tets.append([points.index(corner) for corner in corners])
    return points, tets


def node_data(values, name="pressure"):
    """$NodeData of a Gmsh file: a number at each vertex."""
    rows = "".join(f"{node} {value!r}\n" for node, value in enumerate(values, 1))
    return f'$NodeData\n1\n"{name}"\n1\n0\n3\n0\n1\n{len(values)}\n{rows}$EndNodeData\n'


class Case(unittest.TestCase):
    """Base of all test cases: a folder with a valid mesh, and readers of the program's output."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.work = pathlib.Path(cls.folder.name)
        cls.good = gmsh(cls.work / "good.msh", *bar(4, (0, 0, 0)))
        cls.twice = f"--mesh {cls.good} --mesh {cls.good}"
        schema = json.loads((SOURCE / "results/record.schema.json").read_text())
        cls.validator = jsonschema.Draft7Validator(schema)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def records(self, path):
        """The records of cells in a file, checked against their schema, without verdicts."""
        records = cells_of(path.read_text())
        for record in records:
            self.assertEqual(problems_of_record(record), [])
        return records

    def output(self, *arguments, **options):
        """Standard output of a command that succeeds without a message."""
        status, out, errors = tandem(*briefly(arguments), **options)
        self.assertEqual((status, errors), (0, []), out)
        return out

    def rounds_of_two_samples(self, record):
        """Checks that the record has two samples, one per round; in one round if preparation takes seconds, as on a
        busy machine."""
        rounds = record["total_ns"]["rounds"]
        self.assertEqual(len(record["total_ns"]["samples"]), 2)
        self.assertIn(rounds, ([0, 1], [0, 0]))
        return len(set(rounds))

    def bad(self, expected, *arguments, code=2, environment=None):
        status, out, errors = tandem(*arguments, environment=environment)
        self.assertEqual(status, code, (arguments, out, errors))
        self.assertEqual(len(errors), 1, (arguments, errors))
        self.assertTrue(errors[0].startswith("tandem: "), errors)
        for part in [expected] if isinstance(expected, str) else expected:
            self.assertIn(part, errors[0])
        print(f"\n  {status}: {errors[0]}", end="", file=sys.stderr)
        return out

    def all_bad(self, table, **names):
        """Every row of the table has a part of a message, and the command line that is refused with it."""
        for row in filter(None, table.splitlines()):
            expected, words = re.split(r" +\| +", row.format(**names))
            with self.subTest(words):
                self.bad(expected, words)

    def dump(self, path, header):
        """Rows of a dump after its header, which must be sorted by their first five numbers."""
        rows = list(csv.reader(path.read_text().splitlines()))
        self.assertEqual(",".join(rows[0]), header)
        ids = [tuple(map(int, row[:5])) for row in rows[1:]]
        self.assertEqual(ids, sorted(ids))
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        return rows[1:], ids

    def flawed(self, name):
        """The bar with a flat tetrahedron across its first cube, the 25th, and its tetrahedra."""
        points, tets = bar(4, (0, 0, 0))
        tets = [*tets, [0, 1, 3, 2]]
        return gmsh(self.work / name, points, tets), tets
