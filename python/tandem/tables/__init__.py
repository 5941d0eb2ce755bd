# SPDX-License-Identifier: MIT
"""python3 -m tandem.tables FILE.jsonl[.xz] ...: prints records of any kind as Markdown. Cells have one table
per scene, frame range and kind of bounds: milliseconds per frame by stage, as in the paper's Table 5, then
ratios of gProximity to chunked, as in its Table 4. Profiles have one table each. Simulations have fractions
of time, as in its Table 3. Ceilings of devices have one table.

Columns of stages are device times of replays with timestamps. Stages preprocess and postprocess, and broad if
the host finds body pairs, have host times. Column total is the median of the replays that time whole frames,
+- half its 95 % interval ("?": only one round); it is bold if no comparable cell is faster. Column "as
theirs" has launches counted as in the paper's Table 5, for records with launches of each kernel: a refit, a
balance and the contacts of a batch count as one each. A label has the settings in which cells of one
algorithm and preset differ. Failed and wrong cells are shown as such and not compared. Exits with 2 and one
error line for a file without records, with 3 if standard output cannot be written."""

from .. import kinds
from ..cell import Cell
from ..commands import Parser, run, warn
from . import ceilings, cells, profiles, simulations
from .naming import Devices


def as_markdown(files):
    """Tables of all records of these files. Raises RecordError."""
    devices, runs = Devices(), simulations.Simulations()
    row_types = {"profile": profiles.Profile, "ceilings": ceilings.Ceilings}
    rows = {kind: [] for kind in ("cell", *row_types)}
    for file in files:
        for location, kind, record in kinds.each(file, warn):
            with kinds.fields_of(kind, location):
                if kind == "simulation":
                    runs.add(record, file, devices)
                elif kind == "cell":
                    rows[kind].append(cells.Row(Cell(record, *location.rsplit(":", 1)), devices))
                elif kind != "verdict":
                    rows[kind].append(row_types[kind](record, devices))
    return "".join(
        [
            cells.text(rows["cell"], devices),
            profiles.text(rows["profile"], devices),
            runs.text(devices),
            ceilings.text(rows["ceilings"], devices),
        ]
    )


def _make(arguments):
    parser = Parser("python3 -m tandem.tables", __doc__)
    parser.add_argument("files", nargs="+", metavar="FILE")
    return as_markdown(parser.read(arguments).files), 0


def main(arguments, program=""):
    return run(lambda: _make(arguments))
