# SPDX-License-Identifier: MIT
"""Tables 1 to 7 of the paper, with our numbers beside the paper's."""
import csv
import dataclasses
import statistics

from .folder import SCENES, STEPS_OF_TABLES, number, paper_table


@dataclasses.dataclass
class Table:
    """Rows are dictionaries. `source` of a row is "paper" or "ours"; `records` has the locations of our records."""
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
            writer.writerows([{name: short(row.get(name)) for name in self.columns} for row in self.rows])


def short(value):
    """A value as text: numbers with five digits, an empty text for None."""
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) and abs(value) < 1e5 else f"{value:.0f}" if isinstance(value, float) else str(value)


def ratio(above, below):
    return above / below if above is not None and below else None


def paper_rows(table, columns, gpu="gpu"):
    """Rows of a table of the paper with converted numbers. `columns`: {new name: old name}."""
    return [{"scene": row["scene"], "source": "paper", "device": row.get(gpu, ""), **{new: number(row[old]) for new, old in columns.items()}}
            for row in table]


def ordered(rows):
    return sorted(rows, key=lambda row: (SCENES.index(row["scene"]), row["source"] != "ours"))


def table1(folder):
    rows = paper_rows(paper_table(1), {"bodies": "bodies", "vertices_thousand": "vertices_thousand", "tetrahedra_thousand": "tetrahedra_thousand",
                                   "contacts_thousand": "contacts_thousand", "median_contacts_thousand": "median_contacts_a_step_thousand"})
    for simulation in folder.simulations("sim-"):
        scene, found = simulation.run["scene"], simulation.curve("contacts_found")
        rows.append({"scene": scene["name"], "source": "ours", "device": simulation.run["devices"][0]["id"], "bodies": scene["bodies"],
                     "vertices_thousand": scene["vertices"] / 1e3, "tetrahedra_thousand": scene["tetrahedra"] / 1e3,
                     "contacts_thousand": sum(found) / 1e3, "median_contacts_thousand": statistics.median(found) / 1e3,
                     "steps": len(found), "key": scene["key"], "records": simulation.location})
    for case in [case for case in folder.cases("cells-plates") if case.name.startswith("chunked published")]:
        scene, contacts = case.records[0]["scene"], [n for r in case.records for n in r["work"]["contacts"]]
        rows.append({"scene": scene["name"], "source": "ours", "device": case.device["id"], "bodies": scene["bodies"],
                     "vertices_thousand": scene["vertices"] / 1e3, "tetrahedra_thousand": scene["tetrahedra"] / 1e3,
                     "contacts_thousand": sum(contacts) / 1e3, "median_contacts_thousand": statistics.median(contacts) / 1e3,
                     "steps": len(contacts), "key": scene["key"], "records": case.locations[0]})
    return Table(1, "Scenes: bodies, tetrahedra and contacts", ordered(rows),
                 ("The paper's numbers are of 500 steps. Column steps has the number of our steps. In our scene plates, a script moves the plates.",))


def table2(folder):
    rows = [{"source": "paper", "device": row["gpu"], "compute_units": number(row["compute_units"]), "cores": number(row["cores"]),
             "clock_mhz": number(row["clock_mhz"]), "memory_gb": number(row["memory_gb"]), "local_memory_kib": number(row["local_memory_kib"]),
             "bandwidth_gb_s": number(row["bandwidth_gb_s"]), "single_gflops": number(row["single_gflops"])} for row in paper_table(2)]
    ceilings = folder.ceilings()
    if ceilings:
        device, reported = ceilings["device"], ceilings.get("told", {})
        rows.append({"source": "ours", "device": device["name"], "compute_units": device["compute_units"], "cores": reported.get("cores"),
                     "clock_mhz": reported.get("clock_mhz"),
                     "memory_gb": device["memory_bytes"] / 1e9, "local_memory_kib": ratio(reported.get("local_bytes"), 1024),
                     "bandwidth_gb_s": ratio(reported.get("peak_bytes_per_s"), 1e9),
                     "single_gflops": ratio(reported.get("peak_flops"), 1e9),
                     "measured_read_gb_s": ceilings["read_bytes_per_s"]["median"] / 1e9, "measured_copy_gb_s": ceilings["copy_bytes_per_s"]["median"] / 1e9,
                     "measured_upload_gb_s": ceilings["upload_pageable_bytes_per_s"]["median"] / 1e9,
                     "measured_launch_us": ceilings["launch_s"]["median"] * 1e6, "records": "records/ceilings.jsonl"})
    return Table(2, "Devices", rows, ("Peak: one fused multiply-add, two operations, per core and clock. Bandwidth: from clock and width of the memory, if the "
                                      "driver reports them; measured values are beside it. An empty field is unknown.",))


def percentages(simulation):
    """Percent of the total time by part, from sums over all steps, as in the paper's Table 3."""
    total = simulation.host("step")
    start = simulation.stage("transform") + simulation.stage("refit")
    parts = {"solver": simulation.host("solve") + simulation.host("assemble"), "initialization": start, "broad": simulation.host("broad"),
             "narrow": simulation.host("narrow") - start, "contact_reduction": simulation.host("reduce")}
    return {f"{name}_percent": 100 * seconds / total for name, seconds in parts.items()}


