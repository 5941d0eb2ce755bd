# SPDX-License-Identifier: MIT
"""Tables of cells: stages for each scene, and ratios of the time of gProximity to that of chunked."""

from ..cell import BOUNDS
from ..fields import at
from .naming import Named, labels
from .wording import notes, number, table, with_interval

DEVICE = ("transform", "refit", "seed", "traverse", "balance", "contact", "sort", "read", "write")
HOST = ("preprocess", "postprocess", "exchange")
STAGES = (*DEVICE[:2], "broad", *DEVICE[2:7], *HOST, *DEVICE[7:])
KERNELS = DEVICE[:7]
MAX_RATIOS = 200  # per table; with more, each cell is compared only with the fastest chunked cell


class Row(Named):
    """The values of a Cell in tables: milliseconds per frame by stage, launches and waits per frame, the total,
    notes. Rows of equal `rank` are comparable, as in the table of tandem run: of correct cells with pairs, on
    one device with one output. None: not comparable. Files have many cells, so that a row keeps no more."""

    def __init__(self, cell, devices):
        super().__init__(cell.record, devices)
        self._read_stages(cell.record["stages"], cell.frames)
        self.launches, self.waits = (cell.of_stages(what) / cell.frames for what in ("launches", "waits"))
        released = cell.release_launches
        self.release_launches = None if released is None else released / cell.frames
        total = cell.record["total_ns"] or {}
        self.total = cell.ms() or 0
        self.total_text = with_interval(total, 1e-6 / cell.frames, len(set(total.get("rounds", []))))
        pairs = cell.total_work("candidate_pairs")
        self.pairs = None if pairs is None else pairs / cell.frames
        self.notes = notes(cell.record)
        is_ranked = cell.status == "ok" and self.pairs and self.total
        self.rank = self.once((self.devices, cell.asked.get("output"))) if is_ranked else None
        # Cells with different bounds have different candidate pairs and separate tables.
        bounds = [
            name for name in BOUNDS if name != "output" and cell.asked.get(name, BOUNDS[name]) != BOUNDS[name]
        ]
        self.heading = self.once(self.heading + "".join(f", {name} = {cell.asked[name]}" for name in bounds))

    def _read_stages(self, stages, frames):
        by_host = (*HOST, "broad") if not at(stages, "broad", "launches") else HOST
        self.stage = {
            s: (at(stages, s, "host_ns" if s in by_host else "device_ns", "median") or 0) / frames / 1e6
            for s in STAGES
            if s in stages
        }

    def kernels(self):
        """Milliseconds per frame of the stages that are kernels in the paper."""
        return sum(self.stage.get(s, 0) for s in KERNELS)


def _stage_table(rows, named):
    best, ranked = {}, {}
    for r in rows:
        if r.rank:
            best[r.rank] = min(r.total, best.get(r.rank, r.total))
            ranked[r.rank] = ranked.get(r.rank, 0) + 1
    total = lambda r: (
        f"**{r.total_text}**"
        if r.rank and ranked[r.rank] > 1 and r.total == best[r.rank]
        else r.total_text or "-"
    )
    stages = [s for s in STAGES if any(r.stage.get(s) for r in rows)]
    release_text = lambda r: "-" if r.release_launches is None else f"{r.release_launches:.0f}"
    counted = [("as theirs", release_text)] if any(r.release_launches is not None for r in rows) else []
    return table(
        [
            "method",
            "device",
            *stages,
            "launches",
            *(name for name, _ in counted),
            "waits",
            "total ms",
            "notes",
        ],
        [
            [
                *name,
                *(number(r.stage.get(s)) for s in stages),
                f"{r.launches:.0f}",
                *(text(r) for _, text in counted),
                f"{r.waits:.0f}",
                total(r),
                r.notes,
            ]
            for r, name in zip(rows, named)
        ],
    )


def _opponents(rows, named):
    """Cells of gProximity with their names, cells of chunked with their names by rank, and whether the latter
    are complete."""
    cells = [(r, name) for r, (name, _) in zip(rows, named) if r.rank]
    ours, theirs = (
        [(r, name) for r, name in cells if r.family[0] == algorithm]
        for algorithm in ("chunked", "gproximity")
    )
    by_rank = {}
    for own in ours:
        by_rank.setdefault(own[0].rank, []).append(own)
    all_shown = sum(len(by_rank.get(r.rank, ())) for r, _ in theirs) <= MAX_RATIOS
    if not all_shown:
        by_rank = {rank: [min(own, key=lambda cell: cell[0].total)] for rank, own in by_rank.items()}
    return theirs, by_rank, all_shown


def _ratios(above, below, counted):
    """Texts of ratios of times and launches of two cells."""
    part = lambda a, b, digits: f"{a / b:.{digits}f}" if b else "-"
    texts = [
        part(above.total, below.total, 2),
        part(above.kernels(), below.kernels(), 2),
        part(above.stage.get("write", 0), below.stage.get("write", 0), 1),
        part(above.launches, below.launches, 1),
    ]
    if counted:
        texts.append(
            "-"
            if None in (above.release_launches, below.release_launches)
            else part(above.release_launches, below.release_launches, 1)
        )
    return texts


def _ratio_table(rows, named):
    theirs, by_rank, all_shown = _opponents(rows, named)
    device_of = {id(r): device for r, (_, device) in zip(rows, named)}
    counted = any(r.release_launches is not None for r in rows)
    lines = [
        [f"{name} / {base}", device_of[id(g)], *_ratios(g, c, counted)]
        for g, name in theirs
        for c, base in by_rank.get(g.rank, ())
    ]
    if not lines:
        return ""
    head = (
        "\n"
        if all_shown
        else f"\nMore than {MAX_RATIOS} ratios: only those to the fastest chunked cell are shown.\n\n"
    )
    return head + table(
        [
            "gProximity / chunked",
            "device",
            "total",
            "kernels",
            "write",
            "launches",
            *(["as theirs"] if counted else []),
        ],
        lines,
    )


def text(rows, devices):
    """One table per scene, frame range and kind of bounds."""
    groups, parts = {}, []
    for row in rows:
        groups.setdefault(row.heading, []).append(row)
    for heading, own in groups.items():
        pairs = sorted({row.pairs for row in own if row.pairs is not None})
        count = " to ".join(f"{value:,.0f}" for value in ([pairs[0], pairs[-1]] if len(pairs) > 1 else pairs))
        named = labels(own, devices, BOUNDS.keys() - {"output"})
        parts += [
            f"\n### {heading}\n\n{count or 'Unknown'} candidate pairs per frame.\n\n",
            _stage_table(own, named),
            _ratio_table(own, named),
        ]
    return "".join(parts)
