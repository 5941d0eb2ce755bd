# SPDX-License-Identifier: MIT
"""Tables of the paper with our numbers beside the paper's: what they share, and Tables 1 and 2."""

import csv
import dataclasses
import math
import statistics

from ..csv_fields import fields
from .folder import SCENES, number, paper_table


@dataclasses.dataclass
class Table:
    """Rows are dictionaries. `source` of a row is "paper" or "ours"; `records` has the locations of our
    records."""

    number: int
    title: str
    rows: list
    notes: tuple = ()

    @property
    def columns(self):
        return list(dict.fromkeys(name for row in self.rows for name in row))

    def write(self, folder):
        with open(folder / f"table{self.number}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, self.columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows(
                [fields({name: short(row.get(name)) for name in self.columns}) for row in self.rows]
            )


def short(value):
    """A value as text for programs: numbers with five digits, an empty text for None."""
    if value is None:
        return ""
    return (
        f"{value:.5g}"
        if isinstance(value, float) and abs(value) < 1e5
        else f"{value:.0f}"
        if isinstance(value, float)
        else str(value)
    )


def written(value, digits=3):
    """A value as people write it: commas between thousands, no exponents, whole numbers in full and others
    with three digits."""
    if value is None:
        return ""
    if not isinstance(value, (int, float)):
        return str(value)
    if not math.isfinite(value):
        return "unknown"
    if value == int(value):
        return f"{int(value):,}"
    places = lambda number: digits - 1 - math.floor(math.log10(abs(number)))
    rounded = round(value, places(value))
    return f"{rounded:,.{max(0, places(rounded))}f}"


def ratio(above, below):
    return above / below if above is not None and below else None


def paper_rows(table, columns, gpu="gpu"):
    """Rows of a table of the paper with converted numbers. `columns`: {new name: old name}."""
    return [
        {
            "scene": row["scene"],
            "source": "paper",
            "device": row.get(gpu, ""),
            **{new: number(row[old]) for new, old in columns.items()},
        }
        for row in table
    ]


def ordered(rows):
    place = lambda scene: SCENES.index(scene) if scene in SCENES else len(SCENES)
    return sorted(rows, key=lambda row: (place(row["scene"]), row["source"] != "ours"))


def _contacts(name, counts):
    """Columns with the sum and the median of the contacts of all steps, in thousands."""
    return {
        f"contacts_{name}_thousand": sum(counts) / 1e3,
        f"median_{name}_thousand": statistics.median(counts) / 1e3,
    }


def _scene_row(scene, device, steps, location, **contacts):
    columns = (
        {}
        if not contacts
        else {
            name: value
            for kind, counts in contacts.items()
            for name, value in _contacts(kind, counts).items()
        }
    )
    return {
        "scene": scene["name"],
        "source": "ours",
        "device": device,
        "bodies": scene["bodies"],
        "vertices_thousand": scene["vertices"] / 1e3,
        "tetrahedra_thousand": scene["tetrahedra"] / 1e3,
        **columns,
        "steps": steps,
        "key": scene["key"],
        "records": location,
    }


def table1(folder):
    rows = paper_rows(
        paper_table(1),
        {
            "bodies": "bodies",
            "vertices_thousand": "vertices_thousand",
            "tetrahedra_thousand": "tetrahedra_thousand",
            "contacts_found_thousand": "contacts_thousand",
            "median_found_thousand": "median_contacts_a_step_thousand",
        },
    )
    for row in rows:  # the paper counts contacts after their reduction
        row["contacts_kept_thousand"], row["median_kept_thousand"] = (
            row.pop("contacts_found_thousand"),
            row.pop("median_found_thousand"),
        )
        row["steps"] = 500
    for run in folder.simulations("sim-"):
        rows.append(
            _scene_row(
                run.run["scene"],
                run.run["devices"][0]["id"],
                len(run.steps),
                run.location,
                found=run.curve("contacts_found"),
                kept=run.curve("contacts_kept"),
            )
        )
    for case in [
        case
        for case in folder.cases("cells-plates")
        if (case.algorithm, case.preset) == ("chunked", "published")
    ]:
        found = [count for cell in case.cells for count in cell.work("contacts")]
        rows.append(
            _scene_row(
                case.cells[0].record["scene"], case.device["id"], len(found), case.locations[0], found=found
            )
        )
    return Table(
        1,
        "Scenes: bodies, tetrahedra and contacts",
        ordered(rows),
        (
            "Contacts found are those before, contacts kept those after the reduction of contacts of a step. The paper counts contacts kept. Rows with "
            "other numbers of steps are not comparable, because contacts change over the steps. "
            "In our scene plates, a script moves the plates.",
        ),
    )


def table2(folder):
    rows = [
        {
            "source": "paper",
            "device": row["gpu"],
            "compute_units": number(row["compute_units"]),
            "cores": number(row["cores"]),
            "clock_mhz": number(row["clock_mhz"]),
            "memory_gb": number(row["memory_gb"]),
            "local_memory_kib": number(row["local_memory_kib"]),
            "bandwidth_gb_s": number(row["bandwidth_gb_s"]),
            "single_gflops": number(row["single_gflops"]),
        }
        for row in paper_table(2)
    ]
    ceilings = folder.ceilings()
    if ceilings:
        device, reported = ceilings["device"], ceilings.get("told", {})
        rows.append(
            {
                "source": "ours",
                "device": device["name"],
                "compute_units": device["compute_units"],
                "cores": reported.get("cores"),
                "clock_mhz": reported.get("clock_mhz"),
                "memory_gb": device["memory_bytes"] / 1e9,
                "local_memory_kib": ratio(reported.get("local_bytes"), 1024),
                "bandwidth_gb_s": ratio(reported.get("peak_bytes_per_s"), 1e9),
                "single_gflops": ratio(reported.get("peak_flops"), 1e9),
                "measured_read_gb_s": ceilings["read_bytes_per_s"]["median"] / 1e9,
                "measured_copy_gb_s": ceilings["copy_bytes_per_s"]["median"] / 1e9,
                "measured_upload_gb_s": ceilings["upload_pageable_bytes_per_s"]["median"] / 1e9,
                "measured_launch_us": ceilings["launch_s"]["median"] * 1e6,
                "records": "records/ceilings.jsonl",
            }
        )
    return Table(
        2,
        "Devices",
        rows,
        (
            "Peak: one fused multiply-add, two operations, per core and clock. Bandwidth: from clock and width of the memory, if the "
            "driver reports them; measured values are beside it. An empty field is unknown.",
        ),
    )
