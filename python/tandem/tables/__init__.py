# SPDX-License-Identifier: MIT
"""python3 -m tandem.tables FILE.jsonl[.xz] ...: records of any kind as Markdown. Cells: a table a scene, its frames and kind of bounds, in
milliseconds a frame by stage as in the paper's Table 5, then how many times chunked is faster as in its Table 4; profiles: a
table each; simulations: shares as in its Table 3; ceilings.

Columns of stages are device times of replays with timestamps (host times for preprocess, postprocess, and broad where the host
finds body pairs); total is the median of the replays that time whole frames, +- half its 95 % interval ("?": one round), bold
where no comparable cell is faster. "as theirs" are launches counted as those of the paper's Table 5 are, where a record says how often
each kernel was launched: a refit, a balance and the contacts of a batch are one each. A label has what tells cells of one algorithm and
preset apart. Failed and wrong cells are shown as such and compared with none. Exit 2, and one line that says why, for a file that is no file
of records, also an empty one; 3 when standard output cannot be written."""
import argparse

from .. import kinds
from ..commands import Parser, run, warn
from . import ceilings, cells, profiles, simulations
from .naming import Devices


def as_markdown(files):
    """Tables of all records of these files. Raises RecordError."""
    devices, runs = Devices(), simulations.Simulations()
    made = {"cell": cells.Cell, "profile": profiles.Profile, "ceilings": ceilings.Ceilings}
    rows = {kind: [] for kind in made}
    for file in files:
        for location, kind, record in kinds.each(file, warn):
            with kinds.fields_of(kind, location):
                if kind == "simulation":
                    runs.add(record, file, devices)
                else:
                    rows[kind].append(made[kind](record, devices))
    return "".join([cells.text(rows["cell"], devices), profiles.text(rows["profile"], devices), runs.text(devices),
                    ceilings.text(rows["ceilings"], devices)])


def _make(arguments):
    parser = Parser(prog="python3 -m tandem.tables", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE")
    return as_markdown(parser.parse_args(arguments).files), 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))