def table3(folder):
    columns = ("solver_percent", "initialization_percent", "broad_percent", "narrow_percent", "contact_reduction_percent")
    rows = paper_rows(paper_table(3), {"total_min": "total_min", **{name: name for name in columns}})
    for simulation in [*folder.simulations("sim-"), *folder.simulations("host-"), *folder.simulations("serial-"), *folder.simulations("parallel-")]:
        own = percentages(simulation)
        rows.append({"scene": simulation.scene, "source": "ours", "device": simulation.run["devices"][0]["id"], "total_min": simulation.host("step") / 60,
                     **own, "collision_percent": sum(own[name] for name in columns[1:]), "steps": len(simulation.steps),
                     "data_path": data_path(simulation), "records": simulation.location})
    for row in rows:
        row.setdefault("collision_percent", sum(row[name] or 0 for name in columns[1:]))
    return Table(3, "Parts of the time of a simulation", ordered(rows),
                 ("Percent of sums over all steps of one run; the paper's are means of ten runs. Our solver, including the assembly of its rows, runs on one "
                  "thread, as the paper's does.",))


def data_path(simulation):
    settings = simulation.run["settings"]
    published = settings.get("residency") == "published"
    return f"published, conversion {settings.get('convert', 'serial')}" if published else "resident"


def pick(cases, algorithm, preset, k="8"):
    return next((case for case in cases if case.algorithm == algorithm and case.preset == preset and case.settings.get("k") == k), None)


def factors(own, other, path, against):
    """A row of Table 4: ratios of the times and launches of `other` to those of `own`."""
    return {"scene": own.scene, "source": "ours", "device": own.device["id"], "data_path": path, "against": against, "frame": ratio(other.total(), own.total()),
            "narrow": ratio(other.narrow, own.narrow), "read": ratio(other.stage("read"), own.stage("read")),
            "write": ratio(other.stage("write"), own.stage("write")), "launches": ratio(other.sum("launches"), own.sum("launches")),
            "launches_as_theirs": ratio(other.release_launches, own.release_launches), "frames": own.frames, "records": " ".join((own.locations[0], other.locations[0]))}


def scene_factors(folder, scene):
    cases = folder.cases(f"cells-{scene}")
    rows = []
    published, resident = pick(cases, "chunked", "published"), pick(cases, "chunked", "grouped")
    compared = [case for case in cases if case.algorithm == "gproximity" and case.preset == "published"]
    compared += folder.cases(f"gpus-{scene}")
    for other in compared if published else ():
        if other.frames == published.frames:
            rows.append(factors(published, other, "published", f"gproximity {other.preset}"))
        else:  # the settings of the paper's GPUs are measured on fewer frames: ratios of means per frame
            rows.append({**factors(published, other, "published", f"gproximity {other.preset}"), **frame_factors(published, other)})
    array, other = folder.cases("array"), pick(cases, "gproximity", "published")
    estimated = with_whole_array(published, other, array[0]) if array and published and other else None
    rows += [estimated] if estimated else []
    fair = pick(cases, "gproximity", "fair")
    if resident and fair:
        rows.append(factors(resident, fair, "resident", "gproximity fair"))
    return rows


def with_whole_array(own, other, array):
    """An estimated row of Table 4: `other` plus, for each batch, the measured time of one upload of the array that the release would allocate
    on this device. None if that time is unknown."""
    if not other.batches or not array.batches:
        return None
    write = other.batches * (array.stage("write") - own.stage("write") / own.frames * array.frames) / array.batches
    more = write - other.stage("write")
    return {**factors(own, other, "published", "gproximity with the release's whole queue array, estimated"), "frame": (other.total() + more) / own.total(),
            "narrow": (other.narrow + more) / own.narrow, "write": ratio(write, own.stage("write")),
            "records": " ".join((own.locations[0], other.locations[0], array.locations[0]))}


def frame_factors(own, other):
    """Ratios of means per frame, for different sets of frames."""
    means = lambda case: {"frame": case.total() / case.frames, "narrow": case.narrow / case.frames, "read": case.stage("read") / case.frames,
                         "write": case.stage("write") / case.frames, "launches": case.sum("launches") / case.frames,
                         "launches_as_theirs": case.release_launches / case.frames}
    below, above = means(own), means(other)
    return {**{name: ratio(above[name], below[name]) for name in below}, "frames": f"{own.frames} against {other.frames}"}


def table4(folder):
    rows = paper_rows(paper_table(4), {"total": "total", "narrow": "narrow", "read": "read", "write": "write", "launches": "launches"})
    for row in rows:
        row |= {"data_path": "published", "against": "gproximity", "launches_as_theirs": row["launches"], "launches": None}
    for scene in SCENES:
        rows += scene_factors(folder, scene)
    array = folder.cases("array")
    plates = pick(folder.cases("cells-plates"), "chunked", "published")
    if array and plates:
        rows.append({**factors(plates, array[0], "published", "gproximity with the release's whole queue array"), **frame_factors(plates, array[0])})
    return Table(4, "gProximity / chunked", ordered(rows),
                 ("Published: both algorithms convert, upload and read back everything in every frame. gProximity also uploads its queue array, whose size is "
                  "limited here (setting queue_bytes), except on one frame of plates. In estimated rows, each batch of 30 body pairs has the time of that "
                  "upload. Resident: everything stays on the device. Column total is the paper's for whole simulations; we do not measure "
                  "simulations with gProximity.",
                  "launches counts every kernel. launches_as_theirs counts as the release does: a refit and a balance are one each."))


PARTS = ("transform", "refit", "traverse", "contact", "balance", "preprocess", "postprocess", "read", "write")


def table5(folder):
    rows = []
    for row in paper_table(5):
        rows.append({"scene": row["scene"], "source": "paper", "device": row["gpu"], "method": f"{row['algorithm']} published, k = 8",
                     **{f"{name}_s": number(row[f"{name}_s"]) for name in PARTS}, "launches_as_theirs": number(row["launches"])})
    for scene in SCENES:
        for case in folder.cases(f"cells-{scene}"):
            listed = sum(case.stage(name) for name in PARTS)
            separate = {"broad_s": case.stage("broad"), "seed_s": case.stage("seed")}
            rows.append({"scene": scene, "source": "ours", "device": case.device["id"], "method": case.name,
                         **{f"{name}_s": case.scale * case.stage(name) for name in PARTS}, **untimed(case),
                         "launches_as_theirs": None if case.release_launches is None else case.scale * case.release_launches,
                         **{name: case.scale * value for name, value in separate.items()},
                         "rest_s": case.scale * max(case.total() - listed - sum(separate.values()), 0), "whole_s": case.scale * case.total(),
                         "whole_low_s": case.scale * case.total("low"), "whole_high_s": case.scale * case.total("high"),
                         "launches": case.scale * case.sum("launches"), "waits": case.scale * case.sum("waits"),
                         "frames": f"{case.frames} of {case.first}:{case.last}", "queue_bytes": case.settings.get("queue_bytes"), "records": case.locations[0]})
    return Table(5, f"Where the time goes, seconds in {STEPS_OF_TABLES} frames", ordered(rows),
                 ("Column frames has the number of our frames; our values are scaled to 102 frames. whole is the median of replays that only time whole frames. "
                  "Stages are of replays with timestamps, and may overlap.",
                  "The release does not time the making of seeds and the allocation of its queue array. Columns make_seeds and queue_array have these times, "
                  "which preprocess contains; they are empty for old records. rest is the time outside all stages. Only we have the columns right of launches."))


def untimed(case):
    """Seconds in 102 frames of those parts of stage preprocess that the release does not time; None for records without them."""
    found = {name: case.host_work(work) for name, work in (("make_seeds_s", "make seeds"), ("queue_array_s", "queue array"))}
    return {name: None if seconds is None else case.scale * seconds for name, seconds in found.items()}


def table6(folder):
    rows = paper_rows(paper_table(6), {name: name for name in ("total_min", "read_min", "write_min", "read_percent", "write_percent")})
    for simulation in [*folder.simulations("sim-"), *folder.simulations("host-"), *folder.simulations("serial-"), *folder.simulations("parallel-")]:
        total, read, write = simulation.host("step"), simulation.stage("read", "device_ns"), simulation.stage("write", "device_ns")
        rows.append({"scene": simulation.scene, "source": "ours", "device": simulation.run["devices"][0]["id"], "total_min": total / 60, "read_min": read / 60,
                     "write_min": write / 60, "read_percent": 100 * read / total, "write_percent": 100 * write / total,
                     "data_path": data_path(simulation), "steps": len(simulation.steps), "records": simulation.location})
    return Table(6, "Transfers of a simulation", ordered(rows), ("Device times of uploads and downloads. The paper's are of 500 steps.",))


def table7(folder):
    names = ("transform", "refit", "traverse", "contact")
    rows = paper_rows(paper_table(7), {f"{name}_min": f"{name}_min" for name in names})
    for simulation in [*folder.simulations("sim-"), *folder.simulations("host-"), *folder.simulations("serial-")]:
        rows.append({"scene": simulation.scene, "source": "ours", "device": simulation.run["devices"][0]["id"],
                     **{f"{name}_min": simulation.stage(name) / 60 for name in names}, "data_path": data_path(simulation),
                     "steps": len(simulation.steps), "records": simulation.location})
    for row in rows:
        row["traverse_over_contact"] = ratio(row["traverse_min"], row["contact_min"])
    return Table(7, "Kernels of a simulation", ordered(rows), ("Device times; a resident frame of rigid bodies is transformed in its refit.",))


def all_tables(folder):
    return [make(folder) for make in (table1, table2, table3, table4, table5, table6, table7)]
